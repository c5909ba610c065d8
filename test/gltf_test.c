// The glTF loader: what a file says is what the contents hold, and a file that lies is refused with
// one line.
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "gltf_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void assert_triangles(const char *name, const uint32_t *expected, uint32_t count) {
    girih_gltf_model *model = gltf_load(name);
    if (model == NULL) {
        print_error("%s\n", gltf_message);
    }
    assert_non_null(model);
    const girih_gltf_primitive *primitive = &girih_gltf_get(model)->meshes[0].primitives[0];
    assert_int_equal(primitive->index_count, count);
    assert_int_equal(girih_gltf_get(model)->triangle_count, count / 3);
    assert_memory_equal(primitive->indices, expected, count * sizeof *expected);
    girih_gltf_destroy(model);
}

static void modes_and_index_types(void **state) {
    (void)state;
    static const char *const accessors[] = {"",
                                            ",{\"bufferView\":1,\"componentType\":5121,\"count\":5,"
                                            "\"type\":\"SCALAR\"}",
                                            ",{\"bufferView\":2,\"componentType\":5123,\"count\":5,"
                                            "\"type\":\"SCALAR\"}",
                                            ",{\"bufferView\":3,\"componentType\":5125,\"count\":5,"
                                            "\"type\":\"SCALAR\"}"};
    // The second triangle of a strip swaps its last two corners: (1,2,3) would face the other way.
    static const uint32_t strip[] = {0, 1, 2, 1, 3, 2, 2, 3, 4};
    static const uint32_t fan[] = {1, 2, 0, 2, 3, 0, 3, 4, 0};
    static const uint32_t triangles[] = {0, 1, 2};
    for (unsigned type = 0; type < 4; type++) {
        const char *indices = type == 0 ? "" : ",\"indices\":1";
        char rest[64];
        snprintf(rest, sizeof rest, "%s,\"mode\":5", indices);
        gltf_write_zigzag(accessors[type], rest);
        assert_triangles("zigzag.glb", strip, 9);
        snprintf(rest, sizeof rest, "%s,\"mode\":6", indices);
        gltf_write_zigzag(accessors[type], rest);
        assert_triangles("zigzag.glb", fan, 9);
        gltf_write_zigzag(accessors[type], indices);
        assert_triangles("zigzag.glb", triangles, 3); // the two corners left over are dropped
        assert_non_null(strstr(gltf_warnings, "no whole number of triangles"));
    }
    for (size_t t = 0; t < 9; t += 3) { // every triangle of the strip faces as its first one does
        const float *a = zigzag_data.positions[strip[t]], *b = zigzag_data.positions[strip[t + 1]],
                    *c = zigzag_data.positions[strip[t + 2]];
        assert_true((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0);
    }
}

static void bad_containers(void **state) {
    (void)state;
    static const char json[] = "{\"asset\":{\"version\":\"2.0\"}}";
    unsigned char good[128], bad[128];
    const size_t size = gltf_make_glb(good, json, "abcd", 4);
    folder_write("c.glb", good, size);
    girih_gltf_model *model = gltf_load("c.glb");
    assert_non_null(model);
    assert_int_equal(girih_gltf_get(model)->triangle_count, 0);
    girih_gltf_destroy(model);
    folder_write("named_wrongly.gltf", good, size); // content decides, not the name
    model = gltf_load("named_wrongly.gltf");
    assert_non_null(model);
    girih_gltf_destroy(model);

    static const struct {
        size_t offset;
        unsigned char value;
        const char *words;
    } damages[] = {{0, 'x', "bad GLB header"},   {4, 1, "version 1"}, {8, 1, "bad GLB header"},
                   {12, 27, "no multiple of 4"}, {13, 1, "are left"}, {16, 'X', "must be JSON"},
                   {20, '[', "not valid JSON"},  {52, 'J', NULL}};
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        memcpy(bad, good, size);
        bad[damages[i].offset] = damages[i].value;
        folder_write("c.glb", bad, size);
        if (damages[i].words != NULL) {
            gltf_assert_refused("c.glb", damages[i].words);
        }
    }
    for (size_t length = 0; length < size; length++) {
        folder_write("c.glb", good, length);
        gltf_assert_refused("c.glb", length < 4 ? "header" : "bad GLB");
    }
    folder_write("text.gltf", "hello", 5);
    gltf_assert_refused("text.gltf", "neither glTF JSON nor GLB");
    gltf_assert_refused("absent.gltf", "No such file");
    assert_int_equal(mkfifo(folder_path("fifo.glb"), 0600), 0);
    gltf_assert_refused("fifo.glb", "not a regular file"); // and does not hang
    char deep[1200] = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
    memset(deep + strlen(deep), '[', 1000);
    folder_write("deep.gltf", deep, sizeof deep);
    gltf_assert_refused("deep.gltf", "nested");
}

static void lies_are_refused(void **state) {
    (void)state;
#define SCALARS(rest) ",{\"componentType\":5121,\"type\":\"SCALAR\",\"bufferView\":1," rest "}"
    static const struct {
        const char *accessors, *primitive, *words;
    } cases[] = {
        {SCALARS("\"count\":6"), "", "reach beyond"},
        {SCALARS("\"count\":5,\"byteOffset\":1"), "", "reach beyond"},
        {SCALARS("\"count\":5,\"byteOffset\":9223372036854775807"), "", "reach beyond"},
        {SCALARS("\"count\":9223372036854775807"), "", "reach beyond"},
        {SCALARS("\"count\":5,\"byteOffset\":18446744073709551615"), "", "byteOffset"},
        {SCALARS("\"count\":-1"), "", "count"},
        {SCALARS("\"count\":\"5\""), "", "count"},
        {",{\"componentType\":5126,\"type\":\"VEC3\",\"count\":4000000000}", ",\"indices\":1",
         "scalars"},
        {",{\"componentType\":5121,\"type\":\"SCALAR\",\"count\":4000000000}", ",\"indices\":1",
         "without data"},
        {",{\"bufferView\":0,\"componentType\":5121,\"count\":60,\"type\":\"SCALAR\"}",
         ",\"indices\":1", "only 5 vertices"},
        {",{\"bufferView\":0,\"componentType\":5126,\"count\":15,\"type\":\"SCALAR\"}",
         ",\"indices\":1", "unsigned integer"},
        {"", ",\"indices\":7", "only 1 accessors"},
        {"", ",\"material\":0", "only 0 materials"},
        {"", ",\"mode\":7", "mode"},
        {"", ",\"attributes\":{\"POSITION\":0,\"NORMAL\":3}", "only 1 accessors"},
        {",{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}",
         ",\"attributes\":{\"POSITION\":0,\"NORMAL\":1}", "NORMAL has 4 elements"},
        {",{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC2\"}",
         ",\"attributes\":{\"POSITION\":1}", "POSITION is VEC2"},
        {",{\"bufferView\":0,\"componentType\":5125,\"count\":5,\"type\":\"VEC3\"}",
         ",\"attributes\":{\"POSITION\":1}", "component type 5125"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        gltf_write_zigzag(cases[i].accessors, cases[i].primitive);
        gltf_assert_refused("zigzag.glb", cases[i].words);
    }
    zigzag data = zigzag_data;
    char json[1024];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"}," ZIGZAG_VIEWS "\"accessors\":[" ZIGZAG_POSITIONS
             ",{\"bufferView\":1,\"componentType\":5121,\"count\":5,\"type\":\"SCALAR\"}],"
             "\"meshes\":"
             "[{\"name\":\"roof\",\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}"
             "]}");
    data.bytes[4] = 255;
    gltf_write_glb("lie.glb", json, &data, sizeof data);
    gltf_assert_refused("lie.glb", "mesh 0 'roof', primitive 0: index 4 is the primitive restart "
                                   "value 255");
    data.bytes[4] = 5;
    gltf_write_glb("lie.glb", json, &data, sizeof data);
    gltf_assert_refused("lie.glb", "index 4 is 5, but there are only 5 vertices");
    data = zigzag_data;
    data.positions[3][1] = NAN;
    gltf_write_glb("lie.glb", json, &data, sizeof data);
    gltf_assert_refused("lie.glb", "POSITION of vertex 3 is not finite");
    gltf_write_glb("lie.glb", json, &data, 60); // the chunk is shorter than the buffer says
    gltf_assert_refused("lie.glb", "its data has only 60");
}

static void documents_are_checked(void **state) {
    (void)state;
    static const struct {
        const char *json, *words;
    } cases[] = {
        {"{}", "asset: is missing"},
        {"{\"asset\":{\"version\":\"1.0\"}}", "only 2.0"},
        {"{\"asset\":{\"version\":2}}", "must be a string"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":{}}", "must be an array"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[7]}", "must be an object"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[0]}]}", "node loop"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[1]},{\"children\":[2]},{"
         "\"children\":[0]}]}",
         "node loop"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[2]},{\"children\":[2]},{}]}",
         "two parents"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[1]},{}],\"scenes\":[{"
         "\"nodes\":[1]}]}",
         "no root"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}],\"scenes\":[{\"nodes\":[0,0]}]}", "twic"
                                                                                            "e"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}]}", "only 0 meshes"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"camera\":0}]}", "only 0 cameras"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"scale\":[1,2]}]}", "3 numbers"},
        {"{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"scale\":[1e300,1,1]}]}", "not finite"},
        {"{\"asset\":{\"version\":\"2.0\"},\"scene\":0}", "only 0 scenes"},
        {"{\"asset\":{\"version\":\"2.0\"},\"textures\":[{\"source\":0}]}", "only 0 images"},
        {"{\"asset\":{\"version\":\"2.0\"},\"cameras\":[{\"type\":\"fisheye\"}]}", "camera"},
        {"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4}],\"bufferViews\":[{"
         "\"buffer\":0,"
         "\"byteOffset\":2,\"byteLength\":3}]}",
         "beyond the 4 bytes"},
        {"{\"asset\":{\"version\":\"2.0\"},\"bufferViews\":[{\"buffer\":0,\"byteLength\":3}]}",
         "only 0 buffers"},
        {"{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"EXT_made_up\"]}",
         "required extension EXT_made_up is not supported; export"},
        {"{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"EXT_x\\ny\"]}", "EXT_x y"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        folder_write("doc.gltf", cases[i].json, strlen(cases[i].json));
        gltf_assert_refused("doc.gltf", cases[i].words);
    }
    static const char missing[] = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"gone%"
                                  "20away.bin\",\"byteLength\":36}],"
                                  "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
                                  "\"accessors\":[{\"bufferView\":0,"
                                  "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
                                  "\"meshes\":[{\"primitives\":"
                                  "[{\"attributes\":{\"POSITION\":0}}]}]}";
    folder_write("missing.gltf", missing, strlen(missing));
    gltf_assert_refused("missing.gltf", "buffer 0: 'gone away.bin': cannot open");
    folder_write("gone away.bin", zigzag_data.positions, 36);
    girih_gltf_model *model = gltf_load("missing.gltf");
    assert_non_null(model);
    assert_memory_equal(girih_gltf_get(model)->meshes[0].primitives[0].positions,
                        zigzag_data.positions, 36);
    assert_int_equal(girih_gltf_get(model)->placement_count, 1); // no node: placed as it lies
    assert_true(girih_gltf_get(model)->placements[0].node == GIRIH_GLTF_NO_NODE);
    girih_gltf_destroy(model);
}

static void interleaved_sparse_and_base64(void **state) {
    (void)state;
    // A position and a normal in turn; then one sparse index (u8) and its position.
    float data[3 * 6 + 1 + 3];
    for (unsigned i = 0; i < 18; i++) {
        data[i] = (float)i;
    }
    data[18] = 0.0f;
    ((unsigned char *)&data[18])[0] = 1;
    data[19] = 7.5f, data[20] = -0.0f, data[21] = 1e-42f;
    static const char json[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":88}],\"bufferViews\":["
        "{\"buffer\":0,\"byteLength\":72,\"byteStride\":24},{\"buffer\":0,\"byteOffset\":72,"
        "\"byteLength\":1},"
        "{\"buffer\":0,\"byteOffset\":76,\"byteLength\":12}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{"
        "\"count\":1,"
        "\"indices\":{\"bufferView\":1,\"componentType\":5121},\"values\":{\"bufferView\":2}}},"
        "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":"
        "2}}]}]}";
    gltf_write_glb("mixed.glb", json, data, sizeof data);
    girih_gltf_model *model = gltf_load("mixed.glb");
    assert_non_null(model);
    const girih_gltf_primitive *primitive = &girih_gltf_get(model)->meshes[0].primitives[0];
    const float positions[] = {0, 1, 2, 7.5f, -0.0f, 1e-42f, 12, 13, 14};
    const float normals[] = {3, 4, 5, 9, 10, 11, 15, 16, 17};
    const float zeros[6] = {0};
    assert_memory_equal(primitive->positions, positions, sizeof positions);
    assert_memory_equal(primitive->normals, normals, sizeof normals);
    assert_int_equal(primitive->attribute_count, 1);
    assert_string_equal(primitive->attributes[0].name, "TEXCOORD_0");
    assert_memory_equal(primitive->attributes[0].values, zeros,
                        sizeof zeros); // no buffer view: zeros
    girih_gltf_destroy(model);

    ((unsigned char *)&data[18])[0] = 3;
    gltf_write_glb("mixed.glb", json, data, sizeof data);
    gltf_assert_refused("mixed.glb", "sparse index 3");

    static const char base64[] = // positions (0,0,0), (1,0,0), (0,1,0)
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:"
        "application/octet-stream;"
        "base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":"
        "0,"
        "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126.0,\"count\":3."
        "0,\"type\":"
        "\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0.0}}]}]}";
    folder_write("base64.gltf", base64, strlen(base64));
    model = gltf_load("base64.gltf");
    assert_non_null(model);
    const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    assert_memory_equal(girih_gltf_get(model)->meshes[0].primitives[0].positions, corners,
                        sizeof corners);
    girih_gltf_destroy(model);
}

static void quantized_values(void **state) {
    (void)state;
    static const struct {
        unsigned type;
        const char *normalized;
        float expected[3]; // of the raw components 0x80.., 0x7f.., 0x01..
    } cases[] = {
        {5120, "false", {-128, 127, 1}},
        {5120, "true", {-1, 1, 1.0f / 127}},
        {5121, "false", {128, 127, 1}},
        {5121, "true", {128.0f / 255, 127.0f / 255, 1.0f / 255}},
        {5122, "false", {-32768, 32767, 1}},
        {5122, "true", {-1, 1, 1.0f / 32767}},
        {5123, "false", {32768, 32767, 1}},
        {5123, "true", {32768.0f / 65535, 32767.0f / 65535, 1.0f / 65535}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bool wide = cases[i].type >= 5122;
        unsigned char data[24] = {0};
        for (unsigned v = 0; v < 3; v++) {
            const uint16_t shorts[3] = {0x8000, 0x7fff, 1};
            const uint8_t bytes[3] = {0x80, 0x7f, 1};
            memcpy(data + 8 * v, wide ? (const void *)shorts : (const void *)bytes, wide ? 6 : 3);
        }
        char json[1024];
        snprintf(json, sizeof json,
                 "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_mesh_quantization\"],"
                 "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"buffers\":[{\"byteLength\":"
                 "24}],"
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":24,\"byteStride\":8}],"
                 "\"accessors\":[{\"bufferView\":0,"
                 "\"componentType\":%u,\"normalized\":%s,\"count\":3,\"type\":\"VEC3\"}],"
                 "\"meshes\":[{\"primitives\":"
                 "[{\"attributes\":{\"POSITION\":0}}]}]}",
                 cases[i].type, cases[i].normalized);
        gltf_write_glb("quantized.glb", json, data, sizeof data);
        girih_gltf_model *model = gltf_load("quantized.glb");
        assert_non_null(model);
        for (unsigned c = 0; c < 9; c++) {
            const float value = girih_gltf_get(model)->meshes[0].primitives[0].positions[c];
            assert_true(fabsf(value - cases[i].expected[c % 3]) <= 1e-7f * fabsf(value));
        }
        girih_gltf_destroy(model);
    }
}

static void transforms(void **state) {
    (void)state;
    // A turn of 90 degrees about z and a mirroring scale under a translation, as TRS and as a
    // matrix.
    char json[2048];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"}," ZIGZAG_VIEWS "\"accessors\":[" ZIGZAG_POSITIONS
             "],\"meshes\":[{\"primitives\":"
             "[{\"attributes\":{\"POSITION\":0},\"mode\":5}]}],\"cameras\":[{\"type\":"
             "\"perspective\",\"perspective\":"
             "{\"yfov\":0.75,\"znear\":0.5}}],\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
             "{\"translation\":[1,2,3],\"children\":[1,2]},"
             "{\"rotation\":[0,0,0.70710678118654752,0.70710678118654752],\"scale\":[2,-3,4],"
             "\"mesh\":0},"
             "{\"matrix\":[0,2,0,0,3,0,0,0,0,0,4,0,0,0,0,1],\"mesh\":0,\"camera\":0},{\"mesh\":0}]"
             "}");
    gltf_write_glb("nodes.glb", json, &zigzag_data, sizeof zigzag_data);
    girih_gltf_model *model = gltf_load("nodes.glb");
    assert_non_null(model);
    const girih_gltf_contents *contents = girih_gltf_get(model);
    assert_int_equal(contents->placement_count, 2); // node 3 is in no scene
    static const float expected[12] = {0, 3, 0, 1, 2, 0, 0, 2, 0, 0, 4, 3};
    for (unsigned p = 0; p < 2; p++) {
        assert_int_equal(contents->placements[p].node, p + 1);
        for (unsigned i = 0; i < 12; i++) {
            assert_true(fabsf(contents->placements[p].transform[i] - expected[i]) <= 1e-6f);
        }
    }
    assert_int_equal(contents->camera_count, 1);
    assert_true(contents->cameras[0].perspective && contents->cameras[0].far == 0.0f);
    assert_true(contents->cameras[0].vertical_view_angle == 0.75f &&
                contents->cameras[0].near == 0.5f);
    assert_memory_equal(contents->cameras[0].transform, contents->placements[1].transform, 48);
    girih_gltf_destroy(model);

    // A chain of 20,000 nodes, each a step along x: no recursion, no loss.
    const unsigned count = 20000;
    char *text = malloc(64 * (size_t)count);
    assert_non_null(text);
    size_t length = (size_t)sprintf(text, "{\"asset\":{\"version\":\"2.0\"},\"cameras\":[{\"type\":"
                                          "\"perspective\","
                                          "\"perspective\":{\"yfov\":1,\"znear\":1}}],\"nodes\":[");
    for (unsigned i = 1; i < count; i++) {
        length += (size_t)sprintf(text + length, "{\"translation\":[1,0,0],\"children\":[%u]},", i);
    }
    length += (size_t)sprintf(text + length, "{\"camera\":0}]}");
    folder_write("chain.gltf", text, length);
    free(text);
    model = gltf_load("chain.gltf");
    assert_non_null(model);
    assert_int_equal(girih_gltf_get(model)->camera_count, 1);
    assert_true(girih_gltf_get(model)->cameras[0].transform[3] == (float)(count - 1));
    girih_gltf_destroy(model);
}

static void mutations_never_crash(void **state) {
    (void)state;
    gltf_write_zigzag(",{\"bufferView\":2,\"componentType\":5123,\"count\":5,\"type\":\"SCALAR\"}",
                      ",\"indices\":1,\"mode\":5");
    size_t size;
    unsigned char *good = folder_read(folder_path("zigzag.glb"), &size), *bad = malloc(size);
    assert_non_null(bad);
    uint64_t random = 88172645463325252u;
    for (unsigned run = 0; run < 3000; run++) {
        memcpy(bad, good, size);
        size_t length = size;
        for (unsigned change = 0; change < 1 + run % 3; change++) {
            random ^= random << 13, random ^= random >> 7, random ^= random << 17;
            const size_t at = (size_t)(random >> 16) % size;
            if (random % 3 == 0) {
                bad[at] = (unsigned char)"0123456789-\"[{"[random / 3 % 14];
            } else {
                bad[at] ^= (unsigned char)(1u << random / 3 % 8);
            }
            length = random % 11 == 0 ? at : length;
        }
        folder_write("mutant.glb", bad, length);
        girih_gltf_model *model = gltf_load("mutant.glb");
        assert_true(model != NULL ||
                    (gltf_message[0] != '\0' && strchr(gltf_message, '\n') == NULL));
        girih_gltf_destroy(model);
    }
    free(good);
    free(bad);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(modes_and_index_types),
        cmocka_unit_test(bad_containers),
        cmocka_unit_test(lies_are_refused),
        cmocka_unit_test(documents_are_checked),
        cmocka_unit_test(interleaved_sparse_and_base64),
        cmocka_unit_test(quantized_values),
        cmocka_unit_test(transforms),
        cmocka_unit_test(mutations_never_crash),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
