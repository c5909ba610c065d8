// Stage 4: where each group's output begins, whether all of it fits, and the arguments of the draws
// and of the next dispatches. The only stage that clamps.
#ifndef GIRIH_DISPATCH_GLSL
#define GIRIH_DISPATCH_GLSL

#include "arrays.glsl"

// Counts that may pass 2^32 are carried as (low, high).
struct Sums {
    uvec2 vertices;
    uvec2 triangles;
    uint draws;
    uint chunks;
    uint groups;
};

shared uvec2 lane_vertices[girih_lanes];
shared uvec2 lane_triangles[girih_lanes];
shared uint lane_draws[girih_lanes];
shared uint lane_chunks[girih_lanes];
shared uint lane_groups[girih_lanes];
shared uint first_interior;

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

// First item and end of a group.
uvec2 group_items(uint group) {
    uint word = group * GIRIH_GROUP_WORDS;
    return uvec2(GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST), GIRIH_AT_GROUPS(word + GIRIH_GROUP_END));
}

void write_items(uint group, uvec2 items) {
    uint word = group * GIRIH_GROUP_WORDS;
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST) = items.x;
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_END) = items.y;
}

// After an overflow the first group of a material, base pattern [0,0,0], takes all of its items. All lanes together,
// once none of them needs the bounds as they were.
void merge_groups() {
    uint lane = gl_LocalInvocationID.x;
    uint items = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    uint ranges = girih_frame.range_count;
    for (uint material = lane; material < girih_frame.material_count; material += girih_lanes) {
        uint first = girih_first_item(material * ranges, items);
        uint end = girih_first_item((material + 1u) * ranges, items);
        write_items(material * ranges, first < end ? uvec2(first, end) : uvec2(0u));
    }
    memoryBarrierBuffer();
    barrier();
    for (uint group = lane; group < girih_frame.group_count; group += girih_lanes) {
        uint first_group = group / ranges * ranges;
        uvec2 merged = group_items(first_group);
        if (group != first_group) {
            write_items(group, merged.yy);
        }
    }
    memoryBarrierBuffer();
    barrier();
}

// The numbers of a pattern's vertices before the inner ones of edges 2 and 3 and the interior ones.
uvec3 edge_ends(uint rank) {
    uvec3 ends;
    uint end = 3u;
    for (uint n = 0u; n < 3u; ++n) {
        end += girih_pattern(rank, GIRIH_PATTERN_SEGMENTS + n) - 1u;
        ends[n] = end;
    }
    return ends;
}

// Vertices of a pattern that an item of it adds to the output.
uint item_vertices(uint rank) {
    uint vertices = girih_pattern(rank, GIRIH_PATTERN_VERTICES);
    return girih_frame.output_mode == GIRIH_OUTPUT_WELDED ? vertices - edge_ends(rank).z : vertices;
}

// What evaluate and output need of the group `group` whose items are drawn as those of group `drawn`, which is
// range `range` of its material.
void write_record(uint group, uint drawn, uint range, uint first_item) {
    uint rank = girih_range_rank(range);
    uint mirrored = range != girih_pattern(rank, GIRIH_PATTERN_RANGE) ? GIRIH_GROUP_MIRRORED : 0u;
    uint word = group * GIRIH_GROUP_WORDS;
    uint from = drawn * GIRIH_GROUP_WORDS;
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_RANK) = rank | mirrored;
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_VERTICES) = girih_pattern(rank, GIRIH_PATTERN_VERTICES);
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_PATTERN_VERTEX) = girih_pattern(rank, GIRIH_PATTERN_FIRST_VERTEX);
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_BASE_VERTEX) = GIRIH_AT_GROUPS(from + GIRIH_GROUP_FIRST_VERTEX) - first_item * item_vertices(rank);
    uint triangles = girih_pattern(rank, GIRIH_PATTERN_TRIANGLES);
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_BASE_TRIANGLE) =
        GIRIH_AT_GROUPS(from + GIRIH_GROUP_FIRST_TRIANGLE) - first_item * triangles;
    uvec3 ends = edge_ends(rank);
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_PATTERN_TRIANGLE) =
        girih_pattern(rank, GIRIH_PATTERN_FIRST_TRIANGLE) + (mirrored != 0u ? triangles : 0u);
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_TRIANGLES) = triangles;
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_EDGE_ENDS) = ends.x | ends.y << 16;
    GIRIH_AT_GROUPS(word + GIRIH_GROUP_INTERIOR) = ends.z;
}

// What `count` items of a range add.
Sums range_sums(uint range, uint count) {
    uint rank = girih_range_rank(range);
    uint replicas = girih_pattern(rank, GIRIH_PATTERN_REPLICAS);
    return Sums(multiply_wide(count, item_vertices(rank)),
                multiply_wide(count, girih_pattern(rank, GIRIH_PATTERN_TRIANGLES)), (count + replicas - 1u) / replicas,
                count * (girih_pattern(rank, GIRIH_PATTERN_CHUNKS) - 1u), 1u);
}

Sums add_sums(Sums a, Sums b) {
    return Sums(add_wide(a.vertices, b.vertices), add_wide(a.triangles, b.triangles), a.draws + b.draws,
                a.chunks + b.chunks, a.groups + b.groups);
}

void write_lane(Sums sums) {
    uint lane = gl_LocalInvocationID.x;
    barrier();
    lane_vertices[lane] = sums.vertices;
    lane_triangles[lane] = sums.triangles;
    lane_draws[lane] = sums.draws;
    lane_chunks[lane] = sums.chunks;
    lane_groups[lane] = sums.groups;
    barrier();
}

Sums read_lane(uint lane) {
    return Sums(lane_vertices[lane], lane_triangles[lane], lane_draws[lane], lane_chunks[lane], lane_groups[lane]);
}

// Sums of all lanes before this one; `total` of all.
Sums scan_lanes(Sums own, out Sums total) {
    uint lane = gl_LocalInvocationID.x;
    write_lane(own);
    for (uint step = 1u; step < girih_lanes; step *= 2u) {
        if (lane >= step) {
            own = add_sums(own, read_lane(lane - step));
        }
        write_lane(own);
    }
    total = read_lane(girih_lanes - 1u);
    Sums before = Sums(uvec2(0u), uvec2(0u), 0u, 0u, 0u);
    if (lane > 0u) {
        before = read_lane(lane - 1u);
    }
    return before;
}

// The range of the next group.
uint next_range(uint range) {
    return range + 1u < girih_frame.range_count ? range + 1u : 0u;
}

// Of the groups begin to end, of which the first is range `range` of its material.
Sums sum_run(uint begin, uint end, uint range) {
    Sums sums = Sums(uvec2(0u), uvec2(0u), 0u, 0u, 0u);
    for (uint group = begin; group < end; ++group) {
        uvec2 items = group_items(group);
        if (items.x != items.y) {
            sums = add_sums(sums, range_sums(range, items.y - items.x));
        }
        range = next_range(range);
    }
    return sums;
}

bool exceeds(uvec2 wide, uint room) {
    return wide.y != 0u || wide.x > room;
}

// One workgroup: each lane sums a run of groups, the sums of the lanes before it are added, and it
// walks its run again to write.
void dispatch_groups() {
    uint lane = gl_LocalInvocationID.x;
    if (lane == 0u) {
        first_interior = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    }
    uint run = (girih_frame.group_count + girih_lanes - 1u) / girih_lanes;
    uint begin = min(lane * run, girih_frame.group_count);
    uint end = min(begin + run, girih_frame.group_count);
    uint range = begin;
    uint material = girih_quotient(range, girih_frame.range_count);
    material += min(range, 1u); // the next one to begin
    uvec2 border = uvec2(0u);
    if (girih_frame.output_mode == GIRIH_OUTPUT_WELDED) {
        border = add_wide(uvec2(girih_frame.corner_count, 0u),
                          uvec2(GIRIH_AT_STATUS(GIRIH_STATUS_WELD_VERTICES), GIRIH_AT_STATUS(GIRIH_STATUS_WELD_VERTICES + 1u)));
    }
    uint no_parts = GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_SPLIT_OVERFLOW;
    no_parts |= GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_UNDONE) != 0u ? GIRIH_STATUS_SPLIT_OVERFLOW : 0u;
    Sums total;
    Sums sums = scan_lanes(sum_run(begin, end, range), total);
    uvec2 vertices = add_wide(total.vertices, border);
    bool level0 = no_parts != 0u || exceeds(total.triangles, girih_frame.max_triangles) ||
                  (girih_frame.output_mode != GIRIH_OUTPUT_INSTANCED && exceeds(vertices, girih_frame.max_vertices));
    if (lane == 0u) {
        GIRIH_AT_STATUS(GIRIH_STATUS_NEEDED_VERTICES) = vertices.x;
        GIRIH_AT_STATUS(GIRIH_STATUS_NEEDED_VERTICES + 1u) = vertices.y;
        GIRIH_AT_STATUS(GIRIH_STATUS_NEEDED_TRIANGLES) = total.triangles.x;
        GIRIH_AT_STATUS(GIRIH_STATUS_NEEDED_TRIANGLES + 1u) = total.triangles.y;
        GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) = no_parts | (level0 ? GIRIH_STATUS_OVERFLOW : 0u);
        if (no_parts != 0u) {
            GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS) = 0u;
            GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_ROOTS) = 0u;
            GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_AGAIN) = 0u;
        }
    }
    if (level0) {
        merge_groups();
        sums = scan_lanes(sum_run(begin, end, range), total);
        border = uvec2(girih_frame.output_mode == GIRIH_OUTPUT_WELDED ? girih_frame.corner_count : 0u, 0u);
        vertices = add_wide(total.vertices, border);
    }
    // From here on everything fits 32 bits. What is not written of an empty group was cleared to 0. Each turn
    // walks on to the lane's next group with items: a CPU device would else do for all groups, most of them
    // empty, what only these need. Lanes wait for each other in that walk, so its turns add up to the groups of all
    // lanes at most; where that could be more than lavapipe allows, each is one group. Of what the inner loop makes
    // only that is used after it which a branch with loads or stores has set: lavapipe lets go of other values when
    // a lane leaves such a loop before others.
    bool walk = girih_frame.group_count <= GIRIH_FEW_GROUPS;
    uint patterns = 0u;
    uint group = begin;
    do {
        uvec2 items = uvec2(0u);
        bool empty;
        do {
            empty = false;
            if (group < end) {
                items = group_items(group);
                empty = items.x == items.y;
                uint word = group * GIRIH_GROUP_WORDS;
                GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_VERTEX) = sums.vertices.x + border.x;
                GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_TRIANGLE) = sums.triangles.x;
                GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_DRAW) = sums.draws;
                GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_CHUNK) = sums.chunks;
                if (range == 0u) {
                    GIRIH_AT_STATUS(GIRIH_STATUS_WORDS + girih_frame.pattern_count + material) = sums.triangles.x;
                    ++material;
                }
            }
            if (empty) {
                ++group;
                range = next_range(range);
            }
        } while (empty && walk);
        if (items.x != items.y) {
            uint count = items.y - items.x;
            uint rank = girih_range_rank(range);
            write_record(group, group, range, items.x);
            patterns += 1u - atomicExchange(GIRIH_AT_STATUS(GIRIH_STATUS_WORDS + rank), 1u);
            if (item_vertices(rank) != 0u) {
                atomicMin(first_interior, items.x);
            }
            if (girih_frame.output_mode == GIRIH_OUTPUT_INSTANCED && girih_frame.draws_per_material != 0u) {
                bool mirror = range != girih_pattern(rank, GIRIH_PATTERN_RANGE);
                uint draw = group * GIRIH_DRAW_WORDS;
                GIRIH_AT_DRAWS(draw) = 3u * girih_pattern(rank, GIRIH_PATTERN_TRIANGLES);
                GIRIH_AT_DRAWS(draw + 1u) = count;
                GIRIH_AT_DRAWS(draw + 2u) = girih_frame.first_index +
                    girih_pattern(rank, mirror ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
                GIRIH_AT_DRAWS(draw + 3u) = girih_pattern(rank, GIRIH_PATTERN_FIRST_VERTEX);
                GIRIH_AT_DRAWS(draw + 4u) = items.x;
            }
            sums = add_sums(sums, range_sums(range, count));
            ++group;
            range = next_range(range);
        }
    } while (group < end);
    atomicAdd(GIRIH_AT_STATUS(GIRIH_STATUS_PATTERNS), patterns);
    memoryBarrierBuffer();
    barrier();
    if (level0) {
        // Items keep the keys of their own groups.
        for (uint other = lane; other < girih_frame.group_count; other += girih_lanes) {
            uint first_group = other / girih_frame.range_count * girih_frame.range_count;
            write_record(other, first_group, 0u, group_items(first_group).x);
        }
    }
    if (lane == 0u) {
        uint word = girih_frame.group_count * GIRIH_GROUP_WORDS;
        GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST) = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
        GIRIH_AT_GROUPS(word + GIRIH_GROUP_END) = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
        GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_VERTEX) = vertices.x;
        GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_TRIANGLE) = total.triangles.x;
        GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_DRAW) = total.draws;
        GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_CHUNK) = total.chunks;
        GIRIH_AT_STATUS(GIRIH_STATUS_VERTICES) = vertices.x;
        GIRIH_AT_STATUS(GIRIH_STATUS_TRIANGLES) = total.triangles.x;
        GIRIH_AT_STATUS(GIRIH_STATUS_GROUPS) = total.groups;
        GIRIH_AT_STATUS(GIRIH_STATUS_CHUNKS) = total.chunks;
        GIRIH_AT_STATUS(GIRIH_STATUS_WORDS + girih_frame.pattern_count + girih_frame.material_count) = total.triangles.x;
        // Patches are written one item an invocation; vertices and triangles one chunk an invocation.
        uint invocations = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
        if (girih_frame.output_mode != GIRIH_OUTPUT_INSTANCED) {
            invocations += total.chunks;
        }
        girih_write_dispatch(GIRIH_STATUS_EVALUATE, invocations, uint(GIRIH_WORKGROUP));
        girih_write_dispatch(GIRIH_STATUS_INTERIOR, invocations - first_interior, uint(GIRIH_WORKGROUP));
        girih_write_dispatch(GIRIH_STATUS_PARTS, GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS) + total.chunks, uint(GIRIH_WORKGROUP));
        GIRIH_AT_STATUS(GIRIH_STATUS_FIRST_INTERIOR) = first_interior;
    }
}

// Baked draws, of a material the one with this `number`. A group of C triangles whose pattern's indices are replicated
// R times is drawn by ceil(C / R) draws, each with its own vertex offset; what is left of a material's draws was
// cleared to 0.
uint first_draw(uint group) {
    return GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST_DRAW);
}

// How many draws a material has; pack_catalogue.c says why draws_per_material suffices.
uint draw_count(uint material) {
    uint group = material * girih_frame.range_count;
    return girih_frame.pattern_draws != 0u ? first_draw(group + girih_frame.range_count) - first_draw(group)
                                           : girih_frame.draws_per_material;
}

void dispatch_draw(uint material, uint number) {
    uint low = material * girih_frame.range_count;
    uint high = low + girih_frame.range_count;
    uint arguments[5] = uint[5](0u, 1u, 0u, 0u, 0u);
    if (girih_frame.pattern_draws == 0u) {
        uint first = GIRIH_AT_GROUPS(low * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST_TRIANGLE);
        uint end = GIRIH_AT_GROUPS(high * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST_TRIANGLE);
        arguments[0] = 3u * (end - first);
        arguments[2] = girih_frame.first_list_index + 3u * first;
    } else {
        uint draw = first_draw(low) + number;
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
        uint range = low - material * girih_frame.range_count;
        uint rank = girih_range_rank(range);
        uint replicas = girih_pattern(rank, GIRIH_PATTERN_REPLICAS);
        uint first = (draw - first_draw(low)) * replicas;
        uint count = min(replicas, GIRIH_AT_GROUPS(word + GIRIH_GROUP_END) - GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST) - first);
        bool mirror = range != girih_pattern(rank, GIRIH_PATTERN_RANGE);
        arguments[0] = count * 3u * girih_pattern(rank, GIRIH_PATTERN_TRIANGLES);
        arguments[2] = girih_frame.first_index +
            girih_pattern(rank, mirror ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
        arguments[3] = GIRIH_AT_GROUPS(word + GIRIH_GROUP_FIRST_VERTEX) + first * girih_pattern(rank, GIRIH_PATTERN_VERTICES);
    }
    uint slot = material * girih_frame.draws_per_material + number;
    for (uint n = 0u; n < GIRIH_DRAW_WORDS; ++n) {
        GIRIH_AT_DRAWS(slot * GIRIH_DRAW_WORDS + n) = arguments[n];
    }
}

#endif
