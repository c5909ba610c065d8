#include "catalogues.h"

#include "methods.h"

#define LENGTH_OF_FINENESS_1 8192.0f

// --- Meshes and frames --------------------------------------------------------------------------

girih_result bench_shape_make(const bench_shape *shape, bench_mesh *mesh, girih_error *error) {
    static const float radii[3] = {0.95f, 0.35f, 0.5f};
    return shape->slices ? bench_ellipsoid(shape->slices, shape->stacks, radii, mesh, error)
                         : bench_sphere(shape->halvings, mesh, error);
}

void bench_length_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    const float units = LENGTH_OF_FINENESS_1 / 1000 / (float)*(const uint32_t *)user;
    bench_random_frame(user, n, frame, view);
    *frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_LENGTH,
                           .length = units * (1.0f + 0.005f * (float)n)};
}

void bench_view_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    const float distance = 1.5f + 0.01f * (float)n;
    const float near = 0.1f;
    const float scale = 2.41421356f; // 45 degrees; looking along -z
    *frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_PIXELS,
                           .length = LENGTH_OF_FINENESS_1 / (float)*(const uint32_t *)user,
                           .pixels_per_unit = scale * (float)BENCH_PIXELS / 2,
                           .near_distance = near,
                           .eye = {0, 0, distance},
                           .cull_back = 1};
    *view = (bench_view){.rows = {{scale, 0, 0, 0},
                                  {0, -scale, 0, 0},
                                  {0, 0, -1, distance - near},
                                  {0, 0, -1, distance}}};
}

// --- Measuring ----------------------------------------------------------------------------------

static girih_result measure_modes(const bench_run *run, bench_catalogue_pair *pair, json_t *figures,
                                  girih_error *error) {
    static const bench_method *const modes[] = {&bench_girih_instanced, &bench_girih_baked,
                                                &bench_girih_welded};
    bench_case_job *const jobs[2] = {&pair->jobs[0], &pair->jobs[1]};
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < sizeof modes / sizeof *modes && result == GIRIH_OK; ++n) {
        const bench_method *const methods[2] = {modes[n], modes[n]};
        json_t *object = json_object();
        json_object_set_new(figures, modes[n]->name, object);
        result = bench_measure_pair(run, jobs, methods, object, error);
    }
    return result;
}

static json_t *counts_of(const bench_case_job *job) {
    return json_pack("{s:f,s:f,s:f,s:f}", "mean_triangles", job->mean_triangles, "mean_vertices",
                     job->mean_vertices, "mean_groups", job->mean_groups, "mean_parts",
                     job->mean_parts);
}

girih_result bench_measure_catalogues(const bench_run *run, bench_catalogue_pair *pair,
                                      json_t **item, girih_error *error) {
    json_t *figures = json_object();
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < 2 && result == GIRIH_OK; ++n) {
        result = bench_count_groups(&pair->jobs[n], error);
    }
    if (result == GIRIH_OK) {
        result = measure_modes(run, pair, figures, error);
    }
    if (result == GIRIH_OK) {
        result = bench_add_case(run, &pair->jobs[0], figures, error);
    }
    if (result == GIRIH_OK) {
        *item = json_array_get(run->cases, json_array_size(run->cases) - 1);
        json_object_set_new(*item, "ratio_to", json_string(pair->names[0]));
        for (uint32_t n = 0; n < 2; ++n) {
            json_object_set_new(*item, pair->names[n], counts_of(&pair->jobs[n]));
        }
    }
    json_decref(figures);
    return result;
}
