#include <string.h>

#include "context.h"
#include "error.h"
#include "memory.h"

#define SCENE_FIRST GIRIH_BIND_VERTICES
#define SCENE_END GIRIH_BIND_PATTERNS
#define CATALOGUE_END GIRIH_BIND_INSTANCES

// The attributes' storage buffer for host vertex shaders of the instanced mode.
static girih_result create_draw_set(girih_scene *scene, girih_error *error) {
    const girih_context *context = scene->context;
    const VkDescriptorPoolSize size = {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                       .descriptorCount = 1};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = 1,
                                             .poolSizeCount = 1,
                                             .pPoolSizes = &size};
    VkResult result =
        context->vk.CreateDescriptorPool(context->device, &pool, context->callbacks, &scene->pool);
    if (result == VK_SUCCESS) {
        const VkDescriptorSetAllocateInfo info = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
            .descriptorPool = scene->pool,
            .descriptorSetCount = 1,
            .pSetLayouts = &context->draw_set_layout};
        result = context->vk.AllocateDescriptorSets(context->device, &info, &scene->draw_set);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "creating descriptors", "scene", result);
    }
    const VkDescriptorBufferInfo attributes = {.buffer = scene->buffer.buffer,
                                               .offset = scene->offset[GIRIH_BIND_ATTRIBUTES],
                                               .range =
                                                   scene->arrays.count[GIRIH_BIND_ATTRIBUTES] * 4};
    const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                        .dstSet = scene->draw_set,
                                        .descriptorCount = 1,
                                        .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                        .pBufferInfo = &attributes};
    context->vk.UpdateDescriptorSets(context->device, 1, &write, 0, NULL);
    return GIRIH_OK;
}

girih_result girih_scene_create(const girih_context *context, const girih_mesh *const *meshes,
                                uint32_t mesh_count, girih_scene **out, girih_error *error) {
    if (!context || !out || (mesh_count && !meshes)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_scene_create: context, meshes and scene must be set");
    }
    girih_scene *scene = girih_allocate(sizeof *scene);
    if (!scene) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "scene: out of memory");
    }
    *scene = (girih_scene){.context = context};
    girih_arrays *arrays = &scene->arrays;
    girih_result result = girih_pack_scene(arrays, &scene->table, meshes, mesh_count, error);
    // With few buffers the catalogue rides along, because scene and catalogue share one binding.
    const uint32_t end = context->few_buffers ? CATALOGUE_END : SCENE_END;
    VkDeviceSize size = 0;
    if (result == GIRIH_OK) {
        for (uint32_t n = SCENE_END; n < end; ++n) {
            arrays->count[n] = context->catalogue.count[n];
        }
        girih_layout_arrays(arrays, SCENE_FIRST, end, scene->offset, &size);
        result = girih_check_ranges(context, arrays, SCENE_FIRST, end, size, "scene", error);
    }
    if (result == GIRIH_OK) {
        result = girih_buffer_create(
            context, size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
            false, "scene", &scene->buffer, error);
    }
    if (result == GIRIH_OK) {
        result = girih_buffer_create(context, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, "scene",
                                     &scene->staging, error);
    }
    if (result == GIRIH_OK) {
        char *staging = scene->staging.mapped;
        for (uint32_t n = SCENE_FIRST; n < end; ++n) {
            const uint32_t *words = n < SCENE_END ? arrays->words[n] : context->catalogue.words[n];
            memcpy(staging + scene->offset[n], words, arrays->count[n] * 4);
        }
        result = create_draw_set(scene, error);
    }
    girih_arrays_free(arrays, 0, GIRIH_BIND_COUNT);
    if (result != GIRIH_OK) {
        girih_scene_destroy(scene);
        return result;
    }
    *out = scene;
    return GIRIH_OK;
}

void girih_cmd_upload_scene(girih_scene *scene, VkCommandBuffer commands) {
    const VkBufferCopy all = {.size = scene->buffer.size};
    scene->context->vk.CmdCopyBuffer(commands, scene->staging.buffer, scene->buffer.buffer, 1,
                                     &all);
    girih_barrier(scene->context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_SHADER_BIT,
                  VK_ACCESS_SHADER_READ_BIT);
}

void girih_scene_trim(girih_scene *scene) {
    girih_buffer_destroy(scene->context, &scene->staging);
}

void girih_scene_destroy(girih_scene *scene) {
    if (!scene) {
        return;
    }
    const girih_context *context = scene->context;
    context->vk.DestroyDescriptorPool(context->device, scene->pool, context->callbacks);
    girih_buffer_destroy(context, &scene->staging);
    girih_buffer_destroy(context, &scene->buffer);
    girih_free(scene->table.meshes);
    girih_free(scene);
}
