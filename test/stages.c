#include "stages.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "memory.h"

const float identity_transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

static void assert_ok(girih_result result, const girih_error *error) {
    if (result != GIRIH_OK) {
        fail_msg("%s", error->message);
    }
}

// Filled with a pattern, so that what a stage must write but does not is seen.
static void allocate(girih_arrays *arrays, uint32_t binding, uint64_t count) {
    girih_free(arrays->words[binding]);
    arrays->words[binding] = girih_allocate_array((size_t)count, sizeof(uint32_t));
    arrays->count[binding] = count;
    assert_non_null(arrays->words[binding]);
    memset(arrays->words[binding], 0xa5, (size_t)count * sizeof(uint32_t));
}

stages stages_begin(const girih_catalogue *catalogue, const girih_mesh *const *meshes,
                    uint32_t mesh_count, const girih_instance *instances, uint32_t instance_count,
                    girih_plan_shape shape) {
    stages s;
    memset(&s, 0, sizeof s);
    girih_error error = {GIRIH_OK, ""};
    assert_ok(girih_pack_catalogue(&s.arrays, catalogue, &error), &error);
    assert_ok(girih_pack_scene(&s.arrays, &s.table, meshes, mesh_count, 0, &error), &error);
    girih_instance *once = NULL;
    if (!instances) {
        once = calloc(mesh_count + 1u, sizeof *once);
        assert_non_null(once);
        for (uint32_t n = 0; n < mesh_count; ++n) {
            once[n].mesh = n;
            memcpy(once[n].transform, identity_transform, sizeof identity_transform);
        }
        instances = once;
        instance_count = mesh_count;
    }
    s.shape = shape;
    s.shape.max_vertices = shape.max_vertices ? shape.max_vertices : UINT32_MAX;
    s.shape.max_triangles = shape.max_triangles ? shape.max_triangles : UINT32_MAX;
    assert_ok(girih_pack_plan(&s.arrays, &s.shape, &s.table, instances, instance_count, &error),
              &error);
    free(once);
    for (uint32_t binding = GIRIH_BIND_LEVELS; binding <= GIRIH_BIND_WELD_OFFSETS; ++binding) {
        allocate(&s.arrays, binding, s.arrays.count[binding]);
    }
    return s;
}

void stages_end(stages *s) {
    girih_arrays_free(&s->arrays, 0, GIRIH_BIND_COUNT);
    girih_free(s->table.meshes);
}

void stages_frame(stages *s, const girih_frame *frame) {
    girih_error error = {GIRIH_OK, ""};
    assert_ok(girih_pack_frame(&s->arrays, frame, &error), &error);
}

void stages_count(stages *s, girih_surface surface) {
    girih_error error = {GIRIH_OK, ""};
    girih_twin_levels(&s->arrays);
    girih_twin_select(&s->arrays, surface);
    girih_twin_split(&s->arrays);
    assert_ok(girih_twin_group(&s->arrays, &error), &error);
    if (s->shape.mode == GIRIH_MODE_WELDED) {
        girih_twin_weld(&s->arrays);
    }
    girih_twin_dispatch(&s->arrays);
}

void stages_write(stages *s, girih_surface surface) {
    const girih_statistics statistics = stages_statistics(s);
    girih_arrays *arrays = &s->arrays;
    if (s->shape.mode == GIRIH_MODE_INSTANCED) {
        const uint32_t patch_words =
            (surface == GIRIH_SURFACE_PN ? GIRIH_PATCH_WORDS_PN : GIRIH_PATCH_WORDS_FLAT) +
            (arrays->frame.max_splits > 0 ? GIRIH_PATCH_WORDS_PART : 0u);
        allocate(arrays, GIRIH_BIND_OUT_ATTRIBUTES,
                 arrays->words[GIRIH_BIND_STATUS][GIRIH_STATUS_ITEMS] * patch_words);
        girih_twin_evaluate(arrays, surface);
        return;
    }
    const uint64_t attribute_words = arrays->frame.attribute_stride;
    allocate(arrays, GIRIH_BIND_OUT_POSITIONS, statistics.output_vertices * 3);
    allocate(arrays, GIRIH_BIND_OUT_ATTRIBUTES, statistics.output_vertices * attribute_words);
    allocate(arrays, GIRIH_BIND_OUT_INDICES, statistics.output_triangles * 3);
    allocate(arrays, GIRIH_BIND_OUT_CLOSED_INDICES, statistics.output_triangles * 3);
    allocate(arrays, GIRIH_BIND_OUT_SOURCES, statistics.output_triangles * 2);
    girih_twin_evaluate(arrays, surface);
    girih_twin_output(arrays, s->shape.outputs);
}

void stages_refine(stages *s, const girih_frame *frame, girih_surface surface) {
    stages_frame(s, frame);
    stages_count(s, surface);
    stages_write(s, surface);
}

uint32_t stages_pattern_triangles(const stages *s, const uint32_t levels[3]) {
    const girih_catalogue *catalogue =
        s->arrays.frame.linear_spacing ? girih_catalogue_linear() : girih_catalogue_dyadic();
    uint32_t least = levels[0], largest = levels[0], sum = 0;
    for (int n = 0; n < 3; ++n) {
        least = levels[n] < least ? levels[n] : least;
        largest = levels[n] > largest ? levels[n] : largest;
        sum += levels[n];
    }
    for (uint32_t rank = 0; rank < catalogue->pattern_count; ++rank) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        if (pattern->levels[0] == largest && pattern->levels[1] == sum - largest - least && pattern->levels[2] == least) {
            return pattern->triangle_count;
        }
    }
    fail();
    return 0;
}

girih_statistics stages_statistics(const stages *s) {
    return girih_read_status(&s->arrays.frame, s->arrays.words[GIRIH_BIND_STATUS]);
}

void stages_position(const stages *s, uint32_t vertex, float position[3]) {
    memcpy(position, s->arrays.words[GIRIH_BIND_OUT_POSITIONS] + (size_t)vertex * 3,
           3 * sizeof(float));
}

void stages_normal(const stages *s, uint32_t vertex, float normal[3]) {
    memcpy(normal,
           s->arrays.words[GIRIH_BIND_OUT_ATTRIBUTES] +
               (size_t)vertex * s->arrays.frame.attribute_stride,
           3 * sizeof(float));
}

// --- Audit -------------------------------------------------------------------------------------

static size_t table_size(uint64_t count) {
    size_t size = 16;
    while (size < 2 * count) {
        size *= 2;
    }
    return size;
}

typedef struct used_edge {
    uint32_t low, high;
    uint32_t forward, backward;
} used_edge;

edge_audit audit_indices(const uint32_t *indices, uint64_t triangle_count) {
    edge_audit audit = {0};
    const size_t size = table_size(3 * triangle_count);
    used_edge *edges = calloc(size, sizeof *edges);
    assert_non_null(edges);
    for (uint64_t triangle = 0; triangle < triangle_count; ++triangle) {
        const uint32_t *v = indices + 3 * triangle;
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            ++audit.degenerate;
            continue;
        }
        for (int n = 0; n < 3; ++n) {
            const uint32_t a = v[n], b = v[(n + 1) % 3];
            const uint32_t low = a < b ? a : b, high = a < b ? b : a;
            size_t slot =
                (low * UINT64_C(0x9e3779b97f4a7c15) ^ high * UINT64_C(0xc2b2ae3d27d4eb4f)) >> 24;
            slot &= size - 1;
            while (edges[slot].forward + edges[slot].backward > 0 &&
                   (edges[slot].low != low || edges[slot].high != high)) {
                slot = (slot + 1) & (size - 1);
            }
            edges[slot].low = low;
            edges[slot].high = high;
            *(a < b ? &edges[slot].forward : &edges[slot].backward) += 1;
        }
    }
    for (size_t slot = 0; slot < size; ++slot) {
        const uint32_t uses = edges[slot].forward + edges[slot].backward;
        audit.open += uses == 1;
        audit.nonmanifold += uses > 2;
        audit.flipped += uses == 2 && edges[slot].forward != 1;
        audit.edges += uses == 2 && edges[slot].forward == 1;
    }
    free(edges);
    return audit;
}

edge_audit audit_points(const float *positions, uint64_t vertex_count, const uint32_t *indices,
                        uint64_t triangle_count) {
    const uint64_t count = triangle_count * 3;
    const size_t size = table_size(vertex_count);
    uint32_t *points = malloc((size_t)(count + 1) * sizeof *points);
    uint32_t *slots = calloc(size, sizeof *slots); // vertex and one
    assert_true(points && slots);
    for (uint64_t n = 0; n < count; ++n) {
        const float *position = positions + (size_t)indices[n] * 3;
        uint32_t words[3];
        memcpy(words, position, sizeof words);
        uint64_t hash = words[0] * UINT64_C(0x9e3779b97f4a7c15);
        hash = (hash ^ hash >> 29 ^ words[1]) * UINT64_C(0xc2b2ae3d27d4eb4f);
        hash = (hash ^ hash >> 29 ^ words[2]) * UINT64_C(0x165667b19e3779f9);
        size_t slot = (hash >> 24) & (size - 1);
        while (slots[slot] != 0 &&
               memcmp(position, positions + (size_t)(slots[slot] - 1) * 3, sizeof words) != 0) {
            slot = (slot + 1) & (size - 1);
        }
        if (slots[slot] == 0) {
            slots[slot] = indices[n] + 1;
        }
        points[n] = slots[slot] - 1;
    }
    const edge_audit audit = audit_indices(points, triangle_count);
    free(points);
    free(slots);
    return audit;
}

edge_audit audit_positions(const stages *s) {
    const girih_statistics statistics = stages_statistics(s);
    const size_t size = (size_t)statistics.output_vertices * 3 * sizeof(float);
    float *positions = malloc(size + 1);
    assert_non_null(positions);
    memcpy(positions, s->arrays.words[GIRIH_BIND_OUT_POSITIONS], size);
    const edge_audit audit =
        audit_points(positions, statistics.output_vertices, s->arrays.words[GIRIH_BIND_OUT_INDICES],
                     statistics.output_triangles);
    free(positions);
    return audit;
}
