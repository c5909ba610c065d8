// Requirements and context: girih on one Vulkan device.
//
// Instance, device, queues, command buffers and submission are the host's. girih calls Vulkan
// through the host's vkGetInstanceProcAddr alone and does not link the loader. Where nothing else
// is said, functions that take const objects may be called by several threads at once.
//
// Stability: stable, but for host_set_layouts and push_constant_* (experimental)
#ifndef GIRIH_CONTEXT_H
#define GIRIH_CONTEXT_H

#include <vulkan/vulkan_core.h>

#include "girih/catalogue.h"
#include "girih/result.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Requirements: read before the device is created --------------------------------------------

// What girih needs of a device: Vulkan 1.1 with its required limits, and nothing else; no
// extension. Optional features and further limits are used where they are there.
typedef struct girih_requirements {
    uint32_t api_version;              // VK_API_VERSION_1_1
    VkQueueFlags queue;                // what the queue that runs girih's commands must offer
    VkPhysicalDeviceFeatures optional; // worth enabling: each is VK_TRUE
    VkPhysicalDeviceLimits required; // the least that will do; limits girih does not look at are 0
    VkPhysicalDeviceLimits useful;   // beyond these nothing gets better, likewise
} girih_requirements;
GIRIH_API girih_requirements girih_get_requirements(void);

// Compares a physical device with the requirements: GIRIH_ERROR_UNSUPPORTED names what is missing.
// Thread-safe.
GIRIH_API girih_result girih_check_device(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                          VkInstance instance, VkPhysicalDevice physical_device,
                                          girih_error *error);

// --- Memory: sizes first, then buffers ----------------------------------------------------------

// A buffer that a context, a scene or a plan wants.
typedef struct girih_buffer_need {
    const char *name;         // for people
    VkDeviceSize size;        // bytes; 0: not wanted, whatever is given for it is left alone
    VkDeviceSize alignment;   // of the range's offset in its buffer, a power of two
    VkBufferUsageFlags usage; // what the buffer must have been created with
    int mapped;               // host-visible, coherent and mapped; else device-local serves best
} girih_buffer_need;

// A range of a buffer, the host's or girih's.
typedef struct girih_buffer_range {
    VkBuffer buffer;     // VK_NULL_HANDLE in an array of the host's: girih makes this one itself
    VkDeviceSize offset; // bytes
    void *mapped;        // the mapped memory at offset, where the need says mapped
} girih_buffer_range;

// --- Context ------------------------------------------------------------------------------------

// How triangles are sorted; both give the same bytes.
typedef enum girih_sort {
    GIRIH_SORT_AUTO = 0,      // by the device's kind
    GIRIH_SORT_SERIAL = 1,    // one lane a block of triangles: for CPU devices
    GIRIH_SORT_WORKGROUP = 2, // one workgroup a block of triangles: for GPUs
} girih_sort;

// The buffers of a context, in the order of girih_context_needs.
typedef enum girih_context_buffer {
    GIRIH_CONTEXT_PATTERNS = 0,
    GIRIH_CONTEXT_INDICES = 1,
    GIRIH_CONTEXT_STAGING = 2, // only until the recorded girih_cmd_upload_context has been executed
} girih_context_buffer;
#define GIRIH_CONTEXT_BUFFERS 3

typedef struct girih_context_desc {
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    const VkPhysicalDeviceFeatures *enabled_features; // as the device was made with; NULL: none
    VkQueueFlags queue_flags; // of the queue family that runs girih's commands; 0: graphics and
                              // compute. Barriers name no graphics stage where there is none
    const girih_catalogue *catalogue; // NULL: the built-in dyadic one; must outlive the context
    girih_sort sort;
    int few_buffers; // not 0: use 4 storage buffers a stage even where there are more
    VkPipelineCache pipeline_cache; // may be VK_NULL_HANDLE; must outlive the context
    const VkAllocationCallbacks *allocation_callbacks; // may be NULL; must outlive the context

    // Where girih's compute pipelines have their descriptors and push constants, for hosts that
    // keep sets of their own bound throughout: girih's set number is host_set_layout_count, and its
    // pipeline layouts begin with the host's layouts, so that recording disturbs none of them. The
    // layouts must outlive the context. At least two sets must be left: maxBoundDescriptorSets - 2.
    // Storage buffers that the host's layouts show the compute stage count together with girih's
    // (30, or 4 with few_buffers) against maxPerStageDescriptorStorageBuffers: the host must add
    // them up.
    const VkDescriptorSetLayout *host_set_layouts; // NULL where the count is 0
    uint32_t host_set_layout_count;
    // The host's push constant ranges, copied into girih's pipeline layouts; one of them must offer
    // GIRIH_PUSH_CONSTANT_BYTES from push_constant_offset on to the compute stage, and none may
    // overlap these bytes in part. Count 0: girih has one range of its own at push_constant_offset.
    const VkPushConstantRange *push_constant_ranges;
    uint32_t push_constant_range_count;
    uint32_t push_constant_offset; // bytes, a multiple of 4

    const girih_buffer_range *buffers; // [GIRIH_CONTEXT_BUFFERS]; NULL: girih makes all. They must
                                       // outlive the context and stay the host's
} girih_context_desc;

#define GIRIH_PUSH_CONSTANT_BYTES 24u

// Pipelines for one device and one catalogue. Any number of threads may use it at once: all that
// ever changes are pipelines made, without a lock, when a plan first needs them.
typedef struct girih_context girih_context;

// The buffers a context of this description wants, for a host that brings them. Thread-safe.
GIRIH_API girih_result girih_context_needs(const girih_context_desc *desc,
                                           girih_buffer_need needs[GIRIH_CONTEXT_BUFFERS],
                                           girih_error *error);

// On success *context is the caller's; record girih_cmd_upload_context once before the first use.
// Thread-safe.
GIRIH_API girih_result girih_context_create(const girih_context_desc *desc, girih_context **context,
                                            girih_error *error);

// Records the upload of the catalogue: begins with no access, ends with transfer writes made
// available and visible to compute, vertex shader, vertex input, index and transfer reads.
GIRIH_API void girih_cmd_upload_context(const girih_context *context, VkCommandBuffer commands);

// Frees the upload's staging buffer, if it is girih's, once the recorded upload has been executed.
// Optional. Not while another thread uses the context.
GIRIH_API void girih_context_trim(girih_context *context);

// Takes NULL. Its surface programs, scenes and plans must be destroyed before.
GIRIH_API void girih_context_destroy(girih_context *context);

// Whether the context uses 4 storage buffers a stage: which of a surface program's two modules it
// takes.
GIRIH_API int girih_context_uses_few_buffers(const girih_context *context);

// The descriptor set layout of girih.glsl in a host's vertex shader, for the instanced mode;
// girih_cmd_draw binds its set at the number the host asks for.
GIRIH_API VkDescriptorSetLayout girih_context_draw_set_layout(const girih_context *context);

#ifdef __cplusplus
}
#endif
#endif
