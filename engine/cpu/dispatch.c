// Stage 4 on the CPU: where each group's output begins, whether all of it fits, and the arguments
// of the draws. The only stage that clamps. Twin of glsl/dispatch.glsl; sums that the shader
// carries in two words are 64 bits wide here.
#include <stdbool.h>

#include "scene.h"

typedef struct span {
    uint32_t first, end;
} span;

typedef struct sums {
    uint64_t vertices;
    uint64_t triangles;
    uint32_t draws;
    uint32_t chunks;
    uint32_t groups;
} sums;

// Items of a group as it will be drawn. After an overflow the first group of a material, base
// pattern [0,0,0], takes all of its triangles.
static span group_items(const girih_arrays *arrays, uint32_t group, bool level0) {
    if (!level0) {
        return (span){girih_group_word(arrays, group, GIRIH_GROUP_FIRST),
                      girih_group_word(arrays, group, GIRIH_GROUP_END)};
    }
    if (group % arrays->frame.range_count != 0) {
        return (span){0, 0};
    }
    span all = {UINT32_MAX, 0};
    for (uint32_t n = 0; n < arrays->frame.range_count; ++n) {
        const uint32_t first = girih_group_word(arrays, group + n, GIRIH_GROUP_FIRST);
        const uint32_t end = girih_group_word(arrays, group + n, GIRIH_GROUP_END);
        if (first < end) {
            all.first = first < all.first ? first : all.first;
            all.end = end > all.end ? end : all.end;
        }
    }
    return all.end == 0 ? (span){0, 0} : all;
}

// The numbers of a pattern's vertices before the inner ones of edges 2 and 3 and the interior ones.
static void find_edge_ends(const girih_arrays *arrays, uint32_t rank, uint32_t ends[3]) {
    uint32_t end = 3;
    for (uint32_t n = 0; n < 3; ++n) {
        end += girih_pattern(arrays, rank, GIRIH_PATTERN_SEGMENTS + n) - 1;
        ends[n] = end;
    }
}

// Vertices of a pattern that an item of it adds to the output.
static uint32_t item_vertices(const girih_arrays *arrays, uint32_t rank) {
    const uint32_t vertices = girih_pattern(arrays, rank, GIRIH_PATTERN_VERTICES);
    uint32_t ends[3];
    find_edge_ends(arrays, rank, ends);
    return arrays->frame.output_mode == GIRIH_OUTPUT_WELDED ? vertices - ends[2] : vertices;
}

// What evaluate and output need of the group `group` whose items are drawn as those of group
// `drawn`.
static void write_record(girih_arrays *arrays, uint32_t group, uint32_t drawn,
                         uint32_t first_item) {
    const uint32_t range = drawn % arrays->frame.range_count;
    const uint32_t rank = girih_range_rank(arrays, range);
    const bool mirrored = range != girih_pattern(arrays, rank, GIRIH_PATTERN_RANGE);
    uint32_t *words = arrays->words[GIRIH_BIND_GROUPS] + (size_t)group * GIRIH_GROUP_WORDS;
    words[GIRIH_GROUP_RANK] = rank | (mirrored ? GIRIH_GROUP_MIRRORED : 0u);
    words[GIRIH_GROUP_VERTICES] = girih_pattern(arrays, rank, GIRIH_PATTERN_VERTICES);
    words[GIRIH_GROUP_PATTERN_VERTEX] = girih_pattern(arrays, rank, GIRIH_PATTERN_FIRST_VERTEX);
    words[GIRIH_GROUP_BASE_VERTEX] = girih_group_word(arrays, drawn, GIRIH_GROUP_FIRST_VERTEX) -
                                     first_item * item_vertices(arrays, rank);
    const uint32_t triangles = girih_pattern(arrays, rank, GIRIH_PATTERN_TRIANGLES);
    words[GIRIH_GROUP_BASE_TRIANGLE] =
        girih_group_word(arrays, drawn, GIRIH_GROUP_FIRST_TRIANGLE) - first_item * triangles;
    uint32_t ends[3];
    find_edge_ends(arrays, rank, ends);
    words[GIRIH_GROUP_PATTERN_TRIANGLE] =
        girih_pattern(arrays, rank, GIRIH_PATTERN_FIRST_TRIANGLE) + (mirrored ? triangles : 0);
    words[GIRIH_GROUP_TRIANGLES] = triangles;
    words[GIRIH_GROUP_EDGE_ENDS] = ends[0] | ends[1] << 16;
    words[GIRIH_GROUP_INTERIOR] = ends[2];
}

// Adds what one group adds.
static void add_group(const girih_arrays *arrays, uint32_t group, span items, sums *total) {
    const uint32_t count = items.end - items.first;
    if (count == 0) {
        return;
    }
    const uint32_t rank = girih_range_rank(arrays, group % arrays->frame.range_count);
    const uint32_t replicas = girih_pattern(arrays, rank, GIRIH_PATTERN_REPLICAS);
    total->vertices += (uint64_t)count * item_vertices(arrays, rank);
    total->triangles += (uint64_t)count * girih_pattern(arrays, rank, GIRIH_PATTERN_TRIANGLES);
    total->draws += (count + replicas - 1) / replicas;
    total->chunks += count * (girih_pattern(arrays, rank, GIRIH_PATTERN_CHUNKS) - 1);
    total->groups += 1;
}

static sums sum_groups(const girih_arrays *arrays, bool level0) {
    sums total = {0};
    for (uint32_t group = 0; group < arrays->frame.group_count; ++group) {
        add_group(arrays, group, group_items(arrays, group, level0), &total);
    }
    return total;
}

static void write_instanced_draw(girih_arrays *arrays, uint32_t group, uint32_t rank, span items) {
    const bool mirror =
        group % arrays->frame.range_count != girih_pattern(arrays, rank, GIRIH_PATTERN_RANGE);
    uint32_t *draw = arrays->words[GIRIH_BIND_DRAWS] + (size_t)group * GIRIH_DRAW_WORDS;
    draw[0] = 3 * girih_pattern(arrays, rank, GIRIH_PATTERN_TRIANGLES);
    draw[1] = items.end - items.first;
    draw[2] = girih_pattern(arrays, rank,
                            mirror ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
    draw[3] = girih_pattern(arrays, rank, GIRIH_PATTERN_FIRST_VERTEX);
    draw[4] = items.first;
}

// Where each group's output begins. The groups' bounds stay as they are: level 0 reads those of all
// of a material's groups.
static void write_groups(girih_arrays *arrays, bool level0, uint64_t border) {
    const girih_frame_block *frame = &arrays->frame;
    uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
    sums before = {0};
    for (uint32_t group = 0; group < frame->group_count; ++group) {
        const span items = group_items(arrays, group, level0);
        uint32_t *words = arrays->words[GIRIH_BIND_GROUPS] + (size_t)group * GIRIH_GROUP_WORDS;
        words[GIRIH_GROUP_FIRST_VERTEX] = (uint32_t)(before.vertices + border);
        words[GIRIH_GROUP_FIRST_TRIANGLE] = (uint32_t)before.triangles;
        words[GIRIH_GROUP_FIRST_DRAW] = before.draws;
        words[GIRIH_GROUP_FIRST_CHUNK] = before.chunks;
        const uint32_t range = group % frame->range_count;
        if (range == 0) {
            status[GIRIH_STATUS_WORDS + frame->pattern_count + group / frame->range_count] =
                (uint32_t)before.triangles;
        }
        if (items.end == items.first) {
            continue;
        }
        if (!level0) {
            write_record(arrays, group, group, items.first);
        }
        const uint32_t rank = girih_range_rank(arrays, range);
        status[GIRIH_STATUS_WORDS + rank] = 1;
        if (frame->output_mode == GIRIH_OUTPUT_INSTANCED && frame->draws_per_material != 0) {
            write_instanced_draw(arrays, group, rank, items);
        }
        add_group(arrays, group, items, &before);
    }
}

// After an overflow all of a material's triangles stand in its first group.
static void merge_groups(girih_arrays *arrays) {
    const girih_frame_block *frame = &arrays->frame;
    for (uint32_t material = 0; material < frame->material_count; ++material) {
        const uint32_t group = material * frame->range_count;
        const span items = group_items(arrays, group, true);
        uint32_t *words = arrays->words[GIRIH_BIND_GROUPS] + (size_t)group * GIRIH_GROUP_WORDS;
        for (uint32_t n = 0; n < frame->range_count; ++n, words += GIRIH_GROUP_WORDS) {
            words[GIRIH_GROUP_FIRST] = n == 0 ? items.first : items.end;
            words[GIRIH_GROUP_END] = items.end;
            write_record(arrays, group + n, group, items.first);
        }
    }
}

static void write_dispatch(uint32_t arguments[3], uint32_t invocations) {
    const uint32_t workgroups = (invocations + GIRIH_WORKGROUP - 1) / GIRIH_WORKGROUP;
    const uint32_t rows = (workgroups + 65534) / 65535;
    arguments[0] = rows > 1 ? 65535 : workgroups;
    arguments[1] = rows;
    arguments[2] = 1;
}

// The first item that adds vertices to the output, as the groups are drawn.
static uint32_t find_first_interior(const girih_arrays *arrays) {
    for (uint32_t group = 0; group < arrays->frame.group_count; ++group) {
        const uint32_t first = girih_group_word(arrays, group, GIRIH_GROUP_FIRST);
        const uint32_t rank = girih_range_rank(arrays, group % arrays->frame.range_count);
        if (first != girih_group_word(arrays, group, GIRIH_GROUP_END) &&
            item_vertices(arrays, rank) != 0) {
            return first;
        }
    }
    return arrays->words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS];
}

static void write_status(girih_arrays *arrays, const sums *total, uint64_t vertices) {
    const girih_frame_block *frame = &arrays->frame;
    uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
    uint32_t *words =
        arrays->words[GIRIH_BIND_GROUPS] + (size_t)frame->group_count * GIRIH_GROUP_WORDS;
    words[GIRIH_GROUP_FIRST] = status[GIRIH_STATUS_ITEMS];
    words[GIRIH_GROUP_END] = status[GIRIH_STATUS_ITEMS];
    words[GIRIH_GROUP_FIRST_VERTEX] = (uint32_t)vertices;
    words[GIRIH_GROUP_FIRST_TRIANGLE] = (uint32_t)total->triangles;
    words[GIRIH_GROUP_FIRST_DRAW] = total->draws;
    words[GIRIH_GROUP_FIRST_CHUNK] = total->chunks;
    status[GIRIH_STATUS_VERTICES] = (uint32_t)vertices;
    status[GIRIH_STATUS_TRIANGLES] = (uint32_t)total->triangles;
    status[GIRIH_STATUS_GROUPS] = total->groups;
    status[GIRIH_STATUS_CHUNKS] = total->chunks;
    status[GIRIH_STATUS_WORDS + frame->pattern_count + frame->material_count] =
        (uint32_t)total->triangles;
    uint32_t patterns = 0;
    for (uint32_t rank = 0; rank < frame->pattern_count; ++rank) {
        patterns += status[GIRIH_STATUS_WORDS + rank];
    }
    status[GIRIH_STATUS_PATTERNS] = patterns;
    // Patches are written one item an invocation; vertices and triangles one chunk an invocation.
    uint32_t invocations = status[GIRIH_STATUS_ITEMS];
    if (frame->output_mode != GIRIH_OUTPUT_INSTANCED) {
        invocations += total->chunks;
    }
    const uint32_t first_interior = find_first_interior(arrays);
    write_dispatch(status + GIRIH_STATUS_EVALUATE, invocations);
    write_dispatch(status + GIRIH_STATUS_INTERIOR, invocations - first_interior);
    status[GIRIH_STATUS_FIRST_INTERIOR] = first_interior;
}

// The arguments of the baked draw `slot`. A group of C triangles whose pattern's indices are
// replicated R times is drawn by ceil(C / R) draws, each with its own vertex offset; what is left
// of a material's draws is empty.
static void write_baked_draw(girih_arrays *arrays, uint32_t slot) {
    const girih_frame_block *frame = &arrays->frame;
    const uint32_t material = slot / frame->draws_per_material;
    uint32_t low = material * frame->range_count;
    uint32_t high = low + frame->range_count;
    const uint32_t draw =
        girih_group_word(arrays, low, GIRIH_GROUP_FIRST_DRAW) + slot % frame->draws_per_material;
    uint32_t *arguments = arrays->words[GIRIH_BIND_DRAWS] + (size_t)slot * GIRIH_DRAW_WORDS;
    if (frame->pattern_draws == 0) {
        const uint32_t first = girih_group_word(arrays, low, GIRIH_GROUP_FIRST_TRIANGLE);
        const uint32_t end = girih_group_word(arrays, high, GIRIH_GROUP_FIRST_TRIANGLE);
        arguments[0] = 3 * (end - first);
        arguments[1] = 1;
        arguments[2] = 3 * first;
        return;
    }
    if (draw >= girih_group_word(arrays, high, GIRIH_GROUP_FIRST_DRAW)) {
        return;
    }
    // The last group whose first draw is not beyond this one; empty groups share their successor's.
    while (high - low > 1) {
        const uint32_t middle = (low + high) / 2;
        if (girih_group_word(arrays, middle, GIRIH_GROUP_FIRST_DRAW) <= draw) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const uint32_t range = low % frame->range_count;
    const uint32_t rank = girih_range_rank(arrays, range);
    const uint32_t replicas = girih_pattern(arrays, rank, GIRIH_PATTERN_REPLICAS);
    const uint32_t first =
        (draw - girih_group_word(arrays, low, GIRIH_GROUP_FIRST_DRAW)) * replicas;
    const uint32_t left = girih_group_word(arrays, low, GIRIH_GROUP_END) -
                          girih_group_word(arrays, low, GIRIH_GROUP_FIRST) - first;
    const uint32_t count = replicas < left ? replicas : left;
    const bool mirror = range != girih_pattern(arrays, rank, GIRIH_PATTERN_RANGE);
    arguments[0] = count * 3 * girih_pattern(arrays, rank, GIRIH_PATTERN_TRIANGLES);
    arguments[1] = 1;
    arguments[2] = girih_pattern(arrays, rank,
                                 mirror ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
    arguments[3] = girih_group_word(arrays, low, GIRIH_GROUP_FIRST_VERTEX) +
                   first * girih_pattern(arrays, rank, GIRIH_PATTERN_VERTICES);
}

void girih_twin_dispatch(girih_arrays *arrays) {
    const girih_frame_block *frame = &arrays->frame;
    uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
    const bool welded = frame->output_mode == GIRIH_OUTPUT_WELDED;
    uint64_t border = 0;
    if (welded) {
        border = frame->corner_count + ((uint64_t)status[GIRIH_STATUS_WELD_VERTICES + 1] << 32 |
                                        status[GIRIH_STATUS_WELD_VERTICES]);
    }
    sums total = sum_groups(arrays, false);
    uint64_t vertices = total.vertices + border;
    const uint32_t no_parts = status[GIRIH_STATUS_FLAGS] & GIRIH_STATUS_SPLIT_OVERFLOW;
    const bool level0 =
        no_parts != 0 || total.triangles > frame->max_triangles ||
        (frame->output_mode != GIRIH_OUTPUT_INSTANCED && vertices > frame->max_vertices);
    status[GIRIH_STATUS_NEEDED_VERTICES] = (uint32_t)vertices;
    status[GIRIH_STATUS_NEEDED_VERTICES + 1] = (uint32_t)(vertices >> 32);
    status[GIRIH_STATUS_NEEDED_TRIANGLES] = (uint32_t)total.triangles;
    status[GIRIH_STATUS_NEEDED_TRIANGLES + 1] = (uint32_t)(total.triangles >> 32);
    status[GIRIH_STATUS_FLAGS] = no_parts | (level0 ? GIRIH_STATUS_OVERFLOW : 0);
    if (level0) {
        total = sum_groups(arrays, true);
        border = welded ? frame->corner_count : 0;
        vertices = total.vertices + border;
    }
    if (frame->draws_per_material) {
        // What is not drawn is there nevertheless, empty.
        memset(arrays->words[GIRIH_BIND_DRAWS], 0,
               (size_t)arrays->count[GIRIH_BIND_DRAWS] * sizeof(uint32_t));
    }
    write_groups(arrays, level0, border);
    if (level0) {
        merge_groups(arrays);
    }
    write_status(arrays, &total, vertices);
    if (frame->output_mode != GIRIH_OUTPUT_INSTANCED) {
        for (uint32_t slot = 0; slot < frame->draws_per_material * frame->material_count; ++slot) {
            write_baked_draw(arrays, slot);
        }
    }
}
