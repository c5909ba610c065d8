#include "places.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "weld.h"

static girih_result no_memory(girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory; ask for fewer segments");
}

bool girih_places_are_needed(const girih_gltf_contents *contents) {
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        const girih_gltf_mesh *mesh = &contents->meshes[m];
        for (uint32_t n = 0; n < mesh->primitive_count; n++) {
            if (mesh->target_count != 0 || mesh->primitives[n].influence_count != 0) {
                return true;
            }
        }
    }
    return false;
}

// --- Triangles that share no vertices ---

static girih_result part_triangles(const girih_mesh *mesh, const girih_mesh **parted,
                                   girih_error *error) {
    size_t corners = 3 * (size_t)mesh->triangle_count;
    size_t floats = mesh->attribute_floats;
    float *positions = malloc(corners * 12 + 1);
    float *normals = malloc(corners * 12 + 1);
    float *attributes = malloc(corners * (floats + 3) * 4 + 1);
    uint32_t *indices = malloc(corners * 4 + 1);
    girih_result result = no_memory(error);
    if (positions != NULL && normals != NULL && attributes != NULL && indices != NULL) {
        for (size_t n = 0; n < corners; n++) {
            size_t vertex = mesh->triangle_vertices[n];
            memcpy(positions + 3 * n, mesh->positions + 3 * vertex, 12);
            memcpy(normals + 3 * n, mesh->normals + 3 * vertex, 12);
            float *to = attributes + (floats + 3) * n;
            if (floats != 0) {
                memcpy(to, mesh->attributes + floats * vertex, floats * 4);
            }
            for (size_t c = 0; c < 3; c++) {
                to[floats + c] = c == n % 3 ? 1.0f : 0.0f;
            }
            indices[n] = (uint32_t)n;
        }
        girih_mesh_desc desc = {
            .name = mesh->name,
            .vertex_count = (uint32_t)corners,
            .positions = positions,
            .normals = normals,
            .attributes = attributes,
            .attribute_floats = (uint32_t)floats + 3,
            .indices = indices,
            .index_count = (uint32_t)corners,
            .submeshes = mesh->submeshes,
            .submesh_count = mesh->submesh_count,
        };
        result = girih_mesh_create(&desc, parted, error);
    }
    free(positions);
    free(normals);
    free(attributes);
    free(indices);
    return result;
}

girih_result girih_places_prepare(girih_places *places, girih_model *model, girih_error *error) {
    places->first_float = model->attribute_floats;
    places->meshes = calloc((size_t)model->mesh_count + 1, sizeof *places->meshes);
    if (places->meshes == NULL) {
        return no_memory(error);
    }
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        const girih_mesh *parted;
        girih_result result = part_triangles(model->meshes[n], &parted, error);
        if (result != GIRIH_OK) {
            return result;
        }
        places->meshes[n] = model->meshes[n];
        model->meshes[n] = parted;
        places->mesh_count = n + 1;
    }
    model->attribute_floats += 3;
    return GIRIH_OK;
}

// --- Vertices of an output ---

// Which mesh a material's triangles are of, for every material; NULL: out of memory.
static const girih_mesh **find_material_meshes(const girih_places *places,
                                               const girih_model *model) {
    const girih_gltf_contents *contents = model->contents;
    size_t count = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        count += contents->meshes[m].primitive_count;
    }
    const girih_mesh **meshes = calloc(count + 1, sizeof *meshes);
    for (uint32_t n = 0; n < places->mesh_count && meshes != NULL; n++) {
        uint32_t source = model->mesh_source[n];
        for (uint32_t p = 0; p < contents->meshes[source].primitive_count; p++) {
            meshes[model->first_material[source] + p] = places->meshes[n];
        }
    }
    return meshes;
}

// Equal for vertices that become one; the last word tells the kinds of places apart.
static void make_key(const girih_mesh *mesh, uint32_t triangle, const float b[3],
                     uint32_t key[GIRIH_WELD_KEY_WORDS]) {
    const uint32_t *vertices = mesh->triangle_vertices + 3 * (size_t)triangle;
    uint32_t corners[3];
    uint32_t count = 0;
    for (uint32_t c = 0; c < 3; c++) {
        if (b[c] != 0.0f) {
            corners[count++] = c;
        }
    }
    memset(key, 0, GIRIH_WELD_KEY_WORDS * sizeof *key);
    key[4] = count;
    if (count == 1) {
        key[0] = vertices[corners[0]];
    } else if (count == 2) {
        bool swapped = vertices[corners[0]] > vertices[corners[1]];
        uint32_t low = corners[swapped ? 1 : 0];
        uint32_t high = corners[swapped ? 0 : 1];
        key[0] = vertices[low];
        key[1] = vertices[high];
        memcpy(&key[2], &b[low], 4);
        memcpy(&key[3], &b[high], 4);
    } else {
        key[0] = triangle;
        memcpy(&key[1], b, 12);
    }
}

static girih_result weld(girih_places *places, const girih_mesh *const *material_meshes,
                         girih_cpu_output *output, girih_error *error) {
    size_t count = (size_t)output->statistics.output_vertices;
    size_t stride = 3 + (size_t)output->attribute_floats;
    uint32_t(*keys)[GIRIH_WELD_KEY_WORDS] = malloc(count * sizeof *keys + 1);
    if (keys == NULL) {
        return no_memory(error);
    }
    for (uint32_t material = 0; material < output->material_count; material++) {
        const uint32_t *end = output->indices + 3 * (size_t)output->material_first[material + 1];
        for (const uint32_t *vertex =
                 output->indices + 3 * (size_t)output->material_first[material];
             vertex < end; vertex++) {
            make_key(material_meshes[material], places->vertex_triangles[*vertex],
                     output->attributes + stride * *vertex + 3 + places->first_float,
                     keys[*vertex]);
        }
    }
    const char *reason =
        girih_weld(output, (const uint32_t(*)[GIRIH_WELD_KEY_WORDS])keys, places->vertex_triangles);
    free(keys);
    return reason == NULL ? GIRIH_OK : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "%s", reason);
}

girih_result girih_places_find(girih_places *places, const girih_model *model,
                               girih_cpu_output *output, bool welds, girih_error *error) {
    places->vertex_triangles = malloc((size_t)output->statistics.output_vertices * 4 + 1);
    if (places->vertex_triangles == NULL) {
        return no_memory(error);
    }
    size_t triangles = (size_t)output->statistics.output_triangles;
    for (size_t n = 0; n < 3 * triangles; n++) {
        places->vertex_triangles[output->indices[n]] = output->sources[n / 3 * 2 + 1];
    }
    if (!welds) {
        return GIRIH_OK;
    }
    const girih_mesh **material_meshes = find_material_meshes(places, model);
    if (material_meshes == NULL) {
        return no_memory(error);
    }
    girih_result result = weld(places, material_meshes, output, error);
    free(material_meshes);
    return result;
}

void girih_placed_corners(const girih_placed_vertices *vertices, uint32_t vertex,
                          uint32_t corners[3]) {
    const uint32_t *triangle =
        vertices->mesh->triangle_vertices + 3 * (size_t)vertices->triangles[vertex];
    for (int c = 0; c < 3; c++) {
        corners[c] = vertices->sources[triangle[c]] - vertices->first_source;
    }
}

void girih_places_free(girih_places *places) {
    for (uint32_t n = 0; n < places->mesh_count; n++) {
        girih_mesh_destroy(places->meshes[n]);
    }
    free(places->meshes);
    free(places->vertex_triangles);
    *places = (girih_places){0};
}
