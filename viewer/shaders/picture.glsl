// What the shaders of a picture share: the frame's uniform block, the material's push constants, and
// the ways to shade. picture.h holds the same layout for C.
#ifndef GIRIH_PICTURE_GLSL
#define GIRIH_PICTURE_GLSL

const uint SHADE_LIT = 0u;
const uint SHADE_NORMALS = 1u;
const uint SHADE_RANGES = 2u;  // a colour per range of the catalogue: levels or patterns
const uint SHADE_DENSITY = 3u; // a colour per area on the screen

layout(std140, set = 0, binding = 0) uniform Picture {
    mat4 view_projection;
    vec4 eye;       // w = 1: the eye; w = 0: the direction towards the viewer
    vec4 back_face; // a > 0: the colour of back faces, sRGB
    uint shade;
    uint first_range_color; // of the colours that shade asks for
    uint range_count;
    uint attribute_floats;
    uint texcoord_float;  // instanced: where the texture coordinates begin in a vertex's attributes
    uint texcoord_floats; // 2; 4 where a normal map has coordinates of its own, behind the others
    uint color_float;     // instanced: where the vertex colour begins
    vec2 half_pixels;      // half the drawing's, or slice's, width and height
    float line_half_width; // of the wireframe, pixels; 0: there is none
    float exposure;        // that light is multiplied by
    vec4 depth_cue;        // dot with (position, 1): 0 at the model's nearest point to 1 at its farthest
    vec4 studio_right;     // studio.glsl's axes
    vec4 studio_up;
    vec4 studio_back;
    vec4 density_colors[7]; // sRGB: a pixel's quarter, then four times as much each
    // IS_CYLINDRICAL: GirihPanorama of the slice
    vec4 panorama_forward; // w: half_angle
    vec4 panorama_right;
    vec4 panorama_up;
    vec4 panorama_slopes_depth;
} picture;

layout(push_constant) uniform Material {
    vec4 base_color;
    vec4 emissive;        // w: not 0 where the material is unlit
    vec4 base_color_row0; // rows of KHR_texture_transform: offset * rotation * scale
    vec4 base_color_row1;
    vec4 normal_row0;
    vec4 normal_row1;
    float normal_scale;
    float metallic;
    float roughness;
    float alpha_cutoff;
} material;

layout(constant_id = 0) const bool HAS_BASE_COLOR_MAP = false;
layout(constant_id = 1) const bool HAS_COLOR = false;
layout(constant_id = 2) const bool IS_MASK = false;  // alpha mode MASK
layout(constant_id = 3) const bool IS_BLEND = false; // alpha mode BLEND
layout(constant_id = 4) const bool IS_LINE = false;  // the wireframe over the picture
layout(constant_id = 5) const bool HAS_NORMAL_MAP = false;
layout(constant_id = 6) const bool IS_CYLINDRICAL = false;

#endif
