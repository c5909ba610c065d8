// From a glTF file to prepared meshes: one girih_mesh per glTF mesh that has triangles.
#ifndef GIRIH_VIEWER_MODEL_H
#define GIRIH_VIEWER_MODEL_H

#include "deform.h"
#include "gltf.h"
#include "girih/plan.h"
#include "options.h"
#include "pose.h"

// What the meshes are prepared for.
typedef enum girih_model_purpose {
    GIRIH_MODEL_DRAW,   // materials by glTF material; texture coordinates and colours as attributes
    GIRIH_MODEL_REFINE, // a material for every primitive; every attribute kept
    GIRIH_MODEL_TOPOLOGY, // as REFINE, without attributes
} girih_model_purpose;

// One attribute of the layout that all meshes share.
typedef struct girih_model_attribute {
    const char *name;    // as in the file; belongs to it
    uint32_t components; // the most that any primitive has
    uint32_t first;      // float it begins at in a vertex's attributes
} girih_model_attribute;

// A mesh that is deformed again and again: prepared once, as it is in the file; what it is at the
// moment has the same topology, and positions, normals and bounds of its own.
typedef struct girih_moving_mesh {
    const girih_mesh *prepared; // NULL: not deformed, and there is nothing else
    girih_deformer deformer;
    girih_mesh now;
    float *vertices; // now's positions and normals
    bool is_flat;    // normals that the file lacks are the triangles' own
} girih_moving_mesh;

#define GIRIH_MODEL_NONE UINT32_MAX

typedef struct girih_model {
    girih_gltf_model *file;
    const girih_gltf_contents *contents; // DRAW: the pose's, which has meshes of its own
    girih_pose *pose;                    // DRAW
    girih_model_purpose purpose;

    uint32_t mesh_count;
    const girih_mesh **meshes; // [mesh_count]
    bool is_dynamic;           // DRAW: some are deformed, and all prepared so that they can be
    girih_moving_mesh *moving; // [mesh_count], where it is dynamic
    uint32_t *mesh_source;     // [mesh_count] the glTF mesh
    uint32_t *mesh_number;     // [contents->mesh_count] index into meshes, or GIRIH_MODEL_NONE

    uint32_t attribute_floats;
    uint32_t attribute_count; // REFINE
    girih_model_attribute *attributes;
    uint32_t texcoord_float, color_float; // DRAW: where they begin, or GIRIH_MODEL_NONE
    uint32_t height_float;    // DRAW, displaced: where TEXCOORD_0 begins, or GIRIH_MODEL_NONE
    uint32_t texcoord_floats; // 2; 4 where a normal map has coordinates of its own, behind them

    uint32_t material_count;
    int32_t *materials;       // [material_count] DRAW: the glTF material, -1: the default
    uint32_t *first_material; // [contents->mesh_count] REFINE: material of a mesh's first primitive
    uint32_t **vertex_sources; // [mesh_count][vertex_count of the mesh] vertex of the glTF mesh,
                               // its primitives' one behind another

    float reach; // how far its surface may stray from the points, in the world: for cameras
} girih_model;

// Loads a file and prepares its meshes, for DRAW in a pose; NULL, or options that name none: the
// one that the file's nodes have by themselves. Warnings go to standard error. A file without
// triangles is refused, except for TOPOLOGY, and so is a pose of an animation that it does not
// have. On failure *model is empty, on success girih_model_free takes it.
girih_result girih_model_load(girih_model *model, const char *path, girih_model_purpose purpose,
                              const girih_surface_options *surface, const girih_pose_options *pose,
                              girih_error *error);

// Moves a model that was loaded for DRAW to a moment of an animation of its contents, NULL: to
// where its nodes are by themselves. Meshes, placements and cameras are changed in place;
// girih_model_instances tells where the meshes are then. Fails where it moves a mesh too far.
girih_result girih_model_move(girih_model *model, const girih_gltf_animation *animation,
                              double seconds, girih_error *error);

// Whether a move changes the vertices of a mesh.
bool girih_model_is_deformed(const girih_model *model, uint32_t mesh);

// A mesh's vertices as girih_scene_vertices has them: 6 floats each.
void girih_model_vertices(const girih_model *model, uint32_t mesh, float *vertices);

// A primitive's attribute of this name, or NULL.
const girih_gltf_attribute *girih_model_find_attribute(const girih_gltf_primitive *primitive,
                                                       const char *name);

// Where a height map's texture coordinates, TEXCOORD_0, begin in a vertex's attributes;
// GIRIH_MODEL_NONE where no primitive has any.
uint32_t girih_model_height_float(const girih_model *model);

// Frees the prepared meshes alone, for when they are on the device and memory is wanted.
void girih_model_free_meshes(girih_model *model);

void girih_model_free(girih_model *model);

// For girih_model_load, which poses nodes before meshes are prepared, and moves each mesh when it
// is.
girih_result girih_model_pose(girih_model *model, const girih_pose_options *options,
                              girih_error *error);
girih_result girih_model_begin_moving(girih_model *model, uint32_t mesh,
                                      const girih_surface_options *surface, girih_error *error);

// The instances of the file's placements; of every mesh once, untransformed, where placed is false.
// Meshes whose triangles all have two corners at one point have none; where no other mesh is there,
// *instance_count is 0. A model without any triangle is refused.
// On success *instances is the caller's to free.
girih_result girih_model_instances(const girih_model *model, bool placed,
                                   girih_instance **instances, uint32_t *instance_count,
                                   girih_error *error);

#endif
