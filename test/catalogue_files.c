#define _GNU_SOURCE
#include "catalogue_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "writer.h"

block read_stream(FILE *stream) {
    assert_non_null(stream);
    assert_int_equal(fseek(stream, 0, SEEK_END), 0);
    long size = ftell(stream);
    assert_true(size > 0);
    rewind(stream);
    char *bytes = malloc((size_t)size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, (size_t)size, stream), size);
    bytes[size] = 0;
    fclose(stream);
    return (block){bytes, (size_t)size};
}

block write_catalogue(const girih_family *family, girih_spacing spacing, uint32_t max) {
    char path[] = P_tmpdir "/girih_catalogue_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    girih_error error = {.message = ""};
    girih_result result = girih_catalogue_write(family, spacing, max, path, NULL, &error);
    assert_string_equal(error.message, "");
    assert_int_equal(result, GIRIH_OK);
    block read = read_stream(fopen(path, "rb"));
    unlink(path);
    return read;
}
