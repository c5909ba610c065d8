// The arrays' memory, the frame's fields of one view, and the statistics read back.
#include "pack.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

#include "error.h"
#include "memory.h"

static const double pi = 3.14159265358979323846;

girih_result girih_allocate_words(girih_arrays *arrays, uint32_t binding, uint64_t count,
                                  girih_error *error) {
    uint64_t words = count > 0 ? count : 1;
    uint32_t *memory = NULL;
    if (words <= SIZE_MAX / sizeof *memory) {
        memory = girih_allocate_array((size_t)words, sizeof *memory);
    }
    if (!memory) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "%s: out of memory for %" PRIu64 " words; refine less at once",
                          binding < GIRIH_BIND_PATTERNS    ? "scene"
                          : binding < GIRIH_BIND_INSTANCES ? "catalogue"
                                                           : "plan",
                          words);
    }
    memset(memory, 0, (size_t)words * sizeof *memory);
    arrays->words[binding] = memory;
    arrays->count[binding] = words;
    return GIRIH_OK;
}

void girih_arrays_free(girih_arrays *arrays, uint32_t first, uint32_t end) {
    for (uint32_t binding = first; binding < end; ++binding) {
        girih_free(arrays->words[binding]);
        arrays->words[binding] = NULL;
    }
}

// value squared as a float; 0 where value is not positive or its square no normal float.
static float positive_square(double value) {
    double square = value * value;
    if (!(value > 0.0) || !(square >= FLT_MIN) || !(square <= FLT_MAX)) {
        return 0.0f;
    }
    return (float)square;
}

// The smallest level with at least this many segments, as girih_catalogue_level has it.
static uint32_t level_of(const girih_frame_block *block, uint32_t segments, uint32_t *clamped) {
    uint32_t last = block->last_level;
    uint32_t level = 0;
    if (block->linear_spacing != 0) {
        level = segments > 0 ? segments - 1 : 0;
        *clamped = level > last;
        return level < last ? level : last;
    }
    while (level < last && 1u << level < segments) {
        ++level;
    }
    *clamped = 1u << level < segments;
    return level;
}

static girih_result pack_pixels(girih_frame_block *block, const girih_frame *frame,
                                girih_error *error) {
    if (!(frame->length > 0.0f) || !(frame->pixels_per_unit > 0.0f)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "frame: %g pixels a segment and %g pixels a unit must both be positive",
                          (double)frame->length, (double)frame->pixels_per_unit);
    }
    block->length_factor = positive_square((double)frame->pixels_per_unit / (double)frame->length);
    if (block->length_factor == 0.0f) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "frame: %g pixels a unit at %g pixels a segment are out of range",
                          (double)frame->pixels_per_unit, (double)frame->length);
    }
    if (!frame->orthographic) {
        block->near_squared = positive_square((double)frame->near_distance);
        if (block->near_squared == 0.0f) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "frame: the near distance %g must be positive",
                              (double)frame->near_distance);
        }
    }
    block->rule = GIRIH_LEVELS_LENGTH;
    return GIRIH_OK;
}

// The angle that n segments reach is n times one segment's; beyond 180 degrees every edge is
// reached. Worked out in double, so that CPU and GPU compare with the same numbers.
static girih_result pack_horizontal(girih_frame_block *block, const girih_frame *frame,
                                    girih_error *error) {
    if (!(frame->length > 0.0f) || !(frame->pixels_per_radian > 0.0f)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "frame: %g pixels a segment and %g pixels a radian must both be positive",
                          (double)frame->length, (double)frame->pixels_per_radian);
    }
    const double angle = (double)frame->length / (double)frame->pixels_per_radian;
    block->near_squared = positive_square(angle * (double)frame->near_distance);
    if (block->near_squared == 0.0f) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "frame: segments of %g radians at the near distance %g are out of range",
                          angle, (double)frame->near_distance);
    }
    block->rule = GIRIH_LEVELS_HORIZONTAL;
    for (uint32_t level = 0; level <= block->last_level && level < GIRIH_MAX_LEVELS; ++level) {
        const double segments =
            block->linear_spacing != 0 ? (double)level + 1.0 : ldexp(1.0, (int)level);
        const double reached = segments * angle;
        float *turn = block->turns[level / 2] + 2 * (level % 2);
        turn[0] = reached < pi ? (float)cos(reached) : -1.0f;
        turn[1] = reached < pi ? (float)sin(reached) : 0.0f;
    }
    return GIRIH_OK;
}

static girih_result pack_rule(girih_frame_block *block, const girih_frame *frame,
                              girih_error *error) {
    switch (frame->rule) {
    case GIRIH_LEVEL_SEGMENTS:
        block->rule = GIRIH_LEVELS_UNIFORM;
        block->uniform_level = level_of(block, frame->segments, &block->uniform_clamped);
        return GIRIH_OK;
    case GIRIH_LEVEL_RANDOM:
        block->rule = GIRIH_LEVELS_RANDOM;
        block->random_segments = frame->segments > 0 ? frame->segments : 1;
        block->seed = frame->seed;
        return GIRIH_OK;
    case GIRIH_LEVEL_RANDOM_LEVEL:
        block->rule = GIRIH_LEVELS_RANDOM_LEVEL;
        block->random_segments = frame->segments < UINT32_MAX ? frame->segments + 1 : UINT32_MAX;
        block->seed = frame->seed;
        return GIRIH_OK;
    case GIRIH_LEVEL_EDGE_PIXELS:
        return pack_pixels(block, frame, error);
    case GIRIH_LEVEL_HORIZONTAL_PIXELS:
        return pack_horizontal(block, frame, error);
    case GIRIH_LEVEL_EDGE_LENGTH:
        block->rule = GIRIH_LEVELS_OBJECT_LENGTH;
        block->near_squared = positive_square((double)frame->length);
        if (block->near_squared == 0.0f) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "frame: the length %g of a segment must be positive",
                              (double)frame->length);
        }
        return GIRIH_OK;
    default:
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "frame: unknown level rule %d",
                          (int)frame->rule);
    }
}

// The unit vector of the vertical axis, and two perpendicular to it and to each other. Where the
// axis is one of the world's, so are these, without rounding.
static void pack_axis(girih_frame_block *block, const float up[3]) {
    double axis[3] = {(double)up[0], (double)up[1], (double)up[2]};
    if (axis[0] == 0.0 && axis[1] == 0.0 && axis[2] == 0.0) {
        axis[1] = 1.0;
    }
    const double length = sqrt((axis[0] * axis[0] + axis[1] * axis[1]) + axis[2] * axis[2]);
    // The world's axis that is least along it, made perpendicular to it, and their cross product.
    int least = 0;
    for (int n = 0; n < 3; ++n) {
        axis[n] /= length;
        least = fabs(axis[n]) < fabs(axis[least]) ? n : least;
    }
    const double across_length = sqrt(1.0 - axis[least] * axis[least]);
    double across[3];
    for (int n = 0; n < 3; ++n) {
        across[n] = ((n == least ? 1.0 : 0.0) - axis[least] * axis[n]) / across_length;
    }
    for (int n = 0; n < 3; ++n) {
        const int y = (n + 1) % 3;
        const int z = (n + 2) % 3;
        block->up[n] = (float)axis[n];
        block->horizontal[0][n] = (float)across[n];
        block->horizontal[1][n] = (float)(axis[y] * across[z] - axis[z] * across[y]);
    }
}

static girih_result check_view(const girih_frame *frame, girih_error *error) {
    int finite = 1;
    for (int axis = 0; axis < 3; ++axis) {
        finite = finite && isfinite(frame->eye[axis]);
    }
    if (!finite) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "frame: the eye is not finite");
    }
    for (int axis = 0; axis < 3; ++axis) {
        finite = finite && isfinite(frame->up[axis]);
    }
    if (!finite || !isfinite(frame->lowest_slope) || !isfinite(frame->highest_slope)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "frame: the vertical axis or a slope is not finite");
    }
    for (int plane = 0; plane < 6; ++plane) {
        for (int n = 0; n < 4; ++n) {
            if (!isfinite(frame->planes[plane][n])) {
                return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                                  "frame: plane %d is not finite", plane);
            }
        }
    }
    return GIRIH_OK;
}

girih_result girih_pack_frame(girih_arrays *arrays, const girih_frame *frame, girih_error *error) {
    girih_result result = check_view(frame, error);
    if (result != GIRIH_OK) {
        return result;
    }
    girih_frame_block block = arrays->frame;
    block.uniform_level = 0;
    block.uniform_clamped = 0;
    block.random_segments = 1;
    block.seed = 0;
    block.length_factor = 1.0f;
    block.near_squared = 1.0f;
    memset(block.turns, 0, sizeof block.turns);
    result = pack_rule(&block, frame, error);
    if (result != GIRIH_OK) {
        return result;
    }
    memcpy(block.planes, frame->planes, sizeof block.planes);
    memcpy(block.eye, frame->eye, sizeof frame->eye);
    block.eye[3] = frame->orthographic ? 0.0f : 1.0f;
    pack_axis(&block, frame->up);
    block.cylindrical = frame->cylindrical ? 1 : 0;
    block.lowest_slope = frame->lowest_slope;
    block.highest_slope = frame->highest_slope;
    block.cull =
        (frame->cull_frustum ? GIRIH_CULL_FRUSTUM : 0u) | (frame->cull_back ? GIRIH_CULL_BACK : 0u);
    arrays->frame = block;
    return GIRIH_OK;
}

static uint64_t wide(const uint32_t *words) {
    return (uint64_t)words[1] << 32 | words[0];
}

girih_statistics girih_read_status(const girih_frame_block *frame, const uint32_t *status) {
    const uint32_t parts = status[GIRIH_STATUS_SPLITS] - status[GIRIH_STATUS_SPLIT_AGAIN];
    girih_statistics statistics = {
        .input_triangles = frame->triangle_count,
        .culled_triangles = frame->triangle_count - status[GIRIH_STATUS_SPLIT_ROOTS] -
                            (status[GIRIH_STATUS_ITEMS] - parts),
        .split_triangles = status[GIRIH_STATUS_SPLIT_ROOTS],
        .parts = parts,
        .needed_splits = status[GIRIH_STATUS_NEEDED_SPLITS],
        .clamped_edges = status[GIRIH_STATUS_CLAMPED],
        .needed_triangles = wide(status + GIRIH_STATUS_NEEDED_TRIANGLES),
        .needed_vertices = wide(status + GIRIH_STATUS_NEEDED_VERTICES),
        .groups = status[GIRIH_STATUS_GROUPS],
        .base_patterns = status[GIRIH_STATUS_PATTERNS],
        .overflow = (status[GIRIH_STATUS_FLAGS] & GIRIH_STATUS_OVERFLOW) != 0,
    };
    statistics.output_triangles = status[GIRIH_STATUS_TRIANGLES];
    // Instanced vertices stand in no buffer, so they alone may be more than 32 bits can count.
    statistics.output_vertices =
        statistics.overflow ? status[GIRIH_STATUS_VERTICES] : statistics.needed_vertices;
    return statistics;
}
