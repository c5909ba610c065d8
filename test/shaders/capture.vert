// What a draw of girih hands to the rasteriser, captured by transform feedback: position, normal and the
// 2 attributes of every triangle corner. GIRIH_MODE and GIRIH_SURFACE as girih.glsl asks; with
// CAPTURE_PREVIOUS the position is that of the previous frame.
#version 450
#extension GL_GOOGLE_include_directive : require

#if GIRIH_MODE == 0
#define GIRIH_SET 0
#endif
#include "girih.glsl"
#if GIRIH_SURFACE == 2
#define GIRIH_SURFACE_SET 1
#include "test_surfaces.glsl"
#endif

#if GIRIH_MODE != 0
layout(location = 2) in vec2 baked_attributes;
#endif

layout(xfb_buffer = 0, xfb_stride = 32) out;
layout(location = 0, xfb_offset = 0) out vec3 position;
layout(location = 1, xfb_offset = 12) out vec3 normal;
layout(location = 2, xfb_offset = 24) out vec2 attributes;

void main() {
    GirihPoint point = girih_point();
#ifdef CAPTURE_PREVIOUS
    position = girih_previous_position();
#else
    position = point.position;
#endif
    normal = point.normal;
#if GIRIH_MODE == 0
    attributes = vec2(girih_attribute(point, 0u, 2u), girih_attribute(point, 1u, 2u));
#else
    attributes = baked_attributes;
#endif
    gl_Position = vec4(point.position, 1.0);
}
