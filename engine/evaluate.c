// Stage 5, recorded: glsl/evaluate.comp, once for each window of the output.
#include "context.h"

void girih_record_evaluate(const girih_plan *plan, VkCommandBuffer commands) {
    const bool pn = plan->surface == GIRIH_SURFACE_PN;
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        girih_bind_pipeline(
            plan, commands,
            pn ? GIRIH_SHADER_evaluate_patches_pn : GIRIH_SHADER_evaluate_patches_flat, 0);
    } else {
        girih_bind_pipeline(
            plan, commands,
            pn ? GIRIH_SHADER_evaluate_points_pn : GIRIH_SHADER_evaluate_points_flat, 0);
    }
    for (uint32_t window = 0; window < plan->vertex_windows; ++window) {
        const girih_push_block push = {.window_first = window * plan->vertex_window,
                                       .window_count = plan->vertex_window};
        girih_bind_set(plan, commands, window);
        girih_push(plan, commands, &push);
        girih_dispatch_items(plan, commands);
    }
}
