// What ARK and ARP share: the full set of adaptive patterns, and one draw a triangle.
#ifndef GIRIH_BENCH_ADAPTIVE_H
#define GIRIH_BENCH_ADAPTIVE_H

#include "method.h"

typedef struct bench_pattern_draw {
    uint32_t first_index, index_count;
    int32_t first_vertex;
} bench_pattern_draw;

// The adaptive patterns of a catalogue: level_count^3 of them, one for each way in which levels can
// stand on three edges (ARKFPI, section 4.1, calls this the standard). girih's base patterns serve
// for all, their barycentrics written out permuted, so that the triangles are the same.
typedef struct bench_adaptive_patterns {
    bench_pattern_draw *draws; // by bench_pattern_number
    uint32_t pattern_count;
    uint64_t vertex_count, index_count; // of all
    uint64_t bytes;                     // 4 a vertex and an index, as girih's own
    uint64_t base_bytes;                // of the base patterns alone, stored likewise
} bench_adaptive_patterns;
girih_result bench_adaptive_layout(const girih_catalogue *catalogue,
                                   bench_adaptive_patterns *patterns, girih_error *error);
void bench_adaptive_patterns_free(bench_adaptive_patterns *patterns);

// Uniforms of a draw: push constants, positions then normals.
typedef struct bench_triangle_uniforms {
    float positions[3][3];
    float normals[3][3];
} bench_triangle_uniforms;

typedef struct bench_adaptive {
    const bench_job *job;
    bench_adaptive_patterns patterns;
    girih_device_buffer vertices, indices;
    bench_triangle_uniforms *triangles;
    uint32_t triangle_count;
    bench_layout layout;
    VkPipeline pipelines[BENCH_RASTERS];
} bench_adaptive;

// Of a mesh that stays where it is, so its triangles' uniforms are laid out once: [count][3] each.
girih_result bench_adaptive_create(const bench_job *job, const float *positions,
                                   const float *normals, const uint32_t *indices,
                                   uint32_t triangle_count, bench_adaptive *adaptive,
                                   girih_error *error);
void bench_adaptive_destroy(bench_adaptive *adaptive); // takes {0}

// One draw for each triangle that is not BENCH_HIDDEN, with the pattern that `selected` names.
void bench_adaptive_draw(const bench_adaptive *adaptive, VkCommandBuffer commands,
                         bench_raster raster, const uint32_t *selected);

#endif
