#include "refinement.h"

#include <unistd.h>

#include "error.h"

enum { FIRST_OUTPUTS = 1 << 20, FIRST_SPLITS = 1 << 16 };

const girih_refinement_room girih_refinement_first_room = {
    .triangles = FIRST_OUTPUTS, .vertices = FIRST_OUTPUTS, .splits = FIRST_SPLITS};

girih_result girih_refinement_scene(girih_device *device, girih_context *context,
                                    const girih_mesh *const *meshes, uint32_t mesh_count,
                                    girih_scene **scene, girih_error *error) {
    girih_report_progress("uploading");
    const girih_scene_desc desc = {
        .meshes = meshes,
        .mesh_count = mesh_count,
        .dynamic = mesh_count > 0 && meshes[0]->dynamic, // a model's are all alike
    };
    girih_result result = girih_scene_create(context, &desc, scene, error);
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

static uint64_t larger(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

girih_mode girih_refinement_split_mode(girih_mode mode) {
    return mode == GIRIH_MODE_WELDED ? GIRIH_MODE_BAKED : mode;
}

// What a plan's creation says; where the levels made it too large, with the size they asked for and
// what to do.
static girih_result explain(girih_result result, const girih_error *reason,
                            const girih_refinement_room *asked, girih_error *error) {
    bool too_large = result == GIRIH_ERROR_TOO_LARGE ||
                     result == GIRIH_ERROR_OUT_OF_DEVICE_MEMORY ||
                     result == GIRIH_ERROR_OUT_OF_MEMORY;
    if (!asked->grown || !too_large) {
        return girih_fail(error, result, "%s", reason->message);
    }
    if (asked->triangles == FIRST_OUTPUTS && asked->vertices == FIRST_OUTPUTS) {
        return girih_fail(error, result,
                          "too large: triangles split into %llu parts and more; ask for fewer "
                          "segments, or let --max-segments allow fewer (%.200s)",
                          (unsigned long long)asked->splits, reason->message);
    }
    return girih_fail(
        error, result,
        "too large: %llu triangles with %llu vertices; ask for fewer segments (%.200s)",
        (unsigned long long)asked->triangles, (unsigned long long)asked->vertices, reason->message);
}

bool girih_refinement_grow(girih_refinement_room *room, const girih_statistics *needed) {
    // Parts that found no room are not counted as triangles yet.
    if (needed->needed_splits > room->splits) {
        room->splits = needed->needed_splits;
    } else if (needed->needed_triangles > room->triangles ||
               needed->needed_vertices > room->vertices) {
        room->triangles = larger(room->triangles, needed->needed_triangles);
        room->vertices = larger(room->vertices, needed->needed_vertices);
    } else {
        return false;
    }
    room->grown = true;
    return true;
}

bool girih_refinement_must_split(const girih_refinement *refinement,
                                 const girih_refinement_desc *desc) {
    return desc->max_segments > 0 && !refinement->has_splits &&
           refinement->statistics.clamped_edges > 0;
}

void girih_refinement_read_times(girih_stage_times *times, const girih_device *device,
                                 VkQueryPool queries, uint32_t first) {
    *times = girih_no_times;
    double at[GIRIH_TIMESTAMPS];
    if (girih_device_read_queries(device, queries, first, GIRIH_TIMESTAMPS, at)) {
        times->levels = at[1] - at[0];
        times->select = at[2] - at[1];
        times->group = at[3] - at[2];
        times->dispatch = at[4] - at[3];
        // Indices are part of what evaluating a surface comes to.
        times->evaluate = at[6] - at[4];
    }
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
    double wall = (girih_seconds() - start) * 1e3;
    girih_refinement_read_times(&refinement->times, device, queries, 0);
    refinement->times.wall = wall;
    refinement->statistics = girih_plan_statistics(refinement->plan);
    return GIRIH_OK;
}

girih_result girih_refinement_plan(girih_refinement *refinement, const girih_refinement_desc *desc,
                                   const girih_refinement_room *room, girih_error *error) {
    girih_error reason = {.message = "there can be 2^32 of each"};
    girih_result result = GIRIH_ERROR_TOO_LARGE;
    if (room->triangles <= UINT32_MAX && room->vertices <= UINT32_MAX) {
        girih_plan_desc plan = {
            .scene = desc->scene,
            .instances = desc->instances,
            .instance_count = desc->instance_count,
            .surface = desc->surface,
            .program = desc->program,
            .mode = refinement->mode,
            .outputs = desc->outputs,
            .max_vertices = (uint32_t)room->vertices,
            .max_triangles = (uint32_t)room->triangles,
            .max_segments = refinement->has_splits ? desc->max_segments : 0,
            .max_splits = refinement->has_splits ? (uint32_t)room->splits : 0,
            .vertex_usage = desc->vertex_usage,
            .index_usage = desc->index_usage,
        };
        result = girih_plan_create(desc->context, &plan, &refinement->plan, &reason);
    }
    return result == GIRIH_OK ? GIRIH_OK : explain(result, &reason, room, error);
}

girih_result girih_refinement_run(girih_refinement *refinement, const girih_refinement_desc *desc,
                                  const girih_frame *frame, girih_error *error) {
    *refinement = (girih_refinement){.mode = desc->mode, .times = girih_no_times};
    girih_report_progress("refining");
    girih_refinement_room room = girih_refinement_first_room;
    VkQueryPool queries;
    girih_result result = girih_device_queries(desc->device, GIRIH_TIMESTAMPS, &queries, error);
    while (result == GIRIH_OK) {
        result = girih_refinement_plan(refinement, desc, &room, error);
        if (result == GIRIH_OK) {
            result = run_once(refinement, desc, frame, queries, error);
        }
        bool splits = result == GIRIH_OK && girih_refinement_must_split(refinement, desc);
        if (result != GIRIH_OK || (!splits && !refinement->statistics.overflow)) {
            break;
        }
        girih_plan_destroy(refinement->plan);
        refinement->plan = NULL;
        if (splits) {
            refinement->has_splits = true;
            refinement->mode = girih_refinement_split_mode(desc->mode);
        } else if (!girih_refinement_grow(&room, &refinement->statistics)) {
            result = girih_fail(
                error, GIRIH_ERROR_DEVICE,
                "the device reports an overflow with room for %llu triangles, which should do",
                (unsigned long long)room.triangles);
        }
    }
    if (result != GIRIH_OK) {
        girih_plan_destroy(refinement->plan);
        refinement->plan = NULL;
    }
    vkDestroyQueryPool(desc->device->device, queries, NULL);
    girih_report_progress(NULL);
    return result;
}

// --- On the CPU ---

// Memory that is written to is there only as far as the machine has it, whatever was handed out: a
// quarter of it may be the vertices, and one the triangles, which are copied once more to be
// written or drawn.
static void limit_output(girih_cpu_desc *desc) {
    uint64_t floats = 6;
    for (uint32_t n = 0; n < desc->mesh_count; n++) {
        floats = larger(floats, 6 + (uint64_t)desc->meshes[n]->attribute_floats);
    }
    uint64_t quarter = (uint64_t)sysconf(_SC_PHYS_PAGES) / 4 * (uint64_t)sysconf(_SC_PAGESIZE);
    desc->max_vertices = quarter / (4 * floats);
    desc->max_triangles = quarter / 12;
}

static girih_result run_once_on_cpu(const girih_cpu_desc *desc, const girih_frame *frame,
                                    girih_cpu_output *output, girih_stage_times *times,
                                    girih_error *error) {
    double start = girih_seconds();
    girih_error reason = {.result = GIRIH_OK};
    girih_result result = girih_cpu_refine(desc, frame, output, &reason);
    if (result != GIRIH_OK) {
        bool too_large = result == GIRIH_ERROR_TOO_LARGE || result == GIRIH_ERROR_OUT_OF_MEMORY;
        return girih_fail(error, result, "%s%s", reason.message,
                          too_large ? "; ask for fewer segments" : "");
    }
    const girih_statistics statistics = output->statistics;
    if (statistics.overflow) {
        girih_cpu_output_free(output);
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "too large: %llu triangles with %llu vertices are more than this "
                          "machine's memory should hold; ask for fewer segments",
                          (unsigned long long)statistics.needed_triangles,
                          (unsigned long long)statistics.needed_vertices);
    }
    *times = girih_no_times;
    times->levels = output->times.levels;
    times->select = output->times.select;
    times->group = output->times.group;
    times->dispatch = output->times.dispatch;
    times->evaluate = output->times.evaluate;
    times->wall = (girih_seconds() - start) * 1e3;
    return GIRIH_OK;
}

girih_result girih_refinement_run_on_cpu(girih_cpu_desc *desc, const girih_frame *frame,
                                         girih_cpu_output *output, girih_stage_times *times,
                                         girih_error *error) {
    girih_report_progress("refining");
    const uint32_t max_segments = desc->max_segments;
    desc->max_segments = 0;
    limit_output(desc);
    girih_result result = run_once_on_cpu(desc, frame, output, times, error);
    if (result == GIRIH_OK && max_segments > 0 && output->statistics.clamped_edges > 0) {
        girih_cpu_output_free(output);
        desc->max_segments = max_segments;
        desc->mode = girih_refinement_split_mode(desc->mode);
        result = run_once_on_cpu(desc, frame, output, times, error);
    }
    girih_report_progress(NULL);
    return result;
}
