// girih render: a refined model as a PNG.
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "error.h"
#include "frame.h"
#include "girih/cpu.h"
#include "output_file.h"
#include "png.h"
#include "refinement.h"
#include "renderer.h"

typedef struct render_options {
    const char *model, *output;
    girih_level_options levels;
    girih_surface_options surface;
    girih_camera_options camera;
    girih_device_options device;
    girih_mode_option mode;
    girih_shade shade;
    bool wireframe, beside_input, json;
    bool has_back_face_color;
    float back_face_color[3];
    girih_pose_options pose;
} render_options;

// --- Options ---

enum {
    KEY_MODE = GIRIH_KEY_OWN,
    KEY_SHADE,
    KEY_WIREFRAME,
    KEY_BACKFACE_COLOR,
    KEY_BESIDE_INPUT,
    KEY_TIME,
    KEY_ANIMATION,
    KEY_JSON
};

static const struct argp_option own_options[] = {
    {"output", 'o', "FILE", 0, "The PNG to write", 0},
    {"mode", KEY_MODE, "instanced|baked|welded|auto", 0,
     "How triangles reach the rasteriser; the picture is the same (auto)", 0},
    {"shade", KEY_SHADE, "lit|normals|levels|patterns", 0,
     "levels and patterns colour triangles, or the parts that they are split into, by the largest "
     "edge level, or by base pattern; they are drawn in the instanced mode whatever --mode says",
     0},
    {"wireframe", KEY_WIREFRAME, NULL, 0, "Draw the triangles' edges over the picture", 0},
    {"backface-color", KEY_BACKFACE_COLOR, "R,G,B", 0,
     "Draw back faces too, all in this flat colour (each from 0 to 1): cracks and flipped "
     "triangles show",
     0},
    {"beside-input", KEY_BESIDE_INPUT, NULL, 0,
     "Left half: the model as it is; right half: refined", 0},
    {"time", KEY_TIME, "T", 0,
     "Draw the model as it is T seconds into an animation; the last pose behind its end", 0},
    {"animation", KEY_ANIMATION, "N|NAME", 0,
     "The animation of --time, by its number or name (0); without --time its beginning", 0},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object with counts and times", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static girih_shade read_shade(struct argp_state *state, const char *text) {
    static const char *const names[] = {"lit", "normals", "levels", "patterns", "density"};
    for (int n = 0; n < 5; n++) {
        if (strcmp(text, names[n]) == 0) {
            return (girih_shade)n;
        }
    }
    argp_error(state, "--shade: '%s' is none of lit, normals, levels, patterns", text);
    return GIRIH_SHADE_LIT;
}

static void check_options(struct argp_state *state, const render_options *options) {
    if (options->output == NULL) {
        argp_error(state, "no -o FILE to write the picture to");
    }
    if (options->device.cpu &&
        (options->shade == GIRIH_SHADE_LEVELS || options->shade == GIRIH_SHADE_PATTERNS)) {
        argp_error(
            state,
            "--shade levels and patterns are drawn in the instanced mode, which --cpu has not");
    }
    girih_option_surface_on_cpu(state, &options->surface, &options->device);
    if (options->device.cpu && options->mode == GIRIH_MODE_OPTION_INSTANCED) {
        argp_error(state, "--mode instanced evaluates on the device, --cpu does not");
    }
    if (options->beside_input && options->camera.width < 2) {
        argp_error(state, "--beside-input needs a picture at least 2 pixels wide");
    }
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    render_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->levels;
        state->child_inputs[1] = &options->surface;
        state->child_inputs[2] = &options->camera;
        state->child_inputs[3] = &options->device;
        return 0;
    case 'o': options->output = argument; return 0;
    case KEY_MODE: options->mode = girih_option_mode(state, argument); return 0;
    case KEY_SHADE: options->shade = read_shade(state, argument); return 0;
    case KEY_WIREFRAME: options->wireframe = true; return 0;
    case KEY_BACKFACE_COLOR:
        girih_option_vector(state, "backface-color", argument, options->back_face_color);
        for (int n = 0; n < 3; n++) {
            if (!(options->back_face_color[n] >= 0.0f && options->back_face_color[n] <= 1.0f)) {
                argp_error(state, "--backface-color: '%s' is not three numbers from 0 to 1",
                           argument);
            }
        }
        options->has_back_face_color = true;
        return 0;
    case KEY_BESIDE_INPUT: options->beside_input = true; return 0;
    case KEY_TIME:
        options->pose.time = girih_option_number(state, "time", argument);
        options->pose.has_time = true;
        return 0;
    case KEY_ANIMATION:
        options->pose.animation = argument;
        return 0;
    case KEY_JSON: options->json = true; return 0;
    case ARGP_KEY_ARG: girih_option_model(state, &options->model, argument); return 0;
    case ARGP_KEY_NO_ARGS: argp_error(state, "no MODEL"); return 0;
    case ARGP_KEY_END: check_options(state, options); return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp render_argp = {
    own_options,
    parse,
    "MODEL -o OUT.png",
    "Draws MODEL (.gltf or .glb), its triangles refined on the graphics device, into a PNG."
    "\vExamples:\n"
    "  girih render teapot.glb -o teapot.png\n"
    "  girih render teapot.glb --beside-input --resolution 1600,700 -o both.png\n"
    "  girih render teapot.glb --segments random:7:16 --wireframe -o lines.png\n"
    "  girih render city.gltf --camera-index 0 --edge-pixels 4 --json -o city.png\n"
    "  girih render model.glb --backface-color 1,0,1 -o cracks.png\n"
    "  girih render fox.glb --animation Run --time 0.5 -o running.png\n",
    girih_option_children,
    NULL,
    NULL};

// --- The work ---

// Everything that lives as long as the picture is in the making.
typedef struct session {
    const render_options *options;
    const char *file; // that a failure is about
    girih_catalogue_source catalogue;
    girih_model model;
    girih_own_surface own; // GIRIH_SURFACE_OWN
    girih_instance *instances;
    uint32_t instance_count;
    girih_view view;
    girih_device device;
    bool is_device_open;
    girih_context *context;
    girih_scene *scene;
    girih_mode mode;
    girih_renderer *renderer;
    girih_refinement refinements[2]; // the last is the refined one
    girih_cpu_output outputs[2];
    girih_device_buffer buffers[2][3];
    girih_drawing drawings[2];
    uint32_t drawing_count;
    girih_statistics statistics;
    girih_stage_times times;
} session;

static bool is_by_range(girih_shade shade) {
    return shade == GIRIH_SHADE_LEVELS || shade == GIRIH_SHADE_PATTERNS;
}

static girih_result choose_mode(session *s, girih_error *error) {
    const render_options *options = s->options;
    bool can_instance =
        s->device.features.multiDrawIndirect && s->device.features.drawIndirectFirstInstance;
    bool must_instance =
        options->mode == GIRIH_MODE_OPTION_INSTANCED || is_by_range(options->shade);
    if (must_instance && !can_instance) {
        return girih_fail(
            error, GIRIH_ERROR_UNSUPPORTED,
            "%s: %s draws neither several indirect commands at once nor from a first instance "
            "(multiDrawIndirect, drawIndirectFirstInstance); %s",
            is_by_range(options->shade) ? "--shade levels and patterns" : "--mode instanced",
            s->device.properties.deviceName,
            is_by_range(options->shade) ? "use another --shade" : "use --mode baked");
    }
    if (must_instance) {
        s->mode = GIRIH_MODE_INSTANCED;
    } else {
        s->mode = options->mode == GIRIH_MODE_OPTION_WELDED ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED;
    }
    return GIRIH_OK;
}

// --mode auto, once there is a scene. How much comes out is known beforehand only where all edges
// are alike: a triangle of n segments an edge becomes n * n.
static girih_mode choose_fastest_mode(const session *s) {
    const girih_frame frame = girih_frame_from_options(&s->options->levels, &s->view);
    const girih_plan_desc desc = {.scene = s->scene,
                                  .instances = s->instances,
                                  .instance_count = s->instance_count,
                                  .surface = s->options->surface.surface};
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

static girih_result open_device(session *s, girih_error *error) {
    const girih_device_wishes wishes = {.graphics = true,
                                        .features.geometryShader = true,
                                        .features.fillModeNonSolid = s->options->wireframe};
    girih_result result = girih_device_open(&s->device, &s->options->device, &wishes, error);
    if (result != GIRIH_OK) {
        return result;
    }
    s->is_device_open = true;
    if (s->options->wireframe && !s->device.features.fillModeNonSolid) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "--wireframe: %s does not draw lines (fillModeNonSolid)",
                          s->device.properties.deviceName);
    }
    result = choose_mode(s, error);
    if (result != GIRIH_OK || s->options->device.cpu) {
        return result;
    }
    result = girih_device_context(&s->device, s->catalogue.catalogue, &s->context, error);
    if (result == GIRIH_OK) {
        result = girih_refinement_scene(&s->device, s->context, s->model.meshes,
                                        s->model.mesh_count, &s->scene, error);
    }
    if (result == GIRIH_OK && s->options->mode == GIRIH_MODE_OPTION_AUTO &&
        !is_by_range(s->options->shade)) {
        s->mode = choose_fastest_mode(s);
    }
    if (result == GIRIH_OK && s->options->surface.surface == GIRIH_SURFACE_OWN) {
        result = girih_own_surface_upload(&s->own, &s->device, s->context,
                                          s->mode == GIRIH_MODE_INSTANCED, error);
        s->file = result == GIRIH_OK ? s->file : NULL; // the message names what it is about
    }
    return result;
}

static girih_result upload(session *s, girih_device_buffer *buffer, const void *bytes,
                           VkDeviceSize size, VkBufferUsageFlags usage, girih_error *error) {
    girih_result result = girih_device_buffer_create(&s->device, buffer, size,
                                                     usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                                     GIRIH_MEMORY_DEVICE, error);
    return result == GIRIH_OK ? girih_device_write(&s->device, buffer->buffer, bytes, size, error)
                              : result;
}

static girih_result refine_on_cpu(session *s, uint32_t number, girih_surface surface,
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
        .max_segments = girih_segments_beyond(s->catalogue.catalogue, &s->options->levels),
        .own = girih_displacement_surface,
        .own_user = &s->own.displacement,
        .base = s->options->surface.base,
        .reach = s->own.reach,
    };
    girih_result result = girih_refinement_run_on_cpu(&desc, frame, output, &s->times, error);
    if (result != GIRIH_OK) {
        return result;
    }
    s->drawings[number].mode = desc.mode;
    s->statistics = output->statistics;
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

static girih_result refine_on_device(session *s, uint32_t number, girih_surface surface,
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
        .max_segments = girih_segments_beyond(s->catalogue.catalogue, &s->options->levels),
    };
    girih_refinement *refinement = &s->refinements[number];
    girih_result result = girih_refinement_run(refinement, &desc, frame, error);
    s->drawings[number].plan = refinement->plan;
    s->drawings[number].mode = refinement->mode;
    s->drawings[number].has_splits = refinement->has_splits;
    s->statistics = refinement->statistics;
    s->times = refinement->times;
    if (result == GIRIH_OK && surface == GIRIH_SURFACE_OWN && s->mode == GIRIH_MODE_INSTANCED) {
        result = girih_own_surface_compile_drawing(&s->own, refinement->has_splits, error);
        s->file = result == GIRIH_OK ? s->file : NULL; // the message names what it is about
    }
    return result;
}

static girih_result add_drawing(session *s, girih_surface surface, const girih_frame *frame,
                                uint32_t x, uint32_t width, girih_error *error) {
    uint32_t number = s->drawing_count++;
    s->drawings[number] = (girih_drawing){
        .mode = s->mode, .surface = surface, .own = &s->own, .x = x, .width = width};
    return s->options->device.cpu ? refine_on_cpu(s, number, surface, frame, error)
                                  : refine_on_device(s, number, surface, frame, error);
}

static girih_result add_drawings(session *s, girih_error *error) {
    const render_options *options = s->options;
    uint32_t width = options->camera.width;
    uint32_t half = width / 2;
    girih_frame frame = girih_frame_from_options(&options->levels, &s->view);
    frame.surface_set = s->own.set;
    frame.cull_frustum = 1;
    frame.cull_back = !options->has_back_face_color;
    girih_result result = GIRIH_OK;
    if (options->beside_input) {
        girih_frame input = frame;
        input.rule = GIRIH_LEVEL_SEGMENTS;
        input.segments = 1;
        result = add_drawing(s, GIRIH_SURFACE_FLAT, &input, 0, half, error);
    }
    if (result == GIRIH_OK) {
        uint32_t x = options->beside_input ? width - half : 0;
        result = add_drawing(s, options->surface.surface, &frame, x,
                             options->beside_input ? half : width, error);
    }
    return result;
}

static girih_result draw(session *s, girih_error *error) {
    const render_options *options = s->options;
    const uint32_t width = options->camera.width;
    const uint32_t height = options->camera.height;
    const girih_renderer_desc desc = {
        .device = &s->device,
        .context = s->context,
        .catalogue = s->catalogue.catalogue,
        .model = &s->model,
        .surface_layout = s->own.layout,
        .frame_count = 1,
    };
    girih_picture picture = {
        .view = &s->view,
        .shade = options->shade,
        .wireframe = options->wireframe,
        .line_width = 1.0f,
        .has_back_face_color = options->has_back_face_color,
        .drawings = s->drawings,
        .drawing_count = s->drawing_count,
    };
    memcpy(picture.back_face_color, options->back_face_color, sizeof picture.back_face_color);
    uint8_t *rgba = malloc((size_t)width * height * 4);
    if (rgba == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_report_progress("drawing");
    girih_result result = girih_renderer_create(&desc, &s->renderer, error);
    if (result == GIRIH_OK) {
        result = girih_renderer_resize(s->renderer, width, height, error);
    }
    if (result == GIRIH_OK) {
        result = girih_renderer_draw(s->renderer, &picture, rgba, &s->times.draw, error);
    }
    char message[sizeof error->message];
    if (result == GIRIH_OK &&
        !girih_png_write(options->output, width, height, rgba, message, sizeof message)) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", message);
        s->file = options->output;
    }
    girih_report_progress(NULL);
    free(rgba);
    return result;
}

static girih_result make_picture(session *s, girih_error *error) {
    const render_options *options = s->options;
    if (girih_output_is_same(options->model, options->output)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "is the input; write to another file");
    }
    girih_result result =
        girih_catalogue_source_open(&s->catalogue, options->surface.catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_model_load(&s->model, options->model, GIRIH_MODEL_DRAW, &options->surface,
                                  &options->pose, error);
    }
    if (result == GIRIH_OK) {
        result = girih_model_instances(&s->model, true, &s->instances, &s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_own_surface_load(&s->own, options->model, &options->surface, &s->model,
                                        s->instances, s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        uint32_t width = options->beside_input ? options->camera.width / 2 : options->camera.width;
        result = girih_view_create(&s->view, &options->camera, &s->model, s->instances,
                                   s->instance_count, width, options->camera.height, error);
    }
    if (result == GIRIH_OK) {
        result = open_device(s, error);
    }
    if (result == GIRIH_OK) {
        result = add_drawings(s, error);
    }
    if (result == GIRIH_OK) {
        result = draw(s, error);
    }
    return result;
}

static void close_session(session *s) {
    if (s->is_device_open) {
        girih_renderer_destroy(s->renderer);
        for (uint32_t n = 0; n < s->drawing_count; n++) {
            girih_plan_destroy(s->refinements[n].plan);
            for (int k = 0; k < 3; k++) {
                girih_device_buffer_destroy(&s->device, &s->buffers[n][k]);
            }
            girih_cpu_output_free(&s->outputs[n]);
        }
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

int girih_command_render(int argc, char **argv) {
    render_options options = {0};
    girih_options_parse(&render_argp, argc, argv, &options);
    session s = {.options = &options, .file = options.model};
    girih_error error = {.result = GIRIH_OK};
    girih_result result = make_picture(&s, &error);
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE + 32];
    snprintf(device, sizeof device, "%s%s", options.device.cpu ? "CPU, drawn by " : "",
             s.device.properties.deviceName);
    close_session(&s);
    if (result != GIRIH_OK) {
        return girih_report_failure(s.file, error.message);
    }
    int code = GIRIH_EXIT_DONE;
    const char *mode = girih_mode_name(s.drawings[s.drawing_count - 1].mode);
    if (options.json) {
        code = girih_report_print(girih_report_json(device, mode, &s.statistics, &s.times));
    } else {
        girih_report_text(device, mode, &s.statistics, &s.times);
    }
    return s.device.validation_messages != 0 ? GIRIH_EXIT_FAILED : code;
}
