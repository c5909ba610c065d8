// Case `spheres`: few triangles refined far, many refined little; Curved PN, random dyadic levels
// that change every frame, against the same triangles as one static, welded, cache-optimised
// indexed draw.
#include <stdlib.h>
#include <string.h>

#include <meshoptimizer.h>

#include "bench.h"
#include "error.h"
#include "icosphere.h"
#include "vertex_shader.h"

typedef struct sphere_case {
    const char *name;
    uint32_t halvings;  // of the icosahedron's edges: 20 * 4^halvings triangles
    uint32_t max_level; // of the random levels
} sphere_case;

static const sphere_case cases[] = {{"spheres 1,280 to level 5", 3, 5},
                                    {"spheres 20,480 to level 3", 5, 3},
                                    {"spheres 327,680 to level 1", 7, 1}};

static girih_result make_sphere(uint32_t halvings, const girih_mesh **mesh, girih_error *error) {
    bench_icosphere sphere;
    girih_result result = bench_icosphere_make(halvings, &sphere, error);
    if (result == GIRIH_OK) {
        const girih_mesh_desc desc = {.name = "sphere",
                                      .vertex_count = sphere.vertex_count,
                                      .positions = sphere.positions,
                                      .normals = sphere.positions,
                                      .indices = sphere.indices,
                                      .index_count = sphere.index_count};
        result = girih_mesh_create(&desc, mesh, error);
    }
    bench_icosphere_free(&sphere);
    return result;
}

// --- The static mesh ----------------------------------------------------------------------------

typedef struct static_mesh {
    girih_device_buffer positions, normals, indices;
    uint32_t index_count;
} static_mesh;

static void draw_static(void *state, VkCommandBuffer commands) {
    const static_mesh *mesh = state;
    const VkBuffer buffers[2] = {mesh->positions.buffer, mesh->normals.buffer};
    const VkDeviceSize offsets[2] = {0, 0};
    vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
    vkCmdBindIndexBuffer(commands, mesh->indices.buffer, 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands, mesh->index_count, 1, 0, 0, 0);
}

// The refined mesh of one frame, made by the CPU twin, welded, in vertex cache and vertex fetch
// order.
static girih_result make_static(girih_device *device, const girih_mesh *mesh,
                                const girih_frame *frame, static_mesh *out,
                                girih_statistics *statistics, girih_error *error) {
    const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const girih_cpu_desc desc = {.meshes = &mesh,
                                 .mesh_count = 1,
                                 .instances = &instance,
                                 .instance_count = 1,
                                 .surface = GIRIH_SURFACE_PN,
                                 .mode = GIRIH_MODE_WELDED};
    girih_cpu_output output = {0};
    girih_result result = girih_cpu_refine(&desc, frame, &output, error);
    if (result != GIRIH_OK) {
        return result;
    }
    *statistics = output.statistics;
    const size_t vertices = output.statistics.output_vertices;
    const size_t indices = 3 * output.statistics.output_triangles;
    out->index_count = (uint32_t)indices;
    uint32_t *remap = malloc(vertices * 4);
    if (!remap) {
        girih_cpu_output_free(&output);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    meshopt_optimizeVertexCache(output.indices, output.indices, indices, vertices);
    meshopt_optimizeVertexFetchRemap(remap, output.indices, indices, vertices);
    meshopt_remapIndexBuffer(output.indices, output.indices, indices, remap);
    meshopt_remapVertexBuffer(output.positions, output.positions, vertices, 12, remap);
    meshopt_remapVertexBuffer(output.attributes, output.attributes, vertices, 12, remap);
    free(remap);
    const struct {
        girih_device_buffer *buffer;
        const void *bytes;
        VkDeviceSize size;
        VkBufferUsageFlags usage;
    } parts[3] = {
        {&out->positions, output.positions, vertices * 12, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT},
        {&out->normals, output.attributes, vertices * 12, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT},
        {&out->indices, output.indices, indices * 4, VK_BUFFER_USAGE_INDEX_BUFFER_BIT}};
    for (int n = 0; n < 3 && result == GIRIH_OK; ++n) {
        result = girih_device_buffer_create(device, parts[n].buffer, parts[n].size,
                                            parts[n].usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                            GIRIH_MEMORY_DEVICE, error);
        if (result == GIRIH_OK) {
            result = girih_device_write(device, parts[n].buffer->buffer, parts[n].bytes,
                                        parts[n].size, error);
        }
    }
    girih_cpu_output_free(&output);
    return result;
}

// --- girih --------------------------------------------------------------------------------------

typedef struct girih_state {
    girih_plan *plan;
    girih_frame frame;
} girih_state;

static girih_result prepare_girih(void *state, VkCommandBuffer commands, uint32_t frame,
                                  girih_error *error) {
    girih_state *s = state;
    // Odd frames are the static mesh's own levels; even ones others, so that levels change every
    // frame.
    s->frame.seed = frame % 2 ? 1 : 2 + frame;
    return girih_cmd_refine(s->plan, commands, &s->frame, NULL, error);
}

static void draw_girih(void *state, VkCommandBuffer commands) {
    const girih_state *s = state;
    girih_cmd_draw(s->plan, commands, 0, VK_NULL_HANDLE, 0);
}

// Everything of one case; zero is nothing.
typedef struct case_state {
    const girih_mesh *mesh;
    girih_context *context;
    girih_scene *scene;
    girih_state baked, instanced, unchanged;
    static_mesh rival;
    bench_target *target;
} case_state;

static void end_case(girih_device *device, case_state *s) {
    bench_target_destroy(s->target);
    girih_device_buffer_destroy(device, &s->rival.positions);
    girih_device_buffer_destroy(device, &s->rival.normals);
    girih_device_buffer_destroy(device, &s->rival.indices);
    girih_plan_destroy(s->baked.plan);
    girih_plan_destroy(s->instanced.plan);
    girih_plan_destroy(s->unchanged.plan);
    girih_scene_destroy(s->scene);
    girih_context_destroy(s->context);
    girih_mesh_destroy(s->mesh);
}

static girih_result make_plan(case_state *s, girih_mode mode, const girih_frame *frame,
                              const girih_statistics *room, girih_state *out, girih_error *error) {
    const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    // A tenth more than the static mesh: levels of other seeds ask for a little more or less.
    const girih_plan_desc desc = {
        .scene = s->scene,
        .instances = &instance,
        .instance_count = 1,
        .surface = GIRIH_SURFACE_PN,
        .mode = mode,
        .max_vertices = (uint32_t)(4 * room->output_triangles),
        .max_triangles = (uint32_t)(room->output_triangles + room->output_triangles / 10)};
    out->frame = *frame;
    return girih_plan_create(s->context, &desc, &out->plan, error);
}

static girih_result upload(girih_device *device, case_state *s, girih_error *error) {
    girih_result result = girih_device_begin(device, error);
    if (result == GIRIH_OK) {
        girih_cmd_upload_context(s->context, device->commands);
        girih_cmd_upload_scene(s->scene, device->commands);
        // What the method `girih-unchanged` draws again and again.
        result =
            girih_cmd_refine(s->unchanged.plan, device->commands, &s->unchanged.frame, NULL, error);
    }
    return result == GIRIH_OK ? girih_device_finish(device, error) : result;
}

static girih_result run_case(girih_device *device, const sphere_case *c, uint32_t pairs,
                             case_state *s, json_t *list, girih_error *error) {
    const girih_frame frame = {
        .rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = c->max_level, .seed = 1};
    girih_statistics statistics = {0};
    girih_result result = make_sphere(c->halvings, &s->mesh, error);
    if (result == GIRIH_OK) {
        result = make_static(device, s->mesh, &frame, &s->rival, &statistics, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_context(device, NULL, &s->context, error);
    }
    if (result == GIRIH_OK) {
        result = girih_scene_create(
            s->context, &(girih_scene_desc){.meshes = &s->mesh, .mesh_count = 1}, &s->scene, error);
    }
    const bool can_instance =
        device->features.multiDrawIndirect && device->features.drawIndirectFirstInstance;
    girih_state *const states[3] = {&s->baked, &s->unchanged, &s->instanced};
    const uint32_t state_count = can_instance ? 3 : 2;
    for (uint32_t n = 0; n < state_count && result == GIRIH_OK; ++n) {
        result = make_plan(s, n == 2 ? GIRIH_MODE_INSTANCED : GIRIH_MODE_BAKED, &frame, &statistics,
                           states[n], error);
    }
    if (result == GIRIH_OK) {
        result = upload(device, s, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    const VkPipelineVertexInputStateCreateInfo *input = girih_plan_vertex_input(s->baked.plan);
    bench_method methods[4] = {
        {"static", &s->rival, NULL, draw_static, input, NULL, 0},
        {"girih", &s->baked, prepare_girih, draw_girih, input, NULL, 0},
        {"girih-unchanged", &s->unchanged, NULL, draw_girih, input, NULL, 0}};
    if (can_instance) {
        methods[3] = (bench_method){"girih-instanced", &s->instanced, prepare_girih, draw_girih,
                                    girih_plan_vertex_input(s->instanced.plan), NULL, 0};
    }
    for (uint32_t n = 0; n <= state_count; ++n) {
        bench_set_vertex_shader(&methods[n], n == 3 ? GIRIH_MODE_INSTANCED : GIRIH_MODE_BAKED);
    }
    result = bench_target_create(device, methods, state_count + 1, &s->target, error);
    json_t *figures = json_object();
    if (result == GIRIH_OK) {
        result = bench_measure(s->target, methods, state_count + 1, pairs, figures, error);
    }
    if (result == GIRIH_OK && girih_plan_statistics(s->baked.plan).overflow) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE, "%s: the frames did not fit their plan",
                            c->name);
    }
    if (result == GIRIH_OK) {
        json_array_append_new(
            list, json_pack("{s:s,s:I,s:I,s:o}", "name", c->name, "input_triangles",
                            (json_int_t)statistics.input_triangles, "output_triangles",
                            (json_int_t)statistics.output_triangles, "methods", figures));
    } else {
        json_decref(figures);
    }
    return result;
}

girih_result bench_spheres(girih_device *device, uint32_t pairs, json_t *list, girih_error *error) {
    girih_result result = GIRIH_OK;
    for (size_t n = 0; n < sizeof cases / sizeof *cases && result == GIRIH_OK; ++n) {
        case_state state = {0};
        result = run_case(device, &cases[n], pairs, &state, list, error);
        end_case(device, &state);
    }
    return result;
}
