#include "gpu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline_store.h"

void gpu_check(VkResult result, const char *what) {
    if (result != VK_SUCCESS) {
        fprintf(stderr, "%s: VkResult %d\n", what, (int)result);
        exit(1);
    }
}

void gpu_girih(girih_result result, const girih_error *error) {
    if (result != GIRIH_OK) {
        fprintf(stderr, "girih: %d: %s\n", (int)result, error->message);
        exit(1);
    }
}

static VkBool32 VKAPI_CALL count_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                         VkDebugUtilsMessageTypeFlagsEXT types,
                                         const VkDebugUtilsMessengerCallbackDataEXT *data,
                                         void *user) {
    (void)severity;
    (void)types;
    gpu *host = user;
    ++host->messages;
    fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

static void create_instance(gpu *host, bool validation) {
    const char *layer = "VK_LAYER_KHRONOS_validation";
    const char *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    const VkValidationFeatureEnableEXT enable =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                              .enabledValidationFeatureCount = 1,
                                              .pEnabledValidationFeatures = &enable};
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pApplicationName = "girih test",
                                           .apiVersion = girih_get_requirements().api_version};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pNext = validation ? &features : NULL,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = validation ? 1 : 0,
                                       .ppEnabledLayerNames = &layer,
                                       .enabledExtensionCount = validation ? 1 : 0,
                                       .ppEnabledExtensionNames = &extension};
    gpu_check(vkCreateInstance(&info, NULL, &host->instance),
              "vkCreateInstance (are the validation layers installed?)");
    if (validation) {
        const VkDebugUtilsMessengerCreateInfoEXT messenger = {
            .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
            .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                               VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
            .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
            .pfnUserCallback = count_message,
            .pUserData = host};
        PFN_vkCreateDebugUtilsMessengerEXT create =
            (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                host->instance, "vkCreateDebugUtilsMessengerEXT");
        gpu_check(create(host->instance, &messenger, NULL, &host->messenger),
                  "vkCreateDebugUtilsMessengerEXT");
    }
}

// The features of `wanted` that the device has.
static void mask_features(VkPhysicalDeviceFeatures *enabled, const VkPhysicalDeviceFeatures *wanted,
                          const VkPhysicalDeviceFeatures *there) {
    const size_t count = sizeof(VkPhysicalDeviceFeatures) / sizeof(VkBool32);
    for (size_t n = 0; n < count; ++n) {
        VkBool32 want, have;
        memcpy(&want, (const char *)wanted + n * sizeof want, sizeof want);
        memcpy(&have, (const char *)there + n * sizeof have, sizeof have);
        have = want && have;
        memcpy((char *)enabled + n * sizeof have, &have, sizeof have);
    }
}

static bool has_extension(VkPhysicalDevice device, const char *name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, NULL, &count, NULL);
    VkExtensionProperties *properties = calloc(count + 1, sizeof *properties);
    bool found = false;
    if (properties &&
        vkEnumerateDeviceExtensionProperties(device, NULL, &count, properties) == VK_SUCCESS) {
        for (uint32_t n = 0; n < count; ++n) {
            found = found || strcmp(properties[n].extensionName, name) == 0;
        }
    }
    free(properties);
    return found;
}

void gpu_open(gpu *host, const VkPhysicalDeviceFeatures *wanted, bool validation) {
    memset(host, 0, sizeof *host);
    create_instance(host, validation);
    uint32_t count = 1;
    const VkResult found =
        vkEnumeratePhysicalDevices(host->instance, &count, &host->physical_device);
    if ((found != VK_SUCCESS && found != VK_INCOMPLETE) || count == 0) {
        fprintf(stderr, "no Vulkan device; install mesa-vulkan-drivers\n");
        exit(1);
    }
    vkGetPhysicalDeviceProperties(host->physical_device, &host->properties);
    vkGetPhysicalDeviceMemoryProperties(host->physical_device, &host->memory);
    VkQueueFamilyProperties families[16];
    uint32_t family_count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(host->physical_device, &family_count, families);
    const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    while (host->queue_family < family_count &&
           (families[host->queue_family].queueFlags & needed) != needed) {
        ++host->queue_family;
    }
    if (wanted) {
        VkPhysicalDeviceFeatures there;
        vkGetPhysicalDeviceFeatures(host->physical_device, &there);
        mask_features(&host->features, wanted, &there);
    }
    const char *feedback = VK_EXT_TRANSFORM_FEEDBACK_EXTENSION_NAME;
    host->transform_feedback = has_extension(host->physical_device, feedback);
    VkPhysicalDeviceTransformFeedbackFeaturesEXT feedback_features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TRANSFORM_FEEDBACK_FEATURES_EXT,
        .transformFeedback = VK_TRUE};
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = host->queue_family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = host->transform_feedback ? &feedback_features : NULL,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .enabledExtensionCount = host->transform_feedback ? 1 : 0,
                                     .ppEnabledExtensionNames = &feedback,
                                     .pEnabledFeatures = &host->features};
    gpu_check(vkCreateDevice(host->physical_device, &info, NULL, &host->device), "vkCreateDevice");
    vkGetDeviceQueue(host->device, host->queue_family, 0, &host->queue);
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = host->queue_family};
    gpu_check(vkCreateCommandPool(host->device, &pool, NULL, &host->pool), "vkCreateCommandPool");
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    gpu_check(vkCreateFence(host->device, &fence, NULL, &host->fence), "vkCreateFence");
}

unsigned gpu_close(gpu *host) {
    host->messages += store_close(host->device);
    vkDestroyFence(host->device, host->fence, NULL);
    vkDestroyCommandPool(host->device, host->pool, NULL);
    vkDestroyDevice(host->device, NULL);
    if (host->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                host->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(host->instance, host->messenger, NULL);
    }
    vkDestroyInstance(host->instance, NULL);
    return host->messages;
}

VkCommandBuffer gpu_begin(gpu *host) {
    const VkCommandBufferAllocateInfo info = {.sType =
                                                  VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = host->pool,
                                              .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                              .commandBufferCount = 1};
    VkCommandBuffer commands;
    gpu_check(vkAllocateCommandBuffers(host->device, &info, &commands), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    gpu_check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    return commands;
}

void gpu_end(VkCommandBuffer commands) {
    gpu_check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
}

void gpu_submit(gpu *host, VkCommandBuffer commands) {
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .commandBufferCount = 1,
                                 .pCommandBuffers = &commands};
    gpu_check(vkQueueSubmit(host->queue, 1, &submit, host->fence), "vkQueueSubmit");
    gpu_check(vkWaitForFences(host->device, 1, &host->fence, VK_TRUE, UINT64_MAX),
              "vkWaitForFences");
    gpu_check(vkResetFences(host->device, 1, &host->fence), "vkResetFences");
}

void gpu_run(gpu *host, VkCommandBuffer commands) {
    gpu_end(commands);
    gpu_submit(host, commands);
    vkFreeCommandBuffers(host->device, host->pool, 1, &commands);
}

gpu_buffer gpu_create_buffer(gpu *host, VkDeviceSize size, VkBufferUsageFlags usage, bool mapped) {
    gpu_buffer buffer = {.size = size};
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    gpu_check(vkCreateBuffer(host->device, &info, NULL, &buffer.buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(host->device, buffer.buffer, &needs);
    const VkMemoryPropertyFlags flags =
        mapped ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
               : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    uint32_t type = 0;
    while (!(needs.memoryTypeBits & 1u << type) ||
           (host->memory.memoryTypes[type].propertyFlags & flags) != flags) {
        ++type;
    }
    const VkMemoryAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                             .allocationSize = needs.size,
                                             .memoryTypeIndex = type};
    gpu_check(vkAllocateMemory(host->device, &allocation, NULL, &buffer.memory),
              "vkAllocateMemory");
    gpu_check(vkBindBufferMemory(host->device, buffer.buffer, buffer.memory, 0),
              "vkBindBufferMemory");
    if (mapped) {
        gpu_check(vkMapMemory(host->device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.mapped),
                  "vkMapMemory");
    }
    return buffer;
}

void gpu_destroy_buffer(gpu *host, gpu_buffer *buffer) {
    vkDestroyBuffer(host->device, buffer->buffer, NULL);
    vkFreeMemory(host->device, buffer->memory, NULL);
    *buffer = (gpu_buffer){0};
}

void *gpu_read(gpu *host, VkBuffer source, VkDeviceSize offset, VkDeviceSize size) {
    void *bytes = calloc(1, size ? size : 1);
    if (!bytes) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    if (size == 0) {
        return bytes;
    }
    gpu_buffer target = gpu_create_buffer(host, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true);
    VkCommandBuffer commands = gpu_begin(host);
    const VkMemoryBarrier before = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                    .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &before, 0, NULL, 0, NULL);
    const VkBufferCopy copy = {.srcOffset = offset, .size = size};
    vkCmdCopyBuffer(commands, source, target.buffer, 1, &copy);
    const VkMemoryBarrier after = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &after, 0, NULL, 0, NULL);
    gpu_run(host, commands);
    memcpy(bytes, target.mapped, size);
    gpu_destroy_buffer(host, &target);
    return bytes;
}

VkShaderModule gpu_shader(gpu *host, const uint32_t *words, size_t bytes) {
    const VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
    VkShaderModule module;
    gpu_check(vkCreateShaderModule(host->device, &info, NULL, &module), "vkCreateShaderModule");
    return module;
}

girih_context *gpu_context(gpu *host, const girih_context_desc *options) {
    girih_context_desc desc = *options;
    desc.get_instance_proc_addr =
        host->share_pipelines ? store_get_instance_proc_addr : vkGetInstanceProcAddr;
    desc.instance = host->instance;
    desc.physical_device = host->physical_device;
    desc.device = host->device;
    desc.enabled_features = &host->features;
    girih_context *context;
    girih_error error;
    gpu_girih(girih_context_create(&desc, &context, &error), &error);
    VkCommandBuffer commands = gpu_begin(host);
    girih_cmd_upload_context(context, commands);
    gpu_run(host, commands);
    girih_context_trim(context);
    return context;
}

girih_scene *gpu_scene(gpu *host, const girih_context *context, const girih_mesh *const *meshes,
                       uint32_t mesh_count) {
    girih_scene *scene;
    girih_error error;
    gpu_girih(girih_scene_create(
                  context, &(girih_scene_desc){.meshes = meshes, .mesh_count = mesh_count}, &scene,
                  &error), &error);
    VkCommandBuffer commands = gpu_begin(host);
    girih_cmd_upload_scene(scene, commands);
    gpu_run(host, commands);
    girih_scene_trim(scene);
    return scene;
}
