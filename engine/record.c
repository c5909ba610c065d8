// One frame recorded into the host's command buffer: the six stages in order, and the draw.
#include <stddef.h>
#include <string.h>

#include "context.h"
#include "error.h"

void girih_barrier(const girih_context *context, VkCommandBuffer commands,
                   VkPipelineStageFlags from_stage, VkAccessFlags from_access,
                   VkPipelineStageFlags to_stage, VkAccessFlags to_access) {
    if (context->compute_only) {
        const VkPipelineStageFlags stages =
            ~(VkPipelineStageFlags)(VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
                                    VK_PIPELINE_STAGE_VERTEX_SHADER_BIT);
        from_stage &= stages;
        to_stage &= stages;
        to_access &=
            ~(VkAccessFlags)(VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT);
    }
    const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = from_access,
                                     .dstAccessMask = to_access};
    context->vk.CmdPipelineBarrier(commands, from_stage, to_stage, 0, 1, &barrier, 0, NULL, 0,
                                   NULL);
}

void girih_compute_barrier(const girih_context *context, VkCommandBuffer commands) {
    girih_barrier(context, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                  VK_ACCESS_SHADER_WRITE_BIT,
                  VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                      VK_ACCESS_INDIRECT_COMMAND_READ_BIT);
}

void girih_bind_pipeline(const girih_plan *plan, VkCommandBuffer commands, uint32_t shader,
                         uint32_t further) {
    plan->context->vk.CmdBindPipeline(
        commands, VK_PIPELINE_BIND_POINT_COMPUTE,
        girih_pipeline_get(plan->context, shader, plan->variant | further));
}

void girih_bind_set(const girih_plan *plan, VkCommandBuffer commands, uint32_t set) {
    plan->context->vk.CmdBindDescriptorSets(
        commands, VK_PIPELINE_BIND_POINT_COMPUTE, plan->context->pipeline_layout,
        plan->context->placement.set, 1, &plan->sets[set], 0, NULL);
}

void girih_push(const girih_plan *plan, VkCommandBuffer commands, const girih_push_block *push) {
    plan->context->vk.CmdPushConstants(commands, plan->context->pipeline_layout,
                                       plan->context->placement.push_stages,
                                       plan->context->placement.push_offset, sizeof *push, push);
}

void girih_dispatch_invocations(const girih_plan *plan, VkCommandBuffer commands,
                                uint64_t invocations, uint32_t size) {
    const uint64_t workgroups = (invocations + size - 1) / size;
    if (workgroups == 0) {
        return;
    }
    // 65,535 workgroups in a dimension are what every device takes.
    const uint32_t rows = (uint32_t)((workgroups + 65534) / 65535);
    plan->context->vk.CmdDispatch(commands, rows > 1 ? 65535 : (uint32_t)workgroups, rows, 1);
}

void girih_dispatch_items(const girih_plan *plan, VkCommandBuffer commands, uint32_t arguments) {
    const girih_buffer *work = &plan->buffers[GIRIH_PLAN_WORK];
    plan->context->vk.CmdDispatchIndirect(commands, work->buffer,
                                          work->offset + plan->offset[GIRIH_BIND_STATUS] +
                                              4 * (VkDeviceSize)arguments);
}

static void timestamp(const girih_plan *plan, VkCommandBuffer commands,
                      const girih_timestamps *timestamps, uint32_t n) {
    if (timestamps && timestamps->pool) {
        plan->context->vk.CmdWriteTimestamp(commands,
                                            n == 0 ? VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT
                                                   : VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                            timestamps->pool, timestamps->first + n);
        // lavapipe takes a timestamp only when something after it has to wait.
        girih_compute_barrier(plan->context, commands);
    }
}

// Instances and blocks, the frame block, and what the stages expect to be cleared.
static void record_begin(girih_plan *plan, VkCommandBuffer commands) {
    const girih_functions *vk = &plan->context->vk;
    const girih_arrays *arrays = &plan->arrays;
    const VkPipelineStageFlags users =
        VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
        VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT |
        VK_PIPELINE_STAGE_TRANSFER_BIT;
    girih_barrier(
        plan->context, commands, users, VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
        VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
    const girih_buffer *work = &plan->buffers[GIRIH_PLAN_WORK];
    const girih_buffer *staging = &plan->buffers[GIRIH_PLAN_STAGING];
    const VkDeviceSize instances = arrays->count[GIRIH_BIND_INSTANCES] * 4;
    const VkBufferCopy copies[2] = {{.srcOffset = staging->offset,
                                     .dstOffset = work->offset + plan->offset[GIRIH_BIND_INSTANCES],
                                     .size = instances},
                                    {.srcOffset = staging->offset + instances,
                                     .dstOffset = work->offset + plan->offset[GIRIH_BIND_BLOCKS],
                                     .size = arrays->count[GIRIH_BIND_BLOCKS] * 4}};
    vk->CmdCopyBuffer(commands, staging->buffer, work->buffer, 2, copies);
    vk->CmdUpdateBuffer(commands, work->buffer, work->offset + plan->frame_offset,
                        sizeof arrays->frame, &arrays->frame);
    _Static_assert(GIRIH_BIND_STATUS == GIRIH_BIND_GROUPS + 1 &&
                       GIRIH_BIND_DRAWS == GIRIH_BIND_GROUPS + 2,
                   "groups, status and draws lie side by side");
    const VkDeviceSize cleared = plan->offset[GIRIH_BIND_GROUPS];
    vk->CmdFillBuffer(
        commands, work->buffer, work->offset + cleared,
        plan->offset[GIRIH_BIND_DRAWS] + arrays->count[GIRIH_BIND_DRAWS] * 4 - cleared, 0);
    if (plan->outputs & GIRIH_OUTPUT_PADDED) {
        // All indices 0, of a vertex that is there even if nothing is put out.
        for (uint32_t n = GIRIH_PLAN_INDICES; n <= GIRIH_PLAN_CLOSED_INDICES; ++n) {
            const girih_buffer *list = &plan->buffers[n];
            if (list->buffer) {
                vk->CmdFillBuffer(commands, list->buffer, list->offset, list->size, 0);
            }
        }
        const girih_buffer *positions = &plan->buffers[GIRIH_PLAN_POSITIONS];
        vk->CmdFillBuffer(commands, positions->buffer, positions->offset, 12, 0);
    }
    girih_barrier(plan->context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                      VK_ACCESS_UNIFORM_READ_BIT);
}

// Stages 1 to 4: what is to be drawn, all of it counted and placed.
static void record_stages(const girih_plan *plan, VkCommandBuffer commands,
                          const girih_timestamps *timestamps) {
    const girih_context *context = plan->context;
    if (plan->small) {
        girih_record_small(plan, commands);
        girih_compute_barrier(context, commands);
        for (uint32_t n = 1; n <= 4; ++n) {
            timestamp(plan, commands, timestamps, n);
        }
        return;
    }
    girih_record_levels(plan, commands);
    girih_compute_barrier(context, commands);
    timestamp(plan, commands, timestamps, 1);
    girih_record_select(plan, commands);
    girih_compute_barrier(context, commands);
    girih_record_split(plan, commands);
    timestamp(plan, commands, timestamps, 2);
    girih_record_group(plan, commands);
    girih_compute_barrier(context, commands);
    timestamp(plan, commands, timestamps, 3);
    if (plan->mode == GIRIH_MODE_WELDED) {
        girih_record_weld(plan, commands);
        girih_compute_barrier(context, commands);
    }
    girih_record_dispatch(plan, commands);
    girih_compute_barrier(context, commands);
    timestamp(plan, commands, timestamps, 4);
}

// Whether the plan's buffers hold this frame already, once what was recorded has been executed.
static bool is_unchanged(const girih_plan *plan, const girih_frame *frame) {
    return plan->current && plan->surface_set == frame->surface_set &&
           plan->recorded_revision == frame->revision &&
           memcmp(&plan->recorded, &plan->arrays.frame, sizeof plan->recorded) == 0;
}

girih_result girih_cmd_refine(girih_plan *plan, VkCommandBuffer commands, const girih_frame *frame,
                              const girih_timestamps *timestamps, girih_error *error) {
    if (!plan || !commands || !frame) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_cmd_refine: plan, commands and frame must be set");
    }
    if ((plan->outputs & GIRIH_OUTPUT_CLOSED_INDICES) &&
        (frame->cull_frustum || frame->cull_back)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_cmd_refine: closed indices cannot be closed where triangles are "
                          "culled; turn culling off");
    }
    if (plan->program && girih_evaluates_own_points(plan) && !frame->surface_set &&
        plan->program->pipeline_layout != plan->context->pipeline_layout) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_cmd_refine: the surface program has a descriptor set of its own; "
                          "surface_set must be set");
    }
    const girih_result result = girih_pack_frame(&plan->arrays, frame, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (plan->program) {
        // Nothing is known of an own surface's normals, and of its points only the reach.
        plan->arrays.frame.cull &= plan->program->reach < 0.0f ? 0 : GIRIH_CULL_FRUSTUM;
    }
    const girih_context *context = plan->context;
    if (is_unchanged(plan, frame)) {
        for (uint32_t n = 0; n < GIRIH_TIMESTAMPS; ++n) {
            timestamp(plan, commands, timestamps, n);
        }
        return GIRIH_OK;
    }
    plan->surface_set = frame->surface_set;
    timestamp(plan, commands, timestamps, 0);
    record_begin(plan, commands);
    girih_bind_set(plan, commands, 0);
    record_stages(plan, commands, timestamps);
    girih_record_evaluate(plan, commands);
    timestamp(plan, commands, timestamps, 5);
    girih_record_output(plan, commands);
    timestamp(plan, commands, timestamps, 6);
    girih_barrier(context, commands,
                  VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
                      VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                      VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_INDEX_READ_BIT |
                      VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_UNIFORM_READ_BIT |
                      VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
    const girih_buffer *work = &plan->buffers[GIRIH_PLAN_WORK];
    const girih_buffer *status = &plan->buffers[GIRIH_PLAN_STATUS];
    const VkBufferCopy copy = {.srcOffset = work->offset + plan->offset[GIRIH_BIND_STATUS],
                               .dstOffset = status->offset,
                               .size = plan->arrays.count[GIRIH_BIND_STATUS] * 4};
    context->vk.CmdCopyBuffer(commands, work->buffer, status->buffer, 1, &copy);
    girih_barrier(context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    plan->recorded = plan->arrays.frame;
    plan->recorded_revision = frame->revision;
    plan->current = true;
    return GIRIH_OK;
}

void girih_cmd_draw(const girih_plan *plan, VkCommandBuffer commands, uint32_t material,
                    VkPipelineLayout layout, uint32_t set) {
    const girih_context *context = plan->context;
    const girih_functions *vk = &context->vk;
    const girih_frame_block *frame = &plan->arrays.frame;
    if (material >= frame->material_count || frame->draws_per_material == 0 ||
        frame->triangle_count == 0) {
        return;
    }
    const bool instanced = plan->mode == GIRIH_MODE_INSTANCED;
    const bool pattern_indices = instanced || frame->pattern_draws;
    const girih_buffer *work = &plan->buffers[GIRIH_PLAN_WORK];
    const girih_buffer *positions = &plan->buffers[GIRIH_PLAN_POSITIONS];
    const girih_buffer *attributes = &plan->buffers[GIRIH_PLAN_ATTRIBUTES];
    const VkBuffer vertex_buffers[2] = {instanced ? context->patterns.buffer : positions->buffer,
                                        attributes->buffer};
    const VkDeviceSize vertex_offsets[2] = {
        instanced ? context->patterns.offset + context->offset[GIRIH_BIND_PATTERN_VERTICES]
                  : positions->offset,
        attributes->offset};
    vk->CmdBindVertexBuffers(commands, 0, 2, vertex_buffers, vertex_offsets);
    if (instanced && layout && (frame->attribute_floats || plan->surface == GIRIH_SURFACE_OWN)) {
        vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, set, 1,
                                  &plan->draw_set, 0, NULL);
    }
    // Bound at 0: lavapipe ignores the offset in indirect draws, so it is in their first index.
    vk->CmdBindIndexBuffer(commands,
                           pattern_indices ? context->indices.buffer
                                           : plan->buffers[GIRIH_PLAN_INDICES].buffer,
                           0, VK_INDEX_TYPE_UINT32);
    const uint32_t stride = sizeof(VkDrawIndexedIndirectCommand);
    VkDeviceSize offset = work->offset + plan->offset[GIRIH_BIND_DRAWS] +
                          (VkDeviceSize)material * frame->draws_per_material * stride;
    // One call takes as many draws as the device allows.
    const uint32_t most =
        context->features.multiDrawIndirect ? context->limits.maxDrawIndirectCount : 1;
    for (uint32_t left = frame->draws_per_material; left;) {
        const uint32_t count = left < most ? left : most;
        vk->CmdDrawIndexedIndirect(commands, work->buffer, offset, count, stride);
        offset += (VkDeviceSize)count * stride;
        left -= count;
    }
}
