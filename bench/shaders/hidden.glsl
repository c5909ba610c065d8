// Whether a triangle is hidden, by girih's own bounds: outside the view, or facing away, as the frame asks. Include it
// after rival.glsl.
#ifndef BENCH_HIDDEN_GLSL
#define BENCH_HIDDEN_GLSL

#include "culling.glsl"

// From its corners and, where the surface is curved, the other control points in girih_culled's order.
bool bench_hidden(vec3 points[10]) {
    const GirihTransform world = GirihTransform(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
    return girih_frame.cull != 0u && girih_culled(points, GIRIH_CURVED == 1 ? 10 : 3, world, false, false);
}

bool bench_hidden(vec3 p[3], vec3 n[3]) {
    vec3 points[10];
    points[0] = p[0];
    points[1] = p[1];
    points[2] = p[2];
#if GIRIH_CURVED == 1
    GirihPatch patch_ = bench_patch(p, n);
    points[3] = patch_.b210;
    points[4] = patch_.b120;
    points[5] = patch_.b021;
    points[6] = patch_.b012;
    points[7] = patch_.b102;
    points[8] = patch_.b201;
    points[9] = patch_.b111;
#endif
    return bench_hidden(points);
}

#endif
