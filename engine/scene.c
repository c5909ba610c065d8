// Scene: an arena of meshes on the device.
#include <string.h>

#include "context.h"
#include "error.h"
#include "memory.h"

#define SCENE_FIRST GIRIH_BIND_VERTICES
#define SCENE_END GIRIH_BIND_PATTERNS
#define CATALOGUE_END GIRIH_BIND_INSTANCES
#define VERTEX_BYTES ((VkDeviceSize)GIRIH_VERTEX_WORDS * 4)

// With few buffers the catalogue rides along, because scene and catalogue share one binding.
static uint32_t arena_end(const girih_context *context) {
    return context->few_buffers ? CATALOGUE_END : SCENE_END;
}

static girih_result validate(const girih_scene_desc *desc, girih_error *error) {
    if (desc->mesh_count && !desc->meshes) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "scene: meshes must be set where mesh_count is not 0");
    }
    if (desc->previous && !desc->dynamic) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "scene: previous vertices are kept in dynamic scenes only; set dynamic");
    }
    for (uint32_t n = 0; desc->dynamic && n < desc->mesh_count; ++n) {
        if (desc->meshes[n] && !desc->meshes[n]->dynamic) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "scene: mesh %u '%s' of a dynamic scene was not prepared as dynamic; "
                              "set girih_mesh_desc.dynamic",
                              n, desc->meshes[n]->name);
        }
    }
    return GIRIH_OK;
}

// Packs the meshes and says what the scene's buffers must be. The arrays' words and the table's
// meshes are there on success and the caller's to free.
static girih_result lay_out(girih_scene *scene, const girih_scene_desc *desc,
                            girih_buffer_need needs[GIRIH_SCENE_BUFFERS], girih_error *error) {
    const girih_context *context = scene->context;
    girih_arrays *arrays = &scene->arrays;
    girih_result result = validate(desc, error);
    if (result == GIRIH_OK) {
        result = girih_pack_scene(arrays, &scene->table, desc->meshes, desc->mesh_count,
                                  desc->previous != 0, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    scene->previous_vertices = arrays->frame.previous_vertices;
    const uint32_t end = arena_end(context);
    for (uint32_t n = SCENE_END; n < end; ++n) {
        arrays->count[n] = context->catalogue.count[n];
    }
    VkDeviceSize size = 0;
    girih_layout_arrays(arrays, SCENE_FIRST, end, scene->offset, &size);
    needs[GIRIH_SCENE_ARENA] =
        girih_need("scene", size,
                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT | desc->usage,
                   false);
    needs[GIRIH_SCENE_STAGING] =
        girih_need("scene staging", size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
    return girih_check_ranges(context, arrays, SCENE_FIRST, end, size, "scene", error);
}

girih_result girih_scene_needs(const girih_context *context, const girih_scene_desc *desc,
                               girih_buffer_need needs[GIRIH_SCENE_BUFFERS], girih_error *error) {
    if (!context || !desc || !needs) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_scene_needs: context, desc and needs must be set");
    }
    girih_scene scene = {.context = context};
    const girih_result result = lay_out(&scene, desc, needs, error);
    girih_arrays_free(&scene.arrays, 0, GIRIH_BIND_COUNT);
    girih_free(scene.table.meshes);
    return result;
}

girih_result girih_scene_create(const girih_context *context, const girih_scene_desc *desc,
                                girih_scene **out, girih_error *error) {
    if (!context || !desc || !out) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_scene_create: context, desc and scene must be set");
    }
    girih_scene *scene = girih_allocate(sizeof *scene);
    if (!scene) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "scene: out of memory");
    }
    *scene = (girih_scene){.context = context, .dynamic = desc->dynamic != 0};
    girih_buffer_need needs[GIRIH_SCENE_BUFFERS];
    girih_result result = lay_out(scene, desc, needs, error);
    girih_buffer *const buffers[GIRIH_SCENE_BUFFERS] = {
        [GIRIH_SCENE_ARENA] = &scene->buffer, [GIRIH_SCENE_STAGING] = &scene->staging};
    for (uint32_t n = 0; n < GIRIH_SCENE_BUFFERS && result == GIRIH_OK; ++n) {
        result = girih_buffer_create(context, &needs[n], desc->buffers ? &desc->buffers[n] : NULL,
                                     buffers[n], error);
    }
    const girih_arrays *arrays = &scene->arrays;
    if (result == GIRIH_OK) {
        char *staging = scene->staging.mapped;
        for (uint32_t n = SCENE_FIRST; n < arena_end(context); ++n) {
            const uint32_t *words = n < SCENE_END ? arrays->words[n] : context->catalogue.words[n];
            memcpy(staging + scene->offset[n], words, arrays->count[n] * 4);
        }
    }
    girih_arrays_free(&scene->arrays, 0, GIRIH_BIND_COUNT);
    if (result != GIRIH_OK) {
        girih_scene_destroy(scene);
        return result;
    }
    *out = scene;
    return GIRIH_OK;
}

void girih_cmd_upload_scene(girih_scene *scene, VkCommandBuffer commands) {
    if (!scene->staging.buffer) {
        return; // trimmed: it has been uploaded
    }
    const VkBufferCopy all = {.srcOffset = scene->staging.offset,
                              .dstOffset = scene->buffer.offset,
                              .size = scene->buffer.size};
    scene->context->vk.CmdCopyBuffer(commands, scene->staging.buffer, scene->buffer.buffer, 1,
                                     &all);
    girih_barrier(scene->context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_SHADER_BIT |
                      VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                      VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT);
}

void girih_scene_trim(girih_scene *scene) {
    if (scene->staging.memory) { // else it is the host's
        girih_buffer_destroy(scene->context, &scene->staging);
    }
}

girih_result girih_scene_vertices(const girih_scene *scene, uint32_t mesh,
                                  girih_buffer_range *range, VkDeviceSize *size,
                                  girih_error *error) {
    if (!scene || !range || !size) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_scene_vertices: scene, range and size must be set");
    }
    if (!scene->dynamic) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_scene_vertices: the scene is not dynamic; set "
                          "girih_scene_desc.dynamic to move its vertices");
    }
    if (mesh >= scene->table.mesh_count) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_scene_vertices: there is no mesh %u; the scene has %u", mesh,
                          scene->table.mesh_count);
    }
    const girih_scene_mesh *place = &scene->table.meshes[mesh];
    const VkDeviceSize first =
        scene->offset[GIRIH_BIND_VERTICES] + place->first_vertex * VERTEX_BYTES;
    *range = girih_buffer_as_range(&scene->buffer);
    range->offset += first;
    if (range->mapped) {
        range->mapped = (char *)range->mapped + first;
    }
    *size = place->vertex_count * VERTEX_BYTES;
    return GIRIH_OK;
}

void girih_cmd_keep_vertices(const girih_scene *scene, VkCommandBuffer commands) {
    if (scene->previous_vertices == 0) {
        return;
    }
    const VkDeviceSize current = scene->buffer.offset + scene->offset[GIRIH_BIND_VERTICES];
    const VkDeviceSize size = scene->previous_vertices * VERTEX_BYTES;
    const VkBufferCopy copy = {.srcOffset = current, .dstOffset = current + size, .size = size};
    const VkPipelineStageFlags users = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                       VK_PIPELINE_STAGE_VERTEX_SHADER_BIT |
                                       VK_PIPELINE_STAGE_TRANSFER_BIT;
    girih_barrier(
        scene->context, commands, users, VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT);
    scene->context->vk.CmdCopyBuffer(commands, scene->buffer.buffer, scene->buffer.buffer, 1,
                                     &copy);
    // The copy's reads are ordered before later writes by the stages alone.
    girih_barrier(scene->context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_TRANSFER_WRITE_BIT, users,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                      VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT);
}

void girih_scene_destroy(girih_scene *scene) {
    if (!scene) {
        return;
    }
    const girih_context *context = scene->context;
    girih_buffer_destroy(context, &scene->staging);
    girih_buffer_destroy(context, &scene->buffer);
    girih_free(scene->table.meshes);
    girih_free(scene);
}
