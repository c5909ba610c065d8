// Height maps: one channel of a picture as floats.
#ifndef GIRIH_VIEWER_HEIGHT_MAP_H
#define GIRIH_VIEWER_HEIGHT_MAP_H

#include <stdint.h>

#include "girih/result.h"

// The most texels along either side.
#define GIRIH_HEIGHT_MAP_MAX_SIDE 16384u

typedef struct girih_height_map {
    uint32_t width, height;
    float *texels;          // [height][width], the top row first: v = 0 in glTF's coordinates
    float minimum, maximum; // of the texels, all of which are finite
} girih_height_map;

// Loads a PNG or OpenEXR file. PNG: the grey or the red channel of any kind of PNG, 0..1: each
// value divided by the largest that its bits can hold; gamma is left alone, heights are no colours.
// OpenEXR: channel Y, else R, else the first, as the numbers stand in the file, in its first part,
// scanlines or tiles (full resolution), half, float or uint (rounded to float).
// On success girih_height_map_free takes the map, on failure it is empty and the message names the
// file. Thread-safe.
girih_result girih_height_map_load(const char *path, girih_height_map *map, girih_error *error);

// Takes an empty map too, and leaves one.
void girih_height_map_free(girih_height_map *map);

#endif
