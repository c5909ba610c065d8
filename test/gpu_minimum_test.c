// The least that Vulkan 1.1 promises gives the same bytes: no optional feature, an instance and
// device of version 1.1, and no limit beyond the required ones, each alone and all together. And
// girih beside a host that keeps descriptor sets and push constants of its own bound.
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "gpu_frame.h"
#include "meshes.h"
#include "own_surfaces.h"
#include "results.h"
#include "vulkan_shim.h"

#include "host_sets.spv.h"
#include "host_surface.spv.h"
#include "host_surface_few.spv.h"

#define ROOM 60000u // triangles

// --- Devices -------------------------------------------------------------------------------------

// A device as new as the loader and the driver know, with all features that girih can use.
static void open_newest(gpu *host, const VkPhysicalDeviceFeatures *features) {
    // Queue family, memory types and the rest are the device's own, whatever the version.
    gpu_open(host, features, false);
    vkDestroyFence(host->device, host->fence, NULL);
    vkDestroyCommandPool(host->device, host->pool, NULL);
    vkDestroyDevice(host->device, NULL);
    vkDestroyInstance(host->instance, NULL);
    uint32_t version = 0;
    gpu_check(vkEnumerateInstanceVersion(&version), "vkEnumerateInstanceVersion");
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pApplicationName = "girih test",
                                           .apiVersion = version};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application};
    gpu_check(vkCreateInstance(&info, NULL, &host->instance), "vkCreateInstance");
    uint32_t count = 1;
    const VkResult found =
        vkEnumeratePhysicalDevices(host->instance, &count, &host->physical_device);
    gpu_check(found == VK_INCOMPLETE ? VK_SUCCESS : found, "vkEnumeratePhysicalDevices");
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = host->queue_family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const char *feedback = VK_EXT_TRANSFORM_FEEDBACK_EXTENSION_NAME;
    VkPhysicalDeviceTransformFeedbackFeaturesEXT feedback_features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TRANSFORM_FEEDBACK_FEATURES_EXT,
        .transformFeedback = VK_TRUE};
    const VkDeviceCreateInfo device = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                       .pNext =
                                           host->transform_feedback ? &feedback_features : NULL,
                                       .queueCreateInfoCount = 1,
                                       .pQueueCreateInfos = &queue,
                                       .enabledExtensionCount = host->transform_feedback,
                                       .ppEnabledExtensionNames = &feedback,
                                       .pEnabledFeatures = &host->features};
    gpu_check(vkCreateDevice(host->physical_device, &device, NULL, &host->device),
              "vkCreateDevice");
    vkGetDeviceQueue(host->device, host->queue_family, 0, &host->queue);
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = host->queue_family};
    gpu_check(vkCreateCommandPool(host->device, &pool, NULL, &host->pool), "vkCreateCommandPool");
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    gpu_check(vkCreateFence(host->device, &fence, NULL, &host->fence), "vkCreateFence");
}

enum { NEWEST_FULL, NEWEST_BARE, FIRST_FULL, FIRST_BARE, DEVICES };
static gpu devices[DEVICES];
static own_set own[DEVICES];
#define REACH 0.05f // of the own surface

static const struct {
    const char *name;
    int device;
    bool required_limits;
} worlds[] = {
    {"everything there is", NEWEST_FULL, false}, // what the others are compared with
    {"no feature", NEWEST_BARE, false},
    {"Vulkan 1.1", FIRST_FULL, false},
    {"required limits", NEWEST_FULL, true},
    {"Vulkan 1.1, required limits, no feature", FIRST_BARE, true},
};
#define WORLDS (sizeof worlds / sizeof *worlds)
#define SURFACES 3 // flat, PN, and a host's

// --- Scenes --------------------------------------------------------------------------------------

#define MESHES 5
static const girih_mesh *meshes[MESHES];

#define KEPT                                                                                       \
    { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 }
#define MIRRORED                                                                                   \
    { -0.5f, 0.25f, 0, 3, 0, 1.5f, 0, 0, 0.125f, 0, 1, -1 }

static const struct {
    int linear; // catalogue
    uint32_t first_mesh, mesh_count;
    girih_instance instances[3];
    uint32_t instance_count;
} scenes[] = {
    {0, 0, 1, {{.transform = KEPT}}, 1},
    {0,
     1,
     2,
     {{.transform = KEPT}, {.mesh = 1, .transform = MIRRORED}, {.transform = MIRRORED}},
     3},
    {1, 1, 1, {{.transform = KEPT}}, 1},
    {1, 3, 2, {{.transform = MIRRORED}, {.mesh = 1, .transform = KEPT}}, 2},
};
#define SCENES (sizeof scenes / sizeof *scenes)

static const girih_frame frames[] = {
    {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = 7},
    {.rule = GIRIH_LEVEL_EDGE_PIXELS,
     .length = 24,
     .pixels_per_unit = 900,
     .near_distance = 0.1f,
     .eye = {2, 3, 4}},
};
#define FRAMES (sizeof frames / sizeof *frames)

static girih_context *make_context(gpu *host, girih_context_desc desc) {
    desc.get_instance_proc_addr = shim_get_instance_proc_addr;
    desc.instance = host->instance;
    desc.physical_device = host->physical_device;
    desc.device = host->device;
    desc.enabled_features = &host->features;
    girih_context *context = NULL;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_context_create(&desc, &context, &error), &error);
    VkCommandBuffer commands = gpu_begin(host);
    girih_cmd_upload_context(context, commands);
    gpu_run(host, commands);
    return context;
}

static girih_scene *make_scene(gpu *host, const girih_context *context, size_t number) {
    const girih_scene_desc desc = {.meshes = meshes + scenes[number].first_mesh,
                                   .mesh_count = scenes[number].mesh_count};
    girih_scene *scene = NULL;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_scene_create(context, &desc, &scene, &error), &error);
    VkCommandBuffer commands = gpu_begin(host);
    girih_cmd_upload_scene(scene, commands);
    gpu_run(host, commands);
    return scene;
}

static girih_plan_desc plan_desc(const girih_scene *scene, size_t number, girih_surface surface,
                                 const girih_surface_program *program, girih_mode mode,
                                 uint32_t outputs) {
    return (girih_plan_desc){.scene = scene,
                             .instances = scenes[number].instances,
                             .instance_count = scenes[number].instance_count,
                             .surface = surface,
                             .program = surface == GIRIH_SURFACE_OWN ? program : NULL,
                             .mode = mode,
                             .outputs = outputs,
                             .max_vertices = 3 * ROOM,
                             .max_triangles = ROOM};
}

static girih_plan *make_plan(const girih_context *context, girih_plan_desc desc) {
    girih_plan *plan = NULL;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_plan_create(context, &desc, &plan, &error), &error);
    return plan;
}

// --- The same bytes in every world ---------------------------------------------------------------

// What one scene gives with one surface: the arrays of both modes with buffers, and what is drawn.
typedef struct outcome {
    results arrays[2][FRAMES];
    float *corners; // of the instanced draw of the first frame
    uint32_t drawn;
} outcome;

static outcome expected[SCENES][SURFACES];

static void check_vertex_input(const girih_plan *plan) {
    const VkPipelineVertexInputStateCreateInfo *input = girih_plan_vertex_input(plan);
    const VkPhysicalDeviceLimits *most = &shim_required_limits;
    assert_true(input->vertexAttributeDescriptionCount <= most->maxVertexInputAttributes);
    assert_true(input->vertexBindingDescriptionCount <= most->maxVertexInputBindings);
    for (uint32_t n = 0; n < input->vertexAttributeDescriptionCount; ++n) {
        assert_true(input->pVertexAttributeDescriptions[n].offset <=
                    most->maxVertexInputAttributeOffset);
    }
    for (uint32_t n = 0; n < input->vertexBindingDescriptionCount; ++n) {
        assert_true(input->pVertexBindingDescriptions[n].stride <=
                    most->maxVertexInputBindingStride);
    }
}

static void compare_arrays(size_t world, size_t scene, girih_surface surface, int welded,
                           girih_plan *plan) {
    gpu *host = &devices[worlds[world].device];
    for (size_t n = 0; n < FRAMES; ++n) {
        girih_frame frame = frames[n];
        frame.surface_set = own[worlds[world].device].set;
        results *reference = &expected[scene][surface].arrays[welded][n];
        if (world == 0) {
            results_refine(host, plan, &frame, reference);
            assert_false(reference->statistics.overflow);
            continue;
        }
        results got = {0};
        results_refine(host, plan, &frame, &got);
        const char *difference = results_difference(reference, &got);
        if (difference) {
            fail_msg("%s: scene %zu, surface %d, %s, frame %zu: other %s", worlds[world].name,
                     scene, (int)surface, welded ? "welded" : "baked", n, difference);
        }
        results_free(host, &got);
    }
}

static void compare_draw(size_t world, size_t scene, girih_surface surface, gpu_capture *capture,
                         girih_plan *plan) {
    outcome *reference = &expected[scene][surface];
    girih_frame frame = frames[0];
    frame.surface_set = own[worlds[world].device].set;
    girih_plan_invalidate(plan);
    const uint32_t drawn = gpu_draw(capture, plan, &frame, ROOM);
    const size_t bytes = (size_t)drawn * 3 * GPU_CAPTURE_FLOATS * sizeof(float);
    if (!reference->corners) {
        reference->corners = malloc(bytes + 1);
        assert_non_null(reference->corners);
        memcpy(reference->corners, capture->corners.mapped, bytes);
        reference->drawn = drawn;
    }
    if (drawn != reference->drawn ||
        memcmp(capture->corners.mapped, reference->corners, bytes) != 0) {
        fail_msg("%s: scene %zu, surface %d: other triangles are drawn", worlds[world].name, scene,
                 (int)surface);
    }
}

static void refuse_instances(const girih_context *context, girih_plan_desc desc) {
    girih_plan *plan = NULL;
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_plan_create(context, &desc, &plan, &error), GIRIH_ERROR_UNSUPPORTED);
    assert_null(plan);
    assert_non_null(strstr(error.message, "multiDrawIndirect"));
    assert_non_null(strstr(error.message, "drawIndirectFirstInstance"));
    assert_null(strchr(error.message, '\n'));
}

static void compare_scene(size_t world, size_t number, const girih_context *context,
                          gpu_capture *capture) {
    gpu *host = &devices[worlds[world].device];
    girih_scene *scene = make_scene(host, context, number);
    girih_surface_program *program =
        own_program(context, &own[worlds[world].device], OWN_WAVE, REACH);
    for (int surface = 0; surface < SURFACES; ++surface) {
        const girih_plan_desc instanced =
            plan_desc(scene, number, (girih_surface)surface, program, GIRIH_MODE_INSTANCED, 0);
        if (host->features.multiDrawIndirect && host->features.drawIndirectFirstInstance) {
            girih_plan *plan = make_plan(context, instanced);
            check_vertex_input(plan);
            compare_draw(world, number, (girih_surface)surface, capture, plan);
            girih_plan_destroy(plan);
        } else {
            refuse_instances(context, instanced);
        }
        const uint32_t lists = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES;
        for (int welded = 0; welded < 2; ++welded) {
            const girih_mode mode = welded ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED;
            girih_plan *plan =
                make_plan(context, plan_desc(scene, number, (girih_surface)surface, program, mode,
                                             welded ? lists | GIRIH_OUTPUT_CLOSED_INDICES : lists));
            check_vertex_input(plan);
            compare_arrays(world, number, (girih_surface)surface, welded, plan);
            compare_draw(world, number, (girih_surface)surface, capture, plan);
            girih_plan_destroy(plan);
        }
        // Without lists a baked draw takes the catalogue's indices where the device can.
        girih_plan *plan = make_plan(context, plan_desc(scene, number, (girih_surface)surface,
                                                        program, GIRIH_MODE_BAKED, 0));
        compare_draw(world, number, (girih_surface)surface, capture, plan);
        girih_plan_destroy(plan);
    }
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
}

static void worlds_give_the_same_bytes(void **state) {
    (void)state;
    shim_reset();
    shim_share_pipelines(true);
    for (size_t world = 0; world < WORLDS; ++world) {
        gpu *host = &devices[worlds[world].device];
        shim_report_required_limits(worlds[world].required_limits);
        for (int linear = 0; linear < 2; ++linear) {
            girih_context *context = make_context(
                host, (girih_context_desc){.catalogue = linear ? girih_catalogue_linear() : NULL});
            gpu_capture capture = gpu_capture_open(host, context);
            own_capture(&capture, &own[worlds[world].device], OWN_WAVE);
            for (size_t scene = 0; scene < SCENES; ++scene) {
                if (scenes[scene].linear == linear) {
                    compare_scene(world, scene, context, &capture);
                }
            }
            gpu_capture_close(&capture);
            girih_context_destroy(context);
        }
        assert_int_equal(shim_count().breaches, 0);
    }
    shim_report_required_limits(false);
    uint64_t bytes = 0;
    uint64_t drawn = 0;
    for (size_t scene = 0; scene < SCENES; ++scene) {
        for (int surface = 0; surface < SURFACES; ++surface) {
            outcome *reference = &expected[scene][surface];
            drawn += reference->drawn;
            free(reference->corners);
            for (int welded = 0; welded < 2; ++welded) {
                for (size_t n = 0; n < FRAMES; ++n) {
                    bytes += results_bytes(&reference->arrays[welded][n]);
                    results_free(&devices[worlds[0].device], &reference->arrays[welded][n]);
                }
            }
        }
    }
    printf("%llu bytes and %llu triangles drawn, alike in %zu worlds\n", (unsigned long long)bytes,
           (unsigned long long)drawn, WORLDS);
    assert_true(bytes > 1000000 && drawn > 20000);
}

// --- Beside a host's own sets and push constants -------------------------------------------------

#define HOST_WORDS 16u
#define HOST_PUSH (HOST_WORDS * 4u)

typedef struct host_program {
    VkDescriptorSetLayout set_layouts[2];
    VkPushConstantRange range;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkDescriptorSet sets[2];
    gpu_buffer words, table;
} host_program;

static host_program open_program(gpu *host, uint32_t further_push) {
    host_program program = {
        .range = {.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = HOST_PUSH + further_push}};
    const VkDescriptorType types[2] = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                       VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER};
    VkDescriptorPoolSize sizes[2];
    for (int n = 0; n < 2; ++n) {
        const VkDescriptorSetLayoutBinding binding = {.descriptorType = types[n],
                                                      .descriptorCount = 1,
                                                      .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
        const VkDescriptorSetLayoutCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
            .bindingCount = 1,
            .pBindings = &binding};
        gpu_check(vkCreateDescriptorSetLayout(host->device, &info, NULL, &program.set_layouts[n]),
                  "vkCreateDescriptorSetLayout");
        sizes[n] = (VkDescriptorPoolSize){types[n], 1};
    }
    const VkPipelineLayoutCreateInfo layout = {.sType =
                                                   VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 2,
                                               .pSetLayouts = program.set_layouts,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &program.range};
    gpu_check(vkCreatePipelineLayout(host->device, &layout, NULL, &program.layout),
              "vkCreatePipelineLayout");
    VkShaderModule module = gpu_shader(host, host_sets, sizeof host_sets);
    const VkComputePipelineCreateInfo pipeline = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = program.layout};
    gpu_check(vkCreateComputePipelines(host->device, VK_NULL_HANDLE, 1, &pipeline, NULL,
                                       &program.pipeline),
              "vkCreateComputePipelines");
    vkDestroyShaderModule(host->device, module, NULL);
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = 2,
                                             .poolSizeCount = 2,
                                             .pPoolSizes = sizes};
    gpu_check(vkCreateDescriptorPool(host->device, &pool, NULL, &program.pool),
              "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo sets = {.sType =
                                                  VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = program.pool,
                                              .descriptorSetCount = 2,
                                              .pSetLayouts = program.set_layouts};
    gpu_check(vkAllocateDescriptorSets(host->device, &sets, program.sets),
              "vkAllocateDescriptorSets");
    program.words = gpu_create_buffer(host, HOST_PUSH, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true);
    program.table = gpu_create_buffer(host, HOST_PUSH, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, true);
    const VkDescriptorBufferInfo infos[2] = {{program.words.buffer, 0, VK_WHOLE_SIZE},
                                             {program.table.buffer, 0, VK_WHOLE_SIZE}};
    for (int n = 0; n < 2; ++n) {
        const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = program.sets[n],
                                            .descriptorCount = 1,
                                            .descriptorType = types[n],
                                            .pBufferInfo = &infos[n]};
        vkUpdateDescriptorSets(host->device, 1, &write, 0, NULL);
    }
    return program;
}

static void close_program(gpu *host, host_program *program) {
    gpu_destroy_buffer(host, &program->words);
    gpu_destroy_buffer(host, &program->table);
    vkDestroyDescriptorPool(host->device, program->pool, NULL);
    vkDestroyPipeline(host->device, program->pipeline, NULL);
    vkDestroyPipelineLayout(host->device, program->layout, NULL);
    vkDestroyDescriptorSetLayout(host->device, program->set_layouts[0], NULL);
    vkDestroyDescriptorSetLayout(host->device, program->set_layouts[1], NULL);
}

// Sets and push constants bound once, a frame of girih's, then the host's dispatch.
static void run_beside(gpu *host, const host_program *program, girih_plan *plan,
                       const girih_frame *frame, results *read) {
    uint32_t pushed[HOST_WORDS];
    uint32_t table[HOST_WORDS];
    for (uint32_t n = 0; n < HOST_WORDS; ++n) {
        pushed[n] = 0x1000u + 17u * n;
        table[n] = 0x80000000u + n * n;
    }
    memcpy(program->table.mapped, table, sizeof table);
    memset(program->words.mapped, 0, HOST_PUSH);
    VkCommandBuffer commands = gpu_begin(host);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, program->layout, 0, 2,
                            program->sets, 0, NULL);
    vkCmdPushConstants(commands, program->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, HOST_PUSH,
                       pushed);
    girih_error error = {GIRIH_OK, ""};
    girih_plan_invalidate(plan);
    gpu_girih(girih_cmd_refine(plan, commands, frame, NULL, &error), &error);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, program->pipeline);
    vkCmdDispatch(commands, 1, 1, 1);
    const VkMemoryBarrier after = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                         0, 1, &after, 0, NULL, 0, NULL);
    results_record(host, plan, commands, read);
    gpu_run(host, commands);
    results_finish(plan, read);
    for (uint32_t n = 0; n < HOST_WORDS; ++n) {
        uint32_t word;
        memcpy(&word, (const char *)program->words.mapped + 4 * n, sizeof word);
        assert_int_equal(word, 3 * pushed[n] + table[n]);
    }
}

static void host_sets_stay_bound(void **state) {
    (void)state;
    shim_reset();
    shim_share_pipelines(true);
    gpu *host = &devices[FIRST_FULL];
    host_program program = open_program(host, GIRIH_PUSH_CONSTANT_BYTES);
    uint64_t bytes = 0;
    for (int few = 0; few < 2; ++few) {
        girih_context *alone = make_context(host, (girih_context_desc){.few_buffers = few});
        girih_context *beside =
            make_context(host, (girih_context_desc){.few_buffers = few,
                                                    .host_set_layouts = program.set_layouts,
                                                    .host_set_layout_count = 2,
                                                    .push_constant_ranges = &program.range,
                                                    .push_constant_range_count = 1,
                                                    .push_constant_offset = HOST_PUSH});
        // Compiled for where girih's and the surface's set are here: 2 and 3.
        const girih_surface_program_desc surface_desc = {.bake = host_surface,
                                                         .bake_bytes = sizeof host_surface,
                                                         .bake_few = host_surface_few,
                                                         .bake_few_bytes = sizeof host_surface_few,
                                                         .set_layout = own[FIRST_FULL].layout,
                                                         .base = GIRIH_SURFACE_PN,
                                                         .reach = REACH};
        girih_surface_program *alone_program =
            own_program(alone, &own[FIRST_FULL], OWN_WAVE, REACH);
        girih_surface_program *beside_program = NULL;
        girih_error error = {GIRIH_OK, ""};
        gpu_girih(girih_surface_program_create(beside, &surface_desc, &beside_program, &error),
                  &error);
        gpu_capture alone_capture = gpu_capture_open(host, alone);
        gpu_capture beside_capture = gpu_capture_open(host, beside);
        own_capture(&alone_capture, &own[FIRST_FULL], OWN_WAVE);
        own_capture(&beside_capture, &own[FIRST_FULL], OWN_WAVE);
        girih_frame frame = frames[0];
        frame.surface_set = own[FIRST_FULL].set;
        girih_scene *alone_scene = make_scene(host, alone, 1);
        girih_scene *beside_scene = make_scene(host, beside, 1);
        for (int n = 0; n < 9; ++n) {
            const girih_surface surface = (girih_surface)(n % 3);
            const girih_mode mode = (girih_mode)(n / 3);
            const uint32_t outputs =
                mode == GIRIH_MODE_WELDED ? GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES : 0;
            girih_plan *a =
                make_plan(alone, plan_desc(alone_scene, 1, surface, alone_program, mode, outputs));
            girih_plan *b = make_plan(
                beside, plan_desc(beside_scene, 1, surface, beside_program, mode, outputs));
            results expect = {0};
            results got = {0};
            results_refine(host, a, &frame, &expect);
            run_beside(host, &program, b, &frame, &got);
            const char *difference = results_difference(&expect, &got);
            if (difference) {
                fail_msg("mode %d beside a host's sets has other %s", (int)mode, difference);
            }
            bytes += results_bytes(&got);
            const uint32_t drawn = gpu_draw(&alone_capture, a, NULL, ROOM);
            assert_int_equal(drawn, expect.statistics.output_triangles);
            assert_int_equal(gpu_draw(&beside_capture, b, NULL, ROOM), drawn);
            assert_memory_equal(alone_capture.corners.mapped, beside_capture.corners.mapped,
                                (size_t)drawn * 3 * GPU_CAPTURE_FLOATS * sizeof(float));
            results_free(host, &expect);
            results_free(host, &got);
            girih_plan_destroy(a);
            girih_plan_destroy(b);
        }
        gpu_capture_close(&alone_capture);
        gpu_capture_close(&beside_capture);
        girih_surface_program_destroy(alone_program);
        girih_surface_program_destroy(beside_program);
        girih_scene_destroy(alone_scene);
        girih_scene_destroy(beside_scene);
        girih_context_destroy(alone);
        girih_context_destroy(beside);
    }
    close_program(host, &program);
    printf("%llu bytes alike beside a host's sets\n", (unsigned long long)bytes);
    assert_true(bytes > 500000);
}

// A placement that Vulkan or girih's shaders cannot take is refused.
static void wrong_placements_are_refused(void **state) {
    (void)state;
    shim_reset();
    gpu *host = &devices[FIRST_FULL];
    host_program program = open_program(host, GIRIH_PUSH_CONSTANT_BYTES);
    const girih_context_desc good = {.get_instance_proc_addr = shim_get_instance_proc_addr,
                                     .instance = host->instance,
                                     .physical_device = host->physical_device,
                                     .device = host->device,
                                     .host_set_layouts = program.set_layouts,
                                     .host_set_layout_count = 2,
                                     .push_constant_ranges = &program.range,
                                     .push_constant_range_count = 1,
                                     .push_constant_offset = HOST_PUSH};
    const VkPushConstantRange vertex = {VK_SHADER_STAGE_VERTEX_BIT, 0, 128};
    girih_context_desc wrong[5] = {good, good, good, good, good};
    wrong[0].host_set_layouts = NULL;
    wrong[1].push_constant_offset = HOST_PUSH + 2; // no multiple of 4
    wrong[2].push_constant_offset = HOST_PUSH + 4; // past the end of the range
    wrong[3].push_constant_ranges = &vertex;       // not for compute
    wrong[4].push_constant_ranges = NULL;
    for (int n = 0; n < 5; ++n) {
        girih_context *context = NULL;
        girih_error error = {GIRIH_OK, ""};
        const girih_result result = girih_context_create(&wrong[n], &context, &error);
        if (result != GIRIH_ERROR_INVALID_ARGUMENT || context) {
            fail_msg("placement %d: result %d: %s", n, (int)result, error.message);
        }
        assert_true(strlen(error.message) > 10);
    }
    // Of the required 4 sets, girih and a surface take two.
    shim_report_required_limits(true);
    const VkDescriptorSetLayout three[3] = {program.set_layouts[1], program.set_layouts[1],
                                            program.set_layouts[1]};
    girih_context_desc many = good;
    many.host_set_layouts = three;
    many.host_set_layout_count = 3;
    girih_context *context = NULL;
    girih_error error = {GIRIH_OK, ""};
    const girih_result result = girih_context_create(&many, &context, &error);
    shim_report_required_limits(false);
    assert_int_not_equal(result, GIRIH_OK);
    assert_null(context);
    assert_true(strlen(error.message) > 10);
    for (int kind = 0; kind < SHIM_KINDS; ++kind) {
        assert_int_equal(shim_count().alive[kind], 0);
    }
    close_program(host, &program);
}

// girih asks for no more than Vulkan promises.
static void requirements_are_the_required_limits(void **state) {
    (void)state;
    const girih_requirements requirements = girih_get_requirements();
    const VkPhysicalDeviceLimits *asked = &requirements.required;
    const VkPhysicalDeviceLimits *most = &shim_required_limits;
    uint32_t named = 0;
#define AT_MOST(LIMIT)                                                                             \
    assert_true(asked->LIMIT <= most->LIMIT);                                                      \
    named += asked->LIMIT != 0;
    AT_MOST(maxBoundDescriptorSets)
    AT_MOST(maxComputeSharedMemorySize)
    AT_MOST(maxComputeWorkGroupCount[0])
    AT_MOST(maxComputeWorkGroupCount[1])
    AT_MOST(maxComputeWorkGroupInvocations)
    AT_MOST(maxComputeWorkGroupSize[0])
    AT_MOST(maxDrawIndexedIndexValue)
    AT_MOST(maxDrawIndirectCount)
    AT_MOST(maxPerStageDescriptorStorageBuffers)
    AT_MOST(maxPerStageDescriptorUniformBuffers)
    AT_MOST(maxPerStageResources)
    AT_MOST(maxDescriptorSetStorageBuffers)
    AT_MOST(maxPushConstantsSize)
    AT_MOST(maxStorageBufferRange)
    AT_MOST(maxUniformBufferRange)
    AT_MOST(maxVertexInputAttributes)
    AT_MOST(maxVertexInputBindings)
    AT_MOST(maxVertexInputAttributeOffset)
    AT_MOST(maxVertexInputBindingStride)
    AT_MOST(maxMemoryAllocationCount)
#undef AT_MOST
    assert_true(named > 5);
    for (int device = 0; device < DEVICES; ++device) {
        for (int required = 0; required < 2; ++required) {
            shim_reset();
            shim_report_required_limits(required);
            girih_error error = {GIRIH_OK, ""};
            gpu_girih(girih_check_device(shim_get_instance_proc_addr, devices[device].instance,
                                         devices[device].physical_device, &error),
                      &error);
        }
    }
    shim_reset();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_give_the_same_bytes),
        cmocka_unit_test(host_sets_stay_bound),
        cmocka_unit_test(wrong_placements_are_refused),
        cmocka_unit_test(requirements_are_the_required_limits),
    };
    const girih_requirements requirements = girih_get_requirements();
    open_newest(&devices[NEWEST_FULL], &requirements.optional);
    open_newest(&devices[NEWEST_BARE], NULL);
    gpu_open(&devices[FIRST_FULL], &requirements.optional, true);
    gpu_open(&devices[FIRST_BARE], NULL, true);
    for (int n = 0; n < DEVICES; ++n) {
        own[n] = own_set_open(&devices[n], (own_settings){.height = REACH, .phase = 0.3f});
    }
    meshes[0] = make_torus(12, 10);
    meshes[1] = make_seam_sphere(9, 7);
    meshes[2] = make_cube(1);
    meshes[3] = make_soup(90, 40, 11);
    meshes[4] = make_triangle();
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    for (int n = 0; n < MESHES; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
    unsigned messages = 0;
    for (int n = 0; n < DEVICES; ++n) {
        own_set_close(&devices[n], &own[n]);
        messages += gpu_close(&devices[n]);
    }
    if (messages) {
        fprintf(stderr, "%u validation messages\n", messages);
    }
    return messages != 0;
}
