// Points, edges, seams and weld edges. All return false if, and only if, there is no memory.
#ifndef GIRIH_ENGINE_MESH_TOPOLOGY_H
#define GIRIH_ENGINE_MESH_TOPOLOGY_H

#include "mesh_build.h"

// point[v]: the lowest vertex whose position has the bits of vertex v's.
bool girih_weld_points(const float *positions, uint32_t vertex_count, uint32_t *point);

// From corner_points: triangle_edges in the order of first use, edge_uses, edge_half_edges and the
// audit of the edges.
bool girih_find_edges(girih_mesh_build *build);

// With all normals in place: puts the seams first, then makes edge_points, edge_owner and seams.
bool girih_find_seams(girih_mesh_build *build);

// After the seams: triangle_weld_edges, weld_edge_edge, weld_edge_owner, edge_weld_edge.
bool girih_find_weld_edges(girih_mesh_build *build);

// With all vertices in place: vertex_owner.
bool girih_find_vertex_owners(girih_mesh_build *build);

#endif
