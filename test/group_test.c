// Stage 3: the laws of group, on the CPU.
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "arrays.h"
#include "memory.h"
#include "meshes.h"

static girih_arrays make_arrays(uint32_t triangle_count, uint32_t group_count) {
    girih_arrays arrays;
    memset(&arrays, 0, sizeof arrays);
    arrays.frame.triangle_count = triangle_count;
    arrays.frame.group_count = group_count;
    arrays.count[GIRIH_BIND_KEYS] = triangle_count;
    arrays.count[GIRIH_BIND_ITEMS] = (uint64_t)triangle_count * GIRIH_ITEM_WORDS;
    arrays.count[GIRIH_BIND_GROUPS] = ((uint64_t)group_count + 1) * GIRIH_GROUP_WORDS;
    arrays.count[GIRIH_BIND_STATUS] = GIRIH_STATUS_WORDS;
    for (uint32_t binding = 0; binding < GIRIH_BIND_COUNT; ++binding) {
        if (arrays.count[binding] > 0 || binding == GIRIH_BIND_KEYS ||
            binding == GIRIH_BIND_ITEMS) {
            arrays.words[binding] =
                girih_allocate_array((size_t)arrays.count[binding], sizeof(uint32_t));
            assert_non_null(arrays.words[binding]);
            memset(arrays.words[binding], 0xa5, (size_t)arrays.count[binding] * sizeof(uint32_t));
        }
    }
    // No parts of split triangles.
    memset(arrays.words[GIRIH_BIND_STATUS], 0, GIRIH_STATUS_WORDS * sizeof(uint32_t));
    return arrays;
}

// A triangle and its key; sorted by group, ties by triangle, which is what stable means.
typedef struct pair {
    uint32_t triangle, key;
} pair;

static int compare_pairs(const void *a, const void *b) {
    const pair *x = a, *y = b;
    if (x->key >> 3 != y->key >> 3) {
        return x->key >> 3 < y->key >> 3 ? -1 : 1;
    }
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static void check_sort(girih_arrays *arrays) {
    const uint32_t *keys = arrays->words[GIRIH_BIND_KEYS];
    const uint32_t count = arrays->frame.triangle_count;
    pair *expected = malloc((count + 1u) * sizeof *expected);
    assert_non_null(expected);
    uint32_t items = 0;
    for (uint32_t n = 0; n < count; ++n) {
        if (keys[n] != GIRIH_KEY_CULLED) {
            expected[items++] = (pair){n, keys[n]};
        }
    }
    qsort(expected, items, sizeof *expected, compare_pairs);
    assert_int_equal(girih_twin_group(arrays, NULL), GIRIH_OK);
    assert_int_equal(arrays->words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS], items);
    const uint32_t *sorted = arrays->words[GIRIH_BIND_ITEMS];
    for (uint32_t n = 0; n < items; ++n) {
        assert_int_equal(sorted[2 * n + GIRIH_ITEM_TRIANGLE], expected[n].triangle);
        assert_int_equal(sorted[2 * n + GIRIH_ITEM_KEY], expected[n].key);
    }
    uint32_t item = 0;
    for (uint32_t group = 0; group <= arrays->frame.group_count; ++group) {
        const uint32_t *words =
            arrays->words[GIRIH_BIND_GROUPS] + (size_t)group * GIRIH_GROUP_WORDS;
        const uint32_t first = item;
        while (item < items && expected[item].key >> 3 == group) {
            ++item;
        }
        assert_int_equal(words[GIRIH_GROUP_FIRST], item > first ? first : 0);
        assert_int_equal(words[GIRIH_GROUP_END], item > first ? item : 0);
    }
    assert_int_equal(item, items);
    free(expected);
}

static void sorting_is_stable(void **state) {
    (void)state;
    static const uint32_t counts[] = {0, 1, 2, 63, 1000, 40000};
    static const uint32_t groups[] = {1, 119, 1376, 1376 * 64};
    static const uint32_t culled_of_8[] = {0, 3, 8};
    uint64_t random = 42;
    for (size_t n = 0; n < sizeof counts / sizeof *counts; ++n) {
        for (size_t m = 0; m < sizeof groups / sizeof *groups; ++m) {
            for (size_t k = 0; k < sizeof culled_of_8 / sizeof *culled_of_8; ++k) {
                girih_arrays arrays = make_arrays(counts[n], groups[m]);
                for (uint32_t triangle = 0; triangle < counts[n]; ++triangle) {
                    const uint32_t group = draw_number(&random) % groups[m];
                    arrays.words[GIRIH_BIND_KEYS][triangle] =
                        draw_number(&random) % 8 < culled_of_8[k]
                            ? GIRIH_KEY_CULLED
                            : group << 3 | draw_number(&random) % 8;
                }
                check_sort(&arrays);
                girih_arrays_free(&arrays, 0, GIRIH_BIND_COUNT);
            }
        }
    }
}

static void a_failed_allocation_is_reported(void **state) {
    (void)state;
    girih_arrays arrays = make_arrays(0, 119);
    girih_error error = {GIRIH_OK, ""};
    girih_allocation_failure_after(0);
    const girih_result result = girih_twin_group(&arrays, &error);
    girih_allocation_failure_after(SIZE_MAX);
    assert_int_equal(result, GIRIH_ERROR_OUT_OF_MEMORY);
    assert_string_equal(error.message, "no memory to sort into 119 groups");
    girih_arrays_free(&arrays, 0, GIRIH_BIND_COUNT);
}

// The passes cover the largest group number, with no bit and no pass to spare.
static void passes_cover_all_groups(void **state) {
    (void)state;
    uint32_t bits = 0;
    assert_int_equal(girih_sort_passes(1, &bits), 1);
    assert_int_equal(bits, 1);
    for (uint32_t group_count = 2; group_count <= 1u << 28; group_count += group_count / 7 + 1) {
        const uint32_t passes = girih_sort_passes(group_count, &bits);
        assert_true(bits >= 1 && bits <= GIRIH_MAX_BIN_BITS);
        assert_int_equal((group_count - 1) >> 1 >> (passes * bits - 1), 0);
        assert_true(passes == 1 || (group_count - 1) >> (passes - 1) * GIRIH_MAX_BIN_BITS != 0);
        assert_true(bits == 1 || (group_count - 1) >> passes * (bits - 1) != 0);
    }
    assert_int_equal(girih_sort_passes(512, &bits), 1);
    assert_int_equal(bits, 9);
    assert_int_equal(girih_sort_passes(513, &bits), 2);
    assert_int_equal(bits, 5);
    assert_int_equal(girih_sort_passes(1376 * 64, &bits), 2);
    assert_int_equal(bits, 9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sorting_is_stable),
        cmocka_unit_test(a_failed_allocation_is_reported),
        cmocka_unit_test(passes_cover_all_groups),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
