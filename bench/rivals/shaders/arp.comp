// Pattern selection (Lorenz, Doellner 2008, section 4.2, pass 1): the number of each triangle's adaptive pattern.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "rival.glsl"

layout(local_size_x = 64) in;

layout(std430, set = 1, binding = 0) readonly buffer Vertices {
    float vertices[]; // position, normal
};
layout(std430, set = 1, binding = 1) readonly buffer Indices {
    uint indices[];
};
layout(std430, set = 1, binding = 2) writeonly buffer Selected {
    uint selected[];
};

vec3 position(uint vertex) {
    return vec3(vertices[6u * vertex], vertices[6u * vertex + 1u], vertices[6u * vertex + 2u]);
}

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    if (triangle >= uint(indices.length()) / 3u) {
        return;
    }
    vec3 p1 = position(indices[3u * triangle]);
    vec3 p2 = position(indices[3u * triangle + 1u]);
    vec3 p3 = position(indices[3u * triangle + 2u]);
    uint number = bench_edge_level(p1, p2);
    number = number * girih_frame.level_count + bench_edge_level(p2, p3);
    selected[triangle] = number * girih_frame.level_count + bench_edge_level(p3, p1);
}
