// The program's Vulkan device: one queue, and simple ways to hand it work and memory.
#ifndef GIRIH_VIEWER_DEVICE_H
#define GIRIH_VIEWER_DEVICE_H

#include <stdbool.h>

#include <vulkan/vulkan.h>

#include "girih/context.h"
#include "options.h"

typedef struct girih_device {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkPhysicalDeviceFeatures features; // enabled
    VkDevice device;
    uint32_t queue_family;
    VkQueue queue;
    bool has_timestamps;
    bool has_transform_feedback; // enabled
    VkCommandPool pool;
    VkCommandBuffer commands;
    VkFence fence;
    uint32_t validation_messages;
} girih_device;

// What a program likes its device to have, beside what girih lists.
typedef struct girih_device_wishes {
    bool graphics;                     // a queue that draws; the device must have one
    bool transform_feedback;           // VK_EXT_transform_feedback, where the device has it
    VkPhysicalDeviceFeatures features; // enabled where the device has them
    // For a window: extensions that the instance must have, and whether a queue family can show
    // pictures in one, which also takes VK_KHR_swapchain. NULL: there is no window.
    const char *const *window_extensions;
    uint32_t window_extension_count;
    bool (*shows)(VkInstance instance, VkPhysicalDevice physical, uint32_t queue_family);
} girih_device_wishes;

// Opens the device that the options name, else the likely fastest one, with a queue that runs
// girih's commands. *device must not move while it is open.
girih_result girih_device_open(girih_device *device, const girih_device_options *options,
                               const girih_device_wishes *wishes, girih_error *error);
void girih_device_close(girih_device *device);

// A context for the device.
girih_result girih_device_context(const girih_device *device, const girih_catalogue *catalogue,
                                  girih_context **context, girih_error *error);

// A failure of a Vulkan call, with what to do about it.
girih_result girih_vulkan_failure(girih_error *error, const char *call, VkResult result);

// Begins the device's one command buffer; submits it and waits for it.
girih_result girih_device_begin(girih_device *device, girih_error *error);
girih_result girih_device_finish(girih_device *device, girih_error *error);

// --- Memory ---

typedef struct girih_device_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceSize size;
    void *mapped; // where it is visible to the host
} girih_device_buffer;

typedef struct girih_device_image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
} girih_device_image;

typedef enum girih_memory_place {
    GIRIH_MEMORY_DEVICE,
    GIRIH_MEMORY_UPLOAD,   // mapped and coherent
    GIRIH_MEMORY_READBACK, // mapped and coherent, cached where that can be had
} girih_memory_place;

girih_result girih_device_buffer_create(const girih_device *device, girih_device_buffer *buffer,
                                        VkDeviceSize size, VkBufferUsageFlags usage,
                                        girih_memory_place place, girih_error *error);
void girih_device_buffer_destroy(const girih_device *device, girih_device_buffer *buffer);

// An image of one layer with a view of all of it.
girih_result girih_device_image_create(const girih_device *device, girih_device_image *image,
                                       const VkImageCreateInfo *info, VkImageAspectFlags aspect,
                                       girih_error *error);
void girih_device_image_destroy(const girih_device *device, girih_device_image *image);

// Copies bytes into a buffer, or out of a range, that the host cannot see, in pieces. The buffer
// needs the usage TRANSFER_DST, or TRANSFER_SRC.
girih_result girih_device_write(girih_device *device, VkBuffer buffer, const void *bytes,
                                VkDeviceSize size, girih_error *error);
girih_result girih_device_read(girih_device *device, const girih_buffer_range *range,
                               VkDeviceSize size, void *bytes, girih_error *error);

// Orders everything before against everything after it.
void girih_device_full_barrier(VkCommandBuffer commands);

// --- girih's timestamps ---

// A pool of `count` timestamps; VK_NULL_HANDLE where the queue has none.
girih_result girih_device_queries(const girih_device *device, uint32_t count, VkQueryPool *pool,
                                  girih_error *error);

// Reads `count` of them as milliseconds from the first; false where they are not there.
bool girih_device_read_queries(const girih_device *device, VkQueryPool pool, uint32_t first,
                               uint32_t count, double *milliseconds);

#endif
