// Stage 6, recorded: glsl/output.comp, once for each window of the output.
#include "context.h"

void girih_record_weld(const girih_plan *plan, VkCommandBuffer commands) {
    const girih_frame_block *frame = &plan->arrays.frame;
    girih_bind_pipeline(plan, commands, GIRIH_SHADER_output_weld_blocks, 0);
    girih_dispatch_invocations(plan, commands, frame->scan_block_count, GIRIH_SCAN_WORKGROUP);
    girih_compute_barrier(plan->context, commands);
    girih_bind_pipeline(plan, commands, GIRIH_SHADER_output_weld_sums, 0);
    girih_dispatch_invocations(plan, commands, 1, GIRIH_LARGE_WORKGROUP);
    girih_compute_barrier(plan->context, commands);
    girih_bind_pipeline(plan, commands, GIRIH_SHADER_output_weld_offsets, 0);
    girih_dispatch_invocations(plan, commands, frame->scan_block_count, GIRIH_SCAN_WORKGROUP);
}

void girih_record_output(const girih_plan *plan, VkCommandBuffer commands) {
    if (plan->triangle_windows == 0) {
        return;
    }
    const uint32_t wanted =
        plan->outputs & (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES);
    // With few buffers the lists share one binding, so each has descriptors and a dispatch of its
    // own.
    const uint32_t families = plan->context->few_buffers ? 3 : 1;
    for (uint32_t family = 0; family < families; ++family) {
        const uint32_t outputs = families == 1 ? wanted : wanted & 1u << family;
        if (outputs == 0) {
            continue;
        }
        girih_bind_pipeline(plan, commands, GIRIH_SHADER_output_lists,
                            outputs << GIRIH_VARIANT_OUTPUT_SHIFT);
        for (uint32_t window = 0; window < plan->triangle_windows; ++window) {
            const girih_push_block push = {.window_first = window * plan->triangle_window,
                                           .window_count = plan->triangle_window};
            girih_bind_set(plan, commands,
                           families == 1 ? window : (1 + family) * plan->window_count + window);
            girih_push(plan, commands, &push);
            girih_dispatch_items(plan, commands, GIRIH_STATUS_EVALUATE);
        }
    }
}
