// Files that appear under their name only when they are whole.
#ifndef GIRIH_VIEWER_OUTPUT_FILE_H
#define GIRIH_VIEWER_OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct girih_output_file {
    FILE *stream;    // to write to
    char *target;    // the file that is meant, symbolic links resolved
    char *temporary; // beside the target; NULL where the target is written in place
} girih_output_file;

// Opens a file beside path, with a name of its own, for writing. A path that is a device or a FIFO
// (/dev/null) is opened itself; "-" is standard output. On failure returns false and writes one line
// into message.
bool girih_output_open(girih_output_file *file, const char *path, char *message,
                       size_t message_size);

// Closes the file and moves it to its path. On failure, which includes any earlier failed write to
// the stream, removes it, returns false and writes one line into message. Either way file is done.
bool girih_output_commit(girih_output_file *file, char *message, size_t message_size);

// Whether the path is "-".
bool girih_output_is_standard(const char *path);

// Whether writing there would replace a file.
bool girih_output_replaces(const char *path);

// Whether two names lead to one file.
bool girih_output_is_same(const char *a, const char *b);

// Closes and removes the file; the path is as it was. For a caller that cannot finish.
void girih_output_discard(girih_output_file *file);

#ifdef __cplusplus
}
#endif
#endif
