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

// A world-space point as seen from above, from the axis through the eye.
vec2 girih_from_axis(vec3 p) {
    precise vec3 from_eye = p - girih_frame.eye.xyz;
    return vec2(girih_dot(girih_frame.horizontal[0].xyz, from_eye), girih_dot(girih_frame.horizontal[1].xyz, from_eye));
}

// Lorenz and Doellner 2008, section 5.2: an edge's horizontal length on the screen of a cylindrical projection, which
// is the horizontal angle between its ends, from 0 to 180 degrees whichever way round it is seen; so there is no seam.
//
// Angle <= T where sin(T - angle) >= 0, and times the ends' distances that is sin T dot - cos T |cross|: no angle, root
// or division is needed, nor any square, whose range coordinates could leave. What is nearer to the axis than
// near_distance is not drawn, and what is farther of an edge is seen under no larger an angle than the edge's length
// there: edges shorter than T near_distance reach T whatever their ends' angle is.
uint girih_horizontal_level(vec3 p, vec3 q, out bool clamped) {
    // The table of angles ends there.
    uint last = min(girih_frame.last_level, uint(GIRIH_MAX_LEVELS) - 1u);
    vec2 a = girih_from_axis(p);
    vec2 b = girih_from_axis(q);
    // Alike for the edge from q to p: both products only change places, or the sign.
    precise float cross_ = abs(a.x * b.y - a.y * b.x);
    precise float dot_ = a.x * b.x + a.y * b.y;
    precise vec2 along = b - a;
    precise float square = along.x * along.x + along.y * along.y;
    for (uint level = 0u;; ++level) {
        float segments = float(girih_level_segments(level));
        vec4 turns = girih_frame.turns[level >> 1];
        vec2 turn = (level & 1u) == 0u ? turns.xy : turns.zw;
        precise float reached = (segments * segments) * girih_frame.near_squared;
        precise float less = cross_ * turn.x;
        precise float more = dot_ * turn.y;
        clamped = !(less <= more || square <= reached);
        if (!clamped || level == last) {
            return level;
        }
    }
}

// Whether a level's segments are short enough.
bool girih_reaches(uint level, float distance_squared, float wanted) {
    float segments = float(girih_level_segments(level));
    precise float reached = (segments * segments) * distance_squared;
    return wanted <= reached;
}

// The level of the edge from p to q, mesh-space ends for the random rules and GIRIH_LEVELS_OBJECT_LENGTH, world-space
// ends for GIRIH_LEVELS_LENGTH and GIRIH_LEVELS_HORIZONTAL. `clamped`: it asked for more segments than the last
// level has.
uint girih_edge_level(uint rule, vec3 p, vec3 q, out bool clamped) {
    uint level = 0u;
    uint last = girih_frame.last_level;
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
        uint drawn = girih_draw_below(girih_hash_edge(girih_frame.seed, p, q), girih_frame.random_segments);
        uint segments = 1u + drawn;
        level = girih_frame.linear_spacing != 0u ? min(drawn, last) : 0u;
        while (level < last && girih_level_segments(level) < segments) {
            ++level;
        }
        clamped = girih_level_segments(level) < segments;
        return level;
    }
    if (rule == GIRIH_LEVELS_HORIZONTAL) {
        return girih_horizontal_level(p, q, clamped);
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
    uint end = girih_frame.level_count - 1u;
    while (level < end && !girih_reaches(level, distance_squared, wanted)) {
        ++level;
    }
    clamped = !girih_reaches(level, distance_squared, wanted);
    if (!clamped || level == last) {
        return level;
    }
    // Beyond the catalogue levels may be many: more segments reach farther, so halving finds them.
    while (level < last) {
        uint middle = (level + last) / 2u;
        if (girih_reaches(middle, distance_squared, wanted)) {
            last = middle;
        } else {
            level = middle + 1u;
        }
    }
    clamped = !girih_reaches(level, distance_squared, wanted);
    return level;
}

#endif
