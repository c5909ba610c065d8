// What girih-patterns prints about a catalogue. Write errors stay in the stream.
#ifndef GIRIH_PATTERN_GEN_REPORT_H
#define GIRIH_PATTERN_GEN_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "girih/catalogue.h"

girih_result girih_report_info(const girih_catalogue *catalogue, bool json, FILE *stream,
                               girih_error *error);

void girih_report_dump(const girih_catalogue *catalogue, bool json, FILE *stream);

// A C source with the catalogue's bytes as `const uint64_t symbol[]`, their number as
// `const size_t symbol_size`.
void girih_report_embed(const girih_catalogue *catalogue, const char *symbol, FILE *stream);

#endif
