// Laws of catalogue files: what is generated holds, what is damaged is refused.
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include <jansson.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "catalogue_files.h"
#include "laws.h"
#include "report.h"
#include "writer.h"

static block generate(girih_spacing spacing, uint32_t max) {
    return write_catalogue(&girih_family_uniform, spacing, max);
}

static void assert_lawful(const void *bytes, size_t size) {
    girih_error error = {.message = ""};
    const girih_catalogue *catalogue = NULL;
    girih_result result = girih_catalogue_open(bytes, size, &catalogue, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
    assert_ptr_equal(catalogue, bytes);
    result = girih_laws_check_catalogue(catalogue, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
}

static void assert_refused(const void *bytes, size_t size) {
    girih_error error = {.message = ""};
    const girih_catalogue *catalogue = NULL;
    assert_int_equal(girih_catalogue_open(bytes, size, &catalogue, &error),
                     GIRIH_ERROR_INVALID_DATA);
    assert_int_equal(error.result, GIRIH_ERROR_INVALID_DATA);
    assert_true(strlen(error.message) > 10);
    assert_null(strchr(error.message, '\n'));
    assert_null(catalogue);
}

static void test_built_ins(void **state) {
    (void)state;
    const girih_catalogue *dyadic = girih_catalogue_dyadic();
    assert_int_equal(dyadic->spacing, GIRIH_SPACING_DYADIC);
    assert_int_equal(dyadic->max, 6);
    assert_int_equal(dyadic->pattern_count, 84);
    assert_int_equal(dyadic->level_count, 7);
    assert_lawful(dyadic, dyadic->bytes);

    const girih_catalogue *linear = girih_catalogue_linear();
    assert_int_equal(linear->spacing, GIRIH_SPACING_LINEAR);
    assert_int_equal(linear->max, 16);
    assert_int_equal(linear->pattern_count, 816);
    assert_int_equal(linear->level_count, 16);
    assert_lawful(linear, linear->bytes);
}

// Patterns do not depend on what else is in their catalogue, nor on when they were made.
static void test_same_bytes_twice(void **state) {
    (void)state;
    const girih_catalogue *built_in[2] = {girih_catalogue_dyadic(), girih_catalogue_linear()};
    const uint32_t max[2] = {4, 9};
    for (int n = 0; n < 2; n++) {
        block again = write_catalogue(&girih_family_optimal, (girih_spacing)built_in[n]->spacing, max[n]);
        const girih_catalogue *small = again.bytes;
        for (uint32_t rank = 0; rank < small->pattern_count; rank++) {
            const girih_base_pattern *a = girih_catalogue_pattern(small, rank);
            const girih_base_pattern *b = girih_catalogue_pattern(built_in[n], rank);
            assert_int_equal(a->vertex_count, b->vertex_count);
            assert_int_equal(a->triangle_count, b->triangle_count);
            assert_memory_equal(girih_catalogue_vertices(small, a), girih_catalogue_vertices(built_in[n], b),
                                a->vertex_count * sizeof(uint32_t));
            assert_memory_equal(girih_catalogue_parents(small, a), girih_catalogue_parents(built_in[n], b),
                                a->vertex_count * sizeof(uint32_t));
            for (uint32_t index = 0; index < 3 * a->triangle_count; index++) {
                assert_int_equal(girih_catalogue_index(small, a, index), girih_catalogue_index(built_in[n], b, index));
            }
        }
        block twice = write_catalogue(&girih_family_optimal, (girih_spacing)built_in[n]->spacing, max[n]);
        assert_int_equal(again.size, twice.size);
        assert_memory_equal(again.bytes, twice.bytes, again.size);
        free(twice.bytes);
        free(again.bytes);
    }
}

static void test_generated(void **state) {
    (void)state;
    for (uint32_t levels = 1; levels <= 12; levels++) {
        block linear = generate(GIRIH_SPACING_LINEAR, levels);
        assert_lawful(linear.bytes, linear.size);
        const girih_catalogue *header = linear.bytes;
        assert_int_equal(header->pattern_count, levels * (levels + 1) * (levels + 2) / 6);
        free(linear.bytes);
    }
    for (uint32_t levels = 1; levels <= 6; levels++) {
        block dyadic = generate(GIRIH_SPACING_DYADIC, levels - 1);
        assert_lawful(dyadic.bytes, dyadic.size);
        const girih_catalogue *header = dyadic.bytes;
        assert_int_equal(header->pattern_count, levels * (levels + 1) * (levels + 2) / 6);
        free(dyadic.bytes);
    }
}

// A pattern of more than 65,536 vertices has 32-bit indices, one of more than 256 16-bit ones, a smaller one 8-bit ones.
static void test_index_size(void **state) {
    (void)state;
    // The family that is built the fastest.
    block large = write_catalogue(&girih_family_quadtri, GIRIH_SPACING_DYADIC, 9);
    const girih_catalogue *catalogue = NULL;
    assert_int_equal(girih_catalogue_open(large.bytes, large.size, &catalogue, NULL), GIRIH_OK);
    assert_int_equal(catalogue->pattern_count, 220);
    uint32_t wide = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        assert_int_equal(pattern->index_bytes, pattern->vertex_count > 65536 ? 4 : pattern->vertex_count > 256 ? 2 : 1);
        wide += pattern->index_bytes == 4;
    }
    assert_int_equal(wide, 2); // [9,9,9] and [9,9,8]
    free(large.bytes);
}

static void test_ranges_are_checked(void **state) {
    (void)state;
    girih_error error;
    const girih_family *family = girih_family_find("uniform");
    assert_ptr_equal(family, &girih_family_uniform);
    assert_null(girih_family_find("penrose"));
    assert_int_equal(girih_catalogue_write(family, GIRIH_SPACING_LINEAR, 0, "x", NULL, &error),
                     GIRIH_ERROR_INVALID_ARGUMENT);
    assert_int_equal(girih_catalogue_write(family, GIRIH_SPACING_LINEAR, 129, "x", NULL, &error),
                     GIRIH_ERROR_INVALID_ARGUMENT);
    assert_int_equal(girih_catalogue_write(family, GIRIH_SPACING_DYADIC, 13, "x", NULL, &error),
                     GIRIH_ERROR_INVALID_ARGUMENT);
}

static void test_levels(void **state) {
    (void)state;
    const girih_catalogue *dyadic = girih_catalogue_dyadic();
    const girih_catalogue *linear = girih_catalogue_linear();
    for (uint32_t segments = 0; segments <= 300; segments++) {
        int clamped = -1;
        uint32_t level = girih_catalogue_level(dyadic, segments, &clamped);
        assert_true(level < 7);
        assert_int_equal(clamped, segments > 64);
        assert_true(clamped || girih_catalogue_segments(dyadic, level) >= segments);
        assert_true(level == 0 || girih_catalogue_segments(dyadic, level - 1) < segments);

        level = girih_catalogue_level(linear, segments, &clamped);
        assert_int_equal(clamped, segments > 16);
        assert_int_equal(girih_catalogue_segments(linear, level),
                         segments == 0 ? 1 : segments > 16 ? 16 : segments);
    }
    assert_int_equal(girih_catalogue_level(dyadic, UINT32_MAX, NULL), 6);
    assert_int_equal(girih_catalogue_level(linear, UINT32_MAX, NULL), 15);
}

static void test_wrong_arguments(void **state) {
    (void)state;
    const girih_catalogue *dyadic = girih_catalogue_dyadic();
    const girih_catalogue *catalogue = NULL;
    assert_int_equal(girih_catalogue_open(NULL, 96, &catalogue, NULL),
                     GIRIH_ERROR_INVALID_ARGUMENT);
    assert_int_equal(girih_catalogue_open(dyadic, dyadic->bytes, NULL, NULL),
                     GIRIH_ERROR_INVALID_ARGUMENT);
    assert_int_equal(girih_catalogue_open((const char *)dyadic + 4, dyadic->bytes - 4, &catalogue,
                                          NULL),
                     GIRIH_ERROR_INVALID_ARGUMENT);
}

// Every value of every byte of the header, and one bit of some 4,000 other bytes, one at a time.
static void test_damage_is_refused(void **state) {
    (void)state;
    const girih_catalogue *dyadic = girih_catalogue_dyadic();
    size_t size = dyadic->bytes;
    unsigned char *bytes = malloc(size);
    assert_non_null(bytes);
    memcpy(bytes, dyadic, size);
    size_t step = size / 4001;
    size_t damaged = 0;
    for (size_t offset = 0; offset < size; offset += offset < sizeof *dyadic ? 1 : step) {
        unsigned char kept = bytes[offset];
        bytes[offset] = (unsigned char)(kept ^ 1u << offset % 8);
        assert_refused(bytes, size);
        if (offset < sizeof *dyadic) {
            for (unsigned other = 0; other < 256; other++) {
                if (other != kept) {
                    bytes[offset] = (unsigned char)other;
                    assert_refused(bytes, size);
                }
            }
        }
        bytes[offset] = kept;
        damaged++;
    }
    assert_true(damaged >= 4000);
    assert_lawful(bytes, size);
    free(bytes);
}

// Truncated blocks live in memory of just their size, so that a sanitizer sees a read beyond.
static void test_truncation_is_refused(void **state) {
    (void)state;
    const girih_catalogue *dyadic = girih_catalogue_dyadic();
    for (size_t size = 0; size < dyadic->bytes; size += size < 4096 ? 1 : 9973) {
        void *bytes = malloc(size > 0 ? size : 1);
        assert_non_null(bytes);
        memcpy(bytes, dyadic, size);
        assert_refused(bytes, size);
        if (size >= sizeof *dyadic) {
            // Also where the header knows about it.
            girih_catalogue *header = bytes;
            header->bytes = size;
            header->checksum = XXH64((const char *)bytes + 32, size - 32, 0);
            assert_refused(bytes, size);
        }
        free(bytes);
    }
}

// With its checksum mended.
static void forge(block *catalogue) {
    girih_catalogue *header = catalogue->bytes;
    header->checksum = XXH64((const char *)catalogue->bytes + 32, catalogue->size - 32, 0);
}

static void test_parents_are_checked(void **state) {
    (void)state;
    block small = generate(GIRIH_SPACING_LINEAR, 3);
    girih_catalogue *header = small.bytes;
    uint32_t *parents = (uint32_t *)((char *)small.bytes + header->parent_offset);
    const girih_base_pattern *last = girih_catalogue_pattern(header, header->pattern_count - 1);
    assert_ptr_equal(girih_catalogue_parents(header, last), parents + last->first_vertex);

    const uint32_t kept = parents[5];
    parents[5] = GIRIH_BARYCENTRIC_ONE | 1u << 16;
    forge(&small);
    assert_refused(small.bytes, small.size);
    parents[5] = kept;
    const uint64_t offsets[] = {0, header->vertex_offset, header->parent_offset + 2, header->parent_offset + 4,
                                header->bytes, UINT64_MAX - 3};
    const uint64_t offset = header->parent_offset;
    for (size_t n = 0; n < sizeof offsets / sizeof *offsets; n++) {
        header->parent_offset = offsets[n];
        forge(&small);
        assert_refused(small.bytes, small.size);
    }
    header->parent_offset = offset;
    forge(&small);
    assert_lawful(small.bytes, small.size);

    // Places inside, but against the laws.
    parents[last->first_vertex] = parents[last->first_vertex + 1];
    forge(&small);
    girih_error error = {.message = ""};
    assert_int_equal(girih_catalogue_open(small.bytes, small.size, &(const girih_catalogue *){NULL}, NULL), GIRIH_OK);
    assert_int_equal(girih_laws_check_catalogue(header, &error), GIRIH_ERROR_INVALID_DATA);
    assert_non_null(strstr(error.message, "parent"));
    free(small.bytes);
}

static void test_other_versions_are_refused(void **state) {
    (void)state;
    block small = generate(GIRIH_SPACING_LINEAR, 3);
    girih_catalogue *header = small.bytes;
    assert_int_equal(header->version, 3);
    header->version = 2;
    girih_error error = {.message = ""};
    const girih_catalogue *catalogue = NULL;
    assert_int_equal(girih_catalogue_open(small.bytes, small.size, &catalogue, &error), GIRIH_ERROR_INVALID_DATA);
    assert_string_equal(error.message, "catalogue: format version 2, only 3 is known; generate it anew");
    free(small.bytes);
}

// Bytes changed behind the checksum's back: refused, or still safe to use. The laws read every
// vertex and index.
static void test_forged_catalogues_are_safe(void **state) {
    (void)state;
    block small = generate(GIRIH_SPACING_LINEAR, 3);
    unsigned char *bytes = small.bytes;
    static const unsigned char values[] = {0, 1, 2, 3, 4, 5, 16, 127, 128, 255};
    size_t accepted = 0;
    size_t refused = 0;
    for (size_t offset = 0; offset < small.size; offset++) {
        unsigned char kept = bytes[offset];
        if (offset >= 24 && offset < 32) {
            continue; // the checksum itself
        }
        for (size_t n = 0; n < sizeof values; n++) {
            if (values[n] == kept) {
                continue;
            }
            bytes[offset] = values[n];
            uint64_t checksum = XXH64(bytes + 32, small.size - 32, 0);
            memcpy(bytes + 24, &checksum, sizeof checksum);
            const girih_catalogue *catalogue = NULL;
            if (girih_catalogue_open(bytes, small.size, &catalogue, NULL) == GIRIH_OK) {
                girih_laws_check_catalogue(catalogue, NULL);
                accepted++;
            } else {
                refused++;
            }
        }
        bytes[offset] = kept;
    }
    assert_true(refused > 1000);
    assert_true(accepted > 0);
    free(small.bytes);
}

// What `info --json` and `dump --json` print is JSON of the documented form.
static json_t *printed(void (*print)(const girih_catalogue *, FILE *),
                       const girih_catalogue *catalogue) {
    FILE *stream = tmpfile();
    assert_non_null(stream);
    print(catalogue, stream);
    rewind(stream);
    json_error_t error;
    json_t *json = json_loadf(stream, 0, &error);
    assert_non_null(json);
    fclose(stream);
    return json;
}

static void print_info(const girih_catalogue *catalogue, FILE *stream) {
    assert_int_equal(girih_report_info(catalogue, GIRIH_REPORT_JSON, NULL, stream, NULL), GIRIH_OK);
}

static void print_dump(const girih_catalogue *catalogue, FILE *stream) {
    assert_int_equal(girih_report_dump(catalogue, true, stream, NULL), GIRIH_OK);
}

static json_int_t integer(const json_t *object, const char *name) {
    const json_t *value = json_object_get(object, name);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

static void test_json(void **state) {
    (void)state;
    block linear = generate(GIRIH_SPACING_LINEAR, 10);
    const girih_catalogue *catalogue = linear.bytes;
    json_t *info = printed(print_info, catalogue);
    assert_true(json_object_size(info) > 11);
    assert_string_equal(json_string_value(json_object_get(info, "spacing")), "linear");
    assert_string_equal(json_string_value(json_object_get(info, "family")), "uniform");
    assert_int_equal(integer(info, "max"), 10);
    assert_int_equal(integer(info, "base_patterns"), 220);
    assert_int_equal(integer(info, "adaptive_patterns"), 1000);
    assert_int_equal(integer(info, "degenerate_triangles"), 0);
    assert_int_equal(integer(info, "bytes"), linear.size);
    double mean = json_real_value(json_object_get(info, "mean_min_angle"));
    double worst = json_real_value(json_object_get(info, "worst_min_angle"));
    assert_true(worst > 0 && worst < mean && mean < 60);
    assert_int_equal(json_array_size(json_object_get(info, "worst_pattern")), 3);
    assert_int_equal(json_array_size(json_object_get(info, "patterns")), 220);
    assert_int_equal(json_array_size(json_object_get(info, "min_angle_histogram")), 12);
    assert_int_equal(json_object_size(json_object_get(info, "shapes")), 4);

    json_t *dump = printed(print_dump, catalogue);
    assert_int_equal(integer(dump, "denominator"), 32768);
    assert_int_equal(integer(dump, "max"), 10);
    assert_string_equal(json_string_value(json_object_get(dump, "family")), "uniform");
    const json_t *patterns = json_object_get(dump, "patterns");
    assert_int_equal(json_array_size(patterns), 220);
    size_t vertices = 0;
    size_t triangles = 0;
    for (size_t n = 0; n < 220; n++) {
        const json_t *pattern = json_array_get(patterns, n);
        assert_int_equal(json_array_size(json_object_get(pattern, "levels")), 3);
        const json_t *levels = json_object_get(pattern, "levels");
        const json_t *list = json_object_get(pattern, "vertices");
        json_int_t border = 0;
        for (size_t m = 0; m < json_array_size(list); m++) {
            json_int_t sum = 0;
            int zeros = 0;
            for (size_t corner = 0; corner < 3; corner++) {
                json_int_t weight =
                    json_integer_value(json_array_get(json_array_get(list, m), corner));
                sum += weight;
                zeros += weight == 0;
            }
            assert_int_equal(sum, 32768);
            border += zeros > 0;
        }
        // Linear levels are segments: together as many as the border has vertices.
        for (size_t edge = 0; edge < 3; edge++) {
            border -= json_integer_value(json_array_get(levels, edge));
        }
        assert_int_equal(border, 0);
        vertices += json_array_size(list);
        triangles += json_array_size(json_object_get(pattern, "triangles"));
    }
    assert_int_equal(vertices, integer(info, "vertices"));
    assert_int_equal(triangles, integer(info, "triangles"));
    json_decref(dump);
    json_decref(info);
    free(linear.bytes);
}

// Triangles without area are drawn, so they are counted, but no angle is measured in them.
static void test_degenerate_triangles_are_counted(void **state) {
    (void)state;
    block linear = write_catalogue(&girih_family_semiuniform, GIRIH_SPACING_LINEAR, 6);
    assert_lawful(linear.bytes, linear.size);
    uint64_t expected = 0;
    for (uint32_t i = 1; i <= 6; i++) {
        for (uint32_t j = 1; j <= i; j++) {
            for (uint32_t k = 1; k <= j; k++) {
                expected += 2 * i - j - k;
            }
        }
    }
    assert_int_equal(girih_laws_count_degenerate(linear.bytes), expected);
    json_t *info = printed(print_info, linear.bytes);
    assert_int_equal(integer(info, "degenerate_triangles"), expected);
    assert_true(json_real_value(json_object_get(info, "worst_min_angle")) > 1);
    json_decref(info);

    // The family's name decides: no other may have them.
    girih_catalogue *header = linear.bytes;
    girih_error error;
    memcpy(header->family, "uniform", sizeof "uniform");
    assert_int_equal(girih_laws_check_catalogue(header, &error), GIRIH_ERROR_INVALID_DATA);
    memcpy(header->family, "penrose", sizeof "penrose");
    assert_int_equal(girih_laws_check_catalogue(header, &error), GIRIH_ERROR_INVALID_DATA);
    assert_non_null(strstr(error.message, "degenerate"));
    free(linear.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_built_ins),
        cmocka_unit_test(test_same_bytes_twice),
        cmocka_unit_test(test_generated),
        cmocka_unit_test(test_index_size),
        cmocka_unit_test(test_ranges_are_checked),
        cmocka_unit_test(test_levels),
        cmocka_unit_test(test_wrong_arguments),
        cmocka_unit_test(test_damage_is_refused),
        cmocka_unit_test(test_truncation_is_refused),
        cmocka_unit_test(test_parents_are_checked),
        cmocka_unit_test(test_other_versions_are_refused),
        cmocka_unit_test(test_forged_catalogues_are_safe),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_degenerate_triangles_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
