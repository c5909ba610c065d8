// Catalogues beyond the built-in ones: of the family `uniform`, linked in or generated when they are needed.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"
#include "error.h"
#include "writer.h"

extern const uint64_t bench_uniform_dyadic_words[];
extern const uint64_t bench_uniform_linear_words[];

const girih_catalogue *bench_uniform_dyadic(void) {
    return (const void *)bench_uniform_dyadic_words;
}

const girih_catalogue *bench_uniform_linear(void) {
    return (const void *)bench_uniform_linear_words;
}

static girih_result read_catalogue(const char *path, void **bytes, size_t *size,
                                   girih_error *error) {
    FILE *file = fopen(path, "rb");
    bool whole = file && fseek(file, 0, SEEK_END) == 0;
    const long end = whole ? ftell(file) : -1;
    if (end > 0) {
        rewind(file);
        *size = (size_t)end;
        *bytes = malloc(*size);
        whole = *bytes && fread(*bytes, 1, *size, file) == *size;
    }
    if (file) {
        fclose(file);
    }
    return end > 0 && whole ? GIRIH_OK
                            : girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s: cannot read", path);
}

girih_result bench_catalogue_create(uint32_t max, void **bytes, const girih_catalogue **catalogue,
                                    girih_error *error) {
    const char *temporary = getenv("TMPDIR");
    char folder[3072];
    char path[4096];
    size_t size = 0;
    *bytes = NULL;
    snprintf(folder, sizeof folder, "%s/girih-bench-XXXXXX", temporary ? temporary : "/tmp");
    if (!mkdtemp(folder)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s: cannot make a folder", folder);
    }
    snprintf(path, sizeof path, "%s/dyadic.gpat", folder);
    girih_result result =
        girih_catalogue_write(&girih_family_uniform, GIRIH_SPACING_DYADIC, max, path, NULL, error);
    if (result == GIRIH_OK) {
        result = read_catalogue(path, bytes, &size, error);
    }
    if (result == GIRIH_OK) {
        result = girih_catalogue_open(*bytes, size, catalogue, error);
    }
    if (result != GIRIH_OK) {
        free(*bytes);
        *bytes = NULL;
    }
    unlink(path);
    rmdir(folder);
    return result;
}
