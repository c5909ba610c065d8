// Stage 4: the laws of dispatch, on the CPU.
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "memory.h"
#include "meshes.h"
#include "stages.h"

// What dispatch should say, summed plainly from the catalogue.
typedef struct expectation {
    uint64_t vertices, triangles;
    uint32_t draws, chunks, groups, patterns;
} expectation;

static uint32_t *group_words(const stages *s, uint32_t group) {
    return s->arrays.words[GIRIH_BIND_GROUPS] + (size_t)group * GIRIH_GROUP_WORDS;
}

static const girih_base_pattern *range_pattern(const girih_catalogue *catalogue, uint32_t range,
                                               int *mirrored) {
    uint32_t n = 0;
    for (uint32_t rank = 0;; ++rank) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        const uint32_t ranges = pattern->levels[0] > pattern->levels[1] &&
                                        pattern->levels[1] > pattern->levels[2]
                                    ? 2
                                    : 1;
        if (range < n + ranges) {
            *mirrored = range > n;
            return pattern;
        }
        n += ranges;
    }
}

static uint32_t replicas_of(const girih_base_pattern *pattern) {
    const uint32_t replicas = GIRIH_DRAW_TRIANGLES / pattern->triangle_count;
    return replicas > 1 ? replicas : 1;
}

// Puts random numbers of items into every `sparse`-th group or so, of up to `most` triangles each.
static void fill_groups(stages *s, uint64_t *random, uint32_t sparse, uint32_t most) {
    uint32_t item = 0;
    memset(s->arrays.words[GIRIH_BIND_STATUS], 0,
           (size_t)s->arrays.count[GIRIH_BIND_STATUS] * sizeof(uint32_t));
    memset(s->arrays.words[GIRIH_BIND_GROUPS], 0,
           (size_t)s->arrays.count[GIRIH_BIND_GROUPS] * sizeof(uint32_t));
    for (uint32_t group = 0; group < s->arrays.frame.group_count; ++group) {
        if (draw_number(random) % sparse == 0) {
            const uint32_t *patterns = s->arrays.words[GIRIH_BIND_PATTERNS];
            const uint32_t range = group % s->arrays.frame.range_count;
            const uint32_t rank =
                patterns[s->arrays.frame.pattern_count * GIRIH_PATTERN_WORDS + range];
            const uint32_t triangles =
                patterns[rank * GIRIH_PATTERN_WORDS + GIRIH_PATTERN_TRIANGLES];
            const uint32_t count = 1 + draw_number(random) % (1 + most / triangles);
            group_words(s, group)[GIRIH_GROUP_FIRST] = item;
            group_words(s, group)[GIRIH_GROUP_END] = item + count;
            item += count;
        }
    }
    s->arrays.words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS] = item;
}

// Sums over groups of counts[group] triangles, and asserts where each group begins.
static expectation expect(const stages *s, const girih_catalogue *catalogue,
                          const uint32_t *counts) {
    expectation e = {0};
    char *used = calloc(catalogue->pattern_count, 1);
    assert_non_null(used);
    const int welded = s->shape.mode == GIRIH_MODE_WELDED;
    const uint64_t border = welded ? s->arrays.frame.corner_count : 0;
    for (uint32_t group = 0; group < s->arrays.frame.group_count; ++group) {
        const uint32_t *words = group_words(s, group);
        assert_int_equal(words[GIRIH_GROUP_FIRST_VERTEX], (uint32_t)(e.vertices + border));
        assert_int_equal(words[GIRIH_GROUP_FIRST_TRIANGLE], (uint32_t)e.triangles);
        assert_int_equal(words[GIRIH_GROUP_FIRST_DRAW], e.draws);
        assert_int_equal(words[GIRIH_GROUP_FIRST_CHUNK], e.chunks);
        int mirrored = 0;
        const girih_base_pattern *pattern =
            range_pattern(catalogue, group % s->arrays.frame.range_count, &mirrored);
        if (counts[group] == 0) {
            continue;
        }
        const uint32_t edges =
            pattern->segments[0] + pattern->segments[1] + pattern->segments[2];
        e.vertices += (uint64_t)counts[group] * (pattern->vertex_count - (welded ? edges : 0));
        e.triangles += (uint64_t)counts[group] * pattern->triangle_count;
        e.draws += (counts[group] + replicas_of(pattern) - 1) / replicas_of(pattern);
        e.chunks += counts[group] * ((pattern->vertex_count + 255) / 256 - 1);
        e.groups += 1;
        const uint32_t rank = (uint32_t)(pattern - girih_catalogue_pattern(catalogue, 0));
        e.patterns += !used[rank];
        used[rank] = 1;
    }
    free(used);
    e.vertices += border;
    return e;
}

static uint32_t *group_counts(const stages *s) {
    uint32_t *counts = malloc((s->arrays.frame.group_count + 1u) * sizeof *counts);
    assert_non_null(counts);
    for (uint32_t group = 0; group < s->arrays.frame.group_count; ++group) {
        counts[group] =
            group_words(s, group)[GIRIH_GROUP_END] - group_words(s, group)[GIRIH_GROUP_FIRST];
    }
    return counts;
}

// After an overflow: each material's items in its first group.
static void merge_counts(const stages *s, uint32_t *counts) {
    const uint32_t ranges = s->arrays.frame.range_count;
    for (uint32_t group = 0; group < s->arrays.frame.group_count; ++group) {
        if (group % ranges != 0) {
            counts[group - group % ranges] += counts[group];
            counts[group] = 0;
        }
    }
}

static void check_status(const stages *s, const expectation *e, uint64_t needed_vertices,
                         uint64_t needed_triangles, int overflow) {
    const uint32_t *status = s->arrays.words[GIRIH_BIND_STATUS];
    const girih_statistics statistics = stages_statistics(s);
    assert_int_equal(statistics.overflow, overflow);
    assert_int_equal(statistics.output_vertices, e->vertices);
    assert_int_equal(statistics.needed_vertices, needed_vertices);
    assert_int_equal(statistics.needed_triangles, needed_triangles);
    assert_int_equal(statistics.groups, e->groups);
    assert_int_equal(statistics.base_patterns, e->patterns);
    assert_int_equal(status[GIRIH_STATUS_TRIANGLES], (uint32_t)e->triangles);
    assert_int_equal(status[GIRIH_STATUS_CHUNKS], e->chunks);
    const uint64_t invocations =
        status[GIRIH_STATUS_ITEMS] + (s->shape.mode == GIRIH_MODE_INSTANCED ? 0 : e->chunks);
    const uint64_t workgroups = (uint64_t)status[GIRIH_STATUS_EVALUATE] *
                                status[GIRIH_STATUS_EVALUATE + 1] *
                                status[GIRIH_STATUS_EVALUATE + 2];
    assert_true(workgroups * GIRIH_WORKGROUP >= invocations);
    assert_true(status[GIRIH_STATUS_EVALUATE] <= 65535 &&
                status[GIRIH_STATUS_EVALUATE + 1] <= 65535);
    const uint32_t *first = status + GIRIH_STATUS_WORDS + s->arrays.frame.pattern_count;
    const uint32_t materials = s->arrays.frame.material_count;
    for (uint32_t material = 0; material <= materials; ++material) {
        const uint32_t *words = group_words(s, material * s->arrays.frame.range_count);
        assert_int_equal(first[material], words[GIRIH_GROUP_FIRST_TRIANGLE]);
    }
    assert_int_equal(first[materials], (uint32_t)e->triangles);
}

static void sums_are_right(void **state) {
    (void)state;
    const girih_mesh *mesh = make_soup(60, 30, 8);
    const girih_catalogue *catalogue = girih_catalogue_dyadic();
    uint64_t random = 17;
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        stages s = stages_begin(catalogue, &mesh, 1, NULL, 0,
                                (girih_plan_shape){.mode = (girih_mode)mode,
                                                   .outputs = GIRIH_OUTPUT_NO_DRAW});
        for (int n = 0; n < 20; ++n) {
            fill_groups(&s, &random, 1u + (uint32_t)n, 20000);
            uint32_t *counts = group_counts(&s);
            girih_twin_dispatch(&s.arrays);
            const expectation e = expect(&s, catalogue, counts);
            check_status(&s, &e, e.vertices, e.triangles, 0);
            free(counts);
        }
        // All of it culled.
        fill_groups(&s, &random, 1, 1);
        memset(s.arrays.words[GIRIH_BIND_GROUPS], 0,
               (size_t)s.arrays.count[GIRIH_BIND_GROUPS] * sizeof(uint32_t));
        s.arrays.words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS] = 0;
        girih_twin_dispatch(&s.arrays);
        assert_int_equal(stages_statistics(&s).output_triangles, 0);
        stages_end(&s);
    }
    girih_mesh_destroy(mesh);
}

// One more than there is room for, in triangles or in vertices: everything is drawn at level 0.
static void overflow_draws_level_0(void **state) {
    (void)state;
    const girih_mesh *mesh = make_soup(60, 30, 9);
    const girih_catalogue *catalogue = girih_catalogue_dyadic();
    uint64_t random = 23;
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        stages s = stages_begin(catalogue, &mesh, 1, NULL, 0,
                                (girih_plan_shape){.mode = (girih_mode)mode,
                                                   .outputs = GIRIH_OUTPUT_NO_DRAW});
        for (int n = 0; n < 20; ++n) {
            fill_groups(&s, &random, 1u + (uint32_t)n, 5000);
            const uint32_t items = s.arrays.words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS];
            uint32_t *counts = group_counts(&s);
            uint32_t *groups = girih_allocate_array((size_t)s.arrays.count[GIRIH_BIND_GROUPS],
                                                    sizeof *groups);
            assert_non_null(groups);
            memcpy(groups, s.arrays.words[GIRIH_BIND_GROUPS],
                   (size_t)s.arrays.count[GIRIH_BIND_GROUPS] * sizeof *groups);
            s.arrays.frame.max_triangles = s.arrays.frame.max_vertices = UINT32_MAX;
            girih_twin_dispatch(&s.arrays);
            const girih_statistics needed = stages_statistics(&s);
            assert_false(needed.overflow);
            // Exactly enough is enough.
            s.arrays.frame.max_triangles = (uint32_t)needed.needed_triangles;
            s.arrays.frame.max_vertices = (uint32_t)needed.needed_vertices;
            girih_twin_dispatch(&s.arrays);
            assert_false(stages_statistics(&s).overflow);
            memset(s.arrays.words[GIRIH_BIND_STATUS] + GIRIH_STATUS_WORDS, 0,
                   catalogue->pattern_count * sizeof(uint32_t));
            memcpy(s.arrays.words[GIRIH_BIND_GROUPS], groups,
                   (size_t)s.arrays.count[GIRIH_BIND_GROUPS] * sizeof *groups);
            girih_free(groups);
            const int by_vertices = n % 2 == 1 && mode != GIRIH_MODE_INSTANCED;
            *(by_vertices ? &s.arrays.frame.max_vertices : &s.arrays.frame.max_triangles) -= 1;
            girih_twin_dispatch(&s.arrays);
            merge_counts(&s, counts);
            const expectation e = expect(&s, catalogue, counts);
            check_status(&s, &e, needed.needed_vertices, needed.needed_triangles, 1);
            assert_int_equal(e.triangles, items);
            assert_int_equal(e.vertices,
                             mode == GIRIH_MODE_WELDED ? mesh->vertex_count : 3 * items);
            uint32_t item = 0;
            for (uint32_t group = 0; group < s.arrays.frame.group_count; ++group) {
                const uint32_t *words = group_words(&s, group);
                assert_int_equal(words[GIRIH_GROUP_END] - words[GIRIH_GROUP_FIRST], counts[group]);
                if (counts[group] > 0) {
                    assert_int_equal(words[GIRIH_GROUP_FIRST], item);
                    item += counts[group];
                }
            }
            free(counts);
        }
        stages_end(&s);
    }
    girih_mesh_destroy(mesh);
}

// Sums beyond 32 bits are told exactly, and overflow even the largest room.
static void sums_are_64_bits_wide(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0,
                            (girih_plan_shape){.mode = GIRIH_MODE_BAKED,
                                               .outputs = GIRIH_OUTPUT_NO_DRAW});
    uint64_t random = 5;
    fill_groups(&s, &random, 1, 300000000);
    uint64_t triangles = 0, vertices = 0;
    for (uint32_t group = 0; group < s.arrays.frame.group_count; ++group) {
        int mirrored = 0;
        const girih_base_pattern *pattern =
            range_pattern(girih_catalogue_dyadic(), group, &mirrored);
        const uint64_t count = group_words(&s, group)[GIRIH_GROUP_END] -
                               (uint64_t)group_words(&s, group)[GIRIH_GROUP_FIRST];
        triangles += count * pattern->triangle_count;
        vertices += count * pattern->vertex_count;
    }
    assert_true(triangles > (uint64_t)UINT32_MAX * 3);
    girih_twin_dispatch(&s.arrays);
    const girih_statistics statistics = stages_statistics(&s);
    assert_int_equal(statistics.needed_triangles, triangles);
    assert_int_equal(statistics.needed_vertices, vertices);
    assert_true(statistics.overflow);
    assert_int_equal(statistics.output_triangles,
                     s.arrays.words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS]);
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

static void check_draw(const uint32_t *draw, uint32_t indices, uint32_t instances,
                       uint32_t first_index, uint32_t vertex, uint32_t first_instance) {
    assert_int_equal(draw[0], indices);
    assert_int_equal(draw[1], instances);
    assert_int_equal(draw[2], first_index);
    assert_int_equal(draw[3], vertex);
    assert_int_equal(draw[4], first_instance);
}

static uint32_t first_index_of(const stages *s, uint32_t range) {
    const uint32_t *patterns = s->arrays.words[GIRIH_BIND_PATTERNS];
    const uint32_t rank = patterns[s->arrays.frame.pattern_count * GIRIH_PATTERN_WORDS + range];
    const uint32_t *pattern = patterns + (size_t)rank * GIRIH_PATTERN_WORDS;
    return pattern[range == pattern[GIRIH_PATTERN_RANGE] ? GIRIH_PATTERN_FIRST_INDEX
                                                         : GIRIH_PATTERN_FIRST_MIRRORED];
}

// Baked: each material's groups one after another, in draws of as many triangles as are replicated.
static void check_pattern_draws(const stages *s, const girih_catalogue *catalogue) {
    const girih_frame_block *frame = &s->arrays.frame;
    for (uint32_t material = 0; material < frame->material_count; ++material) {
        const uint32_t *draw = s->arrays.words[GIRIH_BIND_DRAWS] +
                               (size_t)material * frame->draws_per_material * 5;
        uint32_t used = 0;
        for (uint32_t range = 0; range < frame->range_count; ++range) {
            const uint32_t *words = group_words(s, material * frame->range_count + range);
            int mirrored = 0;
            const girih_base_pattern *pattern = range_pattern(catalogue, range, &mirrored);
            uint32_t vertex = words[GIRIH_GROUP_FIRST_VERTEX];
            uint32_t left = words[GIRIH_GROUP_END] - words[GIRIH_GROUP_FIRST];
            while (left > 0) {
                const uint32_t count = left < replicas_of(pattern) ? left : replicas_of(pattern);
                assert_true(used < frame->draws_per_material);
                check_draw(draw + 5 * (size_t)used, count * 3 * pattern->triangle_count, 1,
                           first_index_of(s, range), vertex, 0);
                vertex += count * pattern->vertex_count;
                left -= count;
                ++used;
            }
        }
        for (; used < frame->draws_per_material; ++used) {
            check_draw(draw + 5 * (size_t)used, 0, 0, 0, 0, 0);
        }
    }
}

static void draws_cover_everything_once(void **state) {
    (void)state;
    const girih_mesh *mesh = make_soup(60, 30, 10);
    const girih_catalogue *catalogue = girih_catalogue_dyadic();
    uint64_t random = 29;
    stages baked = stages_begin(catalogue, &mesh, 1, NULL, 0,
                                (girih_plan_shape){.mode = GIRIH_MODE_BAKED,
                                                   .max_vertices = 8000000,
                                                   .max_triangles = 2000000,
                                                   .pattern_draws = 1});
    stages instanced = stages_begin(catalogue, &mesh, 1, NULL, 0,
                                    (girih_plan_shape){.mode = GIRIH_MODE_INSTANCED});
    stages welded =
        stages_begin(catalogue, &mesh, 1, NULL, 0, (girih_plan_shape){.mode = GIRIH_MODE_WELDED});
    const girih_frame_block *frame = &baked.arrays.frame;
    assert_int_equal(frame->draws_per_material, frame->range_count + 2000000 / 1024);
    assert_int_equal(baked.arrays.count[GIRIH_BIND_DRAWS],
                     5 * frame->draws_per_material * frame->material_count);
    assert_int_equal(welded.arrays.count[GIRIH_BIND_DRAWS], 5 * frame->material_count);
    uint32_t fitting = 0;
    for (int n = 0; n < 30; ++n) {
        fill_groups(&baked, &random, 1u + (uint32_t)n, 5000u + 12000u * (uint32_t)n);
        uint32_t *counts = group_counts(&baked);
        for (stages *s = &instanced; s; s = s == &instanced ? &welded : NULL) {
            memcpy(s->arrays.words[GIRIH_BIND_STATUS], baked.arrays.words[GIRIH_BIND_STATUS],
                   (size_t)baked.arrays.count[GIRIH_BIND_STATUS] * sizeof(uint32_t));
            memcpy(s->arrays.words[GIRIH_BIND_GROUPS], baked.arrays.words[GIRIH_BIND_GROUPS],
                   (size_t)baked.arrays.count[GIRIH_BIND_GROUPS] * sizeof(uint32_t));
            girih_twin_dispatch(&s->arrays);
        }
        girih_twin_dispatch(&baked.arrays);
        fitting += !stages_statistics(&baked).overflow;
        check_pattern_draws(&baked, catalogue);
        for (uint32_t group = 0; group < frame->group_count; ++group) {
            int mirrored = 0;
            const girih_base_pattern *pattern =
                range_pattern(catalogue, group % frame->range_count, &mirrored);
            const uint32_t *draw =
                instanced.arrays.words[GIRIH_BIND_DRAWS] + 5 * (size_t)group;
            if (counts[group] == 0) {
                check_draw(draw, 0, 0, 0, 0, 0);
                continue;
            }
            check_draw(draw, 3 * pattern->triangle_count, counts[group],
                       first_index_of(&instanced, group % frame->range_count),
                       pattern->first_vertex, group_words(&instanced, group)[GIRIH_GROUP_FIRST]);
        }
        uint32_t triangle = 0;
        for (uint32_t material = 0; material < frame->material_count; ++material) {
            const uint32_t *draw =
                welded.arrays.words[GIRIH_BIND_DRAWS] + 5 * (size_t)material;
            check_draw(draw, draw[0], 1, 3 * triangle, 0, 0);
            triangle += draw[0] / 3;
        }
        assert_int_equal(triangle, stages_statistics(&welded).output_triangles);
        free(counts);
    }
    assert_true(fitting > 5 && fitting < 30);
    stages_end(&baked);
    stages_end(&instanced);
    stages_end(&welded);
    girih_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_right),
        cmocka_unit_test(overflow_draws_level_0),
        cmocka_unit_test(sums_are_64_bits_wide),
        cmocka_unit_test(draws_cover_everything_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
