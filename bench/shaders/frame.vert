// One vertex of girih's, or of the static mesh: position and normal from buffers.
#version 450
#extension GL_GOOGLE_include_directive : require

#define BENCH_LAST
#include "girih.glsl"
#include "view.glsl"

void main() {
    GirihPoint point = girih_point();
    bench_vertex(point.position, point.normal);
}
