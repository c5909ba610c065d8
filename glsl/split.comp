// Between stages 2 and 3: triangles that ask for more segments than the catalogue holds are split by base patterns into
// parts, pass by pass, until every part's levels are the catalogue's. A pass counts what select or the pass before has
// marked (GIRIH_KERNEL 0, one lane a block of keys), sums the blocks (1, one workgroup), lists the marked ones in ITEMS,
// which the sort has not begun to use (2); then it counts the parts of each that is listed (3, one workgroup a block of
// the list), sums these (4, one workgroup) and writes the parts (5). Only 0 and 2 look at what is not split: a
// CPU device runs whatever may be needed for every lane.
//
// Of the push constants `shift` is the number of the pass; the first splits triangles, each further one the parts that
// the one before it made. `first_pass` marks the first, `to_spare` the last.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#if GIRIH_KERNEL == 0 || GIRIH_KERNEL == 2
#define GIRIH_LOCAL_SIZE GIRIH_SCAN_WORKGROUP
#else
#define GIRIH_LOCAL_SIZE GIRIH_SPLIT_BLOCK
#endif
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

// What the pass splits.
uint list_count() {
    return GIRIH_AT_STATUS(pass_word(girih_push.shift, GIRIH_SPLIT_PASS_COUNT));
}

#if GIRIH_KERNEL == 0 || GIRIH_KERNEL == 2

bool is_marked(uint number) {
    uint key = GIRIH_AT_KEYS(number);
    return key >= GIRIH_KEY_SPLIT && key != GIRIH_KEY_CULLED;
}

void main() {
    uvec2 range = pass_range();
    uint block = girih_invocation();
    uint first = range.x + block * GIRIH_SPLIT_BLOCK;
    if (first >= range.y) {
        return;
    }
    uint end = min(first + GIRIH_SPLIT_BLOCK, range.y);
#if GIRIH_KERNEL == 0
    uint count = 0u;
    for (uint n = first; n < end; ++n) {
        count += is_marked(n) ? 1u : 0u;
    }
    GIRIH_AT_COUNTERS(block) = count;
#else
    uint next = GIRIH_AT_COUNTERS(block);
    for (uint n = first; n < end; ++n) {
        if (is_marked(n)) {
            GIRIH_AT_ITEMS(next)[GIRIH_ITEM_TRIANGLE] = n;
            ++next;
        }
    }
#endif
}

#elif GIRIH_KERNEL == 3 || GIRIH_KERNEL == 5

// A triangle as its own only part, or a part.
struct Whole {
    uint root;
    uint instance;
    uint scene_triangle;
    uvec3 levels;
    bool first; // of the root's parts
    GirihPart part;
};

// The instance of a triangle or a part: a search, so that it is made once for all parts of what is split. A CPU
// device's turns are counted.
uint find_instance(uint number) {
    if (!is_first()) {
        number = GIRIH_AT_SPLIT_FOURS((number - girih_frame.triangle_count) * (GIRIH_SPLIT_WORDS / 4u))[GIRIH_SPLIT_ROOT];
    }
    return girih_find_instance(number, GIRIH_INSTANCE_FIRST_TRIANGLE, girih_frame.triangle_blocks);
}

Whole read_whole(uint number, uint instance) {
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
    whole.instance = instance;
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

// How many parts place n of the list is split into, and its instance.
uint count_parts(uint n, out uint instance) {
    uint number = GIRIH_AT_ITEMS(min(n, list_count() - 1u))[GIRIH_ITEM_TRIANGLE];
    instance = find_instance(number);
    uint count = girih_pattern(choose_division(read_whole(number, instance).levels).rank, GIRIH_PATTERN_TRIANGLES);
    return n < list_count() ? count : 0u;
}

uint block_number() {
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

#endif

#if GIRIH_KERNEL == 3

shared uint part_count;

void main() {
    uint block = block_number();
    uint lane = gl_LocalInvocationID.x;
    if (lane == 0u) {
        part_count = 0u;
    }
    barrier();
    uint instance;
    atomicAdd(part_count, count_parts(block * girih_lanes + lane, instance));
    barrier();
    if (lane == 0u && block * girih_lanes < list_count()) {
        GIRIH_AT_COUNTERS(block) = part_count;
    }
}

#elif GIRIH_KERNEL == 1 || GIRIH_KERNEL == 4

shared uint lane_sums[girih_lanes];

// What is counted stays below 2^31, so that two can be added.
uint add_parts(uint a, uint b) {
    return min(a + b, uint(GIRIH_SPLIT_MOST_PARTS));
}

// Leaves in the blocks' counters how many come before each, from `first` on; returns how many there are in all. Each
// lane sums a run of blocks, the sums of the lanes before it are added, and it walks its run again to write.
uint sum_blocks(uint blocks, uint first) {
    uint lane = gl_LocalInvocationID.x;
    uint run = (blocks + girih_lanes - 1u) / girih_lanes;
    uint begin = min(lane * run, blocks);
    uint end = min(begin + run, blocks);
    uint sum = 0u;
    for (uint block = begin; block < end; ++block) {
        sum = add_parts(sum, GIRIH_AT_COUNTERS(block));
    }
    lane_sums[lane] = sum;
    barrier();
    for (uint step = 1u; step < girih_lanes; step *= 2u) {
        uint before = lane >= step ? lane_sums[lane - step] : 0u;
        barrier();
        lane_sums[lane] = add_parts(lane_sums[lane], before);
        barrier();
    }
    uint offset = lane > 0u ? lane_sums[lane - 1u] : 0u;
    for (uint block = begin; block < end; ++block) {
        uint count = GIRIH_AT_COUNTERS(block);
        GIRIH_AT_COUNTERS(block) = first + offset;
        offset = add_parts(offset, count);
    }
    return lane_sums[girih_lanes - 1u];
}

uint blocks_of(uint count) {
    return (count + uint(GIRIH_SPLIT_BLOCK) - 1u) / uint(GIRIH_SPLIT_BLOCK);
}

#if GIRIH_KERNEL == 1

void main() {
    uvec2 range = pass_range();
    uint count = sum_blocks(blocks_of(range.y - range.x), 0u);
    if (gl_LocalInvocationID.x == 0u) {
        uint word = pass_word(girih_push.shift, 0u);
        GIRIH_AT_STATUS(word + GIRIH_SPLIT_PASS_COUNT) = count;
        girih_write_dispatch(word + GIRIH_SPLIT_PASS_SPLITS, count, uint(GIRIH_SPLIT_BLOCK));
    }
}

#else

void main() {
    uint count = list_count();
    // The parts of a pass follow those of the pass before.
    uint first = is_first() ? 0u : pass_range().y - girih_frame.triangle_count;
    uint made = add_parts(first, sum_blocks(blocks_of(count), first));
    if (gl_LocalInvocationID.x != 0u) {
        return;
    }
    uint next = pass_word(girih_push.shift + 1u, 0u);
    if (!is_first() && (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_SPLIT_OVERFLOW) != 0u) {
        // Nothing is left for any further pass.
        girih_write_dispatch(next + GIRIH_SPLIT_PASS_MARKS, 0u, uint(GIRIH_SCAN_WORKGROUP));
        GIRIH_AT_STATUS(next + GIRIH_SPLIT_PASS_END) = GIRIH_AT_STATUS(next + GIRIH_SPLIT_PASS_FIRST);
        return;
    }
    GIRIH_AT_STATUS(GIRIH_STATUS_NEEDED_SPLITS) = made;
    bool overflow = made > girih_frame.max_splits;
    if (overflow) {
        made = first;
        GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) = GIRIH_STATUS_SPLIT_OVERFLOW;
        GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_ROOTS) = 0u;
        GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_AGAIN) = 0u;
    } else {
        uint word = is_first() ? GIRIH_STATUS_SPLIT_ROOTS : GIRIH_STATUS_SPLIT_AGAIN;
        GIRIH_AT_STATUS(word) += count;
    }
    GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS) = overflow ? 0u : made;
    girih_write_dispatch(next + GIRIH_SPLIT_PASS_MARKS, blocks_of(made - first), uint(GIRIH_SCAN_WORKGROUP));
    GIRIH_AT_STATUS(next + GIRIH_SPLIT_PASS_FIRST) = first;
    GIRIH_AT_STATUS(next + GIRIH_SPLIT_PASS_END) = made;
}

#endif

#elif GIRIH_KERNEL == 5

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
        atomicAdd(GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_UNDONE), 1u);
    }
}

// The parts of each lane and of all before it, by all lanes together.
shared uint lane_ends[girih_lanes];
shared uint lane_instances[girih_lanes];

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

void main() {
    uint block = block_number();
    uint first = block * girih_lanes;
    uint lane = gl_LocalInvocationID.x;
    bool overflow = (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_SPLIT_OVERFLOW) != 0u;
    // The same for all lanes.
    if (overflow || first >= list_count()) {
        return;
    }
    uint count = count_parts(first + lane, lane_instances[lane]);
    scan_parts(count);
    uint total = lane_ends[girih_lanes - 1u];
    uint offset = GIRIH_AT_COUNTERS(block);
    for (uint n = lane; n < total; n += girih_lanes) {
        // The lane whose parts end beyond it.
        uint owner = 0u;
        for (uint step = girih_lanes / 2u; step > 0u; step /= 2u) {
            owner += lane_ends[owner + step - 1u] <= n ? step : 0u;
        }
        uint before = owner > 0u ? lane_ends[owner - 1u] : 0u;
        uint number = GIRIH_AT_ITEMS(first + owner)[GIRIH_ITEM_TRIANGLE];
        write_part(read_whole(number, lane_instances[owner]), n - before, offset + n);
    }
}

#endif
