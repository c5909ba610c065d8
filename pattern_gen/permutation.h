// How a triangle's edge levels are sorted: lambda of ARKFPI (Figure 8), found by search.
#ifndef GIRIH_PATTERN_GEN_PERMUTATION_H
#define GIRIH_PATTERN_GEN_PERMUTATION_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "girih/result.h"

#define GIRIH_LAMBDA_COUNT 8u

typedef struct girih_permutation {
    // Corner n of the sorted triangle is the input's corner corners[n]: Q[n] = P[corners[n]].
    uint8_t corners[3];
    // Edge n of the sorted triangle is the input's edge edges[n]; edge n joins corners n, n + 1.
    uint8_t edges[3];
    bool odd;
    uint8_t even;   // the even lambda that serves as well where two levels are equal
    uint8_t odd_ij; // of an even lambda: the odd one that serves as well where i == j
    uint8_t odd_jk; // of an even lambda: the odd one that serves as well where j == k
} girih_permutation;

// lambda of Figure 8, before ties are looked at. Sorts the levels in place.
uint32_t girih_permutation_sort(uint32_t levels[3]);

// Finds the table by trying all corner permutations on all triples of the levels 0..8. lambda = 3
// cannot occur and stays the identity.
girih_result girih_permutation_derive(girih_permutation table[GIRIH_LAMBDA_COUNT],
                                      girih_error *error);

// Writes girih_permutation.h, a header for C and GLSL alike. Write errors stay in the stream.
void girih_permutation_emit(const girih_permutation table[GIRIH_LAMBDA_COUNT], FILE *stream);

#endif
