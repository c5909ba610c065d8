// The meshes of a scene one after another, their numbers counted through.
#include "pack.h"

#include <inttypes.h>

#include "error.h"
#include "memory.h"

#define FIRST_BINDING GIRIH_BIND_VERTICES
#define END_BINDING (GIRIH_BIND_EDGES + 1)
#define MESH_REVERSED 0x80000000u // girih_mesh.triangle_weld_edges

typedef struct totals {
    uint64_t vertices, triangles, edges, seams, weld_edges;
} totals;

static girih_result check_totals(const totals *sums, uint32_t attribute_floats,
                                 uint32_t vertex_words, girih_error *error) {
    if (sums->triangles > GIRIH_MAX_COUNT || sums->edges > GIRIH_MAX_COUNT ||
        sums->weld_edges > GIRIH_MAX_COUNT) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "scene: %" PRIu64 " triangles with %" PRIu64 " edges and %" PRIu64
                          " weld edges; at most %" PRIu64 " of each can be numbered",
                          sums->triangles, sums->edges, sums->weld_edges, GIRIH_MAX_COUNT);
    }
    const uint64_t words = attribute_floats > vertex_words ? attribute_floats : vertex_words;
    if (sums->vertices > UINT32_MAX / words) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "scene: %" PRIu64 " vertices of %" PRIu64
                          " words are more than 32 bits can number",
                          sums->vertices, words);
    }
    return GIRIH_OK;
}

// Where each mesh begins, and how much there is of everything.
static girih_result place_meshes(girih_scene_table *table, const girih_mesh *const *meshes,
                                 uint32_t vertex_words, totals *sums, girih_error *error) {
    for (uint32_t n = 0; n < table->mesh_count; ++n) {
        const girih_mesh *mesh = meshes[n];
        if (!mesh) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "scene: mesh %" PRIu32 " is NULL", n);
        }
        if (n == 0) {
            table->attribute_floats = mesh->attribute_floats;
        }
        if (mesh->attribute_floats != table->attribute_floats) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "scene: mesh '%s' has %" PRIu32
                              " attribute floats a vertex, the first one has %" PRIu32,
                              mesh->name, mesh->attribute_floats, table->attribute_floats);
        }
        table->meshes[n] = (girih_scene_mesh){
            .first_vertex = (uint32_t)sums->vertices,
            .vertex_count = mesh->vertex_count,
            .first_triangle = (uint32_t)sums->triangles,
            .triangle_count = mesh->triangle_count,
            .first_edge = (uint32_t)sums->edges,
            .edge_count = mesh->edge_count,
            .first_seam = (uint32_t)sums->seams,
            .seam_count = mesh->seam_count,
            .first_weld_edge = (uint32_t)sums->weld_edges,
            .weld_edge_count = mesh->weld_edge_count,
        };
        sums->vertices += mesh->vertex_count;
        sums->triangles += mesh->triangle_count;
        sums->edges += mesh->edge_count;
        sums->seams += mesh->seam_count;
        sums->weld_edges += mesh->weld_edge_count;
        for (uint32_t part = 0; part < mesh->submesh_count; ++part) {
            uint32_t materials = mesh->submeshes[part].material + 1;
            table->has_materials |= materials > 1 || mesh->submeshes[part].two_sided;
            table->material_count =
                materials > table->material_count ? materials : table->material_count;
        }
        girih_result result = check_totals(sums, table->attribute_floats, vertex_words, error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    return GIRIH_OK;
}

static girih_result allocate(girih_arrays *arrays, const totals *sums, uint32_t attribute_floats,
                             uint32_t vertex_words, girih_error *error) {
    const uint64_t counts[END_BINDING] = {
        [GIRIH_BIND_VERTICES] = sums->vertices * vertex_words,
        [GIRIH_BIND_ATTRIBUTES] = sums->vertices * attribute_floats,
        [GIRIH_BIND_TRIANGLE_VERTICES] = sums->triangles * 3,
        [GIRIH_BIND_TRIANGLE_EDGES] = sums->triangles * 3,
        [GIRIH_BIND_TRIANGLE_MATERIALS] = sums->triangles,
        [GIRIH_BIND_EDGE_POINTS] = sums->edges * 2,
        [GIRIH_BIND_SEAMS] = sums->seams * 4,
        [GIRIH_BIND_TRIANGLE_WELD_EDGES] = sums->triangles * 3,
        [GIRIH_BIND_WELD_EDGES] = sums->weld_edges * 2,
        [GIRIH_BIND_POINTS] = sums->vertices * 2,
        [GIRIH_BIND_EDGES] = sums->edges * 2,
    };
    for (uint32_t binding = FIRST_BINDING; binding < END_BINDING; ++binding) {
        girih_result result = girih_allocate_words(arrays, binding, counts[binding], error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    return GIRIH_OK;
}

static void copy_numbers(uint32_t *target, const uint32_t *source, size_t count, uint32_t first) {
    for (size_t n = 0; n < count; ++n) {
        target[n] = source[n] + first;
    }
}

// Pairs of a number and its owner, which is a corner of the mesh.
static void copy_pairs(uint32_t *target, const uint32_t *source, uint32_t first,
                       const uint32_t *owners, uint32_t first_corner, size_t count) {
    for (size_t n = 0; n < count; ++n) {
        target[2 * n] = source[n] + first;
        target[2 * n + 1] = owners[n] + first_corner;
    }
}

static void copy_floats(uint32_t *target, const float *source, size_t count) {
    for (size_t n = 0; n < count; ++n) {
        target[n] = girih_to_word(source[n]);
    }
}

static void copy_vertices(girih_arrays *arrays, const girih_scene_mesh *place,
                          const girih_mesh *mesh) {
    uint32_t *vertices =
        arrays->words[GIRIH_BIND_VERTICES] + (size_t)place->first_vertex * GIRIH_VERTEX_WORDS;
    for (size_t n = 0; n < mesh->vertex_count; ++n) {
        copy_floats(vertices + n * GIRIH_VERTEX_WORDS, mesh->positions + 3 * n, 3);
        copy_floats(vertices + n * GIRIH_VERTEX_WORDS + 3, mesh->normals + 3 * n, 3);
    }
    const size_t floats = mesh->attribute_floats;
    copy_floats(arrays->words[GIRIH_BIND_ATTRIBUTES] + place->first_vertex * floats,
                mesh->attributes, mesh->vertex_count * floats);
    copy_pairs(arrays->words[GIRIH_BIND_POINTS] + (size_t)place->first_vertex * 2,
               mesh->vertex_point, place->first_vertex, mesh->vertex_owner,
               place->first_triangle * 3, mesh->vertex_count);
}

static void copy_triangles(girih_arrays *arrays, const girih_scene_mesh *place,
                           const girih_mesh *mesh) {
    const size_t first_corner = (size_t)place->first_triangle * 3;
    const size_t corners = (size_t)mesh->triangle_count * 3;
    uint32_t *edges = arrays->words[GIRIH_BIND_TRIANGLE_EDGES] + first_corner;
    uint32_t *weld_edges = arrays->words[GIRIH_BIND_TRIANGLE_WELD_EDGES] + first_corner;
    copy_numbers(arrays->words[GIRIH_BIND_TRIANGLE_VERTICES] + first_corner,
                 mesh->triangle_vertices, corners, place->first_vertex);
    for (size_t n = 0; n < corners; ++n) {
        const uint32_t edge = mesh->triangle_edges[n];
        const uint32_t weld_edge = mesh->triangle_weld_edges[n];
        const int reversed = (weld_edge & MESH_REVERSED) != 0;
        edges[n] = (edge + place->first_edge) | (reversed ? GIRIH_EDGE_REVERSED : 0u) |
                   (edge < mesh->seam_count ? GIRIH_EDGE_SEAM : 0u);
        weld_edges[n] = ((weld_edge & ~MESH_REVERSED) + place->first_weld_edge) |
                        (reversed ? GIRIH_WELD_REVERSED : 0u);
    }
    uint32_t *materials = arrays->words[GIRIH_BIND_TRIANGLE_MATERIALS] + place->first_triangle;
    for (uint32_t part = 0; part < mesh->submesh_count; ++part) {
        const girih_submesh *submesh = &mesh->submeshes[part];
        const uint32_t word = submesh->material | (submesh->two_sided ? GIRIH_TWO_SIDED : 0u);
        for (uint32_t n = 0; n < submesh->index_count / 3; ++n) {
            materials[submesh->first_index / 3 + n] = word;
        }
    }
}

static void copy_edges(girih_arrays *arrays, const girih_scene_mesh *place,
                       const girih_mesh *mesh) {
    copy_numbers(arrays->words[GIRIH_BIND_EDGE_POINTS] + (size_t)place->first_edge * 2,
                 mesh->edge_points, (size_t)mesh->edge_count * 2, place->first_vertex);
    copy_numbers(arrays->words[GIRIH_BIND_SEAMS] + (size_t)place->first_seam * 4, mesh->seams,
                 (size_t)mesh->seam_count * 4, place->first_vertex);
    copy_pairs(arrays->words[GIRIH_BIND_WELD_EDGES] + (size_t)place->first_weld_edge * 2,
               mesh->weld_edge_edge, place->first_edge, mesh->weld_edge_owner,
               place->first_triangle * 3, mesh->weld_edge_count);
    copy_pairs(arrays->words[GIRIH_BIND_EDGES] + (size_t)place->first_edge * 2,
               mesh->edge_weld_edge, place->first_weld_edge, mesh->edge_owner,
               place->first_triangle * 3, mesh->edge_count);
}

girih_result girih_pack_scene(girih_arrays *arrays, girih_scene_table *table,
                              const girih_mesh *const *meshes, uint32_t mesh_count, int previous,
                              girih_error *error) {
    *table = (girih_scene_table){.mesh_count = mesh_count, .material_count = 1};
    table->meshes = girih_allocate_array(mesh_count, sizeof *table->meshes);
    if (!table->meshes) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                          "scene: no memory for %" PRIu32 " meshes", mesh_count);
    }
    const uint32_t vertex_words = previous ? 2 * GIRIH_VERTEX_WORDS : GIRIH_VERTEX_WORDS;
    totals sums = {0};
    girih_result result = place_meshes(table, meshes, vertex_words, &sums, error);
    if (result == GIRIH_OK) {
        result = allocate(arrays, &sums, table->attribute_floats, vertex_words, error);
    }
    if (result != GIRIH_OK) {
        girih_arrays_free(arrays, FIRST_BINDING, END_BINDING);
        girih_free(table->meshes);
        table->meshes = NULL;
        return result;
    }
    for (uint32_t n = 0; n < mesh_count; ++n) {
        copy_vertices(arrays, &table->meshes[n], meshes[n]);
        copy_triangles(arrays, &table->meshes[n], meshes[n]);
        copy_edges(arrays, &table->meshes[n], meshes[n]);
    }
    if (previous) {
        const size_t words = (size_t)sums.vertices * GIRIH_VERTEX_WORDS;
        uint32_t *vertices = arrays->words[GIRIH_BIND_VERTICES];
        memcpy(vertices + words, vertices, words * sizeof *vertices);
    }
    table->seam_count = (uint32_t)sums.seams;
    arrays->frame.material_count = table->material_count;
    arrays->frame.attribute_floats = table->attribute_floats;
    arrays->frame.previous_vertices = previous ? (uint32_t)sums.vertices : 0;
    return GIRIH_OK;
}
