// girih's vertices before a camera at (0, 0, 3) that looks along -z.
#version 450
#extension GL_GOOGLE_include_directive : require

#define GIRIH_SURFACE 1 // Curved PN triangles; the Makefile defines GIRIH_MODE
#include "girih.glsl"

layout(location = 0) out vec3 normal;

void main() {
    GirihPoint point = girih_point();
    vec3 seen = point.position - vec3(0.0, 0.0, 3.0);
    normal = point.normal;
    gl_Position = vec4(seen.x, -seen.y, -0.25 * seen.z, -0.5 * seen.z);
}
