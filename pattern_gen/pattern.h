// One base pattern while it is made.
#ifndef GIRIH_PATTERN_GEN_PATTERN_H
#define GIRIH_PATTERN_GEN_PATTERN_H

#include <stdint.h>

#include "girih/catalogue.h"

// Called after each pattern, by one thread at a time; may be NULL.
typedef void girih_progress(uint32_t done, uint32_t all);

// Vertices are packed u | v << 16 and lie in the order of girih_base_pattern; three indices a triangle, which winds
// as P1, P2, P3.
typedef struct girih_pattern {
    uint32_t segments[3]; // of the edges P1P2, P2P3, P3P1, the first the largest
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t *vertices;
    uint32_t *indices;
} girih_pattern;

// Room for so many vertices and triangles, the border's vertices in their places. To be freed also where it fails.
girih_result girih_pattern_allocate(girih_pattern *pattern, const uint32_t segments[3], uint32_t vertex_count,
                                    uint32_t triangle_count, girih_error *error);

// A copy of a catalogue's pattern. To be freed also where it fails.
girih_result girih_pattern_read(const girih_catalogue *catalogue, uint32_t rank, girih_pattern *pattern,
                                girih_error *error);

void girih_pattern_free(girih_pattern *pattern);

// Where vertex m of an edge of n segments lies: round(32768 m / n) for the nearer half, the other half mirrored, so
// that an edge reads the same from both ends (FORMULAS 2.2: t_m).
uint32_t girih_edge_parameter(uint32_t m, uint32_t n);

// The pattern's vertex m, of 0 to segments[edge], on an edge.
uint32_t girih_border_vertex(const uint32_t segments[3], uint32_t edge, uint32_t m);

// The number of vertices on the border, which come before all others.
uint32_t girih_border_count(const uint32_t segments[3]);

uint32_t girih_pack_vertex(uint32_t u, uint32_t v);

// A vertex by the weights of the two corners after `corner`, which gets the rest: with the corner on the axis of
// symmetry, the two sides of a pattern round alike.
uint32_t girih_pack_beside(uint32_t corner, uint32_t next, uint32_t last);

// Which of `few` segments' vertices is nearest to vertex m of `many`, at least as many. A tie goes to the nearer end, so
// that both halves snap alike; the vertex in the middle of all goes to the first half.
uint32_t girih_snap(uint32_t m, uint32_t many, uint32_t few);

// Where the pattern of levels i >= j >= k, counted from 0, stands in a catalogue.
uint32_t girih_pattern_rank(const uint32_t levels[3]);

// The corner on the axis of symmetry of a pattern with two equal segment counts; -1 with three different ones.
int girih_symmetry_corner(const uint32_t segments[3]);

#endif
