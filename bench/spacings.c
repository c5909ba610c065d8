// Case `spacings`: the built-in catalogues against each other, linear to dyadic, at the same rule:
// no segment longer than so many pixels or units. Each mode by itself, Curved PN, levels that
// change every frame; and what it takes to make either ready.
//
// Levels are rounded up to what a catalogue has, so dyadic ones are finer than what was asked for,
// how much finer depends on where between two powers of two the edges lie. So the length of a
// segment doubles in the course of the frames: no place between them is favoured.
#include <math.h>
#include <stdlib.h>

#include "catalogues.h"
#include "context.h"
#include "error.h"

// 40 pairs go through them five times.
#define FRAMES 8u
// Where triangles are split: more than any edge asks for.
#define SPLIT_SEGMENTS 256u

typedef struct setting {
    const char *name;
    bench_shape shape;
    void (*frame)(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view);
    uint32_t fineness;
    uint32_t max_segments;
} setting;

static void view_frame(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view) {
    bench_view_frame(fineness, n, frame, view);
    frame->length *= exp2f((float)n / (float)FRAMES);
}

static void length_frame(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view) {
    bench_length_frame(fineness, n, frame, view);
    frame->length *= exp2f((float)n / (float)FRAMES);
}

// The most segments that an edge asks for, in frame 0, are about those of the name.
static const setting settings[] = {
    {"view, to 4 segments", {.halvings = 6}, view_frame, 560, 0},
    {"lengths, to 4 segments", {.slices = 192, .stacks = 97}, length_frame, 760, 0},
    {"view, to 16 segments", {.halvings = 5}, view_frame, 1100, 0},
    {"lengths, to 16 segments", {.slices = 48, .stacks = 25}, length_frame, 900, 0},
    {"view, to 64 segments", {.halvings = 3}, view_frame, 1350, SPLIT_SEGMENTS},
    {"lengths, to 64 segments", {.slices = 16, .stacks = 9}, length_frame, 1250, SPLIT_SEGMENTS},
    {"view, to 200 segments", {.halvings = 1}, view_frame, 1400, SPLIT_SEGMENTS},
    {"lengths, to 200 segments", {.slices = 6, .stacks = 4}, length_frame, 1500, SPLIT_SEGMENTS},
};

static girih_result create_jobs(const bench_run *run, bench_target *target, const setting *s,
                                const bench_mesh *mesh, bench_catalogue_pair *pair,
                                girih_error *error) {
    const girih_catalogue *const catalogues[2] = {girih_catalogue_dyadic(),
                                                  girih_catalogue_linear()};
    *pair = (bench_catalogue_pair){.names = {"dyadic", "linear"}};
    girih_result result = GIRIH_OK;
    for (int n = 0; n < 2 && result == GIRIH_OK; ++n) {
        const bench_job_desc desc = {.name = s->name,
                                     .mesh = mesh,
                                     .catalogue = catalogues[n],
                                     .surface = GIRIH_SURFACE_PN,
                                     .frame = s->frame,
                                     .user = &s->fineness,
                                     .max_segments = s->max_segments,
                                     .frame_count = FRAMES};
        result = bench_job_create(target, run->device, &desc, &pair->jobs[n], error);
    }
    return result;
}

static girih_result run_setting(const bench_run *run, bench_target *target, const setting *s,
                                girih_error *error) {
    bench_mesh mesh = {0};
    bench_catalogue_pair pair = {0};
    json_t *item;
    girih_result result = bench_shape_make(&s->shape, &mesh, error);
    if (result == GIRIH_OK) {
        result = create_jobs(run, target, s, &mesh, &pair, error);
    }
    if (result == GIRIH_OK) {
        result = bench_measure_catalogues(run, &pair, &item, error);
    }
    bench_job_destroy(&pair.jobs[0]);
    bench_job_destroy(&pair.jobs[1]);
    bench_mesh_free(&mesh);
    return result;
}

// --- Making a catalogue ready -------------------------------------------------------------------

// What a host does before its first frame, as methods that do it anew for each of theirs.
enum { CONTEXT, FIRST_FRAME };

static const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

typedef struct start {
    const bench_job *job;
    int what;
    girih_context *context;
    girih_scene *scene;
    girih_plan *plan;
} start;

static void clear_start(start *s) {
    girih_plan_destroy(s->plan);
    girih_scene_destroy(s->scene);
    girih_context_destroy(s->context);
    *s = (start){.job = s->job, .what = s->what};
}

static void start_destroy(void *state) {
    if (state) {
        clear_start(state);
        free(state);
    }
}

static girih_result start_create(const bench_job *job, int variant, void **state,
                                 girih_error *error) {
    start *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    *s = (start){.job = job, .what = variant};
    *state = s;
    return GIRIH_OK;
}

static girih_plan_desc describe_plan(const girih_scene *scene, const bench_job *job) {
    return (girih_plan_desc){.scene = scene,
                             .instances = &instance,
                             .instance_count = 1,
                             .surface = job->surface,
                             .mode = GIRIH_MODE_BAKED,
                             .max_vertices = 4 * job->room_triangles,
                             .max_triangles = job->room_triangles};
}

static girih_result start_context(start *s, girih_error *error) {
    girih_device *device = s->job->device;
    girih_result result = girih_device_context(device, s->job->catalogue, &s->context, error);
    if (result == GIRIH_OK) {
        result = girih_device_begin(device, error);
    }
    if (result == GIRIH_OK) {
        girih_cmd_upload_context(s->context, device->commands);
        result = girih_device_finish(device, error);
    }
    return result;
}

static girih_result start_plan(start *s, girih_error *error) {
    const bench_job *job = s->job;
    girih_result result =
        bench_scene_create(job->device, job->catalogue, job->mesh, &s->context, &s->scene, error);
    if (result == GIRIH_OK) {
        const girih_plan_desc desc = describe_plan(s->scene, job);
        result = girih_plan_create(s->context, &desc, &s->plan, error);
    }
    return result;
}

static girih_result start_anew(void *state, girih_error *error) {
    start *s = state;
    clear_start(s);
    return s->what == CONTEXT ? start_context(s, error) : start_plan(s, error);
}

static girih_result start_refine(void *state, VkCommandBuffer commands, girih_error *error) {
    const start *s = state;
    return s->plan ? girih_cmd_refine(s->plan, commands, &s->job->frame, NULL, error) : GIRIH_OK;
}

static void start_draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    (void)state;
    (void)commands;
    (void)raster;
}

#define START(NAME, WHAT)                                                                          \
    {                                                                                              \
        .name = NAME, .follows = "this project", .variant = WHAT, .create = start_create,          \
        .destroy = start_destroy, .ahead = start_anew, .prepare = start_refine, .draw = start_draw \
    }

static const bench_method starts[] = {START("context", CONTEXT), START("first-frame", FIRST_FRAME)};

static uint32_t count_pipelines(const girih_context *context) {
    uint32_t count = 0;
    for (uint32_t shader = 0; shader < GIRIH_SHADER_COUNT; ++shader) {
        for (uint32_t variant = 0; variant < GIRIH_MAX_VARIANTS; ++variant) {
            count += context->pipelines[shader][variant] != VK_NULL_HANDLE;
        }
    }
    return count;
}

// What a catalogue, and a baked plan with it, take on the device.
static girih_result add_sizes(const bench_job *job, json_t *object, girih_error *error) {
    const girih_plan_desc desc = describe_plan(job->scene, job);
    girih_buffer_need needs[GIRIH_PLAN_BUFFERS];
    girih_plan *plan = NULL;
    girih_result result = girih_plan_needs(job->context, &desc, needs, error);
    if (result == GIRIH_OK) {
        // The context makes the pipelines that the plan needs.
        result = girih_plan_create(job->context, &desc, &plan, error);
    }
    if (result == GIRIH_OK) {
        const girih_context *context = job->context;
        json_object_set_new(object, "catalogue",
                            json_pack("{s:i,s:i,s:I,s:I,s:I,s:i}", "patterns",
                                      (int)job->catalogue->pattern_count, "groups",
                                      (int)context->catalogue.frame.range_count, "bytes",
                                      (json_int_t)job->catalogue->bytes, "device_bytes",
                                      (json_int_t)(context->patterns.size + context->indices.size),
                                      "plan_bytes", (json_int_t)needs[GIRIH_PLAN_WORK].size,
                                      "pipelines", (int)count_pipelines(context)));
    }
    girih_plan_destroy(plan);
    return result;
}

static girih_result run_start(const bench_run *run, bench_target *target, girih_error *error) {
    static const setting s = {"making ready", {.halvings = 3}, view_frame, 256, 0};
    bench_mesh mesh = {0};
    bench_catalogue_pair pair = {0};
    json_t *figures = json_object();
    girih_result result = bench_shape_make(&s.shape, &mesh, error);
    if (result == GIRIH_OK) {
        result = create_jobs(run, target, &s, &mesh, &pair, error);
    }
    bench_case_job *const jobs[2] = {&pair.jobs[0], &pair.jobs[1]};
    jobs[1]->desc.geometry_only = true;
    for (size_t n = 0; n < sizeof starts / sizeof *starts && result == GIRIH_OK; ++n) {
        const bench_method *const methods[2] = {&starts[n], &starts[n]};
        json_t *object = json_object();
        json_object_set_new(figures, starts[n].name, object);
        result = bench_measure_pair(run, jobs, methods, object, error);
    }
    if (result == GIRIH_OK) {
        result = bench_add_case(run, jobs[0], figures, error);
    }
    json_t *item = json_array_get(run->cases, json_array_size(run->cases) - 1);
    if (result == GIRIH_OK) {
        json_object_set_new(item, "ratio_to", json_string(pair.names[0]));
    }
    for (int n = 0; n < 2 && result == GIRIH_OK; ++n) {
        json_t *object = json_object();
        json_object_set_new(item, pair.names[n], object);
        result = add_sizes(&jobs[n]->job, object, error);
    }
    json_decref(figures);
    bench_job_destroy(&pair.jobs[0]);
    bench_job_destroy(&pair.jobs[1]);
    bench_mesh_free(&mesh);
    return result;
}

girih_result bench_spacings(const bench_run *run, girih_error *error) {
    bench_target *target = NULL;
    girih_result result = bench_target_create(run->device, &target, error);
    for (size_t n = 0; n < sizeof settings / sizeof *settings && result == GIRIH_OK; ++n) {
        result = run_setting(run, target, &settings[n], error);
    }
    if (result == GIRIH_OK) {
        result = run_start(run, target, error);
    }
    bench_target_destroy(target);
    return result;
}
