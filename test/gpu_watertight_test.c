// Watertight by bits, whatever the levels: closed meshes with seams, hard edges and negative zeros,
// more than a thousand random level sets, every mode. What is checked is what the rasteriser would
// get: the corners of all triangles as a host's vertex shader hands them on, captured by transform
// feedback.
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
#include "meshes.h"
#include "stages.h"

#define MESHES 3
#define TRANSFORMS 3
#define MAX_SEGMENTS 16
#define MAX_SPLITS 200000u
#define MAX_SPLIT_TRIANGLES 300000u

static const girih_mesh *meshes[MESHES];
static gpu device;   // with every feature that girih asks for
static gpu plainest; // with none
static unsigned level_sets;
static unsigned masked_sets;
static uint64_t triangles_checked;
static uint64_t edges_checked;
static char what[256];

// The identity; a rotation with a mirroring and a uniform scale; a mirroring with different scales.
static const float transforms[TRANSFORMS][12] = {
    {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
    {0, -1.7f, 0, 0.3f, 1.7f, 0, 0, -0.1f, 0, 0, -1.7f, 5},
    {-0.5f, 0.1f, 0.2f, 1, 0.3f, 1.1f, 0, 2, -0.1f, 0.4f, 0.9f, 3},
};

static void assert_ok(girih_result result, const girih_error *error) {
    if (result != GIRIH_OK) {
        fail_msg("%s: %s", what, error->message);
    }
}

// --- Points by their bits
// -----------------------------------------------------------------------------

typedef struct points {
    size_t size;       // a power of two
    uint32_t *numbers; // number of the point and one
    float (*positions)[3];
    uint32_t count;
} points;

static uint32_t *find_point(const points *p, const float position[3]) {
    uint32_t words[3];
    memcpy(words, position, sizeof words);
    uint64_t hash = words[0] * UINT64_C(0x9e3779b97f4a7c15);
    hash = (hash ^ hash >> 29 ^ words[1]) * UINT64_C(0xc2b2ae3d27d4eb4f);
    hash = (hash ^ hash >> 29 ^ words[2]) * UINT64_C(0x165667b19e3779f9);
    size_t slot = (hash >> 24) & (p->size - 1);
    while (p->numbers[slot] &&
           memcmp(p->positions[p->numbers[slot] - 1], position, sizeof words) != 0) {
        slot = (slot + 1) & (p->size - 1);
    }
    return &p->numbers[slot];
}

static points begin_points(uint32_t most) {
    points p = {.size = 16};
    while (p.size < 2 * (size_t)most) {
        p.size *= 2;
    }
    p.numbers = calloc(p.size, sizeof *p.numbers);
    p.positions = malloc(((size_t)most + 1) * sizeof *p.positions);
    assert_true(p.numbers && p.positions);
    return p;
}

static uint32_t add_point(points *p, const float position[3]) {
    uint32_t *number = find_point(p, position);
    if (*number == 0) {
        memcpy(p->positions[p->count], position, 3 * sizeof(float));
        *number = ++p->count;
    }
    return *number - 1;
}

static void end_points(points *p) {
    free(p->numbers);
    free(p->positions);
}

// --- One level set
// ------------------------------------------------------------------------------------

// What is refined, and how the captured corners must look.
typedef struct solid {
    const girih_mesh *mesh;
    const float *transform;
} solid;

// As the shaders sum it.
static void transform_point(const float t[12], const float p[3], float result[3]) {
    for (int n = 0; n < 3; ++n) {
        const float sum =
            ((t[4 * n] * p[0] + t[4 * n + 1] * p[1]) + t[4 * n + 2] * p[2]) + t[4 * n + 3];
        result[n] = sum == 0.0f ? 0.0f : sum;
    }
}

// Closed, each edge used twice in opposite directions, outside out, and the input's corners in
// place.
static void check_closed(const solid *body, const float *corners, uint32_t count) {
    points p = begin_points(3 * count);
    uint32_t *indices = malloc((3 * (size_t)count + 1) * sizeof *indices);
    assert_non_null(indices);
    double volume = 0;
    for (uint32_t n = 0; n < 3 * count; ++n) {
        indices[n] = add_point(&p, corners + (size_t)n * GPU_CAPTURE_FLOATS);
    }
    for (uint32_t n = 0; n < count; ++n) {
        double v[3][3];
        for (int corner = 0; corner < 3; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
                v[corner][axis] = (double)p.positions[indices[3 * n + (uint32_t)corner]][axis] -
                                  (double)body->transform[4 * axis + 3];
            }
        }
        volume += v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                  v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                  v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    }
    const edge_audit audit = audit_indices(indices, count);
    if (audit.open || audit.nonmanifold || audit.flipped || audit.degenerate ||
        2 * audit.edges != 3 * (uint64_t)count) {
        fail_msg(
            "%s: of %u triangles %llu open, %llu non-manifold, %llu flipped edges, %llu degenerate",
            what, count, (unsigned long long)audit.open, (unsigned long long)audit.nonmanifold,
            (unsigned long long)audit.flipped, (unsigned long long)audit.degenerate);
    }
    if (!(volume > 0.01)) {
        fail_msg("%s: turned inside out, 6 times the volume is %g", what, volume);
    }
    for (uint32_t n = 0; n < body->mesh->vertex_count; ++n) {
        float corner[3];
        transform_point(body->transform, body->mesh->positions + 3 * (size_t)n, corner);
        if (*find_point(&p, corner) == 0) {
            fail_msg("%s: no output at vertex %u of the input", what, n);
        }
    }
    edges_checked += audit.edges;
    free(indices);
    end_points(&p);
}

static void assert_same_corners(const char *mode, const float *corners, uint32_t count,
                                const float *other, uint32_t other_count) {
    if (count != other_count) {
        fail_msg("%s: %u triangles, %s %u", what, count, mode, other_count);
    }
    for (uint32_t n = 0; n < 3 * count; ++n) {
        const size_t first = (size_t)n * GPU_CAPTURE_FLOATS;
        if (memcmp(corners + first, other + first, GPU_CAPTURE_FLOATS * sizeof(float)) != 0) {
            for (size_t f = first; f < first + GPU_CAPTURE_FLOATS; ++f) {
                print_error("%.9g %.9g\n", (double)corners[f], (double)other[f]);
            }
            fail_msg("%s: %s differs at corner %u of triangle %u of %u", what, mode, n % 3, n / 3,
                     count);
        }
    }
}

// The same through the output buffers and a list of indices.
static void assert_same_buffers(const char *mode, const float *corners, uint32_t count,
                                const gpu_readback *read, uint32_t list) {
    const uint32_t *indices = read->words[list];
    const bool by_position = list == GIRIH_BIND_OUT_CLOSED_INDICES;
    for (uint32_t n = 0; n < 3 * count; ++n) {
        const float *corner = corners + (size_t)n * GPU_CAPTURE_FLOATS;
        const uint32_t *position = read->words[GIRIH_BIND_OUT_POSITIONS] + 3 * (size_t)indices[n];
        const uint32_t *attributes =
            read->words[GIRIH_BIND_OUT_ATTRIBUTES] + 5 * (size_t)indices[n];
        if (memcmp(corner, position, 12) != 0 ||
            (!by_position && memcmp(corner + 3, attributes, 20) != 0)) {
            fail_msg("%s: %s: index %u of triangle %u names another vertex than the draw", what,
                     mode, n % 3, n / 3);
        }
    }
}

// --- Plans in every mode
// ----------------------------------------------------------------------------------

enum { INSTANCED, BAKED, BAKED_INDICES, WELDED, PLANS };

typedef struct refiner {
    gpu_capture *capture;
    solid body;
    girih_plan *plans[PLANS]; // the instanced one is NULL where the device cannot
    uint32_t room;
} refiner;

// Room for so much. With room for parts triangles are split, and not welded.
typedef struct room {
    uint32_t triangles, vertices, splits;
} room;

static refiner begin_refiner(gpu_capture *capture, girih_scene *scene, solid body,
                             girih_surface surface, room wanted) {
    static const struct {
        girih_mode mode;
        uint32_t outputs;
    } kinds[PLANS] = {{GIRIH_MODE_INSTANCED, 0},
                      {GIRIH_MODE_BAKED, 0},
                      {GIRIH_MODE_BAKED, GIRIH_OUTPUT_INDICES},
                      {GIRIH_MODE_WELDED, GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES}};
    refiner r = {.capture = capture, .body = body, .room = wanted.triangles};
    girih_instance instance = {0};
    memcpy(instance.transform, body.transform, sizeof instance.transform);
    for (int n = 0; n < PLANS; ++n) {
        if ((n == INSTANCED && !capture->gpu->features.multiDrawIndirect) ||
            (n == WELDED && wanted.splits > 0)) {
            continue;
        }
        const girih_plan_desc desc = {.scene = scene,
                                      .instances = &instance,
                                      .instance_count = 1,
                                      .surface = surface,
                                      .mode = kinds[n].mode,
                                      .outputs = kinds[n].outputs,
                                      .max_vertices = wanted.vertices,
                                      .max_triangles = wanted.triangles,
                                      .max_segments = GIRIH_MOST_SEGMENTS,
                                      .max_splits = wanted.splits};
        girih_error error = {GIRIH_OK, ""};
        assert_ok(girih_plan_create(capture->context, &desc, &r.plans[n], &error), &error);
    }
    return r;
}

static void end_refiner(refiner *r) {
    for (int n = 0; n < PLANS; ++n) {
        girih_plan_destroy(r->plans[n]);
    }
}

// Refines and draws in every mode.
static void check_level_set(refiner *r, const girih_frame *frame, gpu_readback *read) {
    static const char *const names[PLANS] = {"instanced", "baked", "baked by indices", "welded"};
    float *corners = NULL;
    uint32_t count = 0;
    for (int n = 0; n < PLANS; ++n) {
        if (!r->plans[n]) {
            continue;
        }
        const bool buffers = n == BAKED_INDICES || n == WELDED;
        if (buffers) {
            gpu_refine(r->capture->gpu, r->plans[n], frame, read);
        }
        const uint32_t drawn = gpu_draw(r->capture, r->plans[n], buffers ? NULL : frame, r->room);
        const girih_statistics statistics = girih_plan_statistics(r->plans[n]);
        assert_int_equal(statistics.overflow, 0);
        assert_int_equal(statistics.output_triangles, drawn);
        const float *seen = r->capture->corners.mapped;
        if (!corners) {
            count = drawn;
            corners = malloc((size_t)count * 3 * GPU_CAPTURE_FLOATS * sizeof *corners + 1);
            assert_non_null(corners);
            memcpy(corners, seen, (size_t)count * 3 * GPU_CAPTURE_FLOATS * sizeof *corners);
            check_closed(&r->body, corners, count);
        } else {
            assert_same_corners(names[n], corners, count, seen, drawn);
        }
        if (buffers) {
            assert_same_buffers(names[n], corners, count, read, GIRIH_BIND_OUT_INDICES);
        }
        if (n == WELDED) {
            const uint32_t *closed = read->words[GIRIH_BIND_OUT_CLOSED_INDICES];
            assert_same_buffers("closed indices", corners, count, read,
                                GIRIH_BIND_OUT_CLOSED_INDICES);
            const edge_audit audit = audit_indices(closed, count);
            if (2 * audit.edges != 3 * (uint64_t)count) {
                fail_msg("%s: closed indices: %llu of %u edges are used twice", what,
                         (unsigned long long)audit.edges, 3 * count / 2);
            }
        }
        triangles_checked += count;
    }
    free(corners);
}

// `sets` random level sets of every mesh, for both surfaces.
static void check_variant(gpu *host, gpu_variant variant, uint32_t sets, unsigned *counter) {
    girih_context *context = gpu_variant_context(host, variant);
    gpu_capture capture = gpu_capture_open(host, context);
    gpu_readback read = {0};
    for (uint32_t mesh = 0; mesh < MESHES; ++mesh) {
        const uint32_t triangles = meshes[mesh]->triangle_count;
        const room most = {.triangles = triangles * MAX_SEGMENTS * MAX_SEGMENTS,
                           .vertices = triangles * (MAX_SEGMENTS + 1) * (MAX_SEGMENTS + 2) / 2};
        girih_scene *scene = gpu_scene(host, context, &meshes[mesh], 1);
        for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
            for (int transform = 0; transform < TRANSFORMS; ++transform) {
                refiner r =
                    begin_refiner(&capture, scene, (solid){meshes[mesh], transforms[transform]},
                                  (girih_surface)surface, most);
                // Last of all every edge alike: one group, too large for a single baked draw.
                for (uint32_t n = 0; n <= sets; ++n) {
                    girih_frame frame = {.rule = GIRIH_LEVEL_SEGMENTS, .segments = MAX_SEGMENTS};
                    if (n < sets) {
                        frame.rule = GIRIH_LEVEL_RANDOM;
                        frame.segments = 1 + *counter % MAX_SEGMENTS;
                        frame.seed = 1000003u * ++*counter;
                    }
                    snprintf(what, sizeof what,
                             "%s, surface %d, transform %d, %s, sort %d, few %d, %s:%u:%u",
                             meshes[mesh]->name, surface, transform,
                             variant.linear ? "linear" : "dyadic", variant.sort,
                             variant.few_buffers, n < sets ? "random" : "segments", frame.seed,
                             frame.segments);
                    check_level_set(&r, &frame, &read);
                }
                end_refiner(&r);
            }
        }
        girih_scene_destroy(scene);
    }
    gpu_readback_free(host, &read);
    gpu_capture_close(&capture);
    girih_context_destroy(context);
}

#define SETS 15 // of a mesh, surface, transform and variant: 15 * 3 * 2 * 3 * 4 = 1,080

static void dyadic_serial(void **state) {
    (void)state;
    check_variant(&device, (gpu_variant){.linear = 0, .sort = GIRIH_SORT_SERIAL}, SETS,
                  &level_sets);
}

static void dyadic_workgroup_few(void **state) {
    (void)state;
    check_variant(&device,
                  (gpu_variant){.linear = 0, .sort = GIRIH_SORT_WORKGROUP, .few_buffers = 1}, SETS,
                  &level_sets);
}

static void linear_workgroup(void **state) {
    (void)state;
    check_variant(&device, (gpu_variant){.linear = 1, .sort = GIRIH_SORT_WORKGROUP}, SETS,
                  &level_sets);
}

static void linear_serial_few(void **state) {
    (void)state;
    check_variant(&device, (gpu_variant){.linear = 1, .sort = GIRIH_SORT_SERIAL, .few_buffers = 1},
                  SETS, &level_sets);
}

// Without any optional feature: baked and welded, one indirect draw a material, 4 storage buffers a
// stage.
static void features_masked_off(void **state) {
    (void)state;
    assert_false(plainest.features.multiDrawIndirect ||
                 plainest.features.drawIndirectFirstInstance);
    check_variant(&plainest, (gpu_variant){.linear = 0, .sort = GIRIH_SORT_AUTO, .few_buffers = 1},
                  4, &masked_sets);
    check_variant(&plainest, (gpu_variant){.linear = 1, .sort = GIRIH_SORT_AUTO}, 4, &masked_sets);
    assert_true(masked_sets > 100);
}

// --- Beyond the catalogue
// -----------------------------------------------------------------------------------

// What a frame needs of a plan that splits, by the CPU twins, and the levels of the triangle's
// edges that are farthest apart.
static girih_statistics count_split(const girih_catalogue *catalogue, const girih_mesh *mesh,
                                    const girih_frame *frame, uint32_t *least, uint32_t *most) {
    stages s = stages_begin(catalogue, &mesh, 1, NULL, 0,
                            (girih_plan_shape){.mode = GIRIH_MODE_BAKED,
                                               .outputs = GIRIH_OUTPUT_NO_DRAW,
                                               .max_segments = GIRIH_MOST_SEGMENTS,
                                               .max_splits = MAX_SPLITS});
    stages_frame(&s, frame);
    stages_count(&s, GIRIH_SURFACE_FLAT);
    const uint32_t *levels = s.arrays.words[GIRIH_BIND_LEVELS];
    *least = *most = 0;
    for (uint32_t n = 0; n < mesh->triangle_count; ++n) {
        uint32_t low = UINT32_MAX, high = 0;
        for (uint32_t edge = 0; edge < 3; ++edge) {
            const uint32_t level = levels[mesh->triangle_edges[3 * n + edge]];
            low = level < low ? level : low;
            high = level > high ? level : high;
        }
        if (high - low > *most - *least) {
            *least = low;
            *most = high;
        }
    }
    const girih_statistics statistics = stages_statistics(&s);
    stages_end(&s);
    return statistics;
}

static void check_split_set(gpu_capture *capture, const girih_mesh *mesh, girih_surface surface,
                            const float *transform, const girih_frame *frame,
                            const girih_statistics *needed) {
    gpu_readback read = {0};
    girih_scene *scene = gpu_scene(capture->gpu, capture->context, &mesh, 1);
    refiner r = begin_refiner(capture, scene, (solid){mesh, transform}, surface,
                              (room){.triangles = (uint32_t)needed->needed_triangles,
                                     .vertices = (uint32_t)needed->needed_vertices,
                                     .splits = MAX_SPLITS});
    check_level_set(&r, frame, &read);
    end_refiner(&r);
    girih_scene_destroy(scene);
    gpu_readback_free(capture->gpu, &read);
}

// Edges of one segment beside edges of 32,768; and `sets` of random levels, those that few enough
// triangles have to be captured.
static void check_splits(gpu_variant variant, uint32_t sets) {
    girih_context *context = gpu_variant_context(&device, variant);
    const girih_catalogue *catalogue =
        variant.linear ? girih_catalogue_linear() : girih_catalogue_dyadic();
    gpu_capture capture = gpu_capture_open(&device, context);
    const uint32_t last = variant.linear ? GIRIH_MOST_SEGMENTS - 1 : 15;
    uint32_t least, most;
    const girih_mesh *needle = make_needle((float)GIRIH_MOST_SEGMENTS - 0.5f);
    const girih_frame by_length = {.rule = GIRIH_LEVEL_EDGE_LENGTH, .length = 1};
    girih_statistics needed = count_split(catalogue, needle, &by_length, &least, &most);
    assert_int_equal(least, 0);
    assert_int_equal(most, last);
    assert_int_equal(needed.clamped_edges, 0);
    for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
        snprintf(what, sizeof what, "needle, surface %d, %s, few %d", surface,
                 variant.linear ? "linear" : "dyadic", variant.few_buffers);
        check_split_set(&capture, needle, (girih_surface)surface, transforms[0], &by_length,
                        &needed);
    }
    girih_mesh_destroy(needle);
    uint32_t found = 0;
    for (uint32_t seed = 1; found < sets && seed < 4000; ++seed) {
        const girih_mesh *mesh = meshes[seed % MESHES];
        const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM_LEVEL,
                                   .segments = variant.linear ? 1u << (5 + seed % 11) : 15,
                                   .seed = seed};
        needed = count_split(catalogue, mesh, &frame, &least, &most);
        if (needed.overflow || needed.needed_triangles > MAX_SPLIT_TRIANGLES ||
            most < catalogue->level_count) {
            continue;
        }
        snprintf(what, sizeof what, "%s, %s, few %d, levels of up to %u:%u", mesh->name,
                 variant.linear ? "linear" : "dyadic", variant.few_buffers, frame.segments, seed);
        check_split_set(&capture, mesh, found % 2 ? GIRIH_SURFACE_PN : GIRIH_SURFACE_FLAT,
                        transforms[found % TRANSFORMS], &frame, &needed);
        ++found;
    }
    assert_int_equal(found, sets);
    gpu_capture_close(&capture);
    girih_context_destroy(context);
}

static void splits_dyadic(void **state) {
    (void)state;
    check_splits((gpu_variant){.linear = 0, .sort = GIRIH_SORT_SERIAL}, 4);
}

static void splits_linear_few(void **state) {
    (void)state;
    check_splits((gpu_variant){.linear = 1, .sort = GIRIH_SORT_WORKGROUP, .few_buffers = 1}, 6);
}

static void enough(void **state) {
    (void)state;
    print_message("%u level sets in 4 draws each and %u with all features off: %llu triangles, "
                  "%llu edges closed\n",
                  level_sets, masked_sets, (unsigned long long)triangles_checked,
                  (unsigned long long)edges_checked);
    assert_true(level_sets >= 1000);
    assert_true(edges_checked > 1000000);
}

int main(void) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    gpu_open(&plainest, NULL, true);
    device.share_pipelines = plainest.share_pipelines = true;
    meshes[0] = make_seam_sphere(7, 6);
    meshes[1] = make_cube(1);
    meshes[2] = make_torus(9, 4);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dyadic_serial),       cmocka_unit_test(dyadic_workgroup_few),
        cmocka_unit_test(linear_workgroup),    cmocka_unit_test(linear_serial_few),
        cmocka_unit_test(features_masked_off), cmocka_unit_test(splits_dyadic),
        cmocka_unit_test(splits_linear_few),   cmocka_unit_test(enough),
    };
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    for (int n = 0; n < MESHES; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
    const unsigned messages = gpu_close(&plainest) + gpu_close(&device);
    if (messages) {
        print_error("%u validation messages\n", messages);
    }
    return messages != 0;
}
