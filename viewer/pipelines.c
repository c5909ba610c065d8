#include "pipelines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

#include "background_fragment.spv.h"
#include "background_vertex.spv.h"
#include "model_buffers.spv.h"
#include "model_flat.spv.h"
#include "model_flat_attributes.spv.h"
#include "model_flat_attributes_splits.spv.h"
#include "model_flat_splits.spv.h"
#include "model_fragment.spv.h"
#include "model_pn.spv.h"
#include "model_pn_attributes.spv.h"
#include "model_pn_attributes_splits.spv.h"
#include "model_pn_splits.spv.h"
#include "model_triangles_fragment.spv.h"
#include "triangle_geometry.spv.h"

typedef struct shader {
    const uint32_t *words;
    size_t size;
} shader;

#define SHADER(NAME) ((shader){girih_spirv_##NAME, sizeof girih_spirv_##NAME})

static bool uses_own(const girih_pipeline_key *key) {
    return key->instanced && key->surface == GIRIH_SURFACE_OWN;
}

static shader choose_vertex_shader(const girih_pipelines *pipelines, const girih_pipeline_key *key,
                                   const girih_own_surface *own) {
    if (key->background) {
        return SHADER(background_vertex);
    }
    if (!key->instanced) {
        return SHADER(model_buffers);
    }
    if (uses_own(key)) {
        return (shader){own->vertex_words, own->vertex_bytes};
    }
    // By surface, attributes and splits.
    const shader built_in[2][2][2] = {
        {{SHADER(model_flat), SHADER(model_flat_splits)},
         {SHADER(model_flat_attributes), SHADER(model_flat_attributes_splits)}},
        {{SHADER(model_pn), SHADER(model_pn_splits)},
         {SHADER(model_pn_attributes), SHADER(model_pn_attributes_splits)}}};
    return built_in[key->surface == GIRIH_SURFACE_PN][pipelines->attribute_floats != 0]
                   [key->has_splits];
}

static girih_result create_module(VkDevice device, shader code, VkShaderModule *module,
                                  girih_error *error) {
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = code.size,
                                     .pCode = code.words};
    VkResult result = vkCreateShaderModule(device, &info, NULL, module);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateShaderModule", result);
}

// Vertex input of the baked and welded modes: positions in one buffer, normals and attributes in
// another. Attributes that are not there read the normal, which the shader leaves alone.
typedef struct buffer_input {
    VkVertexInputBindingDescription bindings[2];
    VkVertexInputAttributeDescription attributes[4];
    VkPipelineVertexInputStateCreateInfo info;
} buffer_input;

static void describe_buffers(const girih_pipelines *pipelines, buffer_input *input) {
    uint32_t stride = 4 * (3 + pipelines->attribute_floats);
    bool has_texcoord = pipelines->texcoord_float != GIRIH_MODEL_NONE;
    bool has_color = pipelines->color_float != GIRIH_MODEL_NONE;
    input->bindings[0] = (VkVertexInputBindingDescription){0, 12, VK_VERTEX_INPUT_RATE_VERTEX};
    input->bindings[1] = (VkVertexInputBindingDescription){1, stride, VK_VERTEX_INPUT_RATE_VERTEX};
    input->attributes[0] = (VkVertexInputAttributeDescription){0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
    input->attributes[1] = (VkVertexInputAttributeDescription){1, 1, VK_FORMAT_R32G32B32_SFLOAT, 0};
    input->attributes[2] = (VkVertexInputAttributeDescription){8, 1, VK_FORMAT_R32_SFLOAT, 0};
    input->attributes[3] = (VkVertexInputAttributeDescription){9, 1, VK_FORMAT_R32_SFLOAT, 0};
    if (has_texcoord) {
        input->attributes[2].format = pipelines->texcoord_floats == 4
                                          ? VK_FORMAT_R32G32B32A32_SFLOAT
                                          : VK_FORMAT_R32G32_SFLOAT;
        input->attributes[2].offset = 12 + 4 * pipelines->texcoord_float;
    }
    if (has_color) {
        input->attributes[3].format = VK_FORMAT_R32G32B32A32_SFLOAT;
        input->attributes[3].offset = 12 + 4 * pipelines->color_float;
    }
    input->info = (VkPipelineVertexInputStateCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 2,
        .pVertexBindingDescriptions = input->bindings,
        .vertexAttributeDescriptionCount = 4,
        .pVertexAttributeDescriptions = input->attributes,
    };
}

static VkPipelineColorBlendAttachmentState blend_state(const girih_pipeline_key *key) {
    return (VkPipelineColorBlendAttachmentState){
        .blendEnable = !key->background &&
                       (key->line_width > 0.0f || key->alpha_mode == GIRIH_GLTF_ALPHA_BLEND),
        .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
        .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .colorBlendOp = VK_BLEND_OP_ADD,
        .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
        .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .alphaBlendOp = VK_BLEND_OP_ADD,
        .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                          VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT,
    };
}

static girih_result create_pipeline(const girih_pipelines *pipelines, const girih_pipeline_key *key,
                                    const girih_plan *plan, const VkShaderModule modules[3],
                                    VkPipeline *pipeline, girih_error *error) {
    bool is_line = key->line_width > 0.0f;
    VkBool32 switches[7] = {key->has_base_color_map,
                            key->has_color,
                            key->alpha_mode == GIRIH_GLTF_ALPHA_MASK,
                            key->alpha_mode == GIRIH_GLTF_ALPHA_BLEND,
                            is_line,
                            key->has_normal_map,
                            key->cylindrical};
    VkSpecializationMapEntry entries[7];
    for (uint32_t n = 0; n < 7; n++) {
        entries[n] = (VkSpecializationMapEntry){n, 4 * n, 4};
    }
    VkSpecializationInfo specialization = {7, entries, sizeof switches, switches};
    const VkShaderStageFlagBits kinds[3] = {
        VK_SHADER_STAGE_VERTEX_BIT, VK_SHADER_STAGE_FRAGMENT_BIT, VK_SHADER_STAGE_GEOMETRY_BIT};
    VkPipelineShaderStageCreateInfo stages[3];
    for (int n = 0; n < 3; n++) {
        stages[n] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = kinds[n],
            .module = modules[n],
            .pName = "main",
            .pSpecializationInfo = key->background ? NULL : &specialization,
        };
    }
    buffer_input buffers;
    describe_buffers(pipelines, &buffers);
    VkPipelineVertexInputStateCreateInfo nothing = {
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
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = is_line ? VK_POLYGON_MODE_LINE : VK_POLYGON_MODE_FILL,
        .cullMode = key->cull,
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
        // Lines lie a little nearer than the triangles they run along; depth is reversed. At a
        // silhouette front and back faces meet, and rounding may put either first. A closed surface
        // has a front face wherever it has a back face, so pushed back, these show through holes
        // alone.
        .depthBiasEnable = is_line || key->behind,
        .depthBiasConstantFactor = is_line ? 16.0f : -64.0f,
        .depthBiasSlopeFactor = is_line ? 1.0f : -2.0f,
        .lineWidth = is_line ? fmaxf(1.0f, fminf(key->line_width, pipelines->widest_line)) : 1.0f,
    };
    VkPipelineMultisampleStateCreateInfo multisample = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = pipelines->samples,
    };
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = !key->background,
        .depthWriteEnable =
            !key->background && !is_line && key->alpha_mode != GIRIH_GLTF_ALPHA_BLEND,
        .depthCompareOp = VK_COMPARE_OP_GREATER_OR_EQUAL,
    };
    VkPipelineColorBlendAttachmentState attachment = blend_state(key);
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
        .stageCount = key->triangles ? 3 : 2,
        .pStages = stages,
        .pVertexInputState = key->background  ? &nothing
                             : key->instanced ? girih_plan_vertex_input(plan)
                                              : &buffers.info,
        .pInputAssemblyState = &assembly,
        .pViewportState = &viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &multisample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic,
        .layout = pipelines->layout,
        .renderPass = pipelines->pass,
    };
    VkResult result =
        vkCreateGraphicsPipelines(pipelines->device, VK_NULL_HANDLE, 1, &info, NULL, pipeline);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateGraphicsPipelines", result);
}

static bool keys_equal(const girih_pipeline_key *a, const girih_pipeline_key *b) {
    if (a->background || b->background) {
        return a->background == b->background;
    }
    return a->instanced == b->instanced && a->surface == b->surface &&
           a->has_splits == b->has_splits && a->has_base_color_map == b->has_base_color_map &&
           a->has_normal_map == b->has_normal_map && a->has_color == b->has_color &&
           a->alpha_mode == b->alpha_mode && a->cull == b->cull && a->line_width == b->line_width &&
           a->triangles == b->triangles && a->behind == b->behind &&
           a->cylindrical == b->cylindrical;
}

girih_result girih_pipelines_get(girih_pipelines *pipelines, const girih_pipeline_key *key,
                                 const girih_plan *plan, const girih_own_surface *own,
                                 VkPipeline *pipeline, girih_error *error) {
    uint32_t own_revision = uses_own(key) ? own->revision : 0;
    for (uint32_t n = 0; n < pipelines->count; n++) {
        if (keys_equal(&pipelines->entries[n].key, key) &&
            pipelines->entries[n].own_revision == own_revision) {
            *pipeline = pipelines->entries[n].pipeline;
            return GIRIH_OK;
        }
    }
    struct girih_pipeline_entry *grown =
        realloc(pipelines->entries, (pipelines->count + 1) * sizeof *pipelines->entries);
    if (grown == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    pipelines->entries = grown;
    VkShaderModule modules[3] = {VK_NULL_HANDLE, VK_NULL_HANDLE, VK_NULL_HANDLE};
    girih_result result = create_module(
        pipelines->device, choose_vertex_shader(pipelines, key, own), &modules[0], error);
    if (result == GIRIH_OK) {
        shader fragment = key->background  ? SHADER(background_fragment)
                          : key->triangles ? SHADER(model_triangles_fragment)
                                           : SHADER(model_fragment);
        result = create_module(pipelines->device, fragment, &modules[1], error);
    }
    if (result == GIRIH_OK && key->triangles) {
        result = create_module(pipelines->device, SHADER(triangle_geometry), &modules[2], error);
    }
    if (result == GIRIH_OK) {
        result = create_pipeline(pipelines, key, plan, modules, pipeline, error);
    }
    for (int n = 0; n < 3; n++) {
        vkDestroyShaderModule(pipelines->device, modules[n], NULL);
    }
    if (result == GIRIH_OK) {
        pipelines->entries[pipelines->count++] =
            (struct girih_pipeline_entry){*key, own_revision, *pipeline};
    }
    return result;
}

void girih_pipelines_free(girih_pipelines *pipelines) {
    for (uint32_t n = 0; n < pipelines->count; n++) {
        vkDestroyPipeline(pipelines->device, pipelines->entries[n].pipeline, NULL);
    }
    free(pipelines->entries);
    pipelines->entries = NULL;
    pipelines->count = 0;
}
