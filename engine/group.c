// Stage 3, recorded: glsl/group.comp, digit by digit.
#include "context.h"

void girih_record_group(const girih_plan *plan, VkCommandBuffer commands) {
    const girih_context *context = plan->context;
    const girih_frame_block *frame = &plan->arrays.frame;
    const bool serial = context->serial_sort;
    uint32_t bits;
    const uint32_t passes = girih_sort_passes(frame->group_count, &bits);
    const uint64_t block_invocations =
        (uint64_t)frame->sort_block_count * (serial ? 1 : GIRIH_LARGE_WORKGROUP);
    const uint32_t block_size = serial ? GIRIH_SERIAL_WORKGROUP : GIRIH_LARGE_WORKGROUP;
    for (uint32_t pass = 0; pass < passes; ++pass) {
        if (pass > 0) {
            girih_compute_barrier(context, commands);
        }
        const girih_push_block push = {.shift = pass * bits,
                                       .bins = 1u << bits,
                                       .first_pass = pass == 0,
                                       .to_spare =
                                           (passes - 1 - pass) % 2}; // the last pass ends in ITEMS
        girih_push(plan, commands, &push);
        girih_bind_pipeline(
            plan, commands,
            serial ? GIRIH_SHADER_group_count_serial : GIRIH_SHADER_group_count_workgroup, 0);
        girih_dispatch_invocations(plan, commands, block_invocations, block_size);
        girih_compute_barrier(context, commands);
        girih_bind_pipeline(
            plan, commands,
            serial ? GIRIH_SHADER_group_blocks_serial : GIRIH_SHADER_group_blocks_workgroup, 0);
        girih_dispatch_invocations(
            plan, commands, (uint64_t)push.bins * (serial ? 1 : GIRIH_LARGE_WORKGROUP), block_size);
        girih_compute_barrier(context, commands);
        girih_bind_pipeline(
            plan, commands,
            serial ? GIRIH_SHADER_group_digits_serial : GIRIH_SHADER_group_digits_workgroup, 0);
        girih_dispatch_invocations(plan, commands, 1, 1);
        girih_compute_barrier(context, commands);
        girih_bind_pipeline(
            plan, commands,
            serial ? GIRIH_SHADER_group_place_serial : GIRIH_SHADER_group_place_workgroup, 0);
        girih_dispatch_invocations(plan, commands, block_invocations, block_size);
    }
    if (passes > 1) {
        girih_compute_barrier(context, commands);
        girih_bind_pipeline(plan, commands, GIRIH_SHADER_group_bounds, 0);
        girih_dispatch_invocations(plan, commands, frame->group_count, GIRIH_LARGE_WORKGROUP);
    }
}
