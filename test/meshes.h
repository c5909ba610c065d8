// Meshes for tests, prepared by girih_mesh_create. Every one has 2 attribute floats a vertex, so
// that any of them can stand in one scene. They are destroyed with girih_mesh_destroy. A failure
// fails the test.
#ifndef GIRIH_TEST_MESHES_H
#define GIRIH_TEST_MESHES_H

#include "girih/mesh.h"

// The next number of a xorshift64* generator, so that runs repeat everywhere; state must not be 0.
uint32_t draw_number(uint64_t *state);
// Uniform in [low, high).
float draw_float(uint64_t *state, float low, float high);

// Unit sphere of 20 * 4^halvings triangles: closed, smooth, no seam, one submesh.
const girih_mesh *make_icosphere(uint32_t halvings);

// Torus around the z axis of 2 * around * across triangles: closed, smooth, no seam. The triangles
// of the inner half are a second submesh with material 1.
const girih_mesh *make_torus(uint32_t around, uint32_t across);

// Cube with corners at -1/2 and 1/2 of 12 triangles: closed. Hard: 24 vertices with face normals,
// every edge of the cube is a seam. Otherwise 8 vertices with normals along the diagonals.
const girih_mesh *make_cube(int hard);

// Unit sphere of columns (>= 3) by rows (>= 2) with a UV seam: closed by position. The vertices of
// the first column are stored twice with other attributes and normals, the poles once for each
// column; some zero coordinates are negative. The lower rows are a second, two-sided submesh with
// material 2.
const girih_mesh *make_seam_sphere(uint32_t columns, uint32_t rows);

// Closed drum around the z axis, from z = -1 to 1, of 2 * columns * (rows + 1) triangles: the side
// has a UV seam, its vertices stored twice with equal normals, and meets the lids, a second submesh
// with material 1, at hard edges.
const girih_mesh *make_drum(uint32_t columns, uint32_t rows);

// Triangles between random points with random normals: open, non-manifold and flipped edges, and
// three submeshes; no two triangles have the same three points. With `points` 0 every triangle has
// three points of its own.
const girih_mesh *make_soup(uint32_t triangles, uint32_t points, uint64_t seed);

// One triangle (0,0,0), (1,0,0), (0,1,0).
const girih_mesh *make_triangle(void);

// Closed: a triangle with sides of 9/10 and a tip so far away.
const girih_mesh *make_needle(float length);

// The triangles of another mesh, at `positions` (its vertices'; NULL: where they are). Apart: every
// triangle has vertices of its own, with the same normals and attributes.
const girih_mesh *make_copy(const girih_mesh *mesh, const float *positions, int apart, int dynamic);

// Separate random triangles, dealt out evenly to as many submeshes as there are materials.
const girih_mesh *make_materials(uint32_t triangles, uint32_t materials);

// No triangle at all.
const girih_mesh *make_nothing(void);

#endif
