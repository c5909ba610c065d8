#include <string.h>

#include "context.h"
#include "error.h"
#include "memory.h"
#include "pack.h"

#define PLAN_FIRST GIRIH_BIND_INSTANCES
#define PLAN_END GIRIH_BIND_OUT_POSITIONS
#define WINDOW_STEP                                                                                \
    64u // outputs to which windows are rounded, so that every window's offset is aligned

static uint32_t patch_words(girih_surface surface) {
    return surface == GIRIH_SURFACE_PN ? GIRIH_PATCH_WORDS_PN : GIRIH_PATCH_WORDS_FLAT;
}

static uint32_t attribute_words(const girih_plan *plan) {
    return plan->mode == GIRIH_MODE_INSTANCED ? patch_words(plan->surface)
                                              : 3 + plan->arrays.frame.attribute_floats;
}

// The most outputs of `bytes` bytes that one storage buffer shows.
static uint32_t window_of(const girih_context *context, uint32_t bytes) {
    return (uint32_t)(context->limits.maxStorageBufferRange / bytes) / WINDOW_STEP * WINDOW_STEP;
}

static uint32_t windows_for(uint64_t count, uint32_t window) {
    const uint64_t windows = (count + window - 1) / window;
    return windows ? (uint32_t)windows : 1;
}

static girih_result validate(const girih_context *context, const girih_plan_desc *desc,
                             girih_plan **out, girih_error *error) {
    if (!context || !desc || !out || !desc->scene || (desc->instance_count && !desc->instances)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: context, scene, instances and plan must be set");
    }
    if (desc->scene->context != context) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: the scene belongs to another context");
    }
    if ((uint32_t)desc->surface > GIRIH_SURFACE_PN || !(context->surfaces & 1u << desc->surface)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: the context was made without surface %d",
                          (int)desc->surface);
    }
    if ((uint32_t)desc->mode > GIRIH_MODE_WELDED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_plan_create: there is no mode %d", (int)desc->mode);
    }
    if ((desc->outputs & (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES)) &&
        desc->mode == GIRIH_MODE_INSTANCED) {
        return girih_fail(
            error, GIRIH_ERROR_INVALID_ARGUMENT,
            "girih_plan_create: indices and sources need the baked or the welded mode");
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
    return GIRIH_OK;
}

// Output buffers and their windows.
static girih_result create_outputs(girih_plan *plan, const girih_plan_desc *desc,
                                   girih_error *error) {
    const girih_context *context = plan->context;
    const girih_frame_block *frame = &plan->arrays.frame;
    const VkBufferUsageFlags common = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const VkBufferUsageFlags vertex_usage =
        common | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | desc->vertex_usage;
    const VkBufferUsageFlags index_usage =
        common | VK_BUFFER_USAGE_INDEX_BUFFER_BIT | desc->index_usage;
    const uint64_t vertices =
        plan->mode == GIRIH_MODE_INSTANCED ? frame->triangle_count : frame->max_vertices;
    const uint64_t triangles = frame->max_triangles;
    const uint32_t words = attribute_words(plan);
    plan->vertex_window = window_of(context, 4 * (words > 3 ? words : 3));
    if (plan->vertex_window == 0) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %u floats a vertex are more than the device's storage buffers "
                          "show; use fewer attributes",
                          words);
    }
    plan->vertex_windows = windows_for(vertices, plan->vertex_window);
    plan->triangle_window = window_of(context, 12);
    plan->triangle_windows =
        plan->outputs & (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES)
            ? windows_for(triangles, plan->triangle_window)
            : 0;
    plan->window_count = plan->vertex_windows > plan->triangle_windows ? plan->vertex_windows
                                                                       : plan->triangle_windows;
    girih_result result =
        girih_buffer_create(context, (vertices ? vertices : 1) * words * 4, vertex_usage, false,
                            "output attributes", &plan->attributes, error);
    if (result == GIRIH_OK && plan->mode != GIRIH_MODE_INSTANCED) {
        result = girih_buffer_create(context, (vertices ? vertices : 1) * 12, vertex_usage, false,
                                     "output positions", &plan->positions, error);
    }
    const struct {
        uint32_t bit, bytes;
        girih_buffer *buffer;
        const char *what;
    } lists[] = {{GIRIH_OUTPUT_INDICES, 12, &plan->index_list, "output indices"},
                 {GIRIH_OUTPUT_CLOSED_INDICES, 12, &plan->closed_list, "closed output indices"},
                 {GIRIH_OUTPUT_SOURCES, 8, &plan->sources, "output sources"}};
    for (size_t n = 0; n < sizeof lists / sizeof *lists && result == GIRIH_OK; ++n) {
        if (plan->outputs & lists[n].bit) {
            result = girih_buffer_create(context, (triangles ? triangles : 1) * lists[n].bytes,
                                         index_usage, false, lists[n].what, lists[n].buffer, error);
        }
    }
    return result;
}

static girih_result create_inputs(girih_plan *plan, girih_error *error) {
    const girih_context *context = plan->context;
    girih_arrays *arrays = &plan->arrays;
    VkDeviceSize size = 0;
    girih_layout_arrays(arrays, PLAN_FIRST, PLAN_END, plan->offset, &size);
    girih_result result =
        girih_check_ranges(context, arrays, PLAN_FIRST, PLAN_END, size, "plan", error);
    if (result != GIRIH_OK) {
        return result;
    }
    // Arrays that share a buffer binding are told apart by their first word in it.
    if (context->few_buffers) {
        for (uint32_t n = GIRIH_BIND_VERTICES; n < PLAN_END; ++n) {
            const VkDeviceSize offset = n < PLAN_FIRST ? plan->scene->offset[n] : plan->offset[n];
            arrays->frame.bases[n / 4][n % 4] = (uint32_t)(offset / 4);
        }
    }
    plan->frame_offset = (size + 255) / 256 * 256;
    result = girih_buffer_create(
        context, plan->frame_offset + sizeof arrays->frame,
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
            VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
            VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
        false, "plan", &plan->buffer, error);
    const VkDeviceSize instances = arrays->count[GIRIH_BIND_INSTANCES] * 4;
    const VkDeviceSize blocks = arrays->count[GIRIH_BIND_BLOCKS] * 4;
    if (result == GIRIH_OK) {
        result = girih_buffer_create(context, instances + blocks, VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                     true, "plan", &plan->staging, error);
    }
    if (result == GIRIH_OK) {
        result = girih_buffer_create(context, arrays->count[GIRIH_BIND_STATUS] * 4,
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, "plan", &plan->status,
                                     error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    memcpy(plan->staging.mapped, arrays->words[GIRIH_BIND_INSTANCES], instances);
    memcpy((char *)plan->staging.mapped + instances, arrays->words[GIRIH_BIND_BLOCKS], blocks);
    memset(plan->status.mapped, 0, arrays->count[GIRIH_BIND_STATUS] * 4);
    return GIRIH_OK;
}

// The part of an output buffer that a window shows; a buffer that is not there is stood in for by
// the sort's counters, which no shader that could write through this binding reads.
static VkDescriptorBufferInfo window_info(const girih_plan *plan, const girih_buffer *buffer,
                                          uint32_t window, uint32_t window_size, uint32_t windows,
                                          uint32_t bytes) {
    if (!buffer->buffer) {
        return (VkDescriptorBufferInfo){.buffer = plan->buffer.buffer,
                                        .offset = plan->offset[GIRIH_BIND_COUNTERS],
                                        .range = plan->arrays.count[GIRIH_BIND_COUNTERS] * 4};
    }
    if (window >= windows) {
        window = windows - 1;
    }
    const VkDeviceSize offset = (VkDeviceSize)window * window_size * bytes;
    const VkDeviceSize most = (VkDeviceSize)window_size * bytes;
    const VkDeviceSize rest = buffer->size - offset;
    return (VkDescriptorBufferInfo){
        .buffer = buffer->buffer, .offset = offset, .range = rest < most ? rest : most};
}

// What binding n shows in descriptor set `set`: with few buffers there are four sets a window, one
// for the vertices and one for each list that the third output kernel writes through the shared
// binding.
static VkDescriptorBufferInfo binding_info(const girih_plan *plan, uint32_t n, uint32_t window,
                                           uint32_t list) {
    const girih_context *context = plan->context;
    const girih_scene *scene = plan->scene;
    const girih_buffer *const lists[3] = {&plan->index_list, &plan->closed_list, &plan->sources};
    if (n == GIRIH_BIND_FRAME) {
        return (VkDescriptorBufferInfo){.buffer = plan->buffer.buffer,
                                        .offset = plan->frame_offset,
                                        .range = sizeof plan->arrays.frame};
    }
    if (n >= GIRIH_BIND_OUT_INDICES || (n == GIRIH_BIND_SHARED_LIST && list)) {
        const uint32_t which = n >= GIRIH_BIND_OUT_INDICES ? n - GIRIH_BIND_OUT_INDICES : list - 1;
        return window_info(plan, lists[which], window, plan->triangle_window,
                           plan->triangle_windows, which == 2 ? 8 : 12);
    }
    if (n == GIRIH_BIND_OUT_POSITIONS) {
        return window_info(plan, &plan->positions, window, plan->vertex_window,
                           plan->vertex_windows, 12);
    }
    if (n == GIRIH_BIND_OUT_ATTRIBUTES) {
        return window_info(plan, &plan->attributes, window, plan->vertex_window,
                           plan->vertex_windows, 4 * attribute_words(plan));
    }
    if (context->few_buffers) {
        const VkBuffer shared =
            n == GIRIH_BIND_SHARED_SCENE ? scene->buffer.buffer : plan->buffer.buffer;
        const VkDeviceSize size =
            n == GIRIH_BIND_SHARED_SCENE ? scene->buffer.size : plan->frame_offset;
        return (VkDescriptorBufferInfo){.buffer = shared, .range = size};
    }
    if (n >= PLAN_FIRST) {
        return (VkDescriptorBufferInfo){.buffer = plan->buffer.buffer,
                                        .offset = plan->offset[n],
                                        .range = plan->arrays.count[n] * 4};
    }
    if (n < GIRIH_BIND_PATTERNS) {
        return (VkDescriptorBufferInfo){.buffer = scene->buffer.buffer,
                                        .offset = scene->offset[n],
                                        .range = scene->arrays.count[n] * 4};
    }
    return (VkDescriptorBufferInfo){.buffer = n == GIRIH_BIND_PATTERN_INDICES
                                                  ? context->indices.buffer
                                                  : context->patterns.buffer,
                                    .offset = context->offset[n],
                                    .range = context->catalogue.count[n] * 4};
}

static girih_result create_descriptors(girih_plan *plan, girih_error *error) {
    const girih_context *context = plan->context;
    const uint32_t families = context->few_buffers ? 4 : 1;
    const uint32_t set_count = plan->window_count * families;
    if (plan->window_count > GIRIH_MAX_WINDOWS) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "plan: the output needs %u storage buffers' ranges, more than %u; refine less at once",
            plan->window_count, GIRIH_MAX_WINDOWS);
    }
    plan->sets = girih_allocate_array(set_count, sizeof *plan->sets);
    if (!plan->sets) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "plan: out of memory");
    }
    const VkDescriptorPoolSize sizes[2] = {
        {.type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, .descriptorCount = set_count},
        {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
         .descriptorCount = set_count * (GIRIH_BIND_COUNT - 1)}};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = set_count,
                                             .poolSizeCount = 2,
                                             .pPoolSizes = sizes};
    VkResult result =
        context->vk.CreateDescriptorPool(context->device, &pool, context->callbacks, &plan->pool);
    for (uint32_t n = 0; n < set_count && result == VK_SUCCESS; ++n) {
        const VkDescriptorSetAllocateInfo info = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
            .descriptorPool = plan->pool,
            .descriptorSetCount = 1,
            .pSetLayouts = &context->set_layout};
        result = context->vk.AllocateDescriptorSets(context->device, &info, &plan->sets[n]);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "creating descriptors", "plan", result);
    }
    for (uint32_t set = 0; set < set_count; ++set) {
        VkDescriptorBufferInfo infos[GIRIH_BIND_COUNT];
        VkWriteDescriptorSet writes[GIRIH_BIND_COUNT];
        uint32_t count = 0;
        for (uint32_t n = 0; n < GIRIH_BIND_COUNT; ++n) {
            if (context->few_buffers && n != GIRIH_BIND_FRAME && n != GIRIH_BIND_SHARED_SCENE &&
                n != GIRIH_BIND_SHARED_PLAN && n != GIRIH_BIND_OUT_POSITIONS &&
                n != GIRIH_BIND_OUT_ATTRIBUTES) {
                continue;
            }
            infos[count] =
                binding_info(plan, n, set % plan->window_count, set / plan->window_count);
            writes[count] = (VkWriteDescriptorSet){
                .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                .dstSet = plan->sets[set],
                .dstBinding = n,
                .descriptorCount = 1,
                .descriptorType = n == GIRIH_BIND_FRAME ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                        : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                .pBufferInfo = &infos[count]};
            ++count;
        }
        context->vk.UpdateDescriptorSets(context->device, count, writes, 0, NULL);
    }
    return GIRIH_OK;
}

// Every pipeline that any frame of this plan may use.
static girih_result need_pipelines(girih_plan *plan, girih_error *error) {
    const girih_context *context = plan->context;
    const girih_frame_block *frame = &plan->arrays.frame;
    const bool pn = plan->surface == GIRIH_SURFACE_PN;
    const bool serial = context->serial_sort;
    plan->variant = (frame->instance_count > 1 ? GIRIH_VARIANT_INSTANCES : 0) |
                    (plan->scene->table.seam_count ? GIRIH_VARIANT_SEAMS : 0) |
                    (frame->attribute_floats ? GIRIH_VARIANT_ATTRIBUTES : 0) |
                    (plan->mode == GIRIH_MODE_WELDED ? GIRIH_VARIANT_WELDED : 0);
    const uint32_t select = pn ? GIRIH_SHADER_select_pn : GIRIH_SHADER_select_flat;
    uint32_t evaluate = pn ? GIRIH_SHADER_evaluate_points_pn : GIRIH_SHADER_evaluate_points_flat;
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        evaluate = pn ? GIRIH_SHADER_evaluate_patches_pn : GIRIH_SHADER_evaluate_patches_flat;
    }
    const struct {
        uint32_t shader, further;
        bool wanted;
    } needs[] = {
        {GIRIH_SHADER_levels, GIRIH_LEVELS_UNIFORM << GIRIH_VARIANT_RULE_SHIFT, true},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_RANDOM << GIRIH_VARIANT_RULE_SHIFT, true},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_LENGTH << GIRIH_VARIANT_RULE_SHIFT, true},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_OBJECT_LENGTH << GIRIH_VARIANT_RULE_SHIFT, true},
        {GIRIH_SHADER_levels, GIRIH_LEVELS_RANDOM_LEVEL << GIRIH_VARIANT_RULE_SHIFT, true},
        {select, 0, true},
        {select, GIRIH_VARIANT_CULL, true},
        {serial ? GIRIH_SHADER_group_count_serial : GIRIH_SHADER_group_count_workgroup, 0, true},
        {serial ? GIRIH_SHADER_group_blocks_serial : GIRIH_SHADER_group_blocks_workgroup, 0, true},
        {GIRIH_SHADER_group_digits, 0, true},
        {serial ? GIRIH_SHADER_group_place_serial : GIRIH_SHADER_group_place_workgroup, 0, true},
        {GIRIH_SHADER_group_bounds, 0, true},
        {GIRIH_SHADER_dispatch_groups, 0, true},
        {GIRIH_SHADER_dispatch_draws, 0,
         plan->mode != GIRIH_MODE_INSTANCED && frame->draws_per_material},
        {evaluate, 0, true},
        {GIRIH_SHADER_output_lists, 0, plan->triangle_windows > 0},
        {GIRIH_SHADER_output_weld_blocks, 0, plan->mode == GIRIH_MODE_WELDED},
        {GIRIH_SHADER_output_weld_sums, 0, plan->mode == GIRIH_MODE_WELDED},
        {GIRIH_SHADER_output_weld_offsets, 0, plan->mode == GIRIH_MODE_WELDED},
    };
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < sizeof needs / sizeof *needs && result == GIRIH_OK; ++n) {
        if (needs[n].wanted) {
            result = girih_pipeline_need(context, needs[n].shader, plan->variant | needs[n].further,
                                         error);
        }
    }
    return result;
}

// See girih.glsl for the locations.
static void describe_vertex_input(girih_plan *plan) {
    uint32_t attributes = 0;
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        const bool pn = plan->surface == GIRIH_SURFACE_PN;
        const uint32_t words = patch_words(plan->surface);
        plan->bindings[0] = (VkVertexInputBindingDescription){0, 4, VK_VERTEX_INPUT_RATE_VERTEX};
        plan->bindings[1] =
            (VkVertexInputBindingDescription){1, words * 4, VK_VERTEX_INPUT_RATE_INSTANCE};
        plan->vertex_attributes[attributes++] =
            (VkVertexInputAttributeDescription){0, 0, VK_FORMAT_R32_UINT, 0};
        const uint32_t vectors = pn ? 12 : 4;
        for (uint32_t n = 0; n < vectors; ++n) {
            plan->vertex_attributes[attributes++] = (VkVertexInputAttributeDescription){
                1 + n, 1, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * n};
        }
        if (!pn) {
            plan->vertex_attributes[attributes++] =
                (VkVertexInputAttributeDescription){5, 1, VK_FORMAT_R32G32_SFLOAT, 64};
        }
        plan->vertex_attributes[attributes] = (VkVertexInputAttributeDescription){
            attributes, 1, VK_FORMAT_R32G32B32A32_UINT, pn ? 192 : 72};
        ++attributes;
    } else {
        plan->bindings[0] = (VkVertexInputBindingDescription){0, 12, VK_VERTEX_INPUT_RATE_VERTEX};
        plan->bindings[1] = (VkVertexInputBindingDescription){1, attribute_words(plan) * 4,
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

girih_result girih_plan_create(const girih_context *context, const girih_plan_desc *desc,
                               girih_plan **out, girih_error *error) {
    girih_result result = validate(context, desc, out, error);
    if (result != GIRIH_OK) {
        return result;
    }
    girih_plan *plan = girih_allocate(sizeof *plan);
    if (!plan) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "plan: out of memory");
    }
    *plan = (girih_plan){.context = context,
                         .scene = desc->scene,
                         .surface = desc->surface,
                         .mode = desc->mode,
                         .outputs = desc->outputs};
    girih_frame_block *frame = &plan->arrays.frame;
    *frame = context->catalogue.frame;
    frame->material_count = desc->scene->table.material_count;
    frame->attribute_floats = desc->scene->table.attribute_floats;
    const bool pattern_draws = choose_pattern_draws(plan, desc->max_triangles);
    if (plan->mode == GIRIH_MODE_WELDED || (plan->mode == GIRIH_MODE_BAKED && !pattern_draws &&
                                            !(plan->outputs & GIRIH_OUTPUT_NO_DRAW))) {
        plan->outputs |= GIRIH_OUTPUT_INDICES;
    }
    girih_plan_shape shape = {.mode = plan->mode,
                              .outputs = plan->outputs,
                              .max_vertices = desc->max_vertices,
                              .max_triangles = desc->max_triangles,
                              .pattern_draws = pattern_draws,
                              .serial_sort = context->serial_sort};
    result = girih_pack_plan(&plan->arrays, &shape, &desc->scene->table, desc->instances,
                             desc->instance_count, error);
    if (result == GIRIH_OK && !pattern_draws && plan->mode != GIRIH_MODE_INSTANCED &&
        !(plan->outputs & GIRIH_OUTPUT_NO_DRAW) &&
        shape.max_vertices > context->limits.maxDrawIndexedIndexValue) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                            "plan: room for %llu output vertices is more than the device's indices "
                            "reach (%u); refine less at once",
                            (unsigned long long)shape.max_vertices,
                            context->limits.maxDrawIndexedIndexValue);
    }
    if (result == GIRIH_OK) {
        result = create_inputs(plan, error);
    }
    // vkCmdDrawIndexedIndirect counts vertices from a signed offset and triangles by their indices.
    if (result == GIRIH_OK && (plan->arrays.frame.max_vertices > INT32_MAX ||
                               plan->arrays.frame.max_triangles > UINT32_MAX / 3)) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                            "plan: room for %u vertices and %u triangles; at most %u and %u can be "
                            "drawn, refine less at once",
                            plan->arrays.frame.max_vertices, plan->arrays.frame.max_triangles,
                            (unsigned)INT32_MAX, UINT32_MAX / 3);
    }
    girih_arrays_free(&plan->arrays, 0, GIRIH_BIND_COUNT);
    if (result == GIRIH_OK) {
        result = create_outputs(plan, desc, error);
    }
    if (result == GIRIH_OK) {
        result = create_descriptors(plan, error);
    }
    if (result == GIRIH_OK) {
        result = need_pipelines(plan, error);
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
    girih_buffer *const buffers[] = {&plan->buffer,      &plan->staging,    &plan->status,
                                     &plan->positions,   &plan->attributes, &plan->index_list,
                                     &plan->closed_list, &plan->sources};
    for (size_t n = 0; n < sizeof buffers / sizeof *buffers; ++n) {
        girih_buffer_destroy(context, buffers[n]);
    }
    girih_free(plan->sets);
    girih_free(plan);
}

girih_result girih_plan_set_transform(girih_plan *plan, uint32_t instance,
                                      const float transform[12]) {
    if (!plan || !transform || instance >= plan->arrays.frame.instance_count) {
        return GIRIH_ERROR_INVALID_ARGUMENT;
    }
    for (int n = 0; n < 12; ++n) {
        if (!(transform[n] >= -GIRIH_MAX_COORDINATE && transform[n] <= GIRIH_MAX_COORDINATE)) {
            return GIRIH_ERROR_INVALID_DATA;
        }
    }
    girih_pack_transform((uint32_t *)plan->staging.mapped + (size_t)instance * GIRIH_INSTANCE_WORDS,
                         transform);
    if (plan->arrays.frame.instance_count == 1) {
        memcpy(plan->arrays.frame.only_instance, plan->staging.mapped,
               sizeof plan->arrays.frame.only_instance);
    }
    return GIRIH_OK;
}

const VkPipelineVertexInputStateCreateInfo *girih_plan_vertex_input(const girih_plan *plan) {
    return &plan->vertex_input;
}

girih_statistics girih_plan_statistics(const girih_plan *plan) {
    return girih_read_status(&plan->arrays.frame, plan->status.mapped);
}

girih_plan_buffers girih_plan_get_buffers(const girih_plan *plan) {
    return (girih_plan_buffers){
        .positions = plan->positions.buffer,
        .attributes = plan->mode == GIRIH_MODE_INSTANCED ? VK_NULL_HANDLE : plan->attributes.buffer,
        .indices = plan->index_list.buffer,
        .closed_indices = plan->closed_list.buffer,
        .sources = plan->sources.buffer,
        .max_vertices = plan->arrays.frame.max_vertices,
        .max_triangles = plan->arrays.frame.max_triangles};
}

uint32_t girih_plan_material_count(const girih_plan *plan) {
    return plan->arrays.frame.material_count;
}

void girih_plan_material_range(const girih_plan *plan, uint32_t material, uint32_t *first_triangle,
                               uint32_t *triangle_count) {
    const uint32_t *firsts = (const uint32_t *)plan->status.mapped + GIRIH_STATUS_WORDS +
                             plan->arrays.frame.pattern_count;
    const bool there = material < plan->arrays.frame.material_count;
    *first_triangle = there ? firsts[material] : 0;
    *triangle_count = there ? firsts[material + 1] - firsts[material] : 0;
}
