#include "shown_model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

// --- Loading ---

// Puts the model's name before a message that does not begin with it.
static girih_result name_file(girih_result result, const char *path, girih_error *error) {
    size_t length = strlen(path);
    if (result == GIRIH_OK ||
        (strncmp(error->message, path, length) == 0 && error->message[length] == ':')) {
        return result;
    }
    char message[sizeof error->message];
    memcpy(message, error->message, sizeof message);
    return girih_fail(error, result, "%.200s: %.280s", path, message);
}

static girih_result load(girih_shown_model *shown, const girih_pose_options *pose,
                         girih_error *error) {
    girih_surface_options loading = shown->surface;
    if (loading.surface == GIRIH_SURFACE_FLAT) {
        loading.surface = GIRIH_SURFACE_PN; // normals that serve either: it can be switched
    }
    girih_result result =
        girih_model_load(&shown->model, shown->path, GIRIH_MODEL_DRAW, &loading, pose, error);
    if (result == GIRIH_OK) {
        result = girih_model_instances(&shown->model, true, &shown->instances,
                                       &shown->instance_count, error);
    }
    if (result != GIRIH_OK) {
        return name_file(result, shown->path, error);
    }
    result = girih_own_surface_load(&shown->own, shown->path, &shown->surface, &shown->model,
                                    shown->instances, shown->instance_count, error);
    girih_model_box(&shown->model, shown->instances, shown->instance_count, shown->low,
                    shown->high);
    return result;
}

static girih_result upload(girih_shown_model *shown, uint32_t samples, girih_error *error) {
    girih_result result =
        girih_device_context(shown->device, shown->catalogue, &shown->context, error);
    if (result == GIRIH_OK) {
        result = girih_refinement_scene(shown->device, shown->context, shown->model.meshes,
                                        shown->model.mesh_count, &shown->scene, error);
    }
    if (result != GIRIH_OK) {
        return name_file(result, shown->path, error);
    }
    if (girih_shown_has_own(shown)) {
        result = girih_own_surface_upload(&shown->own, shown->device, shown->context, false, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    const girih_renderer_desc desc = {
        .device = shown->device,
        .context = shown->context,
        .catalogue = shown->catalogue,
        .model = &shown->model,
        .surface_layout = shown->own.layout,
        .frame_count = GIRIH_WINDOW_FRAMES,
        .samples = samples,
    };
    return name_file(girih_renderer_create(&desc, &shown->renderer, error), shown->path, error);
}

girih_result girih_shown_open(const girih_shown_desc *desc, girih_shown_model **shown,
                              girih_error *error) {
    girih_shown_model *made = calloc(1, sizeof *made);
    if (made == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    made->device = desc->device;
    made->catalogue = desc->catalogue;
    made->surface = *desc->surface;
    made->room = girih_refinement_first_room;
    made->latest.times = girih_no_times;
    made->path = strdup(desc->path);
    girih_result result = made->path != NULL
                              ? load(made, desc->pose, error)
                              : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    if (result == GIRIH_OK) {
        result = upload(made, desc->samples, error);
    }
    girih_report_progress(NULL);
    if (result != GIRIH_OK) {
        girih_shown_close(made);
        return result;
    }
    *shown = made;
    return GIRIH_OK;
}

static void destroy_plan(girih_shown_slot *slot) {
    girih_plan_destroy(slot->refinement.plan);
    *slot = (girih_shown_slot){
        .refinement.times = girih_no_times, .pose = slot->pose, .vertices = slot->vertices};
}

void girih_shown_close(girih_shown_model *shown) {
    if (shown == NULL) {
        return;
    }
    girih_renderer_destroy(shown->renderer);
    for (uint32_t n = 0; n < GIRIH_WINDOW_FRAMES; n++) {
        destroy_plan(&shown->slots[n]);
        girih_device_buffer_destroy(shown->device, &shown->slots[n].vertices);
    }
    girih_own_surface_remove(&shown->own, shown->device);
    girih_scene_destroy(shown->scene);
    girih_context_destroy(shown->context);
    girih_own_surface_free(&shown->own);
    free(shown->instances);
    girih_model_free(&shown->model);
    free(shown->surface_file);
    free(shown->path);
    free(shown);
}

// --- A surface of the user's ---

bool girih_shown_has_own(const girih_shown_model *shown) {
    return shown->surface.file != NULL || shown->surface.height_map != NULL;
}

static girih_result compile_again(girih_shown_model *shown, girih_error *error) {
    girih_own_surface fresh;
    girih_result result = girih_own_surface_compile_again(
        &shown->own, shown->context, shown->is_own_drawn, shown->is_own_drawn_split, &fresh, error);
    girih_report_progress(NULL);
    if (result != GIRIH_OK) {
        return result;
    }
    VkResult idle = vkDeviceWaitIdle(shown->device->device);
    if (idle != VK_SUCCESS) {
        result = girih_vulkan_failure(error, "vkDeviceWaitIdle", idle);
    }
    for (uint32_t n = 0; n < GIRIH_WINDOW_FRAMES; n++) {
        if (shown->slots[n].wish.surface == GIRIH_SURFACE_OWN) {
            destroy_plan(&shown->slots[n]);
        }
    }
    girih_own_surface_replace(&shown->own, &fresh);
    return result;
}

girih_result girih_shown_take_surface(girih_shown_model *shown, const char *file,
                                      girih_error *error) {
    if (file == NULL) {
        return compile_again(shown, error);
    }
    char *copy = strdup(file);
    if (copy == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    const char *before = shown->surface.file;
    const float reach = shown->own.reach;
    shown->surface.file = copy;
    shown->own.reach = -1.0f; // it may go anywhere
    girih_result result = compile_again(shown, error);
    if (result != GIRIH_OK) {
        shown->surface.file = before;
        shown->own.reach = reach;
        free(copy);
        return result;
    }
    free(shown->surface_file);
    shown->surface_file = copy;
    return GIRIH_OK;
}

static girih_result compile_drawing(girih_shown_model *shown, girih_error *error) {
    if (shown->is_own_drawn && shown->is_own_drawn_split == shown->has_splits) {
        return GIRIH_OK;
    }
    // Pipelines hold what they were made from: pictures in flight do not need the words.
    girih_result result = girih_own_surface_compile_drawing(&shown->own, shown->has_splits, error);
    girih_report_progress(NULL);
    shown->is_own_drawn = result == GIRIH_OK;
    shown->is_own_drawn_split = shown->has_splits;
    return result;
}

// --- Plans ---

static girih_refinement_desc describe(const girih_shown_model *shown,
                                      const girih_shown_wish *wish) {
    return (girih_refinement_desc){
        .device = shown->device,
        .context = shown->context,
        .scene = shown->scene,
        .instances = shown->instances,
        .instance_count = shown->instance_count,
        .surface = wish->surface,
        .program = wish->surface == GIRIH_SURFACE_OWN ? shown->own.program : NULL,
        .mode = wish->mode,
        .max_segments = wish->max_segments,
    };
}

static bool is_room_equal(const girih_refinement_room *a, const girih_refinement_room *b) {
    return a->triangles == b->triangles && a->vertices == b->vertices && a->splits == b->splits;
}

static bool is_in_vain(const girih_shown_model *shown, const girih_refinement_room *room) {
    const girih_refinement_room *most = &shown->too_large;
    return most->grown && room->triangles >= most->triangles && room->vertices >= most->vertices &&
           room->splits >= most->splits;
}

static uint64_t half_as_much_again(uint64_t count) {
    const uint64_t most = UINT32_MAX;
    return count + count / 2 < most ? count + count / 2 : count;
}

// A frame that did not fit has been drawn at level 0; the next plans have room for half as much
// again, where that can be had, so that a camera that comes nearer does not meet their end at every
// step.
static void grow(girih_shown_model *shown, const girih_statistics *needed) {
    girih_refinement_room room = shown->room;
    if (!girih_refinement_grow(&room, needed)) {
        return;
    }
    girih_refinement_room ample = room;
    ample.triangles = half_as_much_again(room.triangles);
    ample.vertices = half_as_much_again(room.vertices);
    ample.splits = half_as_much_again(room.splits);
    if (!is_in_vain(shown, &ample)) {
        shown->room = ample;
    } else if (!is_in_vain(shown, &room)) {
        shown->room = room;
    }
}

static girih_result create_plan(girih_shown_model *shown, girih_shown_slot *slot,
                                const girih_shown_wish *wish, girih_error *error) {
    const girih_refinement_desc desc = describe(shown, wish);
    slot->refinement = (girih_refinement){
        .mode = shown->has_splits ? girih_refinement_split_mode(wish->mode) : wish->mode,
        .has_splits = shown->has_splits,
        .times = girih_no_times,
    };
    slot->wish = *wish;
    slot->room = shown->room;
    return girih_refinement_plan(&slot->refinement, &desc, &shown->room, error);
}

// The plan of slot, made anew where it does not fit. Where the device has no room for what the
// levels ask for, frames are drawn at level 0 in the room that is to be had.
static girih_result fit_plan(girih_shown_model *shown, girih_shown_slot *slot,
                             const girih_shown_wish *wish, girih_error *error) {
    if (slot->refinement.plan != NULL && slot->wish.surface == wish->surface &&
        slot->wish.mode == wish->mode && slot->wish.max_segments == wish->max_segments &&
        slot->refinement.has_splits == shown->has_splits &&
        is_room_equal(&slot->room, &shown->room)) {
        return GIRIH_OK;
    }
    girih_refinement_room before = slot->refinement.plan != NULL && slot->room.grown
                                       ? slot->room
                                       : girih_refinement_first_room;
    destroy_plan(slot);
    girih_result result = create_plan(shown, slot, wish, error);
    if (result != GIRIH_OK && shown->room.grown) {
        snprintf(shown->notice, sizeof shown->notice, "%s", error->message);
        shown->too_large = shown->room;
        shown->room = before;
        result = create_plan(shown, slot, wish, error);
    }
    return result;
}

void girih_shown_collect(girih_shown_model *shown, uint32_t slot, VkQueryPool queries) {
    girih_shown_slot *finished = &shown->slots[slot];
    if (!finished->is_submitted) {
        return;
    }
    finished->is_submitted = false;
    finished->is_finished = true;
    girih_refinement *refinement = &finished->refinement;
    refinement->statistics = girih_plan_statistics(refinement->plan);
    // Of a frame that was not refined again, the times are still those of when it was.
    if (!finished->is_unchanged) {
        girih_refinement_read_times(&refinement->times, shown->device, queries, 0);
    }
    double times[2];
    refinement->times.draw =
        girih_device_read_queries(shown->device, queries, GIRIH_TIMESTAMPS, 2, times) ? times[1]
                                                                                      : -1.0;
    shown->latest = *refinement;
    shown->is_unchanged = finished->is_unchanged;
    const girih_refinement_desc desc = describe(shown, &finished->wish);
    shown->has_splits |= girih_refinement_must_split(refinement, &desc);
    if (refinement->statistics.overflow) {
        grow(shown, &refinement->statistics);
    } else {
        shown->notice[0] = '\0';
    }
}

// --- Moving ---

girih_result girih_shown_move(girih_shown_model *shown, const girih_gltf_animation *animation,
                              double seconds, girih_error *error) {
    girih_instance *instances;
    uint32_t instance_count;
    girih_result result = girih_model_move(&shown->model, animation, seconds, error);
    if (result == GIRIH_OK) {
        result = girih_model_instances(&shown->model, true, &instances, &instance_count, error);
    }
    if (result != GIRIH_OK) {
        return name_file(result, shown->path, error);
    }
    free(shown->instances);
    shown->instances = instances;
    shown->instance_count = instance_count;
    shown->pose++;
    girih_model_box(&shown->model, instances, instance_count, shown->low, shown->high);
    return GIRIH_OK;
}

// Writes the vertices of deformed meshes behind one another, and records their copies.
static girih_result move_vertices(const girih_shown_model *shown, girih_shown_slot *slot,
                                  VkCommandBuffer commands, girih_error *error) {
    const girih_model *model = &shown->model;
    VkDeviceSize size = 0;
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        size += girih_model_is_deformed(model, n)
                    ? (VkDeviceSize)model->meshes[n]->vertex_count * 6 * sizeof(float)
                    : 0;
    }
    girih_result result = GIRIH_OK;
    if (slot->vertices.buffer == VK_NULL_HANDLE) {
        result = girih_device_buffer_create(shown->device, &slot->vertices, size,
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT, GIRIH_MEMORY_UPLOAD,
                                            error);
    }
    // An own surface reads the vertices while it is drawn in the instanced mode.
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_VERTEX_SHADER_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 0, NULL);
    VkBufferCopy copy = {.srcOffset = 0};
    for (uint32_t n = 0; n < model->mesh_count && result == GIRIH_OK; n++) {
        if (!girih_model_is_deformed(model, n)) {
            continue;
        }
        girih_buffer_range range;
        result = girih_scene_vertices(shown->scene, n, &range, &copy.size, error);
        if (result == GIRIH_OK) {
            girih_model_vertices(model, n,
                                 (float *)((char *)slot->vertices.mapped + (size_t)copy.srcOffset));
            copy.dstOffset = range.offset;
            vkCmdCopyBuffer(commands, slot->vertices.buffer, range.buffer, 1, &copy);
            copy.srcOffset += copy.size;
        }
    }
    return result;
}

static girih_result move(const girih_shown_model *shown, girih_shown_slot *slot,
                         VkCommandBuffer commands, girih_error *error) {
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < shown->instance_count && result == GIRIH_OK; n++) {
        result = girih_plan_set_transform(slot->refinement.plan, n, shown->instances[n].transform,
                                          NULL, error);
    }
    if (result == GIRIH_OK && shown->model.is_dynamic) {
        result = move_vertices(shown, slot, commands, error);
    }
    slot->pose = shown->pose;
    return result;
}

// --- Frames ---

girih_result girih_shown_refine(girih_shown_model *shown, uint32_t slot, VkCommandBuffer commands,
                                const girih_shown_wish *wish, const girih_frame *frame,
                                VkQueryPool queries, girih_error *error) {
    girih_shown_slot *next = &shown->slots[slot];
    girih_result result = fit_plan(shown, next, wish, error);
    if (result == GIRIH_OK && wish->surface == GIRIH_SURFACE_OWN &&
        wish->mode == GIRIH_MODE_INSTANCED) {
        result = compile_drawing(shown, error);
    }
    if (result == GIRIH_OK && next->pose != shown->pose) {
        result = move(shown, next, commands, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    const girih_timestamps timestamps = {queries, 0};
    if (queries != VK_NULL_HANDLE) {
        vkCmdResetQueryPool(commands, queries, 0, GIRIH_WINDOW_QUERIES);
    }
    girih_frame posed = *frame;
    posed.revision = shown->pose;
    result = girih_cmd_refine(next->refinement.plan, commands, &posed, &timestamps, error);
    next->is_unchanged = memcmp(&next->frame, &posed, sizeof posed) == 0;
    next->frame = posed;
    next->is_submitted = result == GIRIH_OK;
    return result;
}

girih_drawing girih_shown_drawing(const girih_shown_model *shown, uint32_t slot, uint32_t width) {
    const girih_shown_slot *drawn = &shown->slots[slot];
    return (girih_drawing){
        .plan = drawn->refinement.plan,
        .mode = drawn->refinement.mode,
        .surface = drawn->wish.surface,
        .own = &shown->own,
        .has_splits = drawn->refinement.has_splits,
        .width = width,
    };
}
