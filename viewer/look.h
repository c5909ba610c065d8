// How pictures look: the options of it, as an argp parser for the subcommands that draw.
#ifndef GIRIH_VIEWER_LOOK_H
#define GIRIH_VIEWER_LOOK_H

#include "renderer.h"

typedef struct girih_look_options {
    bool is_filled; // see girih_level_options
    girih_mode_option mode;
    girih_shade shade;
    bool wireframe, has_line_width;
    float line_width; // pixels
    bool has_back_face_color;
    float back_face_color[3];
    float exposure;   // stops
    uint32_t samples; // of a pixel; 0: the device's to choose
    bool no_legend;   // neither legends nor captions
} girih_look_options;

// A child for a subcommand's argp; sets the defaults at ARGP_KEY_INIT.
extern const struct argp girih_look_argp;

const char *girih_shade_name(girih_shade shade);

// Whether a colour stands for the base pattern of a triangle, which the instanced mode alone knows.
bool girih_shade_is_by_pattern(girih_shade shade);

// Refuses what --cpu cannot draw; to be called at ARGP_KEY_END.
void girih_look_on_cpu(struct argp_state *state, const girih_look_options *look,
                       const girih_device_options *device);

// What the device must have for the look beside girih's needs: wished for, and, once the device is
// open, looked for.
void girih_look_wish(const girih_look_options *look, VkPhysicalDeviceFeatures *features);
girih_result girih_look_check_device(const girih_look_options *look, const girih_device *device,
                                     girih_error *error);

// The look's fields of a picture.
void girih_look_apply(const girih_look_options *look, girih_picture *picture);

#endif
