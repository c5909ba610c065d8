// A mesh in the making: what the steps of mesh preparation hand to one another.
#ifndef GIRIH_ENGINE_MESH_BUILD_H
#define GIRIH_ENGINE_MESH_BUILD_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "girih/mesh.h"

#define GIRIH_NONE UINT32_MAX

// A corner is a triangle's number times 3 plus 0, 1 or 2. The half-edge of a corner runs from it to
// the next corner of the same triangle.
typedef struct girih_mesh_build {
    const girih_mesh_desc *desc;
    girih_mesh *mesh; // its counts are kept up to date; its arrays are those below, set at the end

    float *positions;
    float *normals;
    float *attributes;
    uint32_t *vertex_source;
    uint32_t *vertex_point;
    uint32_t *triangle_vertices;
    uint32_t *triangle_edges;
    uint32_t *triangle_weld_edges;
    uint32_t *triangle_source;
    uint32_t *edge_points;
    uint32_t *seams;
    uint32_t *weld_edge_edge;
    uint32_t *edge_weld_edge;
    uint8_t *edge_uses;
    uint32_t *edge_owner;
    uint32_t *weld_edge_owner;
    uint32_t *vertex_owner;
    girih_submesh *submeshes;

    // Not in the mesh.
    uint32_t *corner_points;   // [3 * triangle_count]
    uint32_t *edge_half_edges; // [edge_count][2] its first two half-edges
} girih_mesh_build;

static inline uint32_t girih_next_corner(uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline uint32_t girih_float_bits(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

// -0 as +0. On the bits, because compilers fold `x + 0.0f` and comparisons cannot tell the two
// apart.
static inline float girih_positive_zero(float value) {
    return girih_float_bits(value) == 0x80000000u ? 0.0f : value;
}

static inline bool girih_same_bits(const float *a, const float *b) {
    return memcmp(a, b, 3 * sizeof *a) == 0;
}

// A hash of three floats by their bits, seeded. (The finisher of MurmurHash3 mixes the words.)
static inline uint64_t girih_hash_point(const float *point, uint32_t seed) {
    uint64_t hash = seed;
    for (int axis = 0; axis < 3; ++axis) {
        hash = (hash ^ girih_float_bits(point[axis])) * UINT64_C(0xff51afd7ed558ccd);
        hash ^= hash >> 33;
    }
    return hash * UINT64_C(0xc4ceb9fe1a85ec53) >> 20;
}

// The smallest power of two of at least twice count: the slots of a hash table for count entries.
static inline size_t girih_hash_slots(uint32_t count) {
    size_t slots = 2;
    while (slots / 2 < count) {
        slots *= 2;
    }
    return slots;
}

// In: for every item the number of an earlier item of its class, or its own where it is the first.
// Out: the number of its class, classes being numbered in the order of their first items. Returns
// the number of classes.
static inline uint32_t girih_number_classes(uint32_t *items, uint32_t count) {
    uint32_t classes = 0;
    for (uint32_t item = 0; item < count; ++item) {
        items[item] = items[item] == item ? classes++ : items[items[item]];
    }
    return classes;
}

#endif
