// A search for an order of triangles with fewer cache misses than bands have.
#ifndef GIRIH_PATTERN_GEN_ORDER_SEARCH_H
#define GIRIH_PATTERN_GEN_ORDER_SEARCH_H

#include <stdint.h>

#include "pattern.h"

// Of a larger pattern, states take too long to copy.
#define GIRIH_MOST_TRIANGLES_TO_SEARCH (1u << 13)

// Finds an order of the pattern's triangles. `order` names them all in some other order, by which
// ties are broken, and becomes the one found. On failure it stays as it was.
girih_result girih_search_order(const girih_pattern *pattern, uint32_t *order, girih_error *error);

#endif
