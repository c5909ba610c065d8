#include "compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "nearest.h"

static int compare_corners(const float *a, const float *b) {
    return memcmp(a, b, 12);
}

static int compare_triangles(const void *a, const void *b) {
    const float *p = a;
    const float *q = b;
    for (int n = 0; n < 3; ++n) {
        const int order = compare_corners(p + 6 * n, q + 6 * n);
        if (order != 0) {
            return order;
        }
    }
    return 0;
}

// Rotates each triangle so that its first corner is the first by bits, and sorts them: winding is
// kept, the order of drawing is not.
static void sort_triangles(bench_triangles *triangles) {
    for (uint32_t n = 0; n < triangles->count; ++n) {
        float(*t)[6] = triangles->corners + 3 * (size_t)n;
        int first = compare_corners(t[1], t[0]) < 0 ? 1 : 0;
        first = compare_corners(t[2], t[first]) < 0 ? 2 : first;
        float turned[3][6];
        for (int k = 0; k < 3; ++k) {
            memcpy(turned[k], t[(first + k) % 3], sizeof turned[k]);
        }
        memcpy(t, turned, sizeof turned);
    }
    qsort(triangles->corners, triangles->count, sizeof(float[3][6]), compare_triangles);
}

static bool have_equal_positions(const bench_triangles *a, const bench_triangles *b) {
    if (a->count != b->count) {
        return false;
    }
    for (size_t n = 0; n < 3 * (size_t)a->count; ++n) {
        if (compare_corners(a->corners[n], b->corners[n]) != 0) {
            return false;
        }
    }
    return true;
}

static double area_of(const bench_triangles *triangles) {
    double sum = 0.0;
    for (uint32_t n = 0; n < triangles->count; ++n) {
        const float(*t)[6] = (const float(*)[6])triangles->corners + 3 * (size_t)n;
        double a[3], b[3];
        for (int k = 0; k < 3; ++k) {
            a[k] = (double)t[1][k] - (double)t[0][k];
            b[k] = (double)t[2][k] - (double)t[0][k];
        }
        const double x = a[1] * b[2] - a[2] * b[1];
        const double y = a[2] * b[0] - a[0] * b[2];
        const double z = a[0] * b[1] - a[1] * b[0];
        sum += 0.5 * sqrt(x * x + y * y + z * z);
    }
    return sum;
}

// The greatest distance of a vertex to the nearest vertex of others.
static girih_result largest_distance(const bench_triangles *triangles,
                                     const bench_triangles *others, double *distance,
                                     girih_error *error) {
    bench_nearest *nearest = NULL;
    const girih_result result = bench_nearest_create(others, BENCH_NEAREST_VERTEX, &nearest, error);
    double largest = 0.0;
    if (result == GIRIH_OK) {
        for (size_t n = 0; n < 3 * (size_t)triangles->count; ++n) {
            largest =
                fmax(largest, bench_nearest_find(nearest, triangles->corners[n]).squared_distance);
        }
    }
    *distance = sqrt(largest);
    bench_nearest_destroy(nearest);
    return result;
}

girih_result bench_compare(bench_triangles *reference, bench_triangles *triangles,
                           bench_agreement *agreement, girih_error *error) {
    *agreement = (bench_agreement){.equal = false};
    sort_triangles(reference);
    sort_triangles(triangles);
    agreement->equal = have_equal_positions(reference, triangles);
    const double area = area_of(reference);
    agreement->area_ratio = area > 0.0 ? area_of(triangles) / area : 0.0;
    if (agreement->equal || reference->count == 0 || triangles->count == 0) {
        return GIRIH_OK;
    }
    double there = 0.0, back = 0.0;
    girih_result result = largest_distance(triangles, reference, &there, error);
    if (result == GIRIH_OK) {
        result = largest_distance(reference, triangles, &back, error);
    }
    agreement->largest_distance = fmax(there, back);
    return result;
}

// --- Open edges ---------------------------------------------------------------------------------

static bool has_area(const float (*t)[6]) {
    return compare_corners(t[0], t[1]) != 0 && compare_corners(t[1], t[2]) != 0 &&
           compare_corners(t[2], t[0]) != 0;
}

uint32_t bench_triangles_with_area(const bench_triangles *triangles) {
    uint32_t count = 0;
    for (uint32_t n = 0; n < triangles->count; ++n) {
        count += has_area((const float(*)[6])triangles->corners + 3 * (size_t)n);
    }
    return count;
}

typedef struct edge {
    float ends[2][3]; // the lesser first
} edge;

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, sizeof(edge));
}

girih_result bench_open_edges(const bench_triangles *triangles, uint64_t *open,
                              girih_error *error) {
    edge *edges = malloc((3 * (size_t)triangles->count + 1) * sizeof *edges);
    *open = 0;
    if (!edges) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    size_t count = 0;
    for (uint32_t n = 0; n < triangles->count; ++n) {
        const float(*t)[6] = (const float(*)[6])triangles->corners + 3 * (size_t)n;
        if (!has_area(t)) {
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            const float *p = t[k];
            const float *q = t[(k + 1) % 3];
            const bool turned = compare_corners(q, p) < 0;
            memcpy(edges[count].ends[0], turned ? q : p, 12);
            memcpy(edges[count].ends[1], turned ? p : q, 12);
            ++count;
        }
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t n = 0; n < count;) {
        size_t end = n + 1;
        while (end < count && compare_edges(&edges[n], &edges[end]) == 0) {
            ++end;
        }
        *open += end - n == 1;
        n = end;
    }
    free(edges);
    return GIRIH_OK;
}
