// Stages 1 to 4 of a small plan, recorded: glsl/small.comp.
#include "context.h"

// One workgroup does in a dispatch what otherwise takes six and more, each with a start of its own.
// On lavapipe with two threads 1,024 triangles take as long either way.
#define MOST_TRIANGLES 1024u
#define MOST_GROUPS 4096u
#define MOST_DRAWS 4096u

bool girih_is_small(const girih_plan *plan) {
    const girih_frame_block *frame = &plan->arrays.frame;
    return plan->mode != GIRIH_MODE_WELDED && frame->max_splits == 0 &&
           frame->triangle_count <= MOST_TRIANGLES && frame->group_count <= MOST_GROUPS &&
           (uint64_t)frame->draws_per_material * frame->material_count <= MOST_DRAWS;
}

static uint32_t small_shader(const girih_plan *plan) {
    const bool narrow = plan->context->serial_sort;
    if (girih_select_shader(plan) == GIRIH_SHADER_select_pn) {
        return narrow ? GIRIH_SHADER_small_pn_narrow : GIRIH_SHADER_small_pn_wide;
    }
    return narrow ? GIRIH_SHADER_small_flat_narrow : GIRIH_SHADER_small_flat_wide;
}

girih_result girih_small_need(const girih_plan *plan, girih_error *error) {
    const girih_result result =
        girih_pipeline_need(plan->context, small_shader(plan), plan->variant, error);
    return result == GIRIH_OK ? girih_pipeline_need(plan->context, small_shader(plan),
                                                    plan->variant | GIRIH_VARIANT_CULL, error)
                              : result;
}

void girih_record_small(const girih_plan *plan, VkCommandBuffer commands) {
    const girih_frame_block *frame = &plan->arrays.frame;
    uint32_t bits;
    const uint32_t passes = girih_sort_passes(frame->group_count, &bits);
    const girih_push_block push = {.shift = bits, .bins = 1u << bits, .first_pass = passes};
    girih_push(plan, commands, &push);
    girih_bind_pipeline(plan, commands, small_shader(plan), frame->cull ? GIRIH_VARIANT_CULL : 0);
    girih_dispatch_invocations(plan, commands, 1, 1);
}
