// Levels and pattern selection on the CPU, by girih's own twins: for methods whose paper selects
// there, and for cases that look for levels of a given output.
#ifndef GIRIH_BENCH_CPU_LEVELS_H
#define GIRIH_BENCH_CPU_LEVELS_H

#include "arrays.h"

// Adaptive patterns are numbered by their levels on the edges P1P2, P2P3, P3P1:
// (i * level_count + j) * level_count + k.
#define BENCH_HIDDEN UINT32_MAX // instead of a pattern: nothing of the triangle can be seen

static inline uint32_t bench_pattern_number(uint32_t level_count, uint32_t i, uint32_t j,
                                            uint32_t k) {
    return (i * level_count + j) * level_count + k;
}

typedef struct bench_cpu_levels {
    girih_arrays arrays;
    girih_surface surface;
    uint32_t triangle_count; // of the prepared mesh
} bench_cpu_levels;

// One instance of a mesh, where it stands.
girih_result bench_cpu_levels_create(const girih_mesh *mesh, const girih_catalogue *catalogue,
                                     girih_surface surface, bench_cpu_levels *levels,
                                     girih_error *error);
void bench_cpu_levels_destroy(bench_cpu_levels *levels); // takes {0}

// The adaptive pattern of every triangle of the prepared mesh, or BENCH_HIDDEN where the frame
// culls: one level an edge, each edge once.
girih_result bench_cpu_levels_select(bench_cpu_levels *levels, const girih_frame *frame,
                                     uint32_t *patterns, girih_error *error);

#endif
