#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "gltf_files.h"

#include <stdio.h>
#include <string.h>

char gltf_message[512];
char gltf_warnings[4096];

void gltf_warn(void *user, const char *line) {
    (void)user;
    assert_null(strchr(line, '\n'));
    const size_t used = strlen(gltf_warnings);
    snprintf(gltf_warnings + used, sizeof gltf_warnings - used, "%s\n", line);
}

girih_gltf_model *gltf_load(const char *name) {
    gltf_warnings[0] = gltf_message[0] = '\0';
    return girih_gltf_load(folder_path(name), gltf_warn, NULL, gltf_message, sizeof gltf_message);
}

void gltf_assert_refused(const char *name, const char *words) {
    girih_gltf_model *model = gltf_load(name);
    if (model != NULL || strstr(gltf_message, words) == NULL ||
        strchr(gltf_message, '\n') != NULL) {
        print_error("expected a refusal with '%s', got '%s'\n", words,
                    model != NULL ? "a model" : gltf_message);
        fail();
    }
}

static void put_u32(unsigned char *to, size_t value) {
    for (unsigned i = 0; i < 4; i++) {
        to[i] = (unsigned char)(value >> 8 * i & 0xff);
    }
}

// A GLB of a JSON text and a binary chunk.
size_t gltf_make_glb(unsigned char *to, const char *json, const void *binary, size_t binary_size) {
    const size_t json_size = (strlen(json) + 3) / 4 * 4, padded = (binary_size + 3) / 4 * 4;
    const size_t size = 20 + json_size + (padded > 0 ? 8 + padded : 0);
    memset(to, 0, size);
    memcpy(to, "glTF", 4);
    put_u32(to + 4, 2);
    put_u32(to + 8, size);
    put_u32(to + 12, json_size);
    memcpy(to + 16, "JSON", 4);
    memset(to + 20, ' ', json_size);
    memcpy(to + 20, json, strlen(json));
    if (padded > 0) {
        put_u32(to + 20 + json_size, padded);
        memcpy(to + 24 + json_size, "BIN", 3);
        memcpy(to + 28 + json_size, binary, binary_size);
    }
    return size;
}

void gltf_write_glb(const char *name, const char *json, const void *binary, size_t binary_size) {
    static unsigned char buffer[1 << 16];
    assert_true(strlen(json) + binary_size + 64 < sizeof buffer);
    folder_write(name, buffer, gltf_make_glb(buffer, json, binary, binary_size));
}

const zigzag zigzag_data = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}},
                            {0, 1, 2, 3, 4},
                            {0, 1, 2, 3, 4},
                            {0, 1, 2, 3, 4}};

void gltf_write_zigzag(const char *indices, const char *primitive_rest) {
    char json[2048];
    snprintf(json, sizeof json,
             "{\"asset\":{\"version\":\"2.0\"}," ZIGZAG_VIEWS "\"accessors\":[" ZIGZAG_POSITIONS "%"
             "s"
             "]"
             ","
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}%s}]}],"
             "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}",
             indices, primitive_rest);
    gltf_write_glb("zigzag.glb", json, &zigzag_data, sizeof zigzag_data);
}
