#include "context.h"

#include <string.h>

#include "error.h"

#define GIRIH_ALIGNMENT 256u // no device asks storage, uniform or index offsets for more

girih_result girih_vulkan_failed(girih_error *error, const char *call, const char *what,
                                 VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "%s: out of memory (%s); refine less at once", what, call);
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
        return girih_fail(error, GIRIH_ERROR_OUT_OF_DEVICE_MEMORY,
                          "%s: out of device memory (%s); refine less at once", what, call);
    case VK_ERROR_DEVICE_LOST:
        return girih_fail(error, GIRIH_ERROR_DEVICE, "%s: the device was lost (%s); create it anew",
                          what, call);
    default:
        return girih_fail(error, GIRIH_ERROR_DEVICE, "%s: %s failed with VkResult %d", what, call,
                          (int)result);
    }
}

// The first memory type among `types` with all flags, or UINT32_MAX.
static uint32_t find_memory_type(const girih_context *context, uint32_t types,
                                 VkMemoryPropertyFlags flags) {
    for (uint32_t n = 0; n < context->memory.memoryTypeCount; ++n) {
        if ((types & (1u << n)) &&
            (context->memory.memoryTypes[n].propertyFlags & flags) == flags) {
            return n;
        }
    }
    return UINT32_MAX;
}

girih_result girih_buffer_create(const girih_context *context, VkDeviceSize size,
                                 VkBufferUsageFlags usage, bool host, const char *what,
                                 girih_buffer *buffer, girih_error *error) {
    const girih_functions *vk = &context->vk;
    *buffer = (girih_buffer){.size = size};
    if (size > context->max_allocation) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "%s: %llu bytes are more than the device allocates at once (%llu); refine less at once",
            what, (unsigned long long)size, (unsigned long long)context->max_allocation);
    }
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = size,
                                     .usage = usage,
                                     .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
    VkResult result = vk->CreateBuffer(context->device, &info, context->callbacks, &buffer->buffer);
    if (result != VK_SUCCESS) {
        buffer->buffer = VK_NULL_HANDLE;
        return girih_vulkan_failed(error, "vkCreateBuffer", what, result);
    }
    VkMemoryRequirements requirements;
    vk->GetBufferMemoryRequirements(context->device, buffer->buffer, &requirements);
    const VkMemoryPropertyFlags coherent =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = find_memory_type(context, requirements.memoryTypeBits,
                                     host ? coherent | VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                          : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    if (type == UINT32_MAX) {
        type = find_memory_type(context, requirements.memoryTypeBits, host ? coherent : 0);
    }
    if (type == UINT32_MAX) {
        girih_buffer_destroy(context, buffer);
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "%s: the device has no fitting memory type", what);
    }
    const VkMemoryAllocateFlagsInfo flags = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const bool has_address = usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    const VkMemoryAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                             .pNext = has_address ? &flags : NULL,
                                             .allocationSize = requirements.size,
                                             .memoryTypeIndex = type};
    result = vk->AllocateMemory(context->device, &allocation, context->callbacks, &buffer->memory);
    if (result != VK_SUCCESS) {
        buffer->memory = VK_NULL_HANDLE;
        girih_buffer_destroy(context, buffer);
        return girih_vulkan_failed(error, "vkAllocateMemory", what, result);
    }
    result = vk->BindBufferMemory(context->device, buffer->buffer, buffer->memory, 0);
    if (result == VK_SUCCESS && host) {
        result =
            vk->MapMemory(context->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped);
    }
    if (result != VK_SUCCESS) {
        girih_buffer_destroy(context, buffer);
        return girih_vulkan_failed(error, "vkBindBufferMemory or vkMapMemory", what, result);
    }
    return GIRIH_OK;
}

void girih_buffer_destroy(const girih_context *context, girih_buffer *buffer) {
    context->vk.DestroyBuffer(context->device, buffer->buffer, context->callbacks);
    context->vk.FreeMemory(context->device, buffer->memory, context->callbacks);
    *buffer = (girih_buffer){0};
}

void girih_layout_arrays(const girih_arrays *arrays, uint32_t first, uint32_t end,
                         VkDeviceSize offset[GIRIH_BIND_COUNT], VkDeviceSize *size) {
    for (uint32_t n = first; n < end; ++n) {
        *size = (*size + GIRIH_ALIGNMENT - 1) / GIRIH_ALIGNMENT * GIRIH_ALIGNMENT;
        offset[n] = *size;
        *size += arrays->count[n] * 4;
    }
}

girih_result girih_check_ranges(const girih_context *context, const girih_arrays *arrays,
                                uint32_t first, uint32_t end, VkDeviceSize size, const char *what,
                                girih_error *error) {
    const VkDeviceSize limit = context->limits.maxStorageBufferRange;
    VkDeviceSize largest = context->few_buffers ? size : 0;
    for (uint32_t n = first; n < end; ++n) {
        const VkDeviceSize bytes = arrays->count[n] * 4;
        largest = bytes > largest ? bytes : largest;
    }
    if (largest > limit) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "%s: %llu bytes in one array are more than the device's storage buffers "
                          "show (%llu); split it",
                          what, (unsigned long long)largest, (unsigned long long)limit);
    }
    return GIRIH_OK;
}
