// A point of the patch. BENCH_SPACING: equal_spacing or fractional_odd_spacing.
//
// Both sides of an edge get the same bits without rounding gl_TessCoord: an outer edge's vertices depend on its level and
// the spacing alone, are symmetric about its middle, and 1 - x is exact for each coordinate x (Vulkan 1.3, "Tessellation
// Invariance", rules 2, 3 and 8); and girih's sums commute when the ends of an edge change roles.
#version 450
#extension GL_GOOGLE_include_directive : require

#define BENCH_LAST
#include "rival.glsl"
#include "hardware.glsl"

// With Vulkan's origin of the domain, the upper left, cw is what keeps the winding of the patch's corners.
layout(triangles, BENCH_SPACING, cw) in;

void main() {
    GirihPatch patch_;
    patch_.b300 = corners[0].position;
    patch_.b030 = corners[1].position;
    patch_.b003 = corners[2].position;
    patch_.n200 = corners[0].normal;
    patch_.n020 = corners[1].normal;
    patch_.n002 = corners[2].normal;
#if GIRIH_CURVED == 1
    patch_.b210 = corners[0].near_first;
    patch_.b120 = corners[0].near_last;
    patch_.b021 = corners[1].near_first;
    patch_.b012 = corners[1].near_last;
    patch_.b102 = corners[2].near_first;
    patch_.b201 = corners[2].near_last;
    patch_.b111 = inner_point;
    patch_.n110 = corners[0].edge_normal;
    patch_.n011 = corners[1].edge_normal;
    patch_.n101 = corners[2].edge_normal;
#endif
    bench_surface_vertex(patch_, gl_TessCoord);
}
