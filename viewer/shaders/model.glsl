// The refined model's vertices, in every mode of girih. GIRIH_MODE and GIRIH_SURFACE as girih.glsl
// asks for; GIRIH_SET is defined where the instanced mode has attributes to read.
#include "picture.glsl"
#include "girih.glsl"
#include "panorama.glsl"

#if GIRIH_MODE == 0
layout(std430, set = 0, binding = 1) readonly buffer RangeColors {
    vec4 range_colors[];
};
#else
layout(location = 8) in vec4 in_texcoord;
layout(location = 9) in vec4 in_color;
#endif

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_texcoord; // of the base colour, of the normal map
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out vec3 out_range_color;

GirihPanorama picture_panorama() {
    return GirihPanorama(picture.eye.xyz, picture.panorama_forward.xyz, picture.panorama_right.xyz,
                         picture.panorama_up.xyz, picture.panorama_forward.w,
                         picture.panorama_slopes_depth.xy, picture.panorama_slopes_depth.zw);
}

void main() {
    GirihPoint point = girih_point();
    // Written out and precise: every mode must reach the same pixels.
    precise vec4 clip = ((picture.view_projection[0] * point.position.x +
                          picture.view_projection[1] * point.position.y) +
                         picture.view_projection[2] * point.position.z) +
                        picture.view_projection[3];
    gl_Position = clip;
    if (IS_CYLINDRICAL) {
        gl_Position = girih_panorama_point(picture_panorama(), point.position).position;
    }
    out_position = point.position;
    out_normal = point.normal;
    out_texcoord = vec4(0.0);
    out_color = vec4(1.0);
    out_range_color = vec3(0.0);
#if GIRIH_MODE == 0
#ifdef GIRIH_SET
    if (HAS_BASE_COLOR_MAP || HAS_NORMAL_MAP) {
        for (uint n = 0u; n < picture.texcoord_floats; ++n) {
            out_texcoord[n] = girih_attribute(point, picture.texcoord_float + n,
                                              picture.attribute_floats);
        }
    }
    if (HAS_COLOR) {
        for (uint n = 0u; n < 4u; ++n) {
            out_color[n] = girih_attribute(point, picture.color_float + n,
                                           picture.attribute_floats);
        }
    }
#endif
    if (picture.shade == SHADE_RANGES) {
        out_range_color = range_colors[picture.first_range_color +
                                       (point.key >> 3) % picture.range_count].rgb;
    }
#else
    if (HAS_BASE_COLOR_MAP || HAS_NORMAL_MAP) {
        out_texcoord = in_texcoord;
    }
    if (HAS_COLOR) {
        out_color = in_color;
    }
#endif
    if (picture.texcoord_floats == 2u) {
        out_texcoord.zw = out_texcoord.xy;
    }
}
