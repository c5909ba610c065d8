// The family `uniform`: the inner vertices of the regular grid of the largest segment count n, and
// one ring of triangles between that grid and the three borders, n^2 - 3n + n1 + n2 + n3 triangles.
//
// Which triangles fill the ring is chosen by the constrained Delaunay triangulation, which makes
// the smallest angle as large as it can be; with n segments on all edges it is the regular grid.
// Flipping edges (Lawson 1977) reaches it from any first triangulation and never changes the number
// of triangles.
#include "family.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "error.h"
#include "girih/catalogue.h"

#define NO_NEIGHBOUR UINT32_MAX

// A vertex of the ring: on the border, or on the outline of the inner grid.
typedef struct ring_vertex {
    uint32_t index;    // of the pattern's vertex
    double weights[3]; // barycentric coordinates before rounding: equal distances stay equal
} ring_vertex;

typedef struct ring_triangle {
    uint32_t vertices[3];   // of the ring
    uint32_t neighbours[3]; // the triangle across the edge from vertex n to n + 1, or NO_NEIGHBOUR
    bool queued;
} ring_triangle;

typedef struct ring {
    const uint32_t *positions; // packed, by pattern vertex
    ring_vertex *vertices;     // the border in the order of the pattern, then the inner outline
    ring_triangle *triangles;  // in order around the triangle until edges are flipped
    uint32_t triangle_count;
    uint32_t *queue; // triangles whose edges are still to be looked at, each at most once
    uint32_t queued;
    int symmetry_corner; // the corner on the pattern's axis of symmetry, -1 without one
} ring;

// The pattern's vertex at (n - b - c, b, c) / n inside the triangle: rows along edge 1, from there
// towards P3.
static uint32_t interior_vertex(const uint32_t segments[3], uint32_t b, uint32_t c) {
    uint32_t row = c - 1;
    return girih_border_count(segments) + row * (segments[0] - 2) - row * (row - 1) / 2 + b - 1;
}

// Rounds the two smallest weights and gives the rest to the largest, so that the rows next to the
// borders stay straight and parallel to them: no triangle of the ring can turn over by rounding.
static uint32_t interior_position(uint32_t n, uint32_t b, uint32_t c) {
    const uint32_t steps[3] = {n - b - c, b, c};
    uint32_t largest = 0;
    uint32_t weights[3];
    uint32_t rest = GIRIH_BARYCENTRIC_ONE;
    for (uint32_t corner = 0; corner < 3; corner++) {
        largest = steps[corner] > steps[largest] ? corner : largest;
        weights[corner] = girih_edge_parameter(steps[corner], n);
        rest -= weights[corner];
    }
    weights[largest] += rest;
    return girih_pack_vertex(weights[0], weights[1]);
}

static void place_interior(const uint32_t segments[3], uint32_t *vertices) {
    uint32_t n = segments[0];
    for (uint32_t c = 1; c + 1 < n; c++) {
        for (uint32_t b = 1; b + c < n; b++) {
            vertices[interior_vertex(segments, b, c)] = interior_position(n, b, c);
        }
    }
}

// The triangles whose corners are all inside, (n - 3)^2 of them.
static uint32_t *fill_interior(const uint32_t segments[3], uint32_t *index) {
    uint32_t n = segments[0];
    for (uint32_t c = 1; c + 2 < n; c++) {
        for (uint32_t b = 1; b + c + 1 < n; b++) {
            *index++ = interior_vertex(segments, b, c);
            *index++ = interior_vertex(segments, b + 1, c);
            *index++ = interior_vertex(segments, b, c + 1);
            if (b + c + 2 < n) {
                *index++ = interior_vertex(segments, b + 1, c);
                *index++ = interior_vertex(segments, b + 1, c + 1);
                *index++ = interior_vertex(segments, b, c + 1);
            }
        }
    }
    return index;
}

// Step m of the outline of the inner grid along an edge, for n > 2, m in [0, n - 3].
static uint32_t outline_vertex(const uint32_t segments[3], uint32_t edge, uint32_t m) {
    uint32_t steps = segments[0] - 3;
    return girih_border_count(segments) + (steps == 0 ? 0 : (edge * steps + m) % (3 * steps));
}

static void place_ring_vertices(const uint32_t segments[3], ring_vertex *vertices) {
    for (uint32_t edge = 0; edge < 3; edge++) {
        double count = segments[edge];
        for (uint32_t m = 0; m < segments[edge]; m++) {
            uint32_t index = girih_border_vertex(segments, edge, m);
            vertices[index] = (ring_vertex){.index = index};
            vertices[index].weights[edge] = (segments[edge] - m) / count;
            vertices[index].weights[(edge + 1) % 3] = m / count;
        }
    }
    uint32_t n = segments[0];
    for (uint32_t edge = 0; edge < 3 && n > 2; edge++) {
        for (uint32_t m = 0; m + 2 < n; m++) {
            uint32_t steps[3] = {1, 1, 1};
            steps[edge] = n - 2 - m;
            steps[(edge + 1) % 3] = m + 1;
            ring_vertex *vertex = &vertices[outline_vertex(segments, edge, m)];
            vertex->index = interior_vertex(segments, steps[1], steps[2]);
            for (int corner = 0; corner < 3; corner++) {
                vertex->weights[corner] = steps[corner] / (double)n;
            }
        }
    }
}

static void add_ring_triangle(ring *r, uint32_t a, uint32_t b, uint32_t c, uint32_t entry,
                              uint32_t exit) {
    uint32_t here = r->triangle_count++;
    ring_triangle *triangle = &r->triangles[here];
    *triangle = (ring_triangle){.vertices = {a, b, c}};
    for (int edge = 0; edge < 3; edge++) {
        triangle->neighbours[edge] = NO_NEIGHBOUR;
    }
    triangle->neighbours[entry] = here - 1;
    triangle->neighbours[exit] = here + 1;
}

// Steps along a border and the outline of the inner grid at once, always on the side that lags
// behind. Both are straight and parallel, so every step gives a triangle of positive area.
static void stitch_edge(ring *r, const uint32_t segments[3], uint32_t edge) {
    uint32_t outer_count = segments[edge];
    uint32_t inner_count = segments[0] - 3;
    uint32_t outer = 0;
    uint32_t inner = 0;
    while (outer < outer_count || inner < inner_count) {
        uint32_t border = girih_border_vertex(segments, edge, outer);
        uint32_t outline = outline_vertex(segments, edge, inner);
        bool outward = inner == inner_count ||
                       (outer < outer_count &&
                        (2 * outer + 1) * segments[0] <= (2 * inner + 4) * outer_count);
        if (outward) {
            outer++;
            add_ring_triangle(r, border, girih_border_vertex(segments, edge, outer), outline, 2, 1);
        } else {
            inner++;
            add_ring_triangle(r, outline_vertex(segments, edge, inner), outline, border, 1, 2);
        }
    }
}

// The first triangulation of the ring.
static void stitch(ring *r, const uint32_t segments[3]) {
    if (segments[0] > 2) {
        for (uint32_t edge = 0; edge < 3; edge++) {
            stitch_edge(r, segments, edge);
        }
        // Close the ring. Its first triangle stands on edge 1, which has n segments.
        r->triangles[0].neighbours[2] = r->triangle_count - 1;
        ring_triangle *last = &r->triangles[r->triangle_count - 1];
        for (int edge = 0; edge < 3; edge++) {
            if (last->neighbours[edge] == r->triangle_count) {
                last->neighbours[edge] = 0;
            }
        }
        return;
    }
    // No vertex inside: a fan around the middle of edge 1, or the one triangle itself.
    uint32_t middle = segments[0] == 2 ? girih_border_vertex(segments, 0, 1) : 0;
    for (uint32_t edge = 0; edge < 3; edge++) {
        for (uint32_t m = 0; m < segments[edge]; m++) {
            uint32_t from = girih_border_vertex(segments, edge, m);
            uint32_t to = girih_border_vertex(segments, edge, m + 1);
            if (from != middle && to != middle) {
                add_ring_triangle(r, from, to, middle, 2, 1);
            }
        }
    }
    r->triangles[0].neighbours[2] = NO_NEIGHBOUR;
    r->triangles[r->triangle_count - 1].neighbours[1] = NO_NEIGHBOUR;
}

// Twice the signed area, in units of 1 / 32768^2 of the whole.
static int64_t doubled_area(const ring *r, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t corners[3] = {a, b, c};
    int64_t u[3];
    int64_t v[3];
    for (int n = 0; n < 3; n++) {
        uint32_t position = r->positions[r->vertices[corners[n]].index];
        u[n] = position & 0xffff;
        v[n] = position >> 16;
    }
    return (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
}

// sqrt(3) times the cotangent of the angle at `apex` in the equilateral triangle.
static double cotangent(const ring *r, uint32_t apex, uint32_t from, uint32_t to) {
    const double *p = r->vertices[apex].weights;
    const double *a = r->vertices[from].weights;
    const double *b = r->vertices[to].weights;
    double dot = 0;
    for (int corner = 0; corner < 3; corner++) {
        dot += (a[corner] - p[corner]) * (b[corner] - p[corner]);
    }
    double cross = (a[0] - p[0]) * (b[1] - p[1]) - (b[0] - p[0]) * (a[1] - p[1]);
    return dot / cross;
}

// Four points on a circle have two Delaunay triangulations. The diagonal that begins farthest from
// the pattern's axis of symmetry is taken, so that both sides of the axis choose alike.
static bool goes_before(const ring *r, uint32_t a, uint32_t b) {
    if (r->symmetry_corner >= 0) {
        int corner = r->symmetry_corner;
        const double *p = r->vertices[a].weights;
        const double *q = r->vertices[b].weights;
        double distance_a = fabs(p[(corner + 1) % 3] - p[(corner + 2) % 3]);
        double distance_b = fabs(q[(corner + 1) % 3] - q[(corner + 2) % 3]);
        if (distance_a > distance_b || distance_a < distance_b) {
            return distance_a > distance_b;
        }
        if (p[corner] > q[corner] || p[corner] < q[corner]) {
            return p[corner] > q[corner];
        }
    }
    return a < b;
}

static uint32_t first_of(const ring *r, uint32_t a, uint32_t b) {
    return goes_before(r, a, b) ? a : b;
}

// Whether the quadrilateral a, d, b, c should be cut from c to d rather than from a to b.
static bool should_flip(const ring *r, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    if (doubled_area(r, a, d, c) <= 0 || doubled_area(r, d, b, c) <= 0) {
        return false;
    }
    const double tie = 1e-9;
    double sum = cotangent(r, c, a, b) + cotangent(r, d, b, a);
    if (fabs(sum) > tie) {
        return sum < 0;
    }
    return goes_before(r, first_of(r, c, d), first_of(r, a, b));
}

static void replace_neighbour(ring *r, uint32_t triangle, uint32_t old, uint32_t new) {
    for (int edge = 0; edge < 3 && triangle != NO_NEIGHBOUR; edge++) {
        if (r->triangles[triangle].neighbours[edge] == old) {
            r->triangles[triangle].neighbours[edge] = new;
        }
    }
}

// Flips an edge of a triangle where that is better; returns the other triangle, or NO_NEIGHBOUR.
static uint32_t flip(ring *r, uint32_t here, uint32_t edge) {
    ring_triangle *triangle = &r->triangles[here];
    uint32_t there = triangle->neighbours[edge];
    if (there == NO_NEIGHBOUR) {
        return NO_NEIGHBOUR;
    }
    ring_triangle *other = &r->triangles[there];
    uint32_t next = (edge + 1) % 3;
    uint32_t last = (edge + 2) % 3;
    uint32_t a = triangle->vertices[edge];
    uint32_t b = triangle->vertices[next];
    uint32_t c = triangle->vertices[last];
    uint32_t other_a = 0;
    while (other->vertices[other_a] != a) {
        other_a++;
    }
    uint32_t d = other->vertices[(other_a + 1) % 3];
    if (!should_flip(r, a, b, c, d)) {
        return NO_NEIGHBOUR;
    }
    uint32_t across_bc = triangle->neighbours[next];
    uint32_t across_ca = triangle->neighbours[last];
    uint32_t across_ad = other->neighbours[other_a];
    uint32_t across_db = other->neighbours[(other_a + 1) % 3];
    *triangle = (ring_triangle){{c, a, d}, {across_ca, across_ad, there}, triangle->queued};
    *other = (ring_triangle){{d, b, c}, {across_db, across_bc, here}, other->queued};
    replace_neighbour(r, across_ad, there, here);
    replace_neighbour(r, across_bc, here, there);
    return there;
}

static void enqueue(ring *r, uint32_t triangle) {
    if (!r->triangles[triangle].queued) {
        r->triangles[triangle].queued = true;
        r->queue[r->queued++] = triangle;
    }
}

static void make_delaunay(ring *r) {
    for (uint32_t n = 0; n < r->triangle_count; n++) {
        enqueue(r, n);
    }
    while (r->queued > 0) {
        uint32_t here = r->queue[--r->queued];
        r->triangles[here].queued = false;
        for (uint32_t edge = 0; edge < 3; edge++) {
            uint32_t there = flip(r, here, edge);
            if (there != NO_NEIGHBOUR) {
                enqueue(r, here);
                enqueue(r, there);
                break;
            }
        }
    }
}

static girih_result build(const girih_family *family, const uint32_t segments[3], girih_pattern *pattern,
                          girih_error *error) {
    (void)family;
    const uint32_t n = segments[0];
    const uint32_t border = girih_border_count(segments);
    girih_result result = girih_pattern_allocate(pattern, segments, border + (n > 2 ? (n - 1) * (n - 2) / 2 : 0),
                                                 n * n + border - 3 * n, error);
    if (result != GIRIH_OK) {
        return result;
    }
    place_interior(segments, pattern->vertices);
    uint32_t *index = fill_interior(segments, pattern->indices);

    uint32_t outline = n > 3 ? 3 * (n - 3) : 1;
    size_t capacity = (size_t)border + outline;
    ring r = {
        .positions = pattern->vertices,
        .vertices = calloc(capacity, sizeof *r.vertices),
        .triangles = calloc(capacity, sizeof *r.triangles),
        .queue = calloc(capacity, sizeof *r.queue),
        .symmetry_corner = girih_symmetry_corner(segments),
    };
    if (!r.vertices || !r.triangles || !r.queue) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu ring vertices",
                            capacity);
    } else {
        place_ring_vertices(segments, r.vertices);
        stitch(&r, segments);
        make_delaunay(&r);
        for (uint32_t t = 0; t < r.triangle_count; t++) {
            for (int corner = 0; corner < 3; corner++) {
                *index++ = r.vertices[r.triangles[t].vertices[corner]].index;
            }
        }
    }
    free(r.queue);
    free(r.triangles);
    free(r.vertices);
    return result;
}

const girih_family girih_family_uniform = {
    .name = "uniform",
    .summary = "a regular grid inside, one ring stitched to the borders",
    .build = build,
};
