#include "input_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "error.h"

girih_result girih_input_read(const char *path, char **bytes, size_t *size, girih_error *error) {
    struct stat status;
    if (stat(path, &status) != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "is no regular file");
    }
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", strerror(errno));
    }
    girih_result result = GIRIH_OK;
    *size = (size_t)status.st_size;
    *bytes = malloc(*size + 1);
    if (*bytes == NULL) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else if (fread(*bytes, 1, *size, stream) != *size) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_DATA, "cannot be read to its end");
        free(*bytes);
        *bytes = NULL;
    } else {
        (*bytes)[*size] = '\0';
    }
    fclose(stream);
    return result;
}
