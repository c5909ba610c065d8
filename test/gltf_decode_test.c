// Compressed geometry: what comes out is what went in, and damaged data is refused with one line.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "gltf_files.h"

#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A tetrahedron, 0 and the unit vectors, with the colours (10 v, 200, 0, 255), as draco 1.5.5 wrote
// it: edgebreaker, positions in 8 bits.
static const unsigned char draco_tetrahedron[126] = {
    0x44, 0x52, 0x41, 0x43, 0x4f, 0x02, 0x02, 0x01, 0x01, 0x00, 0x00, 0x00, 0x04, 0x04, 0x01, 0x03,
    0x00, 0x00, 0x01, 0x2f, 0x01, 0x01, 0x10, 0xff, 0x02, 0x66, 0x40, 0x02, 0xff, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x09, 0x03, 0x00, 0x00, 0x02, 0x01, 0x02, 0x02, 0x04, 0x01, 0x01, 0x01,
    0x01, 0x01, 0x01, 0x00, 0x03, 0x03, 0x01, 0x10, 0x01, 0x30, 0x03, 0x00, 0x50, 0x82, 0x24, 0x91,
    0x04, 0x00, 0x00, 0x00, 0x00, 0xff, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3f, 0x08, 0x01, 0x01, 0x01, 0x00, 0x08, 0x13,
    0x01, 0x20, 0x01, 0x10, 0x01, 0x10, 0x03, 0x00, 0x0c, 0x90, 0xbc, 0x37, 0x20, 0x30, 0x01, 0x00,
    0x27, 0x00, 0x00, 0x14, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0x00, 0x00, 0x00};

#define DRACO_JSON(count, position, color)                                                         \
    "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],"        \
    "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"buffers\":[{\"byteLength\":126}],"  \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":126}],\"accessors\":[{\"componentType\":5123,"  \
    "\"count\":12,\"type\":\"SCALAR\"},{\"componentType\":5126,\"count\":" count                   \
    ",\"type\":\"VEC3\"},{\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":"        \
    "\"VEC4\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1,\"COLOR_0\":2},"      \
    "\"indices\":0,\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,"              \
    "\"attributes\":{\"POSITION\":" position ",\"COLOR_0\":" color "}}}}]}]}"

static void draco(void **state) {
    (void)state;
    gltf_write_glb("draco.glb", DRACO_JSON("4", "0", "1"), draco_tetrahedron,
                   sizeof draco_tetrahedron);
    girih_gltf_model *model = gltf_load("draco.glb");
    if (model == NULL) {
        print_error("%s\n", gltf_message);
    }
    assert_non_null(model);
    const girih_gltf_primitive *primitive = &girih_gltf_get(model)->meshes[0].primitives[0];
    assert_int_equal(primitive->vertex_count, 4);
    assert_int_equal(primitive->index_count, 12);
    assert_int_equal(primitive->attribute_count, 1);
    // Each vertex by its colour; every edge once in each direction.
    int edges[4][4] = {{0}};
    unsigned corners[4];
    for (unsigned v = 0; v < 4; v++) {
        const float *color = primitive->attributes[0].values + 4 * v;
        corners[v] = (unsigned)lrintf(color[0] * 25.5f);
        assert_true(corners[v] < 4);
        assert_true(fabsf(color[1] - 200.0f / 255.0f) < 1e-6f && color[3] == 1.0f);
        for (unsigned n = 0; n < 3; n++) {
            const float wanted = corners[v] == n + 1 ? 1.0f : 0.0f;
            assert_true(fabsf(primitive->positions[3 * v + n] - wanted) < 1e-6f);
        }
    }
    for (unsigned i = 0; i < 12; i++) {
        const unsigned next = i % 3 == 2 ? i - 2 : i + 1;
        edges[corners[primitive->indices[i]]][corners[primitive->indices[next]]]++;
    }
    for (unsigned a = 0; a < 4; a++) {
        for (unsigned b = 0; b < 4; b++) {
            assert_int_equal(edges[a][b], a != b);
        }
    }
    assert_int_equal(edges[0][2] + edges[2][1] + edges[1][0], 3);
    girih_gltf_destroy(model);

    static const struct {
        const char *json, *words;
    } lies[] = {
        {DRACO_JSON("5", "0", "1"), "POSITION: 4 elements of 3 components come out"},
        {DRACO_JSON("4", "1", "0"), "COLOR_0: 4 elements of 3 components come out"},
        {DRACO_JSON("4", "0", "7"), "COLOR_0: there is no attribute of number 7"},
    };
    for (size_t n = 0; n < sizeof lies / sizeof *lies; n++) {
        gltf_write_glb("lie.glb", lies[n].json, draco_tetrahedron, sizeof draco_tetrahedron);
        gltf_assert_refused("lie.glb", lies[n].words);
    }
    unsigned char damaged[sizeof draco_tetrahedron];
    for (size_t length = 0; length < sizeof damaged; length += 9) {
        memcpy(damaged, draco_tetrahedron, sizeof damaged);
        memset(damaged + length, 0, sizeof damaged - length);
        gltf_write_glb("damaged.glb", DRACO_JSON("4", "0", "1"), damaged, sizeof damaged);
        model = gltf_load("damaged.glb");
        assert_true(model != NULL || strstr(gltf_message, "KHR_draco_mesh_compression") != NULL);
        girih_gltf_destroy(model);
    }
}

// Positions through the vertex codec and the exponential filter, normals as octahedra in 8 bits,
// triangles and, for a second primitive, a sequence of indices.
typedef struct packed_file {
    unsigned char bytes[2048];
    size_t sizes[4], offsets[4], size;
} packed_file;

static const float grid_positions[6][3] = {{0, 0, 0}, {1, 0, 0},     {2, 0, 0.5f},
                                           {0, 4, 0}, {1, 4, 0.25f}, {2, 4, 0}};
static const unsigned grid_indices[12] = {0, 1, 3, 1, 4, 3, 1, 2, 4, 2, 5, 4};

static void add_part(packed_file *file, unsigned part, size_t size) {
    assert_true(size > 0 && file->size + size < sizeof file->bytes);
    file->sizes[part] = size;
    file->offsets[part] = file->size;
    file->size = (file->size + size + 3) / 4 * 4;
}

static void pack(packed_file *file) {
    memset(file, 0, sizeof *file);
    float filtered[6][3];
    meshopt_encodeFilterExp(filtered, 6, sizeof *filtered, 15, &grid_positions[0][0]);
    add_part(file, 0, meshopt_encodeVertexBuffer(file->bytes, sizeof file->bytes, filtered, 6, 12));
    float normals[6][4];
    for (unsigned v = 0; v < 6; v++) {
        memcpy(normals[v], (const float[4]){0.0f, 0.6f, v % 2 == 0 ? 0.8f : -0.8f, 0.0f}, 16);
    }
    unsigned char octahedra[6][4];
    meshopt_encodeFilterOct(octahedra, 6, sizeof *octahedra, 8, &normals[0][0]);
    add_part(file, 1,
             meshopt_encodeVertexBuffer(file->bytes + file->size, sizeof file->bytes - file->size,
                                        octahedra, 6, 4));
    add_part(file, 2,
             meshopt_encodeIndexBuffer(file->bytes + file->size, sizeof file->bytes - file->size,
                                       grid_indices, 12));
    add_part(file, 3,
             meshopt_encodeIndexSequence(file->bytes + file->size, sizeof file->bytes - file->size,
                                         grid_indices, 12));
}

// change: text of the JSON to replace by another; may be NULL.
static void write_packed(const char *name, const packed_file *file, const char *change,
                         const char *by) {
    static const char *const kinds[] = {
        "\"byteStride\":12,\"count\":6,\"mode\":\"ATTRIBUTES\",\"filter\":\"EXPONENTIAL\"",
        "\"byteStride\":4,\"count\":6,\"mode\":\"ATTRIBUTES\",\"filter\":\"OCTAHEDRAL\"",
        "\"byteStride\":2,\"count\":12,\"mode\":\"TRIANGLES\"",
        "\"byteStride\":4,\"count\":12,\"mode\":\"INDICES\""};
    static const unsigned lengths[] = {72, 24, 24, 48};
    char views[2048] = "";
    for (unsigned part = 0; part < 4; part++) {
        snprintf(views + strlen(views), sizeof views - strlen(views),
                 "%s{\"buffer\":1,\"byteLength\":%u%s,\"extensions\":{\"EXT_meshopt_compression\":{"
                 "\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,%s}}}",
                 part > 0 ? "," : "", lengths[part], part == 1 ? ",\"byteStride\":4" : "",
                 file->offsets[part], file->sizes[part], kinds[part]);
    }
    char json[4096];
    snprintf(
        json, sizeof json,
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"EXT_meshopt_compression\"],"
        "\"extensionsRequired\":[\"EXT_meshopt_compression\"],\"buffers\":[{\"byteLength\":%zu}"
        ",{\"byteLength\":168,\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}"
        "}],\"bufferViews\":[%s],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
        "\"count\":6,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5120,\"count\":6,"
        "\"type\":\"VEC3\",\"normalized\":true},{\"bufferView\":2,\"componentType\":5123,"
        "\"count\":12,\"type\":\"SCALAR\"},{\"bufferView\":3,\"componentType\":5125,\"count\":"
        "12,\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0"
        ",\"NORMAL\":1},\"indices\":2},{\"attributes\":{\"POSITION\":0},\"indices\":3}]}]}",
        file->size, views);
    char changed[4096];
    const char *at = change == NULL ? NULL : strstr(json, change);
    assert_true(change == NULL || at != NULL);
    if (at != NULL) {
        snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - json), json, by,
                 at + strlen(change));
    }
    gltf_write_glb(name, at != NULL ? changed : json, file->bytes, file->size);
}

static void meshopt(void **state) {
    (void)state;
    packed_file file;
    pack(&file);
    write_packed("packed.glb", &file, NULL, NULL);
    girih_gltf_model *model = gltf_load("packed.glb");
    if (model == NULL) {
        print_error("%s\n", gltf_message);
    }
    assert_non_null(model);
    for (unsigned p = 0; p < 2; p++) {
        const girih_gltf_primitive *primitive = &girih_gltf_get(model)->meshes[0].primitives[p];
        assert_int_equal(primitive->vertex_count, 6);
        assert_memory_equal(primitive->positions, grid_positions, sizeof grid_positions);
        assert_int_equal(primitive->index_count, 12);
        // The codec of triangles keeps them and their winding, but not the first corner of each.
        for (unsigned t = 0; t < 12; t += 3) {
            unsigned turn = 0;
            while (turn < 3 && primitive->indices[t + turn] != grid_indices[t]) {
                turn++;
            }
            for (unsigned c = 0; c < 3; c++) {
                assert_int_equal(primitive->indices[t + (c + turn) % 3], grid_indices[t + c]);
            }
        }
    }
    const float *normals = girih_gltf_get(model)->meshes[0].primitives[0].normals;
    for (unsigned v = 0; v < 6; v++) {
        assert_true(fabsf(normals[3 * v]) < 0.01f && fabsf(normals[3 * v + 1] - 0.6f) < 0.01f);
        assert_true(fabsf(normals[3 * v + 2] - (v % 2 == 0 ? 0.8f : -0.8f)) < 0.01f);
    }
    girih_gltf_destroy(model);

    static const struct {
        const char *change, *by, *words;
    } lies[] = {
        {"\"count\":6,\"mode\"", "\"count\":7,\"mode\"", "buffer view 0, EXT_meshopt"},
        {"\"count\":12,\"mode\"", "\"count\":9,\"mode\"", "buffer view 2, EXT_meshopt"},
        {"\"count\":6,\"mode\"", "\"count\":4000000000,\"mode\"", "are more than its"},
        {"\"byteStride\":12", "\"byteStride\":10", "cannot be"},
        {"EXPONENTIAL", "QUATERNION", "filter QUATERNION of elements of 12 bytes"},
        {"EXPONENTIAL", "COLOR", "filter COLOR"},
        {"ATTRIBUTES", "TRIANGLES", "cannot be"},
        {"\"byteOffset\":0", "\"byteOffset\":5000", "reaches beyond"},
        {"\"buffer\":0", "\"buffer\":2", "only 2 buffers"},
        {"\"buffer\":0", "\"buffer\":1", "neither a uri nor a GLB binary chunk"},
        {"\"byteLength\":72", "\"byteLength\":73", "bytes come out, the view has 73"},
    };
    for (size_t n = 0; n < sizeof lies / sizeof *lies; n++) {
        write_packed("lie.glb", &file, lies[n].change, lies[n].by);
        gltf_assert_refused("lie.glb", lies[n].words);
    }
    for (size_t at = 0; at < file.size; at++) {
        packed_file damaged = file;
        damaged.bytes[at] ^= (unsigned char)(1u << at % 8);
        write_packed("damaged.glb", &damaged, NULL, NULL);
        model = gltf_load("damaged.glb");
        assert_true(model != NULL ||
                    (gltf_message[0] != '\0' && strchr(gltf_message, '\n') == NULL));
        girih_gltf_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(draco),
        cmocka_unit_test(meshopt),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
