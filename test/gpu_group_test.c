// Stage 3 on the GPU, alone, on keys of the test's own: the sort gives what its CPU twin gives.
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
#include "meshes.h"

#define MATERIALS 64

static gpu device;
static char what[256]; // the case at hand, for messages

static void assert_ok(girih_result result, const girih_error *error) {
    if (result != GIRIH_OK) {
        fail_msg("%s: %s", what, error->message);
    }
}

static void assert_words(const char *name, const uint32_t *gpu_words, const uint32_t *twin,
                         uint64_t count) {
    if (memcmp(gpu_words, twin, (size_t)count * sizeof *twin) != 0) {
        fail_msg("%s: %s differ", what, name);
    }
}

typedef enum key_kind { KEYS_RANDOM, KEYS_EQUAL, KEYS_FALLING, KEYS_CULLED, KEY_KINDS } key_kind;

static void draw_keys(uint32_t *keys, uint32_t count, uint32_t groups, key_kind kind) {
    uint64_t state = 77 + count;
    for (uint32_t n = 0; n < count; ++n) {
        const uint32_t random = draw_number(&state);
        switch (kind) {
        case KEYS_RANDOM:
            keys[n] = random % 11 == 0 ? GIRIH_KEY_CULLED : random % groups << 3 | (random >> 29);
            break;
        case KEYS_EQUAL:
            keys[n] = (groups - 1) << 3 | (n & 7);
            break;
        case KEYS_FALLING:
            keys[n] = (groups - 1 - n % groups) << 3;
            break;
        default:
            keys[n] = GIRIH_KEY_CULLED;
            break;
        }
    }
}

// Runs the group stage alone on keys written into the plan.
static void sort_keys(girih_plan *plan, key_kind kind) {
    const girih_arrays *arrays = &plan->arrays;
    const uint32_t count = arrays->frame.triangle_count;
    const VkDeviceSize key_bytes = arrays->count[GIRIH_BIND_KEYS] * 4;
    gpu_buffer keys = gpu_create_buffer(&device, key_bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
    draw_keys(keys.mapped, count, arrays->frame.group_count, kind);
    const girih_buffer *work = &plan->buffers[GIRIH_PLAN_WORK];
    VkCommandBuffer commands = gpu_begin(&device);
    const VkBufferCopy copy = {.dstOffset = plan->offset[GIRIH_BIND_KEYS], .size = key_bytes};
    vkCmdCopyBuffer(commands, keys.buffer, work->buffer, 1, &copy);
    vkCmdUpdateBuffer(commands, work->buffer, plan->frame_offset, sizeof arrays->frame,
                      &arrays->frame);
    vkCmdFillBuffer(commands, work->buffer, plan->offset[GIRIH_BIND_GROUPS],
                    arrays->count[GIRIH_BIND_GROUPS] * 4, 0);
    vkCmdFillBuffer(commands, work->buffer, plan->offset[GIRIH_BIND_STATUS],
                    arrays->count[GIRIH_BIND_STATUS] * 4, 0);
    girih_barrier(plan->context, commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                  VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                  VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                      VK_ACCESS_UNIFORM_READ_BIT);
    girih_bind_set(plan, commands, 0);
    girih_record_group(plan, commands);
    gpu_run(&device, commands);

    const uint64_t group_words = arrays->count[GIRIH_BIND_GROUPS];
    uint32_t status[GIRIH_STATUS_WORDS] = {0};
    girih_arrays twin = {.frame = arrays->frame};
    twin.words[GIRIH_BIND_KEYS] = keys.mapped;
    twin.words[GIRIH_BIND_ITEMS] = malloc((size_t)arrays->count[GIRIH_BIND_ITEMS] * 4);
    twin.words[GIRIH_BIND_GROUPS] = malloc((size_t)group_words * 4);
    twin.words[GIRIH_BIND_STATUS] = status;
    twin.count[GIRIH_BIND_GROUPS] = group_words;
    girih_error error = {GIRIH_OK, ""};
    assert_ok(girih_twin_group(&twin, &error), &error);
    const uint64_t item_words = (uint64_t)status[GIRIH_STATUS_ITEMS] * GIRIH_ITEM_WORDS;
    uint32_t *words =
        gpu_read(&device, work->buffer, plan->offset[GIRIH_BIND_ITEMS], item_words * 4);
    assert_words("items", words, twin.words[GIRIH_BIND_ITEMS], item_words);
    free(words);
    words = gpu_read(&device, work->buffer, plan->offset[GIRIH_BIND_GROUPS], group_words * 4);
    assert_words("groups", words, twin.words[GIRIH_BIND_GROUPS], group_words);
    free(words);
    words = gpu_read(&device, work->buffer, plan->offset[GIRIH_BIND_STATUS], 4);
    assert_words("item count", words, status, 1);
    free(words);
    free(twin.words[GIRIH_BIND_ITEMS]);
    free(twin.words[GIRIH_BIND_GROUPS]);
    gpu_destroy_buffer(&device, &keys);
}

// Sorts `copies` instances of a mesh of `triangles` triangles.
static void sort_triangles(const girih_context *context, uint32_t triangles, uint32_t copies,
                           key_kind kinds) {
    const girih_mesh *mesh = make_materials(triangles, MATERIALS);
    assert_int_equal(mesh->triangle_count, triangles);
    girih_scene *scene = gpu_scene(&device, context, &mesh, 1);
    girih_instance *instances = calloc(copies, sizeof *instances);
    assert_non_null(instances);
    // The patches are never written, so their room stays address space.
    const girih_plan_desc desc = {.scene = scene,
                                  .instances = instances,
                                  .instance_count = copies,
                                  .mode = GIRIH_MODE_INSTANCED,
                                  .outputs = GIRIH_OUTPUT_NO_DRAW};
    girih_plan *plan;
    girih_error error = {GIRIH_OK, ""};
    assert_ok(girih_plan_create(context, &desc, &plan, &error), &error);
    free(instances);
    // In dispatches of its own, whatever the plan's size.
    plan->small = false;
    assert_ok(girih_plan_need_pipelines(plan, &error), &error);
    for (key_kind kind = KEYS_RANDOM; kind < kinds; ++kind) {
        snprintf(what, sizeof what, "%u triangles, %u groups, sort %s, few %d, keys %d",
                 triangles * copies, plan->arrays.frame.group_count,
                 context->serial_sort ? "serial" : "workgroup", context->few_buffers, (int)kind);
        sort_keys(plan, kind);
    }
    girih_plan_destroy(plan);
    girih_scene_destroy(scene);
    girih_mesh_destroy(mesh);
}

static void sort_variant(gpu_variant variant, uint32_t most) {
    static const uint32_t counts[] = {0, 1, 2, 127, 128, 129, 1023, 1024, 1025, 70000, 300000};
    girih_context *context = gpu_variant_context(&device, variant);
    for (size_t n = 0; n < sizeof counts / sizeof *counts; ++n) {
        sort_triangles(context, counts[n], 1, KEY_KINDS);
    }
    if (most) {
        sort_triangles(context, 10000, most / 10000, KEYS_EQUAL);
    }
    girih_context_destroy(context);
}

// 1,376 ranges of 816 base patterns times 64 materials: two passes of the sort.
static void group_serial(void **state) {
    (void)state;
    sort_variant((gpu_variant){.linear = 1, .sort = GIRIH_SORT_SERIAL}, 10000000);
}

static void group_workgroup(void **state) {
    (void)state;
    sort_variant((gpu_variant){.linear = 1, .sort = GIRIH_SORT_WORKGROUP}, 1000000);
}

static void group_few_buffers(void **state) {
    (void)state;
    sort_variant((gpu_variant){.linear = 0, .sort = GIRIH_SORT_SERIAL, .few_buffers = 1}, 0);
    sort_variant((gpu_variant){.linear = 1, .sort = GIRIH_SORT_WORKGROUP, .few_buffers = 1}, 0);
}

int main(void) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    device.share_pipelines = true;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(group_serial),
        cmocka_unit_test(group_workgroup),
        cmocka_unit_test(group_few_buffers),
    };
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    const unsigned messages = gpu_close(&device);
    if (messages) {
        print_error("%u validation messages\n", messages);
    }
    return messages != 0;
}
