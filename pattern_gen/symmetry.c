#include "symmetry.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"

// Two that mirror make one that turns, so those that turn come last, to be left out first.
static const uint8_t all_corners[GIRIH_MOST_SYMMETRIES][3] = {
    {0, 1, 2}, {2, 1, 0}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1},
};

typedef struct placed {
    uint32_t vertex; // packed
    uint32_t index;
} placed;

uint32_t girih_symmetry_move(const uint8_t corners[3], uint32_t vertex) {
    const uint32_t u = vertex & 0xffff;
    const uint32_t v = vertex >> 16;
    const uint32_t weights[3] = {u, v, GIRIH_BARYCENTRIC_ONE - u - v};
    uint32_t moved[3];
    for (int corner = 0; corner < 3; corner++) {
        moved[corners[corner]] = weights[corner];
    }
    return girih_pack_vertex(moved[0], moved[1]);
}

static bool are_near(uint32_t a, uint32_t b) {
    return a - b + GIRIH_SYMMETRY_ROUNDING <= 2 * GIRIH_SYMMETRY_ROUNDING;
}

bool girih_symmetry_is_near(uint32_t a, uint32_t b) {
    const uint32_t u[2] = {a & 0xffff, b & 0xffff};
    const uint32_t v[2] = {a >> 16, b >> 16};
    return are_near(u[0], u[1]) && are_near(v[0], v[1]) && are_near(u[0] + v[0], u[1] + v[1]);
}

static int compare_placed(const void *left, const void *right) {
    const placed *a = left;
    const placed *b = right;
    return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

static uint32_t find_exactly(const placed *sorted, uint32_t count, uint32_t vertex) {
    const placed key = {vertex, 0};
    const placed *found = bsearch(&key, sorted, count, sizeof *sorted, compare_placed);
    return found ? found->index : GIRIH_NO_VERTEX;
}

// The vertex at a place, exactly or but for rounding.
static uint32_t find_near(const placed *sorted, uint32_t count, uint32_t vertex) {
    uint32_t found = find_exactly(sorted, count, vertex);
    const int reach = GIRIH_SYMMETRY_ROUNDING;
    for (int u = -reach; u <= reach && found == GIRIH_NO_VERTEX; u++) {
        for (int v = -reach; v <= reach && found == GIRIH_NO_VERTEX; v++) {
            const int64_t there = (int64_t)vertex + u + v * 65536;
            if (there >= 0 && girih_symmetry_is_near((uint32_t)there, vertex)) {
                found = find_exactly(sorted, count, (uint32_t)there);
            }
        }
    }
    return found;
}

static bool has_segments(const girih_pattern *pattern, const uint8_t corners[3]) {
    for (uint32_t edge = 0; edge < 3; edge++) {
        const uint8_t a = corners[edge];
        const uint8_t b = corners[(edge + 1) % 3];
        if (pattern->segments[edge] != pattern->segments[(a + 1) % 3 == b ? a : b]) {
            return false;
        }
    }
    return true;
}

static placed *sort_vertices(const girih_pattern *pattern) {
    placed *sorted = malloc(pattern->vertex_count * sizeof *sorted);
    for (uint32_t n = 0; sorted && n < pattern->vertex_count; n++) {
        sorted[n] = (placed){pattern->vertices[n], n};
    }
    if (sorted) {
        qsort(sorted, pattern->vertex_count, sizeof *sorted, compare_placed);
    }
    return sorted;
}

static girih_result out_of_memory(const girih_pattern *pattern, girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for the images of %u vertices",
                      pattern->vertex_count);
}

// Adds a symmetry with its images, first the one that changes nothing; false without memory.
static bool add(girih_symmetry *symmetry, const uint8_t corners[3], const girih_pattern *pattern,
                const placed *sorted) {
    uint32_t *images = malloc(pattern->vertex_count * sizeof *images);
    if (!images) {
        return false;
    }
    for (uint32_t n = 0; n < pattern->vertex_count; n++) {
        images[n] = symmetry->count == 0
                        ? n
                        : find_near(sorted, pattern->vertex_count,
                                    girih_symmetry_move(corners, pattern->vertices[n]));
    }
    memcpy(symmetry->corners[symmetry->count], corners, 3);
    symmetry->images[symmetry->count++] = images;
    return true;
}

static uint32_t find_product(const girih_symmetry *symmetry, uint32_t a, uint32_t b) {
    uint32_t product = 0;
    while (product < symmetry->count &&
           (symmetry->corners[product][0] != symmetry->corners[b][symmetry->corners[a][0]] ||
            symmetry->corners[product][1] != symmetry->corners[b][symmetry->corners[a][1]])) {
        product++;
    }
    return product;
}

// Whether one symmetry after another is a third one, at every vertex.
static bool is_closed(const girih_symmetry *symmetry, uint32_t vertex_count) {
    for (uint32_t a = 0; a < symmetry->count; a++) {
        for (uint32_t b = 0; b < symmetry->count; b++) {
            const uint32_t product = find_product(symmetry, a, b);
            if (product == symmetry->count) {
                return false;
            }
            for (uint32_t n = 0; n < vertex_count; n++) {
                if (symmetry->images[b][symmetry->images[a][n]] != symmetry->images[product][n]) {
                    return false;
                }
            }
        }
    }
    return true;
}

static bool is_complete(const uint32_t *images, uint32_t count) {
    for (uint32_t n = 0; n < count; n++) {
        if (images[n] == GIRIH_NO_VERTEX) {
            return false;
        }
    }
    return true;
}

static void drop_last(girih_symmetry *symmetry) {
    free(symmetry->images[--symmetry->count]);
    symmetry->images[symmetry->count] = NULL;
}

girih_result girih_symmetry_find(const girih_pattern *pattern, girih_symmetry *symmetry,
                                 girih_error *error) {
    *symmetry = (girih_symmetry){.count = 0};
    placed *sorted = sort_vertices(pattern);
    bool added = sorted != NULL;
    for (uint32_t n = 0; n < GIRIH_MOST_SYMMETRIES && added; n++) {
        if (has_segments(pattern, all_corners[n])) {
            added = add(symmetry, all_corners[n], pattern, sorted);
            if (added &&
                !is_complete(symmetry->images[symmetry->count - 1], pattern->vertex_count)) {
                drop_last(symmetry);
            }
        }
    }
    free(sorted);
    if (!added) {
        return out_of_memory(pattern, error);
    }
    while (!is_closed(symmetry, pattern->vertex_count)) {
        drop_last(symmetry);
    }
    return GIRIH_OK;
}

girih_result girih_symmetry_apply(const girih_symmetry *symmetry, const girih_pattern *pattern,
                                  girih_symmetry *applied, girih_error *error) {
    *applied = (girih_symmetry){.count = 0};
    placed *sorted = sort_vertices(pattern);
    bool added = sorted != NULL;
    for (uint32_t n = 0; n < symmetry->count && added; n++) {
        added = add(applied, symmetry->corners[n], pattern, sorted);
    }
    free(sorted);
    return added ? GIRIH_OK : out_of_memory(pattern, error);
}

void girih_symmetry_free(girih_symmetry *symmetry) {
    while (symmetry->count > 0) {
        drop_last(symmetry);
    }
}
