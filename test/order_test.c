// The order of triangles and inner vertices: still the same pattern, and few misses of a vertex
// cache.
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "family.h"
#include "laws.h"
#include "order.h"

static girih_pattern build(const girih_family *family, const uint32_t segments[3]) {
    girih_pattern pattern;
    girih_error error = {.message = ""};
    const girih_result result = family->build(family, segments, &pattern, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
    return pattern;
}

static void order(girih_pattern *pattern) {
    girih_error error = {.message = ""};
    const girih_result result = girih_pattern_order(pattern, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
}

static void assert_lawful(const girih_pattern *pattern, bool collapses) {
    girih_error error = {.message = ""};
    const girih_result result =
        girih_laws_check_pattern(pattern->segments, pattern->vertices, pattern->vertex_count,
                                 pattern->indices, pattern->triangle_count, collapses, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
}

static uint64_t misses(const girih_pattern *pattern) {
    return girih_cache_misses(pattern->indices, (size_t)pattern->triangle_count * 3,
                              pattern->vertex_count, GIRIH_CACHE_SIZE);
}

static int compare_keys(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

// Triangles by their corners' positions from the smallest on, in sorted order.
static uint32_t (*triangle_keys(const girih_pattern *pattern))[3] {
    uint32_t(*keys)[3] = malloc(pattern->triangle_count * sizeof *keys);
    assert_non_null(keys);
    for (size_t n = 0; n < pattern->triangle_count; n++) {
        uint32_t corners[3];
        size_t first = 0;
        for (size_t corner = 0; corner < 3; corner++) {
            corners[corner] = pattern->vertices[pattern->indices[3 * n + corner]];
            first = corners[corner] < corners[first] ? corner : first;
        }
        for (size_t corner = 0; corner < 3; corner++) {
            keys[n][corner] = corners[(first + corner) % 3];
        }
    }
    qsort(keys, pattern->triangle_count, sizeof *keys, compare_keys);
    return keys;
}

static void assert_same_triangles(const girih_pattern *a, const girih_pattern *b) {
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    uint32_t(*left)[3] = triangle_keys(a);
    uint32_t(*right)[3] = triangle_keys(b);
    assert_memory_equal(left, right, a->triangle_count * sizeof *left);
    free(left);
    free(right);
}

static void assert_same_bytes(const girih_pattern *a, const girih_pattern *b) {
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->vertices, b->vertices, a->vertex_count * sizeof *a->vertices);
    assert_memory_equal(a->indices, b->indices, (size_t)a->triangle_count * 3 * sizeof *a->indices);
}

static void assert_inner_vertices_by_first_use(const girih_pattern *pattern) {
    uint32_t next = girih_border_count(pattern->segments);
    for (size_t n = 0; n < (size_t)pattern->triangle_count * 3; n++) {
        assert_true(pattern->indices[n] <= next);
        next += pattern->indices[n] == next;
    }
    assert_int_equal(next, pattern->vertex_count);
}

// 1.15 times the vertices at most.
static void assert_few_misses(const girih_pattern *pattern) {
    if (pattern->triangle_count > 100) {
        assert_true(100 * misses(pattern) <= 115 * (uint64_t)pattern->vertex_count);
    }
}

static girih_pattern copy_of(const girih_pattern *pattern) {
    girih_pattern copy;
    assert_int_equal(girih_pattern_allocate(&copy, pattern->segments, pattern->vertex_count,
                                            pattern->triangle_count, NULL),
                     GIRIH_OK);
    memcpy(copy.vertices, pattern->vertices, pattern->vertex_count * sizeof *copy.vertices);
    memcpy(copy.indices, pattern->indices, (size_t)pattern->triangle_count * 3 * sizeof *copy.indices);
    return copy;
}

// The family that takes long has its large patterns measured in the built-in catalogues (quality_test).
static bool takes_long(const girih_family *family, uint32_t n) {
    return family == &girih_family_optimal && n > 12;
}

static void assert_well_ordered(const girih_family *family, uint32_t n1, uint32_t n2, uint32_t n3) {
    const uint32_t segments[3] = {n1, n2, n3};
    if (takes_long(family, n1)) {
        return;
    }
    girih_pattern built = build(family, segments);
    girih_pattern ordered = copy_of(&built);
    order(&ordered);
    // All laws' positions: corners and borders are where they were.
    assert_lawful(&ordered, family->collapses);
    assert_same_triangles(&built, &ordered);
    assert_inner_vertices_by_first_use(&ordered);
    assert_few_misses(&ordered);
    girih_pattern_free(&built);
    girih_pattern_free(&ordered);
}

static void test_cache_misses(void **state) {
    (void)state;
    const uint32_t strip[] = {0, 1, 2, 2, 1, 3, 2, 3, 4};
    assert_int_equal(girih_cache_misses(strip, 9, 5, 3), 5);
    assert_int_equal(girih_cache_misses(strip, 9, 5, 1), 8);
    assert_int_equal(girih_cache_misses(strip, 0, 5, 3), 0);
    // A hit keeps nothing longer: 0 leaves as 3 enters.
    const uint32_t first_out[] = {0, 1, 2, 0, 3, 0};
    assert_int_equal(girih_cache_misses(first_out, 6, 4, 3), 5);
    assert_int_equal(girih_cache_misses(first_out, 6, 4, 4), 4);
}

static void test_linear(void **state) {
    (void)state;
    for (uint32_t n = 0; girih_family_at(n); n++) {
        for (uint32_t i = 1; i <= 16; i++) {
            for (uint32_t j = 1; j <= i; j++) {
                for (uint32_t k = 1; k <= j; k++) {
                    assert_well_ordered(girih_family_at(n), i, j, k);
                }
            }
        }
    }
}

static void test_linear_above(void **state) {
    (void)state;
    for (uint32_t n = 0; girih_family_at(n); n++) {
        for (uint32_t i = 17; i <= 32; i += 3) {
            for (uint32_t j = 1; j <= i; j += 5) {
                for (uint32_t k = 1; k <= j; k += 5) {
                    assert_well_ordered(girih_family_at(n), i, j, k);
                }
            }
        }
    }
}

static void test_dyadic(void **state) {
    (void)state;
    for (uint32_t n = 0; girih_family_at(n); n++) {
        for (uint32_t i = 0; i <= 6; i++) {
            for (uint32_t j = 0; j <= i; j++) {
                for (uint32_t k = 0; k <= j; k++) {
                    assert_well_ordered(girih_family_at(n), 1u << i, 1u << j, 1u << k);
                }
            }
        }
    }
}

// Beyond 2^13 triangles fewer ways are tried.
static void test_large(void **state) {
    (void)state;
    assert_well_ordered(&girih_family_uniform, 128, 128, 128);
    assert_well_ordered(&girih_family_uniform, 128, 1, 1);
    assert_well_ordered(&girih_family_uniform, 256, 256, 256);
    assert_well_ordered(&girih_family_uniform, 256, 16, 1);
}

// A triangle whose corners all round to the last step of the grid, a corner.
static void test_crowded_corner(void **state) {
    (void)state;
    const uint32_t segments[3] = {1, 1, 1};
    girih_pattern pattern;
    assert_int_equal(girih_pattern_allocate(&pattern, segments, 5, 5, NULL), GIRIH_OK);
    pattern.vertices[3] = girih_pack_vertex(23000, 3000);
    pattern.vertices[4] = girih_pack_vertex(27000, 5000);
    static const uint32_t indices[] = {1, 2, 3, 2, 0, 3, 0, 1, 4, 1, 3, 4, 3, 0, 4};
    memcpy(pattern.indices, indices, sizeof indices);
    assert_lawful(&pattern, false);
    order(&pattern);
    assert_lawful(&pattern, false);
    assert_inner_vertices_by_first_use(&pattern);
    assert_int_equal(misses(&pattern), 5);
    girih_pattern_free(&pattern);
}

static void reverse_triangles(girih_pattern *pattern) {
    for (size_t n = 0; n < pattern->triangle_count / 2; n++) {
        uint32_t *a = pattern->indices + 3 * n;
        uint32_t *b = pattern->indices + 3 * (pattern->triangle_count - 1 - n);
        for (size_t corner = 0; corner < 3; corner++) {
            const uint32_t kept = a[corner];
            a[corner] = b[corner];
            b[corner] = kept;
        }
    }
}

static void test_same_bytes(void **state) {
    (void)state;
    const uint32_t segments[3] = {32, 7, 3};
    girih_pattern first = build(&girih_family_uniform, segments);
    girih_pattern second = build(&girih_family_uniform, segments);
    girih_pattern reversed = build(&girih_family_uniform, segments);
    reverse_triangles(&reversed);
    order(&first);
    order(&second);
    order(&reversed);
    assert_same_bytes(&first, &second);
    assert_same_bytes(&first, &reversed);
    girih_pattern_free(&first);
    girih_pattern_free(&second);
    girih_pattern_free(&reversed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cache_misses), cmocka_unit_test(test_linear),
        cmocka_unit_test(test_linear_above), cmocka_unit_test(test_dyadic),
        cmocka_unit_test(test_large),        cmocka_unit_test(test_crowded_corner),
        cmocka_unit_test(test_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
