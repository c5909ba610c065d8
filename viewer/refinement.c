#include "refinement.h"

#include "error.h"

girih_result girih_refinement_scene(girih_device *device, girih_context *context,
                                    const girih_mesh *const *meshes, uint32_t mesh_count,
                                    girih_scene **scene, girih_error *error) {
    girih_report_progress("uploading");
    girih_result result = girih_scene_create(
        context, &(girih_scene_desc){.meshes = meshes, .mesh_count = mesh_count}, scene, error);
    if (result == GIRIH_OK) {
        result = girih_device_begin(device, error);
        if (result == GIRIH_OK) {
            girih_cmd_upload_context(context, device->commands);
            girih_cmd_upload_scene(*scene, device->commands);
            result = girih_device_finish(device, error);
        }
        if (result == GIRIH_OK) {
            girih_context_trim(context);
            girih_scene_trim(*scene);
        } else {
            girih_scene_destroy(*scene);
            *scene = NULL;
        }
    }
    return result;
}

// What a plan's creation says; where the levels made it too large (`grown`), with the size they
// asked for and what to do.
static girih_result explain(girih_result result, const girih_error *reason, bool grown,
                            uint64_t triangles, uint64_t vertices, girih_error *error) {
    if (!grown) {
        return girih_fail(error, result, "%s", reason->message);
    }
    if (result == GIRIH_ERROR_TOO_LARGE || result == GIRIH_ERROR_OUT_OF_DEVICE_MEMORY ||
        result == GIRIH_ERROR_OUT_OF_MEMORY) {
        return girih_fail(
            error, result,
            "too large: %llu triangles with %llu vertices; ask for fewer segments (%.200s)",
            (unsigned long long)triangles, (unsigned long long)vertices, reason->message);
    }
    return girih_fail(error, result, "%s", reason->message);
}

static girih_result run_once(girih_refinement *refinement, const girih_refinement_desc *desc,
                             const girih_frame *frame, VkQueryPool queries, girih_error *error) {
    girih_device *device = desc->device;
    girih_timestamps timestamps = {queries, 0};
    girih_result result = girih_device_begin(device, error);
    if (result != GIRIH_OK) {
        return result;
    }
    double start = girih_seconds();
    if (queries != VK_NULL_HANDLE) {
        vkCmdResetQueryPool(device->commands, queries, 0, GIRIH_TIMESTAMPS);
    }
    result = girih_cmd_refine(refinement->plan, device->commands, frame,
                              queries != VK_NULL_HANDLE ? &timestamps : NULL, error);
    if (result == GIRIH_OK) {
        result = girih_device_finish(device, error);
    } else {
        vkEndCommandBuffer(device->commands);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    refinement->times = girih_no_times;
    refinement->times.wall = (girih_seconds() - start) * 1e3;
    refinement->statistics = girih_plan_statistics(refinement->plan);
    double at[GIRIH_TIMESTAMPS];
    if (girih_device_read_queries(device, queries, 0, GIRIH_TIMESTAMPS, at)) {
        refinement->times.levels = at[1] - at[0];
        refinement->times.select = at[2] - at[1];
        refinement->times.group = at[3] - at[2];
        refinement->times.dispatch = at[4] - at[3];
        // Indices are part of what evaluating a surface comes to.
        refinement->times.evaluate = at[6] - at[4];
    }
    return GIRIH_OK;
}

girih_result girih_refinement_run(girih_refinement *refinement, const girih_refinement_desc *desc,
                                  const girih_frame *frame, girih_error *error) {
    *refinement = (girih_refinement){.times = girih_no_times};
    girih_report_progress("refining");
    // Most pictures fit this; what does not says how much it needs.
    uint64_t triangles = (uint64_t)1 << 20;
    uint64_t vertices = (uint64_t)1 << 20;
    bool grown = false;
    VkQueryPool queries;
    girih_result result = girih_device_queries(desc->device, GIRIH_TIMESTAMPS, &queries, error);
    while (result == GIRIH_OK) {
        if (triangles > UINT32_MAX || vertices > UINT32_MAX) {
            girih_error reason = {.message = "there can be 2^32 of each"};
            result = explain(GIRIH_ERROR_TOO_LARGE, &reason, grown, triangles, vertices, error);
            break;
        }
        girih_plan_desc plan = {
            .scene = desc->scene,
            .instances = desc->instances,
            .instance_count = desc->instance_count,
            .surface = desc->surface,
            .program = desc->program,
            .mode = desc->mode,
            .outputs = desc->outputs,
            .max_vertices = (uint32_t)vertices,
            .max_triangles = (uint32_t)triangles,
            .vertex_usage = desc->vertex_usage,
            .index_usage = desc->index_usage,
        };
        girih_error reason = {.result = GIRIH_OK};
        result = girih_plan_create(desc->context, &plan, &refinement->plan, &reason);
        if (result != GIRIH_OK) {
            result = explain(result, &reason, grown, triangles, vertices, error);
            break;
        }
        result = run_once(refinement, desc, frame, queries, error);
        if (result != GIRIH_OK || !refinement->statistics.overflow) {
            break;
        }
        uint64_t needed_triangles = refinement->statistics.needed_triangles;
        uint64_t needed_vertices = refinement->statistics.needed_vertices;
        girih_plan_destroy(refinement->plan);
        refinement->plan = NULL;
        if (needed_triangles <= triangles && needed_vertices <= vertices) {
            result = girih_fail(
                error, GIRIH_ERROR_DEVICE,
                "the device reports an overflow with room for %llu triangles, which should do",
                (unsigned long long)triangles);
            break;
        }
        grown = true;
        triangles = needed_triangles > triangles ? needed_triangles : triangles;
        vertices = needed_vertices > vertices ? needed_vertices : vertices;
    }
    if (result != GIRIH_OK) {
        girih_plan_destroy(refinement->plan);
        refinement->plan = NULL;
    }
    vkDestroyQueryPool(desc->device->device, queries, NULL);
    girih_report_progress(NULL);
    return result;
}

girih_stage_times girih_cpu_stage_times(const girih_cpu_output *output, double wall) {
    girih_stage_times times = girih_no_times;
    times.levels = output->times.levels;
    times.select = output->times.select;
    times.group = output->times.group;
    times.dispatch = output->times.dispatch;
    times.evaluate = output->times.evaluate;
    times.wall = wall;
    return times;
}
