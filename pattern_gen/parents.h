// Parent positions: where each vertex of a pattern goes as the pattern fades into the next coarser
// one.
#ifndef GIRIH_PATTERN_GEN_PARENTS_H
#define GIRIH_PATTERN_GEN_PARENTS_H

#include <stdint.h>

#include "pattern.h"

// The levels of the pattern that one of levels i >= j >= k, counted from 0, fades into: each one
// less, or 0.
void girih_coarser_levels(const uint32_t levels[3], uint32_t coarser[3]);

// Where vertex m of an edge of n segments goes, as a parameter of the edge (girih_edge_parameter):
// to the nearest vertex of the `coarser` segments; of two that are as near to the one closer to an
// end of the edge; the middle of an edge that lies between two stays.
uint32_t girih_border_parent(uint32_t m, uint32_t n, uint32_t coarser);

// Finds the parents of a pattern's vertices, packed as these are: vertices of `coarse`, of which
// the triangles do not matter. The same patterns give the same parents everywhere.
girih_result girih_parents_find(const girih_pattern *fine, const girih_pattern *coarse,
                                uint32_t *parents, girih_error *error);

#endif
