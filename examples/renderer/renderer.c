#include "renderer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake.spv.h"
#include "bake_few.spv.h"
#include "ground_fragment.spv.h"
#include "ground_vertex.spv.h"
#include "model_baked.spv.h"
#include "model_fragment.spv.h"
#include "model_instanced.spv.h"

enum {
    RELIEF = 64,    // texels a side
    AROUND = 16,    // quadrilaterals around the ring
    ACROSS = 8,     // and around its tube
    ROOM = 1 << 20, // output vertices, and triangles
};
#define PI 3.14159265f
#define REACH 0.15f // the largest height in surface.glsl
static const VkFormat formats[] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R32G32_SFLOAT,
                                   VK_FORMAT_D16_UNORM};

// The uniform block of view.glsl.
typedef struct view {
    float world_to_clip[16]; // by columns
    float previous_world_to_clip[16];
    float times[4];
} view;

// --- Commands

static int begin(VkCommandBuffer commands) {
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    return (int)vkBeginCommandBuffer(commands, &info);
}

// The queue is one, whoever submits.
static int submit(renderer *r, VkCommandBuffer commands, VkFence fence) {
    TRY(vkEndCommandBuffer(commands));
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .commandBufferCount = 1,
                               .pCommandBuffers = &commands};
    pthread_mutex_lock(&r->queue_lock);
    const VkResult result = vkQueueSubmit(r->host.queue, 1, &info, fence);
    ++r->submissions;
    pthread_mutex_unlock(&r->queue_lock);
    TRY(result);
    return 0;
}

static int create_pool(const renderer *r, VkCommandPool *pool) {
    const VkCommandPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = r->host.family};
    TRY(vkCreateCommandPool(r->host.device, &info, NULL, pool));
    return 0;
}

static int allocate_commands(const renderer *r, VkCommandPool pool, VkCommandBuffer *commands) {
    const VkCommandBufferAllocateInfo info = {.sType =
                                                  VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = pool,
                                              .commandBufferCount = 1};
    TRY(vkAllocateCommandBuffers(r->host.device, &info, commands));
    return 0;
}

static int begin_upload(const renderer *r, VkCommandBuffer *commands) {
    TRY(allocate_commands(r, r->upload_pool, commands));
    return begin(*commands);
}

static int end_upload(renderer *r, VkCommandBuffer commands) {
    TRY(submit(r, commands, VK_NULL_HANDLE));
    pthread_mutex_lock(&r->queue_lock);
    const VkResult result = vkQueueWaitIdle(r->host.queue);
    pthread_mutex_unlock(&r->queue_lock);
    TRY(result);
    return 0;
}

// --- The scene: rings, a camera, time

// A torus of radius 1. Its texture coordinates end where they begin, in vertices of their own:
// seams.
static int create_ring(renderer *r) {
    static float positions[(AROUND + 1) * (ACROSS + 1)][3];
    static float coordinates[(AROUND + 1) * (ACROSS + 1)][2];
    static uint32_t indices[AROUND * ACROSS][6];
    for (uint32_t i = 0; i <= AROUND; ++i) {
        for (uint32_t j = 0; j <= ACROSS; ++j) {
            // The last row lies on the first to the bit.
            const float a = (float)(i % AROUND) * (2 * PI / AROUND);
            const float b = (float)(j % ACROSS) * (2 * PI / ACROSS);
            const uint32_t n = i * (ACROSS + 1) + j;
            positions[n][0] = cosf(a) * (1 + 0.4f * cosf(b));
            positions[n][1] = 0.4f * sinf(b);
            positions[n][2] = sinf(a) * (1 + 0.4f * cosf(b));
            coordinates[n][0] = (float)i / AROUND;
            coordinates[n][1] = (float)j / ACROSS;
            if (i < AROUND && j < ACROSS) {
                const uint32_t next = n + ACROSS + 1;
                const uint32_t quadrilateral[6] = {n, n + 1, next, next, n + 1, next + 1};
                memcpy(indices[i * ACROSS + j], quadrilateral, sizeof quadrilateral);
            }
        }
    }
    const girih_mesh_desc desc = {.name = "ring",
                                  .vertex_count = (AROUND + 1) * (ACROSS + 1),
                                  .positions = positions[0],
                                  .attributes = coordinates[0],
                                  .attribute_floats = 2,
                                  .indices = indices[0],
                                  .index_count = AROUND * ACROSS * 6};
    TRY(girih_mesh_create(&desc, &r->mesh, &host_error));
    if (r->mesh->open_edges || r->mesh->flipped_edges) {
        fprintf(stderr, "the ring is not closed\n");
        return 1;
    }
    return 0;
}

static float time_of(int frame) {
    return 0.06f * (float)frame;
}

static void place_ring(int ring, int frame, float transform[12]) {
    const float turn = time_of(frame) * (ring ? -1.5f : 1.0f);
    const float c = cosf(turn), s = sinf(turn);
    // The large one turns about a tilted axis, the small one stands upright and rolls.
    const float large[12] = {c, 0, s, -0.6f, 0.3f * s, 1, -0.3f * c, 0, -s, 0, c, 0};
    const float small[12] = {0.5f * c, 0,     -0.5f * s, 1.3f - 0.3f * turn,
                             0.5f * s, 0,     0.5f * c,  -0.2f,
                             0,        -0.5f, 0,         0.8f};
    memcpy(transform, ring ? small : large, sizeof large);
}

static void multiply(const float a[16], const float b[16], float product[16]) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            float sum = 0;
            for (int n = 0; n < 4; ++n) {
                sum += a[4 * n + row] * b[4 * column + n];
            }
            product[4 * column + row] = sum;
        }
    }
}

// The camera circles round the scene and looks at its middle, slightly downwards.
static void look(int frame, float eye[3], float world_to_clip[16]) {
    const float turn = 0.5f * time_of(frame), down = 0.45f, distance = 4.2f;
    const float s = sinf(turn), c = cosf(turn), sd = sinf(down), cd = cosf(down);
    eye[0] = distance * cd * s;
    eye[1] = distance * sd;
    eye[2] = distance * cd * c;
    const float world_to_eye[16] = {c,  -sd * s, cd * s, 0, 0, cd, sd,        0,
                                    -s, -sd * c, cd * c, 0, 0, 0,  -distance, 1};
    const float near = 0.5f, far = 20.0f, focal = 1.8f;
    const float eye_to_clip[16] = {
        focal * HEIGHT / WIDTH,    0, 0, 0, 0, -focal, 0, 0, 0, 0, far / (near - far), -1, 0, 0,
        near * far / (near - far), 0};
    multiply(eye_to_clip, world_to_eye, world_to_clip);
}

// What girih refines for: 6 pixels a segment, and nothing outside the view.
static girih_frame describe_frame(const flight *f, const view *v, const float eye[3], int frame) {
    girih_frame desc = {.rule = GIRIH_LEVEL_EDGE_PIXELS,
                        .length = 6,
                        .pixels_per_unit = 0.5f * 1.8f * HEIGHT,
                        .near_distance = 0.5f,
                        .eye = {eye[0], eye[1], eye[2]},
                        .cull_frustum = 1,
                        .surface_set = f->set,
                        .revision = (uint64_t)frame}; // the surface reads the time
    const float *m = v->world_to_clip;
    for (int column = 0; column < 4; ++column) {
        const float x = m[4 * column], y = m[4 * column + 1], z = m[4 * column + 2];
        const float w = m[4 * column + 3];
        const float planes[6] = {w + x, w - x, w + y, w - y, z, w - z};
        for (int plane = 0; plane < 6; ++plane) {
            desc.planes[plane][column] = planes[plane];
        }
    }
    return desc;
}

// --- girih

static int create_scene(tessellator *t) {
    renderer *r = t->renderer;
    const host *h = &r->host;
    const girih_context_desc context = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                                        .instance = h->instance,
                                        .physical_device = h->physical_device,
                                        .device = h->device,
                                        .enabled_features = &h->features};
    TRY(girih_context_create(&context, &t->context, &host_error));
    const girih_surface_program_desc program = {.bake = bake,
                                                .bake_bytes = sizeof bake,
                                                .bake_few = bake_few,
                                                .bake_few_bytes = sizeof bake_few,
                                                .set_layout = r->set_layout,
                                                .base = GIRIH_SURFACE_PN,
                                                .reach = REACH};
    TRY(girih_surface_program_create(t->context, &program, &t->program, &host_error));
    const girih_scene_desc scene = {.meshes = &r->mesh, .mesh_count = 1};
    TRY(girih_scene_create(t->context, &scene, &t->scene, &host_error));
    VkCommandBuffer commands;
    TRY(begin_upload(r, &commands));
    girih_cmd_upload_context(t->context, commands);
    girih_cmd_upload_scene(t->scene, commands);
    TRY(end_upload(r, commands));
    girih_scene_trim(t->scene);
    return 0;
}

static int create_plan(const tessellator *t, girih_plan **plan) {
    girih_instance rings[2] = {{.mesh = 0}, {.mesh = 0}};
    for (int n = 0; n < 2; ++n) {
        place_ring(n, 0, rings[n].transform);
    }
    const girih_plan_desc desc = {.scene = t->scene,
                                  .instances = rings,
                                  .instance_count = 2,
                                  .surface = GIRIH_SURFACE_OWN,
                                  .program = t->program,
                                  .mode = t->mode,
                                  .outputs =
                                      t->mode == GIRIH_MODE_BAKED ? GIRIH_OUTPUT_PREVIOUS : 0,
                                  .max_vertices = ROOM,
                                  .max_triangles = ROOM};
    TRY(girih_plan_create(t->context, &desc, plan, &host_error));
    return 0;
}

// --- The host's own objects

static int create_set_layout(renderer *r) {
    const VkShaderStageFlags stages =
        VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
    const VkDescriptorSetLayoutBinding bindings[2] = {
        {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, stages, NULL},
        {1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, stages, NULL}};
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 2,
        .pBindings = bindings};
    TRY(vkCreateDescriptorSetLayout(r->host.device, &layout, NULL, &r->set_layout));
    return 0;
}

static int create_pass(renderer *r) {
    VkAttachmentDescription attachments[3];
    for (int n = 0; n < 3; ++n) {
        attachments[n] = (VkAttachmentDescription){
            .format = formats[n],
            .samples = VK_SAMPLE_COUNT_1_BIT,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
            .storeOp = n < 2 ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE,
            .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
            .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
            .finalLayout = n < 2 ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL
                                 : VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    }
    const VkAttachmentReference colours[2] = {{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                                              {1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL}};
    const VkAttachmentReference depth = {2, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                          .colorAttachmentCount = 2,
                                          .pColorAttachments = colours,
                                          .pDepthStencilAttachment = &depth};
    const VkSubpassDependency to_copy = {.srcSubpass = 0,
                                         .dstSubpass = VK_SUBPASS_EXTERNAL,
                                         .srcStageMask =
                                             VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                         .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                         .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                                         .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT};
    const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                         .attachmentCount = 3,
                                         .pAttachments = attachments,
                                         .subpassCount = 1,
                                         .pSubpasses = &subpass,
                                         .dependencyCount = 1,
                                         .pDependencies = &to_copy};
    TRY(vkCreateRenderPass(r->host.device, &info, NULL, &r->pass));
    return 0;
}

// The model's vertex input is girih's. Baked, girih gives position and normal, and the host adds
// what it wants of the attribute buffer: its texture coordinates and the previous position.
static int create_model_pipeline(recorder *c) {
    const renderer *r = c->tessellator->renderer;
    const girih_plan *plan = c->flights[0].plan;
    const int baked = c->tessellator->mode == GIRIH_MODE_BAKED;
    VkPipelineVertexInputStateCreateInfo input = *girih_plan_vertex_input(plan);
    VkVertexInputAttributeDescription attributes[4];
    if (baked) {
        memcpy(attributes, input.pVertexAttributeDescriptions, 2 * sizeof *attributes);
        attributes[2] = (VkVertexInputAttributeDescription){2, 1, VK_FORMAT_R32G32_SFLOAT, 12};
        attributes[3] = (VkVertexInputAttributeDescription){3, 1, VK_FORMAT_R32G32B32_SFLOAT, 20};
        input.vertexAttributeDescriptionCount = 4;
        input.pVertexAttributeDescriptions = attributes;
    }
    const host_code vertex = baked ? (host_code){model_baked, sizeof model_baked}
                                   : (host_code){model_instanced, sizeof model_instanced};
    const host_code fragment = {model_fragment, sizeof model_fragment};
    return host_create_pipeline(&r->host, vertex, fragment, &input, VK_CULL_MODE_BACK_BIT,
                                (VkExtent2D){WIDTH, HEIGHT}, r->pass, c->layout, &c->model);
}

static int create_pipelines(recorder *c) {
    const renderer *r = c->tessellator->renderer;
    const VkDescriptorSetLayout sets[2] = {girih_context_draw_set_layout(c->tessellator->context),
                                           r->set_layout};
    const VkPipelineLayoutCreateInfo layout = {.sType =
                                                   VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 2,
                                               .pSetLayouts = sets};
    TRY(vkCreatePipelineLayout(r->host.device, &layout, NULL, &c->layout));
    TRY(create_model_pipeline(c));
    const VkPipelineVertexInputStateCreateInfo none = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const host_code vertex = {ground_vertex, sizeof ground_vertex};
    const host_code fragment = {ground_fragment, sizeof ground_fragment};
    return host_create_pipeline(&r->host, vertex, fragment, &none, VK_CULL_MODE_NONE,
                                (VkExtent2D){WIDTH, HEIGHT}, r->pass, c->layout, &c->ground);
}

static void record_relief(const renderer *r, VkCommandBuffer commands, const host_buffer *texels) {
    VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                    .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = r->relief.image,
                                    .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
    const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {RELIEF, RELIEF, 1}};
    vkCmdCopyBufferToImage(commands, texels->buffer, r->relief.image,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                             VK_PIPELINE_STAGE_VERTEX_SHADER_BIT |
                             VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                         0, 0, NULL, 0, NULL, 1, &barrier);
}

static int create_relief(renderer *r) {
    TRY(host_create_image(&r->host, VK_FORMAT_R32_SFLOAT, RELIEF, RELIEF,
                          VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                          VK_IMAGE_ASPECT_COLOR_BIT, &r->relief));
    const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                         .magFilter = VK_FILTER_NEAREST,
                                         .minFilter = VK_FILTER_NEAREST};
    TRY(vkCreateSampler(r->host.device, &sampler, NULL, &r->sampler));
    host_buffer texels = {0};
    TRY(host_create_buffer(&r->host, 4 * RELIEF * RELIEF, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, 1,
                           &texels));
    for (int n = 0; n < RELIEF * RELIEF; ++n) {
        // A stud where the waves along and across meet.
        const float u = (float)(n % RELIEF) * (2 * PI / RELIEF);
        const float v = (float)(n / RELIEF) * (2 * PI / RELIEF);
        const float wave = 0.5f + 0.25f * (cosf(u) + cosf(v));
        ((float *)texels.mapped)[n] = wave * wave;
    }
    VkCommandBuffer commands;
    TRY(begin_upload(r, &commands));
    record_relief(r, commands, &texels);
    TRY(end_upload(r, commands));
    host_destroy_buffer(&r->host, &texels);
    return 0;
}

static int create_descriptor_pool(recorder *c) {
    const VkDescriptorPoolSize sizes[2] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, IN_FLIGHT},
                                           {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, IN_FLIGHT}};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = IN_FLIGHT,
                                             .poolSizeCount = 2,
                                             .pPoolSizes = sizes};
    TRY(vkCreateDescriptorPool(c->tessellator->renderer->host.device, &pool, NULL,
                               &c->descriptors));
    return 0;
}

static int create_flight(const recorder *c, flight *f) {
    const renderer *r = c->tessellator->renderer;
    const host *h = &r->host;
    const VkImageUsageFlags copied =
        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkImageView views[3];
    for (int n = 0; n < 3; ++n) {
        TRY(host_create_image(h, formats[n], WIDTH, HEIGHT,
                              n < 2 ? copied : VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                              n < 2 ? VK_IMAGE_ASPECT_COLOR_BIT : VK_IMAGE_ASPECT_DEPTH_BIT,
                              &f->images[n]));
        views[n] = f->images[n].view;
    }
    const VkFramebufferCreateInfo framebuffer = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                 .renderPass = r->pass,
                                                 .attachmentCount = 3,
                                                 .pAttachments = views,
                                                 .width = WIDTH,
                                                 .height = HEIGHT,
                                                 .layers = 1};
    TRY(vkCreateFramebuffer(h->device, &framebuffer, NULL, &f->framebuffer));
    for (int n = 0; n < 2; ++n) {
        TRY(host_create_buffer(h, WIDTH * HEIGHT * (n ? 8 : 4), VK_BUFFER_USAGE_TRANSFER_DST_BIT, 1,
                               &f->pixels[n]));
    }
    TRY(host_create_buffer(h, sizeof(view), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, 1, &f->view));
    const VkDescriptorSetAllocateInfo set = {.sType =
                                                 VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = c->descriptors,
                                             .descriptorSetCount = 1,
                                             .pSetLayouts = &r->set_layout};
    TRY(vkAllocateDescriptorSets(h->device, &set, &f->set));
    const VkDescriptorBufferInfo buffer = {f->view.buffer, 0, VK_WHOLE_SIZE};
    const VkDescriptorImageInfo image = {r->sampler, r->relief.view,
                                         VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const VkWriteDescriptorSet writes[2] = {
        {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
         .dstSet = f->set,
         .dstBinding = 0,
         .descriptorCount = 1,
         .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
         .pBufferInfo = &buffer},
        {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
         .dstSet = f->set,
         .dstBinding = 1,
         .descriptorCount = 1,
         .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
         .pImageInfo = &image}};
    vkUpdateDescriptorSets(h->device, 2, writes, 0, NULL);
    TRY(allocate_commands(r, c->pool, &f->commands));
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    TRY(vkCreateFence(h->device, &fence, NULL, &f->fence));
    return 0;
}

// --- Frames

static void record_draw(const recorder *c, const flight *f) {
    const VkClearValue clear[3] = {
        {.color = {{0.55f, 0.55f, 0.55f, 1}}}, {.color = {{0}}}, {.depthStencil = {1, 0}}};
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = c->tessellator->renderer->pass,
                                        .framebuffer = f->framebuffer,
                                        .renderArea.extent = {WIDTH, HEIGHT},
                                        .clearValueCount = 3,
                                        .pClearValues = clear};
    vkCmdBeginRenderPass(f->commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindDescriptorSets(f->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, c->layout, 1, 1, &f->set,
                            0, NULL);
    vkCmdBindPipeline(f->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, c->ground);
    vkCmdDraw(f->commands, 6, 1, 0, 0);
    vkCmdBindPipeline(f->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, c->model);
    for (uint32_t material = 0; material < girih_plan_material_count(f->plan); ++material) {
        girih_cmd_draw(f->plan, f->commands, material, c->layout, 0);
    }
    vkCmdEndRenderPass(f->commands);
    for (int n = 0; n < 2; ++n) {
        const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                        .imageExtent = {WIDTH, HEIGHT, 1}};
        vkCmdCopyImageToBuffer(f->commands, f->images[n].image,
                               VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, f->pixels[n].buffer, 1, &copy);
    }
    const VkMemoryBarrier to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                     .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(f->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0,
                         1, &to_host, 0, NULL, 0, NULL);
}

// The flight's previous frame has been waited for, so that its buffers and its plan are free.
static int draw_frame(const recorder *c, flight *f, int frame) {
    const int before = frame > 0 ? frame - 1 : 0;
    view v = {.times = {time_of(frame), time_of(before)}};
    float eye[3], eye_before[3];
    look(before, eye_before, v.previous_world_to_clip);
    look(frame, eye, v.world_to_clip);
    memcpy(f->view.mapped, &v, sizeof v);
    for (int ring = 0; ring < 2; ++ring) {
        float now[12], previous[12];
        place_ring(ring, frame, now);
        place_ring(ring, before, previous);
        TRY(girih_plan_set_transform(f->plan, (uint32_t)ring, now, previous, &host_error));
    }
    TRY(begin(f->commands));
    const girih_frame desc = describe_frame(f, &v, eye, frame);
    TRY(girih_cmd_refine(f->plan, f->commands, &desc, NULL, &host_error));
    record_draw(c, f);
    TRY(submit(c->tessellator->renderer, f->commands, f->fence));
    f->frame = frame;
    f->submitted = 1;
    return 0;
}

static int wait_for_frame(const recorder *c, flight *f) {
    const VkDevice device = c->tessellator->renderer->host.device;
    f->submitted = 0;
    TRY(vkWaitForFences(device, 1, &f->fence, VK_TRUE, UINT64_MAX));
    TRY(vkResetFences(device, 1, &f->fence));
    const girih_statistics s = girih_plan_statistics(f->plan);
    if (s.overflow) {
        fprintf(stderr, "no room: %llu triangles and %llu vertices are needed\n",
                (unsigned long long)s.needed_triangles, (unsigned long long)s.needed_vertices);
        return 1;
    }
    return 0;
}

int recorder_run(recorder *c, picture_taker *take, void *user) {
    for (int frame = 0; frame < FRAMES + IN_FLIGHT; ++frame) {
        flight *f = &c->flights[frame % IN_FLIGHT];
        if (f->submitted) {
            TRY(wait_for_frame(c, f));
            TRY(take(f, user));
        }
        if (frame < FRAMES) {
            TRY(draw_frame(c, f, frame));
        }
    }
    return 0;
}

// --- Creation and destruction

int renderer_create(renderer *r) {
    TRY(pthread_mutex_init(&r->queue_lock, NULL));
    TRY(host_create(&r->host));
    TRY(create_pool(r, &r->upload_pool));
    TRY(create_set_layout(r));
    TRY(create_pass(r));
    TRY(create_relief(r));
    TRY(create_ring(r));
    return 0;
}

int tessellator_create(tessellator *t, renderer *r, int baked) {
    t->renderer = r;
    const VkPhysicalDeviceFeatures *features = &r->host.features;
    t->mode = features->multiDrawIndirect && features->drawIndirectFirstInstance && !baked
                  ? GIRIH_MODE_INSTANCED
                  : GIRIH_MODE_BAKED;
    return create_scene(t);
}

int recorder_create(recorder *c, const tessellator *t) {
    c->tessellator = t;
    TRY(create_pool(t->renderer, &c->pool));
    TRY(create_descriptor_pool(c));
    for (int n = 0; n < IN_FLIGHT; ++n) {
        TRY(create_plan(t, &c->flights[n].plan));
        TRY(create_flight(c, &c->flights[n]));
    }
    return create_pipelines(c);
}

void recorder_destroy(recorder *c) {
    if (!c->tessellator) {
        return;
    }
    const host *h = &c->tessellator->renderer->host;
    for (int n = 0; n < IN_FLIGHT; ++n) {
        flight *f = &c->flights[n];
        if (f->submitted) {
            vkWaitForFences(h->device, 1, &f->fence, VK_TRUE, UINT64_MAX);
        }
        girih_plan_destroy(f->plan);
        vkDestroyFramebuffer(h->device, f->framebuffer, NULL);
        vkDestroyFence(h->device, f->fence, NULL);
        host_destroy_buffer(h, &f->view);
        for (int image = 0; image < 3; ++image) {
            host_destroy_image(h, &f->images[image]);
        }
        for (int buffer = 0; buffer < 2; ++buffer) {
            host_destroy_buffer(h, &f->pixels[buffer]);
        }
    }
    vkDestroyCommandPool(h->device, c->pool, NULL);
    vkDestroyDescriptorPool(h->device, c->descriptors, NULL);
    vkDestroyPipeline(h->device, c->model, NULL);
    vkDestroyPipeline(h->device, c->ground, NULL);
    vkDestroyPipelineLayout(h->device, c->layout, NULL);
}

void tessellator_destroy(tessellator *t) {
    girih_scene_destroy(t->scene);
    girih_surface_program_destroy(t->program);
    girih_context_destroy(t->context);
}

void renderer_destroy(renderer *r) {
    const host *h = &r->host;
    girih_mesh_destroy(r->mesh);
    if (h->device) {
        vkDestroyCommandPool(h->device, r->upload_pool, NULL);
        vkDestroyRenderPass(h->device, r->pass, NULL);
        vkDestroyDescriptorSetLayout(h->device, r->set_layout, NULL);
        vkDestroySampler(h->device, r->sampler, NULL);
        host_destroy_image(h, &r->relief);
    }
    host_destroy(&r->host);
    pthread_mutex_destroy(&r->queue_lock);
}
