// Images, render pass, the view's uniform blocks, and capture.
#include "target_private.h"

#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "error.h"

#include "bench_shaders.h"

static girih_result create_images(bench_target *target, girih_error *error) {
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = VK_FORMAT_R8G8B8A8_UNORM,
                              .extent = {BENCH_PIXELS, BENCH_PIXELS, 1},
                              .mipLevels = 1,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                       VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    girih_result result = girih_device_image_create(target->device, &target->color, &info,
                                                    VK_IMAGE_ASPECT_COLOR_BIT, error);
    if (result == GIRIH_OK) {
        info.format = VK_FORMAT_D32_SFLOAT;
        info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
        result = girih_device_image_create(target->device, &target->depth, &info,
                                           VK_IMAGE_ASPECT_DEPTH_BIT, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_buffer_create(
            target->device, &target->picture, 4 * BENCH_PIXELS * BENCH_PIXELS,
            VK_BUFFER_USAGE_TRANSFER_DST_BIT, GIRIH_MEMORY_READBACK, error);
    }
    return result;
}

static VkResult create_pass(bench_target *target) {
    const VkAttachmentDescription attachments[2] = {
        {.format = VK_FORMAT_R8G8B8A8_UNORM,
         .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
         .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
        {.format = VK_FORMAT_D32_SFLOAT,
         .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                          .colorAttachmentCount = 1,
                                          .pColorAttachments = &color,
                                          .pDepthStencilAttachment = &depth};
    const VkSubpassDependency ends = {.srcSubpass = 0,
                                      .dstSubpass = VK_SUBPASS_EXTERNAL,
                                      .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                      .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                      .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                                      .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT};
    const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .attachmentCount = 2,
                                         .pAttachments = attachments,
                                         .subpassCount = 1,
                                         .pSubpasses = &subpass,
                                         .dependencyCount = 1,
                                         .pDependencies = &ends};
    const VkDevice device = target->device->device;
    VkResult result = vkCreateRenderPass(device, &info, NULL, &target->pass);
    if (result == VK_SUCCESS) {
        const VkImageView views[2] = {target->color.view, target->depth.view};
        const VkFramebufferCreateInfo framebuffer = {.sType =
                                                         VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                     .renderPass = target->pass,
                                                     .attachmentCount = 2,
                                                     .pAttachments = views,
                                                     .width = BENCH_PIXELS,
                                                     .height = BENCH_PIXELS,
                                                     .layers = 1};
        result = vkCreateFramebuffer(device, &framebuffer, NULL, &target->framebuffer);
    }
    if (result == VK_SUCCESS) {
        const VkShaderModuleCreateInfo fragment = {.sType =
                                                       VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                                   .codeSize = bench_shader_fragment.bytes,
                                                   .pCode = bench_shader_fragment.words};
        result = vkCreateShaderModule(device, &fragment, NULL, &target->fragment);
    }
    return result;
}

// The pass of transform feedback that is not drawn.
static VkResult create_empty_pass(bench_target *target) {
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS};
    const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .subpassCount = 1,
                                         .pSubpasses = &subpass};
    const VkDevice device = target->device->device;
    VkResult result = vkCreateRenderPass(device, &info, NULL, &target->empty_pass);
    if (result == VK_SUCCESS) {
        const VkFramebufferCreateInfo framebuffer = {.sType =
                                                         VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                     .renderPass = target->empty_pass,
                                                     .width = 1,
                                                     .height = 1,
                                                     .layers = 1};
        result = vkCreateFramebuffer(device, &framebuffer, NULL, &target->empty_framebuffer);
    }
    return result;
}

// --- The view -----------------------------------------------------------------------------------

static VkResult create_view_set(bench_target *target) {
    const VkDevice device = target->device->device;
    VkDescriptorSetLayoutBinding bindings[2];
    for (uint32_t n = 0; n < 2; ++n) {
        bindings[n] =
            (VkDescriptorSetLayoutBinding){.binding = n,
                                           .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                           .descriptorCount = 1,
                                           .stageFlags = bench_target_stages(target)};
    }
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 2,
        .pBindings = bindings};
    VkResult result = vkCreateDescriptorSetLayout(device, &layout, NULL, &target->view_layout);
    if (result == VK_SUCCESS) {
        const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 2};
        const VkDescriptorPoolCreateInfo pool = {.sType =
                                                     VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                                 .maxSets = 1,
                                                 .poolSizeCount = 1,
                                                 .pPoolSizes = &size};
        result = vkCreateDescriptorPool(device, &pool, NULL, &target->view_pool);
    }
    if (result == VK_SUCCESS) {
        const VkDescriptorSetAllocateInfo allocate = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
            .descriptorPool = target->view_pool,
            .descriptorSetCount = 1,
            .pSetLayouts = &target->view_layout};
        result = vkAllocateDescriptorSets(device, &allocate, &target->view_set);
    }
    if (result == VK_SUCCESS) {
        const VkDescriptorBufferInfo infos[2] = {
            {.buffer = target->view.buffer, .range = sizeof(bench_view)},
            {.buffer = target->view.buffer,
             .offset = target->frame_offset,
             .range = sizeof(girih_frame_block)}};
        const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = target->view_set,
                                            .descriptorCount = 2,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                            .pBufferInfo = infos};
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    return result;
}

void bench_target_use_panorama(bench_target *target) {
    target->cylindrical = VK_TRUE;
}

girih_result bench_target_set_view(bench_target *target, const bench_view *view,
                                   const girih_catalogue *catalogue, const girih_frame *frame,
                                   girih_error *error) {
    girih_arrays arrays = {.frame.level_count = catalogue->level_count,
                           .frame.last_level = catalogue->level_count - 1,
                           .frame.linear_spacing = catalogue->spacing == GIRIH_SPACING_LINEAR};
    const girih_result result = girih_pack_frame(&arrays, frame, error);
    if (result == GIRIH_OK) {
        char *bytes = target->view.mapped;
        memcpy(bytes, view, sizeof *view);
        memcpy(bytes + target->frame_offset, &arrays.frame, sizeof arrays.frame);
    }
    return result;
}

// --- The target ---------------------------------------------------------------------------------

static void find_feedback(bench_target *target) {
    if (!target->device->has_transform_feedback) {
        return;
    }
    const VkDevice device = target->device->device;
    target->feedback =
        (bench_feedback){.bind = (PFN_vkCmdBindTransformFeedbackBuffersEXT)vkGetDeviceProcAddr(
                             device, "vkCmdBindTransformFeedbackBuffersEXT"),
                         .begin = (PFN_vkCmdBeginTransformFeedbackEXT)vkGetDeviceProcAddr(
                             device, "vkCmdBeginTransformFeedbackEXT"),
                         .end = (PFN_vkCmdEndTransformFeedbackEXT)vkGetDeviceProcAddr(
                             device, "vkCmdEndTransformFeedbackEXT"),
                         .draw_indirect = (PFN_vkCmdDrawIndirectByteCountEXT)vkGetDeviceProcAddr(
                             device, "vkCmdDrawIndirectByteCountEXT")};
}

girih_result bench_target_create(girih_device *device, bench_target **out, girih_error *error) {
    bench_target *target = calloc(1, sizeof *target);
    if (!target) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    target->device = device;
    find_feedback(target);
    const VkDeviceSize alignment = device->properties.limits.minUniformBufferOffsetAlignment;
    target->frame_offset = (sizeof(bench_view) + alignment - 1) / alignment * alignment;
    girih_result result = create_images(target, error);
    if (result == GIRIH_OK) {
        result = girih_device_buffer_create(
            device, &target->view, target->frame_offset + sizeof(girih_frame_block),
            VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GIRIH_MEMORY_UPLOAD, error);
    }
    if (result == GIRIH_OK && device->has_transform_feedback) {
        result = girih_device_buffer_create(
            device, &target->counter, 4, VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_COUNTER_BUFFER_BIT_EXT,
            GIRIH_MEMORY_READBACK, error);
    }
    if (result == GIRIH_OK) {
        VkResult created = create_pass(target);
        if (created == VK_SUCCESS) {
            created = create_empty_pass(target);
        }
        if (created == VK_SUCCESS) {
            created = create_view_set(target);
        }
        if (created != VK_SUCCESS) {
            result = girih_vulkan_failure(error, "creating the bench's render pass", created);
        }
    }
    if (result != GIRIH_OK) {
        bench_target_destroy(target);
        return result;
    }
    *out = target;
    return GIRIH_OK;
}

void bench_target_destroy(bench_target *target) {
    if (!target) {
        return;
    }
    const VkDevice device = target->device->device;
    vkDestroyDescriptorPool(device, target->view_pool, NULL);
    vkDestroyDescriptorSetLayout(device, target->view_layout, NULL);
    vkDestroyShaderModule(device, target->fragment, NULL);
    vkDestroyFramebuffer(device, target->empty_framebuffer, NULL);
    vkDestroyRenderPass(device, target->empty_pass, NULL);
    vkDestroyFramebuffer(device, target->framebuffer, NULL);
    vkDestroyRenderPass(device, target->pass, NULL);
    girih_device_buffer_destroy(target->device, &target->counter);
    girih_device_buffer_destroy(target->device, &target->captured);
    girih_device_buffer_destroy(target->device, &target->picture);
    girih_device_buffer_destroy(target->device, &target->view);
    girih_device_image_destroy(target->device, &target->depth);
    girih_device_image_destroy(target->device, &target->color);
    free(target);
}

const bench_feedback *bench_target_feedback(const bench_target *target) {
    return target->device->has_transform_feedback ? &target->feedback : NULL;
}

// --- Frames -------------------------------------------------------------------------------------

void bench_target_begin(const bench_target *target, VkCommandBuffer commands, bench_raster raster) {
    const uint32_t size = raster == BENCH_SHADED ? BENCH_PIXELS : 1;
    const VkClearValue clears[2] = {{.color = {.float32 = {0, 0, 0, 1}}},
                                    {.depthStencil = {.depth = 1}}};
    const VkRect2D all = {.extent = {size, size}};
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = target->pass,
                                        .framebuffer = target->framebuffer,
                                        .renderArea = all,
                                        .clearValueCount = 2,
                                        .pClearValues = clears};
    const VkViewport viewport = {.width = (float)size, .height = (float)size, .maxDepth = 1};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &all);
}

void bench_target_end(const bench_target *target, VkCommandBuffer commands) {
    (void)target;
    vkCmdEndRenderPass(commands);
}

void bench_feedback_begin(const bench_target *target, VkCommandBuffer commands) {
    const VkRect2D all = {.extent = {1, 1}};
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = target->empty_pass,
                                        .framebuffer = target->empty_framebuffer,
                                        .renderArea = all};
    const VkViewport viewport = {.width = 1, .height = 1, .maxDepth = 1};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &all);
}

void bench_feedback_end(const bench_target *target, VkCommandBuffer commands) {
    (void)target;
    vkCmdEndRenderPass(commands);
}

girih_result bench_capture_reserve(bench_target *target, uint32_t triangles, girih_error *error) {
    if (!target->device->has_transform_feedback) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "capturing triangles needs VK_EXT_transform_feedback");
    }
    // One more than is expected: where it is filled there may have been even more.
    const uint32_t room = triangles + 1;
    girih_result result = GIRIH_OK;
    if (room > target->capture_room) {
        girih_device_buffer_destroy(target->device, &target->captured);
        target->capture_room = 0;
        result = girih_device_buffer_create(
            target->device, &target->captured, (VkDeviceSize)room * 3 * BENCH_CORNER_BYTES,
            VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_BUFFER_BIT_EXT, GIRIH_MEMORY_READBACK, error);
    }
    if (result == GIRIH_OK) {
        target->capture_room = room > target->capture_room ? room : target->capture_room;
        *(uint32_t *)target->counter.mapped = 0;
    }
    return result;
}

void bench_begin_draws(bench_target *target, VkCommandBuffer commands, bench_raster raster) {
    if (raster == BENCH_CAPTURE) {
        const VkDeviceSize offset = 0;
        target->feedback.bind(commands, 0, 1, &target->captured.buffer, &offset,
                              &target->captured.size);
        target->feedback.begin(commands, 0, 0, NULL, NULL);
    }
}

void bench_end_draws(bench_target *target, VkCommandBuffer commands, bench_raster raster) {
    if (raster == BENCH_CAPTURE) {
        const VkDeviceSize offset = 0;
        target->feedback.end(commands, 0, 1, &target->counter.buffer, &offset);
    }
}

girih_result bench_capture_read(bench_target *target, bench_triangles *triangles,
                                girih_error *error) {
    const uint32_t bytes = *(const uint32_t *)target->counter.mapped;
    *triangles = (bench_triangles){.count = bytes / (3 * BENCH_CORNER_BYTES)};
    // Full to the last triangle: there may have been more.
    if (triangles->count >= target->capture_room) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "a frame has more than the %u triangles that were expected of it",
                          target->capture_room - 1);
    }
    triangles->corners = malloc(bytes + 1u);
    if (!triangles->corners) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    memcpy(triangles->corners, target->captured.mapped, bytes);
    return GIRIH_OK;
}

girih_result bench_target_picture(bench_target *target, uint8_t **rgba, girih_error *error) {
    const size_t bytes = (size_t)4 * BENCH_PIXELS * BENCH_PIXELS;
    *rgba = malloc(bytes);
    if (!*rgba) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = girih_device_begin(target->device, error);
    if (result == GIRIH_OK) {
        const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                        .imageExtent = {BENCH_PIXELS, BENCH_PIXELS, 1}};
        vkCmdCopyImageToBuffer(target->device->commands, target->color.image,
                               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target->picture.buffer, 1,
                               &copy);
        girih_device_full_barrier(target->device->commands);
        result = girih_device_finish(target->device, error);
    }
    if (result == GIRIH_OK) {
        memcpy(*rgba, target->picture.mapped, bytes);
    } else {
        free(*rgba);
        *rgba = NULL;
    }
    return result;
}
