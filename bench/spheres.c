// Case `spheres`: few triangles refined far, many refined little; Curved PN, random dyadic levels
// that change every frame. Beside all methods' ratios to the static mesh, `against_hardware` has
// hardware tessellation's to girih: how many times as fast girih is.
#include "bench.h"
#include "methods.h"

static const struct {
    const char *name;
    uint32_t halvings;  // of the icosahedron's edges: 20 * 4^halvings triangles
    uint32_t max_level; // of the random levels
} cases[] = {{"spheres 1,280 to level 5", 3, 5},
             {"spheres 20,480 to level 3", 5, 3},
             {"spheres 327,680 to level 1", 7, 1}};

static const bench_method *const methods[] = {
    &bench_static,         &bench_girih,        &bench_girih_unchanged,
    &bench_girih_baked,    &bench_girih_welded, &bench_girih_instanced,
    &bench_girih_built_in, &bench_hardware,     &bench_hardware_fractional};

static girih_result run_case(const bench_run *run, bench_target *target, size_t n,
                             girih_error *error) {
    bench_mesh mesh = {0};
    bench_case_job job = {0};
    json_t *figures = json_object();
    json_t *against = json_object();
    girih_result result = bench_sphere(cases[n].halvings, &mesh, error);
    if (result == GIRIH_OK) {
        const bench_job_desc desc = {.name = cases[n].name,
                                     .mesh = &mesh,
                                     .catalogue = bench_uniform_dyadic(),
                                     .surface = GIRIH_SURFACE_PN,
                                     .frame = bench_random_frame,
                                     .user = &cases[n].max_level};
        result = bench_job_create(target, run->device, &desc, &job, error);
    }
    if (result == GIRIH_OK) {
        result =
            bench_measure(run, &job, methods, sizeof methods / sizeof *methods, figures, error);
    }
    if (result == GIRIH_OK) {
        static const bench_method *const pair[2] = {&bench_girih, &bench_hardware};
        bench_case_job *const jobs[2] = {&job, &job};
        result = bench_measure_pair(run, jobs, pair, against, error);
    }
    if (result == GIRIH_OK) {
        result = bench_add_case(run, &job, figures, error);
    }
    if (result == GIRIH_OK) {
        json_t *item = json_array_get(run->cases, json_array_size(run->cases) - 1);
        json_object_set(item, "against_hardware", against);
    }
    json_decref(against);
    json_decref(figures);
    bench_job_destroy(&job);
    bench_mesh_free(&mesh);
    return result;
}

girih_result bench_spheres(const bench_run *run, girih_error *error) {
    bench_target *target = NULL;
    girih_result result = bench_target_create(run->device, &target, error);
    for (size_t n = 0; n < sizeof cases / sizeof *cases && result == GIRIH_OK; ++n) {
        result = run_case(run, target, n, error);
    }
    bench_target_destroy(target);
    return result;
}
