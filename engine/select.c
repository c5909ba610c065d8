// Stage 2, recorded: glsl/select.comp over every triangle of every instance.
#include "context.h"

uint32_t girih_select_shader(const girih_plan *plan) {
    const girih_surface bounds = plan->program ? plan->program->base : plan->surface;
    return bounds == GIRIH_SURFACE_PN ? GIRIH_SHADER_select_pn : GIRIH_SHADER_select_flat;
}

void girih_record_select(const girih_plan *plan, VkCommandBuffer commands) {
    girih_bind_pipeline(plan, commands, girih_select_shader(plan),
                        plan->arrays.frame.cull ? GIRIH_VARIANT_CULL : 0);
    girih_dispatch_invocations(plan, commands, plan->arrays.frame.triangle_count, GIRIH_LARGE_WORKGROUP);
}
