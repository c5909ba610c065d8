#include "pattern.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"

uint32_t girih_pack_vertex(uint32_t u, uint32_t v) {
    return u | v << 16;
}

uint32_t girih_pack_beside(uint32_t corner, uint32_t next, uint32_t last) {
    uint32_t weights[3];
    weights[corner] = GIRIH_BARYCENTRIC_ONE - next - last;
    weights[(corner + 1) % 3] = next;
    weights[(corner + 2) % 3] = last;
    return girih_pack_vertex(weights[0], weights[1]);
}

uint32_t girih_snap(uint32_t m, uint32_t many, uint32_t few) {
    if (2 * m > many) {
        return few - girih_snap(many - m, many, few);
    }
    return (2 * m * few + many - 1) / (2 * many);
}

uint32_t girih_edge_parameter(uint32_t m, uint32_t n) {
    if (2 * m > n) {
        return GIRIH_BARYCENTRIC_ONE - girih_edge_parameter(n - m, n);
    }
    return (2 * m * GIRIH_BARYCENTRIC_ONE + n) / (2 * n);
}

uint32_t girih_border_vertex(const uint32_t segments[3], uint32_t edge, uint32_t m) {
    if (m == 0) {
        return edge;
    }
    if (m == segments[edge]) {
        return (edge + 1) % 3;
    }
    uint32_t first = 3;
    for (uint32_t e = 0; e < edge; e++) {
        first += segments[e] - 1;
    }
    return first + m - 1;
}

uint32_t girih_border_count(const uint32_t segments[3]) {
    return segments[0] + segments[1] + segments[2];
}

uint32_t girih_pattern_rank(const uint32_t levels[3]) {
    const uint32_t i = levels[0];
    const uint32_t j = levels[1];
    return i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + levels[2];
}

int girih_symmetry_corner(const uint32_t segments[3]) {
    if (segments[0] == segments[1]) {
        return 1;
    }
    return segments[1] == segments[2] ? 2 : -1;
}

static void place_border(girih_pattern *pattern) {
    for (uint32_t edge = 0; edge < 3; edge++) {
        for (uint32_t m = 0; m < pattern->segments[edge]; m++) {
            uint32_t weights[3] = {0, 0, 0};
            weights[(edge + 1) % 3] = girih_edge_parameter(m, pattern->segments[edge]);
            weights[edge] = GIRIH_BARYCENTRIC_ONE - weights[(edge + 1) % 3];
            pattern->vertices[girih_border_vertex(pattern->segments, edge, m)] = girih_pack_vertex(weights[0], weights[1]);
        }
    }
}

girih_result girih_pattern_allocate(girih_pattern *pattern, const uint32_t segments[3], uint32_t vertex_count,
                                    uint32_t triangle_count, girih_error *error) {
    *pattern = (girih_pattern){
        .segments = {segments[0], segments[1], segments[2]},
        .vertex_count = vertex_count,
        .triangle_count = triangle_count,
        .vertices = calloc(vertex_count, sizeof *pattern->vertices),
        .indices = calloc((size_t)triangle_count * 3, sizeof *pattern->indices),
    };
    if (!pattern->vertices || !pattern->indices) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for a pattern of %u triangles", triangle_count);
    }
    place_border(pattern);
    return GIRIH_OK;
}

girih_result girih_pattern_read(const girih_catalogue *catalogue, uint32_t rank, girih_pattern *pattern,
                                girih_error *error) {
    const girih_base_pattern *entry = girih_catalogue_pattern(catalogue, rank);
    girih_result result =
        girih_pattern_allocate(pattern, entry->segments, entry->vertex_count, entry->triangle_count, error);
    if (result == GIRIH_OK) {
        memcpy(pattern->vertices, girih_catalogue_vertices(catalogue, entry),
               entry->vertex_count * sizeof *pattern->vertices);
        for (uint32_t n = 0; n < entry->triangle_count * 3; n++) {
            pattern->indices[n] = girih_catalogue_index(catalogue, entry, n);
        }
    }
    return result;
}

void girih_pattern_free(girih_pattern *pattern) {
    free(pattern->vertices);
    free(pattern->indices);
    *pattern = (girih_pattern){.vertex_count = 0};
}
