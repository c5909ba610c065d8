// Twin of glsl/part.glsl: the parts of split triangles, and where a part's pattern vertices lie in
// its root.
#ifndef GIRIH_ENGINE_CPU_PART_H
#define GIRIH_ENGINE_CPU_PART_H

#include "scene.h"

#include <stdbool.h>

// A part, or a triangle that is not split: then the corners are its own.
typedef struct girih_part {
    uint32_t root; // the plan's triangle
    uint32_t levels[3];
    bool first;             // of the root's parts
    uint32_t segments[3];   // of the root's edges
    uint32_t corners[3][3]; // weights of the root's corners, over GIRIH_SPLIT_ONE
} girih_part;

static inline uint32_t girih_level_segments(const girih_frame_block *frame, uint32_t level) {
    return frame->linear_spacing != 0 ? level + 1 : 1u << level;
}

// The weight of an edge's end at vertex m of n segments, over 32768; alike from both ends
// (FORMULAS: t_m, t_{n-m} = 32768 - t_m).
static inline uint32_t girih_edge_weight(uint32_t m, uint32_t n) {
    const uint32_t near = 2 * m <= n ? m : n - m;
    const uint32_t t = (near * 65536u + n) / (2 * n);
    return 2 * m <= n ? t : 32768u - t;
}

// Which of n segments' vertices has this weight.
static inline uint32_t girih_edge_vertex(uint32_t weight, uint32_t n) {
    return (weight * n + 16384u) >> 15;
}

static inline girih_part girih_read_part(const girih_arrays *arrays, uint32_t number) {
    const uint32_t *words = arrays->words[GIRIH_BIND_SPLITS] + (size_t)number * GIRIH_SPLIT_WORDS;
    girih_part part = {.root = words[GIRIH_SPLIT_ROOT],
                       .levels = {words[GIRIH_SPLIT_LEVELS] & 0xffff,
                                  words[GIRIH_SPLIT_LEVELS] >> 16,
                                  words[GIRIH_SPLIT_LEVELS + 1] & 0xffff},
                       .first = (words[GIRIH_SPLIT_LEVELS + 1] & GIRIH_SPLIT_FIRST) != 0};
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t *pair = words + GIRIH_SPLIT_CORNERS + 2 * n;
        const uint32_t u = pair[0] & GIRIH_SPLIT_WEIGHT_MASK;
        const uint32_t v = pair[1] & GIRIH_SPLIT_WEIGHT_MASK;
        part.corners[n][0] = u;
        part.corners[n][1] = v;
        part.corners[n][2] = GIRIH_SPLIT_ONE - u - v;
        part.segments[n] =
            1 + (pair[0] >> GIRIH_SPLIT_WEIGHT_BITS | pair[1] >> GIRIH_SPLIT_WEIGHT_BITS << 8);
    }
    return part;
}

// Six words from GIRIH_SPLIT_CORNERS on.
static inline void girih_pack_corners(uint32_t *words, const girih_part *part) {
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t inner = part->segments[n] - 1;
        words[2 * n] = part->corners[n][0] | (inner & 0xff) << GIRIH_SPLIT_WEIGHT_BITS;
        words[2 * n + 1] = part->corners[n][1] | inner >> 8 << GIRIH_SPLIT_WEIGHT_BITS;
    }
}

static inline void girih_write_part(girih_arrays *arrays, uint32_t number, const girih_part *part) {
    uint32_t *words = arrays->words[GIRIH_BIND_SPLITS] + (size_t)number * GIRIH_SPLIT_WORDS;
    memset(words, 0, GIRIH_SPLIT_WORDS * sizeof *words);
    words[GIRIH_SPLIT_ROOT] = part->root;
    words[GIRIH_SPLIT_LEVELS] = part->levels[0] | part->levels[1] << 16;
    words[GIRIH_SPLIT_LEVELS + 1] = part->levels[2] | (part->first ? GIRIH_SPLIT_FIRST : 0);
    girih_pack_corners(words + GIRIH_SPLIT_CORNERS, part);
}

// Where a frame is drawn at level 0, the first of a root's parts stands for the whole root, and the
// others are points that cannot be seen.
static inline void girih_collapse_part(girih_part *part) {
    for (uint32_t n = 0; n < 3; ++n) {
        part->levels[n] = 0;
        part->segments[n] = 1;
        for (uint32_t corner = 0; corner < 3; ++corner) {
            if (part->first) {
                part->corners[n][corner] = corner == n ? GIRIH_SPLIT_ONE : 0;
            } else {
                part->corners[n][corner] = corner == 0 ? GIRIH_SPLIT_ONE / 2 : GIRIH_SPLIT_ONE / 4;
            }
        }
    }
}

// Whether a part's edge lies on an edge of the root: which corner of the root is opposite to it; 3:
// none.
static inline uint32_t girih_part_border(const girih_part *part, uint32_t edge) {
    const uint32_t *a = part->corners[edge];
    const uint32_t *b = part->corners[(edge + 1) % 3];
    for (uint32_t n = 0; n < 3; ++n) {
        if ((a[n] | b[n]) == 0) {
            return n;
        }
    }
    return 3;
}

// How many of an edge's segments are before the vertex whose end weighs `weight`, where `count`
// parts of it have one each.
static inline uint32_t girih_part_steps(uint32_t segments, uint32_t count, uint32_t weight) {
    return girih_edge_vertex(weight, count) * segments / count;
}

// The weights of the root's corners, over GIRIH_SPLIT_ONE, at a place in the part whose own corners
// weigh `weights`, over 32768. The place is a vertex of the part's own pattern, or of one with
// `counts` segments on its edges, by which it is split.
//
// On an edge of the root that is a vertex of the whole edge's segments, as in a neighbour that is
// not split. Everywhere else it is the rounded mean of the corners, one formula for both parts at
// an edge: sums of integers do not ask which end comes first.
static inline void girih_part_weights(const girih_part *part, const uint32_t weights[3],
                                      const uint32_t *counts, uint32_t result[3]) {
    for (uint32_t edge = 0; edge < 3; ++edge) {
        const uint32_t next = (edge + 1) % 3;
        const uint32_t opposite = girih_part_border(part, edge);
        if (weights[(edge + 2) % 3] != 0 || opposite == 3) {
            continue;
        }
        const uint32_t from = (opposite + 1) % 3;
        const uint32_t to = (opposite + 2) % 3;
        const uint32_t whole = part->segments[from];
        const uint32_t begin = girih_edge_vertex(part->corners[edge][to] / GIRIH_SPLIT_UNIT, whole);
        const uint32_t end = girih_edge_vertex(part->corners[next][to] / GIRIH_SPLIT_UNIT, whole);
        const uint32_t own = begin < end ? end - begin : begin - end;
        const uint32_t steps = girih_part_steps(own, counts ? counts[edge] : own, weights[next]);
        const uint32_t t = girih_edge_weight(begin < end ? begin + steps : begin - steps, whole);
        result[opposite] = 0;
        result[to] = t * GIRIH_SPLIT_UNIT;
        result[from] = GIRIH_SPLIT_ONE - t * GIRIH_SPLIT_UNIT;
        return;
    }
    for (uint32_t n = 0; n < 2; ++n) {
        uint32_t high = 0;
        uint32_t low = 0;
        for (uint32_t corner = 0; corner < 3; ++corner) {
            high += (part->corners[corner][n] >> 8) * weights[corner];
            low += (part->corners[corner][n] & 255u) * weights[corner];
        }
        result[n] = (high >> 7) + (((high & 127u) * 256u + low + 16384u) >> 15);
    }
    result[2] = GIRIH_SPLIT_ONE - result[0] - result[1];
}

#endif
