#include "gpu_frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "capture_buffers.spv.h"
#include "capture_instanced_flat.spv.h"
#include "capture_instanced_pn.spv.h"
#include "capture_split_flat.spv.h"
#include "capture_split_pn.spv.h"

girih_context *gpu_variant_context(gpu *host, gpu_variant variant) {
    const girih_context_desc desc = {.catalogue = variant.linear ? girih_catalogue_linear()
                                                                 : girih_catalogue_dyadic(),
                                     .sort = variant.sort,
                                     .few_buffers = variant.few_buffers};
    return gpu_context(host, &desc);
}

static void barrier(VkCommandBuffer commands, VkPipelineStageFlags from_stage,
                    VkAccessFlags from_access, VkPipelineStageFlags to_stage,
                    VkAccessFlags to_access) {
    const VkMemoryBarrier memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                    .srcAccessMask = from_access,
                                    .dstAccessMask = to_access};
    vkCmdPipelineBarrier(commands, from_stage, to_stage, 0, 1, &memory, 0, NULL, 0, NULL);
}

// A mapped buffer of at least `size` bytes.
static void grow(gpu *host, gpu_buffer *buffer, VkDeviceSize size, VkBufferUsageFlags usage) {
    if (buffer->size < size) {
        if (buffer->buffer) {
            gpu_destroy_buffer(host, buffer);
        }
        *buffer = gpu_create_buffer(host, size, usage, true);
    }
}

typedef struct output {
    uint32_t binding;
    const girih_buffer *buffer;
} output;

#define OUTPUTS 5

static void list_outputs(const girih_plan *plan, output outputs[OUTPUTS]) {
    for (uint32_t n = 0; n < OUTPUTS; ++n) {
        outputs[n] =
            (output){GIRIH_BIND_OUT_POSITIONS + n, &plan->buffers[GIRIH_PLAN_POSITIONS + n]};
    }
}

void gpu_refine(gpu *host, girih_plan *plan, const girih_frame *frame, gpu_readback *readback) {
    output outputs[OUTPUTS];
    list_outputs(plan, outputs);
    const girih_buffer *work = &plan->buffers[GIRIH_PLAN_WORK];
    VkDeviceSize size = work->size;
    for (int n = 0; n < OUTPUTS; ++n) {
        size += outputs[n].buffer->size;
    }
    grow(host, &readback->buffer, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    VkCommandBuffer commands = gpu_begin(host);
    barrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
            VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
            VK_ACCESS_TRANSFER_WRITE_BIT);
    for (int n = 0; n < OUTPUTS; ++n) {
        if (outputs[n].buffer->buffer) {
            vkCmdFillBuffer(commands, outputs[n].buffer->buffer, outputs[n].buffer->offset,
                            outputs[n].buffer->size, 0xa5a5a5a5u);
        }
    }
    girih_error error = {GIRIH_OK, ""};
    girih_plan_invalidate(plan); // its outputs have just been filled
    gpu_girih(girih_cmd_refine(plan, commands, frame, NULL, &error), &error);
    // girih_cmd_refine ends with its writes visible to transfer reads, so nothing is waited for
    // here.
    VkBufferCopy copy = {.srcOffset = work->offset, .size = work->size};
    vkCmdCopyBuffer(commands, work->buffer, readback->buffer.buffer, 1, &copy);
    const char *bytes = readback->buffer.mapped;
    memset(readback->words, 0, sizeof readback->words);
    for (uint32_t n = GIRIH_BIND_INSTANCES; n <= GIRIH_BIND_WELD_OFFSETS; ++n) {
        readback->words[n] = (const uint32_t *)(const void *)(bytes + plan->offset[n]);
    }
    for (int n = 0; n < OUTPUTS; ++n) {
        if (outputs[n].buffer->buffer) {
            copy.dstOffset += copy.size;
            copy.srcOffset = outputs[n].buffer->offset;
            copy.size = outputs[n].buffer->size;
            vkCmdCopyBuffer(commands, outputs[n].buffer->buffer, readback->buffer.buffer, 1, &copy);
            readback->words[outputs[n].binding] =
                (const uint32_t *)(const void *)(bytes + copy.dstOffset);
        }
    }
    barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
            VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    gpu_run(host, commands);
}

void gpu_readback_free(gpu *host, gpu_readback *readback) {
    if (readback->buffer.buffer) {
        gpu_destroy_buffer(host, &readback->buffer);
    }
    memset(readback->words, 0, sizeof readback->words);
}

// --- Capture
// ----------------------------------------------------------------------------------------

gpu_capture gpu_capture_open(gpu *host, const girih_context *context) {
    gpu_capture capture = {.gpu = host, .context = context};
    if (!host->transform_feedback) {
        fprintf(stderr,
                "the device lacks VK_EXT_transform_feedback, which the capture of draws needs\n");
        exit(1);
    }
    capture.bind = (PFN_vkCmdBindTransformFeedbackBuffersEXT)vkGetDeviceProcAddr(
        host->device, "vkCmdBindTransformFeedbackBuffersEXT");
    capture.begin = (PFN_vkCmdBeginTransformFeedbackEXT)vkGetDeviceProcAddr(
        host->device, "vkCmdBeginTransformFeedbackEXT");
    capture.end = (PFN_vkCmdEndTransformFeedbackEXT)vkGetDeviceProcAddr(
        host->device, "vkCmdEndTransformFeedbackEXT");
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS};
    const VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .subpassCount = 1,
                                         .pSubpasses = &subpass};
    gpu_check(vkCreateRenderPass(host->device, &pass, NULL, &capture.pass), "vkCreateRenderPass");
    const VkFramebufferCreateInfo framebuffer = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                 .renderPass = capture.pass,
                                                 .width = 16,
                                                 .height = 16,
                                                 .layers = 1};
    gpu_check(vkCreateFramebuffer(host->device, &framebuffer, NULL, &capture.framebuffer),
              "vkCreateFramebuffer");
    const VkDescriptorSetLayout set = girih_context_draw_set_layout(context);
    const VkPipelineLayoutCreateInfo layout = {.sType =
                                                   VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 1,
                                               .pSetLayouts = &set};
    gpu_check(vkCreatePipelineLayout(host->device, &layout, NULL, &capture.layout),
              "vkCreatePipelineLayout");
    capture.counter =
        gpu_create_buffer(host, 4, VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_COUNTER_BUFFER_BIT_EXT, true);
    return capture;
}

// Which of a capture's pipelines draws a plan.
enum { SPLITS = 2, FROM_BUFFERS = GPU_CAPTURE_BUFFERS, OWN, OWN_PREVIOUS, OWN_SPLITS, PIPELINES };

static int choose_pipeline(const gpu_capture *capture, const girih_plan *plan) {
    const bool splits = plan->arrays.frame.max_splits > 0;
    if (plan->mode != GIRIH_MODE_INSTANCED) {
        return FROM_BUFFERS;
    }
    if (plan->surface != GIRIH_SURFACE_OWN) {
        return (int)plan->surface + (splits ? SPLITS : 0);
    }
    return splits ? OWN_SPLITS : capture->previous ? OWN_PREVIOUS : OWN;
}

static void forget_own(gpu_capture *capture) {
    VkDevice device = capture->gpu->device;
    for (int n = OWN; n < PIPELINES; ++n) {
        vkDestroyPipeline(device, capture->pipelines[n], NULL);
        capture->pipelines[n] = VK_NULL_HANDLE;
    }
    vkDestroyPipelineLayout(device, capture->own_layout, NULL);
    capture->own_layout = VK_NULL_HANDLE;
}

void gpu_capture_own(gpu_capture *capture, const gpu_own_shader *own) {
    forget_own(capture);
    capture->own = *own;
    const VkDescriptorSetLayout sets[2] = {girih_context_draw_set_layout(capture->context),
                                           own->layout};
    const VkPipelineLayoutCreateInfo layout = {.sType =
                                                   VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 2,
                                               .pSetLayouts = sets};
    gpu_check(vkCreatePipelineLayout(capture->gpu->device, &layout, NULL, &capture->own_layout),
              "vkCreatePipelineLayout");
}

void gpu_capture_close(gpu_capture *capture) {
    VkDevice device = capture->gpu->device;
    forget_own(capture);
    for (int n = 0; n < OWN; ++n) {
        vkDestroyPipeline(device, capture->pipelines[n], NULL);
    }
    vkDestroyPipelineLayout(device, capture->layout, NULL);
    vkDestroyFramebuffer(device, capture->framebuffer, NULL);
    vkDestroyRenderPass(device, capture->pass, NULL);
    gpu_destroy_buffer(capture->gpu, &capture->counter);
    if (capture->corners.buffer) {
        gpu_destroy_buffer(capture->gpu, &capture->corners);
    }
}

static VkPipeline create_pipeline(const gpu_capture *capture, const girih_plan *plan, int which) {
    gpu *host = capture->gpu;
    const bool buffers = which == FROM_BUFFERS;
    static const struct {
        const uint32_t *words;
        size_t bytes;
    } instanced[FROM_BUFFERS] = {{capture_instanced_flat, sizeof capture_instanced_flat},
                                 {capture_instanced_pn, sizeof capture_instanced_pn},
                                 {capture_split_flat, sizeof capture_split_flat},
                                 {capture_split_pn, sizeof capture_split_pn}};
    VkShaderModule module =
        buffers ? gpu_shader(host, capture_buffers, sizeof capture_buffers)
        : which >= OWN
            ? gpu_shader(host, capture->own.words[which - OWN], capture->own.bytes[which - OWN])
            : gpu_shader(host, instanced[which].words, instanced[which].bytes);
    VkPipelineVertexInputStateCreateInfo input = *girih_plan_vertex_input(plan);
    VkVertexInputAttributeDescription attributes[16];
    memcpy(attributes, input.pVertexAttributeDescriptions,
           input.vertexAttributeDescriptionCount * sizeof *attributes);
    if (buffers) {
        attributes[input.vertexAttributeDescriptionCount++] =
            (VkVertexInputAttributeDescription){2, 1, VK_FORMAT_R32G32_SFLOAT, 12};
    }
    input.pVertexAttributeDescriptions = attributes;
    const VkPipelineShaderStageCreateInfo stage = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
        .stage = VK_SHADER_STAGE_VERTEX_BIT,
        .module = module,
        .pName = "main"};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineRasterizationStateCreateInfo rasterization = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .rasterizerDiscardEnable = VK_TRUE,
        .lineWidth = 1};
    const VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = 1,
        .pStages = &stage,
        .pVertexInputState = &input,
        .pInputAssemblyState = &assembly,
        .pRasterizationState = &rasterization,
        .layout = which >= OWN ? capture->own_layout : capture->layout,
        .renderPass = capture->pass};
    VkPipeline pipeline;
    gpu_check(vkCreateGraphicsPipelines(host->device, VK_NULL_HANDLE, 1, &info, NULL, &pipeline),
              "vkCreateGraphicsPipelines");
    vkDestroyShaderModule(host->device, module, NULL);
    return pipeline;
}

void gpu_record_draw(gpu_capture *capture, const girih_plan *plan, VkCommandBuffer commands,
                     uint32_t room) {
    const VkDeviceSize bytes = (VkDeviceSize)(room + 1) * 3 * GPU_CAPTURE_FLOATS * sizeof(float);
    grow(capture->gpu, &capture->corners, bytes, VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_BUFFER_BIT_EXT);
    const int which = choose_pipeline(capture, plan);
    VkPipeline *pipeline = &capture->pipelines[which];
    if (!*pipeline) {
        *pipeline = create_pipeline(capture, plan, which);
    }
    const VkPipelineLayout layout = which >= OWN ? capture->own_layout : capture->layout;
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = capture->pass,
                                        .framebuffer = capture->framebuffer,
                                        .renderArea = {.extent = {16, 16}}};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, *pipeline);
    if (which >= OWN) {
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 1, 1,
                                &capture->own.set, 0, NULL);
    }
    const VkDeviceSize zero = 0;
    capture->bind(commands, 0, 1, &capture->corners.buffer, &zero, &capture->corners.size);
    capture->begin(commands, 0, 0, NULL, NULL);
    for (uint32_t material = 0; material < girih_plan_material_count(plan); ++material) {
        girih_cmd_draw(plan, commands, material, layout, 0);
    }
    capture->end(commands, 0, 1, &capture->counter.buffer, &zero);
    vkCmdEndRenderPass(commands);
    barrier(commands, VK_PIPELINE_STAGE_TRANSFORM_FEEDBACK_BIT_EXT,
            VK_ACCESS_TRANSFORM_FEEDBACK_WRITE_BIT_EXT |
                VK_ACCESS_TRANSFORM_FEEDBACK_COUNTER_WRITE_BIT_EXT,
            VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

uint32_t gpu_drawn(const gpu_capture *capture) {
    uint32_t bytes;
    memcpy(&bytes, capture->counter.mapped, sizeof bytes);
    return bytes / (uint32_t)(3 * GPU_CAPTURE_FLOATS * sizeof(float));
}

uint32_t gpu_draw(gpu_capture *capture, girih_plan *plan, const girih_frame *frame, uint32_t room) {
    memset(capture->counter.mapped, 0, sizeof(uint32_t));
    VkCommandBuffer commands = gpu_begin(capture->gpu);
    if (frame) {
        girih_error error = {GIRIH_OK, ""};
        gpu_girih(girih_cmd_refine(plan, commands, frame, NULL, &error), &error);
    }
    gpu_record_draw(capture, plan, commands, room);
    gpu_run(capture->gpu, commands);
    return gpu_drawn(capture);
}
