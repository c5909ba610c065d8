// The family `semiuniform`: Dyken, Reimers, Seland 2009, "Semi-Uniform Adaptive Patch
// Tessellation". The uniform grid of the largest segment count n, whose border vertices snap to the
// nearest vertex of an edge that has fewer segments.
//
// Border vertices that snap to one place are one vertex of the pattern, so a triangle between them
// has a corner twice and no area. The method draws these all the same, and so they stay among the
// indices: n^2 triangles, 3 n - (n1 + n2 + n3) of them without area. The others are conforming on
// their own.
//
// The paper has dyadic counts, but no triangle turns over with others either. Only one at a corner
// could: between the first vertices of its two edges, at 1 / a and 1 / b, and the grid's innermost
// at (1 / n, 1 / n), which lies beyond the line between them if a + b > n. A first vertex that does
// not snap to the corner has an edge of more than n / 2 segments, since a tie goes to the nearer
// end.
#include "family.h"

// The vertex of the grid at (n - b - c, b, c) / n, snapped if it is on the border.
static uint32_t grid_vertex(const uint32_t segments[3], uint32_t b, uint32_t c) {
    const uint32_t n = segments[0];
    if (c == 0) {
        return girih_border_vertex(segments, 0, b);
    }
    // A middle that lies between two vertices goes towards P3 on both edges, which makes them
    // mirror images. With n = 2 nothing else tiles: a middle triangle whose corners snap to P1 and
    // P2 has three corners on one line.
    if (b + c == n) {
        uint32_t from_p3 = girih_snap(b, n, segments[1]);
        return girih_border_vertex(segments, 1, segments[1] - from_p3);
    }
    if (b == 0) {
        uint32_t from_p3 = girih_snap(n - c, n, segments[2]);
        return girih_border_vertex(segments, 2, from_p3);
    }
    uint32_t row = c - 1;
    return girih_border_count(segments) + row * (n - 2) - row * (row - 1) / 2 + b - 1;
}

static void place_interior(const uint32_t segments[3], uint32_t *vertices) {
    const uint32_t n = segments[0];
    const int symmetry_corner = girih_symmetry_corner(segments);
    const uint32_t corner = symmetry_corner < 0 ? 2 : (uint32_t)symmetry_corner;
    for (uint32_t c = 1; c + 1 < n; c++) {
        for (uint32_t b = 1; b + c < n; b++) {
            const uint32_t steps[3] = {n - b - c, b, c};
            vertices[grid_vertex(segments, b, c)] =
                girih_pack_beside(corner, girih_edge_parameter(steps[(corner + 1) % 3], n),
                                  girih_edge_parameter(steps[(corner + 2) % 3], n));
        }
    }
}

static void fill(const uint32_t segments[3], uint32_t *index) {
    const uint32_t n = segments[0];
    for (uint32_t c = 0; c < n; c++) {
        for (uint32_t b = 0; b + c < n; b++) {
            *index++ = grid_vertex(segments, b, c);
            *index++ = grid_vertex(segments, b + 1, c);
            *index++ = grid_vertex(segments, b, c + 1);
            if (b + c + 1 < n) {
                *index++ = grid_vertex(segments, b + 1, c);
                *index++ = grid_vertex(segments, b + 1, c + 1);
                *index++ = grid_vertex(segments, b, c + 1);
            }
        }
    }
}

static girih_result build(const girih_family *family, const uint32_t segments[3],
                          girih_pattern *pattern, girih_error *error) {
    (void)family;
    const uint32_t n = segments[0];
    const uint32_t interior = n > 2 ? (n - 1) * (n - 2) / 2 : 0;
    girih_result result = girih_pattern_allocate(
        pattern, segments, girih_border_count(segments) + interior, n * n, error);
    if (result == GIRIH_OK) {
        place_interior(segments, pattern->vertices);
        fill(segments, pattern->indices);
    }
    return result;
}

const girih_family girih_family_semiuniform = {
    .name = "semiuniform",
    .summary =
        "a regular grid, snapped to the borders (Dyken et al. 2009); not all triangles have area",
    .collapses = true,
    .build = build,
};
