// The order of a pattern's triangles and interior vertices, for the caches of a GPU.
#ifndef GIRIH_PATTERN_GEN_ORDER_H
#define GIRIH_PATTERN_GEN_ORDER_H

#include <stddef.h>
#include <stdint.h>

#include "pattern.h"

// The vertex cache that patterns are ordered for: first in, first out.
#define GIRIH_CACHE_SIZE 16u

// How often a first-in, first-out cache of that many vertices, empty at first, misses. UINT64_MAX
// where memory runs out.
uint64_t girih_cache_misses(const uint32_t *indices, size_t index_count, uint32_t vertex_count,
                            uint32_t cache_size);

// Puts the triangles into an order with few misses, whatever order they are in, and numbers the
// vertices inside by their first use. The border's vertices keep their places, and every triangle
// its corners in their order. Takes linear time, and quadratic time for a pattern of up to
// GIRIH_MOST_TRIANGLES_TO_SEARCH triangles that misses often all the same (order_search.h).
girih_result girih_pattern_order(girih_pattern *pattern, girih_error *error);

#endif
