// Ranges of buffers: the host's, or girih's own with memory of their own.
#include "context.h"

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

girih_buffer_need girih_need(const char *name, VkDeviceSize size, VkBufferUsageFlags usage,
                             bool mapped) {
    return (girih_buffer_need){
        .name = name, .size = size, .alignment = GIRIH_ALIGNMENT, .usage = usage, .mapped = mapped};
}

// The host's range as it is: its buffer, its memory and its size are the host's to answer for.
static girih_result take_range(const girih_buffer_need *need, const girih_buffer_range *given,
                               girih_buffer *buffer, girih_error *error) {
    if (given->offset % need->alignment != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "%s: the range given begins at byte %llu of its buffer; it must begin at "
                          "a multiple of %llu",
                          need->name, (unsigned long long)given->offset,
                          (unsigned long long)need->alignment);
    }
    if (need->mapped && !given->mapped) {
        return girih_fail(
            error, GIRIH_ERROR_INVALID_ARGUMENT,
            "%s: the range given is not mapped; use host-visible, coherent memory and "
            "pass where it is mapped",
            need->name);
    }
    *buffer = (girih_buffer){.buffer = given->buffer,
                             .offset = given->offset,
                             .size = need->size,
                             .mapped = given->mapped};
    return GIRIH_OK;
}

// The memory type for a buffer, or UINT32_MAX. Cached memory is read faster by the host.
static uint32_t choose_memory_type(const girih_context *context, uint32_t types, bool mapped) {
    const VkMemoryPropertyFlags coherent =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const uint32_t best = find_memory_type(context, types,
                                           mapped ? coherent | VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                                  : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    return best != UINT32_MAX ? best : find_memory_type(context, types, mapped ? coherent : 0);
}

// Memory for a buffer that has none, bound to it and, where the need says so, mapped. On failure
// buffer->memory may be there and is the caller's to free.
static girih_result allocate_memory(const girih_context *context, const girih_buffer_need *need,
                                    girih_buffer *buffer, girih_error *error) {
    const girih_functions *vk = &context->vk;
    VkMemoryRequirements requirements;
    vk->GetBufferMemoryRequirements(context->device, buffer->buffer, &requirements);
    const uint32_t type =
        choose_memory_type(context, requirements.memoryTypeBits, need->mapped != 0);
    if (type == UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "%s: the device has no fitting memory type", need->name);
    }
    const VkMemoryAllocateFlagsInfo flags = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                             .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    const bool has_address = need->usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    const VkMemoryAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                             .pNext = has_address ? &flags : NULL,
                                             .allocationSize = requirements.size,
                                             .memoryTypeIndex = type};
    VkResult result =
        vk->AllocateMemory(context->device, &allocation, context->callbacks, &buffer->memory);
    if (result != VK_SUCCESS) {
        buffer->memory = VK_NULL_HANDLE; // a failed call may have written anything
        return girih_vulkan_failed(error, "vkAllocateMemory", need->name, result);
    }
    result = vk->BindBufferMemory(context->device, buffer->buffer, buffer->memory, 0);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "vkBindBufferMemory", need->name, result);
    }
    if (need->mapped) {
        result =
            vk->MapMemory(context->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped);
        if (result != VK_SUCCESS) {
            return girih_vulkan_failed(error, "vkMapMemory", need->name, result);
        }
    }
    return GIRIH_OK;
}

girih_result girih_buffer_create(const girih_context *context, const girih_buffer_need *need,
                                 const girih_buffer_range *given, girih_buffer *buffer,
                                 girih_error *error) {
    *buffer = (girih_buffer){0};
    if (need->size == 0) {
        return GIRIH_OK;
    }
    if (given && given->buffer) {
        return take_range(need, given, buffer, error);
    }
    if (need->size > context->max_allocation) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "%s: %llu bytes are more than the device allocates at once (%llu); refine less at once",
            need->name, (unsigned long long)need->size,
            (unsigned long long)context->max_allocation);
    }
    girih_buffer made = {.size = need->size};
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = need->size,
                                     .usage = need->usage,
                                     .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
    const VkResult created =
        context->vk.CreateBuffer(context->device, &info, context->callbacks, &made.buffer);
    if (created != VK_SUCCESS) {
        return girih_vulkan_failed(error, "vkCreateBuffer", need->name, created);
    }
    const girih_result result = allocate_memory(context, need, &made, error);
    if (result != GIRIH_OK) {
        context->vk.DestroyBuffer(context->device, made.buffer, context->callbacks);
        context->vk.FreeMemory(context->device, made.memory, context->callbacks);
        return result;
    }
    *buffer = made;
    return GIRIH_OK;
}

void girih_buffer_destroy(const girih_context *context, girih_buffer *buffer) {
    if (buffer->memory) { // freeing mapped memory unmaps it
        context->vk.DestroyBuffer(context->device, buffer->buffer, context->callbacks);
        context->vk.FreeMemory(context->device, buffer->memory, context->callbacks);
    }
    *buffer = (girih_buffer){0};
}

girih_buffer_range girih_buffer_as_range(const girih_buffer *buffer) {
    return (girih_buffer_range){
        .buffer = buffer->buffer, .offset = buffer->offset, .mapped = buffer->mapped};
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
