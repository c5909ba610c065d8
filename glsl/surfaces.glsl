// Surfaces: a patch of three corners and their surroundings, and its points. GIRIH_SURFACE chooses:
// 0 flat, 1 Curved PN triangles (Vlachos et al. 2001), 2 a host's own (own.glsl) over GIRIH_BASE: 0
// flat, 1 Curved PN triangles.
//
// All control points are in world space. Those of the library's own surfaces are permuted by lambda, so
// that the base pattern's (u,v,w) apply to the corners 1, 2, 3 as they are; a host's surface gets them
// in the order of the input.
//
// Sums are grouped symmetrically: ((b300 u^3 + b030 v^3) + b003 w^3) + ((e12 + e23) + e31) + b111 term,
// each e the sum of its edge's two terms. On an edge one barycentric is 0 and its terms vanish; what
// remains commutes when the ends change roles, so both sides of an edge give the same bits.
#ifndef GIRIH_SURFACES_GLSL
#define GIRIH_SURFACES_GLSL

#include "math.glsl"

#ifndef GIRIH_BASE
#define GIRIH_BASE 1
#endif
#if GIRIH_SURFACE == 1 || (GIRIH_SURFACE == 2 && GIRIH_BASE == 1)
#define GIRIH_CURVED 1
#else
#define GIRIH_CURVED 0
#endif

// What a host's surface may want to know beside the control points.
#if GIRIH_SURFACE == 2
#define GIRIH_PATCH_SOURCE \
    uint vertices[3];  /* of the scene, for girih_attribute */ \
    uint triangle;     /* of the scene */ \
    uint instance;     /* of the plan */ \
    uint material; \
    float scale;       /* mesh units to world units: the cube root of the transform's |determinant| */ \
    bool mirrored;     /* the transform turns the winding round */ \
    bool previous;     /* as it was in the previous frame */
#else
#define GIRIH_PATCH_SOURCE
#endif

#if GIRIH_CURVED == 1

struct GirihPatch {
    vec3 b300, b030, b003;
    vec3 b210, b120, b021, b012, b102, b201;
    vec3 b111;
    vec3 n200, n020, n002;
    vec3 n110, n011, n101;
    GIRIH_PATCH_SOURCE
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

// An edge of a patch, with its bits: the third corner's terms are zeros there.
struct GirihCurve {
    vec3 b30, b03, b21, b12;
    vec3 n20, n02, n11;
};

vec3 girih_curve_position(GirihCurve c, float u, float v) {
    precise float uu = u * u;
    precise float vv = v * v;
    precise vec3 ends = c.b30 * (uu * u) + c.b03 * (vv * v);
    precise vec3 edge = c.b21 * (uu * v) + c.b12 * (vv * u);
    precise vec3 point = ends + edge * 3.0;
    return girih_no_negative_zero(point);
}

vec3 girih_curve_normal(GirihCurve c, float u, float v) {
    precise vec3 normal = (c.n20 * (u * u) + c.n02 * (v * v)) + c.n11 * (u * v);
    return normal;
}

#else

struct GirihPatch {
    vec3 b300, b030, b003;
    vec3 n200, n020, n002;
    GIRIH_PATCH_SOURCE
};

struct GirihCurve {
    vec3 b30, b03, n20, n02;
};

vec3 girih_curve_position(GirihCurve c, float u, float v) {
    precise vec3 point = c.b30 * u + c.b03 * v;
    return girih_no_negative_zero(point);
}

vec3 girih_curve_normal(GirihCurve c, float u, float v) {
    precise vec3 normal = c.n20 * u + c.n02 * v;
    return normal;
}

vec3 girih_patch_position(GirihPatch p, float u, float v, float w) {
    precise vec3 point = (p.b300 * u + p.b030 * v) + p.b003 * w;
    return girih_no_negative_zero(point);
}

vec3 girih_patch_normal(GirihPatch p, float u, float v, float w) {
    precise vec3 normal = (p.n200 * u + p.n020 * v) + p.n002 * w;
    return normal;
}

#endif

// From a pattern's weights.
vec3 girih_barycentric(uvec3 weights) {
    return vec3(weights) * (1.0 / 32768.0);
}

// From the finer ones that places in a root have: over GIRIH_SPLIT_ONE.
vec3 girih_root_barycentric(uvec3 weights) {
    return vec3(weights) * (1.0 / 8388608.0);
}

// Linear interpolation of one attribute of the three corners.
float girih_patch_attribute(float a, float b, float c, float u, float v, float w) {
    precise float value = (a * u + b * v) + c * w;
    return value;
}

// The normal of a point, of unit length, without -0.
vec3 girih_patch_unit_normal(GirihPatch p, float u, float v, float w) {
    return girih_no_negative_zero(girih_normalize(girih_patch_normal(p, u, v, w)));
}

vec3 girih_curve_unit_normal(GirihCurve c, float u, float v) {
    return girih_no_negative_zero(girih_normalize(girih_curve_normal(c, u, v)));
}

#endif
