#include "renderer.h"

#include <stdlib.h>

#include "error.h"
#include "renderer_parts.h"

static girih_result create_buffers(girih_renderer *renderer, girih_error *error) {
    const double all_around = 6.283185307179586;
    const girih_renderer_desc *desc = &renderer->desc;
    renderer->range_count = girih_picture_range_colors(desc->catalogue, NULL);
    girih_result result = girih_device_buffer_create(
        renderer->device, &renderer->range_colors, (VkDeviceSize)renderer->range_count * 2 * 16,
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GIRIH_MEMORY_UPLOAD, error);
    if (result != GIRIH_OK) {
        return result;
    }
    girih_picture_range_colors(desc->catalogue, renderer->range_colors.mapped);
    uint32_t alignment =
        (uint32_t)renderer->device->properties.limits.minUniformBufferOffsetAlignment;
    renderer->block_stride =
        ((uint32_t)sizeof(girih_picture_block) + alignment - 1) / alignment * alignment;
    renderer->slice_count = girih_panorama_slice_count(all_around);
    return girih_device_buffer_create(
        renderer->device, &renderer->picture_blocks,
        (VkDeviceSize)desc->frame_count * renderer->slice_count * renderer->block_stride,
        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GIRIH_MEMORY_UPLOAD, error);
}

static girih_result create_layouts(girih_renderer *renderer, girih_error *error) {
    VkDevice device = renderer->device->device;
    VkShaderStageFlags both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    VkShaderStageFlags all =
        both | (renderer->device->features.geometryShader ? VK_SHADER_STAGE_GEOMETRY_BIT : 0);
    VkDescriptorSetLayoutBinding picture[2] = {
        {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1, all, NULL},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, NULL},
    };
    VkDescriptorSetLayoutBinding material[2] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, NULL},
        {1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, NULL},
    };
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = 2,
                                            .pBindings = picture};
    VkResult result = vkCreateDescriptorSetLayout(device, &info, NULL, &renderer->picture_layout);
    if (result == VK_SUCCESS) {
        info.pBindings = material;
        result = vkCreateDescriptorSetLayout(device, &info, NULL, &renderer->material_layout);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorSetLayout", result);
    }
    VkDescriptorSetLayout sets[4] = {renderer->picture_layout, renderer->material_layout};
    uint32_t set_count = 2;
    if (renderer->desc.context != NULL) {
        sets[set_count++] = girih_context_draw_set_layout(renderer->desc.context);
    }
    if (renderer->desc.surface_layout != VK_NULL_HANDLE) {
        sets[set_count++] = renderer->desc.surface_layout;
    }
    VkPushConstantRange push = {both, 0, sizeof(girih_material_block)};
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = set_count,
        .pSetLayouts = sets,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &push,
    };
    result = vkCreatePipelineLayout(device, &layout, NULL, &renderer->pipelines.layout);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreatePipelineLayout", result);
}

const girih_gltf_material *girih_renderer_material(const girih_renderer *renderer,
                                                   uint32_t material) {
    const girih_model *model = renderer->desc.model;
    int32_t number = model->materials[material];
    return number < 0 ? NULL : &model->contents->materials[number];
}

static girih_result create_sets(girih_renderer *renderer, girih_error *error) {
    VkDevice device = renderer->device->device;
    uint32_t material_count = renderer->desc.model->material_count;
    VkDescriptorPoolSize sizes[3] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * material_count}};
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = material_count + 1,
        .poolSizeCount = 3,
        .pPoolSizes = sizes,
    };
    VkResult result = vkCreateDescriptorPool(device, &pool, NULL, &renderer->descriptors);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorPool", result);
    }
    VkDescriptorSetAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = renderer->descriptors,
        .descriptorSetCount = 1,
        .pSetLayouts = &renderer->picture_layout,
    };
    result = vkAllocateDescriptorSets(device, &allocate, &renderer->picture_set);
    allocate.pSetLayouts = &renderer->material_layout;
    renderer->material_sets = calloc((size_t)material_count + 1, sizeof *renderer->material_sets);
    if (renderer->material_sets == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < material_count && result == VK_SUCCESS; n++) {
        result = vkAllocateDescriptorSets(device, &allocate, &renderer->material_sets[n]);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkAllocateDescriptorSets", result);
    }
    VkDescriptorBufferInfo buffers[2] = {
        {renderer->picture_blocks.buffer, 0, sizeof(girih_picture_block)},
        {renderer->range_colors.buffer, 0, VK_WHOLE_SIZE}};
    VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = renderer->picture_set,
        .descriptorCount = 1,
    };
    for (uint32_t n = 0; n < 2; n++) {
        write.dstBinding = n;
        write.descriptorType =
            n == 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        write.pBufferInfo = &buffers[n];
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    for (uint32_t n = 0; n < material_count; n++) {
        const girih_gltf_material *material = girih_renderer_material(renderer, n);
        VkDescriptorImageInfo images[2];
        girih_result found =
            girih_textures_find(&renderer->textures, renderer->device,
                                material != NULL ? &material->base_color_texture : NULL,
                                GIRIH_TEXEL_SRGB, &images[0], error);
        if (found == GIRIH_OK) {
            found = girih_textures_find(&renderer->textures, renderer->device,
                                        material != NULL ? &material->normal_texture : NULL,
                                        GIRIH_TEXEL_LINEAR, &images[1], error);
        }
        if (found != GIRIH_OK) {
            return found;
        }
        write.dstSet = renderer->material_sets[n];
        write.dstBinding = 0;
        write.descriptorCount = 2; // runs on into binding 1
        write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        write.pImageInfo = images;
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    return GIRIH_OK;
}

static girih_result create_overlays(girih_renderer *renderer, girih_error *error) {
    renderer->overlays = calloc(renderer->desc.frame_count, sizeof *renderer->overlays);
    if (renderer->overlays == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < renderer->desc.frame_count && result == GIRIH_OK; n++) {
        result = girih_overlay_painter_create(&renderer->overlays[n], renderer->device,
                                              renderer->attachments.pass,
                                              renderer->attachments.samples, error);
    }
    return result;
}

static girih_result create_parts(girih_renderer *renderer, girih_error *error) {
    girih_result result = girih_textures_create(&renderer->textures, renderer->device,
                                                renderer->desc.model->contents, error);
    if (result == GIRIH_OK) {
        result = girih_attachments_create(&renderer->attachments, renderer->device,
                                          renderer->desc.samples, error);
    }
    if (result == GIRIH_OK) {
        result = create_buffers(renderer, error);
    }
    if (result == GIRIH_OK) {
        result = create_layouts(renderer, error);
    }
    if (result == GIRIH_OK) {
        result = create_sets(renderer, error);
    }
    if (result == GIRIH_OK) {
        result = create_overlays(renderer, error);
    }
    return result;
}

girih_result girih_renderer_create(const girih_renderer_desc *desc, girih_renderer **renderer,
                                   girih_error *error) {
    girih_renderer *made = calloc(1, sizeof *made);
    if (made == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    made->desc = *desc;
    made->device = desc->device;
    girih_result result = create_parts(made, error);
    if (result != GIRIH_OK) {
        girih_renderer_destroy(made);
        return result;
    }
    made->pipelines.device = desc->device->device;
    made->pipelines.pass = made->attachments.pass;
    made->pipelines.samples = made->attachments.samples;
    made->pipelines.widest_line =
        desc->device->features.wideLines ? desc->device->properties.limits.lineWidthRange[1] : 1.0f;
    made->pipelines.attribute_floats = desc->model->attribute_floats;
    made->pipelines.texcoord_float = desc->model->texcoord_float;
    made->pipelines.texcoord_floats = desc->model->texcoord_floats;
    made->pipelines.color_float = desc->model->color_float;
    *renderer = made;
    return GIRIH_OK;
}

void girih_renderer_destroy(girih_renderer *renderer) {
    if (renderer == NULL) {
        return;
    }
    girih_device *device = renderer->device;
    girih_pipelines_free(&renderer->pipelines);
    for (uint32_t n = 0; renderer->overlays != NULL && n < renderer->desc.frame_count; n++) {
        girih_overlay_painter_destroy(&renderer->overlays[n], device);
    }
    free(renderer->overlays);
    vkDestroyPipelineLayout(device->device, renderer->pipelines.layout, NULL);
    vkDestroyDescriptorPool(device->device, renderer->descriptors, NULL);
    vkDestroyDescriptorSetLayout(device->device, renderer->picture_layout, NULL);
    vkDestroyDescriptorSetLayout(device->device, renderer->material_layout, NULL);
    girih_device_buffer_destroy(device, &renderer->picture_blocks);
    girih_device_buffer_destroy(device, &renderer->range_colors);
    girih_attachments_free(&renderer->attachments, device);
    girih_textures_free(&renderer->textures, device);
    free(renderer->material_sets);
    free(renderer);
}

girih_result girih_renderer_resize(girih_renderer *renderer, uint32_t width, uint32_t height,
                                   girih_error *error) {
    return girih_attachments_resize(&renderer->attachments, renderer->device, width, height, error);
}

girih_result girih_renderer_set_overlay(girih_renderer *renderer, uint32_t frame,
                                        const girih_overlay *overlay, girih_error *error) {
    return girih_overlay_painter_set(&renderer->overlays[frame], renderer->device, overlay, error);
}

VkImage girih_renderer_image(const girih_renderer *renderer) {
    return renderer->attachments.resolved.image;
}
