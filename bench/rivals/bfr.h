// OpenSubdiv's Bfr (Base Face Representation) as a tessellator on the CPU: per-edge rates,
// positions and normals of a surface, triangles.
//
// It is another surface than girih's: Loop is the limit surface of Loop subdivision, which does not
// go through the mesh's vertices and needs each face's neighbours; Bilinear is the flat mesh
// itself, each triangle cut into three quads. Neither is Curved PN. So the comparison is one of
// throughput at the same rates, not of pictures.
//
// Bfr's own patterns serve. A face's interior gets the rate of its longest edge, as in girih's
// patterns: then Loop gives as many triangles as girih, but for a face with edges of 1 and 2
// segments, where Bfr adds a point in the middle (4 or 5 triangles for girih's 2 or 3). Left to
// itself Bfr takes the mean of the edges, several times fewer triangles where levels differ much.
// Bilinear's three quads are half as many again. So figures are for an output triangle.
//
// Each face has its own vertices, as in Bfr's examples: points on shared edges are evaluated and
// written twice, as in girih's baked mode.
#ifndef BENCH_RIVALS_BFR_H
#define BENCH_RIVALS_BFR_H

#include "girih/result.h"

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum bench_bfr_scheme { BENCH_BFR_BILINEAR = 0, BENCH_BFR_LOOP = 1 } bench_bfr_scheme;

typedef struct bench_bfr_desc {
    bench_bfr_scheme scheme;
    const float *positions; // [vertex_count][3]; must outlive the tessellator
    uint32_t vertex_count;
    const uint32_t *indices;  // [triangle_count][3]
    const uint32_t *segments; // [triangle_count][3] of the edges 12, 23, 31; at least 1
    uint32_t triangle_count;
} bench_bfr_desc;

typedef struct bench_bfr bench_bfr;

// Builds the mesh's topology, sizes the output and allocates it: nothing of this counts as
// tessellation. On success *bfr is the caller's.
girih_result bench_bfr_create(const bench_bfr_desc *desc, bench_bfr **bfr, girih_error *error);

// Takes NULL.
void bench_bfr_destroy(bench_bfr *bfr);

// Evaluates every face and writes the output, on 1 or more threads that share one factory with
// OpenSubdiv's thread-safe cache; with 1, on the calling thread. The cache is kept from call to
// call. Externally synchronised on bfr.
girih_result bench_bfr_tessellate(bench_bfr *bfr, uint32_t thread_count, girih_error *error);

// What bench_bfr_tessellate writes; valid until bfr is destroyed.
typedef struct bench_bfr_output {
    const float *positions;  // [vertex_count][3]
    const float *normals;    // [vertex_count][3] of unit length, or 0 where none can be told
    const uint32_t *indices; // [triangle_count][3]
    uint32_t vertex_count, triangle_count;
} bench_bfr_output;
bench_bfr_output bench_bfr_result(const bench_bfr *bfr);

#ifdef __cplusplus
}
#endif
#endif
