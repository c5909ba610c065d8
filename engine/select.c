// Stage 2, recorded: glsl/select.comp over every triangle of every instance.
#include "context.h"

void girih_record_select(const girih_plan *plan, VkCommandBuffer commands) {
    girih_bind_pipeline(plan, commands,
                        plan->surface == GIRIH_SURFACE_PN ? GIRIH_SHADER_select_pn
                                                          : GIRIH_SHADER_select_flat,
                        plan->arrays.frame.cull ? GIRIH_VARIANT_CULL : 0);
    girih_dispatch_invocations(plan, commands, plan->arrays.frame.triangle_count, GIRIH_WORKGROUP);
}
