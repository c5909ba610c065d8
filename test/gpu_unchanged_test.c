// Unchanged input is not redone, whatever has changed is; and padded index lists, which a host
// draws by a count known beforehand.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "own_surfaces.h"

#define ROOM 60000u        // output triangles
#define POISON 0xa5a5a5a5u // as gpu_refine fills outputs
#define OUTPUTS 5          // positions, attributes, indices, closed indices, sources
#define SMALL_RANGE 65536u // bytes a storage buffer shows in the test of windows

static gpu device;
static own_set textures, other_textures;
static const own_settings settings = {.height = 0.05f, .phase = 0.3f};
static const own_settings other_settings = {.height = 0.02f, .phase = 0.1f};
static const girih_mesh *meshes[OWN_MESHES];

static girih_frame first_frame(void) {
    return (girih_frame){.rule = GIRIH_LEVEL_EDGE_PIXELS,
                         .segments = 16,
                         .length = 30,
                         .pixels_per_unit = 400,
                         .near_distance = 0.1f,
                         .eye = {1, -9, 3},
                         .surface_set = textures.set};
}

// --- What a plan records ------------------------------------------------------------------------

static uint32_t recorded; // commands since it was last set to 0

#define COUNTED(name, parameters, arguments)                                                       \
    static VKAPI_ATTR void VKAPI_CALL count_##name parameters {                                    \
        ++recorded;                                                                                \
        vk##name arguments;                                                                        \
    }

COUNTED(CmdBindPipeline, (VkCommandBuffer c, VkPipelineBindPoint point, VkPipeline pipeline),
        (c, point, pipeline))
COUNTED(CmdBindDescriptorSets,
        (VkCommandBuffer c, VkPipelineBindPoint point, VkPipelineLayout layout, uint32_t first,
         uint32_t count, const VkDescriptorSet *sets, uint32_t offset_count,
         const uint32_t *offsets),
        (c, point, layout, first, count, sets, offset_count, offsets))
COUNTED(CmdCopyBuffer,
        (VkCommandBuffer c, VkBuffer from, VkBuffer to, uint32_t count, const VkBufferCopy *copies),
        (c, from, to, count, copies))
COUNTED(CmdDispatch, (VkCommandBuffer c, uint32_t x, uint32_t y, uint32_t z), (c, x, y, z))
COUNTED(CmdDispatchIndirect, (VkCommandBuffer c, VkBuffer buffer, VkDeviceSize offset),
        (c, buffer, offset))
COUNTED(CmdFillBuffer,
        (VkCommandBuffer c, VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size, uint32_t word),
        (c, buffer, offset, size, word))
COUNTED(CmdUpdateBuffer,
        (VkCommandBuffer c, VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size,
         const void *bytes),
        (c, buffer, offset, size, bytes))
COUNTED(CmdPipelineBarrier,
        (VkCommandBuffer c, VkPipelineStageFlags from, VkPipelineStageFlags to,
         VkDependencyFlags flags, uint32_t count, const VkMemoryBarrier *barriers,
         uint32_t buffer_count, const VkBufferMemoryBarrier *buffers, uint32_t image_count,
         const VkImageMemoryBarrier *images),
        (c, from, to, flags, count, barriers, buffer_count, buffers, image_count, images))
COUNTED(CmdPushConstants,
        (VkCommandBuffer c, VkPipelineLayout layout, VkShaderStageFlags stages, uint32_t offset,
         uint32_t size, const void *bytes),
        (c, layout, stages, offset, size, bytes))
COUNTED(CmdWriteTimestamp,
        (VkCommandBuffer c, VkPipelineStageFlagBits stage, VkQueryPool pool, uint32_t query),
        (c, stage, pool, query))

static girih_context *counted_context(gpu_variant variant) {
    girih_context *context = gpu_variant_context(&device, variant);
    girih_functions *vk = &context->vk;
    vk->CmdBindPipeline = count_CmdBindPipeline;
    vk->CmdBindDescriptorSets = count_CmdBindDescriptorSets;
    vk->CmdCopyBuffer = count_CmdCopyBuffer;
    vk->CmdDispatch = count_CmdDispatch;
    vk->CmdDispatchIndirect = count_CmdDispatchIndirect;
    vk->CmdFillBuffer = count_CmdFillBuffer;
    vk->CmdUpdateBuffer = count_CmdUpdateBuffer;
    vk->CmdPipelineBarrier = count_CmdPipelineBarrier;
    vk->CmdPushConstants = count_CmdPushConstants;
    vk->CmdWriteTimestamp = count_CmdWriteTimestamp;
    return context;
}

// --- What a plan wrote --------------------------------------------------------------------------

// Fills the outputs, then refines. Returns the number of commands that girih recorded.
static uint32_t refine_poisoned(girih_plan *plan, const girih_frame *frame) {
    VkCommandBuffer commands = gpu_begin(&device);
    const VkMemoryBarrier before = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                    .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &before, 0, NULL, 0, NULL);
    for (uint32_t n = 0; n < OUTPUTS; ++n) {
        const girih_buffer *output = &plan->buffers[GIRIH_PLAN_POSITIONS + n];
        if (output->buffer) {
            vkCmdFillBuffer(commands, output->buffer, output->offset, output->size, POISON);
        }
    }
    girih_error error = {GIRIH_OK, ""};
    recorded = 0;
    gpu_girih(girih_cmd_refine(plan, commands, frame, NULL, &error), &error);
    const uint32_t count = recorded;
    gpu_run(&device, commands);
    return count;
}

static void assert_poisoned(const girih_plan *plan) {
    for (uint32_t n = 0; n < OUTPUTS; ++n) {
        const girih_buffer *output = &plan->buffers[GIRIH_PLAN_POSITIONS + n];
        uint32_t *words = gpu_read(&device, output->buffer, output->offset, output->size);
        for (VkDeviceSize k = 0; k < output->size / 4; ++k) {
            assert_int_equal(words[k], POISON);
        }
        free(words);
    }
}

// The same, word for word, as a plan that is new to this frame writes.
static void assert_as_new(const girih_context *context, girih_plan *plan,
                          const girih_plan_desc *desc, const girih_frame *frame) {
    girih_plan *other = own_make_plan(context, *desc);
    gpu_readback read = {0};
    gpu_refine(&device, other, frame, &read);
    assert_false(girih_plan_statistics(other).overflow);
    assert_int_equal(girih_plan_statistics(plan).output_triangles,
                     girih_plan_statistics(other).output_triangles);
    for (uint32_t n = 0; n < OUTPUTS; ++n) {
        const girih_buffer *output = &plan->buffers[GIRIH_PLAN_POSITIONS + n];
        if (output->buffer) {
            uint32_t *words = gpu_read(&device, output->buffer, output->offset, output->size);
            assert_memory_equal(words, read.words[GIRIH_BIND_OUT_POSITIONS + n], output->size);
            free(words);
        }
    }
    gpu_readback_free(&device, &read);
    girih_plan_destroy(other);
}

// --- Unchanged and changed ----------------------------------------------------------------------

// What may change between two frames.
typedef enum change {
    EYE,
    RULE,
    SEED,
    SEGMENTS,
    PLANES,
    REVISION,
    SET,
    TEXTURE, // behind the set, with a new revision
    TRANSFORM,
    INVALIDATE,
    CHANGES
} change;

// Changes the frame, the plan, and for a new plan its instances. False: it does not concern the
// plan.
static bool make_change(change what, girih_plan *plan, girih_frame *frame,
                        girih_instance moved[OWN_INSTANCES]) {
    switch (what) {
    case EYE:
        frame->eye[1] = -14;
        break;
    case RULE:
        frame->rule = GIRIH_LEVEL_RANDOM;
        break;
    case SEED:
        frame->seed = 5;
        break;
    case SEGMENTS:
        frame->segments = 9;
        break;
    case PLANES:
        if (plan->mode == GIRIH_MODE_WELDED) {
            return false; // closed indices are never culled
        }
        frame->cull_frustum = 1;
        for (int plane = 0; plane < 6; ++plane) {
            frame->planes[plane][plane % 3] = 1;
            frame->planes[plane][3] = 1;
        }
        break;
    case REVISION:
        ++frame->revision;
        break;
    case SET:
        frame->surface_set = other_textures.set;
        break;
    case TEXTURE:
        own_set_write(&other_textures, settings);
        ++frame->revision;
        break;
    case TRANSFORM:
        moved[2].transform[3] = -1;
        assert_int_equal(girih_plan_set_transform(plan, 2, moved[2].transform, NULL, NULL),
                         GIRIH_OK);
        break;
    default:
        girih_plan_invalidate(plan);
        break;
    }
    return true;
}

// Baked and welded: what is not redone leaves the outputs as they were found.
static void check_changes(const girih_context *context, girih_plan_desc desc) {
    girih_instance moved[OWN_INSTANCES];
    memcpy(moved, own_instances, sizeof moved);
    desc.instances = moved;
    girih_plan *plan = own_make_plan(context, desc);
    girih_frame frame = first_frame();
    own_set_write(&other_textures, other_settings);
    assert_true(refine_poisoned(plan, &frame) > 20);
    assert_as_new(context, plan, &desc, &frame);
    for (change what = EYE; what < CHANGES; ++what) {
        const girih_statistics before = girih_plan_statistics(plan);
        assert_int_equal(refine_poisoned(plan, &frame), 0);
        assert_poisoned(plan);
        const girih_statistics after = girih_plan_statistics(plan);
        assert_memory_equal(&before, &after, offsetof(girih_statistics, overflow));
        assert_int_equal(before.overflow, after.overflow);
        if (!make_change(what, plan, &frame, moved)) {
            continue;
        }
        assert_true(refine_poisoned(plan, &frame) > 20);
        assert_as_new(context, plan, &desc, &frame);
    }
    // A frame that is refused changes nothing.
    girih_frame wrong = frame;
    wrong.length = -1;
    wrong.rule = GIRIH_LEVEL_EDGE_LENGTH;
    VkCommandBuffer commands = gpu_begin(&device);
    recorded = 0;
    assert_int_equal(girih_cmd_refine(plan, commands, &wrong, NULL, NULL),
                     GIRIH_ERROR_INVALID_ARGUMENT);
    assert_int_equal(recorded, 0);
    gpu_run(&device, commands);
    assert_int_equal(refine_poisoned(plan, &frame), 0);
    assert_poisoned(plan);
    girih_plan_destroy(plan);
}

static void changes_are_redone(void **state) {
    (void)state;
    for (int few = 0; few < 2; ++few) {
        girih_context *context = counted_context((gpu_variant){.few_buffers = few});
        girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
        girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
        for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
            check_changes(context, own_plan_of(scene, program, (girih_mode)mode, ROOM));
            if (!few) {
                check_changes(context, own_plan_of(scene, NULL, (girih_mode)mode, ROOM));
            }
        }
        girih_surface_program_destroy(program);
        girih_scene_destroy(scene);
        girih_context_destroy(context);
    }
}

// One instance: its record is in the uniform block, not in the buffer of the others'.
static void one_instance_moves(void **state) {
    (void)state;
    girih_context *context = counted_context((gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_instance moved = own_instances[2];
    girih_plan_desc desc = own_plan_of(scene, NULL, GIRIH_MODE_BAKED, ROOM);
    desc.instances = &moved;
    desc.instance_count = 1;
    girih_plan *plan = own_make_plan(context, desc);
    const girih_frame frame = first_frame();
    for (int turn = 0; turn < 3; ++turn) {
        assert_true(refine_poisoned(plan, &frame) > 10);
        assert_as_new(context, plan, &desc, &frame);
        assert_int_equal(refine_poisoned(plan, &frame), 0);
        assert_poisoned(plan);
        moved.transform[7] += 1;
        assert_int_equal(girih_plan_set_transform(plan, 0, moved.transform, NULL, NULL), GIRIH_OK);
    }
    girih_plan_destroy(plan);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

// Draws of a frame that was not redone are the draws of the frame that was, in every mode.
static void draws_stay(void **state) {
    (void)state;
    girih_context *context = counted_context((gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    own_capture(&capture, &textures, OWN_NASTY);
    for (int n = 0; n < 6; ++n) {
        girih_plan *plan = own_make_plan(
            context, own_plan_of(scene, n < 3 ? program : NULL, (girih_mode)(n % 3), ROOM));
        girih_frame frame = first_frame();
        uint32_t counts[3];
        size_t bytes = 0;
        void *corners = NULL;
        for (int turn = 0; turn < 4; ++turn) {
            frame.eye[1] = turn == 3 ? -30.0f : -9.0f;
            // The draw's own commands are counted too: what refining adds shows against turn 1.
            recorded = 0;
            const uint32_t drawn = gpu_draw(&capture, plan, &frame, ROOM);
            if (turn < 3) {
                counts[turn] = recorded;
            }
            assert_int_equal(girih_plan_statistics(plan).output_triangles, drawn);
            if (turn == 0) {
                bytes = (size_t)drawn * 3 * GPU_CAPTURE_FLOATS * sizeof(float);
                corners = malloc(bytes + 1);
                assert_non_null(corners);
                memcpy(corners, capture.corners.mapped, bytes);
            } else {
                const size_t now = (size_t)drawn * 3 * GPU_CAPTURE_FLOATS * sizeof(float);
                const bool same =
                    now == bytes && memcmp(corners, capture.corners.mapped, bytes) == 0;
                assert_int_equal(same, turn < 3);
            }
        }
        assert_int_equal(counts[1], counts[2]);
        assert_true(counts[0] > counts[1] + 10);
        free(corners);
        girih_plan_destroy(plan);
    }
    gpu_capture_close(&capture);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

// All timestamps of a frame are written, in order, whether it was redone or not.
static void timestamps_are_written(void **state) {
    (void)state;
    girih_context *context = counted_context((gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_plan *plan = own_make_plan(context, own_plan_of(scene, NULL, GIRIH_MODE_WELDED, ROOM));
    const uint32_t first = 2;
    const VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                        .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                        .queryCount = first + GIRIH_TIMESTAMPS};
    VkQueryPool pool;
    gpu_check(vkCreateQueryPool(device.device, &info, NULL, &pool), "vkCreateQueryPool");
    uint64_t last = 0;
    for (int turn = 0; turn < 3; ++turn) {
        const girih_timestamps timestamps = {pool, first};
        const girih_frame frame = first_frame();
        girih_error error = {GIRIH_OK, ""};
        VkCommandBuffer commands = gpu_begin(&device);
        vkCmdResetQueryPool(commands, pool, 0, first + GIRIH_TIMESTAMPS);
        recorded = 0;
        gpu_girih(girih_cmd_refine(plan, commands, &frame, &timestamps, &error), &error);
        assert_true(turn == 0 ? recorded > 40 : recorded <= 2 * GIRIH_TIMESTAMPS);
        gpu_run(&device, commands);
        uint64_t times[GIRIH_TIMESTAMPS][2];
        gpu_check(
            vkGetQueryPoolResults(device.device, pool, first, GIRIH_TIMESTAMPS, sizeof times, times,
                                  sizeof times[0],
                                  VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT),
            "vkGetQueryPoolResults");
        for (int n = 0; n < GIRIH_TIMESTAMPS; ++n) {
            assert_true(times[n][1] != 0);
            assert_true(times[n][0] >= last);
            last = times[n][0];
        }
    }
    vkDestroyQueryPool(device.device, pool, NULL);
    girih_plan_destroy(plan);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

// --- Padding ------------------------------------------------------------------------------------

// All of the list drawn by its room alone. Returns the number of triangles captured.
static uint32_t draw_room(gpu_capture *capture, const girih_plan *plan, girih_buffer_range list) {
    const girih_plan_buffers buffers = girih_plan_get_buffers(plan);
    memset(capture->counter.mapped, 0, sizeof(uint32_t));
    VkCommandBuffer commands = gpu_begin(&device);
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                        .renderPass = capture->pass,
                                        .framebuffer = capture->framebuffer,
                                        .renderArea = {.extent = {16, 16}}};
    vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, capture->pipelines[GPU_CAPTURE_BUFFERS]);
    const VkDeviceSize zero = 0;
    capture->bind(commands, 0, 1, &capture->corners.buffer, &zero, &capture->corners.size);
    capture->begin(commands, 0, 0, NULL, NULL);
    vkCmdBindVertexBuffers(
        commands, 0, 2, (const VkBuffer[2]){buffers.positions.buffer, buffers.attributes.buffer},
        (const VkDeviceSize[2]){buffers.positions.offset, buffers.attributes.offset});
    vkCmdBindIndexBuffer(commands, list.buffer, list.offset, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands, 3 * buffers.max_triangles, 1, 0, 0, 0);
    capture->end(commands, 0, 1, &capture->counter.buffer, &zero);
    vkCmdEndRenderPass(commands);
    gpu_run(&device, commands);
    return gpu_drawn(capture);
}

// A list as read: its triangles, then nothing but (0, 0, 0); and so it is drawn.
static void check_padded(gpu_capture *capture, const girih_plan *plan, const gpu_readback *read,
                         uint32_t binding, girih_buffer_range list, uint64_t output) {
    const uint32_t *indices = read->words[binding];
    const uint32_t room = girih_plan_get_buffers(plan).max_triangles;
    for (uint64_t n = 0; n < output; ++n) {
        const uint32_t *v = indices + 3 * n;
        assert_true(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
    }
    for (uint64_t n = 3 * output; n < 3 * (uint64_t)room; ++n) {
        assert_int_equal(indices[n], 0);
    }
    assert_int_equal(draw_room(capture, plan, list), room);
    const float *corners = capture->corners.mapped;
    for (uint32_t n = 0; n < 3 * room; ++n) {
        assert_memory_equal(corners + (size_t)n * GPU_CAPTURE_FLOATS,
                            own_position(read, indices[n]), 12);
    }
}

static void check_padding(bool few, bool windows) {
    girih_context *context = gpu_variant_context(&device, (gpu_variant){.few_buffers = few});
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    gpu_capture capture = gpu_capture_open(&device, context);
    const uint32_t range = context->limits.maxStorageBufferRange;
    gpu_readback read = {0};
    enum { FITS, CULLED, PARTLY, OVERFLOWS, CASES };
    for (int n = 0; n < 2 * CASES; ++n) {
        const int which = n / 2;
        girih_plan_desc desc =
            own_plan_of(scene, NULL, n % 2 ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED, ROOM);
        desc.outputs |= GIRIH_OUTPUT_PADDED;
        desc.index_usage = VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
        girih_frame frame = first_frame();
        if (which == CULLED || which == PARTLY) {
            desc.outputs &= ~(uint32_t)GIRIH_OUTPUT_CLOSED_INDICES;
            frame.cull_frustum = 1;
            for (int plane = 0; plane < 6; ++plane) {
                frame.planes[plane][1] = 1;
                frame.planes[plane][3] = which == CULLED ? -100.0f : 1.0f;
            }
        }
        context->limits.maxStorageBufferRange = windows ? SMALL_RANGE : range;
        girih_plan *plan = own_make_plan(context, desc);
        context->limits.maxStorageBufferRange = range;
        assert_int_equal(plan->window_count > 1, windows);
        // Made with the plan's vertex input, and room for what follows.
        gpu_draw(&capture, plan, &frame, ROOM);
        if (which == OVERFLOWS) {
            plan->arrays.frame.max_triangles = plan->arrays.frame.triangle_count;
        }
        gpu_refine(&device, plan, &frame, &read);
        plan->arrays.frame.max_triangles = ROOM;
        const girih_statistics s = girih_plan_statistics(plan);
        assert_int_equal(s.overflow, which == OVERFLOWS);
        assert_int_equal(s.culled_triangles == s.input_triangles, which == CULLED);
        assert_int_equal(s.culled_triangles > 0, which == CULLED || which == PARTLY);
        assert_true(s.output_triangles < ROOM);
        assert_int_equal(s.output_triangles == 0, which == CULLED);
        const girih_plan_buffers buffers = girih_plan_get_buffers(plan);
        assert_int_equal(buffers.max_triangles, ROOM);
        check_padded(&capture, plan, &read, GIRIH_BIND_OUT_INDICES, buffers.indices,
                     s.output_triangles);
        if (desc.outputs & GIRIH_OUTPUT_CLOSED_INDICES) {
            check_padded(&capture, plan, &read, GIRIH_BIND_OUT_CLOSED_INDICES,
                         buffers.closed_indices, s.output_triangles);
        }
        girih_plan_destroy(plan);
    }
    gpu_readback_free(&device, &read);
    gpu_capture_close(&capture);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void padding(void **state) {
    (void)state;
    check_padding(false, false);
    check_padding(true, false);
    check_padding(false, true);
    check_padding(true, true);
}

int main(void) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    textures = own_set_open(&device, settings);
    other_textures = own_set_open(&device, other_settings);
    own_make_meshes(meshes);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_are_redone),
        cmocka_unit_test(one_instance_moves),
        cmocka_unit_test(draws_stay),
        cmocka_unit_test(timestamps_are_written),
        cmocka_unit_test(padding),
    };
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    own_destroy_meshes(meshes);
    own_set_close(&device, &textures);
    own_set_close(&device, &other_textures);
    const unsigned messages = gpu_close(&device);
    if (messages) {
        print_error("%u validation messages\n", messages);
    }
    return messages != 0;
}
