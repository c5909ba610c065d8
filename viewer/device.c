#include "device.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "report.h"

static const char validation_layer[] = "VK_LAYER_KHRONOS_validation";

static const char *result_name(VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED:
        return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST:
        return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_MEMORY_MAP_FAILED:
        return "VK_ERROR_MEMORY_MAP_FAILED";
    case VK_ERROR_LAYER_NOT_PRESENT:
        return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
        return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT:
        return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_ERROR_TOO_MANY_OBJECTS:
        return "VK_ERROR_TOO_MANY_OBJECTS";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
        return "VK_ERROR_FORMAT_NOT_SUPPORTED";
    case VK_ERROR_FRAGMENTED_POOL:
        return "VK_ERROR_FRAGMENTED_POOL";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
        return "VK_ERROR_OUT_OF_POOL_MEMORY";
    case VK_ERROR_SURFACE_LOST_KHR:
        return "VK_ERROR_SURFACE_LOST_KHR";
    case VK_ERROR_NATIVE_WINDOW_IN_USE_KHR:
        return "VK_ERROR_NATIVE_WINDOW_IN_USE_KHR";
    case VK_ERROR_OUT_OF_DATE_KHR:
        return "VK_ERROR_OUT_OF_DATE_KHR";
    default:
        return "VkResult";
    }
}

static const char *advice(VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return ": too little memory; ask for fewer segments or a smaller picture";
    case VK_ERROR_INITIALIZATION_FAILED:
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        return ": no working Vulkan driver; install one (on Debian, mesa-vulkan-drivers) or, for "
               "refine, use --cpu";
    case VK_ERROR_DEVICE_LOST:
        return ": the driver gave up; try another --device, or --validation to find the cause";
    case VK_ERROR_SURFACE_LOST_KHR:
        return ": the window or its display is gone";
    default:
        return "";
    }
}

girih_result girih_vulkan_failure(girih_error *error, const char *call, VkResult result) {
    girih_result kind = result == VK_ERROR_OUT_OF_DEVICE_MEMORY ? GIRIH_ERROR_OUT_OF_DEVICE_MEMORY
                        : result == VK_ERROR_OUT_OF_HOST_MEMORY ? GIRIH_ERROR_OUT_OF_MEMORY
                                                                : GIRIH_ERROR_DEVICE;
    return girih_fail(error, kind, "%s: %s (%d)%s", call, result_name(result), (int)result,
                      advice(result));
}

// --- Instance ---

static VKAPI_ATTR VkBool32 VKAPI_CALL on_validation_message(
    VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT types,
    const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    (void)severity;
    (void)types;
    girih_device *device = user;
    device->validation_messages++;
    girih_report_progress(NULL);
    fprintf(stderr, "girih: validation: %s\n", data->pMessage);
    return VK_FALSE;
}

static girih_result find_validation(girih_error *error) {
    VkLayerProperties layers[64];
    uint32_t count = 64;
    VkResult result = vkEnumerateInstanceLayerProperties(&count, layers);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE) {
        return girih_vulkan_failure(error, "vkEnumerateInstanceLayerProperties", result);
    }
    for (uint32_t n = 0; n < count; n++) {
        if (strcmp(layers[n].layerName, validation_layer) == 0) {
            return GIRIH_OK;
        }
    }
    return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                      "--validation: no layer %s; install it (on Debian, vulkan-validationlayers)",
                      validation_layer);
}

static girih_result create_instance(girih_device *device, bool validation,
                                    const girih_device_wishes *wishes, girih_error *error) {
    const char *layers[] = {validation_layer};
    const char *extensions[8];
    uint32_t extension_count = 0;
    if (validation) {
        extensions[extension_count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
        extensions[extension_count++] = VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME;
    }
    for (uint32_t n = 0; n < wishes->window_extension_count && extension_count < 8; n++) {
        extensions[extension_count++] = wishes->window_extensions[n];
    }
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_validation_message,
        .pUserData = device,
    };
    VkValidationFeatureEnableEXT enabled[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = enabled,
    };
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "girih",
        .apiVersion = girih_get_requirements().api_version,
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = validation ? &features : NULL,
        .pApplicationInfo = &application,
        .enabledLayerCount = validation ? 1 : 0,
        .ppEnabledLayerNames = layers,
        .enabledExtensionCount = extension_count,
        .ppEnabledExtensionNames = extensions,
    };
    if (validation) {
        girih_result found = find_validation(error);
        if (found != GIRIH_OK) {
            return found;
        }
    }
    VkResult result = vkCreateInstance(&info, NULL, &device->instance);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateInstance", result);
    }
    if (validation) {
        PFN_vkCreateDebugUtilsMessengerEXT create =
            (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                device->instance, "vkCreateDebugUtilsMessengerEXT");
        result = create(device->instance, &messenger, NULL, &device->messenger);
        if (result != VK_SUCCESS) {
            return girih_vulkan_failure(error, "vkCreateDebugUtilsMessengerEXT", result);
        }
    }
    return GIRIH_OK;
}

// --- Physical device ---

static bool name_contains(const char *name, const char *part) {
    size_t length = strlen(part);
    for (; *name != '\0'; name++) {
        size_t n = 0;
        while (n < length && tolower((unsigned char)name[n]) == tolower((unsigned char)part[n])) {
            n++;
        }
        if (n == length) {
            return true;
        }
    }
    return length == 0;
}

static bool has_extension(VkPhysicalDevice physical, const char *name) {
    VkExtensionProperties extensions[512];
    uint32_t count = 512;
    const VkResult result =
        vkEnumerateDeviceExtensionProperties(physical, NULL, &count, extensions);
    for (uint32_t n = 0; (result == VK_SUCCESS || result == VK_INCOMPLETE) && n < count; n++) {
        if (strcmp(extensions[n].extensionName, name) == 0) {
            return true;
        }
    }
    return false;
}

static uint32_t find_queue_family(VkInstance instance, VkPhysicalDevice physical,
                                  const girih_device_wishes *wishes) {
    VkQueueFlags flags =
        girih_get_requirements().queue | (wishes->graphics ? VK_QUEUE_GRAPHICS_BIT : 0u);
    if (wishes->shows != NULL && !has_extension(physical, VK_KHR_SWAPCHAIN_EXTENSION_NAME)) {
        return UINT32_MAX;
    }
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (uint32_t n = 0; n < count; n++) {
        if ((families[n].queueFlags & flags) == flags &&
            (wishes->shows == NULL || wishes->shows(instance, physical, n))) {
            return n;
        }
    }
    return UINT32_MAX;
}

static int preference(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return 1;
    default:
        return 0;
    }
}

static girih_result choose_physical(girih_device *device, const char *name,
                                    const girih_device_wishes *wishes, girih_error *error) {
    VkPhysicalDevice devices[32];
    uint32_t count = 32;
    VkResult result = vkEnumeratePhysicalDevices(device->instance, &count, devices);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE) {
        return girih_vulkan_failure(error, "vkEnumeratePhysicalDevices", result);
    }
    char names[sizeof error->message] = "";
    int best = -1;
    bool is_named = false;
    for (uint32_t n = 0; n < count; n++) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(devices[n], &properties);
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s'%s'", n == 0 ? "" : ", ",
                 properties.deviceName);
        if (name != NULL && !name_contains(properties.deviceName, name)) {
            continue;
        }
        is_named = true;
        uint32_t family = find_queue_family(device->instance, devices[n], wishes);
        if (properties.apiVersion < girih_get_requirements().api_version || family == UINT32_MAX) {
            continue;
        }
        if (preference(properties.deviceType) > best) {
            best = preference(properties.deviceType);
            device->physical = devices[n];
            device->properties = properties;
            device->queue_family = family;
        }
    }
    if (best >= 0) {
        return GIRIH_OK;
    }
    if (count == 0) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "no Vulkan device; install a driver (on Debian, mesa-vulkan-drivers has "
                          "one for the CPU)");
    }
    if (!is_named) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED, "--device: no '%s' among %.300s", name,
                          names);
    }
    return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                      "no device with Vulkan 1.1 and a queue that %s among %.300s",
                      wishes->shows != NULL ? "shows windows" : "fits", names);
}

// Features as an array: VkPhysicalDeviceFeatures holds nothing but VkBool32.
static void enable_features(const VkPhysicalDeviceFeatures *there,
                            const VkPhysicalDeviceFeatures *wanted,
                            VkPhysicalDeviceFeatures *enabled) {
    VkBool32 a[sizeof *there / sizeof(VkBool32)], b[sizeof *there / sizeof(VkBool32)],
        c[sizeof *there / sizeof(VkBool32)];
    memcpy(a, there, sizeof a);
    memcpy(b, wanted, sizeof b);
    memcpy(c, enabled, sizeof c);
    for (size_t n = 0; n < sizeof a / sizeof a[0]; n++) {
        c[n] |= a[n] & b[n];
    }
    memcpy(enabled, c, sizeof c);
}

static girih_result create_device(girih_device *device, const girih_device_wishes *wishes,
                                  girih_error *error) {
    VkPhysicalDeviceFeatures there;
    vkGetPhysicalDeviceFeatures(device->physical, &there);
    girih_requirements requirements = girih_get_requirements();
    enable_features(&there, &requirements.optional, &device->features);
    enable_features(&there, &wishes->features, &device->features);
    VkPhysicalDeviceTransformFeedbackFeaturesEXT feedback = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TRANSFORM_FEEDBACK_FEATURES_EXT};
    const char *const feedback_name = VK_EXT_TRANSFORM_FEEDBACK_EXTENSION_NAME;
    if (wishes->transform_feedback && has_extension(device->physical, feedback_name)) {
        VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                              .pNext = &feedback};
        vkGetPhysicalDeviceFeatures2(device->physical, &features);
        feedback.geometryStreams = VK_FALSE;
        device->has_transform_feedback = feedback.transformFeedback;
    }
    const char *extensions[2];
    uint32_t extension_count = 0;
    if (device->has_transform_feedback) {
        extensions[extension_count++] = feedback_name;
    }
    if (wishes->shows != NULL) {
        extensions[extension_count++] = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    }
    float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = device->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &priority,
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = device->has_transform_feedback ? &feedback : NULL,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = extension_count,
        .ppEnabledExtensionNames = extensions,
        .pEnabledFeatures = &device->features,
    };
    VkResult result = vkCreateDevice(device->physical, &info, NULL, &device->device);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDevice", result);
    }
    vkGetDeviceQueue(device->device, device->queue_family, 0, &device->queue);
    vkGetPhysicalDeviceMemoryProperties(device->physical, &device->memory);
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    vkGetPhysicalDeviceQueueFamilyProperties(device->physical, &count, families);
    device->has_timestamps = families[device->queue_family].timestampValidBits != 0;
    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
        .queueFamilyIndex = device->queue_family,
    };
    result = vkCreateCommandPool(device->device, &pool, NULL, &device->pool);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateCommandPool", result);
    }
    VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = device->pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    result = vkAllocateCommandBuffers(device->device, &commands, &device->commands);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkAllocateCommandBuffers", result);
    }
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    result = vkCreateFence(device->device, &fence, NULL, &device->fence);
    return result == VK_SUCCESS ? GIRIH_OK : girih_vulkan_failure(error, "vkCreateFence", result);
}

girih_result girih_device_open(girih_device *device, const girih_device_options *options,
                               const girih_device_wishes *wishes, girih_error *error) {
    *device = (girih_device){0};
    girih_result result = create_instance(device, options->validation, wishes, error);
    if (result == GIRIH_OK) {
        result = choose_physical(device, options->name, wishes, error);
    }
    if (result == GIRIH_OK) {
        result = create_device(device, wishes, error);
    }
    if (result != GIRIH_OK) {
        girih_device_close(device);
    }
    return result;
}

void girih_device_close(girih_device *device) {
    if (device->device != VK_NULL_HANDLE) {
        vkDestroyFence(device->device, device->fence, NULL);
        vkDestroyCommandPool(device->device, device->pool, NULL);
        vkDestroyDevice(device->device, NULL);
        device->device = VK_NULL_HANDLE;
    }
    if (device->messenger != VK_NULL_HANDLE) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                device->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(device->instance, device->messenger, NULL);
        device->messenger = VK_NULL_HANDLE;
    }
    if (device->instance != VK_NULL_HANDLE) {
        vkDestroyInstance(device->instance, NULL);
        device->instance = VK_NULL_HANDLE;
    }
}

girih_result girih_device_context(const girih_device *device, const girih_catalogue *catalogue,
                                  girih_context **context, girih_error *error) {
    girih_context_desc desc = {
        .get_instance_proc_addr = vkGetInstanceProcAddr,
        .instance = device->instance,
        .physical_device = device->physical,
        .device = device->device,
        .enabled_features = &device->features,
        .catalogue = catalogue,
    };
    return girih_context_create(&desc, context, error);
}

girih_result girih_device_begin(girih_device *device, girih_error *error) {
    VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    VkResult result = vkBeginCommandBuffer(device->commands, &info);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkBeginCommandBuffer", result);
}

girih_result girih_device_finish(girih_device *device, girih_error *error) {
    VkResult result = vkEndCommandBuffer(device->commands);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkEndCommandBuffer", result);
    }
    VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                           .commandBufferCount = 1,
                           .pCommandBuffers = &device->commands};
    result = vkQueueSubmit(device->queue, 1, &submit, device->fence);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkQueueSubmit", result);
    }
    result = vkWaitForFences(device->device, 1, &device->fence, VK_TRUE, UINT64_MAX);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkWaitForFences", result);
    }
    result = vkResetFences(device->device, 1, &device->fence);
    return result == VK_SUCCESS ? GIRIH_OK : girih_vulkan_failure(error, "vkResetFences", result);
}

void girih_device_full_barrier(VkCommandBuffer commands) {
    VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
    };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &barrier, 0, NULL, 0, NULL);
}

girih_result girih_device_queries(const girih_device *device, uint32_t count, VkQueryPool *pool,
                                  girih_error *error) {
    *pool = VK_NULL_HANDLE;
    if (!device->has_timestamps) {
        return GIRIH_OK;
    }
    VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                  .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                  .queryCount = count};
    VkResult result = vkCreateQueryPool(device->device, &info, NULL, pool);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateQueryPool", result);
}

bool girih_device_read_queries(const girih_device *device, VkQueryPool pool, uint32_t first,
                               uint32_t count, double *milliseconds) {
    uint64_t ticks[16];
    if (pool == VK_NULL_HANDLE || count > 16 ||
        vkGetQueryPoolResults(device->device, pool, first, count, sizeof ticks, ticks,
                              sizeof ticks[0], VK_QUERY_RESULT_64_BIT) != VK_SUCCESS) {
        return false;
    }
    for (uint32_t n = 0; n < count; n++) {
        milliseconds[n] = (double)(ticks[n] - ticks[0]) *
                          (double)device->properties.limits.timestampPeriod * 1e-6;
    }
    return true;
}
