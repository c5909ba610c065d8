#include "nearest_vertices.h"

#include <stdlib.h>

#include "girih/catalogue.h"

#define MOST_CELLS_A_SIDE 1024u

int64_t girih_squared_distance(uint32_t a, uint32_t b) {
    const int64_t u = (int64_t)(a & 0xffff) - (b & 0xffff);
    const int64_t v = (int64_t)(a >> 16) - (b >> 16);
    return u * u + u * v + v * v;
}

static uint32_t cell_of(const girih_vertex_grid *grid, uint32_t vertex) {
    return (vertex >> 16) / grid->cell_size * grid->side + (vertex & 0xffff) / grid->cell_size;
}

bool girih_vertex_grid_create(girih_vertex_grid *grid, const uint32_t *vertices, uint32_t count) {
    uint32_t cells = 1;
    while (cells < MOST_CELLS_A_SIDE && cells * cells < count) {
        cells *= 2;
    }
    // The corners' weights are 32768 itself, and begin one more cell.
    *grid = (girih_vertex_grid){
        .vertices = vertices, .side = cells + 1, .cell_size = GIRIH_BARYCENTRIC_ONE / cells};
    const uint32_t all = grid->side * grid->side;
    grid->first = calloc((size_t)all + 2, sizeof *grid->first);
    grid->order = malloc(count * sizeof *grid->order);
    if (!grid->first || !grid->order) {
        return false;
    }
    // Counted two places on, so that filling moves every cell's first to its place.
    for (uint32_t n = 0; n < count; n++) {
        grid->first[cell_of(grid, vertices[n]) + 2]++;
    }
    for (uint32_t cell = 0; cell < all; cell++) {
        grid->first[cell + 2] += grid->first[cell + 1];
    }
    for (uint32_t n = 0; n < count; n++) {
        grid->order[grid->first[cell_of(grid, vertices[n]) + 1]++] = n;
    }
    return true;
}

void girih_vertex_grid_free(girih_vertex_grid *grid) {
    free(grid->first);
    free(grid->order);
    *grid = (girih_vertex_grid){.vertices = NULL};
}

// Puts a vertex among those found, if it belongs there.
static uint32_t insert(girih_near_vertex *found, uint32_t count, uint32_t most,
                       girih_near_vertex one) {
    uint32_t place = count;
    while (place > 0 &&
           (found[place - 1].distance > one.distance ||
            (found[place - 1].distance == one.distance && found[place - 1].vertex > one.vertex))) {
        place--;
    }
    if (place == most) {
        return count;
    }
    const uint32_t last = count < most ? count : most - 1;
    for (uint32_t n = last; n > place; n--) {
        found[n] = found[n - 1];
    }
    found[place] = one;
    return last + 1;
}

typedef struct cell_range {
    int32_t from[2];
    int32_t to[2];
} cell_range;

static int32_t clamp(int32_t value, uint32_t side) {
    return value < 0 ? 0 : value >= (int32_t)side ? (int32_t)side - 1 : value;
}

static cell_range cells_around(const girih_vertex_grid *grid, uint32_t place, int32_t ring) {
    const int32_t u = (int32_t)((place & 0xffff) / grid->cell_size);
    const int32_t v = (int32_t)((place >> 16) / grid->cell_size);
    return (cell_range){{clamp(u - ring, grid->side), clamp(v - ring, grid->side)},
                        {clamp(u + ring, grid->side), clamp(v + ring, grid->side)}};
}

static bool is_within(const cell_range *range, int32_t u, int32_t v) {
    return u >= range->from[0] && u <= range->to[0] && v >= range->from[1] && v <= range->to[1];
}

uint32_t girih_vertex_grid_nearest(const girih_vertex_grid *grid, uint32_t place,
                                   girih_vertex_filter *passes, const void *data,
                                   girih_near_vertex *found, uint32_t most) {
    uint32_t count = 0;
    cell_range done = {{0, 0}, {-1, -1}};
    for (int32_t ring = 0; ring < (int32_t)grid->side; ring++) {
        const cell_range range = cells_around(grid, place, ring);
        for (int32_t v = range.from[1]; v <= range.to[1]; v++) {
            for (int32_t u = range.from[0]; u <= range.to[0]; u++) {
                if (is_within(&done, u, v)) {
                    u = done.to[0];
                    continue;
                }
                const uint32_t cell = (uint32_t)v * grid->side + (uint32_t)u;
                for (uint32_t n = grid->first[cell]; n < grid->first[cell + 1]; n++) {
                    const uint32_t vertex = grid->order[n];
                    if (passes(data, vertex)) {
                        const int64_t distance =
                            girih_squared_distance(place, grid->vertices[vertex]);
                        count = insert(found, count, most, (girih_near_vertex){distance, vertex});
                    }
                }
            }
        }
        done = range;
        // What is left differs by more than `reach` in u or v, and then by 3/4 of its square at
        // least.
        const int64_t reach = (int64_t)ring * grid->cell_size;
        if (count == most && 4 * found[most - 1].distance <= 3 * reach * reach) {
            break;
        }
    }
    return count;
}
