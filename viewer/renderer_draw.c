#include "renderer.h"

#include <string.h>

#include "error.h"
#include "renderer_parts.h"

// A picture that is being recorded.
typedef struct recording {
    girih_renderer *renderer;
    VkCommandBuffer commands;
    uint32_t frame;
    const girih_picture *picture;
} recording;

static uint32_t block_offset(const recording *r, uint32_t slice) {
    return (r->frame * r->renderer->slice_count + slice) * r->renderer->block_stride;
}

// Whether a geometry shader tells fragments of their triangles.
static bool uses_triangles(const recording *r) {
    return r->renderer->device->features.geometryShader &&
           (r->picture->wireframe || r->picture->shade == GIRIH_SHADE_DENSITY);
}

static girih_result draw_material(const recording *r, const girih_drawing *drawing, uint32_t slice,
                                  uint32_t number, VkCullModeFlags cull, bool line,
                                  girih_error *error) {
    girih_renderer *renderer = r->renderer;
    VkCommandBuffer commands = r->commands;
    bool shows_back_faces = r->picture->has_back_face_color && cull == VK_CULL_MODE_FRONT_BIT;
    const girih_model *model = renderer->desc.model;
    const girih_gltf_material *material = girih_renderer_material(renderer, number);
    bool has_texcoord = model->texcoord_float != GIRIH_MODEL_NONE && material != NULL;
    girih_pipeline_key key = {
        .instanced = drawing->plan != NULL && drawing->mode == GIRIH_MODE_INSTANCED,
        .surface = drawing->surface,
        .has_splits = drawing->has_splits,
        .has_base_color_map = has_texcoord && material->base_color_texture.image >= 0,
        .has_normal_map = has_texcoord && material->normal_texture.image >= 0,
        .has_color = model->color_float != GIRIH_MODEL_NONE,
        .alpha_mode = material != NULL ? material->alpha_mode : GIRIH_GLTF_ALPHA_OPAQUE,
        .cull = cull,
        .line_width = line ? r->picture->line_width : 0.0f,
        .triangles = !line && uses_triangles(r),
        .behind = shows_back_faces,
        .cylindrical = r->picture->view->cylindrical,
    };
    VkPipeline pipeline;
    girih_result result = girih_pipelines_get(&renderer->pipelines, &key, drawing->plan,
                                              drawing->own, &pipeline, error);
    if (result != GIRIH_OK) {
        return result;
    }
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    VkDescriptorSet sets[2] = {renderer->picture_set, renderer->material_sets[number]};
    uint32_t offset = block_offset(r, slice);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, renderer->pipelines.layout,
                            GIRIH_SET_PICTURE, 2, sets, 1, &offset);
    girih_material_block block = girih_picture_material(material);
    vkCmdPushConstants(commands, renderer->pipelines.layout,
                       VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof block,
                       &block);
    if (key.instanced && key.surface == GIRIH_SURFACE_OWN && drawing->own->set != VK_NULL_HANDLE) {
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                renderer->pipelines.layout, GIRIH_DRAW_SURFACE_SET, 1,
                                &drawing->own->set, 0, NULL);
    }
    if (drawing->plan != NULL) {
        girih_cmd_draw(drawing->plan, commands, number, renderer->pipelines.layout, GIRIH_DRAW_SET);
        return GIRIH_OK;
    }
    uint32_t first = drawing->material_first[number];
    uint32_t count = drawing->material_first[number + 1] - first;
    VkBuffer buffers[2] = {drawing->positions, drawing->attributes};
    VkDeviceSize offsets[2] = {0, 0};
    vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
    vkCmdBindIndexBuffer(commands, drawing->indices, 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands, 3 * count, 1, 3 * first, 0, 0);
    return GIRIH_OK;
}

static void set_viewport(const recording *r, uint32_t x, uint32_t width) {
    uint32_t height = r->renderer->attachments.height;
    // The height is negative, so that y points up as it does in glTF.
    VkViewport viewport = {(float)x, (float)height, (float)width, -(float)height, 0.0f, 1.0f};
    VkRect2D scissor = {{(int32_t)x, 0}, {width, height}};
    vkCmdSetViewport(r->commands, 0, 1, &viewport);
    vkCmdSetScissor(r->commands, 0, 1, &scissor);
}

// Opaque materials, then blended ones, each of these with its far side first; lines over all, where
// no geometry shader has fragments draw them. Back faces in a colour of their own are always a
// drawing of their own.
static girih_result draw_materials(const recording *r, const girih_drawing *drawing, uint32_t slice,
                                   girih_error *error) {
    bool has_back_face_color = r->picture->has_back_face_color;
    girih_result result = GIRIH_OK;
    int layers = r->picture->wireframe && !uses_triangles(r) ? 3 : 2;
    for (int layer = 0; layer < layers; layer++) {
        for (uint32_t n = 0; n < r->renderer->desc.model->material_count && result == GIRIH_OK;
             n++) {
            const girih_gltf_material *material = girih_renderer_material(r->renderer, n);
            bool is_blended = material != NULL && material->alpha_mode == GIRIH_GLTF_ALPHA_BLEND;
            bool two_sided = has_back_face_color || (material != NULL && material->double_sided);
            VkCullModeFlags cull = two_sided ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT;
            if (layer == 2) {
                result = draw_material(r, drawing, slice, n, cull, true, error);
            } else if (layer == (is_blended ? 1 : 0)) {
                if (two_sided && (is_blended || has_back_face_color)) {
                    result =
                        draw_material(r, drawing, slice, n, VK_CULL_MODE_FRONT_BIT, false, error);
                    cull = VK_CULL_MODE_BACK_BIT;
                }
                if (result == GIRIH_OK) {
                    result = draw_material(r, drawing, slice, n, cull, false, error);
                }
            }
        }
    }
    return result;
}

static void draw_divider(const recording *r) {
    const girih_attachments *attachments = &r->renderer->attachments;
    uint32_t width = attachments->width >= 4 ? 2 : 1;
    VkClearAttachment clear = {
        VK_IMAGE_ASPECT_COLOR_BIT, 0, {.color = {{0.25f, 0.26f, 0.28f, 1.0f}}}};
    VkClearRect rect = {
        {{(int32_t)((attachments->width - width) / 2), 0}, {width, attachments->height}}, 0, 1};
    vkCmdClearAttachments(r->commands, 1, &clear, 1, &rect);
}

static girih_result draw_pass(const recording *r, girih_error *error) {
    girih_renderer *renderer = r->renderer;
    const girih_picture *picture = r->picture;
    VkPipeline background;
    girih_pipeline_key key = {.background = true};
    girih_result result =
        girih_pipelines_get(&renderer->pipelines, &key, NULL, NULL, &background, error);
    if (result != GIRIH_OK) {
        return result;
    }
    VkClearValue clears[3] = {{.depthStencil = {0.0f, 0}}}; // reversed depth: 0 is far
    VkRenderPassBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
        .renderPass = renderer->attachments.pass,
        .framebuffer = renderer->attachments.framebuffer,
        .renderArea = {{0, 0}, {renderer->attachments.width, renderer->attachments.height}},
        .clearValueCount = 3,
        .pClearValues = clears,
    };
    vkCmdBeginRenderPass(r->commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    set_viewport(r, 0, renderer->attachments.width);
    if (!picture->transparent) {
        vkCmdBindPipeline(r->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, background);
        vkCmdDraw(r->commands, 3, 1, 0, 0);
    }
    uint32_t slice_count = girih_picture_slice_count(picture->view);
    for (uint32_t n = 0; n < picture->drawing_count && result == GIRIH_OK; n++) {
        const girih_drawing *drawing = &picture->drawings[n];
        for (uint32_t k = 0; k < slice_count && result == GIRIH_OK; k++) {
            girih_panorama_slice slice = girih_picture_slice(picture->view, k, drawing->width);
            if (slice.width > 0) {
                set_viewport(r, drawing->x + slice.x, slice.width);
                result = draw_materials(r, drawing, k, error);
            }
        }
    }
    if (picture->drawing_count > 1) {
        draw_divider(r);
    }
    girih_overlay_painter_record(&renderer->overlays[r->frame], r->commands);
    vkCmdEndRenderPass(r->commands);
    return result;
}

girih_result girih_renderer_record(girih_renderer *renderer, VkCommandBuffer commands,
                                   uint32_t frame, const girih_picture *picture,
                                   girih_error *error) {
    const recording r = {renderer, commands, frame, picture};
    for (uint32_t n = 0; n < girih_picture_slice_count(picture->view); n++) {
        girih_picture_block block = girih_picture_fill(
            picture, renderer->desc.model, renderer->range_count, renderer->attachments.height, n);
        memcpy((char *)renderer->picture_blocks.mapped + block_offset(&r, n), &block, sizeof block);
    }
    return draw_pass(&r, error);
}

// --- One picture, read back ---

static girih_result submit_drawing(girih_renderer *renderer, const girih_picture *picture,
                                   const girih_device_buffer *readback, VkQueryPool queries,
                                   girih_error *error) {
    girih_device *device = renderer->device;
    VkCommandBuffer commands = device->commands;
    girih_result result = girih_device_begin(device, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (queries != VK_NULL_HANDLE) {
        vkCmdResetQueryPool(commands, queries, 0, 2);
        vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries, 0);
    }
    result = girih_renderer_record(renderer, commands, 0, picture, error);
    if (queries != VK_NULL_HANDLE) {
        vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries, 1);
    }
    VkBufferImageCopy copy = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {renderer->attachments.width, renderer->attachments.height, 1},
    };
    vkCmdCopyImageToBuffer(commands, girih_renderer_image(renderer),
                           VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback->buffer, 1, &copy);
    girih_device_full_barrier(commands);
    if (result != GIRIH_OK) {
        vkEndCommandBuffer(commands);
        return result;
    }
    return girih_device_finish(device, error);
}

girih_result girih_renderer_draw(girih_renderer *renderer, const girih_picture *picture,
                                 uint8_t *rgba, double *milliseconds, girih_error *error) {
    const girih_device *device = renderer->device;
    size_t size = (size_t)renderer->attachments.width * renderer->attachments.height * 4;
    girih_device_buffer readback = {0};
    VkQueryPool queries = VK_NULL_HANDLE;
    girih_result result = girih_device_buffer_create(
        device, &readback, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, GIRIH_MEMORY_READBACK, error);
    if (result == GIRIH_OK) {
        result = girih_device_queries(device, 2, &queries, error);
    }
    if (result == GIRIH_OK) {
        result = submit_drawing(renderer, picture, &readback, queries, error);
    }
    if (result == GIRIH_OK) {
        memcpy(rgba, readback.mapped, size);
        double times[2];
        *milliseconds = girih_device_read_queries(device, queries, 0, 2, times) ? times[1] : -1.0;
    }
    vkDestroyQueryPool(device->device, queries, NULL);
    girih_device_buffer_destroy(device, &readback);
    return result;
}
