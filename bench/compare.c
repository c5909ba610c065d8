#include "compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

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

// --- Nearest vertices: a grid of cells, about one vertex each -----------------------------------

typedef struct grid {
    const bench_triangles *triangles;
    float low[3];
    float cell;
    uint32_t size[3];
    uint32_t *first; // of each cell, and the end
    uint32_t *order; // corners by cell
} grid;

static uint32_t axis_cell(const grid *g, const float *p, int axis) {
    const float at = (p[axis] - g->low[axis]) / g->cell;
    return at <= 0.0f ? 0u : at >= (float)(g->size[axis] - 1) ? g->size[axis] - 1 : (uint32_t)at;
}

static size_t cell_of(const grid *g, const uint32_t cell[3]) {
    return ((size_t)cell[2] * g->size[1] + cell[1]) * g->size[0] + cell[0];
}

static size_t cell_at(const grid *g, const float *p) {
    const uint32_t cell[3] = {axis_cell(g, p, 0), axis_cell(g, p, 1), axis_cell(g, p, 2)};
    return cell_of(g, cell);
}

static girih_result build_grid(const bench_triangles *triangles, grid *g, girih_error *error) {
    const size_t count = 3 * (size_t)triangles->count;
    float high[3];
    memcpy(g->low, triangles->corners[0], sizeof g->low);
    memcpy(high, triangles->corners[0], sizeof high);
    for (size_t n = 0; n < count; ++n) {
        for (int k = 0; k < 3; ++k) {
            g->low[k] = fminf(g->low[k], triangles->corners[n][k]);
            high[k] = fmaxf(high[k], triangles->corners[n][k]);
        }
    }
    // A surface fills cells as the square of the resolution.
    const float extent =
        fmaxf(fmaxf(high[0] - g->low[0], high[1] - g->low[1]), high[2] - g->low[2]);
    const float side = fminf(256.0f, fmaxf(1.0f, sqrtf((float)triangles->count / 12.0f)));
    g->cell = extent > 0.0f ? extent / side : 1.0f;
    size_t cells = 1;
    for (int k = 0; k < 3; ++k) {
        g->size[k] = (uint32_t)((high[k] - g->low[k]) / g->cell) + 1u;
        cells *= g->size[k];
    }
    g->triangles = triangles;
    g->first = calloc(cells + 2, sizeof *g->first);
    g->order = malloc((count + 1) * sizeof *g->order);
    if (!g->first || !g->order) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t n = 0; n < count; ++n) {
        ++g->first[cell_at(g, triangles->corners[n]) + 2];
    }
    for (size_t n = 2; n < cells + 2; ++n) {
        g->first[n] += g->first[n - 1];
    }
    for (size_t n = 0; n < count; ++n) {
        g->order[g->first[cell_at(g, triangles->corners[n]) + 1]++] = (uint32_t)n;
    }
    return GIRIH_OK;
}

static void free_grid(grid *g) {
    free(g->first);
    free(g->order);
}

static float nearest_in_cell(const grid *g, size_t cell, const float *p, float nearest) {
    for (uint32_t n = g->first[cell]; n < g->first[cell + 1]; ++n) {
        const float *q = g->triangles->corners[g->order[n]];
        const float x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
        nearest = fminf(nearest, x * x + y * y + z * z);
    }
    return nearest;
}

// Rings of cells around the point's own, until no farther ring can hold a nearer one.
static float nearest_vertex(const grid *g, const float *p) {
    const int at[3] = {(int)axis_cell(g, p, 0), (int)axis_cell(g, p, 1), (int)axis_cell(g, p, 2)};
    float nearest = INFINITY;
    const int most = (int)(g->size[0] + g->size[1] + g->size[2]);
    for (int ring = 0; ring <= most; ++ring) {
        const float gap = (float)(ring - 1) * g->cell;
        if (ring > 0 && gap > 0.0f && nearest <= gap * gap) {
            break;
        }
        for (int z = -ring; z <= ring; ++z) {
            for (int y = -ring; y <= ring; ++y) {
                const bool inner = abs(z) < ring && abs(y) < ring;
                for (int x = -ring; x <= ring; x += inner && ring > 0 ? 2 * ring : 1) {
                    const int cell[3] = {at[0] + x, at[1] + y, at[2] + z};
                    bool outside = false;
                    for (int k = 0; k < 3; ++k) {
                        outside = outside || cell[k] < 0 || cell[k] >= (int)g->size[k];
                    }
                    if (!outside) {
                        const uint32_t c[3] = {(uint32_t)cell[0], (uint32_t)cell[1],
                                               (uint32_t)cell[2]};
                        nearest = nearest_in_cell(g, cell_of(g, c), p, nearest);
                    }
                }
            }
        }
    }
    return nearest;
}

static double largest_distance(const grid *g, const bench_triangles *triangles) {
    float largest = 0.0f;
    for (size_t n = 0; n < 3 * (size_t)triangles->count; ++n) {
        largest = fmaxf(largest, nearest_vertex(g, triangles->corners[n]));
    }
    return sqrt((double)largest);
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
    grid a = {0};
    grid b = {0};
    girih_result result = build_grid(reference, &a, error);
    if (result == GIRIH_OK) {
        result = build_grid(triangles, &b, error);
    }
    if (result == GIRIH_OK) {
        agreement->largest_distance =
            fmax(largest_distance(&a, triangles), largest_distance(&b, reference));
    }
    free_grid(&a);
    free_grid(&b);
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
