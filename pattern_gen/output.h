// Files that appear whole or not at all.
#ifndef GIRIH_PATTERN_GEN_OUTPUT_H
#define GIRIH_PATTERN_GEN_OUTPUT_H

#include <stdio.h>

#include "girih/result.h"

typedef struct girih_pattern_output {
    FILE *stream; // for writing and reading back; girih_pattern_output_commit finds its errors
    char *path;
    char *temporary;
} girih_pattern_output;

// Opens a temporary file beside the target.
girih_result girih_pattern_output_open(girih_pattern_output *output, const char *path,
                                       girih_error *error);

// Closes the file and gives it its name, or removes it where anything failed to be written.
girih_result girih_pattern_output_commit(girih_pattern_output *output, girih_error *error);

// Closes and removes the file.
void girih_pattern_output_discard(girih_pattern_output *output);

#endif
