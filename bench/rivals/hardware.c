// Hardware tessellation: the control and evaluation stages of Vulkan 1.3, chapter "Tessellation".
//
// Outer levels are the segments of the edges' levels, by the same rule as girih's; the inner level
// is the greatest of the three, as is the custom. The fixed-function pattern is another than
// girih's: a triangle with n segments on each edge gives about 1.5 n^2 triangles, not n^2. With
// fractional odd spacing an edge of n segments gets the next odd number of them, two of which are
// short where n is not odd itself.
//
// Mesa's lavapipe (measured with 22.3) has two faults in its tessellation, so that its figures are
// no measure of a GPU's: vertices are numbered with 16 bits in each internal batch of about 341
// patches, and wrap round above 65,535 evaluated vertices; and each patch copies the batch's
// vertices so far, so that its cost grows with the square of the batch. There the patches are drawn
// in batches that can do neither; a GPU gets one draw.
#include <stdlib.h>

#include "error.h"
#include "methods.h"

#include "bench_shaders.h"

enum { EQUAL, FRACTIONAL };

// Of lavapipe's batches: from 24 to 300 patches cost the same within a tenth, as long as the
// vertices do not wrap round.
#define MOST_BATCH_PATCHES 96u
#define MOST_BATCH_VERTICES 65535u

typedef struct hardware {
    const bench_job *job;
    bench_layout layout;
    VkPipeline pipelines[BENCH_RASTERS];
} hardware;

// The most segments that an edge of the frame can have.
static uint32_t most_segments(const bench_job *job, const girih_frame *frame) {
    const girih_catalogue *catalogue = job->catalogue;
    const uint32_t last = catalogue->level_count - 1;
    switch (frame->rule) {
    case GIRIH_LEVEL_RANDOM_LEVEL:
        return girih_catalogue_segments(catalogue, frame->segments < last ? frame->segments : last);
    case GIRIH_LEVEL_SEGMENTS:
    case GIRIH_LEVEL_RANDOM:
        return girih_catalogue_segments(catalogue,
                                        girih_catalogue_level(catalogue, frame->segments, NULL));
    default:
        return girih_catalogue_segments(catalogue, last);
    }
}

// Patches to a draw.
static uint32_t batch_patches(const bench_job *job) {
    if (job->device->properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) {
        return job->triangle_count;
    }
    // n segments on all edges: rings of 3n, 3(n - 2), ... vertices around a vertex or a triangle.
    // One segment more covers fractional odd spacing.
    const uint32_t n = most_segments(job, &job->frame) + 1;
    const uint32_t vertices = 3 * (n + 2) * n / 4 + 1;
    const uint32_t fitting = MOST_BATCH_VERTICES / vertices;
    return fitting < MOST_BATCH_PATCHES ? fitting : MOST_BATCH_PATCHES;
}

static const char *unfit(const bench_job *job) {
    if (!job->device->features.tessellationShader) {
        return "the device lacks tessellationShader";
    }
    if (most_segments(job, &job->reference) >
        job->device->properties.limits.maxTessellationGenerationLevel) {
        return "edges may have more segments than maxTessellationGenerationLevel";
    }
    return NULL;
}

static void destroy(void *state) {
    hardware *s = state;
    if (!s) {
        return;
    }
    bench_pipelines_destroy(s->job->target, s->pipelines);
    bench_layout_destroy(s->job->target, &s->layout);
    free(s);
}

static girih_result create_pipelines(hardware *s, int variant, girih_error *error) {
    // By variant and surface.
    const struct {
        bench_shader shader, capture;
    } evaluations[2][2] = {
        {{bench_shader_hardware_equal_flat, bench_shader_hardware_equal_flat_capture},
         {bench_shader_hardware_equal_pn, bench_shader_hardware_equal_pn_capture}},
        {{bench_shader_hardware_fractional_flat, bench_shader_hardware_fractional_flat_capture},
         {bench_shader_hardware_fractional_pn, bench_shader_hardware_fractional_pn_capture}}};
    const bool pn = s->job->surface == GIRIH_SURFACE_PN;
    const bench_pipeline_desc desc = {.vertex = bench_shader_corners,
                                      .control = pn ? bench_shader_hardware_control_pn
                                                    : bench_shader_hardware_control_flat,
                                      .evaluation = evaluations[variant][pn].shader,
                                      .capture = evaluations[variant][pn].capture,
                                      .input = &bench_corner_input,
                                      .topology = VK_PRIMITIVE_TOPOLOGY_PATCH_LIST,
                                      .patch_points = 3,
                                      .layout = s->layout.layout};
    return bench_pipelines_create(s->job->target, &desc, s->pipelines, error);
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    hardware *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    s->job = job;
    girih_result result = bench_layout_create(job->target, NULL, 0, 0, &s->layout, error);
    if (result == GIRIH_OK) {
        result = create_pipelines(s, variant, error);
    }
    if (result != GIRIH_OK) {
        destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const hardware *s = state;
    const bench_job *job = s->job;
    const VkDeviceSize offset = 0;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipelines[raster]);
    bench_bind_layout(job->target, commands, &s->layout, VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdBindVertexBuffers(commands, 0, 1, &job->vertex_buffer.buffer, &offset);
    vkCmdBindIndexBuffer(commands, job->index_buffer.buffer, 0, VK_INDEX_TYPE_UINT32);
    bench_begin_draws(job->target, commands, raster);
    const uint32_t batch = batch_patches(job);
    for (uint32_t first = 0; first < job->triangle_count; first += batch) {
        const uint32_t rest = job->triangle_count - first;
        vkCmdDrawIndexed(commands, 3 * (rest < batch ? rest : batch), 1, 3 * first, 0, 0);
    }
    bench_end_draws(job->target, commands, raster);
}

#define HARDWARE(NAME, VARIANT, SPACING)                                                           \
    {                                                                                              \
        .name = NAME, .follows = "Vulkan 1.3, chapter Tessellation, " SPACING,                     \
        .note =                                                                                    \
            "on Mesa's lavapipe no measure of a GPU's: its vertices wrap round at 16 bits and "    \
            "its cost is quadratic in a batch, so that it is drawn at most 96 patches at a "       \
            "time",                                                                                \
        .variant = VARIANT, .unfit = unfit, .create = create, .destroy = destroy, .draw = draw     \
    }

const bench_method bench_hardware = HARDWARE("hardware", EQUAL, "equal spacing");
const bench_method bench_hardware_fractional =
    HARDWARE("hardware-fractional", FRACTIONAL, "fractional odd spacing");
