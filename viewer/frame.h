// What the options ask of the library: the catalogue, and the frame to refine.
#ifndef GIRIH_VIEWER_FRAME_H
#define GIRIH_VIEWER_FRAME_H

#include "camera.h"

// A built-in catalogue, or one from a file.
typedef struct girih_catalogue_source {
    const girih_catalogue *catalogue;
    void *bytes; // of the file
} girih_catalogue_source;

// Opens the catalogue of --catalogue. girih_catalogue_source_free takes what it gives.
girih_result girih_catalogue_source_open(girih_catalogue_source *source, const char *name,
                                         girih_error *error);
void girih_catalogue_source_free(girih_catalogue_source *source);

// What --max-segments allows an edge beyond the catalogue's largest level; 0: nothing.
uint32_t girih_segments_beyond(const girih_catalogue *catalogue, const girih_level_options *levels);

// The frame that the level options ask for in a view. view may be NULL where the rule is none of
// pixels. Nothing is culled.
girih_frame girih_frame_from_options(const girih_level_options *levels, const girih_view *view);

// The frame for a model's meshes untransformed, as refine and check take it, with a view only where
// the rule is one of pixels.
girih_result girih_frame_create(girih_frame *frame, const girih_level_options *levels,
                                const girih_camera_options *camera, const girih_model *model,
                                const girih_instance *instances, uint32_t instance_count,
                                girih_error *error);

#endif
