// Graphics pipelines of the picture, made when they are first asked for.
#ifndef GIRIH_VIEWER_PIPELINES_H
#define GIRIH_VIEWER_PIPELINES_H

#include "renderer.h"

// shaders/picture.glsl: the uniform block, std140.
typedef struct girih_picture_block {
    float view_projection[4][4];
    float eye[4];
    float key_light[4];
    float fill_light[4];
    float back_face[4];
    uint32_t shade;
    uint32_t range_count;
    uint32_t attribute_floats;
    uint32_t texcoord_float;
    uint32_t texcoord_floats;
    uint32_t color_float;
    uint32_t padding[2];
    float panorama_forward[4];
    float panorama_right[4];
    float panorama_up[4];
    float panorama_slopes_depth[4];
} girih_picture_block;

// shaders/picture.glsl: the push constants.
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

// Descriptor sets of the picture's pipelines.
enum { GIRIH_SET_PICTURE = 0, GIRIH_SET_MATERIAL = 1 }; // then GIRIH_DRAW_SET and on

// What tells one pipeline from another.
typedef struct girih_pipeline_key {
    bool background; // the rest is unused then
    bool instanced;
    girih_surface surface;
    bool has_splits;                                    // of the instanced mode
    bool has_base_color_map, has_normal_map, has_color; // has_color: of the vertices
    girih_gltf_alpha_mode alpha_mode;
    VkCullModeFlags cull;
    bool line;
    bool behind; // back faces in their own colour, pushed away from the viewer a little
} girih_pipeline_key;

typedef struct girih_pipelines {
    VkDevice device;
    VkRenderPass pass;
    VkPipelineLayout layout;
    VkSampleCountFlagBits samples;
    bool cylindrical;
    const girih_own_surface *own; // of GIRIH_SURFACE_OWN
    uint32_t attribute_floats, texcoord_float, texcoord_floats, color_float;
    uint32_t count;
    struct girih_pipeline_entry {
        girih_pipeline_key key;
        VkPipeline pipeline;
    } * entries;
} girih_pipelines;

// The pipeline of a key. plan gives the vertex input of the instanced mode; otherwise it may be
// NULL.
girih_result girih_pipelines_get(girih_pipelines *pipelines, const girih_pipeline_key *key,
                                 const girih_plan *plan, VkPipeline *pipeline, girih_error *error);

void girih_pipelines_free(girih_pipelines *pipelines);

#endif
