// For rivals' shaders: girih's own level rules and surfaces, without girih's arrays. GIRIH_SURFACE is 0
// (flat) or 1 (Curved PN triangles).
#ifndef BENCH_RIVAL_GLSL
#define BENCH_RIVAL_GLSL

#include "shared.h"
#include "view.glsl"

layout(std140, set = 0, binding = 1) uniform BenchFrame {
    GIRIH_FRAME_BLOCK(vec4, uvec4, uint, float)
} girih_frame;

#include "level_rules.glsl"
#include "pn.glsl"
#include "surfaces.glsl"

// The level of an edge; its ends in world space, which is mesh space too.
uint bench_edge_level(vec3 p, vec3 q) {
    bool clamped;
    return girih_edge_level(girih_frame.rule, p, q, clamped);
}

// The patch of a triangle without seams.
GirihPatch bench_patch(vec3 p[3], vec3 n[3]) {
    GirihPatch patch_;
    patch_.b300 = p[0];
    patch_.b030 = p[1];
    patch_.b003 = p[2];
    patch_.n200 = n[0];
    patch_.n020 = n[1];
    patch_.n002 = n[2];
#if GIRIH_CURVED == 1
    GirihPnPoints c;
    c.b210 = girih_pn_edge_point(p[0], p[1], n[0]);
    c.b120 = girih_pn_edge_point(p[1], p[0], n[1]);
    c.b021 = girih_pn_edge_point(p[1], p[2], n[1]);
    c.b012 = girih_pn_edge_point(p[2], p[1], n[2]);
    c.b102 = girih_pn_edge_point(p[2], p[0], n[2]);
    c.b201 = girih_pn_edge_point(p[0], p[2], n[0]);
    girih_pn_centre(p, c);
    patch_.b210 = c.b210;
    patch_.b120 = c.b120;
    patch_.b021 = c.b021;
    patch_.b012 = c.b012;
    patch_.b102 = c.b102;
    patch_.b201 = c.b201;
    patch_.b111 = c.b111;
    patch_.n110 = girih_pn_edge_normal(p[0], p[1], n[0], n[1]);
    patch_.n011 = girih_pn_edge_normal(p[1], p[2], n[1], n[2]);
    patch_.n101 = girih_pn_edge_normal(p[2], p[0], n[2], n[0]);
#endif
    return patch_;
}

#ifdef BENCH_LAST
// Puts out the patch's point at a barycentric.
void bench_surface_vertex(GirihPatch patch_, vec3 b) {
    bench_vertex(girih_patch_position(patch_, b.x, b.y, b.z), girih_patch_unit_normal(patch_, b.x, b.y, b.z));
}
#endif

#endif
