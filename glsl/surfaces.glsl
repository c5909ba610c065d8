// Surfaces: a patch of three corners and their surroundings, and its points. GIRIH_SURFACE chooses:
// 0 flat, 1 Curved PN triangles (Vlachos et al. 2001).
//
// All control points are in world space and permuted by lambda, so that the base pattern's (u,v,w)
// apply to the corners 1, 2, 3 as they are.
//
// Sums are grouped symmetrically: ((b300 u^3 + b030 v^3) + b003 w^3) + ((e12 + e23) + e31) + b111 term,
// each e the sum of its edge's two terms. On an edge one barycentric is 0 and its terms vanish; what
// remains commutes when the ends change roles, so both sides of an edge give the same bits.
#ifndef GIRIH_SURFACES_GLSL
#define GIRIH_SURFACES_GLSL

#include "math.glsl"

#if GIRIH_SURFACE == 1

struct GirihPatch {
    vec3 b300, b030, b003;
    vec3 b210, b120, b021, b012, b102, b201;
    vec3 b111;
    vec3 n200, n020, n002;
    vec3 n110, n011, n101;
};

vec3 girih_patch_position(GirihPatch p, float u, float v, float w) {
    precise float uu = u * u;
    precise float vv = v * v;
    precise float ww = w * w;
    precise vec3 corners = (p.b300 * (uu * u) + p.b030 * (vv * v)) + p.b003 * (ww * w);
    precise vec3 edge12 = p.b210 * (uu * v) + p.b120 * (vv * u);
    precise vec3 edge23 = p.b021 * (vv * w) + p.b012 * (ww * v);
    precise vec3 edge31 = p.b102 * (ww * u) + p.b201 * (uu * w);
    precise vec3 point = (corners + ((edge12 + edge23) + edge31) * 3.0) + p.b111 * (((u * v) * w) * 6.0);
    return girih_no_negative_zero(point);
}

// The quadratic normal, not normalised.
vec3 girih_patch_normal(GirihPatch p, float u, float v, float w) {
    precise vec3 normal = ((p.n200 * (u * u) + p.n020 * (v * v)) + p.n002 * (w * w)) +
                          ((p.n110 * (u * v) + p.n011 * (v * w)) + p.n101 * (w * u));
    return normal;
}

#else

struct GirihPatch {
    vec3 b300, b030, b003;
    vec3 n200, n020, n002;
};

vec3 girih_patch_position(GirihPatch p, float u, float v, float w) {
    precise vec3 point = (p.b300 * u + p.b030 * v) + p.b003 * w;
    return girih_no_negative_zero(point);
}

vec3 girih_patch_normal(GirihPatch p, float u, float v, float w) {
    precise vec3 normal = (p.n200 * u + p.n020 * v) + p.n002 * w;
    return normal;
}

#endif

// Linear interpolation of one attribute of the three corners.
float girih_patch_attribute(float a, float b, float c, float u, float v, float w) {
    precise float value = (a * u + b * v) + c * w;
    return value;
}

// The normal of a point, of unit length, without -0.
vec3 girih_patch_unit_normal(GirihPatch p, float u, float v, float w) {
    return girih_no_negative_zero(girih_normalize(girih_patch_normal(p, u, v, w)));
}

#endif
