// The smallest host of girih: refines an icosahedron to a ball and draws it once into minimal.ppm,
// without a window. `make && ./minimal`; it needs girih, a Vulkan 1.1 device and glslangValidator.
// Where the validation layer is installed it watches, and any message of it makes the program fail.
#include <girih/girih.h>
#include <stdio.h>
#include <string.h>
#include <vulkan/vulkan.h>

#include "baked.spv.h"
#include "fragment.spv.h"
#include "instanced.spv.h"

// clang-format off
// Calls of Vulkan and girih return 0 on success. After a failure the program ends as it is.
#define TRY(CALL) do { const int result_ = (int)(CALL); if (result_ != 0) { \
    fprintf(stderr, "%.60s: %d %s\n", #CALL, result_, error.message); return 1; } } while (0)
#define TYPE(NAME) .sType = VK_STRUCTURE_TYPE_##NAME
#define SIZE 512

static girih_error error;
static VkInstance instance;
static VkPhysicalDevice physical_device;
static VkPhysicalDeviceFeatures features;
static VkDevice device;
static int messages;

static VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                      VkDebugUtilsMessageTypeFlagsEXT types,
                                      const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    (void)severity, (void)types, (void)user;
    fprintf(stderr, "%s\n", data->pMessage);
    ++messages;
    return VK_FALSE;
}

static int create_instance(VkDebugUtilsMessengerEXT *messenger) {
    const char *layer = "VK_LAYER_KHRONOS_validation", *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkLayerProperties layers[64];
    uint32_t count = 64, watched = 0;
    TRY(vkEnumerateInstanceLayerProperties(&count, layers));
    for (uint32_t n = 0; n < count; ++n) watched |= strcmp(layers[n].layerName, layer) == 0;
    const VkValidationFeatureEnableEXT enable = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT validation = {TYPE(VALIDATION_FEATURES_EXT),
        .enabledValidationFeatureCount = 1, .pEnabledValidationFeatures = &enable};
    const VkApplicationInfo application = {TYPE(APPLICATION_INFO),
        .apiVersion = girih_get_requirements().api_version};
    TRY(vkCreateInstance(&(VkInstanceCreateInfo){TYPE(INSTANCE_CREATE_INFO),
        .pNext = watched ? &validation : NULL, .pApplicationInfo = &application,
        .enabledLayerCount = watched, .ppEnabledLayerNames = &layer,
        .enabledExtensionCount = watched, .ppEnabledExtensionNames = &extension}, NULL, &instance));
    if (!watched) return 0;
    const PFN_vkCreateDebugUtilsMessengerEXT create = (PFN_vkCreateDebugUtilsMessengerEXT)
        vkGetInstanceProcAddr(instance, "vkCreateDebugUtilsMessengerEXT");
    TRY(create(instance, &(VkDebugUtilsMessengerCreateInfoEXT){
        TYPE(DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT), .pfnUserCallback = on_message,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT}, NULL, messenger));
    return 0;
}

// The first device; its first queue family that draws and computes.
static int create_device(uint32_t *family) {
    uint32_t count = 1;
    if (vkEnumeratePhysicalDevices(instance, &count, &physical_device) < 0 || count == 0) {
        fprintf(stderr, "no Vulkan device\n");
        return 1;
    }
    TRY(girih_check_device(vkGetInstanceProcAddr, instance, physical_device, &error));
    vkGetPhysicalDeviceFeatures(physical_device, &features);
    features = (VkPhysicalDeviceFeatures){ // what is there of girih_requirements.optional
        .multiDrawIndirect = features.multiDrawIndirect,
        .drawIndirectFirstInstance = features.drawIndirectFirstInstance,
        .fullDrawIndexUint32 = features.fullDrawIndexUint32};
    VkQueueFamilyProperties families[16];
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &(uint32_t){16}, families);
    const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (*family = 0; (families[*family].queueFlags & wanted) != wanted; ) {
    }
    return 0;
}
