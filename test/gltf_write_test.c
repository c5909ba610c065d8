// The glTF writer: what is written reads back bit for bit, with everything beside the geometry
// kept.
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "../viewer/png.h"
#include "gltf_files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// The values of attributes, as girih_gltf_write wants them.
static const float **attribute_values(const girih_gltf_attribute *attributes, uint32_t count) {
    const float **values = calloc(count + 1u, sizeof *values);
    assert_non_null(values);
    for (uint32_t a = 0; a < count; a++) {
        values[a] = attributes[a].values;
    }
    return values;
}

static girih_gltf_refined_target *own_targets(const girih_gltf_primitive *from, uint32_t count) {
    girih_gltf_refined_target *targets = calloc(count + 1u, sizeof *targets);
    assert_non_null(targets);
    for (uint32_t t = 0; t < count; t++) {
        const girih_gltf_morph_target *target = &from->targets[t];
        targets[t] = (girih_gltf_refined_target){
            target->positions, target->normals,
            attribute_values(target->attributes, target->attribute_count)};
    }
    return targets;
}

static void free_targets(const girih_gltf_refined_target *targets, uint32_t count) {
    for (uint32_t t = 0; t < count; t++) {
        free((void *)(uintptr_t)targets[t].attributes);
    }
    free((void *)(uintptr_t)targets);
}

// The model written with its own geometry and loaded again.
static girih_gltf_model *written_and_reloaded(const girih_gltf_model *model, const char *path) {
    const girih_gltf_contents *contents = girih_gltf_get(model);
    girih_gltf_refined_primitive **refined = calloc(contents->mesh_count + 1, sizeof *refined);
    assert_non_null(refined);
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        const girih_gltf_mesh *mesh = &contents->meshes[m];
        refined[m] = calloc(mesh->primitive_count + 1u, sizeof **refined);
        assert_non_null(refined[m]);
        for (uint32_t p = 0; p < mesh->primitive_count; p++) {
            const girih_gltf_primitive *from = &mesh->primitives[p];
            refined[m][p] = (girih_gltf_refined_primitive){
                .vertex_count = from->vertex_count,
                .positions = from->positions,
                .normals = from->normals,
                .attributes = attribute_values(from->attributes, from->attribute_count),
                .index_count = from->index_count,
                .indices = from->indices,
                .joints = from->joints,
                .weights = from->weights,
                .targets = own_targets(from, mesh->target_count),
            };
        }
    }
    gltf_warnings[0] = '\0';
    const bool written =
        girih_gltf_write(model, (const girih_gltf_refined_primitive *const *)refined, path,
                         gltf_warn, NULL, gltf_message, sizeof gltf_message);
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t p = 0; p < contents->meshes[m].primitive_count; p++) {
            free((void *)(uintptr_t)refined[m][p].attributes);
            free_targets(refined[m][p].targets, contents->meshes[m].target_count);
        }
        free(refined[m]);
    }
    free(refined);
    girih_gltf_model *reloaded =
        written ? girih_gltf_load(path, NULL, NULL, gltf_message, sizeof gltf_message) : NULL;
    if (reloaded == NULL) {
        print_error("%s\n", gltf_message);
    }
    assert_non_null(reloaded);
    return reloaded;
}

static void assert_same_floats(const float *a, const float *b, size_t count) {
    assert_true(a == NULL || b != NULL);
    if (a != NULL) {
        assert_memory_equal(a, b, count * sizeof *a);
        return;
    }
    for (size_t n = 0; n < count && b != NULL; n++) {
        assert_true(b[n] == 0.0f); // of a target that would be empty
    }
}

static void assert_same_attributes(const girih_gltf_attribute *a, const girih_gltf_attribute *b,
                                   uint32_t count, size_t vertex_count) {
    for (uint32_t n = 0; n < count; n++) {
        assert_string_equal(a[n].name, b[n].name);
        assert_int_equal(a[n].components, b[n].components);
        if (strcmp(a[n].name, "TANGENT") != 0) { // made unit length
            assert_same_floats(a[n].values, b[n].values, vertex_count * a[n].components);
        }
    }
}

static void assert_same_primitive(const girih_gltf_primitive *from, const girih_gltf_primitive *to,
                                  uint32_t target_count) {
    const size_t count = from->vertex_count;
    assert_int_equal(from->material, to->material);
    assert_int_equal(count, to->vertex_count);
    assert_int_equal(from->index_count, to->index_count);
    assert_memory_equal(from->positions, to->positions, count * 12);
    assert_memory_equal(from->indices, to->indices, (size_t)from->index_count * 4);
    assert_int_equal(from->normals == NULL, to->normals == NULL);
    assert_int_equal(from->attribute_count, to->attribute_count);
    assert_same_attributes(from->attributes, to->attributes, from->attribute_count, count);
    assert_int_equal(from->influence_count, to->influence_count);
    if (from->influence_count > 0) {
        const size_t size = count * from->influence_count * 4;
        assert_memory_equal(from->joints, to->joints, size);
        assert_memory_equal(from->weights, to->weights, size);
    }
    for (uint32_t t = 0; t < target_count; t++) {
        const girih_gltf_morph_target *a = &from->targets[t], *b = &to->targets[t];
        assert_same_floats(a->positions, b->positions, count * 3);
        assert_same_floats(a->normals, b->normals, count * 3);
        assert_int_equal(a->attribute_count, b->attribute_count);
        assert_same_attributes(a->attributes, b->attributes, a->attribute_count, count);
    }
}

// All but what is not refined, which stays as it is.
static void assert_same_geometry(const girih_gltf_model *before, const girih_gltf_model *after) {
    const girih_gltf_contents *a = girih_gltf_get(before), *b = girih_gltf_get(after);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_int_equal(a->material_count, b->material_count);
    assert_int_equal(a->image_count, b->image_count);
    assert_int_equal(a->camera_count, b->camera_count);
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->placement_count, b->placement_count);
    assert_int_equal(a->skipped_primitives, b->skipped_primitives);
    assert_int_equal(a->mesh_count, b->mesh_count);
    for (uint32_t m = 0; m < a->mesh_count; m++) {
        const girih_gltf_mesh *from = &a->meshes[m], *to = &b->meshes[m];
        assert_string_equal(from->name, to->name);
        assert_int_equal(from->primitive_count, to->primitive_count);
        assert_int_equal(from->target_count, to->target_count);
        assert_same_floats(from->weights, to->weights, from->target_count);
        for (uint32_t p = 0; p < from->primitive_count; p++) {
            assert_same_primitive(&from->primitives[p], &to->primitives[p], from->target_count);
        }
    }
    assert_int_equal(a->skin_count, b->skin_count);
    for (uint32_t s = 0; s < a->skin_count; s++) {
        const girih_gltf_skin *from = &a->skins[s], *to = &b->skins[s];
        assert_int_equal(from->joint_count, to->joint_count);
        assert_memory_equal(from->joints, to->joints, (size_t)from->joint_count * 4);
        assert_memory_equal(from->inverse_bind_matrices, to->inverse_bind_matrices,
                            (size_t)from->joint_count * 48);
    }
    assert_int_equal(a->animation_count, b->animation_count);
    for (uint32_t n = 0; n < a->animation_count; n++) {
        const girih_gltf_animation *from = &a->animations[n], *to = &b->animations[n];
        assert_int_equal(from->channel_count, to->channel_count);
        assert_int_equal(from->sampler_count, to->sampler_count);
        for (uint32_t s = 0; s < from->sampler_count; s++) {
            const girih_gltf_sampler *x = &from->samplers[s], *y = &to->samplers[s];
            assert_int_equal(x->key_count, y->key_count);
            const size_t values = (size_t)x->key_count * x->components *
                                  (x->interpolation == GIRIH_GLTF_CUBIC_SPLINE ? 3u : 1u);
            assert_same_floats(x->times, y->times, x->key_count);
            assert_same_floats(x->values, y->values, values);
        }
        for (uint32_t c = 0; c < from->channel_count; c++) {
            assert_int_equal(from->channels[c].node, to->channels[c].node);
            assert_int_equal(from->channels[c].path, to->channels[c].path);
            assert_int_equal(from->channels[c].sampler, to->channels[c].sampler);
        }
    }
}

static void materials_images_and_writing(void **state) {
    (void)state;
    static const uint8_t picture[4 * 3 * 2] = {255, 0, 0, 255, 0,   255, 0, 128, 0,  0,  255, 0,
                                               1,   2, 3, 4,   250, 251, 9, 8,   77, 66, 55,  44};
    assert_true(girih_png_write(folder_path("a picture.png"), 3, 2, picture, gltf_message,
                                sizeof gltf_message));
    size_t png_size;
    unsigned char *png = folder_read(folder_path("a picture.png"), &png_size);
    char json[4096];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\",\"copyright\":\"nobody\"}," ZIGZAG_VIEWS
             "\"accessors\":[" ZIGZAG_POSITIONS "],"
             "\"extensionsUsed\":[\"KHR_materials_unlit\",\"KHR_texture_transform\",\"KHR_mesh_"
             "quantization\","
             "\"EXT_made_up\"],\"extensionsRequired\":[\"KHR_mesh_quantization\"],"
             "\"images\":[{\"uri\":\"a%%20picture.png\"},{\"uri\":\"none.png\"}],\"samplers\":[{"
             "\"wrapS\":33071,"
             "\"wrapT\":33648,\"magFilter\":9728}],\"textures\":[{\"source\":0,\"sampler\":0},{"
             "\"source\":1}],"
             "\"materials\":[{\"name\":\"tiles\",\"extras\":{\"keep\":[1,\"me\"]},\"extensions\":"
             "{\"KHR_materials_unlit\":{},\"KHR_materials_ior\":{\"ior\":1.25}},\"alphaMode\":"
             "\"MASK\","
             "\"normalTexture\":{\"index\":0,\"texCoord\":1,\"scale\":0.5,\"extensions\":"
             "{\"KHR_texture_transform\":{\"offset\":[0.25,0],\"scale\":[4,1]}}},"
             "\"alphaCutoff\":0.25,\"doubleSided\":true,\"emissiveFactor\":[0.5,0,1],"
             "\"pbrMetallicRoughness\":"
             "{\"baseColorFactor\":[0.5,0.25,1,0.75],\"metallicFactor\":0.125,\"roughnessFactor\":"
             "0.5,"
             "\"baseColorTexture\":{\"index\":0,\"texCoord\":1,\"extensions\":{\"KHR_texture_"
             "transform\":"
             "{\"offset\":[0.5,1],\"scale\":[2,0.25],\"rotation\":0.5,\"texCoord\":2}}}}},"
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}}}],"
             "\"meshes\":[{\"name\":\"dots\",\"primitives\":[{\"attributes\":{\"POSITION\":0},"
             "\"mode\":0}]},"
             "{\"name\":\"sail\",\"weights\":[1],\"primitives\":[{\"attributes\":{\"POSITION\":0},"
             "\"mode\":1},"
             "{\"attributes\":{\"POSITION\":0,\"_HEIGHT\":0},\"mode\":5,\"material\":0,"
             "\"targets\":[{\"POSITION\":0}]}]}],\"skins\":[{\"joints\":[0]}],"
             "\"animations\":[{\"channels\":[],\"samplers\":[]}],\"nodes\":[{\"mesh\":0,\"name\":"
             "\"first\"},"
             "{\"mesh\":1,\"skin\":0,\"weights\":[1]}],\"scenes\":[{\"nodes\":[0,1]}]}");
    gltf_write_glb("rich.glb", json, &zigzag_data, sizeof zigzag_data);
    girih_gltf_model *model = gltf_load("rich.glb");
    if (model == NULL) {
        print_error("%s\n", gltf_message);
    }
    assert_non_null(model);
    assert_non_null(strstr(gltf_warnings, "mesh 0 'dots', primitive 0: points"));
    assert_non_null(strstr(gltf_warnings, "mesh 1 'sail', primitive 0: lines"));
    assert_non_null(strstr(gltf_warnings, "image 1: 'none.png': cannot open"));
    assert_non_null(strstr(gltf_warnings, "EXT_made_up"));
    const girih_gltf_contents *contents = girih_gltf_get(model);
    assert_int_equal(contents->skipped_primitives, 2);
    assert_int_equal(contents->morph_target_count, 1);
    assert_int_equal(contents->skin_count, 1);
    assert_int_equal(contents->animation_count, 1);
    assert_int_equal(contents->image_count, 1);
    assert_int_equal(contents->images[0].width, 3);
    assert_int_equal(contents->images[0].height, 2);
    assert_memory_equal(contents->images[0].pixels, picture, sizeof picture);
    const girih_gltf_material *material = &contents->materials[0];
    assert_string_equal(material->name, "tiles");
    assert_true(material->base_color[3] == 0.75f && material->metallic == 0.125f &&
                material->roughness == 0.5f);
    assert_true(material->emissive[0] == 0.5f && material->alpha_mode == GIRIH_GLTF_ALPHA_MASK);
    assert_true(material->alpha_cutoff == 0.25f && material->double_sided && material->unlit);
    const girih_gltf_texture *texture = &material->base_color_texture;
    assert_true(texture->nearest && texture->wrap_s == GIRIH_GLTF_WRAP_CLAMP &&
                texture->wrap_t == GIRIH_GLTF_WRAP_MIRROR);
    assert_true(texture->image == 0 && texture->texcoord == 2);
    assert_true(texture->offset[1] == 1 && texture->scale[1] == 0.25f);
    assert_true(texture->rotation == 0.5f);
    assert_int_equal(contents->materials[1].base_color_texture.image, -1);
    texture = &material->normal_texture;
    assert_true(texture->image == 0 && texture->texcoord == 1 && material->normal_scale == 0.5f);
    assert_true(texture->offset[0] == 0.25f && texture->scale[0] == 4 && texture->scale[1] == 1);
    assert_int_equal(contents->materials[1].normal_texture.image, -1);
    assert_true(contents->materials[1].normal_scale == 1);

    girih_gltf_model *after = written_and_reloaded(model, folder_path("out.glb"));
    assert_same_geometry(model, after);
    assert_memory_equal(girih_gltf_get(after)->images[0].pixels, picture, sizeof picture);
    assert_string_equal(gltf_warnings, "");
    girih_gltf_destroy(after);
    girih_gltf_destroy(model);

    size_t size;
    unsigned char *out = folder_read(folder_path("out.glb"), &size);
    const size_t json_size = out[12] | (size_t)out[13] << 8;
    const unsigned char *binary = out + 28 + json_size;
    out[20 + json_size - 1] = 0;
    const char *text = (const char *)out + 20;
    static const char *const present[] = {"\"extras\":{\"keep\":[1,\"me\"]}",
                                          "\"KHR_materials_ior\":{\"ior\":1.25}",
                                          "\"name\":\"first\"",
                                          "\"copyright\":\"nobody\"",
                                          "\"_HEIGHT\"",
                                          "\"max\":[2.0,1.0,0.0]",
                                          "\"mode\":0",
                                          "\"mode\":1",
                                          "KHR_mesh_quantization",
                                          "\"mimeType\":\"image/png\""};
    static const char *const absent[] = {"\"mode\":5", "EXT_made_up", "\"a%20picture"};
    for (size_t i = 0; i < sizeof present / sizeof *present; i++) {
        assert_non_null(strstr(text, present[i]));
    }
    for (size_t i = 0; i < sizeof absent / sizeof *absent; i++) {
        assert_null(strstr(text, absent[i]));
    }
    bool embedded = false; // byte for byte
    for (const unsigned char *at = binary; at + png_size <= out + size && !embedded; at += 4) {
        embedded = memcmp(at, png, png_size) == 0;
    }
    assert_true(embedded);
    free(out);
    free(png);
}

static void index_width_and_directions(void **state) {
    (void)state;
    const char json[] = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":120}],"
                        "\"bufferViews\":[{\"buffer\":0,"
                        "\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36},{"
                        "\"buffer\":0,\"byteOffset\":72,"
                        "\"byteLength\":48}],\"accessors\":[{\"bufferView\":0,\"componentType\":"
                        "5126,\"count\":3,\"type\":\"VEC3\"},"
                        "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{"
                        "\"bufferView\":2,"
                        "\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}],\"meshes\":[{"
                        "\"primitives\":[{\"attributes\":"
                        "{\"POSITION\":0,\"NORMAL\":1,\"TANGENT\":2}}]}]}";
    static const float data[30] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    gltf_write_glb("plain.glb", json, data, sizeof data);
    girih_gltf_model *model = gltf_load("plain.glb");
    assert_non_null(model);
    for (uint32_t count = 65535; count <= 65536; count++) {
        float *positions = calloc(count, 12), *normals = calloc(count, 12),
              *tangents = calloc(count, 16);
        uint32_t *indices = malloc(12);
        assert_true(positions != NULL && normals != NULL && tangents != NULL && indices != NULL);
        for (uint32_t i = 0; i < count; i++) {
            positions[3 * i] = (float)i * 0.1f;
            normals[3 * i + 1] = i % 2 == 0 ? 1.0f : 0.25f;
            tangents[4 * i + 2] = (float)(i % 7);
            tangents[4 * i + 3] = i % 3 == 0 ? -0.5f : 0.5f;
        }
        indices[0] = 0, indices[1] = count - 1, indices[2] = count / 2;
        const float *attributes[] = {tangents};
        const girih_gltf_refined_primitive refined = {count,   positions, normals, attributes, 3,
                                                      indices, NULL,      NULL,    NULL};
        const girih_gltf_refined_primitive *const meshes[] = {&refined};
        assert_true(girih_gltf_write(model, meshes, folder_path("wide.glb"), NULL, NULL,
                                     gltf_message, sizeof gltf_message));
        girih_gltf_model *after = gltf_load("wide.glb");
        assert_non_null(after);
        const girih_gltf_primitive *primitive = &girih_gltf_get(after)->meshes[0].primitives[0];
        assert_memory_equal(primitive->positions, positions, (size_t)count * 12);
        assert_memory_equal(primitive->indices, indices, 12);
        for (uint32_t i = 0; i < count; i++) {
            const float *normal = primitive->normals + 3 * i,
                        *tangent = primitive->attributes[0].values + 4 * i;
            assert_true(normal[0] == 0.0f && normal[1] == 1.0f && normal[2] == 0.0f);
            const float x = i % 7 == 0 ? 1.0f : 0.0f;
            assert_true(tangent[0] == x && tangent[1] == 0.0f && tangent[2] == 1.0f - x);
            assert_true(tangent[3] == (i % 3 == 0 ? -1.0f : 1.0f));
        }
        size_t size;
        unsigned char *out = folder_read(folder_path("wide.glb"), &size);
        const bool is_short = strstr((char *)out + 20, "\"componentType\":5123") != NULL;
        assert_int_equal(is_short, count <= 65535);
        free(out);

        assert_false(girih_gltf_write(model, meshes, folder_path("nowhere/x.glb"), NULL, NULL,
                                      gltf_message, sizeof gltf_message));
        assert_non_null(strstr(gltf_message, "cannot write"));
        indices[1] = count;
        assert_false(girih_gltf_write(model, meshes, folder_path("wide.glb"), NULL, NULL,
                                      gltf_message, sizeof gltf_message));
        assert_non_null(strstr(gltf_message, "out of range"));
        girih_gltf_destroy(after);
        free(positions);
        free(normals);
        free(tangents);
        free(indices);
    }
    girih_gltf_destroy(model);
}

// Whether the Khronos validator's report beside a file finds an error in it; false without a
// report.
static bool has_errors(const char *path) {
    char report[4096];
    snprintf(report, sizeof report, "%s.report.json", path);
    if (access(report, R_OK) != 0) {
        return false;
    }
    size_t size;
    unsigned char *text = folder_read(report, &size);
    const char *count = strstr((char *)text, "\"numErrors\":");
    const bool errors = count == NULL || strtol(count + 12, NULL, 10) != 0;
    free(text);
    return errors;
}

static void visit(const char *path, unsigned *loaded) {
    DIR *directory = opendir(path);
    if (directory != NULL) {
        for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
            char below[4096];
            snprintf(below, sizeof below, "%s/%s", path, entry->d_name);
            if (entry->d_name[0] != '.') {
                visit(below, loaded);
            }
        }
        closedir(directory);
        return;
    }
    const char *ending = strrchr(path, '.');
    if (ending == NULL || (strcmp(ending, ".gltf") != 0 && strcmp(ending, ".glb") != 0)) {
        return;
    }
    gltf_message[0] = '\0';
    girih_gltf_model *model = girih_gltf_load(path, NULL, NULL, gltf_message, sizeof gltf_message);
    if (model == NULL) {
        assert_true(gltf_message[0] != '\0' && strchr(gltf_message, '\n') == NULL);
        const bool expected = has_errors(path) || strstr(path, "/invalid/") != NULL ||
                              strstr(gltf_message, "decompress") != NULL;
        if (!expected) {
            print_error("%s\n", gltf_message);
        }
        assert_true(expected);
        return;
    }
    *loaded += 1;
    girih_gltf_model *after = written_and_reloaded(model, folder_path("again.glb"));
    assert_same_geometry(model, after);
    girih_gltf_destroy(after);
    girih_gltf_destroy(model);
}

static void real_models(void **state) {
    (void)state;
    const char *models = getenv("GIRIH_MODELS");
    if (models == NULL) {
        skip(); // the folder of real models is named by the environment
    }
    unsigned loaded = 0;
    visit(models, &loaded);
    print_message("%u models loaded, written and loaded again\n", loaded);
    assert_true(loaded > 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_images_and_writing),
        cmocka_unit_test(index_width_and_directions),
        cmocka_unit_test(real_models),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
