// Whether a triangle of a flat surface is hidden, by girih's own test: outside the view, or facing away, as the frame
// asks. Curved triangles never count as hidden. Include it after rival.glsl.
#ifndef BENCH_HIDDEN_GLSL
#define BENCH_HIDDEN_GLSL

#include "culling.glsl"

bool bench_hidden(vec3 p[3]) {
    bool hidden = false;
#if GIRIH_SURFACE == 0
    const GirihTransform world = GirihTransform(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
    vec3 corners[10];
    for (int n = 0; n < 3; ++n) {
        corners[n] = p[n];
    }
    // No turn or one: a CPU device would run a branch's body in any case.
    for (uint turn = 0u; turn < min(girih_frame.cull, 1u); ++turn) {
        hidden = girih_culled(corners, 3, world, false, false);
    }
#endif
    return hidden;
}

#endif
