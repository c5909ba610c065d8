// Stage 2: base pattern, lambda and winding of every triangle, or culled.
#ifndef GIRIH_SELECT_GLSL
#define GIRIH_SELECT_GLSL

#include "girih_permutation.h"
#include "pn_edges.glsl"
#include "culling.glsl"

void write_key(uint triangle) {
    uint instance = girih_find_instance(triangle, GIRIH_INSTANCE_FIRST_TRIANGLE, girih_frame.triangle_blocks);
    uint scene_triangle = triangle - girih_instance(instance, GIRIH_INSTANCE_TRIANGLE_DELTA);
    uint edge_delta = girih_instance(instance, GIRIH_INSTANCE_EDGE_DELTA);
    uint material = girih_has(GIRIH_VARIANT_MATERIALS) ? GIRIH_AT_TRIANGLE_MATERIALS(scene_triangle) : 0u;
    uint edges[3];
    for (uint n = 0u; n < 3u; ++n) {
        edges[n] = GIRIH_AT_TRIANGLE_EDGES(3u * scene_triangle + n);
    }
    if (girih_has(GIRIH_VARIANT_CULL)) {
        vec3 p[10];
        vec3 normals[3];
        vec3 corners[3];
        for (uint n = 0u; n < 3u; ++n) {
            uint vertex = GIRIH_AT_TRIANGLE_VERTICES(3u * scene_triangle + n);
            girih_vertex(vertex, 0u, corners[n], normals[n]);
            p[n] = corners[n];
        }
        int count = 3;
#if GIRIH_SURFACE == 1
        GirihPnPoints c = girih_pn_points(corners, normals, edges, girih_instance(instance, GIRIH_INSTANCE_SEAM_DELTA), 0u);
        p[3] = c.b210;
        p[4] = c.b120;
        p[5] = c.b021;
        p[6] = c.b012;
        p[7] = c.b102;
        p[8] = c.b201;
        p[9] = c.b111;
        count = 10;
#endif
        if (girih_culled(p, count, girih_instance_transform(instance, 0u), girih_instance_mirrored(instance),
                         (material & GIRIH_TWO_SIDED) != 0u)) {
            GIRIH_AT_KEYS(triangle) = GIRIH_KEY_CULLED;
            return;
        }
    }
    // Sort the levels and keep track of the swaps: ARKFPI, Figure 8.
    uint i = GIRIH_AT_LEVELS((edges[0] & GIRIH_EDGE_MASK) + edge_delta);
    uint j = GIRIH_AT_LEVELS((edges[1] & GIRIH_EDGE_MASK) + edge_delta);
    uint k = GIRIH_AT_LEVELS((edges[2] & GIRIH_EDGE_MASK) + edge_delta);
    uint lambda = 0u;
    uint swap;
    if (i < j) {
        swap = i;
        i = j;
        j = swap;
        lambda += 1u;
    }
    if (i < k) {
        swap = i;
        i = k;
        k = swap;
        lambda += 2u;
    }
    if (j < k) {
        swap = j;
        j = k;
        k = swap;
        lambda += 4u;
    }
    // An odd permutation turns the winding round, and so does a mirroring transform. Where two levels
    // are equal, permutations of either parity serve, so the one that keeps the winding is taken;
    // three distinct levels leave no choice and take the mirrored range.
    bool mirrored = girih_instance_mirrored(instance);
    uint range = 0u;
    if (i == j || j == k) {
        lambda = GIRIH_LAMBDA_EVEN(lambda);
        if (mirrored) {
            lambda = i == j ? GIRIH_LAMBDA_ODD_IJ(lambda) : GIRIH_LAMBDA_ODD_JK(lambda);
        }
    } else if ((GIRIH_LAMBDA_IS_ODD(lambda) != 0u) != mirrored) {
        range = 1u;
    }
    uint rank = i * (i + 1u) * (i + 2u) / 6u + j * (j + 1u) / 2u + k;
    range += girih_pattern(rank, GIRIH_PATTERN_RANGE);
    uint group = (material & GIRIH_MATERIAL_MASK) * girih_frame.range_count + range;
    GIRIH_AT_KEYS(triangle) = group << 3 | lambda;
}

#endif
