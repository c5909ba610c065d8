// Context: layouts, the catalogue on the device, and the host's functions.
#include "context.h"

#include <string.h>

#include "error.h"
#include "memory.h"

// What hosts declare their push constant ranges with.
_Static_assert(sizeof(girih_push_block) == GIRIH_PUSH_CONSTANT_BYTES, "GIRIH_PUSH_CONSTANT_BYTES");

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
    // Without the feature indices reach no further, whatever the limit says of the device.
    if (!context->features.fullDrawIndexUint32) {
        context->limits.maxDrawIndexedIndexValue =
            girih_get_requirements().required.maxDrawIndexedIndexValue;
    }
    context->max_allocation = maintenance.maxMemoryAllocationSize;
    context->is_cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    context->serial_sort = desc->sort == GIRIH_SORT_SERIAL ||
                           (desc->sort == GIRIH_SORT_AUTO && context->is_cpu);
    // Every binding but the frame is a storage buffer.
    const VkPhysicalDeviceLimits *limits = &context->limits;
    context->few_buffers = desc->few_buffers ||
                           limits->maxPerStageDescriptorStorageBuffers < GIRIH_BIND_COUNT - 1 ||
                           limits->maxDescriptorSetStorageBuffers < GIRIH_BIND_COUNT - 1 ||
                           limits->maxPerStageResources < GIRIH_BIND_COUNT;
}

// The stages that share girih's push constants, from the host's ranges.
static girih_result find_push_stages(girih_placement *placement, girih_error *error) {
    const uint32_t first = placement->push_offset;
    const uint32_t end = first + GIRIH_PUSH_CONSTANT_BYTES;
    for (uint32_t n = 0; n < placement->range_count; ++n) {
        const VkPushConstantRange *range = &placement->ranges[n];
        const uint64_t range_end = (uint64_t)range->offset + range->size;
        if (range->offset >= end || range_end <= first) {
            continue;
        }
        // vkCmdPushConstants must name every stage of the bytes it writes, and each of these must
        // have all of the bytes.
        if (range->offset > first || range_end < end) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "context: push_constant_ranges[%u] covers girih's %u bytes from "
                              "push_constant_offset %u on only in part; let it cover them all or "
                              "none",
                              n, GIRIH_PUSH_CONSTANT_BYTES, first);
        }
        placement->push_stages |= range->stageFlags;
    }
    if (!(placement->push_stages & VK_SHADER_STAGE_COMPUTE_BIT)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "context: none of the push_constant_ranges offers the compute stage %u "
                          "bytes from push_constant_offset %u on; add one",
                          GIRIH_PUSH_CONSTANT_BYTES, first);
    }
    return GIRIH_OK;
}

// Copies what of the host's layouts girih's begin with.
static girih_result place(girih_context *context, const girih_context_desc *desc,
                          girih_error *error) {
    girih_placement *placement = &context->placement;
    const VkPhysicalDeviceLimits *limits = &context->limits;
    placement->set = desc->host_set_layout_count;
    placement->push_offset = desc->push_constant_offset;
    if ((placement->set && !desc->host_set_layouts) ||
        (desc->push_constant_range_count && !desc->push_constant_ranges)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "context: host_set_layouts and push_constant_ranges must be set where "
                          "their counts are not 0");
    }
    if ((uint64_t)placement->set + 2 > limits->maxBoundDescriptorSets) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "context: %u host_set_layouts leave less than two of the device's %u "
                          "descriptor sets; bind fewer",
                          placement->set, limits->maxBoundDescriptorSets);
    }
    if (placement->push_offset % 4 != 0 ||
        (uint64_t)placement->push_offset + GIRIH_PUSH_CONSTANT_BYTES >
            limits->maxPushConstantsSize) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "context: push_constant_offset is %u; it must be a multiple of 4 and "
                          "leave %u of the device's %u bytes",
                          placement->push_offset, GIRIH_PUSH_CONSTANT_BYTES,
                          limits->maxPushConstantsSize);
    }
    placement->host_sets = girih_allocate_array(placement->set, sizeof *placement->host_sets);
    placement->range_count = desc->push_constant_range_count ? desc->push_constant_range_count : 1;
    placement->ranges = girih_allocate_array(placement->range_count, sizeof *placement->ranges);
    if (!placement->host_sets || !placement->ranges) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "context: out of memory");
    }
    for (uint32_t n = 0; n < placement->set; ++n) {
        placement->host_sets[n] = desc->host_set_layouts[n];
    }
    if (desc->push_constant_range_count) {
        memcpy(placement->ranges, desc->push_constant_ranges,
               placement->range_count * sizeof *placement->ranges);
    } else {
        placement->ranges[0] = (VkPushConstantRange){.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
                                                     .offset = placement->push_offset,
                                                     .size = GIRIH_PUSH_CONSTANT_BYTES};
    }
    return find_push_stages(placement, error);
}

static VkDescriptorSetLayoutBinding binding_of(uint32_t n, VkShaderStageFlags stages) {
    return (VkDescriptorSetLayoutBinding){.binding = n,
                                          .descriptorType = n == GIRIH_BIND_FRAME
                                                                ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                                : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                          .descriptorCount = 1,
                                          .stageFlags = stages};
}

static girih_result create_set_layout(const girih_context *context,
                                      const VkDescriptorSetLayoutBinding *bindings, uint32_t count,
                                      VkDescriptorSetLayout *layout, girih_error *error) {
    const VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count,
        .pBindings = bindings};
    const VkResult result =
        context->vk.CreateDescriptorSetLayout(context->device, &info, context->callbacks, layout);
    if (result != VK_SUCCESS) {
        *layout = VK_NULL_HANDLE; // a failed call may have written anything
        return girih_vulkan_failed(error, "vkCreateDescriptorSetLayout", "context", result);
    }
    return GIRIH_OK;
}

girih_result girih_create_pipeline_layout(const girih_context *context, VkDescriptorSetLayout own,
                                          const char *what, VkPipelineLayout *layout,
                                          girih_error *error) {
    const girih_placement *placement = &context->placement;
    VkDescriptorSetLayout *sets = girih_allocate_array((size_t)placement->set + 2, sizeof *sets);
    if (!sets) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "%s: out of memory", what);
    }
    for (uint32_t n = 0; n < placement->set; ++n) {
        sets[n] = placement->host_sets[n];
    }
    sets[placement->set] = context->set_layout;
    sets[placement->set + 1] = own;
    const VkPipelineLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = placement->set + (own ? 2 : 1),
                                             .pSetLayouts = sets,
                                             .pushConstantRangeCount = placement->range_count,
                                             .pPushConstantRanges = placement->ranges};
    VkPipelineLayout created;
    const VkResult result =
        context->vk.CreatePipelineLayout(context->device, &info, context->callbacks, &created);
    girih_free(sets);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "vkCreatePipelineLayout", what, result);
    }
    *layout = created;
    return GIRIH_OK;
}

static girih_result create_layouts(girih_context *context, girih_error *error) {
    VkDescriptorSetLayoutBinding bindings[GIRIH_BIND_COUNT];
    uint32_t count = 0;
    for (uint32_t n = 0; n < GIRIH_BIND_COUNT; ++n) {
        const bool kept = !context->few_buffers || n == GIRIH_BIND_FRAME ||
                          n == GIRIH_BIND_SHARED_SCENE || n == GIRIH_BIND_SHARED_PLAN ||
                          n == GIRIH_BIND_OUT_POSITIONS || n == GIRIH_BIND_OUT_ATTRIBUTES;
        if (kept) {
            bindings[count++] = binding_of(n, VK_SHADER_STAGE_COMPUTE_BIT);
        }
    }
    girih_result result = create_set_layout(context, bindings, count, &context->set_layout, error);
    if (result == GIRIH_OK) {
        const VkDescriptorSetLayoutBinding draw[] = {
            binding_of(GIRIH_BIND_FRAME, VK_SHADER_STAGE_VERTEX_BIT),
            binding_of(GIRIH_BIND_SHARED_SCENE, VK_SHADER_STAGE_VERTEX_BIT),
            binding_of(GIRIH_BIND_DRAW_ATTRIBUTES, VK_SHADER_STAGE_VERTEX_BIT),
            binding_of(GIRIH_BIND_SHARED_PLAN, VK_SHADER_STAGE_VERTEX_BIT)};
        result = create_set_layout(context, draw, sizeof draw / sizeof *draw,
                                   &context->draw_set_layout, error);
    }
    if (result == GIRIH_OK) {
        result = girih_create_pipeline_layout(context, VK_NULL_HANDLE, "context",
                                              &context->pipeline_layout, error);
    }
    return result;
}

// Packs the catalogue and says what its buffers must be. The arrays' words are the caller's to
// free.
static girih_result lay_out(const girih_context_desc *desc, girih_arrays *arrays,
                            VkDeviceSize offset[GIRIH_BIND_COUNT],
                            girih_buffer_need needs[GIRIH_CONTEXT_BUFFERS], girih_error *error) {
    const girih_result result = girih_pack_catalogue(
        arrays, desc->catalogue ? desc->catalogue : girih_catalogue_dyadic(), error);
    if (result != GIRIH_OK) {
        return result;
    }
    VkDeviceSize patterns = 0;
    VkDeviceSize indices = 0;
    girih_layout_arrays(arrays, GIRIH_BIND_PATTERNS, GIRIH_BIND_PATTERN_INDICES, offset, &patterns);
    girih_layout_arrays(arrays, GIRIH_BIND_PATTERN_INDICES, GIRIH_BIND_PATTERN_INDICES + 1, offset,
                        &indices);
    const VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    needs[GIRIH_CONTEXT_PATTERNS] = girih_need("catalogue patterns", patterns,
                                               usage | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, false);
    needs[GIRIH_CONTEXT_INDICES] =
        girih_need("catalogue indices", indices, usage | VK_BUFFER_USAGE_INDEX_BUFFER_BIT, false);
    needs[GIRIH_CONTEXT_STAGING] =
        girih_need("catalogue staging", patterns + indices, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
    return GIRIH_OK;
}

girih_result girih_context_needs(const girih_context_desc *desc,
                                 girih_buffer_need needs[GIRIH_CONTEXT_BUFFERS],
                                 girih_error *error) {
    if (!desc || !needs) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_context_needs: desc and needs must be set");
    }
    girih_arrays arrays = {0};
    VkDeviceSize offset[GIRIH_BIND_COUNT];
    const girih_result result = lay_out(desc, &arrays, offset, needs, error);
    girih_arrays_free(&arrays, 0, GIRIH_BIND_COUNT);
    return result;
}

// Draws bind the buffer of the catalogue's indices at 0, because lavapipe ignores the bind offset
// in indirect draws; so every draw's first index counts from there.
static girih_result number_indices(girih_context *context, girih_error *error) {
    girih_frame_block *frame = &context->catalogue.frame;
    const VkDeviceSize end = context->indices.offset + context->indices.size;
    if (end < context->indices.offset || end / 4 > UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "catalogue indices: the range given ends beyond index %u of its buffer; "
                          "give one nearer to the buffer's begin",
                          UINT32_MAX);
    }
    frame->first_index = (uint32_t)(context->indices.offset / 4);
    return GIRIH_OK;
}

static girih_result create_buffers(girih_context *context, const girih_context_desc *desc,
                                   girih_error *error) {
    girih_arrays *arrays = &context->catalogue;
    girih_buffer_need needs[GIRIH_CONTEXT_BUFFERS];
    girih_result result = lay_out(desc, arrays, context->offset, needs, error);
    if (result == GIRIH_OK) {
        result =
            girih_check_ranges(context, arrays, GIRIH_BIND_PATTERNS, GIRIH_BIND_PATTERN_INDICES + 1,
                               needs[GIRIH_CONTEXT_STAGING].size, "catalogue", error);
    }
    girih_buffer *const buffers[GIRIH_CONTEXT_BUFFERS] = {
        [GIRIH_CONTEXT_PATTERNS] = &context->patterns,
        [GIRIH_CONTEXT_INDICES] = &context->indices,
        [GIRIH_CONTEXT_STAGING] = &context->staging};
    for (uint32_t n = 0; n < GIRIH_CONTEXT_BUFFERS && result == GIRIH_OK; ++n) {
        result = girih_buffer_create(context, &needs[n], desc->buffers ? &desc->buffers[n] : NULL,
                                     buffers[n], error);
    }
    if (result == GIRIH_OK) {
        result = number_indices(context, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    char *staging = context->staging.mapped;
    for (uint32_t n = GIRIH_BIND_PATTERNS; n <= GIRIH_BIND_PATTERN_INDICES; ++n) {
        const VkDeviceSize base = n == GIRIH_BIND_PATTERN_INDICES ? context->patterns.size : 0;
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
                               .compute_only = desc->queue_flags &&
                                               !(desc->queue_flags & VK_QUEUE_GRAPHICS_BIT)};
    if (desc->enabled_features) {
        context->features = *desc->enabled_features;
    }
    girih_result result = load_functions(context, desc, error);
    if (result != GIRIH_OK) {
        girih_free(context); // nothing else exists, and nothing could destroy it
        return result;
    }
    read_limits(context, desc);
    result = place(context, desc, error);
    if (result == GIRIH_OK) {
        result = create_layouts(context, error);
    }
    if (result == GIRIH_OK) {
        result = create_buffers(context, desc, error);
    }
    if (result != GIRIH_OK) {
        girih_context_destroy(context);
        return result;
    }
    *out = context;
    return GIRIH_OK;
}

void girih_cmd_upload_context(const girih_context *context, VkCommandBuffer commands) {
    const girih_buffer *staging = &context->staging;
    if (!staging->buffer) {
        return; // trimmed: it has been uploaded
    }
    const girih_buffer *patterns = &context->patterns;
    const girih_buffer *indices = &context->indices;
    const VkBufferCopy pattern_copy = {
        .srcOffset = staging->offset, .dstOffset = patterns->offset, .size = patterns->size};
    const VkBufferCopy index_copy = {.srcOffset = staging->offset + patterns->size,
                                     .dstOffset = indices->offset,
                                     .size = indices->size};
    context->vk.CmdCopyBuffer(commands, staging->buffer, patterns->buffer, 1, &pattern_copy);
    context->vk.CmdCopyBuffer(commands, staging->buffer, indices->buffer, 1, &index_copy);
    girih_barrier(context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                  VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_SHADER_BIT |
                      VK_PIPELINE_STAGE_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT |
                      VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
}

void girih_context_trim(girih_context *context) {
    if (context->staging.memory) {
        girih_buffer_destroy(context, &context->staging);
    }
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
    girih_free(context->placement.host_sets);
    girih_free(context->placement.ranges);
    girih_free(context);
}

int girih_context_uses_few_buffers(const girih_context *context) {
    return context->few_buffers;
}

VkDescriptorSetLayout girih_context_draw_set_layout(const girih_context *context) {
    return context->draw_set_layout;
}
