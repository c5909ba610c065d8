#include "session.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "displacement.h"
#include "error.h"
#include "girih/cpu.h"
#include "legend.h"

girih_result girih_session_load(girih_session *s, const girih_session_desc *desc,
                                girih_error *error) {
    *s = (girih_session){.desc = *desc, .file = desc->model};
    girih_result result =
        girih_catalogue_source_open(&s->catalogue, desc->surface->catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_model_load(&s->model, desc->model, GIRIH_MODEL_DRAW, desc->surface,
                                  desc->pose, error);
    }
    if (result == GIRIH_OK) {
        result = girih_model_instances(&s->model, true, &s->instances, &s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_own_surface_load(&s->own, desc->model, desc->surface, &s->model,
                                        s->instances, s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        girih_model_box(&s->model, s->instances, s->instance_count, s->box[0], s->box[1]);
    }
    return result;
}

// --- The device ---

// --mode auto, once there is a scene. How much comes out is known beforehand only where all edges
// are alike: a triangle of n segments an edge becomes n * n.
static girih_mode choose_fastest_mode(const girih_session *s) {
    const girih_frame frame = girih_frame_from_options(s->desc.levels, NULL);
    const girih_plan_desc desc = {.scene = s->scene,
                                  .instances = s->instances,
                                  .instance_count = s->instance_count,
                                  .surface = s->desc.surface->surface};
    uint64_t each = 0;
    if (frame.rule == GIRIH_LEVEL_SEGMENTS) {
        const uint64_t segments = frame.segments < 1024 ? frame.segments : 1024;
        each = segments * segments;
    }
    uint64_t input_triangles = 0;
    for (uint32_t n = 0; n < s->instance_count; ++n) {
        input_triangles += s->model.meshes[s->instances[n].mesh]->triangle_count;
    }
    return girih_choose_mode(s->context, &desc, each * input_triangles);
}

static girih_mode choose_mode(const girih_session *s) {
    const girih_look_options *look = s->desc.look;
    if (girih_shade_is_by_pattern(look->shade) || look->mode == GIRIH_MODE_OPTION_INSTANCED) {
        return GIRIH_MODE_INSTANCED;
    }
    if (look->mode == GIRIH_MODE_OPTION_AUTO && s->scene != NULL) {
        return choose_fastest_mode(s);
    }
    return look->mode == GIRIH_MODE_OPTION_WELDED ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED;
}

static girih_result create_renderer(girih_session *s, girih_error *error) {
    const girih_renderer_desc desc = {
        .device = &s->device,
        .context = s->context,
        .catalogue = s->catalogue.catalogue,
        .model = &s->model,
        .surface_layout = s->own.layout,
        .frame_count = 1,
        .samples = s->desc.look->samples,
    };
    return girih_renderer_create(&desc, &s->renderer, error);
}

girih_result girih_session_open(girih_session *s, girih_error *error) {
    girih_device_wishes wishes = {.graphics = true};
    girih_look_wish(s->desc.look, &wishes.features);
    girih_result result = girih_device_open(&s->device, s->desc.device, &wishes, error);
    if (result != GIRIH_OK) {
        return result;
    }
    s->is_device_open = true;
    result = girih_look_check_device(s->desc.look, &s->device, error);
    if (result == GIRIH_OK && !s->desc.device->cpu) {
        result = girih_device_context(&s->device, s->catalogue.catalogue, &s->context, error);
        if (result == GIRIH_OK) {
            result = girih_refinement_scene(&s->device, s->context, s->model.meshes,
                                            s->model.mesh_count, &s->scene, error);
        }
    }
    s->mode = choose_mode(s);
    if (result == GIRIH_OK && s->scene != NULL && s->desc.surface->surface == GIRIH_SURFACE_OWN) {
        result = girih_own_surface_upload(&s->own, &s->device, s->context,
                                          s->mode == GIRIH_MODE_INSTANCED, error);
        s->file = result == GIRIH_OK ? s->file : NULL; // the message names what it is about
    }
    if (result == GIRIH_OK) {
        result = create_renderer(s, error);
    }
    return result;
}

// --- Refining ---

static girih_result upload(girih_session *s, girih_device_buffer *buffer, const void *bytes,
                           VkDeviceSize size, VkBufferUsageFlags usage, girih_error *error) {
    girih_result result = girih_device_buffer_create(&s->device, buffer, size,
                                                     usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                                     GIRIH_MEMORY_DEVICE, error);
    return result == GIRIH_OK ? girih_device_write(&s->device, buffer->buffer, bytes, size, error)
                              : result;
}

static girih_result refine_on_cpu(girih_session *s, uint32_t number, girih_surface surface,
                                  const girih_frame *frame, girih_error *error) {
    girih_cpu_output *output = &s->outputs[number];
    girih_cpu_desc desc = {
        .catalogue = s->catalogue.catalogue,
        .meshes = s->model.meshes,
        .mesh_count = s->model.mesh_count,
        .instances = s->instances,
        .instance_count = s->instance_count,
        .surface = surface,
        .mode = s->mode,
        .outputs = GIRIH_OUTPUT_INDICES,
        .max_segments = girih_segments_beyond(s->catalogue.catalogue, s->desc.levels),
        .own = girih_displacement_surface,
        .own_user = &s->own.displacement,
        .base = s->desc.surface->base,
        .reach = s->own.reach,
    };
    girih_result result = girih_refinement_run_on_cpu(&desc, frame, output, &s->times, error);
    if (result != GIRIH_OK) {
        return result;
    }
    s->drawings[number].mode = desc.mode;
    s->statistics[number] = output->statistics;
    VkDeviceSize vertices = output->statistics.output_vertices;
    girih_device_buffer *buffers = s->buffers[number];
    result = upload(s, &buffers[0], output->positions, vertices * 12,
                    VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, error);
    if (result == GIRIH_OK) {
        result = upload(s, &buffers[1], output->attributes,
                        vertices * 4 * (3 + output->attribute_floats),
                        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, error);
    }
    if (result == GIRIH_OK) {
        result = upload(s, &buffers[2], output->indices,
                        (VkDeviceSize)output->statistics.output_triangles * 12,
                        VK_BUFFER_USAGE_INDEX_BUFFER_BIT, error);
    }
    s->drawings[number].positions = buffers[0].buffer;
    s->drawings[number].attributes = buffers[1].buffer;
    s->drawings[number].indices = buffers[2].buffer;
    s->drawings[number].material_first = output->material_first;
    return result;
}

static girih_result refine_on_device(girih_session *s, uint32_t number, girih_surface surface,
                                     const girih_frame *frame, girih_error *error) {
    girih_refinement_desc desc = {
        .device = &s->device,
        .context = s->context,
        .scene = s->scene,
        .instances = s->instances,
        .instance_count = s->instance_count,
        .surface = surface,
        .program = s->own.program,
        .mode = s->mode,
        .max_segments = girih_segments_beyond(s->catalogue.catalogue, s->desc.levels),
    };
    girih_refinement *refinement = &s->refinements[number];
    girih_result result = girih_refinement_run(refinement, &desc, frame, error);
    s->drawings[number].plan = refinement->plan;
    s->drawings[number].mode = refinement->mode;
    s->drawings[number].has_splits = refinement->has_splits;
    s->statistics[number] = refinement->statistics;
    s->times = refinement->times;
    bool is_own = surface == GIRIH_SURFACE_OWN && s->mode == GIRIH_MODE_INSTANCED;
    if (result == GIRIH_OK && is_own &&
        (!s->is_compiled || s->compiled_splits != refinement->has_splits)) {
        result = girih_own_surface_compile_drawing(&s->own, refinement->has_splits, error);
        s->is_compiled = result == GIRIH_OK;
        s->compiled_splits = refinement->has_splits;
        s->file = result == GIRIH_OK ? s->file : NULL; // the message names what it is about
    }
    return result;
}

static girih_result add_drawing(girih_session *s, girih_surface surface, const girih_frame *frame,
                                uint32_t x, uint32_t width, girih_error *error) {
    uint32_t number = s->drawing_count++;
    s->drawings[number] = (girih_drawing){
        .mode = s->mode, .surface = surface, .own = &s->own, .x = x, .width = width};
    return s->desc.device->cpu ? refine_on_cpu(s, number, surface, frame, error)
                               : refine_on_device(s, number, surface, frame, error);
}

static void free_drawings(girih_session *s) {
    for (uint32_t n = 0; n < s->drawing_count; n++) {
        girih_plan_destroy(s->refinements[n].plan);
        for (int k = 0; k < 3; k++) {
            girih_device_buffer_destroy(&s->device, &s->buffers[n][k]);
        }
        girih_cpu_output_free(&s->outputs[n]);
        s->refinements[n] = (girih_refinement){0};
        s->outputs[n] = (girih_cpu_output){0};
    }
    s->drawing_count = 0;
}

static girih_result add_drawings(girih_session *s, const girih_shot *shot, girih_error *error) {
    uint32_t half = shot->width / 2;
    girih_frame frame = girih_frame_from_options(s->desc.levels, shot->view);
    frame.surface_set = s->own.set;
    frame.cull_frustum = 1;
    frame.cull_back = !s->desc.look->has_back_face_color;
    girih_result result = GIRIH_OK;
    if (shot->beside_input) {
        girih_frame input = frame;
        input.rule = GIRIH_LEVEL_SEGMENTS;
        input.segments = 1;
        result = add_drawing(s, GIRIH_SURFACE_FLAT, &input, 0, half, error);
    }
    if (result == GIRIH_OK) {
        result = add_drawing(s, s->desc.surface->surface, &frame,
                             shot->beside_input ? shot->width - half : 0,
                             shot->beside_input ? half : shot->width, error);
    }
    return result;
}

// --- Legend and captions ---

static girih_result add_caption(girih_overlay *overlay, const girih_rectangle *area,
                                const char *what, const girih_statistics *statistics, bool *fits,
                                girih_error *error) {
    char count[64];
    snprintf(count, sizeof count, "%" PRIu64 " triangles drawn", statistics->output_triangles);
    const girih_overlay_line lines[2] = {{.text = what}, {.text = count}};
    const girih_overlay_text text = {
        .lines = lines, .line_count = 2, .corner = GIRIH_CORNER_TOP_LEFT, .area = *area};
    return girih_overlay_add(overlay, &text, fits, error);
}

static girih_result make_overlay(const girih_session *s, const girih_shot *shot,
                                 girih_overlay *overlay, bool *fits, girih_error *error) {
    uint32_t last = s->drawing_count - 1;
    girih_rectangle areas[2];
    for (uint32_t n = 0; n <= last; n++) {
        areas[n] = (girih_rectangle){s->drawings[n].x, 0, s->drawings[n].width, shot->height};
    }
    bool has_room[3] = {true, true, true};
    girih_result result = girih_legend_add(overlay, s->desc.look->shade, s->catalogue.catalogue,
                                           s->drawings[last].plan, GIRIH_CORNER_BOTTOM_RIGHT,
                                           &areas[last], &has_room[0], error);
    if (result == GIRIH_OK && shot->beside_input) {
        result = add_caption(overlay, &areas[0], "input", &s->statistics[0], &has_room[1], error);
    }
    const char *caption = shot->caption == NULL && shot->beside_input ? "refined" : shot->caption;
    if (result == GIRIH_OK && caption != NULL) {
        result =
            add_caption(overlay, &areas[last], caption, &s->statistics[last], &has_room[2], error);
    }
    *fits = has_room[0] && has_room[1] && has_room[2];
    return result;
}

// --- Drawing ---

static double linear_of(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

static double encoded_of(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

// From colours that were multiplied by their alpha, as light, to those that a PNG holds.
static void straighten(uint8_t *rgba, size_t pixels) {
    for (uint8_t *p = rgba; p < rgba + 4 * pixels; p += 4) {
        for (int n = 0; n < 3 && p[3] != 0 && p[3] != 255; n++) {
            double light = linear_of(p[n] / 255.0) * 255.0 / p[3];
            p[n] = (uint8_t)lround(255.0 * encoded_of(fmin(light, 1.0)));
        }
    }
}

girih_result girih_session_draw(girih_session *s, const girih_shot *shot, uint8_t *rgba, bool *fits,
                                girih_error *error) {
    *fits = true;
    free_drawings(s);
    girih_result result = add_drawings(s, shot, error);
    girih_overlay overlay = {0};
    if (result == GIRIH_OK && !s->desc.look->no_legend) {
        result = make_overlay(s, shot, &overlay, fits, error);
    }
    if (result == GIRIH_OK) {
        result = girih_renderer_set_overlay(s->renderer, 0, &overlay, error);
    }
    girih_overlay_clear(&overlay);
    if (result == GIRIH_OK && !s->is_sized) {
        result = girih_renderer_resize(s->renderer, shot->width, shot->height, error);
        s->is_sized = result == GIRIH_OK;
    }
    if (result != GIRIH_OK) {
        return result;
    }
    girih_picture picture = {
        .view = shot->view,
        .transparent = shot->transparent,
        .drawings = s->drawings,
        .drawing_count = s->drawing_count,
    };
    memcpy(picture.box, s->box, sizeof picture.box);
    girih_look_apply(s->desc.look, &picture);
    girih_report_progress("drawing");
    result = girih_renderer_draw(s->renderer, &picture, rgba, &s->times.draw, error);
    girih_report_progress(NULL);
    if (result == GIRIH_OK && shot->transparent) {
        straighten(rgba, (size_t)shot->width * shot->height);
    }
    return result;
}

const girih_statistics *girih_session_statistics(const girih_session *s) {
    return &s->statistics[s->drawing_count - 1];
}

const char *girih_session_mode(const girih_session *s) {
    return girih_mode_name(s->drawings[s->drawing_count - 1].mode);
}

void girih_session_close(girih_session *s) {
    if (s->is_device_open) {
        girih_renderer_destroy(s->renderer);
        free_drawings(s);
        girih_own_surface_remove(&s->own, &s->device);
        girih_scene_destroy(s->scene);
        girih_context_destroy(s->context);
        girih_device_close(&s->device);
    }
    girih_own_surface_free(&s->own);
    free(s->instances);
    girih_model_free(&s->model);
    girih_catalogue_source_free(&s->catalogue);
}
