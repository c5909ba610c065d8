// A plan's instances, and the sizes of all it writes.
#include "pack.h"

#include <inttypes.h>
#include <math.h>

#include "error.h"

// A key is a group's number and three bits of lambda, and GROUPS is numbered by words of 32 bits.
#define MAX_GROUPS (UINT64_C(1) << 28)
#define MIN_SORT_BLOCK 128u
// As many blocks as keep the lanes of a CPU device busy where one lane walks a block. Each has
// counters of its own, so more of them cost more than they save.
#define SORT_BLOCKS_WANTED 128u
#define MAX_INSTANCES (UINT32_MAX / GIRIH_INSTANCE_WORDS - 1)

// --- Transforms --------------------------------------------------------------------------------

// -0 stored as +0, so that sums of vanishing products have one sign.
static void write_float(uint32_t *word, float value) {
    *word = value == 0.0f ? 0u : girih_to_word(value);
}

static void pack_transform(uint32_t *record, const float transform[12]) {
    double row[3][3];
    for (int n = 0; n < 12; ++n) {
        write_float(record + GIRIH_INSTANCE_TRANSFORM + n, transform[n]);
        if (n % 4 < 3) {
            row[n / 4][n % 4] = (double)transform[n];
        }
    }
    // The rows of the inverse transpose times the determinant are the cross products of the others.
    double cofactor[3][3];
    double largest = 0.0;
    for (int n = 0; n < 3; ++n) {
        const double *a = row[(n + 1) % 3];
        const double *b = row[(n + 2) % 3];
        for (int axis = 0; axis < 3; ++axis) {
            const int y = (axis + 1) % 3;
            const int z = (axis + 2) % 3;
            cofactor[n][axis] = a[y] * b[z] - a[z] * b[y];
            largest = fmax(largest, fabs(cofactor[n][axis]));
        }
    }
    const double determinant =
        (row[0][0] * cofactor[0][0] + row[0][1] * cofactor[0][1]) + row[0][2] * cofactor[0][2];
    // Only the direction counts. A power of two brings the largest element to [1, 2) without
    // rounding, so the identity stays the identity.
    int exponent = 0;
    frexp(largest, &exponent);
    const double scale = ldexp(determinant < 0.0 ? -1.0 : 1.0, largest > 0.0 ? 1 - exponent : 0);
    for (int n = 0; n < 9; ++n) {
        write_float(record + GIRIH_INSTANCE_NORMAL + 4 * (n / 3) + n % 3,
                    (float)(cofactor[n / 3][n % 3] * scale));
    }
    record[GIRIH_INSTANCE_FLAGS] = determinant < 0.0 ? GIRIH_INSTANCE_MIRRORED : 0u;
    write_float(record + GIRIH_INSTANCE_SCALE, (float)cbrt(fabs(determinant)));
}

void girih_pack_transform(uint32_t *record, const float transform[12], const float *previous) {
    pack_transform(record, transform);
    pack_transform(record + GIRIH_INSTANCE_PREVIOUS, previous ? previous : transform);
}

girih_result girih_check_transform(const float transform[12], uint32_t instance,
                                   girih_error *error) {
    for (int n = 0; n < 12; ++n) {
        // Written so that a NaN fails it too.
        if (!(fabsf(transform[n]) <= GIRIH_MAX_COORDINATE)) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "plan: element %d of instance %" PRIu32
                              "'s transform is %g; it must be finite and at most %g",
                              n, instance, (double)transform[n], (double)GIRIH_MAX_COORDINATE);
        }
    }
    return GIRIH_OK;
}

// --- Instances ---------------------------------------------------------------------------------

typedef struct totals {
    uint64_t triangles, edges, weld_edges, corners;
} totals;

static girih_result check_instances(totals *sums, const girih_scene_table *table,
                                    const girih_instance *instances, uint32_t instance_count,
                                    girih_error *error) {
    if (instance_count > MAX_INSTANCES) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %" PRIu32 " instances, at most %" PRIu32 " can be numbered",
                          instance_count, MAX_INSTANCES);
    }
    for (uint32_t n = 0; n < instance_count; ++n) {
        if (instances[n].mesh >= table->mesh_count) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "plan: instance %" PRIu32 " is of mesh %" PRIu32
                              ", the scene has %" PRIu32,
                              n, instances[n].mesh, table->mesh_count);
        }
        girih_result result = girih_check_transform(instances[n].transform, n, error);
        if (result != GIRIH_OK) {
            return result;
        }
        const girih_scene_mesh *mesh = &table->meshes[instances[n].mesh];
        sums->triangles += mesh->triangle_count;
        sums->edges += mesh->edge_count;
        sums->weld_edges += mesh->weld_edge_count;
        sums->corners += mesh->vertex_count;
    }
    if (sums->triangles > GIRIH_MAX_COUNT || sums->edges > GIRIH_MAX_COUNT ||
        sums->weld_edges > GIRIH_MAX_COUNT) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: its instances have %" PRIu64 " triangles with %" PRIu64
                          " edges and %" PRIu64 " weld edges; at most %" PRIu64
                          " of each can be numbered",
                          sums->triangles, sums->edges, sums->weld_edges, GIRIH_MAX_COUNT);
    }
    return GIRIH_OK;
}

static void write_instances(uint32_t *records, const girih_scene_table *table,
                            const girih_instance *instances, uint32_t instance_count, int welded) {
    uint32_t triangle = 0;
    uint32_t edge = 0;
    uint32_t weld_edge = 0;
    uint32_t corner = 0;
    uint32_t *record = records;
    for (uint32_t n = 0; n < instance_count; ++n, record += GIRIH_INSTANCE_WORDS) {
        const girih_scene_mesh *mesh = &table->meshes[instances[n].mesh];
        girih_pack_transform(record, instances[n].transform, NULL);
        record[GIRIH_INSTANCE_FIRST_TRIANGLE] = triangle;
        record[GIRIH_INSTANCE_FIRST_EDGE] = edge;
        record[GIRIH_INSTANCE_FIRST_WELD_EDGE] = weld_edge;
        record[GIRIH_INSTANCE_FIRST_CORNER] = corner;
        record[GIRIH_INSTANCE_TRIANGLE_DELTA] = triangle - mesh->first_triangle;
        record[GIRIH_INSTANCE_EDGE_DELTA] = edge - mesh->first_edge;
        record[GIRIH_INSTANCE_WELD_DELTA] = weld_edge - mesh->first_weld_edge;
        record[GIRIH_INSTANCE_VERTEX_DELTA] = welded ? corner - mesh->first_vertex : 0;
        record[GIRIH_INSTANCE_SEAM_DELTA] = mesh->first_seam - mesh->first_edge;
        record[GIRIH_INSTANCE_MESH_TRIANGLE] = mesh->first_triangle;
        triangle += mesh->triangle_count;
        edge += mesh->edge_count;
        weld_edge += mesh->weld_edge_count;
        corner += welded ? mesh->vertex_count : 0;
    }
    record[GIRIH_INSTANCE_FIRST_TRIANGLE] = triangle;
    record[GIRIH_INSTANCE_FIRST_EDGE] = edge;
    record[GIRIH_INSTANCE_FIRST_WELD_EDGE] = weld_edge;
    record[GIRIH_INSTANCE_FIRST_CORNER] = corner;
}

// The instance of each GIRIH_BLOCK-th number out of count; `first` is the field with an instance's
// first one. Instances without numbers are stepped over.
static void write_blocks(uint32_t *blocks, const uint32_t *records, uint32_t first,
                         uint32_t count) {
    uint32_t instance = 0;
    for (uint32_t number = 0; number < count; number += GIRIH_BLOCK) {
        while (records[(size_t)(instance + 1) * GIRIH_INSTANCE_WORDS + first] <= number) {
            ++instance;
        }
        *blocks++ = instance;
    }
}

static uint32_t block_words(uint32_t count) {
    return count > 0 ? (uint32_t)girih_ceiling_quotient(count, GIRIH_BLOCK) : 1;
}

// --- Sizes -------------------------------------------------------------------------------------

uint32_t girih_sort_passes(uint32_t group_count, uint32_t *bits) {
    uint32_t needed = 1;
    while (needed < 32 && (group_count - 1) >> needed != 0) {
        ++needed;
    }
    const uint32_t passes = (needed + GIRIH_MAX_BIN_BITS - 1) / GIRIH_MAX_BIN_BITS;
    *bits = (needed + passes - 1) / passes;
    return passes;
}

static uint32_t choose_sort_block(uint32_t triangle_count, int serial_sort) {
    uint32_t block = GIRIH_MAX_SORT_BLOCK;
    while (serial_sort && block > MIN_SORT_BLOCK &&
           girih_ceiling_quotient(triangle_count, block) < SORT_BLOCKS_WANTED) {
        block /= 2;
    }
    return block;
}

static uint64_t at_least(uint64_t count, uint64_t floor) {
    return count > floor ? count : floor;
}

// What edges may ask for. A catalogue of one level can split nothing.
static void choose_splits(girih_frame_block *frame, const girih_plan_shape *shape) {
    const uint32_t most =
        shape->max_segments < GIRIH_MOST_SEGMENTS ? shape->max_segments : GIRIH_MOST_SEGMENTS;
    const uint32_t last = frame->level_count - 1;
    uint32_t level = last;
    if (shape->max_splits > 0 && last > 0) {
        if (frame->linear_spacing != 0) {
            level = most > frame->level_count ? most - 1 : last;
        } else {
            while (1u << level < most) {
                ++level;
            }
        }
    }
    frame->last_level = level;
    // There even where nothing will be split, so that a host knows by what it asked for whether its
    // instanced vertex input tells of parts.
    frame->max_splits = shape->max_segments > 0 ? shape->max_splits : 0;
    // One more than the longest edge needs: an edge inside may ask for more than what is left to
    // those around it.
    frame->split_passes = level > last ? 1 : 0;
    while (level > last) {
        level = girih_rest_level(frame, level);
        ++frame->split_passes;
    }
}

static girih_result choose_room(girih_frame_block *frame, girih_plan_shape *shape,
                                const totals *sums, girih_error *error) {
    // At level 0 each part is a triangle too, though only the first of a root's is seen.
    const uint64_t level0 = sums->triangles + frame->max_splits;
    shape->max_triangles = at_least(shape->max_triangles, level0);
    if (shape->mode == GIRIH_MODE_BAKED) {
        shape->max_vertices = at_least(shape->max_vertices, 3 * level0);
    } else if (shape->mode == GIRIH_MODE_WELDED) {
        shape->max_vertices = at_least(shape->max_vertices, sums->corners);
    }
    if (sums->corners > UINT32_MAX && shape->mode == GIRIH_MODE_WELDED) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %" PRIu64 " corners are more than 32 bits can number",
                          sums->corners);
    }
    frame->max_vertices =
        shape->max_vertices < UINT32_MAX ? (uint32_t)shape->max_vertices : UINT32_MAX;
    frame->max_triangles =
        shape->max_triangles < UINT32_MAX ? (uint32_t)shape->max_triangles : UINT32_MAX;
    return GIRIH_OK;
}

// Draws of one material, and words of DRAWS.
static girih_result choose_draws(girih_frame_block *frame, const girih_plan_shape *shape,
                                 uint64_t *words, girih_error *error) {
    const uint64_t ranges = frame->range_count;
    const uint64_t materials = frame->material_count;
    uint64_t draws = 1;
    frame->pattern_draws = shape->pattern_draws && shape->mode == GIRIH_MODE_BAKED;
    if (shape->outputs & GIRIH_OUTPUT_NO_DRAW) {
        draws = 0;
    } else if (shape->mode == GIRIH_MODE_INSTANCED) {
        draws = ranges;
    } else if (frame->pattern_draws) {
        // Full draws and one that is not full a range: pack_catalogue.c tells why these suffice.
        draws = ranges + frame->max_triangles / (GIRIH_DRAW_TRIANGLES / 2);
    }
    *words = draws * materials * GIRIH_DRAW_WORDS;
    if (*words > UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %" PRIu64 " draws for each of %" PRIu64
                          " materials are more than 32 bits can number",
                          draws, materials);
    }
    frame->draws_per_material = (uint32_t)draws;
    return GIRIH_OK;
}

static void choose_sort(girih_arrays *arrays, int serial_sort) {
    girih_frame_block *frame = &arrays->frame;
    uint32_t bits = 0;
    const uint32_t passes = girih_sort_passes(frame->group_count, &bits);
    const uint64_t keys = (uint64_t)frame->triangle_count + frame->max_splits;
    frame->sort_block = choose_sort_block((uint32_t)keys, serial_sort);
    frame->sort_block_count = (uint32_t)girih_ceiling_quotient(keys, frame->sort_block);
    frame->scan_block_count =
        (uint32_t)girih_ceiling_quotient(frame->weld_edge_count, GIRIH_SCAN_BLOCK);
    const uint64_t items = keys * GIRIH_ITEM_WORDS;
    arrays->count[GIRIH_BIND_ITEMS] = at_least(items, 1);
    arrays->count[GIRIH_BIND_ITEMS_SPARE] = passes > 1 ? at_least(items, 1) : 1;
    const uint64_t split_blocks =
        frame->max_splits > 0
            ? girih_ceiling_quotient(at_least(frame->triangle_count, frame->max_splits),
                                     GIRIH_SPLIT_BLOCK)
            : 0;
    arrays->count[GIRIH_BIND_COUNTERS] =
        at_least(((uint64_t)frame->sort_block_count + 1) << bits,
                 at_least(frame->scan_block_count, at_least(split_blocks, 1)));
}

static girih_result choose_sizes(girih_arrays *arrays, girih_plan_shape *shape, const totals *sums,
                                 girih_error *error) {
    girih_frame_block *frame = &arrays->frame;
    const uint64_t groups = (uint64_t)frame->material_count * frame->range_count;
    if (groups > MAX_GROUPS) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %" PRIu32 " materials times %" PRIu32
                          " pattern ranges, at most %" PRIu64 " can be numbered",
                          frame->material_count, frame->range_count, MAX_GROUPS);
    }
    frame->triangle_count = (uint32_t)sums->triangles;
    frame->edge_count = (uint32_t)sums->edges;
    frame->weld_edge_count = (uint32_t)sums->weld_edges;
    frame->corner_count = shape->mode == GIRIH_MODE_WELDED ? (uint32_t)sums->corners : 0;
    frame->attribute_stride = 3 + frame->attribute_floats + (shape->previous ? 3 : 0);
    frame->group_count = (uint32_t)groups;
    frame->output_mode = shape->mode == GIRIH_MODE_WELDED  ? GIRIH_OUTPUT_WELDED
                         : shape->mode == GIRIH_MODE_BAKED ? GIRIH_OUTPUT_BAKED
                                                           : GIRIH_OUTPUT_INSTANCED;
    choose_splits(frame, shape);
    if (frame->max_splits > GIRIH_MAX_COUNT - sums->triangles) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "plan: %" PRIu64 " triangles and room for %" PRIu32
                          " parts of split ones; at most %" PRIu64 " together can be numbered",
                          sums->triangles, frame->max_splits, GIRIH_MAX_COUNT);
    }
    girih_result result = choose_room(frame, shape, sums, error);
    uint64_t draw_words = 0;
    if (result == GIRIH_OK) {
        result = choose_draws(frame, shape, &draw_words, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    choose_sort(arrays, shape->serial_sort);
    arrays->count[GIRIH_BIND_LEVELS] = at_least(sums->edges, 1);
    arrays->count[GIRIH_BIND_SPLITS] = at_least((uint64_t)frame->max_splits * GIRIH_SPLIT_WORDS, 1);
    arrays->count[GIRIH_BIND_KEYS] = at_least(sums->triangles + frame->max_splits, 1);
    arrays->count[GIRIH_BIND_GROUPS] = (groups + 1) * GIRIH_GROUP_WORDS;
    arrays->count[GIRIH_BIND_STATUS] =
        (uint64_t)GIRIH_STATUS_WORDS + frame->pattern_count + frame->material_count + 1;
    arrays->count[GIRIH_BIND_DRAWS] = at_least(draw_words, 1);
    arrays->count[GIRIH_BIND_WELD_OFFSETS] =
        shape->mode == GIRIH_MODE_WELDED ? at_least(sums->weld_edges, 1) : 1;
    return GIRIH_OK;
}

girih_result girih_pack_plan(girih_arrays *arrays, girih_plan_shape *shape,
                             const girih_scene_table *table, const girih_instance *instances,
                             uint32_t instance_count, girih_error *error) {
    girih_frame_block *frame = &arrays->frame;
    totals sums = {0};
    girih_result result = check_instances(&sums, table, instances, instance_count, error);
    if (result == GIRIH_OK) {
        result = choose_sizes(arrays, shape, &sums, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    frame->instance_count = instance_count;
    frame->triangle_blocks = 0;
    frame->edge_blocks = block_words(frame->triangle_count);
    frame->weld_blocks = frame->edge_blocks + block_words(frame->edge_count);
    frame->corner_blocks = frame->weld_blocks + block_words(frame->weld_edge_count);
    result = girih_allocate_words(arrays, GIRIH_BIND_INSTANCES,
                                  ((uint64_t)instance_count + 1) * GIRIH_INSTANCE_WORDS, error);
    if (result == GIRIH_OK) {
        result = girih_allocate_words(
            arrays, GIRIH_BIND_BLOCKS,
            (uint64_t)frame->corner_blocks + block_words(frame->corner_count), error);
    }
    if (result != GIRIH_OK) {
        girih_arrays_free(arrays, GIRIH_BIND_INSTANCES, GIRIH_BIND_BLOCKS + 1);
        return result;
    }
    uint32_t *records = arrays->words[GIRIH_BIND_INSTANCES];
    uint32_t *blocks = arrays->words[GIRIH_BIND_BLOCKS];
    write_instances(records, table, instances, instance_count, shape->mode == GIRIH_MODE_WELDED);
    memcpy(frame->only_instance, records, sizeof frame->only_instance);
    write_blocks(blocks, records, GIRIH_INSTANCE_FIRST_TRIANGLE, frame->triangle_count);
    write_blocks(blocks + frame->edge_blocks, records, GIRIH_INSTANCE_FIRST_EDGE,
                 frame->edge_count);
    write_blocks(blocks + frame->weld_blocks, records, GIRIH_INSTANCE_FIRST_WELD_EDGE,
                 frame->weld_edge_count);
    write_blocks(blocks + frame->corner_blocks, records, GIRIH_INSTANCE_FIRST_CORNER,
                 frame->corner_count);
    return GIRIH_OK;
}
