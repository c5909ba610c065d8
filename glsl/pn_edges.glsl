// Curved PN triangles of the scene: one curve per shared edge, at seams too (PN-AEN; McDonald, Kilgard
// 2010).
#ifndef GIRIH_PN_EDGES_GLSL
#define GIRIH_PN_EDGES_GLSL

#include "pn.glsl"
#include "scene.glsl"

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

// The inner control points of a triangle with corners p, normals n, and edge words e for its edges 12, 23, 31.
GirihPnPoints girih_pn_points(vec3 p[3], vec3 n[3], uint e[3], uint seam_delta, uint first) {
    GirihPnPoints c;
    girih_pn_edge(p[0], p[1], n[0], n[1], e[0], seam_delta, first, c.b210, c.b120);
    girih_pn_edge(p[1], p[2], n[1], n[2], e[1], seam_delta, first, c.b021, c.b012);
    girih_pn_edge(p[2], p[0], n[2], n[0], e[2], seam_delta, first, c.b102, c.b201);
    girih_pn_centre(p, c);
    return c;
}

#endif
