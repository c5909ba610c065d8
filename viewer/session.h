// A model on a device, refined and drawn picture after picture: what a picture of `girih render`,
// or one side of it, is made with.
#ifndef GIRIH_VIEWER_SESSION_H
#define GIRIH_VIEWER_SESSION_H

#include "frame.h"
#include "look.h"
#include "refinement.h"

typedef struct girih_session_desc {
    const char *model; // file
    const girih_pose_options *pose;
    const girih_level_options *levels;
    const girih_surface_options *surface;
    const girih_look_options *look;
    const girih_device_options *device;
} girih_session_desc;

typedef struct girih_session {
    girih_session_desc desc;
    const char *file; // that a failure is about; NULL: its message says so
    girih_catalogue_source catalogue;
    girih_model model;
    girih_own_surface own; // GIRIH_SURFACE_OWN
    girih_instance *instances;
    uint32_t instance_count;
    double box[2][3]; // around them
    girih_device device;
    bool is_device_open;
    girih_context *context;
    girih_scene *scene;
    girih_mode mode;
    bool is_compiled, compiled_splits; // own, for drawing
    girih_renderer *renderer;
    bool is_sized;
    // Of the last picture; the last drawing is the refined one.
    girih_refinement refinements[2];
    girih_cpu_output outputs[2];
    girih_device_buffer buffers[2][3];
    girih_drawing drawings[2];
    girih_statistics statistics[2];
    uint32_t drawing_count;
    girih_stage_times times;
} girih_session;

typedef struct girih_shot {
    const girih_view *view; // half as wide with beside_input
    uint32_t width, height;
    bool beside_input;   // left half: the model as it is; right half: refined
    bool transparent;    // no background; the colours are then straight ones
    const char *caption; // of what is refined; NULL: none
} girih_shot;

// Loads the model and all that is read from files. girih_session_close takes *session, whatever the
// result.
girih_result girih_session_load(girih_session *session, const girih_session_desc *desc,
                                girih_error *error);

// Opens the device and brings the model there.
girih_result girih_session_open(girih_session *session, girih_error *error);

// Refines and draws a picture into rgba, 4 * width * height bytes, top row first. All pictures of a
// session are of one size. *fits tells whether legend and captions had room.
girih_result girih_session_draw(girih_session *session, const girih_shot *shot, uint8_t *rgba,
                                bool *fits, girih_error *error);

// What the last picture was refined with.
const girih_statistics *girih_session_statistics(const girih_session *session);
const char *girih_session_mode(const girih_session *session);

void girih_session_close(girih_session *session);

#endif
