// Reading the scene's records.
#ifndef GIRIH_SCENE_GLSL
#define GIRIH_SCENE_GLSL

#include "arrays.glsl"
#include "math.glsl"

// A vertex is three pairs of words: position x y, z and normal x, normal y z.
vec3 girih_vertex_normal(uint vertex) {
    uint pair = vertex * (GIRIH_VERTEX_WORDS / 2) + 1u;
    return vec3(uintBitsToFloat(GIRIH_AT_VERTEX_PAIRS(pair).y), uintBitsToFloat(GIRIH_AT_VERTEX_PAIRS(pair + 1u)));
}

// The position of a vertex that stands for its point.
vec3 girih_point_position(uint vertex) {
    uint pair = vertex * (GIRIH_VERTEX_WORDS / 2);
    vec3 position =
        vec3(uintBitsToFloat(GIRIH_AT_VERTEX_PAIRS(pair)), uintBitsToFloat(GIRIH_AT_VERTEX_PAIRS(pair + 1u).x));
    // Mesh preparation stores no -0; a host that moves vertices may.
    return girih_has(GIRIH_VARIANT_DYNAMIC) ? girih_no_negative_zero(position) : position;
}

// `first`: 0, or girih_frame.previous_vertices.
void girih_vertex(uint vertex, uint first, out vec3 position, out vec3 normal) {
    uint pair = (vertex + first) * (GIRIH_VERTEX_WORDS / 2);
    uvec2 middle = GIRIH_AT_VERTEX_PAIRS(pair + 1u);
    normal = vec3(uintBitsToFloat(middle.y), uintBitsToFloat(GIRIH_AT_VERTEX_PAIRS(pair + 2u)));
    if (girih_has(GIRIH_VARIANT_DYNAMIC)) {
        // Rounding may move duplicates of a point apart: only the one that stands for it counts.
        position = girih_point_position(GIRIH_AT_WELD_POINTS(vertex) + first);
    } else {
        position = vec3(uintBitsToFloat(GIRIH_AT_VERTEX_PAIRS(pair)), uintBitsToFloat(middle.x));
    }
}

// `when`: 0, or GIRIH_INSTANCE_PREVIOUS.
GirihTransform girih_instance_transform(uint instance, uint when) {
    uint field = GIRIH_INSTANCE_TRANSFORM + when;
    return GirihTransform(uintBitsToFloat(girih_instance_four(instance, field)),
                          uintBitsToFloat(girih_instance_four(instance, field + 4u)),
                          uintBitsToFloat(girih_instance_four(instance, field + 8u)));
}

GirihTransform girih_instance_normal_transform(uint instance, uint when) {
    uint field = GIRIH_INSTANCE_NORMAL + when;
    return GirihTransform(vec4(uintBitsToFloat(girih_instance_four(instance, field).xyz), 0.0),
                          vec4(uintBitsToFloat(girih_instance_four(instance, field + 4u).xyz), 0.0),
                          vec4(uintBitsToFloat(girih_instance_four(instance, field + 8u).xyz), 0.0));
}

bool girih_instance_mirrored(uint instance) {
    return (girih_instance(instance, GIRIH_INSTANCE_FLAGS) & GIRIH_INSTANCE_MIRRORED) != 0u;
}

#endif
