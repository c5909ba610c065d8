#include "meshes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint32_t draw_number(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (uint32_t)((*state * UINT64_C(0x2545f4914f6cdd1d)) >> 32);
}

float draw_float(uint64_t *state, float low, float high) {
    return low + (high - low) * ((float)(draw_number(state) >> 8) * 0x1p-24f);
}

// --- Building ----------------------------------------------------------------------------------

typedef struct builder {
    float *positions, *normals, *attributes;
    uint32_t *indices;
    uint32_t vertex_count, index_count;
    uint32_t vertex_room, index_room;
    int dynamic;
} builder;

static builder begin(uint32_t vertex_room, uint32_t triangle_room) {
    builder b = {.vertex_room = vertex_room, .index_room = triangle_room * 3};
    b.positions = calloc(vertex_room + 1u, 3 * sizeof(float));
    b.normals = calloc(vertex_room + 1u, 3 * sizeof(float));
    b.attributes = calloc(vertex_room + 1u, 2 * sizeof(float));
    b.indices = calloc(triangle_room + 1u, 3 * sizeof(uint32_t));
    assert_true(b.positions && b.normals && b.attributes && b.indices);
    return b;
}

static uint32_t add_vertex(builder *b, const float position[3], const float normal[3], float s,
                           float t) {
    const size_t n = b->vertex_count;
    assert_true(b->vertex_count < b->vertex_room);
    memcpy(b->positions + 3 * n, position, 3 * sizeof(float));
    memcpy(b->normals + 3 * n, normal, 3 * sizeof(float));
    b->attributes[2 * n] = s;
    b->attributes[2 * n + 1] = t;
    return b->vertex_count++;
}

static void add_triangle(builder *b, uint32_t p, uint32_t q, uint32_t r) {
    assert_true(b->index_count < b->index_room);
    b->indices[b->index_count++] = p;
    b->indices[b->index_count++] = q;
    b->indices[b->index_count++] = r;
}

static const girih_mesh *finish(builder *b, const char *name, const girih_submesh *submeshes,
                                uint32_t submesh_count) {
    const girih_mesh_desc desc = {
        .name = name,
        .vertex_count = b->vertex_count,
        .positions = b->positions,
        .normals = b->normals,
        .attributes = b->attributes,
        .attribute_floats = 2,
        .indices = b->indices,
        .index_count = b->index_count,
        .submeshes = submeshes,
        .submesh_count = submesh_count,
        .dynamic = b->dynamic,
    };
    const girih_mesh *mesh = NULL;
    girih_error error = {GIRIH_OK, ""};
    if (girih_mesh_create(&desc, &mesh, &error) != GIRIH_OK) {
        fail_msg("%s: %s", name, error.message);
    }
    free(b->positions);
    free(b->normals);
    free(b->attributes);
    free(b->indices);
    return mesh;
}

// --- Icosphere ---------------------------------------------------------------------------------

static uint32_t add_sphere_point(builder *b, double x, double y, double z) {
    const double scale = 1.0 / sqrt(x * x + y * y + z * z);
    const float point[3] = {(float)(x * scale), (float)(y * scale), (float)(z * scale)};
    return add_vertex(b, point, point, point[0], point[1]);
}

// The vertex halfway between two, made when first asked for. `slots` is a hash table of pairs.
static uint32_t middle(builder *b, uint32_t (*slots)[3], size_t slot_count, uint32_t p,
                       uint32_t q) {
    const uint32_t low = p < q ? p : q;
    const uint32_t high = p < q ? q : p;
    size_t slot = (low * UINT64_C(0x9e3779b97f4a7c15) + high * UINT64_C(0xc2b2ae3d27d4eb4f)) >> 20;
    for (slot &= slot_count - 1; slots[slot][2] != 0; slot = (slot + 1) & (slot_count - 1)) {
        if (slots[slot][0] == low && slots[slot][1] == high) {
            return slots[slot][2] - 1;
        }
    }
    const float *a = b->positions + 3 * (size_t)low;
    const float *c = b->positions + 3 * (size_t)high;
    const uint32_t vertex = add_sphere_point(
        b, (double)a[0] + (double)c[0], (double)a[1] + (double)c[1], (double)a[2] + (double)c[2]);
    slots[slot][0] = low;
    slots[slot][1] = high;
    slots[slot][2] = vertex + 1;
    return vertex;
}

const girih_mesh *make_icosphere(uint32_t halvings) {
    static const uint32_t faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    const uint32_t triangles = 20u << (2 * halvings);
    builder b = begin(triangles / 2 + 2, triangles);
    const double g = (1.0 + sqrt(5.0)) / 2.0;
    for (int axis = 0; axis < 3; ++axis) {
        for (int n = 0; n < 4; ++n) {
            double p[3];
            p[(axis + 0) % 3] = n % 2 == 0 ? -1.0 : 1.0;
            p[(axis + 1) % 3] = n < 2 ? g : -g;
            p[(axis + 2) % 3] = 0.0;
            add_sphere_point(&b, p[0], p[1], p[2]);
        }
    }
    for (int n = 0; n < 20; ++n) {
        add_triangle(&b, faces[n][0], faces[n][1], faces[n][2]);
    }
    const size_t slot_count = (size_t)256 << (2 * halvings);
    uint32_t(*slots)[3] = malloc(slot_count * sizeof *slots);
    assert_non_null(slots);
    for (uint32_t halving = 0; halving < halvings; ++halving) {
        memset(slots, 0, slot_count * sizeof *slots);
        const uint32_t count = b.index_count;
        for (uint32_t n = 0; n < count; n += 3) {
            const uint32_t p = b.indices[n], q = b.indices[n + 1], r = b.indices[n + 2];
            const uint32_t pq = middle(&b, slots, slot_count, p, q);
            const uint32_t qr = middle(&b, slots, slot_count, q, r);
            const uint32_t rp = middle(&b, slots, slot_count, r, p);
            b.indices[n] = pq;
            b.indices[n + 1] = qr;
            b.indices[n + 2] = rp;
            add_triangle(&b, p, pq, rp);
            add_triangle(&b, q, qr, pq);
            add_triangle(&b, r, rp, qr);
        }
    }
    free(slots);
    return finish(&b, "icosphere", NULL, 0);
}

// --- The others --------------------------------------------------------------------------------

const girih_mesh *make_torus(uint32_t around, uint32_t across) {
    const double turn = 2.0 * acos(-1.0);
    builder b = begin(around * across, 2 * around * across);
    for (uint32_t n = 0; n < around; ++n) {
        for (uint32_t m = 0; m < across; ++m) {
            const double a = turn * n / around;
            const double c = turn * m / across;
            const float normal[3] = {(float)(cos(a) * cos(c)), (float)(sin(a) * cos(c)),
                                     (float)sin(c)};
            const float position[3] = {(float)(cos(a) * (1.0 + 0.4 * cos(c))),
                                       (float)(sin(a) * (1.0 + 0.4 * cos(c))),
                                       (float)(0.4 * sin(c))};
            add_vertex(&b, position, normal, (float)a, (float)c);
        }
    }
    // The outer half first, then the inner one.
    girih_submesh submeshes[2] = {{.material = 0}, {.material = 1}};
    for (int inner = 0; inner < 2; ++inner) {
        submeshes[inner].first_index = b.index_count;
        for (uint32_t n = 0; n < around; ++n) {
            for (uint32_t m = 0; m < across; ++m) {
                const int is_inner = 4 * m >= across && 4 * m < 3 * across;
                if (is_inner != inner) {
                    continue;
                }
                const uint32_t next_n = (n + 1) % around;
                const uint32_t next_m = (m + 1) % across;
                const uint32_t p = n * across + m, q = next_n * across + m;
                const uint32_t r = next_n * across + next_m, s = n * across + next_m;
                add_triangle(&b, p, q, r);
                add_triangle(&b, p, r, s);
            }
        }
        submeshes[inner].index_count = b.index_count - submeshes[inner].first_index;
    }
    return finish(&b, "torus", submeshes, 2);
}

const girih_mesh *make_cube(int hard) {
    builder b = begin(24, 12);
    if (!hard) {
        for (uint32_t n = 0; n < 8; ++n) {
            const float p[3] = {n & 1 ? 0.5f : -0.5f, n & 2 ? 0.5f : -0.5f, n & 4 ? 0.5f : -0.5f};
            add_vertex(&b, p, p, p[0], p[1]);
        }
    }
    for (uint32_t axis = 0; axis < 3; ++axis) {
        for (uint32_t side = 0; side < 2; ++side) {
            uint32_t v[4];
            for (uint32_t n = 0; n < 4; ++n) {
                const uint32_t y = (axis + 1) % 3, z = (axis + 2) % 3;
                const uint32_t along_y = n == 1 || n == 2, along_z = n >= 2;
                if (!hard) {
                    v[n] = side << axis | along_y << y | along_z << z;
                    continue;
                }
                float p[3], normal[3] = {0.0f, 0.0f, 0.0f};
                p[axis] = side ? 0.5f : -0.5f;
                p[y] = along_y ? 0.5f : -0.5f;
                p[z] = along_z ? 0.5f : -0.5f;
                normal[axis] = side ? 1.0f : -1.0f;
                v[n] = add_vertex(&b, p, normal, (float)along_y, (float)along_z);
            }
            add_triangle(&b, v[0], v[side ? 1 : 2], v[side ? 2 : 1]);
            add_triangle(&b, v[0], v[side ? 2 : 3], v[side ? 3 : 2]);
        }
    }
    return finish(&b, hard ? "hard cube" : "smooth cube", NULL, 0);
}

// A zero coordinate with the sign asked for.
static float zero_or(double value, int negative) {
    const float rounded = fabs(value) < 1e-12 ? 0.0f : (float)value;
    return rounded == 0.0f && negative ? -0.0f : rounded;
}

const girih_mesh *make_seam_sphere(uint32_t columns, uint32_t rows) {
    const double half_turn = acos(-1.0);
    const uint32_t width = columns + 1;
    builder b = begin(width * (rows + 1), 2 * columns * rows);
    for (uint32_t row = 0; row <= rows; ++row) {
        for (uint32_t column = 0; column <= columns; ++column) {
            const double polar = half_turn * row / rows;
            const double angle = 2.0 * half_turn * (column % columns) / columns;
            const int pole = row == 0 || row == rows;
            const double radius = pole ? 0.0 : sin(polar);
            const int negative = column == columns || column % 2 == 1;
            const float position[3] = {zero_or(radius * cos(angle), negative),
                                       zero_or(radius * sin(angle), negative),
                                       zero_or(cos(polar), negative)};
            float normal[3] = {position[0], position[1], position[2]};
            if (column == columns) {
                normal[2] += 0.3f; // a normal map's seam
            }
            add_vertex(&b, position, normal, (float)column / (float)columns,
                       (float)row / (float)rows);
        }
    }
    girih_submesh submeshes[2] = {{.material = 0}, {.material = 2, .two_sided = 1}};
    for (uint32_t row = 0; row < rows; ++row) {
        if (row == rows / 2) {
            submeshes[1].first_index = b.index_count;
        }
        for (uint32_t column = 0; column < columns; ++column) {
            const uint32_t p = row * width + column, q = p + width;
            if (row + 1 < rows) {
                add_triangle(&b, p, q, q + 1);
            }
            if (row > 0) {
                add_triangle(&b, p, row + 1 < rows ? q + 1 : q, p + 1);
            }
        }
    }
    submeshes[0].index_count = submeshes[1].first_index;
    submeshes[1].index_count = b.index_count - submeshes[1].first_index;
    return finish(&b, "seam sphere", submeshes, 2);
}

const girih_mesh *make_drum(uint32_t columns, uint32_t rows) {
    const double turn = 2.0 * acos(-1.0);
    const uint32_t width = columns + 1;
    builder b = begin(width * (rows + 1) + 2 * (columns + 1), 2 * columns * (rows + 1));
    for (uint32_t row = 0; row <= rows; ++row) {
        for (uint32_t column = 0; column <= columns; ++column) {
            const double angle = turn * (column % columns) / columns;
            const float normal[3] = {zero_or(cos(angle), 0), zero_or(sin(angle), 0), 0};
            const float position[3] = {normal[0], normal[1], (float)(2.0 * row / rows - 1.0)};
            add_vertex(&b, position, normal, (float)column / (float)columns,
                       (float)row / (float)rows);
        }
    }
    girih_submesh submeshes[2] = {{.material = 0}, {.material = 1}};
    for (uint32_t n = 0; n < rows * columns; ++n) {
        const uint32_t p = n / columns * width + n % columns, q = p + width;
        add_triangle(&b, p, p + 1, q + 1);
        add_triangle(&b, p, q + 1, q);
    }
    submeshes[0].index_count = submeshes[1].first_index = b.index_count;
    for (uint32_t top = 0; top < 2; ++top) {
        const float side = top ? 1.0f : -1.0f;
        const float normal[3] = {0, 0, side};
        const uint32_t middle = add_vertex(&b, normal, normal, 0.5f, 0.5f);
        for (uint32_t column = 0; column < columns; ++column) {
            const float *rim = b.positions + 3 * (size_t)column;
            const float position[3] = {rim[0], rim[1], side};
            add_vertex(&b, position, normal, rim[0], rim[1]);
        }
        for (uint32_t column = 0; column < columns; ++column) {
            const uint32_t p = middle + 1 + column, q = middle + 1 + (column + 1) % columns;
            add_triangle(&b, middle, top ? p : q, top ? q : p);
        }
    }
    submeshes[1].index_count = b.index_count - submeshes[1].first_index;
    return finish(&b, "drum", submeshes, 2);
}

// Whether a triangle with these three vertices is there, whatever its winding.
static int has_triangle(const builder *b, const uint32_t v[3]) {
    for (uint32_t n = 0; n < b->index_count; n += 3) {
        const uint32_t *other = b->indices + n;
        int common = 0;
        for (int corner = 0; corner < 3; ++corner) {
            common += v[corner] == other[0] || v[corner] == other[1] || v[corner] == other[2];
        }
        if (common == 3) {
            return 1;
        }
    }
    return 0;
}

const girih_mesh *make_soup(uint32_t triangles, uint32_t points, uint64_t seed) {
    uint64_t state = seed * 2 + 1;
    builder b = begin(points > 0 ? points : 3 * triangles, triangles);
    for (uint32_t n = 0; n < b.vertex_room; ++n) {
        float position[3], normal[3];
        for (int axis = 0; axis < 3; ++axis) {
            position[axis] = draw_float(&state, -1.0f, 1.0f);
            normal[axis] = draw_float(&state, -1.0f, 1.0f);
        }
        add_vertex(&b, position, normal, position[0], normal[0]);
    }
    for (uint32_t n = 0; n < triangles; ++n) {
        uint32_t v[3] = {3 * n, 3 * n + 1, 3 * n + 2};
        while (points > 0) {
            for (int corner = 0; corner < 3; ++corner) {
                v[corner] = draw_number(&state) % points;
            }
            if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0] && !has_triangle(&b, v)) {
                break;
            }
        }
        add_triangle(&b, v[0], v[1], v[2]);
    }
    const uint32_t third = triangles / 3 * 3;
    const girih_submesh submeshes[3] = {
        {.first_index = 0, .index_count = third, .material = 1},
        {.first_index = third, .index_count = third, .material = 0, .two_sided = 1},
        {.first_index = 2 * third, .index_count = b.index_count - 2 * third, .material = 1}};
    return finish(&b, "soup", submeshes, 3);
}

const girih_mesh *make_needle(float length) {
    builder b = begin(4, 4);
    static const float base[3][2] = {{-0.45f, -0.26f}, {0.45f, -0.26f}, {0.0f, 0.52f}};
    for (uint32_t n = 0; n < 3; ++n) {
        const float position[3] = {base[n][0], base[n][1], 0.0f};
        add_vertex(&b, position, position, base[n][0], base[n][1]);
    }
    const float tip[3] = {0.0f, 0.0f, length};
    add_vertex(&b, tip, tip, 0.5f, 0.5f);
    add_triangle(&b, 0, 2, 1);
    for (uint32_t n = 0; n < 3; ++n) {
        add_triangle(&b, n, (n + 1) % 3, 3);
    }
    return finish(&b, "needle", NULL, 0);
}

const girih_mesh *make_triangle(void) {
    static const float positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const float normal[3] = {0, 0, 1};
    builder b = begin(3, 1);
    for (int n = 0; n < 3; ++n) {
        add_vertex(&b, positions[n], normal, positions[n][0], positions[n][1]);
    }
    add_triangle(&b, 0, 1, 2);
    return finish(&b, "triangle", NULL, 0);
}

const girih_mesh *make_copy(const girih_mesh *mesh, const float *positions, int apart,
                            int dynamic) {
    builder b = begin(apart ? 3 * mesh->triangle_count : mesh->vertex_count, mesh->triangle_count);
    for (uint32_t n = 0; n < b.vertex_room; ++n) {
        const size_t v = apart ? mesh->triangle_vertices[n] : n;
        add_vertex(&b, (positions ? positions : mesh->positions) + 3 * v, mesh->normals + 3 * v,
                   mesh->attributes[2 * v], mesh->attributes[2 * v + 1]);
    }
    for (uint32_t n = 0; n < 3 * mesh->triangle_count; n += 3) {
        const uint32_t *v = mesh->triangle_vertices + n;
        add_triangle(&b, apart ? n : v[0], apart ? n + 1 : v[1], apart ? n + 2 : v[2]);
    }
    b.dynamic = dynamic;
    return finish(&b, mesh->name, mesh->submeshes, mesh->submesh_count);
}

const girih_mesh *make_nothing(void) {
    builder b = begin(0, 0);
    return finish(&b, "nothing", NULL, 0);
}

const girih_mesh *make_materials(uint32_t triangles, uint32_t materials) {
    const uint32_t vertices = 3 * triangles;
    float *positions = malloc(((size_t)vertices * 5 + 5) * sizeof *positions);
    uint32_t *indices = malloc(((size_t)vertices + 1) * sizeof *indices);
    assert_true(positions && indices);
    float *attributes = positions + (size_t)vertices * 3;
    uint64_t state = 4711;
    for (uint32_t n = 0; n < vertices; ++n) {
        indices[n] = n;
        for (int axis = 0; axis < 3; ++axis) {
            positions[3 * (size_t)n + (size_t)axis] = draw_float(&state, -1.0f, 1.0f);
        }
        attributes[2 * (size_t)n] = draw_float(&state, 0.0f, 1.0f);
        attributes[2 * (size_t)n + 1] = 0.5f;
    }
    girih_submesh *submeshes = calloc(materials, sizeof *submeshes);
    assert_non_null(submeshes);
    for (uint32_t n = 0; n < materials; ++n) {
        const uint32_t first = (uint32_t)((uint64_t)triangles * n / materials);
        const uint32_t end = (uint32_t)((uint64_t)triangles * (n + 1) / materials);
        // Materials against the order of the triangles, so that the sort has them to move.
        submeshes[n] = (girih_submesh){.first_index = 3 * first,
                                       .index_count = 3 * (end - first),
                                       .material = materials - 1 - n};
    }
    const girih_mesh_desc desc = {.name = "materials",
                                  .vertex_count = vertices,
                                  .positions = positions,
                                  .attributes = attributes,
                                  .attribute_floats = 2,
                                  .indices = indices,
                                  .index_count = vertices,
                                  .submeshes = submeshes,
                                  .submesh_count = materials,
                                  .missing_normals = GIRIH_NORMALS_FLAT};
    const girih_mesh *mesh;
    girih_error error = {GIRIH_OK, ""};
    if (girih_mesh_create(&desc, &mesh, &error) != GIRIH_OK) {
        fail_msg("%s: %s", desc.name, error.message);
    }
    free(submeshes);
    free(positions);
    free(indices);
    return mesh;
}
