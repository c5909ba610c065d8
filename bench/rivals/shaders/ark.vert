// A vertex of an adaptive pattern on the triangle whose positions and normals are the draw's uniforms.
#version 450
#extension GL_GOOGLE_include_directive : require

#define BENCH_LAST
#include "rival.glsl"

layout(location = 0) in uint pattern_vertex; // u | v << 16, over 32768, by the triangle's own corners

layout(push_constant) uniform Triangle {
    float corners[18]; // three positions, three normals
} triangle;

vec3 triangle_vector(int n) {
    return vec3(triangle.corners[3 * n], triangle.corners[3 * n + 1], triangle.corners[3 * n + 2]);
}

void main() {
    vec3 positions[3] = vec3[3](triangle_vector(0), triangle_vector(1), triangle_vector(2));
    vec3 normals[3] = vec3[3](triangle_vector(3), triangle_vector(4), triangle_vector(5));
    uint u = pattern_vertex & 0xffffu;
    uint v = pattern_vertex >> 16;
    bench_surface_vertex(bench_patch(positions, normals), girih_barycentric(uvec3(u, v, 32768u - u - v)));
}
