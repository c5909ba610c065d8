// Parents, where vertices go as a pattern fades into the next coarser one: their laws in all
// families.
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "catalogue_files.h"
#include "laws.h"
#include "parent_laws.h"
#include "parents.h"
#include "parents_table.h"
#include "symmetry.h"

// The parents of all vertices of one edge: in order, alike from both ends, each a vertex of the
// coarser edge and each of these a parent; alone the middle stays where the coarser edge has none
// there.
static void assert_edge(uint32_t n, uint32_t coarser) {
    uint32_t before = 0;
    uint32_t reached = 0;
    for (uint32_t m = 0; m <= n; m++) {
        const uint32_t parent = girih_border_parent(m, n, coarser);
        uint32_t k = 0;
        while (k <= coarser && girih_edge_parameter(k, coarser) != parent) {
            k++;
        }
        const bool stays = 2 * m == n && coarser % 2 == 1;
        assert_int_equal(k > coarser, stays);
        assert_true(!stays || parent == girih_edge_parameter(m, n));
        assert_true(stays || k == reached || (m > 0 && k == reached + 1));
        reached = stays ? reached : k;
        assert_true(parent >= before);
        before = parent;
        assert_int_equal(parent + girih_border_parent(n - m, n, coarser), GIRIH_BARYCENTRIC_ONE);
    }
    assert_int_equal(girih_border_parent(0, n, coarser), 0);
    assert_int_equal(reached, coarser);
}

static void test_edges(void **state) {
    (void)state;
    assert_edge(1, 1);
    for (uint32_t n = 2; n <= 256; n++) {
        assert_edge(n, n - 1);
    }
    for (uint32_t n = 2; n <= 32768; n *= 2) {
        assert_edge(n, n / 2);
    }
    // Those halfway go towards the ends.
    assert_int_equal(girih_border_parent(3, 8, 4), 8192);
    assert_int_equal(girih_border_parent(5, 8, 4), 24576);
}

static void assert_result(girih_result result, const girih_error *error) {
    assert_string_equal(error->message, "");
    assert_int_equal(result, GIRIH_OK);
}

static bool has_vertex(const girih_catalogue *catalogue, uint32_t rank, uint32_t place) {
    const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
    const uint32_t *vertices = girih_catalogue_vertices(catalogue, pattern);
    uint32_t n = 0;
    while (n < pattern->vertex_count && vertices[n] != place) {
        n++;
    }
    return n < pattern->vertex_count;
}

// Those inside that stay where the coarser pattern has no vertex are on an axis or at the centre.
static void assert_staying_on_axes(const girih_catalogue *catalogue, uint32_t rank) {
    const girih_base_pattern *entry = girih_catalogue_pattern(catalogue, rank);
    const uint32_t coarser = girih_coarser_rank(entry);
    const uint32_t *parents = girih_catalogue_parents(catalogue, entry);
    girih_pattern fine;
    girih_symmetry symmetry;
    assert_int_equal(girih_pattern_read(catalogue, rank, &fine, NULL), GIRIH_OK);
    assert_int_equal(girih_symmetry_find(&fine, &symmetry, NULL), GIRIH_OK);
    for (uint32_t n = girih_border_count(fine.segments); n < fine.vertex_count; n++) {
        bool on_axis = false;
        for (uint32_t m = 1; m < symmetry.count; m++) {
            on_axis = on_axis || symmetry.images[m][n] == n;
        }
        assert_true(on_axis || has_vertex(catalogue, coarser, parents[n]));
    }
    girih_symmetry_free(&symmetry);
    girih_pattern_free(&fine);
}

static void assert_lawful(const girih_catalogue *catalogue) {
    girih_error error = {.message = ""};
    girih_parent_figures figures;
    assert_result(girih_parent_laws_check_catalogue(catalogue, &error), &error);
    assert_result(girih_parents_measure_catalogue(catalogue, &figures, &error), &error);
    uint64_t middles = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        for (int edge = 0; edge < 3; edge++) {
            const uint32_t n = pattern->segments[edge];
            middles += catalogue->spacing == GIRIH_SPACING_LINEAR ? n % 2 == 0 : n == 2;
        }
        assert_staying_on_axes(catalogue, rank);
    }
    assert_int_equal(figures.staying_middles, middles);
    assert_int_equal(figures.uneven_patterns, 0);
    assert_true(figures.staying_patterns * 5 < catalogue->pattern_count);
    assert_true(figures.childless * 50 < catalogue->vertex_count);
    assert_true(figures.farthest < (int64_t)GIRIH_BARYCENTRIC_ONE * GIRIH_BARYCENTRIC_ONE / 2);
}

static void test_families(void **state) {
    (void)state;
    assert_lawful(girih_catalogue_dyadic());
    assert_lawful(girih_catalogue_linear());
    for (uint32_t n = 0; girih_family_at(n); n++) {
        const girih_family *family = girih_family_at(n);
        const bool slow = family == &girih_family_optimal;
        block dyadic = write_catalogue(family, GIRIH_SPACING_DYADIC, slow ? 3 : 5);
        block linear = write_catalogue(family, GIRIH_SPACING_LINEAR, 8);
        assert_lawful(dyadic.bytes);
        assert_lawful(linear.bytes);
        free(linear.bytes);
        free(dyadic.bytes);
    }
}

// Two patterns and the finer one's parents.
typedef struct pair {
    girih_pattern fine;
    girih_pattern coarse;
    uint32_t *parents;
} pair;

static void find_parents(pair *p) {
    girih_error error = {.message = ""};
    p->parents = malloc(p->fine.vertex_count * sizeof *p->parents);
    assert_non_null(p->parents);
    assert_result(girih_parents_find(&p->fine, &p->coarse, p->parents, &error), &error);
}

static pair build_pair(const uint32_t fine[3], const uint32_t coarse[3]) {
    pair p;
    const girih_family *family = &girih_family_uniform;
    assert_int_equal(girih_pattern_build(family, fine, &p.fine, NULL), GIRIH_OK);
    assert_int_equal(girih_pattern_build(family, coarse, &p.coarse, NULL), GIRIH_OK);
    find_parents(&p);
    return p;
}

static void free_pair(pair *p) {
    girih_pattern_free(&p->fine);
    girih_pattern_free(&p->coarse);
    free(p->parents);
}

static girih_result check(const pair *p, girih_error *error) {
    return girih_parent_laws_check(&p->fine, &p->coarse, p->parents, error);
}

// The centroid, which has nowhere to go.
static void test_centroid_stays(void **state) {
    (void)state;
    pair p = build_pair((const uint32_t[3]){3, 3, 3}, (const uint32_t[3]){2, 2, 2});
    assert_int_equal(p.fine.vertex_count, 10);
    assert_int_equal(p.parents[9], p.fine.vertices[9]);
    assert_int_equal(check(&p, NULL), GIRIH_OK);
    free_pair(&p);
}

// Changes one parent, and expects to be told.
static void assert_broken(pair *p, uint32_t vertex, uint32_t parent, const char *words) {
    girih_error error = {.message = ""};
    const uint32_t kept = p->parents[vertex];
    assert_int_not_equal(kept, parent);
    p->parents[vertex] = parent;
    assert_int_equal(check(p, &error), GIRIH_ERROR_INVALID_DATA);
    assert_non_null(strstr(error.message, words));
    p->parents[vertex] = kept;
    assert_int_equal(check(p, NULL), GIRIH_OK);
}

static void test_broken_laws_are_found(void **state) {
    (void)state;
    pair p = build_pair((const uint32_t[3]){8, 6, 5}, (const uint32_t[3]){7, 5, 4});
    const uint32_t inner = girih_border_count(p.fine.segments);
    assert_broken(&p, 0, p.coarse.vertices[3], "border");
    assert_broken(&p, 4, p.coarse.vertices[6], "border");
    assert_broken(&p, 6, p.coarse.vertices[5], "border");
    assert_broken(&p, inner, p.parents[inner] + 1, "no vertex of the coarser");
    assert_broken(&p, inner,
                  p.coarse.vertices[0] == p.parents[inner] ? p.coarse.vertices[1]
                                                           : p.coarse.vertices[0],
                  "turn a triangle over");
    free_pair(&p);
}

// 3, 3 and 2 segments around one vertex on the axis, but for the corner P2, which is cut off. The
// cut moves beyond the vertex, and the coarser pattern has no other vertex on the axis than P2: the
// symmetry is lost, the other laws hold.
static void test_fallback(void **state) {
    (void)state;
    const uint32_t fan[8][3] = {{0, 3, 8}, {3, 4, 8}, {4, 5, 8}, {5, 6, 8},
                                {6, 2, 8}, {2, 7, 8}, {7, 0, 8}, {4, 1, 5}};
    pair p;
    assert_int_equal(girih_pattern_allocate(&p.fine, (const uint32_t[3]){3, 3, 2}, 9, 8, NULL),
                     GIRIH_OK);
    p.fine.vertices[8] = girih_pack_vertex(6384, 20000);
    memcpy(p.fine.indices, fan, sizeof fan);
    assert_int_equal(girih_laws_check_pattern(p.fine.segments, p.fine.vertices, 9, p.fine.indices,
                                              8, false, NULL),
                     GIRIH_OK);
    assert_int_equal(
        girih_pattern_build(&girih_family_uniform, (const uint32_t[3]){2, 2, 1}, &p.coarse, NULL),
        GIRIH_OK);
    find_parents(&p);
    assert_int_equal(check(&p, NULL), GIRIH_OK);
    girih_parent_figures figures = {.childless = 0};
    assert_int_equal(girih_parents_measure(&p.fine, &p.coarse, p.parents, 0, &figures, NULL),
                     GIRIH_OK);
    assert_int_equal(figures.uneven_patterns, 1);
    assert_int_equal(figures.staying_inside, 0);
    assert_int_equal(figures.staying_middles, 1);
    free_pair(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edges),          cmocka_unit_test(test_families),
        cmocka_unit_test(test_centroid_stays), cmocka_unit_test(test_broken_laws_are_found),
        cmocka_unit_test(test_fallback),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
