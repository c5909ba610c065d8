// Vertices under morph targets and skins: first the targets, then the skin (glTF 2.0, sections
// 3.7.2.2 and 3.7.3.3).
//
// Vertices at one position with the same deltas and the same influences come out at one position,
// to the bit, in whatever order their influences are: no seam opens.
#ifndef GIRIH_VIEWER_DEFORM_H
#define GIRIH_VIEWER_DEFORM_H

#include "pose.h"

// What is worked out once for a mesh: each vertex's influences, in one order, with weights whose
// sum is 1. May be used by any number of threads.
typedef struct girih_deformer {
    const girih_gltf_mesh *mesh; // outlives it
    uint32_t vertex_count;
    uint32_t *primitives;       // [vertex_count] which primitive a vertex is of
    uint32_t *vertices;         // [vertex_count] which vertex of that primitive
    uint32_t *first_influences; // [vertex_count + 1]
    uint32_t *joints;
    float *weights;
} girih_deformer;

// Of vertices that are sources[0..] of the mesh's, those of its primitives being counted one after
// another. False: out of memory; girih_deformer_free takes it in any case.
bool girih_deformer_create(girih_deformer *deformer, const girih_gltf_mesh *mesh,
                           const uint32_t *sources, uint32_t vertex_count);

void girih_deformer_free(girih_deformer *deformer); // takes {0}

// Deforms vertices, 3 floats each, as a node of the pose does that has the deformer's mesh, into
// the space of that node's placement in the pose. Where there is a skin normals become unit
// vectors, or 0 where none can be told. Coordinates may be infinite, or no numbers, where the
// file's are large. False: out of memory.
bool girih_deform(const girih_deformer *deformer, const girih_pose *pose, uint32_t node,
                  const float *from_positions, const float *from_normals, float *positions,
                  float *normals);

#endif
