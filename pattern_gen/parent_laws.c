#include "parent_laws.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "nearest_vertices.h"
#include "parents_table.h"
#include "symmetry.h"

static girih_result broken(girih_error *error, const girih_pattern *fine, const char *law,
                           uint32_t where) {
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                      "pattern of %" PRIu32 ", %" PRIu32 ", %" PRIu32 " segments: %s (at %" PRIu32
                      ")",
                      fine->segments[0], fine->segments[1], fine->segments[2], law, where);
}

static girih_result out_of_memory(const girih_pattern *fine, girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %" PRIu32 " parents",
                      fine->vertex_count);
}

static uint32_t place_on_edge(uint32_t edge, uint32_t parameter) {
    const uint32_t rest = GIRIH_BARYCENTRIC_ONE - parameter;
    const uint32_t places[3] = {girih_pack_vertex(rest, parameter), girih_pack_vertex(0, rest),
                                girih_pack_vertex(parameter, 0)};
    return places[edge];
}

// Vertex m of n segments, by the distances m coarser - k n of the vertices k.
static uint32_t border_parent(uint32_t m, uint32_t n, uint32_t coarser) {
    const uint32_t below = m * coarser / n;
    const uint32_t rest = m * coarser % n;
    if (2 * rest == n && 2 * m == n) {
        return GIRIH_BARYCENTRIC_ONE / 2;
    }
    const bool up = 2 * rest > n || (2 * rest == n && 2 * m > n);
    return girih_edge_parameter(up ? below + 1 : below, coarser);
}

static girih_result check_border(const girih_pattern *fine, const girih_pattern *coarse,
                                 const uint32_t *parents, girih_error *error) {
    for (uint32_t edge = 0; edge < 3; edge++) {
        const uint32_t n = fine->segments[edge];
        for (uint32_t m = 0; m <= n; m++) {
            const uint32_t vertex = girih_border_vertex(fine->segments, edge, m);
            if (parents[vertex] !=
                place_on_edge(edge, border_parent(m, n, coarse->segments[edge]))) {
                return broken(error, fine, "a border vertex has another parent", vertex);
            }
        }
    }
    return GIRIH_OK;
}

static int compare_places(const void *a, const void *b) {
    const uint32_t left = *(const uint32_t *)a;
    const uint32_t right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

// NULL without memory.
static uint32_t *sorted_copy(const uint32_t *places, uint32_t count) {
    uint32_t *sorted = malloc(count * sizeof *sorted);
    if (sorted) {
        memcpy(sorted, places, count * sizeof *sorted);
        qsort(sorted, count, sizeof *sorted, compare_places);
    }
    return sorted;
}

static bool is_among(const uint32_t *sorted, uint32_t count, uint32_t place) {
    return bsearch(&place, sorted, count, sizeof *sorted, compare_places) != NULL;
}

static girih_result check_inside(const girih_pattern *fine, const girih_pattern *coarse,
                                 const uint32_t *parents, girih_error *error) {
    uint32_t *sorted = sorted_copy(coarse->vertices, coarse->vertex_count);
    girih_result result = sorted ? GIRIH_OK : out_of_memory(fine, error);
    for (uint32_t n = girih_border_count(fine->segments);
         n < fine->vertex_count && result == GIRIH_OK; n++) {
        if (parents[n] != fine->vertices[n] &&
            !is_among(sorted, coarse->vertex_count, parents[n])) {
            result = broken(error, fine, "a parent is no vertex of the coarser pattern", n);
        }
    }
    free(sorted);
    return result;
}

static girih_result check_areas(const girih_pattern *fine, const uint32_t *parents,
                                girih_error *error) {
    int64_t sum = 0;
    for (uint32_t n = 0; n < fine->triangle_count; n++) {
        int64_t u[3];
        int64_t v[3];
        for (uint32_t corner = 0; corner < 3; corner++) {
            const uint32_t parent = parents[fine->indices[3 * (size_t)n + corner]];
            u[corner] = parent & 0xffff;
            v[corner] = parent >> 16;
        }
        const int64_t area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
        if (area < 0) {
            return broken(error, fine, "parents turn a triangle over", n);
        }
        sum += area;
    }
    if (sum != (int64_t)GIRIH_BARYCENTRIC_ONE * GIRIH_BARYCENTRIC_ONE) {
        return broken(error, fine, "the areas between parents do not add up to the whole",
                      fine->triangle_count);
    }
    return GIRIH_OK;
}

girih_result girih_parent_laws_check(const girih_pattern *fine, const girih_pattern *coarse,
                                     const uint32_t *parents, girih_error *error) {
    girih_result result = check_border(fine, coarse, parents, error);
    if (result == GIRIH_OK) {
        result = check_inside(fine, coarse, parents, error);
    }
    return result == GIRIH_OK ? check_areas(fine, parents, error) : result;
}

// --- Figures ---

static girih_result measure_symmetry(const girih_pattern *fine, const uint32_t *parents, bool *even,
                                     girih_error *error) {
    girih_symmetry symmetry;
    const girih_result result = girih_symmetry_find(fine, &symmetry, error);
    for (uint32_t n = 1; n < symmetry.count && result == GIRIH_OK; n++) {
        for (uint32_t vertex = 0; vertex < fine->vertex_count && *even; vertex++) {
            *even =
                girih_symmetry_is_near(parents[symmetry.images[n][vertex]],
                                       girih_symmetry_move(symmetry.corners[n], parents[vertex]));
        }
    }
    girih_symmetry_free(&symmetry);
    return result;
}

static void count_staying(const girih_pattern *fine, const girih_pattern *coarse,
                          const uint32_t *parents, const uint32_t *sorted,
                          girih_parent_figures *figures) {
    const uint32_t border = girih_border_count(fine->segments);
    uint32_t counts[2] = {0, 0};
    for (uint32_t n = 0; n < fine->vertex_count; n++) {
        counts[n >= border] += !is_among(sorted, coarse->vertex_count, parents[n]);
    }
    figures->staying_middles += counts[0];
    figures->staying_inside += counts[1];
    figures->staying_patterns += counts[1] > 0;
}

static void count_childless(const girih_pattern *fine, const girih_pattern *coarse,
                            const uint32_t *sorted, girih_parent_figures *figures) {
    uint64_t count = 0;
    for (uint32_t n = 0; n < coarse->vertex_count; n++) {
        count += !is_among(sorted, fine->vertex_count, coarse->vertices[n]);
    }
    figures->childless += count;
    figures->childless_patterns += count > 0;
}

girih_result girih_parents_measure(const girih_pattern *fine, const girih_pattern *coarse,
                                   const uint32_t *parents, uint32_t rank,
                                   girih_parent_figures *figures, girih_error *error) {
    uint32_t *coarse_places = sorted_copy(coarse->vertices, coarse->vertex_count);
    uint32_t *parent_places = sorted_copy(parents, fine->vertex_count);
    girih_result result = GIRIH_OK;
    if (coarse_places && parent_places) {
        bool even = true;
        count_staying(fine, coarse, parents, coarse_places, figures);
        count_childless(fine, coarse, parent_places, figures);
        result = measure_symmetry(fine, parents, &even, error);
        figures->uneven_patterns += !even;
    } else {
        result = out_of_memory(fine, error);
    }
    for (uint32_t n = 0; n < fine->vertex_count; n++) {
        const int64_t distance = girih_squared_distance(fine->vertices[n], parents[n]);
        if (distance > figures->farthest) {
            figures->farthest = distance;
            figures->farthest_rank = rank;
        }
    }
    free(parent_places);
    free(coarse_places);
    return result;
}

// --- Catalogues ---

// Checks the parents of a catalogue's pattern, or, with figures, measures them.
static girih_result visit(const girih_catalogue *catalogue, uint32_t rank,
                          girih_parent_figures *figures, girih_error *error) {
    const girih_base_pattern *entry = girih_catalogue_pattern(catalogue, rank);
    const uint32_t *parents = girih_catalogue_parents(catalogue, entry);
    girih_pattern fine;
    girih_pattern coarse = {.vertex_count = 0};
    girih_result result = girih_pattern_read(catalogue, rank, &fine, error);
    if (result == GIRIH_OK) {
        result = girih_pattern_read(catalogue, girih_coarser_rank(entry), &coarse, error);
    }
    if (result == GIRIH_OK) {
        result = figures ? girih_parents_measure(&fine, &coarse, parents, rank, figures, error)
                         : girih_parent_laws_check(&fine, &coarse, parents, error);
    }
    girih_pattern_free(&fine);
    girih_pattern_free(&coarse);
    return result;
}

static girih_result visit_all(const girih_catalogue *catalogue, girih_parent_figures *figures,
                              girih_error *error) {
    girih_result result = GIRIH_OK;
    for (uint32_t rank = 0; rank < catalogue->pattern_count && result == GIRIH_OK; rank++) {
        result = visit(catalogue, rank, figures, error);
    }
    return result;
}

girih_result girih_parent_laws_check_catalogue(const girih_catalogue *catalogue,
                                               girih_error *error) {
    return visit_all(catalogue, NULL, error);
}

girih_result girih_parents_measure_catalogue(const girih_catalogue *catalogue,
                                             girih_parent_figures *figures, girih_error *error) {
    *figures = (girih_parent_figures){.childless = 0};
    return visit_all(catalogue, figures, error);
}
