// The vertices of a pattern by place, to find those that are nearest to another one.
#ifndef GIRIH_PATTERN_GEN_NEAREST_VERTICES_H
#define GIRIH_PATTERN_GEN_NEAREST_VERTICES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct girih_vertex_grid {
    const uint32_t *vertices; // packed
    uint32_t side;            // cells along u, and along v
    uint32_t cell_size;
    uint32_t *first; // by cell, of `order`, and the end
    uint32_t *order; // vertices by cell
} girih_vertex_grid;

// One that was found.
typedef struct girih_near_vertex {
    int64_t distance; // girih_squared_distance
    uint32_t vertex;
} girih_near_vertex;

// Which vertices count.
typedef bool girih_vertex_filter(const void *data, uint32_t vertex);

// The square of the distance of two packed vertices in an equilateral whole with sides of 32768,
// exactly.
int64_t girih_squared_distance(uint32_t a, uint32_t b);

// False without memory. To be freed in either case.
bool girih_vertex_grid_create(girih_vertex_grid *grid, const uint32_t *vertices, uint32_t count);

// The nearest `most` of the vertices that pass, the nearest first, of two that are as near the
// lower; how many there are.
uint32_t girih_vertex_grid_nearest(const girih_vertex_grid *grid, uint32_t place,
                                   girih_vertex_filter *passes, const void *data,
                                   girih_near_vertex *found, uint32_t most);

void girih_vertex_grid_free(girih_vertex_grid *grid);

#endif
