#include "picture.h"

#include <math.h>
#include <string.h>

// --- Colours by range ---

// A colour of full value around the circle of hues, in [0, 1).
static void hue_color(float hue, float saturation, float value, float color[4]) {
    for (int n = 0; n < 3; n++) {
        float turn = hue * 6.0f + (n == 0 ? 0.0f : n == 1 ? 4.0f : 2.0f);
        turn -= 6.0f * floorf(turn / 6.0f);
        float ramp = fabsf(turn - 3.0f) - 1.0f;
        ramp = ramp < 0.0f ? 0.0f : ramp > 1.0f ? 1.0f : ramp;
        color[n] = value * (1.0f - saturation + saturation * ramp);
    }
    color[3] = 1.0f;
}

void girih_picture_pattern_color(uint32_t rank, float color[4]) {
    // Steps of the golden ratio keep neighbours in rank far apart in hue.
    float hue = (float)rank * 0.61803399f;
    hue_color(hue - floorf(hue), 0.35f + 0.15f * (float)(rank % 4),
              0.95f - 0.12f * (float)(rank % 3), color);
}

void girih_picture_level_color(const girih_catalogue *catalogue, uint32_t level, float color[4]) {
    float last = catalogue->level_count > 1 ? (float)(catalogue->level_count - 1) : 1.0f;
    hue_color(0.62f * (1.0f - (float)level / last), 0.7f, 0.95f, color);
}

// Ranges are numbered in the order of their base patterns, those with i > j > k take two.
static uint32_t ranges_of(const uint8_t levels[3]) {
    return levels[0] > levels[1] && levels[1] > levels[2] ? 2 : 1;
}

uint32_t girih_picture_range_colors(const girih_catalogue *catalogue, float (*colors)[4]) {
    uint32_t range_count = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        range_count += ranges_of(girih_catalogue_pattern(catalogue, rank)->levels);
    }
    if (colors == NULL) {
        return range_count;
    }
    uint32_t range = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const uint8_t *levels = girih_catalogue_pattern(catalogue, rank)->levels;
        for (uint32_t n = ranges_of(levels); n > 0; n--, range++) {
            girih_picture_level_color(catalogue, levels[0], colors[range]);
            girih_picture_pattern_color(rank, colors[range_count + range]);
        }
    }
    return range_count;
}

// Hot where triangles are smaller than the 2 x 2 pixels that devices shade at once.
const float girih_density_colors[GIRIH_DENSITY_COLORS][3] = {
    {0.55f, 0.00f, 0.38f}, {0.84f, 0.19f, 0.15f}, {0.96f, 0.55f, 0.26f}, {0.99f, 0.88f, 0.50f},
    {0.60f, 0.84f, 0.64f}, {0.27f, 0.52f, 0.77f}, {0.20f, 0.20f, 0.58f}};

// --- The picture ---

uint32_t girih_picture_slice_count(const girih_view *view) {
    return view->cylindrical ? girih_panorama_slice_count(view->view_angle) : 1;
}

girih_panorama_slice girih_picture_slice(const girih_view *view, uint32_t n,
                                         uint32_t drawing_width) {
    return view->cylindrical ? girih_panorama_slice_get(n, drawing_width, view->view_angle)
                             : (girih_panorama_slice){.width = drawing_width};
}

static void fill_panorama(girih_picture_block *block, const girih_view *view,
                          const girih_panorama_slice *slice) {
    double cosine = cos(slice->middle);
    double sine = sin(slice->middle);
    for (int n = 0; n < 3; n++) {
        double right = view->right[n];
        double back = view->back[n];
        block->panorama_forward[n] = (float)(sine * right - cosine * back);
        block->panorama_right[n] = (float)(cosine * right + sine * back);
        block->panorama_up[n] = view->up[n];
    }
    block->panorama_forward[3] = (float)slice->half_angle;
    memcpy(block->panorama_slopes_depth, view->slopes, sizeof view->slopes);
    memcpy(block->panorama_slopes_depth + 2, view->depth, sizeof view->depth);
}

// 0 at the nearest point of the model's box that can be in the picture, 1 at the farthest. All the
// way round there is no front.
static void fill_depth_cue(girih_picture_block *block, const girih_picture *picture) {
    const girih_view *view = picture->view;
    if (view->cylindrical) {
        return;
    }
    double nearest = 0.0;
    double farthest = 0.0;
    double eye = 0.0;
    for (int n = 0; n < 3; n++) {
        // Along back, away from the viewer's direction.
        double back = (double)view->back[n];
        nearest += back * picture->box[back > 0.0 ? 1 : 0][n];
        farthest += back * picture->box[back > 0.0 ? 0 : 1][n];
        eye += back * (double)view->eye[n];
    }
    nearest = view->orthographic ? nearest : fmin(nearest, eye);
    double depth = nearest - farthest;
    if (depth > 0.0) {
        for (int n = 0; n < 3; n++) {
            block->depth_cue[n] = (float)(-(double)view->back[n] / depth);
        }
        block->depth_cue[3] = (float)(nearest / depth);
    }
}

// shaders/picture.glsl: levels and patterns are colours by range.
static uint32_t shader_shade(girih_shade shade) {
    static const uint32_t shades[] = {0, 1, 2, 2, 3};
    return shades[shade];
}

girih_picture_block girih_picture_fill(const girih_picture *picture, const girih_model *model,
                                       uint32_t range_count, uint32_t height, uint32_t slice) {
    const girih_view *view = picture->view;
    // Drawings side by side are equally wide, so they share the blocks of their slices.
    girih_panorama_slice columns = girih_picture_slice(view, slice, picture->drawings[0].width);
    girih_picture_block block = {
        .shade = shader_shade(picture->shade),
        .first_range_color = picture->shade == GIRIH_SHADE_PATTERNS ? range_count : 0,
        .range_count = range_count,
        .attribute_floats = model->attribute_floats,
        .texcoord_float = model->texcoord_float,
        .texcoord_floats = model->texcoord_floats,
        .color_float = model->color_float,
        .half_pixels = {0.5f * (float)columns.width, 0.5f * (float)height},
        .line_half_width = picture->wireframe ? 0.5f * picture->line_width : 0.0f,
        .exposure = exp2f(picture->exposure),
    };
    memcpy(block.view_projection, view->view_projection, sizeof block.view_projection);
    memcpy(block.eye, view->eye, sizeof view->eye);
    block.eye[3] = view->orthographic ? 0.0f : 1.0f;
    memcpy(block.studio_right, view->right, sizeof view->right);
    memcpy(block.studio_up, view->up, sizeof view->up);
    memcpy(block.studio_back, view->back, sizeof view->back);
    fill_depth_cue(&block, picture);
    for (int n = 0; n < GIRIH_DENSITY_COLORS; n++) {
        memcpy(block.density_colors[n], girih_density_colors[n], sizeof girih_density_colors[n]);
    }
    if (picture->has_back_face_color) {
        memcpy(block.back_face, picture->back_face_color, sizeof picture->back_face_color);
        block.back_face[3] = 1.0f;
    }
    if (view->cylindrical) {
        fill_panorama(&block, view, &columns);
    }
    return block;
}

// --- Materials ---

// KHR_texture_transform: translation * rotation * scale.
static void texcoord_rows(const girih_gltf_texture *texture, float row0[4], float row1[4]) {
    float c = cosf(texture->rotation);
    float s = sinf(texture->rotation);
    row0[0] = c * texture->scale[0];
    row0[1] = s * texture->scale[1];
    row0[2] = texture->offset[0];
    row1[0] = -s * texture->scale[0];
    row1[1] = c * texture->scale[1];
    row1[2] = texture->offset[1];
}

girih_material_block girih_picture_material(const girih_gltf_material *material) {
    girih_material_block block = {
        .base_color = {0.8f, 0.8f, 0.8f, 1.0f},
        .roughness = 0.55f,
    };
    if (material == NULL) {
        return block;
    }
    memcpy(block.base_color, material->base_color, sizeof block.base_color);
    memcpy(block.emissive, material->emissive, sizeof material->emissive);
    block.emissive[3] = material->unlit ? 1.0f : 0.0f;
    block.metallic = material->metallic;
    block.roughness = material->roughness;
    block.alpha_cutoff = material->alpha_cutoff;
    block.normal_scale = material->normal_scale;
    texcoord_rows(&material->base_color_texture, block.base_color_row0, block.base_color_row1);
    texcoord_rows(&material->normal_texture, block.normal_row0, block.normal_row1);
    return block;
}
