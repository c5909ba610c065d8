// Creation with every Vulkan call, every allocation of girih's own and every allocation through the
// host's callbacks failing once, in turn: each time a clean error, nothing leaked, and what was
// there before works on. And the other way round: a host that brings all the memory itself.
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
#include "memory.h"
#include "meshes.h"
#include "own_surfaces.h"
#include "results.h"
#include "vulkan_shim.h"

#define ROOM 20000u                                           // triangles
#define OUTPUTS (GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES) // of the baked and welded plans

static gpu device;
static const girih_mesh *meshes[2];
static const girih_instance instances[2] = {
    {.mesh = 0, .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {.mesh = 1, .transform = {-1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0}}};
#define REACH 0.05f // of the own surface

static VkPipelineCache cache;
static own_set own;

static void open_device(bool validation) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, validation);
    const VkPipelineCacheCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    gpu_check(vkCreatePipelineCache(device.device, &info, NULL, &cache), "vkCreatePipelineCache");
    own = own_set_open(&device, (own_settings){.height = REACH, .phase = 0.3f});
}

static unsigned close_device(void) {
    own_set_close(&device, &own);
    vkDestroyPipelineCache(device.device, cache, NULL);
    return gpu_close(&device);
}

static girih_context_desc context_desc(int few_buffers) {
    return (girih_context_desc){.get_instance_proc_addr = shim_get_instance_proc_addr,
                                .instance = device.instance,
                                .physical_device = device.physical_device,
                                .device = device.device,
                                .enabled_features = &device.features,
                                .few_buffers = few_buffers,
                                .pipeline_cache = cache,
                                .allocation_callbacks = shim_callbacks()};
}

static girih_scene_desc scene_desc(void) {
    return (girih_scene_desc){.meshes = meshes, .mesh_count = 2};
}

static girih_plan_desc plan_desc(const girih_scene *scene, girih_surface surface, girih_mode mode,
                                 const girih_surface_program *program) {
    const uint32_t lists = mode == GIRIH_MODE_INSTANCED ? 0
                           : mode == GIRIH_MODE_WELDED  ? OUTPUTS | GIRIH_OUTPUT_CLOSED_INDICES
                                                        : OUTPUTS;
    return (girih_plan_desc){.scene = scene,
                             .instances = instances,
                             .instance_count = 2,
                             .surface = surface,
                             .program = surface == GIRIH_SURFACE_OWN ? program : NULL,
                             .mode = mode,
                             .outputs = lists,
                             .max_vertices = 3 * ROOM,
                             .max_triangles = ROOM};
}

// --- One object of the library's, made and destroyed ---------------------------------------------

typedef enum made_kind { MADE_CONTEXT, MADE_PROGRAM, MADE_SCENE, MADE_PLAN } made_kind;

typedef struct maker {
    made_kind kind;
    const girih_context *context; // of all but contexts
    girih_context_desc context_desc;
    girih_surface_program_desc program_desc;
    girih_scene_desc scene_desc;
    girih_plan_desc plan_desc;
} maker;

static girih_result make(const maker *it, void **made, girih_error *error) {
    girih_context *context = NULL;
    girih_surface_program *program = NULL;
    girih_scene *scene = NULL;
    girih_plan *plan = NULL;
    girih_result result = GIRIH_OK;
    switch (it->kind) {
    case MADE_CONTEXT:
        result = girih_context_create(&it->context_desc, &context, error);
        *made = context;
        break;
    case MADE_PROGRAM:
        result = girih_surface_program_create(it->context, &it->program_desc, &program, error);
        *made = program;
        break;
    case MADE_SCENE:
        result = girih_scene_create(it->context, &it->scene_desc, &scene, error);
        *made = scene;
        break;
    case MADE_PLAN:
        result = girih_plan_create(it->context, &it->plan_desc, &plan, error);
        *made = plan;
        break;
    }
    return result;
}

static void destroy(const maker *it, void *made) {
    switch (it->kind) {
    case MADE_CONTEXT:
        girih_context_destroy(made);
        break;
    case MADE_PROGRAM:
        girih_surface_program_destroy(made);
        break;
    case MADE_SCENE:
        girih_scene_destroy(made);
        break;
    case MADE_PLAN:
        girih_plan_destroy(made);
        break;
    }
}

// --- What must go on working ---------------------------------------------------------------------

typedef struct survivor {
    girih_context *context;
    girih_surface_program *program;
    girih_scene *scene;
    girih_plan *plan;
    results expected, got;
} survivor;

static girih_frame frame(void) {
    return (girih_frame){
        .rule = GIRIH_LEVEL_RANDOM, .segments = 8, .seed = 3, .surface_set = own.set};
}

static girih_surface_program_desc program_desc(const survivor *there) {
    const int few = girih_context_uses_few_buffers(there->context);
    return (girih_surface_program_desc){.bake = few ? NULL : there->program->words,
                                        .bake_bytes = few ? 0 : there->program->bytes,
                                        .bake_few = few ? there->program->words : NULL,
                                        .bake_few_bytes = few ? there->program->bytes : 0,
                                        .set_layout = own.layout,
                                        .base = GIRIH_SURFACE_PN,
                                        .reach = REACH};
}

static girih_plan *make_plan(const girih_context *context, girih_plan_desc desc) {
    girih_plan *plan = NULL;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_plan_create(context, &desc, &plan, &error), &error);
    return plan;
}

static void upload(girih_context *context, girih_scene *scene) {
    VkCommandBuffer commands = gpu_begin(&device);
    girih_cmd_upload_context(context, commands);
    girih_cmd_upload_scene(scene, commands);
    gpu_run(&device, commands);
}

static survivor open_survivor(int few_buffers) {
    survivor there = {0};
    girih_error error = {GIRIH_OK, ""};
    const girih_context_desc desc = context_desc(few_buffers);
    gpu_girih(girih_context_create(&desc, &there.context, &error), &error);
    there.program = own_program(there.context, &own, OWN_WAVE, REACH);
    const girih_scene_desc scene = scene_desc();
    gpu_girih(girih_scene_create(there.context, &scene, &there.scene, &error), &error);
    upload(there.context, there.scene);
    there.plan = make_plan(there.context,
                           plan_desc(there.scene, GIRIH_SURFACE_FLAT, GIRIH_MODE_WELDED, NULL));
    const girih_frame once = frame();
    results_refine(&device, there.plan, &once, &there.expected);
    assert_true(there.expected.statistics.output_triangles > 1000);
    assert_false(there.expected.statistics.overflow);
    return there;
}

static void assert_survives(survivor *there) {
    const girih_frame again = frame();
    results_refine(&device, there->plan, &again, &there->got);
    const char *difference = results_difference(&there->expected, &there->got);
    if (difference) {
        fail_msg("after a failure a frame has other %s", difference);
    }
}

static void close_survivor(survivor *there) {
    results_free(&device, &there->expected);
    results_free(&device, &there->got);
    girih_plan_destroy(there->plan);
    girih_scene_destroy(there->scene);
    girih_surface_program_destroy(there->program);
    girih_context_destroy(there->context);
}

static void assert_nothing_is_left(void) {
    const shim_counts counts = shim_count();
    for (int kind = 0; kind < SHIM_KINDS; ++kind) {
        assert_int_equal(counts.alive[kind], 0);
    }
    assert_int_equal(counts.memory_bytes, 0);
    assert_int_equal(counts.allocations, 0);
    assert_int_equal(counts.breaches, 0);
    assert_int_equal(counts.without_callbacks, 0);
    assert_int_equal(counts.without_cache, 0);
}

// --- Faults in turn ------------------------------------------------------------------------------

typedef enum fault_kind { FAULT_CALL, FAULT_OWN_ALLOCATION, FAULT_CALLBACK } fault_kind;

// Pipelines stay in the context, so the calls they took are not made again and those after them
// move up. Going back by more than one pipeline takes leaves none out.
#define CALLS_OF_A_PIPELINE 8u

static girih_result expected_result(VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return GIRIH_ERROR_OUT_OF_MEMORY;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
        return GIRIH_ERROR_OUT_OF_DEVICE_MEMORY;
    default:
        return GIRIH_ERROR_DEVICE;
    }
}

static void check_error(const girih_error *error, girih_result got, fault_kind kind,
                        const char *where) {
    static const char *const whats[] = {"context", "catalogue", "surface",
                                        "scene",   "plan",      "output"};
    assert_int_equal(error->result, got);
    assert_null(strchr(error->message, '\n'));
    bool named = kind != FAULT_OWN_ALLOCATION && strstr(error->message, where);
    // GIRIH_ERROR_DEVICE promises the name of the call.
    for (size_t n = 0; n < sizeof whats / sizeof *whats && got != GIRIH_ERROR_DEVICE; ++n) {
        named = named || strstr(error->message, whats[n]);
    }
    if (!named) {
        fail_msg("%s failed, and the message is: \"%s\"", where, error->message);
    }
}

// Returns how many failures there were.
static uint32_t fail_in_turn(const maker *it, fault_kind kind, VkResult result, survivor *there) {
    uint32_t failures = 0;
    for (size_t n = 0;;) {
        const shim_counts before = shim_count();
        girih_error error = {GIRIH_OK, ""};
        void *made = NULL;
        shim_fail_call(kind == FAULT_CALL ? n : SIZE_MAX, result);
        shim_fail_allocation(kind == FAULT_CALLBACK ? n : SIZE_MAX);
        girih_allocation_failure_after(kind == FAULT_OWN_ALLOCATION ? n : SIZE_MAX);
        const girih_result got = make(it, &made, &error);
        const char *where = kind == FAULT_CALL       ? shim_failed_call()
                            : kind == FAULT_CALLBACK ? shim_failed_allocation()
                            : got == GIRIH_OK        ? NULL
                                                     : "girih_allocate";
        shim_fail_call(SIZE_MAX, VK_SUCCESS);
        shim_fail_allocation(SIZE_MAX);
        girih_allocation_failure_after(SIZE_MAX);
        if (got == GIRIH_OK) {
            assert_non_null(made);
            destroy(it, made);
        } else {
            assert_null(made);
        }
        const shim_counts after = shim_count();
        const uint32_t pipelines = after.alive[SHIM_PIPELINE] - before.alive[SHIM_PIPELINE];
        for (int k = 0; k < SHIM_KINDS; ++k) {
            if (k != SHIM_PIPELINE && after.alive[k] != before.alive[k]) {
                fail_msg("%s: failure %zu in %s leaves %u of %s, there were %u", error.message, n,
                         where ? where : "nothing", after.alive[k], shim_kind_name((shim_kind)k),
                         before.alive[k]);
            }
        }
        assert_int_equal(after.memory_bytes, before.memory_bytes);
        assert_int_equal(after.breaches, before.breaches);
        if (pipelines == 0) {
            assert_int_equal(after.allocations, before.allocations);
        }
        if (!where) {
            assert_int_equal(got, GIRIH_OK);
            return failures;
        }
        // A driver may do without an allocation; a call that failed is never passed over.
        if (kind != FAULT_CALLBACK || got != GIRIH_OK) {
            const girih_result expected =
                kind == FAULT_CALL ? expected_result(result) : GIRIH_ERROR_OUT_OF_MEMORY;
            if (got != expected) {
                fail_msg("failure %zu in %s: result %d, not %d: %s", n, where, (int)got,
                         (int)expected, error.message);
            }
            check_error(&error, got, kind, where);
        }
        ++failures;
        if (there) {
            assert_survives(there);
        }
        const size_t back = n < CALLS_OF_A_PIPELINE ? n : CALLS_OF_A_PIPELINE;
        n = pipelines ? n - back : n + 1;
    }
}

// The first ones may come from every call that can fail, a pipeline's included; the others only
// from calls that come before the pipelines.
static const VkResult results_of_calls[] = {
    VK_ERROR_UNKNOWN,
    VK_ERROR_OUT_OF_HOST_MEMORY,
    VK_ERROR_OUT_OF_DEVICE_MEMORY,
    VK_ERROR_OUT_OF_POOL_MEMORY,
    VK_ERROR_FRAGMENTED_POOL,
    VK_ERROR_FRAGMENTATION,
    VK_ERROR_TOO_MANY_OBJECTS,
    VK_ERROR_MEMORY_MAP_FAILED,
};
#define OF_EVERY_CALL 3
#define RESULTS_OF_CALLS (sizeof results_of_calls / sizeof *results_of_calls)

// Plans of every mode and surface in one context whose pipelines are not made yet: each result in
// turn, added to its own number of failures.
static void fail_plans(int few_buffers, fault_kind kind, const VkResult *reasons, size_t count,
                       uint32_t *failures) {
    survivor there = open_survivor(few_buffers);
    for (size_t k = 0; k < count; ++k) {
        for (int n = 0; n < 9; ++n) {
            const maker plan = {.kind = MADE_PLAN,
                                .context = there.context,
                                .plan_desc = plan_desc(there.scene, (girih_surface)(n / 3),
                                                       (girih_mode)(n % 3), there.program)};
            failures[k] += fail_in_turn(&plan, kind, reasons[k], &there);
        }
    }
    close_survivor(&there);
    assert_nothing_is_left();
}

static uint32_t fail_contexts_programs_and_scenes(int few_buffers, fault_kind kind, VkResult result,
                                                  survivor *there) {
    const maker context = {.kind = MADE_CONTEXT, .context_desc = context_desc(few_buffers)};
    const maker scene = {.kind = MADE_SCENE, .context = there->context, .scene_desc = scene_desc()};
    const maker program = {
        .kind = MADE_PROGRAM, .context = there->context, .program_desc = program_desc(there)};
    return fail_in_turn(&context, kind, result, there) +
           fail_in_turn(&program, kind, result, there) + fail_in_turn(&scene, kind, result, there);
}

static void vulkan_calls_fail(void **unused) {
    (void)unused;
    shim_reset();
    shim_share_pipelines(true);
    uint32_t failures[RESULTS_OF_CALLS] = {0};
    for (int few = 0; few < 2; ++few) {
        survivor there = open_survivor(few);
        for (size_t n = 0; n < RESULTS_OF_CALLS; ++n) {
            failures[n] +=
                fail_contexts_programs_and_scenes(few, FAULT_CALL, results_of_calls[n], &there);
        }
        close_survivor(&there);
        assert_nothing_is_left();
        for (size_t n = 0; n < OF_EVERY_CALL; ++n) {
            fail_plans(few, FAULT_CALL, &results_of_calls[n], 1, &failures[n]);
        }
        fail_plans(few, FAULT_CALL, &results_of_calls[OF_EVERY_CALL],
                   RESULTS_OF_CALLS - OF_EVERY_CALL, &failures[OF_EVERY_CALL]);
    }
    for (size_t n = 0; n < RESULTS_OF_CALLS; ++n) {
        printf("VkResult %d: %u calls made to fail\n", (int)results_of_calls[n], failures[n]);
        assert_true(failures[n] >= (n < OF_EVERY_CALL ? 400u : 10u));
    }
}

static void own_allocations_fail(void **unused) {
    (void)unused;
    shim_reset();
    shim_share_pipelines(true);
    uint32_t failures = 0;
    for (int few = 0; few < 2; ++few) {
        survivor there = open_survivor(few);
        failures +=
            fail_contexts_programs_and_scenes(few, FAULT_OWN_ALLOCATION, VK_SUCCESS, &there);
        close_survivor(&there);
        fail_plans(few, FAULT_OWN_ALLOCATION, &(VkResult){VK_SUCCESS}, 1, &failures);
    }
    printf("%u allocations of girih's own made to fail\n", failures);
    assert_true(failures > 60);
}

// Without validation: the driver's own report of each failure would count as a message. With
// pipelines made anew for each context, whose allocations fail too.
static void host_allocations_fail(void **unused) {
    (void)unused;
    shim_reset();
    const gpu validated = device;
    const VkPipelineCache validated_cache = cache;
    const own_set validated_own = own;
    open_device(false);
    uint32_t failures = 0;
    for (int few = 0; few < 2; ++few) {
        survivor there = open_survivor(few);
        failures += fail_contexts_programs_and_scenes(few, FAULT_CALLBACK, VK_SUCCESS, &there);
        close_survivor(&there);
        fail_plans(few, FAULT_CALLBACK, &(VkResult){VK_SUCCESS}, 1, &failures);
    }
    close_device();
    device = validated;
    cache = validated_cache;
    own = validated_own;
    printf("%u allocations through the host's callbacks made to fail\n", failures);
    assert_true(failures > 200);
}

// Asking for sizes makes nothing, whether it succeeds or not.
static uint32_t fail_to_ask(const maker *it) {
    const shim_counts before = shim_count();
    girih_buffer_need needs[GIRIH_PLAN_BUFFERS];
    for (uint32_t failures = 0;; ++failures) {
        girih_error error = {GIRIH_OK, ""};
        girih_allocation_failure_after(failures);
        const girih_result got =
            it->kind == MADE_CONTEXT ? girih_context_needs(&it->context_desc, needs, &error)
            : it->kind == MADE_SCENE
                ? girih_scene_needs(it->context, &it->scene_desc, needs, &error)
                : girih_plan_needs(it->context, &it->plan_desc, needs, &error);
        girih_allocation_failure_after(SIZE_MAX);
        assert_memory_equal(shim_count().made, before.made, sizeof before.made);
        assert_int_equal(shim_count().allocations, before.allocations);
        if (got == GIRIH_OK) {
            return failures;
        }
        assert_int_equal(got, GIRIH_ERROR_OUT_OF_MEMORY);
        check_error(&error, got, FAULT_OWN_ALLOCATION, "girih_allocate");
    }
}

static void needs_fail(void **unused) {
    (void)unused;
    shim_reset();
    shim_share_pipelines(true);
    uint32_t failures = 0;
    for (int few = 0; few < 2; ++few) {
        survivor there = open_survivor(few);
        const maker context = {.kind = MADE_CONTEXT, .context_desc = context_desc(few)};
        const maker scene = {
            .kind = MADE_SCENE, .context = there.context, .scene_desc = scene_desc()};
        const maker plan = {.kind = MADE_PLAN,
                            .context = there.context,
                            .plan_desc = plan_desc(there.scene, GIRIH_SURFACE_PN, GIRIH_MODE_WELDED,
                                                   there.program)};
        failures += fail_to_ask(&context) + fail_to_ask(&scene) + fail_to_ask(&plan);
        assert_survives(&there);
        close_survivor(&there);
    }
    assert_nothing_is_left();
    printf("%u allocations made to fail while sizes were asked for\n", failures);
    assert_true(failures > 10);
}

// --- Memory of the host's ------------------------------------------------------------------------

// One large buffer for each kind of memory, handed out range by range.
typedef struct host_memory {
    gpu_buffer buffers[2]; // device-local, mapped
    VkDeviceSize used[2];
} host_memory;

#define HOST_BYTES (VkDeviceSize)(64u << 20)

static host_memory open_host_memory(void) {
    const VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
        VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
        VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    host_memory memory = {0};
    for (int mapped = 0; mapped < 2; ++mapped) {
        memory.buffers[mapped] = gpu_create_buffer(&device, HOST_BYTES, usage, mapped);
    }
    return memory;
}

static void close_host_memory(host_memory *memory) {
    gpu_destroy_buffer(&device, &memory->buffers[0]);
    gpu_destroy_buffer(&device, &memory->buffers[1]);
}

// A range for every need, never at 0 and never aligned to more than was asked for.
static void take_ranges(host_memory *memory, const girih_buffer_need *needs, size_t count,
                        girih_buffer_range *ranges) {
    for (size_t n = 0; n < count; ++n) {
        const girih_buffer_need *need = &needs[n];
        ranges[n] = (girih_buffer_range){0};
        if (need->size == 0) {
            continue;
        }
        const int mapped = need->mapped != 0;
        assert_true(need->alignment > 0 && (need->alignment & (need->alignment - 1)) == 0);
        assert_true(need->usage != 0 && need->name && *need->name);
        VkDeviceSize offset = (memory->used[mapped] / need->alignment + 1) * need->alignment;
        offset += offset % (2 * need->alignment) == 0 ? need->alignment : 0;
        memory->used[mapped] = offset + need->size;
        assert_true(memory->used[mapped] <= HOST_BYTES);
        char *base = memory->buffers[mapped].mapped;
        ranges[n] = (girih_buffer_range){.buffer = memory->buffers[mapped].buffer,
                                         .offset = offset,
                                         .mapped = mapped ? base + offset : NULL};
    }
}

typedef struct host_ranges {
    girih_buffer_range context[GIRIH_CONTEXT_BUFFERS];
    girih_buffer_range scene[GIRIH_SCENE_BUFFERS];
    girih_buffer_range plan[GIRIH_PLAN_BUFFERS];
} host_ranges;

static void check_host_memory(int few_buffers) {
    shim_reset();
    shim_share_pipelines(true);
    survivor reference = open_survivor(few_buffers);
    host_memory memory = open_host_memory();
    host_ranges ranges;
    girih_error error = {GIRIH_OK, ""};
    const shim_counts before = shim_count();

    girih_context_desc desc = context_desc(few_buffers);
    girih_buffer_need context_needs[GIRIH_CONTEXT_BUFFERS];
    gpu_girih(girih_context_needs(&desc, context_needs, &error), &error);
    take_ranges(&memory, context_needs, GIRIH_CONTEXT_BUFFERS, ranges.context);
    desc.buffers = ranges.context;
    girih_context *context = NULL;
    gpu_girih(girih_context_create(&desc, &context, &error), &error);

    girih_scene_desc of_scene = scene_desc();
    girih_buffer_need scene_needs[GIRIH_SCENE_BUFFERS];
    gpu_girih(girih_scene_needs(context, &of_scene, scene_needs, &error), &error);
    take_ranges(&memory, scene_needs, GIRIH_SCENE_BUFFERS, ranges.scene);
    of_scene.buffers = ranges.scene;
    girih_scene *scene = NULL;
    gpu_girih(girih_scene_create(context, &of_scene, &scene, &error), &error);
    upload(context, scene);
    girih_scene_trim(scene);

    gpu_capture capture = gpu_capture_open(&device, context);
    gpu_capture reference_capture = gpu_capture_open(&device, reference.context);
    own_capture(&capture, &own, OWN_WAVE);
    own_capture(&reference_capture, &own, OWN_WAVE);
    girih_surface_program *program = own_program(context, &own, OWN_WAVE, REACH);
    const girih_frame once = frame();
    results a = {0};
    results b = {0};
    uint64_t compared = 0;
    uint32_t drawn = 0;
    const host_memory without_plans = memory;
    for (int n = 0; n < 9; ++n) {
        const girih_surface surface = (girih_surface)(n / 3);
        girih_plan_desc of_plan = plan_desc(scene, surface, (girih_mode)(n % 3), program);
        girih_plan *expected =
            make_plan(reference.context,
                      plan_desc(reference.scene, surface, (girih_mode)(n % 3), reference.program));
        const shim_counts made = shim_count();
        girih_buffer_need needs[GIRIH_PLAN_BUFFERS];
        gpu_girih(girih_plan_needs(context, &of_plan, needs, &error), &error);
        memory = without_plans;
        take_ranges(&memory, needs, GIRIH_PLAN_BUFFERS, ranges.plan);
        of_plan.buffers = ranges.plan;
        girih_plan *plan = make_plan(context, of_plan);
        assert_int_equal(shim_count().made[SHIM_BUFFER], made.made[SHIM_BUFFER]);
        assert_int_equal(shim_count().made[SHIM_MEMORY], made.made[SHIM_MEMORY]);
        results_refine(&device, expected, &once, &a);
        results_refine(&device, plan, &once, &b);
        const char *difference = results_difference(&a, &b);
        if (difference) {
            fail_msg("plan %d in the host's buffers has other %s", n, difference);
        }
        compared += results_bytes(&a);
        const uint32_t triangles = gpu_draw(&reference_capture, expected, NULL, ROOM);
        assert_int_equal(gpu_draw(&capture, plan, NULL, ROOM), triangles);
        assert_int_equal(triangles, a.statistics.output_triangles);
        assert_memory_equal(capture.corners.mapped, reference_capture.corners.mapped,
                            (size_t)triangles * 3 * GPU_CAPTURE_FLOATS * sizeof(float));
        drawn += triangles;
        girih_plan_destroy(plan);
        girih_plan_destroy(expected);
    }
    printf("%llu bytes compared, %u triangles drawn, %llu and %llu bytes of the "
           "host's\n",
           (unsigned long long)compared, drawn, (unsigned long long)memory.used[0],
           (unsigned long long)memory.used[1]);
    assert_true(compared > 500000 && drawn > 10000);
    results_free(&device, &a);
    results_free(&device, &b);
    gpu_capture_close(&capture);
    gpu_capture_close(&reference_capture);
    girih_scene_destroy(scene);
    girih_surface_program_destroy(program);
    girih_context_destroy(context);
    assert_int_equal(shim_count().alive[SHIM_BUFFER], before.alive[SHIM_BUFFER]);
    close_host_memory(&memory);
    close_survivor(&reference);
    assert_nothing_is_left();
}

static void host_brings_the_memory(void **unused) {
    (void)unused;
    check_host_memory(0);
}

static void host_brings_the_memory_of_few_buffers(void **unused) {
    (void)unused;
    check_host_memory(1);
}

// Ranges that cannot serve are refused, each alone; a range that is left out is girih's to make.
static void check_ranges(maker *it, const girih_buffer_need *needs, girih_buffer_range *ranges,
                         size_t count) {
    const shim_counts before = shim_count();
    for (size_t n = 0; n < count; ++n) {
        if (needs[n].size == 0) {
            continue;
        }
        const girih_buffer_range good = ranges[n];
        for (int wrong = 0; wrong < 3; ++wrong) {
            if (wrong == 1 && !needs[n].mapped) {
                continue;
            }
            void *made = NULL;
            girih_error error = {GIRIH_OK, ""};
            if (wrong == 0) {
                assert_true(needs[n].alignment > 1);
                ranges[n].offset += needs[n].alignment / 2;
            } else if (wrong == 1) {
                ranges[n].mapped = NULL;
            } else {
                ranges[n].buffer = VK_NULL_HANDLE;
            }
            const girih_result result = make(it, &made, &error);
            ranges[n] = good;
            const uint32_t buffers = shim_count().alive[SHIM_BUFFER] - before.alive[SHIM_BUFFER];
            if (wrong == 2) {
                gpu_girih(result, &error);
                assert_int_equal(buffers, 1);
                destroy(it, made);
            } else {
                assert_int_equal(result, GIRIH_ERROR_INVALID_ARGUMENT);
                assert_null(made);
                assert_int_equal(buffers, 0);
                if (!strstr(error.message, needs[n].name)) {
                    fail_msg("\"%s\" does not name \"%s\"", error.message, needs[n].name);
                }
            }
            assert_int_equal(shim_count().alive[SHIM_BUFFER], before.alive[SHIM_BUFFER]);
            assert_int_equal(shim_count().alive[SHIM_MEMORY], before.alive[SHIM_MEMORY]);
        }
    }
}

static void wrong_ranges_are_refused(void **unused) {
    (void)unused;
    shim_reset();
    shim_share_pipelines(true);
    survivor reference = open_survivor(0);
    host_memory memory = open_host_memory();
    host_ranges ranges;
    girih_error error = {GIRIH_OK, ""};
    maker context = {.kind = MADE_CONTEXT, .context_desc = context_desc(0)};
    girih_buffer_need context_needs[GIRIH_CONTEXT_BUFFERS];
    gpu_girih(girih_context_needs(&context.context_desc, context_needs, &error), &error);
    take_ranges(&memory, context_needs, GIRIH_CONTEXT_BUFFERS, ranges.context);
    context.context_desc.buffers = ranges.context;
    check_ranges(&context, context_needs, ranges.context, GIRIH_CONTEXT_BUFFERS);
    maker scene = {.kind = MADE_SCENE, .context = reference.context, .scene_desc = scene_desc()};
    girih_buffer_need scene_needs[GIRIH_SCENE_BUFFERS];
    gpu_girih(girih_scene_needs(reference.context, &scene.scene_desc, scene_needs, &error), &error);
    take_ranges(&memory, scene_needs, GIRIH_SCENE_BUFFERS, ranges.scene);
    scene.scene_desc.buffers = ranges.scene;
    check_ranges(&scene, scene_needs, ranges.scene, GIRIH_SCENE_BUFFERS);
    maker plan = {.kind = MADE_PLAN,
                  .context = reference.context,
                  .plan_desc =
                      plan_desc(reference.scene, GIRIH_SURFACE_PN, GIRIH_MODE_WELDED, NULL)};
    girih_buffer_need plan_needs[GIRIH_PLAN_BUFFERS];
    gpu_girih(girih_plan_needs(reference.context, &plan.plan_desc, plan_needs, &error), &error);
    for (int n = 0; n < GIRIH_PLAN_BUFFERS; ++n) {
        assert_true(plan_needs[n].size > 0); // this plan wants every one
    }
    take_ranges(&memory, plan_needs, GIRIH_PLAN_BUFFERS, ranges.plan);
    plan.plan_desc.buffers = ranges.plan;
    check_ranges(&plan, plan_needs, ranges.plan, GIRIH_PLAN_BUFFERS);
    assert_survives(&reference);
    close_host_memory(&memory);
    close_survivor(&reference);
    assert_nothing_is_left();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vulkan_calls_fail),
        cmocka_unit_test(own_allocations_fail),
        cmocka_unit_test(host_allocations_fail),
        cmocka_unit_test(needs_fail),
        cmocka_unit_test(host_brings_the_memory),
        cmocka_unit_test(host_brings_the_memory_of_few_buffers),
        cmocka_unit_test(wrong_ranges_are_refused),
    };
    open_device(true);
    meshes[0] = make_seam_sphere(7, 5);
    meshes[1] = make_cube(1);
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    girih_mesh_destroy(meshes[0]);
    girih_mesh_destroy(meshes[1]);
    const unsigned messages = close_device();
    if (messages) {
        fprintf(stderr, "%u validation messages\n", messages);
    }
    return messages != 0;
}
