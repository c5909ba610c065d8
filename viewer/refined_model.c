#include "refined_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "morph.h"
#include "report.h"
#include "skin.h"

// One primitive's arrays, as girih_gltf_write wants them.
struct girih_primitive_arrays {
    float *positions, *normals;
    float **attributes;
    uint32_t *indices;
    uint32_t *joints;
    float *weights;
    girih_morph_arrays *morphs; // [target_count of its mesh]
    girih_gltf_refined_target *targets;
    // Where its vertices lie, while it is made.
    uint32_t *triangles;
    float (*barycentrics)[3];
};

// The triangles of a primitive with the vertices they use, in the order of first use.
typedef struct used_vertices {
    const girih_cpu_output *output;
    uint32_t first_triangle, triangle_count;
    uint32_t *vertices; // [count] output vertices
    uint32_t count;
} used_vertices;

// What all primitives are made from.
typedef struct maker {
    girih_refined_model *to;
    const girih_model *model;
    const girih_places *places;
    girih_surface surface;
    bool has_normals;
    const girih_cpu_output *output;
    uint32_t *number; // output vertex -> vertex of the primitive, UINT32_MAX where it has none yet.
                      // No vertex is shared between primitives, so it serves for all of them
} maker;

static girih_result no_memory(girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory; ask for fewer segments");
}

// --- Vertices ---

// What glTF asks of attributes that interpolation does not keep: tangents of unit length with a
// sign, colours in [0, 1].
static void mend_attribute(const char *name, uint32_t components, float *value) {
    if (strcmp(name, "TANGENT") == 0 && components == 4) {
        float length = sqrtf(value[0] * value[0] + value[1] * value[1] + value[2] * value[2]);
        for (int n = 0; n < 3; n++) {
            value[n] = length > 0.0f ? value[n] / length : (n == 0 ? 1.0f : 0.0f);
        }
        value[3] = value[3] < 0.0f ? -1.0f : 1.0f;
    } else if (strncmp(name, "COLOR_", 6) == 0) {
        for (uint32_t n = 0; n < components; n++) {
            value[n] = value[n] < 0.0f ? 0.0f : value[n] > 1.0f ? 1.0f : value[n];
        }
    }
}

static uint32_t attribute_first(const girih_model *model, const char *name) {
    uint32_t n = 0;
    while (strcmp(model->attributes[n].name, name) != 0) {
        n++;
    }
    return model->attributes[n].first;
}

static float *gather_positions(const used_vertices *used) {
    float *to = malloc((size_t)used->count * 12 + 1);
    for (uint32_t v = 0; v < used->count && to != NULL; v++) {
        memcpy(to + 3 * (size_t)v, used->output->positions + 3 * (size_t)used->vertices[v], 12);
    }
    return to;
}

static float *gather_normals(const used_vertices *used) {
    float *to = malloc((size_t)used->count * 12 + 1);
    size_t stride = 3 + used->output->attribute_floats;
    for (uint32_t v = 0; v < used->count && to != NULL; v++) {
        float *normal = to + 3 * (size_t)v;
        memcpy(normal, used->output->attributes + stride * used->vertices[v], 12);
        // A triangle without area may have none, but glTF wants unit vectors.
        if (normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f) {
            normal[2] = 1.0f;
        }
    }
    return to;
}

static float *gather_attribute(const used_vertices *used, const girih_model *model,
                               const girih_gltf_attribute *attribute) {
    float *to = malloc((size_t)used->count * attribute->components * sizeof(float) + 1);
    size_t stride = 3 + used->output->attribute_floats;
    size_t first = 3 + attribute_first(model, attribute->name);
    for (uint32_t v = 0; v < used->count && to != NULL; v++) {
        float *value = to + (size_t)v * attribute->components;
        memcpy(value, used->output->attributes + stride * used->vertices[v] + first,
               attribute->components * sizeof(float));
        mend_attribute(attribute->name, attribute->components, value);
    }
    return to;
}

static bool find_places(const used_vertices *used, const girih_places *places,
                        girih_primitive_arrays *arrays) {
    arrays->triangles = malloc((size_t)used->count * 4 + 1);
    arrays->barycentrics = malloc((size_t)used->count * 12 + 1);
    if (arrays->triangles == NULL || arrays->barycentrics == NULL) {
        return false;
    }
    const girih_cpu_output *output = used->output;
    size_t stride = 3 + output->attribute_floats;
    for (uint32_t v = 0; v < used->count; v++) {
        size_t vertex = used->vertices[v];
        arrays->triangles[v] = places->vertex_triangles[vertex];
        memcpy(arrays->barycentrics[v],
               output->attributes + stride * vertex + 3 + places->first_float, 12);
    }
    return true;
}

// --- Primitives ---

static bool fill_attributes(const maker *make, const girih_gltf_primitive *source,
                            const used_vertices *used, girih_primitive_arrays *arrays) {
    bool has_normals = source->normals != NULL || make->has_normals;
    arrays->positions = gather_positions(used);
    arrays->normals = has_normals ? gather_normals(used) : NULL;
    arrays->attributes = calloc((size_t)source->attribute_count + 1, sizeof *arrays->attributes);
    bool is_short = arrays->positions == NULL || (has_normals && arrays->normals == NULL) ||
                    arrays->attributes == NULL;
    for (uint32_t n = 0; n < source->attribute_count && !is_short; n++) {
        arrays->attributes[n] = gather_attribute(used, make->model, &source->attributes[n]);
        is_short = arrays->attributes[n] == NULL;
    }
    return !is_short && (make->places == NULL || find_places(used, make->places, arrays));
}

static girih_result fill_primitive(const maker *make, const girih_gltf_primitive *source,
                                   uint32_t material, girih_error *error) {
    const girih_cpu_output *output = make->output;
    girih_primitive_arrays *arrays = &make->to->arrays[material];
    used_vertices used = {.output = output};
    if (material < output->material_count) {
        used.first_triangle = output->material_first[material];
        used.triangle_count = output->material_first[material + 1] - used.first_triangle;
    }
    size_t index_count = 3 * (size_t)used.triangle_count;
    if (index_count > UINT32_MAX) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "%u triangles in one primitive are more than glTF counts; ask for fewer segments",
            used.triangle_count);
    }
    const uint32_t *from = output->indices + 3 * (size_t)used.first_triangle;
    arrays->indices = malloc(index_count * 4 + 1);
    if (arrays->indices == NULL) {
        return no_memory(error);
    }
    for (size_t n = 0; n < index_count; n++) {
        if (make->number[from[n]] == UINT32_MAX) {
            make->number[from[n]] = used.count++;
        }
        arrays->indices[n] = make->number[from[n]];
    }
    used.vertices = malloc((size_t)used.count * 4 + 1);
    if (used.vertices == NULL) {
        return no_memory(error);
    }
    for (size_t n = 0; n < index_count; n++) {
        used.vertices[arrays->indices[n]] = from[n];
    }
    bool done = fill_attributes(make, source, &used, arrays);
    free(used.vertices);
    make->to->refined[material] = (girih_gltf_refined_primitive){
        .vertex_count = used.count,
        .positions = arrays->positions,
        .normals = arrays->normals,
        .attributes = (const float *const *)arrays->attributes,
        .index_count = (uint32_t)index_count,
        .indices = arrays->indices,
    };
    return done ? GIRIH_OK : no_memory(error);
}

// --- Joints and morph targets ---

// number: of the prepared mesh; primitive: of its glTF mesh.
static girih_placed_vertices placed_vertices(const maker *make, uint32_t number,
                                             uint32_t primitive) {
    uint32_t source = make->model->mesh_source[number];
    uint32_t material = make->model->first_material[source] + primitive;
    girih_placed_vertices vertices = {
        .mesh = make->places->meshes[number],
        .count = make->to->refined[material].vertex_count,
        .triangles = make->to->arrays[material].triangles,
        .barycentrics = (const float(*)[3])make->to->arrays[material].barycentrics,
        .sources = make->model->vertex_sources[number],
    };
    for (uint32_t n = 0; n < primitive; n++) {
        vertices.first_source += make->model->contents->meshes[source].primitives[n].vertex_count;
    }
    return vertices;
}

static bool fill_joints(const maker *make, uint32_t number) {
    uint32_t mesh = make->model->mesh_source[number];
    const girih_gltf_mesh *source = &make->model->contents->meshes[mesh];
    for (uint32_t n = 0; n < source->primitive_count; n++) {
        const girih_gltf_primitive *primitive = &source->primitives[n];
        uint32_t material = make->model->first_material[mesh] + n;
        girih_primitive_arrays *arrays = &make->to->arrays[material];
        girih_placed_vertices vertices = placed_vertices(make, number, n);
        size_t size = (size_t)vertices.count * primitive->influence_count * 4 + 1;
        if (primitive->influence_count == 0) {
            continue;
        }
        arrays->joints = malloc(size);
        arrays->weights = malloc(size);
        if (arrays->joints == NULL || arrays->weights == NULL ||
            !girih_skin_vertices(primitive, &vertices, arrays->joints, arrays->weights)) {
            return false;
        }
        make->to->refined[material].joints = arrays->joints;
        make->to->refined[material].weights = arrays->weights;
    }
    return true;
}

static bool fill_target(const maker *make, uint32_t number, uint32_t target) {
    uint32_t mesh = make->model->mesh_source[number];
    const girih_gltf_mesh *source = &make->model->contents->meshes[mesh];
    girih_morphed_mesh morphed;
    bool done = girih_morphed_mesh_make(&morphed, make->places->meshes[number], source,
                                        make->model->vertex_sources[number], target);
    for (uint32_t n = 0; n < source->primitive_count && done; n++) {
        const girih_gltf_primitive *primitive = &source->primitives[n];
        girih_primitive_arrays *arrays = &make->to->arrays[make->model->first_material[mesh] + n];
        girih_placed_vertices vertices = placed_vertices(make, number, n);
        girih_morph_arrays *morph = &arrays->morphs[target];
        done = girih_morph_vertices(&morphed, primitive, target, make->surface,
                                    arrays->normals != NULL, &vertices, morph);
        arrays->targets[target] = (girih_gltf_refined_target){
            .positions = morph->positions,
            .normals = morph->normals,
            .attributes = (const float *const *)morph->attributes,
        };
    }
    girih_morphed_mesh_free(&morphed);
    return done;
}

static bool fill_targets(const maker *make, uint32_t number) {
    uint32_t mesh = make->model->mesh_source[number];
    const girih_gltf_mesh *source = &make->model->contents->meshes[mesh];
    for (uint32_t n = 0; n < source->primitive_count; n++) {
        uint32_t material = make->model->first_material[mesh] + n;
        girih_primitive_arrays *arrays = &make->to->arrays[material];
        arrays->morphs = calloc((size_t)source->target_count + 1, sizeof *arrays->morphs);
        arrays->targets = calloc((size_t)source->target_count + 1, sizeof *arrays->targets);
        if (arrays->morphs == NULL || arrays->targets == NULL) {
            return false;
        }
        make->to->refined[material].targets = arrays->targets;
    }
    for (uint32_t target = 0; target < source->target_count; target++) {
        if (!fill_target(make, number, target)) {
            return false;
        }
    }
    return true;
}

// --- The model ---

static uint32_t count_primitives(const girih_gltf_contents *contents) {
    uint32_t count = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        count += contents->meshes[m].primitive_count;
    }
    return count;
}

static girih_result fill_model(const maker *make, girih_error *error) {
    const girih_model *model = make->model;
    const girih_gltf_contents *contents = model->contents;
    const uint32_t primitives = count_primitives(contents);
    uint32_t material = 0;
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        make->to->meshes[m] = make->to->refined + material;
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++, material++) {
            girih_report_progress_of("gathering", material, primitives);
            girih_result result =
                fill_primitive(make, &contents->meshes[m].primitives[n], material, error);
            if (result != GIRIH_OK) {
                return result;
            }
        }
    }
    for (uint32_t n = 0; n < model->mesh_count && make->places != NULL; n++) {
        if (!fill_joints(make, n) || !fill_targets(make, n)) {
            return no_memory(error);
        }
    }
    return GIRIH_OK;
}

girih_result girih_refined_model_make(girih_refined_model *refined, const girih_model *model,
                                      const girih_places *places, girih_surface surface,
                                      bool has_normals, const girih_cpu_output *output,
                                      girih_error *error) {
    size_t primitives = (size_t)count_primitives(model->contents) + 1;
    size_t vertices = (size_t)output->statistics.output_vertices;
    *refined = (girih_refined_model){
        .model = model,
        .arrays = calloc(primitives, sizeof *refined->arrays),
        .refined = calloc(primitives, sizeof *refined->refined),
        .meshes = calloc((size_t)model->contents->mesh_count + 1, sizeof *refined->meshes),
    };
    maker make = {refined, model, places, surface, has_normals, output, malloc(vertices * 4 + 1)};
    girih_result result = no_memory(error);
    if (refined->arrays != NULL && refined->refined != NULL && refined->meshes != NULL &&
        make.number != NULL) {
        memset(make.number, 0xff, vertices * 4);
        result = fill_model(&make, error);
    }
    free(make.number);
    return result;
}

girih_result girih_refined_model_write(const girih_refined_model *refined, const char *input,
                                       const char *path, girih_error *error) {
    char message[sizeof error->message];
    char name[4096];
    snprintf(name, sizeof name, "%s", input);
    if (!girih_gltf_write(refined->model->file, refined->meshes, path, girih_report_gltf_warning,
                          name, message, sizeof message)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", message);
    }
    return GIRIH_OK;
}

static void free_morphs(const girih_gltf_mesh *mesh, const girih_gltf_primitive *primitive,
                        girih_morph_arrays *morphs) {
    for (uint32_t t = 0; t < mesh->target_count && morphs != NULL; t++) {
        free(morphs[t].positions);
        free(morphs[t].normals);
        for (uint32_t a = 0; a < primitive->targets[t].attribute_count; a++) {
            free(morphs[t].attributes != NULL ? morphs[t].attributes[a] : NULL);
        }
        free(morphs[t].attributes);
    }
    free(morphs);
}

static void free_arrays(const girih_gltf_mesh *mesh, const girih_gltf_primitive *primitive,
                        girih_primitive_arrays *arrays) {
    for (uint32_t a = 0; a < primitive->attribute_count; a++) {
        free(arrays->attributes != NULL ? arrays->attributes[a] : NULL);
    }
    free(arrays->attributes);
    free_morphs(mesh, primitive, arrays->morphs);
    free(arrays->targets);
    free(arrays->positions);
    free(arrays->normals);
    free(arrays->indices);
    free(arrays->joints);
    free(arrays->weights);
    free(arrays->triangles);
    free(arrays->barycentrics);
}

void girih_refined_model_free(girih_refined_model *refined) {
    if (refined->arrays != NULL) {
        const girih_gltf_contents *contents = refined->model->contents;
        size_t at = 0;
        for (uint32_t m = 0; m < contents->mesh_count; m++) {
            const girih_gltf_mesh *mesh = &contents->meshes[m];
            for (uint32_t n = 0; n < mesh->primitive_count; n++) {
                free_arrays(mesh, &mesh->primitives[n], &refined->arrays[at++]);
            }
        }
    }
    free(refined->arrays);
    free(refined->refined);
    free(refined->meshes);
    *refined = (girih_refined_model){0};
}
