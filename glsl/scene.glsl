// Reading the scene's records.
#ifndef GIRIH_SCENE_GLSL
#define GIRIH_SCENE_GLSL

#include "arrays.glsl"
#include "math.glsl"

// A vertex is three pairs of words: position x y, z and normal x, normal y z.
vec3 girih_vertex_position(uint vertex) {
    uint pair = vertex * (GIRIH_VERTEX_WORDS / 2);
    return vec3(uintBitsToFloat(VERTEX_PAIRS(pair)), uintBitsToFloat(VERTEX_PAIRS(pair + 1u).x));
}

vec3 girih_vertex_normal(uint vertex) {
    uint pair = vertex * (GIRIH_VERTEX_WORDS / 2) + 1u;
    return vec3(uintBitsToFloat(VERTEX_PAIRS(pair).y), uintBitsToFloat(VERTEX_PAIRS(pair + 1u)));
}

void girih_vertex(uint vertex, out vec3 position, out vec3 normal) {
    uint pair = vertex * (GIRIH_VERTEX_WORDS / 2);
    uvec2 middle = VERTEX_PAIRS(pair + 1u);
    position = vec3(uintBitsToFloat(VERTEX_PAIRS(pair)), uintBitsToFloat(middle.x));
    normal = vec3(uintBitsToFloat(middle.y), uintBitsToFloat(VERTEX_PAIRS(pair + 2u)));
}

float girih_instance_float(uint instance, uint field) {
    return uintBitsToFloat(girih_instance(instance, field));
}

GirihTransform girih_instance_transform(uint instance) {
    float m[12];
    for (uint n = 0u; n < 12u; ++n) {
        m[n] = girih_instance_float(instance, GIRIH_INSTANCE_TRANSFORM + n);
    }
    return GirihTransform(vec4(m[0], m[1], m[2], m[3]), vec4(m[4], m[5], m[6], m[7]), vec4(m[8], m[9], m[10], m[11]));
}

GirihTransform girih_instance_normal_transform(uint instance) {
    float m[9];
    for (uint n = 0u; n < 9u; ++n) {
        m[n] = girih_instance_float(instance, GIRIH_INSTANCE_NORMAL + n);
    }
    return GirihTransform(vec4(m[0], m[1], m[2], 0.0), vec4(m[3], m[4], m[5], 0.0), vec4(m[6], m[7], m[8], 0.0));
}

#endif
