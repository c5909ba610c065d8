// A glTF scene at a moment of an animation: where its nodes are, what its cameras see, and the
// weights of its morph targets (glTF 2.0, sections 3.7.2.2, 3.7.3.3 and 3.11, appendix C).
#ifndef GIRIH_VIEWER_POSE_H
#define GIRIH_VIEWER_POSE_H

#include "gltf.h"

// The contents of a pose are the file's but for meshes, placements and cameras. Each placement of a
// mesh that its node deforms, by a skin or by morph targets, has a mesh of its own there, behind
// the file's, with vertices as in the file (deform.h moves them); a mesh of the file that is
// nowhere placed as it is has no primitives left. A skinned mesh is deformed into the world, so its
// placement is the identity, or a reflection where its node's transform is one: that, and nothing
// else of it, tells which side is outside.
typedef struct girih_pose {
    const girih_gltf_contents *file; // outlives the pose
    girih_gltf_contents contents;
    uint32_t *mesh_nodes; // [contents.mesh_count] which node deforms it, or GIRIH_GLTF_NO_NODE

    girih_gltf_transform *locals; // [node_count]
    double (*worlds)[12];         // [node_count] rows of the 3x4 node-to-world matrix
    double *weights;              // of morph targets, of one node after another
    size_t *first_weights;        // [node_count] where a node's begin

    // What contents points to.
    girih_gltf_mesh *meshes;
    girih_gltf_placement *placements;
    girih_gltf_camera *cameras;
} girih_pose;

// The pose that the file's nodes have by themselves. False: out of memory. girih_pose_free takes it
// in any case.
bool girih_pose_create(girih_pose *pose, const girih_gltf_contents *file);

// Moves nodes, placements, cameras and weights to a moment of an animation; what it does not
// animate has the pose of the file. Before the first key that one holds, behind the last key the
// last. NULL: no animation.
void girih_pose_set(girih_pose *pose, const girih_gltf_animation *animation, double seconds);

void girih_pose_free(girih_pose *pose); // takes {0}

// The animation of this number or, where it is none, of this name; NULL: there is none.
const girih_gltf_animation *girih_pose_find_animation(const girih_gltf_contents *file,
                                                      const char *number_or_name);

#endif
