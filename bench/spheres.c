// Case `spheres`: few triangles refined far, many refined little; Curved PN, random dyadic levels
// that change every frame, against the same triangles as one static, welded, cache-optimised
// indexed draw.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <meshoptimizer.h>

#include "bench.h"
#include "error.h"

#include "bench_baked.spv.h"
#include "bench_instanced.spv.h"

typedef struct sphere_case {
    const char *name;
    uint32_t halvings;  // of the icosahedron's edges: 20 * 4^halvings triangles
    uint32_t max_level; // of the random levels
} sphere_case;

static const sphere_case cases[] = {{"spheres 1,280 to level 5", 3, 5},
                                    {"spheres 20,480 to level 3", 5, 3},
                                    {"spheres 327,680 to level 1", 7, 1}};

// --- The input ----------------------------------------------------------------------------------

typedef struct sphere {
    float *positions; // of a unit sphere, so they are the normals too
    uint32_t vertex_count;
    uint32_t *indices;
    uint32_t index_count;
} sphere;

static uint32_t sphere_vertex(sphere *s, const float p[3]) {
    const double length = sqrt((double)p[0] * (double)p[0] + (double)p[1] * (double)p[1] +
                               (double)p[2] * (double)p[2]);
    for (int n = 0; n < 3; ++n) {
        s->positions[3 * s->vertex_count + (uint32_t)n] = (float)((double)p[n] / length);
    }
    return s->vertex_count++;
}

// Splits every triangle into four. Midpoints are found again through a chained table by the smaller
// vertex.
static girih_result halve(sphere *s, girih_error *error) {
    const uint32_t triangles = s->index_count / 3;
    const uint32_t before = s->vertex_count;
    sphere fine = {.vertex_count = before, .index_count = 4 * s->index_count};
    fine.positions = malloc(((size_t)before + triangles * 3 / 2) * 12);
    fine.indices = malloc((size_t)fine.index_count * 4);
    uint32_t *heads = malloc((size_t)before * 4);
    uint32_t(*links)[2] = malloc((size_t)triangles * 3 / 2 * sizeof *links); // larger vertex, next
    if (!fine.positions || !fine.indices || !heads || !links) {
        free(fine.positions);
        free(fine.indices);
        free(heads);
        free(links);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    memcpy(fine.positions, s->positions, (size_t)before * 12);
    memset(heads, 0xff, (size_t)before * 4);
    for (uint32_t t = 0; t < triangles; ++t) {
        const uint32_t *corner = s->indices + 3 * t;
        uint32_t middle[3];
        for (uint32_t e = 0; e < 3; ++e) {
            const uint32_t a = corner[e];
            const uint32_t b = corner[(e + 1) % 3];
            const uint32_t low = a < b ? a : b;
            const uint32_t high = a < b ? b : a;
            uint32_t link = heads[low];
            while (link != UINT32_MAX && links[link][0] != high) {
                link = links[link][1];
            }
            if (link == UINT32_MAX) {
                const float *p = s->positions + 3 * low;
                const float *q = s->positions + 3 * high;
                const float sum[3] = {p[0] + q[0], p[1] + q[1], p[2] + q[2]};
                link = sphere_vertex(&fine, sum) - before;
                links[link][0] = high;
                links[link][1] = heads[low];
                heads[low] = link;
            }
            middle[e] = before + link;
        }
        const uint32_t four[12] = {corner[0], middle[0], middle[2], middle[0],
                                   corner[1], middle[1], middle[2], middle[1],
                                   corner[2], middle[0], middle[1], middle[2]};
        memcpy(fine.indices + 12 * (size_t)t, four, sizeof four);
    }
    free(heads);
    free(links);
    free(s->positions);
    free(s->indices);
    *s = fine;
    return GIRIH_OK;
}

static girih_result make_sphere(uint32_t halvings, const girih_mesh **mesh, girih_error *error) {
    static const float x = 0.525731112f, z = 0.850650808f;
    static const float corners[12][3] = {{-x, 0, z}, {x, 0, z},  {-x, 0, -z}, {x, 0, -z},
                                         {0, z, x},  {0, z, -x}, {0, -z, x},  {0, -z, -x},
                                         {z, x, 0},  {-z, x, 0}, {z, -x, 0},  {-z, -x, 0}};
    static const uint32_t faces[60] = {1,  4,  0, 4,  9, 0, 4, 5,  9, 8, 5, 4,  1,  8, 4,
                                       1,  10, 8, 10, 3, 8, 8, 3,  5, 3, 2, 5,  3,  7, 2,
                                       3,  10, 7, 10, 6, 7, 6, 11, 7, 6, 0, 11, 6,  1, 0,
                                       10, 1,  6, 11, 0, 9, 2, 11, 9, 5, 2, 9,  11, 2, 7};
    sphere s = {
        .positions = malloc(sizeof corners), .indices = malloc(sizeof faces), .index_count = 60};
    girih_result result = GIRIH_OK;
    if (!s.positions || !s.indices) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        memcpy(s.indices, faces, sizeof faces);
        for (uint32_t n = 0; n < 12; ++n) {
            sphere_vertex(&s, corners[n]);
        }
    }
    for (uint32_t n = 0; n < halvings && result == GIRIH_OK; ++n) {
        result = halve(&s, error);
    }
    if (result == GIRIH_OK) {
        const girih_mesh_desc desc = {.name = "sphere",
                                      .vertex_count = s.vertex_count,
                                      .positions = s.positions,
                                      .normals = s.positions,
                                      .indices = s.indices,
                                      .index_count = s.index_count};
        result = girih_mesh_create(&desc, mesh, error);
    }
    free(s.positions);
    free(s.indices);
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
    bench_method methods[4] = {
        {"static", &s->rival, NULL, draw_static, girih_plan_vertex_input(s->baked.plan),
         girih_spirv_bench_baked, sizeof girih_spirv_bench_baked},
        {"girih", &s->baked, prepare_girih, draw_girih, girih_plan_vertex_input(s->baked.plan),
         girih_spirv_bench_baked, sizeof girih_spirv_bench_baked},
        {"girih-unchanged", &s->unchanged, NULL, draw_girih,
         girih_plan_vertex_input(s->unchanged.plan), girih_spirv_bench_baked,
         sizeof girih_spirv_bench_baked}};
    if (can_instance) {
        methods[3] = (bench_method){"girih-instanced",
                                    &s->instanced,
                                    prepare_girih,
                                    draw_girih,
                                    girih_plan_vertex_input(s->instanced.plan),
                                    girih_spirv_bench_instanced,
                                    sizeof girih_spirv_bench_instanced};
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
