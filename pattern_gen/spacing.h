// How far apart vertices should be inside a triangle whose edges are split unevenly, and what that leaves of the
// angles. Made of +, -, *, / and square roots alone, which round alike everywhere: patterns are chosen by it, and the
// same pattern must be chosen on every machine.
#ifndef GIRIH_PATTERN_GEN_SPACING_H
#define GIRIH_PATTERN_GEN_SPACING_H

#include <float.h>
#include <stdint.h>

#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD != 0 || defined(__FAST_MATH__)
#error "doubles must be computed as doubles, and in the order written, or other patterns come out (on x86-32: -mfpmath=sse)"
#endif

// Edges shorter or longer than the spacing at their place by more than a factor of two are uneven.
#define GIRIH_SHORTEST_EVEN 0.5
#define GIRIH_LONGEST_EVEN 2.0

typedef struct girih_spacing_field {
    double logarithms[3]; // of the segments of the edges P1P2, P2P3, P3P1
} girih_spacing_field;

girih_spacing_field girih_spacing_create(const uint32_t segments[3]);

// The distance of neighbouring vertices that the three borders suggest at a place, in sides of the whole: the
// geometric mean of the borders' own distances, weighted by nearness (inverse distance). The geometric mean grows by
// the same factor from one triangle to the next where a fan turns from a fine border to a coarse one, as the sides of
// the fan with the largest angles do. Weights need not add up to one; not at a corner.
double girih_spacing_at(const girih_spacing_field *field, const double weights[3]);

// The length of an edge between two points, weights over 32768, in units of the spacing at its middle.
double girih_spacing_ratio(const girih_spacing_field *field, const double from[3], const double to[3]);

// The largest smallest angle that triangles at a corner of 60 degrees can have, where its sides have a and b segments,
// as sqrt(3) times its cotangent (1 for 60 degrees, more for less). k triangles share the corner evenly; their sides
// grow from 1/a to 1/b by one factor r; the angle t across from the shorter side has cot t = (r - cos f) / sin f with
// f = 60/k degrees; the best k counts.
double girih_corner_flatness(uint32_t a, uint32_t b);

// The same of a pattern: of its worst corner.
double girih_pattern_bound(const uint32_t segments[3]);

// The natural logarithm of a positive number.
double girih_logarithm(double x);

#endif
