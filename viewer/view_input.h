// What the user of a window has it do: keys, the mouse, files that are dropped.
#ifndef GIRIH_VIEWER_VIEW_INPUT_H
#define GIRIH_VIEWER_VIEW_INPUT_H

#include "look.h"
#include "orbit.h"
#include "window.h"

// A key or a movement of the mouse, and what it does.
typedef struct girih_view_key {
    const char *key, *what;
} girih_view_key;

extern const girih_view_key girih_view_keys[];
extern const uint32_t girih_view_key_count;

typedef struct girih_view_controls {
    // What there is to choose from:
    bool has_own;      // a surface of the user's
    bool can_instance; // the device draws in the instanced mode
    bool can_draw_lines;
    bool can_draw_sizes; // GIRIH_SHADE_DENSITY
    uint32_t animation_count;

    // What was chosen:
    girih_surface surface;
    girih_level_options levels;
    girih_mode mode;
    girih_look_options look;
    bool shows_statistics, shows_help;
    bool is_frozen; // levels and culling stay as they were seen from
    bool is_playing;
    uint32_t animation;
    girih_orbit orbit;

    // What is to be done once:
    bool wants_picture, wants_camera_reset;
    char *dropped; // a file; the caller's to free

    bool has_news;      // the text over the picture says something else now
    double edge_length; // that --edge-length begins with where a key chose it
    bool is_dragging, is_panning;
    double cursor[2];
} girih_view_controls;

// Has the window's events change *controls, which must outlive the window.
void girih_view_listen(girih_view_controls *controls, GLFWwindow *window);

#endif
