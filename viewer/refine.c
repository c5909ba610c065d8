// girih refine: a refined model as a .glb.
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "error.h"
#include "frame.h"
#include "girih/cpu.h"
#include "output_file.h"
#include "own_surface.h"
#include "places.h"
#include "refined_model.h"
#include "refinement.h"
#include "weld.h"

typedef struct refine_options {
    const char **models; // [model_count]
    uint32_t model_count;
    const char *output, *folder; // one of them
    girih_level_options levels;
    girih_surface_options surface;
    girih_camera_options camera;
    girih_device_options device;
    girih_mode mode;
    bool overwrites, json;
} refine_options;

// --- Options ---

enum { KEY_MODE = GIRIH_KEY_OWN, KEY_OUTPUT_FOLDER, KEY_OVERWRITE, KEY_JSON };

static const struct argp_option own_options[] = {
    {"output", 'o', "FILE", 0, "The .glb to write; - is standard output", 0},
    {"output-folder", KEY_OUTPUT_FOLDER, "FOLDER", 0,
     "Write every MODEL as FOLDER/NAME.glb, making the folder where it is not there", 0},
    {"overwrite", KEY_OVERWRITE, NULL, 0, "Replace files that are there already", 0},
    {"mode", KEY_MODE, "welded|baked", 0,
     "Share vertices between triangles (welded, the default), or not", 0},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object with counts and times", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static void check_output(struct argp_state *state, const refine_options *options) {
    if (options->output == NULL && options->folder == NULL) {
        argp_error(state, "no -o FILE to write to");
    }
    if (options->output != NULL && options->folder != NULL) {
        argp_error(state, "-o and --output-folder: one is all there can be");
    }
    if (options->output != NULL && options->model_count > 1) {
        argp_error(state, "-o is one file, and there are %u MODELs; use --output-folder FOLDER",
                   options->model_count);
    }
    if (options->output != NULL) {
        girih_option_output(state, options->output, options->json);
    }
}

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
    case KEY_OUTPUT_FOLDER:
        options->folder = argument;
        return 0;
    case KEY_OVERWRITE:
        options->overwrites = true;
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
        girih_option_models(state, &options->models, &options->model_count, argument);
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no MODEL");
        return 0;
    case ARGP_KEY_END:
        check_output(state, options);
        girih_option_surface_on_cpu(state, &options->surface, &options->device);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp refine_argp = {
    own_options,
    parse,
    "MODEL -o OUT.glb\nMODEL... --output-folder FOLDER",
    "Writes MODEL (.gltf or .glb) with its triangles refined. Everything else stays: nodes, "
    "materials, textures, cameras, lights, animations, skins, morph targets, every vertex "
    "attribute, points and lines, names, extras and extensions; what cannot stay, as extensions "
    "that describe single vertices, is named on standard error. A vertex keeps as many joints as "
    "the source's have, the heaviest. A morph target is the refined surface of the morphed mesh, "
    "at weight 1; displacement does not follow it. Nothing is culled. --edge-pixels measures each "
    "mesh where it stands in its own space."
    "\vExamples:\n"
    "  girih refine spot.glb --segments 4 -o fine.glb\n"
    "  girih refine models/*.glb --segments 4 --output-folder fine\n"
    "  girih refine spot.glb --segments 4 -o - | gzip > fine.glb.gz\n"
    "  girih refine spot.glb --segments random:7:16 --surface flat -o uneven.glb\n"
    "  girih refine spot.glb --edge-length 0.02 --catalogue linear --cpu --json -o even.glb\n",
    girih_option_children,
    NULL,
    NULL};

// --- Refining ---

// What serves one model after another.
typedef struct refiner {
    girih_catalogue_source catalogue;
    bool is_open; // the device
    girih_device device;
    girih_context *context;
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
} refiner;

// The refining of one model.
typedef struct session {
    const refine_options *options;
    refiner *machine;
    const char *input, *output_name;
    const char *file; // that a failure is about
    girih_model model;
    girih_own_surface own; // GIRIH_SURFACE_OWN
    girih_instance *instances;
    uint32_t instance_count;
    girih_frame frame;
    girih_cpu_output output; // whoever made it
    bool has_places;         // of joints and morph targets
    girih_places places;
    girih_mode mode; // of the output
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
        free(s->output.sources);
        free(s->output.material_first);
    }
    s->output = (girih_cpu_output){0};
}

// What joints and morph targets need: triangles that share no vertices, which are welded later.
static girih_mode wanted_mode(const session *s) {
    return s->has_places ? GIRIH_MODE_BAKED : s->options->mode;
}

static uint32_t place_outputs(const session *s) {
    return s->has_places ? GIRIH_OUTPUT_SOURCES : 0;
}

static girih_result refine_on_cpu(session *s, girih_error *error) {
    girih_cpu_desc desc = {
        .catalogue = s->machine->catalogue.catalogue,
        .meshes = s->model.meshes,
        .mesh_count = s->model.mesh_count,
        .instances = s->instances,
        .instance_count = s->instance_count,
        .surface = s->options->surface.surface,
        .mode = wanted_mode(s),
        .outputs = GIRIH_OUTPUT_INDICES | place_outputs(s),
        .max_segments = girih_segments_beyond(s->machine->catalogue.catalogue, &s->options->levels),
        .own = girih_displacement_surface,
        .own_user = &s->own.displacement,
        .base = s->options->surface.base,
        .reach = s->own.reach,
    };
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
    output->sources = s->has_places ? malloc(triangles * 8 + 1) : NULL;
    if (output->material_first == NULL || output->positions == NULL || output->attributes == NULL ||
        output->indices == NULL || (s->has_places && output->sources == NULL)) {
        return no_memory(error);
    }
    for (uint32_t n = 0; n < output->material_count; n++) {
        uint32_t count;
        girih_plan_material_range(plan, n, &output->material_first[n], &count);
        output->material_first[n + 1] = output->material_first[n] + count;
    }
    const struct {
        const girih_buffer_range *from;
        size_t size;
        void *to;
    } parts[] = {{&buffers.positions, vertices * 12, output->positions},
                 {&buffers.attributes, vertices * floats * 4, output->attributes},
                 {&buffers.indices, triangles * 12, output->indices},
                 {&buffers.sources, s->has_places ? triangles * 8 : 0, output->sources}};
    enum { PARTS = sizeof parts / sizeof parts[0] };
    size_t done = 0;
    size_t all = 0;
    for (int n = 0; n < PARTS; n++) {
        all += parts[n].size;
    }
    girih_result result = GIRIH_OK;
    for (int n = 0; n < PARTS && result == GIRIH_OK; n++) {
        girih_report_progress_of("reading back", done, all);
        if (parts[n].size != 0) {
            result = girih_device_read(device, parts[n].from, parts[n].size, parts[n].to, error);
        }
        done += parts[n].size;
    }
    return result;
}

static girih_result refine_on_device(session *s, girih_error *error) {
    girih_device *device = &s->machine->device;
    girih_context *context = s->machine->context;
    girih_scene *scene = NULL;
    girih_refinement refinement = {0};
    girih_result result = girih_refinement_scene(device, context, s->model.meshes,
                                                 s->model.mesh_count, &scene, error);
    if (result == GIRIH_OK && s->options->surface.surface == GIRIH_SURFACE_OWN) {
        result = girih_own_surface_upload(&s->own, device, context, false, error);
        s->frame.surface_set = s->own.set;
        s->file = result == GIRIH_OK ? s->file : NULL; // the message names what it is about
    }
    if (result == GIRIH_OK) {
        girih_refinement_desc desc = {
            .device = device,
            .context = context,
            .scene = scene,
            .instances = s->instances,
            .instance_count = s->instance_count,
            .surface = s->options->surface.surface,
            .program = s->own.program,
            .mode = wanted_mode(s),
            .outputs = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_NO_DRAW | place_outputs(s),
            .max_segments =
                girih_segments_beyond(s->machine->catalogue.catalogue, &s->options->levels),
            .vertex_usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
            .index_usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
        };
        result = girih_refinement_run(&refinement, &desc, &s->frame, error);
    }
    if (result == GIRIH_OK) {
        s->times = refinement.times;
        s->mode = refinement.mode;
        result = read_output(s, device, refinement.plan, error);
    }
    girih_plan_destroy(refinement.plan);
    girih_own_surface_remove(&s->own, device);
    girih_scene_destroy(scene);
    return result;
}

// --- The command ---

static girih_result make_model(session *s, girih_error *error) {
    const refine_options *options = s->options;
    if (girih_output_is_same(s->input, s->output_name)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "is the input; write to another file");
    }
    if (!options->overwrites && girih_output_replaces(s->output_name)) {
        s->file = s->output_name;
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "is there already; --overwrite replaces it");
    }
    girih_result result =
        girih_model_load(&s->model, s->input, GIRIH_MODEL_REFINE, &options->surface, NULL, error);
    if (result == GIRIH_OK) {
        if (girih_places_are_needed(s->model.contents)) {
            s->has_places = true;
            result = girih_places_prepare(&s->places, &s->model, error);
        }
    }
    if (result == GIRIH_OK) {
        result = girih_model_instances(&s->model, false, &s->instances, &s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_own_surface_load(&s->own, s->input, &options->surface, &s->model,
                                        s->instances, s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_frame_create(&s->frame, &options->levels, &options->camera, &s->model,
                                    s->instances, s->instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = options->device.cpu ? refine_on_cpu(s, error) : refine_on_device(s, error);
    }
    const bool welds = options->mode == GIRIH_MODE_WELDED && s->mode != GIRIH_MODE_WELDED;
    if (result == GIRIH_OK && s->has_places) {
        girih_report_progress("welding");
        result = girih_places_find(&s->places, &s->model, &s->output, welds, error);
    } else if (result == GIRIH_OK && welds) {
        girih_report_progress("welding");
        const char *reason = girih_weld(&s->output, NULL, NULL);
        result =
            reason == NULL ? GIRIH_OK : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "%s", reason);
    }
    girih_report_progress(NULL);
    return result;
}

static girih_result write_model(session *s, girih_error *error) {
    const girih_surface_options *surface = &s->options->surface;
    girih_refined_model refined;
    girih_report_progress("writing");
    girih_result result = girih_refined_model_make(
        &refined, &s->model, s->has_places ? &s->places : NULL,
        surface->surface == GIRIH_SURFACE_OWN ? surface->base : surface->surface,
        surface->surface != GIRIH_SURFACE_FLAT, &s->output, error);
    free_output(s);
    girih_places_free(&s->places);
    if (result == GIRIH_OK) {
        result = girih_refined_model_write(&refined, s->input, s->output_name, error);
    }
    girih_refined_model_free(&refined);
    girih_report_progress(NULL);
    return result;
}

// Refines one model; what --json prints goes into *json. Returns an exit code.
static int refine_file(const refine_options *options, refiner *machine, const char *input,
                       const char *output, json_t **json) {
    session s = {.options = options,
                 .machine = machine,
                 .input = input,
                 .output_name = output,
                 .file = input};
    girih_error error = {.result = GIRIH_OK};
    girih_result result = make_model(&s, &error);
    girih_statistics statistics = s.output.statistics;
    if (result == GIRIH_OK) {
        girih_model_free_meshes(&s.model);
        result = write_model(&s, &error);
        s.file = output;
    }
    free_output(&s);
    girih_places_free(&s.places);
    girih_own_surface_free(&s.own);
    free(s.instances);
    girih_model_free(&s.model);
    if (result != GIRIH_OK) {
        return girih_report_failure(s.file, error.message);
    }
    const char *mode = girih_mode_name(options->mode);
    if (options->json) {
        *json = girih_report_json(machine->name, mode, &statistics, &s.times);
        if (*json == NULL || json_object_set_new(*json, "output", json_string(output)) != 0) {
            return girih_report_failure(input, "out of memory for the report");
        }
    } else {
        if (options->model_count > 1) {
            girih_report_progress(NULL);
            fprintf(stderr, "%s -> %s\n", input, output);
        }
        girih_report_text(machine->name, mode, &statistics, &s.times);
    }
    return GIRIH_EXIT_DONE;
}

static girih_result open_machine(refiner *machine, const refine_options *options,
                                 girih_error *error) {
    girih_result result =
        girih_catalogue_source_open(&machine->catalogue, options->surface.catalogue, error);
    if (result != GIRIH_OK) {
        return result;
    }
    if (options->device.cpu) {
        snprintf(machine->name, sizeof machine->name, "CPU");
        return GIRIH_OK;
    }
    result =
        girih_device_open(&machine->device, &options->device, &(girih_device_wishes){0}, error);
    if (result != GIRIH_OK) {
        return result;
    }
    machine->is_open = true;
    snprintf(machine->name, sizeof machine->name, "%s", machine->device.properties.deviceName);
    return girih_device_context(&machine->device, machine->catalogue.catalogue, &machine->context,
                                error);
}

static void close_machine(refiner *machine) {
    if (machine->is_open) {
        girih_context_destroy(machine->context);
        girih_device_close(&machine->device);
    }
    girih_catalogue_source_free(&machine->catalogue);
}

// FOLDER/NAME.glb of a model; NULL where memory ran out.
static char *output_in_folder(const char *folder, const char *model) {
    const char *slash = strrchr(model, '/');
    const char *name = slash != NULL ? slash + 1 : model;
    const char *dot = strrchr(name, '.');
    size_t length = dot != NULL && dot != name ? (size_t)(dot - name) : strlen(name);
    size_t size = strlen(folder) + length + sizeof "/.glb";
    char *path = malloc(size);
    if (path != NULL) {
        snprintf(path, size, "%s/%.*s.glb", folder, (int)length, name);
    }
    return path;
}

// Says what is wrong where it cannot.
static bool make_folder(const char *path) {
    struct stat status;
    if (mkdir(path, 0777) != 0 &&
        (errno != EEXIST || stat(path, &status) != 0 || !S_ISDIR(status.st_mode))) {
        girih_report_failure(path,
                             errno == EEXIST ? "is no folder; name another one" : strerror(errno));
        return false;
    }
    return true;
}

static void free_outputs(char **outputs, uint32_t count) {
    for (uint32_t n = 0; outputs != NULL && n < count; n++) {
        free(outputs[n]);
    }
    free(outputs);
}

// The files to write, no two of them one. Says what is wrong and returns NULL where there are none.
static char **name_outputs(const refine_options *options) {
    char **outputs = calloc(options->model_count, sizeof *outputs);
    bool complete = outputs != NULL;
    for (uint32_t n = 0; n < options->model_count && complete; n++) {
        outputs[n] = options->folder != NULL ? output_in_folder(options->folder, options->models[n])
                                             : strdup(options->output);
        complete = outputs[n] != NULL;
        for (uint32_t k = 0; k < n && complete; k++) {
            if (strcmp(outputs[k], outputs[n]) == 0) {
                char text[4096];
                snprintf(text, sizeof text,
                         "would be written to %s, as %s; refine one of them with -o", outputs[n],
                         options->models[k]);
                girih_report_failure(options->models[n], text);
                free_outputs(outputs, options->model_count);
                return NULL;
            }
        }
    }
    if (!complete) {
        girih_report_failure(NULL, "out of memory");
        free_outputs(outputs, options->model_count);
        return NULL;
    }
    if (options->folder != NULL && !make_folder(options->folder)) {
        free_outputs(outputs, options->model_count);
        return NULL;
    }
    return outputs;
}

// What fails leaves the other models to be refined.
static int refine_files(const refine_options *options, refiner *machine, char *const *outputs) {
    int code = GIRIH_EXIT_DONE;
    json_t *files = json_array();
    for (uint32_t n = 0; n < options->model_count; n++) {
        json_t *json = NULL;
        girih_report_part("file", n, options->model_count);
        if (refine_file(options, machine, options->models[n], outputs[n], &json) !=
            GIRIH_EXIT_DONE) {
            code = GIRIH_EXIT_FAILED;
        }
        if (json != NULL) {
            json_array_append_new(files, json);
        }
    }
    if (!options->json) {
        json_decref(files);
        return code;
    }
    int printed = girih_report_print_files(files, options->model_count);
    return code != GIRIH_EXIT_DONE ? code : printed;
}

int girih_command_refine(int argc, char **argv) {
    refine_options options = {.mode = GIRIH_MODE_WELDED};
    girih_options_parse(&refine_argp, argc, argv, &options);
    refiner machine = {.is_open = false};
    girih_error error = {.result = GIRIH_OK};
    int code = GIRIH_EXIT_FAILED;
    char **outputs = name_outputs(&options);
    if (outputs != NULL) {
        if (open_machine(&machine, &options, &error) != GIRIH_OK) {
            girih_report_failure(NULL, error.message);
        } else {
            code = refine_files(&options, &machine, outputs);
        }
    }
    close_machine(&machine);
    free_outputs(outputs, options.model_count);
    free(options.models);
    return machine.device.validation_messages != 0 ? GIRIH_EXIT_FAILED : code;
}
