#include "expected.h"

#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "error.h"
#include "memory.h"

static girih_result allocate_words(girih_arrays *arrays, uint32_t binding, girih_error *error) {
    arrays->words[binding] = girih_allocate_array((size_t)arrays->count[binding], sizeof(uint32_t));
    if (arrays->words[binding] == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    memset(arrays->words[binding], 0, (size_t)arrays->count[binding] * sizeof(uint32_t));
    return GIRIH_OK;
}

// The levels of every instance's edges.
static girih_result run_levels(girih_arrays *arrays, const girih_model *model,
                               const girih_instance *instances, uint32_t instance_count,
                               const girih_catalogue *catalogue, uint32_t max_segments,
                               const girih_frame *frame, girih_error *error) {
    girih_scene_table table = {0};
    // Levels take no room for parts, but there must be some for edges to go beyond the catalogue.
    girih_plan_shape shape = {.mode = GIRIH_MODE_BAKED,
                              .outputs = GIRIH_OUTPUT_NO_DRAW,
                              .max_segments = max_segments,
                              .max_splits = 1};
    girih_result result = girih_pack_catalogue(arrays, catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_pack_scene(arrays, &table, model->meshes, model->mesh_count, 0, error);
    }
    if (result == GIRIH_OK) {
        result = girih_pack_plan(arrays, &shape, &table, instances, instance_count, error);
        girih_free(table.meshes);
    }
    if (result == GIRIH_OK) {
        result = girih_pack_frame(arrays, frame, error);
    }
    if (result == GIRIH_OK) {
        result = allocate_words(arrays, GIRIH_BIND_LEVELS, error);
    }
    if (result == GIRIH_OK) {
        result = allocate_words(arrays, GIRIH_BIND_STATUS, error);
    }
    if (result == GIRIH_OK) {
        girih_twin_levels(arrays);
    }
    return result;
}

// Sums one mesh's edges; levels are those of its edges.
static girih_result sum_mesh(girih_expected *expected, const girih_mesh *mesh,
                             const uint32_t *levels, const girih_catalogue *catalogue,
                             girih_error *error) {
    // How often triangles run along an edge in its canonical order.
    uint8_t *forward = calloc((size_t)mesh->edge_count + 1, 1);
    if (forward == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t n = 0; n < 3 * (size_t)mesh->triangle_count; n++) {
        uint32_t edge = mesh->triangle_edges[n];
        if (mesh->edge_uses[edge] == 2) {
            forward[edge] = (uint8_t)(forward[edge] +
                                      ((mesh->triangle_weld_edges[n] & GIRIH_WELD_REVERSED) == 0));
        }
    }
    for (uint32_t edge = 0; edge < mesh->edge_count; edge++) {
        uint32_t segments = girih_catalogue_segments(catalogue, levels[edge]);
        uint32_t uses = mesh->edge_uses[edge];
        expected->open += uses == 1 ? segments : 0;
        expected->nonmanifold += uses >= 3 ? segments : 0;
        expected->flipped += uses == 2 && forward[edge] != 1 ? segments : 0;
    }
    free(forward);
    return GIRIH_OK;
}

girih_result girih_expect(girih_expected *expected, const girih_model *model,
                          const girih_instance *instances, uint32_t instance_count,
                          const girih_catalogue *catalogue, uint32_t max_segments,
                          const girih_frame *frame, girih_error *error) {
    memset(expected, 0, model->mesh_count * sizeof *expected);
    girih_arrays arrays = {0};
    girih_result result = run_levels(&arrays, model, instances, instance_count, catalogue,
                                     max_segments, frame, error);
    const uint32_t *levels = arrays.words[GIRIH_BIND_LEVELS];
    // Instances stand in the order of their meshes, each mesh once, and so do their edges.
    for (uint32_t n = 0; n < instance_count && result == GIRIH_OK; n++) {
        uint32_t mesh = instances[n].mesh;
        result = sum_mesh(&expected[mesh], model->meshes[mesh], levels, catalogue, error);
        levels += model->meshes[mesh]->edge_count;
    }
    girih_arrays_free(&arrays, 0, GIRIH_BIND_COUNT);
    return result;
}
