// Mesh preparation: topology that is worked out once, on the CPU, and never changes afterwards.
// Stability: stable
#ifndef GIRIH_MESH_H
#define GIRIH_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "girih/result.h"

#ifdef __cplusplus
extern "C" {
#endif

// A range of triangles that share a material. Edges are shared across all submeshes of a mesh.
typedef struct girih_submesh {
    uint32_t first_index; // into the indices, a multiple of 3
    uint32_t index_count; // a multiple of 3
    uint32_t material;    // below GIRIH_MAX_MATERIALS; the first part of the group key
    uint32_t two_sided;   // not 0: back faces are never culled
} girih_submesh;

#define GIRIH_MAX_MATERIALS 65536u

// The largest magnitude of a coordinate or a transform's element; beyond it products could
// overflow, and an infinity times 0 would tear edges apart.
#define GIRIH_MAX_COORDINATE 1e15f

// How normals are made where a mesh comes without.
typedef enum girih_missing_normals {
    GIRIH_NORMALS_SMOOTH = 0, // angle-weighted over welded positions, split at creases
    GIRIH_NORMALS_FLAT = 1,   // each triangle's own
} girih_missing_normals;

// The input of girih_mesh_create. Everything is read during the call only. {0} fields mean "none".
typedef struct girih_mesh_desc {
    const char *name; // for messages; may be NULL
    uint32_t vertex_count;
    const float *positions; // 3 floats a vertex
    size_t position_stride; // bytes; 0: 12
    const float *normals; // 3 floats a vertex, normalised here (unit vectors rounded to floats are
                          // kept to the bit); NULL: made as missing_normals says
    size_t normal_stride; // bytes; 0: 12
    const float *attributes; // attribute_floats a vertex, tightly packed; NULL where there are none
    uint32_t attribute_floats;
    const uint32_t *indices; // 3 a triangle
    uint32_t index_count;
    const girih_submesh *submeshes; // NULL: one submesh of all indices, material 0
    uint32_t submesh_count;
    girih_missing_normals missing_normals;
    float crease_degrees; // smooth normals: edges with a larger angle between the face normals are
                          // hard
    int dynamic; // not 0: positions and normals will be moved on the GPU (girih_scene_vertices), so
                 // every edge whose sides have other vertices is a seam, whatever their normals are
} girih_mesh_desc;

// A prepared mesh: read-only, may be shared by any number of threads.
//
// Rules:
// - Positions are one point where their bits are equal after -0 is stored as +0. Coordinates that
//   are not finite or whose magnitude is beyond 1e15 are refused (GIRIH_ERROR_INVALID_DATA, with
//   the vertex named), also in vertices that no triangle uses.
// - A triangle with two corners at one point has no area and no pattern; it is dropped and counted
//   in dropped_triangles. Its neighbours then share the edge it lay between. Triangles of zero area
//   with three distinct corners are kept: they close the mesh.
// - Vertices that no kept triangle uses are dropped. The kept ones stay in input order; those that
//   a crease splits follow, all named by vertex_source.
// - Triangles keep their input order within and across submeshes (submeshes in the order given).
// - Edge 1 of a triangle is P1P2, edge 2 is P2P3, edge 3 is P3P1 (ARKFPI, Tables 1 and 2).
// - Edges are unique by their two points across the mesh. An edge's two ends stand in canonical
//   order: by position, compared as x, then y, then z.
// - Where the triangles at an edge carry other normals at its ends (by bits), or where three or
//   more triangles meet, the edge is a seam: its curve is the mean of the two sides' (PN-AEN;
//   McDonald, Kilgard 2010). For an edge of two triangles the sides are those two, in triangle
//   order; for three or more triangles both sides are the lowest-numbered triangle's. On a dynamic
//   mesh edges whose sides have other vertices are seams too (where the normals are equal, the mean
//   of both sides' is the same to the bit). Seams come
//   first: edge e is a seam if and only if e < seam_count. Otherwise edges are numbered in the
//   order of first use.
// - A weld edge is an edge by its two vertex indices within one submesh: two triangles share the
//   output vertices inside an edge if and only if they share the weld edge.
// - Made normals: a crease_degrees that is not positive, or 180 or more, means no creases.
//   Triangles without area, up to the rounding of their coordinates, have no say in normals and no
//   creases; a corner whose normal cannot be told gets 0.
typedef struct girih_mesh {
    const char *name; // owned copy, never NULL
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t seam_count;
    uint32_t weld_edge_count;
    uint32_t submesh_count;
    uint32_t attribute_floats;

    const float *positions;  // [vertex_count][3], no -0
    const float *normals;    // [vertex_count][3], unit length, or 0 where none can be told; no -0
    const float *attributes; // [vertex_count][attribute_floats]
    const uint32_t *vertex_source;       // [vertex_count] input vertex
    const uint32_t *vertex_point;        // [vertex_count] lowest vertex at the same point
    const uint32_t *triangle_vertices;   // [triangle_count][3]
    const uint32_t *triangle_edges;      // [triangle_count][3]
    const uint32_t *triangle_weld_edges; // [triangle_count][3], bit 31: the triangle runs along it
                                         // against the canonical order of its edge
    const uint32_t *triangle_source;     // [triangle_count] input triangle: its first index / 3
    const uint32_t *edge_points;         // [edge_count][2] vertices (each its own vertex_point) in
                                         // canonical order
    const uint32_t *seams; // [seam_count][4] vertices whose normals the sides have: side A at the
                           // first end, at the second; side B at the first, at the second
    const uint32_t *weld_edge_edge; // [weld_edge_count] its edge
    const uint32_t *edge_weld_edge; // [edge_count] its lowest weld edge, which stands for all
    const uint8_t *edge_uses;       // [edge_count] triangles at the edge, 255 for more
    // Who evaluates an own surface at a shared place, so that both sides get the same bits: the
    // lowest triangle there, as 3 * triangle + 0..2. A point's owner is that of its vertex_point.
    const uint32_t *edge_owner;      // [edge_count] its edge there
    const uint32_t *weld_edge_owner; // [weld_edge_count] its edge there
    const uint32_t *vertex_owner;    // [vertex_count] its corner there, by the vertex's index
    const girih_submesh *submeshes;  // [submesh_count] ranges of triangle_vertices after dropping

    float bounds_min[3], bounds_max[3]; // of the positions; 0 for an empty mesh

    // Audit of the input, by points, after dropping.
    uint32_t dropped_triangles; // two or three corners at one point
    uint32_t open_edges;        // one triangle
    uint32_t nonmanifold_edges; // three or more triangles
    uint32_t flipped_edges;     // two triangles that run along it the same way
    int made_normals;           // the normals were made here
    int dynamic;                // as prepared
} girih_mesh;

// Prepares a mesh. On success *mesh is the caller's, to be destroyed with girih_mesh_destroy. A
// mesh without triangles is valid. Time is linear in the triangles. Thread-safe.
GIRIH_API girih_result girih_mesh_create(const girih_mesh_desc *desc, const girih_mesh **mesh,
                                         girih_error *error);

// Takes NULL.
GIRIH_API void girih_mesh_destroy(const girih_mesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
