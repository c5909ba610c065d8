// Control points of Curved PN triangles (Vlachos et al. 2001).
#ifndef GIRIH_PN_GLSL
#define GIRIH_PN_GLSL

#include "math.glsl"

// Multiplied by, not divided by 3 or 6: x / 3 differs from x * (1/3) in a third of all cases.
const float girih_third = 1.0 / 3.0;
const float girih_sixth = 1.0 / 6.0;

// The control point near p of the edge from p to q, for the normal n at p: (2p + q - ((q - p)·n) n) / 3.
// It depends on the edge alone, so both sides compute the same.
vec3 girih_pn_edge_point(vec3 p, vec3 q, vec3 n) {
    precise vec3 along = q - p;
    precise float rise = girih_dot(along, n);
    precise vec3 point = (((p + p) + q) - n * rise) * girih_third;
    return point;
}

// The mid-edge normal: N_p + N_q reflected in the plane perpendicular to the edge. Shading only, so it may divide.
vec3 girih_pn_edge_normal(vec3 p, vec3 q, vec3 normal_p, vec3 normal_q) {
    precise vec3 along = q - p;
    precise vec3 sum = normal_p + normal_q;
    precise float square = girih_dot(along, along);
    precise float factor = square > 0.0 ? 2.0 * girih_dot(along, sum) / square : 0.0;
    precise vec3 normal = sum - along * factor;
    return girih_normalize(normal);
}

struct GirihPnPoints {
    vec3 b210, b120, b021, b012, b102, b201, b111;
};

// The control points of the inside, from those of the edges.
void girih_pn_centre(vec3 p[3], inout GirihPnPoints c) {
    precise vec3 mean = (((c.b210 + c.b120) + (c.b021 + c.b012)) + (c.b102 + c.b201)) * girih_sixth;
    precise vec3 centre = ((p[0] + p[1]) + p[2]) * girih_third;
    precise vec3 inner = mean + (mean - centre) * 0.5;
    c.b111 = inner;
}

#endif
