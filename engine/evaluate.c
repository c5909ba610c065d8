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

bool girih_evaluates_borders(const girih_plan *plan) {
    return plan->mode == GIRIH_MODE_WELDED && plan->surface != GIRIH_SURFACE_OWN;
}

bool girih_evaluates_parts(const girih_plan *plan) {
    return plan->arrays.frame.max_splits > 0 && plan->mode != GIRIH_MODE_INSTANCED &&
           plan->surface != GIRIH_SURFACE_OWN;
}

uint32_t girih_edges_shader(const girih_plan *plan) {
    return plan->surface == GIRIH_SURFACE_PN ? GIRIH_SHADER_evaluate_edges_pn
                                             : GIRIH_SHADER_evaluate_edges_flat;
}

// What one window shows of the points that triangles share. Corners are first, edges follow; no
// dispatch waits for another.
static void record_borders(const girih_plan *plan, VkCommandBuffer commands, uint32_t first) {
    const girih_frame_block *frame = &plan->arrays.frame;
    if (first < frame->corner_count) {
        girih_bind_pipeline(plan, commands, GIRIH_SHADER_evaluate_corners, 0);
        girih_dispatch_invocations(plan, commands, frame->corner_count, GIRIH_WORKGROUP);
    }
    girih_bind_pipeline(plan, commands, girih_edges_shader(plan), 0);
    girih_dispatch_invocations(plan, commands, frame->weld_edge_count, GIRIH_WORKGROUP);
}

void girih_record_evaluate(const girih_plan *plan, VkCommandBuffer commands) {
    const girih_functions *vk = &plan->context->vk;
    // Where triangles are culled, each evaluates its own border: not what no triangle shows.
    const uint32_t cull =
        girih_evaluates_borders(plan) && plan->arrays.frame.cull ? GIRIH_VARIANT_CULL : 0;
    const bool borders = girih_evaluates_borders(plan) && !cull;
    for (uint32_t window = 0; window < plan->vertex_windows; ++window) {
        const girih_push_block push = {.window_first = window * plan->vertex_window,
                                       .window_count = plan->vertex_window};
        girih_bind_set(plan, commands, window);
        girih_push(plan, commands, &push);
        if (borders) {
            record_borders(plan, commands, push.window_first);
        }
        if (girih_evaluates_own_points(plan)) {
            vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                                girih_surface_pipeline_get(plan->program, plan->variant));
            if (plan->surface_set) {
                vk->CmdBindDescriptorSets(
                    commands, VK_PIPELINE_BIND_POINT_COMPUTE, plan->program->pipeline_layout,
                    plan->context->placement.set + 1, 1, &plan->surface_set, 0, NULL);
            }
        } else {
            girih_bind_pipeline(plan, commands, girih_evaluate_shader(plan), cull);
        }
        girih_dispatch_items(plan, commands,
                             borders ? GIRIH_STATUS_INTERIOR : GIRIH_STATUS_EVALUATE);
        if (girih_evaluates_parts(plan)) {
            girih_bind_pipeline(plan, commands, girih_evaluate_shader(plan),
                                cull | GIRIH_VARIANT_PARTS);
            girih_dispatch_items(plan, commands, GIRIH_STATUS_PARTS);
        }
    }
}
