#include "context.h"

#include <string.h>

#include "error.h"
#include "memory.h"

girih_requirements girih_get_requirements(void) {
    return (girih_requirements){
        .api_version = VK_API_VERSION_1_1,
        .optional = {.multiDrawIndirect = VK_TRUE,
                     .drawIndirectFirstInstance = VK_TRUE,
                     .fullDrawIndexUint32 = VK_TRUE},
        .queue = VK_QUEUE_COMPUTE_BIT,
    };
}

static girih_result load_functions(girih_context *context, const girih_context_desc *desc,
                                   girih_error *error) {
#define GIRIH_LOAD(NAME)                                                                           \
    context->vk.NAME = (PFN_vk##NAME)desc->get_instance_proc_addr(desc->instance, "vk" #NAME);     \
    if (!context->vk.NAME) {                                                                       \
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,                                          \
                          "vk" #NAME " is missing; girih needs Vulkan 1.1");                       \
    }
    GIRIH_INSTANCE_FUNCTIONS(GIRIH_LOAD)
#undef GIRIH_LOAD
#define GIRIH_LOAD(NAME)                                                                           \
    context->vk.NAME = (PFN_vk##NAME)context->vk.GetDeviceProcAddr(desc->device, "vk" #NAME);      \
    if (!context->vk.NAME) {                                                                       \
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,                                          \
                          "vk" #NAME " is missing; girih needs Vulkan 1.1");                       \
    }
    GIRIH_DEVICE_FUNCTIONS(GIRIH_LOAD)
#undef GIRIH_LOAD
    return GIRIH_OK;
}

static void read_limits(girih_context *context, const girih_context_desc *desc) {
    VkPhysicalDeviceMaintenance3Properties maintenance = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &maintenance};
    context->vk.GetPhysicalDeviceProperties2(context->physical_device, &properties);
    context->vk.GetPhysicalDeviceMemoryProperties(context->physical_device, &context->memory);
    context->limits = properties.properties.limits;
    context->max_allocation = maintenance.maxMemoryAllocationSize;
    context->serial_sort = desc->sort == GIRIH_SORT_SERIAL ||
                           (desc->sort == GIRIH_SORT_AUTO &&
                            properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU);
    // Every binding but the frame is a storage buffer.
    context->few_buffers =
        desc->few_buffers ||
        context->limits.maxPerStageDescriptorStorageBuffers < GIRIH_BIND_COUNT - 1;
}

static girih_result create_layouts(girih_context *context, girih_error *error) {
    const girih_functions *vk = &context->vk;
    VkDescriptorSetLayoutBinding bindings[GIRIH_BIND_COUNT];
    uint32_t count = 0;
    for (uint32_t n = 0; n < GIRIH_BIND_COUNT; ++n) {
        const bool kept = !context->few_buffers || n == GIRIH_BIND_FRAME ||
                          n == GIRIH_BIND_SHARED_SCENE || n == GIRIH_BIND_SHARED_PLAN ||
                          n == GIRIH_BIND_OUT_POSITIONS || n == GIRIH_BIND_OUT_ATTRIBUTES;
        if (kept) {
            bindings[count++] = (VkDescriptorSetLayoutBinding){
                .binding = n,
                .descriptorType = n == GIRIH_BIND_FRAME ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                        : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                .descriptorCount = 1,
                .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
        }
    }
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = count,
                                            .pBindings = bindings};
    VkResult result = vk->CreateDescriptorSetLayout(context->device, &info, context->callbacks,
                                                    &context->set_layout);
    if (result == VK_SUCCESS) {
        const VkDescriptorSetLayoutBinding attributes = {.descriptorType =
                                                             VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                         .descriptorCount = 1,
                                                         .stageFlags = VK_SHADER_STAGE_VERTEX_BIT};
        info.bindingCount = 1;
        info.pBindings = &attributes;
        result = vk->CreateDescriptorSetLayout(context->device, &info, context->callbacks,
                                               &context->draw_set_layout);
    }
    if (result == VK_SUCCESS) {
        const VkPushConstantRange push = {.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
                                          .size = sizeof(girih_push_block)};
        const VkPipelineLayoutCreateInfo layout = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
            .setLayoutCount = 1,
            .pSetLayouts = &context->set_layout,
            .pushConstantRangeCount = 1,
            .pPushConstantRanges = &push};
        result = vk->CreatePipelineLayout(context->device, &layout, context->callbacks,
                                          &context->pipeline_layout);
    }
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failed(error, "creating layouts", "context", result);
}

static girih_result create_buffers(girih_context *context, const girih_catalogue *catalogue,
                                   girih_error *error) {
    girih_result result = girih_pack_catalogue(&context->catalogue, catalogue, error);
    if (result != GIRIH_OK) {
        return result;
    }
    girih_arrays *arrays = &context->catalogue;
    VkDeviceSize patterns_size = 0;
    VkDeviceSize indices_size = 0;
    girih_layout_arrays(arrays, GIRIH_BIND_PATTERNS, GIRIH_BIND_PATTERN_INDICES, context->offset,
                        &patterns_size);
    girih_layout_arrays(arrays, GIRIH_BIND_PATTERN_INDICES, GIRIH_BIND_PATTERN_INDICES + 1,
                        context->offset, &indices_size);
    result =
        girih_check_ranges(context, arrays, GIRIH_BIND_PATTERNS, GIRIH_BIND_PATTERN_INDICES + 1,
                           patterns_size + indices_size, "catalogue", error);
    const VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (result == GIRIH_OK) {
        result =
            girih_buffer_create(context, patterns_size, usage | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT,
                                false, "catalogue", &context->patterns, error);
    }
    if (result == GIRIH_OK) {
        result =
            girih_buffer_create(context, indices_size, usage | VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
                                false, "catalogue", &context->indices, error);
    }
    if (result == GIRIH_OK) {
        result = girih_buffer_create(context, patterns_size + indices_size,
                                     VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, "catalogue",
                                     &context->staging, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    char *staging = context->staging.mapped;
    for (uint32_t n = GIRIH_BIND_PATTERNS; n <= GIRIH_BIND_PATTERN_INDICES; ++n) {
        const VkDeviceSize base = n == GIRIH_BIND_PATTERN_INDICES ? patterns_size : 0;
        memcpy(staging + base + context->offset[n], arrays->words[n], arrays->count[n] * 4);
    }
    if (!context->few_buffers) {
        girih_arrays_free(arrays, GIRIH_BIND_PATTERNS, GIRIH_BIND_PATTERN_INDICES + 1);
    }
    return GIRIH_OK;
}

girih_result girih_context_create(const girih_context_desc *desc, girih_context **out,
                                  girih_error *error) {
    if (!desc || !out || !desc->get_instance_proc_addr || !desc->instance ||
        !desc->physical_device || !desc->device) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_context_create: get_instance_proc_addr, instance, physical_device "
                          "and device must be set");
    }
    girih_context *context = girih_allocate(sizeof *context);
    if (!context) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "context: out of memory");
    }
    *context = (girih_context){.physical_device = desc->physical_device,
                               .device = desc->device,
                               .callbacks = desc->allocation_callbacks,
                               .pipeline_cache = desc->pipeline_cache,
                               .surfaces = desc->surfaces ? desc->surfaces : UINT32_MAX};
    if (desc->enabled_features) {
        context->features = *desc->enabled_features;
    }
    girih_result result = load_functions(context, desc, error);
    if (result != GIRIH_OK) {
        girih_free(context); // nothing else exists, and nothing could destroy it
        return result;
    }
    read_limits(context, desc);
    result = create_layouts(context, error);
    if (result == GIRIH_OK) {
        result = create_buffers(
            context, desc->catalogue ? desc->catalogue : girih_catalogue_dyadic(), error);
    }
    if (result != GIRIH_OK) {
        girih_context_destroy(context);
        return result;
    }
    *out = context;
    return GIRIH_OK;
}

void girih_cmd_upload_context(const girih_context *context, VkCommandBuffer commands) {
    const VkBufferCopy patterns = {.size = context->patterns.size};
    const VkBufferCopy indices = {.srcOffset = context->patterns.size,
                                  .size = context->indices.size};
    context->vk.CmdCopyBuffer(commands, context->staging.buffer, context->patterns.buffer, 1,
                              &patterns);
    context->vk.CmdCopyBuffer(commands, context->staging.buffer, context->indices.buffer, 1,
                              &indices);
    girih_barrier(context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT |
                      VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT |
                      VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
}

void girih_context_destroy(girih_context *context) {
    if (!context) {
        return;
    }
    const girih_functions *vk = &context->vk;
    for (uint32_t n = 0; n < GIRIH_SHADER_COUNT; ++n) {
        for (uint32_t slot = 0; slot < GIRIH_MAX_VARIANTS; ++slot) {
            vk->DestroyPipeline(context->device, context->pipelines[n][slot], context->callbacks);
        }
    }
    vk->DestroyPipelineLayout(context->device, context->pipeline_layout, context->callbacks);
    vk->DestroyDescriptorSetLayout(context->device, context->draw_set_layout, context->callbacks);
    vk->DestroyDescriptorSetLayout(context->device, context->set_layout, context->callbacks);
    girih_buffer_destroy(context, &context->staging);
    girih_buffer_destroy(context, &context->indices);
    girih_buffer_destroy(context, &context->patterns);
    girih_arrays_free(&context->catalogue, 0, GIRIH_BIND_COUNT);
    girih_free(context);
}

VkDescriptorSetLayout girih_context_draw_set_layout(const girih_context *context) {
    return context->draw_set_layout;
}
