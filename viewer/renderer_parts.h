// What a renderer is made of: for renderer.c, which makes it, and renderer_draw.c, which draws.
#ifndef GIRIH_VIEWER_RENDERER_PARTS_H
#define GIRIH_VIEWER_RENDERER_PARTS_H

#include "attachments.h"
#include "overlay_painter.h"
#include "picture.h"
#include "pipelines.h"
#include "textures.h"

// Descriptor sets of the picture's pipelines.
enum { GIRIH_SET_PICTURE = 0, GIRIH_SET_MATERIAL = 1 }; // then GIRIH_DRAW_SET and on

struct girih_renderer {
    girih_renderer_desc desc;
    girih_device *device;
    girih_textures textures;
    girih_attachments attachments;
    girih_device_buffer picture_blocks; // of every frame, of every slice
    uint32_t slice_count;               // that a frame has room for
    uint32_t block_stride;              // bytes from one slice's block to the next one's
    girih_device_buffer range_colors;
    uint32_t range_count;
    VkDescriptorSetLayout picture_layout, material_layout;
    VkDescriptorPool descriptors;
    VkDescriptorSet picture_set;
    VkDescriptorSet *material_sets; // [model->material_count]
    girih_pipelines pipelines;
    girih_overlay_painter *overlays; // [desc.frame_count]
};

// NULL: the default material.
const girih_gltf_material *girih_renderer_material(const girih_renderer *renderer,
                                                   uint32_t material);

#endif
