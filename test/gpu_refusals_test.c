// What girih refuses, and says so: wrong calls, allocations that fail, features that are not there,
// more groups than can be counted. And the modes it chooses, none of which it refuses.
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
    assert_refused(girih_scene_create(context, NULL, &nowhere, &error), invalid, &error);
    const girih_mesh *missing = NULL;
    const girih_scene_desc without = {.meshes = &missing, .mesh_count = 1};
    assert_refused(girih_scene_create(context, &without, &nowhere, &error), invalid, &error);
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
    wrong.mode = GIRIH_MODE_INSTANCED;
    wrong.outputs = GIRIH_OUTPUT_SOURCES;
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
    assert_refused(girih_plan_set_transform(plan, 1, once.transform, NULL, &error), invalid,
                   &error);
    assert_refused(girih_plan_set_transform(plan, 0, far.transform, NULL, &error),
                   GIRIH_ERROR_INVALID_DATA, &error);
    assert_refused(girih_plan_set_transform(plan, 0, once.transform, far.transform, &error),
                   GIRIH_ERROR_INVALID_DATA, &error);
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
        girih_result result = girih_scene_create(
            context, &(girih_scene_desc){.meshes = &mesh, .mesh_count = 1}, &scene, &error);
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
    girih_context_destroy(context);
    // The context too; its own allocations all come before its pipelines, which take the time.
    uint32_t context_failures = 0;
    for (size_t allowed = 0;; ++allowed) {
        const girih_context_desc desc = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                                         .instance = device.instance,
                                         .physical_device = device.physical_device,
                                         .device = device.device,
                                         .few_buffers = allowed % 2};
        girih_error error = {0};
        context = NULL;
        girih_allocation_failure_after(allowed);
        const girih_result result = girih_context_create(&desc, &context, &error);
        girih_allocation_failure_after(SIZE_MAX);
        girih_context_destroy(context);
        if (result == GIRIH_OK) {
            break;
        }
        assert_refused(result, GIRIH_ERROR_OUT_OF_MEMORY, &error);
        ++context_failures;
    }
    printf("%u and %u allocations made to fail\n", failures, context_failures);
    assert_true(failures > 10 && context_failures > 2);
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

// A million groups, materials times pattern ranges, are what a CPU device's loops can count.
static void groups_are_limited(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){.linear = 1});
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t indices[3] = {0, 1, 2};
    const uint32_t ranges = 1376; // of linear 1..16
    const bool is_cpu = device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    for (uint32_t over = 0; over < 2; ++over) {
        const girih_submesh submesh = {.index_count = 3,
                                       .material = (1u << 20) / ranges - 1 + over};
        const girih_mesh_desc desc = {.name = "materials",
                                      .vertex_count = 3,
                                      .positions = positions,
                                      .indices = indices,
                                      .index_count = 3,
                                      .submeshes = &submesh,
                                      .submesh_count = 1,
                                      .missing_normals = GIRIH_NORMALS_FLAT};
        const girih_mesh *mesh;
        girih_error error = {0};
        assert_int_equal(girih_mesh_create(&desc, &mesh, &error), GIRIH_OK);
        girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
        const girih_plan_desc wanted =
            plan_of(scene, GIRIH_SURFACE_FLAT, GIRIH_MODE_WELDED, 0, 100);
        girih_plan *plan = NULL;
        const girih_result result = girih_plan_create(context, &wanted, &plan, &error);
        if (over && is_cpu) {
            assert_refused(result, GIRIH_ERROR_TOO_LARGE, &error);
        } else {
            assert_int_equal(result, GIRIH_OK);
        }
        girih_plan_destroy(plan);
        girih_scene_destroy(scene);
        girih_mesh_destroy(mesh);
    }
    girih_context_destroy(context);
}

// Whatever is asked for, the mode chosen can give it. On CPU devices 24 output triangles for each
// input triangle part the modes; elsewhere it is instanced wherever that can be.
static void modes_are_chosen(void **state) {
    (void)state;
    gpu bare;
    gpu_open(&bare, NULL, true);
    gpu *const hosts[2] = {&device, &bare};
    const bool is_cpu = device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    const girih_mesh *mesh = make_torus(8, 6);
    const girih_instance twice[2] = {once, once};
    const uint64_t border = 24 * 2 * (uint64_t)mesh->triangle_count;
    for (int host = 0; host < 2; ++host) {
        girih_context *context = gpu_variant_context(hosts[host], (gpu_variant){0});
        girih_scene *scene = gpu_scene(hosts[host], context, &mesh, 1);
        girih_plan_desc desc = plan_of(scene, GIRIH_SURFACE_PN, GIRIH_MODE_INSTANCED, 0, 40000);
        desc.instances = twice;
        desc.instance_count = 2;
        const bool can_instance = host == 0 && device.features.multiDrawIndirect &&
                                  device.features.drawIndirectFirstInstance;
        const girih_mode large = can_instance ? GIRIH_MODE_INSTANCED : GIRIH_MODE_BAKED;
        const girih_mode small = is_cpu ? GIRIH_MODE_BAKED : large;
        assert_int_equal(girih_choose_mode(context, &desc, 0), small);
        assert_int_equal(girih_choose_mode(context, &desc, border - 1), small);
        assert_int_equal(girih_choose_mode(context, &desc, border), large);
        assert_int_equal(girih_choose_mode(context, &desc, UINT64_MAX), large);
        for (uint32_t outputs = 0; outputs < 64; ++outputs) {
            if (outputs & GIRIH_OUTPUT_PREVIOUS) {
                continue; // of own surfaces alone
            }
            desc.outputs = outputs;
            desc.mode = girih_choose_mode(context, &desc, border);
            assert_int_equal(desc.mode, outputs & GIRIH_OUTPUT_CLOSED_INDICES ? GIRIH_MODE_WELDED
                                        : outputs                             ? GIRIH_MODE_BAKED
                                                                              : large);
            girih_plan_destroy(make_plan(context, desc));
        }
        desc.outputs = 0;
        assert_int_equal(girih_choose_mode(NULL, &desc, border), GIRIH_MODE_BAKED);
        assert_int_equal(girih_choose_mode(context, NULL, border), GIRIH_MODE_BAKED);
        girih_scene_destroy(scene);
        girih_context_destroy(context);
    }
    girih_mesh_destroy(mesh);
    assert_int_equal(gpu_close(&bare), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_calls_are_refused),
        cmocka_unit_test(allocation_failures_are_reported),
        cmocka_unit_test(features_masked_off),
        cmocka_unit_test(groups_are_limited),
        cmocka_unit_test(modes_are_chosen),
    };
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    device.share_pipelines = true;
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    const unsigned messages = gpu_close(&device);
    if (messages) {
        fprintf(stderr, "%u validation messages\n", messages);
    }
    return messages != 0;
}
