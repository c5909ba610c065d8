// Where the vertices of a refined model lie on the input's triangles, for what girih does not
// evaluate: joints and morph targets. The library refines triangles that share no vertices, each
// with (1,0,0), (0,1,0), (0,0,1) at its corners as attributes: interpolated, they are barycentrics,
// to the bit. Normals are prepared before, and points unify by position, so that the surface is the
// same.
#ifndef GIRIH_VIEWER_PLACES_H
#define GIRIH_VIEWER_PLACES_H

#include "girih/cpu.h"
#include "model.h"

typedef struct girih_places {
    uint32_t mesh_count;
    const girih_mesh **meshes;  // [mesh_count] as prepared: the model's triangles, vertices shared
    uint32_t first_float;       // of the barycentrics in the attributes
    uint32_t *vertex_triangles; // [output_vertices] of the mesh; after girih_places_find
} girih_places;

// Whether some mesh of the file has joints or morph targets.
bool girih_places_are_needed(const girih_gltf_contents *contents);

// Replaces the model's meshes by ones that share no vertices. girih_places_free takes *places in
// any case.
girih_result girih_places_prepare(girih_places *places, girih_model *model, girih_error *error);

// Tells the vertices of a baked output of all the model's meshes, in their order, with sources.
// weld: vertices of one material become one where they are the same corner, the same place on an
// edge with the same vertices at its ends, or the same place in a triangle.
girih_result girih_places_find(girih_places *places, const girih_model *model,
                               girih_cpu_output *output, bool weld, girih_error *error);

void girih_places_free(girih_places *places); // takes {0}

// Vertices of one primitive with where they lie.
typedef struct girih_placed_vertices {
    const girih_mesh *mesh;
    uint32_t count;
    const uint32_t *triangles;      // [count] of the mesh
    const float (*barycentrics)[3]; // [count]
    const uint32_t *sources;        // vertex of the mesh: vertex of the glTF mesh
    uint32_t first_source;          // vertex of the glTF mesh that is the primitive's first
} girih_placed_vertices;

// The vertices of the primitive at the corners of the triangle that a vertex lies on.
void girih_placed_corners(const girih_placed_vertices *vertices, uint32_t vertex,
                          uint32_t corners[3]);

#endif
