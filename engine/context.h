// Private half of context, scene and plan.
#ifndef GIRIH_ENGINE_CONTEXT_H
#define GIRIH_ENGINE_CONTEXT_H

#include <stdbool.h>

#include "arrays.h"
#include "girih/context.h"
#include "girih/plan.h"
#include "vulkan.h"

// Every shader of the library: shader_list.h is written by the build from its list.
#define GIRIH_SHADER_ID(NAME) GIRIH_SHADER_##NAME,
enum {
#include "shader_list.h"
    GIRIH_SHADERS(GIRIH_SHADER_ID) GIRIH_SHADER_COUNT
};
#undef GIRIH_SHADER_ID

// Variants of one shader: at most four of the bits of GIRIH_VARIANT_* concern it.
#define GIRIH_MAX_VARIANTS 16

typedef struct girih_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceSize size;
    void *mapped; // host-visible buffers stay mapped and are coherent
} girih_buffer;

struct girih_context {
    girih_functions vk;
    VkPhysicalDevice physical_device;
    VkDevice device;
    const VkAllocationCallbacks *callbacks;
    VkPhysicalDeviceFeatures features; // enabled
    VkPhysicalDeviceLimits limits;
    VkDeviceSize max_allocation;
    VkPhysicalDeviceMemoryProperties memory;
    uint32_t surfaces;
    bool serial_sort;
    bool few_buffers;

    girih_arrays catalogue; // the catalogue's arrays and its part of the frame block
    girih_buffer patterns;  // PATTERNS and PATTERN_VERTICES
    girih_buffer indices;   // PATTERN_INDICES, alone: lavapipe ignores the bind offset of index
                            // buffers in indirect draws
    girih_buffer staging; // both, for girih_cmd_upload_context
    VkDeviceSize offset[GIRIH_BIND_COUNT]; // of each array in its buffer

    VkDescriptorSetLayout set_layout;
    VkDescriptorSetLayout draw_set_layout;
    VkPipelineLayout pipeline_layout;
    VkPipelineCache pipeline_cache;
    // Made when a plan first needs them; a slot is only ever filled, by whichever thread is first.
    _Atomic(VkPipeline) pipelines[GIRIH_SHADER_COUNT][GIRIH_MAX_VARIANTS];
};

struct girih_scene {
    const girih_context *context;
    girih_scene_table table;
    girih_arrays arrays; // counts and frame fields; the words are gone after the packing
    girih_buffer buffer;
    girih_buffer staging;
    VkDeviceSize offset[GIRIH_BIND_COUNT];
    VkDescriptorPool pool;
    VkDescriptorSet draw_set;
};

#define GIRIH_MAX_WINDOWS 4096u

struct girih_plan {
    const girih_context *context;
    const girih_scene *scene;
    girih_surface surface;
    girih_mode mode;
    uint32_t outputs;
    uint32_t variant;     // GIRIH_VARIANT_*, without CULL and the rule
    girih_arrays arrays;  // counts and frame; the words are gone after the packing
    girih_buffer buffer;  // frame block and the plan's arrays
    girih_buffer staging; // INSTANCES and BLOCKS for upload, mapped
    girih_buffer status;  // what the host reads, mapped
    girih_buffer positions, attributes, index_list, closed_list, sources;
    VkDeviceSize offset[GIRIH_BIND_COUNT];
    VkDeviceSize frame_offset;

    // Outputs beyond maxStorageBufferRange are written window by window, each with descriptors of
    // its own.
    uint32_t vertex_window,
        vertex_windows; // vertices (instanced: patches) to a window, and how many
    uint32_t triangle_window, triangle_windows;
    uint32_t window_count; // the larger of both
    VkDescriptorPool pool;
    VkDescriptorSet
        *sets; // [window_count], few buffers: [4][window_count]: vertices, then each list

    VkVertexInputBindingDescription bindings[2];
    VkVertexInputAttributeDescription vertex_attributes[14];
    VkPipelineVertexInputStateCreateInfo vertex_input;
};

// --- buffer.c -----------------------------------------------------------------------------------

// Creates a buffer with memory of its own. host: mapped, coherent, cached where there is a choice.
girih_result girih_buffer_create(const girih_context *context, VkDeviceSize size,
                                 VkBufferUsageFlags usage, bool host, const char *what,
                                 girih_buffer *buffer, girih_error *error);
void girih_buffer_destroy(const girih_context *context, girih_buffer *buffer);

// Lays the arrays of the bindings [first, end) out one after another from *size on: offset[] and
// *size.
void girih_layout_arrays(const girih_arrays *arrays, uint32_t first, uint32_t end,
                         VkDeviceSize offset[GIRIH_BIND_COUNT], VkDeviceSize *size);

// Refuses arrays of the bindings [first, end) that a storage buffer cannot show; few buffers: all
// from the buffer's begin on together, `size` bytes.
girih_result girih_check_ranges(const girih_context *context, const girih_arrays *arrays,
                                uint32_t first, uint32_t end, VkDeviceSize size, const char *what,
                                girih_error *error);

girih_result girih_vulkan_failed(girih_error *error, const char *call, const char *what,
                                 VkResult result);

// --- pipeline.c ---------------------------------------------------------------------------------

// Makes the pipeline of a shader's variant (GIRIH_VARIANT_*) if it is not there yet. Thread-safe.
girih_result girih_pipeline_need(const girih_context *context, uint32_t shader, uint32_t variant,
                                 girih_error *error);

// The pipeline of a variant that a plan has needed.
VkPipeline girih_pipeline_get(const girih_context *context, uint32_t shader, uint32_t variant);

// --- Recording: each stage's file records its own dispatches ------------------------------------

void girih_barrier(const girih_context *context, VkCommandBuffer commands,
                   VkPipelineStageFlags from_stage, VkAccessFlags from_access,
                   VkPipelineStageFlags to_stage, VkAccessFlags to_access);

// Compute shader writes made visible to the next dispatch, its arguments included.
void girih_compute_barrier(const girih_context *context, VkCommandBuffer commands);

// Binds the plan's variant of a shader, with the bits of `further` added.
void girih_bind_pipeline(const girih_plan *plan, VkCommandBuffer commands, uint32_t shader,
                         uint32_t further);
// Binds descriptor set `set` of the plan's sets.
void girih_bind_set(const girih_plan *plan, VkCommandBuffer commands, uint32_t set);
void girih_push(const girih_plan *plan, VkCommandBuffer commands, const girih_push_block *push);

// A dispatch of at least `invocations` invocations in workgroups of `size`, in two dimensions where
// one is too short.
void girih_dispatch_invocations(const girih_plan *plan, VkCommandBuffer commands,
                                uint64_t invocations, uint32_t size);

// A dispatch whose arguments dispatch.comp wrote (GIRIH_STATUS_EVALUATE).
void girih_dispatch_items(const girih_plan *plan, VkCommandBuffer commands);

void girih_record_levels(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_select(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_group(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_weld(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_dispatch(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_evaluate(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_output(const girih_plan *plan, VkCommandBuffer commands);

#endif
