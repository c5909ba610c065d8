// What happens at the limits: outputs in windows, frames that do not fit, features that are not
// there, instances that move, plans side by side, and calls that are wrong.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
#include "memory.h"
#include "meshes.h"
#include "stages.h"

#define SMALL_RANGE 65536u // bytes a storage buffer shows in the tests of windows

static gpu device;
static const girih_instance once = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
static const girih_frame fine = {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = 5};

static girih_plan *make_plan(const girih_context *context, girih_plan_desc desc) {
    girih_plan *plan = NULL;
    girih_error error = {0};
    if (girih_plan_create(context, &desc, &plan, &error) != GIRIH_OK) {
        fail_msg("%s", error.message);
    }
    return plan;
}

static girih_plan_desc plan_of(const girih_scene *scene, girih_surface surface, girih_mode mode,
                               uint32_t outputs, uint32_t room) {
    return (girih_plan_desc){.scene = scene,
                             .instances = &once,
                             .instance_count = 1,
                             .surface = surface,
                             .mode = mode,
                             .outputs = outputs,
                             .max_vertices = 3 * room,
                             .max_triangles = room};
}

// The words of an output that a frame has written.
static uint64_t written(const girih_plan *plan, uint32_t binding, const girih_statistics *s) {
    const uint32_t floats = 3 + plan->arrays.frame.attribute_floats;
    switch (binding) {
    case GIRIH_BIND_OUT_POSITIONS:
        return plan->mode == GIRIH_MODE_INSTANCED ? 0 : 3 * s->output_vertices;
    case GIRIH_BIND_OUT_ATTRIBUTES:
        if (plan->mode == GIRIH_MODE_INSTANCED) {
            return (s->input_triangles - s->culled_triangles) * (plan->surface == GIRIH_SURFACE_PN
                                                                     ? GIRIH_PATCH_WORDS_PN
                                                                     : GIRIH_PATCH_WORDS_FLAT);
        }
        return floats * s->output_vertices;
    case GIRIH_BIND_OUT_SOURCES:
        return 2 * s->output_triangles;
    default:
        return 3 * s->output_triangles;
    }
}

// Every output of two plans after the same frame, word for word. Returns the words compared.
static uint64_t assert_same_outputs(const girih_plan *a, const gpu_readback *read_a,
                                    const girih_plan *b, const gpu_readback *read_b) {
    const girih_statistics s = girih_plan_statistics(a);
    const girih_statistics t = girih_plan_statistics(b);
    assert_int_equal(s.output_triangles, t.output_triangles);
    assert_int_equal(s.output_vertices, t.output_vertices);
    assert_int_equal(s.culled_triangles, t.culled_triangles);
    assert_int_equal(s.groups, t.groups);
    assert_int_equal(s.overflow, t.overflow);
    uint64_t compared = 0;
    for (uint32_t n = GIRIH_BIND_OUT_POSITIONS; n < GIRIH_BIND_COUNT; ++n) {
        assert_int_equal(read_a->words[n] == NULL, read_b->words[n] == NULL);
        if (read_a->words[n]) {
            const uint64_t words = written(a, n, &s);
            assert_memory_equal(read_a->words[n], read_b->words[n], words * sizeof(uint32_t));
            compared += words;
        }
    }
    return compared;
}

// A plan whose outputs need many windows writes what one with a single window writes.
static void check_windows(int few_buffers) {
    girih_context *context =
        gpu_variant_context(&device, (gpu_variant){.few_buffers = few_buffers});
    const girih_mesh *mesh = make_seam_sphere(20, 14);
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    const uint32_t range = context->limits.maxStorageBufferRange;
    uint64_t compared = 0;
    uint32_t most_windows = 0;
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
            const uint32_t outputs =
                mode == GIRIH_MODE_WELDED  ? GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES
                : mode == GIRIH_MODE_BAKED ? GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES
                                           : 0;
            const girih_plan_desc desc =
                plan_of(scene, (girih_surface)surface, (girih_mode)mode, outputs, 130000);
            girih_plan *whole = make_plan(context, desc);
            // The plan's own arrays are small enough for this range; only the outputs are cut.
            context->limits.maxStorageBufferRange = SMALL_RANGE;
            girih_plan *pieces = NULL;
            girih_error error;
            gpu_girih(girih_plan_create(context, &desc, &pieces, &error), &error);
            context->limits.maxStorageBufferRange = range;
            assert_int_equal(whole->window_count, 1);
            most_windows =
                pieces->window_count > most_windows ? pieces->window_count : most_windows;
            gpu_readback a = {0};
            gpu_readback b = {0};
            for (uint32_t seed = 1; seed <= 3; ++seed) {
                const girih_frame frame = {
                    .rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = seed};
                gpu_refine(&device, whole, &frame, &a);
                gpu_refine(&device, pieces, &frame, &b);
                assert_false(girih_plan_statistics(whole).overflow);
                compared += assert_same_outputs(whole, &a, pieces, &b);
            }
            gpu_readback_free(&device, &a);
            gpu_readback_free(&device, &b);
            girih_plan_destroy(whole);
            girih_plan_destroy(pieces);
        }
    }
    printf("%llu words compared, up to %u windows\n", (unsigned long long)compared, most_windows);
    assert_true(compared > 1000000);
    assert_true(most_windows > 20);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_mesh_destroy(mesh);
}

static void windows(void **state) {
    (void)state;
    check_windows(0);
}

static void windows_with_few_buffers(void **state) {
    (void)state;
    check_windows(1);
}

// A frame that does not fit is drawn at level 0, says what it needs, and writes nothing past the
// end.
static void overflow_draws_level_0(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *mesh = make_seam_sphere(12, 8);
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        const girih_plan_desc roomy = plan_of(scene, GIRIH_SURFACE_PN, (girih_mode)mode, 0, 40000);
        girih_plan_desc tight = roomy;
        tight.max_triangles = mesh->triangle_count + 7;
        tight.max_vertices = 3 * mesh->triangle_count + 11;
        girih_plan *large = make_plan(context, roomy);
        girih_plan *small = make_plan(context, tight);
        gpu_readback read = {0};
        gpu_refine(&device, large, &fine, &read);
        const girih_statistics wanted = girih_plan_statistics(large);
        assert_false(wanted.overflow);
        gpu_refine(&device, small, &fine, &read);
        const girih_statistics got = girih_plan_statistics(small);
        assert_true(got.overflow);
        assert_int_equal(got.needed_triangles, wanted.output_triangles);
        assert_int_equal(got.needed_vertices, wanted.output_vertices);
        assert_int_equal(got.output_triangles, mesh->triangle_count);
        assert_int_equal(got.base_patterns, 1);
        if (mode != GIRIH_MODE_INSTANCED) {
            // What lies beyond the output still holds what gpu_refine filled it with.
            const uint64_t end = written(small, GIRIH_BIND_OUT_POSITIONS, &got);
            for (uint64_t n = end; n < 3 * (uint64_t)tight.max_vertices; ++n) {
                assert_int_equal(read.words[GIRIH_BIND_OUT_POSITIONS][n], 0xa5a5a5a5u);
            }
        }
        // Drawn, it is the input: every triangle once, with the winding kept.
        const uint32_t drawn = gpu_draw(&capture, small, &fine, 40000);
        assert_int_equal(drawn, mesh->triangle_count);
        double area = 0, expected = 0;
        const float *corners = capture.corners.mapped;
        for (uint32_t n = 0; n < drawn; ++n) {
            double sum[2] = {0, 0};
            for (int which = 0; which < 2; ++which) {
                double v[3][3];
                for (uint32_t k = 0; k < 3; ++k) {
                    const float *p =
                        which ? mesh->positions + 3 * (size_t)mesh->triangle_vertices[3 * n + k]
                              : corners + GPU_CAPTURE_FLOATS * (size_t)(3 * n + k);
                    for (int axis = 0; axis < 3; ++axis) {
                        v[k][axis] = (double)p[axis];
                    }
                }
                sum[which] = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                             v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                             v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
            }
            area += sum[0];
            expected += sum[1];
        }
        assert_true(fabs(area - expected) < 1e-6 * expected); // six times the volume, signed
        gpu_readback_free(&device, &read);
        girih_plan_destroy(large);
        girih_plan_destroy(small);
    }
    gpu_capture_close(&capture);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_mesh_destroy(mesh);
}

// Room below the level-0 output is raised to it, so that no frame can leave a hole.
static void room_is_at_least_level_0(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *mesh = make_torus(8, 6);
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan_desc desc = plan_of(scene, GIRIH_SURFACE_FLAT, (girih_mode)mode, 0, 0);
        desc.max_vertices = 1;
        girih_plan *plan = make_plan(context, desc);
        const girih_plan_buffers buffers = girih_plan_get_buffers(plan);
        assert_true(buffers.max_triangles >= mesh->triangle_count);
        gpu_readback read = {0};
        gpu_refine(&device, plan, &(girih_frame){0}, &read);
        assert_false(girih_plan_statistics(plan).overflow);
        assert_int_equal(girih_plan_statistics(plan).output_triangles, mesh->triangle_count);
        gpu_readback_free(&device, &read);
        girih_plan_destroy(plan);
    }
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_mesh_destroy(mesh);
}

// The same input gives the same bytes, in one plan and in another; a moved instance gives what a
// plan that was made there gives; two plans submitted together do not disturb each other.
static void frames_repeat(void **state) {
    (void)state;
    girih_context *context =
        gpu_variant_context(&device, (gpu_variant){.sort = GIRIH_SORT_WORKGROUP});
    const girih_mesh *const meshes[3] = {make_torus(8, 6), make_nothing(), make_cube(1)};
    girih_scene *scene = gpu_scene(&device, context, meshes, 3);
    girih_instance moved[4] = {once, once, once, once};
    for (uint32_t n = 0; n < 4; ++n) {
        moved[n].mesh = n % 3;
        moved[n].transform[0] = n == 2 ? -1.5f : 1.0f;
        moved[n].transform[3] = (float)n;
    }
    girih_instance before[4];
    memcpy(before, moved, sizeof before);
    before[0].transform[3] = 9;
    before[2].transform[7] = -4;
    girih_plan_desc desc = plan_of(scene, GIRIH_SURFACE_PN, GIRIH_MODE_BAKED,
                                   GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES, 60000);
    desc.instance_count = 4;
    desc.instances = moved;
    girih_plan *there = make_plan(context, desc);
    desc.instances = before;
    girih_plan *other = make_plan(context, desc);
    gpu_readback a = {0};
    gpu_readback b = {0};
    gpu_refine(&device, other, &fine, &b);
    assert_int_equal(girih_plan_set_transform(other, 0, moved[0].transform), GIRIH_OK);
    assert_int_equal(girih_plan_set_transform(other, 2, moved[2].transform), GIRIH_OK);
    for (int turn = 0; turn < 2; ++turn) {
        gpu_refine(&device, there, &fine, &a);
        gpu_refine(&device, other, &fine, &b);
        assert_true(assert_same_outputs(there, &a, other, &b) > 10000);
    }
    // Both recorded before either runs.
    VkCommandBuffer first = gpu_begin(&device);
    VkCommandBuffer second = gpu_begin(&device);
    girih_error error;
    const girih_frame coarse = {.rule = GIRIH_LEVEL_SEGMENTS, .segments = 3};
    gpu_girih(girih_cmd_refine(there, first, &coarse, NULL, &error), &error);
    gpu_girih(girih_cmd_refine(other, second, &fine, NULL, &error), &error);
    gpu_run(&device, second);
    gpu_run(&device, first);
    const girih_statistics s = girih_plan_statistics(there);
    assert_int_equal(s.output_triangles, 16 * s.input_triangles); // dyadic: 3 segments become 4
    assert_true(girih_plan_statistics(other).output_triangles > s.output_triangles);
    gpu_readback_free(&device, &a);
    gpu_readback_free(&device, &b);
    girih_plan_destroy(there);
    girih_plan_destroy(other);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    for (int n = 0; n < 3; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
}

// No instance at all: everything runs and nothing comes out.
static void nothing_to_refine(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, NULL, 0);
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan_desc desc = plan_of(scene, GIRIH_SURFACE_PN, (girih_mode)mode, 0, 0);
        desc.instance_count = 0;
        girih_plan *plan = make_plan(context, desc);
        gpu_readback read = {0};
        gpu_refine(&device, plan, &fine, &read);
        assert_int_equal(girih_plan_statistics(plan).output_triangles, 0);
        gpu_readback_free(&device, &read);
        girih_plan_destroy(plan);
    }
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void assert_refused(girih_result result, girih_result expected, girih_error *error) {
    assert_int_equal(result, expected);
    assert_int_equal(error->result, expected);
    assert_true(strlen(error->message) > 10);
    assert_null(strchr(error->message, '\n'));
    *error = (girih_error){0};
}

static void wrong_calls_are_refused(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    girih_context *other = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *mesh = make_triangle();
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    girih_error error = {0};
    girih_plan *plan = NULL;
    girih_context *none = NULL;
    const girih_result invalid = GIRIH_ERROR_INVALID_ARGUMENT;
    assert_refused(girih_context_create(&(girih_context_desc){0}, &none, &error), invalid, &error);
    girih_scene *nowhere = NULL;
    assert_refused(girih_scene_create(context, NULL, 1, &nowhere, &error), invalid, &error);
    const girih_mesh *missing = NULL;
    assert_refused(girih_scene_create(context, &missing, 1, &nowhere, &error), invalid, &error);
    girih_plan_desc desc = plan_of(scene, GIRIH_SURFACE_PN, GIRIH_MODE_BAKED, 0, 10);
    girih_plan_desc wrong = desc;
    wrong.scene = NULL;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, &error);
    assert_refused(girih_plan_create(other, &desc, &plan, &error), invalid, &error);
    wrong = desc;
    wrong.surface = (girih_surface)9;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, &error);
    wrong = desc;
    wrong.mode = (girih_mode)9;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, &error);
    wrong = desc;
    wrong.outputs = GIRIH_OUTPUT_CLOSED_INDICES;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, &error);
    wrong = desc;
    wrong.max_triangles = UINT32_MAX;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), GIRIH_ERROR_TOO_LARGE,
                   &error);
    girih_instance far = once;
    far.transform[3] = INFINITY;
    wrong = desc;
    wrong.instances = &far;
    assert_int_not_equal(girih_plan_create(context, &wrong, &plan, &error), GIRIH_OK);
    assert_true(strlen(error.message) > 10);
    desc.mode = GIRIH_MODE_WELDED;
    desc.outputs = GIRIH_OUTPUT_CLOSED_INDICES;
    plan = make_plan(context, desc);
    VkCommandBuffer commands = gpu_begin(&device);
    error = (girih_error){0};
    assert_refused(girih_cmd_refine(plan, commands, NULL, NULL, &error), invalid, &error);
    const girih_frame culled = {.cull_back = 1};
    assert_refused(girih_cmd_refine(plan, commands, &culled, NULL, &error), invalid, &error);
    const girih_frame mad = {.rule = GIRIH_LEVEL_EDGE_LENGTH, .length = NAN};
    assert_refused(girih_cmd_refine(plan, commands, &mad, NULL, &error), invalid, &error);
    gpu_run(&device, commands);
    assert_int_not_equal(girih_plan_set_transform(plan, 1, once.transform), GIRIH_OK);
    assert_int_not_equal(girih_plan_set_transform(plan, 0, far.transform), GIRIH_OK);
    girih_plan_destroy(plan);
    girih_plan_destroy(NULL);
    girih_scene_destroy(scene);
    girih_scene_destroy(NULL);
    girih_context_destroy(context);
    girih_context_destroy(other);
    girih_context_destroy(NULL);
    girih_mesh_destroy(mesh);
}

// Every allocation of girih's own made to fail in turn.
static void allocation_failures_are_reported(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *mesh = make_cube(1);
    uint32_t failures = 0;
    for (size_t allowed = 0;; ++allowed) {
        girih_error error = {0};
        girih_scene *scene = NULL;
        girih_plan *plan = NULL;
        girih_allocation_failure_after(allowed);
        girih_result result = girih_scene_create(context, &mesh, 1, &scene, &error);
        if (result == GIRIH_OK) {
            const girih_plan_desc desc =
                plan_of(scene, GIRIH_SURFACE_PN, GIRIH_MODE_BAKED, 0, 1000);
            result = girih_plan_create(context, &desc, &plan, &error);
        }
        girih_allocation_failure_after(SIZE_MAX);
        girih_plan_destroy(plan);
        girih_scene_destroy(scene);
        if (result == GIRIH_OK) {
            break;
        }
        assert_int_equal(result, GIRIH_ERROR_OUT_OF_MEMORY);
        assert_true(strlen(error.message) > 5);
        ++failures;
    }
    printf("%u allocations made to fail\n", failures);
    assert_true(failures > 10);
    girih_context_destroy(context);
    girih_mesh_destroy(mesh);
}

// A device without optional features bakes, and says so where it is asked to draw instances.
static void features_masked_off(void **state) {
    (void)state;
    gpu bare;
    gpu_open(&bare, NULL, true);
    girih_context *context = gpu_variant_context(&bare, (gpu_variant){0});
    girih_context *full = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *mesh = make_torus(8, 6);
    girih_scene *scene = gpu_scene(&bare, context, &mesh, 1);
    girih_scene *full_scene = gpu_scene(&device, full, &mesh, 1);
    girih_error error = {0};
    girih_plan *plan = NULL;
    girih_plan_desc desc = plan_of(scene, GIRIH_SURFACE_PN, GIRIH_MODE_INSTANCED, 0, 40000);
    assert_refused(girih_plan_create(context, &desc, &plan, &error), GIRIH_ERROR_UNSUPPORTED,
                   &error);
    gpu_capture capture = gpu_capture_open(&bare, context);
    gpu_capture full_capture = gpu_capture_open(&device, full);
    girih_plan_desc full_desc =
        plan_of(full_scene, GIRIH_SURFACE_PN, GIRIH_MODE_INSTANCED, 0, 40000);
    girih_plan *instanced = make_plan(full, full_desc);
    const uint32_t expected = gpu_draw(&full_capture, instanced, &fine, 40000);
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        desc.mode = (girih_mode)mode;
        plan = make_plan(context, desc);
        assert_int_equal(gpu_draw(&capture, plan, &fine, 40000), expected);
        assert_memory_equal(capture.corners.mapped, full_capture.corners.mapped,
                            (size_t)expected * 3 * GPU_CAPTURE_FLOATS * sizeof(float));
        girih_plan_destroy(plan);
    }
    girih_plan_destroy(instanced);
    gpu_capture_close(&capture);
    gpu_capture_close(&full_capture);
    girih_scene_destroy(scene);
    girih_scene_destroy(full_scene);
    girih_context_destroy(context);
    girih_context_destroy(full);
    girih_mesh_destroy(mesh);
    assert_int_equal(gpu_close(&bare), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows),
        cmocka_unit_test(windows_with_few_buffers),
        cmocka_unit_test(overflow_draws_level_0),
        cmocka_unit_test(room_is_at_least_level_0),
        cmocka_unit_test(frames_repeat),
        cmocka_unit_test(nothing_to_refine),
        cmocka_unit_test(wrong_calls_are_refused),
        cmocka_unit_test(allocation_failures_are_reported),
        cmocka_unit_test(features_masked_off),
    };
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    const unsigned messages = gpu_close(&device);
    if (messages) {
        fprintf(stderr, "%u validation messages\n", messages);
    }
    return failed || messages ? 1 : 0;
}
