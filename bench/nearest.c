#include "nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

struct bench_nearest {
    const bench_triangles *triangles;
    bench_nearest_kind kind;
    float low[3];
    float cell;
    uint32_t size[3];
    uint32_t *first; // of each cell, and the end
    uint32_t *order; // items by cell: every cell that an item's bounding box touches has it
};

// --- The grid -----------------------------------------------------------------------------------

static size_t corners_of(const bench_nearest *g) {
    return g->kind == BENCH_NEAREST_VERTEX ? 1 : 3;
}

static size_t item_count(const bench_nearest *g) {
    return 3 * (size_t)g->triangles->count / corners_of(g);
}

static uint32_t axis_cell(const bench_nearest *g, float at, int axis) {
    const float cells = (at - g->low[axis]) / g->cell;
    return cells <= 0.0f                         ? 0u
           : cells >= (float)(g->size[axis] - 1) ? g->size[axis] - 1
                                                 : (uint32_t)cells;
}

static size_t cell_of(const bench_nearest *g, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * g->size[1] + y) * g->size[0] + x;
}

// The cells of an item's bounding box.
typedef struct cells {
    uint32_t low[3], high[3];
} cells;

static cells cells_of(const bench_nearest *g, size_t item) {
    const size_t count = corners_of(g);
    const float(*corners)[6] = (const float(*)[6])g->triangles->corners + count * item;
    cells box;
    for (int axis = 0; axis < 3; ++axis) {
        float low = corners[0][axis];
        float high = low;
        for (size_t n = 1; n < count; ++n) {
            low = fminf(low, corners[n][axis]);
            high = fmaxf(high, corners[n][axis]);
        }
        box.low[axis] = axis_cell(g, low, axis);
        box.high[axis] = axis_cell(g, high, axis);
    }
    return box;
}

// Counts the item in each of its cells, or writes it there.
static void enter(bench_nearest *g, size_t item, bool count) {
    const cells box = cells_of(g, item);
    for (uint32_t z = box.low[2]; z <= box.high[2]; ++z) {
        for (uint32_t y = box.low[1]; y <= box.high[1]; ++y) {
            for (uint32_t x = box.low[0]; x <= box.high[0]; ++x) {
                const size_t cell = cell_of(g, x, y, z);
                if (count) {
                    ++g->first[cell + 2];
                } else {
                    g->order[g->first[cell + 1]++] = (uint32_t)item;
                }
            }
        }
    }
}

// About one vertex or three triangles to a cell that has any.
static size_t lay_out(bench_nearest *g) {
    const bench_triangles *triangles = g->triangles;
    float high[3];
    memcpy(g->low, triangles->corners[0], sizeof g->low);
    memcpy(high, triangles->corners[0], sizeof high);
    for (size_t n = 0; n < 3 * (size_t)triangles->count; ++n) {
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
    size_t count = 1;
    for (int k = 0; k < 3; ++k) {
        g->size[k] = (uint32_t)((high[k] - g->low[k]) / g->cell) + 1u;
        count *= g->size[k];
    }
    return count;
}

girih_result bench_nearest_create(const bench_triangles *triangles, bench_nearest_kind kind,
                                  bench_nearest **nearest, girih_error *error) {
    bench_nearest *g = calloc(1, sizeof *g);
    if (!g) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    g->triangles = triangles;
    g->kind = kind;
    const size_t cell_count = lay_out(g);
    g->first = calloc(cell_count + 2, sizeof *g->first);
    if (g->first) {
        for (size_t n = 0; n < item_count(g); ++n) {
            enter(g, n, true);
        }
        for (size_t n = 2; n < cell_count + 2; ++n) {
            g->first[n] += g->first[n - 1];
        }
        g->order = malloc(((size_t)g->first[cell_count + 1] + 1) * sizeof *g->order);
    }
    if (!g->order) {
        bench_nearest_destroy(g);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t n = 0; n < item_count(g); ++n) {
        enter(g, n, false);
    }
    *nearest = g;
    return GIRIH_OK;
}

void bench_nearest_destroy(bench_nearest *nearest) {
    if (nearest) {
        free(nearest->first);
        free(nearest->order);
        free(nearest);
    }
}

// --- Distances ----------------------------------------------------------------------------------

typedef struct vector {
    double x, y, z;
} vector;

static vector to(const float *from, const float *p) {
    return (vector){(double)p[0] - (double)from[0], (double)p[1] - (double)from[1],
                    (double)p[2] - (double)from[2]};
}

static double dot(vector a, vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Barycentrics of the triangle's point that is nearest to p, by the region of the triangle's plane
// that p is over (Ericson, Real-Time Collision Detection, 2005, section 5.1.5). Triangles without
// area have none to be over: they count as their edges.
static void nearest_of_triangle(const float (*t)[6], const float *p, double weights[3]) {
    const vector ab = to(t[0], t[1]);
    const vector ac = to(t[0], t[2]);
    const vector ap = to(t[0], p);
    const vector bp = to(t[1], p);
    const vector cp = to(t[2], p);
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    const double va = d3 * d6 - d5 * d4;
    const double vb = d5 * d2 - d1 * d6;
    const double vc = d1 * d4 - d3 * d2;
    double b, c;
    if (d1 <= 0.0 && d2 <= 0.0) {
        b = c = 0.0;
    } else if (d3 >= 0.0 && d4 <= d3) {
        b = 1.0;
        c = 0.0;
    } else if (d6 >= 0.0 && d5 <= d6) {
        b = 0.0;
        c = 1.0;
    } else if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) {
        b = d1 / (d1 - d3);
        c = 0.0;
    } else if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6) {
        b = 0.0;
        c = d2 / (d2 - d6);
    } else if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
        c = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        b = 1.0 - c;
    } else {
        b = vb / (va + vb + vc);
        c = vc / (va + vb + vc);
    }
    weights[0] = 1.0 - b - c;
    weights[1] = b;
    weights[2] = c;
}

static void try_item(const bench_nearest *g, size_t item, const float *p,
                     bench_nearest_point *best) {
    const float(*t)[6] = (const float(*)[6])g->triangles->corners + corners_of(g) * item;
    bench_nearest_point point = {.item = item, .weights = {1.0, 0.0, 0.0}};
    vector away = to(p, t[0]);
    if (g->kind == BENCH_NEAREST_TRIANGLE) {
        nearest_of_triangle(t, p, point.weights);
        const vector ab = to(t[0], t[1]);
        const vector ac = to(t[0], t[2]);
        away.x += point.weights[1] * ab.x + point.weights[2] * ac.x;
        away.y += point.weights[1] * ab.y + point.weights[2] * ac.y;
        away.z += point.weights[1] * ab.z + point.weights[2] * ac.z;
    }
    point.squared_distance = dot(away, away);
    if (point.squared_distance < best->squared_distance) {
        *best = point;
    }
}

// How far it is from p, at least, to what lies in no ring of cells up to `ring` around the cell
// `at`; infinite where nothing does.
static double gap_beyond(const bench_nearest *g, const int at[3], int ring, const float *p) {
    double gap = INFINITY;
    for (int k = 0; k < 3; ++k) {
        const double inside = (double)p[k] - (double)g->low[k];
        if (at[k] - ring > 0) {
            gap = fmin(gap, inside - (at[k] - ring) * (double)g->cell);
        }
        if (at[k] + ring + 1 < (int)g->size[k]) {
            gap = fmin(gap, (at[k] + ring + 1) * (double)g->cell - inside);
        }
    }
    // Cells are found in single precision: what is this near to their borders may be in either.
    return fmax(gap - 1e-4 * (double)g->cell, 0.0);
}

bench_nearest_point bench_nearest_find(const bench_nearest *g, const float p[3]) {
    const int at[3] = {(int)axis_cell(g, p[0], 0), (int)axis_cell(g, p[1], 1),
                       (int)axis_cell(g, p[2], 2)};
    bench_nearest_point best = {.squared_distance = INFINITY};
    double gap = 0.0;
    for (int ring = 0; gap * gap < best.squared_distance; ++ring) {
        for (int z = -ring; z <= ring; ++z) {
            for (int y = -ring; y <= ring; ++y) {
                const bool inner = abs(z) < ring && abs(y) < ring;
                for (int x = -ring; x <= ring; x += inner ? 2 * ring : 1) {
                    const int c[3] = {at[0] + x, at[1] + y, at[2] + z};
                    if (c[0] < 0 || c[1] < 0 || c[2] < 0 || c[0] >= (int)g->size[0] ||
                        c[1] >= (int)g->size[1] || c[2] >= (int)g->size[2]) {
                        continue;
                    }
                    const size_t cell = cell_of(g, (uint32_t)c[0], (uint32_t)c[1], (uint32_t)c[2]);
                    for (uint32_t n = g->first[cell]; n < g->first[cell + 1]; ++n) {
                        try_item(g, g->order[n], p, &best);
                    }
                }
            }
        }
        gap = gap_beyond(g, at, ring, p);
    }
    return best;
}
