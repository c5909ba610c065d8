#include "import.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "json_reader.h"
#include "laws.h"
#include "writer.h"

// A catalogue's reader accepts no more in one pattern.
#define MOST_VERTICES (1u << 24)
#define MOST_TRIANGLES (UINT32_MAX / 3)
#define LARGEST_DENOMINATOR (UINT32_C(1) << 31)

// A pattern as the file has it: weights over the file's denominator, three a vertex.
typedef struct raw_pattern {
    uint32_t levels[3]; // as people count them
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t *weights;
    uint32_t *indices;
} raw_pattern;

// The file's values, in whatever order they come.
typedef struct import_document {
    json_t *spacing;
    json_t *max;
    json_t *denominator;
    json_t *family;
    bool has_patterns;
    raw_pattern *patterns;
    uint32_t pattern_count;
    uint32_t capacity;
} import_document;

// Three whole numbers of at most `most`.
static bool read_three(const json_t *list, uint32_t most, uint32_t numbers[3]) {
    if (json_array_size(list) != 3) {
        return false;
    }
    for (size_t n = 0; n < 3; n++) {
        const json_t *number = json_array_get(list, n);
        const json_int_t value = json_integer_value(number);
        if (!json_is_integer(number) || value < 0 || value > most) {
            return false;
        }
        numbers[n] = (uint32_t)value;
    }
    return true;
}

static girih_result read_rows(const raw_pattern *pattern, const json_t *object, const char *key,
                              uint32_t most_rows, uint32_t most, uint32_t **numbers,
                              uint32_t *count, girih_error *error) {
    const uint32_t *levels = pattern->levels;
    const json_t *list = json_object_get(object, key);
    const size_t rows = json_array_size(list);
    if (rows == 0 || rows > most_rows) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32
                          "]: \"%s\" is no list of 1 to %" PRIu32,
                          levels[0], levels[1], levels[2], key, most_rows);
    }
    *numbers = malloc(rows * 3 * sizeof **numbers);
    if (!*numbers) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for a pattern's %s", key);
    }
    *count = (uint32_t)rows;
    for (size_t n = 0; n < rows; n++) {
        if (!read_three(json_array_get(list, n), most, *numbers + 3 * n)) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32
                              "]: %s[%zu] is not three whole numbers from 0 to %" PRIu32,
                              levels[0], levels[1], levels[2], key, n, most);
        }
    }
    return GIRIH_OK;
}

static girih_result read_pattern(import_document *document, const json_t *object,
                                 girih_error *error) {
    if (document->pattern_count == document->capacity) {
        const uint32_t capacity = 2 * document->capacity + 64;
        raw_pattern *grown = realloc(document->patterns, capacity * sizeof *grown);
        if (!grown) {
            return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                              "no memory for %" PRIu32 " patterns", capacity);
        }
        document->patterns = grown;
        document->capacity = capacity;
    }
    const uint32_t place = document->pattern_count++;
    raw_pattern *pattern = &document->patterns[place];
    *pattern = (raw_pattern){.vertex_count = 0};
    if (!read_three(json_object_get(object, "levels"), UINT32_MAX, pattern->levels)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "patterns[%" PRIu32 "]: \"levels\" is not three whole numbers", place);
    }
    girih_result result = read_rows(pattern, object, "vertices", MOST_VERTICES, LARGEST_DENOMINATOR,
                                    &pattern->weights, &pattern->vertex_count, error);
    if (result == GIRIH_OK) {
        result = read_rows(pattern, object, "triangles", MOST_TRIANGLES, pattern->vertex_count - 1,
                           &pattern->indices, &pattern->triangle_count, error);
    }
    return result;
}

static girih_result read_patterns(import_document *document, girih_json_reader *reader,
                                  girih_error *error) {
    girih_result result = girih_json_expect(reader, '[', error);
    document->has_patterns = true;
    if (result != GIRIH_OK || girih_json_take(reader, ']')) {
        return result;
    }
    do {
        json_t *object = girih_json_value(reader, error);
        result = object ? read_pattern(document, object, error) : GIRIH_ERROR_INVALID_DATA;
        json_decref(object);
    } while (result == GIRIH_OK && girih_json_take(reader, ','));
    return result == GIRIH_OK ? girih_json_expect(reader, ']', error) : result;
}

static girih_result read_member(import_document *document, girih_json_reader *reader,
                                const char *key, girih_error *error) {
    json_t *ignored = NULL;
    const bool is_patterns = strcmp(key, "patterns") == 0;
    json_t **value = strcmp(key, "spacing") == 0       ? &document->spacing
                     : strcmp(key, "max") == 0         ? &document->max
                     : strcmp(key, "denominator") == 0 ? &document->denominator
                     : strcmp(key, "family") == 0      ? &document->family
                                                       : &ignored;
    if (*value || (is_patterns && document->has_patterns)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "line %d: \"%s\" comes a second time",
                          reader->line, key);
    }
    if (is_patterns) {
        return read_patterns(document, reader, error);
    }
    *value = girih_json_value(reader, error);
    const girih_result result = *value ? GIRIH_OK : GIRIH_ERROR_INVALID_DATA;
    json_decref(ignored);
    return result;
}

static girih_result read_document(import_document *document, girih_json_reader *reader,
                                  girih_error *error) {
    girih_result result = girih_json_expect(reader, '{', error);
    const bool empty = result == GIRIH_OK && girih_json_peek(reader) == '}';
    while (result == GIRIH_OK && !empty) {
        json_t *key = girih_json_value(reader, error);
        if (!key) {
            result = GIRIH_ERROR_INVALID_DATA;
        } else if (!json_is_string(key)) {
            result = girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                "line %d: no JSON, a name is missing", reader->line);
        } else {
            result = girih_json_expect(reader, ':', error);
        }
        if (result == GIRIH_OK) {
            result = read_member(document, reader, json_string_value(key), error);
        }
        json_decref(key);
        if (!girih_json_take(reader, ',')) {
            break;
        }
    }
    if (result == GIRIH_OK) {
        result = girih_json_expect(reader, '}', error);
    }
    if (result == GIRIH_OK && girih_json_peek(reader) != EOF) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                            "line %d: something follows the closing brace", reader->line);
    }
    return result;
}

static void free_document(import_document *document) {
    json_decref(document->spacing);
    json_decref(document->max);
    json_decref(document->denominator);
    json_decref(document->family);
    for (uint32_t n = 0; n < document->pattern_count; n++) {
        free(document->patterns[n].weights);
        free(document->patterns[n].indices);
    }
    free(document->patterns);
}

// A whole number of the document; false where it is another value, or missing, or out of range.
static bool read_number(const json_t *value, uint32_t first, uint32_t last, uint32_t *number) {
    const json_int_t found = json_integer_value(value);
    if (!json_is_integer(value) || found < first || found > last) {
        return false;
    }
    *number = (uint32_t)found;
    return true;
}

static girih_result read_family(girih_import *import, const json_t *family, girih_error *error) {
    const char *name = family ? json_string_value(family) : "imported";
    bool printable = name && name[0];
    for (const char *at = name; printable && *at; at++) {
        printable = (unsigned char)*at >= ' ' && *at != 0x7f;
    }
    if (!printable || strlen(name) >= sizeof import->name) {
        return girih_fail(
            error, GIRIH_ERROR_INVALID_DATA,
            "\"family\" is not a name of 1 to %zu printable bytes; leave it out, or shorten it",
            sizeof import->name - 1);
    }
    memcpy(import->name, name, strlen(name) + 1);
    return GIRIH_OK;
}

static girih_result read_header(girih_import *import, const import_document *document,
                                uint32_t *denominator, girih_error *error) {
    const char *spacing = json_string_value(document->spacing);
    const bool dyadic = spacing && strcmp(spacing, "dyadic") == 0;
    if (!dyadic && !(spacing && strcmp(spacing, "linear") == 0)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "\"spacing\" is neither \"dyadic\" nor \"linear\"");
    }
    import->spacing = dyadic ? GIRIH_SPACING_DYADIC : GIRIH_SPACING_LINEAR;
    const uint32_t first = dyadic ? 0 : 1;
    const uint32_t last = dyadic ? GIRIH_LARGEST_DYADIC_LEVEL : GIRIH_LARGEST_LINEAR_COUNT;
    if (!read_number(document->max, first, last, &import->max)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "\"max\" is not a whole number from %" PRIu32 " to %" PRIu32
                          ", which \"spacing\": \"%s\" asks for",
                          first, last, spacing);
    }
    if (!read_number(document->denominator, 1, LARGEST_DENOMINATOR, denominator)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "\"denominator\" is not a whole number from 1 to %" PRIu32,
                          LARGEST_DENOMINATOR);
    }
    if (!document->has_patterns) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "\"patterns\" is missing");
    }
    return read_family(import, document->family, error);
}

// A list of patterns in a message: as many as fit, then how many more.
typedef struct name_list {
    char text[208];
    size_t length;
    uint32_t count;
    uint32_t left_out;
} name_list;

static void add_name(name_list *list, const uint32_t levels[3]) {
    const size_t room = 24; // for the longest name, and for how many more
    list->count++;
    if (list->length + 2 * room < sizeof list->text) {
        list->length += (size_t)snprintf(list->text + list->length, room,
                                         " [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]", levels[0],
                                         levels[1], levels[2]);
    } else {
        list->left_out++;
    }
}

static void end_names(name_list *list) {
    if (list->left_out > 0) {
        snprintf(list->text + list->length, sizeof list->text - list->length,
                 " and %" PRIu32 " more", list->left_out);
    }
}

// Names what `found`, a count by rank, does not have just once. `first` is the lowest level as
// people count.
static girih_result check_complete(const uint32_t *found, uint32_t level_count, uint32_t first,
                                   girih_error *error) {
    name_list missing = {.count = 0};
    name_list repeated = {.count = 0};
    for (uint32_t i = 0; i < level_count; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++, found++) {
                const uint32_t levels[3] = {i + first, j + first, k + first};
                if (*found == 0) {
                    add_name(&missing, levels);
                } else if (*found > 1) {
                    add_name(&repeated, levels);
                }
            }
        }
    }
    if (missing.count + repeated.count == 0) {
        return GIRIH_OK;
    }
    end_names(&missing);
    end_names(&repeated);
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s%s%s%s%s",
                      missing.count > 0 ? "patterns are missing:" : "", missing.text,
                      missing.count > 0 && repeated.count > 0 ? "; " : "",
                      repeated.count > 0 ? "patterns are there more than once:" : "",
                      repeated.text);
}

// Where each of the file's patterns goes: its rank, in `ranks`.
static girih_result sort_patterns(const girih_import *import, const import_document *document,
                                  uint32_t *ranks, girih_error *error) {
    const bool dyadic = import->spacing == GIRIH_SPACING_DYADIC;
    const uint32_t first = dyadic ? 0 : 1;
    uint32_t *found = calloc(import->pattern_count, sizeof *found);
    if (!found) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %" PRIu32 " patterns",
                          import->pattern_count);
    }
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < document->pattern_count && result == GIRIH_OK; n++) {
        const uint32_t *levels = document->patterns[n].levels;
        if (levels[0] > import->max || levels[1] > levels[0] || levels[2] > levels[1] ||
            levels[2] < first) {
            result = girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                "patterns[%" PRIu32 "]: levels [%" PRIu32 ",%" PRIu32 ",%" PRIu32
                                "] are not i >= j >= k from %" PRIu32 " to %" PRIu32,
                                n, levels[0], levels[1], levels[2], first, import->max);
        } else {
            ranks[n] = girih_pattern_rank(
                (const uint32_t[3]){levels[0] - first, levels[1] - first, levels[2] - first});
            found[ranks[n]]++;
        }
    }
    if (result == GIRIH_OK) {
        result = check_complete(found, import->max + 1 - first, first, error);
    }
    free(found);
    return result;
}

// Weights over the catalogue's denominator, packed, without rounding.
static girih_result scale_vertices(const raw_pattern *raw, uint32_t denominator, uint32_t *packed,
                                   girih_error *error) {
    for (uint32_t n = 0; n < raw->vertex_count; n++) {
        const uint32_t *weights = raw->weights + 3 * (size_t)n;
        const char *wrong = NULL;
        uint64_t scaled[3];
        for (int m = 0; m < 3; m++) {
            scaled[m] = (uint64_t)weights[m] * GIRIH_BARYCENTRIC_ONE;
            if (scaled[m] % denominator != 0) {
                wrong = "cannot be written over 32768 without rounding";
            }
            scaled[m] /= denominator;
        }
        if ((uint64_t)weights[0] + weights[1] + weights[2] != denominator) {
            wrong = "does not add up to the denominator";
        }
        if (wrong) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]: vertices[%" PRIu32
                              "], [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "] over %" PRIu32 ", %s",
                              raw->levels[0], raw->levels[1], raw->levels[2], n, weights[0],
                              weights[1], weights[2], denominator, wrong);
        }
        packed[n] = girih_pack_vertex((uint32_t)scaled[0], (uint32_t)scaled[1]);
    }
    return GIRIH_OK;
}

// A vertex and where it stands in the file.
typedef struct placed_vertex {
    uint32_t packed;
    uint32_t place;
} placed_vertex;

static int compare_vertices(const void *a, const void *b) {
    const placed_vertex *left = a;
    const placed_vertex *right = b;
    if (left->packed != right->packed) {
        return left->packed < right->packed ? -1 : 1;
    }
    return (left->place > right->place) - (left->place < right->place);
}

// The first place in the file of a vertex; vertex_count where it is not there.
static uint32_t find_vertex(const placed_vertex *sorted, uint32_t vertex_count, uint32_t packed) {
    uint32_t first = 0;
    for (uint32_t end = vertex_count; first < end;) {
        const uint32_t middle = first + (end - first) / 2;
        if (sorted[middle].packed < packed) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first < vertex_count && sorted[first].packed == packed ? sorted[first].place
                                                                  : vertex_count;
}

// Where each of the file's vertices goes, in `order`: the border's to their places, which the
// pattern already has; the others behind them as they come. `order` begins as UINT32_MAX
// everywhere.
static girih_result order_vertices(girih_pattern *pattern, const raw_pattern *raw,
                                   const uint32_t *packed, const placed_vertex *sorted,
                                   uint32_t *order, girih_error *error) {
    uint32_t next = girih_border_count(pattern->segments);
    for (uint32_t n = 0; n < next; n++) {
        const uint32_t place = find_vertex(sorted, raw->vertex_count, pattern->vertices[n]);
        if (place == raw->vertex_count) {
            const uint32_t u = pattern->vertices[n] & 0xffff;
            const uint32_t v = pattern->vertices[n] >> 16;
            return girih_fail(
                error, GIRIH_ERROR_INVALID_DATA,
                "pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]: its border has no vertex [%" PRIu32
                ",%" PRIu32 ",%" PRIu32 "] over 32768, which edges of %" PRIu32 ", %" PRIu32
                " and %" PRIu32 " segments need",
                raw->levels[0], raw->levels[1], raw->levels[2], u, v, GIRIH_BARYCENTRIC_ONE - u - v,
                pattern->segments[0], pattern->segments[1], pattern->segments[2]);
        }
        order[place] = n;
    }
    for (uint32_t n = 0; n < raw->vertex_count; n++) {
        if (order[n] == UINT32_MAX) {
            pattern->vertices[next] = packed[n];
            order[n] = next++;
        }
    }
    return GIRIH_OK;
}

static girih_result place_pattern(girih_pattern *pattern, const raw_pattern *raw,
                                  uint32_t denominator, girih_error *error) {
    uint32_t *packed = malloc(raw->vertex_count * sizeof *packed);
    uint32_t *order = malloc(raw->vertex_count * sizeof *order);
    placed_vertex *sorted = malloc(raw->vertex_count * sizeof *sorted);
    girih_result result = GIRIH_OK;
    if (!packed || !order || !sorted) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %" PRIu32 " vertices",
                            raw->vertex_count);
    } else {
        result = scale_vertices(raw, denominator, packed, error);
    }
    if (result == GIRIH_OK) {
        for (uint32_t n = 0; n < raw->vertex_count; n++) {
            sorted[n] = (placed_vertex){packed[n], n};
            order[n] = UINT32_MAX;
        }
        qsort(sorted, raw->vertex_count, sizeof *sorted, compare_vertices);
        result = order_vertices(pattern, raw, packed, sorted, order, error);
    }
    for (size_t n = 0; n < (size_t)raw->triangle_count * 3 && result == GIRIH_OK; n++) {
        pattern->indices[n] = order[raw->indices[n]];
    }
    free(sorted);
    free(order);
    free(packed);
    return result;
}

static girih_result take_pattern(girih_import *import, uint32_t rank, const raw_pattern *raw,
                                 uint32_t denominator, girih_error *error) {
    uint32_t segments[3];
    for (int edge = 0; edge < 3; edge++) {
        segments[edge] = import->spacing == GIRIH_SPACING_DYADIC ? UINT32_C(1) << raw->levels[edge]
                                                                 : raw->levels[edge];
    }
    if (raw->vertex_count < girih_border_count(segments)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]: %" PRIu32
                          " vertices are too few, its border alone has %" PRIu32,
                          raw->levels[0], raw->levels[1], raw->levels[2], raw->vertex_count,
                          girih_border_count(segments));
    }
    girih_pattern *pattern = &import->patterns[rank];
    girih_result result =
        girih_pattern_allocate(pattern, segments, raw->vertex_count, raw->triangle_count, error);
    if (result == GIRIH_OK) {
        result = place_pattern(pattern, raw, denominator, error);
    }
    return result == GIRIH_OK ? girih_laws_check_built(import->name, pattern, error) : result;
}

static girih_result take_patterns(girih_import *import, const import_document *document,
                                  girih_error *error) {
    uint32_t denominator = 0;
    girih_result result = read_header(import, document, &denominator, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const uint32_t levels = import->spacing == GIRIH_SPACING_DYADIC ? import->max + 1 : import->max;
    import->pattern_count = levels * (levels + 1) * (levels + 2) / 6;
    import->patterns = calloc(import->pattern_count, sizeof *import->patterns);
    uint32_t *ranks = calloc((size_t)document->pattern_count + 1, sizeof *ranks);
    if (!import->patterns || !ranks) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %" PRIu32 " patterns",
                            import->pattern_count);
    } else {
        result = sort_patterns(import, document, ranks, error);
    }
    for (uint32_t n = 0; n < document->pattern_count && result == GIRIH_OK; n++) {
        result = take_pattern(import, ranks[n], &document->patterns[n], denominator, error);
    }
    free(ranks);
    return result;
}

// The family's `build`: a copy of the pattern read.
static girih_result copy_pattern(const girih_family *family, const uint32_t segments[3],
                                 girih_pattern *pattern, girih_error *error) {
    const girih_import *import = family->data;
    uint32_t levels[3] = {0, 0, 0};
    for (int edge = 0; edge < 3; edge++) {
        if (import->spacing == GIRIH_SPACING_LINEAR) {
            levels[edge] = segments[edge] - 1;
        } else {
            while (UINT32_C(1) << levels[edge] < segments[edge]) {
                levels[edge]++;
            }
        }
    }
    const girih_pattern *from = &import->patterns[girih_pattern_rank(levels)];
    girih_result result =
        girih_pattern_allocate(pattern, segments, from->vertex_count, from->triangle_count, error);
    if (result == GIRIH_OK) {
        memcpy(pattern->vertices, from->vertices, from->vertex_count * sizeof *from->vertices);
        memcpy(pattern->indices, from->indices,
               (size_t)from->triangle_count * 3 * sizeof *from->indices);
    }
    return result;
}

girih_result girih_import_read(girih_import *import, FILE *stream, girih_error *error) {
    *import = (girih_import){
        .family = {.name = import->name, .build = copy_pattern, .data = import, .ordered = true},
    };
    import_document document = {.has_patterns = false};
    girih_json_reader reader = girih_json_reader_of(stream);
    girih_result result = read_document(&document, &reader, error);
    if (result == GIRIH_OK) {
        result = take_patterns(import, &document, error);
    }
    free_document(&document);
    return result;
}

void girih_import_free(girih_import *import) {
    for (uint32_t rank = 0; import->patterns && rank < import->pattern_count; rank++) {
        girih_pattern_free(&import->patterns[rank]);
    }
    free(import->patterns);
    import->patterns = NULL;
}
