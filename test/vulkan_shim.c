#include "vulkan_shim.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline_store.h"

typedef struct object {
    shim_kind kind;
    uint64_t handle;
    const VkAllocationCallbacks *callbacks;
    uint64_t size;            // bytes of a buffer or memory
    uint32_t storage_buffers; // of a descriptor set layout
    uint32_t uniform_buffers;
} object;

typedef struct fault {
    size_t left; // calls or allocations before it; SIZE_MAX: none
    const char *where;
} fault;

static struct {
    object *objects;
    size_t object_count, object_room;
    uint32_t made[SHIM_KINDS];
    uint32_t allocations;
    uint32_t without_callbacks, without_cache;
    uint32_t breaches;
    fault call, allocation;
    VkResult result;
    const char *current; // the call that the driver is in
    bool required_limits;
    bool share_pipelines;
} state = {.call = {.left = SIZE_MAX}, .allocation = {.left = SIZE_MAX}};

static const char *const kind_names[SHIM_KINDS] = {
    "buffer",   "descriptor pool", "descriptor set layout", "memory",
    "pipeline", "pipeline layout", "shader module",
};

const char *shim_kind_name(shim_kind kind) {
    return kind_names[kind];
}

// A handle that no object has: Vulkan leaves undefined what a failed call should have made.
#define NO_OBJECT ((uint64_t)0x5ca1ab1eu)

static void breach(const char *call, const char *what, uint64_t number) {
    ++state.breaches;
    fprintf(stderr, "breach: %s: %s (%llu)\n", call, what, (unsigned long long)number);
}

void shim_reset(void) {
    free(state.objects);
    memset(&state, 0, sizeof state);
    state.call.left = state.allocation.left = SIZE_MAX;
}

void shim_share_pipelines(bool on) {
    state.share_pipelines = on;
}

// --- Objects -------------------------------------------------------------------------------------

static VKAPI_ATTR void *VKAPI_CALL allocate(void *user, size_t size, size_t alignment,
                                            VkSystemAllocationScope scope);

static object *find(shim_kind kind, uint64_t handle) {
    for (size_t n = 0; n < state.object_count; ++n) {
        if (state.objects[n].kind == kind && state.objects[n].handle == handle) {
            return &state.objects[n];
        }
    }
    return NULL;
}

static object *add(const char *call, shim_kind kind, uint64_t handle,
                   const VkAllocationCallbacks *allocator) {
    if (state.object_count == state.object_room) {
        state.object_room = state.object_room ? 2 * state.object_room : 64;
        object *more = realloc(state.objects, state.object_room * sizeof *more);
        if (!more) {
            fprintf(stderr, "out of memory\n");
            exit(1);
        }
        state.objects = more;
    }
    if (handle == 0) {
        breach(call, "a call that succeeded made nothing", 0);
    }
    ++state.made[kind];
    state.without_callbacks += allocator == NULL || allocator->pfnAllocation != allocate;
    object *made = &state.objects[state.object_count++];
    *made = (object){.kind = kind, .handle = handle, .callbacks = allocator};
    return made;
}

// Returns whether there is something to destroy.
static bool take(const char *call, shim_kind kind, uint64_t handle,
                 const VkAllocationCallbacks *allocator) {
    if (handle == 0) {
        return false;
    }
    object *there = find(kind, handle);
    if (!there) {
        breach(call, "destroys what was not made, or twice", handle);
        return false;
    }
    if ((there->callbacks == NULL) != (allocator == NULL) ||
        (allocator && allocator->pfnFree != there->callbacks->pfnFree)) {
        breach(call, "other allocation callbacks than it was made with", handle);
    }
    *there = state.objects[--state.object_count];
    return true;
}

shim_counts shim_count(void) {
    shim_counts counts = {.allocations = state.allocations,
                          .without_callbacks = state.without_callbacks,
                          .without_cache = state.without_cache,
                          .breaches = state.breaches};
    memcpy(counts.made, state.made, sizeof counts.made);
    for (size_t n = 0; n < state.object_count; ++n) {
        const object *there = &state.objects[n];
        ++counts.alive[there->kind];
        counts.memory_bytes += there->kind == SHIM_MEMORY ? there->size : 0;
    }
    return counts;
}

// --- Faults --------------------------------------------------------------------------------------

void shim_fail_call(size_t nth, VkResult result) {
    state.call = (fault){.left = nth};
    state.result = result;
}

const char *shim_failed_call(void) {
    return state.call.where;
}

void shim_fail_allocation(size_t nth) {
    state.allocation = (fault){.left = nth};
}

const char *shim_failed_allocation(void) {
    return state.allocation.where;
}

static bool reached(fault *next, const char *where) {
    if (next->left == SIZE_MAX || next->left-- != 0) {
        return false;
    }
    *next = (fault){.left = SIZE_MAX, .where = where};
    return true;
}

// At the head of every call that can fail: whether it is to. Every such call may return the two
// results of memory and VK_ERROR_UNKNOWN; `also` is what this one may return beside them. None of
// those that girih makes may return VK_ERROR_DEVICE_LOST.
static bool fails(const char *call, VkResult also, VkResult *result) {
    state.current = call;
    *result = state.result;
    const bool may = state.result == VK_ERROR_OUT_OF_HOST_MEMORY ||
                     state.result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                     state.result == VK_ERROR_UNKNOWN || state.result == also;
    return may && reached(&state.call, call);
}

// --- Host allocations ----------------------------------------------------------------------------

#define MARK 0x67697269685f6d6bull

// Stands right before every allocation.
typedef struct header {
    uint64_t mark;
    void *base;
    size_t size;
    size_t alignment;
} header;

static VKAPI_ATTR void *VKAPI_CALL allocate(void *user, size_t size, size_t alignment,
                                            VkSystemAllocationScope scope) {
    (void)scope;
    const char *where = state.current ? state.current : "an unknown call";
    if (user != &state) {
        breach(where, "calls back with another pUserData", 0);
    }
    if (alignment == 0 || (alignment & (alignment - 1)) != 0) {
        breach(where, "asks for an alignment that is no power of two", alignment);
        alignment = 1;
    }
    if (size == 0 || reached(&state.allocation, where)) {
        return NULL;
    }
    const size_t step = alignment > sizeof(max_align_t) ? alignment : sizeof(max_align_t);
    char *base = malloc(sizeof(header) + step + size);
    if (!base) {
        return NULL;
    }
    const uintptr_t first = (uintptr_t)base + sizeof(header);
    const uintptr_t place = (first + step - 1) / step * step;
    header *head = (header *)(void *)(base + (place - (uintptr_t)base) - sizeof(header));
    *head = (header){.mark = MARK, .base = base, .size = size, .alignment = alignment};
    ++state.allocations;
    return base + (place - (uintptr_t)base);
}

static header *head_of(void *memory) {
    header *head = (header *)memory - 1;
    if (head->mark != MARK) {
        breach(state.current ? state.current : "an unknown call",
               "frees host memory that was not allocated, or twice", (uint64_t)(uintptr_t)memory);
        return NULL;
    }
    return head;
}

static VKAPI_ATTR void VKAPI_CALL release(void *user, void *memory) {
    header *head = memory ? head_of(memory) : NULL;
    if (user != &state) {
        breach("free", "calls back with another pUserData", 0);
    }
    if (head) {
        head->mark = 0;
        --state.allocations;
        free(head->base);
    }
}

static VKAPI_ATTR void *VKAPI_CALL reallocate(void *user, void *memory, size_t size,
                                              size_t alignment, VkSystemAllocationScope scope) {
    if (!memory) {
        return allocate(user, size, alignment, scope);
    }
    if (size == 0) {
        release(user, memory);
        return NULL;
    }
    const header *head = head_of(memory);
    void *larger = head ? allocate(user, size, alignment, scope) : NULL;
    if (larger) {
        memcpy(larger, memory, size < head->size ? size : head->size);
        release(user, memory);
    }
    return larger;
}

static const VkAllocationCallbacks callbacks = {.pUserData = &state,
                                                .pfnAllocation = allocate,
                                                .pfnReallocation = reallocate,
                                                .pfnFree = release};

const VkAllocationCallbacks *shim_callbacks(void) {
    return &callbacks;
}

// --- Limits --------------------------------------------------------------------------------------

// The table "Required Limits" of the Vulkan 1.1 specification, without optional features; of a
// descriptor set as for devices of all six stages. What the table leaves to the device is 0.
const VkPhysicalDeviceLimits shim_required_limits = {
    .maxImageDimension1D = 4096,
    .maxImageDimension2D = 4096,
    .maxImageDimension3D = 256,
    .maxImageDimensionCube = 4096,
    .maxImageArrayLayers = 256,
    .maxTexelBufferElements = 65536,
    .maxUniformBufferRange = 16384,
    .maxStorageBufferRange = 1u << 27,
    .maxPushConstantsSize = 128,
    .maxMemoryAllocationCount = 4096,
    .maxSamplerAllocationCount = 4000,
    .bufferImageGranularity = 131072,
    .maxBoundDescriptorSets = 4,
    .maxPerStageDescriptorSamplers = 16,
    .maxPerStageDescriptorUniformBuffers = 12,
    .maxPerStageDescriptorStorageBuffers = 4,
    .maxPerStageDescriptorSampledImages = 16,
    .maxPerStageDescriptorStorageImages = 4,
    .maxPerStageDescriptorInputAttachments = 4,
    .maxPerStageResources = 128,
    .maxDescriptorSetSamplers = 96,
    .maxDescriptorSetUniformBuffers = 72,
    .maxDescriptorSetUniformBuffersDynamic = 8,
    .maxDescriptorSetStorageBuffers = 24,
    .maxDescriptorSetStorageBuffersDynamic = 4,
    .maxDescriptorSetSampledImages = 96,
    .maxDescriptorSetStorageImages = 24,
    .maxDescriptorSetInputAttachments = 4,
    .maxVertexInputAttributes = 16,
    .maxVertexInputBindings = 16,
    .maxVertexInputAttributeOffset = 2047,
    .maxVertexInputBindingStride = 2048,
    .maxVertexOutputComponents = 64,
    .maxFragmentInputComponents = 64,
    .maxFragmentOutputAttachments = 4,
    .maxFragmentCombinedOutputResources = 4,
    .maxComputeSharedMemorySize = 16384,
    .maxComputeWorkGroupCount = {65535, 65535, 65535},
    .maxComputeWorkGroupInvocations = 128,
    .maxComputeWorkGroupSize = {128, 128, 64},
    .subPixelPrecisionBits = 4,
    .subTexelPrecisionBits = 4,
    .mipmapPrecisionBits = 4,
    .maxDrawIndexedIndexValue = (1u << 24) - 1,
    .maxDrawIndirectCount = 1,
    .maxSamplerLodBias = 2,
    .maxSamplerAnisotropy = 1,
    .maxViewports = 1,
    .maxViewportDimensions = {4096, 4096},
    .viewportBoundsRange = {-8192, 8191},
    .minMemoryMapAlignment = 64,
    .minTexelBufferOffsetAlignment = 256,
    .minUniformBufferOffsetAlignment = 256,
    .minStorageBufferOffsetAlignment = 256,
    .minTexelOffset = -8,
    .maxTexelOffset = 7,
    .maxFramebufferWidth = 4096,
    .maxFramebufferHeight = 4096,
    .maxFramebufferLayers = 256,
    .framebufferColorSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .framebufferDepthSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .framebufferStencilSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .framebufferNoAttachmentsSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .maxColorAttachments = 4,
    .sampledImageColorSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .sampledImageIntegerSampleCounts = VK_SAMPLE_COUNT_1_BIT,
    .sampledImageDepthSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .sampledImageStencilSampleCounts = VK_SAMPLE_COUNT_1_BIT | VK_SAMPLE_COUNT_4_BIT,
    .storageImageSampleCounts = VK_SAMPLE_COUNT_1_BIT,
    .maxSampleMaskWords = 1,
    .timestampPeriod = 1,
    .discreteQueuePriorities = 2,
    .pointSizeRange = {1, 1},
    .lineWidthRange = {1, 1},
    .optimalBufferCopyOffsetAlignment = 256,
    .optimalBufferCopyRowPitchAlignment = 256,
    .nonCoherentAtomSize = 256,
};

void shim_report_required_limits(bool on) {
    state.required_limits = on;
}

static void lower(VkPhysicalDeviceProperties *properties) {
    properties->apiVersion = VK_API_VERSION_1_1;
    properties->limits = shim_required_limits;
    properties->sparseProperties = (VkPhysicalDeviceSparseProperties){VK_FALSE};
}

static VKAPI_ATTR void VKAPI_CALL get_properties(VkPhysicalDevice device,
                                                 VkPhysicalDeviceProperties *properties) {
    vkGetPhysicalDeviceProperties(device, properties);
    if (state.required_limits) {
        lower(properties);
    }
}

static VKAPI_ATTR void VKAPI_CALL get_properties2(VkPhysicalDevice device,
                                                  VkPhysicalDeviceProperties2 *properties) {
    vkGetPhysicalDeviceProperties2(device, properties);
    if (!state.required_limits) {
        return;
    }
    lower(&properties->properties);
    for (VkBaseOutStructure *next = properties->pNext; next; next = next->pNext) {
        if (next->sType != VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES) {
            fprintf(stderr, "the shim does not know what structure %d must report\n",
                    (int)next->sType);
            exit(1);
        }
        VkPhysicalDeviceMaintenance3Properties *maintenance = (void *)next;
        maintenance->maxPerSetDescriptors = 1024;
        maintenance->maxMemoryAllocationSize = SHIM_REQUIRED_ALLOCATION;
    }
}

static VKAPI_ATTR void VKAPI_CALL get_features(VkPhysicalDevice device,
                                               VkPhysicalDeviceFeatures *features) {
    vkGetPhysicalDeviceFeatures(device, features);
    if (state.required_limits) {
        *features = (VkPhysicalDeviceFeatures){.robustBufferAccess = VK_TRUE};
    }
}

static VKAPI_ATTR void VKAPI_CALL get_features2(VkPhysicalDevice device,
                                                VkPhysicalDeviceFeatures2 *features) {
    vkGetPhysicalDeviceFeatures2(device, features);
    if (state.required_limits) {
        if (features->pNext) {
            fprintf(stderr, "the shim does not know what further features must report\n");
            exit(1);
        }
        features->features = (VkPhysicalDeviceFeatures){.robustBufferAccess = VK_TRUE};
    }
}

static void at_most(const char *call, const char *what, uint64_t number, uint64_t most) {
    if (state.required_limits && number > most) {
        breach(call, what, number);
    }
}

// --- Shader modules: workgroups and shared memory ------------------------------------------------

enum {
    SPIRV_EXECUTION_MODE = 16,
    SPIRV_TYPE_INT = 21,
    SPIRV_TYPE_FLOAT = 22,
    SPIRV_TYPE_VECTOR = 23,
    SPIRV_TYPE_ARRAY = 28,
    SPIRV_TYPE_POINTER = 32,
    SPIRV_CONSTANT = 43,
    SPIRV_SPEC_CONSTANT = 50,
    SPIRV_VARIABLE = 59,
    SPIRV_LOCAL_SIZE = 17,
    SPIRV_WORKGROUP = 4,
};

// Bytes of the types, and values of the constants, that the modules' workgroup variables are made
// of, by id.
static void check_shader(const VkShaderModuleCreateInfo *info) {
    const char *call = "vkCreateShaderModule";
    const uint32_t *words = info->pCode;
    const size_t count = info->codeSize / 4;
    const uint32_t bound = words[3];
    uint64_t *values = calloc(bound, sizeof *values);
    if (!values) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    uint64_t shared = 0;
    for (size_t n = 5; n < count && words[n] >> 16; n += words[n] >> 16) {
        const uint32_t *operand = words + n + 1;
        switch (words[n] & 0xffffu) {
        case SPIRV_EXECUTION_MODE:
            if (operand[1] == SPIRV_LOCAL_SIZE) {
                const VkPhysicalDeviceLimits *most = &shim_required_limits;
                at_most(call, "invocations", (uint64_t)operand[2] * operand[3] * operand[4],
                        most->maxComputeWorkGroupInvocations);
                for (int axis = 0; axis < 3; ++axis) {
                    at_most(call, "workgroup size", operand[2 + axis],
                            most->maxComputeWorkGroupSize[axis]);
                }
            }
            break;
        case SPIRV_TYPE_INT:
        case SPIRV_TYPE_FLOAT:
            values[operand[0]] = operand[1] / 8;
            break;
        case SPIRV_CONSTANT:
        case SPIRV_SPEC_CONSTANT:
            values[operand[1]] = operand[2];
            break;
        case SPIRV_TYPE_VECTOR:
            values[operand[0]] = values[operand[1]] * operand[2];
            break;
        case SPIRV_TYPE_ARRAY:
            values[operand[0]] = values[operand[1]] * values[operand[2]];
            break;
        case SPIRV_TYPE_POINTER:
            values[operand[0]] = values[operand[2]];
            break;
        case SPIRV_VARIABLE:
            if (operand[2] == SPIRV_WORKGROUP) {
                if (values[operand[0]] == 0) {
                    breach(call, "shared memory of a type the shim does not know", operand[0]);
                }
                shared += values[operand[0]];
            }
            break;
        default:
            break;
        }
    }
    at_most(call, "bytes of shared memory", shared,
            shim_required_limits.maxComputeSharedMemorySize);
    free(values);
}

// --- Calls ---------------------------------------------------------------------------------------

#define SHIM_FAIL(CALL, ALSO, OUT)                                                                 \
    VkResult result;                                                                               \
    if (fails(CALL, ALSO, &result)) {                                                              \
        const uint64_t nothing = NO_OBJECT;                                                        \
        memcpy(OUT, &nothing, sizeof *(OUT));                                                      \
        return result;                                                                             \
    }

// CALL is made through PASS_ON.
#define SHIM_DESTROY(FUNCTION, CALL, PASS_ON, KIND, TYPE)                                          \
    static VKAPI_ATTR void VKAPI_CALL FUNCTION(VkDevice device, TYPE handle,                       \
                                               const VkAllocationCallbacks *allocator) {           \
        if (take(#CALL, KIND, (uint64_t)handle, allocator)) {                                      \
            state.current = #CALL;                                                                 \
            PASS_ON(device, handle, allocator);                                                    \
        }                                                                                          \
    }
SHIM_DESTROY(destroy_buffer, vkDestroyBuffer, vkDestroyBuffer, SHIM_BUFFER, VkBuffer)
SHIM_DESTROY(destroy_descriptor_pool, vkDestroyDescriptorPool, vkDestroyDescriptorPool,
             SHIM_DESCRIPTOR_POOL, VkDescriptorPool)
SHIM_DESTROY(destroy_descriptor_set_layout, vkDestroyDescriptorSetLayout,
             store_destroy_descriptor_set_layout, SHIM_DESCRIPTOR_SET_LAYOUT,
             VkDescriptorSetLayout)
SHIM_DESTROY(destroy_pipeline, vkDestroyPipeline, store_destroy_pipeline, SHIM_PIPELINE, VkPipeline)
SHIM_DESTROY(destroy_pipeline_layout, vkDestroyPipelineLayout, store_destroy_pipeline_layout,
             SHIM_PIPELINE_LAYOUT, VkPipelineLayout)
SHIM_DESTROY(destroy_shader_module, vkDestroyShaderModule, store_destroy_shader_module,
             SHIM_SHADER_MODULE, VkShaderModule)
SHIM_DESTROY(free_memory, vkFreeMemory, vkFreeMemory, SHIM_MEMORY, VkDeviceMemory)

static VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo *info,
                                                    const VkAllocationCallbacks *allocator,
                                                    VkBuffer *buffer) {
    SHIM_FAIL("vkCreateBuffer", VK_ERROR_UNKNOWN, buffer)
    result = vkCreateBuffer(device, info, allocator, buffer);
    if (result == VK_SUCCESS) {
        add("vkCreateBuffer", SHIM_BUFFER, (uint64_t)*buffer, allocator)->size = info->size;
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_descriptor_pool(VkDevice device,
                                                             const VkDescriptorPoolCreateInfo *info,
                                                             const VkAllocationCallbacks *allocator,
                                                             VkDescriptorPool *pool) {
    SHIM_FAIL("vkCreateDescriptorPool", VK_ERROR_FRAGMENTATION, pool)
    result = vkCreateDescriptorPool(device, info, allocator, pool);
    if (result == VK_SUCCESS) {
        add("vkCreateDescriptorPool", SHIM_DESCRIPTOR_POOL, (uint64_t)*pool, allocator);
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_descriptor_set_layout(
    VkDevice device, const VkDescriptorSetLayoutCreateInfo *info,
    const VkAllocationCallbacks *allocator, VkDescriptorSetLayout *layout) {
    const char *call = "vkCreateDescriptorSetLayout";
    SHIM_FAIL(call, VK_ERROR_UNKNOWN, layout)
    uint32_t storage = 0;
    uint32_t uniform = 0;
    for (uint32_t n = 0; n < info->bindingCount; ++n) {
        const VkDescriptorSetLayoutBinding *binding = &info->pBindings[n];
        storage += binding->descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                       ? binding->descriptorCount
                       : 0;
        uniform += binding->descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                       ? binding->descriptorCount
                       : 0;
        if (binding->descriptorType != VK_DESCRIPTOR_TYPE_STORAGE_BUFFER &&
            binding->descriptorType != VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER) {
            breach(call, "a descriptor type that the shim does not count", n);
        }
    }
    at_most(call, "storage buffers a stage", storage,
            shim_required_limits.maxPerStageDescriptorStorageBuffers);
    result = store_create_descriptor_set_layout(device, info, allocator, layout);
    if (result == VK_SUCCESS) {
        object *made = add(call, SHIM_DESCRIPTOR_SET_LAYOUT, (uint64_t)*layout, allocator);
        made->storage_buffers = storage;
        made->uniform_buffers = uniform;
    }
    return result;
}

// Layouts of the host's are not known here and count as empty.
static VKAPI_ATTR VkResult VKAPI_CALL create_pipeline_layout(VkDevice device,
                                                             const VkPipelineLayoutCreateInfo *info,
                                                             const VkAllocationCallbacks *allocator,
                                                             VkPipelineLayout *layout) {
    const char *call = "vkCreatePipelineLayout";
    SHIM_FAIL(call, VK_ERROR_UNKNOWN, layout)
    const VkPhysicalDeviceLimits *most = &shim_required_limits;
    uint32_t storage = 0;
    uint32_t uniform = 0;
    for (uint32_t n = 0; n < info->setLayoutCount; ++n) {
        const object *set = find(SHIM_DESCRIPTOR_SET_LAYOUT, (uint64_t)info->pSetLayouts[n]);
        storage += set ? set->storage_buffers : 0;
        uniform += set ? set->uniform_buffers : 0;
    }
    at_most(call, "storage buffers a stage", storage, most->maxPerStageDescriptorStorageBuffers);
    at_most(call, "uniform buffers a stage", uniform, most->maxPerStageDescriptorUniformBuffers);
    at_most(call, "descriptor sets", info->setLayoutCount, most->maxBoundDescriptorSets);
    for (uint32_t n = 0; n < info->pushConstantRangeCount; ++n) {
        const VkPushConstantRange *range = &info->pPushConstantRanges[n];
        at_most(call, "bytes of push constants", (uint64_t)range->offset + range->size,
                most->maxPushConstantsSize);
    }
    result = store_create_pipeline_layout(device, info, allocator, layout);
    if (result == VK_SUCCESS) {
        add(call, SHIM_PIPELINE_LAYOUT, (uint64_t)*layout, allocator);
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_shader_module(VkDevice device,
                                                           const VkShaderModuleCreateInfo *info,
                                                           const VkAllocationCallbacks *allocator,
                                                           VkShaderModule *module) {
    SHIM_FAIL("vkCreateShaderModule", VK_ERROR_UNKNOWN, module)
    check_shader(info);
    result = store_create_shader_module(device, info, allocator, module);
    if (result == VK_SUCCESS) {
        add("vkCreateShaderModule", SHIM_SHADER_MODULE, (uint64_t)*module, allocator);
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL
create_compute_pipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                         const VkComputePipelineCreateInfo *infos,
                         const VkAllocationCallbacks *allocator, VkPipeline *pipelines) {
    VkResult result;
    if (fails("vkCreateComputePipelines", VK_ERROR_UNKNOWN, &result)) {
        for (uint32_t n = 0; n < count; ++n) {
            pipelines[n] = VK_NULL_HANDLE; // as Vulkan says of pipelines that are not made
        }
        return result;
    }
    result = state.share_pipelines
                 ? store_create_compute_pipelines(device, cache, count, infos, allocator, pipelines)
                 : vkCreateComputePipelines(device, cache, count, infos, allocator, pipelines);
    for (uint32_t n = 0; n < count; ++n) {
        if (pipelines[n]) {
            state.without_cache += cache == VK_NULL_HANDLE;
            add("vkCreateComputePipelines", SHIM_PIPELINE, (uint64_t)pipelines[n], allocator);
        }
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_descriptor_sets(
    VkDevice device, const VkDescriptorSetAllocateInfo *info, VkDescriptorSet *sets) {
    const char *call = "vkAllocateDescriptorSets";
    VkResult result;
    if (fails(call,
              state.result == VK_ERROR_FRAGMENTED_POOL ? VK_ERROR_FRAGMENTED_POOL
                                                       : VK_ERROR_OUT_OF_POOL_MEMORY,
              &result)) {
        for (uint32_t n = 0; n < info->descriptorSetCount; ++n) {
            sets[n] = VK_NULL_HANDLE; // as Vulkan says of descriptor sets
        }
        return result;
    }
    return vkAllocateDescriptorSets(device, info, sets);
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device,
                                                      const VkMemoryAllocateInfo *info,
                                                      const VkAllocationCallbacks *allocator,
                                                      VkDeviceMemory *memory) {
    const char *call = "vkAllocateMemory";
    SHIM_FAIL(call, VK_ERROR_TOO_MANY_OBJECTS, memory)
    at_most(call, "bytes at once", info->allocationSize, SHIM_REQUIRED_ALLOCATION);
    result = vkAllocateMemory(device, info, allocator, memory);
    if (result == VK_SUCCESS) {
        add(call, SHIM_MEMORY, (uint64_t)*memory, allocator)->size = info->allocationSize;
        at_most(call, "allocations", shim_count().alive[SHIM_MEMORY],
                shim_required_limits.maxMemoryAllocationCount);
    }
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL bind_buffer_memory(VkDevice device, VkBuffer buffer,
                                                         VkDeviceMemory memory,
                                                         VkDeviceSize offset) {
    VkResult result;
    return fails("vkBindBufferMemory", VK_ERROR_UNKNOWN, &result)
               ? result
               : vkBindBufferMemory(device, buffer, memory, offset);
}

static VKAPI_ATTR VkResult VKAPI_CALL map_memory(VkDevice device, VkDeviceMemory memory,
                                                 VkDeviceSize offset, VkDeviceSize size,
                                                 VkMemoryMapFlags flags, void **mapped) {
    SHIM_FAIL("vkMapMemory", VK_ERROR_MEMORY_MAP_FAILED, mapped)
    return vkMapMemory(device, memory, offset, size, flags, mapped);
}

// --- Calls that cannot fail, within the limits ---------------------------------------------------

static VKAPI_ATTR void VKAPI_CALL update_descriptor_sets(VkDevice device, uint32_t write_count,
                                                         const VkWriteDescriptorSet *writes,
                                                         uint32_t copy_count,
                                                         const VkCopyDescriptorSet *copies) {
    const char *call = "vkUpdateDescriptorSets";
    const VkPhysicalDeviceLimits *limits = &shim_required_limits;
    for (uint32_t n = 0; n < write_count && state.required_limits; ++n) {
        const bool storage = writes[n].descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        for (uint32_t k = 0; k < writes[n].descriptorCount; ++k) {
            const VkDescriptorBufferInfo *info = &writes[n].pBufferInfo[k];
            const object *buffer = find(SHIM_BUFFER, (uint64_t)info->buffer);
            const uint64_t whole = buffer ? buffer->size - info->offset : 0;
            at_most(call, "bytes in a descriptor",
                    info->range == VK_WHOLE_SIZE ? whole : info->range,
                    storage ? limits->maxStorageBufferRange : limits->maxUniformBufferRange);
            const VkDeviceSize alignment = storage ? limits->minStorageBufferOffsetAlignment
                                                   : limits->minUniformBufferOffsetAlignment;
            if (info->offset % alignment) {
                breach(call, "an offset that not every device takes", info->offset);
            }
        }
    }
    vkUpdateDescriptorSets(device, write_count, writes, copy_count, copies);
}

static VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer commands, uint32_t x, uint32_t y,
                                           uint32_t z) {
    const uint32_t *most = shim_required_limits.maxComputeWorkGroupCount;
    at_most("vkCmdDispatch", "workgroups along x", x, most[0]);
    at_most("vkCmdDispatch", "workgroups along y", y, most[1]);
    at_most("vkCmdDispatch", "workgroups along z", z, most[2]);
    vkCmdDispatch(commands, x, y, z);
}

static VKAPI_ATTR void VKAPI_CALL draw_indexed_indirect(VkCommandBuffer commands, VkBuffer buffer,
                                                        VkDeviceSize offset, uint32_t count,
                                                        uint32_t stride) {
    at_most("vkCmdDrawIndexedIndirect", "draws at once", count,
            shim_required_limits.maxDrawIndirectCount);
    vkCmdDrawIndexedIndirect(commands, buffer, offset, count, stride);
}

// --- The table -----------------------------------------------------------------------------------

typedef struct replacement {
    const char *name;
    PFN_vkVoidFunction function;
} replacement;

static PFN_vkVoidFunction lookup(const replacement *list, size_t count, const char *name) {
    for (size_t n = 0; n < count; ++n) {
        if (strcmp(list[n].name, name) == 0) {
            return list[n].function;
        }
    }
    return NULL;
}

#define SHIM_ENTRY(NAME, FUNCTION)                                                                 \
    { "vk" NAME, (PFN_vkVoidFunction)FUNCTION }

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device,
                                                                     const char *name) {
    const replacement list[] = {
        SHIM_ENTRY("AllocateDescriptorSets", allocate_descriptor_sets),
        SHIM_ENTRY("AllocateMemory", allocate_memory),
        SHIM_ENTRY("BindBufferMemory", bind_buffer_memory),
        SHIM_ENTRY("CmdDispatch", dispatch),
        SHIM_ENTRY("CmdDrawIndexedIndirect", draw_indexed_indirect),
        SHIM_ENTRY("CreateBuffer", create_buffer),
        SHIM_ENTRY("CreateComputePipelines", create_compute_pipelines),
        SHIM_ENTRY("CreateDescriptorPool", create_descriptor_pool),
        SHIM_ENTRY("CreateDescriptorSetLayout", create_descriptor_set_layout),
        SHIM_ENTRY("CreatePipelineLayout", create_pipeline_layout),
        SHIM_ENTRY("CreateShaderModule", create_shader_module),
        SHIM_ENTRY("DestroyBuffer", destroy_buffer),
        SHIM_ENTRY("DestroyDescriptorPool", destroy_descriptor_pool),
        SHIM_ENTRY("DestroyDescriptorSetLayout", destroy_descriptor_set_layout),
        SHIM_ENTRY("DestroyPipeline", destroy_pipeline),
        SHIM_ENTRY("DestroyPipelineLayout", destroy_pipeline_layout),
        SHIM_ENTRY("DestroyShaderModule", destroy_shader_module),
        SHIM_ENTRY("FreeMemory", free_memory),
        SHIM_ENTRY("GetDeviceProcAddr", get_device_proc_addr),
        SHIM_ENTRY("MapMemory", map_memory),
        SHIM_ENTRY("UpdateDescriptorSets", update_descriptor_sets),
    };
    const PFN_vkVoidFunction own = lookup(list, sizeof list / sizeof *list, name);
    if (!own && strncmp(name, "vkCmd", 5) != 0 && strncmp(name, "vkGet", 5) != 0) {
        fprintf(stderr, "the shim does not know %s\n", name);
        exit(1);
    }
    return own ? own : vkGetDeviceProcAddr(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL shim_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name) {
    const replacement list[] = {
        SHIM_ENTRY("GetDeviceProcAddr", get_device_proc_addr),
        SHIM_ENTRY("GetInstanceProcAddr", shim_get_instance_proc_addr),
        SHIM_ENTRY("GetPhysicalDeviceFeatures", get_features),
        SHIM_ENTRY("GetPhysicalDeviceFeatures2", get_features2),
        SHIM_ENTRY("GetPhysicalDeviceProperties", get_properties),
        SHIM_ENTRY("GetPhysicalDeviceProperties2", get_properties2),
        SHIM_ENTRY("GetPhysicalDeviceMemoryProperties", vkGetPhysicalDeviceMemoryProperties),
        SHIM_ENTRY("GetPhysicalDeviceQueueFamilyProperties",
                   vkGetPhysicalDeviceQueueFamilyProperties),
    };
    const PFN_vkVoidFunction own = lookup(list, sizeof list / sizeof *list, name);
    if (!own) {
        fprintf(stderr, "the shim does not know %s\n", name);
        exit(1);
    }
    (void)instance;
    return own;
}
