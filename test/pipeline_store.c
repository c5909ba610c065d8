#include "pipeline_store.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Bytes that tell what something was made of.
typedef struct description {
    unsigned char *bytes;
    size_t size, room;
} description;

typedef enum part_kind { SET_LAYOUT, PIPELINE_LAYOUT, MODULE } part_kind;

// A layout or module that is alive.
typedef struct part {
    part_kind kind;
    uint64_t handle;
    description made_of;
} part;

typedef struct entry {
    VkDevice device;
    VkPipeline pipeline;
    uint32_t users; // made and not destroyed
    description made_of;
} entry;

static part *parts;
static size_t part_count;
static entry *entries;
static size_t entry_count;

static void *grow(void *array, size_t bytes) {
    void *larger = realloc(array, bytes);
    if (!larger) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return larger;
}

static void describe(description *d, const void *bytes, size_t size) {
    if (size == 0) {
        return;
    }
    if (d->size + size > d->room) {
        d->room = 2 * (d->size + size);
        d->bytes = grow(d->bytes, d->room);
    }
    memcpy(d->bytes + d->size, bytes, size);
    d->size += size;
}

// With its size, so that no two sequences read the same.
static void describe_sized(description *d, const void *bytes, size_t size) {
    describe(d, &size, sizeof size);
    describe(d, bytes, size);
}

// Nothing may go into a pipeline that its description leaves out.
static void check_known(bool known) {
    if (!known) {
        fprintf(stderr, "the store does not know all that a pipeline is made of\n");
        exit(1);
    }
}

static void remember(part_kind kind, uint64_t handle, description made_of) {
    parts = grow(parts, (part_count + 1) * sizeof *parts);
    parts[part_count++] = (part){kind, handle, made_of};
}

static part *find(part_kind kind, uint64_t handle) {
    for (size_t n = 0; n < part_count; ++n) {
        if (parts[n].kind == kind && parts[n].handle == handle) {
            return &parts[n];
        }
    }
    return NULL;
}

static void forget(part_kind kind, uint64_t handle) {
    part *gone = find(kind, handle);
    if (gone) {
        free(gone->made_of.bytes);
        *gone = parts[--part_count];
    }
}

// What a part was made of, or, where it is the test's own, which one it is.
static void describe_part(description *d, part_kind kind, uint64_t handle) {
    const part *known = find(kind, handle);
    if (known) {
        describe_sized(d, known->made_of.bytes, known->made_of.size);
    } else {
        describe_sized(d, &handle, sizeof handle);
    }
}

VKAPI_ATTR VkResult VKAPI_CALL store_create_descriptor_set_layout(
    VkDevice device, const VkDescriptorSetLayoutCreateInfo *info,
    const VkAllocationCallbacks *allocator, VkDescriptorSetLayout *layout) {
    check_known(!info->pNext);
    const VkResult result = vkCreateDescriptorSetLayout(device, info, allocator, layout);
    if (result == VK_SUCCESS) {
        description d = {0};
        describe(&d, &info->flags, sizeof info->flags);
        for (uint32_t n = 0; n < info->bindingCount; ++n) {
            const VkDescriptorSetLayoutBinding *binding = &info->pBindings[n];
            check_known(!binding->pImmutableSamplers);
            const uint32_t words[] = {binding->binding, (uint32_t)binding->descriptorType,
                                      binding->descriptorCount, binding->stageFlags};
            describe(&d, words, sizeof words);
        }
        remember(SET_LAYOUT, (uint64_t)*layout, d);
    }
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL store_create_pipeline_layout(VkDevice device,
                                                            const VkPipelineLayoutCreateInfo *info,
                                                            const VkAllocationCallbacks *allocator,
                                                            VkPipelineLayout *layout) {
    check_known(!info->pNext && !info->flags);
    const VkResult result = vkCreatePipelineLayout(device, info, allocator, layout);
    if (result == VK_SUCCESS) {
        description d = {0};
        describe_sized(&d, info->pPushConstantRanges,
                       info->pushConstantRangeCount * sizeof *info->pPushConstantRanges);
        for (uint32_t n = 0; n < info->setLayoutCount; ++n) {
            describe_part(&d, SET_LAYOUT, (uint64_t)info->pSetLayouts[n]);
        }
        remember(PIPELINE_LAYOUT, (uint64_t)*layout, d);
    }
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL store_create_shader_module(VkDevice device,
                                                          const VkShaderModuleCreateInfo *info,
                                                          const VkAllocationCallbacks *allocator,
                                                          VkShaderModule *module) {
    const VkResult result = vkCreateShaderModule(device, info, allocator, module);
    if (result == VK_SUCCESS) {
        description d = {0};
        describe(&d, info->pCode, info->codeSize);
        remember(MODULE, (uint64_t)*module, d);
    }
    return result;
}

VKAPI_ATTR void VKAPI_CALL store_destroy_descriptor_set_layout(
    VkDevice device, VkDescriptorSetLayout layout, const VkAllocationCallbacks *allocator) {
    forget(SET_LAYOUT, (uint64_t)layout);
    vkDestroyDescriptorSetLayout(device, layout, allocator);
}

VKAPI_ATTR void VKAPI_CALL store_destroy_pipeline_layout(VkDevice device, VkPipelineLayout layout,
                                                         const VkAllocationCallbacks *allocator) {
    forget(PIPELINE_LAYOUT, (uint64_t)layout);
    vkDestroyPipelineLayout(device, layout, allocator);
}

VKAPI_ATTR void VKAPI_CALL store_destroy_shader_module(VkDevice device, VkShaderModule module,
                                                       const VkAllocationCallbacks *allocator) {
    forget(MODULE, (uint64_t)module);
    vkDestroyShaderModule(device, module, allocator);
}

static description describe_pipeline(const VkComputePipelineCreateInfo *info) {
    description d = {0};
    describe_part(&d, MODULE, (uint64_t)info->stage.module);
    describe_part(&d, PIPELINE_LAYOUT, (uint64_t)info->layout);
    describe_sized(&d, info->stage.pName, strlen(info->stage.pName));
    const VkSpecializationInfo *constants = info->stage.pSpecializationInfo;
    for (uint32_t n = 0; constants && n < constants->mapEntryCount; ++n) {
        const VkSpecializationMapEntry *place = &constants->pMapEntries[n];
        describe(&d, &place->constantID, sizeof place->constantID);
        describe_sized(&d, (const char *)constants->pData + place->offset, place->size);
    }
    return d;
}

static VkResult create_pipeline(VkDevice device, VkPipelineCache cache,
                                const VkComputePipelineCreateInfo *info, VkPipeline *pipeline) {
    check_known(!info->pNext && !info->stage.pNext && !info->flags && !info->stage.flags);
    description d = describe_pipeline(info);
    for (size_t n = 0; n < entry_count; ++n) {
        entry *there = &entries[n];
        if (there->device == device && there->made_of.size == d.size &&
            memcmp(there->made_of.bytes, d.bytes, d.size) == 0) {
            free(d.bytes);
            ++there->users;
            *pipeline = there->pipeline;
            return VK_SUCCESS;
        }
    }
    const VkResult result = vkCreateComputePipelines(device, cache, 1, info, NULL, pipeline);
    if (result == VK_SUCCESS) {
        entries = grow(entries, (entry_count + 1) * sizeof *entries);
        entries[entry_count++] =
            (entry){.device = device, .pipeline = *pipeline, .users = 1, .made_of = d};
    } else {
        free(d.bytes);
    }
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL
store_create_compute_pipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                               const VkComputePipelineCreateInfo *infos,
                               const VkAllocationCallbacks *allocator, VkPipeline *pipelines) {
    (void)allocator;
    VkResult result = VK_SUCCESS;
    for (uint32_t n = 0; n < count; ++n) {
        pipelines[n] = VK_NULL_HANDLE;
        const VkResult one = create_pipeline(device, cache, &infos[n], &pipelines[n]);
        result = one == VK_SUCCESS ? result : one;
    }
    return result;
}

VKAPI_ATTR void VKAPI_CALL store_destroy_pipeline(VkDevice device, VkPipeline pipeline,
                                                  const VkAllocationCallbacks *allocator) {
    for (size_t n = 0; n < entry_count; ++n) {
        entry *there = &entries[n];
        if (there->device == device && there->pipeline == pipeline) {
            if (there->users == 0) {
                fprintf(stderr, "a pipeline is destroyed twice\n");
                exit(1);
            }
            --there->users;
            return;
        }
    }
    vkDestroyPipeline(device, pipeline, allocator);
}

unsigned store_close(VkDevice device) {
    unsigned left = 0;
    size_t kept = 0;
    for (size_t n = 0; n < entry_count; ++n) {
        entry *there = &entries[n];
        if (there->device == device) {
            left += there->users;
            vkDestroyPipeline(device, there->pipeline, NULL);
            free(there->made_of.bytes);
        } else {
            entries[kept++] = *there;
        }
    }
    entry_count = kept;
    if (left) {
        fprintf(stderr, "%u pipelines were not destroyed\n", left);
    }
    return left;
}

#define STORE_ENTRY(NAME, FUNCTION)                                                                \
    { "vk" NAME, (PFN_vkVoidFunction)FUNCTION }

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device,
                                                                     const char *name) {
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } list[] = {
        STORE_ENTRY("CreateComputePipelines", store_create_compute_pipelines),
        STORE_ENTRY("CreateDescriptorSetLayout", store_create_descriptor_set_layout),
        STORE_ENTRY("CreatePipelineLayout", store_create_pipeline_layout),
        STORE_ENTRY("CreateShaderModule", store_create_shader_module),
        STORE_ENTRY("DestroyDescriptorSetLayout", store_destroy_descriptor_set_layout),
        STORE_ENTRY("DestroyPipeline", store_destroy_pipeline),
        STORE_ENTRY("DestroyPipelineLayout", store_destroy_pipeline_layout),
        STORE_ENTRY("DestroyShaderModule", store_destroy_shader_module),
    };
    for (size_t n = 0; n < sizeof list / sizeof *list; ++n) {
        if (strcmp(list[n].name, name) == 0) {
            return list[n].function;
        }
    }
    return vkGetDeviceProcAddr(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL store_get_instance_proc_addr(VkInstance instance,
                                                                      const char *name) {
    return strcmp(name, "vkGetDeviceProcAddr") == 0 ? (PFN_vkVoidFunction)get_device_proc_addr
                                                    : vkGetInstanceProcAddr(instance, name);
}
