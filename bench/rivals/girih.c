// girih's own methods: levels to draw, each frame.
#include <stdlib.h>

#include "error.h"
#include "methods.h"

#include "bench_shaders.h"

#define ROOM_FOR_SPLITS 65536u

enum { AUTO, BAKED, WELDED, INSTANCED, UNCHANGED, SPLITS };

typedef struct own {
    const bench_job *job;
    bench_layout layout;
    VkPipeline pipelines[BENCH_RASTERS];
    girih_plan *plan;
} own;

typedef struct instanced_shaders {
    const bench_shader *drawn, *captured;
} instanced_shaders;

// Flat or PN, of plans that split nothing or triangles.
static const instanced_shaders instanced[2][2] = {
    {{&bench_shader_instanced_flat, &bench_shader_instanced_flat_capture},
     {&bench_shader_instanced_flat_splits, &bench_shader_instanced_flat_splits_capture}},
    {{&bench_shader_instanced_pn, &bench_shader_instanced_pn_capture},
     {&bench_shader_instanced_pn_splits, &bench_shader_instanced_pn_splits_capture}}};

static bool can_instance(const bench_job *job) {
    return job->device->features.multiDrawIndirect &&
           job->device->features.drawIndirectFirstInstance;
}

static const char *unfit_instanced(const bench_job *job) {
    return can_instance(job) ? NULL
                             : "the device lacks multiDrawIndirect or drawIndirectFirstInstance";
}

static const char *unfit_welded(const bench_job *job) {
    return job->room_splits ? "splits no triangles" : NULL;
}

void bench_girih_destroy(void *state) {
    own *s = state;
    if (!s) {
        return;
    }
    bench_pipelines_destroy(s->job->target, s->pipelines);
    bench_layout_destroy(s->job->target, &s->layout);
    girih_plan_destroy(s->plan);
    free(s);
}

girih_result bench_girih_create(const bench_job *job, const girih_context *context,
                                const girih_plan_desc *plan, void **state, girih_error *error) {
    own *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    s->job = job;
    girih_result result = girih_plan_create(context, plan, &s->plan, error);
    if (result == GIRIH_OK) {
        result = bench_layout_create(job->target, NULL, 0, 0, &s->layout, error);
    }
    if (result == GIRIH_OK) {
        bench_pipeline_desc desc = {.vertex = bench_shader_baked,
                                    .capture = bench_shader_baked_capture,
                                    .input = girih_plan_vertex_input(s->plan),
                                    .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
                                    .layout = s->layout.layout};
        if (plan->mode == GIRIH_MODE_INSTANCED) {
            const instanced_shaders *shaders =
                &instanced[plan->surface == GIRIH_SURFACE_PN][plan->max_splits != 0];
            desc.vertex = *shaders->drawn;
            desc.capture = *shaders->captured;
        }
        result = bench_pipelines_create(job->target, &desc, s->pipelines, error);
    }
    if (result != GIRIH_OK) {
        bench_girih_destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

// Refines the reference frame.
static girih_result refine_once(own *s, girih_error *error) {
    girih_device *device = s->job->device;
    girih_result result = girih_device_begin(device, error);
    if (result == GIRIH_OK) {
        result = girih_cmd_refine(s->plan, device->commands, &s->job->reference, NULL, error);
    }
    return result == GIRIH_OK ? girih_device_finish(device, error) : result;
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    girih_plan_desc desc = {.scene = job->scene,
                            .instances = &instance,
                            .instance_count = 1,
                            .surface = job->surface,
                            .mode = variant == WELDED      ? GIRIH_MODE_WELDED
                                    : variant == INSTANCED ? GIRIH_MODE_INSTANCED
                                                           : GIRIH_MODE_BAKED,
                            .max_vertices = 4 * job->room_triangles,
                            .max_triangles = job->room_triangles,
                            .max_segments = variant == SPLITS ? 32768 : job->max_segments,
                            .max_splits = variant == SPLITS ? ROOM_FOR_SPLITS : job->room_splits};
    if (variant == AUTO) {
        desc.mode = girih_choose_mode(job->context, &desc, job->room_triangles);
    }
    void *made = NULL;
    girih_result result = bench_girih_create(job, job->context, &desc, &made, error);
    if (result == GIRIH_OK && variant == UNCHANGED) {
        result = refine_once(made, error);
    }
    if (result != GIRIH_OK) {
        bench_girih_destroy(made);
        return result;
    }
    *state = made;
    return GIRIH_OK;
}

girih_result bench_girih_prepare(void *state, VkCommandBuffer commands, girih_error *error) {
    own *s = state;
    return girih_cmd_refine(s->plan, commands, &s->job->frame, NULL, error);
}

void bench_girih_draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const own *s = state;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipelines[raster]);
    bench_bind_layout(s->job->target, commands, &s->layout, VK_PIPELINE_BIND_POINT_GRAPHICS);
    bench_begin_draws(s->job->target, commands, raster);
    girih_cmd_draw(s->plan, commands, 0, VK_NULL_HANDLE, 0);
    bench_end_draws(s->job->target, commands, raster);
}

bool bench_girih_overflow(void *state) {
    const own *s = state;
    return girih_plan_statistics(s->plan).overflow;
}

static uint64_t drawn(void *state) {
    const own *s = state;
    return girih_plan_statistics(s->plan).output_triangles;
}

#define OWN(NAME, VARIANT, UNFIT, PREPARE)                                                         \
    {                                                                                              \
        .name = NAME, .follows = "this project", .variant = VARIANT, .unfit = UNFIT,               \
        .create = create, .destroy = bench_girih_destroy, .prepare = PREPARE,                      \
        .draw = bench_girih_draw, .overflow = bench_girih_overflow, .drawn = drawn                 \
    }

const bench_method bench_girih = OWN("girih", AUTO, NULL, bench_girih_prepare);
const bench_method bench_girih_baked = OWN("girih-baked", BAKED, NULL, bench_girih_prepare);
const bench_method bench_girih_welded =
    OWN("girih-welded", WELDED, unfit_welded, bench_girih_prepare);
const bench_method bench_girih_instanced =
    OWN("girih-instanced", INSTANCED, unfit_instanced, bench_girih_prepare);
// Baked, with room for the parts of split triangles.
const bench_method bench_girih_splits = OWN("girih-splits", SPLITS, NULL, bench_girih_prepare);
const bench_method bench_girih_unchanged = OWN("girih-unchanged", UNCHANGED, NULL, NULL);
