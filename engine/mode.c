// The output mode that is likely the fastest. The rule stands here alone.
#include "context.h"

// Output triangles for each input triangle from which the instanced mode is the faster one on a CPU
// device: an instance costs such a device as much as some dozens of triangles, a baked vertex is
// written and read again. On lavapipe (girih-bench --case spheres, table3) baked is far ahead at 3,
// the two are about equal from 16 to 30, and instanced is ahead at 35, more so where frames are
// shaded.
#define TRIANGLES_WORTH_AN_INSTANCE 24u

static bool can_instance(const girih_context *context, const girih_plan_desc *desc) {
    const uint32_t of_baked = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES | GIRIH_OUTPUT_PREVIOUS |
                              GIRIH_OUTPUT_PADDED | GIRIH_OUTPUT_NO_DRAW;
    return !(desc->outputs & of_baked) && context->features.multiDrawIndirect &&
           context->features.drawIndirectFirstInstance &&
           (desc->surface != GIRIH_SURFACE_OWN ||
            desc->scene->buffer.size <= context->limits.maxStorageBufferRange);
}

girih_mode girih_choose_mode(const girih_context *context, const girih_plan_desc *desc,
                             uint64_t output_triangles) {
    if (!context || !desc || !desc->scene || (desc->instance_count && !desc->instances)) {
        return GIRIH_MODE_BAKED;
    }
    if (desc->outputs & GIRIH_OUTPUT_CLOSED_INDICES) {
        return GIRIH_MODE_WELDED;
    }
    if (!can_instance(context, desc)) {
        return GIRIH_MODE_BAKED;
    }
    if (!context->is_cpu) {
        return GIRIH_MODE_INSTANCED;
    }
    // The vertex shader of an own surface gathers its patch for every vertex anew.
    if (desc->surface == GIRIH_SURFACE_OWN) {
        return desc->program && !desc->program->words ? GIRIH_MODE_INSTANCED : GIRIH_MODE_BAKED;
    }
    uint64_t input_triangles = 0;
    for (uint32_t n = 0; n < desc->instance_count; ++n) {
        if (desc->instances[n].mesh < desc->scene->table.mesh_count) {
            input_triangles += desc->scene->table.meshes[desc->instances[n].mesh].triangle_count;
        }
    }
    return output_triangles / TRIANGLES_WORTH_AN_INSTANCE >= input_triangles && output_triangles
               ? GIRIH_MODE_INSTANCED
               : GIRIH_MODE_BAKED;
}
