// Two jobs that differ in their catalogue or its levels, each of girih's modes by itself: what the
// cases `families` and `spacings` share.
#ifndef GIRIH_BENCH_CATALOGUES_H
#define GIRIH_BENCH_CATALOGUES_H

#include "bench.h"

// A sphere of 20 * 4^halvings triangles; or, with slices, a closed ellipsoid of
// 2 * slices * (stacks - 1) triangles of many shapes, thinner and thinner towards the poles.
typedef struct bench_shape {
    uint32_t halvings;
    uint32_t slices, stacks;
} bench_shape;
girih_result bench_shape_make(const bench_shape *shape, bench_mesh *mesh, girih_error *error);

// How long a segment is of these frames: 8192 pixels or thousandths of a unit, divided by the
// fineness, `*(const uint32_t *)user`.
// Segments of one length, a little longer from frame to frame.
void bench_length_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view);
// Segments of one length on the screen, seen from a distance that grows from frame to frame.
void bench_view_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view);

typedef struct bench_catalogue_pair {
    bench_case_job jobs[2]; // the first is what the second is compared with
    const char *names[2];   // of the catalogues, in the report
} bench_catalogue_pair;

// Measures the pair's jobs, instanced, baked and welded, and adds the case with both jobs' mean
// counts beside the ratios: an object for each of the names. *item is the case, the run's.
girih_result bench_measure_catalogues(const bench_run *run, bench_catalogue_pair *pair,
                                      json_t **item, girih_error *error);

#endif
