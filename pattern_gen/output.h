// Files that appear whole or not at all.
#ifndef GIRIH_PATTERN_GEN_OUTPUT_H
#define GIRIH_PATTERN_GEN_OUTPUT_H

#include <stdio.h>

#include "girih/result.h"

typedef struct girih_output {
    FILE *stream; // for writing and reading back; its errors are found by girih_output_commit
    char *path;
    char *temporary;
} girih_output;

// Opens a temporary file beside the target.
girih_result girih_output_open(girih_output *output, const char *path, girih_error *error);

// Closes the file and gives it its name, or removes it where anything failed to be written.
girih_result girih_output_commit(girih_output *output, girih_error *error);

// Closes and removes the file.
void girih_output_discard(girih_output *output);

#endif
