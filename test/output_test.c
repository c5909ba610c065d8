// Stage 6: the laws of output, on the CPU.
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "stages.h"

#define MESHES 6
#define SEEDS 60

static const uint32_t all_lists =
    GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_INDICES | GIRIH_OUTPUT_SOURCES;

static const girih_mesh *make_mesh(int n) {
    switch (n) {
    case 0:
        return make_icosphere(1);
    case 1:
        return make_torus(8, 6);
    case 2:
        return make_cube(1);
    case 3:
        return make_cube(0);
    case 4:
        return make_seam_sphere(8, 6);
    default:
        return make_soup(60, 24, 3);
    }
}

static const girih_instance two_instances[2] = {
    {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {0, {-1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0}},
};

static const uint32_t *list(const stages *s, uint32_t binding) {
    return s->arrays.words[binding];
}

// The same triangles in the same order with the same first corner: positions, normals and
// attributes bit for bit in the baked and the welded list, positions in the closed one.
static void check_lists_agree(const stages *baked, const stages *welded) {
    const uint64_t corners = stages_statistics(baked).output_triangles * 3;
    const uint32_t attribute_bytes = (3 + baked->arrays.frame.attribute_floats) * 4;
    assert_int_equal(stages_statistics(welded).output_triangles * 3, corners);
    for (uint64_t n = 0; n < corners; ++n) {
        const uint32_t b = list(baked, GIRIH_BIND_OUT_INDICES)[n];
        const uint32_t w = list(welded, GIRIH_BIND_OUT_INDICES)[n];
        const uint32_t c = list(welded, GIRIH_BIND_OUT_CLOSED_INDICES)[n];
        const uint32_t *position = list(baked, GIRIH_BIND_OUT_POSITIONS) + 3 * (size_t)b;
        assert_memory_equal(position, list(welded, GIRIH_BIND_OUT_POSITIONS) + 3 * (size_t)w, 12);
        assert_memory_equal(position, list(welded, GIRIH_BIND_OUT_POSITIONS) + 3 * (size_t)c, 12);
        assert_memory_equal(
            list(baked, GIRIH_BIND_OUT_ATTRIBUTES) + (size_t)b * attribute_bytes / 4,
            list(welded, GIRIH_BIND_OUT_ATTRIBUTES) + (size_t)w * attribute_bytes / 4,
            attribute_bytes);
    }
    assert_memory_equal(list(baked, GIRIH_BIND_OUT_SOURCES), list(welded, GIRIH_BIND_OUT_SOURCES),
                        (size_t)corners / 3 * 8);
}

static void check_closed(const stages *welded, const girih_mesh *mesh) {
    const edge_audit closed = audit_indices(list(welded, GIRIH_BIND_OUT_CLOSED_INDICES),
                                            stages_statistics(welded).output_triangles);
    const edge_audit points = audit_positions(welded);
    assert_memory_equal(&closed, &points, sizeof closed);
    assert_int_equal(closed.degenerate, 0);
    if (mesh->open_edges + mesh->nonmanifold_edges + mesh->flipped_edges == 0) {
        assert_int_equal(closed.open + closed.nonmanifold + closed.flipped, 0);
        assert_int_equal(closed.edges * 2, stages_statistics(welded).output_triangles * 3);
    }
}

static void modes_give_the_same_triangles(void **state) {
    (void)state;
    for (int n = 0; n < MESHES; ++n) {
        const girih_mesh *mesh = make_mesh(n);
        stages baked = stages_begin(girih_catalogue_linear(), &mesh, 1, two_instances, 2,
                                    (girih_plan_shape){.mode = GIRIH_MODE_BAKED, .outputs = all_lists});
        stages welded =
            stages_begin(girih_catalogue_linear(), &mesh, 1, two_instances, 2,
                         (girih_plan_shape){.mode = GIRIH_MODE_WELDED, .outputs = all_lists | GIRIH_OUTPUT_CLOSED_INDICES});
        for (uint32_t seed = 0; seed < SEEDS; ++seed) {
            const girih_frame frame = {
                .rule = GIRIH_LEVEL_RANDOM, .segments = 2 + seed % 6, .seed = seed};
            const girih_surface surface = seed % 2 ? GIRIH_SURFACE_PN : GIRIH_SURFACE_FLAT;
            stages_refine(&baked, &frame, surface);
            stages_refine(&welded, &frame, surface);
            check_lists_agree(&baked, &welded);
            check_closed(&welded, mesh);
        }
        stages_end(&baked);
        stages_end(&welded);
        girih_mesh_destroy(mesh);
    }
}

// --- Sharing -----------------------------------------------------------------------------------

static uint32_t submesh_of(const girih_mesh *mesh, uint32_t triangle) {
    uint32_t part = 0;
    while (3 * triangle >= mesh->submeshes[part].first_index + mesh->submeshes[part].index_count) {
        ++part;
    }
    return part;
}

// The input vertices two triangles of one instance have in common.
static uint32_t common_vertices(const girih_mesh *mesh, uint32_t a, uint32_t b,
                                uint32_t common[3]) {
    uint32_t count = 0;
    for (uint32_t n = 0; n < 9; ++n) {
        const uint32_t vertex = mesh->triangle_vertices[3 * a + n / 3];
        if (vertex == mesh->triangle_vertices[3 * b + n % 3]) {
            common[count++] = vertex;
        }
    }
    return count;
}

typedef struct use {
    uint32_t vertex, instance, triangle;
} use;

static int compare_uses(const void *a, const void *b) {
    return memcmp(a, b, sizeof(use));
}

// The segments of the edge of a triangle between two input vertices.
static uint32_t segments_between(const stages *s, const girih_mesh *mesh, const use *at,
                                 const uint32_t common[2]) {
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t p = mesh->triangle_vertices[3 * at->triangle + n];
        const uint32_t q = mesh->triangle_vertices[3 * at->triangle + (n + 1) % 3];
        if ((p == common[0] && q == common[1]) || (p == common[1] && q == common[0])) {
            return list(s, GIRIH_BIND_LEVELS)[at->instance * mesh->edge_count +
                                              mesh->triangle_edges[3 * at->triangle + n]] + 1;
        }
    }
    fail();
    return 0;
}

// Two triangles share the vertices inside an edge if and only if they have both its corners'
// indices and the submesh in common; corners by their index; nothing else is shared.
static void check_sharing(const stages *s, const girih_mesh *mesh) {
    const uint64_t count = stages_statistics(s).output_triangles * 3;
    const uint32_t vertex_count = (uint32_t)stages_statistics(s).output_vertices;
    const uint32_t triangles = 2 * mesh->triangle_count;
    use *uses = malloc((size_t)count * sizeof *uses);
    uint32_t *shared = calloc((size_t)triangles * triangles, sizeof *shared);
    assert_true(uses && shared);
    for (uint64_t n = 0; n < count; ++n) {
        const uint32_t *source = list(s, GIRIH_BIND_OUT_SOURCES) + n / 3 * 2;
        uses[n] = (use){list(s, GIRIH_BIND_OUT_INDICES)[n], source[0], source[1]};
        assert_true(uses[n].vertex < vertex_count);
    }
    qsort(uses, (size_t)count, sizeof *uses, compare_uses);
    // Once for each vertex and triangle.
    uint64_t kept = 0;
    for (uint64_t n = 0; n < count; ++n) {
        if (kept == 0 || memcmp(&uses[n], &uses[kept - 1], sizeof *uses) != 0) {
            uses[kept++] = uses[n];
        }
    }
    uint32_t distinct = 0;
    for (uint64_t first = 0, end; first < kept; first = end) {
        for (end = first; end < kept && uses[end].vertex == uses[first].vertex; ++end) {
        }
        ++distinct;
        for (uint64_t a = first; a < end; ++a) {
            for (uint64_t b = a + 1; b < end; ++b) {
                ++shared[(size_t)(uses[a].instance * mesh->triangle_count + uses[a].triangle) *
                             triangles +
                         uses[b].instance * mesh->triangle_count + uses[b].triangle];
            }
        }
    }
    assert_int_equal(distinct, vertex_count);
    for (uint32_t a = 0; a < triangles; ++a) {
        for (uint32_t b = 0; b < triangles; ++b) {
            const use at = {0, a / mesh->triangle_count, a % mesh->triangle_count};
            const uint32_t other = b % mesh->triangle_count;
            uint32_t expected = 0;
            uint32_t common[3];
            if (a != b && b / mesh->triangle_count == at.instance) {
                expected = common_vertices(mesh, at.triangle, other, common);
                if (expected == 2 && submesh_of(mesh, at.triangle) == submesh_of(mesh, other)) {
                    expected += segments_between(s, mesh, &at, common) - 1;
                }
            }
            // Counted in one order of the two or the other.
            assert_int_equal(shared[(size_t)a * triangles + b] + shared[(size_t)b * triangles + a],
                             expected);
        }
    }
    free(uses);
    free(shared);
}

static void sharing_follows_the_indices(void **state) {
    (void)state;
    for (int n = 0; n < MESHES; ++n) {
        const girih_mesh *mesh = make_mesh(n);
        stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, two_instances, 2,
                                (girih_plan_shape){.mode = GIRIH_MODE_WELDED, .outputs = all_lists});
        for (uint32_t seed = 0; seed < 4; ++seed) {
            const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 6, .seed = seed};
            stages_refine(&s, &frame, GIRIH_SURFACE_FLAT);
            check_sharing(&s, mesh);
        }
        stages_end(&s);
        girih_mesh_destroy(mesh);
    }
}

// --- Sources and materials ---------------------------------------------------------------------

// Each input triangle's output stands together, sorted by material, and is as many as its levels
// ask.
static void sources_and_materials(void **state) {
    (void)state;
    const girih_mesh *meshes[3] = {make_seam_sphere(8, 6), make_nothing(), make_torus(8, 6)};
    const girih_instance instances[6] = {
        {1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, {2, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, {1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, {1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}};
    stages s = stages_begin(girih_catalogue_dyadic(), meshes, 3, instances, 6,
                            (girih_plan_shape){.mode = GIRIH_MODE_BAKED, .outputs = all_lists});
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 8, .seed = 1};
    stages_refine(&s, &frame, GIRIH_SURFACE_PN);
    const uint32_t *first =
        list(&s, GIRIH_BIND_STATUS) + GIRIH_STATUS_WORDS + s.arrays.frame.pattern_count;
    assert_int_equal(s.arrays.frame.material_count, 3);
    uint32_t counted[6][256] = {{0}};
    uint32_t material = 0;
    for (uint32_t n = 0; n < stages_statistics(&s).output_triangles; ++n) {
        const uint32_t *source = list(&s, GIRIH_BIND_OUT_SOURCES) + 2 * n;
        assert_true(source[0] == 1 || source[0] == 4);
        const girih_mesh *mesh = meshes[instances[source[0]].mesh];
        assert_true(source[1] < mesh->triangle_count);
        while (n >= first[material + 1]) {
            ++material;
        }
        assert_int_equal(mesh->submeshes[submesh_of(mesh, source[1])].material, material);
        const int begins = n == 0 || source[0] != source[-2] || source[1] != source[-1];
        assert_true(!begins || counted[source[0]][source[1]] == 0);
        ++counted[source[0]][source[1]];
    }
    assert_int_equal(first[0], 0);
    assert_int_equal(first[3], stages_statistics(&s).output_triangles);
    for (uint32_t instance = 1; instance <= 4; instance += 3) {
        const girih_mesh *mesh = meshes[instances[instance].mesh];
        const uint32_t first_edge = instance == 1 ? 0 : meshes[2]->edge_count;
        for (uint32_t triangle = 0; triangle < mesh->triangle_count; ++triangle) {
            uint32_t levels[3];
            for (uint32_t n = 0; n < 3; ++n) {
                levels[n] = list(
                    &s, GIRIH_BIND_LEVELS)[first_edge + mesh->triangle_edges[3 * triangle + n]];
            }
            assert_int_equal(counted[instance][triangle], stages_pattern_triangles(&s, levels));
        }
    }
    stages_end(&s);
    for (int n = 0; n < 3; ++n) {
        girih_mesh_destroy(meshes[n]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(modes_give_the_same_triangles),
        cmocka_unit_test(sharing_follows_the_indices),
        cmocka_unit_test(sources_and_materials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
