// The slices that a cylindrical projection is drawn in: panorama.glsl tells why.
#ifndef GIRIH_VIEWER_PANORAMA_H
#define GIRIH_VIEWER_PANORAMA_H

#include <stdint.h>

typedef struct girih_panorama_slice {
    uint32_t x, width; // columns of the picture
    double middle;     // radians to the right of the picture's middle
    double half_angle; // radians
} girih_panorama_slice;

// How many slices a picture of this angle of view (radians) takes.
uint32_t girih_panorama_slice_count(double view_angle);

// Slice n of a picture `width` columns wide; together they fill it.
girih_panorama_slice girih_panorama_slice_get(uint32_t n, uint32_t width, double view_angle);

#endif
