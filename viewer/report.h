// What the program says, and its exit codes.
#ifndef GIRIH_VIEWER_REPORT_H
#define GIRIH_VIEWER_REPORT_H

#include <jansson.h>
#include <stdio.h>

#include "girih/plan.h"

enum { GIRIH_EXIT_DONE = 0, GIRIH_EXIT_FAILED = 1, GIRIH_EXIT_WRONG_USE = 2 };

// How words stand out. Only on a terminal, and not where the environment has NO_COLOR.
typedef enum girih_style {
    GIRIH_STYLE_PLAIN, // ends the others
    GIRIH_STYLE_LABEL,
    GIRIH_STYLE_GOOD,
    GIRIH_STYLE_WARNING,
    GIRIH_STYLE_FAILURE,
} girih_style;

// What to print on the stream to begin a style; "" where it has none.
const char *girih_report_style(FILE *stream, girih_style style);

// Prints "girih: FILE: what" on standard error and returns GIRIH_EXIT_FAILED. file may be NULL.
int girih_report_failure(const char *file, const char *what);

// Prints "girih: FILE: warning: what" on standard error.
void girih_report_warning(const char *file, const char *what);

// A gltf.h warning function; user is the file's name.
void girih_report_gltf_warning(void *user, const char *line);

// Shows what is being done, where standard error is a terminal; NULL clears the line.
void girih_report_progress(const char *what);

// The same with how much of it is done, and how long the rest will take at that speed. Parts may be
// anything that takes about equally long.
void girih_report_progress_of(const char *what, uint64_t done, uint64_t all);

// Of several files or pictures, says in front of what is being done which one it is, from 0, and how
// long all that are left will take. `kind` is one word, for as long as the program runs.
void girih_report_part(const char *kind, uint32_t number, uint32_t count);

// Milliseconds of the stages. Negative: not measured.
typedef struct girih_stage_times {
    double levels, select, group, dispatch, evaluate, draw;
    double wall; // from recording to the end of the last wait, drawing left out
} girih_stage_times;

extern const girih_stage_times girih_no_times;

// Seconds of a clock that only goes forward.
double girih_seconds(void);

// The JSON object of render and refine; NULL where memory ran out.
json_t *girih_report_json(const char *device, const char *mode, const girih_statistics *statistics,
                          const girih_stage_times *times);

// The same for people, on standard error.
void girih_report_text(const char *device, const char *mode, const girih_statistics *statistics,
                       const girih_stage_times *times);

// Prints an object on standard output, as the only thing there, and releases it. Returns an exit
// code: failed where root is NULL or standard output cannot be written.
int girih_report_print(json_t *root);

// The same for the objects of `count` files, and releases the array: one file's by itself, several
// as {"files": [...]}. Files that failed have none; a single one that did prints nothing.
int girih_report_print_files(json_t *objects, uint32_t count);

#endif
