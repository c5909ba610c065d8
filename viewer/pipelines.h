// Graphics pipelines of the picture, made when they are first asked for.
#ifndef GIRIH_VIEWER_PIPELINES_H
#define GIRIH_VIEWER_PIPELINES_H

#include "renderer.h"

// What tells one pipeline from another.
typedef struct girih_pipeline_key {
    bool background; // the rest is unused then
    bool instanced;
    girih_surface surface;
    bool has_splits;                                    // of the instanced mode
    bool has_base_color_map, has_normal_map, has_color; // has_color: of the vertices
    girih_gltf_alpha_mode alpha_mode;
    VkCullModeFlags cull;
    float line_width; // 0: triangles are filled
    bool triangles;   // fragments are told of their triangles by a geometry shader
    bool behind;      // back faces in their own colour, pushed away from the viewer a little
    bool cylindrical;
} girih_pipeline_key;

typedef struct girih_pipelines {
    VkDevice device;
    VkRenderPass pass;
    VkPipelineLayout layout;
    VkSampleCountFlagBits samples;
    float widest_line; // that the device draws
    uint32_t attribute_floats, texcoord_float, texcoord_floats, color_float;
    uint32_t count;
    struct girih_pipeline_entry {
        girih_pipeline_key key;
        uint32_t own_revision;
        VkPipeline pipeline;
    } * entries;
} girih_pipelines;

// The pipeline of a key. plan gives the vertex input of the instanced mode, own the vertex shader
// of an instanced GIRIH_SURFACE_OWN; otherwise they may be NULL.
girih_result girih_pipelines_get(girih_pipelines *pipelines, const girih_pipeline_key *key,
                                 const girih_plan *plan, const girih_own_surface *own,
                                 VkPipeline *pipeline, girih_error *error);

void girih_pipelines_free(girih_pipelines *pipelines);

#endif
