// Stage 5: the laws of evaluate, on the CPU.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "stages.h"

#define CLOSED_MESHES 5
#define SEEDS 250

static const girih_plan_shape baked = {.mode = GIRIH_MODE_BAKED,
                                       .outputs = GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_INDICES |
                                                  GIRIH_OUTPUT_SOURCES};

static const girih_mesh *make_closed(int n) {
    switch (n) {
    case 0:
        return make_icosphere(1);
    case 1:
        return make_torus(8, 6);
    case 2:
        return make_cube(1);
    case 3:
        return make_cube(0);
    default:
        return make_seam_sphere(8, 6);
    }
}

// As it is; mirrored and moved; sheared and moved. Apart, so that no point falls on another's.
static const girih_instance three_instances[3] = {
    {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {0, {-1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0}},
    {0, {0.9f, 0.3f, -0.1f, -4, -0.2f, 1.1f, 0.4f, 1, 0.3f, -0.2f, 0.7f, 0.5f}},
};

static uint32_t edge_segments(const stages *s, uint32_t edge) {
    const uint32_t level = s->arrays.words[GIRIH_BIND_LEVELS][edge];
    return s->arrays.frame.linear_spacing ? level + 1 : 1u << level;
}

static uint64_t triangles_of(const stages *s, const girih_mesh *mesh, uint32_t instance,
                             uint32_t triangle) {
    uint32_t levels[3];
    for (uint32_t n = 0; n < 3; ++n) {
        levels[n] = s->arrays.words[GIRIH_BIND_LEVELS][instance * mesh->edge_count +
                                                       mesh->triangle_edges[3 * triangle + n]];
    }
    return stages_pattern_triangles(s, levels);
}

static void triangle_positions(const stages *s, uint32_t triangle, double p[3][3]) {
    for (uint32_t corner = 0; corner < 3; ++corner) {
        float position[3];
        stages_position(s, s->arrays.words[GIRIH_BIND_OUT_INDICES][3 * triangle + corner],
                        position);
        for (int axis = 0; axis < 3; ++axis) {
            p[corner][axis] = (double)position[axis];
        }
    }
}

static void doubled_area(double p[3][3], double area[3]) {
    for (int n = 0; n < 3; ++n) {
        const int y = (n + 1) % 3, z = (n + 2) % 3;
        area[n] =
            (p[1][y] - p[0][y]) * (p[2][z] - p[0][z]) - (p[1][z] - p[0][z]) * (p[2][y] - p[0][y]);
    }
}

// Of the output triangles of one instance.
static void area_and_volume(const stages *s, uint32_t instance, double *area, double *volume) {
    *area = *volume = 0.0;
    const uint64_t count = stages_statistics(s).output_triangles;
    for (uint32_t triangle = 0; triangle < count; ++triangle) {
        if (s->arrays.words[GIRIH_BIND_OUT_SOURCES][2 * triangle] == instance) {
            double p[3][3], normal[3];
            triangle_positions(s, triangle, p);
            doubled_area(p, normal);
            *area +=
                sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / 2;
            *volume += (normal[0] * (p[0][0] - 4.0 * (instance == 1)) + normal[1] * p[0][1] +
                        normal[2] * p[0][2]) / 6;
        }
    }
}

static double mesh_area(const girih_mesh *mesh) {
    double area = 0.0;
    for (uint32_t triangle = 0; triangle < mesh->triangle_count; ++triangle) {
        double p[3][3], normal[3];
        for (uint32_t n = 0; n < 9; ++n) {
            const size_t vertex = mesh->triangle_vertices[3 * triangle + n / 3];
            p[n / 3][n % 3] = (double)mesh->positions[3 * vertex + n % 3];
        }
        doubled_area(p, normal);
        area += sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / 2;
    }
    return area;
}

static void check_counts(const stages *s, const girih_mesh *mesh) {
    uint64_t expected = 0;
    for (uint32_t instance = 0; instance < 3; ++instance) {
        for (uint32_t triangle = 0; triangle < mesh->triangle_count; ++triangle) {
            expected += triangles_of(s, mesh, instance, triangle);
        }
    }
    assert_int_equal(stages_statistics(s).output_triangles, expected);
}

// Every output edge is used by two triangles in opposite directions, by the exact bits of its ends;
// the winding is kept, mirrored or not; flat areas are the input's.
static void closed_meshes_stay_closed(void **state) {
    (void)state;
    for (int n = 0; n < CLOSED_MESHES; ++n) {
        const girih_mesh *mesh = make_closed(n);
        assert_int_equal(mesh->open_edges + mesh->nonmanifold_edges + mesh->flipped_edges, 0);
        const double input_area = mesh_area(mesh);
        for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
            stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, three_instances, 3, baked);
            for (uint32_t seed = 0; seed < SEEDS; ++seed) {
                const girih_frame frame = {
                    .rule = GIRIH_LEVEL_RANDOM, .segments = 2 + seed % 5, .seed = seed};
                stages_refine(&s, &frame, (girih_surface)surface);
                check_counts(&s, mesh);
                const edge_audit audit = audit_positions(&s);
                assert_int_equal(audit.open, 0);
                assert_int_equal(audit.nonmanifold, 0);
                assert_int_equal(audit.flipped, 0);
                assert_int_equal(audit.degenerate, 0);
                assert_int_equal(audit.edges * 2, stages_statistics(&s).output_triangles * 3);
                for (uint32_t instance = 0; instance < 3 && seed % 10 == 0; ++instance) {
                    double area, volume;
                    area_and_volume(&s, instance, &area, &volume);
                    assert_true(volume > 0.2);
                    assert_true(surface == GIRIH_SURFACE_PN || instance == 2 ||
                                fabs(area / input_area - 1.0) < 1e-5);
                }
            }
            stages_end(&s);
        }
        girih_mesh_destroy(mesh);
    }
}

// Open, non-manifold and flipped edges stay what they are, segment by segment, and nothing else
// opens.
static void soups_keep_their_edges(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        const girih_mesh *mesh = make_soup(60, 24, seed);
        stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
        for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
            const girih_frame frame = {
                .rule = GIRIH_LEVEL_RANDOM, .segments = 6, .seed = (uint32_t)seed};
            stages_refine(&s, &frame, (girih_surface)surface);
            uint64_t open = 0, nonmanifold = 0, others = 0;
            for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
                const uint32_t segments = edge_segments(&s, edge);
                open += mesh->edge_uses[edge] == 1 ? segments : 0;
                nonmanifold += mesh->edge_uses[edge] > 2 ? segments : 0;
                others += mesh->edge_uses[edge] == 2 ? segments : 0;
            }
            const edge_audit audit = audit_positions(&s);
            assert_int_equal(audit.open, open);
            assert_int_equal(audit.nonmanifold, nonmanifold);
            assert_true(audit.flipped <= others);
            assert_true(mesh->flipped_edges == 0 ? audit.flipped == 0
                                                 : audit.flipped >= mesh->flipped_edges);
            assert_int_equal(audit.degenerate, 0);
        }
        stages_end(&s);
        girih_mesh_destroy(mesh);
    }
}

// Half of the smallest number is -0 or +0; which of them must not depend on the third corner.
static void signed_zeros_agree(void **state) {
    (void)state;
    const float least = -0x1p-149f;
    const float positions[4][3] = {{0, least, 0}, {1, least, 0}, {0.5f, 1, 0.5f}, {0.5f, -1, 0.5f}};
    static const uint32_t indices[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const girih_mesh_desc desc = {.vertex_count = 4,
                                  .positions = positions[0],
                                  .indices = indices,
                                  .index_count = 12};
    const girih_mesh *mesh = NULL;
    assert_int_equal(girih_mesh_create(&desc, &mesh, NULL), GIRIH_OK);
    assert_int_equal(mesh->open_edges + mesh->flipped_edges, 0);
    stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, three_instances, 1, baked);
    for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
        for (uint32_t segments = 1; segments <= 8; ++segments) {
            const girih_frame frame = {.segments = segments};
            stages_refine(&s, &frame, (girih_surface)surface);
            const edge_audit audit = audit_positions(&s);
            assert_int_equal(audit.open + audit.nonmanifold + audit.flipped, 0);
            for (uint32_t n = 0; n < stages_statistics(&s).output_vertices * 3; ++n) {
                assert_int_not_equal(s.arrays.words[GIRIH_BIND_OUT_POSITIONS][n], 0x80000000u);
            }
        }
    }
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

static void hard_cubes_stay_cubes(void **state) {
    (void)state;
    const girih_mesh *mesh = make_cube(1);
    stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, three_instances, 1, baked);
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = seed};
        stages_refine(&s, &frame, GIRIH_SURFACE_PN);
        for (uint32_t n = 0; n < stages_statistics(&s).output_vertices; ++n) {
            float p[3], normal[3];
            stages_position(&s, n, p);
            stages_normal(&s, n, normal);
            const float largest = fmaxf(fmaxf(fabsf(p[0]), fabsf(p[1])), fabsf(p[2]));
            assert_true(fabsf(largest - 0.5f) < 1e-6f);
            for (int axis = 0; axis < 3; ++axis) {
                assert_true(fabsf(normal[axis]) < 1e-6f ||
                            (fabsf(fabsf(normal[axis]) - 1.0f) < 1e-6f &&
                             fabsf(p[axis] - copysignf(0.5f, normal[axis])) < 1e-6f));
            }
        }
        double area, volume;
        area_and_volume(&s, 0, &area, &volume);
        assert_true(fabs(area - 6.0) < 1e-5 && fabs(volume - 1.0) < 1e-5);
    }
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

// An edge's midpoint is (Pa + Pb) / 2 - (w_ab Na + w_ba Nb) / 8 (Vlachos et al. 2001).
static void edge_midpoints(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        const girih_mesh *mesh = make_soup(50, 0, seed);
        stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0, baked);
        const girih_frame frame = {.segments = 2};
        stages_refine(&s, &frame, GIRIH_SURFACE_PN);
        const uint32_t *items = s.arrays.words[GIRIH_BIND_ITEMS];
        for (uint32_t n = 0; n < mesh->triangle_count; ++n) {
            // All levels are equal, so lambda is 0 and the pattern's vertices are P1 P2 P3 M12 M23
            // M31.
            const uint32_t *v = mesh->triangle_vertices + 3 * items[2 * n];
            for (int edge = 0; edge < 3; ++edge) {
                const float *a = mesh->positions + 3 * v[edge];
                const float *b = mesh->positions + 3 * v[(edge + 1) % 3];
                const float *na = mesh->normals + 3 * v[edge];
                const float *nb = mesh->normals + 3 * v[(edge + 1) % 3];
                double wab = 0.0, wba = 0.0;
                for (int axis = 0; axis < 3; ++axis) {
                    wab += ((double)b[axis] - (double)a[axis]) * (double)na[axis];
                    wba += ((double)a[axis] - (double)b[axis]) * (double)nb[axis];
                }
                float middle[3], corner[3];
                stages_position(&s, 6 * n + 3 + (uint32_t)edge, middle);
                stages_position(&s, 6 * n + (uint32_t)edge, corner);
                assert_memory_equal(corner, a, sizeof corner);
                for (int axis = 0; axis < 3; ++axis) {
                    const double expected = ((double)a[axis] + (double)b[axis]) / 2 -
                                            (wab * (double)na[axis] + wba * (double)nb[axis]) / 8;
                    assert_true(fabs((double)middle[axis] - expected) < 1e-6);
                }
            }
        }
        stages_end(&s);
        girih_mesh_destroy(mesh);
    }
}

// Under the identity the corners are the input's, bit for bit, their attributes and normals too.
static void corners_are_the_inputs(void **state) {
    (void)state;
    for (int n = 0; n < CLOSED_MESHES; ++n) {
        const girih_mesh *mesh = make_closed(n);
        stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0,
                                (girih_plan_shape){.mode = GIRIH_MODE_WELDED,
                                                   .outputs = GIRIH_OUTPUT_NO_DRAW |
                                                              GIRIH_OUTPUT_INDICES});
        for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
            const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 8, .seed = 3};
            stages_refine(&s, &frame, (girih_surface)surface);
            // Welded corners are numbered as the input's vertices.
            assert_memory_equal(s.arrays.words[GIRIH_BIND_OUT_POSITIONS], mesh->positions,
                                mesh->vertex_count * 3 * sizeof(float));
            for (uint32_t vertex = 0; vertex < mesh->vertex_count; ++vertex) {
                float normal[5];
                memcpy(normal, s.arrays.words[GIRIH_BIND_OUT_ATTRIBUTES] + 5 * vertex,
                       sizeof normal);
                for (uint32_t axis = 0; axis < 3; ++axis) {
                    assert_true(fabsf(normal[axis] - mesh->normals[3 * vertex + axis]) < 3e-7f);
                }
                for (uint32_t a = 0; a < 2; ++a) {
                    assert_true(normal[3 + a] == mesh->attributes[2 * vertex + a]);
                }
            }
        }
        stages_end(&s);
        girih_mesh_destroy(mesh);
    }
}

// Normals have unit length and point outward, also where a transform mirrors or shears.
static void normals_point_outward(void **state) {
    (void)state;
    const girih_mesh *mesh = make_icosphere(2);
    stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, three_instances, 3, baked);
    const girih_frame frame = {.segments = 4};
    for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
        stages_refine(&s, &frame, (girih_surface)surface);
        for (uint32_t n = 0; n < stages_statistics(&s).output_triangles; ++n) {
            double p[3][3], face[3];
            triangle_positions(&s, n, p);
            doubled_area(p, face);
            const double length = sqrt(face[0] * face[0] + face[1] * face[1] + face[2] * face[2]);
            for (uint32_t corner = 0; corner < 3; ++corner) {
                float normal[3];
                stages_normal(&s, s.arrays.words[GIRIH_BIND_OUT_INDICES][3 * n + corner], normal);
                double square = 0.0, cosine = 0.0;
                for (int axis = 0; axis < 3; ++axis) {
                    square += (double)normal[axis] * (double)normal[axis];
                    cosine += (double)normal[axis] * face[axis] / length;
                }
                assert_true(fabs(square - 1.0) < 1e-6);
                assert_true(cosine > 0.9);
            }
        }
    }
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

// The instanced mode's patches: corners and vertices as in the baked output, the key as sorted.
static void patches_agree_with_baked_corners(void **state) {
    (void)state;
    const girih_mesh *mesh = make_seam_sphere(7, 5);
    for (int surface = GIRIH_SURFACE_FLAT; surface <= GIRIH_SURFACE_PN; ++surface) {
        const uint32_t words =
            surface == GIRIH_SURFACE_PN ? GIRIH_PATCH_WORDS_PN : GIRIH_PATCH_WORDS_FLAT;
        const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 8, .seed = 3};
        stages b = stages_begin(girih_catalogue_linear(), &mesh, 1, three_instances, 3, baked);
        stages i = stages_begin(girih_catalogue_linear(), &mesh, 1, three_instances, 3,
                                (girih_plan_shape){.mode = GIRIH_MODE_INSTANCED});
        stages_refine(&b, &frame, (girih_surface)surface);
        stages_refine(&i, &frame, (girih_surface)surface);
        for (uint32_t group = 0; group < b.arrays.frame.group_count; ++group) {
            const uint32_t *bounds = b.arrays.words[GIRIH_BIND_GROUPS] + GIRIH_GROUP_WORDS * (size_t)group;
            const uint32_t *patterns = b.arrays.words[GIRIH_BIND_PATTERNS];
            const uint32_t rank = patterns[b.arrays.frame.pattern_count * GIRIH_PATTERN_WORDS +
                                           group % b.arrays.frame.range_count];
            const uint32_t vertices = patterns[rank * GIRIH_PATTERN_WORDS + GIRIH_PATTERN_VERTICES];
            uint32_t vertex = bounds[GIRIH_GROUP_FIRST_VERTEX];
            for (uint32_t item = bounds[GIRIH_GROUP_FIRST]; item < bounds[GIRIH_GROUP_END];
                 ++item) {
                const uint32_t *patch =
                    i.arrays.words[GIRIH_BIND_OUT_ATTRIBUTES] + (size_t)item * words;
                for (uint32_t corner = 0; corner < 3; ++corner) {
                    float expected[3], got[3];
                    stages_position(&b, vertex + corner, expected);
                    memcpy(got, patch + 3 * corner, sizeof got);
                    for (int axis = 0; axis < 3; ++axis) {
                        assert_true(got[axis] == expected[axis]);
                    }
                }
                const uint32_t *ids = patch + (surface == GIRIH_SURFACE_PN ? 48 : 18);
                const uint32_t triangle = i.arrays.words[GIRIH_BIND_ITEMS][2 * item];
                const uint32_t key = i.arrays.words[GIRIH_BIND_ITEMS][2 * item + 1];
                assert_int_equal(ids[3], key);
                assert_int_equal(key >> 3, group);
                const uint32_t *v =
                    mesh->triangle_vertices + 3 * (triangle % mesh->triangle_count);
                assert_true(ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0]);
                for (int n = 0; n < 3; ++n) {
                    assert_true(ids[n] == v[0] || ids[n] == v[1] || ids[n] == v[2]);
                }
                vertex += vertices;
            }
        }
        stages_end(&b);
        stages_end(&i);
    }
    girih_mesh_destroy(mesh);
}

// On a dynamic mesh every edge between vertices of different numbers is a seam. Where the normals
// are equal, the mean of both sides' curves is either's: the output is the same to the bit.
static void dynamic_seams_change_nothing(void **state) {
    (void)state;
    for (int n = 0; n < CLOSED_MESHES; ++n) {
        const girih_mesh *mesh = make_closed(n);
        const girih_mesh *fixed = make_copy(mesh, NULL, 1, 0);
        const girih_mesh *dynamic = make_copy(mesh, NULL, 1, 1);
        assert_int_equal(dynamic->seam_count, dynamic->edge_count);
        assert_int_equal(fixed->seam_count, mesh->seam_count);
        assert_int_equal(fixed->dynamic, 0);
        assert_int_equal(dynamic->dynamic, 1);
        stages a = stages_begin(girih_catalogue_linear(), &fixed, 1, three_instances, 3, baked);
        stages b = stages_begin(girih_catalogue_linear(), &dynamic, 1, three_instances, 3, baked);
        for (uint32_t seed = 0; seed < 10; ++seed) {
            const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 9, .seed = seed};
            stages_refine(&a, &frame, GIRIH_SURFACE_PN);
            stages_refine(&b, &frame, GIRIH_SURFACE_PN);
            for (uint32_t binding = GIRIH_BIND_OUT_POSITIONS; binding <= GIRIH_BIND_OUT_SOURCES;
                 ++binding) {
                assert_int_equal(a.arrays.count[binding], b.arrays.count[binding]);
                assert_memory_equal(a.arrays.words[binding], b.arrays.words[binding],
                                    (size_t)a.arrays.count[binding] * sizeof(uint32_t));
            }
        }
        stages_end(&a);
        stages_end(&b);
        girih_mesh_destroy(fixed);
        girih_mesh_destroy(dynamic);
        girih_mesh_destroy(mesh);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_meshes_stay_closed),
        cmocka_unit_test(soups_keep_their_edges),
        cmocka_unit_test(signed_zeros_agree),
        cmocka_unit_test(hard_cubes_stay_cubes),
        cmocka_unit_test(edge_midpoints),
        cmocka_unit_test(corners_are_the_inputs),
        cmocka_unit_test(normals_point_outward),
        cmocka_unit_test(patches_agree_with_baked_corners),
        cmocka_unit_test(dynamic_seams_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
