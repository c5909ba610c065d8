// How patterns are measured: known angles, bounds, spacings and vertex caches.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "family.h"
#include "quality.h"
#include "spacing.h"

#define ONE GIRIH_BARYCENTRIC_ONE

static const uint32_t whole[3] = {ONE, ONE << 16, 0};

static void assert_near(double value, double expected, double tolerance) {
    if (!(fabs(value - expected) <= tolerance)) {
        print_error("%.9f, not %.9f\n", value, expected);
    }
    assert_true(fabs(value - expected) <= tolerance);
}

static girih_pattern build(uint32_t n1, uint32_t n2, uint32_t n3) {
    const uint32_t segments[3] = {n1, n2, n3};
    girih_pattern built;
    assert_int_equal(girih_pattern_build(&girih_family_uniform, segments, &built, NULL), GIRIH_OK);
    return built;
}

static double spacing_of(const uint32_t segments[3], const double weights[3]) {
    const girih_spacing_field field = girih_spacing_create(segments);
    return girih_spacing_at(&field, weights);
}

static girih_quality measure(const girih_pattern *pattern) {
    girih_quality quality;
    assert_int_equal(girih_quality_measure(pattern, &quality, NULL), GIRIH_OK);
    return quality;
}

// The whole has the angles of its shape, whichever corner is the apex and whichever corner it
// begins with.
static void test_angles_of_the_shapes(void **state) {
    (void)state;
    static const double expected[GIRIH_SHAPE_COUNT] = {60, 45, 5.7248104522, 30};
    static const char *const names[GIRIH_SHAPE_COUNT] = {"equilateral", "right", "thin", "obtuse"};
    for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
        assert_string_equal(girih_shape_name((girih_shape)shape), names[shape]);
        for (uint32_t apex = 0; apex < 3; apex++) {
            for (uint32_t first = 0; first < 3; first++) {
                const uint32_t turned[3] = {whole[first], whole[(first + 1) % 3],
                                            whole[(first + 2) % 3]};
                assert_near(girih_quality_angle((girih_shape)shape, apex, turned), expected[shape],
                            1e-9);
            }
        }
    }
}

static void test_angles_of_halves(void **state) {
    (void)state;
    const uint32_t half[3] = {ONE, ONE / 2 | ONE / 2 << 16, 0};
    assert_near(girih_quality_angle(GIRIH_SHAPE_EQUILATERAL, 0, half), 30, 1e-9);
    // Across the apex, half a right triangle is a right triangle again.
    assert_near(girih_quality_angle(GIRIH_SHAPE_RIGHT, 2, half), 45, 1e-9);
    // With the apex at an end of the halved edge, its legs are one twice as long as the other.
    assert_near(girih_quality_angle(GIRIH_SHAPE_RIGHT, 0, half), 26.5650511771, 1e-9);
    assert_near(girih_quality_angle(GIRIH_SHAPE_OBTUSE, 2, half), 30, 1e-9);
    const uint32_t turned[3] = {half[0], half[2], half[1]};
    assert_near(girih_quality_angle(GIRIH_SHAPE_EQUILATERAL, 0, turned), 30, 1e-9);
}

static void test_no_area_is_no_angle(void **state) {
    (void)state;
    const uint32_t flat[][3] = {
        {ONE, ONE, 0}, {0, 0, 0}, {ONE, ONE / 2 | ONE / 2 << 16, ONE << 16}, {ONE, 0, ONE / 4}};
    for (size_t n = 0; n < sizeof flat / sizeof *flat; n++) {
        for (uint32_t apex = 0; apex < 3; apex++) {
            for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
                assert_true(girih_quality_angle((girih_shape)shape, apex, flat[n]) == 0);
            }
        }
    }
}

static void test_corner_bound(void **state) {
    (void)state;
    for (uint32_t n = 1; n <= 128; n++) {
        assert_near(girih_quality_corner_bound(n, n), 60, 1e-9);
        assert_near(girih_quality_corner_bound(n, 2 * n), 30,
                    1e-9); // two triangles: apex 30, half the side
        assert_near(girih_quality_corner_bound(3, n), girih_quality_corner_bound(n, 3), 1e-12);
        // 2 and 3 to 1 have the same: two triangles, and the sides grow fast enough for either.
        assert_true(n == 1 ||
                    girih_quality_corner_bound(n, 1) < girih_quality_corner_bound(n - 1, 1) + 1e-9);
    }
}

static void bounds(girih_spacing spacing, uint32_t levels, double *mean, double *worst) {
    const girih_catalogue header = {.spacing = spacing};
    uint32_t count = 0;
    *mean = 0;
    *worst = 60;
    for (uint32_t i = 0; i < levels; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++, count++) {
                const uint32_t segments[3] = {girih_catalogue_segments(&header, i),
                                              girih_catalogue_segments(&header, j),
                                              girih_catalogue_segments(&header, k)};
                const double bound = girih_quality_bound(segments);
                *mean += bound;
                *worst = fmin(*worst, bound);
            }
        }
    }
    *mean /= count;
}

static void test_bounds_of_catalogues(void **state) {
    (void)state;
    double mean = 0;
    double worst = 0;
    bounds(GIRIH_SPACING_LINEAR, 11, &mean, &worst);
    assert_near(mean, 30.8, 0.05);
    assert_near(worst, 15.0, 0.05);
    bounds(GIRIH_SPACING_DYADIC, 7, &mean, &worst);
    assert_near(mean, 21.9, 0.05);
    assert_near(worst, 9.7, 0.05);
}

static void test_spacing(void **state) {
    (void)state;
    const uint32_t segments[3] = {8, 4, 2};
    const double corner = 1e-9;
    // On a border its own, in the middle the geometric mean, whatever the weights add up to.
    assert_near(spacing_of(segments, (const double[3]){0.3, 0.7, 0}), 1.0 / 8, 1e-12);
    assert_near(spacing_of(segments, (const double[3]){0, 0.3, 0.7}), 1.0 / 4, 1e-12);
    assert_near(spacing_of(segments, (const double[3]){0.3, 0, 0.7}), 1.0 / 2, 1e-12);
    assert_near(spacing_of(segments, (const double[3]){7, 7, 7}), 1.0 / 4, 1e-12);
    // At a corner that of the two borders that meet there.
    assert_near(spacing_of(segments, (const double[3]){1, corner, corner}), 1.0 / 4,
                1e-6);
}

// The regular grid has equilateral triangles of the spacing itself.
static void test_regular_grid(void **state) {
    (void)state;
    girih_pattern pattern = build(8, 8, 8);
    const girih_quality quality = measure(&pattern);
    assert_near(quality.angles[GIRIH_SHAPE_EQUILATERAL], 60, 1e-9);
    assert_near(quality.angles[GIRIH_SHAPE_RIGHT], 45, 1e-9);
    assert_near(quality.angles[GIRIH_SHAPE_OBTUSE], 30, 1e-9);
    assert_near(quality.angle_sum, 64 * 60, 1e-6);
    assert_near(quality.bound, 60, 1e-9);
    assert_near(quality.area_ratio, 1, 1e-12);
    assert_near(quality.shortest, 1, 1e-9);
    assert_near(quality.longest, 1, 1e-9);
    assert_int_equal(quality.measured, 64);
    assert_int_equal(quality.degenerate, 0);
    assert_true(quality.cache_misses >= pattern.vertex_count);
    girih_pattern_free(&pattern);
}

static void test_small_patterns(void **state) {
    (void)state;
    girih_pattern one = build(1, 1, 1);
    const girih_quality whole_triangle = measure(&one);
    assert_near(whole_triangle.angles[GIRIH_SHAPE_EQUILATERAL], 60, 1e-9);
    assert_true(whole_triangle.shortest == 0 && whole_triangle.longest == 0);
    assert_int_equal(whole_triangle.cache_misses, 3);
    girih_pattern_free(&one);

    girih_pattern two = build(2, 1, 1);
    const girih_quality halves = measure(&two);
    assert_near(halves.angles[GIRIH_SHAPE_EQUILATERAL], 30, 1e-9);
    assert_near(halves.bound, 30, 1e-9);
    assert_near(halves.area_ratio, 1, 1e-12);
    // One inner edge, the height, from the middle of edge 1 to P3.
    const double expected =
        sqrt(3) / 2 / spacing_of(two.segments, (const double[3]){1, 1, 2});
    assert_near(halves.shortest, expected, 1e-9);
    assert_near(halves.longest, expected, 1e-9);
    assert_int_equal(halves.cache_misses, 4);
    girih_pattern_free(&two);
}

// A joint without area beside a triangle is counted, and changes no figure of the others.
static void test_degenerate_triangles(void **state) {
    (void)state;
    uint32_t vertices[4] = {ONE, ONE << 16, 0, ONE / 2 | ONE / 2 << 16};
    uint32_t indices[] = {0, 3, 2, 3, 3, 2, 3, 1, 2, 0, 3, 1, 0, 0, 0};
    const girih_pattern pattern = {.segments = {2, 1, 1},
                                   .vertex_count = 4,
                                   .triangle_count = 5,
                                   .vertices = vertices,
                                   .indices = indices};
    const girih_quality quality = measure(&pattern);
    assert_int_equal(quality.degenerate, 3);
    assert_int_equal(quality.measured, 2);
    assert_near(quality.angles[GIRIH_SHAPE_EQUILATERAL], 30, 1e-9);
    assert_near(quality.angle_sum, 60, 1e-9);
    assert_near(quality.area_ratio, 1, 1e-12);
    assert_true(isfinite(quality.shortest) && isfinite(quality.longest) && quality.shortest > 0);

    uint32_t nothing[] = {0, 0, 0, 1, 1, 2};
    const girih_pattern flat = {.segments = {1, 1, 1},
                                .vertex_count = 3,
                                .triangle_count = 2,
                                .vertices = vertices,
                                .indices = nothing};
    const girih_quality none = measure(&flat);
    assert_int_equal(none.degenerate, 2);
    assert_int_equal(none.measured, 0);
    for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
        assert_true(none.angles[shape] == 0);
    }
    assert_true(none.angle_sum == 0 && none.area_ratio == 0);
}

// A strip shades every vertex once; what left the cache is shaded again, just then.
static void test_vertex_cache(void **state) {
    (void)state;
    uint32_t strip[3 * 40];
    for (uint32_t n = 0; n < 40; n++) {
        strip[3 * n] = n;
        strip[3 * n + 1] = n + 1;
        strip[3 * n + 2] = n + 2;
    }
    assert_int_equal(girih_cache_misses(strip, 120, 64, GIRIH_CACHE_SIZE), 42);

    for (uint32_t others = 1; others < 30; others++) {
        // Vertex 0, then so many others, then vertex 0 again, made up to triangles with it.
        uint32_t again[96] = {0};
        uint32_t count = 1;
        for (uint32_t n = 1; n <= others; n++) {
            again[count++] = n;
        }
        again[count++] = 0;
        while (count % 3 != 0) {
            again[count++] = 0;
        }
        const uint64_t misses = girih_cache_misses(again, count, 64, GIRIH_CACHE_SIZE);
        assert_int_equal(misses, 1 + others + (others >= GIRIH_CACHE_SIZE));
    }
}

static uint32_t count_progress;

static void progress(uint32_t done, uint32_t all) {
    count_progress++;
    assert_int_equal(done, count_progress);
    assert_true(done <= all);
}

// What the built-in catalogues promise (doc/patterns.md).
static void check_built_in(const girih_catalogue *catalogue, double mean_angle, double worst_angle) {
    girih_quality *qualities = calloc(catalogue->pattern_count, sizeof *qualities);
    assert_non_null(qualities);
    count_progress = 0;
    assert_int_equal(girih_quality_measure_catalogue(catalogue, qualities, progress, NULL),
                     GIRIH_OK);
    assert_int_equal(count_progress, catalogue->pattern_count);
    const girih_quality_totals totals = girih_quality_total(catalogue, qualities);
    assert_true(totals.mean_angles[GIRIH_SHAPE_EQUILATERAL] >= mean_angle);
    assert_true(totals.worst_angles[GIRIH_SHAPE_EQUILATERAL] >= worst_angle);
    assert_int_equal(totals.uneven, 0);
    uint32_t patterns = 0;
    for (uint32_t n = 0; n < GIRIH_HISTOGRAM_COUNT; n++) {
        patterns += totals.histogram[n];
    }
    assert_int_equal(patterns, catalogue->pattern_count);
    // the regular grids
    assert_true(totals.histogram[GIRIH_HISTOGRAM_COUNT - 1] >= catalogue->level_count);
    assert_true(totals.mean_triangle_angle > totals.mean_angles[GIRIH_SHAPE_EQUILATERAL]);
    assert_true(totals.cache_misses > catalogue->vertex_count);
    assert_true(totals.worst_cache <= 1.15);
    assert_int_equal(totals.degenerate, 0);
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        const uint32_t n = pattern->segments[0];
        assert_true(pattern->triangle_count <= n * n + girih_border_count(pattern->segments) - 3 * n);
        assert_true(qualities[rank].angles[GIRIH_SHAPE_EQUILATERAL] < qualities[rank].bound + 0.05);
        assert_true(qualities[rank].shortest <= qualities[rank].longest);
        assert_true(qualities[rank].angles[GIRIH_SHAPE_THIN] <
                    qualities[rank].angles[GIRIH_SHAPE_EQUILATERAL]);
    }
    free(qualities);
}

static void test_built_in_catalogues(void **state) {
    (void)state;
    check_built_in(girih_catalogue_linear(), 26, 11);
    check_built_in(girih_catalogue_dyadic(), 18, 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_angles_of_the_shapes), cmocka_unit_test(test_angles_of_halves),
        cmocka_unit_test(test_no_area_is_no_angle),  cmocka_unit_test(test_corner_bound),
        cmocka_unit_test(test_bounds_of_catalogues), cmocka_unit_test(test_spacing),
        cmocka_unit_test(test_regular_grid),         cmocka_unit_test(test_small_patterns),
        cmocka_unit_test(test_degenerate_triangles), cmocka_unit_test(test_vertex_cache),
        cmocka_unit_test(test_built_in_catalogues),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
