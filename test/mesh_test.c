// Mesh preparation: the laws of girih/mesh.h.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "memory.h"
#include "mesh_oracle.h"

static const girih_mesh *create(const girih_mesh_desc *desc) {
    const girih_mesh *mesh = NULL;
    girih_error error = {GIRIH_OK, ""};
    if (girih_mesh_create(desc, &mesh, &error) != GIRIH_OK) {
        fail_msg("%s", error.message);
    }
    return mesh;
}

static const girih_mesh *create_checked(const girih_mesh_desc *desc) {
    const girih_mesh *mesh = create(desc);
    assert_mesh_follows(mesh, desc);
    if (!desc->normals && desc->missing_normals == GIRIH_NORMALS_SMOOTH) {
        assert_smooth_normals(mesh, desc);
    }
    return mesh;
}

static void assert_refused(const girih_mesh_desc *desc, girih_result result, const char *message) {
    const girih_mesh *mesh = (const girih_mesh *)desc;
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_mesh_create(desc, &mesh, &error), result);
    assert_int_equal(error.result, result);
    assert_string_equal(error.message, message);
    assert_null(mesh);
    assert_int_equal(girih_mesh_create(desc, &mesh, NULL), result);
}

// xorshift64*, so that runs repeat everywhere.
static uint32_t draw(uint64_t *state, uint32_t below) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (uint32_t)((*state * UINT64_C(0x2545f4914f6cdd1d)) >> 32) % below;
}

// The cube with corners at 0 and 1; vertex v stands at the bits of v. Triangles wind outward.
static const float cube_positions[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                           {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
static const uint32_t cube_indices[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                          2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

static girih_mesh_desc cube(void) {
    return (girih_mesh_desc){
        .name = "cube",
        .vertex_count = 8,
        .positions = cube_positions[0],
        .indices = cube_indices,
        .index_count = 36,
    };
}

static void assert_closed(const girih_mesh *mesh) {
    assert_int_equal(mesh->open_edges, 0);
    assert_int_equal(mesh->nonmanifold_edges, 0);
    assert_int_equal(mesh->flipped_edges, 0);
    assert_int_equal(2 * mesh->edge_count, 3 * mesh->triangle_count);
}

static void test_cube_without_normals(void **state) {
    (void)state;
    const struct {
        girih_missing_normals missing;
        float crease;
        uint32_t vertices, seams, weld_edges;
    } cases[] = {
        {GIRIH_NORMALS_SMOOTH, 60.0f, 24, 12, 30},  {GIRIH_NORMALS_SMOOTH, 89.9f, 24, 12, 30},
        {GIRIH_NORMALS_SMOOTH, 90.0f, 8, 0, 18},    {GIRIH_NORMALS_SMOOTH, 180.0f, 8, 0, 18},
        {GIRIH_NORMALS_SMOOTH, 0.0f, 8, 0, 18},     {GIRIH_NORMALS_SMOOTH, -1.0f, 8, 0, 18},
        {GIRIH_NORMALS_FLAT, 180.0f, 24, 12, 30},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        girih_mesh_desc desc = cube();
        desc.missing_normals = cases[i].missing;
        desc.crease_degrees = cases[i].crease;
        const girih_mesh *mesh = create_checked(&desc);
        assert_closed(mesh);
        assert_int_equal(mesh->vertex_count, cases[i].vertices);
        assert_int_equal(mesh->triangle_count, 12);
        assert_int_equal(mesh->edge_count, 18);
        assert_int_equal(mesh->seam_count, cases[i].seams);
        assert_int_equal(mesh->weld_edge_count, cases[i].weld_edges);
        for (int axis = 0; axis < 3; ++axis) {
            assert_true(mesh->bounds_min[axis] == 0.0f && mesh->bounds_max[axis] == 1.0f);
        }
        for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
            for (int axis = 0; axis < 3; ++axis) {
                // Angle weights make the diagonals of the faces invisible.
                float sign = 2.0f * mesh->positions[3 * v + (uint32_t)axis] - 1.0f;
                float normal = mesh->normals[3 * v + (uint32_t)axis];
                assert_true(mesh->vertex_count == 24
                                ? normal == 0.0f || normal == sign
                                : fabsf(normal - sign * (float)sqrt(1.0 / 3.0)) < 1e-6f);
            }
        }
        girih_mesh_destroy(mesh);
    }
}

// 24 vertices, 4 a face, with normals (not of unit length) and one attribute; every 0 is -0 on the
// faces of odd number.
static void test_cube_with_hard_edges(void **state) {
    (void)state;
    struct vertex {
        float attribute_apart, normal[3], position[3];
    } vertices[24];
    float attributes[24];
    uint32_t indices[36];
    for (uint32_t face = 0; face < 6; ++face) {
        uint32_t used = 0;
        uint32_t names[4];
        float normal[3] = {0, 0, 0};
        normal[face < 2 ? 2 : face < 4 ? 1 : 0] = face % 2 ? 3.0f : -3.0f;
        for (uint32_t i = 6 * face; i < 6 * face + 6; ++i) {
            uint32_t k = 0;
            while (k < used && names[k] != cube_indices[i]) {
                ++k;
            }
            if (k == used) {
                struct vertex *v = vertices + 4 * face + k;
                memcpy(v->normal, normal, sizeof normal);
                for (int axis = 0; axis < 3; ++axis) {
                    float value = cube_positions[cube_indices[i]][axis];
                    v->position[axis] = value == 0.0f && face % 2 ? -0.0f : value;
                }
                attributes[4 * face + k] = face % 2 ? -0.0f : (float)k;
                names[used++] = cube_indices[i];
            }
            indices[i] = 4 * face + k;
        }
    }
    girih_mesh_desc desc = {
        .vertex_count = 24,
        .positions = vertices[0].position,
        .position_stride = sizeof *vertices,
        .normals = vertices[0].normal,
        .normal_stride = sizeof *vertices,
        .attributes = attributes,
        .attribute_floats = 1,
        .indices = indices,
        .index_count = 36,
    };
    const girih_mesh *mesh = create_checked(&desc);
    assert_closed(mesh);
    assert_int_equal(mesh->vertex_count, 24);
    assert_int_equal(mesh->edge_count, 18);
    assert_int_equal(mesh->seam_count, 12);
    assert_int_equal(mesh->weld_edge_count, 30);
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        const float *a = mesh->positions + 3 * mesh->edge_points[2 * edge];
        const float *b = mesh->positions + 3 * mesh->edge_points[2 * edge + 1];
        float square = 0.0f;
        for (int axis = 0; axis < 3; ++axis) {
            square += (a[axis] - b[axis]) * (a[axis] - b[axis]);
        }
        assert_true(square == (edge < mesh->seam_count ? 1.0f : 2.0f));
    }
    uint32_t points = 0;
    for (uint32_t v = 0; v < 24; ++v) {
        points += mesh->vertex_point[v] == v;
        for (int axis = 0; axis < 3; ++axis) {
            assert_false(signbit(mesh->positions[3 * v + (uint32_t)axis]));
        }
        assert_false(signbit(mesh->attributes[v]));
    }
    assert_int_equal(points, 8);
    girih_mesh_destroy(mesh);
}

// An octahedron whose faces are cut into n * n triangles, each face with its own vertices: the
// sphere's counts, with seams in the input that must not become any.
static void test_sphere(void **state) {
    (void)state;
    enum { N = 7, FACE = (N + 1) * (N + 2) / 2 };
    float positions[8 * FACE][3];
    uint32_t indices[8 * N * N * 3];
    uint32_t vertex = 0;
    uint32_t index = 0;
    for (uint32_t face = 0; face < 8; ++face) {
        for (uint32_t row = 0; row <= N; ++row) {
            for (uint32_t column = 0; column <= row; ++column, ++vertex) {
                float xyz[3] = {(float)(N - row), (float)(row - column), (float)column};
                float length = sqrtf(xyz[0] * xyz[0] + xyz[1] * xyz[1] + xyz[2] * xyz[2]);
                for (uint32_t axis = 0; axis < 3; ++axis) {
                    positions[vertex][axis] = (face >> axis & 1 ? -xyz[axis] : xyz[axis]) / length;
                }
                uint32_t below = vertex + row + 1;
                uint32_t corners[6] = {vertex, below, below + 1, vertex, below + 1, vertex + 1};
                bool mirrored = (face ^ face >> 1 ^ face >> 2) & 1;
                for (uint32_t k = 0; row < N && k < (column < row ? 6u : 3u); k += 3) {
                    indices[index++] = corners[k];
                    indices[index++] = corners[k + (mirrored ? 2 : 1)];
                    indices[index++] = corners[k + (mirrored ? 1 : 2)];
                }
            }
        }
    }
    girih_mesh_desc desc = {
        .name = "sphere",
        .vertex_count = 8 * FACE,
        .positions = positions[0],
        .indices = indices,
        .index_count = index,
        .crease_degrees = 90.0f,
    };
    assert_int_equal(index, 3 * 8 * N * N);
    const girih_mesh *mesh = create_checked(&desc);
    uint32_t points = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        points += mesh->vertex_point[v] == v;
        double cosine = 0.0;
        for (uint32_t axis = 0; axis < 3; ++axis) {
            cosine += (double)mesh->normals[3 * v + axis] * (double)mesh->positions[3 * v + axis];
        }
        assert_true(cosine > 0.99);
    }
    assert_closed(mesh);
    assert_int_equal(points + mesh->triangle_count, mesh->edge_count + 2);
    assert_int_equal(points, 4 * N * N + 2);
    assert_int_equal(mesh->vertex_count, 8 * FACE);
    assert_int_equal(mesh->seam_count, 0);
    assert_int_equal(mesh->weld_edge_count, 12 * N * N + 12 * N);
    girih_mesh_destroy(mesh);

    // Where the host moves the normals, each of the octahedron's edges becomes a seam.
    desc.dynamic = 1;
    mesh = create_checked(&desc);
    assert_closed(mesh);
    assert_int_equal(mesh->seam_count, 12 * N);
    girih_mesh_destroy(mesh);
}

static void test_moebius_strip(void **state) {
    (void)state;
    enum { N = 9 };
    float positions[2 * N][3];
    uint32_t indices[6 * N];
    for (uint32_t i = 0; i < N; ++i) {
        double angle = 2.0 * acos(-1.0) * i / N;
        for (uint32_t side = 0; side < 2; ++side) {
            double across = (side ? 0.5 : -0.5);
            double radius = 2.0 + across * cos(angle / 2.0);
            positions[2 * i + side][0] = (float)(radius * cos(angle));
            positions[2 * i + side][1] = (float)(radius * sin(angle));
            positions[2 * i + side][2] = (float)(across * sin(angle / 2.0));
        }
        uint32_t a = 2 * i;
        uint32_t b = 2 * i + 1;
        uint32_t c = i + 1 < N ? 2 * i + 2 : 1;
        uint32_t d = i + 1 < N ? 2 * i + 3 : 0;
        memcpy(indices + 6 * i, (uint32_t[]){a, c, b, b, c, d}, 6 * sizeof *indices);
    }
    girih_mesh_desc desc = {
        .vertex_count = 2 * N,
        .positions = positions[0],
        .indices = indices,
        .index_count = 6 * N,
    };
    const girih_mesh *mesh = create_checked(&desc);
    assert_int_equal(mesh->edge_count, 4 * N);
    assert_int_equal(mesh->open_edges, 2 * N);
    assert_int_equal(mesh->flipped_edges, 1); // where the strip closes
    assert_int_equal(mesh->nonmanifold_edges, 0);
    assert_int_equal(mesh->vertex_count, 2 * N + 2); // the flipped edge is hard
    girih_mesh_destroy(mesh);
}

// Triangles round the edge from (0,0,0) to (0,0,1), in either direction.
static void assert_fan(uint32_t blades) {
    float *positions = calloc(blades + 2u, 3 * sizeof *positions);
    float *normals = calloc(blades + 2u, 3 * sizeof *normals);
    uint32_t *indices = calloc(blades, 3 * sizeof *indices);
    assert_true(positions && normals && indices);
    positions[5] = 1.0f;
    for (uint32_t i = 0; i < blades; ++i) {
        double angle = 2.0 * acos(-1.0) * i / blades;
        positions[3 * i + 6] = (float)cos(angle);
        positions[3 * i + 7] = (float)sin(angle);
        memcpy(indices + 3 * i, (uint32_t[]){i % 2, 1 - i % 2, i + 2}, 3 * sizeof *indices);
    }
    girih_mesh_desc desc = {
        .vertex_count = blades + 2,
        .positions = positions,
        .normals = normals,
        .indices = indices,
        .index_count = 3 * blades,
    };
    const girih_mesh *mesh = create_checked(&desc);
    assert_int_equal(mesh->edge_count, 2 * blades + 1);
    assert_int_equal(mesh->open_edges, 2 * blades);
    assert_int_equal(mesh->nonmanifold_edges, 1);
    assert_int_equal(mesh->seam_count, 1);
    assert_int_equal(mesh->edge_uses[0], blades < 255 ? blades : 255);
    assert_int_equal(mesh->weld_edge_count, mesh->edge_count);
    assert_memory_equal(mesh->seams, ((uint32_t[]){0, 1, 0, 1}), 16);
    for (uint32_t i = 0; i < blades; ++i) {
        assert_int_equal(mesh->triangle_weld_edges[3 * i], i % 2 ? 0x80000000u : 0u);
    }
    girih_mesh_destroy(mesh);

    // Without normals every blade is on its own, and the vertices of the shared edge are split.
    desc.normals = NULL;
    mesh = create_checked(&desc);
    assert_int_equal(mesh->seam_count, 1);
    assert_true(mesh->vertex_count > blades + 2);
    girih_mesh_destroy(mesh);
    free(indices);
    free(normals);
    free(positions);
}

static void test_nonmanifold_fans(void **state) {
    (void)state;
    assert_fan(3);
    assert_fan(4);
    assert_fan(254);
    assert_fan(255);
    assert_fan(300);
}

// The sliver between 1 and its double 4 is dropped; the edge it lay beside is then shared.
static void test_dropped_triangles(void **state) {
    (void)state;
    const float positions[][3] = {{0, 0, 0}, {1, 0, 0},      {1, 1, 0},  {9, 9, 9},
                                  {1, -0.0f, 0}, {2, 0.5f, 0}, {0.5f, 0, 0}};
    const uint32_t indices[] = {0, 1, 2, 1, 4, 2, 4, 5, 2, 3, 3, 0, 0, 6, 1};
    const girih_submesh submeshes[] = {{0, 6, 5, 0}, {3, 3, 6, 1}, {6, 9, 7, 0}};
    girih_mesh_desc desc = {
        .vertex_count = 7,
        .positions = positions[0],
        .indices = indices,
        .index_count = 15,
        .submeshes = submeshes,
        .submesh_count = 3,
    };
    const girih_mesh *mesh = create_checked(&desc);
    assert_int_equal(mesh->triangle_count, 3); // the one of zero area is kept
    assert_int_equal(mesh->dropped_triangles, 3);
    assert_int_equal(mesh->edge_count, 7);
    assert_int_equal(mesh->open_edges, 5);
    assert_int_equal(mesh->flipped_edges, 0);
    assert_int_equal(mesh->vertex_count, 6);
    assert_int_equal(mesh->submeshes[1].index_count, 0);
    assert_int_equal(mesh->submeshes[2].first_index, 3);
    assert_int_equal(mesh->triangle_source[1], 2);
    girih_mesh_destroy(mesh);
}

// A T-junction's filler has rounding for a normal: it must not bend the plane around it.
static void test_filler_triangle(void **state) {
    (void)state;
    const float third = 1.0f / 3.0f;
    const float positions[][3] = {{0, 0, 0},     {1, third, 0.7f}, {0.5f, third / 2, 0.35f},
                                  {0, 1, -0.1f}, {1, -1, 0.3f}};
    float moved[5][3];
    for (uint32_t v = 0; v < 5; ++v) {
        for (uint32_t axis = 0; axis < 3; ++axis) {
            moved[v][axis] = positions[v][axis] + 7.3f;
        }
    }
    const uint32_t indices[] = {0, 1, 3, 0, 2, 1, 0, 4, 2, 2, 4, 1};
    girih_mesh_desc desc = {
        .vertex_count = 5,
        .positions = moved[0],
        .indices = indices,
        .index_count = 12,
    };
    const girih_mesh *filled = create(&desc);
    assert_int_equal(filled->vertex_count, 5);
    desc.indices = indices + 6; // below the line alone
    desc.index_count = 6;
    const girih_mesh *below = create(&desc);
    for (uint32_t axis = 0; axis < 3; ++axis) {
        // The middle vertex takes from the two triangles below and nothing from the filler.
        float middle = filled->normals[3 * 2 + axis];
        assert_true(fabsf(middle - below->normals[3 * 1 + axis]) < 1e-6f);
    }
    girih_mesh_destroy(below);
    desc.indices = indices;
    desc.index_count = 12;
    desc.missing_normals = GIRIH_NORMALS_FLAT;
    const girih_mesh *flat = create_checked(&desc);
    for (uint32_t v = 0; v < flat->vertex_count; ++v) {
        const float *n = flat->normals + 3 * v;
        assert_true(n[0] != 0.0f || n[1] != 0.0f || n[2] != 0.0f);
    }
    girih_mesh_destroy(flat);
    girih_mesh_destroy(filled);
}

static void test_submeshes_share_edges_but_not_weld_edges(void **state) {
    (void)state;
    const float positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    const girih_submesh submeshes[] = {{0, 3, 0, 0}, {3, 3, 65535, 1}};
    girih_mesh_desc desc = {
        .vertex_count = 4,
        .positions = positions[0],
        .indices = indices,
        .index_count = 6,
        .submeshes = submeshes,
        .submesh_count = 2,
    };
    const girih_mesh *mesh = create_checked(&desc);
    assert_int_equal(mesh->edge_count, 5);
    assert_int_equal(mesh->seam_count, 0);
    assert_int_equal(mesh->weld_edge_count, 6);
    assert_int_equal(mesh->triangle_edges[2], mesh->triangle_edges[3]);
    assert_int_equal(mesh->triangle_weld_edges[2], 2u | 0x80000000u);
    assert_int_equal(mesh->triangle_weld_edges[3], 3u);
    assert_int_equal(mesh->edge_weld_edge[mesh->triangle_edges[2]], 2);
    girih_mesh_destroy(mesh);

    desc.submeshes = NULL;
    desc.submesh_count = 0;
    mesh = create_checked(&desc);
    assert_int_equal(mesh->weld_edge_count, 5);
    girih_mesh_destroy(mesh);
}

static void test_empty_meshes(void **state) {
    (void)state;
    girih_mesh_desc desc = {0};
    const girih_mesh *mesh = create_checked(&desc);
    assert_int_equal(mesh->vertex_count + mesh->triangle_count + mesh->edge_count, 0);
    assert_int_equal(mesh->submesh_count, 1);
    assert_string_equal(mesh->name, "");
    girih_mesh_destroy(mesh);

    desc = cube();
    desc.index_count = 0;
    mesh = create_checked(&desc);
    assert_int_equal(mesh->vertex_count, 0);
    assert_true(mesh->bounds_max[0] == 0.0f);
    girih_mesh_destroy(mesh);

    const girih_submesh submesh = {0, 36, 0, 0};
    desc = cube();
    desc.submeshes = &submesh; // a count of 0 is no submesh at all
    mesh = create_checked(&desc);
    assert_int_equal(mesh->submesh_count, 0);
    assert_int_equal(mesh->triangle_count, 0);
    girih_mesh_destroy(mesh);
    girih_mesh_destroy(NULL);
}

// Triangles among few points: doubles, folds, flips and fans of every kind.
typedef struct soup {
    float positions[12][3], normals[12][3], attributes[12][2];
    uint32_t indices[60];
    girih_submesh submeshes[3];
    girih_mesh_desc desc;
} soup;

static void make_soup(soup *s, uint64_t seed) {
    static const float choices[4][3] = {{0, 0, 2}, {0, 0, 1}, {-0.0f, 1, 0}, {0, 0, 0}};
    uint64_t state = (seed + 1) * UINT64_C(0x9e3779b97f4a7c15);
    uint32_t vertices = 3 + draw(&state, 10);
    uint32_t triangles = draw(&state, 21);
    memset(s, 0, sizeof *s);
    for (uint32_t v = 0; v < vertices; ++v) {
        for (uint32_t axis = 0; axis < 3; ++axis) {
            float value = (float)draw(&state, axis < 2 ? 3 : 2);
            s->positions[v][axis] = value == 0.0f && draw(&state, 2) ? -0.0f : value;
        }
        memcpy(s->normals[v], choices[draw(&state, 4)], sizeof *choices);
        s->attributes[v][0] = (float)draw(&state, 2) * -0.0f;
        s->attributes[v][1] = (float)v;
    }
    for (uint32_t i = 0; i < 3 * triangles; ++i) {
        s->indices[i] = draw(&state, vertices);
    }
    uint32_t first = 0;
    for (uint32_t i = 0; i < 3; ++i) {
        uint32_t count = i < 2 ? 3 * draw(&state, triangles - first / 3 + 1)
                               : 3 * triangles - first;
        s->submeshes[i] = (girih_submesh){first, count, i, i % 2};
        first += count;
    }
    bool parts = draw(&state, 2);
    bool normals = draw(&state, 3);
    s->desc = (girih_mesh_desc){
        .name = "soup",
        .vertex_count = vertices,
        .positions = s->positions[0],
        .normals = normals ? s->normals[0] : NULL,
        .attributes = s->attributes[0],
        .attribute_floats = 2,
        .indices = s->indices,
        .index_count = 3 * triangles,
        .submeshes = parts ? s->submeshes : NULL,
        .submesh_count = parts ? 3 : 0,
        .missing_normals = draw(&state, 3) ? GIRIH_NORMALS_SMOOTH : GIRIH_NORMALS_FLAT,
        .crease_degrees = (float)draw(&state, 4) * 40.1f,
    };
}

static void test_random_soups(void **state) {
    (void)state;
    uint32_t seams = 0;
    uint32_t more_seams = 0;
    uint32_t dropped = 0;
    uint32_t nonmanifold = 0;
    uint32_t flipped = 0;
    uint32_t splits = 0;
    for (uint64_t seed = 0; seed < 20000; ++seed) {
        soup s;
        make_soup(&s, seed);
        const girih_mesh *mesh = create_checked(&s.desc);
        const girih_mesh *again = create(&s.desc);
        assert_meshes_equal(mesh, again);
        seams += mesh->seam_count;
        dropped += mesh->dropped_triangles;
        nonmanifold += mesh->nonmanifold_edges;
        flipped += mesh->flipped_edges;
        splits += mesh->made_normals && mesh->vertex_count > s.desc.vertex_count;
        girih_mesh_destroy(again);
        s.desc.dynamic = 1;
        const girih_mesh *dynamic = create_checked(&s.desc);
        assert_true(dynamic->seam_count >= mesh->seam_count);
        more_seams += dynamic->seam_count - mesh->seam_count;
        assert_int_equal(dynamic->edge_count, mesh->edge_count);
        assert_memory_equal(dynamic->triangle_weld_edges, mesh->triangle_weld_edges,
                            12 * (size_t)mesh->triangle_count);
        girih_mesh_destroy(dynamic);
        girih_mesh_destroy(mesh);
    }
    assert_true(more_seams > 1000);
    assert_true(seams > 10000 && dropped > 10000 && nonmanifold > 10000 && flipped > 10000);
    assert_true(splits > 1000);
}

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, 7 * sizeof(float));
}

// The edges as positions, with the seam bit, sorted.
static uint32_t list_edge_keys(const girih_mesh *mesh, float (*keys)[7]) {
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        for (uint32_t end = 0; end < 2; ++end) {
            memcpy(keys[edge] + 3 * end, mesh->positions + 3 * mesh->edge_points[2 * edge + end],
                   3 * sizeof(float));
        }
        keys[edge][6] = edge < mesh->seam_count ? 1.0f : 0.0f;
    }
    qsort(keys, mesh->edge_count, sizeof *keys, compare_edges);
    return mesh->edge_count;
}

// Neither the order of triangles nor that of vertices nor a triangle's first corner decides what
// the edges and seams are.
static void test_order_does_not_matter(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 2000; ++seed) {
        soup s;
        make_soup(&s, seed);
        s.desc.submeshes = NULL;
        s.desc.submesh_count = 0;
        s.desc.normals = s.normals[0];
        soup t = s;
        uint64_t shuffle = seed + 77;
        uint32_t triangles = s.desc.index_count / 3;
        uint32_t vertices = s.desc.vertex_count;
        uint32_t turn = draw(&shuffle, vertices);
        for (uint32_t v = 0; v < vertices; ++v) {
            memcpy(t.positions[(v + turn) % vertices], s.positions[v], sizeof *s.positions);
            memcpy(t.normals[(v + turn) % vertices], s.normals[v], sizeof *s.normals);
        }
        for (uint32_t i = 0; i < triangles; ++i) {
            uint32_t from = triangles - 1 - i;
            uint32_t corner = draw(&shuffle, 3);
            for (uint32_t k = 0; k < 3; ++k) {
                t.indices[3 * i + k] = (s.indices[3 * from + (k + corner) % 3] + turn) % vertices;
            }
        }
        t.desc.positions = t.positions[0];
        t.desc.normals = t.normals[0];
        t.desc.attributes = t.attributes[0];
        t.desc.indices = t.indices;
        const girih_mesh *a = create_checked(&s.desc);
        const girih_mesh *b = create_checked(&t.desc);
        float keys_a[60][7];
        float keys_b[60][7];
        assert_int_equal(list_edge_keys(a, keys_a), list_edge_keys(b, keys_b));
        assert_memory_equal(keys_a, keys_b, a->edge_count * sizeof *keys_a);
        assert_int_equal(a->weld_edge_count, b->weld_edge_count);
        girih_mesh_destroy(b);
        girih_mesh_destroy(a);
    }
}

static void test_refusals(void **state) {
    (void)state;
    float positions[24];
    float attributes[16] = {0};
    memcpy(positions, cube_positions, sizeof positions);
    girih_mesh_desc desc = cube();
    desc.positions = positions;
    desc.index_count = 3; // vertex 6 is then in no triangle, and refused all the same
    positions[19] = NAN;
    assert_refused(&desc, GIRIH_ERROR_INVALID_DATA,
                   "mesh \"cube\": vertex 6: position y is nan; coordinates must be finite and not "
                   "beyond 1e15");
    positions[19] = -INFINITY;
    assert_refused(&desc, GIRIH_ERROR_INVALID_DATA,
                   "mesh \"cube\": vertex 6: position y is -inf; coordinates must be finite and "
                   "not beyond 1e15");
    positions[19] = -1.1e15f;
    assert_refused(&desc, GIRIH_ERROR_INVALID_DATA,
                   "mesh \"cube\": vertex 6: position y is -1.1e+15; coordinates must be finite "
                   "and not beyond 1e15");
    positions[19] = -1e15f;
    girih_mesh_destroy(create(&desc));
    desc.normals = positions;
    positions[23] = INFINITY;
    desc.positions = cube_positions[0];
    assert_refused(&desc, GIRIH_ERROR_INVALID_DATA,
                   "mesh \"cube\": vertex 7: normal z is inf, not finite");
    desc.normals = NULL;
    desc.attributes = attributes;
    desc.attribute_floats = 2;
    attributes[9] = NAN;
    desc.name = NULL;
    assert_refused(&desc, GIRIH_ERROR_INVALID_DATA,
                   "mesh \"\": vertex 4: attribute 1 is nan, not finite");

    desc = cube();
    desc.vertex_count = 7;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": index 8 names vertex 7, but there are 7 vertices");
    desc = cube();
    desc.index_count = 35;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": 35 indices, not a multiple of 3");
    desc = cube();
    desc.position_stride = 11;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": a stride of less than 12 bytes");
    desc = cube();
    desc.attribute_floats = 1;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": attributes is null although its count is not 0");
    desc = cube();
    desc.crease_degrees = NAN;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": crease_degrees is nan, not finite");
    desc = cube();
    desc.missing_normals = (girih_missing_normals)2;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": missing_normals is 2, which names no way to make them");

    girih_submesh submesh = {3, 36, 0, 0};
    desc = cube();
    desc.submesh_count = 1;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": submeshes is null although its count is not 0");
    desc.submeshes = &submesh;
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": submesh 0 ends at index 39, but there are 36 indices");
    submesh = (girih_submesh){3, UINT32_MAX, 0, 0};
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": submesh 0 ends at index 4294967298, but there are 36 indices");
    submesh = (girih_submesh){1, 3, 0, 0};
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": submesh 0: first index 1 and index count 3 must be multiples "
                   "of 3");
    submesh = (girih_submesh){0, 36, GIRIH_MAX_MATERIALS, 0};
    assert_refused(&desc, GIRIH_ERROR_INVALID_ARGUMENT,
                   "mesh \"cube\": submesh 0: material 65536 must be below 65536");

    const girih_mesh *mesh = NULL;
    assert_int_equal(girih_mesh_create(NULL, &mesh, NULL), GIRIH_ERROR_INVALID_ARGUMENT);
    assert_int_equal(girih_mesh_create(&desc, NULL, NULL), GIRIH_ERROR_INVALID_ARGUMENT);
}

// Overlapping submeshes ask for more triangles than there are indices.
static void test_too_many_triangles(void **state) {
    (void)state;
    enum { TRIANGLES = 1 << 18, SUBMESHES = (1 << 11) + 1 };
    uint32_t *indices = calloc(TRIANGLES, 3 * sizeof *indices);
    girih_submesh *submeshes = calloc(SUBMESHES, sizeof *submeshes);
    assert_true(indices && submeshes);
    for (uint32_t i = 0; i < SUBMESHES; ++i) {
        submeshes[i].index_count = 3 * TRIANGLES;
    }
    girih_mesh_desc desc = cube();
    desc.indices = indices;
    desc.index_count = 3 * TRIANGLES;
    desc.submeshes = submeshes;
    desc.submesh_count = SUBMESHES;
    assert_refused(&desc, GIRIH_ERROR_TOO_LARGE,
                   "mesh \"cube\": 537133056 triangles; at most 536870912 fit in one mesh: split "
                   "it");
    free(submeshes);
    free(indices);
}

static void test_every_allocation_may_fail(void **state) {
    (void)state;
    for (uint32_t kind = 0; kind < 3; ++kind) {
        girih_mesh_desc desc = cube();
        desc.crease_degrees = 60.0f;
        desc.normals = kind == 0 ? cube_positions[0] : NULL;
        desc.missing_normals = kind == 1 ? GIRIH_NORMALS_FLAT : GIRIH_NORMALS_SMOOTH;
        const girih_mesh *mesh = NULL;
        girih_error error;
        size_t allocations = 0;
        for (;; ++allocations) {
            girih_allocation_failure_after(allocations);
            girih_result result = girih_mesh_create(&desc, &mesh, &error);
            girih_allocation_failure_after(SIZE_MAX);
            if (result == GIRIH_OK) {
                break;
            }
            assert_int_equal(result, GIRIH_ERROR_OUT_OF_MEMORY);
            assert_string_equal(error.message,
                                "mesh \"cube\": no memory for 8 vertices and 12 triangles");
            assert_null(mesh);
        }
        assert_true(allocations >= 25);
        assert_mesh_follows(mesh, &desc);
        girih_mesh_destroy(mesh);
    }
    assert_null(girih_allocate_array(SIZE_MAX / 2, 3));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube_without_normals),
        cmocka_unit_test(test_cube_with_hard_edges),
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_moebius_strip),
        cmocka_unit_test(test_nonmanifold_fans),
        cmocka_unit_test(test_dropped_triangles),
        cmocka_unit_test(test_filler_triangle),
        cmocka_unit_test(test_submeshes_share_edges_but_not_weld_edges),
        cmocka_unit_test(test_empty_meshes),
        cmocka_unit_test(test_random_soups),
        cmocka_unit_test(test_order_does_not_matter),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_too_many_triangles),
        cmocka_unit_test(test_every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
