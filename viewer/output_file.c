#define _GNU_SOURCE // realpath with NULL, O_CLOEXEC
#include "output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void release(girih_output_file *file) {
    free(file->target);
    free(file->temporary);
    *file = (girih_output_file){0};
}

bool girih_output_open(girih_output_file *file, const char *path, char *message,
                       size_t message_size) {
    *file = (girih_output_file){0};
    struct stat status;
    const bool is_standard = girih_output_is_standard(path);
    const bool exists = !is_standard && stat(path, &status) == 0;
    // Renaming over a link would replace the link, over a device the device.
    file->target = exists ? realpath(path, NULL) : strdup(is_standard ? "standard output" : path);
    int descriptor = -1;
    if (file->target != NULL && is_standard) {
        descriptor = dup(STDOUT_FILENO);
    } else if (file->target != NULL && exists && !S_ISREG(status.st_mode)) {
        descriptor = open(file->target, O_WRONLY | O_CLOEXEC);
    } else if (file->target != NULL) {
        const size_t size = strlen(file->target) + 32;
        file->temporary = malloc(size);
        for (unsigned attempt = 0; file->temporary != NULL && descriptor < 0 && attempt < 100;
             attempt++) {
            snprintf(file->temporary, size, "%s.%ld.%u", file->target, (long)getpid(), attempt);
            descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (descriptor < 0 && errno != EEXIST) {
                break;
            }
        }
    }
    file->stream = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
    if (file->stream != NULL) {
        return true;
    }
    snprintf(message, message_size, "%s: cannot write: %s", path, strerror(errno));
    if (descriptor >= 0) {
        close(descriptor);
        if (file->temporary != NULL) {
            unlink(file->temporary);
        }
    }
    release(file);
    return false;
}

bool girih_output_commit(girih_output_file *file, char *message, size_t message_size) {
    errno = 0;
    bool whole = !ferror(file->stream);
    whole = fclose(file->stream) == 0 && whole;
    if (whole && file->temporary != NULL) {
        whole = rename(file->temporary, file->target) == 0;
    }
    if (!whole) {
        snprintf(message, message_size, "%s: cannot write: %s", file->target,
                 errno != 0 ? strerror(errno) : "a write failed");
        if (file->temporary != NULL) {
            unlink(file->temporary);
        }
    }
    release(file);
    return whole;
}

void girih_output_discard(girih_output_file *file) {
    fclose(file->stream);
    if (file->temporary != NULL) {
        unlink(file->temporary);
    }
    release(file);
}

bool girih_output_is_standard(const char *path) {
    return strcmp(path, "-") == 0;
}

bool girih_output_replaces(const char *path) {
    struct stat status;
    return !girih_output_is_standard(path) && stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

bool girih_output_is_same(const char *a, const char *b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}
