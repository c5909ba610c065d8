// The view of a picture, and of the pixel rule.
#ifndef GIRIH_VIEWER_CAMERA_H
#define GIRIH_VIEWER_CAMERA_H

#include "model.h"
#include "options.h"

// Reversed depth: 1 at the near plane, 0 at the far one, which spreads a float's precision evenly.
typedef struct girih_view {
    float view_projection[4][4];    // columns
    float eye[3];                   // world; orthographic: the direction towards the viewer
    float right[3], up[3], back[3]; // unit vectors of the camera; back points towards the viewer
    bool orthographic;
    float near_distance;
    float pixels_per_unit;
    float planes[6][4]; // inside where n·p + d >= 0; those that are not used are 0
    // The cylindrical projection: up is the axis, back is horizontal, near_distance is from the
    // axis, and pixels_per_unit are also those of a radian across.
    bool cylindrical;
    double view_angle; // radians, horizontal
    float slopes[2];   // lowest and highest
    float depth[2];    // GirihPanorama.depth
} girih_view;

// The view of a model's instances in a picture, or a part of one, of width x height pixels. Without
// options it looks from the front, a little from the right and above, as near as shows all of it;
// from the other side where the model turns its back to the front.
girih_result girih_view_create(girih_view *view, const girih_camera_options *options,
                               const girih_model *model, const girih_instance *instances,
                               uint32_t instance_count, uint32_t width, uint32_t height,
                               girih_error *error);

// A camera that is no panorama, to be moved about: what girih_view_create makes its view of.
typedef struct girih_camera {
    double eye[3], right[3], up[3], back[3]; // unit vectors; back points towards the viewer
    bool orthographic;
    double half_height; // of the picture at distance 1; orthographic: anywhere
    double near, far;
} girih_camera;

girih_result girih_camera_create(girih_camera *camera, const girih_camera_options *options,
                                 const girih_model *model, const girih_instance *instances,
                                 uint32_t instance_count, uint32_t width, uint32_t height,
                                 girih_error *error);

// The cameras of a turntable: `count` options that stand around the upward axis through the focal
// point, equally far apart, anticlockwise seen from above, the first where `options` stand. Without
// a position they are as near as shows all of the model in every picture. Not for panoramas, nor
// for cameras of the file.
girih_result girih_camera_turntable(const girih_camera_options *options, const girih_model *model,
                                    const girih_instance *instances, uint32_t instance_count,
                                    uint32_t width, uint32_t height, uint32_t count,
                                    girih_camera_options *turned, girih_error *error);

// Turns right and up to where the camera's back points to, up being as near to view_up as can be.
void girih_camera_level(girih_camera *camera, const double view_up[3]);

// Refuses a camera whose numbers no picture comes of.
girih_result girih_view_from_camera(girih_view *view, const girih_camera *camera, uint32_t width,
                                    uint32_t height, girih_error *error);

// The box around a model's instances, how far its surface strays from them included; a cube around
// the origin where there are none.
void girih_model_box(const girih_model *model, const girih_instance *instances,
                     uint32_t instance_count, double low[3], double high[3]);

#endif
