// Stage 3: the triangles that were not culled, sorted by (material, range) and within a group in input
// order: a stable counting sort, so that the same input gives the same bytes whatever the timing.
//
// Keys are sorted digit by digit, the lowest first, as many digits as the number of groups needs. Each
// block of sort_block keys counts its digits (count_block); the counts are summed over the blocks
// (sum_blocks) and over the digits (sum_digits); each block then places its keys (place_block). Where one
// digit is enough, its sums are the groups' bounds; else each group looks its bounds up in the sorted keys
// (find_bounds).
//
// Two ways to walk a block, with the same result: one lane alone (GIRIH_SERIAL), best where lanes are
// few and memory is near, or a workgroup, ranking its keys against each other in shared memory.
#ifndef GIRIH_GROUP_GLSL
#define GIRIH_GROUP_GLSL

#include "arrays.glsl"

// The pass that all of these functions are about: GIRIH_PUSH_BLOCK tells of its fields.
struct Pass {
    uint shift;
    uint bins;
    bool first;
    bool to_spare;
};
Pass pass;

// False where there are none, and where they found no room: then all triangles are drawn as they are, at level 0.
// Asked once: a CPU device pays for every load.
bool parts_are_drawn = false;

void find_parts() {
    parts_are_drawn = girih_has(GIRIH_VARIANT_SPLITS) &&
                      (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_SPLIT_OVERFLOW) == 0u &&
                      GIRIH_AT_STATUS(GIRIH_STATUS_SPLIT_UNDONE) == 0u;
}

uint key_count() {
    if (!pass.first) {
        return GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    }
    return girih_frame.triangle_count + (parts_are_drawn ? GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS) : 0u);
}

uint read_key(uint n) {
    if (pass.first) {
        uint key = GIRIH_AT_KEYS(n);
        if (girih_has(GIRIH_VARIANT_SPLITS) && key >= GIRIH_KEY_SPLIT && key != GIRIH_KEY_CULLED) {
            return parts_are_drawn ? GIRIH_KEY_CULLED : key ^ GIRIH_KEY_SPLIT;
        }
        return key;
    }
    return pass.to_spare ? GIRIH_AT_ITEMS(n)[GIRIH_ITEM_KEY] : GIRIH_AT_ITEMS_SPARE(n)[GIRIH_ITEM_KEY];
}

uint digit_of(uint key) {
    return ((key >> 3) >> pass.shift) & (pass.bins - 1u);
}

void place(uint n, uint key, uint target) {
    uvec2 item;
    item[GIRIH_ITEM_TRIANGLE] = n;
    if (!pass.first) {
        item = pass.to_spare ? GIRIH_AT_ITEMS(n) : GIRIH_AT_ITEMS_SPARE(n);
    }
    item[GIRIH_ITEM_KEY] = key;
    if (pass.to_spare) {
        GIRIH_AT_ITEMS_SPARE(target) = item;
    } else {
        GIRIH_AT_ITEMS(target) = item;
        // Of several passes the last one's stays.
        if (girih_has(GIRIH_VARIANT_SPLITS) && item[GIRIH_ITEM_TRIANGLE] >= girih_frame.triangle_count) {
            uint part = item[GIRIH_ITEM_TRIANGLE] - girih_frame.triangle_count;
            GIRIH_AT_SPLIT_FOURS(part * (GIRIH_SPLIT_WORDS / 4u))[GIRIH_SPLIT_ITEM] = target + 1u;
        }
    }
}

// Culled keys count as a digit beyond all others: cheaper than a branch where lanes run in step.
uint digit_or_none(uint key) {
    return key != GIRIH_KEY_CULLED ? digit_of(key) : GIRIH_MAX_BINS;
}

// COUNTERS: a row of `bins` counters for every block, then a row of the digits' totals.
uint counter_word(uint block, uint digit) {
    return block * pass.bins + digit;
}

// The groups were cleared to 0, so that an empty one begins and ends at 0.
void write_bounds(uint group, uint first, uint end) {
    if (first < end) {
        GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST) = first;
        GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_END) = end;
    }
}

// What each lane has summed.
shared uint lane_sums[girih_lanes];

// Leaves in lane_sums the sum of each lane's own and those of all lanes before it. All lanes of a workgroup together.
void scan_counts(uint own) {
    uint lane = gl_LocalInvocationID.x;
    lane_sums[lane] = own;
    barrier();
    for (uint step = 1u; step < girih_lanes; step *= 2u) {
        uint before = lane >= step ? lane_sums[lane - step] : 0u;
        barrier();
        lane_sums[lane] += before;
        barrier();
    }
}

#ifdef GIRIH_SERIAL

void count_block(uint block) {
    uint counts[GIRIH_MAX_BINS + 1u];
    for (uint digit = 0u; digit < pass.bins; ++digit) {
        counts[digit] = 0u;
    }
    uint end = min((block + 1u) * girih_frame.sort_block, key_count());
    for (uint n = block * girih_frame.sort_block; n < end; ++n) {
        uint digit = digit_or_none(read_key(n));
        counts[digit] = counts[digit] + 1u;
    }
    for (uint digit = 0u; digit < pass.bins; ++digit) {
        GIRIH_AT_COUNTERS(counter_word(block, digit)) = counts[digit];
    }
}

void place_block(uint block) {
    uint next[GIRIH_MAX_BINS + 1u];
    for (uint digit = 0u; digit < pass.bins; ++digit) {
        next[digit] = GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) + GIRIH_AT_COUNTERS(counter_word(block, digit));
    }
    uint end = min((block + 1u) * girih_frame.sort_block, key_count());
    for (uint n = block * girih_frame.sort_block; n < end; ++n) {
        uint key = read_key(n);
        uint digit = digit_or_none(key);
        uint target = next[digit];
        next[digit] = target + 1u;
        if (key != GIRIH_KEY_CULLED) {
            place(n, key, target);
        }
    }
}

#else

shared uint counts[GIRIH_MAX_BINS];

void count_block(uint block) {
    uint lane = gl_LocalInvocationID.x;
    for (uint digit = lane; digit < pass.bins; digit += girih_lanes) {
        counts[digit] = 0u;
    }
    barrier();
    uint end = min((block + 1u) * girih_frame.sort_block, key_count());
    for (uint n = block * girih_frame.sort_block + lane; n < end; n += girih_lanes) {
        uint key = read_key(n);
        if (key != GIRIH_KEY_CULLED) {
            atomicAdd(counts[digit_of(key)], 1u);
        }
    }
    barrier();
    for (uint digit = lane; digit < pass.bins; digit += girih_lanes) {
        GIRIH_AT_COUNTERS(counter_word(block, digit)) = counts[digit];
    }
}

shared uint next[GIRIH_MAX_BINS];
shared uint digits[gl_WorkGroupSize.x];

void place_block(uint block) {
    uint lane = gl_LocalInvocationID.x;
    for (uint digit = lane; digit < pass.bins; digit += girih_lanes) {
        next[digit] = GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) + GIRIH_AT_COUNTERS(counter_word(block, digit));
    }
    uint begin = block * girih_frame.sort_block;
    uint end = min(begin + girih_frame.sort_block, key_count());
    for (uint first = begin; first < end; first += girih_lanes) {
        uint n = first + lane;
        uint key = n < end ? read_key(n) : GIRIH_KEY_CULLED;
        uint digit = key != GIRIH_KEY_CULLED ? digit_of(key) : GIRIH_MAX_BINS;
        barrier();
        digits[lane] = digit;
        barrier();
        // A key's place among those of its row is how many equal digits stand before it.
        uint before = 0u;
        bool last = true;
        for (uint other = 0u; other < girih_lanes; ++other) {
            bool same = digits[other] == digit;
            before += same && other < lane ? 1u : 0u;
            last = last && !(same && other > lane);
        }
        uint base = 0u;
        if (key != GIRIH_KEY_CULLED) {
            base = next[digit];
            place(n, key, base + before);
        }
        barrier();
        if (key != GIRIH_KEY_CULLED && last) {
            next[digit] = base + before + 1u;
        }
    }
}

#endif

// By one lane a digit.
void sum_blocks(uint digit) {
    uint sum = 0u;
    for (uint block = 0u; block < girih_frame.sort_block_count; ++block) {
        uint word = counter_word(block, digit);
        uint count = GIRIH_AT_COUNTERS(word);
        GIRIH_AT_COUNTERS(word) = sum;
        sum += count;
    }
    GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) = sum;
}

// By a workgroup a digit.
void sum_blocks_together(uint digit) {
    uint lane = gl_LocalInvocationID.x;
    uint total = 0u;
    for (uint first = 0u; first < girih_frame.sort_block_count; first += girih_lanes) {
        uint block = first + lane;
        uint count = block < girih_frame.sort_block_count ? GIRIH_AT_COUNTERS(counter_word(block, digit)) : 0u;
        scan_counts(count);
        if (block < girih_frame.sort_block_count) {
            GIRIH_AT_COUNTERS(counter_word(block, digit)) = total + lane_sums[lane] - count;
        }
        total += lane_sums[girih_lanes - 1u];
        barrier();
    }
    if (lane == 0u) {
        GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) = total;
    }
}

// One workgroup: each lane sums a run of digits, the sums of the lanes before it are added, and it walks
// its run again to write.
void sum_digits() {
    uint lane = gl_LocalInvocationID.x;
    uint run = (pass.bins + girih_lanes - 1u) / girih_lanes;
    uint begin = min(lane * run, pass.bins);
    uint end = min(begin + run, pass.bins);
    uint own = 0u;
    for (uint digit = begin; digit < end; ++digit) {
        own += GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit));
    }
    scan_counts(own);
    uint sum = lane_sums[lane] - own;
    for (uint digit = begin; digit < end; ++digit) {
        uint word = counter_word(girih_frame.sort_block_count, digit);
        uint count = GIRIH_AT_COUNTERS(word);
        GIRIH_AT_COUNTERS(word) = sum;
        if (girih_frame.group_count <= pass.bins && digit < girih_frame.group_count) {
            write_bounds(digit, sum, sum + count);
        }
        sum += count;
    }
    if (lane == girih_lanes - 1u) {
        GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS) = sum;
    }
}

void find_bounds(uint group) {
    uint items = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    write_bounds(group, girih_first_item(group, items), girih_first_item(group + 1u, items));
}

// The same from the items: item n, of `items`, writes the bounds that it stands at. Less work than find_bounds where
// items are fewer than groups.
void write_bounds_at(uint n, uint items) {
    uint group = GIRIH_AT_ITEMS(n)[GIRIH_ITEM_KEY] >> 3;
    if (n == 0u || GIRIH_AT_ITEMS(n - 1u)[GIRIH_ITEM_KEY] >> 3 != group) {
        GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST) = n;
    }
    if (n + 1u == items || GIRIH_AT_ITEMS(n + 1u)[GIRIH_ITEM_KEY] >> 3 != group) {
        GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_END) = n + 1u;
    }
}

#endif
