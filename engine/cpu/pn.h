// Twin of glsl/pn.glsl: control points of Curved PN triangles (Vlachos et al. 2001) with one curve
// per shared edge (PN-AEN; McDonald, Kilgard 2010).
#ifndef GIRIH_ENGINE_CPU_PN_H
#define GIRIH_ENGINE_CPU_PN_H

#include "scene.h"

// The control point near p of the edge from p to q, for the normal n at p:
// (2p + q - ((q - p)·n) n) / 3.
static inline girih_vector girih_pn_edge_point(girih_vector p, girih_vector q, girih_vector n) {
    const float rise = girih_dot(girih_subtract(q, p), n);
    return girih_scale(girih_subtract(girih_add(girih_add(p, p), q), girih_scale(n, rise)),
                       1.0f / 3.0f);
}

// Both control points of an edge from p to q. `edge` is the word of TRIANGLE_EDGES with its
// reversal relative to the direction p to q. At a seam the curve is the mean of both sides' curves,
// added in the seam's own order.
static inline void girih_pn_edge(const girih_arrays *arrays, girih_vector p, girih_vector q,
                                 girih_vector normal_p, girih_vector normal_q, uint32_t edge,
                                 uint32_t seam_delta, girih_vector *near_p, girih_vector *near_q) {
    if ((edge & GIRIH_EDGE_SEAM) == 0) {
        *near_p = girih_pn_edge_point(p, q, normal_p);
        *near_q = girih_pn_edge_point(q, p, normal_q);
        return;
    }
    const uint32_t *seam =
        arrays->words[GIRIH_BIND_SEAMS] + (size_t)((edge & GIRIH_EDGE_MASK) + seam_delta) * 4;
    const uint32_t at_p = (edge & GIRIH_EDGE_REVERSED) == 0 ? 0 : 1;
    const girih_vector a_p = girih_vertex_normal(arrays, seam[at_p]);
    const girih_vector a_q = girih_vertex_normal(arrays, seam[1 - at_p]);
    const girih_vector b_p = girih_vertex_normal(arrays, seam[2 + at_p]);
    const girih_vector b_q = girih_vertex_normal(arrays, seam[3 - at_p]);
    *near_p = girih_scale(girih_add(girih_pn_edge_point(p, q, a_p), girih_pn_edge_point(p, q, b_p)),
                          0.5f);
    *near_q = girih_scale(girih_add(girih_pn_edge_point(q, p, a_q), girih_pn_edge_point(q, p, b_q)),
                          0.5f);
}

// The mid-edge normal: N_p + N_q reflected in the plane perpendicular to the edge.
static inline girih_vector girih_pn_edge_normal(girih_vector p, girih_vector q,
                                                girih_vector normal_p, girih_vector normal_q) {
    const girih_vector along = girih_subtract(q, p);
    const girih_vector sum = girih_add(normal_p, normal_q);
    const float square = girih_dot(along, along);
    const float factor = square > 0.0f ? 2.0f * girih_dot(along, sum) / square : 0.0f;
    return girih_normalize(girih_subtract(sum, girih_scale(along, factor)));
}

typedef struct girih_pn_points {
    girih_vector b210, b120, b021, b012, b102, b201, b111;
} girih_pn_points;

// b111 from the corners p and the control points of the edges.
static inline girih_vector girih_pn_middle(const girih_vector p[3], const girih_pn_points *c) {
    const girih_vector mean =
        girih_scale(girih_add(girih_add(girih_add(c->b210, c->b120), girih_add(c->b021, c->b012)),
                              girih_add(c->b102, c->b201)),
                    1.0f / 6.0f);
    const girih_vector centre = girih_scale(girih_add(girih_add(p[0], p[1]), p[2]), 1.0f / 3.0f);
    return girih_add(mean, girih_scale(girih_subtract(mean, centre), 0.5f));
}

// The inner control points of a triangle with corners p, normals n, and edge words e for its edges
// 12, 23, 31.
static inline girih_pn_points girih_make_pn_points(const girih_arrays *arrays,
                                                   const girih_vector p[3], const girih_vector n[3],
                                                   const uint32_t e[3], uint32_t seam_delta) {
    girih_pn_points c;
    girih_pn_edge(arrays, p[0], p[1], n[0], n[1], e[0], seam_delta, &c.b210, &c.b120);
    girih_pn_edge(arrays, p[1], p[2], n[1], n[2], e[1], seam_delta, &c.b021, &c.b012);
    girih_pn_edge(arrays, p[2], p[0], n[2], n[0], e[2], seam_delta, &c.b102, &c.b201);
    c.b111 = girih_pn_middle(p, &c);
    return c;
}

// The same where no edge is a seam.
static inline girih_pn_points girih_make_smooth_pn_points(const girih_vector p[3],
                                                          const girih_vector n[3]) {
    girih_pn_points c = {
        .b210 = girih_pn_edge_point(p[0], p[1], n[0]),
        .b120 = girih_pn_edge_point(p[1], p[0], n[1]),
        .b021 = girih_pn_edge_point(p[1], p[2], n[1]),
        .b012 = girih_pn_edge_point(p[2], p[1], n[2]),
        .b102 = girih_pn_edge_point(p[2], p[0], n[2]),
        .b201 = girih_pn_edge_point(p[0], p[2], n[0]),
    };
    c.b111 = girih_pn_middle(p, &c);
    return c;
}

#endif
