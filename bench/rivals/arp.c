// ARP, ARK as DMR measures it (Lorenz, Doellner 2008, section 6): DMR's pattern selection pass runs
// on the GPU, the patterns chosen are read back, then each triangle is drawn with a call of its
// own.
//
// What is done otherwise:
// - The paper waits one frame before it reads a pass's results, so that neither side waits. That
//   draws every frame with the levels of the one before; here the CPU waits, so that what is drawn
//   has the levels of its own frame, as with every other method.
// - The selection pass is a compute shader; the paper had only a geometry shader and transform
//   feedback to write with.
// - Hidden triangles are not drawn at all, where the paper leaves them at one subtriangle: only DMR
//   cannot do without those.
// - Patterns are indexed triangles, not degenerate strips: strips save index fetches, of which a
//   triangle costs six bytes of a pattern that stays in the cache, but each joint costs triangles
//   without area that are assembled and thrown away.
#include <stdlib.h>

#include "adaptive.h"
#include "error.h"
#include "methods.h"

#include "bench_shaders.h"

typedef struct arp {
    bench_adaptive adaptive;
    bench_layout layout;
    VkPipeline pipeline;
    girih_device_buffer selected; // pattern of each triangle, read by the CPU where it was written
} arp;

static void destroy(void *state) {
    arp *s = state;
    if (!s) {
        return;
    }
    const bench_job *job = s->adaptive.job;
    vkDestroyPipeline(job->device->device, s->pipeline, NULL);
    bench_layout_destroy(job->target, &s->layout);
    girih_device_buffer_destroy(job->device, &s->selected);
    bench_adaptive_destroy(&s->adaptive);
    free(s);
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    (void)variant;
    arp *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = bench_adaptive_create(job, job->positions, job->normals, job->indices,
                                                job->triangle_count, &s->adaptive, error);
    if (result == GIRIH_OK) {
        result = girih_device_buffer_create(
            job->device, &s->selected, (VkDeviceSize)job->triangle_count * 4,
            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GIRIH_MEMORY_READBACK, error);
    }
    if (result == GIRIH_OK) {
        const VkBuffer buffers[3] = {job->vertex_buffer.buffer, job->index_buffer.buffer,
                                     s->selected.buffer};
        result = bench_layout_create(job->target, buffers, 3, 0, &s->layout, error);
    }
    if (result == GIRIH_OK) {
        result = bench_compute_pipeline_create(
            job->target,
            job->surface == GIRIH_SURFACE_PN ? bench_shader_arp_pn : bench_shader_arp_flat,
            s->layout.layout, &s->pipeline, error);
    }
    if (result != GIRIH_OK) {
        destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

static girih_result ahead(void *state, girih_error *error) {
    arp *s = state;
    const bench_job *job = s->adaptive.job;
    const VkCommandBuffer commands = job->device->commands;
    const girih_result result = girih_device_begin(job->device, error);
    if (result != GIRIH_OK) {
        return result;
    }
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, s->pipeline);
    bench_bind_layout(job->target, commands, &s->layout, VK_PIPELINE_BIND_POINT_COMPUTE);
    vkCmdDispatch(commands, (job->triangle_count + 63) / 64, 1, 1);
    const VkMemoryBarrier written = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                     .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                         0, 1, &written, 0, NULL, 0, NULL);
    return girih_device_finish(job->device, error);
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const arp *s = state;
    bench_adaptive_draw(&s->adaptive, commands, raster, s->selected.mapped);
}

const bench_method bench_arp = {
    .name = "arp",
    .follows = "Lorenz, Doellner 2008, section 6: ARK with selection on the GPU",
    .create = create,
    .destroy = destroy,
    .ahead = ahead,
    .draw = draw};
