// From three edge levels to a key.
#ifndef GIRIH_KEY_GLSL
#define GIRIH_KEY_GLSL

#include "girih_permutation.h"
#include "arrays.glsl"

// Sorts three levels and keeps track of the swaps: lambda of ARKFPI, Figure 8.
uint girih_sort_levels(inout uvec3 levels) {
    uint lambda = 0u;
    if (levels.x < levels.y) {
        levels = levels.yxz;
        lambda += 1u;
    }
    if (levels.x < levels.z) {
        levels = levels.zyx;
        lambda += 2u;
    }
    if (levels.y < levels.z) {
        levels = levels.xzy;
        lambda += 4u;
    }
    return lambda;
}

uint girih_rank(uvec3 sorted_) {
    return sorted_.x * (sorted_.x + 1u) * (sorted_.x + 2u) / 6u + sorted_.y * (sorted_.y + 1u) / 2u + sorted_.z;
}

// The key of a triangle, or of a part, with these levels, in an instance whose transform mirrors or does not.
// `material` is the triangle's word of TRIANGLE_MATERIALS.
uint girih_key(uvec3 levels, uint material, bool mirrored) {
    uint first_group = (material & GIRIH_MATERIAL_MASK) * girih_frame.range_count;
    uint lambda = girih_sort_levels(levels);
    if (girih_has(GIRIH_VARIANT_SPLITS) && levels.x >= girih_frame.level_count) {
        return GIRIH_KEY_SPLIT | first_group << 3;
    }
    // An odd permutation turns the winding round, and so does a mirroring transform. Where two levels
    // are equal, permutations of either parity serve, so the one that keeps the winding is taken;
    // three distinct levels leave no choice and take the mirrored range.
    uint range = 0u;
    if (levels.x == levels.y || levels.y == levels.z) {
        lambda = GIRIH_LAMBDA_EVEN(lambda);
        if (mirrored) {
            lambda = levels.x == levels.y ? GIRIH_LAMBDA_ODD_IJ(lambda) : GIRIH_LAMBDA_ODD_JK(lambda);
        }
    } else if ((GIRIH_LAMBDA_IS_ODD(lambda) != 0u) != mirrored) {
        range = 1u;
    }
    range += girih_pattern(girih_rank(levels), GIRIH_PATTERN_RANGE);
    return (first_group + range) << 3 | lambda;
}

#endif
