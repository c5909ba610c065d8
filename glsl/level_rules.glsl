// The level rules: how many segments an edge asks for, from the edge alone (stage 1).
//
// Reads the rule's fields of `girih_frame`, which the includer declares: the stages through
// arrays.glsl, any other shader as a uniform block of GIRIH_FRAME_BLOCK (shared.h).
#ifndef GIRIH_LEVEL_RULES_GLSL
#define GIRIH_LEVEL_RULES_GLSL

#include "math.glsl"

// A random number from an edge's end points in canonical order, so that both triangles at it agree.
uint girih_hash_word(uint hash, uint word) {
    hash ^= word;
    hash *= 0x7feb352du;
    hash ^= hash >> 15;
    hash *= 0x846ca68bu;
    hash ^= hash >> 16;
    return hash;
}

bool girih_is_before(vec3 p, vec3 q) {
    return p.x < q.x || (p.x == q.x && (p.y < q.y || (p.y == q.y && p.z < q.z)));
}

uint girih_hash_edge(uint seed, vec3 p, vec3 q) {
    // The ends stand in canonical order where the mesh was prepared; it may have moved since.
    if (girih_is_before(q, p)) {
        vec3 first = q;
        q = p;
        p = first;
    }
    uint hash = girih_hash_word(0x9e3779b9u, seed);
    for (int n = 0; n < 3; ++n) {
        hash = girih_hash_word(hash, floatBitsToUint(p[n]));
    }
    for (int n = 0; n < 3; ++n) {
        hash = girih_hash_word(hash, floatBitsToUint(q[n]));
    }
    return hash;
}

// A number below `count` from a hash, by its high bits: no division.
uint girih_draw_below(uint hash, uint count) {
    uint high, low;
    umulExtended(hash, count, high, low);
    return high;
}

uint girih_level_segments(uint level) {
    return girih_frame.linear_spacing != 0u ? level + 1u : 1u << level;
}

// The level of the edge from p to q, mesh-space ends for the random rules and GIRIH_LEVELS_OBJECT_LENGTH, world-space
// ends for GIRIH_LEVELS_LENGTH. `clamped`: it asked for more segments than the catalogue holds.
uint girih_edge_level(uint rule, vec3 p, vec3 q, out bool clamped) {
    uint level = 0u;
    uint last = girih_frame.level_count - 1u;
    if (rule == GIRIH_LEVELS_UNIFORM) {
        clamped = girih_frame.uniform_clamped != 0u;
        return girih_frame.uniform_level;
    }
    if (rule == GIRIH_LEVELS_RANDOM_LEVEL) {
        uint wanted = girih_draw_below(girih_hash_edge(girih_frame.seed, p, q), girih_frame.random_segments);
        clamped = wanted > last;
        return min(wanted, last);
    }
    if (rule == GIRIH_LEVELS_RANDOM) {
        uint segments = 1u + girih_draw_below(girih_hash_edge(girih_frame.seed, p, q), girih_frame.random_segments);
        while (level < last && girih_level_segments(level) < segments) {
            ++level;
        }
        clamped = girih_level_segments(level) < segments;
        return level;
    }
    precise float distance_squared = girih_frame.near_squared;
    if (rule == GIRIH_LEVELS_LENGTH && girih_frame.eye.w != 0.0) {
        precise vec3 to_eye = (p + q) * 0.5 - girih_frame.eye.xyz;
        distance_squared = max(girih_dot(to_eye, to_eye), distance_squared);
    }
    // The smallest n with |q-p|^2 c^2 <= n^2 P^2 max(|m-e|^2, near^2): squares throughout, so that
    // neither root nor division is needed.
    precise vec3 along = q - p;
    precise float wanted = girih_dot(along, along) * girih_frame.length_factor;
    for (;;) {
        float segments = float(girih_level_segments(level));
        precise float reached = (segments * segments) * distance_squared;
        clamped = !(wanted <= reached);
        if (!clamped || level == last) {
            return level;
        }
        ++level;
    }
}

#endif
