// The nearest of many vertices or triangles, through a grid of cells.
#ifndef GIRIH_BENCH_NEAREST_H
#define GIRIH_BENCH_NEAREST_H

#include "target.h"

typedef enum bench_nearest_kind { BENCH_NEAREST_VERTEX, BENCH_NEAREST_TRIANGLE } bench_nearest_kind;

typedef struct bench_nearest bench_nearest;
// The triangles, of which there must be one at least, must outlive it and stay as they are.
girih_result bench_nearest_create(const bench_triangles *triangles, bench_nearest_kind kind,
                                  bench_nearest **nearest, girih_error *error);
void bench_nearest_destroy(bench_nearest *nearest); // takes NULL

typedef struct bench_nearest_point {
    double squared_distance;
    size_t item;       // corner, or triangle
    double weights[3]; // of the triangle's corners at its nearest point
} bench_nearest_point;
bench_nearest_point bench_nearest_find(const bench_nearest *nearest, const float point[3]);

#endif
