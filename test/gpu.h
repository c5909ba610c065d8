// A Vulkan host for tests and benchmarks: instance, device, one queue, and buffers to read back.
// With validation on, every message of the Khronos layer (synchronization validation included) is
// counted.
#ifndef GIRIH_TEST_GPU_H
#define GIRIH_TEST_GPU_H

#include <stdbool.h>
#include <vulkan/vulkan.h>

#include "girih/girih.h"

typedef struct gpu {
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkPhysicalDeviceFeatures features; // as enabled
    bool transform_feedback;           // VK_EXT_transform_feedback is enabled
    VkDevice device;
    uint32_t queue_family;
    VkQueue queue;
    VkCommandPool pool;
    VkFence fence;
    VkDebugUtilsMessengerEXT messenger;
    unsigned messages;    // validation messages so far, each printed
    bool share_pipelines; // gpu_context's contexts do (pipeline_store.h); set after gpu_open
} gpu;

typedef struct gpu_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceSize size;
    void *mapped;
} gpu_buffer;

// All of these print what failed and exit(1): a test that cannot run is a failure, never a pass.

// wanted: features enabled where the device has them; NULL: none.
void gpu_open(gpu *host, const VkPhysicalDeviceFeatures *wanted, bool validation);
// Closes, and returns the number of validation messages and of shared pipelines that are left.
unsigned gpu_close(gpu *host);
void gpu_check(VkResult result, const char *what);
void gpu_girih(girih_result result, const girih_error *error);

// A command buffer that has begun.
VkCommandBuffer gpu_begin(gpu *host);
// Ends, submits and waits; the command buffer stays for gpu_submit, or is freed by gpu_run.
void gpu_run(gpu *host, VkCommandBuffer commands);
void gpu_end(VkCommandBuffer commands);
void gpu_submit(gpu *host, VkCommandBuffer commands);

// mapped: host-visible and coherent, else device-local.
gpu_buffer gpu_create_buffer(gpu *host, VkDeviceSize size, VkBufferUsageFlags usage, bool mapped);
void gpu_destroy_buffer(gpu *host, gpu_buffer *buffer);
// Copies bytes of a buffer with transfer usage to memory of the caller's (free()).
void *gpu_read(gpu *host, VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size);

VkShaderModule gpu_shader(gpu *host, const uint32_t *words, size_t bytes);

// A context with its catalogue uploaded.
girih_context *gpu_context(gpu *host, const girih_context_desc *options);
girih_scene *gpu_scene(gpu *host, const girih_context *context, const girih_mesh *const *meshes,
                       uint32_t mesh_count);

#endif
