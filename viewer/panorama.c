#include "panorama.h"

#include <math.h>

// 160 degrees.
static const double widest = 2.7925268031909273;

uint32_t girih_panorama_slice_count(double view_angle) {
    // A picture of 160 degrees is one slice, whatever its float rounds to.
    return view_angle > widest ? (uint32_t)ceil(view_angle / widest - 1e-6) : 1;
}

girih_panorama_slice girih_panorama_slice_get(uint32_t n, uint32_t width, double view_angle) {
    const uint64_t count = girih_panorama_slice_count(view_angle);
    const uint32_t first = (uint32_t)(n * (uint64_t)width / count);
    const uint32_t end = (uint32_t)((n + UINT64_C(1)) * width / count);
    const double per_column = view_angle / width;
    return (girih_panorama_slice){
        .x = first,
        .width = end - first,
        .middle = ((double)first + (double)end - (double)width) * 0.5 * per_column,
        .half_angle = (double)(end - first) * 0.5 * per_column,
    };
}
