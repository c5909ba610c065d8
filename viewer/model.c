#include "model.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "report.h"

static const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

static girih_result no_memory(girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

const girih_gltf_attribute *girih_model_find_attribute(const girih_gltf_primitive *primitive,
                                                       const char *name) {
    for (uint32_t n = 0; n < primitive->attribute_count; n++) {
        if (strcmp(primitive->attributes[n].name, name) == 0) {
            return &primitive->attributes[n];
        }
    }
    return NULL;
}

// The texture coordinates that the base colour texture of a primitive's material reads, and those
// that its normal map reads: where only one of the two is there, both are its. NULL: none.
typedef struct texcoord_pair {
    const girih_gltf_attribute *base, *normal;
} texcoord_pair;

static const girih_gltf_attribute *find_texcoord(const girih_gltf_primitive *primitive,
                                                 const girih_gltf_texture *texture) {
    if (texture->image < 0) {
        return NULL;
    }
    char name[32];
    snprintf(name, sizeof name, "TEXCOORD_%u", texture->texcoord);
    return girih_model_find_attribute(primitive, name);
}

static texcoord_pair find_texcoords(const girih_gltf_contents *contents,
                                    const girih_gltf_primitive *primitive) {
    texcoord_pair pair = {NULL, NULL};
    if (primitive->material >= 0) {
        const girih_gltf_material *material = &contents->materials[primitive->material];
        pair.base = find_texcoord(primitive, &material->base_color_texture);
        pair.normal = find_texcoord(primitive, &material->normal_texture);
    }
    pair.base = pair.base != NULL ? pair.base : pair.normal;
    pair.normal = pair.normal != NULL ? pair.normal : pair.base;
    return pair;
}

// --- The layout of attributes ---

static void lay_out_drawing(girih_model *model, bool displaced) {
    const girih_gltf_contents *contents = model->contents;
    bool has_height = false;
    uint32_t texcoord_floats = 0;
    bool has_color = false;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            const girih_gltf_primitive *primitive = &contents->meshes[m].primitives[n];
            texcoord_pair texcoords = find_texcoords(contents, primitive);
            if (texcoords.base != texcoords.normal) {
                texcoord_floats = 4;
            } else if (texcoords.base != NULL && texcoord_floats == 0) {
                texcoord_floats = 2;
            }
            has_color |= girih_model_find_attribute(primitive, "COLOR_0") != NULL;
            has_height |= displaced && girih_model_find_attribute(primitive, "TEXCOORD_0") != NULL;
        }
    }
    if (texcoord_floats != 0) {
        model->texcoord_float = model->attribute_floats;
        model->texcoord_floats = texcoord_floats;
        model->attribute_floats += texcoord_floats;
    }
    if (has_color) {
        model->color_float = model->attribute_floats;
        model->attribute_floats += 4;
    }
    if (has_height) {
        model->height_float = model->attribute_floats;
        model->attribute_floats += 2;
    }
}

static girih_result lay_out_all(girih_model *model, girih_error *error) {
    const girih_gltf_contents *contents = model->contents;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            const girih_gltf_primitive *primitive = &contents->meshes[m].primitives[n];
            for (uint32_t a = 0; a < primitive->attribute_count; a++) {
                const girih_gltf_attribute *attribute = &primitive->attributes[a];
                uint32_t slot = 0;
                while (slot < model->attribute_count &&
                       strcmp(model->attributes[slot].name, attribute->name) != 0) {
                    slot++;
                }
                if (slot == model->attribute_count) {
                    void *grown =
                        realloc(model->attributes, (slot + 1) * sizeof *model->attributes);
                    if (grown == NULL) {
                        return no_memory(error);
                    }
                    model->attributes = grown;
                    model->attributes[model->attribute_count++] =
                        (girih_model_attribute){attribute->name, 0, 0};
                }
                if (attribute->components > model->attributes[slot].components) {
                    model->attributes[slot].components = attribute->components;
                }
            }
        }
    }
    for (uint32_t n = 0; n < model->attribute_count; n++) {
        model->attributes[n].first = model->attribute_floats;
        model->attribute_floats += model->attributes[n].components;
    }
    return GIRIH_OK;
}

// --- Materials ---

static girih_result number_materials(girih_model *model, girih_error *error) {
    const girih_gltf_contents *contents = model->contents;
    model->first_material = calloc((size_t)contents->mesh_count + 1, sizeof *model->first_material);
    model->materials = malloc(((size_t)contents->material_count + 1) * sizeof *model->materials);
    bool *used = calloc((size_t)contents->material_count + 1, sizeof *used); // [0]: the default
    if (model->first_material == NULL || model->materials == NULL || used == NULL) {
        free(used);
        return no_memory(error);
    }
    uint64_t primitives = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        model->first_material[m] = (uint32_t)primitives;
        primitives += contents->meshes[m].primitive_count;
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            used[contents->meshes[m].primitives[n].material + 1] = true;
        }
    }
    for (uint32_t n = 0; n <= contents->material_count; n++) {
        if (used[n]) {
            model->materials[model->material_count++] = (int32_t)n - 1;
        }
    }
    free(used);
    uint64_t count = model->purpose == GIRIH_MODEL_DRAW ? model->material_count : primitives;
    if (count > GIRIH_MAX_MATERIALS) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE, "%llu %s are more than the %u there can be",
                          (unsigned long long)count,
                          model->purpose == GIRIH_MODEL_DRAW ? "materials" : "primitives",
                          GIRIH_MAX_MATERIALS);
    }
    return GIRIH_OK;
}

static uint32_t find_material(const girih_model *model, int32_t material) {
    uint32_t low = 0;
    uint32_t high = model->material_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (model->materials[middle] <= material) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// --- Meshes ---

// One glTF mesh with its primitives laid one after another.
typedef struct girih_joined {
    float *positions, *normals, *attributes;
    uint32_t *indices;
    girih_submesh *submeshes;
    uint32_t vertex_count, index_count, submesh_count;
} girih_joined;

static void free_joined(girih_joined *joined) {
    free(joined->positions);
    free(joined->normals);
    free(joined->attributes);
    free(joined->indices);
    free(joined->submeshes);
}

static void copy_attribute(float *to, uint32_t stride, uint32_t components,
                           const girih_gltf_attribute *from, uint32_t vertex_count, float missing) {
    for (uint32_t v = 0; v < vertex_count; v++) {
        for (uint32_t c = 0; c < components; c++) {
            bool is_there = from != NULL && c < from->components;
            to[(size_t)v * stride + c] =
                is_there ? from->values[(size_t)v * from->components + c] : missing;
        }
    }
}

static void copy_attributes(const girih_model *model, const girih_gltf_primitive *primitive,
                            float *to) {
    uint32_t stride = model->attribute_floats;
    if (model->texcoord_float != GIRIH_MODEL_NONE) {
        texcoord_pair texcoords = find_texcoords(model->contents, primitive);
        copy_attribute(to + model->texcoord_float, stride, 2, texcoords.base,
                       primitive->vertex_count, 0.0f);
        if (model->texcoord_floats == 4) {
            copy_attribute(to + model->texcoord_float + 2, stride, 2, texcoords.normal,
                           primitive->vertex_count, 0.0f);
        }
    }
    if (model->color_float != GIRIH_MODEL_NONE) {
        copy_attribute(to + model->color_float, stride, 4,
                       girih_model_find_attribute(primitive, "COLOR_0"), primitive->vertex_count,
                       1.0f);
    }
    if (model->height_float != GIRIH_MODEL_NONE) {
        copy_attribute(to + model->height_float, stride, 2,
                       girih_model_find_attribute(primitive, "TEXCOORD_0"), primitive->vertex_count,
                       0.0f);
    }
    for (uint32_t n = 0; n < model->attribute_count; n++) {
        const girih_model_attribute *attribute = &model->attributes[n];
        copy_attribute(to + attribute->first, stride, attribute->components,
                       girih_model_find_attribute(primitive, attribute->name),
                       primitive->vertex_count, 0.0f);
    }
}

// Joins the primitives for which `wanted` holds, all where it is NULL.
static girih_result join(girih_joined *joined, const girih_model *model, uint32_t mesh,
                         const bool *wanted, bool with_normals, girih_error *error) {
    const girih_gltf_mesh *source = &model->contents->meshes[mesh];
    uint64_t vertices = 0;
    uint64_t indices = 0;
    for (uint32_t n = 0; n < source->primitive_count; n++) {
        if (wanted == NULL || wanted[n]) {
            vertices += source->primitives[n].vertex_count;
            indices += source->primitives[n].index_count;
        }
    }
    if (vertices > UINT32_MAX || indices > UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "mesh '%s' has more than 2^32 vertices or indices", source->name);
    }
    uint32_t floats = model->attribute_floats;
    joined->positions = malloc(((size_t)vertices * 3 + 1) * sizeof(float));
    joined->normals = with_normals ? malloc(((size_t)vertices * 3 + 1) * sizeof(float)) : NULL;
    joined->attributes =
        floats != 0 ? malloc(((size_t)vertices * floats + 1) * sizeof(float)) : NULL;
    joined->indices = malloc(((size_t)indices + 1) * sizeof(uint32_t));
    joined->submeshes = malloc(((size_t)source->primitive_count + 1) * sizeof *joined->submeshes);
    if (joined->positions == NULL || (with_normals && joined->normals == NULL) ||
        (floats != 0 && joined->attributes == NULL) || joined->indices == NULL ||
        joined->submeshes == NULL) {
        return no_memory(error);
    }
    for (uint32_t n = 0; n < source->primitive_count; n++) {
        const girih_gltf_primitive *primitive = &source->primitives[n];
        if (wanted != NULL && !wanted[n]) {
            continue;
        }
        size_t first = joined->vertex_count;
        memcpy(joined->positions + 3 * first, primitive->positions,
               (size_t)primitive->vertex_count * 3 * sizeof(float));
        if (with_normals && primitive->normals != NULL) {
            memcpy(joined->normals + 3 * first, primitive->normals,
                   (size_t)primitive->vertex_count * 3 * sizeof(float));
        }
        if (floats != 0) {
            copy_attributes(model, primitive, joined->attributes + floats * first);
        }
        for (uint32_t i = 0; i < primitive->index_count; i++) {
            joined->indices[joined->index_count + i] = primitive->indices[i] + joined->vertex_count;
        }
        bool two_sided = primitive->material >= 0 &&
                         model->contents->materials[primitive->material].double_sided;
        uint32_t material = model->purpose == GIRIH_MODEL_DRAW
                                ? find_material(model, primitive->material)
                                : model->first_material[mesh] + n;
        joined->submeshes[joined->submesh_count++] =
            (girih_submesh){joined->index_count, primitive->index_count, material, two_sided};
        joined->vertex_count += primitive->vertex_count;
        joined->index_count += primitive->index_count;
    }
    return GIRIH_OK;
}

static girih_result create_mesh(const girih_model *model, const girih_joined *joined,
                                const char *name, const girih_surface_options *surface,
                                bool dynamic, const girih_mesh **mesh, girih_error *error) {
    girih_mesh_desc desc = {
        .name = name,
        .vertex_count = joined->vertex_count,
        .positions = joined->positions,
        .normals = joined->normals,
        .attributes = joined->attributes,
        .attribute_floats = model->attribute_floats,
        .indices = joined->indices,
        .index_count = joined->index_count,
        .submeshes = joined->submeshes,
        .submesh_count = joined->submesh_count,
        .missing_normals = GIRIH_NORMALS_SMOOTH,
        .crease_degrees = surface->crease_degrees,
        .dynamic = dynamic,
    };
    if (surface->surface == GIRIH_SURFACE_FLAT) {
        if (model->purpose == GIRIH_MODEL_DRAW) {
            desc.missing_normals = GIRIH_NORMALS_FLAT;
        } else {
            // Not written, so no vertex need be split for them.
            desc.crease_degrees = 180.0f;
        }
    }
    return girih_mesh_create(&desc, mesh, error);
}

// Also where it is refined: morph targets move the two sides of an edge apart, as far as normals
// go.
static bool is_dynamic(const girih_model *model, uint32_t mesh) {
    return model->is_dynamic || (model->purpose == GIRIH_MODEL_REFINE &&
                                 model->contents->meshes[mesh].target_count != 0);
}

// Tells *sources of a mesh: of vertices from `base` on through those of `made`, the mesh of the
// primitives that lack normals. made NULL: no vertex is from there.
static girih_result find_sources(const girih_gltf_mesh *source, const bool *lacks,
                                 const girih_mesh *made, uint32_t base, const girih_mesh *mesh,
                                 uint32_t **sources, girih_error *error) {
    uint32_t *lacking = malloc((size_t)base * 4 + 1); // vertex of those primitives: of all
    *sources = malloc((size_t)mesh->vertex_count * 4 + 1);
    if (*sources == NULL || lacking == NULL) {
        free(lacking);
        return no_memory(error);
    }
    uint32_t first = 0;
    uint32_t count = 0;
    for (uint32_t n = 0; n < source->primitive_count; n++) {
        for (uint32_t v = 0; v < source->primitives[n].vertex_count && lacks[n]; v++) {
            lacking[count++] = first + v;
        }
        first += source->primitives[n].vertex_count;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t from = mesh->vertex_source[v];
        (*sources)[v] = from < base ? from : lacking[made->vertex_source[from - base]];
    }
    free(lacking);
    return GIRIH_OK;
}

// A mesh with normals in some primitives and none in others: those without are prepared by
// themselves first, and what comes out, vertices split at creases included, goes in among the
// others. *sources is the caller's to free.
static girih_result create_mixed_mesh(const girih_model *model, uint32_t number, const bool *lacks,
                                      const girih_surface_options *surface, const girih_mesh **mesh,
                                      uint32_t **sources, girih_error *error) {
    const girih_gltf_mesh *source = &model->contents->meshes[number];
    girih_joined without = {0};
    girih_joined all = {0};
    const girih_mesh *made = NULL;
    girih_result result = join(&without, model, number, lacks, false, error);
    if (result == GIRIH_OK) {
        result = create_mesh(model, &without, source->name, surface, false, &made, error);
    }
    if (result == GIRIH_OK) {
        result = join(&all, model, number, NULL, true, error);
    }
    if (result == GIRIH_OK) {
        uint64_t vertices = (uint64_t)all.vertex_count + made->vertex_count;
        float *positions = realloc(all.positions, (size_t)vertices * 3 * sizeof(float) + 1);
        all.positions = positions != NULL ? positions : all.positions;
        float *normals = realloc(all.normals, (size_t)vertices * 3 * sizeof(float) + 1);
        all.normals = normals != NULL ? normals : all.normals;
        bool is_short = positions == NULL || normals == NULL;
        if (model->attribute_floats != 0) {
            float *attributes =
                realloc(all.attributes, (size_t)vertices * model->attribute_floats * sizeof(float));
            all.attributes = attributes != NULL ? attributes : all.attributes;
            is_short |= attributes == NULL;
        }
        if (is_short) {
            result = no_memory(error);
        } else if (vertices > UINT32_MAX) {
            result = girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                                "mesh '%s' has more than 2^32 vertices", source->name);
        }
    }
    if (result == GIRIH_OK) {
        uint32_t base = all.vertex_count;
        memcpy(all.positions + 3 * (size_t)base, made->positions,
               (size_t)made->vertex_count * 3 * sizeof(float));
        memcpy(all.normals + 3 * (size_t)base, made->normals,
               (size_t)made->vertex_count * 3 * sizeof(float));
        if (model->attribute_floats != 0) {
            memcpy(all.attributes + model->attribute_floats * (size_t)base, made->attributes,
                   (size_t)made->vertex_count * model->attribute_floats * sizeof(float));
        }
        uint32_t lacking = 0;
        uint32_t next_vertex = 0;
        for (uint32_t n = 0; n < source->primitive_count; n++) {
            uint32_t vertices = source->primitives[n].vertex_count;
            if (lacks[n]) {
                const girih_submesh *range = &made->submeshes[lacking++];
                girih_submesh *to = &all.submeshes[n];
                for (uint32_t i = 0; i < range->index_count; i++) {
                    all.indices[to->first_index + i] =
                        base + made->triangle_vertices[range->first_index + i];
                }
                to->index_count = range->index_count;
                // Nothing refers to them any more; the mesh drops them, but they must be readable.
                memset(all.normals + 3 * (size_t)next_vertex, 0,
                       (size_t)vertices * 3 * sizeof(float));
            }
            next_vertex += vertices;
        }
        all.vertex_count += made->vertex_count;
        result =
            create_mesh(model, &all, source->name, surface, is_dynamic(model, number), mesh, error);
        if (result == GIRIH_OK) {
            result = find_sources(source, lacks, made, base, *mesh, sources, error);
        }
    }
    girih_mesh_destroy(made);
    free_joined(&without);
    free_joined(&all);
    return result;
}

static girih_result prepare_mesh(const girih_model *model, uint32_t number,
                                 const girih_surface_options *surface, const girih_mesh **mesh,
                                 uint32_t **sources, girih_error *error) {
    const girih_gltf_mesh *source = &model->contents->meshes[number];
    bool *lacks = calloc((size_t)source->primitive_count + 1, sizeof *lacks);
    if (lacks == NULL) {
        return no_memory(error);
    }
    uint32_t lacking = 0;
    for (uint32_t n = 0; n < source->primitive_count; n++) {
        lacks[n] = source->primitives[n].normals == NULL;
        lacking += lacks[n];
    }
    girih_result result;
    if (lacking != 0 && lacking != source->primitive_count) {
        result = create_mixed_mesh(model, number, lacks, surface, mesh, sources, error);
    } else {
        girih_joined joined = {0};
        result = join(&joined, model, number, NULL, lacking == 0, error);
        if (result == GIRIH_OK) {
            result = create_mesh(model, &joined, source->name, surface, is_dynamic(model, number),
                                 mesh, error);
        }
        if (result == GIRIH_OK) {
            result = find_sources(source, lacks, NULL, joined.vertex_count, *mesh, sources, error);
        }
        free_joined(&joined);
    }
    free(lacks);
    return result;
}

static girih_result prepare_meshes(girih_model *model, const girih_surface_options *surface,
                                   girih_error *error) {
    const girih_gltf_contents *contents = model->contents;
    size_t room = (size_t)contents->mesh_count + 1;
    model->meshes = calloc(room, sizeof *model->meshes);
    model->mesh_source = calloc(room, sizeof *model->mesh_source);
    model->mesh_number = calloc(room, sizeof *model->mesh_number);
    model->vertex_sources = calloc(room, sizeof *model->vertex_sources);
    model->moving = model->is_dynamic ? calloc(room, sizeof *model->moving) : NULL;
    if (model->meshes == NULL || model->mesh_source == NULL || model->mesh_number == NULL ||
        model->vertex_sources == NULL || (model->is_dynamic && model->moving == NULL)) {
        return no_memory(error);
    }
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        model->mesh_number[m] = GIRIH_MODEL_NONE;
        uint64_t indices = 0;
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            indices += contents->meshes[m].primitives[n].index_count;
        }
        if (indices == 0) {
            continue;
        }
        uint32_t number = model->mesh_count;
        girih_result result = prepare_mesh(model, m, surface, &model->meshes[number],
                                           &model->vertex_sources[number], error);
        model->mesh_source[number] = m;
        model->mesh_number[m] = number;
        model->mesh_count++;
        if (result == GIRIH_OK && model->is_dynamic) {
            result = girih_model_begin_moving(model, number, surface, error);
        }
        if (result != GIRIH_OK) {
            return result;
        }
    }
    if (model->mesh_count == 0 && model->purpose != GIRIH_MODEL_TOPOLOGY) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "no triangles");
    }
    return GIRIH_OK;
}

girih_result girih_model_load(girih_model *model, const char *path, girih_model_purpose purpose,
                              const girih_surface_options *surface, const girih_pose_options *pose,
                              girih_error *error) {
    *model = (girih_model){.purpose = purpose,
                           .texcoord_float = GIRIH_MODEL_NONE,
                           .color_float = GIRIH_MODEL_NONE,
                           .height_float = GIRIH_MODEL_NONE};
    char message[sizeof error->message];
    char name[4096];
    snprintf(name, sizeof name, "%s", path);
    girih_report_progress("loading");
    model->file = girih_gltf_load(path, girih_report_gltf_warning, name, message, sizeof message);
    if (model->file == NULL) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", message);
    }
    model->contents = girih_gltf_get(model->file);
    girih_report_progress("preparing meshes");
    girih_result result = GIRIH_OK;
    if (purpose == GIRIH_MODEL_DRAW) {
        result = girih_model_pose(model, pose, error);
        lay_out_drawing(model, surface->height_map != NULL);
    } else if (purpose == GIRIH_MODEL_REFINE) {
        result = lay_out_all(model, error);
    }
    if (result == GIRIH_OK) {
        result = number_materials(model, error);
    }
    if (result == GIRIH_OK) {
        result = prepare_meshes(model, surface, error);
    }
    girih_report_progress(NULL);
    if (result != GIRIH_OK) {
        girih_model_free(model);
    }
    return result;
}

uint32_t girih_model_height_float(const girih_model *model) {
    for (uint32_t n = 0; n < model->attribute_count; n++) {
        if (strcmp(model->attributes[n].name, "TEXCOORD_0") == 0) {
            return model->attributes[n].first;
        }
    }
    return model->height_float;
}

void girih_model_free_meshes(girih_model *model) {
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        if (girih_model_is_deformed(model, n)) {
            girih_mesh_destroy(model->moving[n].prepared);
            girih_deformer_free(&model->moving[n].deformer);
            free(model->moving[n].vertices);
            model->moving[n] = (girih_moving_mesh){0};
        } else {
            girih_mesh_destroy(model->meshes[n]);
        }
        model->meshes[n] = NULL;
    }
}

void girih_model_free(girih_model *model) {
    if (model->meshes != NULL) {
        girih_model_free_meshes(model);
    }
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        free(model->vertex_sources[n]);
    }
    free(model->vertex_sources);
    free(model->meshes);
    free(model->moving);
    free(model->mesh_source);
    free(model->mesh_number);
    free(model->attributes);
    free(model->materials);
    free(model->first_material);
    if (model->pose != NULL) {
        girih_pose_free(model->pose);
        free(model->pose);
    }
    girih_gltf_destroy(model->file);
    *model = (girih_model){0};
}

girih_result girih_model_instances(const girih_model *model, bool placed,
                                   girih_instance **instances, uint32_t *instance_count,
                                   girih_error *error) {
    uint32_t room = placed ? model->contents->placement_count : model->mesh_count;
    *instances = malloc(((size_t)room + 1) * sizeof **instances);
    if (*instances == NULL) {
        return no_memory(error);
    }
    uint32_t count = 0;
    bool collapsed = false;
    for (uint32_t n = 0; n < room; n++) {
        uint32_t mesh = placed ? model->mesh_number[model->contents->placements[n].mesh] : n;
        if (mesh == GIRIH_MODEL_NONE || model->meshes[mesh]->triangle_count == 0) {
            collapsed = collapsed || mesh != GIRIH_MODEL_NONE;
            continue;
        }
        girih_instance *instance = &(*instances)[count++];
        instance->mesh = mesh;
        memcpy(instance->transform, placed ? model->contents->placements[n].transform : identity,
               sizeof instance->transform);
    }
    if (count == 0 && !collapsed) {
        free(*instances);
        *instances = NULL;
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "no triangles%s",
                          placed ? " in the nodes of the scene" : "");
    }
    *instance_count = count;
    return GIRIH_OK;
}
