#include "report.h"

#include <inttypes.h>
#include <stdint.h>

#include <jansson.h>

#include "error.h"

const char *girih_report_spacing(const girih_catalogue *catalogue) {
    return catalogue->spacing == GIRIH_SPACING_DYADIC ? "dyadic" : "linear";
}

void girih_report_levels(const girih_catalogue *catalogue, const girih_base_pattern *pattern,
                         uint32_t levels[3]) {
    for (int edge = 0; edge < 3; edge++) {
        levels[edge] = catalogue->spacing == GIRIH_SPACING_LINEAR ? pattern->segments[edge]
                                                                  : pattern->levels[edge];
    }
}

// Weights of packed vertices.
static void print_places(const uint32_t *places, uint32_t count, bool json, FILE *stream) {
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t u = places[n] & 0xffff;
        const uint32_t v = places[n] >> 16;
        const char *separator = json && n > 0 ? "," : "";
        fprintf(stream, json ? "%s[%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]" : "%s%" PRIu32 " %" PRIu32 " %" PRIu32 "\n",
                separator, u, v, GIRIH_BARYCENTRIC_ONE - u - v);
    }
}

// Written number by number rather than through a JSON tree, which would take gigabytes for a large
// catalogue.
girih_result girih_report_dump(const girih_catalogue *catalogue, bool json, FILE *stream,
                               girih_error *error) {
    if (json) {
        json_t *family = json_string(catalogue->family);
        if (!family) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "the family's name is no UTF-8, which JSON needs");
        }
        fprintf(stream, "{\"spacing\":\"%s\",\"max\":%" PRIu32 ",\"family\":",
                girih_report_spacing(catalogue), catalogue->max);
        json_dumpf(family, stream, JSON_ENCODE_ANY);
        json_decref(family);
        fprintf(stream, ",\"denominator\":%u,\"patterns\":[", GIRIH_BARYCENTRIC_ONE);
    } else {
        fprintf(stream, "%s, max %" PRIu32 ", family %s, weights over %u\n",
                girih_report_spacing(catalogue), catalogue->max, catalogue->family, GIRIH_BARYCENTRIC_ONE);
    }
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        uint32_t levels[3];
        girih_report_levels(catalogue, pattern, levels);
        if (json) {
            fprintf(stream, "%s\n{\"levels\":[%u,%u,%u],\"vertices\":[", rank > 0 ? "," : "",
                    levels[0], levels[1], levels[2]);
        } else {
            fprintf(stream,
                    "\npattern [%u,%u,%u]: %" PRIu32 " vertices, %" PRIu32 " triangles\nvertices\n",
                    levels[0], levels[1], levels[2], pattern->vertex_count,
                    pattern->triangle_count);
        }
        print_places(girih_catalogue_vertices(catalogue, pattern), pattern->vertex_count, json, stream);
        fputs(json ? "],\"parents\":[" : "parents\n", stream);
        print_places(girih_catalogue_parents(catalogue, pattern), pattern->vertex_count, json, stream);
        fputs(json ? "],\"triangles\":[" : "triangles\n", stream);
        for (uint32_t n = 0; n < pattern->triangle_count; n++) {
            const char *separator = json && n > 0 ? "," : "";
            fprintf(stream, json ? "%s[%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]"
                                 : "%s%" PRIu32 " %" PRIu32 " %" PRIu32 "\n",
                    separator, girih_catalogue_index(catalogue, pattern, 3 * n),
                    girih_catalogue_index(catalogue, pattern, 3 * n + 1),
                    girih_catalogue_index(catalogue, pattern, 3 * n + 2));
        }
        if (json) {
            fputs("]}", stream);
        }
    }
    if (json) {
        fputs("\n]}\n", stream);
    }
    return GIRIH_OK;
}

void girih_report_embed(const girih_catalogue *catalogue, const char *symbol, FILE *stream) {
    const uint64_t *words = (const void *)catalogue;
    uint64_t count = (catalogue->bytes + 7) / 8;
    fprintf(stream,
            "// Written by `girih-patterns embed`: %s, max %" PRIu32 ", family %s.\n"
            "#include <stddef.h>\n"
            "#include <stdint.h>\n"
            "\n"
            "extern const uint64_t %s[];\n"
            "extern const size_t %s_size;\n"
            "const size_t %s_size = %" PRIu64 ";\n"
            "const uint64_t %s[] = {",
            girih_report_spacing(catalogue), catalogue->max, catalogue->family, symbol, symbol, symbol,
            catalogue->bytes, symbol);
    for (uint64_t n = 0; n < count; n++) {
        fprintf(stream, "%s0x%" PRIx64 "u,", n % 8 == 0 ? "\n" : "", words[n]);
    }
    fputs("\n};\n", stream);
}
