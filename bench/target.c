// Render targets, pipelines and timing of one frame.
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench.h"
#include "error.h"
#include "statistics.h"

#include "bench_fragment.spv.h"

#define MOST_METHODS 8

struct bench_target {
    girih_device *device;
    const bench_method *methods;
    uint32_t method_count;
    girih_device_image color, depth;
    VkRenderPass pass;
    VkFramebuffer framebuffer;
    VkPipelineLayout layout;
    VkPipeline pipelines[MOST_METHODS][2];
};

static girih_result create_images(bench_target *target, girih_error *error) {
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = VK_FORMAT_R8G8B8A8_UNORM,
                              .extent = {BENCH_PIXELS, BENCH_PIXELS, 1},
                              .mipLevels = 1,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT};
    girih_result result = girih_device_image_create(target->device, &target->color, &info,
                                                    VK_IMAGE_ASPECT_COLOR_BIT, error);
    if (result == GIRIH_OK) {
        info.format = VK_FORMAT_D32_SFLOAT;
        info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
        result = girih_device_image_create(target->device, &target->depth, &info,
                                           VK_IMAGE_ASPECT_DEPTH_BIT, error);
    }
    return result;
}

static girih_result create_pass(bench_target *target, girih_error *error) {
    const VkAttachmentDescription attachments[2] = {
        {.format = VK_FORMAT_R8G8B8A8_UNORM,
         .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
         .finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
        {.format = VK_FORMAT_D32_SFLOAT,
         .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                          .colorAttachmentCount = 1,
                                          .pColorAttachments = &color,
                                          .pDepthStencilAttachment = &depth};
    const VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .attachmentCount = 2,
                                         .pAttachments = attachments,
                                         .subpassCount = 1,
                                         .pSubpasses = &subpass};
    VkResult result = vkCreateRenderPass(target->device->device, &pass, NULL, &target->pass);
    if (result == VK_SUCCESS) {
        const VkImageView views[2] = {target->color.view, target->depth.view};
        const VkFramebufferCreateInfo framebuffer = {.sType =
                                                         VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                     .renderPass = target->pass,
                                                     .attachmentCount = 2,
                                                     .pAttachments = views,
                                                     .width = BENCH_PIXELS,
                                                     .height = BENCH_PIXELS,
                                                     .layers = 1};
        result =
            vkCreateFramebuffer(target->device->device, &framebuffer, NULL, &target->framebuffer);
    }
    if (result == VK_SUCCESS) {
        const VkPushConstantRange camera = {.stageFlags = VK_SHADER_STAGE_VERTEX_BIT, .size = 64};
        const VkPipelineLayoutCreateInfo layout = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
            .pushConstantRangeCount = 1,
            .pPushConstantRanges = &camera};
        result = vkCreatePipelineLayout(target->device->device, &layout, NULL, &target->layout);
    }
    return result == VK_SUCCESS
               ? GIRIH_OK
               : girih_vulkan_failure(error, "creating the bench's render pass", result);
}

static VkResult create_pipeline(bench_target *target, const bench_method *method,
                                bench_raster raster, VkShaderModule vertex, VkShaderModule fragment,
                                VkPipeline *pipeline) {
    const VkPipelineShaderStageCreateInfo stages[2] = {
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_VERTEX_BIT,
         .module = vertex,
         .pName = "main"},
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
         .module = fragment,
         .pName = "main"}};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkViewport viewport = {.width = BENCH_PIXELS, .height = BENCH_PIXELS, .maxDepth = 1};
    const VkRect2D scissor = {.extent = {BENCH_PIXELS, BENCH_PIXELS}};
    const VkPipelineViewportStateCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .pViewports = &viewport,
        .scissorCount = 1,
        .pScissors = &scissor};
    const VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .rasterizerDiscardEnable = raster == BENCH_GEOMETRY,
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
    const VkGraphicsPipelineCreateInfo info = {.sType =
                                                   VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                               .stageCount = raster == BENCH_GEOMETRY ? 1 : 2,
                                               .pStages = stages,
                                               .pVertexInputState = method->vertex_input,
                                               .pInputAssemblyState = &assembly,
                                               .pViewportState = &view,
                                               .pRasterizationState = &rasterization,
                                               .pMultisampleState = &multisample,
                                               .pDepthStencilState = &depth,
                                               .pColorBlendState = &blending,
                                               .layout = target->layout,
                                               .renderPass = target->pass};
    return vkCreateGraphicsPipelines(target->device->device, VK_NULL_HANDLE, 1, &info, NULL,
                                     pipeline);
}

static VkResult create_module(const girih_device *device, const uint32_t *words, size_t bytes,
                              VkShaderModule *module) {
    const VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
    return vkCreateShaderModule(device->device, &info, NULL, module);
}

girih_result bench_target_create(girih_device *device, const bench_method *methods,
                                 uint32_t method_count, bench_target **out, girih_error *error) {
    bench_target *target = calloc(1, sizeof *target);
    if (!target || method_count > MOST_METHODS) {
        free(target);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    target->device = device;
    target->methods = methods;
    target->method_count = method_count;
    girih_result result = create_images(target, error);
    if (result == GIRIH_OK) {
        result = create_pass(target, error);
    }
    VkShaderModule fragment = VK_NULL_HANDLE;
    VkResult created = VK_SUCCESS;
    if (result == GIRIH_OK) {
        created = create_module(device, girih_spirv_bench_fragment,
                                sizeof girih_spirv_bench_fragment, &fragment);
    }
    for (uint32_t n = 0; n < method_count && result == GIRIH_OK && created == VK_SUCCESS; ++n) {
        VkShaderModule vertex = VK_NULL_HANDLE;
        created = create_module(device, methods[n].vertex_shader, methods[n].vertex_shader_bytes,
                                &vertex);
        for (uint32_t raster = 0; raster < 2 && created == VK_SUCCESS; ++raster) {
            created = create_pipeline(target, &methods[n], raster, vertex, fragment,
                                      &target->pipelines[n][raster]);
        }
        vkDestroyShaderModule(device->device, vertex, NULL);
    }
    vkDestroyShaderModule(device->device, fragment, NULL);
    if (result == GIRIH_OK && created != VK_SUCCESS) {
        result = girih_vulkan_failure(error, "creating the bench's pipelines", created);
    }
    if (result != GIRIH_OK) {
        bench_target_destroy(target);
        return result;
    }
    *out = target;
    return GIRIH_OK;
}

void bench_target_destroy(bench_target *target) {
    if (!target) {
        return;
    }
    const VkDevice device = target->device->device;
    for (uint32_t n = 0; n < MOST_METHODS; ++n) {
        vkDestroyPipeline(device, target->pipelines[n][0], NULL);
        vkDestroyPipeline(device, target->pipelines[n][1], NULL);
    }
    vkDestroyPipelineLayout(device, target->layout, NULL);
    vkDestroyFramebuffer(device, target->framebuffer, NULL);
    vkDestroyRenderPass(device, target->pass, NULL);
    girih_device_image_destroy(target->device, &target->depth);
    girih_device_image_destroy(target->device, &target->color);
    free(target);
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}

girih_result bench_frame(bench_target *target, uint32_t method, bench_raster raster, uint32_t frame,
                         double *milliseconds, girih_error *error) {
    const bench_method *m = &target->methods[method];
    const double begin = now();
    girih_result result = girih_device_begin(target->device, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const VkCommandBuffer commands = target->device->commands;
    if (m->prepare) {
        result = m->prepare(m->state, commands, frame, error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    const VkClearValue clears[2] = {{.color = {.float32 = {0, 0, 0, 1}}},
                                    {.depthStencil = {.depth = 1}}};
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = target->pass,
                                        .framebuffer = target->framebuffer,
                                        .renderArea = {.extent = {BENCH_PIXELS, BENCH_PIXELS}},
                                        .clearValueCount = 2,
                                        .pClearValues = clears};
    // A unit sphere seen whole: orthographic, looking along -z.
    static const float camera[4][4] = {
        {0.9f, 0, 0, 0}, {0, -0.9f, 0, 0}, {0, 0, -0.4f, 0.5f}, {0, 0, 0, 1}};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, target->pipelines[method][raster]);
    vkCmdPushConstants(commands, target->layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof camera,
                       camera);
    m->draw(m->state, commands);
    vkCmdEndRenderPass(commands);
    result = girih_device_finish(target->device, error);
    *milliseconds = now() - begin;
    return result;
}

// One method's figures from its own times and the paired times of method 0.
static json_t *figures(const double *own, const double *base, uint32_t pairs) {
    double sorted[STATISTICS_MOST];
    double ratios[STATISTICS_MOST];
    double low, high;
    memcpy(sorted, own, pairs * sizeof *sorted);
    const double median = statistics_median(sorted, pairs);
    for (uint32_t n = 0; n < pairs; ++n) {
        ratios[n] = own[n] / base[n];
    }
    statistics_interval(ratios, pairs, &low, &high);
    return json_pack("{s:f,s:f,s:f,s:f,s:f,s:f}", "median_ms", median, "min_ms", sorted[0],
                     "max_ms", sorted[pairs - 1], "ratio", statistics_median(ratios, pairs),
                     "ratio_low", low, "ratio_high", high);
}

girih_result bench_measure(bench_target *target, const bench_method *list, uint32_t method_count,
                           uint32_t pairs, json_t *methods, girih_error *error) {
    static double own[STATISTICS_MOST];
    static double base[STATISTICS_MOST];
    static const char *const names[2] = {"geometry", "shaded"};
    for (uint32_t method = 0; method < method_count; ++method) {
        json_t *object = json_object();
        for (uint32_t raster = 0; raster < 2; ++raster) {
            double warm_up;
            girih_result result = GIRIH_OK;
            for (uint32_t n = 0; n < 4 && result == GIRIH_OK; ++n) {
                result = bench_frame(target, n % 2 ? method : 0, raster, n, &warm_up, error);
            }
            for (uint32_t n = 0; n < pairs && result == GIRIH_OK; ++n) {
                // Which of the two goes first alternates too.
                double *const first = n % 2 ? &own[n] : &base[n];
                double *const second = n % 2 ? &base[n] : &own[n];
                result = bench_frame(target, n % 2 ? method : 0, raster, n, first, error);
                if (result == GIRIH_OK) {
                    result = bench_frame(target, n % 2 ? 0 : method, raster, n, second, error);
                }
            }
            if (result != GIRIH_OK) {
                json_decref(object);
                return result;
            }
            json_object_set_new(object, names[raster], figures(own, base, pairs));
        }
        json_object_set_new(methods, list[method].name, object);
    }
    return GIRIH_OK;
}
