#include "json_reader.h"

#include <errno.h>
#include <string.h>

#include "error.h"

girih_json_reader girih_json_reader_of(FILE *stream) {
    return (girih_json_reader){.stream = stream, .last = EOF, .pushed = EOF, .line = 1};
}

static int take_byte(girih_json_reader *reader) {
    const int pushed = reader->pushed;
    reader->pushed = EOF;
    reader->last = pushed != EOF ? pushed : getc(reader->stream);
    reader->line += reader->last == '\n';
    return reader->last;
}

static void push_back(girih_json_reader *reader) {
    reader->pushed = reader->last;
    reader->line -= reader->last == '\n';
}

int girih_json_peek(girih_json_reader *reader) {
    int byte = take_byte(reader);
    while (byte == ' ' || byte == '\t' || byte == '\r' || byte == '\n') {
        byte = take_byte(reader);
    }
    push_back(reader);
    return byte;
}

bool girih_json_take(girih_json_reader *reader, char mark) {
    if (girih_json_peek(reader) != mark) {
        return false;
    }
    take_byte(reader);
    return true;
}

static girih_result cannot_read(const girih_json_reader *reader, girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot be read: %s",
                      errno != 0 && ferror(reader->stream) ? strerror(errno)
                                                           : "input/output error");
}

girih_result girih_json_expect(girih_json_reader *reader, char mark, girih_error *error) {
    if (girih_json_take(reader, mark)) {
        return GIRIH_OK;
    }
    if (ferror(reader->stream)) {
        return cannot_read(reader, error);
    }
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "line %d: no JSON, '%c' is missing",
                      reader->line, mark);
}

// One byte at a time: jansson must not take more than the value.
static size_t give_byte(void *buffer, size_t size, void *data) {
    (void)size;
    const int byte = take_byte(data);
    *(char *)buffer = (char)byte;
    return byte == EOF ? 0 : 1;
}

json_t *girih_json_value(girih_json_reader *reader, girih_error *error) {
    girih_json_peek(reader);
    const int line = reader->line;
    json_error_t reason;
    json_t *value = json_load_callback(
        give_byte, reader, JSON_DECODE_ANY | JSON_DISABLE_EOF_CHECK | JSON_REJECT_DUPLICATES,
        &reason);
    if (!value && ferror(reader->stream)) {
        cannot_read(reader, error);
    } else if (!value) {
        // What jansson cites of the text must not break the line.
        for (char *at = reason.text; *at; at++) {
            *at = (unsigned char)*at < ' ' ? ' ' : *at;
        }
        girih_fail(error, GIRIH_ERROR_INVALID_DATA, "line %d: no JSON, %s",
                   line + (reason.line > 0 ? reason.line - 1 : 0), reason.text);
    } else if (!json_is_string(value) && !json_is_array(value) && !json_is_object(value)) {
        // A number or a word ends before the byte that ended it.
        push_back(reader);
    }
    return value;
}
