// girih with a surface of the host's: displaced Curved PN triangles, baked.
#include <stdlib.h>

#include "bench_shaders.h"
#include "error.h"
#include "methods.h"

typedef struct displaced {
    girih_surface_program *program;
    void *own;
} displaced;

static void destroy(void *state) {
    displaced *d = state;
    if (d) {
        bench_girih_destroy(d->own);
        girih_surface_program_destroy(d->program);
        free(d);
    }
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    (void)variant;
    displaced *d = calloc(1, sizeof *d);
    if (!d) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    const girih_surface_program_desc program = {.bake = bench_shader_waves.words,
                                                .bake_bytes = bench_shader_waves.bytes,
                                                .bake_few = bench_shader_waves_few.words,
                                                .bake_few_bytes = bench_shader_waves_few.bytes,
                                                .base = GIRIH_SURFACE_PN,
                                                .reach = 0.04f};
    girih_result result = girih_surface_program_create(job->context, &program, &d->program, error);
    if (result == GIRIH_OK) {
        const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
        const girih_plan_desc plan = {.scene = job->scene,
                                      .instances = &instance,
                                      .instance_count = 1,
                                      .surface = GIRIH_SURFACE_OWN,
                                      .program = d->program,
                                      .mode = GIRIH_MODE_BAKED,
                                      .max_vertices = 4 * job->room_triangles,
                                      .max_triangles = job->room_triangles};
        result = bench_girih_create(job, job->context, &plan, &d->own, error);
    }
    if (result != GIRIH_OK) {
        destroy(d);
        return result;
    }
    *state = d;
    return GIRIH_OK;
}

static girih_result prepare(void *state, VkCommandBuffer commands, girih_error *error) {
    return bench_girih_prepare(((displaced *)state)->own, commands, error);
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    bench_girih_draw(((displaced *)state)->own, commands, raster);
}

static bool overflow(void *state) {
    return bench_girih_overflow(((displaced *)state)->own);
}

const bench_method bench_girih_displaced = {.name = "girih-displaced",
                                            .follows = "this project",
                                            .create = create,
                                            .destroy = destroy,
                                            .prepare = prepare,
                                            .draw = draw,
                                            .overflow = overflow};
