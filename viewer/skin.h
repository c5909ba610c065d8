// Joints and weights of a refined primitive.
#ifndef GIRIH_VIEWER_SKIN_H
#define GIRIH_VIEWER_SKIN_H

#include "gltf.h"
#include "places.h"

// Writes joints and weights [count][influence_count] of vertices that lie on the source: its
// weights interpolated, joint by joint, the largest ones kept and made to add up to 1, in falling
// order. A vertex has the same bits from both sides of an edge if both sides have the same joints
// and weights at its ends. False: out of memory.
bool girih_skin_vertices(const girih_gltf_primitive *source, const girih_placed_vertices *vertices,
                         uint32_t *joints, float *weights);

#endif
