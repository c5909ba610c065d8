// Laws of the generated patterns and of the lambda table.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "family.h"
#include "girih/catalogue.h"
#include "girih_permutation.h"
#include "laws.h"
#include "permutation.h"

static girih_pattern build(uint32_t n1, uint32_t n2, uint32_t n3) {
    const uint32_t segments[3] = {n1, n2, n3};
    girih_pattern built;
    girih_error error = {.message = ""};
    girih_result result = girih_pattern_build(&girih_family_uniform, segments, &built, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
    return built;
}

static girih_result check(const girih_pattern *built, girih_error *error) {
    return girih_laws_check_pattern(built->segments, built->vertices, built->vertex_count,
                                    built->indices, built->triangle_count, false, error);
}

static void assert_lawful_pattern(const girih_pattern *built) {
    girih_error error = {.message = ""};
    girih_result result = check(built, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
}

static void assert_lawful(uint32_t n1, uint32_t n2, uint32_t n3) {
    girih_pattern built = build(n1, n2, n3);
    // ring and inner grid of the family `uniform`
    assert_int_equal((int64_t)built.triangle_count,
                     (int64_t)n1 * n1 - 3 * (int64_t)n1 + n1 + n2 + n3);
    assert_lawful_pattern(&built);
    girih_pattern_free(&built);
}

// ARKFPI, equation 2: N distinct levels have N(N+1)(N+2)/6 base patterns of N^3, whatever the
// spacing.
static void test_base_pattern_count(void **state) {
    (void)state;
    for (uint32_t spacing = GIRIH_SPACING_DYADIC; spacing <= GIRIH_SPACING_LINEAR; spacing++) {
        const girih_catalogue header = {.spacing = spacing};
        for (uint32_t levels = 1; levels <= 12; levels++) {
            static uint8_t seen[12 * 13 * 14 / 6];
            memset(seen, 0, sizeof seen);
            uint32_t count = 0;
            for (uint32_t n = 0; n < levels * levels * levels; n++) {
                uint32_t sorted[3] = {n % levels, n / levels % levels, n / levels / levels};
                girih_permutation_sort(sorted);
                const uint32_t i = sorted[0];
                const uint32_t j = sorted[1];
                const uint32_t k = sorted[2];
                assert_true(girih_catalogue_segments(&header, i) >=
                            girih_catalogue_segments(&header, j));
                assert_true(girih_catalogue_segments(&header, j) >=
                            girih_catalogue_segments(&header, k));
                uint32_t rank = i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + k;
                assert_true(rank < sizeof seen);
                count += !seen[rank];
                seen[rank] = 1;
            }
            assert_int_equal(count, levels * (levels + 1) * (levels + 2) / 6);
            for (uint32_t rank = 0; rank < count; rank++) {
                assert_true(seen[rank]);
            }
        }
    }
}

static void test_linear_laws(void **state) {
    (void)state;
    for (uint32_t i = 1; i <= 12; i++) {
        for (uint32_t j = 1; j <= i; j++) {
            for (uint32_t k = 1; k <= j; k++) {
                assert_lawful(i, j, k);
            }
        }
    }
}

static void test_dyadic_laws(void **state) {
    (void)state;
    for (uint32_t i = 0; i <= 7; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++) {
                assert_lawful(1u << i, 1u << j, 1u << k);
            }
        }
    }
}

// Odd counts, primes and extreme differences beyond the built-in catalogues.
static void test_uneven_laws(void **state) {
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 17, 31, 64, 97, 127};
    for (uint32_t i = 0; i < 8; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++) {
                assert_lawful(counts[i], counts[j], counts[k]);
            }
        }
    }
    for (uint32_t k = 0; k < 8; k++) {
        assert_lawful(255, counts[k], counts[k]);
        assert_lawful(255, 255, counts[k]);
        assert_lawful(255, 128, counts[k]);
    }
    assert_lawful(255, 255, 255);
}

static void test_edges_read_the_same_from_both_ends(void **state) {
    (void)state;
    for (uint32_t n = 2; n <= 128; n++) {
        girih_pattern built = build(n, 1, 1);
        uint32_t previous = 0;
        for (uint32_t m = 1; m < n; m++) {
            uint32_t from_p1 = built.vertices[3 + m - 1] >> 16;
            uint32_t from_p2 = built.vertices[3 + (n - m) - 1] & 0xffff;
            assert_int_equal(from_p1, from_p2);
            assert_true(from_p1 > previous);
            previous = from_p1;
        }
        girih_pattern_free(&built);
    }
}

// With one count on all edges the pattern is the regular grid: every triangle's sides are one grid
// step long.
static void test_equal_levels_are_the_regular_grid(void **state) {
    (void)state;
    for (uint32_t level = 0; level <= 6; level++) {
        uint32_t n = 1u << level;
        int32_t step = (int32_t)(GIRIH_BARYCENTRIC_ONE / n);
        girih_pattern built = build(n, n, n);
        assert_int_equal(built.triangle_count, n * n);
        for (size_t index = 0; index < (size_t)built.triangle_count * 3; index++) {
            size_t next = index % 3 == 2 ? index - 2 : index + 1;
            uint32_t a = built.vertices[built.indices[index]];
            uint32_t b = built.vertices[built.indices[next]];
            int32_t du = (int32_t)(a & 0xffff) - (int32_t)(b & 0xffff);
            int32_t dv = (int32_t)(a >> 16) - (int32_t)(b >> 16);
            assert_true(abs(du) <= step && abs(dv) <= step && abs(du + dv) <= step);
        }
        girih_pattern_free(&built);
    }
}

static int compare_keys(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

static int compare_positions(const void *a, const void *b) {
    uint32_t left = *(const uint32_t *)a;
    uint32_t right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

// Triangles by the sorted positions of their corners, in sorted order; mirrored at the axis through
// the corner `fixed` where that is not -1.
static uint32_t (*triangle_keys(const girih_pattern *built, int fixed))[3] {
    uint32_t(*keys)[3] = malloc(built->triangle_count * sizeof *keys);
    assert_non_null(keys);
    for (size_t n = 0; n < built->triangle_count; n++) {
        for (size_t corner = 0; corner < 3; corner++) {
            uint32_t vertex = built->vertices[built->indices[3 * n + corner]];
            uint32_t u = vertex & 0xffff;
            uint32_t v = vertex >> 16;
            uint32_t w = GIRIH_BARYCENTRIC_ONE - u - v;
            keys[n][corner] = fixed < 0 ? vertex : fixed == 1 ? (w | v << 16) : (v | u << 16);
        }
        qsort(keys[n], 3, sizeof keys[n][0], compare_positions);
    }
    qsort(keys, built->triangle_count, sizeof *keys, compare_keys);
    return keys;
}

// Two equal levels: the two halves are stitched alike, but for what lies across the axis itself.
static void test_equal_edges_are_stitched_alike(void **state) {
    (void)state;
    for (uint32_t i = 1; i <= 6; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++) {
                if (i != j && j != k) {
                    continue;
                }
                girih_pattern built = build(1u << i, 1u << j, 1u << k);
                uint32_t(*keys)[3] = triangle_keys(&built, -1);
                uint32_t(*mirrored)[3] = triangle_keys(&built, i == j ? 1 : 2);
                uint32_t alone = 0;
                for (uint32_t n = 0; n < built.triangle_count; n++) {
                    alone += bsearch(keys[n], mirrored, built.triangle_count, sizeof *mirrored,
                                     compare_keys) == NULL;
                }
                assert_true(alone <= 2);
                free(keys);
                free(mirrored);
                girih_pattern_free(&built);
            }
        }
    }
}

static void test_same_pattern_twice(void **state) {
    (void)state;
    girih_pattern first = build(11, 7, 3);
    girih_pattern second = build(11, 7, 3);
    assert_memory_equal(first.vertices, second.vertices,
                        first.vertex_count * sizeof *first.vertices);
    assert_memory_equal(first.indices, second.indices,
                        (size_t)first.triangle_count * 3 * sizeof *first.indices);
    girih_pattern_free(&first);
    girih_pattern_free(&second);
}

static void assert_broken(const girih_pattern *built, const char *law) {
    girih_error error = {.message = ""};
    assert_int_equal(check(built, &error), GIRIH_ERROR_INVALID_DATA);
    assert_non_null(strstr(error.message, law));
}

// The inner vertex farthest from P1.
static uint32_t farthest_from_p1(const girih_pattern *built) {
    uint32_t farthest = built->vertex_count - 1;
    const uint32_t border = girih_border_count(built->segments);
    for (uint32_t vertex = border; vertex < built->vertex_count; vertex++) {
        if ((built->vertices[vertex] & 0xffff) < (built->vertices[farthest] & 0xffff)) {
            farthest = vertex;
        }
    }
    return farthest;
}

// The laws are worth what they refuse.
static void test_broken_patterns_are_refused(void **state) {
    (void)state;
    girih_pattern built = build(8, 4, 1);
    uint32_t kept = built.vertices[3];
    built.vertices[3] += 1;
    assert_broken(&built, "border vertex");
    built.vertices[3] = kept;

    kept = built.vertices[0];
    built.vertices[0] = built.vertices[1];
    assert_broken(&built, "corner");
    built.vertices[0] = kept;

    uint32_t far = farthest_from_p1(&built);
    kept = built.vertices[far];
    built.vertices[far] = built.vertices[far - 1];
    assert_broken(&built, "coincide");
    built.vertices[far] = (GIRIH_BARYCENTRIC_ONE - 2) | 1u << 16;
    assert_broken(&built, "degenerate or turned over");
    built.vertices[far] = kept;

    built.triangle_count--;
    assert_broken(&built, "add up to the whole");
    built.triangle_count++;

    kept = built.indices[0];
    built.indices[0] = built.vertex_count;
    assert_broken(&built, "beyond its vertices");
    built.indices[0] = built.indices[1];
    built.indices[1] = kept;
    assert_broken(&built, "degenerate or turned over");
    built.indices[1] = built.indices[0];
    built.indices[0] = kept;

    assert_lawful_pattern(&built);
    girih_pattern_free(&built);

    // Edge 1 in two segments (its middle is vertex 3), and vertex 4 inside.
    const uint32_t one = GIRIH_BARYCENTRIC_ONE;
    uint32_t vertices[] = {one, one << 16, 0, one / 2 | one / 2 << 16, one / 4 | one / 4 << 16};
    uint32_t sound[] = {0, 3, 4, 3, 1, 4, 1, 2, 4, 2, 0, 4};
    girih_pattern small = {.segments = {2, 1, 1},
                           .vertex_count = 5,
                           .triangle_count = 4,
                           .vertices = vertices,
                           .indices = sound};
    assert_lawful_pattern(&small);

    // The border's middle left out.
    uint32_t skipped[] = {0, 1, 4, 1, 2, 4, 2, 0, 4};
    small.indices = skipped;
    small.triangle_count = 3;
    assert_broken(&small, "in no triangle");

    // Vertex 4 lies on the line from 3 to P3, whose other side does not know it: the areas are
    // right, the edges are not.
    uint32_t hanging[] = {0, 3, 4, 0, 4, 2, 3, 1, 2};
    small.indices = hanging;
    assert_broken(&small, "shared by two triangles");
}

// The sorted levels of a permuted triangle; edge n joins the corners n and n + 1.
static int serves(uint32_t corners, const uint32_t levels[3], const uint32_t sorted[3]) {
    for (uint32_t n = 0; n < 3; n++) {
        uint32_t a = corners >> 2 * n & 3;
        uint32_t b = corners >> 2 * ((n + 1) % 3) & 3;
        uint32_t edge = (a + 1) % 3 == b ? a : b;
        if (levels[edge] != sorted[n]) {
            return 0;
        }
    }
    return 1;
}

static int is_odd(uint32_t corners) {
    uint32_t a = corners & 3;
    uint32_t b = corners >> 2 & 3;
    return (a + 1) % 3 != b;
}

// ARKFPI, Figure 8.
static uint32_t figure_8(uint32_t levels[3]) {
    static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    uint32_t lambda = 0;
    for (int n = 0; n < 3; n++) {
        uint32_t *a = &levels[pairs[n][0]];
        uint32_t *b = &levels[pairs[n][1]];
        if (*a < *b) {
            uint32_t kept = *a;
            *a = *b;
            *b = kept;
            lambda += 1u << n;
        }
    }
    return lambda;
}

static void assert_lambda(const uint32_t levels[3]) {
    uint32_t sorted[3] = {levels[0], levels[1], levels[2]};
    uint32_t lambda = figure_8(sorted);
    assert_int_not_equal(lambda, 3);

    // Every permutation of the corners that serves, by search.
    uint32_t found[2][6];
    uint32_t count[2] = {0, 0};
    for (uint32_t corners = 0; corners < 64; corners++) {
        uint32_t a = corners & 3;
        uint32_t b = corners >> 2 & 3;
        uint32_t c = corners >> 4;
        if (a < 3 && b < 3 && c < 3 && a != b && b != c && c != a &&
            serves(corners, levels, sorted)) {
            int odd = is_odd(corners);
            found[odd][count[odd]++] = corners;
        }
    }
    uint32_t used = GIRIH_LAMBDA_CORNERS(lambda);
    uint32_t odd = GIRIH_LAMBDA_IS_ODD(lambda);
    assert_int_equal(odd, is_odd(used));
    assert_true(serves(used, levels, sorted));
    int known = 0;
    for (uint32_t n = 0; n < count[odd]; n++) {
        known = known || found[odd][n] == used;
    }
    assert_true(known);
    for (uint32_t n = 0; n < 3; n++) {
        uint32_t edge = GIRIH_LAMBDA_EDGES(lambda) >> 2 * n & 3;
        assert_int_equal(levels[edge], sorted[n]);
    }

    int equal_ij = sorted[0] == sorted[1];
    int equal_jk = sorted[1] == sorted[2];
    if (!equal_ij && !equal_jk) {
        assert_int_equal(count[0] + count[1], 1);
        return;
    }
    uint32_t even = GIRIH_LAMBDA_EVEN(lambda);
    assert_true(count[0] > 0);
    assert_false(GIRIH_LAMBDA_IS_ODD(even));
    assert_true(serves(GIRIH_LAMBDA_CORNERS(even), levels, sorted));
    if (equal_ij) {
        uint32_t mirrored = GIRIH_LAMBDA_ODD_IJ(even);
        assert_true(mirrored == 1 || mirrored == 2 || mirrored == 4);
        assert_true(GIRIH_LAMBDA_IS_ODD(mirrored));
        assert_true(serves(GIRIH_LAMBDA_CORNERS(mirrored), levels, sorted));
    }
    if (equal_jk) {
        uint32_t mirrored = GIRIH_LAMBDA_ODD_JK(even);
        assert_true(mirrored == 1 || mirrored == 2 || mirrored == 4);
        assert_true(GIRIH_LAMBDA_IS_ODD(mirrored));
        assert_true(serves(GIRIH_LAMBDA_CORNERS(mirrored), levels, sorted));
    }
}

// All triples of levels 0..4, as the paper's tables, and of 0..8.
static void test_lambda(void **state) {
    (void)state;
    uint32_t replaced = 0;
    for (uint32_t n = 0; n < 9 * 9 * 9; n++) {
        const uint32_t levels[3] = {n / 81, n / 9 % 9, n % 9};
        assert_lambda(levels);
        uint32_t sorted[3] = {levels[0], levels[1], levels[2]};
        uint32_t lambda = figure_8(sorted);
        if (levels[0] < 5 && levels[1] < 5 && levels[2] < 5 &&
            (sorted[0] == sorted[1] || sorted[1] == sorted[2])) {
            replaced += GIRIH_LAMBDA_EVEN(lambda) != lambda;
        }
    }
    assert_int_equal(replaced, 30);
}

// Where a base-pattern vertex (u, v, w) is placed: P1 a + P2 b + P3 c.
static void test_lambda_places_weights(void **state) {
    (void)state;
    static const char *const places[8] = {"uvw", "wvu", "uwv", "uvw", "vuw", "wuv", "vwu", "uwv"};
    for (uint32_t lambda = 0; lambda < 8; lambda++) {
        const uint32_t corners[3] = {GIRIH_LAMBDA_CORNER_1(lambda), GIRIH_LAMBDA_CORNER_2(lambda),
                                     GIRIH_LAMBDA_CORNER_3(lambda)};
        const uint32_t edges[3] = {GIRIH_LAMBDA_EDGE_1(lambda), GIRIH_LAMBDA_EDGE_2(lambda),
                                   GIRIH_LAMBDA_EDGE_3(lambda)};
        for (int n = 0; n < 3; n++) {
            assert_int_equal(places[lambda][corners[n]], "uvw"[n]);
            assert_int_equal(GIRIH_LAMBDA_CORNERS(lambda) >> 2 * n & 3, corners[n]);
            assert_int_equal(GIRIH_LAMBDA_EDGES(lambda) >> 2 * n & 3, edges[n]);
        }
    }
    assert_int_equal(GIRIH_LAMBDA_ODD, 1u << 1 | 1u << 2 | 1u << 4 | 1u << 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_base_pattern_count),
        cmocka_unit_test(test_linear_laws),
        cmocka_unit_test(test_dyadic_laws),
        cmocka_unit_test(test_uneven_laws),
        cmocka_unit_test(test_edges_read_the_same_from_both_ends),
        cmocka_unit_test(test_equal_levels_are_the_regular_grid),
        cmocka_unit_test(test_equal_edges_are_stitched_alike),
        cmocka_unit_test(test_same_pattern_twice),
        cmocka_unit_test(test_broken_patterns_are_refused),
        cmocka_unit_test(test_lambda),
        cmocka_unit_test(test_lambda_places_weights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
