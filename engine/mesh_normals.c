#include "mesh_normals.h"

#include <math.h>

#include "memory.h"

// Sums of unit vectors weighted by angles that are shorter than this have cancelled out.
#define CANCELLED 1e-9

// Unit vectors rounded to floats are this near to length 1, squared. They are kept as they are, so
// that a mesh prepared from another's normals has the same bits.
#define UNIT_TOLERANCE 4e-7

// The tolerance of the crease test, on the cosine: a cube's 90 degrees are not more than 90.
#define CREASE_TOLERANCE 1e-7

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Stores the unit vector along a vector longer than `least`, else 0.
static void store_unit(const double vector[3], double least, float normal[3]) {
    double length = sqrt(dot(vector, vector));
    for (int axis = 0; axis < 3; ++axis) {
        normal[axis] = length > least ? girih_positive_zero((float)(vector[axis] / length)) : 0.0f;
    }
}

bool girih_take_normals(girih_mesh_build *build) {
    const girih_mesh_desc *desc = build->desc;
    size_t stride = desc->normal_stride ? desc->normal_stride : 3 * sizeof(float);
    build->normals = girih_allocate_array(build->mesh->vertex_count, 3 * sizeof *build->normals);
    if (!build->normals) {
        return false;
    }
    for (uint32_t vertex = 0; vertex < build->mesh->vertex_count; ++vertex) {
        float normal[3];
        memcpy(normal, (const char *)desc->normals + build->vertex_source[vertex] * stride,
               sizeof normal);
        const double given[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
        float *stored = build->normals + 3 * (size_t)vertex;
        if (fabs(dot(given, given) - 1.0) < UNIT_TOLERANCE) {
            for (int axis = 0; axis < 3; ++axis) {
                stored[axis] = girih_positive_zero(normal[axis]);
            }
        } else {
            store_unit(given, 0.0, stored);
        }
    }
    return true;
}

static void corner_position(const girih_mesh_build *build, uint32_t corner, double position[3]) {
    const float *stored = build->positions + 3 * (size_t)build->triangle_vertices[corner];
    for (int axis = 0; axis < 3; ++axis) {
        position[axis] = (double)stored[axis];
    }
}

// What a triangle gives to its corners' normals.
typedef struct girih_face {
    double normal[3]; // unit length; 0 for a triangle that faces no way
    double angles[3];
} girih_face;

// A triangle no higher over its longest edge than the rounding of its coordinates (a filled
// T-junction, say) faces no way that could be told.
static void measure_face(const girih_mesh_build *build, uint32_t triangle, girih_face *result) {
    double corners[3][3];
    double edges[3][3];
    double squares[3];
    double longest = 0.0;
    double magnitude = 0.0;
    for (uint32_t corner = 0; corner < 3; ++corner) {
        corner_position(build, 3 * triangle + corner, corners[corner]);
    }
    for (int edge = 0; edge < 3; ++edge) {
        for (int axis = 0; axis < 3; ++axis) {
            edges[edge][axis] = corners[(edge + 1) % 3][axis] - corners[edge][axis];
            magnitude = fmax(magnitude, fabs(corners[edge][axis]));
        }
        squares[edge] = dot(edges[edge], edges[edge]);
        longest = fmax(longest, squares[edge]);
    }
    double cross[3] = {
        edges[0][1] * edges[1][2] - edges[0][2] * edges[1][1],
        edges[0][2] * edges[1][0] - edges[0][0] * edges[1][2],
        edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0],
    };
    double doubled_area = sqrt(dot(cross, cross));
    bool faces = doubled_area > sqrt(longest) * magnitude * 0x1p-23;
    for (int axis = 0; axis < 3; ++axis) {
        result->normal[axis] = faces ? cross[axis] / doubled_area : 0.0;
    }
    for (int corner = 0; corner < 3; ++corner) {
        result->angles[corner] =
            faces ? atan2(doubled_area, -dot(edges[corner], edges[(corner + 2) % 3])) : 0.0;
    }
}

static bool faces_a_way(const girih_face *face) {
    return face->normal[0] != 0.0 || face->normal[1] != 0.0 || face->normal[2] != 0.0;
}

static bool grow_vertices(girih_mesh_build *build, uint32_t count) {
    size_t attribute_size = build->mesh->attribute_floats * sizeof *build->attributes;
    float *positions =
        girih_reallocate_array(build->positions, count, 3 * sizeof *build->positions);
    build->positions = positions ? positions : build->positions;
    float *attributes = girih_reallocate_array(build->attributes, count, attribute_size);
    build->attributes = attributes ? attributes : build->attributes;
    uint32_t *source =
        girih_reallocate_array(build->vertex_source, count, sizeof *build->vertex_source);
    build->vertex_source = source ? source : build->vertex_source;
    uint32_t *point =
        girih_reallocate_array(build->vertex_point, count, sizeof *build->vertex_point);
    build->vertex_point = point ? point : build->vertex_point;
    return positions && attributes && source && point;
}

// A copy of a vertex that a split appends.
typedef struct girih_vertex_copy {
    uint32_t vertex;
    uint32_t normal;
} girih_vertex_copy;

// Gives every corner the copy of its vertex that has the corner's normal. Returns the number of
// copies made; copies and table have room for every corner that misfits.
static uint32_t split_corners(girih_mesh_build *build, const uint32_t *corner_normals,
                              const float *normals, const uint32_t *vertex_normals,
                              girih_vertex_copy *copies, uint32_t *table, size_t slots) {
    uint32_t copy_count = 0;
    memset(table, 0xff, slots * sizeof *table); // GIRIH_NONE everywhere
    for (uint32_t corner = 0; corner < 3 * build->mesh->triangle_count; ++corner) {
        uint32_t vertex = build->triangle_vertices[corner];
        const float *normal = normals + 3 * (size_t)corner_normals[corner];
        if (girih_same_bits(normals + 3 * (size_t)vertex_normals[vertex], normal)) {
            continue;
        }
        size_t slot = (size_t)girih_hash_point(normal, vertex) & (slots - 1);
        while (table[slot] != GIRIH_NONE &&
               (copies[table[slot]].vertex != vertex ||
                !girih_same_bits(normals + 3 * (size_t)copies[table[slot]].normal, normal))) {
            slot = (slot + 1) & (slots - 1);
        }
        if (table[slot] == GIRIH_NONE) {
            copies[copy_count] = (girih_vertex_copy){vertex, corner_normals[corner]};
            table[slot] = copy_count++;
        }
        build->triangle_vertices[corner] = build->mesh->vertex_count + table[slot];
    }
    return copy_count;
}

// Gives every vertex the normal that its corners ask for. corner_normals: for each corner, which of
// normals it takes. The first corner at a vertex decides the vertex's own; others split it.
static bool set_normals(girih_mesh_build *build, const uint32_t *corner_normals,
                        const float *normals) {
    girih_mesh *mesh = build->mesh;
    uint32_t kept = mesh->vertex_count;
    bool done = false;
    girih_vertex_copy *copies = NULL;
    uint32_t *table = NULL;
    uint32_t *vertex_normals = girih_allocate_array(kept, sizeof *vertex_normals);
    if (!vertex_normals) {
        goto cleanup;
    }

    uint32_t misfits = 0;
    memset(vertex_normals, 0xff, kept * sizeof *vertex_normals); // GIRIH_NONE everywhere
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        uint32_t vertex = build->triangle_vertices[corner];
        if (vertex_normals[vertex] == GIRIH_NONE) {
            vertex_normals[vertex] = corner_normals[corner];
        } else if (!girih_same_bits(normals + 3 * (size_t)vertex_normals[vertex],
                                    normals + 3 * (size_t)corner_normals[corner])) {
            ++misfits;
        }
    }

    uint32_t copy_count = 0;
    if (misfits) {
        size_t slots = girih_hash_slots(misfits);
        copies = girih_allocate_array(misfits, sizeof *copies);
        table = girih_allocate_array(slots, sizeof *table);
        if (!copies || !table) {
            goto cleanup;
        }
        copy_count =
            split_corners(build, corner_normals, normals, vertex_normals, copies, table, slots);
        if (!grow_vertices(build, kept + copy_count)) {
            goto cleanup;
        }
    }
    build->normals = girih_allocate_array((size_t)kept + copy_count, 3 * sizeof *build->normals);
    if (!build->normals) {
        goto cleanup;
    }

    size_t floats = mesh->attribute_floats;
    for (uint32_t vertex = 0; vertex < kept; ++vertex) {
        memcpy(build->normals + 3 * (size_t)vertex, normals + 3 * (size_t)vertex_normals[vertex],
               3 * sizeof *normals);
    }
    for (uint32_t number = 0; number < copy_count; ++number) {
        size_t from = copies[number].vertex;
        size_t to = (size_t)kept + number;
        memcpy(build->normals + 3 * to, normals + 3 * (size_t)copies[number].normal,
               3 * sizeof *normals);
        memcpy(build->positions + 3 * to, build->positions + 3 * from,
               3 * sizeof *build->positions);
        memcpy(build->attributes + floats * to, build->attributes + floats * from,
               floats * sizeof *build->attributes);
        build->vertex_source[to] = build->vertex_source[from];
        build->vertex_point[to] = build->vertex_point[from];
    }
    mesh->vertex_count = kept + copy_count;
    done = true;

cleanup:
    girih_free(table);
    girih_free(copies);
    girih_free(vertex_normals);
    return done;
}

// A triangle that faces no way takes, at each corner, the normal of the first triangle at that
// vertex that does: it has none to split the vertex for.
static bool make_flat_normals(girih_mesh_build *build, const girih_face *faces) {
    const girih_mesh *mesh = build->mesh;
    bool done = false;
    float *normals = girih_allocate_array(mesh->triangle_count, 3 * sizeof *normals);
    uint32_t *corner_normals =
        girih_allocate_array(3 * (size_t)mesh->triangle_count, sizeof *corner_normals);
    uint32_t *first_face = girih_allocate_array(mesh->vertex_count, sizeof *first_face);
    if (!normals || !corner_normals || !first_face) {
        goto cleanup;
    }
    memset(first_face, 0xff, mesh->vertex_count * sizeof *first_face); // GIRIH_NONE everywhere
    for (uint32_t triangle = 0; triangle < mesh->triangle_count; ++triangle) {
        store_unit(faces[triangle].normal, 0.0, normals + 3 * (size_t)triangle);
        for (uint32_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
            uint32_t *first = first_face + build->triangle_vertices[corner];
            if (*first == GIRIH_NONE && faces_a_way(faces + triangle)) {
                *first = triangle;
            }
        }
    }
    for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; ++corner) {
        uint32_t first = first_face[build->triangle_vertices[corner]];
        bool own = first == GIRIH_NONE || faces_a_way(faces + corner / 3);
        corner_normals[corner] = own ? corner / 3 : first;
    }
    done = set_normals(build, corner_normals, normals);

cleanup:
    girih_free(first_face);
    girih_free(corner_normals);
    girih_free(normals);
    return done;
}

// Parents never have the higher number, so that a class is known by its first corner.
static uint32_t find_root(uint32_t *parents, uint32_t corner) {
    while (parents[corner] != corner) {
        parents[corner] = parents[parents[corner]];
        corner = parents[corner];
    }
    return corner;
}

static void join(uint32_t *parents, uint32_t a, uint32_t b) {
    a = find_root(parents, a);
    b = find_root(parents, b);
    if (a < b) {
        parents[b] = a;
    } else {
        parents[a] = b;
    }
}

// Groups the corners at each point: corners on the two sides of a smooth edge belong together.
// Edges that are open, flipped or of three or more triangles are not smooth. An edge at a triangle
// that faces no way is. Writes each corner's group, returns the number of groups.
static uint32_t group_corners(const girih_mesh_build *build, const girih_face *faces,
                              uint32_t *corner_groups) {
    const girih_mesh *mesh = build->mesh;
    double crease = (double)build->desc->crease_degrees;
    double least_cosine = -2.0;
    if (crease > 0.0 && crease < 180.0) {
        least_cosine = cos(crease * (acos(-1.0) / 180.0)) - CREASE_TOLERANCE;
    }
    uint32_t corner_count = 3 * mesh->triangle_count;
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        corner_groups[corner] = corner;
    }
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        uint32_t a = build->edge_half_edges[2 * (size_t)edge];
        uint32_t b = build->edge_half_edges[2 * (size_t)edge + 1];
        if (build->edge_uses[edge] != 2 || build->corner_points[a] == build->corner_points[b]) {
            continue;
        }
        const girih_face *face_a = faces + a / 3;
        const girih_face *face_b = faces + b / 3;
        if (!faces_a_way(face_a) || !faces_a_way(face_b) ||
            dot(face_a->normal, face_b->normal) >= least_cosine) {
            join(corner_groups, a, girih_next_corner(b));
            join(corner_groups, girih_next_corner(a), b);
        }
    }
    return girih_number_classes(corner_groups, corner_count);
}

// Face normals weighted by the angle at the corner (Thuermer, Wuethrich 1998): independent of how a
// flat face is cut into triangles.
static bool make_smooth_normals(girih_mesh_build *build, const girih_face *faces) {
    uint32_t corner_count = 3 * build->mesh->triangle_count;
    bool done = false;
    double *sums = NULL;
    float *normals = NULL;
    uint32_t *corner_groups = girih_allocate_array(corner_count, sizeof *corner_groups);
    if (!corner_groups) {
        goto cleanup;
    }
    uint32_t group_count = group_corners(build, faces, corner_groups);
    sums = girih_allocate_array(group_count, 3 * sizeof *sums);
    normals = girih_allocate_array(group_count, 3 * sizeof *normals);
    if (!sums || !normals) {
        goto cleanup;
    }
    for (size_t number = 0; number < 3 * (size_t)group_count; ++number) {
        sums[number] = 0.0;
    }
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        const girih_face *from = faces + corner / 3;
        for (int axis = 0; axis < 3; ++axis) {
            sums[3 * (size_t)corner_groups[corner] + (size_t)axis] +=
                from->angles[corner % 3] * from->normal[axis];
        }
    }
    for (uint32_t group = 0; group < group_count; ++group) {
        store_unit(sums + 3 * (size_t)group, CANCELLED, normals + 3 * (size_t)group);
    }
    girih_free(sums);
    sums = NULL;
    done = set_normals(build, corner_groups, normals);

cleanup:
    girih_free(normals);
    girih_free(sums);
    girih_free(corner_groups);
    return done;
}

bool girih_make_normals(girih_mesh_build *build) {
    uint32_t triangle_count = build->mesh->triangle_count;
    girih_face *faces = girih_allocate_array(triangle_count, sizeof *faces);
    if (!faces) {
        return false;
    }
    for (uint32_t triangle = 0; triangle < triangle_count; ++triangle) {
        measure_face(build, triangle, faces + triangle);
    }
    bool done = build->desc->missing_normals == GIRIH_NORMALS_FLAT
                    ? make_flat_normals(build, faces)
                    : make_smooth_normals(build, faces);
    girih_free(faces);
    return done;
}
