// Control points of a triangle, gathered from the scene and brought into the world.
#ifndef GIRIH_GATHER_GLSL
#define GIRIH_GATHER_GLSL

#include "pn_edges.glsl"
#include "surfaces.glsl"

// Float n of the scene's attributes, between three vertices.
float girih_scene_attribute(uint vertices[3], uint n, vec3 barycentric) {
    uint floats = girih_frame.attribute_floats;
    return girih_patch_attribute(uintBitsToFloat(GIRIH_AT_ATTRIBUTES(vertices[0] * floats + n)),
                                 uintBitsToFloat(GIRIH_AT_ATTRIBUTES(vertices[1] * floats + n)),
                                 uintBitsToFloat(GIRIH_AT_ATTRIBUTES(vertices[2] * floats + n)), barycentric.x,
                                 barycentric.y, barycentric.z);
}

// `edges` are the words of TRIANGLE_EDGES of the edges 12, 23, 31 of `vertices`, with their reversal
// relative to these directions. `previous`: as it was in the previous girih_frame.
GirihPatch girih_gather_patch(uint instance, uint vertices[3], uint edges[3], bool previous) {
    uint first = previous ? girih_frame.previous_vertices : 0u;
    vec3 p[3];
    vec3 n[3];
    for (uint corner = 0u; corner < 3u; ++corner) {
        girih_vertex(vertices[corner], first, p[corner], n[corner]);
    }
    uint when = previous ? GIRIH_INSTANCE_PREVIOUS : 0u;
    GirihTransform t = girih_instance_transform(instance, when);
    GirihTransform nt = girih_instance_normal_transform(instance, when);
    GirihPatch patch_;
    patch_.b300 = girih_transform_point(t, p[0]);
    patch_.b030 = girih_transform_point(t, p[1]);
    patch_.b003 = girih_transform_point(t, p[2]);
    patch_.n200 = girih_transform_point(nt, n[0]);
    patch_.n020 = girih_transform_point(nt, n[1]);
    patch_.n002 = girih_transform_point(nt, n[2]);
#if GIRIH_CURVED == 1
    GirihPnPoints c = girih_pn_points(p, n, edges, girih_instance(instance, GIRIH_INSTANCE_SEAM_DELTA), first);
    patch_.b210 = girih_transform_point(t, c.b210);
    patch_.b120 = girih_transform_point(t, c.b120);
    patch_.b021 = girih_transform_point(t, c.b021);
    patch_.b012 = girih_transform_point(t, c.b012);
    patch_.b102 = girih_transform_point(t, c.b102);
    patch_.b201 = girih_transform_point(t, c.b201);
    patch_.b111 = girih_transform_point(t, c.b111);
    patch_.n110 = girih_transform_point(nt, girih_pn_edge_normal(p[0], p[1], n[0], n[1]));
    patch_.n011 = girih_transform_point(nt, girih_pn_edge_normal(p[1], p[2], n[1], n[2]));
    patch_.n101 = girih_transform_point(nt, girih_pn_edge_normal(p[2], p[0], n[2], n[0]));
#endif
    return patch_;
}

#if GIRIH_SURFACE != 2

// The edge from vertex a to vertex b, `edge` its word of TRIANGLE_EDGES relative to that direction.
GirihCurve girih_gather_curve(uint instance, uint a, uint b, uint edge) {
    vec3 p[2];
    vec3 n[2];
    girih_vertex(a, 0u, p[0], n[0]);
    girih_vertex(b, 0u, p[1], n[1]);
    GirihTransform t = girih_instance_transform(instance, 0u);
    GirihTransform nt = girih_instance_normal_transform(instance, 0u);
    GirihCurve curve;
    curve.b30 = girih_transform_point(t, p[0]);
    curve.b03 = girih_transform_point(t, p[1]);
    curve.n20 = girih_transform_point(nt, n[0]);
    curve.n02 = girih_transform_point(nt, n[1]);
#if GIRIH_CURVED == 1
    vec3 near_a;
    vec3 near_b;
    girih_pn_edge(p[0], p[1], n[0], n[1], edge, girih_instance(instance, GIRIH_INSTANCE_SEAM_DELTA), 0u, near_a, near_b);
    curve.b21 = girih_transform_point(t, near_a);
    curve.b12 = girih_transform_point(t, near_b);
    curve.n11 = girih_transform_point(nt, girih_pn_edge_normal(p[0], p[1], n[0], n[1]));
#endif
    return curve;
}

#endif

#endif
