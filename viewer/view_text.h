// What a window says over its picture: statistics, a message, the keys.
#ifndef GIRIH_VIEWER_VIEW_TEXT_H
#define GIRIH_VIEWER_VIEW_TEXT_H

#include "overlay.h"
#include "report.h"
#include "view_input.h"

typedef struct girih_view_status {
    const char *file;
    girih_mode mode; // that is drawn in
    const girih_statistics *statistics;
    const girih_stage_times *times;
    bool is_unchanged; // nothing had to be refined for the last picture
    double frames_per_second, animation_time;
    const char *animation; // NULL: there is none
    const girih_catalogue *catalogue;
    const girih_plan *plan; // the legend is of what it used; NULL: it has not been executed yet
    const char *message;    // "": none
    bool is_failure;        // what the message tells of
} girih_view_status;

// Fills an overlay for a picture of width x height pixels.
girih_result girih_view_text(girih_overlay *overlay, const girih_view_controls *controls,
                             const girih_view_status *status, uint32_t width, uint32_t height,
                             girih_error *error);

#endif
