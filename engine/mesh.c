#include "girih/mesh.h"

#include <inttypes.h>
#include <math.h>

#include "error.h"
#include "memory.h"
#include "mesh_build.h"
#include "mesh_normals.h"
#include "mesh_topology.h"

// Beyond it 0 * x could become 0 * infinity, and a square times a square would leave the floats.

// Three half-edges a triangle must leave bit 31 free in a weld edge's number.
#define MOST_TRIANGLES (UINT32_C(1) << 29)

// Messages have room for so much of a name.
#define NAMED "mesh \"%.200s\": "

static const char *name_of(const girih_mesh_desc *desc) {
    return desc->name ? desc->name : "";
}

static bool is_finite(float value) {
    return (girih_float_bits(value) & 0x7f800000u) != 0x7f800000u;
}

static girih_result check_pointers(const girih_mesh_desc *desc, girih_error *error) {
    const char *missing = NULL;
    if (desc->vertex_count && !desc->positions) {
        missing = "positions";
    } else if (desc->vertex_count && desc->attribute_floats && !desc->attributes) {
        missing = "attributes";
    } else if (desc->index_count && !desc->indices) {
        missing = "indices";
    } else if (desc->submesh_count && !desc->submeshes) {
        missing = "submeshes";
    }
    if (missing) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          NAMED "%s is null although its count is not 0", name_of(desc), missing);
    }
    if ((desc->position_stride && desc->position_stride < 3 * sizeof(float)) ||
        (desc->normal_stride && desc->normal_stride < 3 * sizeof(float))) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          NAMED "a stride of less than 12 bytes", name_of(desc));
    }
    if (desc->attribute_floats > UINT32_MAX / sizeof(float)) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE, NAMED "%" PRIu32 " floats a vertex",
                          name_of(desc), desc->attribute_floats);
    }
    if (desc->missing_normals != GIRIH_NORMALS_SMOOTH &&
        desc->missing_normals != GIRIH_NORMALS_FLAT) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          NAMED "missing_normals is %d, which names no way to make them",
                          name_of(desc), (int)desc->missing_normals);
    }
    if (!is_finite(desc->crease_degrees)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          NAMED "crease_degrees is %g, not finite", name_of(desc),
                          (double)desc->crease_degrees);
    }
    return GIRIH_OK;
}

static girih_result check_indices(const girih_mesh_desc *desc, girih_error *error) {
    if (desc->index_count % 3 != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          NAMED "%" PRIu32 " indices, not a multiple of 3", name_of(desc),
                          desc->index_count);
    }
    uint64_t triangles = desc->submeshes ? 0 : desc->index_count / 3;
    for (uint32_t number = 0; number < desc->submesh_count; ++number) {
        const girih_submesh *submesh = desc->submeshes + number;
        uint64_t end = (uint64_t)submesh->first_index + submesh->index_count;
        if (submesh->first_index % 3 != 0 || submesh->index_count % 3 != 0) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              NAMED "submesh %" PRIu32 ": first index %" PRIu32
                                    " and index count %" PRIu32 " must be multiples of 3",
                              name_of(desc), number, submesh->first_index, submesh->index_count);
        }
        if (end > desc->index_count) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              NAMED "submesh %" PRIu32 " ends at index %" PRIu64
                                    ", but there are %" PRIu32 " indices",
                              name_of(desc), number, end, desc->index_count);
        }
        if (submesh->material >= GIRIH_MAX_MATERIALS) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              NAMED "submesh %" PRIu32 ": material %" PRIu32 " must be below %u",
                              name_of(desc), number, submesh->material, GIRIH_MAX_MATERIALS);
        }
        triangles += submesh->index_count / 3;
    }
    if (triangles > MOST_TRIANGLES) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          NAMED "%" PRIu64 " triangles; at most %" PRIu32
                                " fit in one mesh: split it",
                          name_of(desc), triangles, MOST_TRIANGLES);
    }
    for (uint32_t index = 0; index < desc->index_count; ++index) {
        if (desc->indices[index] >= desc->vertex_count) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              NAMED "index %" PRIu32 " names vertex %" PRIu32
                                    ", but there are %" PRIu32 " vertices",
                              name_of(desc), index, desc->indices[index], desc->vertex_count);
        }
    }
    return GIRIH_OK;
}

static girih_result check_normals_and_attributes(const girih_mesh_desc *desc, girih_error *error) {
    size_t stride = desc->normal_stride ? desc->normal_stride : 3 * sizeof(float);
    for (uint32_t vertex = 0; desc->normals && vertex < desc->vertex_count; ++vertex) {
        float normal[3];
        memcpy(normal, (const char *)desc->normals + vertex * stride, sizeof normal);
        for (int axis = 0; axis < 3; ++axis) {
            if (!is_finite(normal[axis])) {
                return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                  NAMED "vertex %" PRIu32 ": normal %c is %g, not finite",
                                  name_of(desc), vertex, "xyz"[axis], (double)normal[axis]);
            }
        }
    }
    uint32_t floats = desc->attribute_floats;
    for (uint32_t vertex = 0; floats && vertex < desc->vertex_count; ++vertex) {
        const float *attributes = desc->attributes + (size_t)floats * vertex;
        for (uint32_t number = 0; number < floats; ++number) {
            if (!is_finite(attributes[number])) {
                return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                  NAMED "vertex %" PRIu32 ": attribute %" PRIu32
                                        " is %g, not finite",
                                  name_of(desc), vertex, number, (double)attributes[number]);
            }
        }
    }
    return GIRIH_OK;
}

static girih_result check_positions(const girih_mesh_desc *desc, girih_error *error) {
    size_t stride = desc->position_stride ? desc->position_stride : 3 * sizeof(float);
    for (uint32_t vertex = 0; vertex < desc->vertex_count; ++vertex) {
        float position[3];
        memcpy(position, (const char *)desc->positions + vertex * stride, sizeof position);
        for (int axis = 0; axis < 3; ++axis) {
            if (!is_finite(position[axis]) || fabsf(position[axis]) > GIRIH_MAX_COORDINATE) {
                return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                  NAMED "vertex %" PRIu32 ": position %c is %g; coordinates must "
                                        "be finite and not beyond 1e15",
                                  name_of(desc), vertex, "xyz"[axis], (double)position[axis]);
            }
        }
    }
    return GIRIH_OK;
}

// All input positions, for now.
static bool take_positions(girih_mesh_build *build) {
    const girih_mesh_desc *desc = build->desc;
    size_t stride = desc->position_stride ? desc->position_stride : 3 * sizeof(float);
    build->positions = girih_allocate_array(desc->vertex_count, 3 * sizeof *build->positions);
    build->vertex_point = girih_allocate_array(desc->vertex_count, sizeof *build->vertex_point);
    if (!build->positions || !build->vertex_point) {
        return false;
    }
    for (uint32_t vertex = 0; vertex < desc->vertex_count; ++vertex) {
        float *position = build->positions + 3 * (size_t)vertex;
        memcpy(position, (const char *)desc->positions + vertex * stride, 3 * sizeof *position);
        for (int axis = 0; axis < 3; ++axis) {
            position[axis] = girih_positive_zero(position[axis]);
        }
    }
    return girih_weld_points(build->positions, desc->vertex_count, build->vertex_point);
}

// Keeps the triangles with three distinct points. Their vertices are the input's, for now.
static bool take_triangles(girih_mesh_build *build) {
    const girih_mesh_desc *desc = build->desc;
    girih_mesh *mesh = build->mesh;
    const girih_submesh whole = {.index_count = desc->index_count};
    const girih_submesh *submeshes = desc->submeshes ? desc->submeshes : &whole;
    mesh->submesh_count = desc->submeshes ? desc->submesh_count : 1;

    size_t triangles = 0;
    for (uint32_t number = 0; number < mesh->submesh_count; ++number) {
        triangles += submeshes[number].index_count / 3;
    }
    build->submeshes = girih_allocate_array(mesh->submesh_count, sizeof *build->submeshes);
    build->triangle_source = girih_allocate_array(triangles, sizeof *build->triangle_source);
    build->triangle_vertices =
        girih_allocate_array(3 * triangles, sizeof *build->triangle_vertices);
    if (!build->submeshes || !build->triangle_source || !build->triangle_vertices) {
        return false;
    }

    const uint32_t *point = build->vertex_point;
    for (uint32_t number = 0; number < mesh->submesh_count; ++number) {
        girih_submesh submesh = submeshes[number];
        uint32_t end = submesh.first_index + submesh.index_count;
        uint32_t first_triangle = mesh->triangle_count;
        for (uint32_t index = submesh.first_index; index < end; index += 3) {
            const uint32_t *corners = desc->indices + index;
            uint32_t a = point[corners[0]];
            uint32_t b = point[corners[1]];
            uint32_t c = point[corners[2]];
            if (a == b || b == c || c == a) {
                ++mesh->dropped_triangles;
                continue;
            }
            memcpy(build->triangle_vertices + 3 * (size_t)mesh->triangle_count, corners,
                   3 * sizeof *corners);
            build->triangle_source[mesh->triangle_count++] = index / 3;
        }
        submesh.first_index = 3 * first_triangle;
        submesh.index_count = 3 * (mesh->triangle_count - first_triangle);
        build->submeshes[number] = submesh;
    }
    return true;
}

// Shrinks what was allocated for all of the input to what is kept of it.
static bool shrink_vertices(girih_mesh_build *build) {
    uint32_t count = build->mesh->vertex_count;
    float *positions =
        girih_reallocate_array(build->positions, count, 3 * sizeof *build->positions);
    build->positions = positions ? positions : build->positions;
    uint32_t *point =
        girih_reallocate_array(build->vertex_point, count, sizeof *build->vertex_point);
    build->vertex_point = point ? point : build->vertex_point;
    return positions && point;
}

// Drops the vertices that no kept triangle uses and numbers the others anew.
static bool keep_used_vertices(girih_mesh_build *build) {
    const girih_mesh_desc *desc = build->desc;
    girih_mesh *mesh = build->mesh;
    uint32_t corner_count = 3 * mesh->triangle_count;
    bool done = false;
    uint32_t *numbers = girih_allocate_array(desc->vertex_count, sizeof *numbers);
    uint32_t *lowest_at_point = girih_allocate_array(desc->vertex_count, sizeof *lowest_at_point);
    if (!numbers || !lowest_at_point) {
        goto cleanup;
    }

    memset(numbers, 0xff, desc->vertex_count * sizeof *numbers); // GIRIH_NONE everywhere
    memset(lowest_at_point, 0xff, desc->vertex_count * sizeof *lowest_at_point);
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        uint32_t *number = numbers + build->triangle_vertices[corner];
        if (*number == GIRIH_NONE) {
            *number = 0;
            ++mesh->vertex_count;
        }
    }
    build->vertex_source = girih_allocate_array(mesh->vertex_count, sizeof *build->vertex_source);
    build->corner_points = girih_allocate_array(corner_count, sizeof *build->corner_points);
    if (!build->vertex_source || !build->corner_points) {
        goto cleanup;
    }

    uint32_t kept = 0;
    for (uint32_t vertex = 0; vertex < desc->vertex_count; ++vertex) {
        if (numbers[vertex] == GIRIH_NONE) {
            continue;
        }
        uint32_t *lowest = lowest_at_point + build->vertex_point[vertex];
        if (*lowest == GIRIH_NONE) {
            *lowest = kept;
        }
        // In place: kept is never ahead of vertex.
        build->vertex_point[kept] = *lowest;
        memmove(build->positions + 3 * (size_t)kept, build->positions + 3 * (size_t)vertex,
                3 * sizeof *build->positions);
        build->vertex_source[kept] = vertex;
        numbers[vertex] = kept++;
    }
    for (uint32_t corner = 0; corner < corner_count; ++corner) {
        uint32_t number = numbers[build->triangle_vertices[corner]];
        build->triangle_vertices[corner] = number;
        build->corner_points[corner] = build->vertex_point[number];
    }
    done = shrink_vertices(build);

cleanup:
    girih_free(lowest_at_point);
    girih_free(numbers);
    return done;
}

static bool take_attributes(girih_mesh_build *build) {
    const girih_mesh *mesh = build->mesh;
    size_t floats = mesh->attribute_floats;
    build->attributes =
        girih_allocate_array(mesh->vertex_count, floats * sizeof *build->attributes);
    if (!build->attributes) {
        return false;
    }
    for (uint32_t vertex = 0; floats && vertex < mesh->vertex_count; ++vertex) {
        const float *from = build->desc->attributes + floats * build->vertex_source[vertex];
        float *to = build->attributes + floats * vertex;
        for (size_t number = 0; number < floats; ++number) {
            to[number] = girih_positive_zero(from[number]);
        }
    }
    return true;
}

static bool take_name(girih_mesh_build *build) {
    size_t size = strlen(name_of(build->desc)) + 1;
    char *name = girih_allocate(size);
    if (name) {
        memcpy(name, name_of(build->desc), size);
    }
    build->mesh->name = name;
    return name;
}

static void measure_bounds(girih_mesh *mesh, const float *positions) {
    for (uint32_t vertex = 0; vertex < mesh->vertex_count; ++vertex) {
        for (int axis = 0; axis < 3; ++axis) {
            float value = positions[3 * (size_t)vertex + (size_t)axis];
            if (vertex == 0 || value < mesh->bounds_min[axis]) {
                mesh->bounds_min[axis] = value;
            }
            if (vertex == 0 || value > mesh->bounds_max[axis]) {
                mesh->bounds_max[axis] = value;
            }
        }
    }
}

// Of a checked description. False if there is no memory.
static bool prepare(girih_mesh_build *build) {
    bool given = build->desc->normals;
    build->mesh->made_normals = !given;
    build->mesh->dynamic = build->desc->dynamic != 0;
    build->mesh->attribute_floats = build->desc->attribute_floats;
    if (!take_name(build) || !take_positions(build) || !take_triangles(build) ||
        !keep_used_vertices(build) || !take_attributes(build) || !girih_find_edges(build) ||
        !(given ? girih_take_normals(build) : girih_make_normals(build)) ||
        !girih_find_seams(build) || !girih_find_weld_edges(build) ||
        !girih_find_vertex_owners(build)) {
        return false;
    }
    measure_bounds(build->mesh, build->positions);
    return true;
}

// The arrays are the mesh's from here on.
static void hand_over(girih_mesh_build *build) {
    girih_mesh *mesh = build->mesh;
    mesh->positions = build->positions;
    mesh->normals = build->normals;
    mesh->attributes = build->attributes;
    mesh->vertex_source = build->vertex_source;
    mesh->vertex_point = build->vertex_point;
    mesh->triangle_vertices = build->triangle_vertices;
    mesh->triangle_edges = build->triangle_edges;
    mesh->triangle_weld_edges = build->triangle_weld_edges;
    mesh->triangle_source = build->triangle_source;
    mesh->edge_points = build->edge_points;
    mesh->seams = build->seams;
    mesh->weld_edge_edge = build->weld_edge_edge;
    mesh->edge_weld_edge = build->edge_weld_edge;
    mesh->edge_uses = build->edge_uses;
    mesh->edge_owner = build->edge_owner;
    mesh->weld_edge_owner = build->weld_edge_owner;
    mesh->vertex_owner = build->vertex_owner;
    mesh->submeshes = build->submeshes;
    girih_free(build->corner_points);
    girih_free(build->edge_half_edges);
}

girih_result girih_mesh_create(const girih_mesh_desc *desc, const girih_mesh **mesh,
                               girih_error *error) {
    if (!mesh) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_mesh_create: mesh is null; it must point to where the mesh goes");
    }
    *mesh = NULL;
    if (!desc) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "girih_mesh_create: desc is null");
    }
    girih_result (*const checks[])(const girih_mesh_desc *, girih_error *) = {
        check_pointers, check_indices, check_positions, check_normals_and_attributes};
    for (size_t number = 0; number < sizeof checks / sizeof *checks; ++number) {
        girih_result result = checks[number](desc, error);
        if (result != GIRIH_OK) {
            return result;
        }
    }

    girih_mesh *made = girih_allocate(sizeof *made);
    if (made) {
        *made = (girih_mesh){0};
        girih_mesh_build build = {.desc = desc, .mesh = made};
        bool done = prepare(&build);
        hand_over(&build);
        if (done) {
            *mesh = made;
            return GIRIH_OK;
        }
        girih_mesh_destroy(made);
    }
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                      NAMED "no memory for %" PRIu32 " vertices and %" PRIu32 " triangles",
                      name_of(desc), desc->vertex_count, desc->index_count / 3);
}

void girih_mesh_destroy(const girih_mesh *mesh) {
    if (!mesh) {
        return;
    }
    girih_free(mesh->name);
    girih_free(mesh->positions);
    girih_free(mesh->normals);
    girih_free(mesh->attributes);
    girih_free(mesh->vertex_source);
    girih_free(mesh->vertex_point);
    girih_free(mesh->triangle_vertices);
    girih_free(mesh->triangle_edges);
    girih_free(mesh->triangle_weld_edges);
    girih_free(mesh->triangle_source);
    girih_free(mesh->edge_points);
    girih_free(mesh->seams);
    girih_free(mesh->weld_edge_edge);
    girih_free(mesh->edge_weld_edge);
    girih_free(mesh->edge_uses);
    girih_free(mesh->edge_owner);
    girih_free(mesh->weld_edge_owner);
    girih_free(mesh->vertex_owner);
    girih_free(mesh->submeshes);
    girih_free(mesh);
}
