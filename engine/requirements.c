// What girih needs of a device, as data, and a device compared with it.
#include <stddef.h>

#include "context.h"
#include "error.h"
#include "memory.h"

// The limits girih looks at: what is required of each is at most what Vulkan 1.1 requires of every
// device, so a conforming one passes.
#define LIMITS(X)                                                                                  \
    X(maxUniformBufferRange)                                                                       \
    X(maxStorageBufferRange)                                                                       \
    X(maxPushConstantsSize)                                                                        \
    X(maxBoundDescriptorSets)                                                                      \
    X(maxPerStageDescriptorUniformBuffers)                                                         \
    X(maxPerStageDescriptorStorageBuffers)                                                         \
    X(maxPerStageResources)                                                                        \
    X(maxDescriptorSetUniformBuffers)                                                              \
    X(maxDescriptorSetStorageBuffers)                                                              \
    X(maxVertexInputAttributes)                                                                    \
    X(maxVertexInputBindings)                                                                      \
    X(maxVertexInputAttributeOffset)                                                               \
    X(maxVertexInputBindingStride)                                                                 \
    X(maxComputeSharedMemorySize)                                                                  \
    X(maxComputeWorkGroupCount[0])                                                                 \
    X(maxComputeWorkGroupCount[1])                                                                 \
    X(maxComputeWorkGroupCount[2])                                                                 \
    X(maxComputeWorkGroupInvocations)                                                              \
    X(maxComputeWorkGroupSize[0])                                                                  \
    X(maxComputeWorkGroupSize[1])                                                                  \
    X(maxComputeWorkGroupSize[2])                                                                  \
    X(maxDrawIndexedIndexValue)                                                                    \
    X(maxDrawIndirectCount)

#define FEW_STORAGE_BUFFERS 4u // a stage; see GIRIH_BIND_SHARED_SCENE
#define LARGEST_PATCH_WORDS (GIRIH_PATCH_WORDS_PN + GIRIH_PATCH_WORDS_PART)
// Every binding but the frame block is a storage buffer.
#define ALL_STORAGE_BUFFERS (GIRIH_BIND_COUNT - 1u)
// More than one material's draws in a plan that draws with the catalogue's indices.
#define MOST_DRAWS (1u << 20)

girih_requirements girih_get_requirements(void) {
    girih_requirements requirements = {
        .api_version = VK_API_VERSION_1_1,
        .queue = VK_QUEUE_COMPUTE_BIT,
        .optional = {.multiDrawIndirect = VK_TRUE,
                     .drawIndirectFirstInstance = VK_TRUE,
                     .fullDrawIndexUint32 = VK_TRUE},
        .required = {.maxUniformBufferRange = sizeof(girih_frame_block),
                     .maxStorageBufferRange = 1u << 27,
                     .maxPushConstantsSize = GIRIH_PUSH_CONSTANT_BYTES,
                     .maxBoundDescriptorSets = 2, // girih's and a surface program's
                     .maxPerStageDescriptorUniformBuffers = 1,
                     .maxPerStageDescriptorStorageBuffers = FEW_STORAGE_BUFFERS,
                     .maxPerStageResources = FEW_STORAGE_BUFFERS + 1,
                     .maxDescriptorSetUniformBuffers = 1,
                     .maxDescriptorSetStorageBuffers = FEW_STORAGE_BUFFERS,
                     // The patch of a curved PN triangle, and the pattern's vertex.
                     .maxVertexInputAttributes = LARGEST_PATCH_WORDS / 4 + 1,
                     .maxVertexInputBindings = 2,
                     .maxVertexInputAttributeOffset = (LARGEST_PATCH_WORDS - 4) * 4,
                     .maxVertexInputBindingStride = LARGEST_PATCH_WORDS * 4,
                     .maxComputeSharedMemorySize = 16384,
                     .maxComputeWorkGroupCount = {65535, 65535, 1},
                     .maxComputeWorkGroupInvocations = 128,
                     .maxComputeWorkGroupSize = {128, 1, 1},
                     .maxDrawIndexedIndexValue = (1u << 24) - 1,
                     .maxDrawIndirectCount = 1},
    };
    requirements.useful = requirements.required;
    VkPhysicalDeviceLimits *useful = &requirements.useful;
    useful->maxStorageBufferRange = UINT32_MAX;
    useful->maxPerStageDescriptorStorageBuffers = ALL_STORAGE_BUFFERS;
    useful->maxPerStageResources = ALL_STORAGE_BUFFERS + 1;
    useful->maxDescriptorSetStorageBuffers = ALL_STORAGE_BUFFERS;
    useful->maxDrawIndexedIndexValue = UINT32_MAX;
    useful->maxDrawIndirectCount = MOST_DRAWS;
    return requirements;
}

// vkGetInstanceProcAddr's answer, as the function it is.
#define FUNCTION(NAME) ((PFN_vk##NAME)get_instance_proc_addr(instance, "vk" #NAME))

static girih_result check_version(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                  VkInstance instance, VkPhysicalDevice physical_device,
                                  uint32_t needed, girih_error *error) {
    // A function of Vulkan 1.0, as the device may be of no later version.
    const PFN_vkGetPhysicalDeviceProperties get_properties = FUNCTION(GetPhysicalDeviceProperties);
    if (!get_properties) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "vkGetPhysicalDeviceProperties is missing; girih needs Vulkan 1.1");
    }
    VkPhysicalDeviceProperties properties;
    get_properties(physical_device, &properties);
    if (properties.apiVersion < needed) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "apiVersion: '%s' is a Vulkan %u.%u device; girih needs %u.%u",
                          properties.deviceName, VK_API_VERSION_MAJOR(properties.apiVersion),
                          VK_API_VERSION_MINOR(properties.apiVersion), VK_API_VERSION_MAJOR(needed),
                          VK_API_VERSION_MINOR(needed));
    }
    return GIRIH_OK;
}

static girih_result check_limits(const VkPhysicalDeviceProperties *properties,
                                 const VkPhysicalDeviceLimits *required, girih_error *error) {
    const VkPhysicalDeviceLimits *there = &properties->limits;
    const struct {
        const char *name;
        uint32_t there, needed;
    } limits[] = {
#define LIMIT(NAME) {#NAME, there->NAME, required->NAME},
        LIMITS(LIMIT)
#undef LIMIT
    };
    for (size_t n = 0; n < sizeof limits / sizeof *limits; ++n) {
        if (limits[n].there < limits[n].needed) {
            return girih_fail(error, GIRIH_ERROR_UNSUPPORTED, "%s: '%s' has %u; girih needs %u",
                              limits[n].name, properties->deviceName, limits[n].there,
                              limits[n].needed);
        }
    }
    return GIRIH_OK;
}

static girih_result check_queues(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                 VkInstance instance, VkPhysicalDevice physical_device,
                                 VkQueueFlags needed, girih_error *error) {
    const PFN_vkGetPhysicalDeviceQueueFamilyProperties get_families =
        FUNCTION(GetPhysicalDeviceQueueFamilyProperties);
    if (!get_families) {
        return girih_fail(
            error, GIRIH_ERROR_UNSUPPORTED,
            "vkGetPhysicalDeviceQueueFamilyProperties is missing; girih needs Vulkan 1.1");
    }
    uint32_t count = 0;
    get_families(physical_device, &count, NULL);
    VkQueueFamilyProperties *families = girih_allocate_array(count, sizeof *families);
    if (!families) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "queue families: out of memory");
    }
    get_families(physical_device, &count, families);
    bool found = false;
    for (uint32_t n = 0; n < count; ++n) {
        found = found || (families[n].queueFlags & needed) == needed;
    }
    girih_free(families);
    return found ? GIRIH_OK
                 : girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                              "queueFlags: none of the device's %u queue families has "
                              "VK_QUEUE_COMPUTE_BIT; girih needs one",
                              count);
}

girih_result girih_check_device(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                VkInstance instance, VkPhysicalDevice physical_device,
                                girih_error *error) {
    if (!get_instance_proc_addr || !instance || !physical_device) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_check_device: get_instance_proc_addr, instance and "
                          "physical_device must be set");
    }
    const girih_requirements requirements = girih_get_requirements();
    girih_result result = check_version(get_instance_proc_addr, instance, physical_device,
                                        requirements.api_version, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const PFN_vkGetPhysicalDeviceProperties2 get_properties =
        FUNCTION(GetPhysicalDeviceProperties2);
    if (!get_properties) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "vkGetPhysicalDeviceProperties2 is missing; create the instance with "
                          "apiVersion VK_API_VERSION_1_1 or later");
    }
    VkPhysicalDeviceProperties2 properties = {.sType =
                                                  VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    get_properties(physical_device, &properties);
    result = check_limits(&properties.properties, &requirements.required, error);
    if (result != GIRIH_OK) {
        return result;
    }
    return check_queues(get_instance_proc_addr, instance, physical_device, requirements.queue,
                        error);
}
