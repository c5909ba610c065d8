// Control points of Curved PN triangles (Vlachos et al. 2001) with one curve per shared edge (PN-AEN;
// McDonald, Kilgard 2010).
#ifndef GIRIH_PN_GLSL
#define GIRIH_PN_GLSL

#include "scene.glsl"

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

// Both control points of an edge from p (x of the result's pair: near p) to q. `edge` is the word of
// TRIANGLE_EDGES with its reversal relative to the direction p to q. At a seam the curve is the mean
// of both sides' curves, added in the seam's own order. `first`: as girih_vertex's.
void girih_pn_edge(vec3 p, vec3 q, vec3 normal_p, vec3 normal_q, uint edge, uint seam_delta, uint first,
                   out vec3 near_p, out vec3 near_q) {
    if (!girih_has(GIRIH_VARIANT_SEAMS) || (edge & GIRIH_EDGE_SEAM) == 0u) {
        near_p = girih_pn_edge_point(p, q, normal_p);
        near_q = girih_pn_edge_point(q, p, normal_q);
        return;
    }
    uint seam = ((edge & GIRIH_EDGE_MASK) + seam_delta) * 4u;
    uint at_p = (edge & GIRIH_EDGE_REVERSED) == 0u ? 0u : 1u;
    vec3 a_p = girih_vertex_normal(GIRIH_AT_SEAMS(seam + at_p) + first);
    vec3 a_q = girih_vertex_normal(GIRIH_AT_SEAMS(seam + 1u - at_p) + first);
    vec3 b_p = girih_vertex_normal(GIRIH_AT_SEAMS(seam + 2u + at_p) + first);
    vec3 b_q = girih_vertex_normal(GIRIH_AT_SEAMS(seam + 3u - at_p) + first);
    precise vec3 sum_p = girih_pn_edge_point(p, q, a_p) + girih_pn_edge_point(p, q, b_p);
    precise vec3 sum_q = girih_pn_edge_point(q, p, a_q) + girih_pn_edge_point(q, p, b_q);
    near_p = sum_p * 0.5;
    near_q = sum_q * 0.5;
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

// The inner control points of a triangle with corners p, normals n, and edge words e for its edges 12, 23, 31.
GirihPnPoints girih_pn_points(vec3 p[3], vec3 n[3], uint e[3], uint seam_delta, uint first) {
    GirihPnPoints c;
    girih_pn_edge(p[0], p[1], n[0], n[1], e[0], seam_delta, first, c.b210, c.b120);
    girih_pn_edge(p[1], p[2], n[1], n[2], e[1], seam_delta, first, c.b021, c.b012);
    girih_pn_edge(p[2], p[0], n[2], n[0], e[2], seam_delta, first, c.b102, c.b201);
    precise vec3 mean = (((c.b210 + c.b120) + (c.b021 + c.b012)) + (c.b102 + c.b201)) * girih_sixth;
    precise vec3 centre = ((p[0] + p[1]) + p[2]) * girih_third;
    precise vec3 inner = mean + (mean - centre) * 0.5;
    c.b111 = inner;
    return c;
}

#endif
