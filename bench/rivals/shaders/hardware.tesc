// Tessellation levels from the edges alone, and the patch.
//
// Invocation n works on the edge from corner n to the next. As girih's control points and levels do, its own depend on
// the edge alone, so that the neighbour gets the same.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "rival.glsl"
#include "hidden.glsl"
#define BENCH_CONTROL
#include "hardware.glsl"

layout(vertices = 3) out;

layout(location = 0) in vec3 corner_position[];
layout(location = 1) in vec3 corner_normal[];

void main() {
    int n = gl_InvocationID;
    int next = n == 2 ? 0 : n + 1;
    vec3 p = corner_position[n];
    vec3 q = corner_position[next];
    corners[gl_InvocationID].position = p;
    corners[gl_InvocationID].normal = corner_normal[n];
    // Outer level m is that of the edge opposite corner m.
    gl_TessLevelOuter[n == 0 ? 2 : n - 1] = float(girih_level_segments(bench_edge_level(p, q)));
#if GIRIH_CURVED == 1
    corners[gl_InvocationID].near_first = girih_pn_edge_point(p, q, corner_normal[n]);
    corners[gl_InvocationID].near_last = girih_pn_edge_point(q, p, corner_normal[next]);
    corners[gl_InvocationID].edge_normal = girih_pn_edge_normal(p, q, corner_normal[n], corner_normal[next]);
#endif
    barrier();
    if (n == 0) {
        // As fine inside as the finest edge asks for: the custom with this stage, and what girih's patterns are.
        gl_TessLevelInner[0] = max(max(gl_TessLevelOuter[0], gl_TessLevelOuter[1]), gl_TessLevelOuter[2]);
        vec3 points[10];
        for (int corner = 0; corner < 3; ++corner) {
            points[corner] = corners[corner].position;
        }
#if GIRIH_CURVED == 1
        GirihPnPoints c;
        c.b210 = corners[0].near_first;
        c.b120 = corners[0].near_last;
        c.b021 = corners[1].near_first;
        c.b012 = corners[1].near_last;
        c.b102 = corners[2].near_first;
        c.b201 = corners[2].near_last;
        girih_pn_centre(vec3[3](points[0], points[1], points[2]), c);
        inner_point = c.b111;
        for (int edge = 0; edge < 3; ++edge) {
            points[3 + 2 * edge] = corners[edge].near_first;
            points[4 + 2 * edge] = corners[edge].near_last;
        }
        points[9] = c.b111;
#endif
        if (bench_hidden(points)) {
            gl_TessLevelOuter[0] = 0.0; // hides the patch
        }
    }
}
