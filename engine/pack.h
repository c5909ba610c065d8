// What the packing of catalogue, scene and plan share.
#ifndef GIRIH_ENGINE_PACK_H
#define GIRIH_ENGINE_PACK_H

#include <string.h>

#include "arrays.h"

// The most triangles, edges or weld edges of a scene or a plan: edge numbers keep 30 bits beside
// their marks (GIRIH_EDGE_MASK).
#define GIRIH_MAX_COUNT (UINT64_C(1) << 30)

// Gives a binding count words of zero, one at least so that it can be bound.
girih_result girih_allocate_words(girih_arrays *arrays, uint32_t binding, uint64_t count,
                                  girih_error *error);

static inline uint32_t girih_to_word(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static inline uint64_t girih_ceiling_quotient(uint64_t count, uint64_t size) {
    return (count + size - 1) / size;
}

#endif
