// Twin of glsl/math.glsl: arithmetic on the way to positions, levels and culling. Every sum is
// written out in the shader's grouping, and no product may be contracted with a sum, so that both
// round alike. Floating point must be IEEE 754 single precision throughout.
#ifndef GIRIH_ENGINE_CPU_VECTOR_H
#define GIRIH_ENGINE_CPU_VECTOR_H

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__FAST_MATH__) || FLT_EVAL_METHOD != 0
#error "the CPU twins need IEEE 754 float arithmetic: no -ffast-math, no x87"
#endif

typedef struct girih_vector {
    float x, y, z;
} girih_vector;

static inline uint32_t girih_float_word(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static inline float girih_word_float(uint32_t word) {
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

static inline float girih_min(float a, float b) {
    return b < a ? b : a;
}

static inline float girih_max(float a, float b) {
    return a < b ? b : a;
}

static inline girih_vector girih_add(girih_vector a, girih_vector b) {
    return (girih_vector){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline girih_vector girih_subtract(girih_vector a, girih_vector b) {
    return (girih_vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline girih_vector girih_scale(girih_vector a, float factor) {
    return (girih_vector){a.x * factor, a.y * factor, a.z * factor};
}

static inline girih_vector girih_negate(girih_vector a) {
    return (girih_vector){-a.x, -a.y, -a.z};
}

static inline girih_vector girih_absolute(girih_vector a) {
    return (girih_vector){fabsf(a.x), fabsf(a.y), fabsf(a.z)};
}

static inline girih_vector girih_min_vector(girih_vector a, girih_vector b) {
    return (girih_vector){girih_min(a.x, b.x), girih_min(a.y, b.y), girih_min(a.z, b.z)};
}

static inline girih_vector girih_max_vector(girih_vector a, girih_vector b) {
    return (girih_vector){girih_max(a.x, b.x), girih_max(a.y, b.y), girih_max(a.z, b.z)};
}

static inline float girih_dot(girih_vector a, girih_vector b) {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

static inline girih_vector girih_cross(girih_vector a, girih_vector b) {
    return (girih_vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// An upper bound of a vector's length without a root: sqrt(1 + a^2 + b^2) <= 1 + (a + b) / 2 for a,
// b in [0,1].
static inline float girih_length_bound(girih_vector a) {
    const girih_vector m = girih_absolute(a);
    return 0.5f * (girih_max(girih_max(m.x, m.y), m.z) + ((m.x + m.y) + m.z));
}

static inline float girih_no_negative_zero(float x) {
    return girih_float_word(x) == 0x80000000u ? 0.0f : x;
}

static inline girih_vector girih_no_negative_zeros(girih_vector p) {
    return (girih_vector){girih_no_negative_zero(p.x), girih_no_negative_zero(p.y),
                          girih_no_negative_zero(p.z)};
}

// Rows of an affine map applied to a point.
typedef struct girih_transform {
    girih_vector row[3];
    float offset[3];
} girih_transform;

static inline girih_vector girih_transform_point(const girih_transform *t, girih_vector p) {
    return (girih_vector){girih_dot(t->row[0], p) + t->offset[0],
                          girih_dot(t->row[1], p) + t->offset[1],
                          girih_dot(t->row[2], p) + t->offset[2]};
}

// Only ever used for shading: zero stays zero.
static inline girih_vector girih_normalize(girih_vector n) {
    const float square = girih_dot(n, n);
    return square > 0.0f ? girih_scale(n, 1.0f / sqrtf(square)) : (girih_vector){0.0f, 0.0f, 0.0f};
}

#endif
