#include "look.h"

#include <string.h>

#include "error.h"

static const char *const shade_names[] = {"lit", "normals", "levels", "patterns", "density"};
enum { SHADES = sizeof shade_names / sizeof shade_names[0] };

const char *girih_shade_name(girih_shade shade) {
    return shade_names[shade];
}

bool girih_shade_is_by_pattern(girih_shade shade) {
    return shade == GIRIH_SHADE_LEVELS || shade == GIRIH_SHADE_PATTERNS;
}

// --- Options ---

enum {
    // Apart from the subcommands' own keys.
    KEY_MODE = GIRIH_KEY_SHARED + 128,
    KEY_SHADE,
    KEY_WIREFRAME,
    KEY_LINE_WIDTH,
    KEY_BACKFACE_COLOR,
    KEY_EXPOSURE,
    KEY_SAMPLES,
    KEY_NO_LEGEND,
};

static girih_shade read_shade(struct argp_state *state, const char *text) {
    for (int n = 0; n < SHADES; n++) {
        if (strcmp(text, shade_names[n]) == 0) {
            return (girih_shade)n;
        }
    }
    argp_error(state, "--shade: '%s' is none of lit, normals, levels, patterns, density", text);
    return GIRIH_SHADE_LIT;
}

static float read_within(struct argp_state *state, const char *option, const char *text,
                         float least, float greatest) {
    float value = girih_option_number(state, option, text);
    if (!(value >= least && value <= greatest)) {
        argp_error(state, "--%s: '%s' is not from %g to %g", option, text, (double)least,
                   (double)greatest);
    }
    return value;
}

static void read_back_face_color(struct argp_state *state, const char *text, float color[3]) {
    girih_option_vector(state, "backface-color", text, color);
    for (int n = 0; n < 3; n++) {
        if (!(color[n] >= 0.0f && color[n] <= 1.0f)) {
            argp_error(state, "--backface-color: '%s' is not three numbers from 0 to 1", text);
        }
    }
}

static uint32_t read_samples(struct argp_state *state, const char *text) {
    uint32_t samples = girih_option_count(state, "samples", text, 1, 8);
    if ((samples & (samples - 1)) != 0) {
        argp_error(state, "--samples: %s is none of 1, 2, 4, 8", text);
    }
    return samples;
}

static error_t parse_look(int key, char *argument, struct argp_state *state) {
    girih_look_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        if (!options->is_filled) {
            *options = (girih_look_options){.is_filled = true, .line_width = 1.0f};
        }
        return 0;
    case KEY_MODE: options->mode = girih_option_mode(state, argument); return 0;
    case KEY_SHADE: options->shade = read_shade(state, argument); return 0;
    case KEY_WIREFRAME: options->wireframe = true; return 0;
    case KEY_LINE_WIDTH:
        options->line_width = read_within(state, "line-width", argument, 0.1f, 32.0f);
        options->has_line_width = true;
        return 0;
    case KEY_BACKFACE_COLOR:
        read_back_face_color(state, argument, options->back_face_color);
        options->has_back_face_color = true;
        return 0;
    case KEY_EXPOSURE:
        options->exposure = read_within(state, "exposure", argument, -16.0f, 16.0f);
        return 0;
    case KEY_SAMPLES: options->samples = read_samples(state, argument); return 0;
    case KEY_NO_LEGEND: options->no_legend = true; return 0;
    case ARGP_KEY_END:
        if (options->has_line_width && !options->wireframe) {
            argp_error(state, "--line-width: there is no --wireframe");
        }
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option look_options[] = {
    {NULL, 0, NULL, 0, "Look:", 4},
    {"shade", KEY_SHADE, "lit|normals|levels|patterns|density", 0,
     "levels and patterns colour triangles, or the parts that they are split into, by their finest "
     "edge, or by base pattern, and are drawn in the instanced mode whatever --mode says; density: "
     "by the pixels that a triangle covers",
     4},
    {"wireframe", KEY_WIREFRAME, NULL, 0,
     "Draw the triangles' edges, fainter with distance; what is hidden stays so", 4},
    {"line-width", KEY_LINE_WIDTH, "PIXELS", 0, "Of the wireframe, nearest to the viewer (1)", 4},
    {"backface-color", KEY_BACKFACE_COLOR, "R,G,B", 0,
     "Draw back faces too, all in this flat colour (each from 0 to 1): cracks and flipped "
     "triangles show",
     4},
    {"exposure", KEY_EXPOSURE, "STOPS", 0, "Twice the light for every stop (0)", 4},
    {"samples", KEY_SAMPLES, "1|2|4|8", 0,
     "Of every pixel, against jagged edges, as far as the device has them (4)", 4},
    {"no-legend", KEY_NO_LEGEND, NULL, 0, "Without the legends and captions in the picture", 4},
    {"mode", KEY_MODE, "instanced|baked|welded|auto", 0,
     "How triangles reach the rasteriser; the picture is the same (auto)", 4},
    {NULL, 0, NULL, 0, NULL, 0}};

const struct argp girih_look_argp = {look_options, parse_look, NULL, NULL, NULL, NULL, NULL};

void girih_look_on_cpu(struct argp_state *state, const girih_look_options *look,
                       const girih_device_options *device) {
    if (device->cpu && girih_shade_is_by_pattern(look->shade)) {
        argp_error(
            state,
            "--shade levels and patterns are drawn in the instanced mode, which --cpu has not");
    }
    if (device->cpu && look->mode == GIRIH_MODE_OPTION_INSTANCED) {
        argp_error(state, "--mode instanced evaluates on the device, --cpu does not");
    }
}

// --- The device ---

void girih_look_wish(const girih_look_options *look, VkPhysicalDeviceFeatures *features) {
    bool is_density = look->shade == GIRIH_SHADE_DENSITY;
    features->geometryShader = look->wireframe || is_density;
    features->fillModeNonSolid = look->wireframe;
    features->wideLines = look->wireframe;
}

girih_result girih_look_check_device(const girih_look_options *look, const girih_device *device,
                                     girih_error *error) {
    const VkPhysicalDeviceFeatures *features = &device->features;
    const char *name = device->properties.deviceName;
    if (look->shade == GIRIH_SHADE_DENSITY && !features->geometryShader) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "--shade density: %s has no geometry shaders (geometryShader), which "
                          "measure the triangles; use another --shade",
                          name);
    }
    if (look->wireframe && !features->geometryShader && !features->fillModeNonSolid) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "--wireframe: %s has neither geometry shaders nor lines along triangles "
                          "(geometryShader, fillModeNonSolid)",
                          name);
    }
    bool can_instance = features->multiDrawIndirect && features->drawIndirectFirstInstance;
    bool is_by_pattern = girih_shade_is_by_pattern(look->shade);
    if ((is_by_pattern || look->mode == GIRIH_MODE_OPTION_INSTANCED) && !can_instance) {
        return girih_fail(
            error, GIRIH_ERROR_UNSUPPORTED,
            "%s: %s draws neither several indirect commands at once nor from a first instance "
            "(multiDrawIndirect, drawIndirectFirstInstance); %s",
            is_by_pattern ? "--shade levels and patterns" : "--mode instanced", name,
            is_by_pattern ? "use another --shade" : "use --mode baked");
    }
    return GIRIH_OK;
}

void girih_look_apply(const girih_look_options *look, girih_picture *picture) {
    picture->shade = look->shade;
    picture->wireframe = look->wireframe;
    picture->line_width = look->line_width;
    picture->exposure = look->exposure;
    picture->has_back_face_color = look->has_back_face_color;
    memcpy(picture->back_face_color, look->back_face_color, sizeof picture->back_face_color);
}
