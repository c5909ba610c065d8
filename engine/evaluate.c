// Stage 5, recorded: glsl/evaluate.comp or a host's surface, once for each window of the output.
#include "context.h"

bool girih_evaluates_own_points(const girih_plan *plan) {
    return plan->surface == GIRIH_SURFACE_OWN && plan->mode != GIRIH_MODE_INSTANCED;
}

uint32_t girih_evaluate_shader(const girih_plan *plan) {
    if (plan->surface == GIRIH_SURFACE_OWN) {
        return GIRIH_SHADER_evaluate_items;
    }
    const bool pn = plan->surface == GIRIH_SURFACE_PN;
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        return pn ? GIRIH_SHADER_evaluate_patches_pn : GIRIH_SHADER_evaluate_patches_flat;
    }
    return pn ? GIRIH_SHADER_evaluate_points_pn : GIRIH_SHADER_evaluate_points_flat;
}

void girih_record_evaluate(const girih_plan *plan, VkCommandBuffer commands) {
    const girih_functions *vk = &plan->context->vk;
    if (girih_evaluates_own_points(plan)) {
        vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                            girih_surface_pipeline_get(plan->program, plan->variant));
        if (plan->surface_set) {
            vk->CmdBindDescriptorSets(
                commands, VK_PIPELINE_BIND_POINT_COMPUTE, plan->program->pipeline_layout,
                plan->context->placement.set + 1, 1, &plan->surface_set, 0, NULL);
        }
    } else {
        girih_bind_pipeline(plan, commands, girih_evaluate_shader(plan), 0);
    }
    for (uint32_t window = 0; window < plan->vertex_windows; ++window) {
        const girih_push_block push = {.window_first = window * plan->vertex_window,
                                       .window_count = plan->vertex_window};
        girih_bind_set(plan, commands, window);
        girih_push(plan, commands, &push);
        girih_dispatch_items(plan, commands);
    }
}
