// Do two methods draw the same surface?
#ifndef GIRIH_BENCH_COMPARE_H
#define GIRIH_BENCH_COMPARE_H

#include <stdbool.h>

#include "target.h"

typedef struct bench_agreement {
    bool equal;              // the same triangles, whatever their order: positions equal by bits
    double largest_distance; // of a vertex of either to the nearest vertex of the other
    double area_ratio;       // all triangles' area, against the reference's
} bench_agreement;

// Compares triangles with a reference's. Sorts both.
girih_result bench_compare(bench_triangles *reference, bench_triangles *triangles,
                           bench_agreement *agreement, girih_error *error);

// How many triangles have their corners at three different points: patterns that snap vertices put
// out others.
uint32_t bench_triangles_with_area(const bench_triangles *triangles);

// Edges that only one triangle has, by the exact bits of their end positions; triangles with two
// corners at one point take no part.
girih_result bench_open_edges(const bench_triangles *triangles, uint64_t *open, girih_error *error);

#endif
