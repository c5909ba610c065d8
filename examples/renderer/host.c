#include "host.h"

#include <stdio.h>
#include <string.h>

_Thread_local girih_error host_error;

int host_failed(int result, const char *call) {
    if (result != 0) {
        fprintf(stderr, "%.60s: %d %s\n", call, result, host_error.message);
    }
    return result != 0;
}

static VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                      VkDebugUtilsMessageTypeFlagsEXT types,
                                      const VkDebugUtilsMessengerCallbackDataEXT *data,
                                      void *user) {
    (void)severity;
    (void)types;
    fprintf(stderr, "%s\n", data->pMessage);
    ++((host *)user)->messages;
    return VK_FALSE;
}

static int has_layer(const char *name, int *found) {
    VkLayerProperties layers[64];
    uint32_t count = 64;
    TRY(vkEnumerateInstanceLayerProperties(&count, layers));
    for (uint32_t n = 0; n < count; ++n) {
        *found = *found || strcmp(layers[n].layerName, name) == 0;
    }
    return 0;
}

static int create_instance(host *h) {
    const char *layer = "VK_LAYER_KHRONOS_validation";
    const char *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    int watched = 0;
    TRY(has_layer(layer, &watched));
    const VkValidationFeatureEnableEXT enable =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT validation = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                                .enabledValidationFeatureCount = 1,
                                                .pEnabledValidationFeatures = &enable};
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pApplicationName = "girih example",
                                           .apiVersion = girih_get_requirements().api_version};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pNext = watched ? &validation : NULL,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = watched ? 1 : 0,
                                       .ppEnabledLayerNames = &layer,
                                       .enabledExtensionCount = watched ? 1 : 0,
                                       .ppEnabledExtensionNames = &extension};
    TRY(vkCreateInstance(&info, NULL, &h->instance));
    if (!watched) {
        return 0;
    }
    const PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(h->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = h};
    TRY(create(h->instance, &messenger, NULL, &h->messenger));
    return 0;
}

// The first device, and of it the first queue family that draws and computes.
static int create_device(host *h) {
    uint32_t count = 1;
    if (vkEnumeratePhysicalDevices(h->instance, &count, &h->physical_device) < 0 || count == 0) {
        fprintf(stderr, "no Vulkan device\n");
        return 1;
    }
    TRY(girih_check_device(vkGetInstanceProcAddr, h->instance, h->physical_device, &host_error));
    vkGetPhysicalDeviceProperties(h->physical_device, &h->properties);
    VkQueueFamilyProperties families[16];
    count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(h->physical_device, &count, families);
    const girih_requirements requirements = girih_get_requirements();
    const VkQueueFlags wanted = requirements.queue | VK_QUEUE_GRAPHICS_BIT;
    while (h->family < count && (families[h->family].queueFlags & wanted) != wanted) {
        ++h->family;
    }
    if (h->family == count) {
        fprintf(stderr, "%s: no queue draws and computes\n", h->properties.deviceName);
        return 1;
    }
    VkPhysicalDeviceFeatures there;
    vkGetPhysicalDeviceFeatures(h->physical_device, &there);
    const VkPhysicalDeviceFeatures *optional = &requirements.optional;
    h->features.multiDrawIndirect = optional->multiDrawIndirect & there.multiDrawIndirect;
    h->features.drawIndirectFirstInstance =
        optional->drawIndirectFirstInstance & there.drawIndirectFirstInstance;
    h->features.fullDrawIndexUint32 = optional->fullDrawIndexUint32 & there.fullDrawIndexUint32;
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = h->family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .pEnabledFeatures = &h->features};
    TRY(vkCreateDevice(h->physical_device, &info, NULL, &h->device));
    vkGetDeviceQueue(h->device, h->family, 0, &h->queue);
    return 0;
}

int host_create(host *h) {
    TRY(create_instance(h));
    TRY(create_device(h));
    return 0;
}

void host_destroy(host *h) {
    if (h->device) {
        vkDestroyDevice(h->device, NULL);
    }
    if (h->messenger) {
        const PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                h->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(h->instance, h->messenger, NULL);
    }
    if (h->instance) {
        vkDestroyInstance(h->instance, NULL);
    }
}

static int allocate(const host *h, const VkMemoryRequirements *needs, VkMemoryPropertyFlags flags,
                    VkDeviceMemory *memory) {
    VkPhysicalDeviceMemoryProperties there;
    vkGetPhysicalDeviceMemoryProperties(h->physical_device, &there);
    uint32_t type = 0;
    while (type < there.memoryTypeCount &&
           (!(needs->memoryTypeBits >> type & 1) ||
            (there.memoryTypes[type].propertyFlags & flags) != flags)) {
        ++type;
    }
    if (type == there.memoryTypeCount) {
        fprintf(stderr, "no fitting memory type\n");
        return 1;
    }
    const VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                       .allocationSize = needs->size,
                                       .memoryTypeIndex = type};
    TRY(vkAllocateMemory(h->device, &info, NULL, memory));
    return 0;
}

int host_create_buffer(const host *h, VkDeviceSize size, VkBufferUsageFlags usage, int mapped,
                       host_buffer *buffer) {
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    TRY(vkCreateBuffer(h->device, &info, NULL, &buffer->buffer));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(h->device, buffer->buffer, &needs);
    TRY(allocate(h, &needs,
                 mapped ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
                        : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                 &buffer->memory));
    TRY(vkBindBufferMemory(h->device, buffer->buffer, buffer->memory, 0));
    if (mapped) {
        TRY(vkMapMemory(h->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped));
    }
    return 0;
}

void host_destroy_buffer(const host *h, host_buffer *buffer) {
    vkDestroyBuffer(h->device, buffer->buffer, NULL);
    vkFreeMemory(h->device, buffer->memory, NULL);
}

int host_create_image(const host *h, VkFormat format, uint32_t width, uint32_t height,
                      VkImageUsageFlags usage, VkImageAspectFlags aspect, host_image *image) {
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = format,
                                    .extent = {width, height, 1},
                                    .mipLevels = 1,
                                    .arrayLayers = 1,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .usage = usage};
    TRY(vkCreateImage(h->device, &info, NULL, &image->image));
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(h->device, image->image, &needs);
    TRY(allocate(h, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &image->memory));
    TRY(vkBindImageMemory(h->device, image->image, image->memory, 0));
    const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                        .image = image->image,
                                        .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                        .format = format,
                                        .subresourceRange = {aspect, 0, 1, 0, 1}};
    TRY(vkCreateImageView(h->device, &view, NULL, &image->view));
    return 0;
}

void host_destroy_image(const host *h, host_image *image) {
    vkDestroyImageView(h->device, image->view, NULL);
    vkDestroyImage(h->device, image->image, NULL);
    vkFreeMemory(h->device, image->memory, NULL);
}

static int create_module(const host *h, host_code code, VkShaderModule *module) {
    const VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                           .codeSize = code.bytes,
                                           .pCode = code.words};
    TRY(vkCreateShaderModule(h->device, &info, NULL, module));
    return 0;
}

static int create_pipeline(const host *h, const VkShaderModule modules[2],
                           const VkPipelineVertexInputStateCreateInfo *input, VkCullModeFlags cull,
                           VkExtent2D extent, VkRenderPass pass, VkPipelineLayout layout,
                           VkPipeline *pipeline) {
    const VkPipelineShaderStageCreateInfo stages[2] = {
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_VERTEX_BIT,
         .module = modules[0],
         .pName = "main"},
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
         .module = modules[1],
         .pName = "main"}};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkViewport viewport = {
        .width = (float)extent.width, .height = (float)extent.height, .maxDepth = 1};
    const VkRect2D scissor = {.extent = extent};
    const VkPipelineViewportStateCreateInfo viewports = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .pViewports = &viewport,
        .scissorCount = 1,
        .pScissors = &scissor};
    const VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .cullMode = cull,
        .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo multisample = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = VK_COMPARE_OP_LESS};
    const VkColorComponentFlags all = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                      VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    const VkPipelineColorBlendAttachmentState attachments[2] = {{.colorWriteMask = all},
                                                                {.colorWriteMask = all}};
    const VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 2,
        .pAttachments = attachments};
    const VkGraphicsPipelineCreateInfo info = {.sType =
                                                   VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                               .stageCount = 2,
                                               .pStages = stages,
                                               .pVertexInputState = input,
                                               .pInputAssemblyState = &assembly,
                                               .pViewportState = &viewports,
                                               .pRasterizationState = &rasterization,
                                               .pMultisampleState = &multisample,
                                               .pDepthStencilState = &depth,
                                               .pColorBlendState = &blend,
                                               .layout = layout,
                                               .renderPass = pass};
    TRY(vkCreateGraphicsPipelines(h->device, VK_NULL_HANDLE, 1, &info, NULL, pipeline));
    return 0;
}

int host_create_pipeline(const host *h, host_code vertex, host_code fragment,
                         const VkPipelineVertexInputStateCreateInfo *input, VkCullModeFlags cull,
                         VkExtent2D extent, VkRenderPass pass, VkPipelineLayout layout,
                         VkPipeline *pipeline) {
    VkShaderModule modules[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    const int failed = create_module(h, vertex, &modules[0]) ||
                       create_module(h, fragment, &modules[1]) ||
                       create_pipeline(h, modules, input, cull, extent, pass, layout, pipeline);
    vkDestroyShaderModule(h->device, modules[0], NULL);
    vkDestroyShaderModule(h->device, modules[1], NULL);
    return failed;
}
