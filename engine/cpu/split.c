// Triangles that ask for more segments than the catalogue holds, on the CPU: split by base patterns
// into parts, pass by pass, until every part's levels are the catalogue's. Twin of glsl/split.comp.
#include "item.h"
#include "key.h"
#include "part.h"

// How a triangle or a part is split.
typedef struct division {
    uint32_t rank;
    uint32_t lambda;
    uint32_t counts[3]; // parts of each edge
    uint32_t rest[3];   // dyadic: levels of their parts
} division;

static uint32_t last_bit(uint32_t number) {
    uint32_t bit = 0;
    while (number >> (bit + 1) != 0) {
        ++bit;
    }
    return bit;
}

uint32_t girih_rest_level(const girih_frame_block *frame, uint32_t level) {
    const uint32_t most = GIRIH_SPLIT_MOST_SEGMENTS;
    if (frame->linear_spacing == 0) {
        const uint32_t last = last_bit(most);
        const uint32_t coarse = frame->level_count - 1 < last ? frame->level_count - 1 : last;
        return level / 2 + coarse > level ? level / 2 : level - coarse;
    }
    const uint32_t coarse = frame->level_count < most ? frame->level_count : most;
    const uint32_t segments = level + 1;
    const uint32_t least = frame->level_count < GIRIH_SPLIT_LEAST_SEGMENTS
                               ? 1u << last_bit(frame->level_count)
                               : GIRIH_SPLIT_LEAST_SEGMENTS;
    uint32_t rest = 1u << last_bit(segments) / 2;
    rest = rest < least ? least : rest;
    while (rest * coarse < segments) {
        rest *= 2;
    }
    return rest - 1;
}

// The level by which an edge is split so that about `rest` is left to its parts.
static uint32_t coarse_level(const girih_frame_block *frame, uint32_t level, uint32_t rest) {
    if (frame->linear_spacing == 0) {
        return level > rest ? level - rest : 0;
    }
    return level / (rest + 1);
}

// Both sides of an inner edge split it alike: by its own level. Of a root all edges are split to
// about one size: their vertices are those of the whole edges however they are split.
static division choose_division(const girih_arrays *arrays, const girih_part *part, bool is_root) {
    const girih_frame_block *frame = &arrays->frame;
    uint32_t largest = 0;
    for (uint32_t n = 0; n < 3; ++n) {
        largest = part->levels[n] > largest ? part->levels[n] : largest;
    }
    division d;
    uint32_t coarse[3];
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t level = part->levels[n];
        coarse[n] = 0;
        if (is_root || level >= frame->level_count) {
            coarse[n] =
                coarse_level(frame, level, girih_rest_level(frame, is_root ? largest : level));
        }
        d.counts[n] = girih_level_segments(frame, coarse[n]);
        d.rest[n] = level - coarse[n];
    }
    d.lambda = girih_sort_levels(coarse);
    d.rank = girih_rank(coarse);
    return d;
}

// The level of a part's edge inside what is split, between two places whose corners weigh `a` and
// `b`. The spacing there is that of the border, growing with the distance from each edge, up to
// that of the coarsest edge: equal edges give a regular grid, and the triangles along an edge of n
// segments are some n, not the square of it, however coarse the others are.
static uint32_t inner_level(const girih_frame_block *frame, const girih_part *part,
                            const uint32_t a[3], const uint32_t b[3]) {
    // All lengths are over 2^14, of a part whose sides are 1.
    uint32_t spacing = 1;
    uint32_t nearest = UINT32_MAX;
    uint32_t square = 0;
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t segments = girih_level_segments(frame, part->levels[n]);
        const uint32_t border = (16384u + segments / 2) / segments;
        // The mean weight of the corner opposite to the edge is the distance in heights.
        const uint32_t opposite = (n + 2) % 3;
        const uint32_t here = border + (a[opposite] + b[opposite]) / 4;
        spacing = border > spacing ? border : spacing;
        nearest = here < nearest ? here : nearest;
        const uint32_t across = (a[n] > b[n] ? a[n] - b[n] : b[n] - a[n]) / 2;
        square += across * across;
    }
    spacing = nearest < spacing ? nearest : spacing;
    // The square of the length is half of the sum.
    square /= 2;
    if (frame->linear_spacing == 0) {
        // The power of two whose segments are nearest to the spacing.
        uint32_t level = 0;
        while (spacing * spacing << (2 * level) < square / 2) {
            ++level;
        }
        return level;
    }
    // The most segments that are too long, and thus the level of one more.
    uint32_t level = 0;
    for (uint32_t bit = GIRIH_MOST_SEGMENTS / 2; bit > 0; bit /= 2) {
        const uint32_t length = (level | bit) * spacing;
        if (length < 32768u && length * length < square) {
            level |= bit;
        }
    }
    if (level >= frame->level_count) {
        // Parts of equal size, so that the places of its vertices do not depend on how it is split.
        level |= girih_rest_level(frame, level);
    }
    return level;
}

// The level of a part's edge between two places of what is split, whose corners weigh `a` and `b`.
static uint32_t part_level(const girih_frame_block *frame, const girih_part *part,
                           const division *d, const uint32_t a[3], const uint32_t b[3]) {
    for (uint32_t edge = 0; edge < 3; ++edge) {
        if ((a[(edge + 2) % 3] | b[(edge + 2) % 3]) != 0) {
            continue;
        }
        if (frame->linear_spacing == 0) {
            return d->rest[edge];
        }
        const uint32_t next = (edge + 1) % 3;
        const uint32_t segments = girih_level_segments(frame, part->levels[edge]);
        const uint32_t from = girih_part_steps(segments, d->counts[edge], a[next]);
        const uint32_t to = girih_part_steps(segments, d->counts[edge], b[next]);
        return (from < to ? to - from : from - to) - 1;
    }
    return inner_level(frame, part, a, b);
}

// The parts of one triangle or part, from number `first` on.
static void write_parts(girih_arrays *arrays, const girih_part *part, bool is_root,
                        uint32_t first) {
    const girih_frame_block *frame = &arrays->frame;
    const division d = choose_division(arrays, part, is_root);
    const uint32_t instance = girih_find_instance(arrays, part->root, GIRIH_INSTANCE_FIRST_TRIANGLE,
                                                  frame->triangle_blocks);
    const uint32_t material = girih_word(
        arrays, GIRIH_BIND_TRIANGLE_MATERIALS,
        part->root - girih_instance_word(arrays, instance, GIRIH_INSTANCE_TRIANGLE_DELTA));
    const bool mirrored = (girih_instance_word(arrays, instance, GIRIH_INSTANCE_FLAGS) &
                           GIRIH_INSTANCE_MIRRORED) != 0;
    const uint32_t *vertices = arrays->words[GIRIH_BIND_PATTERN_VERTICES] +
                               girih_pattern(arrays, d.rank, GIRIH_PATTERN_FIRST_VERTEX);
    const uint32_t first_index = girih_pattern(arrays, d.rank, GIRIH_PATTERN_FIRST_INDEX);
    const uint32_t count = girih_pattern(arrays, d.rank, GIRIH_PATTERN_TRIANGLES);
    const uint32_t corners = GIRIH_LAMBDA_CORNERS(d.lambda);
    const uint32_t odd = GIRIH_LAMBDA_IS_ODD(d.lambda);
    for (uint32_t triangle = 0; triangle < count; ++triangle) {
        girih_part made = {.root = part->root, .first = part->first && triangle == 0};
        uint32_t weights[3][3];
        for (uint32_t n = 0; n < 3; ++n) {
            // A mirrored triangle (a, c, b) winds as its part does again.
            const uint32_t corner = odd != 0 && n != 0 ? 3 - n : n;
            const uint32_t word =
                vertices[girih_pattern_index(arrays, first_index + 3 * triangle + corner)];
            const uint32_t pattern[3] = {word & 0xffff, word >> 16,
                                         32768 - (word & 0xffff) - (word >> 16)};
            for (uint32_t k = 0; k < 3; ++k) {
                weights[n][corners >> (2 * k) & 3] = pattern[k];
            }
            girih_part_weights(part, weights[n], d.counts, made.corners[n]);
            made.segments[n] = part->segments[n];
        }
        for (uint32_t n = 0; n < 3; ++n) {
            made.levels[n] = part_level(frame, part, &d, weights[n], weights[(n + 1) % 3]);
        }
        girih_write_part(arrays, first + triangle, &made);
        arrays->words[GIRIH_BIND_KEYS][frame->triangle_count + first + triangle] =
            girih_key(arrays, made.levels, material, mirrored);
    }
}

// The triangle as its own only part.
static girih_part whole_triangle(const girih_arrays *arrays, uint32_t triangle) {
    const uint32_t instance = girih_find_instance(arrays, triangle, GIRIH_INSTANCE_FIRST_TRIANGLE,
                                                  arrays->frame.triangle_blocks);
    const uint32_t scene_triangle =
        triangle - girih_instance_word(arrays, instance, GIRIH_INSTANCE_TRIANGLE_DELTA);
    girih_part part = {.root = triangle, .first = true};
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t edge =
            girih_word(arrays, GIRIH_BIND_TRIANGLE_EDGES, 3 * (size_t)scene_triangle + n) &
            GIRIH_EDGE_MASK;
        part.levels[n] =
            girih_word(arrays, GIRIH_BIND_LEVELS,
                       edge + girih_instance_word(arrays, instance, GIRIH_INSTANCE_EDGE_DELTA));
        part.segments[n] = girih_level_segments(&arrays->frame, part.levels[n]);
        part.corners[n][n] = GIRIH_SPLIT_ONE;
    }
    return part;
}

static bool is_split(uint32_t key) {
    return (key & GIRIH_KEY_SPLIT) != 0 && key != GIRIH_KEY_CULLED;
}

uint64_t girih_least_split_triangles(const girih_arrays *arrays) {
    const girih_frame_block *frame = &arrays->frame;
    uint64_t least = 0;
    for (uint32_t n = 0; n < frame->triangle_count; ++n) {
        if (is_split(arrays->words[GIRIH_BIND_KEYS][n])) {
            const girih_part whole = whole_triangle(arrays, n);
            uint32_t segments = whole.segments[0];
            for (uint32_t k = 1; k < 3; ++k) {
                segments = whole.segments[k] < segments ? whole.segments[k] : segments;
            }
            least += (uint64_t)segments * segments / 2;
        }
    }
    return least;
}

// Without any of its parts a frame is drawn at level 0.
static void drop_parts(uint32_t *status) {
    status[GIRIH_STATUS_FLAGS] = GIRIH_STATUS_SPLIT_OVERFLOW;
    status[GIRIH_STATUS_SPLITS] = 0;
    status[GIRIH_STATUS_SPLIT_ROOTS] = 0;
    status[GIRIH_STATUS_SPLIT_AGAIN] = 0;
}

void girih_twin_split(girih_arrays *arrays) {
    const girih_frame_block *frame = &arrays->frame;
    const uint32_t *keys = arrays->words[GIRIH_BIND_KEYS];
    uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
    uint32_t begin = 0;
    uint32_t end = frame->triangle_count;
    uint64_t made = 0;
    // The first pass splits triangles, each further one the parts that the one before it made.
    for (uint32_t pass = 0; pass < frame->split_passes; ++pass) {
        const uint64_t before = made;
        for (uint32_t n = begin; n < end; ++n) {
            if (!is_split(keys[n])) {
                continue;
            }
            const bool is_root = pass == 0;
            const girih_part part = is_root ? whole_triangle(arrays, n)
                                            : girih_read_part(arrays, n - frame->triangle_count);
            const division d = choose_division(arrays, &part, is_root);
            const uint32_t count = girih_pattern(arrays, d.rank, GIRIH_PATTERN_TRIANGLES);
            if (made + count <= frame->max_splits) {
                write_parts(arrays, &part, is_root, (uint32_t)made);
            }
            made += count;
            ++status[is_root ? GIRIH_STATUS_SPLIT_ROOTS : GIRIH_STATUS_SPLIT_AGAIN];
        }
        status[GIRIH_STATUS_NEEDED_SPLITS] =
            made < GIRIH_SPLIT_MOST_PARTS ? (uint32_t)made : GIRIH_SPLIT_MOST_PARTS;
        if (made > frame->max_splits) {
            drop_parts(status);
            return;
        }
        begin = frame->triangle_count + (uint32_t)before;
        end = frame->triangle_count + (uint32_t)made;
        status[GIRIH_STATUS_SPLITS] = (uint32_t)made;
    }
    for (uint32_t n = begin; n < end; ++n) {
        if (frame->split_passes > 0 && is_split(keys[n])) {
            drop_parts(status);
            return;
        }
    }
}
