// Case `errors`: how many triangles a method needs for an error. The same PN meshes at the same
// edge lengths; each method's own triangles, captured, against the surface itself.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "compare.h"
#include "cpu/pn.h"
#include "cpu/surfaces.h"
#include "error.h"
#include "methods.h"
#include "nearest.h"
#include "report.h"

// Mesh units a segment. The longest edges get 16 segments at the last.
static const float lengths[] = {0.4f, 0.28f, 0.2f, 0.14f, 0.1f, 0.07f, 0.05f, 0.035f, 0.025f};
#define LENGTH_COUNT ((uint32_t)(sizeof lengths / sizeof *lengths))

static const bench_method *const methods[] = {
    &bench_girih,        &bench_hardware, &bench_hardware_fractional, &bench_knuth,
    &bench_knuth_warped, &bench_suapt,    &bench_uniform_pn};

static const struct {
    const char *name;
    const girih_catalogue *(*catalogue)(void);
} spacings[] = {{"dyadic", bench_uniform_dyadic}, {"linear", bench_uniform_linear}};

// The surface: so many points of each triangle, and so many segments of each edge where it is
// approximated, four times as many as the finest that is measured has.
#define SURFACE_POINTS 512u
#define SURFACE_SEGMENTS 64u

typedef struct surface {
    const bench_mesh *mesh;
    girih_patch *patches; // of its triangles
    float (*points)[6];   // position, normal
    uint32_t point_count;
    bench_triangles triangles; // with SURFACE_SEGMENTS to an edge
    bench_nearest *nearest;    // of these
    uint8_t *picture;          // of these
} surface;

// --- The surface --------------------------------------------------------------------------------

static girih_patch patch_of(const bench_mesh *mesh, uint32_t triangle) {
    girih_vector p[3], n[3];
    for (uint32_t corner = 0; corner < 3; ++corner) {
        const size_t vertex = mesh->indices[3 * (size_t)triangle + corner];
        const float *position = mesh->positions + 3 * vertex;
        const float *normal = mesh->normals + 3 * vertex;
        p[corner] = (girih_vector){position[0], position[1], position[2]};
        n[corner] = (girih_vector){normal[0], normal[1], normal[2]};
    }
    const girih_pn_points c = girih_make_smooth_pn_points(p, n);
    return (girih_patch){.surface = GIRIH_SURFACE_PN,
                         .b300 = p[0],
                         .b030 = p[1],
                         .b003 = p[2],
                         .b210 = c.b210,
                         .b120 = c.b120,
                         .b021 = c.b021,
                         .b012 = c.b012,
                         .b102 = c.b102,
                         .b201 = c.b201,
                         .b111 = c.b111,
                         .n200 = n[0],
                         .n020 = n[1],
                         .n002 = n[2],
                         .n110 = girih_pn_edge_normal(p[0], p[1], n[0], n[1]),
                         .n011 = girih_pn_edge_normal(p[1], p[2], n[1], n[2]),
                         .n101 = girih_pn_edge_normal(p[2], p[0], n[2], n[0])};
}

static void evaluate(const girih_patch *patch, float v, float w, float point[6]) {
    const float u = 1.0f - v - w;
    const girih_vector position = girih_patch_position(patch, u, v, w);
    const girih_vector normal = girih_patch_unit_normal(patch, u, v, w);
    const float values[6] = {position.x, position.y, position.z, normal.x, normal.y, normal.z};
    memcpy(point, values, sizeof values);
}

// Points that no regular pattern has: those would measure it where it is exact. The two-dimensional
// Kronecker sequence of the plastic number, 1.32471795724..., folded into the triangle.
static void sample(surface *s, uint32_t triangle) {
    for (uint32_t n = 0; n < SURFACE_POINTS; ++n) {
        double v = 0.5 + n * 0.75487766624669276;
        double w = 0.5 + n * 0.56984029099805327;
        v -= floor(v);
        w -= floor(w);
        const bool outside = v + w > 1.0;
        evaluate(&s->patches[triangle], (float)(outside ? 1.0 - v : v),
                 (float)(outside ? 1.0 - w : w), s->points[s->point_count++]);
    }
}

// Triangles of a regular grid.
static void refine(surface *s, uint32_t triangle) {
    const float step = 1.0f / (float)SURFACE_SEGMENTS;
    for (uint32_t j = 0; j < SURFACE_SEGMENTS; ++j) {
        for (uint32_t i = 0; i + j < SURFACE_SEGMENTS; ++i) {
            for (uint32_t turned = 0; turned < (i + j + 1 < SURFACE_SEGMENTS ? 2 : 1); ++turned) {
                static const uint32_t corners[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}},
                                                          {{1, 0}, {1, 1}, {0, 1}}};
                float(*t)[6] = s->triangles.corners + 3 * (size_t)s->triangles.count++;
                for (uint32_t n = 0; n < 3; ++n) {
                    evaluate(&s->patches[triangle], (float)(i + corners[turned][n][0]) * step,
                             (float)(j + corners[turned][n][1]) * step, t[n]);
                }
            }
        }
    }
}

static void surface_free(surface *s) {
    bench_nearest_destroy(s->nearest);
    free(s->patches);
    free(s->points);
    free(s->triangles.corners);
    free(s->picture);
}

static girih_result surface_make(const bench_mesh *mesh, surface *s, girih_error *error) {
    const size_t count = mesh->triangle_count;
    *s = (surface){.mesh = mesh};
    s->patches = malloc(count * sizeof *s->patches);
    s->points = malloc(count * SURFACE_POINTS * sizeof *s->points);
    s->triangles.corners =
        malloc(3 * count * SURFACE_SEGMENTS * SURFACE_SEGMENTS * sizeof *s->triangles.corners);
    if (!s->patches || !s->points || !s->triangles.corners) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < mesh->triangle_count; ++n) {
        s->patches[n] = patch_of(mesh, n);
        sample(s, n);
        refine(s, n);
    }
    return bench_nearest_create(&s->triangles, BENCH_NEAREST_TRIANGLE, &s->nearest, error);
}

// --- Errors -------------------------------------------------------------------------------------

typedef struct errors {
    double hausdorff;      // the greatest distance of a point of the surface to the triangles
    double hausdorff_back; // of a point of the triangles to the surface
    double normal_mean;    // degrees, at the points of the surface
    double normal_max;
    double image;
} errors;

static double degrees_between(const double a[3], const float b[3]) {
    const double x = a[1] * (double)b[2] - a[2] * (double)b[1];
    const double y = a[2] * (double)b[0] - a[0] * (double)b[2];
    const double z = a[0] * (double)b[1] - a[1] * (double)b[0];
    const double cosine = a[0] * (double)b[0] + a[1] * (double)b[1] + a[2] * (double)b[2];
    return atan2(sqrt(x * x + y * y + z * z), cosine) * (180.0 / 3.14159265358979323846);
}

static girih_result measure_distances(const surface *s, const bench_triangles *triangles,
                                      errors *found, girih_error *error) {
    bench_nearest *nearest = NULL;
    const girih_result result =
        bench_nearest_create(triangles, BENCH_NEAREST_TRIANGLE, &nearest, error);
    if (result != GIRIH_OK) {
        return result;
    }
    double farthest = 0.0;
    for (uint32_t n = 0; n < s->point_count; ++n) {
        const bench_nearest_point at = bench_nearest_find(nearest, s->points[n]);
        const float(*t)[6] = (const float(*)[6])triangles->corners + 3 * at.item;
        double normal[3] = {0.0, 0.0, 0.0};
        for (uint32_t corner = 0; corner < 3; ++corner) {
            for (uint32_t k = 0; k < 3; ++k) {
                normal[k] += at.weights[corner] * (double)t[corner][3 + k];
            }
        }
        const double degrees = degrees_between(normal, s->points[n] + 3);
        farthest = fmax(farthest, at.squared_distance);
        found->normal_mean += degrees / s->point_count;
        found->normal_max = fmax(found->normal_max, degrees);
    }
    found->hausdorff = sqrt(farthest);
    bench_nearest_destroy(nearest);
    return GIRIH_OK;
}

// From each triangle's middle and its edges' middles: its corners are on the surface.
static double distance_back(const surface *s, const bench_triangles *triangles) {
    static const float weights[4][3] = {{1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f},
                                        {0.5f, 0.5f, 0.0f},
                                        {0.0f, 0.5f, 0.5f},
                                        {0.5f, 0.0f, 0.5f}};
    double farthest = 0.0;
    for (uint32_t n = 0; n < 4 * triangles->count; ++n) {
        const float(*t)[6] = (const float(*)[6])triangles->corners + 3 * (size_t)(n / 4);
        const float *w = weights[n % 4];
        float point[3];
        for (uint32_t k = 0; k < 3; ++k) {
            point[k] = w[0] * t[0][k] + w[1] * t[1][k] + w[2] * t[2][k];
        }
        farthest = fmax(farthest, bench_nearest_find(s->nearest, point).squared_distance);
    }
    return sqrt(farthest);
}

// Root mean square of the difference, in steps of 8 bits, over the whole picture.
static double picture_difference(const uint8_t *a, const uint8_t *b) {
    const size_t count = (size_t)4 * BENCH_PIXELS * BENCH_PIXELS;
    double sum = 0.0;
    for (size_t n = 0; n < count; ++n) {
        if (n % 4 != 3) {
            const double difference = (double)a[n] - (double)b[n];
            sum += difference * difference;
        }
    }
    return sqrt(sum / (3.0 * BENCH_PIXELS * BENCH_PIXELS));
}

static girih_result take_picture(bench_case_job *job, const bench_method *method, void *state,
                                 uint32_t n, uint8_t **picture, girih_error *error) {
    bench_time time;
    const girih_result result = bench_frame(job, method, state, BENCH_SHADED, n, &time, error);
    return result == GIRIH_OK ? bench_target_picture(job->job.target, picture, error) : result;
}

// --- Finenesses ---------------------------------------------------------------------------------

// From above, at 50 degrees, orthographic.
static const bench_view view_from_above = {.rows = {{0.9f, 0, 0, 0},
                                                    {0, -0.578509f, 0.689440f, 0},
                                                    {0, -0.306418f, -0.257115f, 0.5f},
                                                    {0, 0, 0, 1}}};

static void length_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    (void)user;
    *frame =
        (girih_frame){.rule = GIRIH_LEVEL_EDGE_LENGTH, .length = lengths[n], .orthographic = true};
    *view = view_from_above;
}

static void surface_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    (void)user;
    (void)n;
    *frame = (girih_frame){
        .rule = GIRIH_LEVEL_SEGMENTS, .segments = SURFACE_SEGMENTS, .orthographic = true};
    *view = view_from_above;
}

static girih_result measure_length(bench_case_job *job, const surface *s, const char *name,
                                   const bench_method *method, void *state, uint32_t n,
                                   json_t *points, girih_error *error) {
    bench_triangles triangles = {0};
    uint8_t *picture = NULL;
    errors found = {0};
    uint64_t open = 0;
    girih_report_progress(name);
    girih_result result = bench_capture(job, method, state, n, &triangles, error);
    if (result == GIRIH_OK) {
        result = take_picture(job, method, state, n, &picture, error);
    }
    if (result == GIRIH_OK) {
        found.image = picture_difference(picture, s->picture);
        found.hausdorff_back = distance_back(s, &triangles);
        result = measure_distances(s, &triangles, &found, error);
    }
    if (result == GIRIH_OK) {
        result = bench_open_edges(&triangles, &open, error);
    }
    if (result == GIRIH_OK) {
        json_array_append_new(
            points,
            json_pack("{s:s,s:f,s:I,s:I,s:f,s:f,s:f,s:f,s:f}", "method", name, "length",
                      (double)lengths[n], "triangles", (json_int_t)triangles.count, "open_edges",
                      (json_int_t)open, "hausdorff", found.hausdorff, "hausdorff_back",
                      found.hausdorff_back, "normal_degrees_mean", found.normal_mean,
                      "normal_degrees_max", found.normal_max, "image_rms", found.image));
    }
    free(picture);
    free(triangles.corners);
    return result;
}

// Each fineness is the job's reference in its turn: what a method rests on it is as for that
// fineness alone.
static girih_result measure_method(bench_case_job *job, const surface *s, const char *spacing,
                                   const bench_method *method, json_t *points, girih_error *error) {
    char name[128];
    girih_result result = GIRIH_OK;
    snprintf(name, sizeof name, "%s, %s", method->name, spacing);
    for (uint32_t n = 0; n < LENGTH_COUNT && result == GIRIH_OK; ++n) {
        bench_view view;
        length_frame(NULL, n, &job->job.reference, &view);
        const char *why = method->unfit ? method->unfit(&job->job) : NULL;
        if (why) {
            json_array_append_new(points, json_pack("{s:s,s:f,s:s}", "method", name, "length",
                                                    (double)lengths[n], "unfit", why));
            continue;
        }
        void *state = NULL;
        result = method->create(&job->job, method->variant, &state, error);
        if (result == GIRIH_OK) {
            result = measure_length(job, s, name, method, state, n, points, error);
        }
        method->destroy(state);
    }
    return result;
}

// The picture of the surface, drawn by girih:.
static girih_result draw_surface(const bench_run *run, bench_target *target, surface *s,
                                 girih_error *error) {
    const bench_job_desc desc = {.name = "surface",
                                 .mesh = s->mesh,
                                 .catalogue = bench_uniform_dyadic(),
                                 .surface = GIRIH_SURFACE_PN,
                                 .frame = surface_frame,
                                 .frame_count = 2};
    bench_case_job job = {0};
    void *state = NULL;
    girih_result result = bench_job_create(target, run->device, &desc, &job, error);
    if (result == GIRIH_OK) {
        result = bench_girih.create(&job.job, bench_girih.variant, &state, error);
    }
    if (result == GIRIH_OK) {
        result = take_picture(&job, &bench_girih, state, 1, &s->picture, error);
    }
    bench_girih.destroy(state);
    bench_job_destroy(&job);
    return result;
}

static girih_result measure_mesh(const bench_run *run, bench_target *target, const bench_mesh *mesh,
                                 girih_error *error) {
    surface s = {0};
    json_t *points = json_array();
    girih_result result = surface_make(mesh, &s, error);
    if (result == GIRIH_OK) {
        result = draw_surface(run, target, &s, error);
    }
    for (size_t n = 0; n < sizeof spacings / sizeof *spacings && result == GIRIH_OK; ++n) {
        const bench_job_desc desc = {.name = mesh->name,
                                     .mesh = mesh,
                                     .catalogue = spacings[n].catalogue(),
                                     .surface = GIRIH_SURFACE_PN,
                                     .frame = length_frame,
                                     .frame_count = LENGTH_COUNT};
        bench_case_job job = {0};
        result = bench_job_create(target, run->device, &desc, &job, error);
        for (size_t m = 0; m < sizeof methods / sizeof *methods && result == GIRIH_OK; ++m) {
            result = measure_method(&job, &s, spacings[n].name, methods[m], points, error);
        }
        bench_job_destroy(&job);
    }
    girih_report_progress(NULL);
    if (result == GIRIH_OK) {
        char name[128];
        snprintf(name, sizeof name, "errors %s", mesh->name);
        json_array_append_new(run->cases,
                              json_pack("{s:s,s:I,s:O}", "name", name, "input_triangles",
                                        (json_int_t)mesh->triangle_count, "points", points));
    }
    json_decref(points);
    surface_free(&s);
    return result;
}

girih_result bench_errors(const bench_run *run, girih_error *error) {
    if (!run->device->has_transform_feedback) {
        json_array_append_new(run->cases, json_pack("{s:s,s:s}", "name", "errors", "unfit",
                                                    "the device lacks VK_EXT_transform_feedback"));
        return GIRIH_OK;
    }
    bench_target *target = NULL;
    bench_mesh sphere = {0};
    bench_mesh torus = {0};
    girih_result result = bench_target_create(run->device, &target, error);
    if (result == GIRIH_OK) {
        result = bench_sphere(2, &sphere, error);
    }
    if (result == GIRIH_OK) {
        result = bench_torus(16, 10, 0.7f, 0.3f, &torus, error);
    }
    if (result == GIRIH_OK) {
        result = measure_mesh(run, target, &sphere, error);
    }
    if (result == GIRIH_OK) {
        result = measure_mesh(run, target, &torus, error);
    }
    bench_mesh_free(&torus);
    bench_mesh_free(&sphere);
    bench_target_destroy(target);
    return result;
}
