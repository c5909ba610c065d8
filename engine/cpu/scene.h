// Twin of glsl/arrays.glsl and glsl/scene.glsl: reading the arrays' records.
#ifndef GIRIH_ENGINE_CPU_SCENE_H
#define GIRIH_ENGINE_CPU_SCENE_H

#include "../arrays.h"
#include "vector.h"

static inline uint32_t girih_word(const girih_arrays *arrays, uint32_t binding, size_t index) {
    return arrays->words[binding][index];
}

// Word `field` of a rank's pattern.
static inline uint32_t girih_pattern(const girih_arrays *arrays, uint32_t rank, uint32_t field) {
    return girih_word(arrays, GIRIH_BIND_PATTERNS, rank * GIRIH_PATTERN_WORDS + field);
}

// The rank of a range.
static inline uint32_t girih_range_rank(const girih_arrays *arrays, uint32_t range) {
    return girih_word(arrays, GIRIH_BIND_PATTERNS,
                      arrays->frame.pattern_count * GIRIH_PATTERN_WORDS + range);
}

// Index n of the patterns'.
static inline uint32_t girih_pattern_index(const girih_arrays *arrays, uint32_t n) {
    return girih_word(arrays, GIRIH_BIND_PATTERN_INDICES, n);
}

static inline uint32_t girih_instance_word(const girih_arrays *arrays, uint32_t instance,
                                           uint32_t field) {
    return girih_word(arrays, GIRIH_BIND_INSTANCES, instance * GIRIH_INSTANCE_WORDS + field);
}

static inline uint32_t girih_group_word(const girih_arrays *arrays, uint32_t group,
                                        uint32_t field) {
    return girih_word(arrays, GIRIH_BIND_GROUPS, (size_t)group * GIRIH_GROUP_WORDS + field);
}

// The instance that the plan's triangle, edge or weld edge `number` belongs to: `first` is the
// field with an instance's first number, `blocks` where the words for this kind begin in BLOCKS.
static inline uint32_t girih_find_instance(const girih_arrays *arrays, uint32_t number,
                                           uint32_t first, uint32_t blocks) {
    if (arrays->frame.instance_count == 1) {
        return 0;
    }
    uint32_t instance = girih_word(arrays, GIRIH_BIND_BLOCKS, blocks + number / GIRIH_BLOCK);
    while (girih_instance_word(arrays, instance + 1, first) <= number) {
        ++instance;
    }
    return instance;
}

static inline girih_vector girih_read_vector(const uint32_t *words) {
    return (girih_vector){girih_word_float(words[0]), girih_word_float(words[1]),
                          girih_word_float(words[2])};
}

static inline girih_vector girih_vertex_position(const girih_arrays *arrays, uint32_t vertex) {
    return girih_read_vector(arrays->words[GIRIH_BIND_VERTICES] +
                             (size_t)vertex * GIRIH_VERTEX_WORDS);
}

static inline girih_vector girih_vertex_normal(const girih_arrays *arrays, uint32_t vertex) {
    return girih_read_vector(arrays->words[GIRIH_BIND_VERTICES] +
                             (size_t)vertex * GIRIH_VERTEX_WORDS + 3);
}

static inline girih_transform girih_instance_transform(const girih_arrays *arrays,
                                                       uint32_t instance) {
    const uint32_t *words = arrays->words[GIRIH_BIND_INSTANCES] +
                            (size_t)instance * GIRIH_INSTANCE_WORDS + GIRIH_INSTANCE_TRANSFORM;
    girih_transform transform;
    for (int n = 0; n < 3; ++n) {
        transform.row[n] = girih_read_vector(words + 4 * n);
        transform.offset[n] = girih_word_float(words[4 * n + 3]);
    }
    return transform;
}

static inline girih_transform girih_instance_normal_transform(const girih_arrays *arrays,
                                                              uint32_t instance) {
    const uint32_t *words = arrays->words[GIRIH_BIND_INSTANCES] +
                            (size_t)instance * GIRIH_INSTANCE_WORDS + GIRIH_INSTANCE_NORMAL;
    girih_transform transform;
    for (int n = 0; n < 3; ++n) {
        transform.row[n] = girih_read_vector(words + 4 * n);
        transform.offset[n] = 0.0f;
    }
    return transform;
}

#endif
