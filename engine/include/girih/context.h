// Requirements and context: girih on one Vulkan device.
//
// Instance, device, queues, command buffers and submission are the host's. girih calls Vulkan
// through the host's vkGetInstanceProcAddr alone and does not link the loader.
#ifndef GIRIH_CONTEXT_H
#define GIRIH_CONTEXT_H

#include <vulkan/vulkan_core.h>

#include "girih/catalogue.h"
#include "girih/result.h"

#ifdef __cplusplus
extern "C" {
#endif

// What girih needs of a device: Vulkan 1.1 with its required limits, and nothing else. The features
// listed as optional are used where the host enabled them.
typedef struct girih_requirements {
    uint32_t api_version;              // VK_API_VERSION_1_1
    VkPhysicalDeviceFeatures optional; // worth enabling: each is VK_TRUE
    VkQueueFlags queue;                // what the queue that runs girih's commands must offer
} girih_requirements;
GIRIH_API girih_requirements girih_get_requirements(void);

typedef enum girih_surface {
    GIRIH_SURFACE_FLAT = 0, // the input's own triangles
    GIRIH_SURFACE_PN = 1,   // Curved PN triangles (Vlachos et al. 2001) with PN-AEN seams
} girih_surface;

// How triangles are sorted; both give the same bytes.
typedef enum girih_sort {
    GIRIH_SORT_AUTO = 0,      // by the device's kind
    GIRIH_SORT_SERIAL = 1,    // one lane a block of triangles: for CPU devices
    GIRIH_SORT_WORKGROUP = 2, // one workgroup a block of triangles: for GPUs
} girih_sort;

typedef struct girih_context_desc {
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    const VkPhysicalDeviceFeatures *enabled_features; // as the device was made with; NULL: none
    const girih_catalogue *catalogue; // NULL: the built-in dyadic one; must outlive the context
    uint32_t surfaces;                // bit mask of 1 << girih_surface; 0: all
    girih_sort sort;
    int few_buffers; // not 0: use 4 storage buffers a stage even where there are more
    VkPipelineCache pipeline_cache; // may be VK_NULL_HANDLE; must outlive the context
    const VkAllocationCallbacks *allocation_callbacks; // may be NULL; must outlive the context
} girih_context_desc;

// Pipelines for one device and one catalogue. Any number of threads may use it at once: all that
// ever changes are pipelines made, without a lock, when a plan first needs them.
typedef struct girih_context girih_context;

// On success *context is the caller's; record girih_cmd_upload_context once before the first use.
// Thread-safe.
GIRIH_API girih_result girih_context_create(const girih_context_desc *desc, girih_context **context,
                                            girih_error *error);

// Records the upload of the catalogue: ends with transfer writes made available and visible to
// compute, vertex input, index and transfer reads.
GIRIH_API void girih_cmd_upload_context(const girih_context *context, VkCommandBuffer commands);

// Takes NULL. Its scenes and plans must be destroyed before.
GIRIH_API void girih_context_destroy(girih_context *context);

// The descriptor set layout of girih.glsl in a host's vertex shader (instanced mode): one storage
// buffer with the vertices' attributes, binding 0.
GIRIH_API VkDescriptorSetLayout girih_context_draw_set_layout(const girih_context *context);

#ifdef __cplusplus
}
#endif
#endif
