// What `girih-patterns info` prints.
#include "report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include <jansson.h>

#include "error.h"
#include "parent_laws.h"
#include "quality.h"
#include "spacing.h"

typedef struct measured_catalogue {
    const girih_catalogue *catalogue;
    const girih_quality *qualities;
    girih_quality_totals totals;
    girih_parent_figures parents;
} measured_catalogue;

static double per_triangle(const girih_catalogue *catalogue, uint64_t count) {
    return (double)count / (double)catalogue->triangle_count;
}

static uint64_t adaptive_patterns(const girih_catalogue *catalogue) {
    const uint64_t levels = catalogue->level_count;
    return levels * levels * levels;
}

static void levels_of(const girih_catalogue *catalogue, uint32_t rank, uint32_t levels[3]) {
    girih_report_levels(catalogue, girih_catalogue_pattern(catalogue, rank), levels);
}

static void print_sizes(const measured_catalogue *measured, FILE *stream) {
    const girih_catalogue *catalogue = measured->catalogue;
    fprintf(stream,
            "spacing            %s\n"
            "max                %" PRIu32 "\n"
            "family             %s\n"
            "base patterns      %" PRIu32 "\n"
            "adaptive patterns  %" PRIu64 "\n"
            "vertices           %" PRIu64 "\n"
            "triangles          %" PRIu64 "\n"
            "degenerate         %" PRIu64 " triangles\n"
            "bytes              %" PRIu64 "\n",
            girih_report_spacing(catalogue), catalogue->max, catalogue->family,
            catalogue->pattern_count, adaptive_patterns(catalogue), catalogue->vertex_count,
            catalogue->triangle_count, measured->totals.degenerate, catalogue->bytes);
}

static void print_angles(const measured_catalogue *measured, FILE *stream) {
    const girih_quality_totals *totals = &measured->totals;
    uint32_t worst[3];
    levels_of(measured->catalogue, totals->worst_rank, worst);
    fprintf(stream,
            "mean min angle     %.2f degrees, of the patterns' smallest%s\n"
            "worst min angle    %.2f degrees\n"
            "worst pattern      [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]\n"
            "mean of triangles  %.2f degrees, of every triangle's smallest\n",
            totals->mean_angles[GIRIH_SHAPE_EQUILATERAL],
            totals->degenerate > 0 ? ", in triangles with area" : "",
            totals->worst_angles[GIRIH_SHAPE_EQUILATERAL], worst[0], worst[1], worst[2],
            totals->mean_triangle_angle);
    fprintf(stream, "\nsmallest angles      mean   worst\n");
    for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
        fprintf(stream, "  %-15s  %6.2f  %6.2f\n", girih_shape_name((girih_shape)shape),
                totals->mean_angles[shape], totals->worst_angles[shape]);
    }
    fprintf(stream,
            "  %-15s  %6.2f  %6.2f  no pattern of the same borders exceeds it, equilateral\n",
            "corner bound", totals->mean_bound, totals->worst_bound);
    fprintf(stream, "areas, smallest to largest\n  %-15s  %6.3f  %6.3g\n", "any shape",
            totals->mean_area_ratio, totals->worst_area_ratio);
}

static void print_histogram(const measured_catalogue *measured, FILE *stream) {
    enum { LONGEST_BAR = 40 };
    const uint32_t *histogram = measured->totals.histogram;
    uint32_t largest = 1;
    for (uint32_t n = 0; n < GIRIH_HISTOGRAM_COUNT; n++) {
        largest = histogram[n] > largest ? histogram[n] : largest;
    }
    fprintf(stream, "\npatterns by smallest angle, equilateral\n");
    for (uint32_t n = 0; n < GIRIH_HISTOGRAM_COUNT; n++) {
        fprintf(stream, "  %2u to %2u degrees %7" PRIu32 "%s", n * GIRIH_HISTOGRAM_STEP,
                (n + 1) * GIRIH_HISTOGRAM_STEP, histogram[n], histogram[n] > 0 ? "  " : "");
        // A step that is not empty shows.
        const uint64_t length = ((uint64_t)histogram[n] * LONGEST_BAR + largest - 1) / largest;
        for (uint64_t bar = 0; bar < length; bar++) {
            fputc('#', stream);
        }
        fputc('\n', stream);
    }
}

static void print_spacing(const measured_catalogue *measured, FILE *stream) {
    const girih_quality_totals *totals = &measured->totals;
    fprintf(stream, "\ninner edges, in units of the spacing between the borders\n");
    if (totals->longest > 0) {
        fprintf(stream,
                "  shortest         %6.3f\n"
                "  longest          %6.3f\n"
                "  uneven patterns  %6" PRIu32 "  have one outside %.1f to %.1f\n",
                totals->shortest, totals->longest, totals->uneven, GIRIH_SHORTEST_EVEN,
                GIRIH_LONGEST_EVEN);
    } else {
        fprintf(stream, "  none\n");
    }
}

static void print_cache(const measured_catalogue *measured, FILE *stream) {
    const girih_catalogue *catalogue = measured->catalogue;
    const girih_quality_totals *totals = &measured->totals;
    fprintf(stream,
            "\nshading, with a cache of %u vertices, first in first out\n"
            "  vertices         %6.3f  a triangle\n"
            "  cache misses     %6.3f  a triangle\n",
            GIRIH_CACHE_SIZE, per_triangle(catalogue, catalogue->vertex_count),
            per_triangle(catalogue, totals->cache_misses));
    if (totals->worst_cache > 0) {
        uint32_t levels[3];
        levels_of(catalogue, totals->worst_cache_rank, levels);
        fprintf(stream,
                "  worst            %6.3f  misses a vertex, [%" PRIu32 ",%" PRIu32 ",%" PRIu32
                "], of patterns of more than %u triangles\n",
                totals->worst_cache, levels[0], levels[1], levels[2], GIRIH_CACHE_SMALL_PATTERN);
    }
}

static uint64_t parent_bytes(const measured_catalogue *measured) {
    return measured->catalogue->vertex_count * sizeof(uint32_t);
}

// In sides of an equilateral whole.
static double farthest_parent(const measured_catalogue *measured) {
    return sqrt((double)measured->parents.farthest) / GIRIH_BARYCENTRIC_ONE;
}

static void print_parents(const measured_catalogue *measured, FILE *stream) {
    const girih_parent_figures *parents = &measured->parents;
    uint32_t levels[3];
    levels_of(measured->catalogue, parents->farthest_rank, levels);
    fprintf(stream,
            "\nparents, where vertices go as patterns fade into the next coarser ones\n"
            "  bytes            %6" PRIu64 "\n"
            "  staying          %6" PRIu64 "  middles of edges, and %" PRIu64
            " vertices inside %" PRIu32 " patterns\n"
            "  childless        %6" PRIu64 "  vertices that are no parents, for %" PRIu32
            " patterns\n"
            "  uneven patterns  %6" PRIu32 "  have symmetric vertices with other parents\n"
            "  farthest         %6.3f  sides of the whole, [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]\n",
            parent_bytes(measured), parents->staying_middles, parents->staying_inside,
            parents->staying_patterns, parents->childless, parents->childless_patterns,
            parents->uneven_patterns, farthest_parent(measured), levels[0], levels[1], levels[2]);
}

static void print_rows(const measured_catalogue *measured, FILE *stream) {
    fprintf(stream, "\n%-13s %9s %9s %9s %9s %9s %9s\n", "pattern", "triangles", "vertices",
            "angle", "bound", "shortest", "longest");
    for (uint32_t rank = 0; rank < measured->catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(measured->catalogue, rank);
        const girih_quality *quality = &measured->qualities[rank];
        uint32_t levels[3];
        char name[40];
        levels_of(measured->catalogue, rank, levels);
        snprintf(name, sizeof name, "[%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]", levels[0], levels[1],
                 levels[2]);
        fprintf(stream, "%-13s %9" PRIu32 " %9" PRIu32 " %9.2f %9.2f", name,
                pattern->triangle_count, pattern->vertex_count,
                quality->angles[GIRIH_SHAPE_EQUILATERAL], quality->bound);
        if (quality->longest > 0) {
            fprintf(stream, " %9.3f %9.3f\n", quality->shortest, quality->longest);
        } else {
            fprintf(stream, " %9s %9s\n", "-", "-");
        }
    }
}

// A number, or null for what there is none of.
static json_t *real_or_null(double value, bool there) {
    return there ? json_real(value) : json_null();
}

static json_t *describe_pattern(const measured_catalogue *measured, uint32_t rank) {
    const girih_base_pattern *pattern = girih_catalogue_pattern(measured->catalogue, rank);
    const girih_quality *quality = &measured->qualities[rank];
    uint32_t levels[3];
    levels_of(measured->catalogue, rank, levels);
    return json_pack("{s:[iii], s:I, s:I, s:f, s:f, s:o, s:o}", "levels", (int)levels[0],
                     (int)levels[1], (int)levels[2], "triangles",
                     (json_int_t)pattern->triangle_count, "vertices",
                     (json_int_t)pattern->vertex_count, "min_angle",
                     quality->angles[GIRIH_SHAPE_EQUILATERAL], "min_angle_bound", quality->bound,
                     "shortest_spacing", real_or_null(quality->shortest, quality->longest > 0),
                     "longest_spacing", real_or_null(quality->longest, quality->longest > 0));
}

static json_t *describe_patterns(const measured_catalogue *measured) {
    json_t *list = json_array();
    for (uint32_t rank = 0; list && rank < measured->catalogue->pattern_count; rank++) {
        if (json_array_append_new(list, describe_pattern(measured, rank)) != 0) {
            json_decref(list);
            list = NULL;
        }
    }
    return list;
}

static json_t *describe_shapes(const girih_quality_totals *totals) {
    json_t *shapes = json_object();
    for (int shape = 0; shapes && shape < GIRIH_SHAPE_COUNT; shape++) {
        json_t *angles = json_pack("{s:f, s:f}", "mean_min_angle", totals->mean_angles[shape],
                                   "worst_min_angle", totals->worst_angles[shape]);
        if (json_object_set_new(shapes, girih_shape_name((girih_shape)shape), angles) != 0) {
            json_decref(shapes);
            shapes = NULL;
        }
    }
    return shapes;
}

static json_t *describe_histogram(const girih_quality_totals *totals) {
    json_t *histogram = json_array();
    for (uint32_t n = 0; histogram && n < GIRIH_HISTOGRAM_COUNT; n++) {
        if (json_array_append_new(histogram, json_integer(totals->histogram[n])) != 0) {
            json_decref(histogram);
            histogram = NULL;
        }
    }
    return histogram;
}

static json_t *describe_sizes(const measured_catalogue *measured) {
    const girih_catalogue *catalogue = measured->catalogue;
    const girih_quality_totals *totals = &measured->totals;
    uint32_t worst[3];
    levels_of(catalogue, totals->worst_rank, worst);
    return json_pack("{s:s, s:I, s:s, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:[iii], s:I}", "spacing",
                     girih_report_spacing(catalogue), "max", (json_int_t)catalogue->max, "family",
                     catalogue->family, "base_patterns", (json_int_t)catalogue->pattern_count,
                     "adaptive_patterns", (json_int_t)adaptive_patterns(catalogue), "vertices",
                     (json_int_t)catalogue->vertex_count, "triangles",
                     (json_int_t)catalogue->triangle_count, "bytes", (json_int_t)catalogue->bytes,
                     "mean_min_angle", totals->mean_angles[GIRIH_SHAPE_EQUILATERAL],
                     "worst_min_angle", totals->worst_angles[GIRIH_SHAPE_EQUILATERAL],
                     "worst_pattern", (int)worst[0], (int)worst[1], (int)worst[2],
                     "degenerate_triangles", (json_int_t)totals->degenerate);
}

static json_t *describe_parents(const measured_catalogue *measured) {
    const girih_parent_figures *parents = &measured->parents;
    uint32_t levels[3];
    levels_of(measured->catalogue, parents->farthest_rank, levels);
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:[iii]}", "bytes",
        (json_int_t)parent_bytes(measured), "staying_middles", (json_int_t)parents->staying_middles,
        "staying_inside", (json_int_t)parents->staying_inside, "staying_patterns",
        (json_int_t)parents->staying_patterns, "childless", (json_int_t)parents->childless,
        "childless_patterns", (json_int_t)parents->childless_patterns, "uneven_patterns",
        (json_int_t)parents->uneven_patterns, "farthest", farthest_parent(measured),
        "farthest_pattern", (int)levels[0], (int)levels[1], (int)levels[2]);
}

static json_t *describe_quality(const measured_catalogue *measured) {
    const girih_catalogue *catalogue = measured->catalogue;
    const girih_quality_totals *totals = &measured->totals;
    uint32_t worst[3];
    levels_of(catalogue, totals->worst_cache_rank, worst);
    const bool has_worst = totals->worst_cache > 0;
    json_t *worst_pattern =
        has_worst ? json_pack("[iii]", (int)worst[0], (int)worst[1], (int)worst[2]) : json_null();
    const bool has_edges = totals->longest > 0;
    return json_pack(
        "{s:f, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:o, s:I, s:f, s:f, s:o, s:o, s:o, s:o}",
        "mean_triangle_min_angle", totals->mean_triangle_angle, "mean_min_angle_bound",
        totals->mean_bound, "worst_min_angle_bound", totals->worst_bound, "mean_area_ratio",
        totals->mean_area_ratio, "worst_area_ratio", totals->worst_area_ratio, "shapes",
        describe_shapes(totals), "min_angle_histogram", describe_histogram(totals),
        "shortest_spacing", real_or_null(totals->shortest, has_edges), "longest_spacing",
        real_or_null(totals->longest, has_edges), "uneven_patterns", (json_int_t)totals->uneven,
        "vertices_per_triangle", per_triangle(catalogue, catalogue->vertex_count),
        "cache_misses_per_triangle", per_triangle(catalogue, totals->cache_misses),
        "worst_cache_misses_per_vertex", real_or_null(totals->worst_cache, has_worst),
        "worst_cache_pattern", worst_pattern, "parents", describe_parents(measured), "patterns",
        describe_patterns(measured));
}

static girih_result print_json(const measured_catalogue *measured, FILE *stream,
                               girih_error *error) {
    json_t *object = describe_sizes(measured);
    json_t *quality = describe_quality(measured);
    girih_result result = GIRIH_OK;
    if (object && quality && json_object_update(object, quality) == 0) {
        json_dumpf(object, stream, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
        fputc('\n', stream);
    } else {
        result = girih_fail(
            error, GIRIH_ERROR_OUT_OF_MEMORY,
            "cannot put the figures into JSON: the family's name is no UTF-8, or no memory");
    }
    json_decref(quality);
    json_decref(object);
    return result;
}

girih_result girih_report_info(const girih_catalogue *catalogue, girih_report_form form,
                               girih_progress *progress, FILE *stream, girih_error *error) {
    girih_quality *qualities = calloc(catalogue->pattern_count, sizeof *qualities);
    girih_result result =
        qualities ? girih_quality_measure_catalogue(catalogue, qualities, progress, error)
                  : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory to measure patterns");
    girih_parent_figures parents;
    if (result == GIRIH_OK) {
        result = girih_parents_measure_catalogue(catalogue, &parents, error);
    }
    if (result == GIRIH_OK) {
        const measured_catalogue measured = {catalogue, qualities,
                                             girih_quality_total(catalogue, qualities), parents};
        if (form == GIRIH_REPORT_JSON) {
            result = print_json(&measured, stream, error);
        } else {
            print_sizes(&measured, stream);
            print_angles(&measured, stream);
            print_histogram(&measured, stream);
            print_spacing(&measured, stream);
            print_cache(&measured, stream);
            print_parents(&measured, stream);
            if (form == GIRIH_REPORT_ROWS) {
                print_rows(&measured, stream);
            }
        }
    }
    free(qualities);
    return result;
}
