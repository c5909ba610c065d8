// How good patterns are: angles in triangles of several shapes, sizes, spacing, vertex reuse. All
// of it is for reports: what patterns are made with is in spacing.h.
//
// A triangle without area, as families with zero-area joints have them, is counted but not
// measured.
#ifndef GIRIH_PATTERN_GEN_QUALITY_H
#define GIRIH_PATTERN_GEN_QUALITY_H

#include <stdint.h>

#include "order.h"
#include "pattern.h"

// What a pattern is laid over: isosceles triangles, by the angle at the apex.
typedef enum girih_shape {
    GIRIH_SHAPE_EQUILATERAL,
    GIRIH_SHAPE_RIGHT,  // half a square
    GIRIH_SHAPE_THIN,   // ten times as high as wide
    GIRIH_SHAPE_OBTUSE, // 120 degrees
    GIRIH_SHAPE_COUNT
} girih_shape;

#define GIRIH_HISTOGRAM_STEP 5u // degrees
#define GIRIH_HISTOGRAM_COUNT (60u / GIRIH_HISTOGRAM_STEP)

// A larger pattern counts for the worst use of the cache: in a small one the first visits outweigh
// all others.
#define GIRIH_CACHE_SMALL_PATTERN 100u

// One pattern. Angles are in degrees.
typedef struct girih_quality {
    double
        angles[GIRIH_SHAPE_COUNT]; // the smallest, the worst over which corner is the shape's apex
    double angle_sum;              // of every triangle's smallest angle in the equilateral shape
    double bound;                  // girih_quality_bound
    double area_ratio;             // smallest area to largest, the same in every shape
    double shortest; // inner edges in units of the spacing at their middle; both 0 without
    double longest;  // an inner edge
    uint64_t cache_misses;
    uint32_t degenerate; // triangles without area
    uint32_t measured;   // the others
} girih_quality;

// All patterns of a catalogue. Means are over patterns unless they say otherwise.
typedef struct girih_quality_totals {
    double mean_angles[GIRIH_SHAPE_COUNT];
    double worst_angles[GIRIH_SHAPE_COUNT];
    uint32_t worst_rank;        // of the pattern with the worst angle in the equilateral shape
    double mean_triangle_angle; // of every triangle's smallest angle, over all triangles with area
    double mean_bound;
    double worst_bound;
    double mean_area_ratio;
    double worst_area_ratio;
    double shortest; // as in girih_quality
    double longest;
    uint32_t uneven; // patterns with an edge shorter or longer than even
    uint32_t
        histogram[GIRIH_HISTOGRAM_COUNT]; // patterns by smallest angle; 60 degrees are in the last
    uint64_t cache_misses;
    double worst_cache; // misses a vertex of the worst larger pattern; 0 without one
    uint32_t worst_cache_rank;
    uint64_t degenerate;
} girih_quality_totals;

const char *girih_shape_name(girih_shape shape);

// The smallest angle in degrees of a triangle of packed vertices in a shape whose apex is corner 0,
// 1 or 2 of the pattern; 0 where it has no area. A triangle that is turned over has the angles of
// its mirror image.
double girih_quality_angle(girih_shape shape, uint32_t apex, const uint32_t vertices[3]);

// girih_corner_flatness and girih_pattern_bound as angles.
double girih_quality_corner_bound(uint32_t a, uint32_t b);
double girih_quality_bound(const uint32_t segments[3]);

girih_result girih_quality_measure(const girih_pattern *pattern, girih_quality *quality,
                                   girih_error *error);

// Measures every pattern of a catalogue. `qualities` has room for all of them, in the order of
// rank. `progress` is called after each and may be NULL.
girih_result girih_quality_measure_catalogue(const girih_catalogue *catalogue,
                                             girih_quality *qualities, girih_progress *progress,
                                             girih_error *error);

girih_quality_totals girih_quality_total(const girih_catalogue *catalogue,
                                         const girih_quality *qualities);

#endif
