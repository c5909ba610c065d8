// What girih-patterns prints about a catalogue. Write errors stay in the stream.
#ifndef GIRIH_PATTERN_GEN_REPORT_H
#define GIRIH_PATTERN_GEN_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "pattern.h"

// "dyadic" or "linear".
const char *girih_report_spacing(const girih_catalogue *catalogue);

// A pattern's levels as people count them, and as --max does: from 0 if dyadic, in segments if
// linear.
void girih_report_levels(const girih_catalogue *catalogue, const girih_base_pattern *pattern,
                         uint32_t levels[3]);

typedef enum girih_report_form {
    GIRIH_REPORT_TEXT,
    GIRIH_REPORT_ROWS, // text, and a row for every pattern
    GIRIH_REPORT_JSON,
} girih_report_form;

// Sizes and quality. `progress` may be NULL.
girih_result girih_report_info(const girih_catalogue *catalogue, girih_report_form form,
                               girih_progress *progress, FILE *stream, girih_error *error);

// One of the catalogues that are compared.
typedef struct girih_compared {
    const char *name;
    const girih_catalogue *catalogue;
} girih_compared;

// Two catalogues side by side; patterns of the same segment counts against each other.
girih_result girih_report_compare(const girih_compared compared[2], bool json,
                                  girih_progress *progress, FILE *stream, girih_error *error);

girih_result girih_report_dump(const girih_catalogue *catalogue, bool json, FILE *stream,
                               girih_error *error);

// A C source with the catalogue's bytes as `const uint64_t symbol[]`, their number as
// `const size_t symbol_size`.
void girih_report_embed(const girih_catalogue *catalogue, const char *symbol, FILE *stream);

#endif
