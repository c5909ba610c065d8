// Generates a catalogue into a file.
#ifndef GIRIH_PATTERN_GEN_WRITER_H
#define GIRIH_PATTERN_GEN_WRITER_H

#include <stdint.h>

#include "family.h"

// What fits 32-bit counts of vertices over all patterns.
#define GIRIH_LARGEST_DYADIC_LEVEL 12u
#define GIRIH_LARGEST_LINEAR_COUNT 128u

// Writes the catalogue of dyadic levels 0..max or of linear counts 1..max. Patterns are built by as many threads as the
// machine runs at once, and few of them are in memory. The same arguments give the same bytes.
girih_result girih_catalogue_write(const girih_family *family, girih_spacing spacing, uint32_t max,
                                   const char *path, girih_progress *progress, girih_error *error);

#endif
