// girih in a host's own shaders.
//
// In a vertex shader, define before the include
//   GIRIH_MODE     0: instanced; 1: baked or welded
//   GIRIH_SURFACE  0: flat; 1: Curved PN triangles; 2: the host's own
// and for the instanced mode, where attributes are wanted or the surface is an own one,
//   GIRIH_SET      the descriptor set number that girih_cmd_draw is given.
// and for the instanced mode of a plan that splits triangles (girih_plan_desc.max_splits)
//   GIRIH_SPLITS
// girih_point() gives the vertex in all modes alike, and the pipeline's vertex input is
// girih_plan_vertex_input's. Instanced, girih takes the input locations 0 to 15 at most; baked, 0 and 1,
// and the attributes are the host's to declare: floats of binding 1 from byte 12 on. No push constants
// and no specialization constants are used.
//
// An own surface is one function, defined after the include:
//   vec3 girih_surface(GirihPatch patch_, vec3 barycentric)
// from a patch (surfaces.glsl) and the weights of its corners to a point in the world. It may call
//   vec3 girih_base_position(patch_, barycentric)    the base surface: GIRIH_BASE 0 flat, 1 (the default)
//                                                    Curved PN triangles
//   vec3 girih_base_normal(patch_, barycentric)      its unit normal
//   vec3 girih_displacement(patch_, normal, height)  the way `height` mesh units along a unit normal
//   float girih_attribute(patch_, n, barycentric)    float n of the vertices' attributes
//   girih_mesh_place(patch_, barycentric, out position, out normal)    the same place in mesh space
// and read textures and buffers of the host's. Normals are worked out from it (own.glsl) unless
// GIRIH_SURFACE_NORMAL is defined; then the host defines
//   vec3 girih_surface_normal(GirihPatch patch_, vec3 barycentric)
// too. girih_previous_position() is the vertex where it was in the previous frame: patch_.previous tells
// the function so.
//
// The same surface in baking is a compute shader of its own, for girih_surface_program_create:
//   #version 450
//   #extension GL_GOOGLE_include_directive : require
//   #define GIRIH_BAKE
//   #include "girih.glsl"
//   ... girih_surface ...
// compiled once as it is and once with GIRIH_FEW_BUFFERS. Its own textures and buffers are in descriptor
// set GIRIH_SURFACE_SET: 1, unless GIRIH_SET is defined as the number of the host's own sets
// (girih_context_desc.host_set_layout_count): then the one after it. GIRIH_PUSH_OFFSET is
// girih_context_desc.push_constant_offset. In a vertex shader GIRIH_SURFACE_SET is the host's to define.
#ifndef GIRIH_GLSL
#define GIRIH_GLSL

#ifdef GIRIH_BAKE

#ifndef GIRIH_SET
#define GIRIH_SET 0
#endif
#define GIRIH_SURFACE_SET (GIRIH_SET + 1)
#define GIRIH_SURFACE 2
#define GIRIH_KERNEL 1
#include "evaluate.glsl"

#else

struct GirihPoint {
    vec3 position;   // world
    vec3 normal;     // world, unit length
    uint key;        // instanced: group << 3 | lambda, group = material * ranges + range
    uvec3 vertices;  // instanced: the scene's vertices at the patch's corners
    vec3 barycentric; // instanced: their weights
};

#if GIRIH_MODE == 0

layout(location = 0) in uint girih_pattern_vertex; // u | v << 16, over 32768

uvec3 girih_pattern_weights() {
    uint u = girih_pattern_vertex & 0xffffu;
    uint v = girih_pattern_vertex >> 16;
    return uvec3(u, v, 32768u - u - v);
}

#ifdef GIRIH_SPLITS
#include "part.glsl"
#if GIRIH_SURFACE == 2
#define GIRIH_PART_LOCATION 2
#elif GIRIH_SURFACE == 1
#define GIRIH_PART_LOCATION 14
#else
#define GIRIH_PART_LOCATION 7
#endif
// A part's corners (GIRIH_SPLIT_CORNERS); 0 for a triangle that is not split.
layout(location = GIRIH_PART_LOCATION) in uvec4 girih_part_first;
layout(location = GIRIH_PART_LOCATION + 1) in uvec2 girih_part_last;

bool girih_is_part() {
    return (girih_part_first.x | girih_part_first.y | girih_part_first.z | girih_part_first.w) != 0u;
}

// The weights of the patch's corners, over GIRIH_SPLIT_ONE.
uvec3 girih_patch_weights() {
    GirihPart part = girih_unpack_part(girih_part_first, girih_part_last);
    return girih_is_part() ? girih_part_weights(part, girih_pattern_weights(), uvec3(0u))
                           : girih_pattern_weights() * GIRIH_SPLIT_UNIT;
}
#else
#include "shared.h"

bool girih_is_part() {
    return false;
}

uvec3 girih_patch_weights() {
    return girih_pattern_weights() * GIRIH_SPLIT_UNIT;
}
#endif

#if GIRIH_SURFACE == 2

#define GIRIH_VERTEX
#include "own.glsl"

layout(location = 1) in uvec4 girih_record; // scene triangle, instance, key, base pattern

// How the patch's corners stand to the input's: a part's are those of its root.
uint girih_patch_lambda() {
    return girih_is_part() ? 0u : girih_record.z & 7u;
}

GirihPoint girih_point() {
    uvec3 weights = girih_input_weights(girih_patch_lambda(), girih_patch_weights());
    GirihPlaces places = girih_find_places(girih_record.x, weights);
    GirihPoint point;
    for (uint turn = 0u; turn < (places.smooth_ ? 1u : 2u); ++turn) {
        GirihPlace place = places.position;
        if (turn == 1u) {
            place = places.normal;
        }
        GirihPatch patch_ = girih_own_patch(place.triangle, girih_record.y, false);
        vec3 position;
        girih_own_sample(patch_, girih_root_barycentric(place.weights), position, point.normal);
        if (turn == 0u) {
            point.position = position;
        }
    }
    point.key = girih_record.z;
    // Attributes are permuted as the library's own surfaces permute them: sums round by their order.
    uint corners = GIRIH_LAMBDA_CORNERS(girih_patch_lambda());
    for (uint n = 0u; n < 3u; ++n) {
        point.vertices[n] = GIRIH_AT_TRIANGLE_VERTICES(3u * girih_record.x + (corners >> (2u * n) & 3u));
    }
    point.barycentric = girih_root_barycentric(girih_patch_weights());
    return point;
}

vec3 girih_previous_position() {
    uvec3 weights = girih_input_weights(girih_patch_lambda(), girih_patch_weights());
    GirihPlace place = girih_find_places(girih_record.x, weights).position;
    GirihPatch patch_ = girih_own_patch(place.triangle, girih_record.y, true);
    return girih_no_negative_zero(girih_surface(patch_, girih_root_barycentric(place.weights)));
}

float girih_draw_attribute(uint vertex, uint n, uint attribute_floats) {
    return uintBitsToFloat(GIRIH_AT_ATTRIBUTES(vertex * attribute_floats + n));
}

#else

#include "surfaces.glsl"

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
    GirihPoint point;
    point.barycentric = girih_root_barycentric(girih_patch_weights());
    point.position = girih_patch_position(p, point.barycentric.x, point.barycentric.y, point.barycentric.z);
    point.normal = girih_patch_unit_normal(p, point.barycentric.x, point.barycentric.y, point.barycentric.z);
    point.key = girih_patch_ids.w;
    point.vertices = girih_patch_ids.xyz;
    return point;
}

#ifdef GIRIH_SET
#include "shared.h"
layout(std430, set = GIRIH_SET, binding = GIRIH_BIND_DRAW_ATTRIBUTES) readonly buffer GirihDrawAttributes {
    float girih_draw_attributes[];
};

float girih_draw_attribute(uint vertex, uint n, uint attribute_floats) {
    return girih_draw_attributes[vertex * attribute_floats + n];
}
#endif

#endif

#ifdef GIRIH_SET
// Float n of the point's attributes, attribute_floats to a vertex.
float girih_attribute(GirihPoint point, uint n, uint attribute_floats) {
    return girih_no_negative_zero(girih_patch_attribute(girih_draw_attribute(point.vertices.x, n, attribute_floats),
                                                        girih_draw_attribute(point.vertices.y, n, attribute_floats),
                                                        girih_draw_attribute(point.vertices.z, n, attribute_floats),
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

#endif
