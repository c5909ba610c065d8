// Cases `cities` and `large_city`: Figures 6, 7 and 8 of Lorenz and Doellner 2008. A flight through
// a small and a large city in a cylindrical projection of 160 degrees, refined by the edges'
// horizontal length.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "city.h"
#include "error.h"
#include "methods.h"
#include "report.h"

// Levels 0..8. The paper's go to 9; those patterns take 390 MB, more than many devices show a
// shader.
#define MAX_LEVEL 8u
#define FIGURE_6_PIXELS 10.0f
// Frames of the shortest edges take DMR many seconds.
#define MOST_SECONDS 10.0

static const float lengths[] = {200.0f, 100.0f, 50.0f, 20.0f, 10.0f, 5.0f, 2.0f};
#define LENGTH_COUNT (sizeof lengths / sizeof *lengths)

static const struct {
    const char *name;
    uint32_t reach;
} cities[] = {{"city of 13,639", 0}, {"city of 122,751", 1}};

static const bench_method *const methods[] = {&bench_girih,       &bench_girih_instanced,
                                              &bench_girih_baked, &bench_arp,
                                              &bench_dmr,         &bench_dmr_symmetric};
#define METHOD_COUNT (sizeof methods / sizeof *methods)

// --- Frames -------------------------------------------------------------------------------------

#define VIEW_ANGLE 2.79252680f // 160 degrees
#define NEAR 0.5f
#define FAR 1200.0f

typedef struct city_view {
    float pixels; // maximum horizontal edge length
    // Frames from this one on are `ahead` frames later in the flight: a cut.
    uint32_t cut;
    uint32_t ahead;
} city_view;

static void city_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    const city_view *city = user;
    const bench_flight flight = bench_flight_at(n < city->cut ? n : n + city->ahead);
    const float half = VIEW_ANGLE / 2.0f;
    // As high as makes pixels on the horizon square, and a little downwards.
    const float slopes[2] = {-half - 0.2f, half - 0.2f};
    const float right[3] = {-flight.forward[2], 0.0f, flight.forward[0]};
    *frame = (girih_frame){.rule = GIRIH_LEVEL_HORIZONTAL_PIXELS,
                           .length = city->pixels,
                           .near_distance = NEAR,
                           .eye = {flight.eye[0], flight.eye[1], flight.eye[2]},
                           .cull_frustum = 1,
                           .cull_back = 1,
                           .cylindrical = 1,
                           .pixels_per_radian = (float)BENCH_PIXELS / VIEW_ANGLE,
                           .lowest_slope = slopes[0],
                           .highest_slope = slopes[1]};
    // The two sides of the picture.
    for (int side = 0; side < 2; ++side) {
        const float sign = side == 0 ? 1.0f : -1.0f;
        float *plane = frame->planes[side];
        for (int k = 0; k < 3; ++k) {
            plane[k] = sinf(half) * flight.forward[k] + sign * cosf(half) * right[k];
            plane[3] -= plane[k] * flight.eye[k];
        }
    }
    *view = (bench_view){.forward = {[3] = half},
                         .up = {0.0f, 1.0f, 0.0f},
                         // y grows downwards on the screen.
                         .slopes = {slopes[1], slopes[0]},
                         .depth = {FAR / (FAR - NEAR), -NEAR * FAR / (FAR - NEAR)}};
    memcpy(view->eye, flight.eye, sizeof flight.eye);
    memcpy(view->forward, flight.forward, sizeof flight.forward);
    memcpy(view->right, right, sizeof right);
}

// --- Counts -------------------------------------------------------------------------------------

// What a method draws in each of the first frames of a flight, once more in order.
static girih_result fly(bench_case_job *job, const bench_method *method, uint32_t frames,
                        json_t *object, girih_error *error) {
    void *state = NULL;
    json_t *drawn = json_array();
    json_t *cracks = json_array();
    const bool is_dmr = method == &bench_dmr || method == &bench_dmr_symmetric;
    girih_result result = method->create(&job->job, method->variant, &state, error);
    double sum = 0.0;
    for (uint32_t n = 0; n < frames && result == GIRIH_OK; ++n) {
        bench_time time;
        uint64_t triangles = 0;
        result = bench_frame(job, method, state, BENCH_GEOMETRY, n, &time, error);
        if (result == GIRIH_OK && is_dmr) {
            bench_dmr_audit audit = {0};
            result = bench_dmr_look(state, &audit, error);
            triangles = audit.seen_triangles;
            json_array_append_new(cracks, json_integer((json_int_t)audit.cracked_edges));
        } else if (result == GIRIH_OK) {
            triangles = method->drawn(state);
        }
        sum += (double)triangles;
        json_array_append_new(drawn, json_integer((json_int_t)triangles));
    }
    method->destroy(state);
    json_object_set_new(object, "mean_triangles", json_real(sum / (double)frames));
    json_object_set_new(object, "drawn_triangles", drawn);
    if (is_dmr) {
        json_object_set_new(object, "cracks", cracks);
    } else {
        json_decref(cracks);
    }
    return result;
}

static const bench_method *const flown[] = {&bench_girih, &bench_dmr, &bench_dmr_symmetric};
#define FLOWN_COUNT (sizeof flown / sizeof *flown)

static girih_result fly_all(bench_case_job *job, uint32_t frames, json_t *figures,
                            girih_error *error) {
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < FLOWN_COUNT && result == GIRIH_OK; ++n) {
        const bench_method *method = flown[n];
        if (method->unfit && method->unfit(&job->job)) {
            continue;
        }
        json_t *object = json_object_get(figures, method->name);
        if (!object) {
            object = json_object();
            json_object_set_new(figures, method->name, object);
        }
        result = fly(job, method, frames, object, error);
    }
    return result;
}

// --- The figures --------------------------------------------------------------------------------

typedef struct place {
    bench_target *target;
    const bench_mesh *mesh;
    const girih_catalogue *catalogue;
} place;

static girih_result start(const bench_run *run, const place *at, const char *name,
                          const city_view *view, uint32_t frames, bench_case_job *job,
                          girih_error *error) {
    const bench_job_desc desc = {.name = name,
                                 .mesh = at->mesh,
                                 .catalogue = at->catalogue,
                                 .surface = GIRIH_SURFACE_FLAT,
                                 .frame = city_frame,
                                 .user = view,
                                 .frame_count = frames,
                                 .most_seconds = MOST_SECONDS};
    return bench_job_create(at->target, run->device, &desc, job, error);
}

static girih_result add(const bench_run *run, const bench_case_job *job, float pixels,
                        json_t *figures, girih_error *error) {
    const girih_result result = bench_add_case(run, job, figures, error);
    if (result == GIRIH_OK) {
        json_t *item = json_array_get(run->cases, json_array_size(run->cases) - 1);
        json_object_set_new(item, "pixels", json_real((double)pixels));
        json_object_set_new(item, "clamped_edges",
                            json_integer((json_int_t)job->reference.clamped_edges));
        json_object_set_new(item, "culled_triangles",
                            json_integer((json_int_t)job->reference.culled_triangles));
    }
    return result;
}

// Figure 7, and 6 at its length.
static girih_result measure_length(const bench_run *run, const place *at, const char *city,
                                   float pixels, girih_error *error) {
    const city_view view = {.pixels = pixels};
    char name[64];
    snprintf(name, sizeof name, "%s, %.0f pixels", city, (double)pixels);
    bench_case_job job = {0};
    json_t *figures = json_object();
    girih_result result = start(run, at, name, &view, BENCH_FLIGHT_FRAMES, &job, error);
    if (result == GIRIH_OK) {
        result = bench_measure(run, &job, methods, METHOD_COUNT, figures, error);
    }
    if (result == GIRIH_OK && pixels >= FIGURE_6_PIXELS && pixels <= FIGURE_6_PIXELS) {
        result = fly_all(&job, BENCH_FLIGHT_FRAMES, figures, error);
    }
    if (result == GIRIH_OK) {
        result = add(run, &job, pixels, figures, error);
    }
    json_decref(figures);
    bench_job_destroy(&job);
    return result;
}

// The flight cut to another place: how long the limits of growth hold back, and crack.
static girih_result count_cracks(const bench_run *run, const place *at, girih_error *error) {
    const city_view view = {.pixels = FIGURE_6_PIXELS, .cut = 4, .ahead = 60};
    bench_case_job job = {0};
    json_t *figures = json_object();
    girih_result result = start(run, at, "city of 13,639, a cut", &view, 20, &job, error);
    if (result == GIRIH_OK) {
        result = fly_all(&job, 20, figures, error);
    }
    if (result == GIRIH_OK) {
        result = add(run, &job, view.pixels, figures, error);
    }
    json_decref(figures);
    bench_job_destroy(&job);
    return result;
}

// Figure 8.
static girih_result measure_limits(const bench_run *run, const place *at, girih_error *error) {
    const city_view view = {.pixels = FIGURE_6_PIXELS};
    const bench_method *all[1 + BENCH_DMR_LIMITS] = {&bench_girih};
    for (size_t n = 0; n < BENCH_DMR_LIMITS; ++n) {
        all[1 + n] = &bench_dmr_output_limits[n];
    }
    bench_case_job job = {0};
    json_t *figures = json_object();
    girih_result result =
        start(run, at, "city of 13,639, output limits", &view, BENCH_FLIGHT_FRAMES, &job, error);
    if (result == GIRIH_OK) {
        result = bench_measure(run, &job, all, 1 + BENCH_DMR_LIMITS, figures, error);
    }
    if (result == GIRIH_OK) {
        result = add(run, &job, view.pixels, figures, error);
    }
    json_decref(figures);
    bench_job_destroy(&job);
    return result;
}

static girih_result visit(const bench_run *run, place *at, size_t city, girih_error *error) {
    bench_mesh mesh = {0};
    girih_result result = bench_city(cities[city].reach, &mesh, error);
    at->mesh = &mesh;
    for (size_t n = 0; n < LENGTH_COUNT && result == GIRIH_OK; ++n) {
        result = measure_length(run, at, cities[city].name, lengths[n], error);
    }
    if (result == GIRIH_OK && city == 0) {
        result = count_cracks(run, at, error);
        if (result == GIRIH_OK) {
            result = measure_limits(run, at, error);
        }
    }
    bench_mesh_free(&mesh);
    return result;
}

static girih_result run_city(const bench_run *run, size_t city, girih_error *error) {
    place at = {0};
    void *bytes = NULL;
    girih_result result = bench_catalogue_create(MAX_LEVEL, &bytes, &at.catalogue, error);
    if (result == GIRIH_OK) {
        result = bench_target_create(run->device, &at.target, error);
    }
    if (result == GIRIH_OK) {
        bench_target_use_panorama(at.target);
    }
    if (result == GIRIH_OK) {
        result = visit(run, &at, city, error);
    }
    bench_target_destroy(at.target);
    free(bytes);
    return result;
}

girih_result bench_cities(const bench_run *run, girih_error *error) {
    return run_city(run, 0, error);
}

girih_result bench_large_city(const bench_run *run, girih_error *error) {
    return run_city(run, 1, error);
}
