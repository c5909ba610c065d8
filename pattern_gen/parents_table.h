// The parents of all patterns of a catalogue.
#ifndef GIRIH_PATTERN_GEN_PARENTS_TABLE_H
#define GIRIH_PATTERN_GEN_PARENTS_TABLE_H

#include <stdint.h>

#include "pattern.h"

// The rank of the pattern that one fades into (girih_coarser_levels); its own where there is no
// coarser one.
uint32_t girih_coarser_rank(const girih_base_pattern *pattern);

// Finds the parents of every pattern's vertices, on as many threads as the machine runs at once,
// and writes them where the vertices lie in the catalogue's vertex table. Of the catalogue all but
// the parents must be there.
girih_result girih_parents_fill(const girih_catalogue *catalogue, uint32_t *parents,
                                girih_error *error);

#endif
