#define _GNU_SOURCE
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "error.h"

static void release(girih_pattern_output *output) {
    free(output->temporary);
    free(output->path);
    *output = (girih_pattern_output){0};
}

girih_result girih_pattern_output_open(girih_pattern_output *output, const char *path,
                                       girih_error *error) {
    *output = (girih_pattern_output){0};
    struct stat status;
    bool exists = stat(path, &status) == 0;
    if (exists && !S_ISREG(status.st_mode)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s: is not a regular file", path);
    }
    // A link stays one: its target is replaced.
    output->path = exists ? realpath(path, NULL) : strdup(path);
    if (!output->path ||
        asprintf(&output->temporary, "%s.%ld.tmp", output->path, (long)getpid()) < 0) {
        output->temporary = NULL;
        release(output);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "%s: no memory for its name", path);
    }
    int file = open(output->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) {
        output->stream = fdopen(file, "w+b");
    }
    if (!output->stream) {
        girih_result result = girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                                         "%s: cannot be written: %s", path, strerror(errno));
        if (file >= 0) {
            close(file);
            unlink(output->temporary);
        }
        release(output);
        return result;
    }
    return GIRIH_OK;
}

girih_result girih_pattern_output_commit(girih_pattern_output *output, girih_error *error) {
    errno = 0;
    bool written = fflush(output->stream) == 0 && !ferror(output->stream);
    written = fclose(output->stream) == 0 && written;
    girih_result result = GIRIH_OK;
    if (!written || rename(output->temporary, output->path) != 0) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s: cannot be written: %s",
                            output->path, errno ? strerror(errno) : "input/output error");
        unlink(output->temporary);
    }
    release(output);
    return result;
}

void girih_pattern_output_discard(girih_pattern_output *output) {
    fclose(output->stream);
    unlink(output->temporary);
    release(output);
}
