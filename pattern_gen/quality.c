#include "quality.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "error.h"
#include "spacing.h"

typedef struct point {
    double x;
    double y;
} point;

// An isosceles triangle: base from (-1/2, 0) to (1/2, 0), apex above the middle.
typedef struct shape_form {
    const char *name;
    double height;
} shape_form;

static const shape_form shapes[GIRIH_SHAPE_COUNT] = {
    [GIRIH_SHAPE_EQUILATERAL] = {"equilateral", 0.86602540378443864676},
    [GIRIH_SHAPE_RIGHT] = {"right", 0.5},
    [GIRIH_SHAPE_THIN] = {"thin", 10},
    [GIRIH_SHAPE_OBTUSE] = {"obtuse", 0.28867513459481288225},
};

static const double one = GIRIH_BARYCENTRIC_ONE;
static const double pi = 3.14159265358979323846;

static double to_degrees(double radians) {
    return radians * (180 / pi);
}

const char *girih_shape_name(girih_shape shape) {
    return shapes[shape].name;
}

// Where a vertex lies in a shape, in units of 1 / 32768 of the base.
static point place(girih_shape shape, uint32_t apex, uint32_t vertex) {
    const uint32_t u = vertex & 0xffff;
    const uint32_t v = vertex >> 16;
    const double weights[3] = {u, v, one - u - v};
    const double left = weights[(apex + 1) % 3];
    const double right = weights[(apex + 2) % 3];
    return (point){(right - left) / 2, weights[apex] * shapes[shape].height};
}

// Twice the area in units of 1 / 32768^2 of the whole: without rounding, so that zero is zero.
static int64_t doubled_area(const uint32_t vertices[3]) {
    int64_t u[3];
    int64_t v[3];
    for (int n = 0; n < 3; n++) {
        u[n] = vertices[n] & 0xffff;
        v[n] = vertices[n] >> 16;
    }
    return llabs((u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]));
}

// The cotangent of the smallest angle: the largest of the three, which all have the doubled area as
// denominator.
static double largest_cotangent(girih_shape shape, const point corners[3], int64_t area) {
    double largest = -HUGE_VAL;
    for (int n = 0; n < 3; n++) {
        const point p = corners[n];
        const point a = corners[(n + 1) % 3];
        const point b = corners[(n + 2) % 3];
        const double dot = (a.x - p.x) * (b.x - p.x) + (a.y - p.y) * (b.y - p.y);
        largest = dot > largest ? dot : largest;
    }
    return largest / ((double)area * shapes[shape].height);
}

static double angle_of_cotangent(double cotangent) {
    return to_degrees(atan2(1, cotangent));
}

double girih_quality_angle(girih_shape shape, uint32_t apex, const uint32_t vertices[3]) {
    const int64_t area = doubled_area(vertices);
    if (area == 0) {
        return 0;
    }
    point corners[3];
    for (int n = 0; n < 3; n++) {
        corners[n] = place(shape, apex, vertices[n]);
    }
    return angle_of_cotangent(largest_cotangent(shape, corners, area));
}

double girih_quality_corner_bound(uint32_t a, uint32_t b) {
    return angle_of_cotangent(girih_corner_flatness(a, b) / sqrt(3));
}

double girih_quality_bound(const uint32_t segments[3]) {
    return angle_of_cotangent(girih_pattern_bound(segments) / sqrt(3));
}

static void corners_of(const girih_pattern *pattern, uint32_t triangle, uint32_t vertices[3]) {
    for (size_t corner = 0; corner < 3; corner++) {
        vertices[corner] = pattern->vertices[pattern->indices[(size_t)triangle * 3 + corner]];
    }
}

static void measure_areas(const girih_pattern *pattern, girih_quality *quality) {
    int64_t smallest = INT64_MAX;
    int64_t largest = 0;
    for (uint32_t n = 0; n < pattern->triangle_count; n++) {
        uint32_t vertices[3];
        corners_of(pattern, n, vertices);
        const int64_t area = doubled_area(vertices);
        if (area == 0) {
            quality->degenerate++;
            continue;
        }
        quality->measured++;
        smallest = area < smallest ? area : smallest;
        largest = area > largest ? area : largest;
    }
    quality->area_ratio = largest > 0 ? (double)smallest / (double)largest : 0;
}

// The smallest angle in a shape. `points` has room for every vertex.
static double measure_angle(const girih_pattern *pattern, girih_shape shape, uint32_t apex,
                            point *points) {
    for (uint32_t n = 0; n < pattern->vertex_count; n++) {
        points[n] = place(shape, apex, pattern->vertices[n]);
    }
    double largest = -HUGE_VAL;
    for (uint32_t n = 0; n < pattern->triangle_count; n++) {
        const uint32_t *index = &pattern->indices[(size_t)n * 3];
        uint32_t vertices[3];
        corners_of(pattern, n, vertices);
        const int64_t area = doubled_area(vertices);
        if (area > 0) {
            const point corners[3] = {points[index[0]], points[index[1]], points[index[2]]};
            largest = fmax(largest, largest_cotangent(shape, corners, area));
        }
    }
    return largest > -HUGE_VAL ? angle_of_cotangent(largest) : 0;
}

static void measure_angles(const girih_pattern *pattern, point *points, girih_quality *quality) {
    for (uint32_t n = 0; n < GIRIH_SHAPE_COUNT; n++) {
        const girih_shape shape = (girih_shape)n;
        quality->angles[n] = measure_angle(pattern, shape, 0, points);
        for (uint32_t apex = 1; apex < 3 && shape != GIRIH_SHAPE_EQUILATERAL; apex++) {
            quality->angles[n] =
                fmin(quality->angles[n], measure_angle(pattern, shape, apex, points));
        }
    }
    for (uint32_t n = 0; n < pattern->triangle_count; n++) {
        uint32_t vertices[3];
        corners_of(pattern, n, vertices);
        quality->angle_sum += girih_quality_angle(GIRIH_SHAPE_EQUILATERAL, 0, vertices);
    }
}

// Weight n of a packed vertex is zero on the edge across from corner n.
static void unpack(uint32_t vertex, double weights[3]) {
    weights[0] = vertex & 0xffff;
    weights[1] = vertex >> 16;
    weights[2] = one - weights[0] - weights[1];
}

static bool is_on_border(const double from[3], const double to[3]) {
    return from[0] + to[0] <= 0 || from[1] + to[1] <= 0 || from[2] + to[2] <= 0;
}

static void measure_edges(const girih_pattern *pattern, girih_quality *quality) {
    const girih_spacing_field spacing = girih_spacing_create(pattern->segments);
    for (size_t n = 0; n < (size_t)pattern->triangle_count * 3; n++) {
        const uint32_t from = pattern->indices[n];
        const uint32_t to = pattern->indices[n % 3 == 2 ? n - 2 : n + 1];
        double a[3];
        double b[3];
        unpack(pattern->vertices[from], a);
        unpack(pattern->vertices[to], b);
        // The other triangle has the same edge the other way.
        if (from < to && !is_on_border(a, b)) {
            const double ratio = girih_spacing_ratio(&spacing, a, b);
            quality->shortest = quality->shortest > 0 ? fmin(quality->shortest, ratio) : ratio;
            quality->longest = fmax(quality->longest, ratio);
        }
    }
}

girih_result girih_quality_measure(const girih_pattern *pattern, girih_quality *quality,
                                   girih_error *error) {
    *quality = (girih_quality){.bound = girih_quality_bound(pattern->segments)};
    point *points = malloc(pattern->vertex_count * sizeof *points);
    const uint64_t misses = girih_cache_misses(pattern->indices, (size_t)pattern->triangle_count * 3,
                                               pattern->vertex_count, GIRIH_CACHE_SIZE);
    girih_result result = GIRIH_OK;
    if (points && misses != UINT64_MAX) {
        measure_areas(pattern, quality);
        measure_angles(pattern, points, quality);
        measure_edges(pattern, quality);
        quality->cache_misses = misses;
    } else {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory to measure %u vertices",
                            pattern->vertex_count);
    }
    free(points);
    return result;
}

girih_result girih_quality_measure_catalogue(const girih_catalogue *catalogue,
                                             girih_quality *qualities, girih_progress *progress,
                                             girih_error *error) {
    girih_result result = GIRIH_OK;
    for (uint32_t rank = 0; rank < catalogue->pattern_count && result == GIRIH_OK; rank++) {
        girih_pattern pattern;
        result = girih_pattern_read(catalogue, rank, &pattern, error);
        if (result == GIRIH_OK) {
            result = girih_quality_measure(&pattern, &qualities[rank], error);
        }
        girih_pattern_free(&pattern);
        if (progress) {
            progress(rank + 1, catalogue->pattern_count);
        }
    }
    return result;
}

static uint32_t histogram_step(double angle) {
    // An angle of just 30 degrees may have been rounded down.
    const uint32_t step = (uint32_t)(angle / GIRIH_HISTOGRAM_STEP + 1e-9);
    return step < GIRIH_HISTOGRAM_COUNT ? step : GIRIH_HISTOGRAM_COUNT - 1;
}

static void add_angles(girih_quality_totals *totals, uint32_t rank, const girih_quality *quality) {
    if (quality->angles[GIRIH_SHAPE_EQUILATERAL] < totals->worst_angles[GIRIH_SHAPE_EQUILATERAL]) {
        totals->worst_rank = rank;
    }
    for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
        totals->mean_angles[shape] += quality->angles[shape];
        totals->worst_angles[shape] = fmin(totals->worst_angles[shape], quality->angles[shape]);
    }
    totals->histogram[histogram_step(quality->angles[GIRIH_SHAPE_EQUILATERAL])]++;
    totals->mean_bound += quality->bound;
    totals->worst_bound = fmin(totals->worst_bound, quality->bound);
}

static void add_edges(girih_quality_totals *totals, const girih_quality *quality) {
    if (quality->longest > 0) {
        totals->shortest =
            totals->shortest > 0 ? fmin(totals->shortest, quality->shortest) : quality->shortest;
        totals->longest = fmax(totals->longest, quality->longest);
        totals->uneven +=
            quality->shortest < GIRIH_SHORTEST_EVEN || quality->longest > GIRIH_LONGEST_EVEN;
    }
}

static void add_cache(girih_quality_totals *totals, const girih_base_pattern *pattern,
                      uint32_t rank, const girih_quality *quality) {
    totals->cache_misses += quality->cache_misses;
    const double misses = (double)quality->cache_misses / pattern->vertex_count;
    if (pattern->triangle_count > GIRIH_CACHE_SMALL_PATTERN && misses > totals->worst_cache) {
        totals->worst_cache = misses;
        totals->worst_cache_rank = rank;
    }
}

girih_quality_totals girih_quality_total(const girih_catalogue *catalogue,
                                         const girih_quality *qualities) {
    girih_quality_totals totals = {.worst_bound = 60, .worst_area_ratio = 1};
    for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
        totals.worst_angles[shape] = HUGE_VAL;
    }
    double angle_sum = 0;
    uint64_t measured = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_quality *quality = &qualities[rank];
        add_angles(&totals, rank, quality);
        add_edges(&totals, quality);
        add_cache(&totals, girih_catalogue_pattern(catalogue, rank), rank, quality);
        totals.mean_area_ratio += quality->area_ratio;
        totals.worst_area_ratio = fmin(totals.worst_area_ratio, quality->area_ratio);
        totals.degenerate += quality->degenerate;
        angle_sum += quality->angle_sum;
        measured += quality->measured;
    }
    const double count = catalogue->pattern_count;
    for (int shape = 0; shape < GIRIH_SHAPE_COUNT; shape++) {
        totals.mean_angles[shape] /= count;
    }
    totals.mean_bound /= count;
    totals.mean_area_ratio /= count;
    totals.mean_triangle_angle = measured > 0 ? angle_sum / (double)measured : 0;
    return totals;
}
