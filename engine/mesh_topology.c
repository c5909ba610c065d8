#include "mesh_topology.h"

#include "memory.h"

bool girih_weld_points(const float *positions, uint32_t vertex_count, uint32_t *point) {
    size_t slots = girih_hash_slots(vertex_count);
    uint32_t *table = girih_allocate_array(slots, sizeof *table);
    if (!table) {
        return false;
    }
    memset(table, 0xff, slots * sizeof *table); // GIRIH_NONE everywhere
    for (uint32_t vertex = 0; vertex < vertex_count; ++vertex) {
        const float *position = positions + 3 * (size_t)vertex;
        size_t slot = (size_t)girih_hash_point(position, 0) & (slots - 1);
        while (table[slot] != GIRIH_NONE &&
               !girih_same_bits(positions + 3 * (size_t)table[slot], position)) {
            slot = (slot + 1) & (slots - 1);
        }
        if (table[slot] == GIRIH_NONE) {
            table[slot] = vertex;
        }
        point[vertex] = table[slot];
    }
    girih_free(table);
    return true;
}

// Where a half-edge to some end was met last.
typedef struct girih_last_use {
    uint32_t stamp;
    uint32_t half_edge;
} girih_last_use;

// Numbers the unordered pairs (end, end) of all half-edges in the order of first use. corner_ends
// gives the end at each corner, below end_count. With triangle_groups, which must not decrease,
// pairs of different groups are different. Half-edges are sorted by their lower end, then a table
// over the higher ends finds the equal ones: linear whatever the valence of a vertex.
static bool number_pairs(const uint32_t *corner_ends, uint32_t triangle_count, uint32_t end_count,
                         const uint32_t *triangle_groups, uint32_t *pairs, uint32_t *pair_count) {
    uint32_t corner_count = 3 * triangle_count;
    bool done = false;
    uint32_t *start = girih_allocate_array((size_t)end_count + 1, sizeof *start);
    uint32_t *sorted = girih_allocate_array(corner_count, sizeof *sorted);
    girih_last_use *last = girih_allocate_array(end_count, sizeof *last);
    if (!start || !sorted || !last) {
        goto cleanup;
    }

    memset(start, 0, ((size_t)end_count + 1) * sizeof *start);
    memset(last, 0, end_count * sizeof *last);
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        uint32_t a = corner_ends[corner];
        uint32_t b = corner_ends[girih_next_corner(corner)];
        ++start[a < b ? a : b];
    }
    uint32_t sum = 0;
    for (uint32_t end = 0; end <= end_count; ++end) {
        sum += start[end];
        start[end] = sum;
    }
    // Filled from behind, each start comes down to its first half-edge, and the order is kept.
    for (uint32_t corner = corner_count; corner-- > 0;) {
        uint32_t a = corner_ends[corner];
        uint32_t b = corner_ends[girih_next_corner(corner)];
        sorted[--start[a < b ? a : b]] = corner;
    }

    uint32_t stamp = 0;
    for (uint32_t end = 0; end < end_count; ++end) {
        uint32_t group = GIRIH_NONE;
        ++stamp;
        for (uint32_t place = start[end]; place < start[end + 1]; ++place) {
            uint32_t corner = sorted[place];
            if (triangle_groups && triangle_groups[corner / 3] != group) {
                group = triangle_groups[corner / 3];
                ++stamp;
            }
            uint32_t other = corner_ends[corner];
            if (other == end) {
                other = corner_ends[girih_next_corner(corner)];
            }
            if (last[other].stamp != stamp) {
                last[other] = (girih_last_use){stamp, corner};
            }
            pairs[corner] = last[other].half_edge;
        }
    }
    *pair_count = girih_number_classes(pairs, corner_count);
    done = true;

cleanup:
    girih_free(last);
    girih_free(sorted);
    girih_free(start);
    return done;
}

bool girih_find_edges(girih_mesh_build *build) {
    girih_mesh *mesh = build->mesh;
    uint32_t corner_count = 3 * mesh->triangle_count;
    const uint32_t *points = build->corner_points;
    build->triangle_edges = girih_allocate_array(corner_count, sizeof *build->triangle_edges);
    if (!build->triangle_edges || !number_pairs(points, mesh->triangle_count, mesh->vertex_count,
                                                NULL, build->triangle_edges, &mesh->edge_count)) {
        return false;
    }
    build->edge_uses = girih_allocate_array(mesh->edge_count, sizeof *build->edge_uses);
    build->edge_half_edges =
        girih_allocate_array(mesh->edge_count, 2 * sizeof *build->edge_half_edges);
    if (!build->edge_uses || !build->edge_half_edges) {
        return false;
    }

    memset(build->edge_uses, 0, mesh->edge_count * sizeof *build->edge_uses);
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        uint32_t edge = build->triangle_edges[corner];
        uint8_t uses = build->edge_uses[edge];
        if (uses == 0) {
            build->edge_half_edges[2 * (size_t)edge] = corner;
        }
        if (uses <= 1) { // an open edge has its one half-edge twice
            build->edge_half_edges[2 * (size_t)edge + 1] = corner;
        }
        if (uses < UINT8_MAX) {
            ++build->edge_uses[edge];
        }
    }
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        const uint32_t *half_edges = build->edge_half_edges + 2 * (size_t)edge;
        if (build->edge_uses[edge] == 1) {
            ++mesh->open_edges;
        } else if (build->edge_uses[edge] > 2) {
            ++mesh->nonmanifold_edges;
        } else if (points[half_edges[0]] == points[half_edges[1]]) {
            ++mesh->flipped_edges;
        }
    }
    return true;
}

// Whether the point of vertex a comes before that of vertex b. A total order: there is no -0 and no
// NaN.
static bool comes_before(const float *positions, uint32_t a, uint32_t b) {
    const float *p = positions + 3 * (size_t)a;
    const float *q = positions + 3 * (size_t)b;
    for (int axis = 0; axis < 2; ++axis) {
        if (p[axis] != q[axis]) {
            return p[axis] < q[axis];
        }
    }
    return p[2] < q[2];
}

// The vertices of a half-edge at the ends of its edge: at the point `first`, then at the other.
static void vertices_from(const girih_mesh_build *build, uint32_t half_edge, uint32_t first,
                          uint32_t vertices[2]) {
    uint32_t next = girih_next_corner(half_edge);
    bool along = build->corner_points[half_edge] == first;
    vertices[0] = build->triangle_vertices[along ? half_edge : next];
    vertices[1] = build->triangle_vertices[along ? next : half_edge];
}

// Hard edges, UV seams whose normals differ and edges of three or more triangles (PN-AEN; McDonald,
// Kilgard 2010). Where the host moves the normals, other vertices may come to differ in them.
static bool is_seam(const girih_mesh_build *build, uint32_t edge) {
    if (build->edge_uses[edge] != 2) {
        return build->edge_uses[edge] > 2;
    }
    const uint32_t *half_edges = build->edge_half_edges + 2 * (size_t)edge;
    uint32_t first = build->corner_points[half_edges[0]];
    uint32_t a[2];
    uint32_t b[2];
    vertices_from(build, half_edges[0], first, a);
    vertices_from(build, half_edges[1], first, b);
    for (int end = 0; end < 2; ++end) {
        bool differ = build->mesh->dynamic ? a[end] != b[end]
                                           : !girih_same_bits(build->normals + 3 * (size_t)a[end],
                                                              build->normals + 3 * (size_t)b[end]);
        if (differ) {
            return true;
        }
    }
    return false;
}

bool girih_find_seams(girih_mesh_build *build) {
    girih_mesh *mesh = build->mesh;
    uint32_t edge_count = mesh->edge_count;
    uint32_t corner_count = 3 * mesh->triangle_count;
    bool done = false;
    uint32_t *numbers = girih_allocate_array(edge_count, sizeof *numbers);
    uint8_t *uses = girih_allocate_array(edge_count, sizeof *uses);
    build->edge_points = girih_allocate_array(edge_count, 2 * sizeof *build->edge_points);
    build->edge_owner = girih_allocate_array(edge_count, sizeof *build->edge_owner);
    if (!numbers || !uses || !build->edge_points || !build->edge_owner) {
        goto cleanup;
    }

    // Seams from 0 on, the others from edge_count down; the latter are turned round below.
    uint32_t others = 0;
    for (uint32_t edge = 0; edge < edge_count; ++edge) {
        numbers[edge] = is_seam(build, edge) ? mesh->seam_count++ : edge_count - ++others;
    }
    for (uint32_t edge = 0; edge < edge_count; ++edge) {
        if (numbers[edge] >= mesh->seam_count) {
            numbers[edge] = mesh->seam_count + (edge_count - 1 - numbers[edge]);
        }
    }
    build->seams = girih_allocate_array(mesh->seam_count, 4 * sizeof *build->seams);
    if (!build->seams) {
        goto cleanup;
    }

    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        build->triangle_edges[corner] = numbers[build->triangle_edges[corner]];
    }
    for (uint32_t edge = 0; edge < edge_count; ++edge) {
        const uint32_t *half_edges = build->edge_half_edges + 2 * (size_t)edge;
        uint32_t number = numbers[edge];
        uint32_t a = build->corner_points[half_edges[0]];
        uint32_t b = build->corner_points[girih_next_corner(half_edges[0])];
        bool forward = comes_before(build->positions, a, b);
        uint32_t *ends = build->edge_points + 2 * (size_t)number;
        ends[0] = forward ? a : b;
        ends[1] = forward ? b : a;
        uses[number] = build->edge_uses[edge];
        build->edge_owner[number] = half_edges[0];
        if (number < mesh->seam_count) {
            uint32_t *sides = build->seams + 4 * (size_t)number;
            vertices_from(build, half_edges[0], ends[0], sides);
            vertices_from(build, half_edges[uses[number] > 2 ? 0 : 1], ends[0], sides + 2);
        }
    }
    memcpy(build->edge_uses, uses, edge_count * sizeof *uses);
    done = true;

cleanup:
    girih_free(uses);
    girih_free(numbers);
    return done;
}

bool girih_find_weld_edges(girih_mesh_build *build) {
    girih_mesh *mesh = build->mesh;
    uint32_t corner_count = 3 * mesh->triangle_count;
    bool done = false;
    uint32_t *triangle_submeshes =
        girih_allocate_array(mesh->triangle_count, sizeof *triangle_submeshes);
    build->triangle_weld_edges =
        girih_allocate_array(corner_count, sizeof *build->triangle_weld_edges);
    build->edge_weld_edge = girih_allocate_array(mesh->edge_count, sizeof *build->edge_weld_edge);
    if (!triangle_submeshes || !build->triangle_weld_edges || !build->edge_weld_edge) {
        goto cleanup;
    }

    for (uint32_t submesh = 0; submesh < mesh->submesh_count; ++submesh) {
        uint32_t first = build->submeshes[submesh].first_index / 3;
        uint32_t end = first + build->submeshes[submesh].index_count / 3;
        for (uint32_t triangle = first; triangle < end; ++triangle) {
            triangle_submeshes[triangle] = submesh;
        }
    }
    if (!number_pairs(build->triangle_vertices, mesh->triangle_count, mesh->vertex_count,
                      triangle_submeshes, build->triangle_weld_edges, &mesh->weld_edge_count)) {
        goto cleanup;
    }
    build->weld_edge_edge =
        girih_allocate_array(mesh->weld_edge_count, sizeof *build->weld_edge_edge);
    build->weld_edge_owner =
        girih_allocate_array(mesh->weld_edge_count, sizeof *build->weld_edge_owner);
    if (!build->weld_edge_edge || !build->weld_edge_owner) {
        goto cleanup;
    }

    memset(build->edge_weld_edge, 0xff, mesh->edge_count * sizeof *build->edge_weld_edge);
    for (uint32_t corner = corner_count; corner-- > 0;) {
        uint32_t edge = build->triangle_edges[corner];
        uint32_t weld_edge = build->triangle_weld_edges[corner];
        build->weld_edge_edge[weld_edge] = edge;
        build->weld_edge_owner[weld_edge] = corner;
        if (weld_edge < build->edge_weld_edge[edge]) {
            build->edge_weld_edge[edge] = weld_edge;
        }
        if (build->corner_points[corner] != build->edge_points[2 * (size_t)edge]) {
            build->triangle_weld_edges[corner] = weld_edge | UINT32_C(1) << 31;
        }
    }
    done = true;

cleanup:
    girih_free(triangle_submeshes);
    return done;
}

bool girih_find_vertex_owners(girih_mesh_build *build) {
    const girih_mesh *mesh = build->mesh;
    build->vertex_owner = girih_allocate_array(mesh->vertex_count, sizeof *build->vertex_owner);
    if (!build->vertex_owner) {
        return false;
    }
    for (uint32_t corner = 3 * mesh->triangle_count; corner-- > 0;) {
        build->vertex_owner[build->triangle_vertices[corner]] = corner;
    }
    return true;
}
