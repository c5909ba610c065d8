// girih_cpu_refine, and the packing of transforms and instances that all stages rest on.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "memory.h"
#include "meshes.h"
#include "stages.h"

static const girih_instance once = {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

static girih_cpu_desc describe(const girih_mesh *const *mesh, girih_mode mode) {
    return (girih_cpu_desc){.meshes = mesh,
                            .mesh_count = 1,
                            .instances = &once,
                            .instance_count = 1,
                            .surface = GIRIH_SURFACE_PN,
                            .mode = mode};
}

static girih_cpu_output refine(const girih_cpu_desc *desc, const girih_frame *frame) {
    girih_cpu_output output;
    girih_error error = {GIRIH_OK, ""};
    if (girih_cpu_refine(desc, frame, &output, &error) != GIRIH_OK) {
        fail_msg("%s", error.message);
    }
    return output;
}

static void refused(const girih_cpu_desc *desc, const girih_frame *frame, girih_result result,
                    const char *message) {
    girih_cpu_output output = {.material_count = 77};
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_cpu_refine(desc, frame, &output, &error), result);
    assert_int_equal(error.result, result);
    assert_string_equal(error.message, message);
    assert_int_equal(girih_cpu_refine(desc, frame, &output, NULL), result);
    assert_int_equal(output.material_count, 77);
}

static void gives_what_the_stages_give(void **state) {
    (void)state;
    const girih_mesh *mesh = make_seam_sphere(8, 6);
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 40, .seed = 4};
    for (int mode = GIRIH_MODE_INSTANCED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_cpu_desc desc = describe(&mesh, (girih_mode)mode);
        desc.outputs = GIRIH_OUTPUT_SOURCES |
                       (mode == GIRIH_MODE_WELDED ? (uint32_t)GIRIH_OUTPUT_CLOSED_INDICES : 0u);
        girih_cpu_output output = refine(&desc, &frame);
        stages s = stages_begin(
            girih_catalogue_dyadic(), &mesh, 1, NULL, 0,
            (girih_plan_shape){
                .mode = mode == GIRIH_MODE_WELDED ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED,
                .outputs = desc.outputs | GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_INDICES});
        stages_refine(&s, &frame, GIRIH_SURFACE_PN);
        const girih_statistics statistics = stages_statistics(&s);
        // Up to the padding at the end.
        assert_memory_equal(&output.statistics, &statistics,
                            offsetof(girih_statistics, overflow) + sizeof statistics.overflow);
        assert_int_equal(output.attribute_floats, 2);
        assert_int_equal(output.material_count, 3);
        assert_memory_equal(output.positions, s.arrays.words[GIRIH_BIND_OUT_POSITIONS],
                            (size_t)statistics.output_vertices * 12);
        assert_memory_equal(output.attributes, s.arrays.words[GIRIH_BIND_OUT_ATTRIBUTES],
                            (size_t)statistics.output_vertices * 20);
        assert_memory_equal(output.indices, s.arrays.words[GIRIH_BIND_OUT_INDICES],
                            (size_t)statistics.output_triangles * 12);
        assert_memory_equal(output.sources, s.arrays.words[GIRIH_BIND_OUT_SOURCES],
                            (size_t)statistics.output_triangles * 8);
        if (mode == GIRIH_MODE_WELDED) {
            assert_memory_equal(output.closed_indices,
                                s.arrays.words[GIRIH_BIND_OUT_CLOSED_INDICES],
                                (size_t)statistics.output_triangles * 12);
        } else {
            assert_null(output.closed_indices);
        }
        assert_int_equal(output.material_first[0], 0);
        assert_int_equal(output.material_first[1], output.material_first[2]);
        assert_int_equal(output.material_first[3], statistics.output_triangles);
        girih_cpu_output_free(&output);
        assert_null(output.positions);
        stages_end(&s);
    }
    girih_cpu_output_free(NULL);
    girih_mesh_destroy(mesh);
}

static void overflow_is_drawn_at_level_0(void **state) {
    (void)state;
    const girih_mesh *mesh = make_torus(8, 6);
    const girih_instance mirrored[2] = {{0, {-1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0}}, once};
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = 2};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_cpu_desc desc = describe(&mesh, (girih_mode)mode);
        desc.instances = mirrored;
        desc.instance_count = 2;
        girih_cpu_output full = refine(&desc, &frame);
        desc.max_triangles = full.statistics.output_triangles;
        desc.max_vertices = full.statistics.output_vertices;
        girih_cpu_output exact = refine(&desc, &frame);
        assert_false(exact.statistics.overflow);
        // Less than level 0 is raised to level 0.
        desc.max_triangles = 1;
        girih_cpu_output level0 = refine(&desc, &frame);
        assert_true(level0.statistics.overflow);
        assert_int_equal(level0.statistics.output_triangles, 2 * mesh->triangle_count);
        assert_int_equal(level0.statistics.output_vertices, mode == GIRIH_MODE_WELDED
                                                                ? 2 * mesh->vertex_count
                                                                : 6 * mesh->triangle_count);
        assert_int_equal(level0.statistics.needed_triangles, full.statistics.output_triangles);
        assert_int_equal(level0.statistics.needed_vertices, full.statistics.output_vertices);
        // It is the input: closed, outward, every point written.
        if (mode == GIRIH_MODE_WELDED) {
            const edge_audit audit =
                audit_indices(level0.indices, level0.statistics.output_triangles);
            assert_int_equal(audit.edges, 2 * mesh->edge_count);
        }
        double volume = 0.0;
        for (uint64_t n = 0; n < level0.statistics.output_triangles; ++n) {
            double p[3][3];
            for (int k = 0; k < 9; ++k) {
                p[k / 3][k % 3] =
                    (double)level0.positions[3 * (size_t)level0.indices[3 * n + (uint64_t)k / 3] +
                                             (size_t)k % 3];
            }
            for (int k = 0; k < 3; ++k) {
                const int y = (k + 1) % 3, z = (k + 2) % 3;
                volume += p[0][k] * (p[1][y] * p[2][z] - p[1][z] * p[2][y]) / 6;
            }
        }
        assert_true(volume > 3.0);
        girih_cpu_output_free(&full);
        girih_cpu_output_free(&exact);
        girih_cpu_output_free(&level0);
    }
    girih_mesh_destroy(mesh);
}

static void what_cannot_be_done_is_refused(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    const girih_frame frame = {.segments = 64};
    girih_cpu_desc desc = describe(&mesh, GIRIH_MODE_BAKED);
    desc.outputs = GIRIH_OUTPUT_CLOSED_INDICES;
    refused(&desc, &frame, GIRIH_ERROR_INVALID_ARGUMENT,
            "refine: closed indices need the welded mode, and nothing culled");
    desc.mode = GIRIH_MODE_WELDED;
    const girih_frame culling = {.cull_back = 1};
    refused(&desc, &culling, GIRIH_ERROR_INVALID_ARGUMENT,
            "refine: closed indices need the welded mode, and nothing culled");
    desc = describe(&mesh, (girih_mode)9);
    refused(&desc, &frame, GIRIH_ERROR_INVALID_ARGUMENT, "refine: unknown mode 9");
    desc = describe(&mesh, GIRIH_MODE_BAKED);
    desc.surface = (girih_surface)5;
    refused(&desc, &frame, GIRIH_ERROR_INVALID_ARGUMENT, "refine: unknown surface 5");
    desc = describe(NULL, GIRIH_MODE_BAKED);
    refused(&desc, &frame, GIRIH_ERROR_INVALID_ARGUMENT, "refine: meshes or instances are NULL");
    const girih_mesh *none = NULL;
    desc = describe(&none, GIRIH_MODE_BAKED);
    refused(&desc, &frame, GIRIH_ERROR_INVALID_ARGUMENT, "scene: mesh 0 is NULL");
    desc = describe(&mesh, GIRIH_MODE_BAKED);
    girih_instance instance = once;
    desc.instances = &instance;
    instance.mesh = 1;
    refused(&desc, &frame, GIRIH_ERROR_INVALID_ARGUMENT,
            "plan: instance 0 is of mesh 1, the scene has 1");
    instance.mesh = 0;
    instance.transform[7] = INFINITY;
    refused(
        &desc, &frame, GIRIH_ERROR_INVALID_DATA,
        "plan: element 7 of instance 0's transform is inf; it must be finite and at most 1e+15");
    girih_error error = {GIRIH_OK, ""};
    instance.transform[7] = NAN;
    girih_cpu_output output;
    assert_int_equal(girih_cpu_refine(&desc, &frame, &output, &error), GIRIH_ERROR_INVALID_DATA);
    assert_int_equal(girih_cpu_refine(NULL, &frame, &output, &error), GIRIH_ERROR_INVALID_ARGUMENT);
    girih_mesh_destroy(mesh);
}

// More output than 2^31 triangles is refused, and the number needed is told.
static void too_large_outputs_are_refused(void **state) {
    (void)state;
    const girih_mesh *mesh = make_icosphere(5);
    girih_instance *many = malloc(300 * sizeof *many);
    assert_non_null(many);
    for (int n = 0; n < 300; ++n) {
        many[n] = once;
    }
    girih_cpu_desc desc = describe(&mesh, GIRIH_MODE_BAKED);
    desc.instances = many;
    desc.instance_count = 300;
    const girih_frame frame = {.segments = 64};
    refused(
        &desc, &frame, GIRIH_ERROR_TOO_LARGE,
        "refine: 13178880000 vertices and 25165824000 triangles are needed, at most 2147483648 of "
        "each can be written");
    free(many);
    girih_mesh_destroy(mesh);
}

// Before any of their parts are made.
static void too_many_parts_are_refused(void **state) {
    (void)state;
    const girih_mesh *mesh = make_cube(1);
    girih_cpu_desc desc = describe(&mesh, GIRIH_MODE_WELDED);
    desc.max_segments = 32768;
    refused(&desc, &(girih_frame){.segments = 3}, GIRIH_ERROR_UNSUPPORTED,
            "refine: split triangles are not welded; use the baked mode, or max_segments 0");
    desc.mode = GIRIH_MODE_BAKED;
    refused(&desc, &(girih_frame){.segments = 32768}, GIRIH_ERROR_TOO_LARGE,
            "refine: 6442450944 triangles or more are needed, at most 2147483648 can be written");
    // What does not fit the room given is counted all the same.
    desc.max_triangles = 1000;
    girih_cpu_output output = refine(&desc, &(girih_frame){.segments = 512});
    assert_true(output.statistics.overflow);
    assert_int_equal(output.statistics.needed_triangles, 12 * 512 * 512);
    girih_cpu_output_free(&output);
    girih_mesh_destroy(mesh);
}

static void nothing_gives_nothing(void **state) {
    (void)state;
    const girih_mesh *mesh = make_nothing();
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 5, .cull_back = 1};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_cpu_desc desc = describe(&mesh, (girih_mode)mode);
        for (int n = 0; n < 3; ++n) {
            girih_cpu_output output = refine(&desc, &frame);
            assert_int_equal(output.statistics.output_triangles, 0);
            assert_int_equal(output.statistics.output_vertices, 0);
            assert_int_equal(output.material_first[1], 0);
            girih_cpu_output_free(&output);
            // With a mesh; without an instance; without either.
            *(n == 0 ? &desc.instance_count : &desc.mesh_count) = 0;
        }
    }
    girih_mesh_destroy(mesh);
}

// Whichever allocation fails, it is reported and nothing leaks.
static void failed_allocations_are_reported(void **state) {
    (void)state;
    const girih_mesh *mesh = make_seam_sphere(5, 4);
    girih_cpu_desc desc = describe(&mesh, GIRIH_MODE_WELDED);
    desc.outputs = GIRIH_OUTPUT_SOURCES | GIRIH_OUTPUT_CLOSED_INDICES;
    const girih_frame frame = {.segments = 3};
    size_t failures = 0;
    for (;; ++failures) {
        girih_cpu_output output = {.material_count = 5};
        girih_error error = {GIRIH_OK, ""};
        girih_allocation_failure_after(failures);
        const girih_result result = girih_cpu_refine(&desc, &frame, &output, &error);
        girih_allocation_failure_after(SIZE_MAX);
        if (result == GIRIH_OK) {
            girih_cpu_output_free(&output);
            break;
        }
        assert_int_equal(result, GIRIH_ERROR_OUT_OF_MEMORY);
        assert_int_equal(error.result, result);
        assert_true(strlen(error.message) > 10);
        assert_int_equal(output.material_count, 5);
    }
    assert_true(failures >= 25);
    girih_mesh_destroy(mesh);
}

// --- Packing -----------------------------------------------------------------------------------

static float record_float(const uint32_t *record, uint32_t field) {
    float value;
    memcpy(&value, record + field, sizeof value);
    return value;
}

static void normals_follow_the_inverse_transpose(void **state) {
    (void)state;
    uint32_t record[GIRIH_INSTANCE_WORDS] = {0};
    const float identity[12] = {1, -0.0f, 0, -0.0f, 0, 1, 0, 0, 0, -0.0f, 1, 0};
    girih_pack_transform(record, identity, NULL);
    assert_memory_equal(record + GIRIH_INSTANCE_TRANSFORM, identity_transform,
                        sizeof identity_transform);
    assert_memory_equal(record + GIRIH_INSTANCE_PREVIOUS, identity_transform,
                        sizeof identity_transform);
    for (uint32_t k = 0; k < 9; ++k) {
        assert_true(record_float(record, GIRIH_INSTANCE_NORMAL + 4 * (k / 3) + k % 3) ==
                    (k / 3 == k % 3 ? 1.0f : 0.0f));
        assert_false(signbit(record_float(record, GIRIH_INSTANCE_NORMAL + 4 * (k / 3) + k % 3)));
    }
    assert_int_equal(record[GIRIH_INSTANCE_FLAGS], 0);
    assert_true(record_float(record, GIRIH_INSTANCE_SCALE) == 1.0f);
    uint64_t random = 12;
    uint32_t mirrored = 0;
    for (int n = 0; n < 1000; ++n) {
        // From 1e-12 to 1e12, so that a product of floats would overflow or vanish.
        const double scale = pow(10.0, (double)draw_float(&random, -12.0f, 12.0f));
        float t[12];
        for (int k = 0; k < 12; ++k) {
            t[k] = (float)(scale * (double)draw_float(&random, -1.0f, 1.0f));
        }
        float before[12];
        for (int k = 0; k < 12; ++k) {
            before[k] = draw_float(&random, -1.0f, 1.0f);
        }
        record[GIRIH_INSTANCE_MESH_TRIANGLE] = 77;
        record[GIRIH_INSTANCE_FIRST_TRIANGLE] = 78;
        girih_pack_transform(record, t, before);
        assert_memory_equal(record + GIRIH_INSTANCE_TRANSFORM, t, sizeof t);
        assert_memory_equal(record + GIRIH_INSTANCE_PREVIOUS, before, sizeof before);
        assert_int_equal(record[GIRIH_INSTANCE_MESH_TRIANGLE], 77);
        assert_int_equal(record[GIRIH_INSTANCE_FIRST_TRIANGLE], 78);
        double m[3][3];
        for (int k = 0; k < 9; ++k) {
            m[k / 3][k % 3] = (double)t[4 * (k / 3) + k % 3] / scale;
        }
        const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                                   m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                                   m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
        assert_int_equal(record[GIRIH_INSTANCE_FLAGS],
                         determinant < 0 ? GIRIH_INSTANCE_MIRRORED : 0);
        mirrored += determinant < 0;
        const double size = scale * cbrt(fabs(determinant));
        assert_true(fabs((double)record_float(record, GIRIH_INSTANCE_SCALE) - size) <= 1e-6 * size);
        // N^T M is a positive multiple of the identity, and N is about 1 in size.
        double product[3][3], largest = 0.0;
        for (int k = 0; k < 9; ++k) {
            product[k / 3][k % 3] = 0.0;
            for (uint32_t row = 0; row < 3; ++row) {
                const double element =
                    (double)record_float(record, GIRIH_INSTANCE_NORMAL + 4 * row + (uint32_t)k / 3);
                largest = fmax(largest, fabs(element));
                product[k / 3][k % 3] += element * m[row][k % 3];
            }
        }
        assert_true(largest >= 1.0 && largest <= 2.0);
        assert_true(product[0][0] > 0.0);
        for (int k = 0; k < 9; ++k) {
            const double expected = k / 3 == k % 3 ? product[0][0] : 0.0;
            assert_true(fabs(product[k / 3][k % 3] - expected) < 1e-6);
        }
    }
    assert_true(mirrored > 300 && mirrored < 700);
    // A flat transform has no inverse; it is still packed.
    const float flat[12] = {0};
    girih_pack_transform(record, flat, NULL);
    assert_int_equal(record[GIRIH_INSTANCE_FLAGS], 0);
    for (uint32_t k = 0; k < 9; ++k) {
        assert_int_equal(record[GIRIH_INSTANCE_NORMAL + 4 * (k / 3) + k % 3], 0);
    }
    assert_int_equal(record[GIRIH_INSTANCE_SCALE], 0);
}

static void transforms_are_checked(void **state) {
    (void)state;
    float transform[12] = {1, 0, 0, GIRIH_MAX_COORDINATE, 0, 1, 0, 0, 0, 0, 1, 0};
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_check_transform(transform, 5, &error), GIRIH_OK);
    transform[6] = NAN;
    assert_int_equal(girih_check_transform(transform, 5, &error), GIRIH_ERROR_INVALID_DATA);
    assert_string_equal(error.message, "plan: element 6 of instance 5's transform is nan; it must "
                                       "be finite and at most 1e+15");
    assert_int_equal(girih_check_transform(transform, 5, NULL), GIRIH_ERROR_INVALID_DATA);
}

// Everything that has an owner names it by the scene's numbers, and the previous frame's vertices
// are the current ones.
static void scenes_name_owners(void **state) {
    (void)state;
    const girih_mesh *meshes[3] = {make_cube(1), make_nothing(), make_seam_sphere(6, 4)};
    for (int previous = 0; previous < 2; ++previous) {
        girih_arrays arrays = {.frame = {.instance_count = 0}};
        girih_scene_table table;
        assert_int_equal(girih_pack_scene(&arrays, &table, meshes, 3, previous, NULL), GIRIH_OK);
        const uint32_t vertices = meshes[0]->vertex_count + meshes[2]->vertex_count;
        const size_t words = (size_t)vertices * GIRIH_VERTEX_WORDS;
        assert_int_equal(arrays.frame.previous_vertices, previous ? vertices : 0);
        assert_int_equal(arrays.count[GIRIH_BIND_VERTICES], previous ? 2 * words : words);
        if (previous) {
            assert_memory_equal(arrays.words[GIRIH_BIND_VERTICES],
                                arrays.words[GIRIH_BIND_VERTICES] + words,
                                words * sizeof(uint32_t));
        }
        assert_int_equal(arrays.count[GIRIH_BIND_POINTS], 2 * vertices);
        for (uint32_t n = 0; n < 3; ++n) {
            const girih_mesh *mesh = meshes[n];
            const girih_scene_mesh *place = &table.meshes[n];
            const uint32_t corner = 3 * place->first_triangle;
            const uint32_t *pair =
                arrays.words[GIRIH_BIND_POINTS] + 2 * (size_t)place->first_vertex;
            for (uint32_t v = 0; v < mesh->vertex_count; ++v, pair += 2) {
                assert_int_equal(pair[0], mesh->vertex_point[v] + place->first_vertex);
                assert_int_equal(pair[1], mesh->vertex_owner[v] + corner);
                assert_int_equal(arrays.words[GIRIH_BIND_TRIANGLE_VERTICES][pair[1]],
                                 v + place->first_vertex);
            }
            pair = arrays.words[GIRIH_BIND_EDGES] + 2 * (size_t)place->first_edge;
            for (uint32_t e = 0; e < mesh->edge_count; ++e, pair += 2) {
                assert_int_equal(pair[0], mesh->edge_weld_edge[e] + place->first_weld_edge);
                assert_int_equal(pair[1], mesh->edge_owner[e] + corner);
            }
            pair = arrays.words[GIRIH_BIND_WELD_EDGES] + 2 * (size_t)place->first_weld_edge;
            for (uint32_t e = 0; e < mesh->weld_edge_count; ++e, pair += 2) {
                assert_int_equal(pair[0], mesh->weld_edge_edge[e] + place->first_edge);
                assert_int_equal(pair[1], mesh->weld_edge_owner[e] + corner);
            }
        }
        girih_arrays_free(&arrays, 0, GIRIH_BIND_COUNT);
        girih_free(table.meshes);
    }
    for (int n = 0; n < 3; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
}

// Room for the previous position changes where vertices stand, and nothing else.
static void strides_leave_room(void **state) {
    (void)state;
    const girih_mesh *mesh = make_seam_sphere(6, 4);
    const girih_frame frame = {.segments = 3};
    girih_plan_shape shape = {.mode = GIRIH_MODE_BAKED,
                              .outputs = GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_NO_DRAW};
    stages a = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, shape);
    shape.previous = 1;
    stages b = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, shape);
    stages_refine(&a, &frame, GIRIH_SURFACE_PN);
    stages_refine(&b, &frame, GIRIH_SURFACE_PN);
    assert_int_equal(a.arrays.frame.attribute_stride, 5);
    assert_int_equal(b.arrays.frame.attribute_stride, 8);
    for (size_t v = 0; v < stages_statistics(&a).output_vertices; ++v) {
        assert_memory_equal(a.arrays.words[GIRIH_BIND_OUT_ATTRIBUTES] + 5 * v,
                            b.arrays.words[GIRIH_BIND_OUT_ATTRIBUTES] + 8 * v, 20);
    }
    stages_end(&a);
    stages_end(&b);
    girih_mesh_destroy(mesh);
}

// BLOCKS leads to the right instance from any number, over instances that have none.
static void check_blocks(const stages *s, uint32_t count, uint32_t first, uint32_t blocks) {
    const uint32_t *records = s->arrays.words[GIRIH_BIND_INSTANCES];
    uint32_t expected = 0;
    for (uint32_t number = 0; number < count; ++number) {
        while (records[(expected + 1) * GIRIH_INSTANCE_WORDS + first] <= number) {
            ++expected;
        }
        const uint32_t block = s->arrays.words[GIRIH_BIND_BLOCKS][blocks + number / GIRIH_BLOCK];
        assert_true(block <= expected);
        assert_true(records[block * GIRIH_INSTANCE_WORDS + first] <=
                    number / GIRIH_BLOCK * GIRIH_BLOCK);
        assert_true(records[(block + 1) * GIRIH_INSTANCE_WORDS + first] >
                    number / GIRIH_BLOCK * GIRIH_BLOCK);
    }
    assert_int_equal(records[s->arrays.frame.instance_count * GIRIH_INSTANCE_WORDS + first], count);
}

static void instances_are_found(void **state) {
    (void)state;
    const girih_mesh *meshes[4] = {make_nothing(), make_triangle(), make_cube(1), make_torus(9, 7)};
    girih_instance instances[200];
    uint64_t random = 99;
    for (uint32_t n = 0; n < 200; ++n) {
        instances[n] = once;
        instances[n].mesh = draw_number(&random) % 4;
    }
    stages s = stages_begin(girih_catalogue_dyadic(), meshes, 4, instances, 200,
                            (girih_plan_shape){.mode = GIRIH_MODE_WELDED, .serial_sort = 1});
    const girih_frame_block *frame = &s.arrays.frame;
    check_blocks(&s, frame->triangle_count, GIRIH_INSTANCE_FIRST_TRIANGLE, frame->triangle_blocks);
    check_blocks(&s, frame->edge_count, GIRIH_INSTANCE_FIRST_EDGE, frame->edge_blocks);
    check_blocks(&s, frame->weld_edge_count, GIRIH_INSTANCE_FIRST_WELD_EDGE, frame->weld_blocks);
    check_blocks(&s, frame->corner_count, GIRIH_INSTANCE_FIRST_CORNER, frame->corner_blocks);
    const uint32_t *records = s.arrays.words[GIRIH_BIND_INSTANCES];
    uint32_t corner = 0;
    for (uint32_t n = 0; n < 200; ++n) {
        const girih_scene_mesh *place = &s.table.meshes[instances[n].mesh];
        const uint32_t *record = records + (size_t)n * GIRIH_INSTANCE_WORDS;
        assert_int_equal(place->first_triangle + record[GIRIH_INSTANCE_TRIANGLE_DELTA],
                         record[GIRIH_INSTANCE_FIRST_TRIANGLE]);
        assert_int_equal(place->first_edge + record[GIRIH_INSTANCE_EDGE_DELTA],
                         record[GIRIH_INSTANCE_FIRST_EDGE]);
        assert_int_equal(place->first_weld_edge + record[GIRIH_INSTANCE_WELD_DELTA],
                         record[GIRIH_INSTANCE_FIRST_WELD_EDGE]);
        assert_int_equal((uint32_t)(place->first_vertex + record[GIRIH_INSTANCE_VERTEX_DELTA]),
                         corner);
        assert_int_equal((uint32_t)(place->first_edge + record[GIRIH_INSTANCE_SEAM_DELTA]),
                         place->first_seam);
        corner += place->vertex_count;
    }
    assert_int_equal(frame->corner_count, corner);
    // The sort's blocks: all keys, and few enough keys each that there are many.
    assert_int_equal(frame->sort_block, 128);
    assert_true(frame->sort_block_count * frame->sort_block >= frame->triangle_count);
    stages_end(&s);
    for (int n = 0; n < 4; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gives_what_the_stages_give),
        cmocka_unit_test(overflow_is_drawn_at_level_0),
        cmocka_unit_test(what_cannot_be_done_is_refused),
        cmocka_unit_test(too_large_outputs_are_refused),
        cmocka_unit_test(too_many_parts_are_refused),
        cmocka_unit_test(nothing_gives_nothing),
        cmocka_unit_test(failed_allocations_are_reported),
        cmocka_unit_test(normals_follow_the_inverse_transpose),
        cmocka_unit_test(transforms_are_checked),
        cmocka_unit_test(scenes_name_owners),
        cmocka_unit_test(strides_leave_room),
        cmocka_unit_test(instances_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
