// Levels beyond the catalogue: the laws of split triangles, on the CPU.
//
// One flat triangle with the corners (0,0), (1,0), (0,1): the coordinates of a point are two of its
// barycentrics, and floats hold them exactly, so that areas are sums of integers.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "stages.h"

#define MAX_SPLITS 20000u
#define MAX_TRIANGLES 110000u

typedef struct refined {
    stages s;
    const girih_mesh *mesh;
    uint32_t segments[3];
    uint64_t triangles;
} refined;

// The triangle with these levels. False: it has more triangles or parts than are looked at.
static bool refine(const girih_catalogue *catalogue, const uint32_t levels[3], uint32_t max_splits,
                   refined *r) {
    *r = (refined){.mesh = make_triangle()};
    r->s = stages_begin(catalogue, &r->mesh, 1, NULL, 0,
                        (girih_plan_shape){.mode = GIRIH_MODE_BAKED,
                                           .outputs = GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_INDICES,
                                           .max_segments = GIRIH_MOST_SEGMENTS,
                                           .max_splits = max_splits});
    girih_arrays *arrays = &r->s.arrays;
    girih_error error = {GIRIH_OK, ""};
    stages_frame(&r->s, &(girih_frame){.rule = GIRIH_LEVEL_SEGMENTS});
    girih_twin_levels(arrays);
    for (uint32_t n = 0; n < 3; ++n) {
        arrays->words[GIRIH_BIND_LEVELS][r->mesh->triangle_edges[n]] = levels[n];
        r->segments[n] = arrays->frame.linear_spacing ? levels[n] + 1 : 1u << levels[n];
    }
    girih_twin_select(arrays, GIRIH_SURFACE_FLAT);
    girih_twin_split(arrays);
    if (girih_twin_group(arrays, &error) != GIRIH_OK) {
        fail_msg("%s", error.message);
    }
    girih_twin_dispatch(arrays);
    const girih_statistics statistics = stages_statistics(&r->s);
    r->triangles = statistics.output_triangles;
    if (max_splits == MAX_SPLITS && (statistics.overflow || r->triangles > MAX_TRIANGLES)) {
        return false;
    }
    stages_write(&r->s, GIRIH_SURFACE_FLAT);
    return true;
}

static void end(refined *r) {
    stages_end(&r->s);
    girih_mesh_destroy(r->mesh);
}

// A vertex's weights of the triangle's corners, over 2^23.
static void weights_of(const refined *r, uint32_t vertex, int64_t weights[3]) {
    float position[3];
    stages_position(&r->s, vertex, position);
    for (int axis = 0; axis < 2; ++axis) {
        const float scaled = position[axis] * (float)GIRIH_SPLIT_ONE;
        assert_true(scaled == floorf(scaled));
        weights[1 + axis] = (int64_t)scaled;
    }
    weights[0] = (int64_t)GIRIH_SPLIT_ONE - weights[1] - weights[2];
    assert_true(weights[0] >= 0);
}

// FORMULAS 2.2: t_m = round(m * 32768 / n) up to the middle, and t_{n-m} = 32768 - t_m.
static int64_t edge_place(uint32_t m, uint32_t n) {
    return 2 * m <= n ? (65536 * (int64_t)m + n) / (2 * (int64_t)n) : 32768 - edge_place(n - m, n);
}

// Every edge has its own vertices and no others, whatever the other edges are.
static void check_borders(const refined *r) {
    uint8_t *seen[3];
    uint64_t found[3] = {0};
    for (uint32_t edge = 0; edge < 3; ++edge) {
        seen[edge] = calloc(r->segments[edge] + 1, 1);
        assert_non_null(seen[edge]);
    }
    const uint32_t *indices = r->s.arrays.words[GIRIH_BIND_OUT_INDICES];
    for (uint64_t n = 0; n < 3 * r->triangles; ++n) {
        int64_t weights[3];
        weights_of(r, indices[n], weights);
        for (uint32_t edge = 0; edge < 3; ++edge) {
            if (weights[(edge + 2) % 3] != 0) {
                continue;
            }
            const uint32_t segments = r->segments[edge];
            const int64_t t = weights[(edge + 1) % 3];
            const uint32_t m =
                (uint32_t)((t * segments + GIRIH_SPLIT_ONE / 2) / (int64_t)GIRIH_SPLIT_ONE);
            assert_int_equal(t, edge_place(m, segments) * GIRIH_SPLIT_UNIT);
            found[edge] += !seen[edge][m];
            seen[edge][m] = 1;
        }
    }
    for (uint32_t edge = 0; edge < 3; ++edge) {
        assert_int_equal(found[edge], r->segments[edge] + 1);
        free(seen[edge]);
    }
}

// No triangle is degenerate or turned over, and together they are the whole.
static void check_area(const refined *r) {
    const uint32_t *indices = r->s.arrays.words[GIRIH_BIND_OUT_INDICES];
    int64_t area = 0;
    for (uint64_t n = 0; n < 3 * r->triangles; n += 3) {
        int64_t w[3][3];
        for (uint32_t corner = 0; corner < 3; ++corner) {
            weights_of(r, indices[n + corner], w[corner]);
        }
        const int64_t twice =
            (w[1][1] - w[0][1]) * (w[2][2] - w[0][2]) - (w[2][1] - w[0][1]) * (w[1][2] - w[0][2]);
        assert_true(twice > 0);
        area += twice;
    }
    assert_true(area == INT64_C(1) << 46);
}

// Inside each edge joins two triangles; the border is as long as the edges ask.
static void check_edges(const refined *r) {
    const edge_audit audit = audit_positions(&r->s);
    assert_int_equal(audit.open, (uint64_t)r->segments[0] + r->segments[1] + r->segments[2]);
    assert_int_equal(audit.nonmanifold + audit.flipped + audit.degenerate, 0);
}

// Checks the triangle with these levels; how many triangles it has, 0 where they are too many.
static uint64_t check(const girih_catalogue *catalogue, uint32_t i, uint32_t j, uint32_t k) {
    refined r;
    const uint32_t levels[3] = {i, j, k};
    uint64_t triangles = 0;
    if (refine(catalogue, levels, MAX_SPLITS, &r)) {
        check_area(&r);
        check_borders(&r);
        check_edges(&r);
        triangles = r.triangles;
        const girih_statistics statistics = stages_statistics(&r.s);
        assert_int_equal(statistics.culled_triangles, 0);
        assert_int_equal(statistics.split_triangles, statistics.parts > 0);
        assert_true(statistics.parts <= statistics.needed_splits);
    }
    end(&r);
    return triangles;
}

static void dyadic_levels(void **state) {
    (void)state;
    const girih_catalogue *catalogue = girih_catalogue_dyadic();
    uint32_t checked = 0, beyond = 0;
    for (uint32_t i = 7; i < 16; ++i) {
        for (uint32_t j = 0; j <= i; j += i > 10 ? 3 : 1) {
            for (uint32_t k = 0; k <= j; k += i > 10 ? 3 : 2) {
                // The largest level on each of the edges.
                const uint32_t turn = (i + j + k) % 3;
                const uint64_t triangles = check(catalogue,
                                                 turn == 0   ? i
                                                 : turn == 1 ? j
                                                             : k,
                                                 turn == 0   ? j
                                                 : turn == 1 ? k
                                                             : i,
                                                 turn == 0   ? k
                                                 : turn == 1 ? i
                                                             : j);
                ++*(triangles > 0 ? &checked : &beyond);
                // A triangle for each segment at least, and not the square of their number.
                assert_true(triangles == 0 || triangles >= 1u << i);
                assert_true(j > 0 || triangles <= 5u << i);
            }
        }
    }
    print_message("%u triples checked, %u have more than %u triangles\n", checked, beyond,
                  MAX_TRIANGLES);
    assert_true(checked > 120);
}

// Edges of one level give the regular grid, or nearly so many triangles where the parts cannot be
// equal.
static void equal_levels(void **state) {
    (void)state;
    for (uint32_t level = 0; level < 9; ++level) {
        assert_int_equal(check(girih_catalogue_dyadic(), level, level, level), 1u << 2 * level);
    }
    for (uint32_t n = 17; n < 300; n += 1 + n / 9) {
        const uint64_t triangles = check(girih_catalogue_linear(), n - 1, n - 1, n - 1);
        assert_true(triangles >= (uint64_t)n * n * 4 / 5 && triangles <= (uint64_t)n * n * 5 / 4);
    }
}

// Any number of segments, most of which do not divide into equal parts.
static void linear_levels(void **state) {
    (void)state;
    uint64_t random = 4711;
    uint32_t checked = 0;
    while (checked < 100) {
        uint32_t levels[3];
        uint32_t largest = 0;
        for (uint32_t n = 0; n < 3; ++n) {
            const uint32_t bits = draw_number(&random) % 16;
            levels[n] = draw_number(&random) & ((1u << bits) - 1);
            largest = levels[n] > largest ? levels[n] : largest;
        }
        if (largest > 15) {
            checked += check(girih_catalogue_linear(), levels[0], levels[1], levels[2]) > 0;
        }
    }
    assert_true(check(girih_catalogue_linear(), 32767, 0, 0) > 0);
    assert_true(check(girih_catalogue_linear(), 0, 32766, 2) > 0);
}

// Without room for its parts a triangle is drawn whole, at level 0, and what is missing is told.
static void overflow(void **state) {
    (void)state;
    const uint32_t levels[3] = {9, 2, 12};
    refined full;
    assert_true(refine(girih_catalogue_dyadic(), levels, MAX_SPLITS, &full));
    const girih_statistics needed = stages_statistics(&full.s);
    end(&full);
    refined r;
    assert_true(refine(girih_catalogue_dyadic(), levels, (uint32_t)needed.needed_splits - 1, &r));
    girih_statistics statistics = stages_statistics(&r.s);
    assert_true(statistics.overflow);
    assert_int_equal(statistics.output_triangles, 1);
    assert_int_equal(statistics.parts, 0);
    assert_int_equal(statistics.culled_triangles, 0);
    assert_int_equal(statistics.needed_splits, needed.needed_splits);
    r.segments[0] = r.segments[1] = r.segments[2] = 1;
    check_area(&r);
    end(&r);
    assert_true(refine(girih_catalogue_dyadic(), levels, (uint32_t)needed.needed_splits, &r));
    statistics = stages_statistics(&r.s);
    assert_false(statistics.overflow);
    assert_int_equal(statistics.output_triangles, needed.output_triangles);
    end(&r);
}

// Of a triangle whose parts have room but whose output has none, the first part is the whole
// triangle, and the others cannot be seen.
static void no_room_for_the_output(void **state) {
    (void)state;
    const girih_mesh *mesh = make_icosphere(1);
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 300, .seed = 5};
    stages s =
        stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0,
                     (girih_plan_shape){.mode = GIRIH_MODE_BAKED,
                                        .outputs = GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_INDICES,
                                        .max_triangles = 1,
                                        .max_segments = 300,
                                        .max_splits = MAX_SPLITS});
    stages_refine(&s, &frame, GIRIH_SURFACE_PN);
    const girih_statistics statistics = stages_statistics(&s);
    assert_true(statistics.overflow && statistics.parts > 80);
    assert_int_equal(statistics.output_triangles,
                     mesh->triangle_count - statistics.split_triangles + statistics.parts);
    const edge_audit audit = audit_positions(&s);
    assert_int_equal(audit.edges, 3 * mesh->triangle_count / 2);
    assert_int_equal(audit.degenerate, statistics.output_triangles - mesh->triangle_count);
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dyadic_levels),          cmocka_unit_test(equal_levels),
        cmocka_unit_test(linear_levels),          cmocka_unit_test(overflow),
        cmocka_unit_test(no_room_for_the_output),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
