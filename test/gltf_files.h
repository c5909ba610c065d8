// glTF files made by the tests.
#ifndef GIRIH_TEST_GLTF_FILES_H
#define GIRIH_TEST_GLTF_FILES_H

#include "../viewer/gltf.h"
#include "folder.h"

#include <stddef.h>
#include <stdint.h>

extern char gltf_message[512];   // what the last call had to say
extern char gltf_warnings[4096]; // of the last gltf_load, one a line

void gltf_warn(void *user, const char *line); // adds to gltf_warnings

girih_gltf_model *gltf_load(const char *name); // a file of the folder
void gltf_assert_refused(const char *name, const char *words);

// A GLB of a JSON text and a binary chunk; returns its size.
size_t gltf_make_glb(unsigned char *to, const char *json, const void *binary, size_t binary_size);
void gltf_write_glb(const char *name, const char *json, const void *binary, size_t binary_size);

// Five points in a zigzag, as a strip sees them, followed by the indices 0..4 as 8, 16 and 32 bits.
typedef struct zigzag {
    float positions[5][3];
    uint8_t bytes[8];
    uint16_t shorts[6];
    uint32_t words[5];
} zigzag;

extern const zigzag zigzag_data;

#define ZIGZAG_VIEWS                                                                               \
    "\"buffers\":[{\"byteLength\":100}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":60},"        \
    "{\"buffer\":0,\"byteOffset\":60,\"byteLength\":5},{\"buffer\":0,\"byteOffset\":68,"           \
    "\"byteLength\":10},{\"buffer\":0,\"byteOffset\":80,\"byteLength\":20}],"
#define ZIGZAG_POSITIONS "{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"}"

// zigzag.glb: one primitive with further accessors (from 1 on) and members, as JSON.
void gltf_write_zigzag(const char *accessors, const char *primitive_members);

#endif
