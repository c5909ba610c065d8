// Geodesic spheres, the input of several cases.
#ifndef GIRIH_BENCH_ICOSPHERE_H
#define GIRIH_BENCH_ICOSPHERE_H

#include "girih/girih.h"

typedef struct bench_icosphere {
    float *positions; // of a unit sphere, so they are the normals too
    uint32_t vertex_count;
    uint32_t *indices;
    uint32_t index_count;
} bench_icosphere;

// 20 * 4^halvings triangles; the caller's, to be freed with bench_icosphere_free.
girih_result bench_icosphere_make(uint32_t halvings, bench_icosphere *sphere, girih_error *error);
void bench_icosphere_free(bench_icosphere *sphere);

#endif
