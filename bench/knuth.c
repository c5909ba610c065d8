// Case `knuth`: Figures 11 and 4 of Knuth, Kohlhammer and Kuijper 2010 (0821648fa4470fda), with
// girih as the first method: what stands in the report is how much slower the others are.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "error.h"
#include "methods.h"
#include "outlines.h"

#define MOST_SEGMENTS 16u    // of the linear catalogue
#define OUTLINED_SEGMENTS 7u // no power of two

// What a job's frames ask for.
typedef struct levels {
    girih_level_rule rule;
    uint32_t segments; // GIRIH_LEVEL_RANDOM
    float length;      // GIRIH_LEVEL_EDGE_LENGTH
    bench_view view;
    bool shaded;   // whether shaded frames are timed too
    bool outlines; // whether the patterns are drawn, where pictures are wanted
} levels;

// Levels at random differ from frame to frame; those of lengths are the same, and the revision has
// girih refine all the same.
static void frame(const void *user, uint32_t n, girih_frame *out, bench_view *view) {
    const levels *l = user;
    *out = (girih_frame){.rule = l->rule,
                         .segments = l->segments,
                         .length = l->length,
                         .seed = n % 2 ? 1 : 2 + n,
                         .revision = n,
                         .orthographic = true}; // warping asks where the viewer is
    *view = l->view;
}

// --- Meshes whose edges have the wanted levels --------------------------------------------------

// The length of an edge that asks for n segments of length 1 / (most - 0.5), where an edge of
// length 1 asks for `most`: in the middle, so that no rounding changes the level.
static float length_of(uint32_t n, uint32_t most) {
    return ((float)n - 0.5f) / ((float)most - 0.5f);
}

static void set_vertex(bench_mesh *mesh, uint32_t n, float x, float y, float z, float normal_x,
                       float normal_y, float normal_z) {
    const float position[3] = {x, y, z};
    const float normal[3] = {normal_x, normal_y, normal_z};
    memcpy(mesh->positions + 3 * (size_t)n, position, sizeof position);
    memcpy(mesh->normals + 3 * (size_t)n, normal, sizeof normal);
}

static void set_triangle(bench_mesh *mesh, uint32_t n, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t corners[3] = {a, b, c};
    memcpy(mesh->indices + 3 * (size_t)n, corners, sizeof corners);
}

#define TOWERS 4u
#define STOREYS 6u
#define SIDES 6u
#define TOWER_VERTICES ((STOREYS + 1) * SIDES + 2)
#define TOWER_TRIANGLES (2 * SIDES * STOREYS + 2 * SIDES)

static void add_tower(bench_mesh *mesh, uint32_t number, double base) {
    const double pi = 3.14159265358979323846;
    const double middle = 2.3 * ((double)number - 0.5 * (TOWERS - 1));
    // Six sides: the radius is the side. Rings are turned by half a side against each other.
    const double shift = 2.0 * base * sin(pi / (2 * SIDES));
    const double storey = sqrt(1.0 - shift * shift);
    const double roof = sqrt(1.0 - base * base);
    const uint32_t first = number * TOWER_VERTICES;
    const uint32_t bottom = first + TOWER_VERTICES - 2;
    const uint32_t top = bottom + 1;
    for (uint32_t ring = 0; ring <= STOREYS; ++ring) {
        const double y = storey * ((double)ring - 0.5 * STOREYS);
        for (uint32_t side = 0; side < SIDES; ++side) {
            const double angle = 2.0 * pi * ((double)side + 0.5 * (ring % 2)) / SIDES;
            const double x = cos(angle), z = -sin(angle);
            set_vertex(mesh, first + ring * SIDES + side, (float)(middle + base * x), (float)y,
                       (float)(base * z), (float)x, 0.0f, (float)z);
        }
    }
    const float height = (float)(0.5 * storey * STOREYS + roof);
    set_vertex(mesh, bottom, (float)middle, -height, 0, 0, -1, 0);
    set_vertex(mesh, top, (float)middle, height, 0, 0, 1, 0);
    uint32_t triangle = number * TOWER_TRIANGLES;
    for (uint32_t side = 0; side < SIDES; ++side) {
        const uint32_t next = (side + 1) % SIDES;
        for (uint32_t ring = 0; ring < STOREYS; ++ring) {
            const uint32_t low = first + ring * SIDES;
            const uint32_t high = low + SIDES;
            // The vertex of the ring above that stands over the side.
            const uint32_t over = ring % 2 ? next : side;
            const uint32_t under = ring % 2 ? side : next;
            set_triangle(mesh, triangle++, low + side, low + next, high + over);
            set_triangle(mesh, triangle++, high + next, high + side, low + under);
        }
        const uint32_t roof_ring = first + STOREYS * SIDES;
        set_triangle(mesh, triangle++, first + next, first + side, bottom);
        set_triangle(mesh, triangle++, roof_ring + side, roof_ring + next, top);
    }
}

// Every triangle has two edges of length 1 and one of length `base` < 1, on a closed surface:
// towers of six sides with pointed roofs.
static girih_result make_towers(float base, bench_mesh *mesh, girih_error *error) {
    const girih_result result =
        bench_mesh_allocate(mesh, TOWERS * TOWER_VERTICES, TOWERS * TOWER_TRIANGLES, error);
    for (uint32_t n = 0; n < TOWERS && result == GIRIH_OK; ++n) {
        add_tower(mesh, n, (double)base);
    }
    mesh->name = "towers";
    return result;
}

// Three long edges of length 1 over a triangle of edges of length `base`.
static girih_result make_tetrahedron(float base, bench_mesh *mesh, girih_error *error) {
    const girih_result result = bench_mesh_allocate(mesh, 4, 4, error);
    if (result != GIRIH_OK) {
        return result;
    }
    static const float third[3][2] = {{0.0f, 1.0f}, {0.8660254f, -0.5f}, {-0.8660254f, -0.5f}};
    const float radius = base * 0.57735027f;
    const float height = sqrtf(1.0f - radius * radius);
    for (uint32_t n = 0; n < 3; ++n) {
        set_vertex(mesh, n, radius * third[n][0], -0.5f * height, radius * third[n][1], third[n][0],
                   0.0f, third[n][1]);
        set_triangle(mesh, n, n, (n + 1) % 3, 3);
    }
    set_vertex(mesh, 3, 0, 0.5f * height, 0, 0, 1, 0);
    set_triangle(mesh, 3, 0, 2, 1);
    mesh->name = "tetrahedron";
    return GIRIH_OK;
}

// --- Patterns -----------------------------------------------------------------------------------

// Draws the outlines of a method's triangles.
static girih_result write_outlines(const bench_run *run, bench_case_job *job,
                                   const bench_method *method, girih_error *error) {
    char path[4096];
    const int length =
        snprintf(path, sizeof path, "%s/%s_%s.svg", run->pictures, job->job.name, method->name);
    if (length < 0 || (size_t)length >= sizeof path) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s: too long", run->pictures);
    }
    for (char *c = path + strlen(run->pictures) + 1; *c; ++c) {
        *c = *c == ' ' || *c == ',' ? '-' : *c;
    }
    void *state = NULL;
    bench_triangles triangles = {0};
    bench_time time;
    girih_result result = method->create(&job->job, method->variant, &state, error);
    if (result == GIRIH_OK) {
        result = bench_capture_reserve(job->job.target, job->job.room_triangles, error);
    }
    if (result == GIRIH_OK) {
        result = bench_frame(job, method, state, BENCH_CAPTURE, 1, &time, error);
    }
    if (result == GIRIH_OK) {
        result = bench_capture_read(job->job.target, &triangles, error);
    }
    if (result == GIRIH_OK) {
        const levels *l = job->desc.user;
        result = bench_outlines_write(path, &triangles, &l->view, error);
    }
    free(triangles.corners);
    method->destroy(state);
    return result;
}

// --- Jobs ---------------------------------------------------------------------------------------

#define METHODS 6u

typedef struct method_list {
    const bench_method *methods[METHODS];
    uint32_t count;
} method_list;

// The levels differ only between triangles, not at their edges: uniform refinement has no cracks.
static const method_list worst_methods = {{&bench_girih, &bench_static, &bench_uniform_pn,
                                           &bench_suapt, &bench_knuth, &bench_knuth_warped},
                                          6};
static const method_list mixed_methods = {
    {&bench_girih, &bench_static, &bench_suapt, &bench_knuth, &bench_knuth_warped}, 5};
static const method_list thin_methods = {
    {&bench_girih, &bench_uniform_pn, &bench_suapt, &bench_knuth, &bench_knuth_warped}, 5};

// Measures the methods on a mesh; takes the mesh.
static girih_result run_job(const bench_run *run, bench_target *target, const char *name,
                            bench_mesh *mesh, girih_surface surface, const levels *l,
                            const method_list *list, girih_error *error) {
    bench_case_job job = {0};
    json_t *figures = json_object();
    const bench_job_desc desc = {.name = name,
                                 .mesh = mesh,
                                 .catalogue = bench_uniform_linear(),
                                 .surface = surface,
                                 .frame = frame,
                                 .user = l,
                                 .frame_count = 8,
                                 .geometry_only = !l->shaded};
    girih_result result = bench_job_create(target, run->device, &desc, &job, error);
    if (result == GIRIH_OK) {
        // The others' patterns are of the largest level, rounded up to a power of two.
        job.job.room_triangles = mesh->triangle_count * MOST_SEGMENTS * MOST_SEGMENTS;
        result = bench_measure(run, &job, list->methods, list->count, figures, error);
    }
    for (uint32_t n = 0; n < list->count && result == GIRIH_OK; ++n) {
        const json_t *object = json_object_get(figures, list->methods[n]->name);
        if (l->outlines && run->pictures && run->device->has_transform_feedback &&
            !json_object_get(object, "unfit")) {
            result = write_outlines(run, &job, list->methods[n], error);
        }
    }
    if (result == GIRIH_OK) {
        result = bench_add_case(run, &job, figures, error);
    }
    json_decref(figures);
    bench_job_destroy(&job);
    bench_mesh_free(mesh);
    return result;
}

// Figure 11 (12 is the same on two GPUs): the worst case for Knuth's method is the most triangles
// of a level that still go through the quad part, so the base has one segment less.
static girih_result run_worst(const bench_run *run, bench_target *target, uint32_t segments,
                              girih_error *error) {
    // Orthographic, looking along -z, as all views here.
    const levels l = {
        .rule = GIRIH_LEVEL_EDGE_LENGTH,
        .length = 1.0f / ((float)segments - 0.5f),
        .shaded = segments == OUTLINED_SEGMENTS || segments == MOST_SEGMENTS,
        .outlines = segments == OUTLINED_SEGMENTS,
        .view = {{{0.21f, 0, 0, 0}, {0, -0.21f, 0, 0}, {0, 0, -0.2f, 0.5f}, {0, 0, 0, 1}}}};
    char name[64];
    snprintf(name, sizeof name, "worst case, level %u", segments);
    bench_mesh mesh = {0};
    // At level 1 there is no less.
    const float base = segments > 1 ? length_of(segments - 1, segments) : 0.95f;
    const girih_result result = make_towers(base, &mesh, error);
    return result == GIRIH_OK
               ? run_job(run, target, name, &mesh, GIRIH_SURFACE_PN, &l, &worst_methods, error)
               : result;
}

// The same where every edge has another level.
static girih_result run_mixed(const bench_run *run, bench_target *target, uint32_t segments,
                              girih_error *error) {
    const levels l = {
        .rule = GIRIH_LEVEL_RANDOM,
        .segments = segments,
        .shaded = segments == OUTLINED_SEGMENTS || segments == MOST_SEGMENTS,
        .outlines = segments == OUTLINED_SEGMENTS,
        .view = {{{0.9f, 0, 0, 0}, {0, -0.9f, 0, 0}, {0, 0, -0.4f, 0.5f}, {0, 0, 0, 1}}}};
    char name[64];
    snprintf(name, sizeof name, "mixed levels, 1 to %u", segments);
    bench_mesh mesh = {0};
    const girih_result result = bench_sphere(2, &mesh, error);
    return result == GIRIH_OK
               ? run_job(run, target, name, &mesh, GIRIH_SURFACE_PN, &l, &mixed_methods, error)
               : result;
}

// Figure 4: a thin tetrahedron, its long edges fine, its base coarse.
static girih_result run_thin(const bench_run *run, bench_target *target, uint32_t base,
                             girih_error *error) {
    // Turned a little, so that two faces are seen.
    const levels l = {
        .rule = GIRIH_LEVEL_EDGE_LENGTH,
        .length = 1.0f / ((float)MOST_SEGMENTS - 0.5f),
        .outlines = true,
        .view = {{{1.75f, 0, 0.4f, 0}, {0, -1.8f, 0.0f, 0}, {0.2f, 0, -0.8f, 0.5f}, {0, 0, 0, 1}}}};
    char name[64];
    snprintf(name, sizeof name, "thin tetrahedron, %u and %u segments", MOST_SEGMENTS, base);
    bench_mesh mesh = {0};
    const girih_result result = make_tetrahedron(length_of(base, MOST_SEGMENTS), &mesh, error);
    return result == GIRIH_OK
               ? run_job(run, target, name, &mesh, GIRIH_SURFACE_FLAT, &l, &thin_methods, error)
               : result;
}

girih_result bench_knuth_case(const bench_run *run, girih_error *error) {
    bench_target *target = NULL;
    girih_result result = bench_target_create(run->device, &target, error);
    for (uint32_t n = 1; n <= MOST_SEGMENTS && result == GIRIH_OK; ++n) {
        result = run_worst(run, target, n, error);
    }
    static const uint32_t mixed[] = {4, OUTLINED_SEGMENTS, 11, MOST_SEGMENTS};
    for (size_t n = 0; n < sizeof mixed / sizeof *mixed && result == GIRIH_OK; ++n) {
        result = run_mixed(run, target, mixed[n], error);
    }
    for (uint32_t base = 1; base <= MOST_SEGMENTS / 2 && result == GIRIH_OK; base *= 2) {
        result = run_thin(run, target, base, error);
    }
    bench_target_destroy(target);
    return result;
}
