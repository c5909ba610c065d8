// Stage 4: where each group's output begins, whether all of it fits, and the arguments of the draws
// and of the next dispatches. The only stage that clamps.
#version 450
#extension GL_GOOGLE_include_directive : require

#if GIRIH_KERNEL == 0
#define GIRIH_LOCAL_SIZE 128
#endif
#include "arrays.glsl"

#if GIRIH_KERNEL == 0

// One workgroup: each lane sums a run of groups, the sums of the lanes before it are added, and it
// walks its run again to write. Counts that may pass 2^32 are carried as (low, high).
const uint lanes = gl_WorkGroupSize.x;

struct Sums {
    uvec2 vertices;
    uvec2 triangles;
    uint draws;
    uint chunks;
    uint groups;
};

shared uvec2 lane_vertices[lanes];
shared uvec2 lane_triangles[lanes];
shared uint lane_draws[lanes];
shared uint lane_chunks[lanes];
shared uint lane_groups[lanes];
shared uint overflow;

uvec2 add_wide(uvec2 a, uvec2 b) {
    uint carry;
    uint low = uaddCarry(a.x, b.x, carry);
    return uvec2(low, a.y + b.y + carry);
}

uvec2 multiply_wide(uint a, uint b) {
    uint high, low;
    umulExtended(a, b, high, low);
    return uvec2(low, high);
}

// Items of a group as it will be drawn. After an overflow the first group of a material, base pattern
// [0,0,0], takes all of its triangles.
uvec2 group_items(uint group, bool level0) {
    uint word = group * GIRIH_GROUP_WORDS;
    if (!level0) {
        return uvec2(GROUPS(word + GIRIH_GROUP_FIRST), GROUPS(word + GIRIH_GROUP_END));
    }
    if (group % frame.range_count != 0u) {
        return uvec2(0u);
    }
    uint first = 0xffffffffu;
    uint end = 0u;
    for (uint n = 0u; n < frame.range_count; ++n) {
        uint other = (group + n) * GIRIH_GROUP_WORDS;
        if (GROUPS(other + GIRIH_GROUP_FIRST) < GROUPS(other + GIRIH_GROUP_END)) {
            first = min(first, GROUPS(other + GIRIH_GROUP_FIRST));
            end = max(end, GROUPS(other + GIRIH_GROUP_END));
        }
    }
    return end == 0u ? uvec2(0u) : uvec2(first, end);
}

// Vertices of a pattern that an item of it adds to the output.
uint item_vertices(uint rank) {
    uint vertices = girih_pattern(rank, GIRIH_PATTERN_VERTICES);
    if (frame.output_mode == GIRIH_OUTPUT_WELDED) {
        for (uint n = 0u; n < 3u; ++n) {
            vertices -= girih_pattern(rank, GIRIH_PATTERN_SEGMENTS + n);
        }
    }
    return vertices;
}

// What evaluate and output need of the group `group` whose items are drawn as those of group `drawn`.
void write_record(uint group, uint drawn, uint first_item) {
    uint range = drawn % frame.range_count;
    uint rank = girih_range_rank(range);
    uint mirrored = range != girih_pattern(rank, GIRIH_PATTERN_RANGE) ? GIRIH_GROUP_MIRRORED : 0u;
    uint word = group * GIRIH_GROUP_WORDS;
    uint from = drawn * GIRIH_GROUP_WORDS;
    GROUPS(word + GIRIH_GROUP_RANK) = rank | mirrored;
    GROUPS(word + GIRIH_GROUP_VERTICES) = girih_pattern(rank, GIRIH_PATTERN_VERTICES);
    GROUPS(word + GIRIH_GROUP_PATTERN_VERTEX) = girih_pattern(rank, GIRIH_PATTERN_FIRST_VERTEX);
    GROUPS(word + GIRIH_GROUP_BASE_VERTEX) = GROUPS(from + GIRIH_GROUP_FIRST_VERTEX) - first_item * item_vertices(rank);
    GROUPS(word + GIRIH_GROUP_BASE_TRIANGLE) =
        GROUPS(from + GIRIH_GROUP_FIRST_TRIANGLE) - first_item * girih_pattern(rank, GIRIH_PATTERN_TRIANGLES);
}

// What one group adds.
Sums group_sums(uint group, uvec2 items) {
    Sums sums = Sums(uvec2(0u), uvec2(0u), 0u, 0u, 0u);
    uint count = items.y - items.x;
    if (count != 0u) {
        uint rank = girih_range_rank(group % frame.range_count);
        uint replicas = girih_pattern(rank, GIRIH_PATTERN_REPLICAS);
        sums.vertices = multiply_wide(count, item_vertices(rank));
        sums.triangles = multiply_wide(count, girih_pattern(rank, GIRIH_PATTERN_TRIANGLES));
        sums.draws = (count + replicas - 1u) / replicas;
        sums.chunks = count * (girih_pattern(rank, GIRIH_PATTERN_CHUNKS) - 1u);
        sums.groups = 1u;
    }
    return sums;
}

Sums add_sums(Sums a, Sums b) {
    return Sums(add_wide(a.vertices, b.vertices), add_wide(a.triangles, b.triangles), a.draws + b.draws,
                a.chunks + b.chunks, a.groups + b.groups);
}

// Sums of all lanes before this one; `total` of all.
Sums scan_lanes(Sums own, out Sums total) {
    uint lane = gl_LocalInvocationID.x;
    barrier();
    lane_vertices[lane] = own.vertices;
    lane_triangles[lane] = own.triangles;
    lane_draws[lane] = own.draws;
    lane_chunks[lane] = own.chunks;
    lane_groups[lane] = own.groups;
    barrier();
    Sums before = Sums(uvec2(0u), uvec2(0u), 0u, 0u, 0u);
    total = before;
    for (uint other = 0u; other < lanes; ++other) {
        if (other == lane) {
            before = total;
        }
        total = add_sums(total, Sums(lane_vertices[other], lane_triangles[other], lane_draws[other],
                                     lane_chunks[other], lane_groups[other]));
    }
    return before;
}

Sums sum_run(uint begin, uint end, bool level0) {
    Sums sums = Sums(uvec2(0u), uvec2(0u), 0u, 0u, 0u);
    for (uint group = begin; group < end; ++group) {
        sums = add_sums(sums, group_sums(group, group_items(group, level0)));
    }
    return sums;
}

bool exceeds(uvec2 wide, uint room) {
    return wide.y != 0u || wide.x > room;
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint run = (frame.group_count + lanes - 1u) / lanes;
    uint begin = min(lane * run, frame.group_count);
    uint end = min(begin + run, frame.group_count);
    uvec2 border = uvec2(0u);
    if (frame.output_mode == GIRIH_OUTPUT_WELDED) {
        border = add_wide(uvec2(frame.corner_count, 0u),
                          uvec2(STATUS(GIRIH_STATUS_WELD_VERTICES), STATUS(GIRIH_STATUS_WELD_VERTICES + 1u)));
    }
    Sums total;
    Sums sums = scan_lanes(sum_run(begin, end, false), total);
    uvec2 vertices = add_wide(total.vertices, border);
    uint groups_in_use = total.groups;
    bool level0 = exceeds(total.triangles, frame.max_triangles) ||
                  (frame.output_mode != GIRIH_OUTPUT_INSTANCED && exceeds(vertices, frame.max_vertices));
    if (lane == 0u) {
        STATUS(GIRIH_STATUS_NEEDED_VERTICES) = vertices.x;
        STATUS(GIRIH_STATUS_NEEDED_VERTICES + 1u) = vertices.y;
        STATUS(GIRIH_STATUS_NEEDED_TRIANGLES) = total.triangles.x;
        STATUS(GIRIH_STATUS_NEEDED_TRIANGLES + 1u) = total.triangles.y;
        STATUS(GIRIH_STATUS_FLAGS) = level0 ? GIRIH_STATUS_OVERFLOW : 0u;
    }
    if (level0) {
        sums = scan_lanes(sum_run(begin, end, true), total);
        border = uvec2(frame.output_mode == GIRIH_OUTPUT_WELDED ? frame.corner_count : 0u, 0u);
        vertices = add_wide(total.vertices, border);
    }
    // From here on everything fits 32 bits.
    for (uint group = begin; group < end; ++group) {
        uvec2 items = group_items(group, level0);
        uint word = group * GIRIH_GROUP_WORDS;
        GROUPS(word + GIRIH_GROUP_FIRST_VERTEX) = sums.vertices.x + border.x;
        GROUPS(word + GIRIH_GROUP_FIRST_TRIANGLE) = sums.triangles.x;
        GROUPS(word + GIRIH_GROUP_FIRST_DRAW) = sums.draws;
        GROUPS(word + GIRIH_GROUP_FIRST_CHUNK) = sums.chunks;
        if (!level0) {
            write_record(group, group, items.x);
        }
        uint count = items.y - items.x;
        uint range = group % frame.range_count;
        uint rank = girih_range_rank(range);
        if (count != 0u) {
            STATUS(GIRIH_STATUS_WORDS + rank) = 1u;
        }
        if (range == 0u) {
            STATUS(GIRIH_STATUS_WORDS + frame.pattern_count + group / frame.range_count) = sums.triangles.x;
        }
        if (frame.output_mode == GIRIH_OUTPUT_INSTANCED && frame.draws_per_material != 0u) {
            bool mirror = range != girih_pattern(rank, GIRIH_PATTERN_RANGE);
            uint draw = group * GIRIH_DRAW_WORDS;
            DRAWS(draw) = 3u * girih_pattern(rank, GIRIH_PATTERN_TRIANGLES);
            DRAWS(draw + 1u) = count;
            DRAWS(draw + 2u) = frame.first_index +
                girih_pattern(rank, mirror ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
            DRAWS(draw + 3u) = girih_pattern(rank, GIRIH_PATTERN_FIRST_VERTEX);
            DRAWS(draw + 4u) = items.x;
        }
        sums = add_sums(sums, group_sums(group, items));
    }
    memoryBarrierBuffer();
    barrier();
    if (level0) {
        // All of a material's triangles stand in its first group. Only now that every lane has read the
        // bounds of its groups do they change.
        for (uint material = lane; material < frame.material_count; material += lanes) {
            uint group = material * frame.range_count;
            uvec2 items = group_items(group, true);
            for (uint n = 0u; n < frame.range_count; ++n) {
                GROUPS((group + n) * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST) = n == 0u ? items.x : items.y;
                GROUPS((group + n) * GIRIH_GROUP_WORDS + GIRIH_GROUP_END) = items.y;
                write_record(group + n, group, items.x);
            }
        }
    }
    if (lane == 0u) {
        uint word = frame.group_count * GIRIH_GROUP_WORDS;
        GROUPS(word + GIRIH_GROUP_FIRST) = STATUS(GIRIH_STATUS_ITEMS);
        GROUPS(word + GIRIH_GROUP_END) = STATUS(GIRIH_STATUS_ITEMS);
        GROUPS(word + GIRIH_GROUP_FIRST_VERTEX) = vertices.x;
        GROUPS(word + GIRIH_GROUP_FIRST_TRIANGLE) = total.triangles.x;
        GROUPS(word + GIRIH_GROUP_FIRST_DRAW) = total.draws;
        GROUPS(word + GIRIH_GROUP_FIRST_CHUNK) = total.chunks;
        STATUS(GIRIH_STATUS_VERTICES) = vertices.x;
        STATUS(GIRIH_STATUS_TRIANGLES) = total.triangles.x;
        STATUS(GIRIH_STATUS_GROUPS) = total.groups;
        STATUS(GIRIH_STATUS_CHUNKS) = total.chunks;
        STATUS(GIRIH_STATUS_WORDS + frame.pattern_count + frame.material_count) = total.triangles.x;
        uint patterns = 0u;
        for (uint rank = 0u; rank < frame.pattern_count; ++rank) {
            patterns += STATUS(GIRIH_STATUS_WORDS + rank);
        }
        STATUS(GIRIH_STATUS_PATTERNS) = patterns;
        // Patches are written one item an invocation; vertices and triangles one chunk an invocation.
        uint invocations = STATUS(GIRIH_STATUS_ITEMS);
        if (frame.output_mode != GIRIH_OUTPUT_INSTANCED) {
            invocations += total.chunks;
        }
        uint workgroups = (invocations + uint(GIRIH_WORKGROUP) - 1u) / uint(GIRIH_WORKGROUP);
        uint rows = (workgroups + 65534u) / 65535u;
        STATUS(GIRIH_STATUS_EVALUATE) = rows > 1u ? 65535u : workgroups;
        STATUS(GIRIH_STATUS_EVALUATE + 1u) = rows;
        STATUS(GIRIH_STATUS_EVALUATE + 2u) = 1u;
    }
}

#else

// Baked draws: one invocation for each draw that a material may have. A group of C triangles whose
// pattern's indices are replicated R times is drawn by ceil(C / R) draws, each with its own vertex
// offset; what is left of a material's draws is empty.
uint first_draw(uint group) {
    return GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST_DRAW);
}

void main() {
    uint slot = girih_invocation();
    if (slot >= frame.draws_per_material * frame.material_count) {
        return;
    }
    uint material = slot / frame.draws_per_material;
    uint low = material * frame.range_count;
    uint high = low + frame.range_count;
    uint draw = first_draw(low) + slot % frame.draws_per_material;
    uint arguments[5] = uint[5](0u, 0u, 0u, 0u, 0u);
    if (frame.pattern_draws == 0u) {
        uint first = GROUPS(low * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST_TRIANGLE);
        uint end = GROUPS(high * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST_TRIANGLE);
        arguments = uint[5](3u * (end - first), 1u, frame.first_list_index + 3u * first, 0u, 0u);
    } else if (draw < first_draw(high)) {
        // The last group whose first draw is not beyond this one; empty groups share their successor's.
        while (high - low > 1u) {
            uint middle = (low + high) / 2u;
            if (first_draw(middle) <= draw) {
                low = middle;
            } else {
                high = middle;
            }
        }
        uint word = low * GIRIH_GROUP_WORDS;
        uint range = low % frame.range_count;
        uint rank = girih_range_rank(range);
        uint replicas = girih_pattern(rank, GIRIH_PATTERN_REPLICAS);
        uint first = (draw - first_draw(low)) * replicas;
        uint count = min(replicas, GROUPS(word + GIRIH_GROUP_END) - GROUPS(word + GIRIH_GROUP_FIRST) - first);
        bool mirror = range != girih_pattern(rank, GIRIH_PATTERN_RANGE);
        arguments[0] = count * 3u * girih_pattern(rank, GIRIH_PATTERN_TRIANGLES);
        arguments[1] = 1u;
        arguments[2] = frame.first_index +
            girih_pattern(rank, mirror ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
        arguments[3] = GROUPS(word + GIRIH_GROUP_FIRST_VERTEX) + first * girih_pattern(rank, GIRIH_PATTERN_VERTICES);
    }
    for (uint n = 0u; n < GIRIH_DRAW_WORDS; ++n) {
        DRAWS(slot * GIRIH_DRAW_WORDS + n) = arguments[n];
    }
}

#endif
