// Text and legends over a picture, drawn by cairo. overlay_painter.h puts them there.
#ifndef GIRIH_VIEWER_OVERLAY_H
#define GIRIH_VIEWER_OVERLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "girih/catalogue.h"

// A part of the picture, pixels from its upper left corner.
typedef struct girih_rectangle {
    uint32_t x, y, width, height;
} girih_rectangle;

typedef enum girih_corner {
    GIRIH_CORNER_TOP_LEFT,
    GIRIH_CORNER_TOP_RIGHT,
    GIRIH_CORNER_BOTTOM_LEFT,
    GIRIH_CORNER_BOTTOM_RIGHT,
} girih_corner;

typedef struct girih_overlay_line {
    const char *text;                  // UTF-8
    bool has_swatch;                   // a field of colour before the text
    float color[3];                    // sRGB
    const girih_base_pattern *pattern; // NULL, or what the field shows: the pattern in its colour
} girih_overlay_line;

// One panel: lines below each other on a translucent ground, in a corner of an area. Those from the
// first field of colour on are in several columns where one would be too high.
typedef struct girih_overlay_text {
    const girih_overlay_line *lines;
    uint32_t line_count;
    girih_corner corner;
    girih_rectangle area;
    bool is_scale; // the swatches make one bar: colours between those of its lines are in between
    const girih_catalogue *catalogue; // of the lines' patterns
} girih_overlay_text;

typedef struct girih_panel {
    girih_rectangle place;
    uint32_t *pixels; // top row first, 0xAARRGGBB, sRGB, premultiplied by alpha
} girih_panel;

enum { GIRIH_OVERLAY_PANELS = 6 };

// {0} is an empty one.
typedef struct girih_overlay {
    girih_panel panels[GIRIH_OVERLAY_PANELS];
    uint32_t panel_count;
} girih_overlay;

// Adds a panel. Its letters grow with the picture's height; what is too large for its area is made
// smaller, and what could not be read then is left out: *fits, which may be NULL, says so.
girih_result girih_overlay_add(girih_overlay *overlay, const girih_overlay_text *text, bool *fits,
                               girih_error *error);

// Lines with a pattern that one column of a panel holds in an area, below two or three others.
uint32_t girih_overlay_patterns(const girih_rectangle *area);

// Frees all panels, and the overlay is empty.
void girih_overlay_clear(girih_overlay *overlay);

#endif
