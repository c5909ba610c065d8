// Pictures of refined models, off screen.
#ifndef GIRIH_VIEWER_RENDERER_H
#define GIRIH_VIEWER_RENDERER_H

#include "camera.h"
#include "device.h"
#include "own_surface.h"

typedef enum girih_shade {
    GIRIH_SHADE_LIT,
    GIRIH_SHADE_NORMALS,
    GIRIH_SHADE_LEVELS,   // a colour for the largest edge level of a base pattern
    GIRIH_SHADE_PATTERNS, // a colour for every base pattern; parts of split triangles have their
                          // own
} girih_shade;

typedef struct girih_renderer_desc {
    girih_device *device;
    const girih_context *context;
    const girih_catalogue *catalogue;
    const girih_model *model;     // GIRIH_MODEL_DRAW; must outlive the renderer
    const girih_own_surface *own; // NULL: no drawing has a surface of the user's
    const girih_view *view;
    uint32_t width, height;
    uint32_t drawing_width; // of each of the drawings side by side
    girih_shade shade;
    bool wireframe;
    bool has_back_face_color;
    float back_face_color[3];
} girih_renderer_desc;

// Where the triangles of one drawing come from: a plan, or vertex and index buffers with a range of
// triangles for every material.
typedef struct girih_drawing {
    const girih_plan *plan;
    girih_mode mode;
    girih_surface surface;
    bool has_splits;                         // of the plan: see girih_refinement
    VkBuffer positions, attributes, indices; // without a plan
    const uint32_t *material_first;          // [material_count + 1]
    uint32_t x, width;                       // the columns of the picture that it fills
} girih_drawing;

typedef struct girih_renderer girih_renderer;

// On success *renderer is the caller's. desc is copied.
girih_result girih_renderer_create(const girih_renderer_desc *desc, girih_renderer **renderer,
                                   girih_error *error);
void girih_renderer_destroy(girih_renderer *renderer); // takes NULL

// Draws one picture of all drawings side by side and reads it into rgba, 4 * width * height bytes,
// top row first. *milliseconds is the device's time for it, negative where it has no clock.
girih_result girih_renderer_draw(girih_renderer *renderer, const girih_drawing *drawings,
                                 uint32_t drawing_count, uint8_t *rgba, double *milliseconds,
                                 girih_error *error);

#endif
