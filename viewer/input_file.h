// Whole files in memory.
#ifndef GIRIH_VIEWER_INPUT_FILE_H
#define GIRIH_VIEWER_INPUT_FILE_H

#include <stddef.h>

#include "girih/result.h"

// Reads a regular file; anything else is refused before it is opened, since a FIFO or a device may
// never end. A 0 byte follows the last one. On success *bytes is the caller's to free. The message
// does not name the file.
girih_result girih_input_read(const char *path, char **bytes, size_t *size, girih_error *error);

#endif
