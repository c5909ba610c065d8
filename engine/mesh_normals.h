// The normals of a mesh: the input's, or made here.
#ifndef GIRIH_ENGINE_MESH_NORMALS_H
#define GIRIH_ENGINE_MESH_NORMALS_H

#include "mesh_build.h"

// Normalises the input's normals for the kept vertices (vertex_source). Needs finite normals. False
// if there is no memory.
bool girih_take_normals(girih_mesh_build *build);

// Makes normals as the description says. Needs the edges. Vertices whose triangles want other
// normals are split: their copies are appended in the order of the corners that ask for them, and
// triangle_vertices follows. False if there is no memory.
bool girih_make_normals(girih_mesh_build *build);

#endif
