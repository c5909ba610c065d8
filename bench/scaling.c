// The case `scaling`: what a frame costs by its input and by its output, stage by stage, and the
// memory both take. Levels to output of the baked mode, without a draw.
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "context.h"
#include "error.h"
#include "statistics.h"

#define STAGES (GIRIH_TIMESTAMPS - 1)
#define MOST_OUTPUT (UINT64_C(1) << 24) // triangles: minutes, not hours
#define MOST_BYTES (UINT64_C(3) << 30)
#define LEAST_RUNS 5u
#define TRIANGLES_WANTED (UINT64_C(1) << 26) // of all runs of a row together

static const char *const stage_names[STAGES] = {"levels",   "select",   "group",
                                                "dispatch", "evaluate", "output"};

static const double inputs[] = {1e3, 1e4, 1e5, 1e6, 5e6, 1e7};

// Every edge alike gives outputs of 1 to 4096 triangles a triangle; levels drawn for each edge give
// many groups.
static const struct {
    const char *name;
    girih_level_rule rule;
    uint32_t segments;
} fineness[] = {
    {"uniform 1", GIRIH_LEVEL_SEGMENTS, 1},        {"uniform 2", GIRIH_LEVEL_SEGMENTS, 2},
    {"uniform 4", GIRIH_LEVEL_SEGMENTS, 4},        {"uniform 8", GIRIH_LEVEL_SEGMENTS, 8},
    {"uniform 16", GIRIH_LEVEL_SEGMENTS, 16},      {"uniform 32", GIRIH_LEVEL_SEGMENTS, 32},
    {"uniform 64", GIRIH_LEVEL_SEGMENTS, 64},      {"random 1 to 2", GIRIH_LEVEL_RANDOM_LEVEL, 1},
    {"random 1 to 8", GIRIH_LEVEL_RANDOM_LEVEL, 3}};

// Everything of one input; zero is nothing.
typedef struct scaling_state {
    const girih_mesh *mesh;
    girih_context *context;
    girih_scene *scene;
    VkQueryPool queries;
    uint64_t context_bytes, topology_bytes, mesh_bytes;
} scaling_state;

typedef struct scaling_samples {
    double stage[STAGES][STATISTICS_MOST];
    double front[STATISTICS_MOST]; // levels, select and group
    double wall[STATISTICS_MOST];
} scaling_samples;

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}

// --- Input --------------------------------------------------------------------------------------

// A closed torus of about `triangles` triangles, twice as many as vertices, whatever their number.
static girih_result make_torus(double triangles, const girih_mesh **mesh, girih_error *error) {
    const uint32_t rows = (uint32_t)sqrt(triangles / 2);
    const uint32_t columns = (uint32_t)(triangles / 2 / rows);
    const uint32_t vertices = rows * columns;
    const size_t corners = 6 * (size_t)vertices;
    float(*positions)[3] = malloc(vertices * sizeof *positions);
    float(*normals)[3] = malloc(vertices * sizeof *normals);
    uint32_t *indices = malloc(corners * sizeof *indices);
    girih_result result = GIRIH_OK;
    if (!positions || !normals || !indices) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
        goto cleanup;
    }
    const double turn = 6.283185307179586;
    for (uint32_t vertex = 0; vertex < vertices; ++vertex) {
        const uint32_t row = vertex / columns;
        const uint32_t column = vertex % columns;
        const uint32_t next_row = (row + 1) % rows * columns;
        const uint32_t next_column = (column + 1) % columns;
        const double a = turn * row / rows;
        const double b = turn * column / columns;
        const double normal[3] = {cos(b) * cos(a), sin(b) * cos(a), sin(a)};
        const double centre[3] = {cos(b), sin(b), 0.0};
        for (int axis = 0; axis < 3; ++axis) {
            normals[vertex][axis] = (float)normal[axis];
            positions[vertex][axis] = (float)(centre[axis] + 0.4 * normal[axis]);
        }
        const uint32_t quad[4] = {vertex, row * columns + next_column, next_row + next_column,
                                  next_row + column};
        const uint32_t two[6] = {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]};
        for (uint32_t n = 0; n < 6; ++n) {
            indices[6 * (size_t)vertex + n] = two[n];
        }
    }
    const girih_mesh_desc desc = {.name = "torus",
                                  .vertex_count = vertices,
                                  .positions = &positions[0][0],
                                  .normals = &normals[0][0],
                                  .indices = indices,
                                  .index_count = (uint32_t)corners};
    result = girih_mesh_create(&desc, mesh, error);

cleanup:
    free(positions);
    free(normals);
    free(indices);
    return result;
}

static girih_result begin_input(girih_device *device, double triangles, scaling_state *s,
                                girih_error *error) {
    girih_result result = make_torus(triangles, &s->mesh, error);
    if (result == GIRIH_OK) {
        result = girih_device_context(device, NULL, &s->context, error);
    }
    const girih_scene_desc desc = {.meshes = &s->mesh, .mesh_count = 1};
    girih_buffer_need needs[GIRIH_SCENE_BUFFERS];
    if (result == GIRIH_OK) {
        result = girih_scene_needs(s->context, &desc, needs, error);
    }
    if (result == GIRIH_OK) {
        result = girih_scene_create(s->context, &desc, &s->scene, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_queries(device, GIRIH_TIMESTAMPS, &s->queries, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_begin(device, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    girih_cmd_upload_context(s->context, device->commands);
    girih_cmd_upload_scene(s->scene, device->commands);
    result = girih_device_finish(device, error);
    girih_scene_trim(s->scene);
    // The mesh itself: a position and a normal a vertex, three indices a triangle.
    s->mesh_bytes = s->mesh->vertex_count * UINT64_C(24) + s->mesh->triangle_count * UINT64_C(12);
    s->topology_bytes = needs[GIRIH_SCENE_ARENA].size - s->mesh_bytes;
    s->context_bytes = s->context->patterns.size + s->context->indices.size;
    return result;
}

static void end_input(girih_device *device, scaling_state *s) {
    vkDestroyQueryPool(device->device, s->queries, NULL);
    girih_scene_destroy(s->scene);
    girih_context_destroy(s->context);
    girih_mesh_destroy(s->mesh);
}

// --- Frames -------------------------------------------------------------------------------------

static girih_result run_frame(girih_device *device, const scaling_state *s, girih_plan *plan,
                              const girih_frame *frame, double times[STAGES], double *wall,
                              girih_error *error) {
    girih_plan_invalidate(plan);
    const double begin = now();
    girih_result result = girih_device_begin(device, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (s->queries != VK_NULL_HANDLE) {
        vkCmdResetQueryPool(device->commands, s->queries, 0, GIRIH_TIMESTAMPS);
    }
    const girih_timestamps timestamps = {.pool = s->queries};
    result = girih_cmd_refine(plan, device->commands, frame, &timestamps, error);
    const girih_result finished = girih_device_finish(device, error);
    *wall = now() - begin;
    double at[GIRIH_TIMESTAMPS] = {0};
    girih_device_read_queries(device, s->queries, 0, GIRIH_TIMESTAMPS, at);
    for (uint32_t n = 0; n < STAGES; ++n) {
        times[n] = at[n + 1] - at[n];
    }
    return result == GIRIH_OK ? finished : result;
}

// {"median_ms", "min_ms", "ns_per_input", "ns_per_output"} of samples, which are sorted.
static json_t *describe(double *samples, uint32_t runs, const girih_statistics *statistics) {
    const double median = statistics_median(samples, runs);
    return json_pack("{s:f,s:f,s:f,s:f}", "median_ms", median, "min_ms", samples[0], "ns_per_input",
                     median * 1e6 / (double)statistics->input_triangles, "ns_per_output",
                     median * 1e6 / (double)statistics->output_triangles);
}

// What the plan needs to work, beside its output.
static uint64_t work_bytes(const girih_buffer_need needs[GIRIH_PLAN_BUFFERS]) {
    return needs[GIRIH_PLAN_WORK].size + needs[GIRIH_PLAN_STAGING].size +
           needs[GIRIH_PLAN_STATUS].size;
}

// `least` is the work of a plan with room for level 0 alone: what goes beyond it, draws, is there
// for the output.
static json_t *describe_memory(const scaling_state *s, const girih_statistics *statistics,
                               uint64_t least, const girih_buffer_need needs[GIRIH_PLAN_BUFFERS]) {
    uint64_t output = work_bytes(needs) - least;
    for (uint32_t n = GIRIH_PLAN_POSITIONS; n < GIRIH_PLAN_BUFFERS; ++n) {
        output += needs[n].size;
    }
    return json_pack("{s:I,s:I,s:I,s:I,s:I,s:f,s:f}", "context_bytes", (json_int_t)s->context_bytes,
                     "mesh_bytes", (json_int_t)s->mesh_bytes, "topology_bytes",
                     (json_int_t)s->topology_bytes, "work_bytes", (json_int_t)least, "output_bytes",
                     (json_int_t)output, "beyond_mesh_per_input",
                     (double)(s->topology_bytes + least) / (double)statistics->input_triangles,
                     "output_per_output", (double)output / (double)statistics->output_triangles);
}

// Runs frames of one plan and appends their figures.
static girih_result measure(girih_device *device, const scaling_state *s, girih_plan *plan,
                            uint64_t least, const girih_buffer_need needs[GIRIH_PLAN_BUFFERS],
                            girih_frame frame, const char *name, uint32_t runs,
                            scaling_samples *samples, json_t *list, girih_error *error) {
    double times[STAGES];
    double wall;
    girih_result result = run_frame(device, s, plan, &frame, times, &wall, error); // warm-up
    girih_statistics statistics = {0};
    for (uint32_t run = 0; run < runs && result == GIRIH_OK; ++run) {
        frame.seed = run + 2;
        result = run_frame(device, s, plan, &frame, times, &samples->wall[run], error);
        for (uint32_t stage = 0; stage < STAGES; ++stage) {
            samples->stage[stage][run] = times[stage];
        }
        samples->front[run] = (times[0] + times[1]) + times[2];
        statistics = girih_plan_statistics(plan);
        if (result == GIRIH_OK && statistics.overflow) {
            result =
                girih_fail(error, GIRIH_ERROR_TOO_LARGE, "scaling: a frame did not fit its plan");
        }
    }
    if (result != GIRIH_OK) {
        return result;
    }
    json_t *stages = json_object();
    double sum = 0.0;
    for (uint32_t stage = 0; stage < STAGES; ++stage) {
        json_t *figures = describe(samples->stage[stage], runs, &statistics);
        sum += json_real_value(json_object_get(figures, "median_ms"));
        json_object_set_new(stages, stage_names[stage], figures);
    }
    for (uint32_t stage = 0; stage < STAGES; ++stage) {
        json_t *figures = json_object_get(stages, stage_names[stage]);
        const double median = json_real_value(json_object_get(figures, "median_ms"));
        json_object_set_new(figures, "share", json_real(sum > 0.0 ? median / sum : 0.0));
    }
    json_array_append_new(
        list,
        json_pack("{s:s,s:s,s:I,s:I,s:i,s:i,s:o,s:o,s:o,s:o}", "name", "scaling", "levels", name,
                  "input_triangles", (json_int_t)statistics.input_triangles, "output_triangles",
                  (json_int_t)statistics.output_triangles, "groups", (int)statistics.groups, "runs",
                  (int)runs, "wall", describe(samples->wall, runs, &statistics), "levels_to_group",
                  describe(samples->front, runs, &statistics), "stages", stages, "memory",
                  describe_memory(s, &statistics, least, needs)));
    return GIRIH_OK;
}

// One row of the table: a plan with just the room that the levels need. Nothing where that is more
// than a bench should take.
static girih_result run_row(girih_device *device, const scaling_state *s, size_t row, uint32_t runs,
                            scaling_samples *samples, json_t *list, girih_error *error) {
    const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    girih_plan_desc desc = {.scene = s->scene,
                            .instances = &instance,
                            .instance_count = 1,
                            .surface = GIRIH_SURFACE_PN,
                            .mode = GIRIH_MODE_BAKED};
    const girih_frame frame = {
        .rule = fineness[row].rule, .segments = fineness[row].segments, .seed = 1};
    girih_plan *plan = NULL;
    double times[STAGES];
    double wall;
    girih_buffer_need needs[GIRIH_PLAN_BUFFERS];
    girih_result result = girih_plan_needs(s->context, &desc, needs, error);
    const uint64_t least = result == GIRIH_OK ? work_bytes(needs) : 0;
    // With room for level 0 alone the frame still says how much it needs.
    if (result == GIRIH_OK) {
        result = girih_plan_create(s->context, &desc, &plan, error);
    }
    if (result == GIRIH_OK) {
        result = run_frame(device, s, plan, &frame, times, &wall, error);
    }
    if (result != GIRIH_OK) {
        girih_plan_destroy(plan);
        return result;
    }
    const girih_statistics needed = girih_plan_statistics(plan);
    girih_plan_destroy(plan);
    // Other seeds ask for a little more or less.
    const uint64_t triangles = needed.needed_triangles + needed.needed_triangles / 4;
    const uint64_t vertices = needed.needed_vertices + needed.needed_vertices / 4;
    if (needed.needed_triangles > MOST_OUTPUT) {
        return GIRIH_OK;
    }
    desc.max_triangles = (uint32_t)triangles;
    desc.max_vertices = (uint32_t)vertices;
    result = girih_plan_needs(s->context, &desc, needs, error);
    uint64_t bytes = s->mesh_bytes + s->topology_bytes;
    for (uint32_t n = 0; n < GIRIH_PLAN_BUFFERS && result == GIRIH_OK; ++n) {
        bytes += needs[n].size;
    }
    if (result != GIRIH_OK || bytes > MOST_BYTES) {
        return result;
    }
    result = girih_plan_create(s->context, &desc, &plan, error);
    if (result == GIRIH_OK) {
        const uint64_t affordable =
            TRIANGLES_WANTED / (needed.input_triangles + needed.needed_triangles);
        const uint32_t turns = affordable < LEAST_RUNS ? LEAST_RUNS
                               : affordable < runs     ? (uint32_t)affordable
                                                       : runs;
        result = measure(device, s, plan, least, needs, frame, fineness[row].name, turns, samples,
                         list, error);
    }
    girih_plan_destroy(plan);
    return result;
}

girih_result bench_scaling(const bench_run *run, girih_error *error) {
    girih_device *device = run->device;
    const uint32_t runs = run->pairs;
    json_t *list = run->cases;
    scaling_samples *samples = malloc(sizeof *samples);
    if (!samples) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < sizeof inputs / sizeof *inputs && result == GIRIH_OK; ++n) {
        scaling_state state = {0};
        result = begin_input(device, inputs[n], &state, error);
        for (size_t row = 0; row < sizeof fineness / sizeof *fineness && result == GIRIH_OK;
             ++row) {
            result = run_row(device, &state, row, runs < STATISTICS_MOST ? runs : STATISTICS_MOST,
                             samples, list, error);
        }
        end_input(device, &state);
    }
    free(samples);
    return result;
}
