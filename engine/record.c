// One frame recorded into the host's command buffer: the six stages in order, and the draw.
#include <stddef.h>

#include "context.h"
#include "error.h"

void girih_barrier(const girih_context *context, VkCommandBuffer commands,
                   VkPipelineStageFlags from_stage, VkAccessFlags from_access,
                   VkPipelineStageFlags to_stage, VkAccessFlags to_access) {
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
    plan->context->vk.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                                            plan->context->pipeline_layout, 0, 1, &plan->sets[set],
                                            0, NULL);
}

void girih_push(const girih_plan *plan, VkCommandBuffer commands, const girih_push_block *push) {
    plan->context->vk.CmdPushConstants(commands, plan->context->pipeline_layout,
                                       VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof *push, push);
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

void girih_dispatch_items(const girih_plan *plan, VkCommandBuffer commands) {
    plan->context->vk.CmdDispatchIndirect(
        commands, plan->buffer.buffer, plan->offset[GIRIH_BIND_STATUS] + 4 * GIRIH_STATUS_EVALUATE);
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
    // Copied every time: a recording that was never submitted must not be counted on.
    const VkDeviceSize instances = arrays->count[GIRIH_BIND_INSTANCES] * 4;
    const VkBufferCopy copies[2] = {
        {.dstOffset = plan->offset[GIRIH_BIND_INSTANCES], .size = instances},
        {.srcOffset = instances,
         .dstOffset = plan->offset[GIRIH_BIND_BLOCKS],
         .size = arrays->count[GIRIH_BIND_BLOCKS] * 4}};
    vk->CmdCopyBuffer(commands, plan->staging.buffer, plan->buffer.buffer, 2, copies);
    vk->CmdUpdateBuffer(commands, plan->buffer.buffer, plan->frame_offset, sizeof arrays->frame,
                        &arrays->frame);
    vk->CmdFillBuffer(commands, plan->buffer.buffer, plan->offset[GIRIH_BIND_GROUPS],
                      arrays->count[GIRIH_BIND_GROUPS] * 4, 0);
    vk->CmdFillBuffer(commands, plan->buffer.buffer, plan->offset[GIRIH_BIND_STATUS],
                      arrays->count[GIRIH_BIND_STATUS] * 4, 0);
    girih_barrier(plan->context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                      VK_ACCESS_UNIFORM_READ_BIT);
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
    const girih_result result = girih_pack_frame(&plan->arrays, frame, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const girih_context *context = plan->context;
    timestamp(plan, commands, timestamps, 0);
    record_begin(plan, commands);
    girih_bind_set(plan, commands, 0);
    girih_record_levels(plan, commands);
    girih_compute_barrier(context, commands);
    timestamp(plan, commands, timestamps, 1);
    girih_record_select(plan, commands);
    girih_compute_barrier(context, commands);
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
                      VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_SHADER_READ_BIT |
                      VK_ACCESS_TRANSFER_READ_BIT);
    const VkBufferCopy status = {.srcOffset = plan->offset[GIRIH_BIND_STATUS],
                                 .size = plan->arrays.count[GIRIH_BIND_STATUS] * 4};
    context->vk.CmdCopyBuffer(commands, plan->buffer.buffer, plan->status.buffer, 1, &status);
    girih_barrier(context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
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
    if (instanced) {
        const VkBuffer buffers[2] = {context->patterns.buffer, plan->attributes.buffer};
        const VkDeviceSize offsets[2] = {context->offset[GIRIH_BIND_PATTERN_VERTICES], 0};
        vk->CmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
        if (layout && frame->attribute_floats) {
            vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, set, 1,
                                      &plan->scene->draw_set, 0, NULL);
        }
    } else {
        const VkBuffer buffers[2] = {plan->positions.buffer, plan->attributes.buffer};
        const VkDeviceSize offsets[2] = {0, 0};
        vk->CmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
    }
    vk->CmdBindIndexBuffer(
        commands, pattern_indices ? context->indices.buffer : plan->index_list.buffer, 0,
        pattern_indices && frame->index_bytes == 2 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32);
    const uint32_t stride = sizeof(VkDrawIndexedIndirectCommand);
    VkDeviceSize offset = plan->offset[GIRIH_BIND_DRAWS] +
                          (VkDeviceSize)material * frame->draws_per_material * stride;
    // One call takes as many draws as the device allows.
    const uint32_t most =
        context->features.multiDrawIndirect ? context->limits.maxDrawIndirectCount : 1;
    for (uint32_t left = frame->draws_per_material; left;) {
        const uint32_t count = left < most ? left : most;
        vk->CmdDrawIndexedIndirect(commands, plan->buffer.buffer, offset, count, stride);
        offset += (VkDeviceSize)count * stride;
        left -= count;
    }
}
