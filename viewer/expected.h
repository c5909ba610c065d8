// What a refined mesh's audit must find, from the unrefined one.
#ifndef GIRIH_VIEWER_EXPECTED_H
#define GIRIH_VIEWER_EXPECTED_H

#include "model.h"

// Edges of a mesh after refinement. An input edge of n segments becomes n edges that are as open,
// non-manifold or flipped as it was.
typedef struct girih_expected {
    uint64_t open, nonmanifold, flipped;
} girih_expected;

// Works out expected[model->mesh_count] with the levels stage itself. max_segments is
// girih_segments_beyond's.
girih_result girih_expect(girih_expected *expected, const girih_model *model,
                          const girih_instance *instances, uint32_t instance_count,
                          const girih_catalogue *catalogue, uint32_t max_segments,
                          const girih_frame *frame, girih_error *error);

#endif
