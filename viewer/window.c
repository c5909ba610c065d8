#include "window.h"

#include <stdlib.h>

#include "error.h"

// --- GLFW ---

static const char *glfw_reason(void) {
    const char *reason = NULL;
    glfwGetError(&reason);
    return reason != NULL ? reason : "no reason is given";
}

girih_result girih_window_open(girih_window *window, const char *title, uint32_t width,
                               uint32_t height, girih_error *error) {
    *window = (girih_window){0};
    if (!glfwInit()) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "no display to open a window on (%.200s); girih render draws into a file",
                          glfw_reason());
    }
    if (!glfwVulkanSupported()) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "no Vulkan driver that shows windows here; install one (on Debian, "
                          "mesa-vulkan-drivers), or draw into a file with girih render");
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window->handle = glfwCreateWindow((int)width, (int)height, title, NULL, NULL);
    if (window->handle == NULL) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "no window could be opened (%.200s); girih render draws into a file",
                          glfw_reason());
    }
    return GIRIH_OK;
}

void girih_window_close(girih_window *window) {
    if (window->handle != NULL) {
        glfwDestroyWindow(window->handle);
        window->handle = NULL;
    }
    glfwTerminate();
}

static bool shows(VkInstance instance, VkPhysicalDevice physical, uint32_t queue_family) {
    return glfwGetPhysicalDevicePresentationSupport(instance, physical, queue_family) == GLFW_TRUE;
}

void girih_window_wishes(girih_device_wishes *wishes) {
    wishes->window_extensions = glfwGetRequiredInstanceExtensions(&wishes->window_extension_count);
    wishes->shows = shows;
}

bool girih_window_is_visible(const girih_window *window) {
    int width, height;
    glfwGetFramebufferSize(window->handle, &width, &height);
    return width > 0 && height > 0 && !glfwGetWindowAttrib(window->handle, GLFW_ICONIFIED) &&
           glfwGetWindowAttrib(window->handle, GLFW_VISIBLE);
}

// --- Swapchain ---

// sRGB of 8 bits, as the picture is, so that a blit between them keeps colours.
static girih_result choose_format(const girih_window *window, VkSurfaceFormatKHR *format,
                                  girih_error *error) {
    VkSurfaceFormatKHR formats[64];
    uint32_t count = 64;
    VkResult result = vkGetPhysicalDeviceSurfaceFormatsKHR(window->device->physical,
                                                           window->surface, &count, formats);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE) {
        return girih_vulkan_failure(error, "vkGetPhysicalDeviceSurfaceFormatsKHR", result);
    }
    for (uint32_t n = 0; n < count; n++) {
        if (formats[n].format == VK_FORMAT_B8G8R8A8_SRGB ||
            formats[n].format == VK_FORMAT_R8G8B8A8_SRGB) {
            *format = formats[n];
            return GIRIH_OK;
        }
    }
    return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                      "%s: windows here take no sRGB colours of 8 bits; girih render draws into a "
                      "file",
                      window->device->properties.deviceName);
}

static void free_images(girih_window *window) {
    for (uint32_t n = 0; n < window->image_count; n++) {
        vkDestroySemaphore(window->device->device, window->images[n].drawn, NULL);
    }
    free(window->images);
    window->images = NULL;
    window->image_count = 0;
}

static girih_result get_images(girih_window *window, girih_error *error) {
    VkDevice device = window->device->device;
    uint32_t count = 0;
    VkResult result = vkGetSwapchainImagesKHR(device, window->swapchain, &count, NULL);
    VkImage *images = calloc((size_t)count + 1, sizeof *images);
    window->images = calloc((size_t)count + 1, sizeof *window->images);
    if (images == NULL || window->images == NULL) {
        free(images);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    if (result == VK_SUCCESS) {
        result = vkGetSwapchainImagesKHR(device, window->swapchain, &count, images);
    }
    VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    for (; window->image_count < count && result == VK_SUCCESS; window->image_count++) {
        girih_window_image *image = &window->images[window->image_count];
        image->image = images[window->image_count];
        result = vkCreateSemaphore(device, &info, NULL, &image->drawn);
    }
    free(images);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkGetSwapchainImagesKHR", result);
}

static uint32_t clamp(uint32_t value, uint32_t least, uint32_t greatest) {
    return value < least ? least : value > greatest ? greatest : value;
}

static girih_result create_swapchain(girih_window *window, girih_error *error) {
    girih_device *device = window->device;
    VkSurfaceCapabilitiesKHR limits;
    VkResult result =
        vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device->physical, window->surface, &limits);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR", result);
    }
    VkSurfaceFormatKHR format = {VK_FORMAT_UNDEFINED, VK_COLOR_SPACE_SRGB_NONLINEAR_KHR};
    girih_result chosen = choose_format(window, &format, error);
    if (chosen != GIRIH_OK) {
        return chosen;
    }
    if ((limits.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "%s: pictures cannot be copied into windows here; girih render draws "
                          "into a file",
                          device->properties.deviceName);
    }
    VkExtent2D extent = limits.currentExtent;
    if (extent.width == UINT32_MAX) { // the swapchain says how large the window's picture is
        int width, height;
        glfwGetFramebufferSize(window->handle, &width, &height);
        extent.width =
            clamp((uint32_t)width, limits.minImageExtent.width, limits.maxImageExtent.width);
        extent.height =
            clamp((uint32_t)height, limits.minImageExtent.height, limits.maxImageExtent.height);
    }
    VkSwapchainKHR old = window->swapchain;
    window->swapchain = VK_NULL_HANDLE;
    window->width = extent.width;
    window->height = extent.height;
    if (extent.width > 0 && extent.height > 0) {
        uint32_t most = limits.maxImageCount != 0 ? limits.maxImageCount : UINT32_MAX;
        VkSwapchainCreateInfoKHR info = {
            .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
            .surface = window->surface,
            .minImageCount = clamp(limits.minImageCount + 1, limits.minImageCount, most),
            .imageFormat = format.format,
            .imageColorSpace = format.colorSpace,
            .imageExtent = extent,
            .imageArrayLayers = 1,
            .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
            .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
            .preTransform = limits.currentTransform,
            .compositeAlpha =
                (limits.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                    ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                    : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
            .presentMode = VK_PRESENT_MODE_FIFO_KHR,
            .clipped = VK_TRUE,
            .oldSwapchain = old,
        };
        result = vkCreateSwapchainKHR(device->device, &info, NULL, &window->swapchain);
    }
    vkDestroySwapchainKHR(device->device, old, NULL);
    free_images(window);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateSwapchainKHR", result);
    }
    return window->swapchain != VK_NULL_HANDLE ? get_images(window, error) : GIRIH_OK;
}

girih_result girih_window_fit(girih_window *window, bool *is_new, girih_error *error) {
    int width, height;
    glfwGetFramebufferSize(window->handle, &width, &height);
    *is_new = window->swapchain == VK_NULL_HANDLE || window->is_stale ||
              window->width != (uint32_t)width || window->height != (uint32_t)height;
    if (!*is_new) {
        return GIRIH_OK;
    }
    VkResult result = vkDeviceWaitIdle(window->device->device);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkDeviceWaitIdle", result);
    }
    girih_result created = create_swapchain(window, error);
    window->is_stale = created != GIRIH_OK || window->swapchain == VK_NULL_HANDLE;
    return created;
}

// --- Device ---

static girih_result create_frame(girih_window *window, girih_window_frame *frame,
                                 girih_error *error) {
    const girih_device *device = window->device;
    VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = device->pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    VkResult result = vkAllocateCommandBuffers(device->device, &commands, &frame->commands);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkAllocateCommandBuffers", result);
    }
    VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    result = vkCreateSemaphore(device->device, &semaphore, NULL, &frame->acquired);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateSemaphore", result);
    }
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                               .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    result = vkCreateFence(device->device, &fence, NULL, &frame->finished);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateFence", result);
    }
    return girih_device_queries(device, GIRIH_WINDOW_QUERIES, &frame->queries, error);
}

girih_result girih_window_attach(girih_window *window, girih_device *device, girih_error *error) {
    window->device = device;
    VkResult result =
        glfwCreateWindowSurface(device->instance, window->handle, NULL, &window->surface);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "glfwCreateWindowSurface", result);
    }
    VkBool32 is_shown = VK_FALSE;
    result = vkGetPhysicalDeviceSurfaceSupportKHR(device->physical, device->queue_family,
                                                  window->surface, &is_shown);
    if (result != VK_SUCCESS || !is_shown) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "%s does not show pictures in this window; try another --device",
                          device->properties.deviceName);
    }
    girih_result made = GIRIH_OK;
    for (uint32_t n = 0; n < GIRIH_WINDOW_FRAMES && made == GIRIH_OK; n++) {
        made = create_frame(window, &window->frames[n], error);
    }
    return made;
}

void girih_window_detach(girih_window *window) {
    if (window->device == NULL) {
        return;
    }
    VkDevice device = window->device->device;
    for (uint32_t n = 0; n < GIRIH_WINDOW_FRAMES; n++) {
        girih_window_frame *frame = &window->frames[n];
        vkDestroyQueryPool(device, frame->queries, NULL);
        vkDestroyFence(device, frame->finished, NULL);
        vkDestroySemaphore(device, frame->acquired, NULL);
        *frame = (girih_window_frame){0}; // the device's pool frees the commands
    }
    vkDestroySwapchainKHR(device, window->swapchain, NULL);
    free_images(window);
    vkDestroySurfaceKHR(window->device->instance, window->surface, NULL);
    window->swapchain = VK_NULL_HANDLE;
    window->surface = VK_NULL_HANDLE;
    window->device = NULL;
}

// --- Frames ---

girih_result girih_window_wait(girih_window *window, girih_error *error) {
    VkResult result = vkWaitForFences(window->device->device, 1,
                                      &window->frames[window->frame].finished, VK_TRUE, UINT64_MAX);
    return result == VK_SUCCESS ? GIRIH_OK : girih_vulkan_failure(error, "vkWaitForFences", result);
}

girih_result girih_window_begin(girih_window *window, VkCommandBuffer *commands,
                                girih_error *error) {
    const girih_window_frame *frame = &window->frames[window->frame];
    *commands = VK_NULL_HANDLE;
    VkResult result = vkAcquireNextImageKHR(window->device->device, window->swapchain, UINT64_MAX,
                                            frame->acquired, VK_NULL_HANDLE, &window->image);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
        window->is_stale = true;
        return GIRIH_OK;
    }
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) {
        return girih_vulkan_failure(error, "vkAcquireNextImageKHR", result);
    }
    VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    result = vkBeginCommandBuffer(frame->commands, &info);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkBeginCommandBuffer", result);
    }
    *commands = frame->commands;
    return GIRIH_OK;
}

static void record_copy(const girih_window *window, VkCommandBuffer commands, VkImage picture) {
    VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = window->images[window->image].image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         0, 0, NULL, 0, NULL, 1, &barrier);
    VkOffset3D end = {(int32_t)window->width, (int32_t)window->height, 1};
    VkImageBlit blit = {
        .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .srcOffsets = {{0, 0, 0}, end},
        .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .dstOffsets = {{0, 0, 0}, end},
    };
    vkCmdBlitImage(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, barrier.image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_NEAREST);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = 0;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

girih_result girih_window_end(girih_window *window, VkImage picture, girih_error *error) {
    const girih_device *device = window->device;
    const girih_window_frame *frame = &window->frames[window->frame];
    const girih_window_image *image = &window->images[window->image];
    record_copy(window, frame->commands, picture);
    VkResult result = vkEndCommandBuffer(frame->commands);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkEndCommandBuffer", result);
    }
    result = vkResetFences(device->device, 1, &frame->finished);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkResetFences", result);
    }
    VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .waitSemaphoreCount = 1,
        .pWaitSemaphores = &frame->acquired,
        .pWaitDstStageMask = &stage,
        .commandBufferCount = 1,
        .pCommandBuffers = &frame->commands,
        .signalSemaphoreCount = 1,
        .pSignalSemaphores = &image->drawn,
    };
    result = vkQueueSubmit(device->queue, 1, &submit, frame->finished);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkQueueSubmit", result);
    }
    window->frame = (window->frame + 1) % GIRIH_WINDOW_FRAMES;
    VkPresentInfoKHR present = {
        .sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
        .waitSemaphoreCount = 1,
        .pWaitSemaphores = &image->drawn,
        .swapchainCount = 1,
        .pSwapchains = &window->swapchain,
        .pImageIndices = &window->image,
    };
    result = vkQueuePresentKHR(device->queue, &present);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) {
        window->is_stale = true;
        return GIRIH_OK;
    }
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkQueuePresentKHR", result);
}
