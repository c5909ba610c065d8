// Catalogues written into temporary files and read back. A failure fails the test.
#ifndef GIRIH_TEST_CATALOGUE_FILES_H
#define GIRIH_TEST_CATALOGUE_FILES_H

#include <stddef.h>
#include <stdio.h>

#include "family.h"

// In memory, to be freed; a zero follows the last byte.
typedef struct block {
    void *bytes;
    size_t size;
} block;

// The whole of a stream, which is closed.
block read_stream(FILE *stream);

block write_catalogue(const girih_family *family, girih_spacing spacing, uint32_t max);

#endif
