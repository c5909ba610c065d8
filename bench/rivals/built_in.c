// girih with the built-in dyadic catalogue beside the job's: the same edge levels, other patterns.
#include <stdlib.h>

#include "bench.h"
#include "error.h"
#include "methods.h"

typedef struct built_in {
    girih_context *context;
    girih_scene *scene;
    void *own;
} built_in;

static void destroy(void *state) {
    built_in *b = state;
    if (b) {
        bench_girih_destroy(b->own);
        girih_scene_destroy(b->scene);
        girih_context_destroy(b->context);
        free(b);
    }
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    (void)variant;
    built_in *b = calloc(1, sizeof *b);
    if (!b) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = bench_scene_create(job->device, girih_catalogue_dyadic(), job->mesh,
                                             &b->context, &b->scene, error);
    if (result == GIRIH_OK) {
        const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
        // The job's room is enough: none of these patterns has more triangles than `uniform`.
        girih_plan_desc plan = {.scene = b->scene,
                                .instances = &instance,
                                .instance_count = 1,
                                .surface = job->surface,
                                .max_vertices = 4 * job->room_triangles,
                                .max_triangles = job->room_triangles};
        // The mode that `girih` has, so that the patterns alone differ.
        plan.mode = girih_choose_mode(b->context, &plan, job->room_triangles);
        result = bench_girih_create(job, b->context, &plan, &b->own, error);
    }
    if (result != GIRIH_OK) {
        destroy(b);
        return result;
    }
    *state = b;
    return GIRIH_OK;
}

static girih_result prepare(void *state, VkCommandBuffer commands, girih_error *error) {
    return bench_girih_prepare(((built_in *)state)->own, commands, error);
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    bench_girih_draw(((built_in *)state)->own, commands, raster);
}

static bool overflow(void *state) {
    return bench_girih_overflow(((built_in *)state)->own);
}

const bench_method bench_girih_built_in = {
    .name = "girih-built-in",
    .follows = "this project",
    .note = "the built-in catalogue, family optimal: fewer triangles for the same edge levels",
    .create = create,
    .destroy = destroy,
    .prepare = prepare,
    .draw = draw,
    .overflow = overflow};
