// Geodesic spheres: an icosahedron whose triangles are split into four again and again.
#include "icosphere.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

static uint32_t sphere_vertex(bench_icosphere *s, const float p[3]) {
    const double length = sqrt((double)p[0] * (double)p[0] + (double)p[1] * (double)p[1] +
                               (double)p[2] * (double)p[2]);
    for (int n = 0; n < 3; ++n) {
        s->positions[3 * s->vertex_count + (uint32_t)n] = (float)((double)p[n] / length);
    }
    return s->vertex_count++;
}

// Splits every triangle into four. Midpoints are found again through a chained table by the smaller
// vertex.
static girih_result halve(bench_icosphere *s, girih_error *error) {
    const uint32_t triangles = s->index_count / 3;
    const uint32_t before = s->vertex_count;
    bench_icosphere fine = {.vertex_count = before, .index_count = 4 * s->index_count};
    fine.positions = malloc(((size_t)before + triangles * 3 / 2) * 12);
    fine.indices = malloc((size_t)fine.index_count * 4);
    uint32_t *heads = malloc((size_t)before * 4);
    uint32_t(*links)[2] = malloc((size_t)triangles * 3 / 2 * sizeof *links); // larger vertex, next
    if (!fine.positions || !fine.indices || !heads || !links) {
        free(fine.positions);
        free(fine.indices);
        free(heads);
        free(links);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    memcpy(fine.positions, s->positions, (size_t)before * 12);
    memset(heads, 0xff, (size_t)before * 4);
    for (uint32_t t = 0; t < triangles; ++t) {
        const uint32_t *corner = s->indices + 3 * t;
        uint32_t middle[3];
        for (uint32_t e = 0; e < 3; ++e) {
            const uint32_t a = corner[e];
            const uint32_t b = corner[(e + 1) % 3];
            const uint32_t low = a < b ? a : b;
            const uint32_t high = a < b ? b : a;
            uint32_t link = heads[low];
            while (link != UINT32_MAX && links[link][0] != high) {
                link = links[link][1];
            }
            if (link == UINT32_MAX) {
                const float *p = s->positions + 3 * low;
                const float *q = s->positions + 3 * high;
                const float sum[3] = {p[0] + q[0], p[1] + q[1], p[2] + q[2]};
                link = sphere_vertex(&fine, sum) - before;
                links[link][0] = high;
                links[link][1] = heads[low];
                heads[low] = link;
            }
            middle[e] = before + link;
        }
        const uint32_t four[12] = {corner[0], middle[0], middle[2], middle[0],
                                   corner[1], middle[1], middle[2], middle[1],
                                   corner[2], middle[0], middle[1], middle[2]};
        memcpy(fine.indices + 12 * (size_t)t, four, sizeof four);
    }
    free(heads);
    free(links);
    free(s->positions);
    free(s->indices);
    *s = fine;
    return GIRIH_OK;
}

girih_result bench_icosphere_make(uint32_t halvings, bench_icosphere *sphere, girih_error *error) {
    static const float x = 0.525731112f, z = 0.850650808f;
    static const float corners[12][3] = {{-x, 0, z}, {x, 0, z},  {-x, 0, -z}, {x, 0, -z},
                                         {0, z, x},  {0, z, -x}, {0, -z, x},  {0, -z, -x},
                                         {z, x, 0},  {-z, x, 0}, {z, -x, 0},  {-z, -x, 0}};
    static const uint32_t faces[60] = {1,  4,  0, 4,  9, 0, 4, 5,  9, 8, 5, 4,  1,  8, 4,
                                       1,  10, 8, 10, 3, 8, 8, 3,  5, 3, 2, 5,  3,  7, 2,
                                       3,  10, 7, 10, 6, 7, 6, 11, 7, 6, 0, 11, 6,  1, 0,
                                       10, 1,  6, 11, 0, 9, 2, 11, 9, 5, 2, 9,  11, 2, 7};
    bench_icosphere s = {
        .positions = malloc(sizeof corners), .indices = malloc(sizeof faces), .index_count = 60};
    girih_result result = GIRIH_OK;
    if (!s.positions || !s.indices) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        memcpy(s.indices, faces, sizeof faces);
        for (uint32_t n = 0; n < 12; ++n) {
            sphere_vertex(&s, corners[n]);
        }
    }
    for (uint32_t n = 0; n < halvings && result == GIRIH_OK; ++n) {
        result = halve(&s, error);
    }
    if (result != GIRIH_OK) {
        bench_icosphere_free(&s);
    }
    *sphere = s;
    return result;
}

void bench_icosphere_free(bench_icosphere *sphere) {
    free(sphere->positions);
    free(sphere->indices);
    *sphere = (bench_icosphere){0};
}
