// Twin of glsl/surfaces.glsl: a patch of three corners and their surroundings, and its points. Sums
// are grouped symmetrically, so that both sides of an edge give the same bits, as the shader says.
#ifndef GIRIH_ENGINE_CPU_SURFACES_H
#define GIRIH_ENGINE_CPU_SURFACES_H

#include "vector.h"

#include "girih/surface.h"

// In world space and permuted by lambda. A flat patch has corners and their normals alone.
typedef struct girih_patch {
    girih_surface surface;
    girih_vector b300, b030, b003;
    girih_vector b210, b120, b021, b012, b102, b201;
    girih_vector b111;
    girih_vector n200, n020, n002;
    girih_vector n110, n011, n101;
} girih_patch;

static inline girih_vector girih_patch_position(const girih_patch *p, float u, float v, float w) {
    if (p->surface != GIRIH_SURFACE_PN) {
        return girih_no_negative_zeros(girih_add(
            girih_add(girih_scale(p->b300, u), girih_scale(p->b030, v)), girih_scale(p->b003, w)));
    }
    const float uu = u * u;
    const float vv = v * v;
    const float ww = w * w;
    const girih_vector corners =
        girih_add(girih_add(girih_scale(p->b300, uu * u), girih_scale(p->b030, vv * v)),
                  girih_scale(p->b003, ww * w));
    const girih_vector edge12 =
        girih_add(girih_scale(p->b210, uu * v), girih_scale(p->b120, vv * u));
    const girih_vector edge23 =
        girih_add(girih_scale(p->b021, vv * w), girih_scale(p->b012, ww * v));
    const girih_vector edge31 =
        girih_add(girih_scale(p->b102, ww * u), girih_scale(p->b201, uu * w));
    const girih_vector edges = girih_add(girih_add(edge12, edge23), edge31);
    return girih_no_negative_zeros(girih_add(girih_add(corners, girih_scale(edges, 3.0f)),
                                             girih_scale(p->b111, ((u * v) * w) * 6.0f)));
}

// The linear or quadratic normal, not normalised.
static inline girih_vector girih_patch_normal(const girih_patch *p, float u, float v, float w) {
    if (p->surface != GIRIH_SURFACE_PN) {
        return girih_add(girih_add(girih_scale(p->n200, u), girih_scale(p->n020, v)),
                         girih_scale(p->n002, w));
    }
    const girih_vector corners =
        girih_add(girih_add(girih_scale(p->n200, u * u), girih_scale(p->n020, v * v)),
                  girih_scale(p->n002, w * w));
    const girih_vector edges =
        girih_add(girih_add(girih_scale(p->n110, u * v), girih_scale(p->n011, v * w)),
                  girih_scale(p->n101, w * u));
    return girih_add(corners, edges);
}

// Linear interpolation of one attribute of the three corners.
static inline float girih_patch_attribute(float a, float b, float c, float u, float v, float w) {
    return (a * u + b * v) + c * w;
}

// The normal of a point, of unit length, without -0.
static inline girih_vector girih_patch_unit_normal(const girih_patch *p, float u, float v,
                                                   float w) {
    return girih_no_negative_zeros(girih_normalize(girih_patch_normal(p, u, v, w)));
}

#endif
