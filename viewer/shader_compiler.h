// GLSL to SPIR-V while the program runs, through glslang's C interface: for surfaces that the user
// writes.
#ifndef GIRIH_VIEWER_SHADER_COMPILER_H
#define GIRIH_VIEWER_SHADER_COMPILER_H

#include <stddef.h>
#include <stdint.h>

#include "girih/result.h"

typedef enum girih_shader_stage {
    GIRIH_SHADER_VERTEX,
    GIRIH_SHADER_COMPUTE,
} girih_shader_stage;

// A file to include that is held in memory.
typedef struct girih_shader_include {
    const char *name; // as #include gives it
    const char *text;
} girih_shader_include;

// The user's file, by the name under which a request's source includes it.
#define GIRIH_SHADER_USER_FILE "user file"

typedef struct girih_shader_request {
    girih_shader_stage stage;
    const char *source;      // the whole shader, from #version on
    const char *source_name; // for messages
    const girih_shader_include *includes;
    uint32_t include_count;
    const char *user_file; // a path; NULL: the source does not include one
    // What the user's file must define: a function's name, and how it is declared, for people.
    const char *function, *declaration;
} girih_shader_request;

// Compiles for Vulkan 1.1 (SPIR-V 1.3). #include "NAME" takes a file beside the includer if that
// one is a file itself and there is such a one, else a file in memory; #include <NAME> one in
// memory. On success *words is the caller's to free. On failure the message is the first error as
// "FILE:LINE: what", the file and line being the user's own, with ", and N more" where there are
// more. Errors in the user's files go before others. Thread-safe.
girih_result girih_shader_compile(const girih_shader_request *request, uint32_t **words,
                                  size_t *bytes, girih_error *error);

// The library's GLSL, for requests: what an installed girih could not find as files.
extern const girih_shader_include girih_shader_library[];
extern const uint32_t girih_shader_library_count;

#endif
