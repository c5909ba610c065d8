// DMR, pass 3: a vertex of the intermediate mesh becomes a point of the surface (Lorenz and Doellner 2008,
// section 4.5).
#version 450
#extension GL_GOOGLE_include_directive : require

#define BENCH_LAST
#include "dmr.glsl"
#include "rival.glsl"

layout(location = 0) in uvec3 in_vertex;

layout(std430, set = 1, binding = 0) readonly buffer Indices {
    uint indices[];
};
layout(std430, set = 1, binding = 1) readonly buffer Vertices {
    float vertices[]; // position and normal
};

void main() {
    uint corners = GIRIH_LAMBDA_CORNERS((in_vertex.y >> DMR_LAMBDA_SHIFT) & 7u);
    vec3 p[3];
    vec3 n[3];
    // The corners in the order that girih's evaluation has them, for the same bits.
    for (uint k = 0u; k < 3u; ++k) {
        uint first = 6u * indices[3u * in_vertex.x + ((corners >> (2u * k)) & 3u)];
        p[k] = vec3(vertices[first], vertices[first + 1u], vertices[first + 2u]);
        n[k] = vec3(vertices[first + 3u], vertices[first + 4u], vertices[first + 5u]);
    }
    uint u = in_vertex.z & 0xffffu;
    uint v = in_vertex.z >> 16;
    // A hidden triangle is drawn as nothing: unrefined, it may be anything but where it belongs.
    if ((in_vertex.y & DMR_HIDDEN) != 0u) {
        bench_nothing();
        return;
    }
    bench_surface_vertex(bench_patch(p, n), girih_barycentric(uvec3(u, v, 32768u - u - v)));
}
