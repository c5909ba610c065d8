// Case `families`: the built-in catalogues, of the family `optimal`, against the family `uniform`
// at the same number of triangles, each mode by itself; Curved PN, levels that change every frame.
//
// At the same levels `optimal` has fewer triangles and would be ahead for that alone, so its levels
// are raised here: bounds of random levels, or lengths of a segment, are searched for whose frames
// have as many triangles in the mean.
#include <math.h>

#include "bench.h"
#include "error.h"
#include "methods.h"

#define FRAMES 16u
// Of random levels the fineness is the bound. Else it says how long a segment is: this many pixels
// or thousandths of a unit, divided by it.
#define LENGTH_OF_FINENESS_1 8192.0f

typedef struct setting {
    const char *name;
    girih_result (*make_mesh)(bench_mesh *mesh, girih_error *error);
    bool linear; // the catalogue's spacing
    void (*frame)(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view);
    uint32_t least, most; // of `uniform`: whichever `optimal` comes nearest to
    uint32_t limit;       // of `optimal`
} setting;

static girih_result make_sphere_320(bench_mesh *mesh, girih_error *error) {
    return bench_sphere(2, mesh, error);
}

static girih_result make_sphere_1280(bench_mesh *mesh, girih_error *error) {
    return bench_sphere(3, mesh, error);
}

static girih_result make_sphere_5120(bench_mesh *mesh, girih_error *error) {
    return bench_sphere(4, mesh, error);
}

static girih_result make_sphere_20480(bench_mesh *mesh, girih_error *error) {
    return bench_sphere(5, mesh, error);
}

static girih_result make_sphere_327680(bench_mesh *mesh, girih_error *error) {
    return bench_sphere(7, mesh, error);
}

// Triangles of many shapes, thinner and thinner towards the poles.
static girih_result make_ellipsoid(bench_mesh *mesh, girih_error *error) {
    static const float radii[3] = {0.95f, 0.35f, 0.5f};
    return bench_ellipsoid(64, 33, radii, mesh, error);
}

// 1 to `*fineness` segments at random.
static void random_frame(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view) {
    bench_random_frame(fineness, n, frame, view);
    *frame = (girih_frame){
        .rule = GIRIH_LEVEL_RANDOM, .segments = *(const uint32_t *)fineness, .seed = n};
}

// Segments of one length, a little longer from frame to frame.
static void length_frame(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view) {
    const float units = LENGTH_OF_FINENESS_1 / 1000 / (float)*(const uint32_t *)fineness;
    bench_random_frame(fineness, n, frame, view);
    *frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_LENGTH,
                           .length = units * (1.0f + 0.005f * (float)n)};
}

// Segments of one length on the screen, seen from a distance that grows from frame to frame.
static void view_frame(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view) {
    const float distance = 1.5f + 0.01f * (float)n;
    const float near = 0.1f;
    const float scale = 2.41421356f; // 45 degrees; looking along -z
    *frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_PIXELS,
                           .length = LENGTH_OF_FINENESS_1 / (float)*(const uint32_t *)fineness,
                           .pixels_per_unit = scale * (float)BENCH_PIXELS / 2,
                           .near_distance = near,
                           .eye = {0, 0, distance},
                           .cull_back = 1};
    *view = (bench_view){.rows = {{scale, 0, 0, 0},
                                  {0, -scale, 0, 0},
                                  {0, 0, -1, distance - near},
                                  {0, 0, -1, distance}}};
}

// Bounds of random levels are whole, so only few of them can be matched: these are.
static const setting settings[] = {
    {"random, dyadic, large patterns", make_sphere_320, false, random_frame, 20, 28, 64},
    {"random, dyadic, middling", make_sphere_1280, false, random_frame, 16, 16, 64},
    {"random, dyadic, small patterns", make_sphere_327680, false, random_frame, 2, 2, 64},
    {"lengths, dyadic", make_ellipsoid, false, length_frame, 1024, 1024, 8192},
    {"lengths, linear", make_ellipsoid, true, length_frame, 1024, 1024, 8192},
    {"view, dyadic", make_sphere_20480, false, view_frame, 1024, 1024, 8192},
    {"view, linear", make_sphere_5120, true, view_frame, 1024, 1024, 8192},
};

enum { UNIFORM, OPTIMAL };

// Both jobs and how fine their levels are.
typedef struct match {
    bench_case_job jobs[2];
    uint32_t fineness[2];
} match;

static girih_result count(match *m, int family, uint32_t fineness, double *triangles,
                          girih_error *error) {
    m->fineness[family] = fineness;
    const girih_result result = bench_count_frames(&m->jobs[family], error);
    *triangles = m->jobs[family].mean_triangles;
    return result;
}

// The first fineness of `optimal` with as many triangles as are asked for, or the one before it.
static girih_result search_optimal(match *m, const setting *s, double asked, uint32_t *best,
                                   double *miss, girih_error *error) {
    uint32_t low = m->fineness[UNIFORM]; // not more triangles here
    uint32_t high = s->limit;
    double triangles = 0.0;
    girih_result result = GIRIH_OK;
    while (low < high && result == GIRIH_OK) {
        const uint32_t middle = (low + high) / 2;
        result = count(m, OPTIMAL, middle, &triangles, error);
        if (triangles < asked) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    *miss = INFINITY;
    for (uint32_t n = low > m->fineness[UNIFORM] ? low - 1 : low; n <= low && result == GIRIH_OK;
         ++n) {
        result = count(m, OPTIMAL, n, &triangles, error);
        if (fabs(triangles / asked - 1.0) < *miss) {
            *miss = fabs(triangles / asked - 1.0);
            *best = n;
        }
    }
    return result;
}

// Leaves both jobs at levels with the same number of triangles, as nearly as can be.
static girih_result match_triangles(match *m, const setting *s, girih_error *error) {
    uint32_t best[2] = {s->least, s->least};
    double best_miss = INFINITY;
    double triangles = 0.0;
    girih_result result = GIRIH_OK;
    for (uint32_t n = s->least; n <= s->most && result == GIRIH_OK; ++n) {
        uint32_t optimal = n;
        double miss = INFINITY;
        result = count(m, UNIFORM, n, &triangles, error);
        if (result == GIRIH_OK) {
            result = search_optimal(m, s, triangles, &optimal, &miss, error);
        }
        if (miss < best_miss) {
            best_miss = miss;
            best[UNIFORM] = n;
            best[OPTIMAL] = optimal;
        }
    }
    for (int family = UNIFORM; family <= OPTIMAL && result == GIRIH_OK; ++family) {
        result = count(m, family, best[family], &triangles, error);
    }
    return result;
}

static girih_result measure(const bench_run *run, match *m, girih_error *error) {
    static const bench_method *const modes[] = {&bench_girih_instanced, &bench_girih_baked,
                                                &bench_girih_welded};
    bench_case_job *const jobs[2] = {&m->jobs[UNIFORM], &m->jobs[OPTIMAL]};
    json_t *figures = json_object();
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < sizeof modes / sizeof *modes && result == GIRIH_OK; ++n) {
        const bench_method *const pair[2] = {modes[n], modes[n]};
        json_t *object = json_object();
        json_object_set_new(figures, modes[n]->name, object);
        result = bench_measure_pair(run, jobs, pair, object, error);
    }
    if (result == GIRIH_OK) {
        result = bench_add_case(run, jobs[UNIFORM], figures, error);
    }
    json_decref(figures);
    return result;
}

static void add_facts(json_t *item, const match *m) {
    static const char *const families[2] = {"uniform", "optimal"};
    json_object_set_new(item, "ratio_to", json_string(families[UNIFORM]));
    for (int family = UNIFORM; family <= OPTIMAL; ++family) {
        const bench_case_job *job = &m->jobs[family];
        json_object_set_new(item, families[family],
                            json_pack("{s:I,s:f,s:f}", "fineness", (json_int_t)m->fineness[family],
                                      "mean_triangles", job->mean_triangles, "mean_vertices",
                                      job->mean_vertices));
    }
}

static girih_result run_setting(const bench_run *run, bench_target *target, const setting *s,
                                girih_error *error) {
    const girih_catalogue *const catalogues[2] = {
        s->linear ? bench_uniform_linear() : bench_uniform_dyadic(),
        s->linear ? girih_catalogue_linear() : girih_catalogue_dyadic()};
    bench_mesh mesh = {0};
    match m = {.fineness = {s->least, s->least}};
    girih_result result = s->make_mesh(&mesh, error);
    for (int family = UNIFORM; family <= OPTIMAL && result == GIRIH_OK; ++family) {
        const bench_job_desc desc = {.name = s->name,
                                     .mesh = &mesh,
                                     .catalogue = catalogues[family],
                                     .surface = GIRIH_SURFACE_PN,
                                     .frame = s->frame,
                                     .user = &m.fineness[family],
                                     .frame_count = FRAMES};
        result = bench_job_create(target, run->device, &desc, &m.jobs[family], error);
    }
    if (result == GIRIH_OK) {
        result = match_triangles(&m, s, error);
    }
    if (result == GIRIH_OK) {
        result = measure(run, &m, error);
    }
    if (result == GIRIH_OK) {
        add_facts(json_array_get(run->cases, json_array_size(run->cases) - 1), &m);
    }
    bench_job_destroy(&m.jobs[UNIFORM]);
    bench_job_destroy(&m.jobs[OPTIMAL]);
    bench_mesh_free(&mesh);
    return result;
}

girih_result bench_families(const bench_run *run, girih_error *error) {
    bench_target *target = NULL;
    girih_result result = bench_target_create(run->device, &target, error);
    for (size_t n = 0; n < sizeof settings / sizeof *settings && result == GIRIH_OK; ++n) {
        result = run_setting(run, target, &settings[n], error);
    }
    bench_target_destroy(target);
    return result;
}
