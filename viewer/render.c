// girih render: refined models as PNGs.
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <wordexp.h>

#include "commands.h"
#include "error.h"
#include "output_file.h"
#include "png.h"
#include "session.h"

// One side of --compare, or all of the picture.
typedef struct side_options {
    girih_level_options levels;
    girih_surface_options surface;
    girih_look_options look;
    const char *caption; // the options of --compare, NULL: there is none
    wordexp_t words;     // they point into
} side_options;

typedef struct render_options {
    const char *model, *output;
    girih_camera_options camera;
    girih_device_options device;
    const char *compare[2];
    side_options sides[2];
    uint32_t side_count;
    uint32_t turntable; // pictures, 0: there is none
    girih_pose_options pose;
    bool beside_input, transparent, json;
} render_options;

// --- Options ---

enum { KEY_BESIDE_INPUT = GIRIH_KEY_OWN, KEY_COMPARE, KEY_TRANSPARENT, KEY_TURNTABLE, KEY_JSON };

static const struct argp_option own_options[] = {
    {"output", 'o', "FILE", 0, "The PNG to write; - is standard output", 0},
    {"beside-input", KEY_BESIDE_INPUT, NULL, 0,
     "Left half: the model as it is; right half: refined", 0},
    {"compare", KEY_COMPARE, "'OPTIONS' 'OPTIONS'", 0,
     "Left half: with these options more; right half: with those. Options of how fine, surface and "
     "look; the camera is the same",
     0},
    {"transparent", KEY_TRANSPARENT, NULL, 0, "No background", 0},
    {"turntable", KEY_TURNTABLE, "N", 0,
     "N pictures from all around the upward axis through the focal point: -o turn.png gives "
     "turn-000.png, turn-001.png, ...",
     0},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object with counts and times", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static void check_side(struct argp_state *state, const side_options *side,
                       const girih_device_options *device) {
    girih_look_on_cpu(state, &side->look, device);
    girih_option_surface_on_cpu(state, &side->surface, device);
}

static error_t parse_side(int key, char *argument, struct argp_state *state) {
    side_options *side = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &side->levels;
        state->child_inputs[1] = &side->surface;
        state->child_inputs[2] = &side->look;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "'%s' is no option", argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child side_children[] = {{&girih_level_argp, 0, NULL, 1},
                                                  {&girih_surface_argp, 0, NULL, 2},
                                                  {&girih_look_argp, 0, NULL, 4},
                                                  {NULL, 0, NULL, 0}};
static const struct argp side_argp = {NULL, parse_side, NULL, NULL, side_children, NULL, NULL};

// The words of a side, split as a shell does, read over the options outside of --compare.
static void read_side(struct argp_state *state, const char *text, side_options *side) {
    // The program's name first: argp's messages begin with it.
    side->words.we_offs = 1;
    if (wordexp(text, &side->words, WRDE_NOCMD | WRDE_DOOFFS) != 0) {
        argp_error(state, "--compare: '%s' cannot be split into options", text);
        return;
    }
    side->words.we_wordv[0] = (char[]){"girih render"};
    side->caption = text[0] != '\0' ? text : "no options";
    side->levels.given = NULL; // another rule takes its place
    argp_parse(&side_argp, (int)side->words.we_wordc + 1, side->words.we_wordv, ARGP_NO_HELP, NULL,
               side);
}

static void check_options(struct argp_state *state, render_options *options) {
    if (options->output == NULL) {
        argp_error(state, "no -o FILE to write the picture to");
    }
    girih_option_output(state, options->output, options->json);
    if (options->turntable != 0 && girih_output_is_standard(options->output)) {
        argp_error(state, "--turntable writes many files, and -o - is one");
    }
    options->side_count = 1;
    if (options->compare[0] != NULL) {
        options->side_count = 2;
        options->sides[1] = options->sides[0];
        for (int n = 0; n < 2; n++) {
            read_side(state, options->compare[n], &options->sides[n]);
        }
    }
    for (uint32_t n = 0; n < options->side_count; n++) {
        check_side(state, &options->sides[n], &options->device);
    }
    if (options->beside_input && options->side_count == 2) {
        argp_error(state, "--beside-input and --compare both want the two halves");
    }
    if ((options->beside_input || options->side_count == 2) && options->camera.width < 2) {
        argp_error(state, "%s needs a picture at least 2 pixels wide",
                   options->beside_input ? "--beside-input" : "--compare");
    }
    if (options->turntable != 0 && (options->camera.has_index || options->camera.cylindrical)) {
        argp_error(state,
                   "--turntable moves the camera, so neither --camera-index nor --projection "
                   "cylinder goes with it");
    }
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    render_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->sides[0].levels;
        state->child_inputs[1] = &options->sides[0].surface;
        state->child_inputs[2] = &options->camera;
        state->child_inputs[3] = &options->device;
        state->child_inputs[4] = &options->sides[0].look;
        state->child_inputs[5] = &options->pose;
        return 0;
    case 'o':
        options->output = argument;
        return 0;
    case KEY_BESIDE_INPUT:
        options->beside_input = true;
        return 0;
    case KEY_COMPARE:
        if (state->next >= state->argc) {
            argp_error(state, "--compare takes the options of two sides, each as one argument");
        }
        options->compare[0] = argument;
        options->compare[1] = state->argv[state->next++];
        return 0;
    case KEY_TRANSPARENT:
        options->transparent = true;
        return 0;
    case KEY_TURNTABLE:
        options->turntable = girih_option_count(state, "turntable", argument, 1, 100000);
        return 0;
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
        check_options(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child render_children[] = {{&girih_level_argp, 0, NULL, 1},
                                                    {&girih_surface_argp, 0, NULL, 2},
                                                    {&girih_camera_argp, 0, NULL, 3},
                                                    {&girih_device_argp, 0, NULL, 5},
                                                    {&girih_look_argp, 0, NULL, 4},
                                                    {&girih_pose_argp, 0, NULL, 6},
                                                    {NULL, 0, NULL, 0}};

static const struct argp render_argp = {
    own_options,
    parse,
    "MODEL -o OUT.png",
    "Draws MODEL (.gltf or .glb), its triangles refined on the graphics device, into a PNG."
    "\vExamples:\n"
    "  girih render teapot.glb -o teapot.png\n"
    "  girih render teapot.glb --beside-input --resolution 1600,700 -o both.png\n"
    "  girih render teapot.glb --segments random:7:16 --wireframe -o lines.png\n"
    "  girih render teapot.glb --shade levels -o levels.png\n"
    "  girih render teapot.glb --compare '--surface flat' '--surface pn --wireframe' -o two.png\n"
    "  girih render teapot.glb --turntable 36 --transparent -o turn.png\n"
    "  girih render city.gltf --camera-index 0 --edge-pixels 4 --json -o city.png\n"
    "  girih render model.glb --backface-color 1,0,1 -o cracks.png\n"
    "  girih render fox.glb --animation Run --time 0.5 -o running.png\n",
    render_children,
    NULL,
    NULL};

// --- The work ---

// Everything that lives as long as pictures are in the making.
typedef struct work {
    const render_options *options;
    const char *file; // that a failure is about
    girih_session sides[2];
    girih_camera_options *cameras; // one for every picture
    uint32_t picture_count;
    uint32_t side_width;
    uint8_t *rgba, *side_rgba;
    json_t *reports; // of the pictures, with --json
    char *output;    // of the present picture
} work;

// girih_session's way to say which file a failure is about.
static girih_result note_file(work *w, const girih_session *session, girih_result result) {
    w->file = result == GIRIH_OK ? w->options->model : session->file;
    return result;
}

static girih_result load_sides(work *w, girih_error *error) {
    const render_options *options = w->options;
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < options->side_count && result == GIRIH_OK; n++) {
        const girih_session_desc desc = {
            .model = options->model,
            .pose = &options->pose,
            .levels = &options->sides[n].levels,
            .surface = &options->sides[n].surface,
            .look = &options->sides[n].look,
            .device = &options->device,
        };
        result = note_file(w, &w->sides[n], girih_session_load(&w->sides[n], &desc, error));
    }
    // Both are seen from where the one that strays farther from the model is seen whole.
    girih_model *models[2] = {&w->sides[0].model, &w->sides[1].model};
    if (models[0]->reach < models[1]->reach) {
        models[0]->reach = models[1]->reach;
    }
    return result;
}

static girih_result place_cameras(work *w, girih_error *error) {
    const render_options *options = w->options;
    const girih_session *first = &w->sides[0];
    w->picture_count = options->turntable != 0 ? options->turntable : 1;
    bool is_split = options->side_count == 2 || options->beside_input;
    w->side_width = is_split ? options->camera.width / 2 : options->camera.width;
    w->cameras = malloc(w->picture_count * sizeof *w->cameras);
    if (w->cameras == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    w->cameras[0] = options->camera;
    return options->turntable == 0 ? GIRIH_OK
                                   : girih_camera_turntable(&options->camera, &first->model,
                                                            first->instances, first->instance_count,
                                                            w->side_width, options->camera.height,
                                                            options->turntable, w->cameras, error);
}

// Where the n-th picture goes: a number before the ending, in as many digits as the last one takes.
static girih_result name_output(work *w, uint32_t n, girih_error *error) {
    const char *output = w->options->output;
    size_t size = strlen(output) + 16;
    free(w->output);
    w->output = malloc(size);
    if (w->output == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    const char *slash = strrchr(output, '/');
    const char *name = slash != NULL ? slash + 1 : output;
    const char *dot = strrchr(name, '.');
    int stem = (int)((dot != NULL && dot != name ? dot : name + strlen(name)) - output);
    if (w->options->turntable == 0) {
        snprintf(w->output, size, "%s", output);
    } else {
        int digits = snprintf(NULL, 0, "%u", w->picture_count - 1);
        snprintf(w->output, size, "%.*s-%0*u%s", stem, output, digits < 3 ? 3 : digits, n,
                 output + stem);
    }
    if (girih_output_is_same(w->options->model, w->output)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "is the input; write to another file");
    }
    return GIRIH_OK;
}

// Puts a side's columns into the picture.
static void copy_side(work *w, uint32_t x, uint32_t width) {
    uint32_t whole = w->options->camera.width;
    for (uint32_t row = 0; row < w->options->camera.height; row++) {
        memcpy(w->rgba + 4 * ((size_t)row * whole + x), w->side_rgba + 4 * (size_t)row * width,
               4 * (size_t)width);
    }
}

// As wide and dark as the renderer's own.
static void draw_divider(work *w) {
    static const uint8_t color[4] = {137, 139, 144, 255};
    uint32_t whole = w->options->camera.width;
    uint32_t width = whole >= 4 ? 2 : 1;
    for (uint32_t row = 0; row < w->options->camera.height; row++) {
        for (uint32_t n = 0; n < width; n++) {
            size_t pixel = (size_t)row * whole + (whole - width) / 2 + n;
            memcpy(w->rgba + 4 * pixel, color, sizeof color);
        }
    }
}

static girih_result draw_sides(work *w, const girih_view *view, girih_error *error) {
    const render_options *options = w->options;
    uint32_t whole = options->camera.width;
    bool is_compared = options->side_count == 2;
    bool all_fits = true;
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < options->side_count && result == GIRIH_OK; n++) {
        const girih_shot shot = {
            .view = view,
            .width = is_compared ? w->side_width : whole,
            .height = options->camera.height,
            .beside_input = options->beside_input,
            .transparent = options->transparent,
            .caption = options->sides[n].caption,
        };
        bool fits;
        result = girih_session_draw(&w->sides[n], &shot, is_compared ? w->side_rgba : w->rgba,
                                    &fits, error);
        result = note_file(w, &w->sides[n], result);
        all_fits = all_fits && fits;
        if (result == GIRIH_OK && is_compared) {
            copy_side(w, n == 0 ? 0 : whole - w->side_width, w->side_width);
        }
    }
    if (result == GIRIH_OK && is_compared) {
        draw_divider(w);
    }
    if (result == GIRIH_OK && !all_fits) {
        girih_report_warning(w->output, "too small for its legend or captions");
    }
    return result;
}

static void name_device(const work *w, const girih_session *side, char *name, size_t size) {
    snprintf(name, size, "%s%s", w->options->device.cpu ? "CPU, drawn by " : "",
             side->device.properties.deviceName);
}

// NULL: out of memory, as jansson's functions have it.
static json_t *report_side(const work *w, uint32_t n) {
    const girih_session *side = &w->sides[n];
    char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE + 32];
    name_device(w, side, device, sizeof device);
    json_t *report = girih_report_json(device, girih_session_mode(side),
                                       girih_session_statistics(side), &side->times);
    if (w->options->sides[n].caption != NULL) {
        json_object_set_new(report, "options", json_string(w->options->sides[n].caption));
    }
    return report;
}

static json_t *report_vector(const float v[3]) {
    return json_pack("[f, f, f]", (double)v[0], (double)v[1], (double)v[2]);
}

static json_t *report_picture(const work *w, uint32_t n) {
    json_t *report = w->options->side_count == 1
                         ? report_side(w, 0)
                         : json_pack("{s: [o, o]}", "sides", report_side(w, 0), report_side(w, 1));
    if (w->options->turntable != 0) {
        const girih_camera_options *camera = &w->cameras[n];
        json_object_set_new(report, "output", json_string(w->output));
        json_object_set_new(report, "camera_position", report_vector(camera->position));
        json_object_set_new(report, "camera_focal_point", report_vector(camera->focal_point));
    }
    return report;
}

static girih_result make_picture(work *w, uint32_t n, girih_error *error) {
    const girih_session *first = &w->sides[0];
    const girih_camera_options *camera = &w->cameras[n];
    girih_view view;
    girih_result result = name_output(w, n, error);
    if (result != GIRIH_OK) {
        w->file = w->output;
        return result;
    }
    result = girih_view_create(&view, camera, &first->model, first->instances,
                               first->instance_count, w->side_width, camera->height, error);
    if (result == GIRIH_OK) {
        result = draw_sides(w, &view, error);
    }
    char message[sizeof error->message];
    if (result == GIRIH_OK && !girih_png_write(w->output, camera->width, camera->height, w->rgba,
                                               message, sizeof message)) {
        w->file = w->output;
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", message);
    }
    if (result == GIRIH_OK && w->options->json) {
        json_array_append_new(w->reports, report_picture(w, n));
    }
    return result;
}

static girih_result make_pictures(work *w, girih_error *error) {
    const girih_camera_options *camera = &w->options->camera;
    size_t pixels = (size_t)camera->width * camera->height;
    girih_result result = load_sides(w, error);
    if (result == GIRIH_OK) {
        result = place_cameras(w, error);
    }
    for (uint32_t n = 0; n < w->options->side_count && result == GIRIH_OK; n++) {
        result = note_file(w, &w->sides[n], girih_session_open(&w->sides[n], error));
    }
    if (result != GIRIH_OK) {
        return result;
    }
    w->rgba = malloc(4 * pixels);
    bool is_compared = w->options->side_count == 2;
    w->side_rgba = is_compared ? malloc(4 * (size_t)w->side_width * camera->height) : NULL;
    w->reports = json_array();
    if (w->rgba == NULL || (is_compared && w->side_rgba == NULL)) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < w->picture_count && result == GIRIH_OK; n++) {
        girih_report_part("picture", n, w->picture_count);
        result = make_picture(w, n, error);
    }
    return result;
}

static int report_pictures(work *w) {
    if (w->options->json) {
        json_t *root = w->options->turntable != 0 ? json_pack("{s: O}", "images", w->reports)
                                                  : json_incref(json_array_get(w->reports, 0));
        return girih_report_print(root);
    }
    for (uint32_t n = 0; n < w->options->side_count; n++) {
        const girih_session *side = &w->sides[n];
        char device[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE + 32];
        name_device(w, side, device, sizeof device);
        girih_report_text(device, girih_session_mode(side), girih_session_statistics(side),
                          &side->times);
    }
    return GIRIH_EXIT_DONE;
}

int girih_command_render(int argc, char **argv) {
    render_options options = {0};
    girih_options_parse(&render_argp, argc, argv, &options);
    work w = {.options = &options, .file = options.model};
    girih_error error = {.result = GIRIH_OK};
    girih_result result = make_pictures(&w, &error);
    int code =
        result == GIRIH_OK ? report_pictures(&w) : girih_report_failure(w.file, error.message);
    for (uint32_t n = 0; n < options.side_count; n++) {
        girih_session_close(&w.sides[n]);
        wordfree(&options.sides[n].words);
        code = w.sides[n].device.validation_messages != 0 ? GIRIH_EXIT_FAILED : code;
    }
    json_decref(w.reports);
    free(w.cameras);
    free(w.rgba);
    free(w.side_rgba);
    free(w.output);
    return code;
}
