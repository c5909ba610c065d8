// Patterns from JSON, of the form that `girih-patterns dump --json` writes.
#ifndef GIRIH_PATTERN_GEN_IMPORT_H
#define GIRIH_PATTERN_GEN_IMPORT_H

#include <stdio.h>

#include "family.h"

typedef struct girih_import {
    girih_family family; // copies the patterns read; valid as long as the import stays where it is
    char name[16];       // of the family
    girih_spacing spacing;
    uint32_t max;
    girih_pattern *patterns; // all that the spacing and the maximum ask for, in the order of rank
    uint32_t pattern_count;
} girih_import;

// Reads patterns in any order, their vertices in any order too: they are put into the catalogue's.
// Triangles stay in the order in which they come. Every law is checked. To be freed also where it
// fails.
girih_result girih_import_read(girih_import *import, FILE *stream, girih_error *error);

void girih_import_free(girih_import *import);

#endif
