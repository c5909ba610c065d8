// Stage 3: the triangles that were not culled, sorted by (material, range) and within a group in input
// order: a stable counting sort, so that the same input gives the same bytes whatever the timing.
//
// Keys are sorted digit by digit, the lowest first, as many digits as the number of groups needs. Each
// block of sort_block keys counts its digits (GIRIH_KERNEL 0); the counts are summed over the blocks
// (1) and over the digits (2); each block then places its keys (3). Where one digit is enough, its sums
// are the groups' bounds; else each group looks its bounds up in the sorted keys (4).
//
// Two ways to walk a block, with the same result: one lane alone (GIRIH_SERIAL), best where lanes are
// few and memory is near, or a workgroup, ranking its keys against each other in shared memory.
#version 450
#extension GL_GOOGLE_include_directive : require

#ifdef GIRIH_SERIAL
#define GIRIH_LOCAL_SIZE 8
#else
#define GIRIH_LOCAL_SIZE 128
#endif
#include "arrays.glsl"

const uint lanes = gl_WorkGroupSize.x;

uint key_count() {
    return girih_push.first_pass != 0u ? girih_frame.triangle_count : GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
}

uint read_key(uint n) {
    if (girih_push.first_pass != 0u) {
        return GIRIH_AT_KEYS(n);
    }
    return girih_push.to_spare != 0u ? GIRIH_AT_ITEMS(n)[GIRIH_ITEM_KEY] : GIRIH_AT_ITEMS_SPARE(n)[GIRIH_ITEM_KEY];
}

uint digit_of(uint key) {
    return ((key >> 3) >> girih_push.shift) & (girih_push.bins - 1u);
}

void place(uint n, uint key, uint target) {
    uvec2 item;
    item[GIRIH_ITEM_TRIANGLE] = n;
    if (girih_push.first_pass == 0u) {
        item = girih_push.to_spare != 0u ? GIRIH_AT_ITEMS(n) : GIRIH_AT_ITEMS_SPARE(n);
    }
    item[GIRIH_ITEM_KEY] = key;
    if (girih_push.to_spare != 0u) {
        GIRIH_AT_ITEMS_SPARE(target) = item;
    } else {
        GIRIH_AT_ITEMS(target) = item;
    }
}

// Culled keys count as a digit beyond all others: cheaper than a branch where lanes run in step.
uint digit_or_none(uint key) {
    return key != GIRIH_KEY_CULLED ? digit_of(key) : GIRIH_MAX_BINS;
}

// COUNTERS: a row of `bins` counters for every block, then a row of the digits' totals.
uint counter_word(uint block, uint digit) {
    return block * girih_push.bins + digit;
}

// The groups were cleared to 0, so that an empty one begins and ends at 0.
void write_bounds(uint group, uint first, uint end) {
    if (first < end) {
        GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST) = first;
        GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + GIRIH_GROUP_END) = end;
    }
}

#if GIRIH_KERNEL == 0 && defined(GIRIH_SERIAL)

void main() {
    uint block = girih_invocation();
    if (block >= girih_frame.sort_block_count) {
        return;
    }
    uint counts[GIRIH_MAX_BINS + 1u];
    for (uint digit = 0u; digit < girih_push.bins; ++digit) {
        counts[digit] = 0u;
    }
    uint end = min((block + 1u) * girih_frame.sort_block, key_count());
    for (uint n = block * girih_frame.sort_block; n < end; ++n) {
        uint digit = digit_or_none(read_key(n));
        counts[digit] = counts[digit] + 1u;
    }
    for (uint digit = 0u; digit < girih_push.bins; ++digit) {
        GIRIH_AT_COUNTERS(counter_word(block, digit)) = counts[digit];
    }
}

#elif GIRIH_KERNEL == 0

shared uint counts[GIRIH_MAX_BINS];

void main() {
    uint block = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    if (block >= girih_frame.sort_block_count) {
        return;
    }
    for (uint digit = lane; digit < girih_push.bins; digit += lanes) {
        counts[digit] = 0u;
    }
    barrier();
    uint end = min((block + 1u) * girih_frame.sort_block, key_count());
    for (uint n = block * girih_frame.sort_block + lane; n < end; n += lanes) {
        uint key = read_key(n);
        if (key != GIRIH_KEY_CULLED) {
            atomicAdd(counts[digit_of(key)], 1u);
        }
    }
    barrier();
    for (uint digit = lane; digit < girih_push.bins; digit += lanes) {
        GIRIH_AT_COUNTERS(counter_word(block, digit)) = counts[digit];
    }
}

#elif GIRIH_KERNEL == 1 && defined(GIRIH_SERIAL)

void main() {
    uint digit = girih_invocation();
    if (digit >= girih_push.bins) {
        return;
    }
    uint sum = 0u;
    // Two loops, because lavapipe ends a shader's loop after 65,535 turns.
    for (uint first = 0u; first < girih_frame.sort_block_count; first += 32768u) {
        uint end = min(first + 32768u, girih_frame.sort_block_count);
        for (uint block = first; block < end; ++block) {
            uint word = counter_word(block, digit);
            uint count = GIRIH_AT_COUNTERS(word);
            GIRIH_AT_COUNTERS(word) = sum;
            sum += count;
        }
    }
    GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) = sum;
}

#elif GIRIH_KERNEL == 1

shared uint sums[gl_WorkGroupSize.x];

void main() {
    uint digit = gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    uint total = 0u;
    for (uint first = 0u; first < girih_frame.sort_block_count; first += lanes) {
        uint block = first + lane;
        uint count = block < girih_frame.sort_block_count ? GIRIH_AT_COUNTERS(counter_word(block, digit)) : 0u;
        sums[lane] = count;
        barrier();
        for (uint step = 1u; step < lanes; step *= 2u) {
            uint before = lane >= step ? sums[lane - step] : 0u;
            barrier();
            sums[lane] += before;
            barrier();
        }
        if (block < girih_frame.sort_block_count) {
            GIRIH_AT_COUNTERS(counter_word(block, digit)) = total + sums[lane] - count;
        }
        total += sums[lanes - 1u];
        barrier();
    }
    if (lane == 0u) {
        GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) = total;
    }
}

#elif GIRIH_KERNEL == 2

shared uint sums[gl_WorkGroupSize.x];

// One workgroup: each lane sums a run of digits, the sums of the lanes before it are added, and it walks
// its run again to write.
void main() {
    uint lane = gl_LocalInvocationID.x;
    uint run = (girih_push.bins + lanes - 1u) / lanes;
    uint begin = min(lane * run, girih_push.bins);
    uint end = min(begin + run, girih_push.bins);
    uint own = 0u;
    for (uint digit = begin; digit < end; ++digit) {
        own += GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit));
    }
    sums[lane] = own;
    barrier();
    for (uint step = 1u; step < lanes; step *= 2u) {
        uint before = lane >= step ? sums[lane - step] : 0u;
        barrier();
        sums[lane] += before;
        barrier();
    }
    uint sum = sums[lane] - own;
    for (uint digit = begin; digit < end; ++digit) {
        uint word = counter_word(girih_frame.sort_block_count, digit);
        uint count = GIRIH_AT_COUNTERS(word);
        GIRIH_AT_COUNTERS(word) = sum;
        if (girih_frame.group_count <= girih_push.bins && digit < girih_frame.group_count) {
            write_bounds(digit, sum, sum + count);
        }
        sum += count;
    }
    if (lane == lanes - 1u) {
        GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS) = sum;
    }
}

#elif GIRIH_KERNEL == 3 && defined(GIRIH_SERIAL)

void main() {
    uint block = girih_invocation();
    if (block >= girih_frame.sort_block_count) {
        return;
    }
    uint next[GIRIH_MAX_BINS + 1u];
    for (uint digit = 0u; digit < girih_push.bins; ++digit) {
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

#elif GIRIH_KERNEL == 3

shared uint next[GIRIH_MAX_BINS];
shared uint digits[gl_WorkGroupSize.x];

void main() {
    uint block = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    if (block >= girih_frame.sort_block_count) {
        return;
    }
    for (uint digit = lane; digit < girih_push.bins; digit += lanes) {
        next[digit] = GIRIH_AT_COUNTERS(counter_word(girih_frame.sort_block_count, digit)) + GIRIH_AT_COUNTERS(counter_word(block, digit));
    }
    uint begin = block * girih_frame.sort_block;
    uint end = min(begin + girih_frame.sort_block, key_count());
    for (uint first = begin; first < end; first += lanes) {
        uint n = first + lane;
        uint key = n < end ? read_key(n) : GIRIH_KEY_CULLED;
        uint digit = key != GIRIH_KEY_CULLED ? digit_of(key) : GIRIH_MAX_BINS;
        barrier();
        digits[lane] = digit;
        barrier();
        // A key's place among those of its row is how many equal digits stand before it.
        uint before = 0u;
        bool last = true;
        for (uint other = 0u; other < lanes; ++other) {
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

#else

// The first item whose group is not before `group`.
uint lower_bound(uint group, uint items) {
    uint low = 0u;
    uint high = items;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (GIRIH_AT_ITEMS(middle)[GIRIH_ITEM_KEY] >> 3 < group) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

void main() {
    uint group = girih_invocation();
    if (group >= girih_frame.group_count) {
        return;
    }
    uint items = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    write_bounds(group, lower_bound(group, items), lower_bound(group + 1u, items));
}

#endif
