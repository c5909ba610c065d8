// The icosahedron's vertices, from girih, before a camera at (0, 0, 3) that looks along -z.
#version 450
#extension GL_GOOGLE_include_directive : require

#define GIRIH_SURFACE 1 // Curved PN triangles; the Makefile defines GIRIH_MODE
#include "girih.glsl"

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;

void main() {
    GirihPoint point = girih_point();
    position = point.position;
    normal = point.normal;
    vec3 seen = position - vec3(0.0, 0.0, 3.0);
    gl_Position = vec4(seen.x, -seen.y, -0.25 * seen.z, -0.5 * seen.z);
}
