#include "overlay_painter.h"

#include <string.h>

#include "error.h"

#include "overlay_fragment.spv.h"
#include "overlay_vertex.spv.h"

// shaders/overlay.frag: the push constants.
typedef struct panel_block {
    int32_t corner[2];
    int32_t width;
    int32_t first;
} panel_block;

static girih_result create_layouts(girih_overlay_painter *painter, VkDevice device,
                                   girih_error *error) {
    VkDescriptorSetLayoutBinding binding = {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                                            VK_SHADER_STAGE_FRAGMENT_BIT, NULL};
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = 1,
                                            .pBindings = &binding};
    VkResult result = vkCreateDescriptorSetLayout(device, &info, NULL, &painter->set_layout);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorSetLayout", result);
    }
    VkPushConstantRange push = {VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(panel_block)};
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &painter->set_layout,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &push,
    };
    result = vkCreatePipelineLayout(device, &layout, NULL, &painter->layout);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreatePipelineLayout", result);
}

static girih_result create_set(girih_overlay_painter *painter, VkDevice device,
                               girih_error *error) {
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = 1,
        .pPoolSizes = &size,
    };
    VkResult result = vkCreateDescriptorPool(device, &pool, NULL, &painter->descriptors);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorPool", result);
    }
    VkDescriptorSetAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = painter->descriptors,
        .descriptorSetCount = 1,
        .pSetLayouts = &painter->set_layout,
    };
    result = vkAllocateDescriptorSets(device, &allocate, &painter->set);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkAllocateDescriptorSets", result);
}

static girih_result create_pipeline(girih_overlay_painter *painter, VkDevice device,
                                    VkRenderPass pass, VkSampleCountFlagBits samples,
                                    const VkShaderModule modules[2], girih_error *error) {
    VkPipelineShaderStageCreateInfo stages[2];
    for (int n = 0; n < 2; n++) {
        stages[n] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = n == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT,
            .module = modules[n],
            .pName = "main",
        };
    }
    VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
    };
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1.0f};
    VkPipelineMultisampleStateCreateInfo multisample = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = samples,
    };
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    VkPipelineColorBlendAttachmentState attachment = {
        .blendEnable = VK_TRUE,
        .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
        .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .colorBlendOp = VK_BLEND_OP_ADD,
        .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
        .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .alphaBlendOp = VK_BLEND_OP_ADD,
        .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                          VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT,
    };
    VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &attachment,
    };
    VkDynamicState dynamic_states[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = dynamic_states,
    };
    VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = 2,
        .pStages = stages,
        .pVertexInputState = &input,
        .pInputAssemblyState = &assembly,
        .pViewportState = &viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &multisample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic,
        .layout = painter->layout,
        .renderPass = pass,
    };
    VkResult result =
        vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &painter->pipeline);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateGraphicsPipelines", result);
}

girih_result girih_overlay_painter_create(girih_overlay_painter *painter,
                                          const girih_device *device, VkRenderPass pass,
                                          VkSampleCountFlagBits samples, girih_error *error) {
    *painter = (girih_overlay_painter){0};
    girih_result result = create_layouts(painter, device->device, error);
    if (result == GIRIH_OK) {
        result = create_set(painter, device->device, error);
    }
    const struct {
        const uint32_t *words;
        size_t size;
    } code[2] = {{girih_spirv_overlay_vertex, sizeof girih_spirv_overlay_vertex},
                 {girih_spirv_overlay_fragment, sizeof girih_spirv_overlay_fragment}};
    VkShaderModule modules[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    for (int n = 0; n < 2 && result == GIRIH_OK; n++) {
        VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                         .codeSize = code[n].size,
                                         .pCode = code[n].words};
        VkResult created = vkCreateShaderModule(device->device, &info, NULL, &modules[n]);
        if (created != VK_SUCCESS) {
            result = girih_vulkan_failure(error, "vkCreateShaderModule", created);
        }
    }
    if (result == GIRIH_OK) {
        result = create_pipeline(painter, device->device, pass, samples, modules, error);
    }
    vkDestroyShaderModule(device->device, modules[0], NULL);
    vkDestroyShaderModule(device->device, modules[1], NULL);
    if (result != GIRIH_OK) {
        girih_overlay_painter_destroy(painter, device);
    }
    return result;
}

void girih_overlay_painter_destroy(girih_overlay_painter *painter, const girih_device *device) {
    vkDestroyPipeline(device->device, painter->pipeline, NULL);
    vkDestroyPipelineLayout(device->device, painter->layout, NULL);
    vkDestroyDescriptorPool(device->device, painter->descriptors, NULL);
    vkDestroyDescriptorSetLayout(device->device, painter->set_layout, NULL);
    girih_device_buffer_destroy(device, &painter->pixels);
    *painter = (girih_overlay_painter){0};
}

static VkDeviceSize panel_bytes(const girih_rectangle *place) {
    return (VkDeviceSize)place->width * place->height * sizeof(uint32_t);
}

// Room for so many bytes, kept while it lasts.
static girih_result make_room(girih_overlay_painter *painter, const girih_device *device,
                              VkDeviceSize bytes, girih_error *error) {
    if (bytes <= painter->pixels.size) {
        return GIRIH_OK;
    }
    girih_device_buffer_destroy(device, &painter->pixels);
    girih_result result =
        girih_device_buffer_create(device, &painter->pixels, bytes,
                                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GIRIH_MEMORY_UPLOAD, error);
    if (result != GIRIH_OK) {
        return result;
    }
    VkDescriptorBufferInfo buffer = {painter->pixels.buffer, 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = painter->set,
        .descriptorCount = 1,
        .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        .pBufferInfo = &buffer,
    };
    vkUpdateDescriptorSets(device->device, 1, &write, 0, NULL);
    return GIRIH_OK;
}

girih_result girih_overlay_painter_set(girih_overlay_painter *painter, const girih_device *device,
                                       const girih_overlay *overlay, girih_error *error) {
    painter->panel_count = 0;
    uint32_t count = overlay != NULL ? overlay->panel_count : 0;
    VkDeviceSize bytes = 0;
    for (uint32_t n = 0; n < count; n++) {
        bytes += panel_bytes(&overlay->panels[n].place);
    }
    girih_result result = make_room(painter, device, bytes, error);
    char *to = painter->pixels.mapped;
    for (uint32_t n = 0; n < count && result == GIRIH_OK; n++) {
        painter->places[n] = overlay->panels[n].place;
        memcpy(to, overlay->panels[n].pixels, panel_bytes(&painter->places[n]));
        to += panel_bytes(&painter->places[n]);
        painter->panel_count++;
    }
    return result;
}

void girih_overlay_painter_record(const girih_overlay_painter *painter, VkCommandBuffer commands) {
    if (painter->panel_count == 0) {
        return;
    }
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, painter->pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, painter->layout, 0, 1,
                            &painter->set, 0, NULL);
    int32_t first = 0;
    for (uint32_t n = 0; n < painter->panel_count; n++) {
        const girih_rectangle *place = &painter->places[n];
        VkViewport viewport = {(float)place->x,
                               (float)place->y,
                               (float)place->width,
                               (float)place->height,
                               0.0f,
                               1.0f};
        VkRect2D scissor = {{(int32_t)place->x, (int32_t)place->y}, {place->width, place->height}};
        panel_block block = {{(int32_t)place->x, (int32_t)place->y}, (int32_t)place->width, first};
        vkCmdSetViewport(commands, 0, 1, &viewport);
        vkCmdSetScissor(commands, 0, 1, &scissor);
        vkCmdPushConstants(commands, painter->layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof block,
                           &block);
        vkCmdDraw(commands, 3, 1, 0, 0);
        first += (int32_t)(place->width * place->height);
    }
}
