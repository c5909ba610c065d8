// A displaced surface: Curved PN triangles with waves of the place in the mesh along the normal.
#version 450
#extension GL_GOOGLE_include_directive : require

#define GIRIH_BAKE
#include "girih.glsl"

vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
    vec3 position = girih_base_position(patch_, barycentric);
    vec3 normal = girih_base_normal(patch_, barycentric);
    precise float height = 0.02 * (sin(position.x * 20.0) + sin(position.y * 20.0));
    return position + girih_displacement(patch_, normal, height);
}
