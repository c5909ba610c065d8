// The options that several subcommands share, as argp parsers that take one structure each.
#ifndef GIRIH_VIEWER_OPTIONS_H
#define GIRIH_VIEWER_OPTIONS_H

#include <argp.h>
#include <stdbool.h>
#include <stdint.h>

#include "girih/plan.h"

// How fine.
typedef struct girih_level_options {
    bool is_filled;    // options are read over what is there already, not over the defaults
    const char *given; // the option that was given, NULL: none, and the fields hold the default
    girih_level_rule rule;
    uint32_t segments, seed;
    float length;
    uint32_t max_segments; // that an edge may ask for, where the catalogue holds fewer
} girih_level_options;

typedef struct girih_surface_options {
    bool is_filled;        // see girih_level_options
    girih_surface surface; // OWN where any of the user's is in it: a file, a height map, or both
    girih_surface base;    // what an own one stands on
    const char *file;      // GLSL that defines it, NULL: none
    const char *height_map;
    float height, height_zero; // mesh units at 1 in the map; what in the map moves nothing
    bool has_base, has_height, has_height_zero;
    float crease_degrees;
    const char *catalogue; // "dyadic", "linear" or a file
} girih_surface_options;

typedef struct girih_camera_options {
    bool has_position, has_direction, has_focal_point, has_view_up, has_view_angle, has_index;
    float position[3], direction[3], focal_point[3], view_up[3];
    bool cylindrical; // cylindrical projection
    float view_angle; // degrees: vertical; cylindrical: horizontal
    uint32_t index;
    uint32_t width, height;
} girih_camera_options;

// Which moment of which animation.
typedef struct girih_pose_options {
    bool has_time;
    float time;            // seconds
    const char *animation; // number or name, NULL: the first
} girih_pose_options;

typedef struct girih_device_options {
    const char *name; // part of the device's name; NULL: the best there is
    bool cpu;
    bool validation;
} girih_device_options;

// How girih hands its triangles over; AUTO is the program's to resolve.
typedef enum girih_mode_option {
    GIRIH_MODE_OPTION_AUTO,
    GIRIH_MODE_OPTION_INSTANCED,
    GIRIH_MODE_OPTION_BAKED,
    GIRIH_MODE_OPTION_WELDED,
} girih_mode_option;

// Children for a subcommand's argp. Each sets its structure's defaults at ARGP_KEY_INIT, levels and
// surface only where the structure is not filled yet.
extern const struct argp girih_level_argp;
extern const struct argp girih_surface_argp;
extern const struct argp girih_camera_argp;
extern const struct argp girih_pose_argp;
extern const struct argp girih_device_argp;

// All four of them, in this order, for a subcommand that takes them all.
extern const struct argp_child girih_option_children[];

// Keys of options without a letter: the shared ones lie from here on, a subcommand's own start at
// GIRIH_KEY_OWN.
enum { GIRIH_KEY_SHARED = 256, GIRIH_KEY_OWN = 512 };

// Readers of option values. A value that cannot be read ends the program as wrong use, with a line
// that names the option.
uint32_t girih_option_count(struct argp_state *state, const char *option, const char *text,
                            uint32_t least, uint32_t greatest);
float girih_option_number(struct argp_state *state, const char *option, const char *text);
void girih_option_vector(struct argp_state *state, const char *option, const char *text,
                         float vector[3]);
girih_mode_option girih_option_mode(struct argp_state *state, const char *text);
const char *girih_mode_name(girih_mode mode);

// Refuses a surface in GLSL together with --cpu, which cannot run it; to be called at ARGP_KEY_END.
void girih_option_surface_on_cpu(struct argp_state *state, const girih_surface_options *surface,
                                 const girih_device_options *device);

// Refuses an -o FILE that is standard output together with --json, and where that is a terminal; to
// be called at ARGP_KEY_END.
void girih_option_output(struct argp_state *state, const char *output, bool json);

// Takes MODEL at ARGP_KEY_ARG: one and no more.
void girih_option_model(struct argp_state *state, const char **model, const char *text);

// Takes one of several MODELs; *models is the caller's to free, its names are argv's.
void girih_option_models(struct argp_state *state, const char ***models, uint32_t *model_count,
                         const char *text);

// Runs a subcommand's parser over its own arguments, argv[0] being "girih NAME".
void girih_options_parse(const struct argp *argp, int argc, char **argv, void *input);

#endif
