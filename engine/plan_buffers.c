// How large a plan's buffers are, how their outputs are cut into windows, and making them.
#include <string.h>

#include "context.h"
#include "error.h"
#include "pack.h"

#define PLAN_FIRST GIRIH_BIND_INSTANCES
#define PLAN_END GIRIH_BIND_OUT_POSITIONS
#define WINDOW_STEP                                                                                \
    64u // outputs to which windows are rounded, so that every window's offset is aligned

uint32_t girih_patch_words(const girih_plan *plan) {
    const uint32_t part = plan->arrays.frame.max_splits > 0 ? GIRIH_PATCH_WORDS_PART : 0;
    switch (plan->surface) {
    case GIRIH_SURFACE_FLAT:
        return GIRIH_PATCH_WORDS_FLAT + part;
    case GIRIH_SURFACE_PN:
        return GIRIH_PATCH_WORDS_PN + part;
    default:
        return GIRIH_PATCH_WORDS_OWN + part;
    }
}

uint32_t girih_attribute_words(const girih_plan *plan) {
    return plan->mode == GIRIH_MODE_INSTANCED ? girih_patch_words(plan)
                                              : plan->arrays.frame.attribute_stride;
}

// The most outputs of `bytes` bytes that one storage buffer shows.
static uint32_t window_of(const girih_context *context, uint32_t bytes) {
    return (uint32_t)(context->limits.maxStorageBufferRange / bytes) / WINDOW_STEP * WINDOW_STEP;
}

static uint32_t windows_for(uint64_t count, uint32_t window) {
    const uint64_t windows = (count + window - 1) / window;
    return windows ? (uint32_t)windows : 1;
}

static girih_result find_windows(girih_plan *plan, uint64_t vertices, girih_error *error) {
    const girih_context *context = plan->context;
    const uint32_t words = girih_attribute_words(plan);
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
            ? windows_for(plan->arrays.frame.max_triangles, plan->triangle_window)
            : 0;
    plan->window_count = plan->vertex_windows > plan->triangle_windows ? plan->vertex_windows
                                                                       : plan->triangle_windows;
    return GIRIH_OK;
}

// Where the plan's own arrays lie in WORK, and its size.
static girih_result lay_out_work(girih_plan *plan, girih_error *error) {
    const girih_context *context = plan->context;
    girih_arrays *arrays = &plan->arrays;
    VkDeviceSize size = 0;
    girih_layout_arrays(arrays, PLAN_FIRST, GIRIH_BIND_WELD_OFFSETS, plan->offset, &size);
    _Static_assert(GIRIH_BIND_WELD_OFFSETS + 1 == PLAN_END, "no array of the plan's lies behind");
    // The offsets are written when the sort is done, so they lie in its spare items where they fit.
    plan->offset[GIRIH_BIND_WELD_OFFSETS] = plan->offset[GIRIH_BIND_ITEMS_SPARE];
    if (arrays->count[GIRIH_BIND_WELD_OFFSETS] > arrays->count[GIRIH_BIND_ITEMS_SPARE]) {
        girih_layout_arrays(arrays, GIRIH_BIND_WELD_OFFSETS, PLAN_END, plan->offset, &size);
    }
    plan->frame_offset = (size + 255) / 256 * 256;
    const girih_result result = girih_check_ranges(context, arrays, PLAN_FIRST, PLAN_END,
                                                   plan->frame_offset, "plan", error);
    // Arrays that share a buffer binding are told apart by their first word in it.
    for (uint32_t n = GIRIH_BIND_VERTICES; n < PLAN_END; ++n) {
        const VkDeviceSize offset = n < PLAN_FIRST ? plan->scene->offset[n] : plan->offset[n];
        arrays->frame.bases[n / 4][n % 4] = (uint32_t)(offset / 4);
    }
    return result;
}

girih_result girih_plan_find_needs(girih_plan *plan, const girih_plan_desc *desc,
                                   girih_buffer_need needs[GIRIH_PLAN_BUFFERS],
                                   girih_error *error) {
    const girih_arrays *arrays = &plan->arrays;
    const bool instanced = plan->mode == GIRIH_MODE_INSTANCED;
    const VkBufferUsageFlags common = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                      VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const VkBufferUsageFlags vertex =
        common | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | desc->vertex_usage;
    const VkBufferUsageFlags index = common | VK_BUFFER_USAGE_INDEX_BUFFER_BIT | desc->index_usage;
    // Instanced, a patch for each triangle and each part.
    uint64_t vertices = instanced
                            ? (uint64_t)arrays->frame.triangle_count + arrays->frame.max_splits
                            : arrays->frame.max_vertices;
    uint64_t triangles = arrays->frame.max_triangles;
    girih_result result = lay_out_work(plan, error);
    if (result == GIRIH_OK) {
        result = find_windows(plan, vertices, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    // Buffers of no bytes cannot be made.
    vertices = vertices ? vertices : 1;
    triangles = triangles ? triangles : 1;
    const uint32_t outputs = plan->outputs;
    needs[GIRIH_PLAN_WORK] = girih_need(
        "plan", plan->frame_offset + sizeof arrays->frame,
        common | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, false);
    needs[GIRIH_PLAN_STAGING] =
        girih_need("plan staging",
                   (arrays->count[GIRIH_BIND_INSTANCES] + arrays->count[GIRIH_BIND_BLOCKS]) * 4,
                   VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
    needs[GIRIH_PLAN_STATUS] = girih_need("plan status", arrays->count[GIRIH_BIND_STATUS] * 4,
                                          VK_BUFFER_USAGE_TRANSFER_DST_BIT, true);
    needs[GIRIH_PLAN_POSITIONS] =
        girih_need("output positions", instanced ? 0 : vertices * 12, vertex, false);
    needs[GIRIH_PLAN_ATTRIBUTES] =
        girih_need(instanced ? "patches" : "output attributes",
                   vertices * girih_attribute_words(plan) * 4, vertex, false);
    needs[GIRIH_PLAN_INDICES] = girih_need(
        "output indices", outputs & GIRIH_OUTPUT_INDICES ? triangles * 12 : 0, index, false);
    needs[GIRIH_PLAN_CLOSED_INDICES] =
        girih_need("closed output indices",
                   outputs & GIRIH_OUTPUT_CLOSED_INDICES ? triangles * 12 : 0, index, false);
    needs[GIRIH_PLAN_SOURCES] = girih_need(
        "output sources", outputs & GIRIH_OUTPUT_SOURCES ? triangles * 8 : 0, index, false);
    return GIRIH_OK;
}

girih_result girih_plan_create_buffers(girih_plan *plan, const girih_buffer_range *given,
                                       const girih_buffer_need needs[GIRIH_PLAN_BUFFERS],
                                       girih_error *error) {
    const girih_arrays *arrays = &plan->arrays;
    for (uint32_t n = 0; n < GIRIH_PLAN_BUFFERS; ++n) {
        const girih_result result = girih_buffer_create(
            plan->context, &needs[n], given ? &given[n] : NULL, &plan->buffers[n], error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    const size_t instances = arrays->count[GIRIH_BIND_INSTANCES] * 4;
    char *staging = plan->buffers[GIRIH_PLAN_STAGING].mapped;
    memcpy(staging, arrays->words[GIRIH_BIND_INSTANCES], instances);
    memcpy(staging + instances, arrays->words[GIRIH_BIND_BLOCKS],
           arrays->count[GIRIH_BIND_BLOCKS] * 4);
    memset(plan->buffers[GIRIH_PLAN_STATUS].mapped, 0, arrays->count[GIRIH_BIND_STATUS] * 4);
    // Index buffers are bound at 0: lavapipe ignores the offset in indirect draws.
    const VkDeviceSize first = plan->buffers[GIRIH_PLAN_INDICES].offset / 4;
    if (first > UINT32_MAX - 3 * (uint64_t)arrays->frame.max_triangles) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: the range given for output indices begins beyond what 32 bits can "
                          "number; give one nearer to its buffer's begin");
    }
    plan->arrays.frame.first_list_index = (uint32_t)first;
    return GIRIH_OK;
}
