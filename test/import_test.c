// Catalogues from JSON: what is dumped comes back the same, whatever the order; what is wrong is
// refused.
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

#include "catalogue_files.h"
#include "import.h"
#include "laws.h"
#include "report.h"

static block dump(const girih_catalogue *catalogue) {
    FILE *stream = tmpfile();
    assert_non_null(stream);
    assert_int_equal(girih_report_dump(catalogue, true, stream, NULL), GIRIH_OK);
    return read_stream(stream);
}

static girih_result import_text(girih_import *import, const char *text, size_t size,
                                girih_error *error) {
    FILE *stream = fmemopen((void *)text, size, "rb");
    assert_non_null(stream);
    girih_result result = girih_import_read(import, stream, error);
    fclose(stream);
    return result;
}

// Imports a JSON text and gives the catalogue's bytes.
static block imported(const char *text, size_t size) {
    girih_import import;
    girih_error error = {.message = ""};
    import_text(&import, text, size, &error);
    assert_string_equal(error.message, "");
    block catalogue = write_catalogue(&import.family, import.spacing, import.max);
    girih_import_free(&import);
    return catalogue;
}

static void assert_same(const block *a, const void *bytes, size_t size) {
    assert_int_equal(a->size, size);
    assert_memory_equal(a->bytes, bytes, size);
}

static void assert_comes_back(const void *bytes, size_t size) {
    const girih_catalogue *catalogue = NULL;
    assert_int_equal(girih_catalogue_open(bytes, size, &catalogue, NULL), GIRIH_OK);
    block text = dump(catalogue);
    block again = imported(text.bytes, text.size);
    assert_same(&again, bytes, size);
    free(again.bytes);
    free(text.bytes);
}

static void test_dumps_come_back(void **state) {
    (void)state;
    assert_comes_back(girih_catalogue_dyadic(), girih_catalogue_dyadic()->bytes);
    assert_comes_back(girih_catalogue_linear(), girih_catalogue_linear()->bytes);
    for (uint32_t family = 0; girih_family_at(family); family++) {
        for (uint32_t max = 1; max <= 5; max++) {
            block linear = write_catalogue(girih_family_at(family), GIRIH_SPACING_LINEAR, max);
            assert_comes_back(linear.bytes, linear.size);
            free(linear.bytes);
            block dyadic = write_catalogue(girih_family_at(family), GIRIH_SPACING_DYADIC, max - 1);
            assert_comes_back(dyadic.bytes, dyadic.size);
            free(dyadic.bytes);
        }
    }
}

static json_t *small_document(void) {
    block catalogue = write_catalogue(&girih_family_uniform, GIRIH_SPACING_LINEAR, 5);
    block text = dump(catalogue.bytes);
    json_t *document = json_loadb(text.bytes, text.size, 0, NULL);
    assert_non_null(document);
    free(text.bytes);
    free(catalogue.bytes);
    return document;
}

static char *print(const json_t *document, size_t flags) {
    char *text = json_dumps(document, flags);
    assert_non_null(text);
    return text;
}

// Turns a pattern's vertices around, with the indices that go with them. Those inside keep their
// order among each other, which is not part of the catalogue's.
static void reorder_vertices(json_t *pattern) {
    json_t *vertices = json_object_get(pattern, "vertices");
    const size_t count = json_array_size(vertices);
    size_t border = 0;
    size_t n;
    json_t *value;
    json_array_foreach(json_object_get(pattern, "levels"), n, value) {
        border += (size_t)json_integer_value(value);
    }
    json_t *reordered = json_array();
    for (n = 0; n < count; n++) {
        // The inner ones first, then the border backwards.
        const size_t from = n < count - border ? border + n : count - 1 - n;
        json_array_append(reordered, json_array_get(vertices, from));
    }
    json_t *triangle;
    json_array_foreach(json_object_get(pattern, "triangles"), n, triangle) {
        for (size_t corner = 0; corner < 3; corner++) {
            const size_t old = (size_t)json_integer_value(json_array_get(triangle, corner));
            const size_t new = old >= border ? old - border : count - 1 - old;
            json_array_set_new(triangle, corner, json_integer((json_int_t) new));
        }
    }
    json_object_set_new(pattern, "vertices", reordered);
}

static void test_any_order(void **state) {
    (void)state;
    block expected = write_catalogue(&girih_family_uniform, GIRIH_SPACING_LINEAR, 5);
    json_t *document = small_document();
    json_t *patterns = json_object_get(document, "patterns");
    json_t *backwards = json_array();
    for (size_t n = json_array_size(patterns); n > 0; n--) {
        reorder_vertices(json_array_get(patterns, n - 1));
        json_array_append(backwards, json_array_get(patterns, n - 1));
    }
    json_object_set_new(document, "patterns", backwards);
    json_object_set_new(document, "comment", json_pack("{s:[ifbn]}", "more", 1, 0.5, 1));
    // Sorted, "denominator" comes before and "spacing" after the patterns.
    char *text = print(document, JSON_SORT_KEYS | JSON_INDENT(3));
    block catalogue = imported(text, strlen(text));
    assert_same(&catalogue, expected.bytes, expected.size);
    free(catalogue.bytes);
    free(text);
    json_decref(document);
    free(expected.bytes);
}

static void scale(json_t *document, json_int_t by) {
    json_t *patterns = json_object_get(document, "patterns");
    size_t n;
    size_t m;
    json_t *pattern;
    json_t *vertex;
    json_array_foreach(patterns, n, pattern) {
        json_array_foreach(json_object_get(pattern, "vertices"), m, vertex) {
            for (size_t corner = 0; corner < 3; corner++) {
                json_t *weight = json_array_get(vertex, corner);
                json_integer_set(weight, json_integer_value(weight) * by);
            }
        }
    }
    json_object_set_new(document, "denominator", json_integer(32768 * by));
}

static void test_denominators(void **state) {
    (void)state;
    block expected = write_catalogue(&girih_family_uniform, GIRIH_SPACING_LINEAR, 5);
    static const json_int_t factors[] = {2, 3, 65536};
    for (size_t n = 0; n < sizeof factors / sizeof *factors; n++) {
        json_t *document = small_document();
        scale(document, factors[n]);
        char *text = print(document, JSON_COMPACT);
        block catalogue = imported(text, strlen(text));
        assert_same(&catalogue, expected.bytes, expected.size);
        free(catalogue.bytes);
        free(text);
        json_decref(document);
    }
    free(expected.bytes);
    // A smaller one will do where the vertices are so.
    static const char halves[] =
        "{\"spacing\":\"dyadic\",\"max\":1,\"denominator\":2,\"patterns\":["
        "{\"levels\":[0,0,0],\"vertices\":[[2,0,0],[0,2,0],[0,0,2]],\"triangles\":[[0,1,2]]},"
        "{\"levels\":[1,0,0],\"vertices\":[[0,0,2],[1,1,0],[2,0,0],[0,2,0]],"
        "\"triangles\":[[2,1,0],[1,3,0]]},"
        "{\"levels\":[1,1,0],\"vertices\":[[2,0,0],[0,2,0],[0,0,2],[1,1,0],[0,1,1]],"
        "\"triangles\":[[0,3,2],[3,4,2],[3,1,4]]},"
        "{\"levels\":[1,1,1],\"vertices\":[[2,0,0],[0,2,0],[0,0,2],[1,1,0],[0,1,1],[1,0,1]],"
        "\"triangles\":[[0,3,5],[3,1,4],[5,4,2],[3,4,5]]}]}";
    block catalogue = imported(halves, strlen(halves));
    const girih_catalogue *opened = NULL;
    assert_int_equal(girih_catalogue_open(catalogue.bytes, catalogue.size, &opened, NULL),
                     GIRIH_OK);
    assert_int_equal(girih_laws_check_catalogue(opened, NULL), GIRIH_OK);
    assert_string_equal(opened->family, "imported");
    free(catalogue.bytes);
}

static void assert_refused(const char *text, const char *reason) {
    girih_import import;
    girih_error error = {.message = ""};
    assert_true(import_text(&import, text, strlen(text), &error) != GIRIH_OK);
    girih_import_free(&import);
    assert_null(strchr(error.message, '\n'));
    if (!strstr(error.message, reason)) {
        print_error("'%s', not '%s'\n", error.message, reason);
    }
    assert_non_null(strstr(error.message, reason));
}

// What a change does to the document is refused for this reason. The change is "key=value" of the
// document, with value in JSON; without a value the key is removed.
static void assert_change_refused(const char *key, const char *value, const char *reason) {
    json_t *document = small_document();
    if (value) {
        json_t *parsed = json_loads(value, JSON_DECODE_ANY, NULL);
        assert_non_null(parsed);
        json_object_set_new(document, key, parsed);
    } else {
        json_object_del(document, key);
    }
    char *text = print(document, 0);
    assert_refused(text, reason);
    free(text);
    json_decref(document);
}

static void test_wrong_headers(void **state) {
    (void)state;
    assert_change_refused("spacing", NULL, "\"spacing\" is neither");
    assert_change_refused("spacing", "\"cubic\"", "\"spacing\" is neither");
    assert_change_refused("max", NULL, "\"max\" is not a whole number from 1 to 128");
    assert_change_refused("max", "0", "\"max\" is not");
    assert_change_refused("max", "5.0", "\"max\" is not");
    assert_change_refused("max", "6", "patterns are missing: [6,1,1] [6,2,1]");
    assert_change_refused("max", "4", "are not i >= j >= k from 1 to 4");
    assert_change_refused("max", "128", "more");
    assert_change_refused("denominator", NULL, "\"denominator\" is not");
    assert_change_refused("denominator", "0", "\"denominator\" is not");
    assert_change_refused("denominator", "-32768", "\"denominator\" is not");
    assert_change_refused("denominator", "32767", "does not add up to the denominator");
    assert_change_refused("family", "\"\"", "\"family\" is not");
    assert_change_refused("family", "\"a name of 16 byt\"", "\"family\" is not");
    assert_change_refused("family", "\"a\\nb\"", "\"family\" is not");
    assert_change_refused("family", "7", "\"family\" is not");
    assert_change_refused("patterns", NULL, "\"patterns\" is missing");
    assert_change_refused("patterns", "[]", "patterns are missing: [1,1,1]");
    assert_change_refused("patterns", "{}", "'[' is missing");
    assert_change_refused("patterns", "[7]", "patterns[0]: \"levels\"");
    assert_change_refused("patterns", "[{\"levels\":[3,2]}]", "patterns[0]: \"levels\"");
    assert_change_refused("patterns", "[{\"levels\":[1,1,1]}]", "\"vertices\" is no list");
}

// As in a file of thirds over 3, which no vertex of the catalogue can have.
static void test_inexact_weights(void **state) {
    (void)state;
    assert_refused("{\"spacing\":\"linear\",\"max\":1,\"denominator\":3,\"patterns\":[{\"levels\":"
                   "[1,1,1],\"vertices\":[[3,0,0],[0,3,0],[0,0,3],[1,1,1]],\"triangles\":"
                   "[[0,1,3],[1,2,3],[2,0,3]]}]}",
                   "vertices[3], [1,1,1] over 3, cannot be written over 32768 without rounding");
}

typedef void pattern_change(json_t *pattern);

// Changes pattern [3,2,1].
static void assert_pattern_refused(pattern_change *change, const char *reason) {
    json_t *document = small_document();
    change(json_array_get(json_object_get(document, "patterns"), 5));
    char *text = print(document, 0);
    assert_refused(text, reason);
    free(text);
    json_decref(document);
}

static json_t *row(json_t *pattern, const char *key, size_t n) {
    return json_array_get(json_object_get(pattern, key), n);
}

static void add_corner(json_t *pattern) {
    json_array_append_new(row(pattern, "triangles", 2), json_integer(0));
}

static void swap_corners(json_t *pattern) {
    json_t *triangle = row(pattern, "triangles", 2);
    json_t *first = json_incref(json_array_get(triangle, 0));
    json_array_set(triangle, 0, json_array_get(triangle, 1));
    json_array_set_new(triangle, 1, first);
}

static void repeat_corner(json_t *pattern) {
    json_t *triangle = row(pattern, "triangles", 2);
    json_array_set(triangle, 0, json_array_get(triangle, 1));
}

static void drop_triangle(json_t *pattern) {
    json_array_remove(json_object_get(pattern, "triangles"), 1);
}

static void drop_all_triangles(json_t *pattern) {
    json_array_clear(json_object_get(pattern, "triangles"));
}

static void move_border_vertex(json_t *pattern) {
    json_t *vertex = row(pattern, "vertices", 3);
    json_integer_set(json_array_get(vertex, 0), json_integer_value(json_array_get(vertex, 0)) - 1);
    json_integer_set(json_array_get(vertex, 1), json_integer_value(json_array_get(vertex, 1)) + 1);
}

static void lose_weight(json_t *pattern) {
    json_t *vertex = row(pattern, "vertices", 4);
    json_integer_set(json_array_get(vertex, 0), json_integer_value(json_array_get(vertex, 0)) - 1);
}

static void add_vertex(json_t *pattern) {
    json_array_append_new(json_object_get(pattern, "vertices"),
                          json_pack("[iii]", 32768 / 4, 32768 / 4, 32768 / 2));
}

static void repeat_vertex(json_t *pattern) {
    json_array_append(json_object_get(pattern, "vertices"), row(pattern, "vertices", 0));
}

static void drop_vertices(json_t *pattern) {
    json_object_set_new(pattern, "vertices",
                        json_pack("[[iii][iii][iii]]", 32768, 0, 0, 0, 32768, 0, 0, 0, 32768));
    json_object_set_new(pattern, "triangles", json_pack("[[iii]]", 0, 1, 2));
}

static void wide_index(json_t *pattern) {
    json_integer_set(json_array_get(row(pattern, "triangles", 0), 0), 99);
}

static void fraction(json_t *pattern) {
    json_array_set_new(row(pattern, "vertices", 1), 0, json_real(0.5));
}

static void negative(json_t *pattern) {
    json_integer_set(json_array_get(row(pattern, "vertices", 1), 0), -1);
}

static void other_levels(json_t *pattern) {
    json_object_set_new(pattern, "levels", json_pack("[iii]", 3, 1, 1));
}

static void unsorted_levels(json_t *pattern) {
    json_object_set_new(pattern, "levels", json_pack("[iii]", 2, 3, 1));
}

static void test_wrong_patterns(void **state) {
    (void)state;
    assert_pattern_refused(swap_corners,
                           "3, 2, 1 segments: a triangle is degenerate or turned over");
    assert_pattern_refused(repeat_corner, "3, 2, 1 segments: a triangle is degenerate");
    assert_pattern_refused(add_corner, "[3,2,1]: triangles[2] is not three whole numbers");
    assert_pattern_refused(drop_triangle, "3, 2, 1 segments: ");
    assert_pattern_refused(drop_all_triangles, "[3,2,1]: \"triangles\" is no list");
    assert_pattern_refused(move_border_vertex, "[3,2,1]: its border has no vertex [21845,10923,0]");
    assert_pattern_refused(lose_weight, "[3,2,1]: vertices[4], ");
    assert_pattern_refused(add_vertex, "3, 2, 1 segments: a vertex is in no triangle");
    assert_pattern_refused(repeat_vertex, "3, 2, 1 segments: two vertices coincide");
    assert_pattern_refused(drop_vertices,
                           "[3,2,1]: 3 vertices are too few, its border alone has 6");
    assert_pattern_refused(wide_index,
                           "[3,2,1]: triangles[0] is not three whole numbers from 0 to 6");
    assert_pattern_refused(fraction, "[3,2,1]: vertices[1] is not three whole numbers");
    assert_pattern_refused(negative, "[3,2,1]: vertices[1] is not three whole numbers");
    assert_pattern_refused(
        other_levels, "patterns are missing: [3,2,1]; patterns are there more than once: [3,1,1]");
    assert_pattern_refused(unsorted_levels,
                           "patterns[5]: levels [2,3,1] are not i >= j >= k from 1 to 5");
}

static void test_wrong_json(void **state) {
    (void)state;
    assert_refused(" ", "line 1: no JSON, '{' is missing");
    assert_refused("[]", "line 1: no JSON, '{' is missing");
    assert_refused("{}", "\"spacing\" is neither");
    assert_refused("{\"max\":1,\n\"max\":2}", "line 2: \"max\" comes a second time");
    assert_refused("{\"patterns\":[],\n\"patterns\":[]}",
                   "line 2: \"patterns\" comes a second time");
    assert_refused("{\"max\":1} {}", "line 1: something follows the closing brace");
    assert_refused("{\"max\" 1}", "line 1: no JSON, ':' is missing");
    assert_refused("{\"max\":\n\n1 \"x\"}", "line 3: no JSON, '}' is missing");
    assert_refused("{7:1}", "line 1: no JSON, a name is missing");
    assert_refused("{\"max\":1,}", "line 1: no JSON, ");
    assert_refused("{\"patterns\":[\n{\n\"levels\":[1,1 1]}]}", "line 3: no JSON, ");
    assert_refused("{\"a\":\"two\nlines\"}", "line 1: no JSON, ");
}

// Text cut off anywhere, or with any byte changed: refused, or lawful.
static void test_damaged_text(void **state) {
    (void)state;
    block catalogue = write_catalogue(&girih_family_uniform, GIRIH_SPACING_LINEAR, 2);
    block text = dump(catalogue.bytes);
    for (size_t size = 1; size + 2 < text.size; size++) {
        girih_import import;
        girih_error error = {.message = ""};
        assert_true(import_text(&import, text.bytes, size, &error) != GIRIH_OK);
        girih_import_free(&import);
        assert_true(strlen(error.message) > 10);
        assert_null(strchr(error.message, '\n'));
    }
    static const char bytes[] = {0,   '\n', ' ', '"', ',', '0',    '9',   '-',
                                 '[', ']',  '{', '}', 'e', '\x80', '\xff'};
    for (size_t place = 0; place < text.size; place++) {
        char *changed = (char *)text.bytes + place;
        const char kept = *changed;
        for (size_t n = 0; n < sizeof bytes; n++) {
            *changed = bytes[n];
            girih_import import;
            girih_error error = {.message = ""};
            if (import_text(&import, text.bytes, text.size, &error) == GIRIH_OK) {
                for (uint32_t rank = 0; rank < import.pattern_count; rank++) {
                    const girih_pattern *pattern = &import.patterns[rank];
                    assert_int_equal(girih_laws_check_pattern(pattern->segments, pattern->vertices,
                                                              pattern->vertex_count,
                                                              pattern->indices,
                                                              pattern->triangle_count, false, NULL),
                                     GIRIH_OK);
                }
            } else {
                assert_true(strlen(error.message) > 10);
                assert_null(strchr(error.message, '\n'));
            }
            girih_import_free(&import);
        }
        *changed = kept;
    }
    free(text.bytes);
    free(catalogue.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_dumps_come_back), cmocka_unit_test(test_any_order),
        cmocka_unit_test(test_denominators),    cmocka_unit_test(test_wrong_headers),
        cmocka_unit_test(test_inexact_weights), cmocka_unit_test(test_wrong_patterns),
        cmocka_unit_test(test_wrong_json),      cmocka_unit_test(test_damaged_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
