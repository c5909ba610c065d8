// Stage 1: one level per unique edge of every instance, from the edge alone.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"

// A random number from an edge's end points in canonical order, so that both triangles at it agree.
uint hash_word(uint hash, uint word) {
    hash ^= word;
    hash *= 0x7feb352du;
    hash ^= hash >> 15;
    hash *= 0x846ca68bu;
    hash ^= hash >> 16;
    return hash;
}

bool is_before(vec3 p, vec3 q) {
    return p.x < q.x || (p.x == q.x && (p.y < q.y || (p.y == q.y && p.z < q.z)));
}

uint hash_edge(uint seed, vec3 p, vec3 q) {
    // The ends stand in canonical order where the mesh was prepared; it may have moved since.
    if (is_before(q, p)) {
        vec3 first = q;
        q = p;
        p = first;
    }
    uint hash = hash_word(0x9e3779b9u, seed);
    for (int n = 0; n < 3; ++n) {
        hash = hash_word(hash, floatBitsToUint(p[n]));
    }
    for (int n = 0; n < 3; ++n) {
        hash = hash_word(hash, floatBitsToUint(q[n]));
    }
    return hash;
}

// A number below `count` from a hash, by its high bits: no division.
uint draw_below(uint hash, uint count) {
    uint high, low;
    umulExtended(hash, count, high, low);
    return high;
}

uint level_segments(uint level) {
    return girih_frame.linear_spacing != 0u ? level + 1u : 1u << level;
}

const uint rule = girih_variant >> GIRIH_VARIANT_RULE_SHIFT & 7u;

void main() {
    uint edge = girih_invocation();
    if (edge >= girih_frame.edge_count) {
        return;
    }
    if (rule == GIRIH_LEVELS_UNIFORM) {
        GIRIH_AT_LEVELS(edge) = girih_frame.uniform_level;
        if (edge == 0u && girih_frame.uniform_clamped != 0u) {
            GIRIH_AT_STATUS(GIRIH_STATUS_CLAMPED) = girih_frame.edge_count;
        }
        return;
    }
    uint instance = girih_find_instance(edge, GIRIH_INSTANCE_FIRST_EDGE, girih_frame.edge_blocks);
    uint scene_edge = edge - girih_instance(instance, GIRIH_INSTANCE_EDGE_DELTA);
    uvec2 points = GIRIH_AT_EDGE_POINTS(scene_edge);
    vec3 p = girih_point_position(points.x);
    vec3 q = girih_point_position(points.y);
    uint level = 0u;
    uint last = girih_frame.level_count - 1u;
    bool clamped;
    if (rule == GIRIH_LEVELS_RANDOM_LEVEL) {
        uint wanted = draw_below(hash_edge(girih_frame.seed, p, q), girih_frame.random_segments);
        level = min(wanted, last);
        clamped = wanted > last;
    } else if (rule == GIRIH_LEVELS_RANDOM) {
        uint segments = 1u + draw_below(hash_edge(girih_frame.seed, p, q), girih_frame.random_segments);
        while (level < last && level_segments(level) < segments) {
            ++level;
        }
        clamped = level_segments(level) < segments;
    } else {
        precise float distance_squared = girih_frame.near_squared;
        if (rule == GIRIH_LEVELS_LENGTH) {
            GirihTransform transform = girih_instance_transform(instance, 0u);
            p = girih_transform_point(transform, p);
            q = girih_transform_point(transform, q);
            if (girih_frame.eye.w != 0.0) {
                precise vec3 to_eye = (p + q) * 0.5 - girih_frame.eye.xyz;
                distance_squared = max(girih_dot(to_eye, to_eye), distance_squared);
            }
        }
        // The smallest n with |q-p|^2 c^2 <= n^2 P^2 max(|m-e|^2, near^2): squares throughout, so that
        // neither root nor division is needed.
        precise vec3 along = q - p;
        precise float wanted = girih_dot(along, along) * girih_frame.length_factor;
        for (;;) {
            float segments = float(level_segments(level));
            precise float reached = (segments * segments) * distance_squared;
            clamped = !(wanted <= reached);
            if (!clamped || level == last) {
                break;
            }
            ++level;
        }
    }
    GIRIH_AT_LEVELS(edge) = level;
    if (clamped) {
        atomicAdd(GIRIH_AT_STATUS(GIRIH_STATUS_CLAMPED), 1u);
    }
}
