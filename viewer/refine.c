// girih refine: a refined model as a .glb.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "error.h"
#include "frame.h"
#include "girih/cpu.h"
#include "output_file.h"
#include "own_surface.h"
#include "refinement.h"
#include "weld.h"

typedef struct refine_options {
    const char *model, *output;
    girih_level_options levels;
    girih_surface_options surface;
    girih_camera_options camera;
    girih_device_options device;
    girih_mode mode;
    bool json;
} refine_options;

// --- Options ---

enum { KEY_MODE = GIRIH_KEY_OWN, KEY_JSON };

static const struct argp_option own_options[] = {
    {"output", 'o', "FILE", 0, "The .glb to write", 0},
    {"mode", KEY_MODE, "welded|baked", 0,
     "Share vertices between triangles (welded, the default), or not", 0},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object with counts and times", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static error_t parse(int key, char *argument, struct argp_state *state) {
    refine_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->levels;
        state->child_inputs[1] = &options->surface;
        state->child_inputs[2] = &options->camera;
        state->child_inputs[3] = &options->device;
        return 0;
    case 'o':
        options->output = argument;
        return 0;
    case KEY_MODE: {
        girih_mode_option mode = girih_option_mode(state, argument);
        if (mode == GIRIH_MODE_OPTION_INSTANCED) {
            argp_error(
                state,
                "--mode: instanced triangles are drawn, not written; there are welded and baked");
        }
        options->mode = mode == GIRIH_MODE_OPTION_BAKED ? GIRIH_MODE_BAKED : GIRIH_MODE_WELDED;
        return 0;
    }
    case KEY_JSON:
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        girih_option_model(state, &options->model, argument);
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no MODEL");
        return 0;
    case ARGP_KEY_END:
        if (options->output == NULL) {
            argp_error(state, "no -o FILE to write to");
        }
        girih_option_surface_on_cpu(state, &options->surface, &options->device);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp refine_argp = {
    own_options,
    parse,
    "MODEL -o OUT.glb",
    "Writes MODEL (.gltf or .glb) with its triangles refined: nodes, materials, textures and every "
    "vertex attribute "
    "are kept; skins, morph targets and animations are left out. Nothing is culled. --edge-pixels "
    "measures each mesh "
    "where it stands in its own space."
    "\vExamples:\n"
    "  girih refine spot.glb --segments 4 -o fine.glb\n"
    "  girih refine spot.glb --segments random:7:16 --surface flat -o uneven.glb\n"
    "  girih refine spot.glb --edge-length 0.02 --catalogue linear --cpu --json -o even.glb\n",
    girih_option_children,
    NULL,
    NULL};

// --- Refining ---

typedef struct session {
    const refine_options *options;
    const char *file; // that a failure is about
    girih_catalogue_source catalogue;
    girih_model model;
    girih_own_surface own; // GIRIH_SURFACE_OWN
    girih_instance *instances;
    uint32_t instance_count;
    girih_frame frame;
    girih_cpu_output output; // whoever made it
    girih_mode mode;         // of the output
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    uint32_t validation_messages;
    girih_stage_times times;
} session;

static girih_result no_memory(girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory; ask for fewer segments");
}

// The library frees what it made; what was read from a device is the program's own.
static void free_output(session *s) {
    if (s->options->device.cpu) {
        girih_cpu_output_free(&s->output);
    } else {
        free(s->output.positions);
        free(s->output.attributes);
        free(s->output.indices);
        free(s->output.material_first);
    }
    s->output = (girih_cpu_output){0};
}

static girih_result refine_on_cpu(session *s, girih_error *error) {
    girih_cpu_desc desc = {
        .catalogue = s->catalogue.catalogue,
        .meshes = s->model.meshes,
        .mesh_count = s->model.mesh_count,
        .instances = s->instances,
        .instance_count = s->instance_count,
        .surface = s->options->surface.surface,
        .mode = s->options->mode,
        .outputs = GIRIH_OUTPUT_INDICES,
        .max_segments = girih_segments_beyond(s->catalogue.catalogue, &s->options->levels),
        .own = girih_displacement_surface,
        .own_user = &s->own.displacement,
        .base = s->options->surface.base,
        .reach = s->own.reach,
    };
    snprintf(s->device, sizeof s->device, "CPU");
    girih_result result =
        girih_refinement_run_on_cpu(&desc, &s->frame, &s->output, &s->times, error);
    s->mode = desc.mode;
    return result;
}

// Reads a plan's output into the form that the CPU gives it.
static girih_result read_output(session *s, girih_device *device, const girih_plan *plan,
                                girih_error *error) {
    girih_cpu_output *output = &s->output;
    girih_plan_buffers buffers = girih_plan_get_buffers(plan);
    output->statistics = girih_plan_statistics(plan);
    output->attribute_floats = s->model.attribute_floats;
    output->material_count = girih_plan_material_count(plan);
    size_t vertices = (size_t)output->statistics.output_vertices;
    size_t triangles = (size_t)output->statistics.output_triangles;
    size_t floats = 3 + output->attribute_floats;
    output->material_first = malloc(((size_t)output->material_count + 1) * sizeof(uint32_t));
    output->positions = malloc(vertices * 12 + 1);
    output->attributes = malloc(vertices * floats * 4 + 1);
    output->indices = malloc(triangles * 12 + 1);
    if (output->material_first == NULL || output->positions == NULL || output->attributes == NULL ||
        output->indices == NULL) {
        return no_memory(error);
    }
    for (uint32_t n = 0; n < output->material_count; n++) {
        uint32_t count;
        girih_plan_material_range(plan, n, &output->material_first[n], &count);
        output->material_first[n + 1] = output->material_first[n] + count;
    }
    girih_report_progress("reading back");
    girih_result result =
        girih_device_read(device, &buffers.positions, vertices * 12, output->positions, error);
    if (result == GIRIH_OK) {
        result = girih_device_read(device, &buffers.attributes, vertices * floats * 4,
                                   output->attributes, error);
    }
    if (result == GIRIH_OK) {
        result =
            girih_device_read(device, &buffers.indices, triangles * 12, output->indices, error);
    }
    return result;
}

static girih_result refine_on_device(session *s, girih_error *error) {
    girih_device device;
    girih_context *context = NULL;
    girih_scene *scene = NULL;
    girih_refinement refinement = {0};
    girih_result result =
        girih_device_open(&device, &s->options->device, &(girih_device_wishes){0}, error);
    if (result != GIRIH_OK) {
        return result;
    }
    snprintf(s->device, sizeof s->device, "%s", device.properties.deviceName);
    result = girih_device_context(&device, s->catalogue.catalogue, &context, error);
    if (result == GIRIH_OK) {
        result = girih_refinement_scene(&device, context, s->model.meshes, s->model.mesh_count,
                                        &scene, error);
    }
    if (result == GIRIH_OK && s->options->surface.surface == GIRIH_SURFACE_OWN) {
        result = girih_own_surface_upload(&s->own, &device, context, false, error);
        s->frame.surface_set = s->own.set;
        s->file = result == GIRIH_OK ? s->file : NULL; // the message names what it is about
    }
    if (result == GIRIH_OK) {
        girih_refinement_desc desc = {
            .device = &device,
            .context = context,
            .scene = scene,
            .instances = s->instances,
            .instance_count = s->instance_count,
            .surface = s->options->surface.surface,
            .program = s->own.program,
            .mode = s->options->mode,
            .outputs = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_NO_DRAW,
            .max_segments = girih_segments_beyond(s->catalogue.catalogue, &s->options->levels),
            .vertex_usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
            .index_usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
        };
        result = girih_refinement_run(&refinement, &desc, &s->frame, error);
    }
    if (result == GIRIH_OK) {
        s->times = refinement.times;
        s->mode = refinement.mode;
        result = read_output(s, &device, refinement.plan, error);
    }
    girih_plan_destroy(refinement.plan);
    girih_own_surface_remove(&s->own, &device);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_device_close(&device);
    s->validation_messages = device.validation_messages;
    return result;
}

// --- From the output back to primitives ---

// One primitive's arrays, as girih_gltf_write wants them.
typedef struct primitive_arrays {
    float *positions, *normals;
    float **attributes;
    uint32_t *indices;
} primitive_arrays;

// The triangles of a primitive with the vertices they use, in the order of first use.
typedef struct used_vertices {
    const girih_cpu_output *output;
    uint32_t first_triangle, triangle_count;
    uint32_t *vertices; // [count] output vertices
    uint32_t count;
} used_vertices;

// What glTF asks of attributes that interpolation does not keep: tangents of unit length with a
// sign, colours in [0, 1].
static void mend_attribute(const char *name, uint32_t components, float *value) {
    if (strcmp(name, "TANGENT") == 0 && components == 4) {
        float length = sqrtf(value[0] * value[0] + value[1] * value[1] + value[2] * value[2]);
        for (int n = 0; n < 3; n++) {
            value[n] = length > 0.0f ? value[n] / length : (n == 0 ? 1.0f : 0.0f);
        }
        value[3] = value[3] < 0.0f ? -1.0f : 1.0f;
    } else if (strncmp(name, "COLOR_", 6) == 0) {
        for (uint32_t n = 0; n < components; n++) {
            value[n] = value[n] < 0.0f ? 0.0f : value[n] > 1.0f ? 1.0f : value[n];
        }
    }
}

static uint32_t attribute_first(const girih_model *model, const char *name) {
    uint32_t n = 0;
    while (strcmp(model->attributes[n].name, name) != 0) {
        n++;
    }
    return model->attributes[n].first;
}

static float *gather_positions(const used_vertices *used) {
    float *to = malloc((size_t)used->count * 12 + 1);
    for (uint32_t v = 0; v < used->count && to != NULL; v++) {
        memcpy(to + 3 * (size_t)v, used->output->positions + 3 * (size_t)used->vertices[v], 12);
    }
    return to;
}

static float *gather_normals(const used_vertices *used) {
    float *to = malloc((size_t)used->count * 12 + 1);
    size_t stride = 3 + used->output->attribute_floats;
    for (uint32_t v = 0; v < used->count && to != NULL; v++) {
        float *normal = to + 3 * (size_t)v;
        memcpy(normal, used->output->attributes + stride * used->vertices[v], 12);
        // A triangle without area may have none, but glTF wants unit vectors.
        if (normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f) {
            normal[2] = 1.0f;
        }
    }
    return to;
}

static float *gather_attribute(const used_vertices *used, const girih_model *model,
                               const girih_gltf_attribute *attribute) {
    float *to = malloc((size_t)used->count * attribute->components * sizeof(float) + 1);
    size_t stride = 3 + used->output->attribute_floats;
    size_t first = 3 + attribute_first(model, attribute->name);
    for (uint32_t v = 0; v < used->count && to != NULL; v++) {
        float *value = to + (size_t)v * attribute->components;
        memcpy(value, used->output->attributes + stride * used->vertices[v] + first,
               attribute->components * sizeof(float));
        mend_attribute(attribute->name, attribute->components, value);
    }
    return to;
}

// number: output vertex -> vertex of the primitive, UINT32_MAX where it has none yet. No vertex is
// shared between primitives, so it serves for all of them.
static girih_result fill_primitive(const session *s, const girih_gltf_primitive *source,
                                   uint32_t material, uint32_t *number, primitive_arrays *arrays,
                                   girih_gltf_refined_primitive *refined, girih_error *error) {
    const girih_cpu_output *output = &s->output;
    used_vertices used = {.output = output};
    if (material < output->material_count) {
        used.first_triangle = output->material_first[material];
        used.triangle_count = output->material_first[material + 1] - used.first_triangle;
    }
    size_t index_count = 3 * (size_t)used.triangle_count;
    if (index_count > UINT32_MAX) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "%u triangles in one primitive are more than glTF counts; ask for fewer segments",
            used.triangle_count);
    }
    const uint32_t *from = output->indices + 3 * (size_t)used.first_triangle;
    arrays->indices = malloc(index_count * 4 + 1);
    arrays->attributes = calloc((size_t)source->attribute_count + 1, sizeof *arrays->attributes);
    if (arrays->indices == NULL || arrays->attributes == NULL) {
        return no_memory(error);
    }
    for (size_t n = 0; n < index_count; n++) {
        if (number[from[n]] == UINT32_MAX) {
            number[from[n]] = used.count++;
        }
        arrays->indices[n] = number[from[n]];
    }
    used.vertices = malloc((size_t)used.count * 4 + 1);
    if (used.vertices == NULL) {
        return no_memory(error);
    }
    for (size_t n = 0; n < index_count; n++) {
        used.vertices[arrays->indices[n]] = from[n];
    }
    bool has_normals = source->normals != NULL || s->options->surface.surface != GIRIH_SURFACE_FLAT;
    arrays->positions = gather_positions(&used);
    arrays->normals = has_normals ? gather_normals(&used) : NULL;
    bool is_short = arrays->positions == NULL || (has_normals && arrays->normals == NULL);
    for (uint32_t n = 0; n < source->attribute_count; n++) {
        arrays->attributes[n] = gather_attribute(&used, &s->model, &source->attributes[n]);
        is_short |= arrays->attributes[n] == NULL;
    }
    free(used.vertices);
    *refined = (girih_gltf_refined_primitive){
        .vertex_count = used.count,
        .positions = arrays->positions,
        .normals = arrays->normals,
        .attributes = (const float *const *)arrays->attributes,
        .index_count = (uint32_t)index_count,
        .indices = arrays->indices,
    };
    return is_short ? no_memory(error) : GIRIH_OK;
}

static void free_arrays(const girih_gltf_contents *contents, primitive_arrays *arrays) {
    size_t at = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++, at++) {
            for (uint32_t a = 0; a < contents->meshes[m].primitives[n].attribute_count; a++) {
                free(arrays[at].attributes != NULL ? arrays[at].attributes[a] : NULL);
            }
            free(arrays[at].attributes);
            free(arrays[at].positions);
            free(arrays[at].normals);
            free(arrays[at].indices);
        }
    }
    free(arrays);
}

static girih_result fill_primitives(session *s, primitive_arrays *arrays,
                                    girih_gltf_refined_primitive *refined,
                                    const girih_gltf_refined_primitive **meshes,
                                    girih_error *error) {
    const girih_gltf_contents *contents = s->model.contents;
    size_t vertices = (size_t)s->output.statistics.output_vertices;
    uint32_t *number = malloc(vertices * 4 + 1);
    if (number == NULL) {
        return no_memory(error);
    }
    memset(number, 0xff, vertices * 4);
    girih_result result = GIRIH_OK;
    uint32_t at = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        meshes[m] = refined + at;
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count && result == GIRIH_OK;
             n++, at++) {
            result = fill_primitive(s, &contents->meshes[m].primitives[n], at, number, &arrays[at],
                                    &refined[at], error);
        }
    }
    free(number);
    return result;
}

static girih_result write_model(session *s, girih_error *error) {
    const girih_gltf_contents *contents = s->model.contents;
    size_t primitive_count = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        primitive_count += contents->meshes[m].primitive_count;
    }
    primitive_arrays *arrays = calloc(primitive_count + 1, sizeof *arrays);
    girih_gltf_refined_primitive *refined = calloc(primitive_count + 1, sizeof *refined);
    const girih_gltf_refined_primitive **meshes =
        calloc((size_t)contents->mesh_count + 1, sizeof *meshes);
    girih_result result = arrays == NULL || refined == NULL || meshes == NULL
                              ? no_memory(error)
                              : fill_primitives(s, arrays, refined, meshes, error);
    free_output(s);
    if (result == GIRIH_OK) {
        girih_report_progress("writing");
        char message[sizeof error->message];
        if (!girih_gltf_write(s->model.file, meshes, s->options->output, message, sizeof message)) {
            result = girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", message);
        }
        girih_report_progress(NULL);
    }
    if (arrays != NULL) {
        free_arrays(contents, arrays);
    }
    free(refined);
    free(meshes);
    return result;
}

// --- The command ---

static void warn_of_losses(const session *s) {
    const girih_gltf_contents *contents = s->model.contents;
    if (contents->animation_count + contents->skin_count + contents->morph_target_count != 0) {
        char text[160];
        snprintf(
            text, sizeof text,
            "%u animations, %u skins and %u morph targets are left out; the bind pose is written",
            contents->animation_count, contents->skin_count, contents->morph_target_count);
        girih_report_warning(s->options->model, text);
    }
}

static girih_result make_model(session *s, girih_error *error) {
    const refine_options *options = s->options;
    if (girih_output_is_same(options->model, options->output)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "is the input; write to another file");
    }
    girih_result result =
        girih_catalogue_source_open(&s->catalogue, options->surface.catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_model_load(&s->model, options->model, GIRIH_MODEL_REFINE, &options->surface,
                                  NULL, error);
    }
    if (result == GIRIH_OK) {
        warn_of_losses(s);
        result = girih_model_instances(&s->model, false, &s->instances, &s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_own_surface_load(&s->own, options->model, &options->surface, &s->model,
                                        s->instances, s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_frame_create(&s->frame, &options->levels, &options->camera, &s->model,
                                    s->instances, s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = options->device.cpu ? refine_on_cpu(s, error) : refine_on_device(s, error);
    }
    if (result == GIRIH_OK && options->mode == GIRIH_MODE_WELDED && s->mode != GIRIH_MODE_WELDED) {
        girih_report_progress("welding");
        const char *reason = girih_weld(&s->output);
        result =
            reason == NULL ? GIRIH_OK : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "%s", reason);
    }
    girih_report_progress(NULL);
    return result;
}

int girih_command_refine(int argc, char **argv) {
    refine_options options = {.mode = GIRIH_MODE_WELDED};
    girih_options_parse(&refine_argp, argc, argv, &options);
    session s = {.options = &options, .file = options.model};
    girih_error error = {.result = GIRIH_OK};
    girih_result result = make_model(&s, &error);
    girih_statistics statistics = s.output.statistics;
    if (result == GIRIH_OK) {
        girih_model_free_meshes(&s.model);
        result = write_model(&s, &error);
        s.file = options.output;
    }
    free_output(&s);
    girih_own_surface_free(&s.own);
    free(s.instances);
    girih_model_free(&s.model);
    girih_catalogue_source_free(&s.catalogue);
    if (result != GIRIH_OK) {
        return girih_report_failure(s.file, error.message);
    }
    int code = GIRIH_EXIT_DONE;
    const char *mode = girih_mode_name(options.mode);
    if (options.json) {
        json_t *report = girih_report_json(s.device, mode, &statistics, &s.times);
        if (report != NULL &&
            json_object_set_new(report, "output", json_string(options.output)) != 0) {
            json_decref(report);
            report = NULL;
        }
        code = girih_report_print(report);
    } else {
        girih_report_text(s.device, mode, &statistics, &s.times);
    }
    return s.validation_messages != 0 ? GIRIH_EXIT_FAILED : code;
}
