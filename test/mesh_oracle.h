// Mesh preparation by brute force: the rules of girih/mesh.h, word for word, in quadratic time.
#ifndef GIRIH_TEST_MESH_ORACLE_H
#define GIRIH_TEST_MESH_ORACLE_H

#include "girih/mesh.h"

// Asserts (cmocka) that everything in the mesh but the values of made normals is what the
// description asks for. For small meshes.
void assert_mesh_follows(const girih_mesh *mesh, const girih_mesh_desc *desc);

// Asserts that smooth normals made here are, to 1e-6, the angle-weighted means of the faces around
// each corner, bit-identical within a group, and that no vertex was split without need.
void assert_smooth_normals(const girih_mesh *mesh, const girih_mesh_desc *desc);

// Asserts that two meshes are equal byte for byte.
void assert_meshes_equal(const girih_mesh *a, const girih_mesh *b);

#endif
