// A host that moves a dynamic scene's vertices: two bones along z, then a wave. Duplicates of a point are
// left a rounding apart from the vertex that stands for it, and small coordinates are -0.
#version 450

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Rest {
    float rest[];  // 6 a vertex
};
layout(std430, binding = 1) readonly buffer Points {
    uint points[];
};
layout(std430, binding = 2) writeonly buffer Live {
    float live[];
};
layout(push_constant) uniform Push {
    uint first;  // float of the live vertices
    uint count;
    float time;
};

float negative_zero(float x) {
    return abs(x) < 0.02 ? uintBitsToFloat(0x80000000u) : x;
}

vec3 bend(vec3 v, float weight) {
    float angle = 0.8 * sin(time);
    vec3 bent = vec3(v.x, v.y * cos(angle) - v.z * sin(angle), v.y * sin(angle) + v.z * cos(angle));
    return mix(v, bent, weight);
}

void main() {
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= count) {
        return;
    }
    vec3 position = vec3(rest[6u * vertex], rest[6u * vertex + 1u], rest[6u * vertex + 2u]);
    vec3 normal = vec3(rest[6u * vertex + 3u], rest[6u * vertex + 4u], rest[6u * vertex + 5u]);
    float weight = clamp(position.z * 0.5 + 0.5, 0.0, 1.0);
    position = bend(position, weight);
    position += 0.1 * sin(position.yzx * 3.0 + time);
    normal = bend(normal, weight);
    for (int axis = 0; axis < 3; ++axis) {
        position[axis] = negative_zero(position[axis]);
        normal[axis] = negative_zero(normal[axis]);
        if (points[vertex] != vertex) {
            position[axis] = uintBitsToFloat(floatBitsToUint(position[axis]) ^ 1u);
        }
    }
    normal = normalize(normal);
    for (uint axis = 0u; axis < 3u; ++axis) {
        live[first + 6u * vertex + axis] = position[axis];
        live[first + 6u * vertex + 3u + axis] = normal[axis];
    }
}
