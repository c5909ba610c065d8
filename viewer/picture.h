// What the shaders of a picture read: shaders/picture.glsl.
#ifndef GIRIH_VIEWER_PICTURE_H
#define GIRIH_VIEWER_PICTURE_H

#include "panorama.h"
#include "renderer.h"

// The colours of GIRIH_SHADE_DENSITY, sRGB, and the pixels that a triangle covers at each: a
// quarter, then four times as many as before. In between they are mixed by the logarithm.
enum { GIRIH_DENSITY_COLORS = 7 };
extern const float girih_density_colors[GIRIH_DENSITY_COLORS][3];

// The uniform block, std140.
typedef struct girih_picture_block {
    float view_projection[4][4];
    float eye[4];
    float back_face[4];
    uint32_t shade;
    uint32_t first_range_color;
    uint32_t range_count;
    uint32_t attribute_floats;
    uint32_t texcoord_float;
    uint32_t texcoord_floats;
    uint32_t color_float;
    uint32_t padding;
    float half_pixels[2];
    float line_half_width;
    float exposure;
    float depth_cue[4];
    float studio_right[4];
    float studio_up[4];
    float studio_back[4];
    float density_colors[GIRIH_DENSITY_COLORS][4];
    float panorama_forward[4];
    float panorama_right[4];
    float panorama_up[4];
    float panorama_slopes_depth[4];
} girih_picture_block;

// The push constants.
typedef struct girih_material_block {
    float base_color[4];
    float emissive[4];
    float base_color_row0[4];
    float base_color_row1[4];
    float normal_row0[4];
    float normal_row1[4];
    float normal_scale;
    float metallic;
    float roughness;
    float alpha_cutoff;
} girih_material_block;

// The colour, sRGB and 1, of a level and of a base pattern.
void girih_picture_level_color(const girih_catalogue *catalogue, uint32_t level, float color[4]);
void girih_picture_pattern_color(uint32_t rank, float color[4]);

// Colours by range: those by level, then those by pattern, range_count of each. colors may be NULL.
// Returns range_count.
uint32_t girih_picture_range_colors(const girih_catalogue *catalogue, float (*colors)[4]);

// The slices that a picture is drawn in: a panorama's, else one.
uint32_t girih_picture_slice_count(const girih_view *view);

// The columns of a drawing that slice n takes.
girih_panorama_slice girih_picture_slice(const girih_view *view, uint32_t n,
                                         uint32_t drawing_width);

// The block of one slice of a picture of this height.
girih_picture_block girih_picture_fill(const girih_picture *picture, const girih_model *model,
                                       uint32_t range_count, uint32_t height, uint32_t slice);

// A material's; NULL: the default one.
girih_material_block girih_picture_material(const girih_gltf_material *material);

#endif
