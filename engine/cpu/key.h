// Twin of glsl/key.glsl: from three edge levels to a key.
#ifndef GIRIH_ENGINE_CPU_KEY_H
#define GIRIH_ENGINE_CPU_KEY_H

#include <stdbool.h>

#include "girih_permutation.h"
#include "scene.h"

static inline void girih_swap(uint32_t *a, uint32_t *b) {
    const uint32_t old = *a;
    *a = *b;
    *b = old;
}

// Sorts three levels and keeps track of the swaps: lambda of ARKFPI, Figure 8.
static inline uint32_t girih_sort_levels(uint32_t levels[3]) {
    uint32_t lambda = 0;
    if (levels[0] < levels[1]) {
        girih_swap(&levels[0], &levels[1]);
        lambda += 1;
    }
    if (levels[0] < levels[2]) {
        girih_swap(&levels[0], &levels[2]);
        lambda += 2;
    }
    if (levels[1] < levels[2]) {
        girih_swap(&levels[1], &levels[2]);
        lambda += 4;
    }
    return lambda;
}

static inline uint32_t girih_rank(const uint32_t sorted[3]) {
    const uint32_t i = sorted[0];
    const uint32_t j = sorted[1];
    return i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + sorted[2];
}

// The key of a triangle, or of a part, with these levels, in an instance whose transform mirrors or
// does not. `material` is the triangle's word of TRIANGLE_MATERIALS.
static inline uint32_t girih_key(const girih_arrays *arrays, const uint32_t levels[3],
                                 uint32_t material, bool mirrored) {
    const uint32_t first_group = (material & GIRIH_MATERIAL_MASK) * arrays->frame.range_count;
    uint32_t sorted[3] = {levels[0], levels[1], levels[2]};
    uint32_t lambda = girih_sort_levels(sorted);
    if (sorted[0] >= arrays->frame.level_count) {
        return GIRIH_KEY_SPLIT | first_group << 3;
    }
    // An odd permutation turns the winding round, and so does a mirroring transform. Where two
    // levels are equal, permutations of either parity serve, so the one that keeps the winding is
    // taken; three distinct levels leave no choice and take the mirrored range.
    uint32_t range = 0;
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
        lambda = GIRIH_LAMBDA_EVEN(lambda);
        if (mirrored) {
            lambda =
                sorted[0] == sorted[1] ? GIRIH_LAMBDA_ODD_IJ(lambda) : GIRIH_LAMBDA_ODD_JK(lambda);
        }
    } else if (((GIRIH_LAMBDA_IS_ODD(lambda)) != 0) != mirrored) {
        range = 1;
    }
    range += girih_pattern(arrays, girih_rank(sorted), GIRIH_PATTERN_RANGE);
    return (first_group + range) << 3 | lambda;
}

#endif
