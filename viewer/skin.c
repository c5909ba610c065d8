#include "skin.h"

#include <stdlib.h>

typedef struct influence {
    uint32_t joint;
    double weight;
} influence;

// Adds to the joint's weight in a list, or behind it; returns the new count.
static uint32_t add_influence(influence *list, uint32_t count, uint32_t joint, double weight) {
    uint32_t n = 0;
    while (n < count && list[n].joint != joint) {
        n++;
    }
    if (n < count) {
        list[n].weight += weight;
        return count;
    }
    list[n] = (influence){joint, weight};
    return count + 1;
}

// Larger weights first, ties by joint: an order that depends on nothing else.
static int compare(const void *a, const void *b) {
    const influence *first = a;
    const influence *second = b;
    if (first->weight != second->weight) {
        return first->weight > second->weight ? -1 : 1;
    }
    return (first->joint > second->joint) - (first->joint < second->joint);
}

// list has room for 4 * influence_count: of all corners together, then those of one. A product of
// two floats is exact in double, and on an edge at most two corners count, so that no order of the
// corners shows in the sums.
static uint32_t gather(const girih_gltf_primitive *source, const uint32_t corners[3],
                       const float barycentric[3], influence *list) {
    const uint32_t width = source->influence_count;
    uint32_t count = 0;
    for (uint32_t c = 0; c < 3; c++) {
        if (barycentric[c] == 0.0f) {
            continue;
        }
        const size_t at = (size_t)corners[c] * width;
        influence *corner = list + 3 * (size_t)width;
        uint32_t corner_count = 0;
        for (uint32_t n = 0; n < width; n++) {
            if (source->weights[at + n] > 0.0f) {
                corner_count = add_influence(corner, corner_count, source->joints[at + n],
                                             (double)source->weights[at + n]);
            }
        }
        for (uint32_t n = 0; n < corner_count; n++) {
            count = add_influence(list, count, corner[n].joint,
                                  corner[n].weight * (double)barycentric[c]);
        }
    }
    return count;
}

bool girih_skin_vertices(const girih_gltf_primitive *source, const girih_placed_vertices *vertices,
                         uint32_t *joints, float *weights) {
    const uint32_t width = source->influence_count;
    influence *list = malloc(4 * (size_t)width * sizeof *list);
    if (list == NULL) {
        return false;
    }
    for (uint32_t v = 0; v < vertices->count; v++) {
        uint32_t corners[3];
        girih_placed_corners(vertices, v, corners);
        uint32_t count = gather(source, corners, vertices->barycentrics[v], list);
        qsort(list, count, sizeof *list, compare);
        count = count < width ? count : width;
        double sum = 0.0;
        for (uint32_t n = 0; n < count; n++) {
            sum += list[n].weight;
        }
        for (uint32_t n = 0; n < width; n++) {
            bool is_there = n < count;
            joints[(size_t)v * width + n] = is_there ? list[n].joint : 0;
            weights[(size_t)v * width + n] = is_there ? (float)(list[n].weight / sum) : 0.0f;
        }
    }
    free(list);
    return true;
}
