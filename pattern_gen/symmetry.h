// Which permutations of the corners leave a pattern's vertices where they are, and where each of
// them goes.
#ifndef GIRIH_PATTERN_GEN_SYMMETRY_H
#define GIRIH_PATTERN_GEN_SYMMETRY_H

#include <stdbool.h>
#include <stdint.h>

#include "pattern.h"

#define GIRIH_MOST_SYMMETRIES 6u

// Rounding keeps images apart: the centroid of a grid is (10923,10923,10922). A weight may differ
// by so much.
#define GIRIH_SYMMETRY_ROUNDING 2u

#define GIRIH_NO_VERTEX UINT32_MAX

// The first is always the one that changes nothing.
typedef struct girih_symmetry {
    uint32_t count;
    uint8_t corners[GIRIH_MOST_SYMMETRIES]
                   [3]; // symmetry n puts the weight of corner k at corners[n][k]
    uint32_t *images[GIRIH_MOST_SYMMETRIES]; // by vertex: the vertex at its image
} girih_symmetry;

// The symmetries of a pattern's vertices, all of them or, where rounding leaves some out, as many
// as go together. To be freed also where it fails.
girih_result girih_symmetry_find(const girih_pattern *pattern, girih_symmetry *symmetry,
                                 girih_error *error);

// The images of another pattern's vertices under the same symmetries, GIRIH_NO_VERTEX where none
// is. To be freed also where it fails.
girih_result girih_symmetry_apply(const girih_symmetry *symmetry, const girih_pattern *pattern,
                                  girih_symmetry *applied, girih_error *error);

void girih_symmetry_free(girih_symmetry *symmetry);

// A packed vertex with its weights at other corners.
uint32_t girih_symmetry_move(const uint8_t corners[3], uint32_t vertex);

// Whether two packed vertices are the same but for rounding.
bool girih_symmetry_is_near(uint32_t a, uint32_t b);

#endif
