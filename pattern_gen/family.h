// Families of patterns: ways to fill a triangle whose three edges are split into given segments.
#ifndef GIRIH_PATTERN_GEN_FAMILY_H
#define GIRIH_PATTERN_GEN_FAMILY_H

#include <stdint.h>

#include "girih/result.h"

typedef struct girih_family {
    const char *name; // at most 15 bytes, as the catalogue's header stores it
    // The numbers of vertices and triangles of a pattern. segments: of the edges P1P2, P2P3, P3P1,
    // the first the largest.
    void (*count)(const uint32_t segments[3], uint32_t *vertex_count, uint32_t *triangle_count);
    // Writes a pattern's vertices, packed u | v << 16, in the order of girih_base_pattern, and its
    // triangles, which wind as P1, P2, P3, in no particular order.
    girih_result (*build)(const uint32_t segments[3], uint32_t *vertices, uint32_t *indices,
                          girih_error *error);
} girih_family;

// The grid of the largest segment count inside, one ring of triangles stitched to the borders.
extern const girih_family girih_family_uniform;

// The family of that name, NULL where there is none.
const girih_family *girih_family_find(const char *name);

// Builds a pattern and puts its triangles into an order that suits a GPU's vertex cache. The
// buffers hold what family->count says.
girih_result girih_pattern_build(const girih_family *family, const uint32_t segments[3],
                                 uint32_t *vertices, uint32_t *indices, girih_error *error);

#endif
