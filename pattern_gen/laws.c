#include "laws.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "family.h"
#include "parent_laws.h"

// A directed edge of a triangle, by its end points.
typedef struct directed_edge {
    uint32_t from;
    uint32_t to;
} directed_edge;

typedef struct pattern_view {
    const uint32_t *segments;
    const uint32_t *vertices;
    const uint32_t *indices;
    uint32_t vertex_count;
    uint32_t triangle_count;
} pattern_view;

static girih_result broken(girih_error *error, const pattern_view *pattern, const char *law,
                           uint32_t where) {
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                      "pattern of %" PRIu32 ", %" PRIu32 ", %" PRIu32 " segments: %s (at %" PRIu32
                      ")",
                      pattern->segments[0], pattern->segments[1], pattern->segments[2], law, where);
}

static girih_result check_borders(const pattern_view *pattern, girih_error *error) {
    const uint32_t one = GIRIH_BARYCENTRIC_ONE;
    uint32_t corners[3] = {one, one << 16, 0};
    for (uint32_t corner = 0; corner < 3; corner++) {
        if (pattern->vertices[corner] != corners[corner]) {
            return broken(error, pattern, "a corner is not in its place", corner);
        }
    }
    uint32_t vertex = 3;
    for (int edge = 0; edge < 3; edge++) {
        uint32_t n = pattern->segments[edge];
        for (uint32_t m = 1; m < n; m++, vertex++) {
            uint32_t nearer = m <= n - m ? m : n - m;
            uint32_t parameter = (2 * nearer * one + n) / (2 * n);
            uint32_t to = nearer == m ? parameter : one - parameter;
            uint32_t from = one - to;
            uint32_t expected[3] = {from | to << 16, from << 16, to};
            if (pattern->vertices[vertex] != expected[edge]) {
                return broken(error, pattern, "a border vertex is not in its place", vertex);
            }
        }
    }
    return GIRIH_OK;
}

static int compare_vertices(const void *a, const void *b) {
    uint32_t left = *(const uint32_t *)a;
    uint32_t right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

static girih_result check_vertices(const pattern_view *pattern, girih_error *error) {
    uint32_t *sorted = malloc(pattern->vertex_count * sizeof *sorted);
    bool *used = calloc(pattern->vertex_count, sizeof *used);
    girih_result result = GIRIH_OK;
    if (!sorted || !used) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %" PRIu32 " vertices",
                            pattern->vertex_count);
    } else {
        memcpy(sorted, pattern->vertices, pattern->vertex_count * sizeof *sorted);
        qsort(sorted, pattern->vertex_count, sizeof *sorted, compare_vertices);
        for (size_t n = 0; n < (size_t)pattern->triangle_count * 3; n++) {
            used[pattern->indices[n]] = true;
        }
        for (uint32_t n = 0; n < pattern->vertex_count && result == GIRIH_OK; n++) {
            if (n > 0 && sorted[n] == sorted[n - 1]) {
                result = broken(error, pattern, "two vertices coincide", n);
            } else if (!used[n]) {
                result = broken(error, pattern, "a vertex is in no triangle", n);
            }
        }
    }
    free(used);
    free(sorted);
    return result;
}

static girih_result check_areas(const pattern_view *pattern, girih_error *error) {
    const int64_t whole = (int64_t)GIRIH_BARYCENTRIC_ONE * GIRIH_BARYCENTRIC_ONE;
    int64_t sum = 0;
    for (uint32_t n = 0; n < pattern->triangle_count; n++) {
        int64_t u[3];
        int64_t v[3];
        for (int corner = 0; corner < 3; corner++) {
            uint32_t vertex = pattern->vertices[pattern->indices[3 * (size_t)n + (size_t)corner]];
            u[corner] = vertex & 0xffff;
            v[corner] = vertex >> 16;
        }
        int64_t area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
        if (area <= 0) {
            return broken(error, pattern, "a triangle is degenerate or turned over", n);
        }
        sum += area;
    }
    if (sum != whole) {
        return broken(error, pattern, "the areas do not add up to the whole",
                      pattern->triangle_count);
    }
    return GIRIH_OK;
}

static uint32_t lower(directed_edge edge) {
    return edge.from < edge.to ? edge.from : edge.to;
}

static uint32_t upper(directed_edge edge) {
    return edge.from < edge.to ? edge.to : edge.from;
}

// One stable counting sort by the lower or upper end point. first: vertex_count + 1 entries.
static void sort_edges(const directed_edge *from, directed_edge *to, size_t count,
                       uint32_t (*key)(directed_edge), uint32_t *first, uint32_t vertex_count) {
    memset(first, 0, (vertex_count + 1u) * sizeof *first);
    for (size_t n = 0; n < count; n++) {
        first[key(from[n]) + 1]++;
    }
    for (uint32_t n = 0; n < vertex_count; n++) {
        first[n + 1] += first[n];
    }
    for (size_t n = 0; n < count; n++) {
        to[first[key(from[n])]++] = from[n];
    }
}

// Whether an edge is a segment of a border in the border's direction: the vertices of the borders
// come first and in order.
static bool is_border(const uint32_t segments[3], directed_edge edge) {
    uint32_t first = 3;
    for (uint32_t n = 0; n < 3; n++) {
        uint32_t last = first + segments[n] - 2;
        uint32_t end = (n + 1) % 3;
        if (segments[n] == 1) {
            if (edge.from == n && edge.to == end) {
                return true;
            }
        } else if ((edge.from == n && edge.to == first) || (edge.from == last && edge.to == end) ||
                   (edge.from >= first && edge.from < last && edge.to == edge.from + 1)) {
            return true;
        }
        first += segments[n] - 1;
    }
    return false;
}

static girih_result check_sorted_edges(const pattern_view *pattern, const directed_edge *edges,
                                       size_t count, girih_error *error) {
    uint32_t border = 0;
    for (size_t n = 0; n < count;) {
        size_t next = n + 1;
        while (next < count && lower(edges[next]) == lower(edges[n]) &&
               upper(edges[next]) == upper(edges[n])) {
            next++;
        }
        bool inner = next - n == 2 && edges[n].from == edges[n + 1].to;
        if (next - n == 1 && is_border(pattern->segments, edges[n])) {
            border++;
        } else if (!inner) {
            return broken(error, pattern, "an edge is not shared by two triangles",
                          edges[n].from);
        }
        n = next;
    }
    if (border != pattern->segments[0] + pattern->segments[1] + pattern->segments[2]) {
        return broken(error, pattern, "a border segment is missing", border);
    }
    return GIRIH_OK;
}

static girih_result check_edges(const pattern_view *pattern, girih_error *error) {
    size_t count = (size_t)pattern->triangle_count * 3;
    directed_edge *edges = calloc(count, sizeof *edges);
    directed_edge *sorted = calloc(count, sizeof *sorted);
    uint32_t *first = malloc((pattern->vertex_count + (size_t)1) * sizeof *first);
    girih_result result = GIRIH_OK;
    if (!edges || !sorted || !first) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu edges", count);
    } else {
        for (size_t n = 0; n < count; n++) {
            size_t next = n % 3 == 2 ? n - 2 : n + 1;
            edges[n] = (directed_edge){pattern->indices[n], pattern->indices[next]};
        }
        sort_edges(edges, sorted, count, upper, first, pattern->vertex_count);
        sort_edges(sorted, edges, count, lower, first, pattern->vertex_count);
        result = check_sorted_edges(pattern, edges, count, error);
    }
    free(first);
    free(sorted);
    free(edges);
    return result;
}

static girih_result check_all(const pattern_view *pattern, girih_error *error) {
    const uint32_t *segments = pattern->segments;
    if (pattern->vertex_count < segments[0] + segments[1] + segments[2]) {
        return broken(error, pattern, "too few vertices for its borders", pattern->vertex_count);
    }
    if (pattern->triangle_count == 0) {
        return broken(error, pattern, "no triangles", 0);
    }
    for (size_t n = 0; n < (size_t)pattern->triangle_count * 3; n++) {
        if (pattern->indices[n] >= pattern->vertex_count) {
            return broken(error, pattern, "an index beyond its vertices", (uint32_t)(n / 3));
        }
    }
    girih_result result = check_borders(pattern, error);
    if (result == GIRIH_OK) {
        result = check_vertices(pattern, error);
    }
    if (result == GIRIH_OK) {
        result = check_areas(pattern, error);
    }
    if (result == GIRIH_OK) {
        result = check_edges(pattern, error);
    }
    return result;
}

static bool is_collapsed(uint32_t a, uint32_t b, uint32_t c) {
    return a == b || b == c || c == a;
}

// The edges of a triangle with a corner twice are one edge to and fro, so it joins nothing that the
// others do not join without it.
static girih_result check_without_collapsed(const pattern_view *pattern, girih_error *error) {
    uint32_t *kept = calloc((size_t)pattern->triangle_count * 3, sizeof *kept);
    if (!kept) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %" PRIu32 " triangles",
                          pattern->triangle_count);
    }
    pattern_view others = *pattern;
    others.indices = kept;
    others.triangle_count = 0;
    for (uint32_t n = 0; n < pattern->triangle_count; n++) {
        const uint32_t *corners = pattern->indices + 3 * (size_t)n;
        if (!is_collapsed(corners[0], corners[1], corners[2])) {
            memcpy(kept + 3 * (size_t)others.triangle_count++, corners, 3 * sizeof *corners);
        }
    }
    girih_result result = check_all(&others, error);
    free(kept);
    return result;
}

girih_result girih_laws_check_pattern(const uint32_t segments[3], const uint32_t *vertices,
                                      uint32_t vertex_count, const uint32_t *indices,
                                      uint32_t triangle_count, bool collapses, girih_error *error) {
    const pattern_view pattern = {segments, vertices, indices, vertex_count, triangle_count};
    return collapses ? check_without_collapsed(&pattern, error) : check_all(&pattern, error);
}

uint64_t girih_laws_count_degenerate(const girih_catalogue *catalogue) {
    uint64_t count = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        for (uint32_t n = 0; n < pattern->triangle_count * 3; n += 3) {
            count += is_collapsed(girih_catalogue_index(catalogue, pattern, n),
                                  girih_catalogue_index(catalogue, pattern, n + 1),
                                  girih_catalogue_index(catalogue, pattern, n + 2));
        }
    }
    return count;
}

girih_result girih_laws_check_built(const char *family, const girih_pattern *pattern,
                                    girih_error *error) {
    const uint32_t *segments = pattern->segments;
    uint32_t expected = segments[0] * segments[0] - 3 * segments[0] + segments[0] + segments[1] +
                        segments[2];
    if (strcmp(family, "uniform") == 0 && pattern->triangle_count != expected) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "pattern of %" PRIu32 ", %" PRIu32 ", %" PRIu32 " segments: %" PRIu32
                          " triangles, the family uniform has %" PRIu32,
                          segments[0], segments[1], segments[2], pattern->triangle_count, expected);
    }
    const girih_family *known = girih_family_find(family);
    return girih_laws_check_pattern(segments, pattern->vertices, pattern->vertex_count,
                                    pattern->indices, pattern->triangle_count,
                                    known && known->collapses, error);
}

girih_result girih_laws_check_catalogue(const girih_catalogue *catalogue, girih_error *error) {
    girih_result result = GIRIH_OK;
    for (uint32_t rank = 0; rank < catalogue->pattern_count && result == GIRIH_OK; rank++) {
        girih_pattern pattern;
        result = girih_pattern_read(catalogue, rank, &pattern, error);
        if (result == GIRIH_OK) {
            result = girih_laws_check_built(catalogue->family, &pattern, error);
        }
        girih_pattern_free(&pattern);
    }
    return result == GIRIH_OK ? girih_parent_laws_check_catalogue(catalogue, error) : result;
}
