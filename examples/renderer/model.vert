// A vertex of girih's, where it is and where it was. The Makefile defines GIRIH_MODE.
#version 450
#extension GL_GOOGLE_include_directive : require

#define GIRIH_SURFACE 2
#if GIRIH_MODE == 0

#define GIRIH_SET 0
#define GIRIH_SURFACE_SET 1
#include "girih.glsl"
#include "surface.glsl"

#else

#include "girih.glsl"
#include "view.glsl"

// Behind the normal, as in main.c: the texture coordinates and GIRIH_OUTPUT_PREVIOUS.
layout(location = 2) in vec2 baked_uv;
layout(location = 3) in vec3 baked_previous;

#endif

layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 uv;
layout(location = 2) out vec4 now;
layout(location = 3) out vec4 before;

void main() {
    GirihPoint point = girih_point();
#if GIRIH_MODE == 0
    uv = vec2(girih_attribute(point, 0u, 2u), girih_attribute(point, 1u, 2u));
    vec3 previous = girih_previous_position();
#else
    uv = baked_uv;
    vec3 previous = baked_previous;
#endif
    normal = point.normal;
    now = view.world_to_clip * vec4(point.position, 1.0);
    before = view.previous_world_to_clip * vec4(previous, 1.0);
    gl_Position = now;
}
