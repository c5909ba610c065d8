// What `girih-patterns compare` prints.
#include "report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include <jansson.h>

#include "error.h"
#include "quality.h"

enum { LARGEST_DIFFERENCES = 10 };

// Angles closer than this are equal, in degrees.
static const double tie = 1e-6;

// The same segments in both catalogues.
typedef struct common_pattern {
    uint32_t ranks[2];
    double difference; // smallest angle of the first less that of the second
} common_pattern;

// One catalogue's figures over the common patterns.
typedef struct common_figures {
    uint64_t vertices;
    uint64_t triangles;
    uint64_t cache_misses;
    double mean_angle;
    double worst_angle;
    uint32_t larger_angle; // patterns of a larger smallest angle than the other's
    uint32_t fewer_triangles;
    uint32_t fewer_vertices;
} common_figures;

typedef struct catalogue_pair {
    const girih_compared *compared;
    girih_quality *qualities[2];
    girih_quality_totals totals[2];
    common_pattern *common; // the largest difference first
    uint32_t common_count;
    common_figures figures[2];
} catalogue_pair;

static const girih_base_pattern *pattern_of(const catalogue_pair *comparison,
                                            const common_pattern *common, int which) {
    return girih_catalogue_pattern(comparison->compared[which].catalogue, common->ranks[which]);
}

static double angle_of(const catalogue_pair *comparison, const common_pattern *common, int which) {
    return comparison->qualities[which][common->ranks[which]].angles[GIRIH_SHAPE_EQUILATERAL];
}

// The rank of the pattern of such segments, pattern_count where there is none.
static uint32_t find_pattern(const girih_catalogue *catalogue, const uint32_t segments[3]) {
    uint32_t levels[3];
    for (int edge = 0; edge < 3; edge++) {
        levels[edge] = girih_catalogue_level(catalogue, segments[edge], NULL);
        if (girih_catalogue_segments(catalogue, levels[edge]) != segments[edge]) {
            return catalogue->pattern_count;
        }
    }
    return levels[0] * (levels[0] + 1) * (levels[0] + 2) / 6 + levels[1] * (levels[1] + 1) / 2 +
           levels[2];
}

static int compare_differences(const void *a, const void *b) {
    const common_pattern *left = a;
    const common_pattern *right = b;
    const double difference = fabs(right->difference) - fabs(left->difference);
    if (difference > 0 || difference < 0) {
        return difference > 0 ? 1 : -1;
    }
    return (left->ranks[0] > right->ranks[0]) - (left->ranks[0] < right->ranks[0]);
}

static void find_common(catalogue_pair *comparison) {
    const girih_catalogue *first = comparison->compared[0].catalogue;
    const girih_catalogue *second = comparison->compared[1].catalogue;
    for (uint32_t rank = 0; rank < first->pattern_count; rank++) {
        const uint32_t other = find_pattern(second, girih_catalogue_pattern(first, rank)->segments);
        if (other < second->pattern_count) {
            common_pattern *common = &comparison->common[comparison->common_count++];
            *common = (common_pattern){.ranks = {rank, other}};
            common->difference = angle_of(comparison, common, 0) - angle_of(comparison, common, 1);
        }
    }
}

static void add_up(catalogue_pair *comparison, int which) {
    common_figures *figures = &comparison->figures[which];
    *figures = (common_figures){.worst_angle = 60};
    for (uint32_t n = 0; n < comparison->common_count; n++) {
        const common_pattern *common = &comparison->common[n];
        const girih_base_pattern *pattern = pattern_of(comparison, common, which);
        const girih_base_pattern *other = pattern_of(comparison, common, !which);
        const double angle = angle_of(comparison, common, which);
        figures->vertices += pattern->vertex_count;
        figures->triangles += pattern->triangle_count;
        figures->cache_misses += comparison->qualities[which][common->ranks[which]].cache_misses;
        figures->mean_angle += angle / comparison->common_count;
        figures->worst_angle = fmin(figures->worst_angle, angle);
        figures->larger_angle += angle > angle_of(comparison, common, !which) + tie;
        figures->fewer_triangles += pattern->triangle_count < other->triangle_count;
        figures->fewer_vertices += pattern->vertex_count < other->vertex_count;
    }
}

static double ratio(uint64_t count, uint64_t of) {
    return of > 0 ? (double)count / (double)of : 0;
}

static void print_whole(const catalogue_pair *comparison, FILE *stream) {
    const girih_compared *compared = comparison->compared;
    const girih_catalogue *a = compared[0].catalogue;
    const girih_catalogue *b = compared[1].catalogue;
    const girih_quality_totals *totals = comparison->totals;
    fprintf(stream, "A  %s\nB  %s\n\n%-25s %14s %14s\n", compared[0].name, compared[1].name, "",
            "A", "B");
    fprintf(stream, "%-25s %14s %14s\n", "family", a->family, b->family);
    fprintf(stream, "%-25s %14s %14s\n", "spacing", girih_report_spacing(a),
            girih_report_spacing(b));
    fprintf(stream, "%-25s %14" PRIu32 " %14" PRIu32 "\n", "max", a->max, b->max);
    fprintf(stream, "%-25s %14" PRIu32 " %14" PRIu32 "\n", "base patterns", a->pattern_count,
            b->pattern_count);
    fprintf(stream, "%-25s %14" PRIu64 " %14" PRIu64 "\n", "vertices", a->vertex_count,
            b->vertex_count);
    fprintf(stream, "%-25s %14" PRIu64 " %14" PRIu64 "\n", "triangles", a->triangle_count,
            b->triangle_count);
    fprintf(stream, "%-25s %14" PRIu64 " %14" PRIu64 "\n", "bytes", a->bytes, b->bytes);
    fprintf(stream, "%-25s %14.2f %14.2f\n", "mean min angle",
            totals[0].mean_angles[GIRIH_SHAPE_EQUILATERAL],
            totals[1].mean_angles[GIRIH_SHAPE_EQUILATERAL]);
    fprintf(stream, "%-25s %14.2f %14.2f\n", "worst min angle",
            totals[0].worst_angles[GIRIH_SHAPE_EQUILATERAL],
            totals[1].worst_angles[GIRIH_SHAPE_EQUILATERAL]);
    fprintf(stream, "%-25s %14.3f %14.3f\n", "cache misses per triangle",
            ratio(totals[0].cache_misses, a->triangle_count),
            ratio(totals[1].cache_misses, b->triangle_count));
}

static void print_common(const catalogue_pair *comparison, FILE *stream) {
    const common_figures *a = &comparison->figures[0];
    const common_figures *b = &comparison->figures[1];
    fprintf(stream, "\n%" PRIu32 " patterns in both\n", comparison->common_count);
    if (comparison->common_count == 0) {
        return;
    }
    fprintf(stream, "  %-23s %14" PRIu64 " %14" PRIu64 "\n", "vertices", a->vertices, b->vertices);
    fprintf(stream, "  %-23s %14" PRIu64 " %14" PRIu64 "\n", "triangles", a->triangles,
            b->triangles);
    fprintf(stream, "  %-23s %14.2f %14.2f\n", "mean min angle", a->mean_angle, b->mean_angle);
    fprintf(stream, "  %-23s %14.2f %14.2f\n", "worst min angle", a->worst_angle, b->worst_angle);
    fprintf(stream, "  %-23s %14.3f %14.3f\n", "misses per triangle",
            ratio(a->cache_misses, a->triangles), ratio(b->cache_misses, b->triangles));
    fprintf(stream, "  %-23s %14" PRIu32 " %14" PRIu32 "\n", "larger min angle in", a->larger_angle,
            b->larger_angle);
    fprintf(stream, "  %-23s %14" PRIu32 " %14" PRIu32 "\n", "fewer triangles in",
            a->fewer_triangles, b->fewer_triangles);
    fprintf(stream, "  %-23s %14" PRIu32 " %14" PRIu32 "\n", "fewer vertices in", a->fewer_vertices,
            b->fewer_vertices);
}

// How many of the first common patterns differ in their angles, at most ten.
static uint32_t difference_count(const catalogue_pair *comparison) {
    uint32_t count = 0;
    while (count < comparison->common_count && count < LARGEST_DIFFERENCES &&
           fabs(comparison->common[count].difference) > tie) {
        count++;
    }
    return count;
}

static void print_differences(const catalogue_pair *comparison, FILE *stream) {
    const uint32_t count = difference_count(comparison);
    if (count == 0) {
        return;
    }
    fprintf(stream, "\n%-15s %9s %9s %9s  %s\n", "segments", "A angle", "B angle", "A - B",
            "triangles A, B");
    for (uint32_t n = 0; n < count; n++) {
        const common_pattern *common = &comparison->common[n];
        const girih_base_pattern *a = pattern_of(comparison, common, 0);
        const girih_base_pattern *b = pattern_of(comparison, common, 1);
        char name[40];
        snprintf(name, sizeof name, "[%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]", a->segments[0],
                 a->segments[1], a->segments[2]);
        fprintf(stream, "%-15s %9.2f %9.2f %+9.2f  %" PRIu32 ", %" PRIu32 "\n", name,
                angle_of(comparison, common, 0), angle_of(comparison, common, 1),
                common->difference, a->triangle_count, b->triangle_count);
    }
}

static json_t *describe_whole(const catalogue_pair *comparison, int which) {
    const girih_catalogue *catalogue = comparison->compared[which].catalogue;
    const girih_quality_totals *totals = &comparison->totals[which];
    return json_pack(
        "{s:s, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:f}", "file",
        comparison->compared[which].name, "family", catalogue->family, "spacing",
        girih_report_spacing(catalogue), "max", (json_int_t)catalogue->max, "base_patterns",
        (json_int_t)catalogue->pattern_count, "vertices", (json_int_t)catalogue->vertex_count,
        "triangles", (json_int_t)catalogue->triangle_count, "bytes", (json_int_t)catalogue->bytes,
        "mean_min_angle", totals->mean_angles[GIRIH_SHAPE_EQUILATERAL], "worst_min_angle",
        totals->worst_angles[GIRIH_SHAPE_EQUILATERAL], "cache_misses_per_triangle",
        ratio(totals->cache_misses, catalogue->triangle_count));
}

static json_t *describe_figures(const common_figures *figures) {
    return json_pack("{s:I, s:I, s:f, s:f, s:f, s:I, s:I, s:I}", "vertices",
                     (json_int_t)figures->vertices, "triangles", (json_int_t)figures->triangles,
                     "mean_min_angle", figures->mean_angle, "worst_min_angle", figures->worst_angle,
                     "cache_misses_per_triangle", ratio(figures->cache_misses, figures->triangles),
                     "larger_min_angle", (json_int_t)figures->larger_angle, "fewer_triangles",
                     (json_int_t)figures->fewer_triangles, "fewer_vertices",
                     (json_int_t)figures->fewer_vertices);
}

static json_t *describe_common(const catalogue_pair *comparison) {
    if (comparison->common_count == 0) {
        return json_pack("{s:i}", "base_patterns", 0);
    }
    return json_pack("{s:I, s:o, s:o}", "base_patterns", (json_int_t)comparison->common_count, "a",
                     describe_figures(&comparison->figures[0]), "b",
                     describe_figures(&comparison->figures[1]));
}

static json_t *describe_differences(const catalogue_pair *comparison) {
    json_t *list = json_array();
    for (uint32_t n = 0; list && n < difference_count(comparison); n++) {
        const common_pattern *common = &comparison->common[n];
        const girih_base_pattern *a = pattern_of(comparison, common, 0);
        const girih_base_pattern *b = pattern_of(comparison, common, 1);
        json_t *row =
            json_pack("{s:[III], s:[ff], s:[II]}", "segments", (json_int_t)a->segments[0],
                      (json_int_t)a->segments[1], (json_int_t)a->segments[2], "min_angle",
                      angle_of(comparison, common, 0), angle_of(comparison, common, 1), "triangles",
                      (json_int_t)a->triangle_count, (json_int_t)b->triangle_count);
        if (json_array_append_new(list, row) != 0) {
            json_decref(list);
            list = NULL;
        }
    }
    return list;
}

static girih_result print_json(const catalogue_pair *comparison, FILE *stream, girih_error *error) {
    json_t *object = json_pack("{s:o, s:o, s:o, s:o}", "a", describe_whole(comparison, 0), "b",
                               describe_whole(comparison, 1), "common", describe_common(comparison),
                               "largest_differences", describe_differences(comparison));
    if (!object) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "cannot put the figures into JSON: a file's or family's name is no "
                          "UTF-8, or no memory");
    }
    json_dumpf(object, stream, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    fputc('\n', stream);
    json_decref(object);
    return GIRIH_OK;
}

static girih_result measure_both(catalogue_pair *comparison, girih_progress *progress,
                                 girih_error *error) {
    for (int which = 0; which < 2; which++) {
        const girih_catalogue *catalogue = comparison->compared[which].catalogue;
        comparison->qualities[which] =
            calloc(catalogue->pattern_count, sizeof *comparison->qualities[which]);
        if (!comparison->qualities[which]) {
            return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory to measure patterns");
        }
        girih_result result = girih_quality_measure_catalogue(
            catalogue, comparison->qualities[which], progress, error);
        if (result != GIRIH_OK) {
            return result;
        }
        comparison->totals[which] = girih_quality_total(catalogue, comparison->qualities[which]);
    }
    comparison->common =
        calloc(comparison->compared[0].catalogue->pattern_count, sizeof *comparison->common);
    return comparison->common
               ? GIRIH_OK
               : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory to compare patterns");
}

girih_result girih_report_compare(const girih_compared compared[2], bool json,
                                  girih_progress *progress, FILE *stream, girih_error *error) {
    catalogue_pair comparison = {.compared = compared};
    girih_result result = measure_both(&comparison, progress, error);
    if (result == GIRIH_OK) {
        find_common(&comparison);
        add_up(&comparison, 0);
        add_up(&comparison, 1);
        qsort(comparison.common, comparison.common_count, sizeof *comparison.common,
              compare_differences);
    }
    if (result == GIRIH_OK && json) {
        result = print_json(&comparison, stream, error);
    } else if (result == GIRIH_OK) {
        print_whole(&comparison, stream);
        print_common(&comparison, stream);
        print_differences(&comparison, stream);
    }
    free(comparison.common);
    free(comparison.qualities[1]);
    free(comparison.qualities[0]);
    return result;
}
