#include "attachments.h"

#include "error.h"

static const VkFormat color_format = VK_FORMAT_R8G8B8A8_SRGB;

static bool is_depth_attachment(const girih_device *device, VkFormat format) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device->physical, format, &properties);
    return (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
}

// Attachments: depth, resolved colour and, with several samples, the colour that is resolved.
girih_result girih_attachments_create(girih_attachments *attachments, const girih_device *device,
                                      uint32_t wanted, girih_error *error) {
    *attachments = (girih_attachments){0};
    const VkPhysicalDeviceLimits *limits = &device->properties.limits;
    VkSampleCountFlags samples =
        limits->framebufferColorSampleCounts & limits->framebufferDepthSampleCounts;
    // VkSampleCountFlagBits are the counts themselves.
    if (wanted != 0 && (samples & wanted) == 0) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "--samples %u: %s takes these numbers of samples:%s%s%s%s", wanted,
                          device->properties.deviceName, (samples & 1) != 0 ? " 1" : "",
                          (samples & 2) != 0 ? " 2" : "", (samples & 4) != 0 ? " 4" : "",
                          (samples & 8) != 0 ? " 8" : "");
    }
    attachments->samples = (VkSampleCountFlagBits)(wanted != 0          ? wanted
                                                   : (samples & 4) != 0 ? 4
                                                                        : 1);
    attachments->depth_format = is_depth_attachment(device, VK_FORMAT_D32_SFLOAT)
                                    ? VK_FORMAT_D32_SFLOAT
                                    : VK_FORMAT_X8_D24_UNORM_PACK32;
    bool resolves = attachments->samples != VK_SAMPLE_COUNT_1_BIT;
    VkAttachmentDescription descriptions[3] = {
        {.format = attachments->depth_format,
         .samples = attachments->samples,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL},
        {.format = color_format,
         .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = resolves ? VK_ATTACHMENT_LOAD_OP_DONT_CARE : VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
         .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
        {.format = color_format,
         .samples = attachments->samples,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
    };
    VkAttachmentReference depth = {0, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkAttachmentReference color = {resolves ? 2 : 1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkAttachmentReference resolved = {1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {
        .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
        .colorAttachmentCount = 1,
        .pColorAttachments = &color,
        .pResolveAttachments = resolves ? &resolved : NULL,
        .pDepthStencilAttachment = &depth,
    };
    // One set of images serves all pictures in flight: each waits for the copy of the one before.
    VkPipelineStageFlags drawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                   VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                   VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    VkAccessFlags written =
        VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    VkSubpassDependency dependencies[2] = {
        {VK_SUBPASS_EXTERNAL, 0, drawing | VK_PIPELINE_STAGE_TRANSFER_BIT, drawing, written,
         written | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT, 0},
        {0, VK_SUBPASS_EXTERNAL, drawing, VK_PIPELINE_STAGE_TRANSFER_BIT, written,
         VK_ACCESS_TRANSFER_READ_BIT, 0},
    };
    VkRenderPassCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
        .attachmentCount = resolves ? 3 : 2,
        .pAttachments = descriptions,
        .subpassCount = 1,
        .pSubpasses = &subpass,
        .dependencyCount = 2,
        .pDependencies = dependencies,
    };
    VkResult result = vkCreateRenderPass(device->device, &info, NULL, &attachments->pass);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateRenderPass", result);
}

static girih_result create_image(const girih_attachments *attachments, const girih_device *device,
                                 girih_device_image *image, VkFormat format,
                                 VkSampleCountFlagBits samples, VkImageUsageFlags usage,
                                 girih_error *error) {
    VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {attachments->width, attachments->height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = samples,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = usage,
    };
    bool is_depth = (usage & VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
    return girih_device_image_create(
        device, image, &info, is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
        error);
}

static girih_result create_framebuffer(girih_attachments *attachments, const girih_device *device,
                                       girih_error *error) {
    VkImageView views[3] = {attachments->depth.view, attachments->resolved.view,
                            attachments->color.view};
    VkFramebufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
        .renderPass = attachments->pass,
        .attachmentCount = attachments->samples != VK_SAMPLE_COUNT_1_BIT ? 3 : 2,
        .pAttachments = views,
        .width = attachments->width,
        .height = attachments->height,
        .layers = 1,
    };
    VkResult result = vkCreateFramebuffer(device->device, &info, NULL, &attachments->framebuffer);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateFramebuffer", result);
}

static void free_images(girih_attachments *attachments, const girih_device *device) {
    vkDestroyFramebuffer(device->device, attachments->framebuffer, NULL);
    attachments->framebuffer = VK_NULL_HANDLE;
    girih_device_image_destroy(device, &attachments->color);
    girih_device_image_destroy(device, &attachments->resolved);
    girih_device_image_destroy(device, &attachments->depth);
    attachments->width = 0;
    attachments->height = 0;
}

girih_result girih_attachments_resize(girih_attachments *attachments, const girih_device *device,
                                      uint32_t width, uint32_t height, girih_error *error) {
    const VkPhysicalDeviceLimits *limits = &device->properties.limits;
    if (width > limits->maxFramebufferWidth || height > limits->maxFramebufferHeight ||
        width > limits->maxImageDimension2D || height > limits->maxImageDimension2D ||
        width > limits->maxViewportDimensions[0] || height > limits->maxViewportDimensions[1]) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "--resolution %u,%u: the device draws at most %u x %u pixels", width,
                          height, limits->maxFramebufferWidth, limits->maxFramebufferHeight);
    }
    free_images(attachments, device);
    attachments->width = width;
    attachments->height = height;
    VkImageUsageFlags color = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    girih_result result = GIRIH_OK;
    if (attachments->samples != VK_SAMPLE_COUNT_1_BIT) {
        result = create_image(attachments, device, &attachments->color, color_format,
                              attachments->samples, color, error);
    }
    if (result == GIRIH_OK) {
        result =
            create_image(attachments, device, &attachments->resolved, color_format,
                         VK_SAMPLE_COUNT_1_BIT, color | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, error);
    }
    if (result == GIRIH_OK) {
        result =
            create_image(attachments, device, &attachments->depth, attachments->depth_format,
                         attachments->samples, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, error);
    }
    if (result == GIRIH_OK) {
        result = create_framebuffer(attachments, device, error);
    }
    if (result != GIRIH_OK) {
        free_images(attachments, device);
    }
    return result;
}

void girih_attachments_free(girih_attachments *attachments, const girih_device *device) {
    free_images(attachments, device);
    vkDestroyRenderPass(device->device, attachments->pass, NULL);
    attachments->pass = VK_NULL_HANDLE;
}
