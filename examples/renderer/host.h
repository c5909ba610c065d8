// What any Vulkan program has: instance, device, memory, images, pipelines.
#ifndef HOST_H
#define HOST_H

#include <stdatomic.h>

#include <girih/girih.h>
#include <vulkan/vulkan.h>

// Leaves the function where a call of Vulkan's, girih's or the host's fails; all return 0 on
// success.
#define TRY(CALL)                                                                                  \
    do {                                                                                           \
        if (host_failed((int)(CALL), #CALL)) {                                                     \
            return 1;                                                                              \
        }                                                                                          \
    } while (0)

typedef struct host {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    atomic_uint messages; // of the validation layer, in whatever thread
    VkPhysicalDevice physical_device;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceFeatures features; // enabled
    VkDevice device;
    uint32_t family;
    VkQueue queue;
} host;

typedef struct host_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} host_buffer;

typedef struct host_image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
} host_image;

extern _Thread_local girih_error host_error; // of the thread's last call of girih's that failed

// Says what failed, if it did.
int host_failed(int result, const char *call);

// Instance, device and queue. Validation and synchronization validation are on where the layer is
// installed.
int host_create(host *h);
void host_destroy(host *h);

// Mapped: host-visible and coherent memory; else device-local.
int host_create_buffer(const host *h, VkDeviceSize size, VkBufferUsageFlags usage, int mapped,
                       host_buffer *buffer);
void host_destroy_buffer(const host *h, host_buffer *buffer);

int host_create_image(const host *h, VkFormat format, uint32_t width, uint32_t height,
                      VkImageUsageFlags usage, VkImageAspectFlags aspect, host_image *image);
void host_destroy_image(const host *h, host_image *image);

// SPIR-V of a stage, as glslangValidator --vn writes it.
typedef struct host_code {
    const uint32_t *words;
    size_t bytes;
} host_code;

// Triangles with depth test into two colour attachments; viewport and scissor cover the picture.
int host_create_pipeline(const host *h, host_code vertex, host_code fragment,
                         const VkPipelineVertexInputStateCreateInfo *input, VkCullModeFlags cull,
                         VkExtent2D extent, VkRenderPass pass, VkPipelineLayout layout,
                         VkPipeline *pipeline);

#endif
