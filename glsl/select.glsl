// Stage 2: base pattern, lambda and winding of every triangle, or culled.
#ifndef GIRIH_SELECT_GLSL
#define GIRIH_SELECT_GLSL

#include "key.glsl"
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
    uvec3 levels;
    for (uint n = 0u; n < 3u; ++n) {
        levels[n] = GIRIH_AT_LEVELS((edges[n] & GIRIH_EDGE_MASK) + edge_delta);
    }
    GIRIH_AT_KEYS(triangle) = girih_key(levels, material, girih_instance_mirrored(instance));
}

#endif
