// #include of a shader_compiler.h request, expanded into one text: glslang's C interface of
// Debian's version (12.0) takes no callbacks for it. Line directives tell each part's file and
// line.
#ifndef GIRIH_VIEWER_SHADER_INCLUDES_H
#define GIRIH_VIEWER_SHADER_INCLUDES_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "shader_compiler.h"

typedef struct girih_shader_file {
    char *name; // path, or name of a file in memory
    const char *text;
    bool is_user;  // a file on disk, told from others by device and inode
    char *storage; // text of a file on disk
    dev_t device;
    ino_t inode;
} girih_shader_file;

typedef struct girih_shader_text {
    char *bytes;
    size_t size, room;
    girih_shader_file *files;
    uint32_t file_count;
    char **failures;
    uint32_t failure_count;
} girih_shader_text;

// An #include that fails becomes "#error" with this and the number of its message, so that it
// counts only where the preprocessor comes by.
#define GIRIH_SHADER_FAILURE "girih_include_failure "

// *text is the caller's to free, after a failure too.
girih_result girih_shader_expand(const girih_shader_request *request, girih_shader_text *text,
                                 girih_error *error);

// The file of a string number in the text's line directives, NULL: none of ours.
const girih_shader_file *girih_shader_text_file(const girih_shader_text *text,
                                                unsigned long string);

// The message of a failure's number, or NULL.
const char *girih_shader_text_failure(const girih_shader_text *text, unsigned long number);

void girih_shader_text_free(girih_shader_text *text);

#endif
