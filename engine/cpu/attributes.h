// The host's attributes of an output vertex, interpolated linearly.
#ifndef GIRIH_ENGINE_CPU_ATTRIBUTES_H
#define GIRIH_ENGINE_CPU_ATTRIBUTES_H

#include "item.h"

static inline void girih_write_attributes(const girih_arrays *arrays, const uint32_t vertices[3],
                                          const float b[3], float *out) {
    const uint32_t floats = arrays->frame.attribute_floats;
    const uint32_t *attributes = arrays->words[GIRIH_BIND_ATTRIBUTES];
    for (uint32_t a = 0; a < floats; ++a) {
        out[a] = girih_no_negative_zero(girih_patch_attribute(
            girih_word_float(attributes[(size_t)vertices[0] * floats + a]),
            girih_word_float(attributes[(size_t)vertices[1] * floats + a]),
            girih_word_float(attributes[(size_t)vertices[2] * floats + a]), b[0], b[1], b[2]));
    }
}

#endif
