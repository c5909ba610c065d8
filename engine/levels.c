// Stage 1, recorded: glsl/levels.comp over every edge of every instance.
#include "context.h"

void girih_record_levels(const girih_plan *plan, VkCommandBuffer commands) {
    girih_bind_pipeline(plan, commands, GIRIH_SHADER_levels,
                        plan->arrays.frame.rule << GIRIH_VARIANT_RULE_SHIFT);
    girih_dispatch_invocations(plan, commands, plan->arrays.frame.edge_count, GIRIH_LARGE_WORKGROUP);
}
