// The laws of parents, and figures about them.
#ifndef GIRIH_PATTERN_GEN_PARENT_LAWS_H
#define GIRIH_PATTERN_GEN_PARENT_LAWS_H

#include <stdint.h>

#include "pattern.h"

// Checks the parents of one pattern's vertices, the pattern and the coarser one being lawful:
// - a corner's is itself, and vertex m of an edge of n segments has the nearest vertex of the
// coarser edge, of two that
//   are as near that closer to an end; the middle of an edge that lies between two has itself;
// - every other vertex has a vertex of the coarser pattern, or itself;
// - the parents turn no triangle over: doubled areas are not negative, and they add up to the
// whole, exactly.
girih_result girih_parent_laws_check(const girih_pattern *fine, const girih_pattern *coarse,
                                     const uint32_t *parents, girih_error *error);

// Checks those of all patterns of a lawful catalogue.
girih_result girih_parent_laws_check_catalogue(const girih_catalogue *catalogue,
                                               girih_error *error);

// Sums over patterns.
typedef struct girih_parent_figures {
    uint64_t staying_middles; // of edges, their own parents where the coarser pattern has no vertex
    uint64_t staying_inside;  // likewise, on axes of symmetry
    uint32_t staying_patterns;   // that have such inside
    uint64_t childless;          // vertices of coarser patterns that are no parents
    uint32_t childless_patterns; // that have such
    uint32_t uneven_patterns; // images of a vertex have other parents than the images of its parent
    int64_t farthest;         // girih_squared_distance of a vertex and its parent
    uint32_t farthest_rank;
} girih_parent_figures;

// Adds a pattern's figures.
girih_result girih_parents_measure(const girih_pattern *fine, const girih_pattern *coarse,
                                   const uint32_t *parents, uint32_t rank,
                                   girih_parent_figures *figures, girih_error *error);

girih_result girih_parents_measure_catalogue(const girih_catalogue *catalogue,
                                             girih_parent_figures *figures, girih_error *error);

#endif
