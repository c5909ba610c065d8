// Case `families`: the built-in catalogues, of the family `optimal`, against the family `uniform`
// at the same number of triangles, each mode by itself; Curved PN, levels that change every frame.
//
// At the same levels `optimal` has fewer triangles and would be ahead for that alone, so its levels
// are raised here: bounds of random levels, or lengths of a segment, are searched for whose frames
// have as many triangles in the mean.
#include <math.h>

#include "catalogues.h"

#define FRAMES 16u

typedef struct setting {
    const char *name;
    bench_shape shape;
    bool linear; // the catalogue's spacing
    void (*frame)(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view);
    uint32_t least, most; // of `uniform`: whichever `optimal` comes nearest to
    uint32_t limit;       // of `optimal`
} setting;

// 1 to `*fineness` segments at random.
static void random_frame(const void *fineness, uint32_t n, girih_frame *frame, bench_view *view) {
    bench_random_frame(fineness, n, frame, view);
    *frame = (girih_frame){
        .rule = GIRIH_LEVEL_RANDOM, .segments = *(const uint32_t *)fineness, .seed = n};
}

// Bounds of random levels are whole, so only few of them can be matched: these are.
static const setting settings[] = {
    {"random, dyadic, large patterns", {.halvings = 2}, false, random_frame, 20, 28, 64},
    {"random, dyadic, middling", {.halvings = 3}, false, random_frame, 16, 16, 64},
    {"random, dyadic, small patterns", {.halvings = 7}, false, random_frame, 2, 2, 64},
    {"lengths, dyadic", {.slices = 64, .stacks = 33}, false, bench_length_frame, 1024, 1024, 8192},
    {"lengths, linear", {.slices = 64, .stacks = 33}, true, bench_length_frame, 1024, 1024, 8192},
    {"view, dyadic", {.halvings = 5}, false, bench_view_frame, 1024, 1024, 8192},
    {"view, linear", {.halvings = 4}, true, bench_view_frame, 1024, 1024, 8192},
};

enum { UNIFORM, OPTIMAL };

// Both jobs and how fine their levels are: of random levels the bound, else as the frames have it.
typedef struct match {
    bench_catalogue_pair pair;
    uint32_t fineness[2];
} match;

static girih_result count(match *m, int family, uint32_t fineness, double *triangles,
                          girih_error *error) {
    m->fineness[family] = fineness;
    const girih_result result = bench_count_frames(&m->pair.jobs[family], error);
    *triangles = m->pair.jobs[family].mean_triangles;
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

static girih_result run_setting(const bench_run *run, bench_target *target, const setting *s,
                                girih_error *error) {
    const girih_catalogue *const catalogues[2] = {
        s->linear ? bench_uniform_linear() : bench_uniform_dyadic(),
        s->linear ? girih_catalogue_linear() : girih_catalogue_dyadic()};
    bench_mesh mesh = {0};
    match m = {.pair.names = {"uniform", "optimal"}, .fineness = {s->least, s->least}};
    girih_result result = bench_shape_make(&s->shape, &mesh, error);
    for (int family = UNIFORM; family <= OPTIMAL && result == GIRIH_OK; ++family) {
        const bench_job_desc desc = {.name = s->name,
                                     .mesh = &mesh,
                                     .catalogue = catalogues[family],
                                     .surface = GIRIH_SURFACE_PN,
                                     .frame = s->frame,
                                     .user = &m.fineness[family],
                                     .frame_count = FRAMES};
        result = bench_job_create(target, run->device, &desc, &m.pair.jobs[family], error);
    }
    if (result == GIRIH_OK) {
        result = match_triangles(&m, s, error);
    }
    json_t *item = NULL;
    if (result == GIRIH_OK) {
        result = bench_measure_catalogues(run, &m.pair, &item, error);
    }
    for (int family = UNIFORM; family <= OPTIMAL && result == GIRIH_OK; ++family) {
        json_object_set_new(json_object_get(item, m.pair.names[family]), "fineness",
                            json_integer((json_int_t)m.fineness[family]));
    }
    bench_job_destroy(&m.pair.jobs[UNIFORM]);
    bench_job_destroy(&m.pair.jobs[OPTIMAL]);
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
