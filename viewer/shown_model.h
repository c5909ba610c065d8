// A model in a window: on the device, with a plan for each picture in flight.
#ifndef GIRIH_VIEWER_SHOWN_MODEL_H
#define GIRIH_VIEWER_SHOWN_MODEL_H

#include "frame.h"
#include "refinement.h"
#include "renderer.h"
#include "window.h"

// What there is to refine, beside the frame.
typedef struct girih_shown_wish {
    girih_surface surface;
    girih_mode mode;
    uint32_t max_segments; // as girih_segments_beyond's
} girih_shown_wish;

typedef struct girih_shown_slot {
    girih_refinement refinement;
    girih_shown_wish wish;        // that the plan was made for,
    girih_refinement_room room;   // and with
    girih_frame frame;            // that the plan was last recorded for
    bool is_unchanged;            // it had been recorded for the same frame before
    bool is_submitted;            // what was recorded may not be finished
    bool is_finished;             // the plan has been executed
    uint64_t pose;                // that instances and vertices were moved to
    girih_device_buffer vertices; // of the deformed meshes, on their way to the device
} girih_shown_slot;

typedef struct girih_shown_model {
    girih_device *device;
    const girih_catalogue *catalogue;
    char *path;
    girih_surface_options surface; // of its own, since a file may be dropped on the window
    char *surface_file;            // dropped
    girih_model model;
    double low[3], high[3]; // girih_model_box
    girih_instance *instances;
    uint32_t instance_count;
    uint64_t pose; // goes up with every girih_shown_move
    girih_own_surface own;
    bool is_own_drawn, is_own_drawn_split; // own's vertex shader is there, and for what
    girih_context *context;
    girih_scene *scene;
    girih_renderer *renderer;
    girih_refinement_room room;      // that plans are made with
    girih_refinement_room too_large; // more could not be had
    bool has_splits;                 // a frame has asked for more than the catalogue holds
    girih_shown_slot slots[GIRIH_WINDOW_FRAMES];
    girih_refinement latest; // of the last finished picture; its plan may be gone
    bool is_unchanged;       // nothing had to be refined for it
    char notice[sizeof((girih_error *)NULL)->message]; // why frames are not as fine as asked
} girih_shown_model;

typedef struct girih_shown_desc {
    girih_device *device;
    const girih_catalogue *catalogue;
    const char *path;
    const girih_surface_options *surface;
    const girih_pose_options *pose;
    uint32_t samples; // girih_renderer_desc.samples
} girih_shown_desc;

// Loads and uploads. On success *shown is the caller's. Messages name the file they are about.
girih_result girih_shown_open(const girih_shown_desc *desc, girih_shown_model **shown,
                              girih_error *error);
// Takes NULL. The device must be idle.
void girih_shown_close(girih_shown_model *shown);

// Whether there is a surface of the user's to show.
bool girih_shown_has_own(const girih_shown_model *shown);

// Compiles the surface's file as it is now, or another file where one is given; on failure the
// surface stays as it was. Waits for the device where it succeeds.
girih_result girih_shown_take_surface(girih_shown_model *shown, const char *file,
                                      girih_error *error);

// Takes note of what slot's last picture came to, which must be finished.
void girih_shown_collect(girih_shown_model *shown, uint32_t slot, VkQueryPool queries);

// Moves the model for the frames to come: girih_model_move.
girih_result girih_shown_move(girih_shown_model *shown, const girih_gltf_animation *animation,
                              double seconds, girih_error *error);

// Records a frame, whose revision is left to it. slot's last picture must be collected.
girih_result girih_shown_refine(girih_shown_model *shown, uint32_t slot, VkCommandBuffer commands,
                                const girih_shown_wish *wish, const girih_frame *frame,
                                VkQueryPool queries, girih_error *error);

// What slot's refinement is drawn by.
girih_drawing girih_shown_drawing(const girih_shown_model *shown, uint32_t slot, uint32_t width);

#endif
