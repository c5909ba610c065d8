// A case's mesh, prepared once for all methods.
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "error.h"
#include "icosphere.h"

// Parts of split triangles, while it is not known how many there are.
#define MOST_SPLITS (1u << 18)

girih_result bench_mesh_allocate(bench_mesh *mesh, uint32_t vertex_count, uint32_t triangle_count,
                                 girih_error *error) {
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    mesh->positions = malloc((size_t)vertex_count * 12);
    mesh->normals = malloc((size_t)vertex_count * 12);
    mesh->indices = malloc((size_t)triangle_count * 12);
    if (!mesh->positions || !mesh->normals || !mesh->indices) {
        bench_mesh_free(mesh);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "out of memory for a mesh of %u triangles", triangle_count);
    }
    return GIRIH_OK;
}

void bench_mesh_free(bench_mesh *mesh) {
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->indices);
    *mesh = (bench_mesh){0};
}

girih_result bench_sphere(uint32_t halvings, bench_mesh *mesh, girih_error *error) {
    bench_icosphere sphere = {0};
    girih_result result = bench_icosphere_make(halvings, &sphere, error);
    if (result == GIRIH_OK) {
        result = bench_mesh_allocate(mesh, sphere.vertex_count, sphere.index_count / 3, error);
    }
    if (result == GIRIH_OK) {
        const size_t bytes = (size_t)sphere.vertex_count * 12;
        mesh->name = "sphere";
        memcpy(mesh->positions, sphere.positions, bytes);
        memcpy(mesh->normals, sphere.positions, bytes);
        memcpy(mesh->indices, sphere.indices, (size_t)sphere.index_count * 4);
    }
    bench_icosphere_free(&sphere);
    return result;
}

static girih_result upload_mesh(girih_device *device, bench_job *job, girih_error *error) {
    const VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
        VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    const VkDeviceSize vertex_bytes = (VkDeviceSize)job->vertex_count * 24;
    const VkDeviceSize index_bytes = (VkDeviceSize)job->triangle_count * 12;
    float *vertices = malloc(vertex_bytes);
    if (!vertices) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t n = 0; n < job->vertex_count; ++n) {
        memcpy(vertices + 6 * n, job->positions + 3 * n, 12);
        memcpy(vertices + 6 * n + 3, job->normals + 3 * n, 12);
    }
    girih_result result = girih_device_buffer_create(device, &job->vertex_buffer, vertex_bytes,
                                                     usage, GIRIH_MEMORY_DEVICE, error);
    if (result == GIRIH_OK) {
        result = girih_device_buffer_create(device, &job->index_buffer, index_bytes, usage,
                                            GIRIH_MEMORY_DEVICE, error);
    }
    if (result == GIRIH_OK) {
        result =
            girih_device_write(device, job->vertex_buffer.buffer, vertices, vertex_bytes, error);
    }
    if (result == GIRIH_OK) {
        result =
            girih_device_write(device, job->index_buffer.buffer, job->indices, index_bytes, error);
    }
    free(vertices);
    return result;
}

girih_result bench_scene_create(girih_device *device, const girih_catalogue *catalogue,
                                const girih_mesh *mesh, girih_context **context,
                                girih_scene **scene, girih_error *error) {
    girih_result result = girih_device_context(device, catalogue, context, error);
    if (result == GIRIH_OK) {
        const girih_scene_desc desc = {.meshes = &mesh, .mesh_count = 1};
        result = girih_scene_create(*context, &desc, scene, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_begin(device, error);
    }
    if (result == GIRIH_OK) {
        girih_cmd_upload_context(*context, device->commands);
        girih_cmd_upload_scene(*scene, device->commands);
        result = girih_device_finish(device, error);
    }
    return result;
}

// Frames in a plan that has room for what the job has room for, or for level 0 alone.
static girih_result count_frames(bench_case_job *job, uint32_t room_triangles, uint32_t room_splits,
                                 girih_error *error) {
    const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const girih_plan_desc desc = {.scene = job->job.scene,
                                  .instances = &instance,
                                  .instance_count = 1,
                                  .surface = job->job.surface,
                                  .mode = GIRIH_MODE_BAKED,
                                  .max_vertices = 4 * room_triangles,
                                  .max_triangles = room_triangles,
                                  .max_segments = job->desc.max_segments,
                                  .max_splits = room_splits};
    girih_device *device = job->job.device;
    girih_plan *plan = NULL;
    double triangles = 0.0, vertices = 0.0, parts = 0.0, groups = 0.0;
    uint64_t most_triangles = 0, most_splits = 0;
    girih_result result = girih_plan_create(job->job.context, &desc, &plan, error);
    for (uint32_t n = 0; n < job->desc.frame_count && result == GIRIH_OK; ++n) {
        girih_frame frame = {0};
        bench_view view;
        job->desc.frame(job->desc.user, n, &frame, &view);
        result = girih_device_begin(device, error);
        if (result == GIRIH_OK) {
            result = girih_cmd_refine(plan, device->commands, &frame, NULL, error);
        }
        if (result == GIRIH_OK) {
            result = girih_device_finish(device, error);
        }
        const girih_statistics statistics = girih_plan_statistics(plan);
        triangles += (double)statistics.needed_triangles;
        vertices += (double)statistics.needed_vertices;
        parts += (double)statistics.parts;
        groups += statistics.groups;
        if (statistics.needed_triangles > most_triangles) {
            most_triangles = statistics.needed_triangles;
        }
        if (statistics.needed_splits > most_splits) {
            most_splits = statistics.needed_splits;
        }
        if (n == 1) {
            job->reference = statistics;
            job->job.reference = frame;
        }
    }
    girih_plan_destroy(plan);
    if (result == GIRIH_OK && most_splits > room_splits) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE, "%s: more than %u parts", job->job.name,
                            room_splits);
    }
    job->job.room_triangles = (uint32_t)most_triangles;
    job->job.room_splits = (uint32_t)most_splits;
    job->mean_triangles = triangles / job->desc.frame_count;
    job->mean_vertices = vertices / job->desc.frame_count;
    job->mean_parts = parts / job->desc.frame_count;
    job->mean_groups = groups / job->desc.frame_count;
    return result;
}

girih_result bench_count_frames(bench_case_job *job, girih_error *error) {
    return count_frames(job, 0, job->desc.max_segments ? MOST_SPLITS : 0, error);
}

girih_result bench_count_groups(bench_case_job *job, girih_error *error) {
    return count_frames(job, job->job.room_triangles, job->job.room_splits, error);
}

girih_result bench_job_create(bench_target *target, girih_device *device,
                              const bench_job_desc *desc, bench_case_job *job, girih_error *error) {
    *job = (bench_case_job){.desc = *desc,
                            .job = {.target = target,
                                    .device = device,
                                    .name = desc->name,
                                    .positions = desc->mesh->positions,
                                    .normals = desc->mesh->normals,
                                    .indices = desc->mesh->indices,
                                    .vertex_count = desc->mesh->vertex_count,
                                    .triangle_count = desc->mesh->triangle_count,
                                    .catalogue = desc->catalogue,
                                    .surface = desc->surface,
                                    .max_segments = desc->max_segments}};
    if (job->desc.frame_count == 0) {
        job->desc.frame_count = BENCH_FRAMES;
    }
    const girih_mesh_desc mesh = {.name = desc->mesh->name,
                                  .vertex_count = desc->mesh->vertex_count,
                                  .positions = desc->mesh->positions,
                                  .normals = desc->mesh->normals,
                                  .indices = desc->mesh->indices,
                                  .index_count = 3 * desc->mesh->triangle_count};
    girih_result result = girih_mesh_create(&mesh, &job->job.mesh, error);
    if (result == GIRIH_OK) {
        result = bench_scene_create(device, desc->catalogue, job->job.mesh, &job->job.context,
                                    &job->job.scene, error);
    }
    if (result == GIRIH_OK) {
        result = upload_mesh(device, &job->job, error);
    }
    if (result == GIRIH_OK) {
        result = bench_count_frames(job, error);
    }
    if (result != GIRIH_OK) {
        bench_job_destroy(job);
    }
    return result;
}

void bench_job_destroy(bench_case_job *job) {
    if (!job->job.device) {
        return;
    }
    girih_device_buffer_destroy(job->job.device, &job->job.vertex_buffer);
    girih_device_buffer_destroy(job->job.device, &job->job.index_buffer);
    girih_scene_destroy(job->job.scene);
    girih_context_destroy(job->job.context);
    girih_mesh_destroy(job->job.mesh);
    *job = (bench_case_job){0};
}

void bench_random_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view) {
    const uint32_t *most = user;
    *frame = (girih_frame){
        .rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = *most, .seed = n % 2 ? 1 : 2 + n};
    // A unit sphere seen whole: orthographic, looking along -z.
    *view = (bench_view){
        .rows = {{0.9f, 0, 0, 0}, {0, -0.9f, 0, 0}, {0, 0, -0.4f, 0.5f}, {0, 0, 0, 1}}};
}
