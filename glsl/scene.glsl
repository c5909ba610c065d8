// Reading the scene's records.
#ifndef GIRIH_SCENE_GLSL
#define GIRIH_SCENE_GLSL

#include "arrays.glsl"
#include "math.glsl"

vec3 girih_vertex_position(uint vertex) {
    uint word = vertex * GIRIH_VERTEX_WORDS;
    return vec3(uintBitsToFloat(VERTICES(word)), uintBitsToFloat(VERTICES(word + 1u)),
                uintBitsToFloat(VERTICES(word + 2u)));
}

vec3 girih_vertex_normal(uint vertex) {
    uint word = vertex * GIRIH_VERTEX_WORDS + 3u;
    return vec3(uintBitsToFloat(VERTICES(word)), uintBitsToFloat(VERTICES(word + 1u)),
                uintBitsToFloat(VERTICES(word + 2u)));
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
