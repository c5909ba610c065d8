// Pictures out.
#ifndef GIRIH_VIEWER_PNG_H
#define GIRIH_VIEWER_PNG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Writes 8-bit RGBA pixels, 4 * width * height bytes, top row first, sRGB encoded, as a PNG. The
// file appears under path only when it is whole. Returns false and one line in message on failure.
bool girih_png_write(const char *path, uint32_t width, uint32_t height, const uint8_t *rgba,
                     char *message, size_t message_size);

#endif
