// The parts of split triangles, and where a part's pattern vertices lie in its root.
#ifndef GIRIH_PART_GLSL
#define GIRIH_PART_GLSL

#include "shared.h"

// The weights of the root's corners 1 and 2 at each of the part's corners, over GIRIH_SPLIT_ONE, and the segments of
// the root's edges.
struct GirihPart {
    uvec3 u;
    uvec3 v;
    uvec3 segments;
};

uvec3 girih_part_corner(GirihPart part, uint n) {
    return uvec3(part.u[n], part.v[n], GIRIH_SPLIT_ONE - part.u[n] - part.v[n]);
}

// A triangle that is its own only part.
GirihPart girih_whole_part(uvec3 segments) {
    return GirihPart(uvec3(GIRIH_SPLIT_ONE, 0u, 0u), uvec3(0u, GIRIH_SPLIT_ONE, 0u), segments);
}

// Where a frame is drawn at level 0, the first of a root's parts stands for the whole root, and the others are points
// that cannot be seen.
GirihPart girih_collapsed_part(bool first) {
    GirihPart part = girih_whole_part(uvec3(1u));
    if (!first) {
        part.u = uvec3(GIRIH_SPLIT_ONE / 2u);
        part.v = uvec3(GIRIH_SPLIT_ONE / 4u);
    }
    return part;
}

// The six words from GIRIH_SPLIT_CORNERS on.
GirihPart girih_unpack_part(uvec4 first, uvec2 last) {
    uvec3 u = uvec3(first.xz, last.x);
    uvec3 v = uvec3(first.yw, last.y);
    return GirihPart(u & GIRIH_SPLIT_WEIGHT_MASK, v & GIRIH_SPLIT_WEIGHT_MASK,
                     1u + (u >> GIRIH_SPLIT_WEIGHT_BITS | v >> GIRIH_SPLIT_WEIGHT_BITS << 8));
}

void girih_pack_part(GirihPart part, out uvec4 first, out uvec2 last) {
    uvec3 u = part.u | (part.segments - 1u & 0xffu) << GIRIH_SPLIT_WEIGHT_BITS;
    uvec3 v = part.v | (part.segments - 1u) >> 8 << GIRIH_SPLIT_WEIGHT_BITS;
    first = uvec4(u.x, v.x, u.y, v.y);
    last = uvec2(u.z, v.z);
}

// The same part with corner n where corner corners >> 2n was.
GirihPart girih_permuted_part(GirihPart part, uint corners) {
    GirihPart permuted = part;
    for (uint n = 0u; n < 3u; ++n) {
        uint corner = corners >> (2u * n) & 3u;
        permuted.u[n] = part.u[corner];
        permuted.v[n] = part.v[corner];
    }
    return permuted;
}

// The weight of an edge's end at vertex m of n segments, over 32768; alike from both ends (FORMULAS: t_m,
// t_{n-m} = 32768 - t_m).
uint girih_edge_weight(uint m, uint n) {
    uint near = 2u * m <= n ? m : n - m;
    uint t = (near * 65536u + n) / (2u * n);
    return 2u * m <= n ? t : 32768u - t;
}

// Which of n segments' vertices has this weight.
uint girih_edge_vertex(uint weight, uint n) {
    return weight * n + 16384u >> 15;
}

// How many of an edge's segments are before the vertex whose end weighs `weight`, where `count` parts of it have one
// each.
uint girih_part_steps(uint segments, uint count, uint weight) {
    return girih_edge_vertex(weight, count) * segments / count;
}

// The weights of the root's corners, over GIRIH_SPLIT_ONE, at a place in the part whose own corners weigh `weights`,
// over 32768. The place is a vertex of the part's own pattern, or, where `counts` are not 0, of one with so many
// segments on its edges, by which it is split.
//
// On an edge of the root that is a vertex of the whole edge's segments, as in a neighbour that is not split.
// Everywhere else it is the rounded mean of the corners, one formula for both parts at an edge: sums of integers do not
// ask which end comes first.
uvec3 girih_part_weights(GirihPart part, uvec3 weights, uvec3 counts) {
    // As two products over 2^7 and 2^15, so that none needs more than 32 bits.
    uvec3 u = part.u;
    uvec3 v = part.v;
    uvec2 high = uvec2((u.x >> 8) * weights.x + (u.y >> 8) * weights.y + (u.z >> 8) * weights.z,
                       (v.x >> 8) * weights.x + (v.y >> 8) * weights.y + (v.z >> 8) * weights.z);
    uvec2 low = uvec2((u.x & 255u) * weights.x + (u.y & 255u) * weights.y + (u.z & 255u) * weights.z,
                      (v.x & 255u) * weights.x + (v.y & 255u) * weights.y + (v.z & 255u) * weights.z);
    uvec2 mean = (high >> 7) + ((high & 127u) * 256u + low + 16384u >> 15);
    uvec3 result = uvec3(mean, GIRIH_SPLIT_ONE - mean.x - mean.y);
    bool found = false;
    for (uint edge = 0u; edge < 3u; ++edge) {
        uint next = edge == 2u ? 0u : edge + 1u;
        uint last = 3u - edge - next;
        if (weights[last] == 0u && !found) {
            uvec3 a = girih_part_corner(part, edge);
            uvec3 b = girih_part_corner(part, next);
            uvec3 either = a | b;
            // The corner of the root that is opposite to its edge.
            uint opposite = either.x == 0u ? 0u : either.y == 0u ? 1u : either.z == 0u ? 2u : 3u;
            if (opposite != 3u) {
                uint from = opposite == 2u ? 0u : opposite + 1u;
                uint to = 3u - opposite - from;
                uint whole = part.segments[from];
                uint begin = girih_edge_vertex(a[to] / GIRIH_SPLIT_UNIT, whole);
                uint end = girih_edge_vertex(b[to] / GIRIH_SPLIT_UNIT, whole);
                uint own = begin < end ? end - begin : begin - end;
                uint steps = girih_part_steps(own, counts[edge] == 0u ? own : counts[edge], weights[next]);
                uint t = girih_edge_weight(begin < end ? begin + steps : begin - steps, whole);
                result[opposite] = 0u;
                result[to] = t * GIRIH_SPLIT_UNIT;
                result[from] = GIRIH_SPLIT_ONE - t * GIRIH_SPLIT_UNIT;
                found = true;
            }
        }
    }
    return result;
}

#endif
