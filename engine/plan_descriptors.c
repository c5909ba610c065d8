// What the shaders see: the descriptors of a plan.
#include "context.h"
#include "error.h"
#include "memory.h"

static VkDescriptorBufferInfo part(const girih_buffer *buffer, VkDeviceSize offset,
                                   VkDeviceSize size) {
    return (VkDescriptorBufferInfo){
        .buffer = buffer->buffer, .offset = buffer->offset + offset, .range = size};
}

static VkDescriptorBufferInfo work_info(const girih_plan *plan, VkDeviceSize offset,
                                        VkDeviceSize size) {
    return part(&plan->buffers[GIRIH_PLAN_WORK], offset, size);
}

static VkDescriptorBufferInfo frame_info(const girih_plan *plan) {
    return work_info(plan, plan->frame_offset, sizeof plan->arrays.frame);
}

static void write_binding(const girih_plan *plan, VkDescriptorSet set, uint32_t binding,
                          const VkDescriptorBufferInfo *info) {
    const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                        .dstSet = set,
                                        .dstBinding = binding,
                                        .descriptorCount = 1,
                                        .descriptorType = binding == GIRIH_BIND_FRAME
                                                              ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                              : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                        .pBufferInfo = info};
    plan->context->vk.UpdateDescriptorSets(plan->context->device, 1, &write, 0, NULL);
}

// The part of an output buffer that a window shows; a buffer that is not there is stood in for by
// the sort's counters, which no shader that could write through this binding reads.
static VkDescriptorBufferInfo window_info(const girih_plan *plan, const girih_buffer *buffer,
                                          uint32_t window, uint32_t window_size, uint32_t windows,
                                          uint32_t bytes) {
    if (!buffer->buffer) {
        return work_info(plan, plan->offset[GIRIH_BIND_COUNTERS],
                         plan->arrays.count[GIRIH_BIND_COUNTERS] * 4);
    }
    if (window >= windows) {
        window = windows - 1;
    }
    const VkDeviceSize offset = (VkDeviceSize)window * window_size * bytes;
    const VkDeviceSize most = (VkDeviceSize)window_size * bytes;
    const VkDeviceSize rest = buffer->size - offset;
    return part(buffer, offset, rest < most ? rest : most);
}

// What binding n shows in descriptor set `set`: with few buffers there are four sets a window, one
// for the vertices and one for each list that the third output kernel writes through the shared
// binding.
static VkDescriptorBufferInfo binding_info(const girih_plan *plan, uint32_t n, uint32_t window,
                                           uint32_t list) {
    const girih_context *context = plan->context;
    const girih_scene *scene = plan->scene;
    if (n == GIRIH_BIND_FRAME) {
        return frame_info(plan);
    }
    if (n >= GIRIH_BIND_OUT_INDICES || (n == GIRIH_BIND_SHARED_LIST && list)) {
        const uint32_t which = n >= GIRIH_BIND_OUT_INDICES ? n - GIRIH_BIND_OUT_INDICES : list - 1;
        return window_info(plan, &plan->buffers[GIRIH_PLAN_INDICES + which], window,
                           plan->triangle_window, plan->triangle_windows, which == 2 ? 8 : 12);
    }
    if (n == GIRIH_BIND_OUT_POSITIONS) {
        return window_info(plan, &plan->buffers[GIRIH_PLAN_POSITIONS], window, plan->vertex_window,
                           plan->vertex_windows, 12);
    }
    if (n == GIRIH_BIND_OUT_ATTRIBUTES) {
        return window_info(plan, &plan->buffers[GIRIH_PLAN_ATTRIBUTES], window, plan->vertex_window,
                           plan->vertex_windows, 4 * girih_attribute_words(plan));
    }
    if (context->few_buffers) {
        return n == GIRIH_BIND_SHARED_SCENE ? part(&scene->buffer, 0, scene->buffer.size)
                                            : work_info(plan, 0, plan->frame_offset);
    }
    if (n >= GIRIH_BIND_INSTANCES) {
        return work_info(plan, plan->offset[n], plan->arrays.count[n] * 4);
    }
    if (n < GIRIH_BIND_PATTERNS) {
        return part(&scene->buffer, scene->offset[n], scene->arrays.count[n] * 4);
    }
    return part(n == GIRIH_BIND_PATTERN_INDICES ? &context->indices : &context->patterns,
                context->offset[n], context->catalogue.count[n] * 4);
}

// What girih.glsl reads in a host's vertex shader.
static void write_draw_set(const girih_plan *plan) {
    const girih_scene *scene = plan->scene;
    const VkDescriptorBufferInfo infos[] = {
        part(&scene->buffer, scene->offset[GIRIH_BIND_ATTRIBUTES],
             scene->arrays.count[GIRIH_BIND_ATTRIBUTES] * 4),
        frame_info(plan),
        part(&scene->buffer, 0, scene->buffer.size),
        work_info(plan, 0,
                  plan->offset[GIRIH_BIND_INSTANCES] +
                      plan->arrays.count[GIRIH_BIND_INSTANCES] * 4),
    };
    const uint32_t bindings[] = {GIRIH_BIND_DRAW_ATTRIBUTES, GIRIH_BIND_FRAME,
                                 GIRIH_BIND_SHARED_SCENE, GIRIH_BIND_SHARED_PLAN};
    // The library's own surfaces read the attributes alone.
    const uint32_t count = plan->surface == GIRIH_SURFACE_OWN ? 4 : 1;
    for (uint32_t n = 0; n < count; ++n) {
        write_binding(plan, plan->draw_set, bindings[n], &infos[n]);
    }
}

girih_result girih_plan_create_descriptors(girih_plan *plan, girih_error *error) {
    const girih_context *context = plan->context;
    const girih_functions *vk = &context->vk;
    const uint32_t families = context->few_buffers ? 4 : 1;
    const uint32_t set_count = plan->window_count * families;
    const uint32_t draw_sets = plan->mode == GIRIH_MODE_INSTANCED ? 1 : 0;
    if (plan->window_count > GIRIH_MAX_WINDOWS) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "plan: the output needs %u storage buffers' ranges, more than %u; refine less at once",
            plan->window_count, GIRIH_MAX_WINDOWS);
    }
    plan->sets = girih_allocate_array(set_count, sizeof *plan->sets);
    if (!plan->sets) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "plan: out of memory");
    }
    const VkDescriptorPoolSize sizes[2] = {
        {.type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, .descriptorCount = set_count + draw_sets},
        {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
         .descriptorCount = set_count * (GIRIH_BIND_COUNT - 1) + 3 * draw_sets}};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = set_count + draw_sets,
                                             .poolSizeCount = 2,
                                             .pPoolSizes = sizes};
    VkResult result =
        vk->CreateDescriptorPool(context->device, &pool, context->callbacks, &plan->pool);
    if (result != VK_SUCCESS) {
        plan->pool = VK_NULL_HANDLE;
        return girih_vulkan_failed(error, "vkCreateDescriptorPool", "plan", result);
    }
    for (uint32_t n = 0; n < set_count + draw_sets && result == VK_SUCCESS; ++n) {
        const VkDescriptorSetAllocateInfo info = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
            .descriptorPool = plan->pool,
            .descriptorSetCount = 1,
            .pSetLayouts = n < set_count ? &context->set_layout : &context->draw_set_layout};
        result = vk->AllocateDescriptorSets(context->device, &info,
                                            n < set_count ? &plan->sets[n] : &plan->draw_set);
    }
    if (result != VK_SUCCESS) {
        return girih_vulkan_failed(error, "vkAllocateDescriptorSets", "plan", result);
    }
    for (uint32_t set = 0; set < set_count; ++set) {
        for (uint32_t n = 0; n < GIRIH_BIND_COUNT; ++n) {
            if (context->few_buffers && n != GIRIH_BIND_FRAME && n != GIRIH_BIND_SHARED_SCENE &&
                n != GIRIH_BIND_SHARED_PLAN && n != GIRIH_BIND_OUT_POSITIONS &&
                n != GIRIH_BIND_OUT_ATTRIBUTES) {
                continue;
            }
            const VkDescriptorBufferInfo info =
                binding_info(plan, n, set % plan->window_count, set / plan->window_count);
            write_binding(plan, plan->sets[set], n, &info);
        }
    }
    if (draw_sets) {
        write_draw_set(plan);
    }
    return GIRIH_OK;
}
