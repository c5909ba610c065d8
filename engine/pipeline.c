// Compute pipelines, one for each variant of each shader that a plan has needed.
#include <stdatomic.h>
#include <string.h>

#include "context.h"
#include "error.h"
#include "memory.h"

#define GIRIH_SHADERS_WANT_CODE
#include "shader_list.h"

typedef struct shader_code {
    const uint32_t *words;
    size_t bytes;
} shader_code;

static const shader_code shaders[GIRIH_SHADER_COUNT][2] = {
#define GIRIH_SHADER_CODE(NAME)                                                                    \
    {{girih_spirv_##NAME, sizeof girih_spirv_##NAME},                                              \
     {girih_spirv_##NAME##_few, sizeof girih_spirv_##NAME##_few}},
    GIRIH_SHADERS(GIRIH_SHADER_CODE)
#undef GIRIH_SHADER_CODE
};

// The bits of a variant that concern a shader: at most eight, so that GIRIH_MAX_VARIANTS slots do.
static uint32_t variant_mask(uint32_t shader) {
    switch (shader) {
    case GIRIH_SHADER_levels:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_DYNAMIC | 7u << GIRIH_VARIANT_RULE_SHIFT;
    case GIRIH_SHADER_select_flat:
    case GIRIH_SHADER_select_pn:
    case GIRIH_SHADER_small_flat_narrow:
    case GIRIH_SHADER_small_flat_wide:
    case GIRIH_SHADER_small_pn_narrow:
    case GIRIH_SHADER_small_pn_wide:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_SEAMS | GIRIH_VARIANT_CULL |
               GIRIH_VARIANT_DYNAMIC | GIRIH_VARIANT_MATERIALS | GIRIH_VARIANT_SPLITS;
    case GIRIH_SHADER_split_count:
    case GIRIH_SHADER_split_parts:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_MATERIALS | GIRIH_VARIANT_SPLITS;
    case GIRIH_SHADER_group_count_serial:
    case GIRIH_SHADER_group_count_workgroup:
    case GIRIH_SHADER_group_place_serial:
    case GIRIH_SHADER_group_place_workgroup:
        return GIRIH_VARIANT_SPLITS;
    case GIRIH_SHADER_evaluate_patches_flat:
    case GIRIH_SHADER_evaluate_patches_pn:
    case GIRIH_SHADER_evaluate_points_flat:
    case GIRIH_SHADER_evaluate_points_pn:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_SEAMS | GIRIH_VARIANT_ATTRIBUTES |
               GIRIH_VARIANT_CULL | GIRIH_VARIANT_WELDED | GIRIH_VARIANT_DYNAMIC |
               GIRIH_VARIANT_SPLITS | GIRIH_VARIANT_PARTS;
    case GIRIH_SHADER_evaluate_edges_flat:
    case GIRIH_SHADER_evaluate_edges_pn:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_SEAMS | GIRIH_VARIANT_ATTRIBUTES |
               GIRIH_VARIANT_DYNAMIC;
    case GIRIH_SHADER_evaluate_corners:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_ATTRIBUTES | GIRIH_VARIANT_DYNAMIC;
    case GIRIH_SHADER_output_lists:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_WELDED | GIRIH_VARIANT_SPLITS |
               7u << GIRIH_VARIANT_OUTPUT_SHIFT;
    case GIRIH_SHADER_evaluate_items:
        return GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_SPLITS;
    case GIRIH_SHADER_output_weld_blocks:
    case GIRIH_SHADER_output_weld_offsets:
        return GIRIH_VARIANT_INSTANCES;
    default:
        return 0;
    }
}

uint32_t girih_variant_slot(uint32_t variant, uint32_t mask) {
    uint32_t slot = 0;
    uint32_t place = 0;
    for (uint32_t bit = 0; bit < 32; ++bit) {
        if (mask & 1u << bit) {
            slot |= (variant >> bit & 1u) << place++;
        }
    }
    return slot;
}

girih_result girih_pipeline_create(const girih_context *context, const uint32_t *words,
                                   size_t bytes, uint32_t variant, VkPipelineLayout layout,
                                   const _Atomic(VkPipeline) *slot, girih_error *error) {
    const girih_functions *vk = &context->vk;
    const VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
    VkShaderModule module;
    VkResult result =
        vk->CreateShaderModule(context->device, &module_info, context->callbacks, &module);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "vkCreateShaderModule", "plan", result);
    }
    const VkSpecializationMapEntry entry = {.constantID = 0, .size = sizeof variant};
    const VkSpecializationInfo specialization = {
        .mapEntryCount = 1, .pMapEntries = &entry, .dataSize = sizeof variant, .pData = &variant};
    const VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &specialization},
        .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    result = vk->CreateComputePipelines(context->device, context->pipeline_cache, 1, &info,
                                        context->callbacks, &pipeline);
    vk->DestroyShaderModule(context->device, module, context->callbacks);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "vkCreateComputePipelines", "plan", result);
    }
    // The only part of a context or a surface program that changes, and only from nothing to
    // something.
    VkPipeline nothing = VK_NULL_HANDLE;
    if (!atomic_compare_exchange_strong((_Atomic(VkPipeline) *)slot, &nothing, pipeline)) {
        vk->DestroyPipeline(context->device, pipeline,
                            context->callbacks); // another thread was first
    }
    return GIRIH_OK;
}

girih_result girih_pipeline_need(const girih_context *context, uint32_t shader, uint32_t variant,
                                 girih_error *error) {
    const uint32_t mask = variant_mask(shader);
    const _Atomic(VkPipeline) *slot =
        &context->pipelines[shader][girih_variant_slot(variant, mask)];
    if (atomic_load(slot)) {
        return GIRIH_OK;
    }
    const shader_code code = shaders[shader][context->few_buffers];
    const girih_placement *placement = &context->placement;
    if (placement->set == 0 && placement->push_offset == 0) {
        return girih_pipeline_create(context, code.words, code.bytes, variant & mask,
                                     context->pipeline_layout, slot, error);
    }
    uint32_t *placed = girih_allocate(code.bytes);
    if (!placed) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "plan: out of memory for a shader");
    }
    memcpy(placed, code.words, code.bytes);
    girih_spirv_place(placed, code.bytes, placement->set, placement->push_offset);
    const girih_result result = girih_pipeline_create(context, placed, code.bytes, variant & mask,
                                                      context->pipeline_layout, slot, error);
    girih_free(placed);
    return result;
}

VkPipeline girih_pipeline_get(const girih_context *context, uint32_t shader, uint32_t variant) {
    return atomic_load(
        &context->pipelines[shader][girih_variant_slot(variant, variant_mask(shader))]);
}
