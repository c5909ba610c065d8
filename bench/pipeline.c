// Pipelines and their layouts.
#include "error.h"
#include "target_private.h"

VkShaderStageFlags bench_target_stages(const bench_target *target) {
    VkShaderStageFlags stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
    if (target->device->features.geometryShader) {
        stages |= VK_SHADER_STAGE_GEOMETRY_BIT;
    }
    if (target->device->features.tessellationShader) {
        stages |=
            VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT | VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT;
    }
    return stages;
}

static const VkVertexInputBindingDescription corner_binding = {0, 24, VK_VERTEX_INPUT_RATE_VERTEX};
static const VkVertexInputAttributeDescription corner_attributes[2] = {
    {0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0}, {1, 0, VK_FORMAT_R32G32B32_SFLOAT, 12}};
const VkPipelineVertexInputStateCreateInfo bench_corner_input = {
    .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
    .vertexBindingDescriptionCount = 1,
    .pVertexBindingDescriptions = &corner_binding,
    .vertexAttributeDescriptionCount = 2,
    .pVertexAttributeDescriptions = corner_attributes};

#define MOST_STAGES 5

typedef struct stages {
    VkSpecializationInfo constants;
    VkShaderModule modules[MOST_STAGES];
    VkPipelineShaderStageCreateInfo infos[MOST_STAGES];
    uint32_t count;
} stages;

static VkResult add_stage(const bench_target *target, bench_shader shader,
                          VkShaderStageFlagBits stage, stages *list) {
    if (!shader.words) {
        return VK_SUCCESS;
    }
    const VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                           .codeSize = shader.bytes,
                                           .pCode = shader.words};
    VkShaderModule *module = &list->modules[list->count];
    const VkResult result = vkCreateShaderModule(target->device->device, &info, NULL, module);
    if (result == VK_SUCCESS) {
        list->infos[list->count++] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = stage,
            .module = *module,
            .pName = "main",
            .pSpecializationInfo = &list->constants};
    }
    return result;
}

// No stages yet, and the constants that all of them are to have.
static stages begin_stages(const bench_target *target) {
    static const VkSpecializationMapEntry cylindrical = {100, 0, sizeof(VkBool32)};
    return (stages){.constants = {.mapEntryCount = 1,
                                  .pMapEntries = &cylindrical,
                                  .dataSize = sizeof target->cylindrical,
                                  .pData = &target->cylindrical}};
}

static VkResult create_graphics(const bench_target *target, const bench_pipeline_desc *desc,
                                VkRenderPass pass, bench_raster raster, const stages *list,
                                VkPipeline *pipeline) {
    static const VkPipelineVertexInputStateCreateInfo nothing = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = desc->topology};
    const VkPipelineTessellationStateCreateInfo tessellation = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_TESSELLATION_STATE_CREATE_INFO,
        .patchControlPoints = desc->patch_points};
    const VkPipelineViewportStateCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    static const VkDynamicState states[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = states};
    const VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .rasterizerDiscardEnable = raster != BENCH_SHADED,
        .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo multisample = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = VK_COMPARE_OP_LESS};
    const VkPipelineColorBlendAttachmentState blend = {.colorWriteMask = 0xf};
    const VkPipelineColorBlendStateCreateInfo blending = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &blend};
    const VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = list->count,
        .pStages = list->infos,
        .pVertexInputState = desc->input ? desc->input : &nothing,
        .pInputAssemblyState = &assembly,
        .pTessellationState = desc->patch_points ? &tessellation : NULL,
        .pViewportState = &view,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &multisample,
        .pDepthStencilState = &depth,
        .pColorBlendState = pass == target->pass ? &blending : NULL,
        .pDynamicState = &dynamic,
        .layout = desc->layout,
        .renderPass = pass};
    return vkCreateGraphicsPipelines(target->device->device, VK_NULL_HANDLE, 1, &info, NULL,
                                     pipeline);
}

static VkResult create_one(const bench_target *target, const bench_pipeline_desc *desc,
                           VkRenderPass pass, bench_raster raster, VkPipeline *pipeline) {
    bench_shader shaders[4] = {desc->vertex, desc->control, desc->evaluation, desc->geometry};
    static const VkShaderStageFlagBits kinds[4] = {
        VK_SHADER_STAGE_VERTEX_BIT, VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT,
        VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT, VK_SHADER_STAGE_GEOMETRY_BIT};
    uint32_t last = 3;
    while (last > 0 && !shaders[last].words) {
        --last;
    }
    if (raster == BENCH_CAPTURE && pass == target->pass) {
        shaders[last] = desc->capture;
    }
    stages list = begin_stages(target);
    VkResult result = VK_SUCCESS;
    for (uint32_t n = 0; n < 4 && result == VK_SUCCESS; ++n) {
        result = add_stage(target, shaders[n], kinds[n], &list);
    }
    const uint32_t modules = list.count;
    if (result == VK_SUCCESS && raster == BENCH_SHADED) {
        list.infos[list.count++] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
            .module = target->fragment,
            .pName = "main",
            .pSpecializationInfo = &list.constants};
    }
    if (result == VK_SUCCESS) {
        result = create_graphics(target, desc, pass, raster, &list, pipeline);
    }
    for (uint32_t n = 0; n < modules; ++n) {
        vkDestroyShaderModule(target->device->device, list.modules[n], NULL);
    }
    return result;
}

girih_result bench_pipelines_create(const bench_target *target, const bench_pipeline_desc *desc,
                                    VkPipeline pipelines[BENCH_RASTERS], girih_error *error) {
    for (uint32_t raster = 0; raster < BENCH_RASTERS; ++raster) {
        pipelines[raster] = VK_NULL_HANDLE;
        if (raster == BENCH_CAPTURE && !target->device->has_transform_feedback) {
            continue;
        }
        const VkResult result = create_one(target, desc, target->pass, raster, &pipelines[raster]);
        if (result != VK_SUCCESS) {
            bench_pipelines_destroy(target, pipelines);
            return girih_vulkan_failure(error, "creating a method's pipelines", result);
        }
    }
    return GIRIH_OK;
}

girih_result bench_feedback_pipeline_create(const bench_target *target,
                                            const bench_pipeline_desc *desc, VkPipeline *pipeline,
                                            girih_error *error) {
    *pipeline = VK_NULL_HANDLE;
    const VkResult result = create_one(target, desc, target->empty_pass, BENCH_CAPTURE, pipeline);
    return result == VK_SUCCESS
               ? GIRIH_OK
               : girih_vulkan_failure(error, "creating a method's feedback pipeline", result);
}

void bench_pipelines_destroy(const bench_target *target, VkPipeline pipelines[BENCH_RASTERS]) {
    for (uint32_t raster = 0; raster < BENCH_RASTERS; ++raster) {
        vkDestroyPipeline(target->device->device, pipelines[raster], NULL);
        pipelines[raster] = VK_NULL_HANDLE;
    }
}

girih_result bench_compute_pipeline_create(const bench_target *target, bench_shader shader,
                                           VkPipelineLayout layout, VkPipeline *pipeline,
                                           girih_error *error) {
    stages list = begin_stages(target);
    *pipeline = VK_NULL_HANDLE;
    VkResult result = add_stage(target, shader, VK_SHADER_STAGE_COMPUTE_BIT, &list);
    if (result == VK_SUCCESS) {
        const VkComputePipelineCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .stage = list.infos[0],
            .layout = layout};
        result = vkCreateComputePipelines(target->device->device, VK_NULL_HANDLE, 1, &info, NULL,
                                          pipeline);
        vkDestroyShaderModule(target->device->device, list.modules[0], NULL);
    }
    return result == VK_SUCCESS
               ? GIRIH_OK
               : girih_vulkan_failure(error, "creating a method's compute pipeline", result);
}

// --- Layouts ------------------------------------------------------------------------------------

#define MOST_STORAGE_BUFFERS 16u

static VkResult create_storage_set(const bench_target *target, const VkBuffer *buffers,
                                   uint32_t count, bench_layout *layout) {
    const VkDevice device = target->device->device;
    VkDescriptorSetLayoutBinding bindings[MOST_STORAGE_BUFFERS];
    VkDescriptorBufferInfo infos[MOST_STORAGE_BUFFERS];
    for (uint32_t n = 0; n < count; ++n) {
        bindings[n] =
            (VkDescriptorSetLayoutBinding){.binding = n,
                                           .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                           .descriptorCount = 1,
                                           .stageFlags = bench_target_stages(target)};
        infos[n] = (VkDescriptorBufferInfo){.buffer = buffers[n], .range = VK_WHOLE_SIZE};
    }
    const VkDescriptorSetLayoutCreateInfo set_layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count,
        .pBindings = bindings};
    VkResult result = vkCreateDescriptorSetLayout(device, &set_layout, NULL, &layout->set_layout);
    if (result == VK_SUCCESS) {
        const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count};
        const VkDescriptorPoolCreateInfo pool = {.sType =
                                                     VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                                 .maxSets = 1,
                                                 .poolSizeCount = 1,
                                                 .pPoolSizes = &size};
        result = vkCreateDescriptorPool(device, &pool, NULL, &layout->pool);
    }
    if (result == VK_SUCCESS) {
        const VkDescriptorSetAllocateInfo allocate = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
            .descriptorPool = layout->pool,
            .descriptorSetCount = 1,
            .pSetLayouts = &layout->set_layout};
        result = vkAllocateDescriptorSets(device, &allocate, &layout->set);
    }
    if (result == VK_SUCCESS) {
        for (uint32_t n = 0; n < count; ++n) {
            const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                                .dstSet = layout->set,
                                                .dstBinding = n,
                                                .descriptorCount = 1,
                                                .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                .pBufferInfo = &infos[n]};
            vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
        }
    }
    return result;
}

girih_result bench_layout_create(const bench_target *target, const VkBuffer *storage_buffers,
                                 uint32_t storage_buffer_count, uint32_t push_bytes,
                                 bench_layout *layout, girih_error *error) {
    *layout = (bench_layout){.set = VK_NULL_HANDLE};
    VkResult result = VK_SUCCESS;
    if (storage_buffer_count > MOST_STORAGE_BUFFERS) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "a method asks for %u storage buffers; at most %u", storage_buffer_count,
                          MOST_STORAGE_BUFFERS);
    }
    if (storage_buffer_count != 0) {
        result = create_storage_set(target, storage_buffers, storage_buffer_count, layout);
    }
    if (result == VK_SUCCESS) {
        const VkDescriptorSetLayout sets[2] = {target->view_layout, layout->set_layout};
        const VkPushConstantRange push = {.stageFlags = bench_target_stages(target),
                                          .size = push_bytes};
        const VkPipelineLayoutCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
            .setLayoutCount = storage_buffer_count != 0 ? 2 : 1,
            .pSetLayouts = sets,
            .pushConstantRangeCount = push_bytes != 0 ? 1 : 0,
            .pPushConstantRanges = &push};
        result = vkCreatePipelineLayout(target->device->device, &info, NULL, &layout->layout);
    }
    if (result != VK_SUCCESS) {
        bench_layout_destroy(target, layout);
        return girih_vulkan_failure(error, "creating a method's pipeline layout", result);
    }
    return GIRIH_OK;
}

void bench_layout_destroy(const bench_target *target, bench_layout *layout) {
    const VkDevice device = target->device->device;
    vkDestroyPipelineLayout(device, layout->layout, NULL);
    vkDestroyDescriptorPool(device, layout->pool, NULL);
    vkDestroyDescriptorSetLayout(device, layout->set_layout, NULL);
    *layout = (bench_layout){.set = VK_NULL_HANDLE};
}

void bench_bind_layout(const bench_target *target, VkCommandBuffer commands,
                       const bench_layout *layout, VkPipelineBindPoint bind_point) {
    const VkDescriptorSet sets[2] = {target->view_set, layout->set};
    vkCmdBindDescriptorSets(commands, bind_point, layout->layout, 0, layout->set ? 2 : 1, sets, 0,
                            NULL);
}
