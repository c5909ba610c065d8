// The family `quadtri`: Knuth, Kohlhammer, Kuijper 2010, "A Geometry-Shader-Based Adaptive Mesh
// Refinement Scheme Using Semiuniform Quad/Triangle Patches and Warping", section 3.1, without the
// warp of 3.2. A triangle part with a uniform grid at the tip, and below it a quad part between the
// base and the tip.
//
// The paper makes its patterns on the fly, as strips for a rasteriser, which has no use for a law.
// What it leaves open, or what would break the laws of a catalogue, is settled here:
// - Snapping merges vertices of a strip (Figure 7). Merged vertices are one vertex of the pattern,
//   and triangles that collapse are left out.
// - "The change of resolution is distributed over the quad" (Figure 7): a line between its two ends
//   has the nearest whole number of segments, and its vertices lie evenly on it.
// - A vertex in the middle between two snaps to the one at the nearer end of its line.
// - Strips cut all their quads in the same direction. Here the shorter diagonal cuts a quad: two
//   equal sides are then cut alike, but for what lies across the axis between them, and angles are
//   larger in the mean than the paper's own. Vertices and numbers of triangles are the same.
// - The turned quad (Figure 6) takes half of its two sides, the larger half if they are odd; the
//   paper does not say how much. Of sides of one segment it takes all, and the triangle part is the
//   corner alone.
#include "family.h"

#include <stdbool.h>

// The pattern as section 3.1.1 turns it: the quad part lies on the base AB, the triangle part at C.
typedef struct layout {
    const uint32_t *segments;
    uint32_t base;   // the edge AB; BC and CA follow it, and A is the corner of the same number
    uint32_t tip;    // segments of the triangle part
    bool turned;     // the quad's lines run from side to side, not from the base to the tip
    uint32_t strips; // of the quad part, 0 without one; they lie between straight lines, one more
    uint32_t first;  // segments of the first line, on CA or, turned, on the base
    uint32_t last;   // segments of the last line, on BC or, turned, below the triangle part
} layout;

static uint32_t right(const layout *l) {
    return l->segments[(l->base + 1) % 3];
}

static uint32_t left(const layout *l) {
    return l->segments[(l->base + 2) % 3];
}

// The lowest resolution goes to the base (3.1.1) and through the quad to the triangle part; the
// quad bridges what the two sides have more (3.1.2). With two equal low edges and a high one the
// quad lies on the high one, turned by 90 degrees (Figure 6).
static layout lay_out(const uint32_t segments[3]) {
    layout l = {.segments = segments, .base = 2, .tip = segments[2]};
    l.turned = segments[0] > segments[1] && segments[1] == segments[2];
    if (l.turned) {
        l.base = 0;
        l.tip = segments[1] / 2;
        l.strips = segments[1] - l.tip;
        l.first = segments[0];
        l.last = l.tip;
    } else if (segments[0] > segments[2]) {
        l.strips = segments[2];
        l.first = segments[1] - segments[2];
        l.last = segments[0] - segments[2];
    }
    return l;
}

// The segments of a line of the quad part.
static uint32_t line_segments(const layout *l, uint32_t line) {
    return (2 * (l->first * (l->strips - line) + l->last * line) + l->strips) / (2 * l->strips);
}

static uint32_t base_vertex(const layout *l, uint32_t from_a) {
    return girih_border_vertex(l->segments, l->base, from_a);
}

static uint32_t right_vertex(const layout *l, uint32_t from_b) {
    return girih_border_vertex(l->segments, (l->base + 1) % 3, from_b);
}

static uint32_t left_vertex(const layout *l, uint32_t from_a) {
    return girih_border_vertex(l->segments, (l->base + 2) % 3, left(l) - from_a);
}

// The last row of the triangle part that is not the base: row n has n - 1 vertices inside.
static uint32_t last_inner_row(const layout *l) {
    return l->strips > 0 ? l->tip : l->tip - 1;
}

static uint32_t tip_inner_count(const layout *l) {
    uint32_t rows = last_inner_row(l);
    return rows > 0 ? rows * (rows - 1) / 2 : 0;
}

// Vertex k, from the left, of a row of the triangle part, counted from the tip.
static uint32_t tip_vertex(const layout *l, uint32_t row, uint32_t k) {
    if (k == 0) {
        return left_vertex(l, left(l) - row);
    }
    if (k == row) {
        return right_vertex(l, right(l) - row);
    }
    if (row == l->tip && l->strips == 0) {
        return base_vertex(l, k);
    }
    return girih_border_count(l->segments) + (row - 1) * (row - 2) / 2 + k - 1;
}

// Vertex k of a line of the quad part, whose inner vertices begin at `inner`. Lines are counted
// from the left and their vertices from the base, turned: from the base and from the right. So
// strips wind the same way in both.
static uint32_t line_vertex(const layout *l, uint32_t line, uint32_t inner, uint32_t k) {
    uint32_t end = line_segments(l, line);
    if (l->turned) {
        return line == 0           ? base_vertex(l, end - k)
               : line == l->strips ? tip_vertex(l, l->tip, end - k)
               : k == 0            ? right_vertex(l, line)
               : k == end          ? left_vertex(l, line)
                                   : inner + k - 1;
    }
    return line == 0           ? left_vertex(l, k)
           : line == l->strips ? right_vertex(l, k)
           : k == 0            ? base_vertex(l, line)
           : k == end          ? tip_vertex(l, l->tip, line)
                               : inner + k - 1;
}

// The inner vertices of a line lie one after the other; the first and the last line have none.
static uint32_t line_inner_count(const layout *l, uint32_t line) {
    return line == 0 || line == l->strips ? 0 : line_segments(l, line) - 1;
}

static uint32_t share(uint64_t part, uint64_t whole) {
    return (uint32_t)((2 * part * GIRIH_BARYCENTRIC_ONE + whole) / (2 * whole));
}

// The weights of A and B are rounded alike and C, on the axis of two equal sides, gets the rest.
static uint32_t weigh(const layout *l, uint32_t a, uint32_t b) {
    return girih_pack_beside((l->base + 2) % 3, a, b);
}

// The place in the quad part x of `across` from the left and y of `up` from the base: on the
// straight lines that join its four borders evenly.
static uint32_t quad_position(const layout *l, uint64_t x, uint64_t across, uint64_t y,
                              uint64_t up) {
    uint64_t on_left = up * left(l) - y * (left(l) - l->tip);
    uint64_t on_right = up * right(l) - y * (right(l) - l->tip);
    return weigh(l, share((across - x) * on_left, across * up * left(l)),
                 share(x * on_right, across * up * right(l)));
}

static void place_tip(const layout *l, uint32_t *vertices) {
    for (uint32_t row = 2; row <= last_inner_row(l); row++) {
        for (uint32_t k = 1; k < row; k++) {
            vertices[tip_vertex(l, row, k)] = weigh(l, share(row - k, left(l)), share(k, right(l)));
        }
    }
}

static void place_line(const layout *l, uint32_t line, uint32_t *vertex) {
    uint32_t end = line_segments(l, line);
    for (uint32_t k = 1; k <= line_inner_count(l, line); k++) {
        *vertex++ = l->turned ? quad_position(l, end - k, end, line, l->strips)
                              : quad_position(l, line, l->strips, k, end);
    }
}

// Nothing where two corners are merged.
static uint32_t *add_triangle(uint32_t *index, uint32_t a, uint32_t b, uint32_t c) {
    if (a == b || b == c || c == a) {
        return index;
    }
    *index++ = a;
    *index++ = b;
    *index++ = c;
    return index;
}

// The uniform mesh of the triangle part.
static uint32_t *fill_tip(const layout *l, uint32_t *index) {
    for (uint32_t row = 0; row < l->tip; row++) {
        for (uint32_t k = 0; k <= row; k++) {
            uint32_t below = tip_vertex(l, row + 1, k + 1);
            index = add_triangle(index, tip_vertex(l, row, k), tip_vertex(l, row + 1, k), below);
            if (k < row) {
                index =
                    add_triangle(index, tip_vertex(l, row, k), below, tip_vertex(l, row, k + 1));
            }
        }
    }
    return index;
}

// In an equilateral whole, up to a factor.
static int64_t squared_length(const uint32_t *vertices, uint32_t a, uint32_t b) {
    int64_t u = (int64_t)(vertices[a] & 0xffff) - (int64_t)(vertices[b] & 0xffff);
    int64_t v = (int64_t)(vertices[a] >> 16) - (int64_t)(vertices[b] >> 16);
    return u * u + u * v + v * v;
}

// The strip between a line and the next (Figure 7): as many steps as the finer end of the quad has
// segments, in which the vertices of both lines snap to their own nearest. The inner vertices of
// the two lines begin at inner[0] and inner[1].
static uint32_t *fill_strip(const layout *l, const uint32_t *vertices, uint32_t line,
                            const uint32_t inner[2], uint32_t *index) {
    uint32_t steps = l->first > l->last ? l->first : l->last;
    uint32_t now[2] = {line_vertex(l, line, inner[0], 0), line_vertex(l, line + 1, inner[1], 0)};
    for (uint32_t step = 1; step <= steps; step++) {
        uint32_t next[2];
        for (uint32_t side = 0; side < 2; side++) {
            uint32_t k = girih_snap(step, steps, line_segments(l, line + side));
            next[side] = line_vertex(l, line + side, inner[side], k);
        }
        int64_t rising = squared_length(vertices, now[0], next[1]);
        int64_t falling = squared_length(vertices, next[0], now[1]);
        bool before_axis = l->turned ? 2 * step <= steps + 1 : 2 * line + 1 <= l->strips;
        if (falling < rising || (falling == rising && before_axis)) {
            index = add_triangle(index, now[0], now[1], next[0]);
            index = add_triangle(index, now[1], next[1], next[0]);
        } else {
            index = add_triangle(index, now[0], now[1], next[1]);
            index = add_triangle(index, now[0], next[1], next[0]);
        }
        now[0] = next[0];
        now[1] = next[1];
    }
    return index;
}

static girih_result build(const girih_family *family, const uint32_t segments[3],
                          girih_pattern *pattern, girih_error *error) {
    (void)family;
    const layout l = lay_out(segments);
    const uint32_t first_inner = girih_border_count(segments) + tip_inner_count(&l);
    uint32_t vertex_count = first_inner;
    uint32_t triangle_count = l.tip * l.tip;
    for (uint32_t line = 0; line < l.strips; line++) {
        vertex_count += line_inner_count(&l, line);
        triangle_count += line_segments(&l, line) + line_segments(&l, line + 1);
    }
    girih_result result =
        girih_pattern_allocate(pattern, segments, vertex_count, triangle_count, error);
    if (result != GIRIH_OK) {
        return result;
    }
    place_tip(&l, pattern->vertices);
    uint32_t *index = fill_tip(&l, pattern->indices);
    uint32_t inner[2] = {first_inner, first_inner};
    for (uint32_t line = 0; line < l.strips; line++) {
        inner[1] = inner[0] + line_inner_count(&l, line);
        place_line(&l, line + 1, pattern->vertices + inner[1]);
        index = fill_strip(&l, pattern->vertices, line, inner, index);
        inner[0] = inner[1];
    }
    return GIRIH_OK;
}

const girih_family girih_family_quadtri = {
    .name = "quadtri",
    .summary = "a uniform triangle at the tip, a semi-uniform quad below it (Knuth et al. 2010)",
    .build = build,
};
