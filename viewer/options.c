#include "options.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "output_file.h"
#include "report.h"

enum {
    KEY_SEGMENTS = GIRIH_KEY_SHARED,
    KEY_MAX_SEGMENTS,
    KEY_EDGE_PIXELS,
    KEY_EDGE_LENGTH,
    KEY_SURFACE,
    KEY_BASE,
    KEY_DISPLACE,
    KEY_HEIGHT,
    KEY_HEIGHT_ZERO,
    KEY_CREASE,
    KEY_CATALOGUE,
    KEY_PROJECTION,
    KEY_CAMERA_POSITION,
    KEY_CAMERA_FOCAL_POINT,
    KEY_CAMERA_DIRECTION,
    KEY_CAMERA_VIEW_UP,
    KEY_CAMERA_VIEW_ANGLE,
    KEY_CAMERA_INDEX,
    KEY_RESOLUTION,
    KEY_TIME,
    KEY_ANIMATION,
    KEY_DEVICE,
    KEY_CPU,
    KEY_VALIDATION,
};

#define END_OF_OPTIONS                                                                             \
    { NULL, 0, NULL, 0, NULL, 0 }

uint32_t girih_option_count(struct argp_state *state, const char *option, const char *text,
                            uint32_t least, uint32_t greatest) {
    char *end = NULL;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    // strtoull takes blanks and signs; a count has neither.
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || errno != 0 || value < least ||
        value > greatest) {
        argp_error(state, "--%s: '%s' is not a whole number from %u to %u", option, text, least,
                   greatest);
    }
    return (uint32_t)value;
}

static bool read_number(const char **text, float *value) {
    char *end = NULL;
    *value = strtof(*text, &end);
    bool is_read = end != *text && isfinite(*value);
    *text = end;
    return is_read;
}

float girih_option_number(struct argp_state *state, const char *option, const char *text) {
    const char *end = text;
    float value = 0.0f;
    if (!read_number(&end, &value) || *end != '\0') {
        argp_error(state, "--%s: '%s' is not a number", option, text);
    }
    return value;
}

static float positive_number(struct argp_state *state, const char *option, const char *text) {
    float value = girih_option_number(state, option, text);
    if (!(value > 0.0f)) {
        argp_error(state, "--%s: '%s' is not above 0", option, text);
    }
    return value;
}

void girih_option_vector(struct argp_state *state, const char *option, const char *text,
                         float vector[3]) {
    const char *end = text;
    for (int n = 0; n < 3; n++) {
        if ((n > 0 && *end++ != ',') || !read_number(&end, &vector[n])) {
            argp_error(state, "--%s: '%s' is not three numbers with commas between them", option,
                       text);
        }
    }
    if (*end != '\0') {
        argp_error(state, "--%s: '%s' is not three numbers with commas between them", option, text);
    }
}

girih_mode_option girih_option_mode(struct argp_state *state, const char *text) {
    static const char *const names[] = {"auto", "instanced", "baked", "welded"};
    for (int n = 0; n < 4; n++) {
        if (strcmp(text, names[n]) == 0) {
            return (girih_mode_option)n;
        }
    }
    argp_error(state, "--mode: '%s' is none of instanced, baked, welded, auto", text);
    return GIRIH_MODE_OPTION_AUTO;
}

const char *girih_mode_name(girih_mode mode) {
    return mode == GIRIH_MODE_INSTANCED ? "instanced"
           : mode == GIRIH_MODE_BAKED   ? "baked"
                                        : "welded";
}

void girih_option_model(struct argp_state *state, const char **model, const char *text) {
    if (*model != NULL) {
        argp_error(state, "one MODEL only, '%s' is too many", text);
    }
    *model = text;
}

void girih_option_output(struct argp_state *state, const char *output, bool json) {
    if (!girih_output_is_standard(output)) {
        return;
    }
    if (json) {
        argp_error(state, "-o - and --json both want standard output");
    }
    if (isatty(STDOUT_FILENO)) {
        argp_error(state, "-o -: standard output is a terminal; send it into a file or a pipe");
    }
}

void girih_option_models(struct argp_state *state, const char ***models, uint32_t *model_count,
                         const char *text) {
    const char **grown = realloc(*models, (*model_count + 1) * sizeof **models);
    if (grown == NULL) {
        argp_failure(state, GIRIH_EXIT_FAILED, 0, "out of memory");
        return;
    }
    *models = grown;
    grown[(*model_count)++] = text;
}

void girih_option_surface_on_cpu(struct argp_state *state, const girih_surface_options *surface,
                                 const girih_device_options *device) {
    if (device->cpu && surface->file != NULL) {
        argp_error(state, "--surface: %s is GLSL, which needs a device; leave out --cpu",
                   surface->file);
    }
}

void girih_options_parse(const struct argp *argp, int argc, char **argv, void *input) {
    error_t result = argp_parse(argp, argc, argv, 0, NULL, input);
    if (result != 0) {
        argp_help(argp, stderr, ARGP_HELP_STD_ERR, argv[0]);
    }
}

// --- How fine ---

static void read_random(struct argp_state *state, const char *text, girih_level_options *options) {
    char seed[16];
    const char *colon = strchr(text, ':');
    size_t length = colon != NULL ? (size_t)(colon - text) : 0;
    if (length == 0 || length >= sizeof seed) {
        argp_error(state, "--segments: 'random:%s' is not random:SEED:MAX", text);
        return;
    }
    memcpy(seed, text, length);
    seed[length] = '\0';
    options->rule = GIRIH_LEVEL_RANDOM;
    options->seed = girih_option_count(state, "segments", seed, 0, UINT32_MAX);
    options->segments = girih_option_count(state, "segments", colon + 1, 1, GIRIH_BARYCENTRIC_ONE);
}

static error_t parse_level(int key, char *argument, struct argp_state *state) {
    girih_level_options *options = state->input;
    if (key == ARGP_KEY_INIT) {
        if (!options->is_filled) {
            *options = (girih_level_options){.is_filled = true,
                                             .rule = GIRIH_LEVEL_EDGE_PIXELS,
                                             .length = 8.0f,
                                             .max_segments = GIRIH_BARYCENTRIC_ONE};
        }
        return 0;
    }
    if (key == KEY_MAX_SEGMENTS) {
        options->max_segments =
            girih_option_count(state, "max-segments", argument, 1, GIRIH_BARYCENTRIC_ONE);
        return 0;
    }
    if (key != KEY_SEGMENTS && key != KEY_EDGE_PIXELS && key != KEY_EDGE_LENGTH) {
        return ARGP_ERR_UNKNOWN;
    }
    const char *name = key == KEY_SEGMENTS      ? "segments"
                       : key == KEY_EDGE_PIXELS ? "edge-pixels"
                                                : "edge-length";
    if (options->given != NULL) {
        argp_error(state, "--%s: --%s is given already, and one is all there can be", name,
                   options->given);
    }
    options->given = name;
    if (key == KEY_EDGE_PIXELS) {
        options->rule = GIRIH_LEVEL_EDGE_PIXELS;
        options->length = positive_number(state, name, argument);
    } else if (key == KEY_EDGE_LENGTH) {
        options->rule = GIRIH_LEVEL_EDGE_LENGTH;
        options->length = positive_number(state, name, argument);
    } else if (strncmp(argument, "random:", 7) == 0) {
        read_random(state, argument + 7, options);
    } else {
        options->rule = GIRIH_LEVEL_SEGMENTS;
        options->segments = girih_option_count(state, name, argument, 1, GIRIH_BARYCENTRIC_ONE);
    }
    return 0;
}

static const struct argp_option level_options[] = {
    {NULL, 0, NULL, 0,
     "How fine (--segments, --edge-pixels or --edge-length; without, --edge-pixels 8):", 1},
    {"segments", KEY_SEGMENTS, "N", 0,
     "Every edge in N segments; random:SEED:MAX: in 1 to MAX, by a hash of its ends", 1},
    {"edge-pixels", KEY_EDGE_PIXELS, "P", 0,
     "Segments of about P pixels on the screen; of a cylinder, across it", 1},
    {"edge-length", KEY_EDGE_LENGTH, "L", 0,
     "Segments of length L at most, in the mesh's own units", 1},
    {"max-segments", KEY_MAX_SEGMENTS, "N", 0,
     "The most that an edge may ask for (32768). Triangles with an edge of more than the catalogue "
     "holds are split; edges never get fewer than the catalogue's most for this",
     1},
    END_OF_OPTIONS};

const struct argp girih_level_argp = {level_options, parse_level, NULL, NULL, NULL, NULL, NULL};

// --- Surface ---

static bool read_built_in(const char *text, girih_surface *surface) {
    bool is_flat = strcmp(text, "flat") == 0;
    if (is_flat || strcmp(text, "pn") == 0) {
        *surface = is_flat ? GIRIH_SURFACE_FLAT : GIRIH_SURFACE_PN;
        return true;
    }
    return false;
}

static void read_surface(struct argp_state *state, const char *text,
                         girih_surface_options *options) {
    static const char ending[] = ".glsl";
    size_t size = strlen(text);
    options->file = NULL;
    if (!read_built_in(text, &options->surface)) {
        if (size < sizeof ending || strcmp(text + size - (sizeof ending - 1), ending) != 0) {
            argp_error(state, "--surface: '%s' is neither flat nor pn nor a .glsl file", text);
        }
        options->file = text;
    }
}

static void finish_surface(struct argp_state *state, girih_surface_options *options) {
    if (options->has_base && options->file == NULL) {
        argp_error(state, "--base: what a .glsl file of --surface stands on; there is none");
    }
    if (options->height_map != NULL && !options->has_height) {
        argp_error(state, "--displace: no --height H to say how high the map goes");
    }
    if (options->height_map == NULL && (options->has_height || options->has_height_zero)) {
        argp_error(state, "--%s: there is no --displace",
                   options->has_height ? "height" : "height-zero");
    }
    // Filled before, it may be an own one already.
    if (options->file == NULL && options->surface != GIRIH_SURFACE_OWN) {
        options->base = options->surface;
    }
    if (options->file != NULL || options->height_map != NULL) {
        options->surface = GIRIH_SURFACE_OWN;
    }
}

static error_t parse_surface(int key, char *argument, struct argp_state *state) {
    girih_surface_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        if (!options->is_filled) {
            *options = (girih_surface_options){.is_filled = true,
                                               .surface = GIRIH_SURFACE_PN,
                                               .base = GIRIH_SURFACE_PN,
                                               .crease_degrees = 60.0f,
                                               .catalogue = "dyadic"};
        }
        return 0;
    case KEY_SURFACE:
        read_surface(state, argument, options);
        return 0;
    case KEY_BASE:
        if (!read_built_in(argument, &options->base)) {
            argp_error(state, "--base: '%s' is neither flat nor pn", argument);
        }
        options->has_base = true;
        return 0;
    case KEY_DISPLACE:
        options->height_map = argument;
        return 0;
    case KEY_HEIGHT:
        options->height = girih_option_number(state, "height", argument);
        options->has_height = true;
        return 0;
    case KEY_HEIGHT_ZERO:
        options->height_zero = girih_option_number(state, "height-zero", argument);
        options->has_height_zero = true;
        return 0;
    case KEY_CREASE:
        options->crease_degrees = girih_option_number(state, "crease", argument);
        if (!(options->crease_degrees >= 0.0f && options->crease_degrees <= 180.0f)) {
            argp_error(state, "--crease: '%s' is not from 0 to 180", argument);
        }
        return 0;
    case KEY_CATALOGUE:
        options->catalogue = argument;
        return 0;
    case ARGP_KEY_END:
        finish_surface(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option surface_options[] = {
    {NULL, 0, NULL, 0, "Surface:", 2},
    {"surface", KEY_SURFACE, "flat|pn|FILE.glsl", 0,
     "The triangles as they are, Curved PN triangles (the default), or a function of yours: "
     "vec3 girih_surface(GirihPatch, vec3)",
     2},
    {"base", KEY_BASE, "flat|pn", 0, "What the function of --surface FILE.glsl stands on (pn)", 2},
    {"displace", KEY_DISPLACE, "MAP", 0,
     "Move the surface along its normal by a height map (PNG or OpenEXR), laid on by TEXCOORD_0, "
     "or "
     "along the axes where a model has none",
     2},
    {"height", KEY_HEIGHT, "H", 0, "Mesh units that 1 in the map is high; a PNG has 0 to 1", 2},
    {"height-zero", KEY_HEIGHT_ZERO, "Z", 0, "Height in the map that moves nothing (0)", 2},
    {"crease", KEY_CREASE, "DEGREES", 0,
     "Where a model has no normals: edges that bend by more than this are hard (60)", 2},
    {"catalogue", KEY_CATALOGUE, "dyadic|linear|FILE", 0,
     "Base patterns: up to 64 segments in powers of two (the default), 1 to 16 segments, or a file",
     2},
    END_OF_OPTIONS};

const struct argp girih_surface_argp = {
    surface_options, parse_surface, NULL, NULL, NULL, NULL, NULL};

// --- Camera ---

static void read_resolution(struct argp_state *state, const char *text,
                            girih_camera_options *options) {
    char width[16];
    const char *comma = strchr(text, ',');
    size_t length = comma != NULL ? (size_t)(comma - text) : 0;
    if (length == 0 || length >= sizeof width) {
        argp_error(state, "--resolution: '%s' is not W,H", text);
        return;
    }
    memcpy(width, text, length);
    width[length] = '\0';
    options->width = girih_option_count(state, "resolution", width, 1, 32768);
    options->height = girih_option_count(state, "resolution", comma + 1, 1, 32768);
}

static void check_camera(struct argp_state *state, girih_camera_options *options) {
    // A camera of a file says where it stands and looks to; a panorama's angle is none of its own.
    if (options->has_index &&
        (options->has_position || options->has_direction || options->has_focal_point ||
         options->has_view_up || (options->has_view_angle && !options->cylindrical))) {
        argp_error(state, "--camera-index: a camera of the file takes no other --camera option");
    }
    float widest = options->cylindrical ? 360.0f : 175.0f;
    if (!options->has_view_angle) {
        options->view_angle = options->cylindrical ? 360.0f : 30.0f;
    } else if (!(options->view_angle >= 0.01f && options->view_angle <= widest)) {
        argp_error(state, "--camera-view-angle: %g is not from 0.01 to %g",
                   (double)options->view_angle, (double)widest);
    }
    if (options->has_direction && (options->has_position || options->cylindrical)) {
        argp_error(state, options->cylindrical
                              ? "--camera-direction: a panorama looks around; aim it with "
                                "--camera-focal-point"
                              : "--camera-direction finds the position itself, and "
                                "--camera-position is given");
    }
    if (options->has_position && options->has_focal_point &&
        memcmp(options->position, options->focal_point, sizeof options->position) == 0) {
        argp_error(state, "--camera-position and --camera-focal-point are the same point");
    }
}

static error_t parse_camera(int key, char *argument, struct argp_state *state) {
    girih_camera_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        *options =
            (girih_camera_options){.view_up = {0.0f, 1.0f, 0.0f}, .width = 1000, .height = 600};
        return 0;
    case KEY_PROJECTION:
        options->cylindrical = strcmp(argument, "cylinder") == 0;
        if (!options->cylindrical && strcmp(argument, "perspective") != 0) {
            argp_error(state, "--projection: '%s' is neither perspective nor cylinder", argument);
        }
        return 0;
    case KEY_CAMERA_POSITION:
        girih_option_vector(state, "camera-position", argument, options->position);
        options->has_position = true;
        return 0;
    case KEY_CAMERA_FOCAL_POINT:
        girih_option_vector(state, "camera-focal-point", argument, options->focal_point);
        options->has_focal_point = true;
        return 0;
    case KEY_CAMERA_DIRECTION:
        girih_option_vector(state, "camera-direction", argument, options->direction);
        options->has_direction = true;
        if (options->direction[0] == 0.0f && options->direction[1] == 0.0f &&
            options->direction[2] == 0.0f) {
            argp_error(state, "--camera-direction: a direction cannot be 0,0,0");
        }
        return 0;
    case KEY_CAMERA_VIEW_UP:
        girih_option_vector(state, "camera-view-up", argument, options->view_up);
        options->has_view_up = true;
        if (options->view_up[0] == 0.0f && options->view_up[1] == 0.0f &&
            options->view_up[2] == 0.0f) {
            argp_error(state, "--camera-view-up: a direction cannot be 0,0,0");
        }
        return 0;
    case KEY_CAMERA_VIEW_ANGLE:
        options->view_angle = girih_option_number(state, "camera-view-angle", argument);
        options->has_view_angle = true;
        return 0;
    case KEY_CAMERA_INDEX:
        options->index = girih_option_count(state, "camera-index", argument, 0, UINT32_MAX);
        options->has_index = true;
        return 0;
    case KEY_RESOLUTION:
        read_resolution(state, argument, options);
        return 0;
    case ARGP_KEY_END:
        check_camera(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option camera_options[] = {
    {NULL, 0, NULL, 0, "Camera (without, one that frames the model):", 3},
    {"projection", KEY_PROJECTION, "perspective|cylinder", 0,
     "cylinder: a panorama, the angle around the upward axis across the picture; up the picture it "
     "is perspective, as high as makes pixels on the horizon square, and moved so that the middle "
     "row shows the focal point's height. --edge-pixels then counts pixels across alone. Without a "
     "position it stands in the middle of the model",
     3},
    {"camera-position", KEY_CAMERA_POSITION, "X,Y,Z", 0, "Where it stands", 3},
    {"camera-focal-point", KEY_CAMERA_FOCAL_POINT, "X,Y,Z", 0, "What it looks at", 3},
    {"camera-direction", KEY_CAMERA_DIRECTION, "X,Y,Z", 0,
     "Where it looks, from as near as shows all of the model: 0,0,-1 is from the front, -1,0,0 "
     "from "
     "the right, 0,-1,0 from above",
     3},
    {"camera-view-up", KEY_CAMERA_VIEW_UP, "X,Y,Z", 0, "What is up (0,1,0)", 3},
    {"camera-view-angle", KEY_CAMERA_VIEW_ANGLE, "DEGREES", 0,
     "Vertical view angle (30); of a cylinder the horizontal one, up to 360 (360)", 3},
    {"camera-index", KEY_CAMERA_INDEX, "N", 0, "Camera N of the file, from 0", 3},
    {"resolution", KEY_RESOLUTION, "W,H", 0, "Size of the picture (1000,600)", 3},
    END_OF_OPTIONS};

const struct argp girih_camera_argp = {camera_options, parse_camera, NULL, NULL, NULL, NULL, NULL};

// --- Pose ---

static error_t parse_pose(int key, char *argument, struct argp_state *state) {
    girih_pose_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        *options = (girih_pose_options){.has_time = false};
        return 0;
    case KEY_TIME:
        options->time = girih_option_number(state, "time", argument);
        options->has_time = true;
        return 0;
    case KEY_ANIMATION:
        options->animation = argument;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option pose_options[] = {
    {NULL, 0, NULL, 0, "Pose (without, that of the file's nodes):", 6},
    {"time", KEY_TIME, "T", 0,
     "The model as it is T seconds into an animation; the last pose behind its end", 6},
    {"animation", KEY_ANIMATION, "N|NAME", 0,
     "The animation of --time, by its number or name (0); without --time its beginning", 6},
    END_OF_OPTIONS};

const struct argp girih_pose_argp = {pose_options, parse_pose, NULL, NULL, NULL, NULL, NULL};

// --- Device ---

static error_t parse_device(int key, char *argument, struct argp_state *state) {
    girih_device_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT: {
        const char *validation = getenv("GIRIH_VALIDATION");
        *options = (girih_device_options){.validation =
                                              validation != NULL && strcmp(validation, "1") == 0};
        return 0;
    }
    case KEY_DEVICE:
        options->name = argument;
        return 0;
    case KEY_CPU:
        options->cpu = true;
        return 0;
    case KEY_VALIDATION:
        options->validation = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option device_options[] = {
    {NULL, 0, NULL, 0, "Device:", 4},
    {"device", KEY_DEVICE, "NAME", 0, "The Vulkan device whose name has NAME in it", 4},
    {"cpu", KEY_CPU, NULL, 0, "Refine on the CPU instead", 4},
    {"validation", KEY_VALIDATION, NULL, 0,
     "Check every Vulkan call (Khronos validation layer); a message is a failure. "
     "GIRIH_VALIDATION=1 does the same",
     4},
    END_OF_OPTIONS};

const struct argp girih_device_argp = {device_options, parse_device, NULL, NULL, NULL, NULL, NULL};

const struct argp_child girih_option_children[] = {{&girih_level_argp, 0, NULL, 1},
                                                   {&girih_surface_argp, 0, NULL, 2},
                                                   {&girih_camera_argp, 0, NULL, 3},
                                                   {&girih_device_argp, 0, NULL, 4},
                                                   {NULL, 0, NULL, 0}};
