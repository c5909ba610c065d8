// A picture of a catalogue's patterns, to look at.
#ifndef GIRIH_PATTERN_GEN_SHEET_H
#define GIRIH_PATTERN_GEN_SHEET_H

#include <stdio.h>

#include "pattern.h"

typedef enum girih_sheet_format { GIRIH_SHEET_SVG, GIRIH_SHEET_PNG } girih_sheet_format;

// Which patterns a sheet shows.
typedef struct girih_sheet {
    uint32_t *ranks;
    uint32_t count;
    uint32_t columns; // 0: as many as make the sheet a little wider than high
} girih_sheet;

// Reads a choice of patterns, as "16,8,3;2,1,1", levels as people count them; all patterns where it
// is NULL. What is no such text gives GIRIH_ERROR_INVALID_ARGUMENT, what the catalogue does not
// have GIRIH_ERROR_INVALID_DATA. The ranks are to be freed with girih_sheet_free also where it
// fails.
girih_result girih_sheet_choose(girih_sheet *sheet, const girih_catalogue *catalogue,
                                const char *choice, girih_error *error);

void girih_sheet_free(girih_sheet *sheet);

// Write errors stay in the stream.
girih_result girih_sheet_draw(const girih_sheet *sheet, const girih_catalogue *catalogue,
                              girih_sheet_format format, girih_progress *progress, FILE *stream,
                              girih_error *error);

#endif
