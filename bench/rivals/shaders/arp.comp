// Pattern selection (Lorenz, Doellner 2008, section 4.3): the number of each triangle's adaptive pattern.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "rival.glsl"
#include "hidden.glsl"

layout(local_size_x = 64) in;

const uint HIDDEN = 0xffffffffu; // BENCH_HIDDEN of cpu_levels.h

layout(std430, set = 1, binding = 0) readonly buffer Vertices {
    float vertices[]; // position, normal
};
layout(std430, set = 1, binding = 1) readonly buffer Indices {
    uint indices[];
};
layout(std430, set = 1, binding = 2) writeonly buffer Selected {
    uint selected[];
};

vec3 vertex_vector(uint word) {
    return vec3(vertices[word], vertices[word + 1u], vertices[word + 2u]);
}

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    if (triangle >= uint(indices.length()) / 3u) {
        return;
    }
    vec3 p[3];
    vec3 n[3];
    for (uint corner = 0u; corner < 3u; ++corner) {
        uint word = 6u * indices[3u * triangle + corner];
        p[corner] = vertex_vector(word);
        n[corner] = vertex_vector(word + 3u);
    }
    bool hidden = bench_hidden(p, n);
    uint number = bench_edge_level(p[0], p[1]);
    number = number * girih_frame.level_count + bench_edge_level(p[1], p[2]);
    number = number * girih_frame.level_count + bench_edge_level(p[2], p[0]);
    selected[triangle] = hidden ? HIDDEN : number;
}
