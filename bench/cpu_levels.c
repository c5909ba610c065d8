#include "cpu_levels.h"

#include <stdbool.h>

#include "error.h"
#include "memory.h"

girih_result bench_cpu_levels_create(const girih_mesh *mesh, const girih_catalogue *catalogue,
                                     girih_surface surface, bench_cpu_levels *levels,
                                     girih_error *error) {
    *levels = (bench_cpu_levels){.surface = surface, .triangle_count = mesh->triangle_count};
    girih_arrays *arrays = &levels->arrays;
    girih_scene_table table = {0};
    girih_result result = girih_pack_catalogue(arrays, catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_pack_scene(arrays, &table, &mesh, 1, 0, error);
    }
    if (result == GIRIH_OK) {
        const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
        girih_plan_shape shape = {.mode = GIRIH_MODE_BAKED, .outputs = GIRIH_OUTPUT_NO_DRAW};
        result = girih_pack_plan(arrays, &shape, &table, &instance, 1, error);
    }
    girih_free(table.meshes);
    static const uint32_t written[] = {GIRIH_BIND_LEVELS, GIRIH_BIND_KEYS, GIRIH_BIND_STATUS};
    for (size_t n = 0; n < sizeof written / sizeof *written && result == GIRIH_OK; ++n) {
        arrays->words[written[n]] =
            girih_allocate_array((size_t)arrays->count[written[n]], sizeof(uint32_t));
        if (!arrays->words[written[n]]) {
            result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
        }
    }
    if (result != GIRIH_OK) {
        bench_cpu_levels_destroy(levels);
    }
    return result;
}

void bench_cpu_levels_destroy(bench_cpu_levels *levels) {
    girih_arrays_free(&levels->arrays, 0, GIRIH_BIND_COUNT);
    *levels = (bench_cpu_levels){0};
}

girih_result bench_cpu_levels_select(bench_cpu_levels *levels, const girih_frame *frame,
                                     uint32_t *patterns, girih_error *error) {
    girih_arrays *arrays = &levels->arrays;
    const girih_result result = girih_pack_frame(arrays, frame, error);
    if (result != GIRIH_OK) {
        return result;
    }
    girih_twin_levels(arrays);
    const bool culls = arrays->frame.cull != 0;
    if (culls) {
        girih_twin_select(arrays, levels->surface);
    }
    const uint32_t *edge_levels = arrays->words[GIRIH_BIND_LEVELS];
    const uint32_t *edges = arrays->words[GIRIH_BIND_TRIANGLE_EDGES];
    const uint32_t *keys = arrays->words[GIRIH_BIND_KEYS];
    for (size_t n = 0; n < levels->triangle_count; ++n) {
        patterns[n] = culls && keys[n] == GIRIH_KEY_CULLED
                          ? BENCH_HIDDEN
                          : bench_pattern_number(arrays->frame.level_count,
                                                 edge_levels[edges[3 * n] & GIRIH_EDGE_MASK],
                                                 edge_levels[edges[3 * n + 1] & GIRIH_EDGE_MASK],
                                                 edge_levels[edges[3 * n + 2] & GIRIH_EDGE_MASK]);
    }
    return GIRIH_OK;
}
