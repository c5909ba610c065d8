// girih in a host's own vertex shader. Before the include, define
//   GIRIH_MODE     0: instanced; 1: baked or welded
//   GIRIH_SURFACE  0: flat; 1: Curved PN triangles
// and where the instanced mode's attributes are wanted, GIRIH_SET: the descriptor set number that
// girih_cmd_draw binds. girih_point() gives the vertex in both modes alike, and the pipeline's vertex
// input is girih_plan_vertex_input's. Instanced, girih takes the input locations 0 to 13; baked, 0 and
// 1, and the attributes are the host's to declare: floats of binding 1 from byte 12 on.
#ifndef GIRIH_GLSL
#define GIRIH_GLSL

struct GirihPoint {
    vec3 position;   // world
    vec3 normal;     // world, unit length
    uint key;        // instanced: group << 3 | lambda, group = material * ranges + range
    uvec3 vertices;  // instanced: the scene's vertices at the patch's corners
    vec3 barycentric; // instanced: their weights
};

#if GIRIH_MODE == 0

#include "surfaces.glsl"

layout(location = 0) in uint girih_pattern_vertex; // u | v << 16, over 32768
layout(location = 1) in vec4 girih_patch_0;
layout(location = 2) in vec4 girih_patch_1;
layout(location = 3) in vec4 girih_patch_2;
layout(location = 4) in vec4 girih_patch_3;
#if GIRIH_SURFACE == 1
layout(location = 5) in vec4 girih_patch_4;
layout(location = 6) in vec4 girih_patch_5;
layout(location = 7) in vec4 girih_patch_6;
layout(location = 8) in vec4 girih_patch_7;
layout(location = 9) in vec4 girih_patch_8;
layout(location = 10) in vec4 girih_patch_9;
layout(location = 11) in vec4 girih_patch_10;
layout(location = 12) in vec4 girih_patch_11;
layout(location = 13) in uvec4 girih_patch_ids;
#else
layout(location = 5) in vec2 girih_patch_4;
layout(location = 6) in uvec4 girih_patch_ids;
#endif

GirihPatch girih_input_patch() {
    GirihPatch p;
#if GIRIH_SURFACE == 1
    p.b300 = girih_patch_0.xyz;
    p.b030 = vec3(girih_patch_0.w, girih_patch_1.xy);
    p.b003 = vec3(girih_patch_1.zw, girih_patch_2.x);
    p.b210 = girih_patch_2.yzw;
    p.b120 = girih_patch_3.xyz;
    p.b021 = vec3(girih_patch_3.w, girih_patch_4.xy);
    p.b012 = vec3(girih_patch_4.zw, girih_patch_5.x);
    p.b102 = girih_patch_5.yzw;
    p.b201 = girih_patch_6.xyz;
    p.b111 = vec3(girih_patch_6.w, girih_patch_7.xy);
    p.n200 = vec3(girih_patch_7.zw, girih_patch_8.x);
    p.n020 = girih_patch_8.yzw;
    p.n002 = girih_patch_9.xyz;
    p.n110 = vec3(girih_patch_9.w, girih_patch_10.xy);
    p.n011 = vec3(girih_patch_10.zw, girih_patch_11.x);
    p.n101 = girih_patch_11.yzw;
#else
    p.b300 = girih_patch_0.xyz;
    p.b030 = vec3(girih_patch_0.w, girih_patch_1.xy);
    p.b003 = vec3(girih_patch_1.zw, girih_patch_2.x);
    p.n200 = girih_patch_2.yzw;
    p.n020 = girih_patch_3.xyz;
    p.n002 = vec3(girih_patch_3.w, girih_patch_4);
#endif
    return p;
}

GirihPoint girih_point() {
    GirihPatch p = girih_input_patch();
    uint u = girih_pattern_vertex & 0xffffu;
    uint v = girih_pattern_vertex >> 16;
    GirihPoint point;
    point.barycentric = vec3(float(u), float(v), float(32768u - u - v)) * (1.0 / 32768.0);
    point.position = girih_patch_position(p, point.barycentric.x, point.barycentric.y, point.barycentric.z);
    point.normal = girih_patch_unit_normal(p, point.barycentric.x, point.barycentric.y, point.barycentric.z);
    point.key = girih_patch_ids.w;
    point.vertices = girih_patch_ids.xyz;
    return point;
}

#ifdef GIRIH_SET
layout(std430, set = GIRIH_SET, binding = 0) readonly buffer GirihDrawAttributes {
    float girih_draw_attributes[];
};

// Float n of the point's attributes, attribute_floats to a vertex.
float girih_attribute(GirihPoint point, uint n, uint attribute_floats) {
    return girih_no_negative_zero(girih_patch_attribute(girih_draw_attributes[point.vertices.x * attribute_floats + n],
                                                        girih_draw_attributes[point.vertices.y * attribute_floats + n],
                                                        girih_draw_attributes[point.vertices.z * attribute_floats + n],
                                                        point.barycentric.x, point.barycentric.y, point.barycentric.z));
}
#endif

#else

layout(location = 0) in vec3 girih_position;
layout(location = 1) in vec3 girih_normal;

GirihPoint girih_point() {
    return GirihPoint(girih_position, girih_normal, 0u, uvec3(0u), vec3(0.0));
}

#endif
#endif
