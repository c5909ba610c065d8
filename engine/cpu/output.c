// Stage 6 on the CPU: index lists of the baked and welded modes, and before them the numbers of the
// welded vertices inside shared edges. Twin of glsl/output.comp.
#include "item.h"

// Indices of the pattern's from `first` on, each with `base` added.
static void copy_indices(const girih_arrays *arrays, uint32_t first, uint32_t count, uint32_t base,
                         uint32_t *restrict out) {
    const uint32_t *restrict indices = arrays->words[GIRIH_BIND_PATTERN_INDICES] + first;
    for (uint32_t n = 0; n < count; ++n) {
        out[n] = base + indices[n];
    }
}

static void write_triangles(girih_arrays *arrays, uint32_t number, uint32_t outputs) {
    const girih_item item = girih_read_item(arrays, number);
    const uint32_t count = girih_pattern(arrays, item.rank, GIRIH_PATTERN_TRIANGLES);
    const uint32_t first =
        girih_group_word(arrays, item.group, GIRIH_GROUP_BASE_TRIANGLE) + number * count;
    const bool welded = arrays->frame.output_mode == GIRIH_OUTPUT_WELDED;
    const bool closed = (outputs & GIRIH_OUTPUT_BIT_CLOSED_INDICES) != 0;
    uint32_t first_vertex = 0;
    girih_weld weld = {{0}, {0}, {false}, {0}, 0};
    girih_weld closed_weld = weld;
    if (welded) {
        uint32_t vertices[3];
        girih_item_vertices(arrays, &item, vertices);
        weld = girih_item_weld(arrays, &item, vertices, false);
        if (closed) {
            closed_weld = girih_item_weld(arrays, &item, vertices, true);
        }
    } else {
        first_vertex = girih_group_word(arrays, item.group, GIRIH_GROUP_BASE_VERTEX) +
                       number * girih_group_word(arrays, item.group, GIRIH_GROUP_VERTICES);
    }
    const uint32_t first_index =
        girih_pattern(arrays, item.rank,
                      item.mirrored ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
    for (uint32_t triangle = 0; triangle < count; ++triangle) {
        const size_t slot = (size_t)first + triangle;
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t n = girih_pattern_index(arrays, first_index + 3 * triangle + corner);
            if ((outputs & GIRIH_OUTPUT_BIT_INDICES) != 0) {
                arrays->words[GIRIH_BIND_OUT_INDICES][3 * slot + corner] =
                    welded ? girih_weld_vertex(&weld, n) : first_vertex + n;
            }
            if (closed) {
                arrays->words[GIRIH_BIND_OUT_CLOSED_INDICES][3 * slot + corner] =
                    girih_weld_vertex(&closed_weld, n);
            }
        }
        if ((outputs & GIRIH_OUTPUT_BIT_SOURCES) != 0) {
            uint32_t *source = arrays->words[GIRIH_BIND_OUT_SOURCES] + 2 * slot;
            source[0] = item.instance;
            source[1] = item.scene_triangle -
                        girih_instance_word(arrays, item.instance, GIRIH_INSTANCE_MESH_TRIANGLE);
        }
    }
}

// The indices of consecutive items of one group: the pattern's replicas, as far as they go.
static void write_replicas(girih_arrays *arrays, const girih_item *item, uint32_t count) {
    const uint32_t triangles = girih_pattern(arrays, item->rank, GIRIH_PATTERN_TRIANGLES);
    const uint32_t vertices = girih_group_word(arrays, item->group, GIRIH_GROUP_VERTICES);
    const uint32_t replicas = girih_pattern(arrays, item->rank, GIRIH_PATTERN_REPLICAS);
    const uint32_t first_index =
        girih_pattern(arrays, item->rank,
                      item->mirrored ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX);
    for (uint32_t done = 0; done < count; done += replicas) {
        const uint32_t number = item->number + done;
        const uint32_t items = count - done < replicas ? count - done : replicas;
        const uint32_t first_vertex =
            girih_group_word(arrays, item->group, GIRIH_GROUP_BASE_VERTEX) + number * vertices;
        const uint32_t first_triangle =
            girih_group_word(arrays, item->group, GIRIH_GROUP_BASE_TRIANGLE) + number * triangles;
        copy_indices(arrays, first_index, 3 * items * triangles, first_vertex,
                     arrays->words[GIRIH_BIND_OUT_INDICES] + 3 * (size_t)first_triangle);
    }
}

void girih_twin_output(girih_arrays *arrays, uint32_t outputs) {
    const uint32_t items = girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_ITEMS);
    const uint32_t lists = outputs & (GIRIH_OUTPUT_BIT_INDICES | GIRIH_OUTPUT_BIT_CLOSED_INDICES |
                                      GIRIH_OUTPUT_BIT_SOURCES);
    if (arrays->frame.output_mode != GIRIH_OUTPUT_WELDED && lists == GIRIH_OUTPUT_BIT_INDICES) {
        for (uint32_t number = 0, count; number < items; number += count) {
            const girih_item item = girih_read_item(arrays, number);
            const uint32_t *item_words =
                arrays->words[GIRIH_BIND_ITEMS] + (size_t)number * GIRIH_ITEM_WORDS;
            count = 1;
            while (number + count < items &&
                   item_words[count * GIRIH_ITEM_WORDS + GIRIH_ITEM_KEY] >> 3 == item.group) {
                ++count;
            }
            write_replicas(arrays, &item, count);
        }
        return;
    }
    for (uint32_t number = 0; number < items; ++number) {
        write_triangles(arrays, number, outputs);
    }
}

// Output vertices inside the plan's weld edge.
static uint32_t inner_vertices(const girih_arrays *arrays, uint32_t weld_edge) {
    const uint32_t instance = girih_find_instance(arrays, weld_edge, GIRIH_INSTANCE_FIRST_WELD_EDGE,
                                                  arrays->frame.weld_blocks);
    const uint32_t scene_weld_edge =
        weld_edge - girih_instance_word(arrays, instance, GIRIH_INSTANCE_WELD_DELTA);
    const uint32_t level =
        girih_word(arrays, GIRIH_BIND_LEVELS,
                   girih_word(arrays, GIRIH_BIND_WELD_EDGES, 2 * (size_t)scene_weld_edge) +
                       girih_instance_word(arrays, instance, GIRIH_INSTANCE_EDGE_DELTA));
    return arrays->frame.linear_spacing != 0 ? level : (1u << level) - 1;
}

void girih_twin_weld(girih_arrays *arrays) {
    uint32_t *offsets = arrays->words[GIRIH_BIND_WELD_OFFSETS];
    uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
    uint64_t sum = 0;
    for (uint32_t n = 0; n < arrays->frame.weld_edge_count; ++n) {
        offsets[n] = (uint32_t)sum;
        sum += inner_vertices(arrays, n);
    }
    status[GIRIH_STATUS_WELD_VERTICES] = (uint32_t)sum;
    status[GIRIH_STATUS_WELD_VERTICES + 1] = (uint32_t)(sum >> 32);
}
