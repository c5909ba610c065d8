// Case `conditions`: what a frame's cost depends on beside the number of triangles: few groups or
// many, a view that moves or stands, flat, PN or displaced.
#include <math.h>

#include "bench.h"
#include "methods.h"

// A unit sphere seen whole: orthographic, looking along -z.
static const bench_view whole = {
    .rows = {{0.9f, 0, 0, 0}, {0, -0.9f, 0, 0}, {0, 0, -0.4f, 0.5f}, {0, 0, 0, 1}}};

// Eight segments on every edge: one group. The revision has the frame redone.
static void one_group(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    (void)user;
    *frame = (girih_frame){.rule = GIRIH_LEVEL_SEGMENTS, .segments = 8, .revision = n};
    *view = whole;
}

// 1 to 10 segments at random: hundreds of groups, about as many triangles.
static void many_groups(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    (void)user;
    *frame = (girih_frame){.rule = GIRIH_LEVEL_RANDOM, .segments = 10, .seed = n % 2 ? 1 : 2 + n};
    *view = whole;
}

// Perspective from a distance that changes or does not, `*(const float *)user` from frame to frame;
// frame 1 alike.
static void seen_from(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    const float step = *(const float *)user;
    const float distance = 2.5f + step * ((float)(n % 16) - 1.0f);
    const float near = 0.5f;
    // 45 degrees; looking along -z.
    const float scale = 2.41421356f;
    *frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_PIXELS,
                           .length = 8,
                           .pixels_per_unit = scale * (float)BENCH_PIXELS / 2,
                           .near_distance = near,
                           .eye = {0, 0, distance},
                           .cull_back = 1};
    *view = (bench_view){.rows = {{scale, 0, 0, 0},
                                  {0, -scale, 0, 0},
                                  {0, 0, -1, distance - near},
                                  {0, 0, -1, distance}}};
}

static const float standing = 0.0f;
static const float moving = 0.01f;
static const uint32_t level_3 = 3;

#define MOST_METHODS 6u

static const struct condition {
    const char *name;
    uint32_t halvings;
    bool linear;
    girih_surface surface;
    void (*frame)(const void *user, uint32_t n, girih_frame *frame, bench_view *view);
    const void *user;
    const bench_method *methods[MOST_METHODS];
} conditions[] = {
    {"one group",
     4,
     true,
     GIRIH_SURFACE_PN,
     one_group,
     NULL,
     {&bench_static, &bench_girih, &bench_girih_baked, &bench_girih_instanced}},
    {"hundreds of groups",
     4,
     true,
     GIRIH_SURFACE_PN,
     many_groups,
     NULL,
     {&bench_static, &bench_girih, &bench_girih_baked, &bench_girih_instanced}},
    {"a view that moves",
     5,
     false,
     GIRIH_SURFACE_PN,
     seen_from,
     &moving,
     {&bench_static, &bench_girih, &bench_girih_baked, &bench_girih_instanced, &bench_girih_splits}},
    {"a view that stands",
     5,
     false,
     GIRIH_SURFACE_PN,
     seen_from,
     &standing,
     {&bench_static, &bench_girih, &bench_girih_baked, &bench_girih_instanced}},
    {"flat",
     5,
     false,
     GIRIH_SURFACE_FLAT,
     bench_random_frame,
     &level_3,
     {&bench_static, &bench_girih, &bench_girih_baked, &bench_girih_instanced}},
    {"PN and displaced",
     5,
     false,
     GIRIH_SURFACE_PN,
     bench_random_frame,
     &level_3,
     {&bench_static, &bench_girih, &bench_girih_baked, &bench_girih_instanced,
      &bench_girih_displaced, &bench_girih_splits}},
};

static girih_result run_condition(const bench_run *run, bench_target *target,
                                  const struct condition *c, girih_error *error) {
    bench_mesh mesh = {0};
    girih_result result = bench_sphere(c->halvings, &mesh, error);
    if (result == GIRIH_OK) {
        const bench_job_desc desc = {.name = c->name,
                                     .mesh = &mesh,
                                     .catalogue = c->linear ? bench_uniform_linear()
                                                            : bench_uniform_dyadic(),
                                     .surface = c->surface,
                                     .frame = c->frame,
                                     .user = c->user};
        uint32_t count = 0;
        while (count < MOST_METHODS && c->methods[count]) {
            ++count;
        }
        result = bench_run_job(run, target, &desc, c->methods, count, error);
    }
    bench_mesh_free(&mesh);
    return result;
}

girih_result bench_conditions(const bench_run *run, girih_error *error) {
    bench_target *target = NULL;
    girih_result result = bench_target_create(run->device, &target, error);
    for (size_t n = 0; n < sizeof conditions / sizeof *conditions && result == GIRIH_OK; ++n) {
        result = run_condition(run, target, &conditions[n], error);
    }
    bench_target_destroy(target);
    return result;
}
