// What happens at the limits: outputs in windows, frames that do not fit, instances that move, and
// plans side by side.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
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

// Both plans drawn: the same triangles in the same order. Returns their number.
static uint32_t assert_same_draws(gpu_capture *capture, girih_plan *a, girih_plan *b,
                                  uint32_t room) {
    const uint32_t drawn = gpu_draw(capture, a, NULL, room);
    const size_t bytes = (size_t)drawn * 3 * GPU_CAPTURE_FLOATS * sizeof(float);
    void *corners = malloc(bytes + 1);
    assert_non_null(corners);
    memcpy(corners, capture->corners.mapped, bytes);
    assert_int_equal(gpu_draw(capture, b, NULL, room), drawn);
    assert_memory_equal(capture->corners.mapped, corners, bytes);
    free(corners);
    return drawn;
}

// A plan whose outputs need many windows writes and draws what one with a single window does.
static void check_windows(int few_buffers) {
    static const struct {
        girih_mode mode;
        uint32_t outputs;
    } kinds[4] = {{GIRIH_MODE_INSTANCED, 0},
                  {GIRIH_MODE_BAKED, 0},
                  {GIRIH_MODE_BAKED, GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES},
                  {GIRIH_MODE_WELDED, GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES}};
    const uint32_t room = 130000;
    girih_context *context =
        gpu_variant_context(&device, (gpu_variant){.few_buffers = few_buffers});
    const girih_mesh *mesh = make_seam_sphere(20, 14);
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    const uint32_t range = context->limits.maxStorageBufferRange;
    uint64_t compared = 0;
    uint64_t drawn = 0;
    uint32_t most_windows = 0;
    for (int n = 0; n < 8; ++n) {
        const girih_surface surface = n % 2 ? GIRIH_SURFACE_PN : GIRIH_SURFACE_FLAT;
        const girih_plan_desc desc =
            plan_of(scene, surface, kinds[n / 2].mode, kinds[n / 2].outputs, room);
        girih_plan *whole = make_plan(context, desc);
        // The plan's own arrays are small enough for this range; only the outputs are cut.
        context->limits.maxStorageBufferRange = SMALL_RANGE;
        girih_plan *pieces = make_plan(context, desc);
        context->limits.maxStorageBufferRange = range;
        assert_int_equal(whole->window_count, 1);
        most_windows = pieces->window_count > most_windows ? pieces->window_count : most_windows;
        gpu_readback a = {0};
        gpu_readback b = {0};
        for (uint32_t seed = 1; seed <= 3; ++seed) {
            const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = seed};
            if (seed == 3) { // does not fit any more
                whole->arrays.frame.max_triangles = pieces->arrays.frame.max_triangles = 1000;
            }
            gpu_refine(&device, whole, &frame, &a);
            gpu_refine(&device, pieces, &frame, &b);
            assert_int_equal(girih_plan_statistics(whole).overflow, seed == 3);
            compared += assert_same_outputs(whole, &a, pieces, &b);
            drawn += assert_same_draws(&capture, whole, pieces, room);
        }
        gpu_readback_free(&device, &a);
        gpu_readback_free(&device, &b);
        girih_plan_destroy(whole);
        girih_plan_destroy(pieces);
    }
    printf("%llu words compared, %llu triangles drawn, up to %u windows\n",
           (unsigned long long)compared, (unsigned long long)drawn, most_windows);
    assert_true(compared > 1000000);
    assert_true(drawn > 100000);
    assert_true(most_windows > 20);
    gpu_capture_close(&capture);
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

// More output than a storage buffer of 128 MiB shows, as a real frame: the CPU's words, in windows.
static void more_than_a_storage_buffer(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *mesh = make_torus(40, 40);
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    const girih_frame frame = {.rule = GIRIH_LEVEL_SEGMENTS, .segments = 64};
    const girih_cpu_desc cpu = {.meshes = &mesh,
                                .mesh_count = 1,
                                .instances = &once,
                                .instance_count = 1,
                                .surface = GIRIH_SURFACE_PN,
                                .mode = GIRIH_MODE_BAKED};
    girih_cpu_output expected;
    girih_error error;
    gpu_girih(girih_cpu_refine(&cpu, &frame, &expected, &error), &error);
    const uint64_t vertices = expected.statistics.output_vertices;
    const uint64_t triangles = expected.statistics.output_triangles;
    girih_plan_desc desc =
        plan_of(scene, GIRIH_SURFACE_PN, GIRIH_MODE_BAKED, GIRIH_OUTPUT_INDICES, 0);
    desc.max_vertices = (uint32_t)vertices;
    desc.max_triangles = (uint32_t)triangles;
    girih_plan *plan = make_plan(context, desc);
    gpu_readback read = {0};
    gpu_refine(&device, plan, &frame, &read);
    const girih_statistics got = girih_plan_statistics(plan);
    assert_false(got.overflow);
    assert_int_equal(got.output_vertices, vertices);
    assert_int_equal(got.output_triangles, triangles);
    const uint64_t attribute_bytes = vertices * 5 * sizeof(float);
    const uint64_t index_bytes = triangles * 3 * sizeof(uint32_t);
    printf("%llu vertices, attributes of %llu and indices of %llu bytes, %u and %u windows\n",
           (unsigned long long)vertices, (unsigned long long)attribute_bytes,
           (unsigned long long)index_bytes, plan->vertex_windows, plan->triangle_windows);
    assert_true(attribute_bytes > UINT64_C(128) << 20 && index_bytes > UINT64_C(128) << 20);
    assert_int_equal(memcmp(read.words[GIRIH_BIND_OUT_POSITIONS], expected.positions,
                            vertices * 3 * sizeof(float)),
                     0);
    assert_int_equal(memcmp(read.words[GIRIH_BIND_OUT_INDICES], expected.indices, index_bytes), 0);
    const float *attributes = (const float *)(const void *)read.words[GIRIH_BIND_OUT_ATTRIBUTES];
    float farthest = 0;
    for (uint64_t n = 0; n < vertices * 5; ++n) {
        const float apart = fabsf(attributes[n] - expected.attributes[n]);
        if (!(apart <= (n % 5 < 3 ? 3e-7f : 0.0f))) {
            fail_msg("float %llu of vertex %llu's attributes is %.9g, not %.9g",
                     (unsigned long long)(n % 5), (unsigned long long)(n / 5),
                     (double)attributes[n], (double)expected.attributes[n]);
        }
        farthest = apart > farthest ? apart : farthest;
    }
    printf("normals within %g\n", (double)farthest);
    gpu_readback_free(&device, &read);
    girih_cpu_output_free(&expected);
    girih_plan_destroy(plan);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_mesh_destroy(mesh);
}

// Refines and checks that what lies behind each output still holds what gpu_refine filled it with.
static girih_statistics refine_guarded(girih_plan *plan, gpu_readback *read, uint64_t *guards) {
    gpu_refine(&device, plan, &fine, read);
    const girih_statistics s = girih_plan_statistics(plan);
    const struct {
        uint32_t binding;
        VkDeviceSize size;
    } outputs[] = {{GIRIH_BIND_OUT_POSITIONS, plan->buffers[GIRIH_PLAN_POSITIONS].size},
                   {GIRIH_BIND_OUT_ATTRIBUTES, plan->buffers[GIRIH_PLAN_ATTRIBUTES].size},
                   {GIRIH_BIND_OUT_INDICES, plan->buffers[GIRIH_PLAN_INDICES].size},
                   {GIRIH_BIND_OUT_CLOSED_INDICES, plan->buffers[GIRIH_PLAN_CLOSED_INDICES].size},
                   {GIRIH_BIND_OUT_SOURCES, plan->buffers[GIRIH_PLAN_SOURCES].size}};
    for (size_t k = 0; k < sizeof outputs / sizeof *outputs; ++k) {
        const uint32_t *words = read->words[outputs[k].binding];
        if (!words) {
            continue;
        }
        for (uint64_t n = written(plan, outputs[k].binding, &s); n < outputs[k].size / 4; ++n) {
            if (words[n] != 0xa5a5a5a5u) {
                fail_msg("mode %d: word %llu of binding %u was written", (int)plan->mode,
                         (unsigned long long)n, outputs[k].binding);
            }
            ++*guards;
        }
    }
    return s;
}

// Room for exactly what a frame needs is enough, one less is an overflow, and neither writes a word
// too many. The buffers are larger than the room, so that such a word would be seen.
static void exact_room(void **state) {
    (void)state;
    const girih_mesh *mesh = make_seam_sphere(12, 8);
    uint64_t guards = 0;
    for (int few = 0; few < 2; ++few) {
        girih_context *context = gpu_variant_context(&device, (gpu_variant){.few_buffers = few});
        girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
        for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
            const uint32_t outputs =
                mode == GIRIH_MODE_WELDED  ? GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES
                : mode == GIRIH_MODE_BAKED ? GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES
                                           : 0;
            girih_plan *plan = make_plan(
                context, plan_of(scene, GIRIH_SURFACE_PN, (girih_mode)mode, outputs, 40000));
            girih_frame_block *frame = &plan->arrays.frame;
            gpu_readback read = {0};
            const girih_statistics all = refine_guarded(plan, &read, &guards);
            assert_false(all.overflow);
            frame->max_triangles = (uint32_t)all.output_triangles;
            if (mode != GIRIH_MODE_INSTANCED) {
                frame->max_vertices = (uint32_t)all.output_vertices;
            }
            assert_false(refine_guarded(plan, &read, &guards).overflow);
            for (int which = 0; which < (mode == GIRIH_MODE_INSTANCED ? 1 : 2); ++which) {
                uint32_t *room = which ? &frame->max_vertices : &frame->max_triangles;
                --*room;
                const girih_statistics s = refine_guarded(plan, &read, &guards);
                ++*room;
                assert_true(s.overflow);
                assert_int_equal(s.needed_triangles, all.output_triangles);
                assert_int_equal(s.needed_vertices, all.output_vertices);
                assert_int_equal(s.output_triangles, mesh->triangle_count);
                assert_int_equal(s.groups, 2); // one for each of the sphere's materials
            }
            gpu_readback_free(&device, &read);
            girih_plan_destroy(plan);
        }
        girih_scene_destroy(scene);
        girih_context_destroy(context);
    }
    girih_mesh_destroy(mesh);
    printf("%llu words behind the outputs untouched\n", (unsigned long long)guards);
    assert_true(guards > 100000);
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
    assert_int_equal(girih_plan_set_transform(other, 0, moved[0].transform, NULL, NULL), GIRIH_OK);
    assert_int_equal(girih_plan_set_transform(other, 2, moved[2].transform, NULL, NULL), GIRIH_OK);
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

// Two plans of one scene in two command buffers of one submission: each as when it runs alone.
static void plans_side_by_side(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *const meshes[3] = {make_seam_sphere(12, 8), make_nothing(), make_cube(1)};
    girih_scene *scene = gpu_scene(&device, context, meshes, 3);
    const girih_instance instances[4] = {
        {.mesh = 1, .transform = {1, 0, 0, 0, 0, 1}},
        {.mesh = 0, .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
        {.mesh = 1, .transform = {1, 0, 0, 0, 0, 1}},
        {.mesh = 2, .transform = {0, 1, 0, 3, 1, 0, 0, 0, 0, 0, 1}}};
    const girih_frame frames[2] = {{.rule = GIRIH_LEVEL_RANDOM, .segments = 11, .seed = 1}, fine};
    girih_plan *plans[2];
    gpu_readback alone[2] = {0};
    VkCommandBuffer commands[2];
    girih_error error;
    for (int n = 0; n < 2; ++n) {
        girih_plan_desc desc =
            plan_of(scene, n ? GIRIH_SURFACE_PN : GIRIH_SURFACE_FLAT,
                    n ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED, GIRIH_OUTPUT_INDICES, 60000);
        desc.instances = instances;
        desc.instance_count = 4;
        plans[n] = make_plan(context, desc);
        gpu_refine(&device, plans[n], &frames[n], &alone[n]);
        // Something else in between, so that what is read below was written below.
        commands[n] = gpu_begin(&device);
        gpu_girih(girih_cmd_refine(plans[n], commands[n], &(girih_frame){0}, NULL, &error), &error);
        gpu_run(&device, commands[n]);
    }
    for (int n = 0; n < 2; ++n) {
        commands[n] = gpu_begin(&device);
        gpu_girih(girih_cmd_refine(plans[n], commands[n], &frames[n], NULL, &error), &error);
        gpu_end(commands[n]);
    }
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .commandBufferCount = 2,
                                 .pCommandBuffers = commands};
    gpu_check(vkQueueSubmit(device.queue, 1, &submit, device.fence), "vkQueueSubmit");
    gpu_check(vkWaitForFences(device.device, 1, &device.fence, VK_TRUE, UINT64_MAX),
              "vkWaitForFences");
    gpu_check(vkResetFences(device.device, 1, &device.fence), "vkResetFences");
    vkFreeCommandBuffers(device.device, device.pool, 2, commands);
    for (int n = 0; n < 2; ++n) {
        const girih_statistics s = girih_plan_statistics(plans[n]);
        assert_true(s.output_triangles > 5000);
        const girih_plan_buffers buffers = girih_plan_get_buffers(plans[n]);
        const struct {
            uint32_t binding;
            girih_buffer_range range;
        } outputs[] = {{GIRIH_BIND_OUT_POSITIONS, buffers.positions},
                       {GIRIH_BIND_OUT_ATTRIBUTES, buffers.attributes},
                       {GIRIH_BIND_OUT_INDICES, buffers.indices}};
        for (size_t k = 0; k < sizeof outputs / sizeof *outputs; ++k) {
            const uint64_t bytes = 4 * written(plans[n], outputs[k].binding, &s);
            void *words =
                gpu_read(&device, outputs[k].range.buffer, outputs[k].range.offset, bytes);
            assert_memory_equal(words, alone[n].words[outputs[k].binding], bytes);
            free(words);
        }
        gpu_readback_free(&device, &alone[n]);
        girih_plan_destroy(plans[n]);
    }
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows),
        cmocka_unit_test(windows_with_few_buffers),
        cmocka_unit_test(more_than_a_storage_buffer),
        cmocka_unit_test(overflow_draws_level_0),
        cmocka_unit_test(exact_room),
        cmocka_unit_test(room_is_at_least_level_0),
        cmocka_unit_test(frames_repeat),
        cmocka_unit_test(plans_side_by_side),
        cmocka_unit_test(nothing_to_refine),
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
