// Stage 1 on the CPU: one level per unique edge of every instance, from the edge alone. Twin of
// glsl/levels.glsl.
#include "part.h"

// A random number from an edge's end points.
static uint32_t hash_word(uint32_t hash, uint32_t word) {
    hash ^= word;
    hash *= 0x7feb352du;
    hash ^= hash >> 15;
    hash *= 0x846ca68bu;
    hash ^= hash >> 16;
    return hash;
}

static uint32_t hash_point(uint32_t hash, girih_vector p) {
    hash = hash_word(hash, girih_float_word(p.x));
    hash = hash_word(hash, girih_float_word(p.y));
    return hash_word(hash, girih_float_word(p.z));
}

// The canonical order of mesh preparation. Without branches: which way an edge runs is chance.
static bool comes_before(girih_vector p, girih_vector q) {
    return (p.x < q.x) | ((p.x == q.x) & ((p.y < q.y) | ((p.y == q.y) & (p.z < q.z))));
}

// Positions that the host has moved are hashed as a mesh freshly prepared from them would be: in
// canonical order, without -0. For others this changes nothing.
static uint32_t hash_edge(const girih_arrays *arrays, uint32_t seed, uint32_t a, uint32_t b) {
    const girih_vector p = girih_no_negative_zeros(girih_vertex_position(arrays, a));
    const girih_vector q = girih_no_negative_zeros(girih_vertex_position(arrays, b));
    const bool turned = comes_before(q, p);
    const uint32_t hash = hash_word(0x9e3779b9u, seed);
    return hash_point(hash_point(hash, turned ? q : p), turned ? p : q);
}

static uint32_t random_level(const girih_arrays *arrays, uint32_t a, uint32_t b, bool *clamped) {
    const girih_frame_block *frame = &arrays->frame;
    // By the hash's high bits: no division.
    const uint32_t drawn =
        (uint32_t)((uint64_t)hash_edge(arrays, frame->seed, a, b) * frame->random_segments >> 32);
    const uint32_t last = frame->last_level;
    if (frame->rule == GIRIH_LEVELS_RANDOM_LEVEL) {
        *clamped = drawn > last;
        return *clamped ? last : drawn;
    }
    const uint32_t segments = 1 + drawn;
    uint32_t level = frame->linear_spacing != 0 && drawn < last ? drawn : 0;
    while (level < last && girih_level_segments(frame, level) < segments) {
        ++level;
    }
    *clamped = girih_level_segments(frame, level) < segments;
    return level;
}

// Whether a level's segments are short enough.
static bool reaches(const girih_frame_block *frame, uint32_t level, float distance_squared,
                    float wanted) {
    const float segments = (float)girih_level_segments(frame, level);
    return wanted <= (segments * segments) * distance_squared;
}

static uint32_t length_level(const girih_arrays *arrays, uint32_t instance, uint32_t a, uint32_t b,
                             bool *clamped) {
    const girih_frame_block *frame = &arrays->frame;
    girih_vector p = girih_vertex_position(arrays, a);
    girih_vector q = girih_vertex_position(arrays, b);
    float distance_squared = frame->near_squared;
    if (frame->rule == GIRIH_LEVELS_LENGTH) {
        const girih_transform transform = girih_instance_transform(arrays, instance);
        p = girih_transform_point(&transform, p);
        q = girih_transform_point(&transform, q);
        if (frame->eye[3] != 0.0f) {
            const girih_vector eye = {frame->eye[0], frame->eye[1], frame->eye[2]};
            const girih_vector to_eye = girih_subtract(girih_scale(girih_add(p, q), 0.5f), eye);
            distance_squared = girih_max(girih_dot(to_eye, to_eye), distance_squared);
        }
    }
    // The smallest n with |q-p|^2 c^2 <= n^2 P^2 max(|m-e|^2, near^2): squares throughout, so that
    // neither root nor division is needed.
    const girih_vector along = girih_subtract(q, p);
    const float wanted = girih_dot(along, along) * frame->length_factor;
    uint32_t level = 0;
    while (level < frame->level_count - 1 && !reaches(frame, level, distance_squared, wanted)) {
        ++level;
    }
    if (reaches(frame, level, distance_squared, wanted)) {
        *clamped = false;
        return level;
    }
    // Beyond the catalogue levels may be many: more segments reach farther, so halving finds them.
    uint32_t high = frame->last_level;
    while (level < high) {
        const uint32_t middle = (level + high) / 2;
        if (reaches(frame, middle, distance_squared, wanted)) {
            high = middle;
        } else {
            level = middle + 1;
        }
    }
    *clamped = !reaches(frame, level, distance_squared, wanted);
    return level;
}

// A world-space point as seen from above, from the axis through the eye.
typedef struct plan_point {
    float x, y;
} plan_point;

static plan_point from_axis(const girih_frame_block *frame, girih_vector p) {
    const girih_vector eye = {frame->eye[0], frame->eye[1], frame->eye[2]};
    const girih_vector from_eye = girih_subtract(p, eye);
    const float *x = frame->horizontal[0];
    const float *y = frame->horizontal[1];
    return (plan_point){girih_dot((girih_vector){x[0], x[1], x[2]}, from_eye),
                        girih_dot((girih_vector){y[0], y[1], y[2]}, from_eye)};
}

// Why the tests hold is told in the shader.
static uint32_t horizontal_level(const girih_arrays *arrays, uint32_t instance, uint32_t p,
                                 uint32_t q, bool *clamped) {
    const girih_frame_block *frame = &arrays->frame;
    const girih_transform transform = girih_instance_transform(arrays, instance);
    const plan_point a =
        from_axis(frame, girih_transform_point(&transform, girih_vertex_position(arrays, p)));
    const plan_point b =
        from_axis(frame, girih_transform_point(&transform, girih_vertex_position(arrays, q)));
    const float cross = fabsf(a.x * b.y - a.y * b.x);
    const float dot = a.x * b.x + a.y * b.y;
    const plan_point along = {b.x - a.x, b.y - a.y};
    const float square = along.x * along.x + along.y * along.y;
    // The table of angles ends there.
    const uint32_t last =
        frame->last_level < GIRIH_MAX_LEVELS ? frame->last_level : GIRIH_MAX_LEVELS - 1;
    for (uint32_t level = 0;; ++level) {
        const float segments = (float)girih_level_segments(frame, level);
        const float *turn = frame->turns[level / 2] + 2 * (level % 2);
        const float reached = (segments * segments) * frame->near_squared;
        const float less = cross * turn[0];
        const float more = dot * turn[1];
        *clamped = !(less <= more || square <= reached);
        if (!*clamped || level == last) {
            return level;
        }
    }
}

static uint32_t edge_level(const girih_arrays *arrays, uint32_t instance, uint32_t a, uint32_t b,
                           bool *clamped) {
    switch (arrays->frame.rule) {
    case GIRIH_LEVELS_RANDOM:
    case GIRIH_LEVELS_RANDOM_LEVEL:
        return random_level(arrays, a, b, clamped);
    case GIRIH_LEVELS_HORIZONTAL:
        return horizontal_level(arrays, instance, a, b, clamped);
    default:
        return length_level(arrays, instance, a, b, clamped);
    }
}

void girih_twin_levels(girih_arrays *arrays) {
    const girih_frame_block *frame = &arrays->frame;
    uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
    uint32_t *levels = arrays->words[GIRIH_BIND_LEVELS];
    memset(status, 0, (size_t)arrays->count[GIRIH_BIND_STATUS] * sizeof *status);
    for (uint32_t edge = 0; edge < frame->edge_count; ++edge) {
        if (frame->rule == GIRIH_LEVELS_UNIFORM) {
            levels[edge] = frame->uniform_level;
            status[GIRIH_STATUS_CLAMPED] = frame->uniform_clamped != 0 ? frame->edge_count : 0;
            continue;
        }
        const uint32_t instance =
            girih_find_instance(arrays, edge, GIRIH_INSTANCE_FIRST_EDGE, frame->edge_blocks);
        const uint32_t scene_edge =
            edge - girih_instance_word(arrays, instance, GIRIH_INSTANCE_EDGE_DELTA);
        const uint32_t *points = arrays->words[GIRIH_BIND_EDGE_POINTS] + 2 * (size_t)scene_edge;
        bool clamped = false;
        levels[edge] = edge_level(arrays, instance, points[0], points[1], &clamped);
        if (clamped) {
            ++status[GIRIH_STATUS_CLAMPED];
        }
    }
}
