// Triangles beyond the catalogue, recorded: glsl/split.comp, pass by pass.
#include "context.h"

// A pass goes over all triangles, or over the parts that the pass before it made.
static void record_kernel(const girih_plan *plan, VkCommandBuffer commands, uint32_t shader,
                          uint32_t pass) {
    girih_bind_pipeline(plan, commands, shader, 0);
    if (pass == 0) {
        girih_dispatch_invocations(plan, commands, plan->arrays.frame.triangle_count,
                                   GIRIH_SPLIT_BLOCK);
    } else {
        girih_dispatch_items(plan, commands,
                             GIRIH_STATUS_SPLIT_PASS + pass % 2 * GIRIH_SPLIT_PASS_WORDS +
                                 GIRIH_SPLIT_PASS_DISPATCH);
    }
}

void girih_record_split(const girih_plan *plan, VkCommandBuffer commands) {
    const uint32_t passes = plan->arrays.frame.split_passes;
    for (uint32_t pass = 0; pass < passes; ++pass) {
        const girih_push_block push = {
            .shift = pass, .first_pass = pass == 0, .to_spare = pass == passes - 1};
        girih_push(plan, commands, &push);
        record_kernel(plan, commands, GIRIH_SHADER_split_count, pass);
        girih_compute_barrier(plan->context, commands);
        girih_bind_pipeline(plan, commands, GIRIH_SHADER_split_sums, 0);
        girih_dispatch_invocations(plan, commands, 1, GIRIH_SPLIT_BLOCK);
        girih_compute_barrier(plan->context, commands);
        record_kernel(plan, commands, GIRIH_SHADER_split_parts, pass);
        girih_compute_barrier(plan->context, commands);
    }
}
