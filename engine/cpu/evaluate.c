// Stage 5 on the CPU: patches for the instanced mode, or the surface's points for the baked and
// welded modes. Twin of glsl/evaluate.glsl.
#include "attributes.h"
#include "own.h"
#include "points.h"

// Copied, not assigned as words: girih_cpu_output hands the same memory out as floats.
static void write_vector(uint32_t *words, girih_vector v) {
    const float values[3] = {v.x, v.y, v.z};
    memcpy(words, values, sizeof values);
}

// The corners in the order of the base pattern; 0 for a triangle that is not split.
static void write_part(const girih_arrays *arrays, uint32_t *words, const girih_item *item) {
    memset(words, 0, GIRIH_PATCH_WORDS_PART * sizeof *words);
    if (!item->is_part) {
        return;
    }
    const uint32_t corners = GIRIH_LAMBDA_CORNERS(item->lambda);
    const girih_part part = girih_item_part(arrays, item);
    girih_part permuted = part;
    for (uint32_t n = 0; n < 3; ++n) {
        memcpy(permuted.corners[n], part.corners[corners >> (2 * n) & 3],
               sizeof permuted.corners[n]);
    }
    girih_pack_corners(words, &permuted);
}

static void write_patch(girih_arrays *arrays, uint32_t number, girih_surface surface) {
    const girih_item item = girih_read_item(arrays, number);
    uint32_t vertices[3];
    girih_item_vertices(arrays, &item, vertices);
    girih_patch p;
    girih_item_patch(arrays, &item, vertices, surface, &p);
    const bool pn = surface == GIRIH_SURFACE_PN;
    const uint32_t part_words = arrays->frame.max_splits > 0 ? GIRIH_PATCH_WORDS_PART : 0;
    const uint32_t patch_words = (pn ? GIRIH_PATCH_WORDS_PN : GIRIH_PATCH_WORDS_FLAT) + part_words;
    uint32_t *words = arrays->words[GIRIH_BIND_OUT_ATTRIBUTES] + (size_t)number * patch_words;
    write_vector(words, p.b300);
    write_vector(words + 3, p.b030);
    write_vector(words + 6, p.b003);
    words += 9;
    if (pn) {
        write_vector(words, p.b210);
        write_vector(words + 3, p.b120);
        write_vector(words + 6, p.b021);
        write_vector(words + 9, p.b012);
        write_vector(words + 12, p.b102);
        write_vector(words + 15, p.b201);
        write_vector(words + 18, p.b111);
        words += 21;
    }
    write_vector(words, p.n200);
    write_vector(words + 3, p.n020);
    write_vector(words + 6, p.n002);
    words += 9;
    if (pn) {
        write_vector(words, p.n110);
        write_vector(words + 3, p.n011);
        write_vector(words + 6, p.n101);
        words += 9;
    }
    memcpy(words, vertices, sizeof vertices);
    const bool overflow =
        (girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_FLAGS) & GIRIH_STATUS_OVERFLOW) != 0;
    const uint32_t group =
        overflow ? item.group - item.group % arrays->frame.range_count : item.group;
    words[3] = group << 3 | item.lambda;
    if (part_words != 0) {
        write_part(arrays, words + (pn ? 4 : 6), &item);
    }
}

// Where a vertex goes: its position, and words of its normal followed by its attributes.
typedef struct target {
    uint32_t *position, *attributes;
} target;

static target find_target(const girih_arrays *arrays, uint32_t vertex) {
    return (target){arrays->words[GIRIH_BIND_OUT_POSITIONS] + (size_t)vertex * 3,
                    arrays->words[GIRIH_BIND_OUT_ATTRIBUTES] +
                        (size_t)vertex * arrays->frame.attribute_stride};
}

static void to_barycentric(const uint32_t weights[3], float b[3]) {
    for (int n = 0; n < 3; ++n) {
        b[n] = (float)weights[n] * (1.0f / (float)GIRIH_SPLIT_ONE);
    }
}

// An item's patches of the host's surface: its own, and the last one of another triangle.
typedef struct own_item {
    const girih_arrays *arrays;
    const girih_cpu_desc *desc;
    const girih_item *item;
    girih_own_patch own, other;
} own_item;

static const girih_own_patch *own_patch(own_item *surface, uint32_t scene_triangle) {
    if (scene_triangle == surface->own.scene_triangle) {
        return &surface->own;
    }
    if (scene_triangle != surface->other.scene_triangle) {
        girih_own_patch_make(surface->arrays, surface->desc, scene_triangle,
                             surface->item->instance, &surface->other);
    }
    return &surface->other;
}

static void begin_own(own_item *surface, const girih_arrays *arrays, const girih_cpu_desc *desc,
                      const girih_item *item) {
    surface->arrays = arrays;
    surface->desc = desc;
    surface->item = item;
    girih_own_patch_make(arrays, desc, item->scene_triangle, item->instance, &surface->own);
    surface->other.scene_triangle = item->scene_triangle;
}

// `permuted`: the weights of the item's corners.
static void write_own_point(own_item *surface, const uint32_t permuted[3], target out) {
    const girih_item *item = surface->item;
    uint32_t weights[3];
    for (uint32_t n = 0; n < 3; ++n) {
        weights[item->corners[n]] = permuted[n];
    }
    const girih_places places = girih_find_places(surface->arrays, item->scene_triangle, weights);
    float b[3];
    to_barycentric(places.position.weights, b);
    const girih_own_patch *owner = own_patch(surface, places.position.scene_triangle);
    write_vector(out.position, girih_own_position(surface->desc, owner, b));
    to_barycentric(places.normal.weights, b);
    owner = own_patch(surface, places.normal.scene_triangle);
    write_vector(out.attributes, girih_own_normal(surface->desc, owner, b));
}

static void write_own_points(girih_arrays *arrays, uint32_t number, const girih_cpu_desc *desc) {
    const girih_item item = girih_read_item(arrays, number);
    const uint32_t count = girih_group_word(arrays, item.group, GIRIH_GROUP_VERTICES);
    const uint32_t first =
        girih_group_word(arrays, item.group, GIRIH_GROUP_BASE_VERTEX) + number * count;
    const bool welded = arrays->frame.output_mode == GIRIH_OUTPUT_WELDED;
    uint32_t vertices[3];
    girih_item_vertices(arrays, &item, vertices);
    girih_weld weld = {{0}, {0}, {false}, {0}, 0};
    if (welded) {
        weld = girih_item_weld(arrays, &item, vertices, false);
    }
    girih_part part = {.root = 0};
    if (item.is_part) {
        part = girih_item_part(arrays, &item);
    }
    own_item surface;
    begin_own(&surface, arrays, desc, &item);
    const uint32_t *pattern_vertices =
        arrays->words[GIRIH_BIND_PATTERN_VERTICES] +
        girih_group_word(arrays, item.group, GIRIH_GROUP_PATTERN_VERTEX);
    for (uint32_t n = 0; n < count; ++n) {
        const target out = find_target(arrays, welded ? girih_weld_vertex(&weld, n) : first + n);
        uint32_t weights[3];
        girih_item_weights(&item, &part, pattern_vertices[n], weights);
        float b[3];
        to_barycentric(weights, b);
        write_own_point(&surface, weights, out);
        girih_write_attributes(arrays, vertices, b, (float *)(void *)(out.attributes + 3));
    }
}

void girih_twin_evaluate(girih_arrays *arrays, girih_surface surface) {
    if (arrays->frame.output_mode != GIRIH_OUTPUT_INSTANCED) {
        girih_twin_points(arrays, surface);
        return;
    }
    const uint32_t items = girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_ITEMS);
    for (uint32_t number = 0; number < items; ++number) {
        write_patch(arrays, number, surface);
    }
}

void girih_twin_evaluate_own(girih_arrays *arrays, const girih_cpu_desc *desc) {
    const uint32_t items = girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_ITEMS);
    for (uint32_t number = 0; number < items; ++number) {
        write_own_points(arrays, number, desc);
    }
}

void girih_cpu_base_position(const girih_cpu_patch *patch, const float barycentric[3],
                             float position[3]) {
    const girih_vector p =
        girih_patch_position(patch->base, barycentric[0], barycentric[1], barycentric[2]);
    memcpy(position, &p, sizeof p);
}

void girih_cpu_base_normal(const girih_cpu_patch *patch, const float barycentric[3],
                           float normal[3]) {
    const girih_vector n =
        girih_patch_unit_normal(patch->base, barycentric[0], barycentric[1], barycentric[2]);
    memcpy(normal, &n, sizeof n);
}

void girih_cpu_displacement(const girih_cpu_patch *patch, const float normal[3], float height,
                            float offset[3]) {
    const float *t = patch->transform;
    // World normals are mesh normals times the inverse transpose; its inverse is the transpose.
    girih_vector mesh = {
        (t[0] * normal[0] + t[4] * normal[1]) + t[8] * normal[2],
        (t[1] * normal[0] + t[5] * normal[1]) + t[9] * normal[2],
        (t[2] * normal[0] + t[6] * normal[1]) + t[10] * normal[2],
    };
    mesh = girih_normalize(mesh);
    for (size_t n = 0; n < 3; ++n) {
        const girih_vector row = {t[4 * n], t[4 * n + 1], t[4 * n + 2]};
        offset[n] = girih_dot(row, mesh) * height;
    }
}
