// Case `instances`: a thousand instances of a hundred meshes against one mesh of the same
// triangles; Curved PN, random dyadic levels that change every frame.
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "error.h"
#include "icosphere.h"
#include "methods.h"

#define MESHES 100u
#define INSTANCES 1000u
#define HALVINGS 2u // 320 triangles

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

// --- The method: a scene of a hundred meshes ----------------------------------------------------

typedef struct many {
    girih_scene *scene;
    void *own;
} many;

static void destroy(void *state) {
    many *m = state;
    if (m) {
        bench_girih_destroy(m->own);
        girih_scene_destroy(m->scene);
        free(m);
    }
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

static girih_result make_scene(const bench_job *job, many *m, girih_error *error) {
    const girih_mesh *meshes[MESHES] = {NULL};
    bench_icosphere sphere = {0};
    girih_result result = bench_icosphere_make(HALVINGS, &sphere, error);
    if (result == GIRIH_OK) {
        result = make_meshes(&sphere, meshes, error);
    }
    if (result == GIRIH_OK) {
        const girih_scene_desc desc = {.meshes = meshes, .mesh_count = MESHES};
        result = girih_scene_create(job->context, &desc, &m->scene, error);
    }
    for (uint32_t n = 0; n < MESHES; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
    bench_icosphere_free(&sphere);
    if (result == GIRIH_OK) {
        result = girih_device_begin(job->device, error);
    }
    if (result == GIRIH_OK) {
        girih_cmd_upload_scene(m->scene, job->device->commands);
        result = girih_device_finish(job->device, error);
    }
    return result;
}

static girih_result make_plan(const bench_job *job, girih_mode mode, many *m, girih_error *error) {
    girih_instance *instances = malloc(INSTANCES * sizeof *instances);
    if (!instances) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < INSTANCES; ++n) {
        place(n, &instances[n]);
    }
    const girih_plan_desc desc = {.scene = m->scene,
                                  .instances = instances,
                                  .instance_count = INSTANCES,
                                  .surface = job->surface,
                                  .mode = mode,
                                  .max_vertices = 6 * job->triangle_count,
                                  .max_triangles = 4 * job->triangle_count};
    const girih_result result = bench_girih_create(job, job->context, &desc, &m->own, error);
    free(instances);
    return result;
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    many *m = calloc(1, sizeof *m);
    if (!m) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = make_scene(job, m, error);
    if (result == GIRIH_OK) {
        result = make_plan(job, (girih_mode)variant, m, error);
    }
    if (result != GIRIH_OK) {
        destroy(m);
        return result;
    }
    *state = m;
    return GIRIH_OK;
}

static girih_result prepare(void *state, VkCommandBuffer commands, girih_error *error) {
    return bench_girih_prepare(((many *)state)->own, commands, error);
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    bench_girih_draw(((many *)state)->own, commands, raster);
}

static bool overflow(void *state) {
    return bench_girih_overflow(((many *)state)->own);
}

#define MANY(MODE)                                                                                 \
    {                                                                                              \
        .name = "girih-instances", .follows = "this project", .variant = MODE, .create = create,   \
        .destroy = destroy, .prepare = prepare, .draw = draw, .overflow = overflow                 \
    }
static const bench_method many_baked = MANY(GIRIH_MODE_BAKED);
static const bench_method many_instanced = MANY(GIRIH_MODE_INSTANCED);

// --- The case -----------------------------------------------------------------------------------

// All instances in one mesh.
static girih_result make_one(bench_mesh *mesh, girih_error *error) {
    bench_icosphere sphere = {0};
    girih_result result = bench_icosphere_make(HALVINGS, &sphere, error);
    if (result == GIRIH_OK) {
        result = bench_mesh_allocate(mesh, INSTANCES * sphere.vertex_count,
                                     INSTANCES * sphere.index_count / 3, error);
    }
    const size_t floats = 3 * (size_t)sphere.vertex_count;
    for (uint32_t n = 0; n < INSTANCES && result == GIRIH_OK; ++n) {
        girih_instance instance;
        place(n, &instance);
        for (size_t k = 0; k < floats; ++k) {
            mesh->positions[n * floats + k] = sphere.positions[k] * radius_of(instance.mesh) +
                                              instance.transform[4 * (k % 3) + 3];
        }
        memcpy(mesh->normals + n * floats, sphere.positions, floats * 4);
        for (uint32_t k = 0; k < sphere.index_count; ++k) {
            mesh->indices[(size_t)n * sphere.index_count + k] =
                sphere.indices[k] + n * sphere.vertex_count;
        }
    }
    bench_icosphere_free(&sphere);
    return result;
}

// All spheres in sight: orthographic, looking along -z. New levels every frame.
static void frame(const void *user, uint32_t n, girih_frame *out, bench_view *view) {
    (void)user;
    *out = (girih_frame){.rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = 1, .seed = n};
    *view = (bench_view){
        .rows = {{0.045f, 0, 0, -0.8f}, {0, -0.045f, 0, 0.8f}, {0, 0, -0.02f, 0.8f}, {0, 0, 0, 1}}};
}

girih_result bench_instances(const bench_run *run, girih_error *error) {
    static const struct {
        const char *name;
        const bench_method *methods[2];
    } cases[] = {{"instances, baked", {&bench_girih_baked, &many_baked}},
                 {"instances, instanced", {&bench_girih_instanced, &many_instanced}}};
    bench_mesh mesh = {0};
    bench_target *target = NULL;
    girih_result result = make_one(&mesh, error);
    if (result == GIRIH_OK) {
        result = bench_target_create(run->device, &target, error);
    }
    for (size_t n = 0; n < sizeof cases / sizeof *cases && result == GIRIH_OK; ++n) {
        const bench_job_desc desc = {.name = cases[n].name,
                                     .mesh = &mesh,
                                     .catalogue = bench_uniform_dyadic(),
                                     .surface = GIRIH_SURFACE_PN,
                                     .frame = frame};
        result = bench_run_job(run, target, &desc, cases[n].methods, 2, error);
    }
    bench_target_destroy(target);
    bench_mesh_free(&mesh);
    return result;
}
