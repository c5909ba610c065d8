// The families after papers: laws, numbers of triangles, symmetry, and small patterns known by
// hand.
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "family.h"
#include "girih/catalogue.h"
#include "laws.h"

static girih_pattern build(const girih_family *family, const uint32_t segments[3]) {
    girih_pattern built;
    girih_error error = {.message = ""};
    girih_result result = girih_pattern_build(family, segments, &built, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
    return built;
}

static girih_result check(const girih_pattern *built, bool collapses, girih_error *error) {
    return girih_laws_check_pattern(built->segments, built->vertices, built->vertex_count,
                                    built->indices, built->triangle_count, collapses, error);
}

static void assert_lawful(const girih_family *family, const girih_pattern *built) {
    girih_error error = {.message = ""};
    girih_result result = check(built, family->collapses, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
}

// Sorted triples of counts: linear ones, dyadic ones, and some that differ much.
static void for_each_triple(void (*visit)(const uint32_t segments[3])) {
    static const uint32_t uneven[] = {1, 2, 3, 17, 31, 33, 64, 65, 97, 127, 128};
    uint32_t counts[3][16];
    const uint32_t sizes[3] = {16, 7, sizeof uneven / sizeof *uneven};
    for (uint32_t n = 0; n < 16; n++) {
        counts[0][n] = n + 1;
        counts[1][n] = 1u << n;
        counts[2][n] = n < sizes[2] ? uneven[n] : 0;
    }
    for (uint32_t set = 0; set < 3; set++) {
        for (uint32_t i = 0; i < sizes[set]; i++) {
            for (uint32_t j = 0; j <= i; j++) {
                for (uint32_t k = 0; k <= j; k++) {
                    visit((const uint32_t[3]){counts[set][i], counts[set][j], counts[set][k]});
                }
            }
        }
    }
}

// Triangles of a quad part of so many strips, whose lines go from `first` to `last` segments in the
// nearest whole numbers: what one line rounds down another one rounds up, but for halves.
static uint32_t quad_triangles(uint32_t strips, uint32_t first, uint32_t last) {
    uint32_t count = strips * (first + last);
    uint32_t change = first > last ? first - last : last - first;
    for (uint32_t line = 1; line < strips; line++) {
        count += 2 * change * line % (2 * strips) == strips;
    }
    return count;
}

static uint32_t quadtri_triangles(const uint32_t segments[3]) {
    const uint32_t i = segments[0];
    const uint32_t j = segments[1];
    const uint32_t k = segments[2];
    if (i > j && j == k) {
        return (j / 2) * (j / 2) + quad_triangles(j - j / 2, i, j / 2);
    }
    return k * k + quad_triangles(k, j - k, i - k);
}

static void assert_quadtri(const uint32_t segments[3]) {
    girih_pattern built = build(&girih_family_quadtri, segments);
    assert_lawful(&girih_family_quadtri, &built);
    assert_int_equal(built.triangle_count, quadtri_triangles(segments));
    girih_pattern_free(&built);
}

static void test_quadtri_laws(void **state) {
    (void)state;
    for_each_triple(assert_quadtri);
}

static uint32_t count_collapsed(const girih_pattern *built) {
    uint32_t count = 0;
    for (size_t n = 0; n < (size_t)built->triangle_count * 3; n += 3) {
        const uint32_t *corners = built->indices + n;
        count += corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    }
    return count;
}

static void assert_semiuniform(const uint32_t segments[3]) {
    girih_pattern built = build(&girih_family_semiuniform, segments);
    assert_lawful(&girih_family_semiuniform, &built);
    assert_int_equal(built.triangle_count, segments[0] * segments[0]);
    uint32_t collapsed = 3 * segments[0] - girih_border_count(segments);
    assert_int_equal(count_collapsed(&built), collapsed);
    girih_error error;
    assert_int_equal(check(&built, false, &error),
                     collapsed > 0 ? GIRIH_ERROR_INVALID_DATA : GIRIH_OK);
    girih_pattern_free(&built);
}

static void test_semiuniform_laws(void **state) {
    (void)state;
    for_each_triple(assert_semiuniform);
}

static int compare_numbers(const void *a, const void *b) {
    uint32_t left = *(const uint32_t *)a;
    uint32_t right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

static int compare_keys(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

static uint32_t mirrored(uint32_t vertex, int corner) {
    uint32_t u = vertex & 0xffff;
    uint32_t v = vertex >> 16;
    uint32_t w = GIRIH_BARYCENTRIC_ONE - u - v;
    return corner == 1 ? (w | v << 16) : (v | u << 16);
}

// Triangles by the sorted positions of their corners, in sorted order.
static uint32_t (*triangle_keys(const girih_pattern *built, bool mirror, int corner))[3] {
    uint32_t(*keys)[3] = malloc(built->triangle_count * sizeof *keys);
    assert_non_null(keys);
    for (size_t n = 0; n < (size_t)built->triangle_count * 3; n++) {
        uint32_t vertex = built->vertices[built->indices[n]];
        keys[n / 3][n % 3] = mirror ? mirrored(vertex, corner) : vertex;
    }
    for (size_t n = 0; n < built->triangle_count; n++) {
        qsort(keys[n], 3, sizeof keys[n][0], compare_numbers);
    }
    qsort(keys, built->triangle_count, sizeof *keys, compare_keys);
    return keys;
}

// Whether a triangle has corners on both sides of the axis through a corner.
static bool is_across(const uint32_t key[3], int corner) {
    bool before = false;
    bool behind = false;
    for (int n = 0; n < 3; n++) {
        uint32_t here = key[n];
        uint32_t there = mirrored(here, corner);
        before = before || (here & 0xffff) < (there & 0xffff);
        behind = behind || (here & 0xffff) > (there & 0xffff);
    }
    return before && behind;
}

static void assert_mirrored_vertices(const girih_pattern *built, int corner) {
    size_t size = built->vertex_count * sizeof(uint32_t);
    uint32_t *here = malloc(size);
    uint32_t *there = malloc(size);
    assert_non_null(here);
    assert_non_null(there);
    for (uint32_t n = 0; n < built->vertex_count; n++) {
        here[n] = built->vertices[n];
        there[n] = mirrored(here[n], corner);
    }
    qsort(here, built->vertex_count, sizeof *here, compare_numbers);
    qsort(there, built->vertex_count, sizeof *there, compare_numbers);
    assert_memory_equal(here, there, size);
    free(there);
    free(here);
}

static void assert_symmetric(const girih_family *family, const uint32_t segments[3]) {
    int corner = girih_symmetry_corner(segments);
    if (corner < 0) {
        return;
    }
    girih_pattern built = build(family, segments);
    assert_mirrored_vertices(&built, corner);
    uint32_t(*keys)[3] = triangle_keys(&built, false, corner);
    uint32_t(*others)[3] = triangle_keys(&built, true, corner);
    for (uint32_t n = 0; n < built.triangle_count; n++) {
        bool found = bsearch(keys[n], others, built.triangle_count, sizeof *others, compare_keys);
        bool collapsed = keys[n][0] == keys[n][1] || keys[n][1] == keys[n][2];
        assert_true(found || collapsed || is_across(keys[n], corner));
    }
    free(others);
    free(keys);
    girih_pattern_free(&built);
}

static void assert_quadtri_symmetric(const uint32_t segments[3]) {
    assert_symmetric(&girih_family_quadtri, segments);
}

static void assert_semiuniform_symmetric(const uint32_t segments[3]) {
    assert_symmetric(&girih_family_semiuniform, segments);
}

// Two equal levels: mirrored vertices, and mirrored triangles but for those across the axis.
static void test_equal_edges_are_filled_alike(void **state) {
    (void)state;
    for_each_triple(assert_quadtri_symmetric);
    for_each_triple(assert_semiuniform_symmetric);
}

static bool has_triangle(const girih_pattern *built, const uint32_t corners[3]) {
    for (size_t n = 0; n < (size_t)built->triangle_count * 3; n += 3) {
        const uint32_t *found = built->indices + n;
        for (uint32_t turn = 0; turn < 3; turn++) {
            if (found[0] == corners[turn] && found[1] == corners[(turn + 1) % 3] &&
                found[2] == corners[(turn + 2) % 3]) {
                return true;
            }
        }
    }
    return false;
}

static void assert_triangles(const girih_family *family, const uint32_t segments[3],
                             uint32_t vertex_count, const uint32_t (*expected)[3], uint32_t count) {
    girih_pattern built = build(family, segments);
    assert_int_equal(built.vertex_count, vertex_count);
    assert_int_equal(built.triangle_count - count_collapsed(&built), count);
    for (uint32_t n = 0; n < count; n++) {
        assert_true(has_triangle(&built, expected[n]));
    }
    girih_pattern_free(&built);
}

// Knuth et al. 2010. Of [2,2,1], vertex 3 is in the middle of P1P2 and 4 of P2P3.
static void test_small_quadtri_patterns(void **state) {
    (void)state;
    const girih_family *family = &girih_family_quadtri;
    const uint32_t ladder[][3] = {{1, 4, 3}, {4, 2, 0}, {4, 0, 3}};
    assert_triangles(family, (const uint32_t[3]){2, 2, 1}, 5, ladder, 3);

    // Figure 5: tip of one triangle, a quad of one strip with one segment at the left, two at the
    // right.
    const uint32_t split[][3] = {{1, 5, 4}, {2, 0, 3}, {2, 3, 5}, {3, 4, 5}};
    assert_triangles(family, (const uint32_t[3]){3, 2, 1}, 6, split, 4);

    // Figure 6: the quad on the high edge; 6 and 7 are the middles of the low ones.
    const uint32_t turned[][3] = {{2, 7, 6}, {1, 6, 5}, {5, 6, 4}, {4, 6, 7}, {4, 7, 3}, {3, 7, 0}};
    assert_triangles(family, (const uint32_t[3]){4, 2, 2}, 8, turned, 6);

    const uint32_t fan[][3] = {{0, 3, 2}, {3, 4, 2}, {4, 1, 2}};
    assert_triangles(family, (const uint32_t[3]){3, 1, 1}, 5, fan, 3);
}

// Figure 4 of Knuth et al.: a thin triangle has the quad's ladder below one triangle, where the
// semi-uniform grid has n^2.
static void test_thin_triangles_have_few(void **state) {
    (void)state;
    const uint32_t segments[3] = {64, 64, 1};
    girih_pattern quadtri = build(&girih_family_quadtri, segments);
    girih_pattern semiuniform = build(&girih_family_semiuniform, segments);
    assert_int_equal(quadtri.vertex_count, 129);
    assert_int_equal(quadtri.triangle_count, 127);
    assert_int_equal(semiuniform.vertex_count, 2082);
    assert_int_equal(semiuniform.triangle_count, 4096);
    girih_pattern_free(&semiuniform);
    girih_pattern_free(&quadtri);
}

// Dyken et al. 2009. Vertices that lie between two go to the nearer end of the edge.
static void test_small_semiuniform_patterns(void **state) {
    (void)state;
    const girih_family *family = &girih_family_semiuniform;
    const uint32_t halved[][3] = {{0, 3, 2}, {3, 1, 2}};
    assert_triangles(family, (const uint32_t[3]){2, 1, 1}, 4, halved, 2);

    const uint32_t middle[][3] = {{0, 3, 2}, {3, 1, 4}, {3, 4, 2}};
    assert_triangles(family, (const uint32_t[3]){2, 2, 1}, 5, middle, 3);

    // 6 is in the middle of P2P3, and 7, 8, 9 are inside: at 2, 1, 1 quarters from P1, P2, P3.
    const uint32_t snapped[][3] = {{0, 3, 7}, {3, 4, 7}, {4, 8, 7}, {4, 5, 8}, {5, 1, 8}, {1, 6, 8},
                                   {7, 8, 9}, {8, 6, 9}, {6, 2, 9}, {2, 0, 7}, {2, 7, 9}};
    assert_triangles(family, (const uint32_t[3]){4, 2, 1}, 10, snapped, 11);
}

// A triangle without area must not join what nothing else joins.
static void test_false_joints_are_refused(void **state) {
    (void)state;
    const uint32_t one = GIRIH_BARYCENTRIC_ONE;
    uint32_t vertices[] = {one, one << 16, 0, one / 2 | one / 2 << 16};
    uint32_t indices[] = {0, 1, 2, 0, 3, 1, 0, 0, 3, 1, 3, 3};
    girih_pattern built = {.segments = {2, 1, 1},
                           .vertex_count = 4,
                           .triangle_count = 4,
                           .vertices = vertices,
                           .indices = indices};
    girih_error error = {.message = ""};
    assert_int_equal(check(&built, true, &error), GIRIH_ERROR_INVALID_DATA);
    assert_non_null(strstr(error.message, "degenerate"));

    // Without it the border's vertex is in none but collapsed triangles.
    memcpy(indices + 3, indices + 6, 3 * sizeof *indices);
    assert_int_equal(check(&built, true, &error), GIRIH_ERROR_INVALID_DATA);
    assert_non_null(strstr(error.message, "in no triangle"));

    const uint32_t halved[] = {0, 3, 2, 3, 1, 2};
    memcpy(indices, halved, sizeof halved);
    assert_int_equal(check(&built, true, &error), GIRIH_OK);
}

static void test_names(void **state) {
    (void)state;
    assert_ptr_equal(girih_family_find("quadtri"), &girih_family_quadtri);
    assert_ptr_equal(girih_family_find("semiuniform"), &girih_family_semiuniform);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quadtri_laws),
        cmocka_unit_test(test_semiuniform_laws),
        cmocka_unit_test(test_equal_edges_are_filled_alike),
        cmocka_unit_test(test_small_quadtri_patterns),
        cmocka_unit_test(test_thin_triangles_have_few),
        cmocka_unit_test(test_small_semiuniform_patterns),
        cmocka_unit_test(test_false_joints_are_refused),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
