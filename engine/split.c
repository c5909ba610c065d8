// Triangles beyond the catalogue, recorded: glsl/split.comp, pass by pass.
#include "context.h"

static uint32_t pass_word(uint32_t pass, uint32_t field) {
    return GIRIH_STATUS_SPLIT_PASS + pass % 2 * GIRIH_SPLIT_PASS_WORDS + field;
}

// Over all triangles, or all parts that the pass before made, a lane a block.
static void record_marks(const girih_plan *plan, VkCommandBuffer commands, uint32_t shader,
                         uint32_t pass) {
    girih_bind_pipeline(plan, commands, shader, 0);
    if (pass == 0) {
        const uint64_t blocks =
            (plan->arrays.frame.triangle_count + (uint64_t)GIRIH_SPLIT_BLOCK - 1) /
            GIRIH_SPLIT_BLOCK;
        girih_dispatch_invocations(plan, commands, blocks, GIRIH_SCAN_WORKGROUP);
    } else {
        girih_dispatch_items(plan, commands, pass_word(pass, GIRIH_SPLIT_PASS_MARKS));
    }
    girih_compute_barrier(plan->context, commands);
}

// Over what is split alone.
static void record_splits(const girih_plan *plan, VkCommandBuffer commands, uint32_t shader,
                          uint32_t pass) {
    girih_bind_pipeline(plan, commands, shader, 0);
    girih_dispatch_items(plan, commands, pass_word(pass, GIRIH_SPLIT_PASS_SPLITS));
    girih_compute_barrier(plan->context, commands);
}

static void record_sums(const girih_plan *plan, VkCommandBuffer commands, uint32_t shader) {
    girih_bind_pipeline(plan, commands, shader, 0);
    girih_dispatch_invocations(plan, commands, 1, 1);
    girih_compute_barrier(plan->context, commands);
}

void girih_record_split(const girih_plan *plan, VkCommandBuffer commands) {
    const uint32_t passes = plan->arrays.frame.split_passes;
    for (uint32_t pass = 0; pass < passes; ++pass) {
        const girih_push_block push = {
            .shift = pass, .first_pass = pass == 0, .to_spare = pass == passes - 1};
        girih_push(plan, commands, &push);
        record_marks(plan, commands, GIRIH_SHADER_split_marks, pass);
        record_sums(plan, commands, GIRIH_SHADER_split_mark_sums);
        record_marks(plan, commands, GIRIH_SHADER_split_list, pass);
        record_splits(plan, commands, GIRIH_SHADER_split_count, pass);
        record_sums(plan, commands, GIRIH_SHADER_split_sums);
        record_splits(plan, commands, GIRIH_SHADER_split_parts, pass);
    }
}
