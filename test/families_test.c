// The families: laws, numbers of triangles, symmetry, angles, and small patterns known by hand.
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
#include "quality.h"

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
    static const uint32_t uneven[] = {1, 2, 3, 17, 31, 33, 65, 97, 128};
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
    return corner == 0 ? (u | w << 16) : corner == 1 ? (w | v << 16) : (v | u << 16);
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

// `across`: triangles across the axis may differ.
static void assert_mirrored(const girih_pattern *built, int corner, bool across) {
    assert_mirrored_vertices(built, corner);
    uint32_t(*keys)[3] = triangle_keys(built, false, corner);
    uint32_t(*others)[3] = triangle_keys(built, true, corner);
    for (uint32_t n = 0; n < built->triangle_count; n++) {
        bool found = bsearch(keys[n], others, built->triangle_count, sizeof *others, compare_keys);
        bool collapsed = keys[n][0] == keys[n][1] || keys[n][1] == keys[n][2];
        assert_true(found || collapsed || (across && is_across(keys[n], corner)));
    }
    free(others);
    free(keys);
}

static void assert_symmetric(const girih_family *family, const uint32_t segments[3]) {
    int corner = girih_symmetry_corner(segments);
    if (corner < 0) {
        return;
    }
    girih_pattern built = build(family, segments);
    assert_mirrored(&built, corner, true);
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
    // Not yet in an order for caches.
    girih_pattern built;
    assert_int_equal(family->build(family, segments, &built, NULL), GIRIH_OK);
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

// Sums over patterns.
typedef struct figures {
    uint32_t patterns;
    uint32_t triangles;
    double angles;
    double worst_angle;
} figures;

// One pattern of the family `optimal`, with all that holds for each.
static void take_optimal(const uint32_t segments[3], figures *sums) {
    girih_pattern built = build(&girih_family_optimal, segments);
    assert_lawful(&girih_family_optimal, &built);
    const uint32_t n = segments[0];
    assert_true(built.triangle_count <= n * n + girih_border_count(segments) - 3 * n);
    // [2,2,1] has a trapezium to cut in two, and three triangles are better than five.
    if (girih_symmetry_corner(segments) >= 0 && !(n == 2 && segments[1] == 2 && segments[2] == 1)) {
        // The centroid of a grid is symmetric about P3 alone.
        assert_mirrored(&built, segments[0] == segments[2] ? 2 : girih_symmetry_corner(segments), false);
    }
    girih_quality quality;
    assert_int_equal(girih_quality_measure(&built, &quality, NULL), GIRIH_OK);
    assert_true(quality.longest <= 0 || (quality.shortest >= 0.499 && quality.longest <= 2.001));
    const double angle = quality.angles[GIRIH_SHAPE_EQUILATERAL];
    assert_true(angle <= quality.bound + 0.1);
    sums->patterns++;
    sums->triangles += built.triangle_count;
    sums->angles += angle;
    sums->worst_angle = angle < sums->worst_angle ? angle : sums->worst_angle;
    girih_pattern_free(&built);
}

// The best table known before has 8,398 triangles, 18.0 degrees in the mean and 4.5 at worst.
static void test_optimal_is_better_than_known_tables(void **state) {
    (void)state;
    figures sums = {.worst_angle = 60};
    for (uint32_t i = 1; i <= 11; i++) {
        for (uint32_t j = 1; j <= i; j++) {
            for (uint32_t k = 1; k <= j; k++) {
                take_optimal((const uint32_t[3]){i, j, k}, &sums);
            }
        }
    }
    print_message("linear 1..11: %u triangles, smallest angles %.2f in the mean, %.2f at worst\n", sums.triangles,
                  sums.angles / sums.patterns, sums.worst_angle);
    assert_int_equal(sums.patterns, 286);
    assert_true(sums.triangles <= 8398);
    assert_true(sums.angles / sums.patterns >= 24);
    assert_true(sums.worst_angle >= 11);
}

static void test_optimal_dyadic(void **state) {
    (void)state;
    figures sums = {.worst_angle = 60};
    for (uint32_t i = 0; i <= 4; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++) {
                take_optimal((const uint32_t[3]){1u << i, 1u << j, 1u << k}, &sums);
            }
        }
    }
    assert_true(sums.angles / sums.patterns >= 24);
    assert_true(sums.worst_angle >= 10.5);
}

// The regular grid to within a unit, symmetric in all three ways, the centroid where everybody expects it.
static void test_optimal_grids(void **state) {
    (void)state;
    for (uint32_t n = 1; n <= 48; n++) {
        girih_pattern built = build(&girih_family_optimal, (const uint32_t[3]){n, n, n});
        assert_lawful(&girih_family_optimal, &built);
        assert_int_equal(built.triangle_count, n * n);
        uint32_t centroids = 0;
        for (uint32_t m = 0; m < built.vertex_count; m++) {
            const uint32_t u = built.vertices[m] & 0xffff;
            const uint32_t v = built.vertices[m] >> 16;
            const uint32_t weights[3] = {u, v, GIRIH_BARYCENTRIC_ONE - u - v};
            for (int corner = 0; corner < 3; corner++) {
                const uint32_t step = (weights[corner] * n + GIRIH_BARYCENTRIC_ONE / 2) / GIRIH_BARYCENTRIC_ONE;
                const double exact = (double)step * GIRIH_BARYCENTRIC_ONE / n;
                assert_true(weights[corner] <= exact + 1 && weights[corner] >= exact - 1);
            }
            centroids += u == 10923 && v == 10923;
        }
        assert_int_equal(centroids, n % 3 == 0);
        // The centroid's three weights cannot be equal; all else is symmetric in every way.
        for (int corner = 0; corner < 3 && n % 3 != 0; corner++) {
            assert_mirrored(&built, corner, false);
        }
        girih_pattern_free(&built);
    }
}

static void test_optimal_is_the_same_twice(void **state) {
    (void)state;
    const uint32_t segments[3] = {19, 7, 4};
    girih_pattern first = build(&girih_family_optimal, segments);
    girih_pattern second = build(&girih_family_optimal, segments);
    assert_int_equal(first.vertex_count, second.vertex_count);
    assert_int_equal(first.triangle_count, second.triangle_count);
    assert_memory_equal(first.vertices, second.vertices, first.vertex_count * sizeof *first.vertices);
    assert_memory_equal(first.indices, second.indices, (size_t)first.triangle_count * 3 * sizeof *first.indices);
    girih_pattern_free(&first);
    girih_pattern_free(&second);
}

static void test_names(void **state) {
    (void)state;
    assert_ptr_equal(girih_family_at(0), &girih_family_optimal);
    assert_ptr_equal(girih_family_find("optimal"), &girih_family_optimal);
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
        cmocka_unit_test(test_optimal_is_better_than_known_tables),
        cmocka_unit_test(test_optimal_dyadic),
        cmocka_unit_test(test_optimal_grids),
        cmocka_unit_test(test_optimal_is_the_same_twice),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
