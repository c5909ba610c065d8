// Reads a JSON text value by value, so that a list of many megabytes need not be in memory as a
// whole.
#ifndef GIRIH_PATTERN_GEN_JSON_READER_H
#define GIRIH_PATTERN_GEN_JSON_READER_H

#include <stdbool.h>
#include <stdio.h>

#include <jansson.h>

#include "girih/result.h"

typedef struct girih_json_reader {
    FILE *stream;
    int last;   // the byte read last, or EOF
    int pushed; // a byte to be read once more, or EOF
    int line;   // from 1, where the reader stands
} girih_json_reader;

girih_json_reader girih_json_reader_of(FILE *stream);

// The next byte that is no white space, without taking it; EOF at the end.
int girih_json_peek(girih_json_reader *reader);

// Takes the next byte that is no white space where it is `mark`.
bool girih_json_take(girih_json_reader *reader, char mark);

// As girih_json_take, and fails where it is another.
girih_result girih_json_expect(girih_json_reader *reader, char mark, girih_error *error);

// The next value whole, to be released with json_decref; NULL and a reason where it is no JSON.
json_t *girih_json_value(girih_json_reader *reader, girih_error *error);

#endif
