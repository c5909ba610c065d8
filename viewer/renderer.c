#include "renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "panorama.h"
#include "pipelines.h"
#include "textures.h"

static const VkFormat color_format = VK_FORMAT_R8G8B8A8_SRGB;

struct girih_renderer {
    girih_renderer_desc desc;
    girih_device *device;
    girih_textures textures;
    girih_device_image color, resolved, depth;
    VkFormat depth_format;
    VkFramebuffer framebuffer;
    girih_device_buffer picture_block, range_colors, readback;
    uint32_t slice_count;  // a panorama's; else the one that is all of the picture
    uint32_t block_stride; // bytes from one slice's picture_block to the next one's
    VkDescriptorSetLayout picture_layout, material_layout;
    VkDescriptorPool descriptors;
    VkDescriptorSet picture_set;
    VkDescriptorSet *material_sets; // [model->material_count]
    girih_pipelines pipelines;
    VkQueryPool queries;
};

// --- Attachments ---

static bool is_depth_attachment(const girih_device *device, VkFormat format) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device->physical, format, &properties);
    return (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
}

static girih_result create_attachment(const girih_renderer *renderer, girih_device_image *image,
                                      VkFormat format, VkSampleCountFlagBits samples,
                                      VkImageUsageFlags usage, girih_error *error) {
    VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {renderer->desc.width, renderer->desc.height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = samples,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = usage,
    };
    bool is_depth = (usage & VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
    return girih_device_image_create(
        renderer->device, image, &info,
        is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, error);
}

static girih_result create_attachments(girih_renderer *renderer, girih_error *error) {
    const VkPhysicalDeviceLimits *limits = &renderer->device->properties.limits;
    if (renderer->desc.width > limits->maxFramebufferWidth ||
        renderer->desc.height > limits->maxFramebufferHeight ||
        renderer->desc.width > limits->maxImageDimension2D ||
        renderer->desc.height > limits->maxImageDimension2D ||
        renderer->desc.width > limits->maxViewportDimensions[0] ||
        renderer->desc.height > limits->maxViewportDimensions[1]) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "--resolution %u,%u: the device draws at most %u x %u pixels",
                          renderer->desc.width, renderer->desc.height, limits->maxFramebufferWidth,
                          limits->maxFramebufferHeight);
    }
    VkSampleCountFlags samples =
        limits->framebufferColorSampleCounts & limits->framebufferDepthSampleCounts;
    renderer->pipelines.samples =
        (samples & VK_SAMPLE_COUNT_4_BIT) != 0 ? VK_SAMPLE_COUNT_4_BIT : VK_SAMPLE_COUNT_1_BIT;
    renderer->depth_format = is_depth_attachment(renderer->device, VK_FORMAT_D32_SFLOAT)
                                 ? VK_FORMAT_D32_SFLOAT
                                 : VK_FORMAT_X8_D24_UNORM_PACK32;
    VkImageUsageFlags color = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    girih_result result = GIRIH_OK;
    if (renderer->pipelines.samples != VK_SAMPLE_COUNT_1_BIT) {
        result = create_attachment(renderer, &renderer->color, color_format,
                                   renderer->pipelines.samples, color, error);
    }
    if (result == GIRIH_OK) {
        result =
            create_attachment(renderer, &renderer->resolved, color_format, VK_SAMPLE_COUNT_1_BIT,
                              color | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, error);
    }
    if (result == GIRIH_OK) {
        result = create_attachment(renderer, &renderer->depth, renderer->depth_format,
                                   renderer->pipelines.samples,
                                   VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, error);
    }
    return result;
}

// Attachments: depth, resolved colour and, with several samples, the colour that is resolved.
static girih_result create_pass(girih_renderer *renderer, girih_error *error) {
    bool resolves = renderer->pipelines.samples != VK_SAMPLE_COUNT_1_BIT;
    VkAttachmentDescription attachments[3] = {
        {.format = renderer->depth_format,
         .samples = renderer->pipelines.samples,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL},
        {.format = color_format,
         .samples = VK_SAMPLE_COUNT_1_BIT,
         .loadOp = resolves ? VK_ATTACHMENT_LOAD_OP_DONT_CARE : VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
         .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
        {.format = color_format,
         .samples = renderer->pipelines.samples,
         .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
         .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
         .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
         .finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
    };
    VkAttachmentReference depth = {0, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkAttachmentReference color = {resolves ? 2 : 1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkAttachmentReference resolved = {1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {
        .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
        .colorAttachmentCount = 1,
        .pColorAttachments = &color,
        .pResolveAttachments = resolves ? &resolved : NULL,
        .pDepthStencilAttachment = &depth,
    };
    VkPipelineStageFlags drawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                   VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                   VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    VkAccessFlags written =
        VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    VkSubpassDependency dependencies[2] = {
        {VK_SUBPASS_EXTERNAL, 0, drawing | VK_PIPELINE_STAGE_TRANSFER_BIT, drawing, written,
         written | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT, 0},
        {0, VK_SUBPASS_EXTERNAL, drawing, VK_PIPELINE_STAGE_TRANSFER_BIT, written,
         VK_ACCESS_TRANSFER_READ_BIT, 0},
    };
    VkRenderPassCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
        .attachmentCount = resolves ? 3 : 2,
        .pAttachments = attachments,
        .subpassCount = 1,
        .pSubpasses = &subpass,
        .dependencyCount = 2,
        .pDependencies = dependencies,
    };
    VkResult result =
        vkCreateRenderPass(renderer->device->device, &info, NULL, &renderer->pipelines.pass);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateRenderPass", result);
    }
    VkImageView views[3] = {renderer->depth.view, renderer->resolved.view, renderer->color.view};
    VkFramebufferCreateInfo framebuffer = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
        .renderPass = renderer->pipelines.pass,
        .attachmentCount = resolves ? 3 : 2,
        .pAttachments = views,
        .width = renderer->desc.width,
        .height = renderer->desc.height,
        .layers = 1,
    };
    result =
        vkCreateFramebuffer(renderer->device->device, &framebuffer, NULL, &renderer->framebuffer);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreateFramebuffer", result);
}

// --- What the shaders read ---

// A colour of full value around the circle of hues, in [0, 1).
static void hue_color(float hue, float saturation, float value, float color[4]) {
    for (int n = 0; n < 3; n++) {
        float turn = hue * 6.0f + (n == 0 ? 0.0f : n == 1 ? 4.0f : 2.0f);
        turn -= 6.0f * floorf(turn / 6.0f);
        float ramp = fabsf(turn - 3.0f) - 1.0f;
        ramp = ramp < 0.0f ? 0.0f : ramp > 1.0f ? 1.0f : ramp;
        color[n] = value * (1.0f - saturation + saturation * ramp);
    }
    color[3] = 1.0f;
}

// Colours by range: ranges are numbered in the order of their base patterns, those with i > j > k
// take two. Returns their number; colors may be NULL.
static uint32_t fill_range_colors(const girih_catalogue *catalogue, girih_shade shade,
                                  float (*colors)[4]) {
    uint32_t range = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const uint8_t *levels = girih_catalogue_pattern(catalogue, rank)->levels;
        float color[4];
        if (shade == GIRIH_SHADE_PATTERNS) {
            // Steps of the golden ratio keep neighbours in rank far apart in hue.
            float hue = (float)rank * 0.61803399f;
            hue_color(hue - floorf(hue), 0.35f + 0.15f * (float)(rank % 4),
                      0.95f - 0.12f * (float)(rank % 3), color);
        } else {
            float last = catalogue->level_count > 1 ? (float)(catalogue->level_count - 1) : 1.0f;
            hue_color(0.62f * (1.0f - (float)levels[0] / last), 0.7f, 0.95f, color);
        }
        uint32_t ranges = levels[0] > levels[1] && levels[1] > levels[2] ? 2 : 1;
        for (uint32_t n = 0; n < ranges; n++, range++) {
            if (colors != NULL) {
                memcpy(colors[range], color, sizeof color);
            }
        }
    }
    return range;
}

static void combine(float to[4], const girih_view *view, float right, float up, float back) {
    float length = sqrtf(right * right + up * up + back * back);
    for (int n = 0; n < 3; n++) {
        to[n] = (right * view->right[n] + up * view->up[n] + back * view->back[n]) / length;
    }
    to[3] = 0.0f;
}

// The columns of a drawing that slice n takes.
static girih_panorama_slice find_slice(const girih_renderer *renderer, uint32_t n,
                                       uint32_t drawing_width) {
    if (!renderer->desc.view->cylindrical) {
        return (girih_panorama_slice){.width = drawing_width};
    }
    return girih_panorama_slice_get(n, drawing_width, renderer->desc.view->view_angle);
}

static void fill_panorama(girih_picture_block *block, const girih_view *view,
                          const girih_panorama_slice *slice) {
    double cosine = cos(slice->middle);
    double sine = sin(slice->middle);
    for (int n = 0; n < 3; n++) {
        double right = view->right[n];
        double back = view->back[n];
        block->panorama_forward[n] = (float)(sine * right - cosine * back);
        block->panorama_right[n] = (float)(cosine * right + sine * back);
        block->panorama_up[n] = view->up[n];
    }
    block->panorama_forward[3] = (float)slice->half_angle;
    memcpy(block->panorama_slopes_depth, view->slopes, sizeof view->slopes);
    memcpy(block->panorama_slopes_depth + 2, view->depth, sizeof view->depth);
}

// Drawings side by side are equally wide, so they share the blocks of their slices.
static void write_picture_blocks(girih_renderer *renderer, girih_picture_block *block) {
    const girih_renderer_desc *desc = &renderer->desc;
    for (uint32_t n = 0; n < renderer->slice_count; n++) {
        if (desc->view->cylindrical) {
            girih_panorama_slice slice = find_slice(renderer, n, desc->drawing_width);
            fill_panorama(block, desc->view, &slice);
        }
        memcpy((char *)renderer->picture_block.mapped + (size_t)n * renderer->block_stride, block,
               sizeof *block);
    }
}

static girih_result fill_buffers(girih_renderer *renderer, girih_error *error) {
    const girih_renderer_desc *desc = &renderer->desc;
    uint32_t range_count = fill_range_colors(desc->catalogue, desc->shade, NULL);
    girih_result result = girih_device_buffer_create(
        renderer->device, &renderer->range_colors, (VkDeviceSize)range_count * 16,
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GIRIH_MEMORY_UPLOAD, error);
    if (result == GIRIH_OK) {
        fill_range_colors(desc->catalogue, desc->shade, renderer->range_colors.mapped);
        uint32_t alignment =
            (uint32_t)renderer->device->properties.limits.minUniformBufferOffsetAlignment;
        renderer->block_stride =
            ((uint32_t)sizeof(girih_picture_block) + alignment - 1) / alignment * alignment;
        renderer->slice_count =
            desc->view->cylindrical ? girih_panorama_slice_count(desc->view->view_angle) : 1;
        result = girih_device_buffer_create(
            renderer->device, &renderer->picture_block,
            (VkDeviceSize)renderer->slice_count * renderer->block_stride,
            VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GIRIH_MEMORY_UPLOAD, error);
    }
    if (result == GIRIH_OK) {
        girih_picture_block block = {
            .shade = desc->shade == GIRIH_SHADE_PATTERNS ? GIRIH_SHADE_LEVELS : desc->shade,
            .range_count = range_count,
            .attribute_floats = desc->model->attribute_floats,
            .texcoord_float = desc->model->texcoord_float,
            .texcoord_floats = desc->model->texcoord_floats,
            .color_float = desc->model->color_float,
        };
        memcpy(block.view_projection, desc->view->view_projection, sizeof block.view_projection);
        memcpy(block.eye, desc->view->eye, sizeof desc->view->eye);
        block.eye[3] = desc->view->orthographic ? 0.0f : 1.0f;
        combine(block.key_light, desc->view, -0.5f, 0.7f, 0.75f);
        combine(block.fill_light, desc->view, 0.85f, 0.1f, 0.5f);
        if (desc->has_back_face_color) {
            memcpy(block.back_face, desc->back_face_color, sizeof desc->back_face_color);
            block.back_face[3] = 1.0f;
        }
        write_picture_blocks(renderer, &block);
        result = girih_device_buffer_create(
            renderer->device, &renderer->readback, (VkDeviceSize)desc->width * desc->height * 4,
            VK_BUFFER_USAGE_TRANSFER_DST_BIT, GIRIH_MEMORY_READBACK, error);
    }
    return result;
}

static girih_result create_layouts(girih_renderer *renderer, girih_error *error) {
    VkDevice device = renderer->device->device;
    VkShaderStageFlags both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    VkDescriptorSetLayoutBinding picture[2] = {
        {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1, both, NULL},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT, NULL},
    };
    VkDescriptorSetLayoutBinding material[2] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, NULL},
        {1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, NULL},
    };
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = 2,
                                            .pBindings = picture};
    VkResult result = vkCreateDescriptorSetLayout(device, &info, NULL, &renderer->picture_layout);
    if (result == VK_SUCCESS) {
        info.pBindings = material;
        result = vkCreateDescriptorSetLayout(device, &info, NULL, &renderer->material_layout);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorSetLayout", result);
    }
    VkDescriptorSetLayout sets[4] = {renderer->picture_layout, renderer->material_layout};
    uint32_t set_count = 2;
    if (renderer->desc.context != NULL) {
        sets[set_count++] = girih_context_draw_set_layout(renderer->desc.context);
    }
    if (renderer->desc.own != NULL && renderer->desc.own->layout != VK_NULL_HANDLE) {
        sets[set_count++] = renderer->desc.own->layout;
    }
    VkPushConstantRange push = {both, 0, sizeof(girih_material_block)};
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = set_count,
        .pSetLayouts = sets,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &push,
    };
    result = vkCreatePipelineLayout(device, &layout, NULL, &renderer->pipelines.layout);
    return result == VK_SUCCESS ? GIRIH_OK
                                : girih_vulkan_failure(error, "vkCreatePipelineLayout", result);
}

static const girih_gltf_material *find_material(const girih_model *model, uint32_t material) {
    int32_t number = model->materials[material];
    return number < 0 ? NULL : &model->contents->materials[number];
}

static girih_result create_sets(girih_renderer *renderer, girih_error *error) {
    VkDevice device = renderer->device->device;
    uint32_t material_count = renderer->desc.model->material_count;
    VkDescriptorPoolSize sizes[3] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * material_count}};
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = material_count + 1,
        .poolSizeCount = 3,
        .pPoolSizes = sizes,
    };
    VkResult result = vkCreateDescriptorPool(device, &pool, NULL, &renderer->descriptors);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorPool", result);
    }
    VkDescriptorSetAllocateInfo allocate = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = renderer->descriptors,
        .descriptorSetCount = 1,
        .pSetLayouts = &renderer->picture_layout,
    };
    result = vkAllocateDescriptorSets(device, &allocate, &renderer->picture_set);
    allocate.pSetLayouts = &renderer->material_layout;
    renderer->material_sets = calloc((size_t)material_count + 1, sizeof *renderer->material_sets);
    if (renderer->material_sets == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < material_count && result == VK_SUCCESS; n++) {
        result = vkAllocateDescriptorSets(device, &allocate, &renderer->material_sets[n]);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkAllocateDescriptorSets", result);
    }
    VkDescriptorBufferInfo buffers[2] = {
        {renderer->picture_block.buffer, 0, sizeof(girih_picture_block)},
        {renderer->range_colors.buffer, 0, VK_WHOLE_SIZE}};
    VkWriteDescriptorSet write = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
        .dstSet = renderer->picture_set,
        .descriptorCount = 1,
    };
    for (uint32_t n = 0; n < 2; n++) {
        write.dstBinding = n;
        write.descriptorType =
            n == 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        write.pBufferInfo = &buffers[n];
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    for (uint32_t n = 0; n < material_count; n++) {
        const girih_gltf_material *material = find_material(renderer->desc.model, n);
        VkDescriptorImageInfo images[2];
        girih_result found =
            girih_textures_find(&renderer->textures, renderer->device,
                                material != NULL ? &material->base_color_texture : NULL,
                                GIRIH_TEXEL_SRGB, &images[0], error);
        if (found == GIRIH_OK) {
            found = girih_textures_find(&renderer->textures, renderer->device,
                                        material != NULL ? &material->normal_texture : NULL,
                                        GIRIH_TEXEL_LINEAR, &images[1], error);
        }
        if (found != GIRIH_OK) {
            return found;
        }
        write.dstSet = renderer->material_sets[n];
        write.dstBinding = 0;
        write.descriptorCount = 2; // runs on into binding 1
        write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        write.pImageInfo = images;
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    return GIRIH_OK;
}

girih_result girih_renderer_create(const girih_renderer_desc *desc, girih_renderer **renderer,
                                   girih_error *error) {
    girih_renderer *made = calloc(1, sizeof *made);
    if (made == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    made->desc = *desc;
    made->device = desc->device;
    made->pipelines.device = desc->device->device;
    made->pipelines.own = desc->own;
    made->pipelines.cylindrical = desc->view->cylindrical;
    made->pipelines.attribute_floats = desc->model->attribute_floats;
    made->pipelines.texcoord_float = desc->model->texcoord_float;
    made->pipelines.texcoord_floats = desc->model->texcoord_floats;
    made->pipelines.color_float = desc->model->color_float;
    girih_result result =
        girih_textures_create(&made->textures, made->device, desc->model->contents, error);
    if (result == GIRIH_OK) {
        result = create_attachments(made, error);
    }
    if (result == GIRIH_OK) {
        result = create_pass(made, error);
    }
    if (result == GIRIH_OK) {
        result = fill_buffers(made, error);
    }
    if (result == GIRIH_OK) {
        result = create_layouts(made, error);
    }
    if (result == GIRIH_OK) {
        result = create_sets(made, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_queries(made->device, 2, &made->queries, error);
    }
    if (result != GIRIH_OK) {
        girih_renderer_destroy(made);
        return result;
    }
    *renderer = made;
    return GIRIH_OK;
}

void girih_renderer_destroy(girih_renderer *renderer) {
    if (renderer == NULL) {
        return;
    }
    girih_device *device = renderer->device;
    girih_pipelines_free(&renderer->pipelines);
    vkDestroyQueryPool(device->device, renderer->queries, NULL);
    vkDestroyPipelineLayout(device->device, renderer->pipelines.layout, NULL);
    vkDestroyDescriptorPool(device->device, renderer->descriptors, NULL);
    vkDestroyDescriptorSetLayout(device->device, renderer->picture_layout, NULL);
    vkDestroyDescriptorSetLayout(device->device, renderer->material_layout, NULL);
    vkDestroyFramebuffer(device->device, renderer->framebuffer, NULL);
    vkDestroyRenderPass(device->device, renderer->pipelines.pass, NULL);
    girih_device_buffer_destroy(device, &renderer->picture_block);
    girih_device_buffer_destroy(device, &renderer->range_colors);
    girih_device_buffer_destroy(device, &renderer->readback);
    girih_device_image_destroy(device, &renderer->color);
    girih_device_image_destroy(device, &renderer->resolved);
    girih_device_image_destroy(device, &renderer->depth);
    girih_textures_free(&renderer->textures, device);
    free(renderer->material_sets);
    free(renderer);
}

// --- Drawing ---

// KHR_texture_transform: translation * rotation * scale.
static void texcoord_rows(const girih_gltf_texture *texture, float row0[4], float row1[4]) {
    float c = cosf(texture->rotation);
    float s = sinf(texture->rotation);
    row0[0] = c * texture->scale[0];
    row0[1] = s * texture->scale[1];
    row0[2] = texture->offset[0];
    row1[0] = -s * texture->scale[0];
    row1[1] = c * texture->scale[1];
    row1[2] = texture->offset[1];
}

static girih_material_block material_block(const girih_gltf_material *material) {
    girih_material_block block = {
        .base_color = {0.8f, 0.8f, 0.8f, 1.0f},
        .roughness = 0.55f,
    };
    if (material == NULL) {
        return block;
    }
    memcpy(block.base_color, material->base_color, sizeof block.base_color);
    memcpy(block.emissive, material->emissive, sizeof material->emissive);
    block.emissive[3] = material->unlit ? 1.0f : 0.0f;
    block.metallic = material->metallic;
    block.roughness = material->roughness;
    block.alpha_cutoff = material->alpha_cutoff;
    block.normal_scale = material->normal_scale;
    texcoord_rows(&material->base_color_texture, block.base_color_row0, block.base_color_row1);
    texcoord_rows(&material->normal_texture, block.normal_row0, block.normal_row1);
    return block;
}

static girih_result draw_material(girih_renderer *renderer, const girih_drawing *drawing,
                                  uint32_t slice, uint32_t number, VkCullModeFlags cull, bool line,
                                  girih_error *error) {
    bool shows_back_faces = renderer->desc.has_back_face_color && cull == VK_CULL_MODE_FRONT_BIT;
    const girih_model *model = renderer->desc.model;
    const girih_gltf_material *material = find_material(model, number);
    VkCommandBuffer commands = renderer->device->commands;
    bool has_texcoord = model->texcoord_float != GIRIH_MODEL_NONE && material != NULL;
    girih_pipeline_key key = {
        .instanced = drawing->plan != NULL && drawing->mode == GIRIH_MODE_INSTANCED,
        .surface = drawing->surface,
        .has_splits = drawing->has_splits,
        .has_base_color_map = has_texcoord && material->base_color_texture.image >= 0,
        .has_normal_map = has_texcoord && material->normal_texture.image >= 0,
        .has_color = model->color_float != GIRIH_MODEL_NONE,
        .alpha_mode = material != NULL ? material->alpha_mode : GIRIH_GLTF_ALPHA_OPAQUE,
        .cull = cull,
        .line = line,
        .behind = shows_back_faces,
    };
    VkPipeline pipeline;
    girih_result result =
        girih_pipelines_get(&renderer->pipelines, &key, drawing->plan, &pipeline, error);
    if (result != GIRIH_OK) {
        return result;
    }
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    VkDescriptorSet sets[2] = {renderer->picture_set, renderer->material_sets[number]};
    uint32_t block_offset = slice * renderer->block_stride;
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, renderer->pipelines.layout,
                            GIRIH_SET_PICTURE, 2, sets, 1, &block_offset);
    girih_material_block block = material_block(material);
    vkCmdPushConstants(commands, renderer->pipelines.layout,
                       VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof block,
                       &block);
    if (key.instanced && key.surface == GIRIH_SURFACE_OWN &&
        renderer->desc.own->set != VK_NULL_HANDLE) {
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                renderer->pipelines.layout, GIRIH_DRAW_SURFACE_SET, 1,
                                &renderer->desc.own->set, 0, NULL);
    }
    if (drawing->plan != NULL) {
        girih_cmd_draw(drawing->plan, commands, number, renderer->pipelines.layout, GIRIH_DRAW_SET);
        return GIRIH_OK;
    }
    uint32_t first = drawing->material_first[number];
    uint32_t count = drawing->material_first[number + 1] - first;
    VkBuffer buffers[2] = {drawing->positions, drawing->attributes};
    VkDeviceSize offsets[2] = {0, 0};
    vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
    vkCmdBindIndexBuffer(commands, drawing->indices, 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands, 3 * count, 1, 3 * first, 0, 0);
    return GIRIH_OK;
}

static void set_viewport(const girih_renderer *renderer, uint32_t x, uint32_t width) {
    // The height is negative, so that y points up as it does in glTF.
    VkViewport viewport = {(float)x,     (float)renderer->desc.height,
                           (float)width, -(float)renderer->desc.height,
                           0.0f,         1.0f};
    VkRect2D scissor = {{(int32_t)x, 0}, {width, renderer->desc.height}};
    vkCmdSetViewport(renderer->device->commands, 0, 1, &viewport);
    vkCmdSetScissor(renderer->device->commands, 0, 1, &scissor);
}

// Opaque materials, then blended ones, each of these with its far side first; lines over all. Back
// faces in a colour of their own are always a drawing of their own.
static girih_result draw_materials(girih_renderer *renderer, const girih_drawing *drawing,
                                   uint32_t slice, girih_error *error) {
    const girih_model *model = renderer->desc.model;
    girih_result result = GIRIH_OK;
    for (int layer = 0; layer < (renderer->desc.wireframe ? 3 : 2); layer++) {
        for (uint32_t n = 0; n < model->material_count && result == GIRIH_OK; n++) {
            const girih_gltf_material *material = find_material(model, n);
            bool is_blended = material != NULL && material->alpha_mode == GIRIH_GLTF_ALPHA_BLEND;
            bool two_sided =
                renderer->desc.has_back_face_color || (material != NULL && material->double_sided);
            VkCullModeFlags cull = two_sided ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT;
            if (layer == 2) {
                result = draw_material(renderer, drawing, slice, n, cull, true, error);
            } else if (layer == (is_blended ? 1 : 0)) {
                if (two_sided && (is_blended || renderer->desc.has_back_face_color)) {
                    result = draw_material(renderer, drawing, slice, n, VK_CULL_MODE_FRONT_BIT,
                                           false, error);
                    cull = VK_CULL_MODE_BACK_BIT;
                }
                if (result == GIRIH_OK) {
                    result = draw_material(renderer, drawing, slice, n, cull, false, error);
                }
            }
        }
    }
    return result;
}

static void draw_divider(const girih_renderer *renderer) {
    uint32_t width = renderer->desc.width >= 4 ? 2 : 1;
    VkClearAttachment clear = {
        VK_IMAGE_ASPECT_COLOR_BIT, 0, {.color = {{0.25f, 0.26f, 0.28f, 1.0f}}}};
    VkClearRect rect = {
        {{(int32_t)((renderer->desc.width - width) / 2), 0}, {width, renderer->desc.height}}, 0, 1};
    vkCmdClearAttachments(renderer->device->commands, 1, &clear, 1, &rect);
}

static girih_result record_pass(girih_renderer *renderer, const girih_drawing *drawings,
                                uint32_t drawing_count, girih_error *error) {
    VkCommandBuffer commands = renderer->device->commands;
    VkPipeline background;
    girih_pipeline_key key = {.background = true};
    girih_result result = girih_pipelines_get(&renderer->pipelines, &key, NULL, &background, error);
    if (result != GIRIH_OK) {
        return result;
    }
    VkClearValue clears[3] = {{.depthStencil = {0.0f, 0}}}; // reversed depth: 0 is far
    VkRenderPassBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
        .renderPass = renderer->pipelines.pass,
        .framebuffer = renderer->framebuffer,
        .renderArea = {{0, 0}, {renderer->desc.width, renderer->desc.height}},
        .clearValueCount = 3,
        .pClearValues = clears,
    };
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    set_viewport(renderer, 0, renderer->desc.width);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, background);
    vkCmdDraw(commands, 3, 1, 0, 0);
    for (uint32_t n = 0; n < drawing_count && result == GIRIH_OK; n++) {
        for (uint32_t k = 0; k < renderer->slice_count && result == GIRIH_OK; k++) {
            girih_panorama_slice slice = find_slice(renderer, k, drawings[n].width);
            if (slice.width > 0) {
                set_viewport(renderer, drawings[n].x + slice.x, slice.width);
                result = draw_materials(renderer, &drawings[n], k, error);
            }
        }
    }
    if (drawing_count > 1) {
        draw_divider(renderer);
    }
    vkCmdEndRenderPass(commands);
    return result;
}

static void record_readback(const girih_renderer *renderer) {
    VkBufferImageCopy copy = {
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageExtent = {renderer->desc.width, renderer->desc.height, 1},
    };
    vkCmdCopyImageToBuffer(renderer->device->commands, renderer->resolved.image,
                           VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, renderer->readback.buffer, 1,
                           &copy);
    girih_device_full_barrier(renderer->device->commands);
}

girih_result girih_renderer_draw(girih_renderer *renderer, const girih_drawing *drawings,
                                 uint32_t drawing_count, uint8_t *rgba, double *milliseconds,
                                 girih_error *error) {
    girih_device *device = renderer->device;
    girih_result result = girih_device_begin(device, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (renderer->queries != VK_NULL_HANDLE) {
        vkCmdResetQueryPool(device->commands, renderer->queries, 0, 2);
        vkCmdWriteTimestamp(device->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                            renderer->queries, 0);
    }
    result = record_pass(renderer, drawings, drawing_count, error);
    if (renderer->queries != VK_NULL_HANDLE) {
        vkCmdWriteTimestamp(device->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                            renderer->queries, 1);
    }
    record_readback(renderer);
    if (result == GIRIH_OK) {
        result = girih_device_finish(device, error);
    }
    if (result == GIRIH_OK) {
        memcpy(rgba, renderer->readback.mapped,
               (size_t)renderer->desc.width * renderer->desc.height * 4);
        double times[2];
        *milliseconds =
            girih_device_read_queries(device, renderer->queries, 0, 2, times) ? times[1] : -1.0;
    }
    return result;
}
