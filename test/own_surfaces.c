#include "own_surfaces.h"

#include <string.h>

#include "meshes.h"
#include "own_shaders.h"

#define TEXELS 16u

#define LIST_MODULES(name)                                                                         \
    {.bake = {own_##name##_bake, sizeof own_##name##_bake},                                        \
     .bake_few = {own_##name##_bake_few, sizeof own_##name##_bake_few},                            \
     .draw = {own_##name##_draw, sizeof own_##name##_draw},                                        \
     .draw_splits = {own_##name##_draw_splits, sizeof own_##name##_draw_splits},                   \
     .draw_previous = {own_##name##_draw_previous, sizeof own_##name##_draw_previous}},

typedef struct module {
    const uint32_t *words;
    size_t bytes;
} module;

// In the order of own_surface.
static const struct {
    module bake, bake_few, draw, draw_splits, draw_previous;
} modules[] = {OWN_SURFACES(LIST_MODULES)};

// A texture of random bytes, in the layout that shaders read.
static void create_texture(gpu *host, own_set *set) {
    const VkImageCreateInfo image = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                     .imageType = VK_IMAGE_TYPE_2D,
                                     .format = VK_FORMAT_R8_UNORM,
                                     .extent = {TEXELS, TEXELS, 1},
                                     .mipLevels = 1,
                                     .arrayLayers = 1,
                                     .samples = VK_SAMPLE_COUNT_1_BIT,
                                     .tiling = VK_IMAGE_TILING_OPTIMAL,
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT |
                                              VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    gpu_check(vkCreateImage(host->device, &image, NULL, &set->image), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(host->device, set->image, &needs);
    uint32_t type = 0;
    while (!(needs.memoryTypeBits & 1u << type)) {
        ++type;
    }
    const VkMemoryAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                             .allocationSize = needs.size,
                                             .memoryTypeIndex = type};
    gpu_check(vkAllocateMemory(host->device, &allocation, NULL, &set->memory), "vkAllocateMemory");
    gpu_check(vkBindImageMemory(host->device, set->image, set->memory, 0), "vkBindImageMemory");

    gpu_buffer texels =
        gpu_create_buffer(host, TEXELS * TEXELS, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
    uint32_t state = 1;
    for (uint32_t n = 0; n < TEXELS * TEXELS; ++n) {
        state = state * 1664525u + 1013904223u;
        ((uint8_t *)texels.mapped)[n] = (uint8_t)(state >> 24);
    }
    VkCommandBuffer commands = gpu_begin(host);
    VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                    .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = set->image,
                                    .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
    const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {TEXELS, TEXELS, 1}};
    vkCmdCopyBufferToImage(commands, texels.buffer, set->image,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_SHADER_BIT,
                         0, 0, NULL, 0, NULL, 1, &barrier);
    gpu_run(host, commands);
    gpu_destroy_buffer(host, &texels);

    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = set->image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = VK_FORMAT_R8_UNORM,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    gpu_check(vkCreateImageView(host->device, &view, NULL, &set->view), "vkCreateImageView");
    const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                         .magFilter = VK_FILTER_LINEAR,
                                         .minFilter = VK_FILTER_LINEAR};
    gpu_check(vkCreateSampler(host->device, &sampler, NULL, &set->sampler), "vkCreateSampler");
}

own_set own_set_open(gpu *host, own_settings settings) {
    own_set set = {0};
    create_texture(host, &set);
    set.numbers =
        gpu_create_buffer(host, sizeof settings, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, true);
    own_set_write(&set, settings);
    const VkShaderStageFlags stages = VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT;
    const VkDescriptorSetLayoutBinding bindings[2] = {
        {.binding = 0,
         .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
         .descriptorCount = 1,
         .stageFlags = stages},
        {.binding = 1,
         .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
         .descriptorCount = 1,
         .stageFlags = stages}};
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 2,
        .pBindings = bindings};
    gpu_check(vkCreateDescriptorSetLayout(host->device, &layout, NULL, &set.layout),
              "vkCreateDescriptorSetLayout");
    const VkDescriptorPoolSize sizes[2] = {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1},
                                           {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1}};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = 1,
                                             .poolSizeCount = 2,
                                             .pPoolSizes = sizes};
    gpu_check(vkCreateDescriptorPool(host->device, &pool, NULL, &set.pool),
              "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocation = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = set.pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &set.layout};
    gpu_check(vkAllocateDescriptorSets(host->device, &allocation, &set.set),
              "vkAllocateDescriptorSets");
    const VkDescriptorImageInfo texture = {set.sampler, set.view,
                                           VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const VkDescriptorBufferInfo numbers = {set.numbers.buffer, 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet writes[2] = {
        {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
         .dstSet = set.set,
         .dstBinding = 0,
         .descriptorCount = 1,
         .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
         .pImageInfo = &texture},
        {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
         .dstSet = set.set,
         .dstBinding = 1,
         .descriptorCount = 1,
         .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
         .pBufferInfo = &numbers}};
    vkUpdateDescriptorSets(host->device, 2, writes, 0, NULL);
    return set;
}

void own_set_close(gpu *host, own_set *set) {
    vkDestroyDescriptorPool(host->device, set->pool, NULL);
    vkDestroyDescriptorSetLayout(host->device, set->layout, NULL);
    vkDestroySampler(host->device, set->sampler, NULL);
    vkDestroyImageView(host->device, set->view, NULL);
    vkDestroyImage(host->device, set->image, NULL);
    vkFreeMemory(host->device, set->memory, NULL);
    gpu_destroy_buffer(host, &set->numbers);
}

void own_set_write(own_set *set, own_settings settings) {
    memcpy(set->numbers.mapped, &settings, sizeof settings);
}

girih_surface_program_desc own_program_desc(const own_set *set, own_surface surface, float reach) {
    return (girih_surface_program_desc){.bake = modules[surface].bake.words,
                                        .bake_bytes = modules[surface].bake.bytes,
                                        .bake_few = modules[surface].bake_few.words,
                                        .bake_few_bytes = modules[surface].bake_few.bytes,
                                        .set_layout = set->layout,
                                        .base = surface == OWN_IDENTITY_FLAT ? GIRIH_SURFACE_FLAT
                                                                             : GIRIH_SURFACE_PN,
                                        .reach = reach};
}

girih_surface_program *own_program(const girih_context *context, const own_set *set,
                                   own_surface surface, float reach) {
    const girih_surface_program_desc desc = own_program_desc(set, surface, reach);
    girih_surface_program *program;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_surface_program_create(context, &desc, &program, &error), &error);
    return program;
}

void own_capture(gpu_capture *capture, const own_set *set, own_surface surface) {
    const gpu_own_shader own = {
        .words = {modules[surface].draw.words, modules[surface].draw_previous.words,
                  modules[surface].draw_splits.words},
        .bytes = {modules[surface].draw.bytes, modules[surface].draw_previous.bytes,
                  modules[surface].draw_splits.bytes},
        .layout = set->layout,
        .set = set->set};
    gpu_capture_own(capture, &own);
}

// --- What they are tried on ---------------------------------------------------------------------

const girih_instance own_instances[OWN_INSTANCES] = {
    {OWN_SPHERE, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {OWN_CUBE, {-1.5f, 0, 0, 3, 0, 1, 0.2f, 0, 0, 0, 1, 0}},
    {OWN_TORUS, {0, -1.7f, 0, 0.3f, 1.7f, 0, 0, 4, 0, 0, 1.7f, 1}},
    {OWN_SOUP, {0.7f, 0.1f, 0, -3, 0, 0.7f, 0, 0, 0, 0, 0.7f, 0.5f}},
    {OWN_SPHERE, {-0.5f, 0.1f, 0.2f, 1, 0.3f, 1.1f, 0, -4, -0.1f, 0.4f, 0.9f, 3}},
};

void own_make_meshes(const girih_mesh *meshes[OWN_MESHES]) {
    meshes[OWN_SPHERE] = make_seam_sphere(7, 6);
    meshes[OWN_CUBE] = make_cube(1);
    meshes[OWN_TORUS] = make_torus(9, 4);
    meshes[OWN_SOUP] = make_soup(24, 10, 3);
}

void own_destroy_meshes(const girih_mesh *meshes[OWN_MESHES]) {
    for (int n = 0; n < OWN_MESHES; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
}

girih_plan_desc own_plan_of(const girih_scene *scene, const girih_surface_program *program,
                            girih_mode mode, uint32_t room) {
    static const uint32_t outputs[] = {
        [GIRIH_MODE_INSTANCED] = 0,
        [GIRIH_MODE_BAKED] = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES,
        [GIRIH_MODE_WELDED] =
            GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES};
    return (girih_plan_desc){.scene = scene,
                             .instances = own_instances,
                             .instance_count = OWN_INSTANCES,
                             .surface = program ? GIRIH_SURFACE_OWN : GIRIH_SURFACE_PN,
                             .program = program,
                             .mode = mode,
                             .outputs = outputs[mode],
                             .max_vertices = 3 * room,
                             .max_triangles = room};
}

girih_plan *own_make_plan(const girih_context *context, girih_plan_desc desc) {
    girih_plan *plan;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_plan_create(context, &desc, &plan, &error), &error);
    return plan;
}

const float *own_position(const gpu_readback *read, uint32_t vertex) {
    return (const float *)(const void *)(read->words[GIRIH_BIND_OUT_POSITIONS] +
                                         3 * (size_t)vertex);
}

const float *own_normal(const gpu_readback *read, uint32_t vertex, uint32_t stride) {
    return (const float *)(const void *)(read->words[GIRIH_BIND_OUT_ATTRIBUTES] +
                                         (size_t)stride * vertex);
}
