#include <string.h>

#include "device.h"
#include "error.h"

// Copies between the host and memory that it cannot see pass through a buffer of this size.
static const VkDeviceSize piece_size = (VkDeviceSize)64 << 20;

static uint32_t find_memory_type(const girih_device *device, uint32_t bits,
                                 VkMemoryPropertyFlags flags) {
    for (uint32_t n = 0; n < device->memory.memoryTypeCount; n++) {
        if ((bits >> n & 1u) != 0 &&
            (device->memory.memoryTypes[n].propertyFlags & flags) == flags) {
            return n;
        }
    }
    return UINT32_MAX;
}

static girih_result allocate(const girih_device *device, const VkMemoryRequirements *requirements,
                             girih_memory_place place, VkDeviceMemory *memory, girih_error *error) {
    VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryPropertyFlags best = place == GIRIH_MEMORY_DEVICE ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
                                 : place == GIRIH_MEMORY_UPLOAD
                                     ? mapped
                                     : mapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    uint32_t type = find_memory_type(device, requirements->memoryTypeBits, best);
    if (type == UINT32_MAX) {
        type = find_memory_type(device, requirements->memoryTypeBits,
                                place == GIRIH_MEMORY_DEVICE ? 0 : mapped);
    }
    if (type == UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED, "the device has no fitting memory");
    }
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = requirements->size,
        .memoryTypeIndex = type,
    };
    VkResult result = vkAllocateMemory(device->device, &info, NULL, memory);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkAllocateMemory", result);
}

girih_result girih_device_buffer_create(const girih_device *device, girih_device_buffer *buffer,
                                        VkDeviceSize size, VkBufferUsageFlags usage,
                                        girih_memory_place place, girih_error *error) {
    *buffer = (girih_device_buffer){.size = size != 0 ? size : 4};
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = buffer->size,
        .usage = usage,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
    };
    VkResult result = vkCreateBuffer(device->device, &info, NULL, &buffer->buffer);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateBuffer", result);
    }
    VkMemoryRequirements requirements;
    vkGetBufferMemoryRequirements(device->device, buffer->buffer, &requirements);
    girih_result allocated = allocate(device, &requirements, place, &buffer->memory, error);
    if (allocated == GIRIH_OK) {
        result = vkBindBufferMemory(device->device, buffer->buffer, buffer->memory, 0);
        if (result == VK_SUCCESS && place != GIRIH_MEMORY_DEVICE) {
            result =
                vkMapMemory(device->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped);
        }
        if (result != VK_SUCCESS) {
            allocated = girih_vulkan_failure(error, "vkBindBufferMemory or vkMapMemory", result);
        }
    }
    if (allocated != GIRIH_OK) {
        girih_device_buffer_destroy(device, buffer);
    }
    return allocated;
}

void girih_device_buffer_destroy(const girih_device *device, girih_device_buffer *buffer) {
    vkDestroyBuffer(device->device, buffer->buffer, NULL);
    vkFreeMemory(device->device, buffer->memory, NULL);
    *buffer = (girih_device_buffer){0};
}

girih_result girih_device_image_create(const girih_device *device, girih_device_image *image,
                                       const VkImageCreateInfo *info, VkImageAspectFlags aspect,
                                       girih_error *error) {
    *image = (girih_device_image){0};
    VkResult result = vkCreateImage(device->device, info, NULL, &image->image);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateImage", result);
    }
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device->device, image->image, &requirements);
    girih_result allocated =
        allocate(device, &requirements, GIRIH_MEMORY_DEVICE, &image->memory, error);
    if (allocated == GIRIH_OK) {
        result = vkBindImageMemory(device->device, image->image, image->memory, 0);
        VkImageViewCreateInfo view = {
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
            .image = image->image,
            .viewType = VK_IMAGE_VIEW_TYPE_2D,
            .format = info->format,
            .subresourceRange = {aspect, 0, info->mipLevels, 0, 1},
        };
        if (result == VK_SUCCESS) {
            result = vkCreateImageView(device->device, &view, NULL, &image->view);
        }
        if (result != VK_SUCCESS) {
            allocated =
                girih_vulkan_failure(error, "vkBindImageMemory or vkCreateImageView", result);
        }
    }
    if (allocated != GIRIH_OK) {
        girih_device_image_destroy(device, image);
    }
    return allocated;
}

void girih_device_image_destroy(const girih_device *device, girih_device_image *image) {
    vkDestroyImageView(device->device, image->view, NULL);
    vkDestroyImage(device->device, image->image, NULL);
    vkFreeMemory(device->device, image->memory, NULL);
    *image = (girih_device_image){0};
}

// Moves a piece at a time; `to_device` tells which way.
static girih_result transfer(girih_device *device, const girih_buffer_range *range, char *bytes,
                             VkDeviceSize size, bool to_device, girih_error *error) {
    girih_device_buffer staging;
    girih_result result = girih_device_buffer_create(
        device, &staging, size < piece_size ? size : piece_size,
        to_device ? VK_BUFFER_USAGE_TRANSFER_SRC_BIT : VK_BUFFER_USAGE_TRANSFER_DST_BIT,
        to_device ? GIRIH_MEMORY_UPLOAD : GIRIH_MEMORY_READBACK, error);
    for (VkDeviceSize at = 0; at < size && result == GIRIH_OK; at += piece_size) {
        VkDeviceSize count = size - at < piece_size ? size - at : piece_size;
        if (to_device) {
            memcpy(staging.mapped, bytes + at, (size_t)count);
        }
        result = girih_device_begin(device, error);
        if (result != GIRIH_OK) {
            break;
        }
        girih_device_full_barrier(device->commands);
        const VkDeviceSize place = range->offset + at;
        VkBufferCopy region = {to_device ? 0 : place, to_device ? place : 0, count};
        vkCmdCopyBuffer(device->commands, to_device ? staging.buffer : range->buffer,
                        to_device ? range->buffer : staging.buffer, 1, &region);
        girih_device_full_barrier(device->commands);
        result = girih_device_finish(device, error);
        if (result == GIRIH_OK && !to_device) {
            memcpy(bytes + at, staging.mapped, (size_t)count);
        }
    }
    girih_device_buffer_destroy(device, &staging);
    return result;
}

girih_result girih_device_write(girih_device *device, VkBuffer buffer, const void *bytes,
                                VkDeviceSize size, girih_error *error) {
    // The bytes are only read.
    char *source;
    memcpy(&source, &bytes, sizeof source);
    return transfer(device, &(girih_buffer_range){.buffer = buffer}, source, size, true, error);
}

girih_result girih_device_read(girih_device *device, const girih_buffer_range *range,
                               VkDeviceSize size, void *bytes, girih_error *error) {
    return transfer(device, range, bytes, size, false, error);
}
