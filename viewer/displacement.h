// --displace: a surface moved along its normal by a height map. The CPU's twin of
// shaders/displaced.glsl and glsl/displace.glsl.
#ifndef GIRIH_VIEWER_DISPLACEMENT_H
#define GIRIH_VIEWER_DISPLACEMENT_H

#include <stdbool.h>

#include "girih/cpu.h"
#include "height_map.h"

typedef struct girih_displacement {
    girih_height_map map;
    float per_unit;          // mesh units that a difference of 1 in the map comes to
    float zero;              // the map's value that moves nothing
    uint32_t texcoord_float; // where texture coordinates begin in a vertex's attributes
    bool by_axes;            // there are none: by position, the map going
    float repeats;           // this often into a mesh unit
} girih_displacement;

// The map's height at (u, v), filtered bilinearly, the map repeating. Any u and v will do.
float girih_displacement_height(const girih_height_map *map, float u, float v);

// How far the surface strays from its base, in mesh units.
float girih_displacement_distance(const girih_displacement *displacement);

// A girih_cpu_surface; user is the girih_displacement.
void girih_displacement_surface(void *user, const girih_cpu_patch *patch,
                                const float barycentric[3], float position[3]);

#endif
