// Case `instances`: a thousand instances of a hundred meshes against one mesh of the same triangles;
// Curved PN, random dyadic levels that change every frame.
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "error.h"
#include "icosphere.h"
#include "vertex_shader.h"

#define MESHES 100u
#define INSTANCES 1000u
#define HALVINGS 2u // 320 triangles

static const struct {
    const char *name;
    girih_mode mode;
} cases[] = {{"instances, baked", GIRIH_MODE_BAKED},
             {"instances, instanced", GIRIH_MODE_INSTANCED}};

// Placed side by side; every mesh is a sphere of its own size.
static void place(uint32_t instance, girih_instance *out) {
    *out = (girih_instance){.mesh = instance % MESHES,
                            .transform = {1, 0, 0, (float)(instance % 10) * 4, 0, 1, 0,
                                          (float)(instance / 10 % 10) * 4, 0, 0, 1,
                                          (float)(instance / 100) * 4}};
}

static float radius_of(uint32_t mesh) {
    return 1.0f + (float)mesh / (float)MESHES;
}

static girih_result make_meshes(const bench_icosphere *sphere, const girih_mesh *meshes[MESHES],
                                girih_error *error) {
    float *positions = malloc((size_t)sphere->vertex_count * 12);
    girih_result result =
        positions ? GIRIH_OK : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    for (uint32_t n = 0; n < MESHES && result == GIRIH_OK; ++n) {
        for (uint32_t k = 0; k < 3 * sphere->vertex_count; ++k) {
            positions[k] = sphere->positions[k] * radius_of(n);
        }
        const girih_mesh_desc desc = {.vertex_count = sphere->vertex_count,
                                      .positions = positions,
                                      .normals = sphere->positions,
                                      .indices = sphere->indices,
                                      .index_count = sphere->index_count};
        result = girih_mesh_create(&desc, &meshes[n], error);
    }
    free(positions);
    return result;
}

// All instances in one mesh.
static girih_result make_one(const bench_icosphere *sphere, const girih_mesh **mesh,
                             girih_error *error) {
    const size_t floats = 3 * (size_t)sphere->vertex_count;
    float *positions = malloc(INSTANCES * floats * 4);
    float *normals = malloc(INSTANCES * floats * 4);
    uint32_t *indices = malloc((size_t)INSTANCES * sphere->index_count * 4);
    girih_result result = GIRIH_OK;
    if (!positions || !normals || !indices) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < INSTANCES && result == GIRIH_OK; ++n) {
        girih_instance instance;
        place(n, &instance);
        for (size_t k = 0; k < floats; ++k) {
            positions[n * floats + k] = sphere->positions[k] * radius_of(instance.mesh) +
                                        instance.transform[4 * (k % 3) + 3];
        }
        memcpy(normals + n * floats, sphere->positions, floats * 4);
        for (uint32_t k = 0; k < sphere->index_count; ++k) {
            indices[(size_t)n * sphere->index_count + k] =
                sphere->indices[k] + n * sphere->vertex_count;
        }
    }
    if (result == GIRIH_OK) {
        const girih_mesh_desc desc = {.vertex_count = INSTANCES * sphere->vertex_count,
                                      .positions = positions,
                                      .normals = normals,
                                      .indices = indices,
                                      .index_count = INSTANCES * sphere->index_count};
        result = girih_mesh_create(&desc, mesh, error);
    }
    free(positions);
    free(normals);
    free(indices);
    return result;
}

typedef struct side {
    girih_scene *scene;
    girih_plan *plan;
    uint32_t seed; // of its last frame: an unchanged frame would cost nothing
} side;

static girih_result prepare(void *state, VkCommandBuffer commands, uint32_t frame,
                            girih_error *error) {
    side *s = state;
    (void)frame;
    const girih_frame levels = {.rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = 1, .seed = ++s->seed};
    return girih_cmd_refine(s->plan, commands, &levels, NULL, error);
}

static void draw(void *state, VkCommandBuffer commands) {
    const side *s = state;
    girih_cmd_draw(s->plan, commands, 0, VK_NULL_HANDLE, 0);
}

typedef struct case_state {
    girih_context *context;
    side one, many;
    bench_target *target;
} case_state;

static girih_result make_side(case_state *s, girih_mode mode, const girih_mesh *const *meshes,
                              uint32_t mesh_count, const girih_instance *instances,
                              uint32_t instance_count, side *out, girih_error *error) {
    girih_result result = girih_scene_create(
        s->context, &(girih_scene_desc){.meshes = meshes, .mesh_count = mesh_count}, &out->scene,
        error);
    const uint32_t triangles = INSTANCES * (20u << (2 * HALVINGS));
    const girih_plan_desc desc = {.scene = out->scene,
                                  .instances = instances,
                                  .instance_count = instance_count,
                                  .surface = GIRIH_SURFACE_PN,
                                  .mode = mode,
                                  .max_vertices = 6 * triangles,
                                  .max_triangles = 4 * triangles};
    return result == GIRIH_OK ? girih_plan_create(s->context, &desc, &out->plan, error) : result;
}

static girih_result run_case(girih_device *device, size_t n, uint32_t pairs,
                             const girih_mesh *const *meshes, const girih_mesh *one, case_state *s,
                             json_t *list, girih_error *error) {
    girih_instance *instances = malloc(INSTANCES * sizeof *instances);
    girih_instance at_once;
    place(0, &at_once);
    if (!instances) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t k = 0; k < INSTANCES; ++k) {
        place(k, &instances[k]);
    }
    girih_result result = girih_device_context(device, NULL, &s->context, error);
    if (result == GIRIH_OK) {
        result = make_side(s, cases[n].mode, &one, 1, &at_once, 1, &s->one, error);
    }
    if (result == GIRIH_OK) {
        result = make_side(s, cases[n].mode, meshes, MESHES, instances, INSTANCES, &s->many, error);
    }
    free(instances);
    if (result == GIRIH_OK) {
        result = girih_device_begin(device, error);
    }
    if (result == GIRIH_OK) {
        girih_cmd_upload_context(s->context, device->commands);
        girih_cmd_upload_scene(s->one.scene, device->commands);
        girih_cmd_upload_scene(s->many.scene, device->commands);
        result = girih_device_finish(device, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    const VkPipelineVertexInputStateCreateInfo *input = girih_plan_vertex_input(s->one.plan);
    bench_method methods[2] = {{"one mesh", &s->one, prepare, draw, input, NULL, 0},
                               {"instances", &s->many, prepare, draw, input, NULL, 0}};
    bench_set_vertex_shader(&methods[0], cases[n].mode);
    bench_set_vertex_shader(&methods[1], cases[n].mode);
    result = bench_target_create(device, methods, 2, &s->target, error);
    json_t *figures = json_object();
    if (result == GIRIH_OK) {
        result = bench_measure(s->target, methods, 2, pairs, figures, error);
    }
    const girih_statistics statistics = girih_plan_statistics(s->many.plan);
    if (result == GIRIH_OK && statistics.overflow) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE, "%s: the frames did not fit their plan",
                            cases[n].name);
    }
    if (result != GIRIH_OK) {
        json_decref(figures);
        return result;
    }
    json_array_append_new(
        list, json_pack("{s:s,s:I,s:I,s:o}", "name", cases[n].name, "input_triangles",
                        (json_int_t)statistics.input_triangles, "output_triangles",
                        (json_int_t)statistics.output_triangles, "methods", figures));
    return GIRIH_OK;
}

static void end_case(case_state *s) {
    bench_target_destroy(s->target);
    girih_plan_destroy(s->one.plan);
    girih_plan_destroy(s->many.plan);
    girih_scene_destroy(s->one.scene);
    girih_scene_destroy(s->many.scene);
    girih_context_destroy(s->context);
}

girih_result bench_instances(girih_device *device, uint32_t pairs, json_t *list,
                             girih_error *error) {
    bench_icosphere sphere = {0};
    const girih_mesh *meshes[MESHES] = {NULL};
    const girih_mesh *one = NULL;
    girih_result result = bench_icosphere_make(HALVINGS, &sphere, error);
    if (result == GIRIH_OK) {
        result = make_meshes(&sphere, meshes, error);
    }
    if (result == GIRIH_OK) {
        result = make_one(&sphere, &one, error);
    }
    const bool can_instance =
        device->features.multiDrawIndirect && device->features.drawIndirectFirstInstance;
    for (size_t n = 0; n < sizeof cases / sizeof *cases && result == GIRIH_OK; ++n) {
        if (cases[n].mode != GIRIH_MODE_INSTANCED || can_instance) {
            case_state state = {0};
            result = run_case(device, n, pairs, meshes, one, &state, list, error);
            end_case(&state);
        }
    }
    for (uint32_t n = 0; n < MESHES; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
    girih_mesh_destroy(one);
    bench_icosphere_free(&sphere);
    return result;
}
