// Dynamic meshes: a closed mesh with a UV seam and hard edges, skinned and deformed on the GPU for
// 200 frames. Each frame is watertight by bits and equal to a fresh preparation of the deformed
// mesh, and nothing is made for it on the CPU.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "deform.spv.h"
#include "memory.h"
#include "meshes.h"
#include "own_surfaces.h"
#include "stages.h"

#define FRAMES 200
#define ROOM 20000u // output triangles
#define INSTANCES 2
#define DRUM 1u // the moved mesh's number; 0 stands before it in the arena and does not move

static gpu device;
static own_set textures;
static const own_settings settings = {.height = 0.05f, .phase = 0.3f};
static const girih_mesh *meshes[2];
static const girih_instance instances[INSTANCES] = {
    {DRUM, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {DRUM, {-0.8f, 0, 0.1f, 4, 0, 1.2f, 0, 0, 0, 0, 1, 0.5f}}};

// --- The host's deformation ---------------------------------------------------------------------

typedef struct deformation {
    gpu_buffer rest, points;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    struct {
        uint32_t first, count;
        float time;
    } push;
} deformation;

static deformation deformation_open(const girih_scene *scene) {
    const girih_mesh *mesh = meshes[DRUM];
    deformation d = {0};
    const VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    d.rest = gpu_create_buffer(&device, (VkDeviceSize)mesh->vertex_count * 24, storage, true);
    d.points = gpu_create_buffer(&device, (VkDeviceSize)mesh->vertex_count * 4, storage, true);
    memcpy(d.points.mapped, mesh->vertex_point, mesh->vertex_count * sizeof(uint32_t));
    for (uint32_t n = 0; n < mesh->vertex_count; ++n) {
        float *vertex = (float *)d.rest.mapped + 6 * (size_t)n;
        memcpy(vertex, mesh->positions + 3 * (size_t)n, 12);
        memcpy(vertex + 3, mesh->normals + 3 * (size_t)n, 12);
    }
    VkDescriptorSetLayoutBinding bindings[3];
    for (uint32_t n = 0; n < 3; ++n) {
        bindings[n] = (VkDescriptorSetLayoutBinding){n, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                                                     VK_SHADER_STAGE_COMPUTE_BIT, NULL};
    }
    const VkDescriptorSetLayoutCreateInfo set_layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 3,
        .pBindings = bindings};
    gpu_check(vkCreateDescriptorSetLayout(device.device, &set_layout, NULL, &d.set_layout),
              "vkCreateDescriptorSetLayout");
    const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof d.push};
    const VkPipelineLayoutCreateInfo layout = {.sType =
                                                   VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 1,
                                               .pSetLayouts = &d.set_layout,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &range};
    gpu_check(vkCreatePipelineLayout(device.device, &layout, NULL, &d.layout),
              "vkCreatePipelineLayout");
    const VkShaderModule module = gpu_shader(&device, deform, sizeof deform);
    const VkComputePipelineCreateInfo pipeline = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = d.layout};
    gpu_check(
        vkCreateComputePipelines(device.device, VK_NULL_HANDLE, 1, &pipeline, NULL, &d.pipeline),
        "vkCreateComputePipelines");
    vkDestroyShaderModule(device.device, module, NULL);
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = 1,
                                             .poolSizeCount = 1,
                                             .pPoolSizes = &size};
    gpu_check(vkCreateDescriptorPool(device.device, &pool, NULL, &d.pool),
              "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocation = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = d.pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &d.set_layout};
    gpu_check(vkAllocateDescriptorSets(device.device, &allocation, &d.set),
              "vkAllocateDescriptorSets");

    girih_buffer_range live;
    VkDeviceSize live_size;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_scene_vertices(scene, DRUM, &live, &live_size, &error), &error);
    assert_int_equal(live_size, mesh->vertex_count * 24);
    d.push.first = (uint32_t)(live.offset / 4);
    d.push.count = mesh->vertex_count;
    const VkDescriptorBufferInfo buffers[3] = {{d.rest.buffer, 0, VK_WHOLE_SIZE},
                                               {d.points.buffer, 0, VK_WHOLE_SIZE},
                                               {live.buffer, 0, VK_WHOLE_SIZE}};
    for (uint32_t n = 0; n < 3; ++n) {
        const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = d.set,
                                            .dstBinding = n,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                            .pBufferInfo = &buffers[n]};
        vkUpdateDescriptorSets(device.device, 1, &write, 0, NULL);
    }
    return d;
}

static void deformation_close(deformation *d) {
    vkDestroyDescriptorPool(device.device, d->pool, NULL);
    vkDestroyPipeline(device.device, d->pipeline, NULL);
    vkDestroyPipelineLayout(device.device, d->layout, NULL);
    vkDestroyDescriptorSetLayout(device.device, d->set_layout, NULL);
    gpu_destroy_buffer(&device, &d->rest);
    gpu_destroy_buffer(&device, &d->points);
}

// No barrier before or after: girih_cmd_refine orders both.
static void record_deformation(deformation *d, VkCommandBuffer commands, float time) {
    d->push.time = time;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, d->pipeline);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, d->layout, 0, 1, &d->set, 0,
                            NULL);
    vkCmdPushConstants(commands, d->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof d->push,
                       &d->push);
    vkCmdDispatch(commands, (d->push.count + 63) / 64, 1, 1);
}

// --- Scenes and plans ---------------------------------------------------------------------------

static girih_scene *make_scene(const girih_context *context, const girih_mesh *const *of,
                               int dynamic, int previous) {
    const girih_scene_desc desc = {
        .meshes = of, .mesh_count = 2, .dynamic = dynamic, .previous = previous};
    girih_scene *scene;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_scene_create(context, &desc, &scene, &error), &error);
    VkCommandBuffer commands = gpu_begin(&device);
    girih_cmd_upload_scene(scene, commands);
    gpu_run(&device, commands);
    girih_scene_trim(scene);
    return scene;
}

// `surface` GIRIH_SURFACE_OWN: of the program.
static girih_plan_desc plan_of(const girih_scene *scene, const girih_surface_program *program,
                               girih_surface surface, girih_mode mode) {
    girih_plan_desc desc = own_plan_of(scene, program, mode, ROOM);
    desc.instances = instances;
    desc.instance_count = INSTANCES;
    desc.surface = surface;
    return desc;
}

// Six floats a vertex of the moved mesh, as the GPU has them (free()).
static float *read_vertices(const girih_scene *scene) {
    girih_buffer_range range;
    VkDeviceSize size;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_scene_vertices(scene, DRUM, &range, &size, &error), &error);
    return gpu_read(&device, range.buffer, range.offset, size);
}

// The deformed mesh prepared anew, every position from the vertex that stands for it.
static const girih_mesh *prepare_anew(const float *vertices, int dynamic, uint32_t *apart,
                                      uint32_t *negative_zeros) {
    const girih_mesh *mesh = meshes[DRUM];
    float *positions = malloc(mesh->vertex_count * 3 * sizeof *positions);
    float *normals = malloc(mesh->vertex_count * 3 * sizeof *normals);
    assert_true(positions && normals);
    for (size_t n = 0; n < mesh->vertex_count; ++n) {
        const size_t point = mesh->vertex_point[n];
        memcpy(positions + 3 * n, vertices + 6 * point, 12);
        memcpy(normals + 3 * n, vertices + 6 * n + 3, 12);
        *apart += memcmp(vertices + 6 * n, vertices + 6 * point, 12) != 0;
        for (int axis = 0; axis < 3; ++axis) {
            *negative_zeros +=
                vertices[6 * n + (size_t)axis] == 0.0f && signbit(vertices[6 * n + (size_t)axis]);
        }
    }
    const girih_mesh_desc desc = {.name = "anew",
                                  .vertex_count = mesh->vertex_count,
                                  .positions = positions,
                                  .normals = normals,
                                  .attributes = mesh->attributes,
                                  .attribute_floats = mesh->attribute_floats,
                                  .indices = mesh->triangle_vertices,
                                  .index_count = 3 * mesh->triangle_count,
                                  .submeshes = mesh->submeshes,
                                  .submesh_count = mesh->submesh_count,
                                  .dynamic = dynamic};
    const girih_mesh *anew;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_mesh_create(&desc, &anew, &error), &error);
    assert_int_equal(anew->vertex_count, mesh->vertex_count);
    assert_int_equal(anew->triangle_count, mesh->triangle_count);
    assert_int_equal(anew->edge_count, mesh->edge_count);
    free(positions);
    free(normals);
    return anew;
}

// --- Frames -------------------------------------------------------------------------------------

// What a frame hands on: the corners of its triangles, 8 floats each, however it was made (free()).
typedef struct corners {
    float *floats;
    uint32_t triangles;
} corners;

static corners run_frame(gpu_capture *capture, girih_plan *plan, const girih_frame *frame,
                         gpu_readback *read) {
    corners c = {0};
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        c.triangles = gpu_draw(capture, plan, frame, ROOM);
    } else {
        gpu_refine(&device, plan, frame, read);
        c.triangles = (uint32_t)girih_plan_statistics(plan).output_triangles;
    }
    assert_false(girih_plan_statistics(plan).overflow);
    c.floats = malloc((size_t)c.triangles * 3 * GPU_CAPTURE_FLOATS * sizeof(float) + 1);
    assert_non_null(c.floats);
    if (plan->mode == GIRIH_MODE_INSTANCED) {
        memcpy(c.floats, capture->corners.mapped,
               (size_t)c.triangles * 3 * GPU_CAPTURE_FLOATS * sizeof(float));
        return c;
    }
    for (size_t n = 0; n < 3 * (size_t)c.triangles; ++n) {
        const uint32_t vertex = read->words[GIRIH_BIND_OUT_INDICES][n];
        memcpy(c.floats + GPU_CAPTURE_FLOATS * n, own_position(read, vertex), 12);
        memcpy(c.floats + GPU_CAPTURE_FLOATS * n + 3, own_normal(read, vertex, 5), 20);
        if (plan->mode == GIRIH_MODE_WELDED) {
            const uint32_t closed = read->words[GIRIH_BIND_OUT_CLOSED_INDICES][n];
            assert_memory_equal(own_position(read, closed), own_position(read, vertex), 12);
        }
    }
    return c;
}

static void assert_closed(const corners *c, uint32_t frame) {
    float *positions = malloc((size_t)c->triangles * 9 * sizeof *positions);
    uint32_t *indices = malloc((size_t)c->triangles * 3 * sizeof *indices);
    assert_true(positions && indices);
    for (uint32_t n = 0; n < 3 * c->triangles; ++n) {
        memcpy(positions + 3 * (size_t)n, c->floats + GPU_CAPTURE_FLOATS * (size_t)n, 12);
        indices[n] = n;
    }
    const edge_audit audit =
        audit_points(positions, 3 * (uint64_t)c->triangles, indices, c->triangles);
    if (2 * audit.edges != 3 * (uint64_t)c->triangles || audit.degenerate) {
        fail_msg("frame %u: of %u triangles %llu edges are open, %llu non-manifold, %llu flipped; "
                 "%llu are degenerate",
                 frame, c->triangles, (unsigned long long)audit.open,
                 (unsigned long long)audit.nonmanifold, (unsigned long long)audit.flipped,
                 (unsigned long long)audit.degenerate);
    }
    free(positions);
    free(indices);
}

static void assert_same(const corners *moved, const corners *anew, const char *how,
                        uint32_t frame) {
    if (moved->triangles != anew->triangles) {
        fail_msg("frame %u, %s: %u triangles, prepared anew %u", frame, how, moved->triangles,
                 anew->triangles);
    }
    for (uint32_t n = 0; n < 3 * moved->triangles; ++n) {
        const float *a = moved->floats + GPU_CAPTURE_FLOATS * (size_t)n;
        const float *b = anew->floats + GPU_CAPTURE_FLOATS * (size_t)n;
        if (memcmp(a, b, GPU_CAPTURE_FLOATS * sizeof(float)) != 0) {
            fail_msg("frame %u, %s: corner %u of triangle %u is (%.9g %.9g %.9g) with normal (%.9g "
                     "%.9g %.9g), prepared anew (%.9g %.9g %.9g) with (%.9g %.9g %.9g)",
                     frame, how, n % 3, n / 3, (double)a[0], (double)a[1], (double)a[2],
                     (double)a[3], (double)a[4], (double)a[5], (double)b[0], (double)b[1],
                     (double)b[2], (double)b[3], (double)b[4], (double)b[5]);
        }
    }
}

static girih_frame frame_of(uint32_t n) {
    girih_frame frame = {.segments = 8,
                         .seed = n,
                         .length = 30,
                         .pixels_per_unit = 400,
                         .near_distance = 0.1f,
                         .eye = {2, -5, 1},
                         .surface_set = textures.set,
                         .revision = n};
    static const girih_level_rule rules[3] = {GIRIH_LEVEL_RANDOM, GIRIH_LEVEL_EDGE_PIXELS,
                                              GIRIH_LEVEL_SEGMENTS};
    frame.rule = rules[n / 9 % 3];
    return frame;
}

static void check_frames(gpu_variant variant, uint32_t first, uint32_t end) {
    static const char *const names[3] = {"instanced", "baked", "welded"};
    girih_context *context = gpu_variant_context(&device, variant);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    girih_scene *scene = make_scene(context, meshes, 1, 0);
    gpu_capture capture = gpu_capture_open(&device, context);
    own_capture(&capture, &textures, OWN_NASTY);
    deformation host = deformation_open(scene);
    girih_plan *plans[3][3];
    for (int surface = 0; surface < 3; ++surface) {
        for (int mode = 0; mode < 3; ++mode) {
            plans[surface][mode] = own_make_plan(
                context, plan_of(scene, program, (girih_surface)surface, (girih_mode)mode));
        }
    }
    gpu_readback read = {0}, read_anew = {0};
    uint64_t triangles = 0;
    uint32_t apart = 0, negative_zeros = 0;
    for (uint32_t n = first; n < end; ++n) {
        const girih_surface surface = (girih_surface)(n % 3);
        const girih_mode mode = (girih_mode)(n / 3 % 3);
        girih_plan *plan = plans[surface][mode];
        girih_frame frame = frame_of(n);
        // From here on nothing is made on the CPU.
        girih_allocation_failure_after(0);
        VkCommandBuffer commands = gpu_begin(&device);
        if (n % 4 == 0) { // refined in between: the next deformation waits for that
            record_deformation(&host, commands, 0.15f * (float)n - 1);
            frame.revision = UINT64_MAX - n;
            girih_error error = {GIRIH_OK, ""};
            gpu_girih(girih_cmd_refine(plan, commands, &frame, NULL, &error), &error);
            frame.revision = n;
        }
        record_deformation(&host, commands, 0.15f * (float)n);
        if (n % 4 == 1) { // this frame's in the same commands
            girih_error error = {GIRIH_OK, ""};
            gpu_girih(girih_cmd_refine(plan, commands, &frame, NULL, &error), &error);
        }
        gpu_run(&device, commands);
        corners moved = run_frame(&capture, plan, &frame, &read);
        girih_allocation_failure_after(SIZE_MAX);
        assert_closed(&moved, n);

        float *vertices = read_vertices(scene);
        const int dynamic = n / 27 % 2 == 1;
        const girih_mesh *const anew[2] = {
            meshes[0], prepare_anew(vertices, dynamic, &apart, &negative_zeros)};
        girih_scene *fresh = make_scene(context, anew, dynamic, 0);
        girih_plan *fresh_plan = own_make_plan(context, plan_of(fresh, program, surface, mode));
        corners expected = run_frame(&capture, fresh_plan, &frame, &read_anew);
        assert_same(&moved, &expected, names[mode], n);
        triangles += moved.triangles;
        free(vertices);
        free(moved.floats);
        free(expected.floats);
        girih_plan_destroy(fresh_plan);
        girih_scene_destroy(fresh);
        girih_mesh_destroy(anew[1]);
    }
    printf("%u frames of %llu triangles as prepared anew; %u vertices apart from their points, %u "
           "coordinates of -0\n",
           end - first, (unsigned long long)triangles, apart, negative_zeros);
    assert_true(triangles > 1000 * (uint64_t)(end - first));
    assert_true(apart > 5 * (end - first) && negative_zeros > 0);
    gpu_readback_free(&device, &read);
    gpu_readback_free(&device, &read_anew);
    for (int n = 0; n < 9; ++n) {
        girih_plan_destroy(plans[n / 3][n % 3]);
    }
    deformation_close(&host);
    gpu_capture_close(&capture);
    girih_scene_destroy(scene);
    girih_surface_program_destroy(program);
    girih_context_destroy(context);
}

static void frames_are_as_prepared_anew(void **state) {
    (void)state;
    check_frames((gpu_variant){0}, 0, FRAMES / 2);
    check_frames((gpu_variant){.linear = 1, .few_buffers = 1}, FRAMES / 2, FRAMES);
}

// --- The previous frame -------------------------------------------------------------------------

static void run_deformation(deformation *host, const girih_scene *scene, bool keep, float time) {
    VkCommandBuffer commands = gpu_begin(&device);
    if (keep) {
        girih_cmd_keep_vertices(scene, commands);
    }
    if (time >= 0) {
        record_deformation(host, commands, time);
    }
    gpu_run(&device, commands);
}

static const float *previous_of(const gpu_readback *read, uint32_t vertex) {
    return own_normal(read, vertex, 8) + 5;
}

// The positions of all corners of a baked or welded frame, this one's or the previous one's
// (free()).
static float *read_corners(const girih_plan *plan, const gpu_readback *read, bool previous) {
    const size_t count = 3 * (size_t)girih_plan_statistics(plan).output_triangles;
    float *result = malloc(count * 12);
    assert_non_null(result);
    for (size_t n = 0; n < count; ++n) {
        const uint32_t vertex = read->words[GIRIH_BIND_OUT_INDICES][n];
        memcpy(result + 3 * n, previous ? previous_of(read, vertex) : own_position(read, vertex),
               12);
    }
    return result;
}

// Kept vertices are the previous frame's: what moved was where the frame before put it, baked,
// welded and drawn.
static void check_previous(gpu_variant variant) {
    girih_context *context = gpu_variant_context(&device, variant);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    girih_scene *scene = make_scene(context, meshes, 1, 1);
    gpu_capture capture = gpu_capture_open(&device, context);
    own_capture(&capture, &textures, OWN_NASTY);
    capture.previous = true;
    deformation host = deformation_open(scene);
    gpu_readback read = {0};
    const girih_frame frame = {
        .rule = GIRIH_LEVEL_SEGMENTS, .segments = 8, .surface_set = textures.set};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan_desc desc = plan_of(scene, program, GIRIH_SURFACE_OWN, (girih_mode)mode);
        desc.outputs |= GIRIH_OUTPUT_PREVIOUS;
        girih_plan *plan = own_make_plan(context, desc);
        girih_plan *instanced = own_make_plan(
            context, plan_of(scene, program, GIRIH_SURFACE_OWN, GIRIH_MODE_INSTANCED));
        run_deformation(&host, scene, false, 1);
        run_deformation(&host, scene, true, -1);
        float *before = NULL;
        for (int n = 0; n < 6; ++n) {
            const bool still = n % 3 == 0; // kept, and not moved since
            if (n > 0) {
                run_deformation(&host, scene, true, still ? -1 : (float)n + 1);
            }
            gpu_refine(&device, plan, &frame, &read);
            const size_t triangles = girih_plan_statistics(plan).output_triangles;
            float *now = read_corners(plan, &read, false);
            float *previous = read_corners(plan, &read, true);
            assert_int_equal(memcmp(now, previous, triangles * 36) == 0, still);
            if (before) {
                assert_memory_equal(previous, before, triangles * 36);
            }
            girih_plan_invalidate(instanced);
            assert_int_equal(gpu_draw(&capture, instanced, &frame, ROOM), triangles);
            const float *drawn = capture.corners.mapped;
            for (size_t k = 0; k < 3 * triangles; ++k) {
                assert_memory_equal(drawn + GPU_CAPTURE_FLOATS * k, previous + 3 * k, 12);
            }
            free(previous);
            free(before);
            before = now;
        }
        free(before);
        girih_plan_destroy(plan);
        girih_plan_destroy(instanced);
    }
    gpu_readback_free(&device, &read);
    deformation_close(&host);
    gpu_capture_close(&capture);
    girih_scene_destroy(scene);
    girih_surface_program_destroy(program);
    girih_context_destroy(context);
}

static void previous_frames_are_kept(void **state) {
    (void)state;
    check_previous((gpu_variant){0});
    check_previous((gpu_variant){.few_buffers = 1});
}

// --- Wrong calls --------------------------------------------------------------------------------

static void assert_refused(girih_result result, const char *word, girih_error *error) {
    assert_int_equal(result, GIRIH_ERROR_INVALID_ARGUMENT);
    if (!strstr(error->message, word) || strchr(error->message, '\n')) {
        fail_msg("'%s' does not speak of '%s' in one line", error->message, word);
    }
    *error = (girih_error){0};
}

static void wrong_calls_are_refused(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *rigid = make_drum(5, 2);
    girih_scene *scene = NULL;
    girih_error error = {0};
    girih_scene_desc desc = {.meshes = &rigid, .mesh_count = 1, .dynamic = 1};
    assert_refused(girih_scene_create(context, &desc, &scene, &error), "dynamic", &error);
    desc = (girih_scene_desc){.meshes = meshes, .mesh_count = 2, .previous = 1};
    assert_refused(girih_scene_create(context, &desc, &scene, &error), "dynamic", &error);
    assert_null(scene);
    girih_buffer_range range;
    VkDeviceSize size;
    scene = make_scene(context, meshes, 0, 0); // a dynamic mesh may stand still
    assert_refused(girih_scene_vertices(scene, 0, &range, &size, &error), "dynamic", &error);
    girih_scene_destroy(scene);
    scene = make_scene(context, meshes, 1, 0);
    assert_refused(girih_scene_vertices(scene, 2, &range, &size, &error), "mesh 2", &error);
    assert_refused(girih_scene_vertices(scene, 0, NULL, &size, &error), "range", &error);
    girih_scene_destroy(scene);
    girih_mesh_destroy(rigid);
    girih_context_destroy(context);
}

int main(void) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    textures = own_set_open(&device, settings);
    const girih_mesh *const rigid[2] = {make_cube(1), make_drum(6, 3)};
    for (int n = 0; n < 2; ++n) {
        meshes[n] = make_copy(rigid[n], NULL, 0, 1);
        girih_mesh_destroy(rigid[n]);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_as_prepared_anew),
        cmocka_unit_test(previous_frames_are_kept),
        cmocka_unit_test(wrong_calls_are_refused),
    };
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    girih_mesh_destroy(meshes[0]);
    girih_mesh_destroy(meshes[1]);
    own_set_close(&device, &textures);
    const unsigned messages = gpu_close(&device);
    if (messages) {
        print_error("%u validation messages\n", messages);
    }
    return messages != 0;
}
