#include "results.h"

#include <string.h>

static const char *const names[RESULTS_OUTPUTS] = {"positions", "attributes", "indices",
                                                   "closed indices", "sources"};

// The plan's output buffers, in the order of names.
static void list_ranges(const girih_plan_buffers *buffers,
                        girih_buffer_range ranges[RESULTS_OUTPUTS]) {
    ranges[0] = buffers->positions;
    ranges[1] = buffers->attributes;
    ranges[2] = buffers->indices;
    ranges[3] = buffers->closed_indices;
    ranges[4] = buffers->sources;
}

// Bytes of each output with this many vertices and triangles.
static void list_bytes(const girih_plan_buffers *buffers, uint64_t vertices, uint64_t triangles,
                       VkDeviceSize bytes[RESULTS_OUTPUTS]) {
    girih_buffer_range ranges[RESULTS_OUTPUTS];
    list_ranges(buffers, ranges);
    const VkDeviceSize all[RESULTS_OUTPUTS] = {12 * vertices, buffers->attribute_stride * vertices,
                                               12 * triangles, 12 * triangles, 8 * triangles};
    for (int n = 0; n < RESULTS_OUTPUTS; ++n) {
        bytes[n] = ranges[n].buffer ? all[n] : 0;
    }
}

void results_record(gpu *host, const girih_plan *plan, VkCommandBuffer commands, results *read) {
    const girih_plan_buffers buffers = girih_plan_get_buffers(plan);
    girih_buffer_range ranges[RESULTS_OUTPUTS];
    VkDeviceSize room[RESULTS_OUTPUTS];
    list_ranges(&buffers, ranges);
    list_bytes(&buffers, buffers.max_vertices, buffers.max_triangles, room);
    VkDeviceSize size = 0;
    for (int n = 0; n < RESULTS_OUTPUTS; ++n) {
        read->offset[n] = size;
        size += room[n];
    }
    if (read->copy.size < size || !read->copy.buffer) {
        results_free(host, read);
        read->copy =
            gpu_create_buffer(host, size ? size : 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true);
    }
    for (int n = 0; n < RESULTS_OUTPUTS; ++n) {
        if (room[n]) {
            const VkBufferCopy copy = {ranges[n].offset, read->offset[n], room[n]};
            vkCmdCopyBuffer(commands, ranges[n].buffer, read->copy.buffer, 1, &copy);
        }
    }
    const VkMemoryBarrier after = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &after, 0, NULL, 0, NULL);
}

void results_finish(const girih_plan *plan, results *read) {
    const girih_plan_buffers buffers = girih_plan_get_buffers(plan);
    read->statistics = girih_plan_statistics(plan);
    list_bytes(&buffers, read->statistics.output_vertices, read->statistics.output_triangles,
               read->bytes);
}

void results_refine(gpu *host, girih_plan *plan, const girih_frame *frame, results *read) {
    VkCommandBuffer commands = gpu_begin(host);
    girih_error error = {GIRIH_OK, ""};
    girih_plan_invalidate(plan);
    gpu_girih(girih_cmd_refine(plan, commands, frame, NULL, &error), &error);
    results_record(host, plan, commands, read);
    gpu_run(host, commands);
    results_finish(plan, read);
}

void results_free(gpu *host, results *read) {
    if (read->copy.buffer) {
        gpu_destroy_buffer(host, &read->copy);
    }
}

const char *results_difference(const results *a, const results *b) {
    const girih_statistics *s = &a->statistics;
    const girih_statistics *t = &b->statistics;
    if (s->input_triangles != t->input_triangles || s->culled_triangles != t->culled_triangles ||
        s->clamped_edges != t->clamped_edges || s->output_triangles != t->output_triangles ||
        s->output_vertices != t->output_vertices || s->needed_triangles != t->needed_triangles ||
        s->needed_vertices != t->needed_vertices || s->groups != t->groups ||
        s->base_patterns != t->base_patterns || s->overflow != t->overflow) {
        return "statistics";
    }
    for (int n = 0; n < RESULTS_OUTPUTS; ++n) {
        const char *x = a->copy.mapped;
        const char *y = b->copy.mapped;
        if (a->bytes[n] != b->bytes[n] ||
            (a->bytes[n] && memcmp(x + a->offset[n], y + b->offset[n], a->bytes[n]) != 0)) {
            return names[n];
        }
    }
    return NULL;
}

uint64_t results_bytes(const results *read) {
    uint64_t bytes = 0;
    for (int n = 0; n < RESULTS_OUTPUTS; ++n) {
        bytes += read->bytes[n];
    }
    return bytes;
}
