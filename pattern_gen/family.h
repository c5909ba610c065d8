// Families of patterns: ways to fill a triangle whose three edges are split into given segments.
#ifndef GIRIH_PATTERN_GEN_FAMILY_H
#define GIRIH_PATTERN_GEN_FAMILY_H

#include <stdbool.h>
#include <stdint.h>

#include "pattern.h"

typedef struct girih_family girih_family;
struct girih_family {
    const char *name;    // at most 15 bytes, as the catalogue's header stores it
    const char *summary; // for --help
    bool collapses;      // its triangles may have a corner twice, and then no area
    // Makes the pattern of these segments, the first the largest; its triangles and inner vertices in no
    // particular order. Called by several threads at once. What it leaves in *pattern is to be freed also where it
    // fails.
    girih_result (*build)(const girih_family *family, const uint32_t segments[3], girih_pattern *pattern,
                          girih_error *error);
    const void *data; // the family's own; of optimal a seed, a uint32_t, NULL for 0
    bool ordered;     // its triangles come in the order to be drawn in, which is kept
};

// The grid of the largest segment count inside, one ring of triangles stitched to the borders.
extern const girih_family girih_family_uniform;

// Graded from border to border, optimised for the smallest angle.
extern const girih_family girih_family_optimal;
// A uniform grid at the tip, a quad part semi-uniform along one axis below it.
extern const girih_family girih_family_quadtri;

// The grid of the largest segment count, its border vertices snapped to those of the edges.
extern const girih_family girih_family_semiuniform;

// The family of that name, NULL where there is none.
const girih_family *girih_family_find(const char *name);

// Family n of all, NULL after the last.
const girih_family *girih_family_at(uint32_t n);

// Builds a pattern and puts its triangles and inner vertices into an order that suits a GPU's caches (order.h).
girih_result girih_pattern_build(const girih_family *family, const uint32_t segments[3], girih_pattern *pattern,
                                 girih_error *error);

#endif
