// Case `bake`: how fast triangles are refined into buffers, without a draw: positions, normals and
// 32-bit indices, each triangle with its own vertices. girih on the device, from levels to output;
// its CPU twin on one thread; OpenSubdiv's Bfr on one and two threads. All at the same rates.
//
// Only the work of a frame counts: memory is there and was touched before. For girih that includes
// recording, submission and the wait; for the twin its six stages; for Bfr neither the levels (the
// rates are handed over) nor the sizes of its output.
#include "bench.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "arrays.h"
#include "error.h"
#include "girih/girih.h"
#include "icosphere.h"
#include "memory.h"
#include "methods.h"
#include "rivals/bfr.h"
#include "statistics.h"

#define WARM_UP 2

static const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

static const struct sphere_case {
    const char *name;
    uint32_t halvings;  // of the icosahedron's edges: 20 * 4^halvings triangles
    uint32_t max_level; // of the random levels
} cases[] = {{"bake 1,280 to level 5", 3, 5},
             {"bake 20,480 to level 3", 5, 3},
             {"bake 327,680 to level 1", 7, 1}};

// Everything of one case; zero is nothing.
typedef struct case_state {
    girih_device *device;
    const girih_mesh *mesh;
    girih_frame frame;
    girih_arrays arrays; // of the twin
    girih_statistics statistics;
    girih_context *context;
    girih_scene *scene;
    girih_plan *plan;
    bench_bfr *bfr[2]; // by scheme
} case_state;

static void end_case(case_state *s) {
    bench_bfr_destroy(s->bfr[BENCH_BFR_BILINEAR]);
    bench_bfr_destroy(s->bfr[BENCH_BFR_LOOP]);
    girih_plan_destroy(s->plan);
    girih_scene_destroy(s->scene);
    girih_context_destroy(s->context);
    girih_arrays_free(&s->arrays, 0, GIRIH_BIND_COUNT);
    girih_mesh_destroy(s->mesh);
}

static girih_result make_mesh(case_state *s, uint32_t halvings, girih_error *error) {
    bench_icosphere sphere;
    girih_result result = bench_icosphere_make(halvings, &sphere, error);
    if (result == GIRIH_OK) {
        const girih_mesh_desc desc = {.name = "sphere",
                                      .vertex_count = sphere.vertex_count,
                                      .positions = sphere.positions,
                                      .normals = sphere.positions,
                                      .indices = sphere.indices,
                                      .index_count = sphere.index_count};
        result = girih_mesh_create(&desc, &s->mesh, error);
    }
    bench_icosphere_free(&sphere);
    return result;
}

// --- The CPU twin -------------------------------------------------------------------------------

// Everything that tells how large the output is.
static girih_result count_twin(case_state *s, girih_error *error) {
    girih_twin_levels(&s->arrays);
    girih_twin_select(&s->arrays, GIRIH_SURFACE_PN);
    const girih_result result = girih_twin_group(&s->arrays, error);
    if (result == GIRIH_OK) {
        girih_twin_dispatch(&s->arrays);
    }
    return result;
}

static girih_result run_twin(case_state *s, girih_error *error) {
    const girih_result result = count_twin(s, error);
    if (result == GIRIH_OK) {
        girih_twin_evaluate(&s->arrays, GIRIH_SURFACE_PN);
        girih_twin_output(&s->arrays, GIRIH_OUTPUT_INDICES);
    }
    return result;
}

static girih_result allocate(girih_arrays *arrays, uint32_t binding, uint64_t count,
                             girih_error *error) {
    arrays->words[binding] = girih_allocate_array((size_t)count, sizeof(uint32_t));
    arrays->count[binding] = count;
    return arrays->words[binding] ? GIRIH_OK
                                  : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

static girih_result make_twin(case_state *s, girih_error *error) {
    girih_scene_table table;
    girih_result result = girih_pack_catalogue(&s->arrays, bench_uniform_dyadic(), error);
    if (result == GIRIH_OK) {
        result = girih_pack_scene(&s->arrays, &table, &s->mesh, 1, 0, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    girih_plan_shape shape = {.mode = GIRIH_MODE_BAKED,
                              .outputs = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_NO_DRAW,
                              .max_vertices = UINT32_MAX,
                              .max_triangles = UINT32_MAX};
    result = girih_pack_plan(&s->arrays, &shape, &table, &instance, 1, error);
    girih_free(table.meshes);
    if (result == GIRIH_OK) {
        result = girih_pack_frame(&s->arrays, &s->frame, error);
    }
    static const uint32_t work[] = {GIRIH_BIND_LEVELS, GIRIH_BIND_KEYS, GIRIH_BIND_ITEMS,
                                    GIRIH_BIND_GROUPS, GIRIH_BIND_STATUS};
    for (size_t n = 0; n < sizeof work / sizeof *work && result == GIRIH_OK; ++n) {
        result = allocate(&s->arrays, work[n], s->arrays.count[work[n]], error);
    }
    if (result == GIRIH_OK) {
        result = count_twin(s, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    s->statistics = girih_read_status(&s->arrays.frame, s->arrays.words[GIRIH_BIND_STATUS]);
    const uint64_t vertex_words = 3 * s->statistics.output_vertices;
    result = allocate(&s->arrays, GIRIH_BIND_OUT_POSITIONS, vertex_words, error);
    if (result == GIRIH_OK) {
        result = allocate(&s->arrays, GIRIH_BIND_OUT_ATTRIBUTES, vertex_words, error);
    }
    if (result == GIRIH_OK) {
        result =
            allocate(&s->arrays, GIRIH_BIND_OUT_INDICES, 3 * s->statistics.output_triangles, error);
    }
    return result;
}

// --- girih on the device ------------------------------------------------------------------------

static girih_result run_girih(case_state *s, girih_error *error) {
    girih_result result = girih_device_begin(s->device, error);
    if (result == GIRIH_OK) {
        // The same levels again, but not kept from the last frame.
        ++s->frame.revision;
        result = girih_cmd_refine(s->plan, s->device->commands, &s->frame, NULL, error);
    }
    return result == GIRIH_OK ? girih_device_finish(s->device, error) : result;
}

static girih_result make_plan(case_state *s, girih_error *error) {
    girih_result result = girih_device_context(s->device, NULL, &s->context, error);
    if (result == GIRIH_OK) {
        result = girih_scene_create(
            s->context, &(girih_scene_desc){.meshes = &s->mesh, .mesh_count = 1}, &s->scene, error);
    }
    if (result == GIRIH_OK) {
        const girih_plan_desc desc = {.scene = s->scene,
                                      .instances = &instance,
                                      .instance_count = 1,
                                      .surface = GIRIH_SURFACE_PN,
                                      .mode = GIRIH_MODE_BAKED,
                                      .outputs = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_NO_DRAW,
                                      .max_vertices = (uint32_t)s->statistics.output_vertices,
                                      .max_triangles = (uint32_t)s->statistics.output_triangles};
        result = girih_plan_create(s->context, &desc, &s->plan, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_begin(s->device, error);
    }
    if (result == GIRIH_OK) {
        girih_cmd_upload_context(s->context, s->device->commands);
        girih_cmd_upload_scene(s->scene, s->device->commands);
        result = girih_device_finish(s->device, error);
    }
    if (result == GIRIH_OK) {
        result = run_girih(s, error);
    }
    if (result == GIRIH_OK &&
        girih_plan_statistics(s->plan).output_triangles != s->statistics.output_triangles) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                            "the device's output is not that of the CPU twin");
    }
    return result;
}

// --- Bfr ----------------------------------------------------------------------------------------

static girih_result run_bfr_loop(case_state *s, girih_error *error) {
    return bench_bfr_tessellate(s->bfr[BENCH_BFR_LOOP], 1, error);
}

static girih_result run_bfr_loop_2(case_state *s, girih_error *error) {
    return bench_bfr_tessellate(s->bfr[BENCH_BFR_LOOP], 2, error);
}

static girih_result run_bfr_bilinear(case_state *s, girih_error *error) {
    return bench_bfr_tessellate(s->bfr[BENCH_BFR_BILINEAR], 1, error);
}

static girih_result run_bfr_bilinear_2(case_state *s, girih_error *error) {
    return bench_bfr_tessellate(s->bfr[BENCH_BFR_BILINEAR], 2, error);
}

// With the segments of the twin's levels.
static girih_result make_bfr(case_state *s, girih_error *error) {
    const size_t edges = 3 * (size_t)s->mesh->triangle_count;
    uint32_t *segments = malloc(edges * sizeof *segments);
    if (!segments) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t n = 0; n < edges; ++n) {
        const uint32_t edge = s->arrays.words[GIRIH_BIND_TRIANGLE_EDGES][n] & GIRIH_EDGE_MASK;
        segments[n] = 1u << s->arrays.words[GIRIH_BIND_LEVELS][edge];
    }
    bench_bfr_desc desc = {.positions = s->mesh->positions,
                           .vertex_count = s->mesh->vertex_count,
                           .indices = s->mesh->triangle_vertices,
                           .segments = segments,
                           .triangle_count = s->mesh->triangle_count};
    girih_result result = GIRIH_OK;
    for (bench_bfr_scheme scheme = BENCH_BFR_BILINEAR;
         scheme <= BENCH_BFR_LOOP && result == GIRIH_OK; ++scheme) {
        desc.scheme = scheme;
        result = bench_bfr_create(&desc, &s->bfr[scheme], error);
    }
    free(segments);
    return result;
}

// --- Pictures -----------------------------------------------------------------------------------

// What a method has written, drawn as it is: the static mesh at level 0.
static girih_result draw_output(const bench_run *run, bench_target *target, const char *name,
                                const char *method_name, const bench_bfr_output *output,
                                girih_error *error) {
    bench_mesh mesh = {.name = method_name,
                       .vertex_count = output->vertex_count,
                       .triangle_count = output->triangle_count};
    girih_result result =
        bench_mesh_allocate(&mesh, output->vertex_count, output->triangle_count, error);
    if (result != GIRIH_OK) {
        return result;
    }
    memcpy(mesh.positions, output->positions, 12 * (size_t)output->vertex_count);
    memcpy(mesh.normals, output->normals, 12 * (size_t)output->vertex_count);
    memcpy(mesh.indices, output->indices, 12 * (size_t)output->triangle_count);
    static const uint32_t max_level = 0;
    const bench_job_desc desc = {.name = name,
                                 .mesh = &mesh,
                                 .catalogue = bench_uniform_dyadic(),
                                 .surface = GIRIH_SURFACE_FLAT,
                                 .frame = bench_random_frame,
                                 .user = &max_level};
    bench_case_job job = {0};
    result = bench_job_create(target, run->device, &desc, &job, error);
    if (result == GIRIH_OK) {
        bench_method method = bench_static;
        method.name = method_name;
        result = bench_picture(run, &job, &method, error);
    }
    bench_job_destroy(&job);
    bench_mesh_free(&mesh);
    return result;
}

static girih_result draw_outputs(const bench_run *run, bench_target *target, const case_state *s,
                                 const char *name, girih_error *error) {
    // girih's, by its twin.
    const bench_bfr_output girih = {
        .positions = (const float *)(const void *)s->arrays.words[GIRIH_BIND_OUT_POSITIONS],
        .normals = (const float *)(const void *)s->arrays.words[GIRIH_BIND_OUT_ATTRIBUTES],
        .indices = s->arrays.words[GIRIH_BIND_OUT_INDICES],
        .vertex_count = (uint32_t)s->statistics.output_vertices,
        .triangle_count = (uint32_t)s->statistics.output_triangles};
    const bench_bfr_output outputs[] = {girih, bench_bfr_result(s->bfr[BENCH_BFR_LOOP]),
                                        bench_bfr_result(s->bfr[BENCH_BFR_BILINEAR])};
    static const char *const names[] = {"girih", "bfr-loop", "bfr-bilinear"};
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < sizeof outputs / sizeof *outputs && result == GIRIH_OK; ++n) {
        result = draw_output(run, target, name, names[n], &outputs[n], error);
    }
    return result;
}

// --- Measuring ----------------------------------------------------------------------------------

typedef struct method {
    const char *name;
    girih_result (*run)(case_state *state, girih_error *error);
    uint64_t triangles;
} method;

static double milliseconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

// Wall time, and CPU time of all of the process's threads.
typedef struct duration {
    double wall, cpu;
} duration;

static girih_result time_run(case_state *s, const method *m, duration *time, girih_error *error) {
    const double cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID);
    const double wall = milliseconds(CLOCK_MONOTONIC);
    const girih_result result = m->run(s, error);
    time->wall = milliseconds(CLOCK_MONOTONIC) - wall;
    time->cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    return result;
}

// Of a method's pairs.
typedef struct samples {
    double wall[STATISTICS_MOST], cpu[STATISTICS_MOST];
    double ratios[STATISTICS_MOST], cpu_ratios[STATISTICS_MOST];
} samples;

static json_t *figures(const method *m, samples *of, uint32_t pairs) {
    double low, high;
    statistics_interval(of->ratios, pairs, &low, &high);
    const double median = statistics_median(of->wall, pairs);
    const double triangles = (double)m->triangles;
    return json_pack("{s:{s:f,s:f,s:f,s:f,s:I,s:f,s:f,s:f,s:f,s:f,s:f}}", "bake", "median_ms",
                     median, "min_ms", of->wall[0], "max_ms", of->wall[pairs - 1], "cpu_ms",
                     statistics_median(of->cpu, pairs), "output_triangles",
                     (json_int_t)m->triangles, "ns_per_triangle", median * 1e6 / triangles,
                     "triangles_per_second", triangles / median * 1e3, "ratio",
                     statistics_median(of->ratios, pairs), "ratio_low", low, "ratio_high", high,
                     "cpu_ratio", statistics_median(of->cpu_ratios, pairs));
}

// One method against girih, in alternating pairs; which of the two goes first alternates too.
static girih_result measure(case_state *s, const method *m, const method *base, uint32_t pairs,
                            json_t *methods, girih_error *error) {
    static samples of;
    const double scale = (double)base->triangles / (double)m->triangles;
    girih_result result = GIRIH_OK;
    duration times[2]; // girih, the method
    for (uint32_t n = 0; n < WARM_UP + pairs && result == GIRIH_OK; ++n) {
        for (uint32_t turn = 0; turn < 2 && result == GIRIH_OK; ++turn) {
            const uint32_t which = (n + turn) % 2;
            result = time_run(s, which ? m : base, &times[which], error);
        }
        if (n >= WARM_UP && result == GIRIH_OK) {
            const uint32_t pair = n - WARM_UP;
            of.wall[pair] = times[1].wall;
            of.cpu[pair] = times[1].cpu;
            of.ratios[pair] = times[1].wall / times[0].wall * scale;
            of.cpu_ratios[pair] = times[1].cpu / times[0].cpu * scale;
        }
    }
    if (result == GIRIH_OK) {
        json_object_set_new(methods, m->name, figures(m, &of, pairs));
    }
    return result;
}

static girih_result run_case(const bench_run *run, bench_target *target, case_state *s,
                             const struct sphere_case *c, girih_error *error) {
    s->frame = (girih_frame){.rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = c->max_level, .seed = 1};
    girih_result result = make_mesh(s, c->halvings, error);
    if (result == GIRIH_OK) {
        result = make_twin(s, error);
    }
    if (result == GIRIH_OK) {
        result = make_plan(s, error);
    }
    if (result == GIRIH_OK) {
        result = make_bfr(s, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    const uint64_t triangles = s->statistics.output_triangles;
    const uint64_t loop = bench_bfr_result(s->bfr[BENCH_BFR_LOOP]).triangle_count;
    const uint64_t bilinear = bench_bfr_result(s->bfr[BENCH_BFR_BILINEAR]).triangle_count;
    const method methods[] = {{"girih", run_girih, triangles},
                              {"cpu", run_twin, triangles},
                              {"bfr-loop", run_bfr_loop, loop},
                              {"bfr-loop-2-threads", run_bfr_loop_2, loop},
                              {"bfr-bilinear", run_bfr_bilinear, bilinear},
                              {"bfr-bilinear-2-threads", run_bfr_bilinear_2, bilinear}};
    json_t *object = json_object();
    for (size_t n = 0; n < sizeof methods / sizeof *methods && result == GIRIH_OK; ++n) {
        result = measure(s, &methods[n], &methods[0], run->pairs, object, error);
    }
    if (result == GIRIH_OK && run->pictures) {
        result = draw_outputs(run, target, s, c->name, error);
    }
    if (result != GIRIH_OK) {
        json_decref(object);
        return result;
    }
    json_array_append_new(run->cases,
                          json_pack("{s:s,s:I,s:I,s:o}", "name", c->name, "input_triangles",
                                    (json_int_t)s->statistics.input_triangles, "output_triangles",
                                    (json_int_t)triangles, "methods", object));
    return GIRIH_OK;
}

girih_result bench_bake(const bench_run *run, girih_error *error) {
    bench_target *target = NULL;
    girih_result result =
        run->pictures ? bench_target_create(run->device, &target, error) : GIRIH_OK;
    for (size_t n = 0; n < sizeof cases / sizeof *cases && result == GIRIH_OK; ++n) {
        case_state state = {.device = run->device};
        result = run_case(run, target, &state, &cases[n], error);
        end_case(&state);
    }
    bench_target_destroy(target);
    return result;
}
