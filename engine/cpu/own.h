// Twin of glsl/own.glsl: a host's surface, evaluated at every shared place in the one triangle that
// owns it, so that both sides get the same bits whatever the surface does.
#ifndef GIRIH_ENGINE_CPU_OWN_H
#define GIRIH_ENGINE_CPU_OWN_H

#include "item.h"

// As a share of the way to each corner, how far the points are at least that a normal is taken
// from.
#define GIRIH_OWN_NORMAL_STEP (1.0f / 256.0f)

// Where a pattern vertex is evaluated: a triangle, and its corners' weights over GIRIH_SPLIT_ONE,
// in the order of the input.
typedef struct girih_place {
    uint32_t scene_triangle;
    uint32_t weights[3];
} girih_place;

// Across a hard edge the normals part; all who share an output vertex (the weld edge, the vertex)
// still share the place.
typedef struct girih_places {
    girih_place position, normal;
} girih_places;

static inline bool girih_same_normal(const girih_arrays *arrays, uint32_t corner_a,
                                     uint32_t corner_b) {
    const uint32_t *vertices = arrays->words[GIRIH_BIND_VERTICES];
    const size_t a = girih_word(arrays, GIRIH_BIND_TRIANGLE_VERTICES, corner_a);
    const size_t b = girih_word(arrays, GIRIH_BIND_TRIANGLE_VERTICES, corner_b);
    return memcmp(vertices + a * GIRIH_VERTEX_WORDS + 3, vertices + b * GIRIH_VERTEX_WORDS + 3,
                  3 * sizeof *vertices) == 0;
}

static inline girih_place girih_corner_place(uint32_t owner) {
    girih_place place = {.scene_triangle = owner / 3};
    place.weights[owner % 3] = GIRIH_SPLIT_ONE;
    return place;
}

// Edge n of a triangle runs from corner n to corner n + 1.
static inline uint32_t girih_edge_end(uint32_t edge) {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
}

static inline bool girih_edge_reversed(const girih_arrays *arrays, uint32_t edge) {
    return (girih_word(arrays, GIRIH_BIND_TRIANGLE_EDGES, edge) & GIRIH_EDGE_REVERSED) != 0;
}

// `first` and `second` weigh the ends of an edge in canonical order.
static inline girih_place girih_edge_place(const girih_arrays *arrays, uint32_t owner,
                                           uint32_t first, uint32_t second) {
    const bool reversed = girih_edge_reversed(arrays, owner);
    girih_place place = {.scene_triangle = owner / 3};
    place.weights[owner % 3] = reversed ? second : first;
    place.weights[girih_edge_end(owner) % 3] = reversed ? first : second;
    return place;
}

static inline girih_places girih_corner_places(const girih_arrays *arrays, uint32_t corner) {
    const size_t vertex = girih_word(arrays, GIRIH_BIND_TRIANGLE_VERTICES, corner);
    const size_t point = girih_word(arrays, GIRIH_BIND_POINTS, 2 * vertex);
    const uint32_t owner = girih_word(arrays, GIRIH_BIND_POINTS, 2 * point + 1);
    girih_places places = {girih_corner_place(owner), girih_corner_place(owner)};
    if (!girih_same_normal(arrays, corner, owner)) {
        places.normal = girih_corner_place(girih_word(arrays, GIRIH_BIND_POINTS, 2 * vertex + 1));
    }
    return places;
}

// The weights are the edge's first corner's and the next one's.
static inline girih_places girih_edge_places(const girih_arrays *arrays, uint32_t edge,
                                             uint32_t weight, uint32_t end_weight) {
    const bool reversed = girih_edge_reversed(arrays, edge);
    const uint32_t first = reversed ? end_weight : weight;
    const uint32_t second = reversed ? weight : end_weight;
    const size_t number = girih_word(arrays, GIRIH_BIND_TRIANGLE_EDGES, edge) & GIRIH_EDGE_MASK;
    const uint32_t owner = girih_word(arrays, GIRIH_BIND_EDGES, 2 * number + 1);
    const girih_place place = girih_edge_place(arrays, owner, first, second);
    girih_places places = {place, place};
    const bool same_way = reversed == girih_edge_reversed(arrays, owner);
    const uint32_t near = same_way ? owner : girih_edge_end(owner);
    const uint32_t far = same_way ? girih_edge_end(owner) : owner;
    if (!girih_same_normal(arrays, edge, near) ||
        !girih_same_normal(arrays, girih_edge_end(edge), far)) {
        const size_t weld_edge =
            girih_word(arrays, GIRIH_BIND_TRIANGLE_WELD_EDGES, edge) & GIRIH_WELD_MASK;
        places.normal = girih_edge_place(
            arrays, girih_word(arrays, GIRIH_BIND_WELD_EDGES, 2 * weld_edge + 1), first, second);
    }
    return places;
}

// `weights` of the triangle's corners in the order of the input.
static inline girih_places girih_find_places(const girih_arrays *arrays, uint32_t scene_triangle,
                                             const uint32_t weights[3]) {
    for (uint32_t n = 0; n < 3; ++n) {
        if (weights[n] == GIRIH_SPLIT_ONE) {
            return girih_corner_places(arrays, 3 * scene_triangle + n);
        }
    }
    for (uint32_t n = 0; n < 3; ++n) {
        if (weights[(n + 2) % 3] == 0) {
            return girih_edge_places(arrays, 3 * scene_triangle + n, weights[n],
                                     weights[(n + 1) % 3]);
        }
    }
    const girih_place inside = {scene_triangle, {weights[0], weights[1], weights[2]}};
    return (girih_places){inside, inside};
}

// What an own surface is given, with the base surface it stands on.
typedef struct girih_own_patch {
    girih_cpu_patch patch; // base points to the next
    girih_patch base;
    uint32_t scene_triangle;
} girih_own_patch;

static inline void girih_own_patch_make(const girih_arrays *arrays, const girih_cpu_desc *desc,
                                        uint32_t scene_triangle, uint32_t instance,
                                        girih_own_patch *own) {
    const girih_item item = {.scene_triangle = scene_triangle,
                             .instance = instance,
                             .corners = {0, 1, 2},
                             .edges = {0, 1, 2}};
    uint32_t vertices[3];
    girih_item_vertices(arrays, &item, vertices);
    girih_item_patch(arrays, &item, vertices, desc->base, &own->base);
    own->scene_triangle = scene_triangle;

    girih_cpu_patch *patch = &own->patch;
    const girih_vector position[3] = {own->base.b300, own->base.b030, own->base.b003};
    const girih_vector normal[3] = {own->base.n200, own->base.n020, own->base.n002};
    patch->mesh = desc->meshes[desc->instances[instance].mesh];
    patch->instance = instance;
    patch->triangle =
        scene_triangle - girih_instance_word(arrays, instance, GIRIH_INSTANCE_MESH_TRIANGLE);
    patch->material =
        girih_word(arrays, GIRIH_BIND_TRIANGLE_MATERIALS, scene_triangle) & GIRIH_MATERIAL_MASK;
    patch->scale = girih_word_float(girih_instance_word(arrays, instance, GIRIH_INSTANCE_SCALE));
    patch->transform = desc->instances[instance].transform;
    patch->base = &own->base;
    for (size_t n = 0; n < 3; ++n) {
        const girih_vector unit = girih_no_negative_zeros(girih_normalize(normal[n]));
        memcpy(patch->position[n], &position[n], sizeof patch->position[n]);
        memcpy(patch->normal[n], &unit, sizeof patch->normal[n]);
        patch->vertices[n] = patch->mesh->triangle_vertices[3 * (size_t)patch->triangle + n];
    }
}

static inline girih_vector girih_own_surface(const girih_cpu_desc *desc, const girih_own_patch *own,
                                             const float b[3]) {
    float position[3];
    desc->own(desc->own_user, &own->patch, b, position);
    return (girih_vector){position[0], position[1], position[2]};
}

static inline girih_vector girih_own_position(const girih_cpu_desc *desc,
                                              const girih_own_patch *own, const float b[3]) {
    return girih_no_negative_zeros(girih_own_surface(desc, own, b));
}

// The share for a patch: far from the origin, or where triangles are small, the rounding of
// coordinates must stay a hundredth of what lies between the points.
static inline float girih_own_normal_step(const girih_patch *base) {
    const girih_vector far =
        girih_max_vector(girih_max_vector(girih_absolute(base->b300), girih_absolute(base->b030)),
                         girih_absolute(base->b003));
    const girih_vector wide =
        girih_max_vector(girih_max_vector(girih_absolute(girih_subtract(base->b030, base->b300)),
                                          girih_absolute(girih_subtract(base->b003, base->b030))),
                         girih_absolute(girih_subtract(base->b300, base->b003)));
    const float size = fmaxf(fmaxf(far.x, far.y), far.z);
    const float extent = fmaxf(fmaxf(wide.x, wide.y), wide.z);
    // 128 units in the last place.
    const float wanted = extent > 0.0f ? size * (128.0f / 8388608.0f) / extent : 1.0f;
    return fmaxf(fminf(wanted, 0.25f), GIRIH_OWN_NORMAL_STEP);
}

// The base normal, turned as the surface turns against the base: the base's tangents are taken
// perpendicular to its normal, which need not be that of its own facets, and what the surface adds
// to the base is differentiated between three points around the place, which never leave the
// triangle.
static inline girih_vector girih_own_normal(const girih_cpu_desc *desc, const girih_own_patch *own,
                                            const float b[3]) {
    const girih_vector normal = girih_patch_unit_normal(&own->base, b[0], b[1], b[2]);
    girih_vector base[3];
    girih_vector added[3];
    const float share = girih_own_normal_step(&own->base);
    for (int n = 0; n < 3; ++n) {
        float near[3];
        for (int k = 0; k < 3; ++k) {
            near[k] = b[k] * (1.0f - share) + (k == n ? share : 0);
        }
        base[n] = girih_patch_position(&own->base, near[0], near[1], near[2]);
        added[n] = girih_subtract(girih_own_surface(desc, own, near), base[n]);
    }
    girih_vector along[2] = {girih_subtract(base[1], base[0]), girih_subtract(base[2], base[0])};
    // Mirrored, folded, or given with normals that oppose the winding: the normal decides. A
    // sliver, or a base that the normal lies in, cannot tell.
    const float facing = girih_dot(girih_cross(along[0], along[1]), normal);
    if (!(fabsf(facing) > 0.01f * girih_length_bound(along[0]) * girih_length_bound(along[1]))) {
        return normal;
    }
    for (int n = 0; n < 2; ++n) {
        const girih_vector tangent =
            girih_subtract(along[n], girih_scale(normal, girih_dot(along[n], normal)));
        along[n] = girih_add(tangent, girih_subtract(added[n + 1], added[0]));
    }
    const girih_vector turned = girih_normalize(girih_cross(along[0], along[1]));
    // A NaN ends up here too.
    if (!(girih_dot(turned, turned) > 0.5f)) {
        return normal;
    }
    return girih_no_negative_zeros(facing < 0.0f ? girih_negate(turned) : turned);
}

#endif
