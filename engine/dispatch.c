// Stage 4, recorded: glsl/dispatch.comp.
#include "context.h"

uint32_t girih_dispatch_shader(const girih_plan *plan) {
    // Eight lanes would have too many groups each: lavapipe ends all loops of an invocation after
    // 65,535 turns.
    return plan->context->serial_sort && plan->arrays.frame.group_count <= GIRIH_FEW_GROUPS
               ? GIRIH_SHADER_dispatch_groups_serial
               : GIRIH_SHADER_dispatch_groups_workgroup;
}

void girih_record_dispatch(const girih_plan *plan, VkCommandBuffer commands) {
    const girih_frame_block *frame = &plan->arrays.frame;
    girih_bind_pipeline(plan, commands, girih_dispatch_shader(plan), 0);
    girih_dispatch_invocations(plan, commands, 1, 1);
    if (plan->mode != GIRIH_MODE_INSTANCED && frame->draws_per_material) {
        girih_compute_barrier(plan->context, commands);
        girih_bind_pipeline(plan, commands, GIRIH_SHADER_dispatch_draws, 0);
        girih_dispatch_invocations(plan, commands,
                                   (uint64_t)frame->draws_per_material * frame->material_count,
                                   GIRIH_WORKGROUP);
    }
}
