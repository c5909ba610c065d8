#include "png.h"

#include "output_file.h"

#include <setjmp.h>
#include <stdio.h>

#include <libpng16/png.h> // with its folder: <png.h> alone could mean this project's

// libpng's default compression, 6, takes twice the time of 3 for a few percent of the size.
#define COMPRESSION_LEVEL 3

typedef struct failure {
    jmp_buf jump;
    char text[128];
} failure;

static void fail(png_structp png, png_const_charp text) {
    failure *state = png_get_error_ptr(png);
    snprintf(state->text, sizeof state->text, "%s", text);
    longjmp(state->jump, 1);
}

static void ignore_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

// Apart from girih_png_write, so that no variable of that one changes between setjmp and longjmp.
static bool encode(png_structp png, png_infop info, failure *state, FILE *stream, uint32_t width,
                   uint32_t height, const uint8_t *rgba) {
    if (setjmp(state->jump) != 0) {
        return false;
    }
    png_init_io(png, stream);
    png_set_compression_level(png, COMPRESSION_LEVEL);
    png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (uint32_t row = 0; row < height; row++) {
        png_write_row(png, rgba + (size_t)4 * width * row);
    }
    png_write_end(png, NULL);
    return true;
}

bool girih_png_write(const char *path, uint32_t width, uint32_t height, const uint8_t *rgba,
                     char *message, size_t message_size) {
    girih_output_file file;
    if (!girih_output_open(&file, path, message, message_size)) {
        return false;
    }
    failure state = {.text = "out of memory"};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &state, fail, ignore_warning);
    png_infop info = png != NULL ? png_create_info_struct(png) : NULL;
    const bool encoded =
        info != NULL && encode(png, info, &state, file.stream, width, height, rgba);
    png_destroy_write_struct(&png, &info);
    if (!encoded) {
        girih_output_discard(&file);
        snprintf(message, message_size, "%s: cannot write PNG: %s", path, state.text);
        return false;
    }
    return girih_output_commit(&file, message, message_size);
}
