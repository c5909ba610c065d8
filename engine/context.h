// Private half of context, scene and plan.
#ifndef GIRIH_ENGINE_CONTEXT_H
#define GIRIH_ENGINE_CONTEXT_H

#include <stdbool.h>

#include "arrays.h"
#include "girih/plan.h"
#include "vulkan.h"

// Every shader of the library: shader_list.h is written by the build from its list.
#define GIRIH_SHADER_ID(NAME) GIRIH_SHADER_##NAME,
enum {
#include "shader_list.h"
    GIRIH_SHADERS(GIRIH_SHADER_ID) GIRIH_SHADER_COUNT
};
#undef GIRIH_SHADER_ID

// Variants of one shader: at most eight of the bits of GIRIH_VARIANT_* concern it.
#define GIRIH_MAX_VARIANTS 256

// A range of a buffer: girih's own, with memory of its own, or a part of the host's.
typedef struct girih_buffer {
    VkBuffer buffer;
    VkDeviceSize offset;   // 0 where it is girih's
    VkDeviceMemory memory; // VK_NULL_HANDLE where it is the host's
    VkDeviceSize size;
    void *mapped; // at offset; host-visible buffers stay mapped and are coherent
} girih_buffer;

// Where the pipelines' descriptors and push constants are among the host's. Owned copies.
typedef struct girih_placement {
    uint32_t set;                     // girih's set number; a surface program's is the next
    VkDescriptorSetLayout *host_sets; // [set]
    VkPushConstantRange *ranges;
    uint32_t range_count;
    uint32_t push_offset;           // bytes
    VkShaderStageFlags push_stages; // of all ranges at push_offset: vkCmdPushConstants names them
} girih_placement;

struct girih_context {
    girih_functions vk;
    VkPhysicalDevice physical_device;
    VkDevice device;
    const VkAllocationCallbacks *callbacks;
    VkPhysicalDeviceFeatures features; // enabled
    VkPhysicalDeviceLimits limits;
    VkDeviceSize max_allocation;
    VkPhysicalDeviceMemoryProperties memory;
    bool is_cpu; // the device's type
    bool serial_sort;
    bool few_buffers;
    bool compute_only; // the queue knows no graphics stage

    girih_arrays catalogue; // the catalogue's arrays and its part of the frame block
    girih_buffer patterns;  // PATTERNS and PATTERN_VERTICES
    girih_buffer indices;   // PATTERN_INDICES, alone: lavapipe ignores the bind offset of index
                            // buffers in indirect draws
    girih_buffer staging;   // both, for girih_cmd_upload_context
    VkDeviceSize offset[GIRIH_BIND_COUNT]; // of each array in its girih_buffer's range

    VkDescriptorSetLayout set_layout;
    VkDescriptorSetLayout draw_set_layout;
    VkPipelineLayout pipeline_layout;
    girih_placement placement;
    VkPipelineCache pipeline_cache;
    // Made when a plan first needs them; a slot is only ever filled, by whichever thread is first.
    _Atomic(VkPipeline) pipelines[GIRIH_SHADER_COUNT][GIRIH_MAX_VARIANTS];
};

// A host's surface.
struct girih_surface_program {
    const girih_context *context;
    uint32_t *words; // SPIR-V of the module that the context takes; NULL: none
    size_t bytes;
    VkPipelineLayout pipeline_layout; // the context's, with the surface's own set after it
    girih_surface base;
    float reach; // negative: unknown
    // As the context's pipelines.
    _Atomic(VkPipeline) pipelines[GIRIH_MAX_VARIANTS];
};

struct girih_scene {
    const girih_context *context;
    girih_scene_table table;
    girih_arrays arrays; // counts and frame fields; the words are gone after the packing
    bool dynamic;
    uint32_t previous_vertices; // see GIRIH_FRAME_BLOCK; VERTICES' count includes them
    girih_buffer buffer;
    girih_buffer staging;
    VkDeviceSize offset[GIRIH_BIND_COUNT];
};

#define GIRIH_MAX_WINDOWS 4096u

struct girih_plan {
    const girih_context *context;
    const girih_scene *scene;
    girih_surface surface;
    const girih_surface_program *program; // GIRIH_SURFACE_OWN
    girih_mode mode;
    uint32_t outputs;
    uint32_t variant;    // GIRIH_VARIANT_*, without CULL and the rule
    bool small;          // stages 1 to 4 are one dispatch: glsl/small.comp
    girih_arrays arrays; // counts and frame; the words are gone after the packing
    girih_buffer buffers[GIRIH_PLAN_BUFFERS]; // WORK: frame block and the plan's arrays; STAGING:
                                              // INSTANCES and BLOCKS for upload; STATUS: what the
                                              // host reads
    VkDeviceSize offset[GIRIH_BIND_COUNT];    // in WORK
    VkDeviceSize frame_offset;

    // What the last recorded girih_cmd_refine was given.
    girih_frame_block recorded;
    VkDescriptorSet surface_set;
    uint64_t recorded_revision;
    bool current; // nothing else has changed since

    // Outputs beyond maxStorageBufferRange are written window by window, each with descriptors of
    // its own.
    uint32_t vertex_window,
        vertex_windows; // vertices (instanced: patches) to a window, and how many
    uint32_t triangle_window, triangle_windows;
    uint32_t window_count; // the larger of both
    VkDescriptorPool pool;
    VkDescriptorSet
        *sets; // [window_count], few buffers: [4][window_count]: vertices, then each list
    VkDescriptorSet draw_set; // instanced: what girih.glsl reads in the vertex shader

    VkVertexInputBindingDescription bindings[2];
    VkVertexInputAttributeDescription vertex_attributes[16];
    VkPipelineVertexInputStateCreateInfo vertex_input;
};

// --- buffer.c -----------------------------------------------------------------------------------

// What is wanted, as the host may read it.
girih_buffer_need girih_need(const char *name, VkDeviceSize size, VkBufferUsageFlags usage,
                             bool mapped);

// Takes the host's range for a need or, where given is NULL or empty, makes a buffer with memory of
// its own. A need of size 0 gives an empty buffer. Ranges that cannot serve (alignment, no mapped
// memory) are refused.
girih_result girih_buffer_create(const girih_context *context, const girih_buffer_need *need,
                                 const girih_buffer_range *given, girih_buffer *buffer,
                                 girih_error *error);
// Destroys what is girih's.
void girih_buffer_destroy(const girih_context *context, girih_buffer *buffer);
girih_buffer_range girih_buffer_as_range(const girih_buffer *buffer);

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

// --- context.c ----------------------------------------------------------------------------------

// The host's sets, girih's and, where it is not VK_NULL_HANDLE, `own` after it; the push constants
// are the context's. *layout stays untouched on failure.
girih_result girih_create_pipeline_layout(const girih_context *context, VkDescriptorSetLayout own,
                                          const char *what, VkPipelineLayout *layout,
                                          girih_error *error);

// --- spirv.c ------------------------------------------------------------------------------------

// Moves a module's descriptor sets up by `set` and its push constant block by `push_offset` bytes,
// in place. False: the words are no SPIR-V module.
bool girih_spirv_place(uint32_t *words, size_t bytes, uint32_t set, uint32_t push_offset);

// --- surface.c ----------------------------------------------------------------------------------

// As girih_pipeline_need and girih_pipeline_get, for the evaluation of a host's surface in buffers.
girih_result girih_surface_pipeline_need(const girih_surface_program *program, uint32_t variant,
                                         girih_error *error);
VkPipeline girih_surface_pipeline_get(const girih_surface_program *program, uint32_t variant);

// --- plan_buffers.c and plan_descriptors.c ------------------------------------------------------

// Words of one triangle's patch in the instanced mode.
uint32_t girih_patch_words(const girih_plan *plan);
// Words of one record of the plan's attribute buffer: a patch, or an output vertex.
uint32_t girih_attribute_words(const girih_plan *plan);

// From the packed counts: windows, offsets, and what every buffer must be.
girih_result girih_plan_find_needs(girih_plan *plan, const girih_plan_desc *desc,
                                   girih_buffer_need needs[GIRIH_PLAN_BUFFERS], girih_error *error);
// Makes the buffers or takes those given (may be NULL), and fills the staging and status memory.
girih_result girih_plan_create_buffers(girih_plan *plan, const girih_buffer_range *given,
                                       const girih_buffer_need needs[GIRIH_PLAN_BUFFERS],
                                       girih_error *error);
girih_result girih_plan_create_descriptors(girih_plan *plan, girih_error *error);

// --- select.c and evaluate.c: the shader of a plan's surface ------------------------------------

uint32_t girih_select_shader(const girih_plan *plan);
uint32_t girih_evaluate_shader(const girih_plan *plan);
// Whether corners and edges are evaluated apart from the triangles, once each, where nothing is
// culled.
bool girih_evaluates_borders(const girih_plan *plan);
// Whether the parts of split triangles are evaluated apart from the triangles that are not split.
bool girih_evaluates_parts(const girih_plan *plan);
uint32_t girih_edges_shader(const girih_plan *plan);
// Whether the host's surface is evaluated in buffers, by its program's pipeline.
bool girih_evaluates_own_points(const girih_plan *plan);

// --- small.c: stages 1 to 4 of a small plan in one dispatch
// ---------------------------------------

// Whether a plan is one, by its counts.
bool girih_is_small(const girih_plan *plan);
// girih_pipeline_need for every frame that it may be given.
girih_result girih_small_need(const girih_plan *plan, girih_error *error);

// --- plan.c -------------------------------------------------------------------------------------

// Makes every pipeline that any frame of this plan may use.
girih_result girih_plan_need_pipelines(const girih_plan *plan, girih_error *error);

// --- pipeline.c ---------------------------------------------------------------------------------

// A compute pipeline from SPIR-V, specialized to a variant's bits, stored into an empty slot unless
// another thread was first. The words are placed already.
girih_result girih_pipeline_create(const girih_context *context, const uint32_t *words,
                                   size_t bytes, uint32_t variant, VkPipelineLayout layout,
                                   const _Atomic(VkPipeline) *slot, girih_error *error);

// The bits of variant that mask selects, moved together: the number of a slot.
uint32_t girih_variant_slot(uint32_t variant, uint32_t mask);

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

// A dispatch whose arguments dispatch.glsl writes: GIRIH_STATUS_EVALUATE or GIRIH_STATUS_INTERIOR.
void girih_dispatch_items(const girih_plan *plan, VkCommandBuffer commands, uint32_t arguments);

void girih_record_levels(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_select(const girih_plan *plan, VkCommandBuffer commands);
// Nothing where no triangle can be split; ends with a barrier.
void girih_record_split(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_group(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_weld(const girih_plan *plan, VkCommandBuffer commands);
// The shader that walks through the groups, by their number.
uint32_t girih_dispatch_shader(const girih_plan *plan);
void girih_record_dispatch(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_small(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_evaluate(const girih_plan *plan, VkCommandBuffer commands);
void girih_record_output(const girih_plan *plan, VkCommandBuffer commands);

#endif
