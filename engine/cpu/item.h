// Twin of glsl/patch.glsl: from a sorted item to its patch, the corners permuted by lambda, the
// control points in world space.
#ifndef GIRIH_ENGINE_CPU_ITEM_H
#define GIRIH_ENGINE_CPU_ITEM_H

#include <stdbool.h>

#include "girih_permutation.h"
#include "part.h"
#include "pn.h"
#include "surfaces.h"

// One item as evaluate and output see it.
typedef struct girih_item {
    uint32_t number; // of the sorted items
    uint32_t scene_triangle;
    uint32_t instance;
    uint32_t group;
    uint32_t rank;
    bool mirrored; // uses its pattern's mirrored range
    uint32_t lambda;
    bool is_part;        // of a split triangle
    uint32_t part;       // then: its number
    uint32_t corners[3]; // input corner 0..2 at each of the base pattern's corners
    uint32_t edges[3];   // input edge 0..2 at each of the base pattern's edges
    bool odd;            // the base pattern's edges run against the input's
    // A part's points are evaluated in its root, whose corners and edges stay in the input's order.
} girih_item;

static inline girih_item girih_read_item(const girih_arrays *arrays, uint32_t number) {
    const uint32_t *words = arrays->words[GIRIH_BIND_ITEMS] + (size_t)number * GIRIH_ITEM_WORDS;
    uint32_t triangle = words[GIRIH_ITEM_TRIANGLE];
    const uint32_t key = words[GIRIH_ITEM_KEY];
    girih_item item;
    item.number = number;
    item.is_part = triangle >= arrays->frame.triangle_count;
    item.part = triangle - arrays->frame.triangle_count;
    if (item.is_part) {
        triangle = girih_word(arrays, GIRIH_BIND_SPLITS,
                              (size_t)item.part * GIRIH_SPLIT_WORDS + GIRIH_SPLIT_ROOT);
    }
    item.instance = girih_find_instance(arrays, triangle, GIRIH_INSTANCE_FIRST_TRIANGLE,
                                        arrays->frame.triangle_blocks);
    item.scene_triangle =
        triangle - girih_instance_word(arrays, item.instance, GIRIH_INSTANCE_TRIANGLE_DELTA);
    item.group = key >> 3;
    item.lambda = key & 7;
    if ((girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_FLAGS) & GIRIH_STATUS_OVERFLOW) != 0) {
        // Drawn at level 0: base pattern [0,0,0], whose permutation only has to keep the winding.
        const bool mirror = (girih_instance_word(arrays, item.instance, GIRIH_INSTANCE_FLAGS) &
                             GIRIH_INSTANCE_MIRRORED) != 0;
        item.lambda = mirror ? GIRIH_LAMBDA_ODD_IJ(0u) : 0;
    }
    const uint32_t rank = girih_group_word(arrays, item.group, GIRIH_GROUP_RANK);
    item.rank = rank & ~GIRIH_GROUP_MIRRORED;
    item.mirrored = (rank & GIRIH_GROUP_MIRRORED) != 0;
    const uint32_t placed = item.is_part ? 0 : item.lambda;
    const uint32_t corners = GIRIH_LAMBDA_CORNERS(placed);
    const uint32_t edges = GIRIH_LAMBDA_EDGES(placed);
    for (uint32_t n = 0; n < 3; ++n) {
        item.corners[n] = corners >> (2 * n) & 3;
        item.edges[n] = edges >> (2 * n) & 3;
    }
    item.odd = (GIRIH_LAMBDA_IS_ODD(placed)) != 0;
    return item;
}

// The part that an item is, as it is drawn.
static inline girih_part girih_item_part(const girih_arrays *arrays, const girih_item *item) {
    girih_part part = girih_read_part(arrays, item->part);
    if ((girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_FLAGS) & GIRIH_STATUS_OVERFLOW) != 0) {
        girih_collapse_part(&part);
    }
    return part;
}

// The weights, over GIRIH_SPLIT_ONE, of the item's corners at a vertex of its pattern (a word of
// PATTERN_VERTICES): of the triangle permuted by lambda, or of a part's root in the input's order.
// `part` is the item's, if it is one.
static inline void girih_item_weights(const girih_item *item, const girih_part *part, uint32_t word,
                                      uint32_t result[3]) {
    const uint32_t u = word & 0xffff;
    const uint32_t v = word >> 16;
    const uint32_t weights[3] = {u, v, 32768 - u - v};
    if (!item->is_part) {
        for (uint32_t n = 0; n < 3; ++n) {
            result[n] = weights[n] * GIRIH_SPLIT_UNIT;
        }
        return;
    }
    const uint32_t corners = GIRIH_LAMBDA_CORNERS(item->lambda);
    uint32_t own[3];
    for (uint32_t n = 0; n < 3; ++n) {
        own[corners >> (2 * n) & 3] = weights[n];
    }
    girih_part_weights(part, own, NULL, result);
}

static inline void girih_item_vertices(const girih_arrays *arrays, const girih_item *item,
                                       uint32_t vertices[3]) {
    for (uint32_t n = 0; n < 3; ++n) {
        vertices[n] = girih_word(arrays, GIRIH_BIND_TRIANGLE_VERTICES,
                                 3 * (size_t)item->scene_triangle + item->corners[n]);
    }
}

// The words of the item's edges, with their reversal relative to the base pattern's direction.
static inline void girih_item_edges(const girih_arrays *arrays, const girih_item *item,
                                    uint32_t edges[3]) {
    for (uint32_t n = 0; n < 3; ++n) {
        edges[n] = girih_word(arrays, GIRIH_BIND_TRIANGLE_EDGES,
                              3 * (size_t)item->scene_triangle + item->edges[n]);
        if (item->odd) {
            edges[n] ^= GIRIH_EDGE_REVERSED;
        }
    }
}

// From corners p and normals n in mesh space to the patch in world space.
static inline void girih_place_flat(const girih_vector p[3], const girih_vector n[3],
                                    const girih_transform *t, const girih_transform *nt,
                                    girih_patch *patch) {
    patch->b300 = girih_transform_point(t, p[0]);
    patch->b030 = girih_transform_point(t, p[1]);
    patch->b003 = girih_transform_point(t, p[2]);
    patch->n200 = girih_transform_point(nt, n[0]);
    patch->n020 = girih_transform_point(nt, n[1]);
    patch->n002 = girih_transform_point(nt, n[2]);
}

// What a PN patch has beside that.
static inline void girih_place_curve(const girih_vector p[3], const girih_vector n[3],
                                     const girih_pn_points *c, const girih_transform *t,
                                     const girih_transform *nt, girih_patch *patch) {
    patch->b210 = girih_transform_point(t, c->b210);
    patch->b120 = girih_transform_point(t, c->b120);
    patch->b021 = girih_transform_point(t, c->b021);
    patch->b012 = girih_transform_point(t, c->b012);
    patch->b102 = girih_transform_point(t, c->b102);
    patch->b201 = girih_transform_point(t, c->b201);
    patch->b111 = girih_transform_point(t, c->b111);
    patch->n110 = girih_transform_point(nt, girih_pn_edge_normal(p[0], p[1], n[0], n[1]));
    patch->n011 = girih_transform_point(nt, girih_pn_edge_normal(p[1], p[2], n[1], n[2]));
    patch->n101 = girih_transform_point(nt, girih_pn_edge_normal(p[2], p[0], n[2], n[0]));
}

static inline void girih_item_patch(const girih_arrays *arrays, const girih_item *item,
                                    const uint32_t vertices[3], girih_surface surface,
                                    girih_patch *patch) {
    girih_vector p[3];
    girih_vector n[3];
    for (uint32_t corner = 0; corner < 3; ++corner) {
        p[corner] = girih_vertex_position(arrays, vertices[corner]);
        n[corner] = girih_vertex_normal(arrays, vertices[corner]);
    }
    const girih_transform t = girih_instance_transform(arrays, item->instance);
    const girih_transform nt = girih_instance_normal_transform(arrays, item->instance);
    patch->surface = surface;
    girih_place_flat(p, n, &t, &nt, patch);
    if (surface == GIRIH_SURFACE_PN) {
        uint32_t edges[3];
        girih_item_edges(arrays, item, edges);
        const girih_pn_points c = girih_make_pn_points(
            arrays, p, n, edges,
            girih_instance_word(arrays, item->instance, GIRIH_INSTANCE_SEAM_DELTA));
        girih_place_curve(p, n, &c, &t, &nt, patch);
    }
}

// Where a base pattern's vertices go when points are shared (GIRIH_OUTPUT_WELDED).
typedef struct girih_weld {
    uint32_t corners[3]; // output vertex of each corner
    uint32_t edges[3];   // output vertex of the first inner vertex of each edge, in canonical order
    bool reversed[3];    // the pattern runs along the edge against the canonical order
    uint32_t segments[3];
    uint32_t interior; // output vertex of the first interior vertex
} girih_weld;

// `closed`: by position alone, through the vertex and weld edge that stand for all at one place.
static inline girih_weld girih_item_weld(const girih_arrays *arrays, const girih_item *item,
                                         const uint32_t vertices[3], bool closed) {
    girih_weld weld;
    const uint32_t vertex_delta =
        girih_instance_word(arrays, item->instance, GIRIH_INSTANCE_VERTEX_DELTA);
    const uint32_t weld_delta =
        girih_instance_word(arrays, item->instance, GIRIH_INSTANCE_WELD_DELTA);
    uint32_t border = 0;
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t word = girih_word(arrays, GIRIH_BIND_TRIANGLE_WELD_EDGES,
                                         3 * (size_t)item->scene_triangle + item->edges[n]);
        uint32_t edge = word & GIRIH_WELD_MASK;
        uint32_t vertex = vertices[n];
        if (closed) {
            edge =
                girih_word(arrays, GIRIH_BIND_EDGES,
                           2 * (size_t)girih_word(arrays, GIRIH_BIND_WELD_EDGES, 2 * (size_t)edge));
            vertex = girih_word(arrays, GIRIH_BIND_POINTS, 2 * (size_t)vertex);
        }
        weld.corners[n] = vertex + vertex_delta;
        weld.edges[n] = arrays->frame.corner_count +
                        girih_word(arrays, GIRIH_BIND_WELD_OFFSETS, edge + weld_delta);
        weld.reversed[n] = ((word & GIRIH_WELD_REVERSED) != 0) != item->odd;
        weld.segments[n] = girih_pattern(arrays, item->rank, GIRIH_PATTERN_SEGMENTS + n);
        border += weld.segments[n];
    }
    const uint32_t interior = girih_group_word(arrays, item->group, GIRIH_GROUP_VERTICES) - border;
    weld.interior =
        girih_group_word(arrays, item->group, GIRIH_GROUP_BASE_VERTEX) + item->number * interior;
    return weld;
}

// The output vertex of the base pattern's vertex n: corners, inner vertices of edges 1, 2, 3,
// interior.
static inline uint32_t girih_weld_vertex(const girih_weld *weld, uint32_t n) {
    if (n < 3) {
        return weld->corners[n];
    }
    n -= 3;
    for (uint32_t edge = 0; edge < 3; ++edge) {
        const uint32_t inner = weld->segments[edge] - 1;
        if (n < inner) {
            return weld->edges[edge] + (weld->reversed[edge] ? inner - 1 - n : n);
        }
        n -= inner;
    }
    return weld->interior + n;
}

#endif
