// DMR, pass 1: selects one pattern for each triangle of the input (Lorenz and Doellner 2008, section 4.3). With
// DMR_SYMMETRIC the growth is limited edge by edge.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "dmr.glsl"
#include "rival.glsl"
#include "hidden.glsl"

layout(triangles) in;
layout(points, max_vertices = 1) out;

layout(location = 0) in vec3 corner_position[];
layout(location = 1) in vec3 corner_normal[];
layout(location = 0, xfb_buffer = 0, xfb_stride = 12, xfb_offset = 0) out uvec3 selected; // p, s_r, s_p

layout(std430, set = 1, binding = 0) readonly buffer PreviousSelection {
    uint previous[];
};
layout(std430, set = 1, binding = 2) readonly buffer Table {
    uvec2 table[]; // of each pattern: subtriangles; its first one << 3 | lambda
};
layout(std430, set = 1, binding = 4) readonly buffer Around {
    uint around[]; // the next triangle's edge at the same edge, 3 * triangle + 0..2, in rings
};
layout(push_constant) uniform Push {
    uint growth; // s_r / s_p at most
    uint others; // edges in the largest ring beside the triangle's own
};

uint pattern_of(uvec3 levels) {
    uint count = girih_frame.level_count;
    return (levels.x * count + levels.y) * count + levels.z;
}

// The level that an edge of a triangle had in the previous frame.
uint previous_level(uint triangle, uint edge) {
    uint count = girih_frame.level_count;
    uint pattern = previous[DMR_SELECTION_WORDS * triangle] & ~DMR_HIDDEN;
    uint quotient = pattern / count;
    uint last = pattern - quotient * count;
    if (edge == 2u) {
        return last;
    }
    uint first = quotient / count;
    return edge == 0u ? first : quotient - first * count;
}

void main() {
    uint triangle = uint(gl_PrimitiveIDIn);
    uint available = previous[DMR_SELECTION_WORDS * triangle + 1u];
    vec3 p[3] = vec3[3](corner_position[0], corner_position[1], corner_position[2]);
    vec3 n[3] = vec3[3](corner_normal[0], corner_normal[1], corner_normal[2]);
    bool hidden = bench_hidden(p, n);
    uvec3 levels = uvec3(bench_edge_level(p[0], p[1]), bench_edge_level(p[1], p[2]), bench_edge_level(p[2], p[0]));
#ifdef DMR_SYMMETRIC
    // No edge grows by more than one level beyond what it had in any triangle at it, so all of them limit it alike.
    // A hidden triangle keeps up with those at its edges that were seen: if it started again at one subtriangle,
    // the edge would have to, too.
    for (uint edge = 0u; edge < 3u; ++edge) {
        uint other = 3u * triangle + edge;
        uint low = previous_level(triangle, edge);
        bool seen = !hidden;
        // As many turns for all: smaller rings are gone round more than once. A loop that ends where the ring does
        // may not end at all in the unused lanes of a CPU device.
        for (uint turn = 0u; turn < others; ++turn) {
            other = around[other];
            low = min(low, previous_level(other / 3u, other % 3u));
            seen = seen || (previous[DMR_SELECTION_WORDS * (other / 3u)] & DMR_HIDDEN) == 0u;
        }
        levels[edge] = seen ? min(levels[edge], low + 1u) : 0u;
    }
    uint pattern = pattern_of(levels);
    uint required = table[pattern].x;
#else
    // Hidden triangles must stay in the intermediate mesh, as one subtriangle.
    levels = hidden ? uvec3(0u) : levels;
    // "The pattern growth must not exceed the output limit of the update pass, even though this might introduce
    // temporary cracks": the largest edge levels are lowered until it does not.
    uint pattern = pattern_of(levels);
    uint required = table[pattern].x;
    if (required > growth * available) {
        uint most = max(max(levels.x, levels.y), levels.z);
        for (; required > growth * available; required = table[pattern].x) {
            --most;
            pattern = pattern_of(min(levels, uvec3(most)));
        }
        // A pattern with one fine edge can have so few subtriangles that the next finer one is out of reach, and the
        // triangle would stay so for ever. Three equal edges always grow.
        if (required <= available) {
            pattern = pattern_of(uvec3(most));
            for (uint finer = most; table[pattern_of(uvec3(finer))].x <= growth * available; ++finer) {
                pattern = pattern_of(uvec3(finer));
            }
            required = table[pattern].x;
        }
    }
#endif
    selected = uvec3(pattern | (hidden ? DMR_HIDDEN : 0u), required, available);
    EmitVertex();
    EndPrimitive();
}
