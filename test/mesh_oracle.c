#include "mesh_oracle.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

// Room for the largest mesh that is checked.
#define MOST_TRIANGLES 400
#define MOST_CORNERS (3 * MOST_TRIANGLES)

static float read_float(const float *base, size_t stride, uint32_t vertex, uint32_t number) {
    float value;
    memcpy(&value, (const char *)base + stride * vertex + sizeof value * number, sizeof value);
    return value == 0.0f ? 0.0f : value;
}

static float input_position(const girih_mesh_desc *desc, uint32_t vertex, uint32_t axis) {
    return read_float(desc->positions, desc->position_stride ? desc->position_stride : 12, vertex,
                      axis);
}

static bool same_input_point(const girih_mesh_desc *desc, uint32_t a, uint32_t b) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
        if (input_position(desc, a, axis) != input_position(desc, b, axis)) {
            return false;
        }
    }
    return true;
}

static uint32_t next(uint32_t corner) {
    return corner - corner % 3 + (corner + 1) % 3;
}

static void assert_triangles(const girih_mesh *mesh, const girih_mesh_desc *desc) {
    const girih_submesh whole = {0, desc->index_count, 0, 0};
    const girih_submesh *submeshes = desc->submeshes ? desc->submeshes : &whole;
    uint32_t submesh_count = desc->submeshes ? desc->submesh_count : 1;
    uint32_t kept = 0;
    uint32_t dropped = 0;
    assert_int_equal(mesh->submesh_count, submesh_count);
    for (uint32_t s = 0; s < submesh_count; ++s) {
        assert_int_equal(mesh->submeshes[s].first_index, 3 * kept);
        for (uint32_t i = 0; i < submeshes[s].index_count; i += 3) {
            const uint32_t *index = desc->indices + submeshes[s].first_index + i;
            if (same_input_point(desc, index[0], index[1]) ||
                same_input_point(desc, index[1], index[2]) ||
                same_input_point(desc, index[2], index[0])) {
                ++dropped;
                continue;
            }
            assert_true(kept < mesh->triangle_count);
            assert_int_equal(mesh->triangle_source[kept], (submeshes[s].first_index + i) / 3);
            for (uint32_t k = 0; k < 3; ++k) {
                uint32_t vertex = mesh->triangle_vertices[3 * kept + k];
                assert_true(vertex < mesh->vertex_count);
                assert_int_equal(mesh->vertex_source[vertex], index[k]);
            }
            ++kept;
        }
        assert_int_equal(mesh->submeshes[s].index_count,
                         3 * kept - mesh->submeshes[s].first_index);
        assert_int_equal(mesh->submeshes[s].material, submeshes[s].material);
        assert_int_equal(mesh->submeshes[s].two_sided, submeshes[s].two_sided);
    }
    assert_int_equal(mesh->triangle_count, kept);
    assert_int_equal(mesh->dropped_triangles, dropped);
    assert_true(kept <= MOST_TRIANGLES);
}

static void assert_vertices(const girih_mesh *mesh, const girih_mesh_desc *desc) {
    uint32_t kept = 0;
    for (uint32_t vertex = 0; vertex < desc->vertex_count; ++vertex) {
        bool used = false;
        for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
            used |= mesh->vertex_source[mesh->triangle_vertices[corner]] == vertex;
        }
        if (used) {
            assert_true(kept < mesh->vertex_count);
            assert_int_equal(mesh->vertex_source[kept++], vertex);
        }
    }
    if (desc->normals) {
        assert_int_equal(mesh->vertex_count, kept);
    }
    // Copies follow, in the order of first use, and each vertex has a triangle.
    uint32_t copies = kept;
    bool used[2 * MOST_CORNERS] = {false};
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        uint32_t vertex = mesh->triangle_vertices[corner];
        assert_true(vertex <= copies);
        copies += vertex == copies;
        used[vertex] = true;
    }
    assert_int_equal(mesh->vertex_count, copies);

    for (uint32_t vertex = 0; vertex < mesh->vertex_count; ++vertex) {
        uint32_t source = mesh->vertex_source[vertex];
        uint32_t point = 0;
        double length = 0.0;
        assert_true(used[vertex]);
        for (uint32_t axis = 0; axis < 3; ++axis) {
            float position = input_position(desc, source, axis);
            float normal = mesh->normals[3 * vertex + axis];
            assert_memory_equal(&mesh->positions[3 * vertex + axis], &position, sizeof position);
            assert_false(normal == 0.0f && signbit(normal));
            length += (double)normal * (double)normal;
            assert_true(mesh->bounds_min[axis] <= position && position <= mesh->bounds_max[axis]);
        }
        assert_true(length == 0.0 || fabs(length - 1.0) < 1e-6);
        for (uint32_t number = 0; number < mesh->attribute_floats; ++number) {
            float value = read_float(desc->attributes, 4 * (size_t)desc->attribute_floats, source,
                                     number);
            assert_memory_equal(&mesh->attributes[mesh->attribute_floats * vertex + number],
                                &value, sizeof value);
        }
        while (memcmp(mesh->positions + 3 * point, mesh->positions + 3 * vertex, 12) != 0) {
            ++point;
        }
        assert_int_equal(mesh->vertex_point[vertex], point);
        if (desc->normals) {
            double given[3];
            double square = 0.0;
            for (uint32_t axis = 0; axis < 3; ++axis) {
                given[axis] = (double)read_float(
                    desc->normals, desc->normal_stride ? desc->normal_stride : 12, source, axis);
                square += given[axis] * given[axis];
            }
            for (uint32_t axis = 0; axis < 3; ++axis) {
                double unit = square > 0.0 ? given[axis] / sqrt(square) : 0.0;
                assert_true(fabs((double)mesh->normals[3 * vertex + axis] - unit) < 1e-7);
            }
        }
    }
}

typedef struct oracle_edge {
    uint32_t ends[2]; // points
    uint32_t uses;
    uint32_t half_edges[2];
    bool seam;
} oracle_edge;

static bool point_before(const girih_mesh *mesh, uint32_t a, uint32_t b) {
    const float *p = mesh->positions + 3 * a;
    const float *q = mesh->positions + 3 * b;
    return p[0] != q[0] ? p[0] < q[0] : p[1] != q[1] ? p[1] < q[1] : p[2] < q[2];
}

static uint32_t point_of(const girih_mesh *mesh, uint32_t corner) {
    return mesh->vertex_point[mesh->triangle_vertices[corner]];
}

static uint32_t vertex_at(const girih_mesh *mesh, uint32_t half_edge, uint32_t point) {
    uint32_t corner = point_of(mesh, half_edge) == point ? half_edge : next(half_edge);
    assert_int_equal(point_of(mesh, corner), point);
    return mesh->triangle_vertices[corner];
}

// Edges in the order of first use, with each half-edge's edge.
static uint32_t list_edges(const girih_mesh *mesh, oracle_edge *edges, uint32_t *half_edge_edge) {
    uint32_t count = 0;
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        uint32_t a = point_of(mesh, corner);
        uint32_t b = point_of(mesh, next(corner));
        uint32_t first = point_before(mesh, a, b) ? a : b;
        uint32_t second = first == a ? b : a;
        uint32_t edge = 0;
        while (edge < count && (edges[edge].ends[0] != first || edges[edge].ends[1] != second)) {
            ++edge;
        }
        if (edge == count) {
            edges[count++] = (oracle_edge){.ends = {first, second}};
        }
        if (edges[edge].uses < 2) {
            edges[edge].half_edges[edges[edge].uses] = corner;
        }
        ++edges[edge].uses;
        half_edge_edge[corner] = edge;
    }
    return count;
}

// By brute force: the first corner or edge of all at each place.
static void assert_owners(const girih_mesh *mesh) {
    for (uint32_t corner = 3 * mesh->triangle_count; corner-- > 0;) {
        uint32_t owner = 0;
        while (mesh->triangle_vertices[owner] != mesh->triangle_vertices[corner]) {
            ++owner;
        }
        assert_int_equal(mesh->vertex_owner[mesh->triangle_vertices[corner]], owner);
        owner = 0;
        while (mesh->triangle_edges[owner] != mesh->triangle_edges[corner]) {
            ++owner;
        }
        assert_int_equal(mesh->edge_owner[mesh->triangle_edges[corner]], owner);
        const uint32_t weld_edge = mesh->triangle_weld_edges[corner] & 0x7fffffffu;
        owner = 0;
        while ((mesh->triangle_weld_edges[owner] & 0x7fffffffu) != weld_edge) {
            ++owner;
        }
        assert_int_equal(mesh->weld_edge_owner[weld_edge], owner);
    }
}

static void assert_edges(const girih_mesh *mesh) {
    static oracle_edge edges[MOST_CORNERS];
    static uint32_t half_edge_edge[MOST_CORNERS];
    uint32_t numbers[MOST_CORNERS];
    uint32_t count = list_edges(mesh, edges, half_edge_edge);
    uint32_t seams = 0;
    uint32_t open = 0;
    uint32_t nonmanifold = 0;
    uint32_t flipped = 0;
    for (uint32_t edge = 0; edge < count; ++edge) {
        oracle_edge *e = edges + edge;
        e->seam = e->uses > 2;
        for (int end = 0; end < 2 && e->uses == 2; ++end) {
            uint32_t a = vertex_at(mesh, e->half_edges[0], e->ends[end]);
            uint32_t b = vertex_at(mesh, e->half_edges[1], e->ends[end]);
            e->seam |= memcmp(mesh->normals + 3 * a, mesh->normals + 3 * b, 12) != 0 ||
                       (mesh->dynamic && a != b);
        }
        seams += e->seam;
        open += e->uses == 1;
        nonmanifold += e->uses > 2;
        flipped += e->uses == 2 &&
                   point_of(mesh, e->half_edges[0]) == point_of(mesh, e->half_edges[1]);
    }
    assert_int_equal(mesh->edge_count, count);
    assert_int_equal(mesh->seam_count, seams);
    assert_int_equal(mesh->open_edges, open);
    assert_int_equal(mesh->nonmanifold_edges, nonmanifold);
    assert_int_equal(mesh->flipped_edges, flipped);

    uint32_t next_seam = 0;
    uint32_t next_other = seams;
    for (uint32_t edge = 0; edge < count; ++edge) {
        const oracle_edge *e = edges + edge;
        uint32_t number = e->seam ? next_seam++ : next_other++;
        numbers[edge] = number;
        assert_int_equal(mesh->edge_uses[number], e->uses < 255 ? e->uses : 255);
        for (uint32_t end = 0; end < 2; ++end) {
            assert_int_equal(mesh->edge_points[2 * number + end], e->ends[end]);
            if (e->seam) {
                uint32_t other = e->half_edges[e->uses == 2];
                assert_int_equal(mesh->seams[4 * number + end],
                                 vertex_at(mesh, e->half_edges[0], e->ends[end]));
                assert_int_equal(mesh->seams[4 * number + 2 + end],
                                 vertex_at(mesh, other, e->ends[end]));
            }
        }
    }
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        assert_int_equal(mesh->triangle_edges[corner], numbers[half_edge_edge[corner]]);
    }
}

static uint32_t submesh_of(const girih_mesh *mesh, uint32_t corner) {
    uint32_t submesh = 0;
    while (corner - mesh->submeshes[submesh].first_index >= mesh->submeshes[submesh].index_count) {
        ++submesh;
    }
    return submesh;
}

static void assert_weld_edges(const girih_mesh *mesh) {
    uint32_t first_use[MOST_CORNERS];
    uint32_t lowest[MOST_CORNERS];
    uint32_t count = 0;
    memset(lowest, 0xff, sizeof lowest);
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        uint32_t a = mesh->triangle_vertices[corner];
        uint32_t b = mesh->triangle_vertices[next(corner)];
        uint32_t weld_edge = 0;
        for (; weld_edge < count; ++weld_edge) {
            uint32_t c = mesh->triangle_vertices[first_use[weld_edge]];
            uint32_t d = mesh->triangle_vertices[next(first_use[weld_edge])];
            if (submesh_of(mesh, first_use[weld_edge]) == submesh_of(mesh, corner) &&
                ((a == c && b == d) || (a == d && b == c))) {
                break;
            }
        }
        if (weld_edge == count) {
            first_use[count++] = corner;
        }
        uint32_t edge = mesh->triangle_edges[corner];
        bool against = mesh->vertex_point[a] != mesh->edge_points[2 * edge];
        assert_int_equal(mesh->triangle_weld_edges[corner],
                         weld_edge | (against ? 0x80000000u : 0u));
        assert_int_equal(mesh->weld_edge_edge[weld_edge], edge);
        lowest[edge] = weld_edge < lowest[edge] ? weld_edge : lowest[edge];
    }
    assert_int_equal(mesh->weld_edge_count, count);
    assert_memory_equal(mesh->edge_weld_edge, lowest, mesh->edge_count * sizeof *lowest);
}

void assert_mesh_follows(const girih_mesh *mesh, const girih_mesh_desc *desc) {
    assert_string_equal(mesh->name, desc->name ? desc->name : "");
    assert_int_equal(mesh->made_normals, desc->normals == NULL);
    assert_int_equal(mesh->dynamic, desc->dynamic != 0);
    assert_int_equal(mesh->attribute_floats, desc->attribute_floats);
    assert_triangles(mesh, desc);
    assert_vertices(mesh, desc);
    assert_edges(mesh);
    assert_weld_edges(mesh);
    assert_owners(mesh);
}

typedef struct oracle_face {
    double normal[3]; // 0 where there is no area
    double angles[3];
} oracle_face;

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static oracle_face face_of(const girih_mesh *mesh, uint32_t triangle) {
    oracle_face face;
    for (uint32_t corner = 0; corner < 3; ++corner) {
        double to[2][3];
        for (uint32_t other = 0; other < 2; ++other) {
            for (uint32_t axis = 0; axis < 3; ++axis) {
                uint32_t at = mesh->triangle_vertices[3 * triangle + corner];
                uint32_t end =
                    mesh->triangle_vertices[3 * triangle + (corner + 1 + other) % 3];
                to[other][axis] = (double)mesh->positions[3 * end + axis] -
                                  (double)mesh->positions[3 * at + axis];
            }
        }
        double cross[3] = {to[0][1] * to[1][2] - to[0][2] * to[1][1],
                           to[0][2] * to[1][0] - to[0][0] * to[1][2],
                           to[0][0] * to[1][1] - to[0][1] * to[1][0]};
        double area = length_of(cross);
        double cosine = (to[0][0] * to[1][0] + to[0][1] * to[1][1] + to[0][2] * to[1][2]) /
                        (length_of(to[0]) * length_of(to[1]));
        face.angles[corner] = acos(fmax(-1.0, fmin(1.0, cosine)));
        for (uint32_t axis = 0; axis < 3; ++axis) {
            face.normal[axis] = area > 1e-6 ? cross[axis] / area : 0.0;
        }
    }
    return face;
}

// Spreads the lowest number over each group until nothing changes.
static void list_groups(const girih_mesh *mesh, const oracle_face *faces, double crease,
                        uint32_t *groups) {
    static oracle_edge edges[MOST_CORNERS];
    static uint32_t half_edge_edge[MOST_CORNERS];
    uint32_t count = list_edges(mesh, edges, half_edge_edge);
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        groups[corner] = corner;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t edge = 0; edge < count; ++edge) {
            uint32_t a = edges[edge].half_edges[0];
            uint32_t b = edges[edge].half_edges[1];
            if (edges[edge].uses != 2 || point_of(mesh, a) == point_of(mesh, b)) {
                continue;
            }
            const double *m = faces[a / 3].normal;
            const double *n = faces[b / 3].normal;
            double cosine = m[0] * n[0] + m[1] * n[1] + m[2] * n[2];
            double angle = acos(fmax(-1.0, fmin(1.0, cosine))) * 180.0 / acos(-1.0);
            if (length_of(m) > 0.5 && length_of(n) > 0.5 && crease > 0.0 && angle > crease) {
                continue;
            }
            const uint32_t pairs[2][2] = {{a, next(b)}, {next(a), b}};
            for (int pair = 0; pair < 2; ++pair) {
                uint32_t *p = groups + pairs[pair][0];
                uint32_t *q = groups + pairs[pair][1];
                changed |= *p != *q;
                *p = *q = *p < *q ? *p : *q;
            }
        }
    }
}

void assert_smooth_normals(const girih_mesh *mesh, const girih_mesh_desc *desc) {
    static oracle_face faces[MOST_TRIANGLES];
    static uint32_t groups[MOST_CORNERS];
    static double sums[MOST_CORNERS][3];
    uint32_t corner_count = 3 * mesh->triangle_count;
    for (uint32_t triangle = 0; triangle < mesh->triangle_count; ++triangle) {
        faces[triangle] = face_of(mesh, triangle);
    }
    list_groups(mesh, faces, (double)desc->crease_degrees, groups);
    memset(sums, 0, sizeof sums);
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
            sums[groups[corner]][axis] +=
                faces[corner / 3].angles[corner % 3] * faces[corner / 3].normal[axis];
        }
    }
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        const float *normal = mesh->normals + 3 * mesh->triangle_vertices[corner];
        const float *leader = mesh->normals + 3 * mesh->triangle_vertices[groups[corner]];
        double length = length_of(sums[groups[corner]]);
        assert_memory_equal(normal, leader, 12);
        for (int axis = 0; axis < 3; ++axis) {
            double expected = length > 1e-6 ? sums[groups[corner]][axis] / length : 0.0;
            assert_true(fabs((double)normal[axis] - expected) < 1e-6);
        }
    }
    for (uint32_t a = 0; a < mesh->vertex_count; ++a) {
        for (uint32_t b = a + 1; b < mesh->vertex_count; ++b) {
            assert_false(mesh->vertex_source[a] == mesh->vertex_source[b] &&
                         memcmp(mesh->normals + 3 * a, mesh->normals + 3 * b, 12) == 0);
        }
    }
}

void assert_meshes_equal(const girih_mesh *a, const girih_mesh *b) {
    assert_string_equal(a->name, b->name);
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_int_equal(a->edge_count, b->edge_count);
    assert_int_equal(a->seam_count, b->seam_count);
    assert_int_equal(a->weld_edge_count, b->weld_edge_count);
    assert_int_equal(a->submesh_count, b->submesh_count);
    assert_int_equal(a->attribute_floats, b->attribute_floats);
    assert_int_equal(a->dropped_triangles, b->dropped_triangles);
    assert_int_equal(a->open_edges, b->open_edges);
    assert_int_equal(a->nonmanifold_edges, b->nonmanifold_edges);
    assert_int_equal(a->flipped_edges, b->flipped_edges);
    assert_int_equal(a->made_normals, b->made_normals);
    assert_memory_equal(a->bounds_min, b->bounds_min, sizeof a->bounds_min);
    assert_memory_equal(a->bounds_max, b->bounds_max, sizeof a->bounds_max);
    size_t v = a->vertex_count;
    size_t c = 3 * (size_t)a->triangle_count;
    assert_memory_equal(a->positions, b->positions, 12 * v);
    assert_memory_equal(a->normals, b->normals, 12 * v);
    assert_memory_equal(a->attributes, b->attributes, 4 * v * a->attribute_floats);
    assert_memory_equal(a->vertex_source, b->vertex_source, 4 * v);
    assert_memory_equal(a->vertex_point, b->vertex_point, 4 * v);
    assert_memory_equal(a->triangle_vertices, b->triangle_vertices, 4 * c);
    assert_memory_equal(a->triangle_edges, b->triangle_edges, 4 * c);
    assert_memory_equal(a->triangle_weld_edges, b->triangle_weld_edges, 4 * c);
    assert_memory_equal(a->triangle_source, b->triangle_source, 4 * (c / 3));
    assert_memory_equal(a->edge_points, b->edge_points, 8 * (size_t)a->edge_count);
    assert_memory_equal(a->seams, b->seams, 16 * (size_t)a->seam_count);
    assert_memory_equal(a->weld_edge_edge, b->weld_edge_edge, 4 * (size_t)a->weld_edge_count);
    assert_memory_equal(a->edge_weld_edge, b->edge_weld_edge, 4 * (size_t)a->edge_count);
    assert_memory_equal(a->edge_uses, b->edge_uses, a->edge_count);
    assert_memory_equal(a->edge_owner, b->edge_owner, 4 * (size_t)a->edge_count);
    assert_memory_equal(a->weld_edge_owner, b->weld_edge_owner, 4 * (size_t)a->weld_edge_count);
    assert_memory_equal(a->vertex_owner, b->vertex_owner, 4 * v);
    assert_memory_equal(a->submeshes, b->submeshes, a->submesh_count * sizeof *a->submeshes);
}
