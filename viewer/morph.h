// Morph targets of a refined mesh.
#ifndef GIRIH_VIEWER_MORPH_H
#define GIRIH_VIEWER_MORPH_H

#include "gltf.h"
#include "places.h"

// A morph target of one primitive; each array is the caller's to free, or NULL where it is not
// written.
typedef struct girih_morph_arrays {
    float *positions, *normals; // [count][3]
    float **attributes;         // [attribute_count of the source's target][count][components]
} girih_morph_arrays;

// A mesh as a morph target has it at weight 1.
typedef struct girih_morphed_mesh {
    const girih_mesh *base;     // dynamic: every edge that may come apart is a seam
    float *positions, *normals; // [vertex_count][3]
    bool *is_moved;             // [vertex_count] its position or normal is another
} girih_morphed_mesh;

// Morphs a prepared mesh. sources: vertex of the mesh: vertex of the glTF mesh, its primitives' one
// behind another. False: out of memory. girih_morphed_mesh_free takes *morphed in any case.
bool girih_morphed_mesh_make(girih_morphed_mesh *morphed, const girih_mesh *mesh,
                             const girih_gltf_mesh *source, const uint32_t *sources,
                             uint32_t target);

void girih_morphed_mesh_free(girih_morphed_mesh *morphed); // takes {0}

// What a primitive's target adds to vertices that lie on it: the surface (flat or PN) of the
// morphed mesh less the surface of the mesh, for positions and, where has_normals, unit normals;
// the rest is interpolated. Corners have what the source has. The same bits from both sides of an
// edge. False: out of memory.
bool girih_morph_vertices(const girih_morphed_mesh *morphed, const girih_gltf_primitive *source,
                          uint32_t target, girih_surface surface, bool has_normals,
                          const girih_placed_vertices *vertices, girih_morph_arrays *arrays);

#endif
