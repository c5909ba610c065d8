// Own surfaces on the CPU: watertight whatever the surface does, and their normals.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "stages.h"

// As it is; mirrored and moved; sheared and moved. Apart, so that no point falls on another's.
static const girih_instance three_instances[3] = {
    {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {0, {-2, 0, 0, 9, 0, 2, 0, 0, 0, 0, 2, 0}},
    {0, {0.9f, 0.3f, -0.1f, -9, -0.2f, 1.1f, 0.4f, 1, 0.3f, -0.2f, 0.7f, 0.5f}},
};

static const girih_mesh *make_closed(int n) {
    if (n < 5) {
        return n == 0   ? make_icosphere(1)
               : n == 1 ? make_torus(8, 6)
               : n == 2 ? make_cube(1)
               : n == 3 ? make_cube(0)
                        : make_seam_sphere(8, 6);
    }
    const girih_mesh *mesh = make_torus(8, 6);
    const girih_mesh *apart = make_copy(mesh, NULL, 1, n == 6);
    girih_mesh_destroy(mesh);
    return apart;
}
#define CLOSED_MESHES 7

static girih_cpu_desc describe(const girih_mesh *const *mesh, girih_cpu_surface own,
                               girih_surface base, girih_mode mode) {
    return (girih_cpu_desc){.catalogue = girih_catalogue_linear(),
                            .meshes = mesh,
                            .mesh_count = 1,
                            .instances = three_instances,
                            .instance_count = 3,
                            .surface = GIRIH_SURFACE_OWN,
                            .mode = mode,
                            .outputs = GIRIH_OUTPUT_SOURCES,
                            .own = own,
                            .base = base};
}

static girih_cpu_output refine(const girih_cpu_desc *desc, const girih_frame *frame) {
    girih_cpu_output output;
    girih_error error = {GIRIH_OK, ""};
    if (girih_cpu_refine(desc, frame, &output, &error) != GIRIH_OK) {
        fail_msg("%s", error.message);
    }
    return output;
}

static const float *normal_of(const girih_cpu_output *output, uint32_t vertex) {
    return output->attributes + (size_t)vertex * (3 + output->attribute_floats);
}

static double dot(const float *a, const float *b) {
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

// --- Surfaces ----------------------------------------------------------------------------------

static void identity(void *user, const girih_cpu_patch *patch, const float b[3],
                     float position[3]) {
    (void)user;
    girih_cpu_base_position(patch, b, position);
}

// Everything in it differs between the triangles at an edge: their numbers, the order of their
// corners, and what the corners say.
static void torn(void *user, const girih_cpu_patch *patch, const float b[3], float position[3]) {
    (void)user;
    float normal[3];
    girih_cpu_base_position(patch, b, position);
    girih_cpu_base_normal(patch, b, normal);
    const float *attributes = patch->mesh->attributes + 2 * (size_t)patch->vertices[1];
    const float phase = (float)patch->triangle * 1.7f + (float)patch->material + attributes[0];
    const float height =
        patch->scale * 0.02f * sinf(phase + 37.0f * b[0] + 11.0f * b[1] * b[2] - 5.0f * b[2]);
    for (int axis = 0; axis < 3; ++axis) {
        position[axis] += height * (normal[axis] + patch->normal[0][axis]);
    }
}

// --- Laws --------------------------------------------------------------------------------------

static void any_surface_is_watertight(void **state) {
    (void)state;
    uint64_t triangles = 0;
    for (int n = 0; n < CLOSED_MESHES; ++n) {
        const girih_mesh *mesh = make_closed(n);
        for (uint32_t seed = 0; seed < 24; ++seed) {
            const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 9, .seed = seed};
            const girih_surface base = seed % 2 ? GIRIH_SURFACE_PN : GIRIH_SURFACE_FLAT;
            girih_cpu_desc desc = describe(&mesh, torn, base, GIRIH_MODE_BAKED);
            // The dyadic catalogue is packed in a tenth of the time.
            desc.catalogue = seed % 8 < 2 ? girih_catalogue_linear() : girih_catalogue_dyadic();
            girih_cpu_output baked = refine(&desc, &frame);
            desc.mode = GIRIH_MODE_WELDED;
            desc.outputs |= GIRIH_OUTPUT_CLOSED_INDICES;
            girih_cpu_output welded = refine(&desc, &frame);
            const uint64_t count = baked.statistics.output_triangles;
            assert_int_equal(welded.statistics.output_triangles, count);
            const edge_audit audit = audit_points(baked.positions, baked.statistics.output_vertices,
                                                  baked.indices, count);
            assert_int_equal(audit.open + audit.nonmanifold + audit.flipped + audit.degenerate, 0);
            assert_int_equal(audit.edges * 2, count * 3);
            const edge_audit closed = audit_indices(welded.closed_indices, count);
            assert_memory_equal(&audit, &closed, sizeof audit);
            // Positions, normals and attributes alike, whoever wrote a shared vertex last.
            for (uint64_t corner = 0; corner < 3 * count; ++corner) {
                const uint32_t b = baked.indices[corner];
                const uint32_t w = welded.indices[corner];
                const uint32_t c = welded.closed_indices[corner];
                const float *position = baked.positions + 3 * (size_t)b;
                assert_memory_equal(position, welded.positions + 3 * (size_t)w, 12);
                assert_memory_equal(position, welded.positions + 3 * (size_t)c, 12);
                assert_memory_equal(normal_of(&baked, b), normal_of(&welded, w), 20);
            }
            triangles += count;
            girih_cpu_output_free(&baked);
            girih_cpu_output_free(&welded);
        }
        girih_mesh_destroy(mesh);
    }
    assert_true(triangles > 500000);
}

// Shared places are where the lowest triangle puts them, and so are their normals where the input's
// are the same.
static void owners_decide(void **state) {
    (void)state;
    const girih_mesh *mesh = make_torus(8, 6);
    const girih_frame frame = {.segments = 1};
    girih_cpu_desc desc = describe(&mesh, torn, GIRIH_SURFACE_PN, GIRIH_MODE_WELDED);
    desc.instance_count = 1;
    girih_cpu_output output = refine(&desc, &frame);
    for (uint32_t triangle = 0; triangle < 7; ++triangle) {
        const uint32_t *corners = mesh->triangle_vertices + 3 * (size_t)triangle;
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t v = corners[corner];
            if (mesh->vertex_owner[v] != 3 * triangle + corner) {
                continue;
            }
            girih_cpu_patch patch = {.mesh = mesh, .triangle = triangle, .scale = 1.0f};
            memcpy(patch.vertices, corners, sizeof patch.vertices);
            for (int k = 0; k < 3; ++k) {
                memcpy(patch.position[k], mesh->positions + 3 * (size_t)corners[k], 12);
                memcpy(patch.normal[k], mesh->normals + 3 * (size_t)corners[k], 12);
            }
            const float height =
                0.02f * sinf((float)triangle * 1.7f + mesh->attributes[2 * (size_t)corners[1]] +
                             (corner == 0   ? 37.0f
                              : corner == 2 ? -5.0f
                                            : 0.0f));
            for (int axis = 0; axis < 3; ++axis) {
                const float expected =
                    patch.position[corner][axis] +
                    height * (patch.normal[corner][axis] + patch.normal[0][axis]);
                assert_true(fabsf(output.positions[3 * (size_t)v + (size_t)axis] - expected) <
                            2e-6f);
            }
        }
    }
    girih_cpu_output_free(&output);
    girih_mesh_destroy(mesh);
}

static void check_patch(void *user, const girih_cpu_patch *patch, const float b[3],
                        float position[3]) {
    const girih_mesh *mesh = patch->mesh;
    assert_ptr_equal(mesh, *(const girih_mesh *const *)user);
    assert_true(patch->triangle < mesh->triangle_count && patch->instance < 3);
    assert_true(b[0] >= 0.0f && b[1] >= 0.0f && b[2] >= 0.0f);
    assert_true(fabsf(b[0] + b[1] + b[2] - 1.0f) < 1e-6f);
    const float *t = three_instances[patch->instance].transform;
    const float scales[3] = {
        1.0f, 2.0f,
        cbrtf(0.9f * (1.1f * 0.7f + 0.08f) - 0.3f * (-0.14f - 0.12f) - 0.1f * (0.04f - 0.33f))};
    assert_true(fabsf(patch->scale - scales[patch->instance]) < 1e-6f);
    uint32_t part = 0;
    while (3 * patch->triangle >=
           mesh->submeshes[part].first_index + mesh->submeshes[part].index_count) {
        ++part;
    }
    assert_int_equal(patch->material, mesh->submeshes[part].material);
    for (uint32_t corner = 0; corner < 3; ++corner) {
        const uint32_t v = mesh->triangle_vertices[3 * (size_t)patch->triangle + corner];
        assert_int_equal(patch->vertices[corner], v);
        const float *p = mesh->positions + 3 * (size_t)v;
        for (int axis = 0; axis < 3; ++axis) {
            const float *row = t + 4 * axis;
            assert_true(fabs((double)patch->position[corner][axis] -
                             (dot(row, p) + (double)row[3])) < 1e-5);
        }
        assert_true(fabs(dot(patch->normal[corner], patch->normal[corner]) - 1.0) < 1e-6);
    }
    girih_cpu_base_position(patch, b, position);
}

static void surfaces_are_told_where_they_are(void **state) {
    (void)state;
    const girih_mesh *mesh = make_seam_sphere(8, 6);
    girih_cpu_desc desc = describe(&mesh, check_patch, GIRIH_SURFACE_PN, GIRIH_MODE_WELDED);
    desc.own_user = (void *)(uintptr_t)&mesh;
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 7, .seed = 3};
    girih_cpu_output output = refine(&desc, &frame);
    girih_cpu_output_free(&output);
    girih_mesh_destroy(mesh);
}

// --- Normals -----------------------------------------------------------------------------------

// The identity over a base gives the base.
static void identity_gives_the_base(void **state) {
    (void)state;
    for (int n = 0; n < CLOSED_MESHES; ++n) {
        const girih_mesh *mesh = make_closed(n);
        for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
            for (int base = GIRIH_SURFACE_FLAT; base <= GIRIH_SURFACE_PN; ++base) {
                const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 9, .seed = 5};
                girih_cpu_desc desc =
                    describe(&mesh, identity, (girih_surface)base, (girih_mode)mode);
                girih_cpu_output own = refine(&desc, &frame);
                desc.surface = (girih_surface)base;
                girih_cpu_output library = refine(&desc, &frame);
                assert_int_equal(own.statistics.output_vertices,
                                 library.statistics.output_vertices);
                assert_memory_equal(own.indices, library.indices,
                                    (size_t)own.statistics.output_triangles * 12);
                for (uint32_t v = 0; v < own.statistics.output_vertices; ++v) {
                    for (size_t axis = 0; axis < 3; ++axis) {
                        assert_true(fabsf(own.positions[3 * (size_t)v + axis] -
                                          library.positions[3 * (size_t)v + axis]) < 2e-6f);
                        assert_true(fabsf(normal_of(&own, v)[axis] - normal_of(&library, v)[axis]) <
                                    1e-3f);
                    }
                    assert_memory_equal(normal_of(&own, v) + 3, normal_of(&library, v) + 3, 8);
                }
                girih_cpu_output_free(&own);
                girih_cpu_output_free(&library);
            }
        }
        girih_mesh_destroy(mesh);
    }
}

static void cubes_keep_six_normals(void **state) {
    (void)state;
    const girih_mesh *mesh = make_cube(1);
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 9, .seed = 2};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_cpu_desc desc = describe(&mesh, identity, GIRIH_SURFACE_FLAT, (girih_mode)mode);
        desc.instance_count = 2;
        girih_cpu_output output = refine(&desc, &frame);
        uint32_t seen[6] = {0};
        for (uint64_t n = 0; n < 3 * output.statistics.output_triangles; ++n) {
            const uint32_t *source = output.sources + 2 * (size_t)(n / 3);
            const uint32_t face = source[1] / 2; // axis and side
            float expected[3] = {0.0f, 0.0f, 0.0f};
            expected[face / 2] = face % 2 ? 1.0f : -1.0f;
            expected[0] = source[0] == 1 ? -expected[0] : expected[0];
            const float *normal = normal_of(&output, output.indices[n]);
            for (int axis = 0; axis < 3; ++axis) {
                assert_true(fabsf(normal[axis] - expected[axis]) < 1e-6f);
            }
            ++seen[face];
        }
        for (int face = 0; face < 6; ++face) {
            assert_true(seen[face] > 0);
        }
        girih_cpu_output_free(&output);
    }
    girih_mesh_destroy(mesh);
}

static float wave(const float p[3], float slope[2]) {
    slope[0] = 0.3f * cosf(3.0f * p[0] + 2.0f * p[1]);
    slope[1] = 0.2f * cosf(3.0f * p[0] + 2.0f * p[1]);
    return 0.1f * sinf(3.0f * p[0] + 2.0f * p[1]);
}

static void waves(void *user, const girih_cpu_patch *patch, const float b[3], float position[3]) {
    (void)user;
    float slope[2];
    girih_cpu_base_position(patch, b, position);
    position[2] += wave(position, slope);
}

// Over a flat triangle the normal is the height field's own, to the step it is taken with; and a
// mirrored triangle's stays on its side.
static void normals_follow_the_surface(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    const girih_instance instances[2] = {{0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
                                         {0, {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0}}};
    girih_cpu_desc desc = describe(&mesh, waves, GIRIH_SURFACE_FLAT, GIRIH_MODE_BAKED);
    desc.instances = instances;
    desc.instance_count = 2;
    const girih_frame frame = {.segments = 16};
    girih_cpu_output output = refine(&desc, &frame);
    assert_int_equal(output.statistics.output_vertices, 2 * 153);
    double worst = 0.0;
    for (uint32_t v = 0; v < output.statistics.output_vertices; ++v) {
        float slope[2];
        wave(output.positions + 3 * (size_t)v, slope);
        const float expected[3] = {-slope[0], -slope[1], 1.0f};
        const double cosine = dot(normal_of(&output, v), expected) / sqrt(dot(expected, expected));
        worst = fmax(worst, sqrt(fmax(0.0, 1.0 - cosine * cosine)));
        assert_true(cosine > 0.0);
    }
    assert_true(worst < 5e-3);
    girih_cpu_output_free(&output);
    girih_mesh_destroy(mesh);
}

static void not_a_number(void *user, const girih_cpu_patch *patch, const float b[3],
                         float position[3]) {
    girih_cpu_base_position(patch, b, position);
    if (user || b[0] > 0.9f) {
        position[0] = NAN;
    }
}

static void collapsed(void *user, const girih_cpu_patch *patch, const float b[3],
                      float position[3]) {
    (void)user;
    (void)patch;
    (void)b;
    memset(position, 0, 3 * sizeof *position);
}

// Where the surface has no normal, the base's is taken.
static void normals_fall_back_to_the_base(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    const girih_cpu_surface surfaces[2] = {not_a_number, collapsed};
    for (int n = 0; n < 2; ++n) {
        girih_cpu_desc desc = describe(&mesh, surfaces[n], GIRIH_SURFACE_FLAT, GIRIH_MODE_BAKED);
        desc.instance_count = 1;
        desc.own_user = n == 0 ? &desc : NULL;
        const girih_frame frame = {.segments = 8};
        girih_cpu_output output = refine(&desc, &frame);
        for (uint32_t v = 0; v < output.statistics.output_vertices; ++v) {
            const float expected[3] = {0.0f, 0.0f, 1.0f};
            assert_memory_equal(normal_of(&output, v), expected, sizeof expected);
        }
        girih_cpu_output_free(&output);
    }
    girih_mesh_destroy(mesh);
}

// --- Culling -----------------------------------------------------------------------------------

// As far away as its reach allows.
static void away(void *user, const girih_cpu_patch *patch, const float b[3], float position[3]) {
    const float *t = three_instances[patch->instance].transform;
    const float reach = *(const float *)user;
    girih_cpu_base_position(patch, b, position);
    for (int axis = 0; axis < 3; ++axis) {
        for (int from = 0; from < 3; ++from) {
            const int sign = (patch->triangle >> from & 1) != 0 ? 1 : -1;
            position[axis] += (float)sign * reach * t[4 * axis + from];
        }
    }
}

// A triangle is missing only if every vertex it would have is outside of one plane.
static void culling_respects_reach(void **state) {
    (void)state;
    const girih_mesh *mesh = make_icosphere(2);
    uint64_t random = 8;
    uint64_t culled_in_all = 0;
    for (uint32_t turn = 0; turn < 40; ++turn) {
        float reach = draw_float(&random, 0.0f, 0.4f);
        girih_cpu_desc desc = describe(&mesh, away, GIRIH_SURFACE_FLAT, GIRIH_MODE_BAKED);
        desc.catalogue = girih_catalogue_dyadic();
        desc.own_user = &reach;
        desc.reach = reach;
        girih_frame frame = {.segments = 2};
        girih_cpu_output all = refine(&desc, &frame);
        for (int plane = 0; plane < 6; ++plane) {
            for (int k = 0; k < 3; ++k) {
                frame.planes[plane][k] = draw_float(&random, -1.0f, 1.0f);
            }
            frame.planes[plane][3] = draw_float(&random, -1.0f, 6.0f);
        }
        frame.cull_frustum = 1;
        frame.cull_back = 1; // which a surface with a reach must not follow
        girih_cpu_output seen = refine(&desc, &frame);
        const uint64_t each = all.statistics.output_triangles / (3 * mesh->triangle_count);
        assert_int_equal(each, 4);
        uint64_t next = 0;
        for (uint64_t n = 0; n < all.statistics.output_triangles; n += each) {
            const uint32_t *source = all.sources + 2 * n;
            if (next < seen.statistics.output_triangles &&
                memcmp(source, seen.sources + 2 * next, 2 * sizeof *source) == 0) {
                next += each;
                continue;
            }
            // Its neighbours may own its vertices and move them their way: its corners, moved its
            // own.
            int outside_one = 0;
            for (int plane = 0; plane < 6; ++plane) {
                const float *p = frame.planes[plane];
                int outside = 1;
                for (uint32_t corner = 0; corner < 3; ++corner) {
                    const uint32_t v = mesh->triangle_vertices[3 * (size_t)source[1] + corner];
                    const float *t = three_instances[source[0]].transform;
                    float world[3];
                    for (int axis = 0; axis < 3; ++axis) {
                        world[axis] = t[4 * axis + 3];
                        for (int from = 0; from < 3; ++from) {
                            const float sign = (source[1] >> from & 1) != 0 ? 1.0f : -1.0f;
                            world[axis] +=
                                t[4 * axis + from] *
                                (mesh->positions[3 * (size_t)v + (size_t)from] + sign * reach);
                        }
                    }
                    outside &= dot(p, world) + (double)p[3] < 1e-4;
                }
                outside_one |= outside;
            }
            assert_true(outside_one);
        }
        assert_int_equal(next, seen.statistics.output_triangles);
        culled_in_all += seen.statistics.culled_triangles;
        girih_cpu_output_free(&seen);

        desc.reach = turn % 2 ? -1.0f : NAN;
        seen = refine(&desc, &frame);
        assert_int_equal(seen.statistics.culled_triangles, 0);
        girih_cpu_output_free(&seen);
        girih_cpu_output_free(&all);
    }
    assert_true(culled_in_all > 40 * 100);
    girih_mesh_destroy(mesh);
}

// Nothing is known of an own surface's normals, so its back faces are kept, reach or no reach.
static void culling_without_reach(void **state) {
    (void)state;
    const girih_mesh *mesh = make_icosphere(2);
    girih_cpu_desc desc = describe(&mesh, identity, GIRIH_SURFACE_FLAT, GIRIH_MODE_BAKED);
    desc.catalogue = girih_catalogue_dyadic();
    const girih_frame frame = {.cull_back = 1, .eye = {0, 0, 20}};
    girih_cpu_output own;
    for (int base = GIRIH_SURFACE_FLAT; base <= GIRIH_SURFACE_PN; ++base) {
        desc.base = (girih_surface)base;
        own = refine(&desc, &frame);
        assert_int_equal(own.statistics.culled_triangles, 0);
        girih_cpu_output_free(&own);
    }
    desc.surface = GIRIH_SURFACE_FLAT;
    own = refine(&desc, &frame);
    assert_true(own.statistics.culled_triangles > mesh->triangle_count);
    girih_cpu_output_free(&own);
    desc.surface = GIRIH_SURFACE_OWN;

    uint64_t culled_by[2];
    // The frustum is tested with the base's control points.
    const girih_mesh *coarse = make_icosphere(0);
    desc.meshes = &coarse;
    for (int base = GIRIH_SURFACE_FLAT; base <= GIRIH_SURFACE_PN; ++base) {
        uint64_t culled[2] = {0, 0};
        for (int step = 0; step < 50; ++step) {
            const girih_frame cut = {.cull_frustum = 1,
                                     .planes = {{0, 0, 1, -0.02f * (float)step}}};
            for (int own_one = 0; own_one < 2; ++own_one) {
                desc.surface = own_one ? GIRIH_SURFACE_OWN : (girih_surface)base;
                desc.base = (girih_surface)base;
                own = refine(&desc, &cut);
                culled[own_one] += own.statistics.culled_triangles;
                girih_cpu_output_free(&own);
            }
        }
        assert_int_equal(culled[0], culled[1]);
        culled_by[base] = culled[0];
    }
    assert_true(culled_by[GIRIH_SURFACE_FLAT] > culled_by[GIRIH_SURFACE_PN]);
    girih_mesh_destroy(coarse);
    girih_mesh_destroy(mesh);
}

// --- Refusals ----------------------------------------------------------------------------------

static void refused(const girih_cpu_desc *desc, const char *message) {
    const girih_frame frame = {.segments = 1};
    girih_cpu_output output;
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_cpu_refine(desc, &frame, &output, &error), GIRIH_ERROR_INVALID_ARGUMENT);
    assert_string_equal(error.message, message);
}

static void what_is_no_surface_is_refused(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    girih_cpu_desc desc = describe(&mesh, NULL, GIRIH_SURFACE_FLAT, GIRIH_MODE_BAKED);
    refused(&desc, "refine: the own surface is NULL");
    desc = describe(&mesh, identity, GIRIH_SURFACE_OWN, GIRIH_MODE_BAKED);
    refused(&desc, "refine: unknown base 2 of the own surface");
    desc = describe(&mesh, identity, GIRIH_SURFACE_FLAT, GIRIH_MODE_BAKED);
    desc.outputs = GIRIH_OUTPUT_PREVIOUS;
    refused(&desc, "refine: the previous frame's positions are written on the GPU only");
    girih_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_surface_is_watertight),
        cmocka_unit_test(owners_decide),
        cmocka_unit_test(surfaces_are_told_where_they_are),
        cmocka_unit_test(identity_gives_the_base),
        cmocka_unit_test(cubes_keep_six_normals),
        cmocka_unit_test(normals_follow_the_surface),
        cmocka_unit_test(normals_fall_back_to_the_base),
        cmocka_unit_test(culling_respects_reach),
        cmocka_unit_test(culling_without_reach),
        cmocka_unit_test(what_is_no_surface_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
