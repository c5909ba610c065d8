// The laws of a catalogue, for `girih-patterns check` and the tests alike.
#ifndef GIRIH_PATTERN_GEN_LAWS_H
#define GIRIH_PATTERN_GEN_LAWS_H

#include <stdbool.h>
#include <stdint.h>

#include "pattern.h"

// Checks one pattern, in near linear time:
// - its vertices begin with the corners and the edges' vertices, each exactly where it must be;
// - all vertices are distinct and used;
// - every triangle has a positive doubled area, and these add up to the whole, exactly;
// - it is conforming: an inner edge belongs to two triangles, in opposite directions, and the edges
//   that belong to one are the segments of the borders, in the direction P1, P2, P3.
// Together they say that the triangles tile the whole and wind as P1, P2, P3.
// vertices: packed u | v << 16, with u + v <= 32768. indices: three per triangle.
// collapses: triangles with a corner twice are allowed; without them all the above must hold. A
// triangle without area between three different vertices never is: it would hide that the triangles
// at both sides do not share their edges.
girih_result girih_laws_check_pattern(const uint32_t segments[3], const uint32_t *vertices,
                                      uint32_t vertex_count, const uint32_t *indices,
                                      uint32_t triangle_count, bool collapses, girih_error *error);

// Checks one pattern of a family, of one that is known by the family's laws; of `uniform` the number of triangles
// too.
girih_result girih_laws_check_built(const char *family, const girih_pattern *pattern,
                                    girih_error *error);

// Checks all patterns of an opened catalogue, each as girih_laws_check_built does, then their parents (parent_laws.h).
girih_result girih_laws_check_catalogue(const girih_catalogue *catalogue, girih_error *error);

// The triangles of all patterns that have a corner twice: in a lawful catalogue, those without area.
uint64_t girih_laws_count_degenerate(const girih_catalogue *catalogue);

#endif
