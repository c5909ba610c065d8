// Stage 3 on the CPU: the triangles that were not culled, sorted by (material, range) and within a
// group in input order. The counterpart of glsl/group.glsl: one counting sort over all groups gives
// what its passes over the digits give, because both are stable.
#include <inttypes.h>

#include "../error.h"
#include "../memory.h"
#include "scene.h"

// The key of a triangle or a part; of one that is split only where its parts found no room.
static uint32_t read_key(const girih_arrays *arrays, uint32_t n) {
    const uint32_t key = arrays->words[GIRIH_BIND_KEYS][n];
    if (key < GIRIH_KEY_SPLIT || key == GIRIH_KEY_CULLED) {
        return key;
    }
    const uint32_t flags = arrays->words[GIRIH_BIND_STATUS][GIRIH_STATUS_FLAGS];
    return (flags & GIRIH_STATUS_SPLIT_OVERFLOW) != 0 ? key ^ GIRIH_KEY_SPLIT : GIRIH_KEY_CULLED;
}

girih_result girih_twin_group(girih_arrays *arrays, girih_error *error) {
    const girih_frame_block *frame = &arrays->frame;
    uint32_t *items = arrays->words[GIRIH_BIND_ITEMS];
    uint32_t *groups = arrays->words[GIRIH_BIND_GROUPS];
    uint32_t *next = girih_allocate_array(frame->group_count, sizeof *next);
    if (!next) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "no memory to sort into %" PRIu32 " groups", frame->group_count);
    }
    memset(groups, 0, (size_t)arrays->count[GIRIH_BIND_GROUPS] * sizeof *groups);
    memset(next, 0, (size_t)frame->group_count * sizeof *next);
    const uint32_t key_count =
        frame->triangle_count + arrays->words[GIRIH_BIND_STATUS][GIRIH_STATUS_SPLITS];
    for (uint32_t n = 0; n < key_count; ++n) {
        const uint32_t key = read_key(arrays, n);
        if (key != GIRIH_KEY_CULLED) {
            ++next[key >> 3];
        }
    }
    uint32_t sum = 0;
    for (uint32_t group = 0; group < frame->group_count; ++group) {
        const uint32_t count = next[group];
        next[group] = sum;
        if (count > 0) {
            // An empty group begins and ends at 0.
            groups[(size_t)group * GIRIH_GROUP_WORDS + GIRIH_GROUP_FIRST] = sum;
            groups[(size_t)group * GIRIH_GROUP_WORDS + GIRIH_GROUP_END] = sum + count;
        }
        sum += count;
    }
    for (uint32_t n = 0; n < key_count; ++n) {
        const uint32_t key = read_key(arrays, n);
        if (key != GIRIH_KEY_CULLED) {
            uint32_t *item = items + (size_t)next[key >> 3]++ * GIRIH_ITEM_WORDS;
            item[GIRIH_ITEM_TRIANGLE] = n;
            item[GIRIH_ITEM_KEY] = key;
            if (n >= frame->triangle_count) {
                const size_t part = n - frame->triangle_count;
                arrays->words[GIRIH_BIND_SPLITS][part * GIRIH_SPLIT_WORDS + GIRIH_SPLIT_ITEM] =
                    (uint32_t)(item - items) / GIRIH_ITEM_WORDS + 1;
            }
        }
    }
    arrays->words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS] = sum;
    girih_free(next);
    return GIRIH_OK;
}
