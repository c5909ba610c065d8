// The bench's nearest vertices and triangles: what the grid finds is what trying all finds, with
// another formula.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nearest.h"

enum { TRIANGLES = 600, POINTS = 2000 };

static uint32_t state = 1;

// In [-1, 1).
static float draw(void) {
    state = state * 1664525u + 1013904223u;
    return (float)(state >> 8) / (float)(1u << 23) - 1.0f;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const float *a, const float *b, double c[3]) {
    for (int k = 0; k < 3; ++k) {
        c[k] = (double)a[k] - (double)b[k];
    }
}

static double to_segment(const float *p, const float *a, const float *b) {
    double along[3], from[3];
    subtract(b, a, along);
    subtract(p, a, from);
    const double square = dot(along, along);
    const double t = square > 0.0 ? fmin(fmax(dot(from, along) / square, 0.0), 1.0) : 0.0;
    for (int k = 0; k < 3; ++k) {
        from[k] -= t * along[k];
    }
    return dot(from, from);
}

// The plane's where p is over the triangle, else the nearest edge's.
static double to_triangle(const float *p, const float (*t)[6]) {
    double nearest =
        fmin(fmin(to_segment(p, t[0], t[1]), to_segment(p, t[1], t[2])), to_segment(p, t[2], t[0]));
    double a[3], b[3], from[3];
    subtract(t[1], t[0], a);
    subtract(t[2], t[0], b);
    subtract(p, t[0], from);
    const double normal[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                              a[0] * b[1] - a[1] * b[0]};
    const double square = dot(normal, normal);
    if (square > 0.0) {
        const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
        const double v = (bb * dot(from, a) - ab * dot(from, b)) / square;
        const double w = (aa * dot(from, b) - ab * dot(from, a)) / square;
        if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
            nearest = fmin(nearest, dot(from, normal) * dot(from, normal) / square);
        }
    }
    return nearest;
}

// Triangles of all sizes near a sphere, one in eight without area.
static bench_triangles make_triangles(float size) {
    bench_triangles triangles = {.corners = malloc(sizeof(float[TRIANGLES][3][6])),
                                 .count = TRIANGLES};
    assert_non_null(triangles.corners);
    for (uint32_t n = 0; n < TRIANGLES; ++n) {
        float(*t)[6] = triangles.corners + 3 * (size_t)n;
        const float middle[3] = {draw(), draw(), draw()};
        const float length =
            sqrtf(middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]) + 1e-3f;
        const float extent = size * (n % 5 == 0 ? 10.0f : 1.0f);
        for (int corner = 0; corner < 3; ++corner) {
            for (int k = 0; k < 3; ++k) {
                t[corner][k] = middle[k] / length + extent * draw();
            }
        }
        if (n % 8 == 0) {
            memcpy(t[n % 3], t[(n + 1) % 3], sizeof *t);
        }
        if (n % 16 == 0) {
            memcpy(t[0], t[1], sizeof *t);
            memcpy(t[2], t[1], sizeof *t);
        }
    }
    return triangles;
}

static void make_point(uint32_t n, const bench_triangles *triangles, float point[3]) {
    const float *corner = triangles->corners[n % (3 * TRIANGLES)];
    for (int k = 0; k < 3; ++k) {
        // At a corner, near one, anywhere near, and far outside.
        const float away[4] = {0.0f, 0.01f, 1.0f, 9.0f};
        point[k] = corner[k] + away[n % 4] * draw();
    }
}

static void check(const bench_triangles *triangles, bench_nearest_kind kind) {
    girih_error error = {0};
    bench_nearest *nearest = NULL;
    assert_int_equal(bench_nearest_create(triangles, kind, &nearest, &error), GIRIH_OK);
    for (uint32_t n = 0; n < POINTS; ++n) {
        float point[3];
        make_point(n, triangles, point);
        double least = INFINITY;
        for (uint32_t i = 0; i < (kind == BENCH_NEAREST_VERTEX ? 3u : 1u) * TRIANGLES; ++i) {
            const float(*corners)[6] = (const float(*)[6])triangles->corners;
            least = fmin(least, kind == BENCH_NEAREST_VERTEX
                                    ? to_segment(point, corners[i], corners[i])
                                    : to_triangle(point, corners + 3 * (size_t)i));
        }
        const bench_nearest_point found = bench_nearest_find(nearest, point);
        assert_true(fabs(sqrt(found.squared_distance) - sqrt(least)) <= 1e-7);
        // The weights are of a point of the item, and it is as far as is said.
        const float(*t)[6] = (const float(*)[6])triangles->corners +
                             (kind == BENCH_NEAREST_VERTEX ? 1 : 3) * found.item;
        double away[3];
        double sum = 0.0;
        subtract(point, t[0], away);
        for (int corner = 0; corner < (kind == BENCH_NEAREST_VERTEX ? 1 : 3); ++corner) {
            double along[3];
            subtract(t[corner], t[0], along);
            assert_true(found.weights[corner] >= -1e-9);
            sum += found.weights[corner];
            for (int k = 0; k < 3; ++k) {
                away[k] -= found.weights[corner] * along[k];
            }
        }
        assert_true(fabs(sum - 1.0) <= 1e-12);
        assert_true(fabs(sqrt(dot(away, away)) - sqrt(found.squared_distance)) <= 1e-9);
    }
    bench_nearest_destroy(nearest);
}

static void nearest_is_the_least_of_all(void **unused) {
    (void)unused;
    static const float sizes[4] = {0.0f, 0.001f, 0.05f, 0.5f};
    for (int n = 0; n < 4; ++n) {
        bench_triangles triangles = make_triangles(sizes[n]);
        check(&triangles, BENCH_NEAREST_VERTEX);
        check(&triangles, BENCH_NEAREST_TRIANGLE);
        free(triangles.corners);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nearest_is_the_least_of_all)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
