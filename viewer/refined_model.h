// A refined output as the primitives of the model it was made from.
#ifndef GIRIH_VIEWER_REFINED_MODEL_H
#define GIRIH_VIEWER_REFINED_MODEL_H

#include "girih/cpu.h"
#include "model.h"
#include "places.h"

typedef struct girih_primitive_arrays girih_primitive_arrays;

typedef struct girih_refined_model {
    const girih_model *model;
    girih_primitive_arrays *arrays;              // of all primitives, mesh by mesh
    girih_gltf_refined_primitive *refined;       // the same, as girih_gltf_write wants them
    const girih_gltf_refined_primitive **meshes; // [mesh_count] a mesh's first in `refined`
} girih_refined_model;

// Makes a model of an output of its meshes. places: of the output's vertices where the model has
// joints or morph targets, else NULL; surface: what the meshes stand on, flat or PN; has_normals:
// primitives without normals get the surface's. girih_refined_model_free takes *refined in any
// case.
girih_result girih_refined_model_make(girih_refined_model *refined, const girih_model *model,
                                      const girih_places *places, girih_surface surface,
                                      bool has_normals, const girih_cpu_output *output,
                                      girih_error *error);

// Writes it as a .glb. input: the source's name, for warnings of what is left out.
girih_result girih_refined_model_write(const girih_refined_model *refined, const char *input,
                                       const char *path, girih_error *error);

void girih_refined_model_free(girih_refined_model *refined); // takes {0}

#endif
