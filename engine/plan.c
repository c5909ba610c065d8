// One frame in flight: what is refined into which buffers.
#include <string.h>

#include "context.h"
#include "error.h"
#include "memory.h"
#include "pack.h"

// lavapipe ends all loops of an invocation after 65,535 turns, and dispatch takes up to six for
// each 128 groups.
#define MOST_CPU_GROUPS (1u << 20)

#define ALL_OUTPUTS                                                                                \
    ((uint32_t)(GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES |        \
                GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_PREVIOUS | GIRIH_OUTPUT_PADDED))

static girih_result validate(const girih_context *context, const girih_plan_desc *desc,
                             girih_error *error) {
    if (!context || !desc || !desc->scene || (desc->instance_count && !desc->instances)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: context, desc, scene and instances must be set");
    }
    if (desc->scene->context != context) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: the scene belongs to another context");
    }
    if ((uint32_t)desc->surface > GIRIH_SURFACE_OWN) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: there is no surface %d", (int)desc->surface);
    }
    if (desc->surface == GIRIH_SURFACE_OWN &&
        (!desc->program || desc->program->context != context)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: an own surface needs a program of this context");
    }
    if (desc->surface == GIRIH_SURFACE_OWN && desc->mode != GIRIH_MODE_INSTANCED &&
        !desc->program->words) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: the surface program has no module for baking; give "
                          "one to girih_surface_program_create or draw instanced");
    }
    if ((desc->outputs & GIRIH_OUTPUT_PREVIOUS) &&
        (desc->surface != GIRIH_SURFACE_OWN || desc->mode == GIRIH_MODE_INSTANCED)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: previous positions are written for own surfaces, "
                          "baked or welded");
    }
    if ((uint32_t)desc->mode > GIRIH_MODE_WELDED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: there is no mode %d", (int)desc->mode);
    }
    if (desc->mode == GIRIH_MODE_WELDED && desc->max_segments && desc->max_splits) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "girih_plan_create: split triangles are not welded; use the baked mode, "
                          "or max_splits 0");
    }
    if (desc->outputs & ~ALL_OUTPUTS) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: there are no outputs 0x%x",
                          desc->outputs & ~ALL_OUTPUTS);
    }
    if ((desc->outputs & (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES | GIRIH_OUTPUT_PADDED)) &&
        desc->mode == GIRIH_MODE_INSTANCED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: indices, their padding and sources need the baked or "
                          "the welded mode");
    }
    if ((desc->outputs & GIRIH_OUTPUT_CLOSED_INDICES) && desc->mode != GIRIH_MODE_WELDED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: closed indices need the welded mode");
    }
    if (desc->mode == GIRIH_MODE_INSTANCED && !(desc->outputs & GIRIH_OUTPUT_NO_DRAW) &&
        (!context->features.multiDrawIndirect || !context->features.drawIndirectFirstInstance)) {
        return girih_fail(
            error, GIRIH_ERROR_UNSUPPORTED,
            "girih_plan_create: the instanced mode needs the features multiDrawIndirect and "
            "drawIndirectFirstInstance; use the baked mode");
    }
    // The vertex shader reads the scene through one binding.
    if (desc->mode == GIRIH_MODE_INSTANCED && desc->surface == GIRIH_SURFACE_OWN &&
        desc->scene->buffer.size > context->limits.maxStorageBufferRange) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "girih_plan_create: the scene's %llu bytes are more than a storage buffer "
            "shows a vertex shader (%u); use the baked mode",
            (unsigned long long)desc->scene->buffer.size, context->limits.maxStorageBufferRange);
    }
    return GIRIH_OK;
}

girih_result girih_plan_need_pipelines(const girih_plan *plan, girih_error *error) {
    const girih_context *context = plan->context;
    const girih_frame_block *frame = &plan->arrays.frame;
    const bool serial = context->serial_sort;
    const bool apart = !plan->small;
    const uint32_t select = girih_select_shader(plan);
    const bool own_points = girih_evaluates_own_points(plan);
    const bool few = context->few_buffers;
    const uint32_t lists =
        plan->outputs & (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES);
    const struct {
        uint32_t shader, further;
        bool wanted;
    } needs[] = {
        {GIRIH_SHADER_levels, GIRIH_LEVELS_UNIFORM << GIRIH_VARIANT_RULE_SHIFT, apart},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_RANDOM << GIRIH_VARIANT_RULE_SHIFT, apart},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_LENGTH << GIRIH_VARIANT_RULE_SHIFT, apart},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_OBJECT_LENGTH << GIRIH_VARIANT_RULE_SHIFT, apart},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_RANDOM_LEVEL << GIRIH_VARIANT_RULE_SHIFT, apart},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_HORIZONTAL << GIRIH_VARIANT_RULE_SHIFT, apart},
        {select, 0, apart},
        {select, GIRIH_VARIANT_CULL, apart},
        {GIRIH_SHADER_split_marks, 0, frame->max_splits > 0},
        {GIRIH_SHADER_split_mark_sums, 0, frame->max_splits > 0},
        {GIRIH_SHADER_split_list, 0, frame->max_splits > 0},
        {GIRIH_SHADER_split_count, 0, frame->max_splits > 0},
        {GIRIH_SHADER_split_sums, 0, frame->max_splits > 0},
        {GIRIH_SHADER_split_parts, 0, frame->max_splits > 0},
        {serial ? GIRIH_SHADER_group_count_serial : GIRIH_SHADER_group_count_workgroup, 0, apart},
        {serial ? GIRIH_SHADER_group_blocks_serial : GIRIH_SHADER_group_blocks_workgroup, 0, apart},
        {serial ? GIRIH_SHADER_group_digits_serial : GIRIH_SHADER_group_digits_workgroup, 0, apart},
        {serial ? GIRIH_SHADER_group_place_serial : GIRIH_SHADER_group_place_workgroup, 0, apart},
        {GIRIH_SHADER_group_bounds, 0,
         apart && girih_sort_passes(frame->group_count, &(uint32_t){0}) > 1},
        {girih_dispatch_shader(plan), 0, apart},
        {GIRIH_SHADER_dispatch_draws, 0,
         apart && plan->mode != GIRIH_MODE_INSTANCED && frame->draws_per_material},
        {own_points ? 0 : girih_evaluate_shader(plan), 0, !own_points},
        {girih_evaluate_shader(plan), GIRIH_VARIANT_CULL, girih_evaluates_borders(plan)},
        {girih_evaluate_shader(plan), GIRIH_VARIANT_PARTS, girih_evaluates_parts(plan)},
        {GIRIH_SHADER_evaluate_corners, 0, girih_evaluates_borders(plan)},
        {girih_edges_shader(plan), 0, girih_evaluates_borders(plan)},
        {GIRIH_SHADER_output_lists, lists << GIRIH_VARIANT_OUTPUT_SHIFT, lists && !few},
        {GIRIH_SHADER_output_lists, GIRIH_OUTPUT_INDICES << GIRIH_VARIANT_OUTPUT_SHIFT,
         few && (lists & GIRIH_OUTPUT_INDICES)},
        {GIRIH_SHADER_output_lists, GIRIH_OUTPUT_CLOSED_INDICES << GIRIH_VARIANT_OUTPUT_SHIFT,
         few && (lists & GIRIH_OUTPUT_CLOSED_INDICES)},
        {GIRIH_SHADER_output_lists, GIRIH_OUTPUT_SOURCES << GIRIH_VARIANT_OUTPUT_SHIFT,
         few && (lists & GIRIH_OUTPUT_SOURCES)},
        {GIRIH_SHADER_output_weld_blocks, 0, plan->mode == GIRIH_MODE_WELDED},
        {GIRIH_SHADER_output_weld_sums, 0, plan->mode == GIRIH_MODE_WELDED},
        {GIRIH_SHADER_output_weld_offsets, 0, plan->mode == GIRIH_MODE_WELDED},
    };
    girih_result result = plan->small ? girih_small_need(plan, error) : GIRIH_OK;
    for (size_t n = 0; n < sizeof needs / sizeof *needs && result == GIRIH_OK; ++n) {
        if (needs[n].wanted) {
            result = girih_pipeline_need(context, needs[n].shader, plan->variant | needs[n].further,
                                         error);
        }
    }
    if (result == GIRIH_OK && own_points) {
        result = girih_surface_pipeline_need(plan->program, plan->variant, error);
    }
    return result;
}

// See girih.glsl for the locations.
static void describe_vertex_input(girih_plan *plan) {
    uint32_t attributes = 0;
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        // As many vectors as the patch fills, what is left of it, and the ids at its end.
        const uint32_t words = girih_patch_words(plan);
        const uint32_t part = plan->arrays.frame.max_splits > 0 ? GIRIH_PATCH_WORDS_PART : 0;
        const uint32_t vectors = (words - part - 4) / 4;
        const uint32_t padding = plan->surface == GIRIH_SURFACE_FLAT ? 2 : 0;
        plan->bindings[0] = (VkVertexInputBindingDescription){0, 4, VK_VERTEX_INPUT_RATE_VERTEX};
        plan->bindings[1] =
            (VkVertexInputBindingDescription){1, words * 4, VK_VERTEX_INPUT_RATE_INSTANCE};
        plan->vertex_attributes[attributes++] =
            (VkVertexInputAttributeDescription){0, 0, VK_FORMAT_R32_UINT, 0};
        for (uint32_t n = 0; n < vectors; ++n) {
            plan->vertex_attributes[attributes] = (VkVertexInputAttributeDescription){
                attributes, 1,
                padding && n == vectors - 1 ? VK_FORMAT_R32G32_SFLOAT
                                            : VK_FORMAT_R32G32B32A32_SFLOAT,
                16 * n};
            ++attributes;
        }
        plan->vertex_attributes[attributes] = (VkVertexInputAttributeDescription){
            attributes, 1, VK_FORMAT_R32G32B32A32_UINT, 4 * (words - part - 4 - padding)};
        ++attributes;
        if (part > 0) {
            plan->vertex_attributes[attributes] = (VkVertexInputAttributeDescription){
                attributes, 1, VK_FORMAT_R32G32B32A32_UINT, 4 * (words - part)};
            ++attributes;
            plan->vertex_attributes[attributes] = (VkVertexInputAttributeDescription){
                attributes, 1, VK_FORMAT_R32G32_UINT, 4 * (words - part) + 16};
            ++attributes;
        }
    } else {
        plan->bindings[0] = (VkVertexInputBindingDescription){0, 12, VK_VERTEX_INPUT_RATE_VERTEX};
        plan->bindings[1] = (VkVertexInputBindingDescription){1, girih_attribute_words(plan) * 4,
                                                              VK_VERTEX_INPUT_RATE_VERTEX};
        plan->vertex_attributes[attributes++] =
            (VkVertexInputAttributeDescription){0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
        plan->vertex_attributes[attributes++] =
            (VkVertexInputAttributeDescription){1, 1, VK_FORMAT_R32G32B32_SFLOAT, 0};
    }
    plan->vertex_input = (VkPipelineVertexInputStateCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 2,
        .pVertexBindingDescriptions = plan->bindings,
        .vertexAttributeDescriptionCount = attributes,
        .pVertexAttributeDescriptions = plan->vertex_attributes};
}

// Baked draws use the catalogue's own indices, many draws to a material, where the device takes
// many at once and their arguments stay small; else the output's indices and one draw a material.
static bool choose_pattern_draws(const girih_plan *plan, uint64_t max_triangles) {
    if (plan->mode != GIRIH_MODE_BAKED ||
        (plan->outputs & (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_NO_DRAW)) ||
        !plan->context->features.multiDrawIndirect) {
        return false;
    }
    const girih_frame_block *frame = &plan->context->catalogue.frame;
    const uint64_t draws = (frame->range_count + max_triangles / (GIRIH_DRAW_TRIANGLES / 2)) *
                           plan->scene->table.material_count;
    return draws < 1u << 20;
}

// Whether the device can draw what is asked for with the host's vertex shader.
static girih_result check_draws(const girih_plan *plan, bool pattern_draws,
                                const girih_plan_shape *shape, girih_error *error) {
    const VkPhysicalDeviceLimits *limits = &plan->context->limits;
    if (!pattern_draws && shape->max_vertices > limits->maxDrawIndexedIndexValue) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: room for %llu output vertices is more than the device's indices "
                          "reach (%u); refine less at once",
                          (unsigned long long)shape->max_vertices,
                          limits->maxDrawIndexedIndexValue);
    }
    if (girih_attribute_words(plan) * 4 > limits->maxVertexInputBindingStride) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %u bytes a vertex are more than the device's vertex input takes "
                          "(%u); use fewer attributes, or GIRIH_OUTPUT_NO_DRAW",
                          girih_attribute_words(plan) * 4, limits->maxVertexInputBindingStride);
    }
    return GIRIH_OK;
}

// Everything about a plan that needs no buffer: counts, windows, and what its buffers must be.
static girih_result prepare(girih_plan *plan, const girih_plan_desc *desc,
                            girih_buffer_need needs[GIRIH_PLAN_BUFFERS], girih_error *error) {
    const girih_context *context = plan->context;
    girih_frame_block *frame = &plan->arrays.frame;
    *frame = context->catalogue.frame;
    frame->material_count = desc->scene->table.material_count;
    frame->attribute_floats = desc->scene->table.attribute_floats;
    frame->previous_vertices = desc->scene->previous_vertices;
    frame->reach = plan->program && plan->program->reach > 0.0f ? plan->program->reach : 0.0f;
    const bool wants_draws = !(plan->outputs & GIRIH_OUTPUT_NO_DRAW);
    const bool pattern_draws = choose_pattern_draws(plan, desc->max_triangles);
    if (plan->mode == GIRIH_MODE_WELDED ||
        (plan->mode == GIRIH_MODE_BAKED && !pattern_draws && wants_draws)) {
        plan->outputs |= GIRIH_OUTPUT_INDICES;
    }
    girih_plan_shape shape = {.mode = plan->mode,
                              .outputs = plan->outputs,
                              .max_vertices = desc->max_vertices,
                              .max_triangles = desc->max_triangles,
                              .max_segments = desc->max_segments,
                              .max_splits = desc->max_segments > 0 ? desc->max_splits : 0,
                              .pattern_draws = pattern_draws,
                              .serial_sort = context->serial_sort,
                              .previous = (plan->outputs & GIRIH_OUTPUT_PREVIOUS) != 0};
    girih_result result = girih_pack_plan(&plan->arrays, &shape, &desc->scene->table,
                                          desc->instances, desc->instance_count, error);
    if (result == GIRIH_OK && context->is_cpu && frame->group_count > MOST_CPU_GROUPS) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                            "plan: %u materials times %u pattern ranges are more than a CPU "
                            "device's loops can count (%u); use fewer of either",
                            frame->material_count, frame->range_count, MOST_CPU_GROUPS);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    if (plan->mode != GIRIH_MODE_INSTANCED && wants_draws) {
        result = check_draws(plan, pattern_draws, &shape, error);
    }
    plan->variant = (frame->instance_count > 1 ? GIRIH_VARIANT_INSTANCES : 0) |
                    (plan->scene->table.seam_count ? GIRIH_VARIANT_SEAMS : 0) |
                    (frame->attribute_floats ? GIRIH_VARIANT_ATTRIBUTES : 0) |
                    (plan->mode == GIRIH_MODE_WELDED ? GIRIH_VARIANT_WELDED : 0) |
                    (plan->scene->dynamic ? GIRIH_VARIANT_DYNAMIC : 0) |
                    (shape.previous ? GIRIH_VARIANT_PREVIOUS : 0) |
                    (frame->max_splits > 0 ? GIRIH_VARIANT_SPLITS : 0) |
                    (plan->scene->table.has_materials ? GIRIH_VARIANT_MATERIALS : 0);
    frame->variant = plan->variant;
    plan->small = girih_is_small(plan);
    if (result == GIRIH_OK) {
        result = girih_plan_find_needs(plan, desc, needs, error);
    }
    // vkCmdDrawIndexedIndirect counts vertices from a signed offset and triangles by their indices.
    if (result == GIRIH_OK &&
        (frame->max_vertices > INT32_MAX || frame->max_triangles > UINT32_MAX / 3)) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                            "plan: room for %u vertices and %u triangles; at most %u and %u can be "
                            "drawn, refine less at once",
                            frame->max_vertices, frame->max_triangles, (unsigned)INT32_MAX,
                            UINT32_MAX / 3);
    }
    return result;
}

static girih_plan begin(const girih_context *context, const girih_plan_desc *desc) {
    return (girih_plan){.context = context,
                        .scene = desc->scene,
                        .surface = desc->surface,
                        .program = desc->surface == GIRIH_SURFACE_OWN ? desc->program : NULL,
                        .mode = desc->mode,
                        .outputs = desc->outputs};
}

girih_result girih_plan_needs(const girih_context *context, const girih_plan_desc *desc,
                              girih_buffer_need needs[GIRIH_PLAN_BUFFERS], girih_error *error) {
    girih_result result = validate(context, desc, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (!needs) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_needs: needs must be set");
    }
    girih_plan plan = begin(context, desc);
    result = prepare(&plan, desc, needs, error);
    girih_arrays_free(&plan.arrays, 0, GIRIH_BIND_COUNT);
    return result;
}

girih_result girih_plan_create(const girih_context *context, const girih_plan_desc *desc,
                               girih_plan **out, girih_error *error) {
    girih_result result = validate(context, desc, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (!out) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: plan must be set");
    }
    girih_plan *plan = girih_allocate(sizeof *plan);
    if (!plan) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "plan: out of memory");
    }
    *plan = begin(context, desc);
    girih_buffer_need needs[GIRIH_PLAN_BUFFERS];
    result = prepare(plan, desc, needs, error);
    if (result == GIRIH_OK) {
        result = girih_plan_create_buffers(plan, desc->buffers, needs, error);
    }
    girih_arrays_free(&plan->arrays, 0, GIRIH_BIND_COUNT);
    if (result == GIRIH_OK) {
        result = girih_plan_create_descriptors(plan, error);
    }
    if (result == GIRIH_OK) {
        result = girih_plan_need_pipelines(plan, error);
    }
    if (result != GIRIH_OK) {
        girih_plan_destroy(plan);
        return result;
    }
    describe_vertex_input(plan);
    *out = plan;
    return GIRIH_OK;
}

void girih_plan_destroy(girih_plan *plan) {
    if (!plan) {
        return;
    }
    const girih_context *context = plan->context;
    context->vk.DestroyDescriptorPool(context->device, plan->pool, context->callbacks);
    for (uint32_t n = 0; n < GIRIH_PLAN_BUFFERS; ++n) {
        girih_buffer_destroy(context, &plan->buffers[n]);
    }
    girih_free(plan->sets);
    girih_free(plan);
}

girih_result girih_plan_set_transform(girih_plan *plan, uint32_t instance,
                                      const float transform[12], const float *previous,
                                      girih_error *error) {
    if (!plan || !transform || instance >= plan->arrays.frame.instance_count) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_set_transform: plan and transform must be set, and instance "
                          "%u be one of the plan's",
                          instance);
    }
    girih_result result = girih_check_transform(transform, instance, error);
    if (result == GIRIH_OK && previous) {
        result = girih_check_transform(previous, instance, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    uint32_t *records = plan->buffers[GIRIH_PLAN_STAGING].mapped;
    uint32_t *record = records + (size_t)instance * GIRIH_INSTANCE_WORDS;
    uint32_t moved[GIRIH_INSTANCE_WORDS];
    memcpy(moved, record, sizeof moved);
    girih_pack_transform(moved, transform, previous);
    // A host may set all of its transforms every frame; those that stay do not undo what is there.
    if (memcmp(moved, record, sizeof moved) == 0) {
        return GIRIH_OK;
    }
    memcpy(record, moved, sizeof moved);
    if (plan->arrays.frame.instance_count == 1) {
        memcpy(plan->arrays.frame.only_instance, records, sizeof plan->arrays.frame.only_instance);
    }
    plan->current = false;
    return GIRIH_OK;
}

void girih_plan_invalidate(girih_plan *plan) {
    plan->current = false;
}

const VkPipelineVertexInputStateCreateInfo *girih_plan_vertex_input(const girih_plan *plan) {
    return &plan->vertex_input;
}

girih_statistics girih_plan_statistics(const girih_plan *plan) {
    return girih_read_status(&plan->arrays.frame, plan->buffers[GIRIH_PLAN_STATUS].mapped);
}

int girih_plan_uses_pattern(const girih_plan *plan, uint32_t rank) {
    const uint32_t *status = plan->buffers[GIRIH_PLAN_STATUS].mapped;
    return rank < plan->arrays.frame.pattern_count && status[GIRIH_STATUS_WORDS + rank] != 0;
}

girih_plan_buffers girih_plan_get_buffers(const girih_plan *plan) {
    const bool instanced = plan->mode == GIRIH_MODE_INSTANCED;
    const girih_buffer *buffers = plan->buffers;
    return (girih_plan_buffers){
        .positions = girih_buffer_as_range(&buffers[GIRIH_PLAN_POSITIONS]),
        .attributes = instanced ? (girih_buffer_range){0}
                                : girih_buffer_as_range(&buffers[GIRIH_PLAN_ATTRIBUTES]),
        .indices = girih_buffer_as_range(&buffers[GIRIH_PLAN_INDICES]),
        .closed_indices = girih_buffer_as_range(&buffers[GIRIH_PLAN_CLOSED_INDICES]),
        .sources = girih_buffer_as_range(&buffers[GIRIH_PLAN_SOURCES]),
        .attribute_stride = instanced ? 0 : 4 * girih_attribute_words(plan),
        .max_vertices = plan->arrays.frame.max_vertices,
        .max_triangles = plan->arrays.frame.max_triangles};
}

uint32_t girih_plan_material_count(const girih_plan *plan) {
    return plan->arrays.frame.material_count;
}

void girih_plan_material_range(const girih_plan *plan, uint32_t material, uint32_t *first_triangle,
                               uint32_t *triangle_count) {
    const uint32_t *firsts = (const uint32_t *)plan->buffers[GIRIH_PLAN_STATUS].mapped +
                             GIRIH_STATUS_WORDS + plan->arrays.frame.pattern_count;
    const bool there = material < plan->arrays.frame.material_count;
    *first_triangle = there ? firsts[material] : 0;
    *triangle_count = there ? firsts[material + 1] - firsts[material] : 0;
}
