// The points of the library's own surfaces, baked or welded, eight at a time.
#ifndef GIRIH_ENGINE_CPU_POINTS_H
#define GIRIH_ENGINE_CPU_POINTS_H

#include "../arrays.h"

// Writes OUT_POSITIONS and OUT_ATTRIBUTES of all items, in one window.
void girih_twin_points(girih_arrays *arrays, girih_surface surface);

#endif
