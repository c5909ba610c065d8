#include "report.h"

#include <inttypes.h>
#include <math.h>
#include <stdint.h>

#include <jansson.h>

#include "error.h"
#include "laws.h"

typedef struct angles {
    double mean;  // of the patterns' smallest angles, in triangles with area
    double worst; // the smallest angle of all
    const girih_base_pattern *worst_pattern;
} angles;

static const char *spacing_name(const girih_catalogue *catalogue) {
    return catalogue->spacing == GIRIH_SPACING_DYADIC ? "dyadic" : "linear";
}

// The smallest angle in degrees of a triangle of an equilateral whole. It lies across from the
// shortest side, and with barycentric differences d, e of two sides, each adding up to zero,
// d . e = sum(d_n e_n) / 2 and |d x e| = sqrt(3) / 2 * |determinant|.
static double smallest_angle(const uint32_t corners[3]) {
    int64_t weights[3][3];
    for (int n = 0; n < 3; n++) {
        weights[n][0] = corners[n] & 0xffff;
        weights[n][1] = corners[n] >> 16;
        weights[n][2] = (int64_t)GIRIH_BARYCENTRIC_ONE - weights[n][0] - weights[n][1];
    }
    int64_t shortest = INT64_MAX;
    int64_t dot = 0;
    int64_t determinant = 0;
    for (int n = 0; n < 3; n++) {
        const int64_t *a = weights[(n + 1) % 3];
        const int64_t *b = weights[(n + 2) % 3];
        const int64_t *p = weights[n];
        int64_t length = 0;
        int64_t product = 0;
        for (int m = 0; m < 3; m++) {
            length += (b[m] - a[m]) * (b[m] - a[m]);
            product += (a[m] - p[m]) * (b[m] - p[m]);
        }
        if (length < shortest) {
            shortest = length;
            dot = product;
            determinant = (a[0] - p[0]) * (b[1] - p[1]) - (b[0] - p[0]) * (a[1] - p[1]);
        }
    }
    const double degrees = 57.295779513082320877;
    return degrees * atan2(sqrt(3.0) * (double)determinant, (double)dot);
}

static angles measure(const girih_catalogue *catalogue) {
    angles found = {.worst = 360, .worst_pattern = girih_catalogue_pattern(catalogue, 0)};
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        const uint32_t *vertices = girih_catalogue_vertices(catalogue, pattern);
        double smallest = 360;
        for (uint32_t n = 0; n < pattern->triangle_count; n++) {
            uint32_t corners[3];
            for (uint32_t corner = 0; corner < 3; corner++) {
                corners[corner] =
                    vertices[girih_catalogue_index(catalogue, pattern, 3 * n + corner)];
            }
            bool collapsed = corners[0] == corners[1] || corners[1] == corners[2] ||
                             corners[2] == corners[0];
            double angle = collapsed ? smallest : smallest_angle(corners);
            smallest = angle < smallest ? angle : smallest;
        }
        found.mean += smallest;
        if (smallest < found.worst) {
            found.worst = smallest;
            found.worst_pattern = pattern;
        }
    }
    found.mean /= (double)catalogue->pattern_count;
    return found;
}

// An edge's level as people count it, and as --max does: from 0 if dyadic, in segments if linear.
static uint32_t printed_level(const girih_catalogue *catalogue, const girih_base_pattern *pattern,
                              int edge) {
    return catalogue->spacing == GIRIH_SPACING_LINEAR ? pattern->segments[edge]
                                                      : pattern->levels[edge];
}

girih_result girih_report_info(const girih_catalogue *catalogue, bool json, FILE *stream,
                               girih_error *error) {
    angles found = measure(catalogue);
    uint32_t worst[3];
    for (int edge = 0; edge < 3; edge++) {
        worst[edge] = printed_level(catalogue, found.worst_pattern, edge);
    }
    uint64_t levels = catalogue->level_count;
    uint64_t degenerate = girih_laws_count_degenerate(catalogue);
    if (!json) {
        const char *measured = degenerate > 0 ? ", in triangles with area" : "";
        fprintf(stream,
                "spacing            %s\n"
                "max                %" PRIu32 "\n"
                "family             %s\n"
                "base patterns      %" PRIu32 "\n"
                "adaptive patterns  %" PRIu64 "\n"
                "vertices           %" PRIu64 "\n"
                "triangles          %" PRIu64 "\n"
                "degenerate         %" PRIu64 " triangles\n"
                "bytes              %" PRIu64 "\n"
                "mean min angle     %.2f degrees, of the patterns' smallest%s\n"
                "worst min angle    %.2f degrees%s\n"
                "worst pattern      [%u,%u,%u]\n",
                spacing_name(catalogue), catalogue->max, catalogue->family,
                catalogue->pattern_count, levels * levels * levels, catalogue->vertex_count,
                catalogue->triangle_count, degenerate, catalogue->bytes, found.mean, measured,
                found.worst, measured, worst[0], worst[1], worst[2]);
        return GIRIH_OK;
    }
    json_t *object = json_pack(
        "{s:s, s:I, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:[iii]}", "spacing",
        spacing_name(catalogue), "max", (json_int_t)catalogue->max, "family", catalogue->family,
        "base_patterns", (json_int_t)catalogue->pattern_count, "adaptive_patterns",
        (json_int_t)(levels * levels * levels), "vertices", (json_int_t)catalogue->vertex_count,
        "triangles", (json_int_t)catalogue->triangle_count, "degenerate_triangles",
        (json_int_t)degenerate, "bytes", (json_int_t)catalogue->bytes,
        "mean_min_angle", found.mean, "worst_min_angle", found.worst, "worst_pattern",
        (int)worst[0], (int)worst[1], (int)worst[2]);
    if (!object) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "cannot put the figures into JSON: the family's name is no UTF-8, or no "
                          "memory");
    }
    json_dumpf(object, stream, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    fputc('\n', stream);
    json_decref(object);
    return GIRIH_OK;
}

// Written number by number rather than through a JSON tree, which would take gigabytes for a large
// catalogue.
void girih_report_dump(const girih_catalogue *catalogue, bool json, FILE *stream) {
    if (json) {
        fprintf(stream,
                "{\"spacing\":\"%s\",\"max\":%" PRIu32 ",\"denominator\":%u,\"patterns\":[",
                spacing_name(catalogue), catalogue->max, GIRIH_BARYCENTRIC_ONE);
    } else {
        fprintf(stream, "%s, max %" PRIu32 ", family %s, weights over %u\n",
                spacing_name(catalogue), catalogue->max, catalogue->family, GIRIH_BARYCENTRIC_ONE);
    }
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        const uint32_t *vertices = girih_catalogue_vertices(catalogue, pattern);
        uint32_t levels[3];
        for (int edge = 0; edge < 3; edge++) {
            levels[edge] = printed_level(catalogue, pattern, edge);
        }
        if (json) {
            fprintf(stream, "%s\n{\"levels\":[%u,%u,%u],\"vertices\":[", rank > 0 ? "," : "",
                    levels[0], levels[1], levels[2]);
        } else {
            fprintf(stream,
                    "\npattern [%u,%u,%u]: %" PRIu32 " vertices, %" PRIu32 " triangles\nvertices\n",
                    levels[0], levels[1], levels[2], pattern->vertex_count,
                    pattern->triangle_count);
        }
        for (uint32_t n = 0; n < pattern->vertex_count; n++) {
            uint32_t u = vertices[n] & 0xffff;
            uint32_t v = vertices[n] >> 16;
            const char *separator = json && n > 0 ? "," : "";
            fprintf(stream, json ? "%s[%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]"
                                 : "%s%" PRIu32 " %" PRIu32 " %" PRIu32 "\n",
                    separator, u, v, GIRIH_BARYCENTRIC_ONE - u - v);
        }
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
            spacing_name(catalogue), catalogue->max, catalogue->family, symbol, symbol, symbol,
            catalogue->bytes, symbol);
    for (uint64_t n = 0; n < count; n++) {
        fprintf(stream, "%s0x%" PRIx64 "u,", n % 8 == 0 ? "\n" : "", words[n]);
    }
    fputs("\n};\n", stream);
}
