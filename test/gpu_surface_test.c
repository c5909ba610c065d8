// A host's own surfaces on the GPU: the identity is the built-in surface; functions that differ in
// every way on the two sides of an edge leave no crack in any mode; normals, culling, the previous
// frame's positions, and the twin on the CPU.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
#include "meshes.h"
#include "own_surfaces.h"
#include "stages.h"

#define SMALL_RANGE 65536u // bytes a storage buffer shows in the tests of windows
#define ROOM 60000u        // output triangles

static gpu device;
static own_set textures;
static const own_settings settings = {.height = 0.05f, .phase = 0.3f};
static const girih_mesh *meshes[OWN_MESHES];

static girih_plan_desc plan_of(const girih_scene *scene, const girih_surface_program *program,
                               girih_mode mode) {
    return own_plan_of(scene, program, mode, ROOM);
}

static girih_frame random_frame(uint32_t seed) {
    return (girih_frame){
        .rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = seed, .surface_set = textures.set};
}

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Every word of the outputs, unwritten ones included: gpu_refine filled them.
static void assert_same_outputs(const girih_plan *a, const gpu_readback *read_a,
                                const girih_plan *b, const gpu_readback *read_b) {
    for (uint32_t n = 0; n <= GIRIH_PLAN_SOURCES - GIRIH_PLAN_POSITIONS; ++n) {
        const VkDeviceSize size = a->buffers[GIRIH_PLAN_POSITIONS + n].size;
        assert_int_equal(size, b->buffers[GIRIH_PLAN_POSITIONS + n].size);
        if (size) {
            assert_memory_equal(read_a->words[GIRIH_BIND_OUT_POSITIONS + n],
                                read_b->words[GIRIH_BIND_OUT_POSITIONS + n], size);
        }
    }
}

// --- The identity -------------------------------------------------------------------------------

static void check_identity(gpu_variant variant) {
    girih_context *context = gpu_variant_context(&device, variant);
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_IDENTITY, 0);
    float farthest = 0, farthest_normal = 0;
    gpu_readback expected = {0}, got = {0};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan *built_in = own_make_plan(context, plan_of(scene, NULL, (girih_mode)mode));
        girih_plan *plan = own_make_plan(context, plan_of(scene, program, (girih_mode)mode));
        const girih_frame frame = random_frame(1);
        gpu_refine(&device, built_in, &frame, &expected);
        gpu_refine(&device, plan, &frame, &got);
        const girih_statistics s = girih_plan_statistics(plan);
        assert_false(s.overflow);
        assert_int_equal(s.output_triangles, girih_plan_statistics(built_in).output_triangles);
        for (uint32_t n = GIRIH_BIND_OUT_INDICES; n <= GIRIH_BIND_OUT_SOURCES; ++n) {
            if (expected.words[n]) {
                const uint64_t words = n == GIRIH_BIND_OUT_SOURCES ? 2 : 3;
                assert_memory_equal(expected.words[n], got.words[n],
                                    words * s.output_triangles * sizeof(uint32_t));
            }
        }
        for (uint32_t n = 0; n < 3 * s.output_triangles; ++n) {
            const uint32_t vertex = expected.words[GIRIH_BIND_OUT_INDICES][n];
            const float *p = own_position(&expected, vertex), *q = own_position(&got, vertex);
            const float *a = own_normal(&expected, vertex, 5), *b = own_normal(&got, vertex, 5);
            const float size = sqrtf(dot(p, p));
            for (int axis = 0; axis < 3; ++axis) {
                const float apart = fabsf(p[axis] - q[axis]) / fmaxf(size, 1.0f);
                const float normals_apart = fabsf(a[axis] - b[axis]);
                // Written so that a NaN fails it too.
                assert_true(apart <= 1e-6f && normals_apart <= 1e-3f);
                farthest = fmaxf(farthest, apart);
                farthest_normal = fmaxf(farthest_normal, normals_apart);
            }
            assert_memory_equal(a + 3, b + 3, 8); // the attributes
        }
        girih_plan_destroy(built_in);
        girih_plan_destroy(plan);
    }
    printf("identity: positions within %g of the built-in surface's, normals within %g\n",
           (double)farthest, (double)farthest_normal);
    gpu_readback_free(&device, &expected);
    gpu_readback_free(&device, &got);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void identity(void **state) {
    (void)state;
    check_identity((gpu_variant){0});
    check_identity((gpu_variant){.linear = 1, .few_buffers = 1});
}

// A cube with face normals keeps its six normals, whoever evaluates its edges.
static void hard_edges_stay_hard(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, &meshes[OWN_CUBE], 1);
    const girih_instance once = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    gpu_readback read = {0};
    for (int flat = 0; flat < 2; ++flat) {
        girih_surface_program *program =
            own_program(context, &textures, flat ? OWN_IDENTITY_FLAT : OWN_IDENTITY, 0);
        for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
            girih_plan_desc desc = plan_of(scene, program, (girih_mode)mode);
            desc.instances = &once;
            desc.instance_count = 1;
            girih_plan *plan = own_make_plan(context, desc);
            const girih_frame frame = random_frame(4);
            gpu_refine(&device, plan, &frame, &read);
            const uint64_t corners = 3 * girih_plan_statistics(plan).output_triangles;
            uint64_t seen[6] = {0};
            for (uint64_t n = 0; n < corners; ++n) {
                const uint32_t triangle = read.words[GIRIH_BIND_OUT_SOURCES][n / 3 * 2 + 1];
                const uint32_t vertex = meshes[OWN_CUBE]->triangle_vertices[3 * triangle];
                const float *face = meshes[OWN_CUBE]->normals + 3 * (size_t)vertex;
                const float *normal = own_normal(&read, read.words[GIRIH_BIND_OUT_INDICES][n], 5);
                for (int axis = 0; axis < 3; ++axis) {
                    assert_true(fabsf(face[axis] - normal[axis]) <= 1e-6f);
                    seen[2 * axis + (face[axis] > 0)] += fabsf(face[axis]) == 1.0f;
                }
            }
            for (int n = 0; n < 6; ++n) {
                assert_true(seen[n] > 6);
            }
            girih_plan_destroy(plan);
        }
        girih_surface_program_destroy(program);
    }
    gpu_readback_free(&device, &read);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

// --- Watertight ---------------------------------------------------------------------------------

// How often the output's edges must be used, by the input's edges and their levels.
static edge_audit expect_edges(const girih_catalogue *catalogue, const gpu_readback *read,
                               uint64_t output_triangles) {
    const uint32_t *levels = read->words[GIRIH_BIND_LEVELS];
    edge_audit expected = {0};
    uint64_t on_edges = 0;
    for (uint32_t n = 0; n < OWN_INSTANCES; ++n) {
        const girih_mesh *mesh = meshes[own_instances[n].mesh];
        for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
            const uint32_t segments = girih_catalogue_segments(catalogue, *levels++);
            const uint32_t uses = mesh->edge_uses[edge];
            expected.open += uses == 1 ? segments : 0;
            expected.nonmanifold += uses > 2 ? segments : 0;
            expected.edges += uses == 2 ? segments : 0;
            on_edges += (uint64_t)uses * segments;
        }
    }
    expected.edges += (3 * output_triangles - on_edges) / 2;
    return expected;
}

// Edges of two triangles count alike whichever way these run: the soup has flipped ones.
static bool is_as_expected(const edge_audit *audit, const edge_audit *expected) {
    return audit->edges + audit->flipped == expected->edges && audit->open == expected->open &&
           audit->nonmanifold == expected->nonmanifold && audit->degenerate == 0;
}

static void assert_as_expected(const char *what, edge_audit audit, edge_audit expected) {
    if (!is_as_expected(&audit, &expected)) {
        fail_msg("%s: %llu edges of two triangles, %llu open, %llu non-manifold, %llu degenerate; "
                 "expected %llu, %llu, %llu, 0",
                 what, (unsigned long long)(audit.edges + audit.flipped),
                 (unsigned long long)audit.open, (unsigned long long)audit.nonmanifold,
                 (unsigned long long)audit.degenerate, (unsigned long long)expected.edges,
                 (unsigned long long)expected.open, (unsigned long long)expected.nonmanifold);
    }
}

static edge_audit audit_read(const girih_plan *plan, const gpu_readback *read) {
    const girih_statistics s = girih_plan_statistics(plan);
    return audit_points(own_position(read, 0), s.output_vertices,
                        read->words[GIRIH_BIND_OUT_INDICES], s.output_triangles);
}

// The corners that the instanced draw hands on are those of the baked output, bit for bit.
// lavapipe runs the same instructions in a vertex and in a compute shader.
static uint32_t assert_draws(gpu_capture *capture, girih_plan *instanced, const girih_frame *frame,
                             const girih_plan *baked, const gpu_readback *read) {
    const uint32_t drawn =
        gpu_draw(capture, instanced, frame, instanced->arrays.frame.max_triangles);
    assert_int_equal(drawn, girih_plan_statistics(baked).output_triangles);
    const float *corners = capture->corners.mapped;
    for (uint32_t n = 0; n < 3 * drawn; ++n) {
        const uint32_t vertex = read->words[GIRIH_BIND_OUT_INDICES][n];
        const float *corner = corners + (size_t)n * GPU_CAPTURE_FLOATS;
        const float *position = own_position(read, vertex), *rest = own_normal(read, vertex, 5);
        if (memcmp(corner, position, 12) || memcmp(corner + 3, rest, 20)) {
            fail_msg("corner %u of triangle %u is drawn at (%.9g %.9g %.9g) with normal (%.9g %.9g "
                     "%.9g), baked at (%.9g %.9g %.9g) with (%.9g %.9g %.9g)",
                     n % 3, n / 3, (double)corner[0], (double)corner[1], (double)corner[2],
                     (double)corner[3], (double)corner[4], (double)corner[5], (double)position[0],
                     (double)position[1], (double)position[2], (double)rest[0], (double)rest[1],
                     (double)rest[2]);
        }
    }
    return drawn;
}

static void check_watertight(gpu_variant variant, uint32_t seeds, bool windows) {
    const girih_catalogue *catalogue =
        variant.linear ? girih_catalogue_linear() : girih_catalogue_dyadic();
    girih_context *context = gpu_variant_context(&device, variant);
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    own_capture(&capture, &textures, OWN_NASTY);
    girih_plan *plans[3], *pieces[3] = {NULL};
    const uint32_t range = context->limits.maxStorageBufferRange;
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        const girih_plan_desc desc = plan_of(scene, program, (girih_mode)mode);
        plans[mode] = own_make_plan(context, desc);
        if (windows && mode != GIRIH_MODE_INSTANCED) {
            context->limits.maxStorageBufferRange = SMALL_RANGE;
            pieces[mode] = own_make_plan(context, desc);
            context->limits.maxStorageBufferRange = range;
            assert_true(plans[mode]->window_count == 1 && pieces[mode]->window_count > 5);
        }
    }
    gpu_readback read = {0}, again = {0};
    uint64_t closed = 0, open = 0, crowded = 0, triangles = 0;
    for (uint32_t seed = 1; seed <= seeds; ++seed) {
        const girih_frame frame = random_frame(seed);
        for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
            gpu_refine(&device, plans[mode], &frame, &read);
            const girih_statistics s = girih_plan_statistics(plans[mode]);
            assert_false(s.overflow);
            const edge_audit expected = expect_edges(catalogue, &read, s.output_triangles);
            assert_as_expected("positions", audit_read(plans[mode], &read), expected);
            closed += expected.edges;
            open += expected.open;
            crowded += expected.nonmanifold;
            if (mode == GIRIH_MODE_WELDED) {
                const uint32_t *list = read.words[GIRIH_BIND_OUT_CLOSED_INDICES];
                assert_as_expected("closed indices", audit_indices(list, s.output_triangles),
                                   expected);
                for (uint64_t n = 0; n < 3 * s.output_triangles; ++n) {
                    assert_memory_equal(own_position(&read, list[n]),
                                        own_position(&read, read.words[GIRIH_BIND_OUT_INDICES][n]),
                                        12);
                }
            }
            triangles +=
                assert_draws(&capture, plans[GIRIH_MODE_INSTANCED], &frame, plans[mode], &read);
            // Several invocations write one welded vertex: always the same bytes.
            gpu_refine(&device, plans[mode], &frame, &again);
            assert_same_outputs(plans[mode], &read, plans[mode], &again);
            if (pieces[mode]) {
                gpu_refine(&device, pieces[mode], &frame, &again);
                assert_same_outputs(plans[mode], &read, pieces[mode], &again);
            }
        }
    }
    printf("%llu triangles drawn and written alike: %llu edges closed, %llu open and %llu "
           "non-manifold as in the input\n",
           (unsigned long long)triangles, (unsigned long long)closed, (unsigned long long)open,
           (unsigned long long)crowded);
    assert_true(closed > 10000 * seeds && open > 50 * seeds && crowded > 50 * seeds);
    gpu_readback_free(&device, &read);
    gpu_readback_free(&device, &again);
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan_destroy(plans[mode]);
        girih_plan_destroy(pieces[mode]);
    }
    gpu_capture_close(&capture);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void watertight(void **state) {
    (void)state;
    check_watertight((gpu_variant){0}, 4, true);
}

static void watertight_with_few_buffers(void **state) {
    (void)state;
    check_watertight((gpu_variant){.few_buffers = 1}, 4, true);
}

static void watertight_with_the_linear_catalogue(void **state) {
    (void)state;
    check_watertight((gpu_variant){.linear = 1}, 4, false);
}

// Parts are evaluated in their roots, so that places on the input's edges still have their owners.
static void check_splits(gpu_variant variant) {
    const girih_catalogue *catalogue =
        variant.linear ? girih_catalogue_linear() : girih_catalogue_dyadic();
    girih_context *context = gpu_variant_context(&device, variant);
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    own_capture(&capture, &textures, OWN_NASTY);
    girih_plan *plans[2];
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_BAKED; ++mode) {
        girih_plan_desc desc = own_plan_of(scene, program, (girih_mode)mode, 900000);
        desc.max_segments = 100;
        desc.max_splits = 60000;
        plans[mode] = own_make_plan(context, desc);
    }
    gpu_readback read = {0};
    girih_frame frame = random_frame(11);
    frame.segments = variant.linear ? 40 : 100;
    gpu_refine(&device, plans[GIRIH_MODE_BAKED], &frame, &read);
    const girih_statistics s = girih_plan_statistics(plans[GIRIH_MODE_BAKED]);
    assert_false(s.overflow);
    assert_int_equal(s.clamped_edges, 0);
    assert_true(s.parts > 500);
    const edge_audit expected = expect_edges(catalogue, &read, s.output_triangles);
    assert_as_expected("split", audit_read(plans[GIRIH_MODE_BAKED], &read), expected);
    assert_draws(&capture, plans[GIRIH_MODE_INSTANCED], &frame, plans[GIRIH_MODE_BAKED], &read);
    gpu_readback_free(&device, &read);
    girih_plan_destroy(plans[GIRIH_MODE_INSTANCED]);
    girih_plan_destroy(plans[GIRIH_MODE_BAKED]);
    gpu_capture_close(&capture);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void watertight_beyond_the_catalogue(void **state) {
    (void)state;
    check_splits((gpu_variant){.linear = 1});
    check_splits((gpu_variant){.few_buffers = 1});
}

// The control: the same function cracks where each triangle evaluates its border itself.
static void apart_it_cracks(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY_APART, 1);
    girih_plan *plan = own_make_plan(context, plan_of(scene, program, GIRIH_MODE_BAKED));
    gpu_readback read = {0};
    const girih_frame frame = random_frame(1);
    gpu_refine(&device, plan, &frame, &read);
    const edge_audit audit = audit_read(plan, &read);
    const edge_audit expected =
        expect_edges(girih_catalogue_dyadic(), &read, girih_plan_statistics(plan).output_triangles);
    printf("apart: %llu open edges, %llu in the input\n", (unsigned long long)audit.open,
           (unsigned long long)expected.open);
    assert_false(is_as_expected(&audit, &expected));
    assert_true(audit.open > 10 * expected.open);
    gpu_readback_free(&device, &read);
    girih_plan_destroy(plan);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

// --- The previous frame -------------------------------------------------------------------------

// The previous positions stand after normal and attributes.
static const float *previous_of(const gpu_readback *read, uint32_t vertex) {
    return own_normal(read, vertex, 8) + 5;
}

// What moves was where a plan of instances that stand there puts it; what stands still was there.
static void check_previous(gpu_variant variant) {
    girih_context *context = gpu_variant_context(&device, variant);
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    own_capture(&capture, &textures, OWN_NASTY);
    const girih_frame frame = random_frame(9);
    gpu_readback before = {0}, now = {0};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan_desc desc = plan_of(scene, program, (girih_mode)mode);
        girih_plan *there = own_make_plan(context, desc);
        desc.outputs |= GIRIH_OUTPUT_PREVIOUS;
        girih_plan *moving = own_make_plan(context, desc);
        desc = plan_of(scene, program, GIRIH_MODE_INSTANCED);
        girih_plan *instanced = own_make_plan(context, desc);
        gpu_refine(&device, there, &frame, &before);
        assert_int_equal(girih_plan_get_buffers(moving).attribute_stride, 32);
        for (int moved = 0; moved < 2; ++moved) {
            for (uint32_t n = 0; moved && n < OWN_INSTANCES; n += 2) {
                float transform[12];
                memcpy(transform, own_instances[n].transform, sizeof transform);
                transform[3] += 0.7f;
                transform[4] *= 1.25f;
                girih_plan *const both[2] = {moving, instanced};
                for (int k = 0; k < 2; ++k) {
                    assert_int_equal(girih_plan_set_transform(both[k], n, transform,
                                                              own_instances[n].transform, NULL),
                                     GIRIH_OK);
                }
            }
            gpu_refine(&device, moving, &frame, &now);
            const girih_statistics s = girih_plan_statistics(moving);
            assert_int_equal(s.output_triangles, girih_plan_statistics(there).output_triangles);
            uint64_t elsewhere = 0;
            for (uint64_t n = 0; n < 3 * s.output_triangles; ++n) {
                const uint32_t vertex = now.words[GIRIH_BIND_OUT_INDICES][n];
                const uint32_t instance = now.words[GIRIH_BIND_OUT_SOURCES][n / 3 * 2];
                assert_memory_equal(previous_of(&now, vertex), own_position(&before, vertex), 12);
                const bool same =
                    memcmp(previous_of(&now, vertex), own_position(&now, vertex), 12) == 0;
                assert_int_equal(same, !moved || instance % 2 == 1);
                elsewhere += !same;
            }
            assert_true(moved ? elsewhere > 10000 : elsewhere == 0);
            // The same in the vertex shader.
            capture.previous = true;
            const uint32_t drawn = gpu_draw(&capture, instanced, &frame, ROOM);
            capture.previous = false;
            assert_int_equal(drawn, s.output_triangles);
            const float *corners = capture.corners.mapped;
            for (uint32_t n = 0; n < 3 * drawn; ++n) {
                const uint32_t vertex = now.words[GIRIH_BIND_OUT_INDICES][n];
                assert_memory_equal(corners + (size_t)n * GPU_CAPTURE_FLOATS,
                                    previous_of(&now, vertex), 12);
            }
        }
        girih_plan_destroy(there);
        girih_plan_destroy(moving);
        girih_plan_destroy(instanced);
    }
    gpu_readback_free(&device, &before);
    gpu_readback_free(&device, &now);
    gpu_capture_close(&capture);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void previous_positions(void **state) {
    (void)state;
    check_previous((gpu_variant){0});
    check_previous((gpu_variant){.linear = 1, .few_buffers = 1});
}

int main(void) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    textures = own_set_open(&device, settings);
    own_make_meshes(meshes);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identity),
        cmocka_unit_test(hard_edges_stay_hard),
        cmocka_unit_test(watertight),
        cmocka_unit_test(watertight_with_few_buffers),
        cmocka_unit_test(watertight_with_the_linear_catalogue),
        cmocka_unit_test(watertight_beyond_the_catalogue),
        cmocka_unit_test(apart_it_cracks),
        cmocka_unit_test(previous_positions),
    };
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    own_destroy_meshes(meshes);
    own_set_close(&device, &textures);
    const unsigned messages = gpu_close(&device);
    if (messages) {
        print_error("%u validation messages\n", messages);
    }
    return messages != 0;
}
