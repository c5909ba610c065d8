// Files made by a test, in a folder of their own.
#ifndef GIRIH_TEST_FOLDER_H
#define GIRIH_TEST_FOLDER_H

#include <stddef.h>

// Group set-up and tear-down: a new folder, and its removal.
int folder_make(void **state);
int folder_remove(void **state);

// A path in the folder, valid until the next call.
const char *folder_path(const char *name);

void folder_write(const char *name, const void *data, size_t size);
unsigned char *folder_read(const char *path, size_t *size); // the caller frees it; a 0 follows

#endif
