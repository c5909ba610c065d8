// Pictures of refined models: one after another, of any size, view and look.
#ifndef GIRIH_VIEWER_RENDERER_H
#define GIRIH_VIEWER_RENDERER_H

#include "camera.h"
#include "device.h"
#include "overlay.h"
#include "own_surface.h"

typedef enum girih_shade {
    GIRIH_SHADE_LIT,
    GIRIH_SHADE_NORMALS,
    GIRIH_SHADE_LEVELS,   // a colour for the largest edge level of a base pattern
    GIRIH_SHADE_PATTERNS, // a colour for every base pattern; parts of split triangles have their
                          // own
    GIRIH_SHADE_DENSITY,  // a colour for the pixels that a triangle covers; needs geometryShader
} girih_shade;

// What stays the same from picture to picture.
typedef struct girih_renderer_desc {
    girih_device *device;
    const girih_context *context; // NULL: all drawings are without a plan
    const girih_catalogue *catalogue;
    const girih_model *model;             // GIRIH_MODEL_DRAW; must outlive the renderer
    VkDescriptorSetLayout surface_layout; // girih_own_surface.layout
    uint32_t frame_count;                 // pictures that may be in flight at once
    uint32_t samples;                     // of a pixel; 0: 4, or 1 where the device has no more
} girih_renderer_desc;

// Where the triangles of one drawing come from: a plan, or vertex and index buffers with a range of
// triangles for every material.
typedef struct girih_drawing {
    const girih_plan *plan;
    girih_mode mode;
    girih_surface surface;
    const girih_own_surface *own;            // GIRIH_SURFACE_OWN, instanced
    bool has_splits;                         // of the plan: see girih_refinement
    VkBuffer positions, attributes, indices; // without a plan
    const uint32_t *material_first;          // [material_count + 1]
    uint32_t x, width;                       // the columns of the picture that it fills
} girih_drawing;

// One picture: drawings side by side, equally wide.
typedef struct girih_picture {
    const girih_view *view; // of each drawing
    double box[2][3]; // around the model (girih_model_box): lines fade from its front to its back
    girih_shade shade;
    bool wireframe;   // with geometryShader, else fillModeNonSolid (and wideLines)
    float line_width; // pixels, nearest to the viewer
    float exposure;   // stops: light is multiplied by 2 to the power of it
    bool transparent; // no background; the picture's colours are premultiplied by its alpha
    bool has_back_face_color;
    float back_face_color[3];
    const girih_drawing *drawings;
    uint32_t drawing_count;
} girih_picture;

typedef struct girih_renderer girih_renderer;

// On success *renderer is the caller's. desc is copied. Has no size yet.
girih_result girih_renderer_create(const girih_renderer_desc *desc, girih_renderer **renderer,
                                   girih_error *error);
void girih_renderer_destroy(girih_renderer *renderer); // takes NULL

// The size of the pictures to come, at least 1 x 1. No submitted picture may be unfinished. After a
// failure there is no size.
girih_result girih_renderer_resize(girih_renderer *renderer, uint32_t width, uint32_t height,
                                   girih_error *error);

// Copies an overlay, NULL being an empty one, to lie over the pictures of a frame in flight from now
// on, the one of that number being finished.
girih_result girih_renderer_set_overlay(girih_renderer *renderer, uint32_t frame,
                                        const girih_overlay *overlay, girih_error *error);

// Records a picture outside a render pass, behind what its drawings' plans were refined by. frame,
// below frame_count, tells which picture in flight this is: the one before of that number must be
// finished. The picture is then in girih_renderer_image, for copies, until the next one is drawn.
// After a failure the commands must not be submitted.
girih_result girih_renderer_record(girih_renderer *renderer, VkCommandBuffer commands,
                                   uint32_t frame, const girih_picture *picture,
                                   girih_error *error);

// The finished picture: R8G8B8A8_SRGB, one sample, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, visible to
// transfer reads of later commands.
VkImage girih_renderer_image(const girih_renderer *renderer);

// Draws one picture, waits for it and reads it into rgba, 4 * width * height bytes, top row first.
// *milliseconds is the device's time for it, negative where it has no clock. No submitted picture
// may be unfinished.
girih_result girih_renderer_draw(girih_renderer *renderer, const girih_picture *picture,
                                 uint8_t *rgba, double *milliseconds, girih_error *error);

#endif
