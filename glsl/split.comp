// Between stages 2 and 3: triangles that ask for more segments than the catalogue holds are split by base patterns into
// parts, pass by pass, until every part's levels are the catalogue's. A pass counts (GIRIH_KERNEL 0), by one workgroup
// a block, sums the blocks (1), by one workgroup, and writes the parts (2), by one workgroup a block.
//
// Of the push constants `shift` is the number of the pass; the first splits triangles, each further one the parts that
// the one before it made. `first_pass` marks the first, `to_spare` the last.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#define GIRIH_LOCAL_SIZE GIRIH_SPLIT_BLOCK
#include "key.glsl"
#include "part.glsl"
#include "level_rules.glsl"
#include "scene.glsl"

uint pass_word(uint pass, uint field) {
    return GIRIH_STATUS_SPLIT_PASS + (pass & 1u) * GIRIH_SPLIT_PASS_WORDS + field;
}

bool is_first() {
    return girih_push.first_pass != 0u;
}

// The numbers, as of the plan's triangles, of what the pass may have to split.
uvec2 pass_range() {
    if (is_first()) {
        return uvec2(0u, girih_frame.triangle_count);
    }
    return girih_frame.triangle_count + uvec2(GIRIH_AT_STATUS(pass_word(girih_push.shift, GIRIH_SPLIT_PASS_FIRST)),
                                              GIRIH_AT_STATUS(pass_word(girih_push.shift, GIRIH_SPLIT_PASS_END)));
}

#if GIRIH_KERNEL != 1

// A triangle as its own only part, or a part.
struct Whole {
    uint root;
    uint instance;
    uint scene_triangle;
    uvec3 levels;
    bool first; // of the root's parts
    GirihPart part;
};

Whole read_whole(uint number) {
    Whole whole;
    whole.root = number;
    uvec4 levels = uvec4(0u);
    if (!is_first()) {
        uint four = (number - girih_frame.triangle_count) * (GIRIH_SPLIT_WORDS / 4u);
        levels = GIRIH_AT_SPLIT_FOURS(four);
        whole.root = levels[GIRIH_SPLIT_ROOT];
        whole.levels = uvec3(levels[GIRIH_SPLIT_LEVELS] & 0xffffu, levels[GIRIH_SPLIT_LEVELS] >> 16,
                             levels[GIRIH_SPLIT_LEVELS + 1] & 0xffffu);
        whole.first = (levels[GIRIH_SPLIT_LEVELS + 1] & GIRIH_SPLIT_FIRST) != 0u;
        whole.part = girih_unpack_part(GIRIH_AT_SPLIT_FOURS(four + 1u), GIRIH_AT_SPLIT_FOURS(four + 2u).xy);
    }
    whole.instance = girih_find_instance(whole.root, GIRIH_INSTANCE_FIRST_TRIANGLE, girih_frame.triangle_blocks);
    whole.scene_triangle = whole.root - girih_instance(whole.instance, GIRIH_INSTANCE_TRIANGLE_DELTA);
    if (is_first()) {
        uvec3 segments;
        for (uint n = 0u; n < 3u; ++n) {
            uint edge = GIRIH_AT_TRIANGLE_EDGES(3u * whole.scene_triangle + n) & GIRIH_EDGE_MASK;
            whole.levels[n] = GIRIH_AT_LEVELS(edge + girih_instance(whole.instance, GIRIH_INSTANCE_EDGE_DELTA));
            segments[n] = girih_level_segments(whole.levels[n]);
        }
        whole.first = true;
        whole.part = girih_whole_part(segments);
    }
    return whole;
}

// The level that is left to the parts of an edge of this level: half of the levels (linear: about the root of the
// segments, but 8; a power of two), or more where the catalogue cannot split so finely.
uint rest_level(uint level) {
    uint most = uint(GIRIH_SPLIT_MOST_SEGMENTS);
    if (girih_frame.linear_spacing == 0u) {
        uint coarse = min(girih_frame.level_count - 1u, uint(findMSB(most)));
        return level / 2u + coarse > level ? level / 2u : level - coarse;
    }
    uint coarse = min(girih_frame.level_count, most);
    uint segments = level + 1u;
    uint least = 1u << findMSB(min(girih_frame.level_count, uint(GIRIH_SPLIT_LEAST_SEGMENTS)));
    uint needed = (segments + coarse - 1u) / coarse;
    return max(max(1u << (findMSB(segments) / 2), least), 1u << (findMSB(needed - 1u) + 1)) - 1u;
}

// How something is split.
struct Division {
    uint rank;
    uint lambda;
    uvec3 counts; // parts of each edge
    uvec3 rest;   // dyadic: levels of their parts
};

// Both sides of an inner edge split it alike: by its own level. Of a triangle all edges are split to about one size:
// their vertices are those of the whole edges however they are split.
Division choose_division(uvec3 levels) {
    uint largest = max(max(levels.x, levels.y), levels.z);
    Division d;
    uvec3 coarse = uvec3(0u);
    for (uint n = 0u; n < 3u; ++n) {
        uint level = levels[n];
        if (is_first() || level >= girih_frame.level_count) {
            uint rest = rest_level(is_first() ? largest : level);
            if (girih_frame.linear_spacing != 0u) {
                coarse[n] = level / (rest + 1u);
            } else {
                coarse[n] = level > rest ? level - rest : 0u;
            }
        }
        d.counts[n] = girih_level_segments(coarse[n]);
        d.rest[n] = level - coarse[n];
    }
    d.lambda = girih_sort_levels(coarse);
    d.rank = girih_rank(coarse);
    return d;
}

// What lanes before this one split, and in all; by all lanes together.
shared uint lane_ends[girih_lanes];

void scan_parts(uint own) {
    uint lane = gl_LocalInvocationID.x;
    lane_ends[lane] = own;
    barrier();
    for (uint step = 1u; step < girih_lanes; step *= 2u) {
        uint before = lane >= step ? lane_ends[lane - step] : 0u;
        barrier();
        lane_ends[lane] += before;
        barrier();
    }
}

// How many parts this lane's triangle or part is split into; 0: it is not.
uint count_parts(uint number, uint end) {
    uint key = number < end ? GIRIH_AT_KEYS(number) : GIRIH_KEY_CULLED;
    if (key < GIRIH_KEY_SPLIT || key == GIRIH_KEY_CULLED) {
        return 0u;
    }
    return girih_pattern(choose_division(read_whole(number).levels).rank, GIRIH_PATTERN_TRIANGLES);
}

uint block_number() {
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

#endif

#if GIRIH_KERNEL == 0

shared uint split_count;

void main() {
    uvec2 range = pass_range();
    uint block = block_number();
    uint lane = gl_LocalInvocationID.x;
    if (lane == 0u) {
        split_count = 0u;
    }
    uint count = count_parts(range.x + block * girih_lanes + lane, range.y);
    scan_parts(count);
    if (count != 0u) {
        atomicAdd(split_count, 1u);
    }
    barrier();
    if (lane == 0u && range.x + block * girih_lanes < range.y) {
        GIRIH_AT_COUNTERS(2u * block) = lane_ends[girih_lanes - 1u];
        GIRIH_AT_COUNTERS(2u * block + 1u) = split_count;
    }
}

#elif GIRIH_KERNEL == 1

shared uint lane_parts[girih_lanes];
shared uint lane_splits[girih_lanes];

// What is counted stays below 2^31, so that two can be added.
uint add_parts(uint a, uint b) {
    return min(a + b, uint(GIRIH_SPLIT_MOST_PARTS));
}

void write_dispatch(uint field, uint invocations, uint size) {
    uint workgroups = (invocations + size - 1u) / size;
    uint rows = (workgroups + 65534u) / 65535u;
    GIRIH_AT_STATUS(field) = rows > 1u ? 65535u : workgroups;
    GIRIH_AT_STATUS(field + 1u) = rows;
    GIRIH_AT_STATUS(field + 2u) = 1u;
}

// Each lane sums a run of blocks, the sums of the lanes before it are added, and it walks its run again to write.
void main() {
    uint lane = gl_LocalInvocationID.x;
    uvec2 range = pass_range();
    uint blocks = (range.y - range.x + girih_lanes - 1u) / girih_lanes;
    uint run = (blocks + girih_lanes - 1u) / girih_lanes;
    uint begin = min(lane * run, blocks);
    uint end = min(begin + run, blocks);
    uint parts = 0u;
    uint splits = 0u;
    for (uint block = begin; block < end; ++block) {
        parts = add_parts(parts, GIRIH_AT_COUNTERS(2u * block));
        splits += GIRIH_AT_COUNTERS(2u * block + 1u);
    }
    lane_parts[lane] = parts;
    lane_splits[lane] = splits;
    barrier();
    for (uint step = 1u; step < girih_lanes; step *= 2u) {
        uint parts_before = lane >= step ? lane_parts[lane - step] : 0u;
        uint splits_before = lane >= step ? lane_splits[lane - step] : 0u;
        barrier();
        lane_parts[lane] = add_parts(lane_parts[lane], parts_before);
        lane_splits[lane] += splits_before;
        barrier();
    }
    // The parts of a pass follow those of the pass before.
    uint first = is_first() ? 0u : range.y - girih_frame.triangle_count;
    uint offset = lane > 0u ? lane_parts[lane - 1u] : 0u;
    for (uint block = begin; block < end; ++block) {
        uint count = GIRIH_AT_COUNTERS(2u * block);
        GIRIH_AT_COUNTERS(2u * block) = first + offset;
        offset = add_parts(offset, count);
    }
    if (lane != 0u) {
        return;
    }
    uint made = add_parts(first, lane_parts[girih_lanes - 1u]);
    bool overflow = made > girih_frame.max_splits;
    if (!is_first() && (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_SPLIT_OVERFLOW) != 0u) {
        return;
    }
    GIRIH_AT_STATUS(GIRIH_STATUS_NEEDED_SPLITS) = made;
    if (overflow) {
        GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) = GIRIH_STATUS_SPLIT_OVERFLOW;
        GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS) = 0u;
        GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_ROOTS) = 0u;
        GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_AGAIN) = 0u;
        made = first;
    } else {
        GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS) = made;
        uint word = is_first() ? GIRIH_STATUS_SPLIT_ROOTS : GIRIH_STATUS_SPLIT_AGAIN;
        GIRIH_AT_STATUS(word) += lane_splits[girih_lanes - 1u];
    }
    uint next = girih_push.shift + 1u;
    write_dispatch(pass_word(next, GIRIH_SPLIT_PASS_DISPATCH), made - first, girih_lanes);
    GIRIH_AT_STATUS(pass_word(next, GIRIH_SPLIT_PASS_FIRST)) = first;
    write_dispatch(GIRIH_STATUS_PARTS, overflow ? 0u : made, GIRIH_WORKGROUP);
    GIRIH_AT_STATUS(pass_word(next, GIRIH_SPLIT_PASS_END)) = made;
}

#else

// The level of a part's edge inside what is split, between two places whose corners weigh `a` and `b`. The spacing
// there is that of the border, growing with the distance from each edge, up to that of the coarsest edge: equal edges
// give a regular grid, and the triangles along an edge of n segments are some n, not the square of it, however coarse
// the others are. No loops: a CPU device's turns are counted.
uint inner_level(uvec3 levels, uvec3 a, uvec3 b) {
    // All lengths are over 2^14, of a part whose sides are 1.
    uint spacing = 1u;
    uint nearest = 0xffffffffu;
    uint square = 0u;
    for (uint n = 0u; n < 3u; ++n) {
        uint segments = girih_level_segments(levels[n]);
        uint border = (16384u + segments / 2u) / segments;
        // The mean weight of the corner opposite to the edge is the distance in heights.
        uint opposite = n == 0u ? 2u : n - 1u;
        spacing = max(spacing, border);
        nearest = min(nearest, border + (a[opposite] + b[opposite]) / 4u);
        uint across = (max(a[n], b[n]) - min(a[n], b[n])) / 2u;
        square += across * across;
    }
    spacing = min(spacing, nearest);
    // The square of the length is half of the sum.
    square /= 2u;
    if (girih_frame.linear_spacing == 0u) {
        // The power of two whose segments are nearest to the spacing: at most one less than its halved bits tell.
        uint wanted = square / 2u;
        uint have = spacing * spacing;
        int bits = wanted > have ? findMSB(wanted) - findMSB(have) : 0;
        uint level = uint(bits / 2);
        level += have << 2u * level < wanted ? 1u : 0u;
        level += have << 2u * level < wanted ? 1u : 0u;
        return level;
    }
    // The root of the square, rounded up: a float's may be off by one.
    uint root = uint(sqrt(float(square)));
    root -= root * root > square ? 1u : 0u;
    root += (root + 1u) * (root + 1u) <= square ? 1u : 0u;
    root += root * root < square ? 1u : 0u;
    uint level = (max(root, 1u) - 1u) / spacing;
    if (level >= girih_frame.level_count) {
        // Parts of equal size, so that the places of its vertices do not depend on how it is split.
        level |= rest_level(level);
    }
    return level;
}

// The level of a part's edge between two places of what is split, whose corners weigh `a` and `b`.
uint part_level(uvec3 levels, Division d, uvec3 a, uvec3 b) {
    uvec3 either = a | b;
    // The edge that both lie on.
    uint edge = either.z == 0u ? 0u : either.x == 0u ? 1u : either.y == 0u ? 2u : 3u;
    if (edge == 3u) {
        return inner_level(levels, a, b);
    }
    if (girih_frame.linear_spacing == 0u) {
        return d.rest[edge];
    }
    uint next = edge == 2u ? 0u : edge + 1u;
    uint segments = girih_level_segments(levels[edge]);
    uint from = girih_part_steps(segments, d.counts[edge], a[next]);
    uint to = girih_part_steps(segments, d.counts[edge], b[next]);
    return (from < to ? to - from : from - to) - 1u;
}

// Part `triangle` of those that something is split into becomes part `made`.
void write_part(Whole whole, uint triangle, uint made) {
    Division d = choose_division(whole.levels);
    uint first_vertex = girih_pattern(d.rank, GIRIH_PATTERN_FIRST_VERTEX);
    uvec2 words = GIRIH_AT_PATTERN_TRIANGLES(girih_pattern(d.rank, GIRIH_PATTERN_FIRST_TRIANGLE) + triangle);
    uvec3 vertices = girih_pattern_triangle(words);
    // A mirrored triangle (a, c, b) winds as what is split does again.
    vertices = GIRIH_LAMBDA_IS_ODD(d.lambda) != 0u ? vertices.xzy : vertices;
    uint corners = GIRIH_LAMBDA_CORNERS(d.lambda);
    uvec3 weights[3];
    GirihPart part = whole.part;
    for (uint n = 0u; n < 3u; ++n) {
        uint packed = GIRIH_AT_PATTERN_VERTICES(first_vertex + vertices[n]);
        uvec3 pattern = uvec3(packed & 0xffffu, packed >> 16, 32768u - (packed & 0xffffu) - (packed >> 16));
        for (uint k = 0u; k < 3u; ++k) {
            weights[n][corners >> (2u * k) & 3u] = pattern[k];
        }
        uvec3 corner = girih_part_weights(whole.part, weights[n], d.counts);
        part.u[n] = corner.x;
        part.v[n] = corner.y;
    }
    uvec3 levels = uvec3(part_level(whole.levels, d, weights[0], weights[1]),
                         part_level(whole.levels, d, weights[1], weights[2]),
                         part_level(whole.levels, d, weights[2], weights[0]));
    uvec4 first_corners;
    uvec2 last_corner;
    girih_pack_part(part, first_corners, last_corner);
    uint four = made * (GIRIH_SPLIT_WORDS / 4u);
    uint first = whole.first && triangle == 0u ? GIRIH_SPLIT_FIRST : 0u;
    GIRIH_AT_SPLIT_FOURS(four) = uvec4(whole.root, levels.x | levels.y << 16, levels.z | first, 0u);
    GIRIH_AT_SPLIT_FOURS(four + 1u) = first_corners;
    GIRIH_AT_SPLIT_FOURS(four + 2u) = uvec4(last_corner, 0u, 0u);
    uint material = girih_has(GIRIH_VARIANT_MATERIALS) ? GIRIH_AT_TRIANGLE_MATERIALS(whole.scene_triangle) : 0u;
    uint key = girih_key(levels, material, girih_instance_mirrored(whole.instance));
    GIRIH_AT_KEYS(girih_frame.triangle_count + made) = key;
    if (girih_push.to_spare != 0u && key >= GIRIH_KEY_SPLIT) {
        atomicOr(GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS), GIRIH_STATUS_SPLIT_OVERFLOW);
    }
}

void main() {
    uvec2 range = pass_range();
    uint first = range.x + block_number() * girih_lanes;
    uint lane = gl_LocalInvocationID.x;
    bool overflow = (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_SPLIT_OVERFLOW) != 0u;
    scan_parts(overflow ? 0u : count_parts(first + lane, range.y));
    uint total = lane_ends[girih_lanes - 1u];
    uint offset = first < range.y ? GIRIH_AT_COUNTERS(2u * block_number()) : 0u;
    for (uint n = lane; n < total; n += girih_lanes) {
        // The lane whose parts end beyond it.
        uint owner = 0u;
        for (uint step = girih_lanes / 2u; step > 0u; step /= 2u) {
            owner += lane_ends[owner + step - 1u] <= n ? step : 0u;
        }
        uint before = owner > 0u ? lane_ends[owner - 1u] : 0u;
        write_part(read_whole(first + owner), n - before, offset + n);
    }
}

#endif
