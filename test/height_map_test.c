// Height maps: exact texels from every kind of PNG and OpenEXR file, and one clear line for files
// that cannot be read.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <OpenEXR/openexr.h>
#include <libpng16/png.h>

#include "folder.h"
#include "height_map.h"

enum { WIDTH = 62, HEIGHT = 20 };

static girih_error failure;

static girih_height_map load(const char *name) {
    girih_height_map map;
    failure = (girih_error){0};
    if (girih_height_map_load(folder_path(name), &map, &failure) != GIRIH_OK) {
        fail_msg("%s", failure.message);
    }
    return map;
}

static void assert_refused(const char *name, girih_result result, const char *words) {
    girih_height_map map;
    failure = (girih_error){0};
    girih_result got = girih_height_map_load(folder_path(name), &map, &failure);
    if (got == GIRIH_OK || strstr(failure.message, words) == NULL) {
        fail_msg("expected a refusal with '%s', got '%s'", words,
                 got == GIRIH_OK ? "a map" : failure.message);
    }
    assert_int_equal(got, result);
    assert_int_equal(failure.result, result);
    assert_non_null(strstr(failure.message, name));
    assert_null(strchr(failure.message, '\n'));
    assert_null(map.texels);
    assert_null(strstr(failure.message, "height map height map"));
}

// --- PNG ---

static uint32_t sample_at(uint32_t x, uint32_t y, uint32_t channel, int bits) {
    uint32_t mixed = (x * 2654435761u) ^ (y * 40503u * 65537u) ^ (channel * 97u);
    mixed ^= mixed >> 15;
    return (mixed * 2246822519u >> 16) & ((1u << bits) - 1);
}

static void write_png(const char *name, int color, int bits, int interlace) {
    FILE *stream = fopen(folder_path(name), "wb");
    assert_non_null(stream);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, stream);
    png_set_IHDR(png, info, WIDTH, HEIGHT, bits, color, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_gAMA(png, info, 0.45455); // must change nothing
    if (color == PNG_COLOR_TYPE_PALETTE) {
        png_color palette[256];
        png_byte alphas[256];
        for (int n = 0; n < 1 << bits; n++) {
            palette[n] = (png_color){(png_byte)(255 - 7 * n), (png_byte)n, (png_byte)(3 * n)};
            alphas[n] = (png_byte)(n * 5);
        }
        png_set_PLTE(png, info, palette, 1 << bits);
        png_set_tRNS(png, info, alphas, 1 << bits, NULL);
    }
    png_write_info(png, info);
    uint32_t channels = png_get_channels(png, info);
    static uint8_t rows[HEIGHT][WIDTH * 8];
    png_bytep pointers[HEIGHT];
    memset(rows, 0, sizeof rows);
    for (uint32_t y = 0; y < HEIGHT; y++) {
        pointers[y] = rows[y];
        for (uint32_t x = 0; x < WIDTH; x++) {
            for (uint32_t c = 0; c < channels; c++) {
                uint32_t sample = sample_at(x, y, c, bits);
                uint32_t at = channels * x + c;
                if (bits == 16) {
                    rows[y][2 * at] = (uint8_t)(sample >> 8);
                    rows[y][2 * at + 1] = (uint8_t)sample;
                } else {
                    uint32_t bit = at * (uint32_t)bits;
                    rows[y][bit / 8] |= (uint8_t)(sample << (8 - (uint32_t)bits - bit % 8));
                }
            }
        }
    }
    png_write_image(png, pointers);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(stream), 0);
}

static void png_texels_are_exact(void **state) {
    (void)state;
    static const struct {
        int color, bits;
    } kinds[] = {
        {PNG_COLOR_TYPE_GRAY, 1},        {PNG_COLOR_TYPE_GRAY, 2},
        {PNG_COLOR_TYPE_GRAY, 4},        {PNG_COLOR_TYPE_GRAY, 8},
        {PNG_COLOR_TYPE_GRAY, 16},       {PNG_COLOR_TYPE_GRAY_ALPHA, 8},
        {PNG_COLOR_TYPE_GRAY_ALPHA, 16}, {PNG_COLOR_TYPE_RGB, 8},
        {PNG_COLOR_TYPE_RGB, 16},        {PNG_COLOR_TYPE_RGB_ALPHA, 8},
        {PNG_COLOR_TYPE_RGB_ALPHA, 16},  {PNG_COLOR_TYPE_PALETTE, 1},
        {PNG_COLOR_TYPE_PALETTE, 4},     {PNG_COLOR_TYPE_PALETTE, 8},
    };
    for (size_t n = 0; n < 2 * sizeof kinds / sizeof kinds[0]; n++) {
        int color = kinds[n / 2].color;
        int bits = kinds[n / 2].bits;
        write_png("map.png", color, bits, n % 2 == 0 ? PNG_INTERLACE_NONE : PNG_INTERLACE_ADAM7);
        girih_height_map map = load("map.png");
        assert_int_equal(map.width, WIDTH);
        assert_int_equal(map.height, HEIGHT);
        float minimum = 1e9f, maximum = -1e9f;
        for (uint32_t y = 0; y < HEIGHT; y++) {
            for (uint32_t x = 0; x < WIDTH; x++) {
                uint32_t sample = sample_at(x, y, 0, bits);
                double most = (1u << bits) - 1;
                if (color == PNG_COLOR_TYPE_PALETTE) {
                    sample = (uint8_t)(255 - 7 * sample);
                    most = 255;
                }
                float expected = (float)(sample / most);
                float got = map.texels[WIDTH * y + x];
                if (got != expected) {
                    fail_msg("colour type %d, %d bits, texel %u,%u: %.9g instead of %.9g", color,
                             bits, x, y, (double)got, (double)expected);
                }
                minimum = fminf(minimum, expected);
                maximum = fmaxf(maximum, expected);
            }
        }
        assert_true(map.minimum == minimum && map.maximum == maximum);
        girih_height_map_free(&map);
        assert_null(map.texels);
    }
}

// --- OpenEXR ---

typedef struct exr_kind {
    exr_pixel_type_t type;
    exr_compression_t compression;
    uint32_t tile; // 0: scanlines
    exr_lineorder_t order;
    const char *channels[4]; // in the order of the file, which is the alphabet's
    int32_t origin;          // of both windows
    int32_t crop;            // texels by which the display window is wider
} exr_kind;

// Exact in half too. Alike in runs, so that every line gets smaller when compressed:
// OpenEXRCore 3.1 writes lines wrongly that do not.
static float exr_value(const exr_kind *kind, int channel, uint32_t x, uint32_t y) {
    float value = (float)(channel * 500 + (int)(y * 8 + x / 8)) - 40.0f;
    return kind->type == EXR_PIXEL_UINT ? value + 40.0f : value * 0.25f;
}

// Half bits of a normal number that half holds exactly, or 0.
static uint16_t half_bits(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    if ((word & 0x7fffffff) == 0) {
        return (uint16_t)(word >> 16);
    }
    uint32_t exponent = (word >> 23 & 255) - 127 + 15;
    assert_true(isfinite(value) ? exponent > 0 && exponent < 31 && (word & 0x1fff) == 0 : true);
    return (uint16_t)((word >> 16 & 0x8000) | exponent << 10 | (word >> 13 & 0x3ff));
}

static void encode(exr_context_t context, const exr_kind *kind, const exr_chunk_info_t *chunk,
                   uint32_t left, uint32_t top, uint32_t bad) {
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    assert_int_equal(exr_encoding_initialize(context, 0, chunk, &pipeline), EXR_ERR_SUCCESS);
    int32_t bytes = kind->type == EXR_PIXEL_HALF ? 2 : 4;
    static uint8_t texels[4][WIDTH * HEIGHT * 4];
    for (int c = 0; c < pipeline.channel_count; c++) {
        for (uint32_t y = 0; y < (uint32_t)chunk->height; y++) {
            for (uint32_t x = 0; x < (uint32_t)chunk->width; x++) {
                float value = exr_value(kind, c, left + x, top + y);
                if (bad != 0 && left + x == 5 && top + y == 3) {
                    memcpy(&value, &bad, sizeof value);
                }
                uint32_t word = (uint32_t)value;
                uint16_t half = half_bits(kind->type == EXR_PIXEL_HALF ? value : 0.0f);
                memcpy(texels[c] + (size_t)bytes * (y * (uint32_t)chunk->width + x),
                       kind->type == EXR_PIXEL_HALF   ? (void *)&half
                       : kind->type == EXR_PIXEL_UINT ? (void *)&word
                                                      : (void *)&value,
                       (size_t)bytes);
            }
        }
        pipeline.channels[c].encode_from_ptr = texels[c];
        pipeline.channels[c].user_pixel_stride = bytes;
        pipeline.channels[c].user_line_stride = bytes * chunk->width;
    }
    assert_int_equal(exr_encoding_choose_default_routines(context, 0, &pipeline), EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_run(context, 0, &pipeline), EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_destroy(context, &pipeline), EXR_ERR_SUCCESS);
}

// bad: 0, or the bits of what texel 5,3 is instead.
static void write_exr(const char *name, const exr_kind *kind, uint32_t bad) {
    exr_context_t context;
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    int part;
    assert_int_equal(
        exr_start_write(&context, folder_path(name), EXR_WRITE_FILE_DIRECTLY, &initializer),
        EXR_ERR_SUCCESS);
    assert_int_equal(exr_add_part(context, "height",
                                  kind->tile != 0 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                                  &part),
                     EXR_ERR_SUCCESS);
    exr_attr_v2f_t center = {0};
    exr_attr_box2i_t data;
    data.min.x = data.min.y = kind->origin;
    data.max.x = kind->origin + WIDTH - 1;
    data.max.y = kind->origin + HEIGHT - 1;
    exr_attr_box2i_t display = data;
    display.max.x += kind->crop;
    assert_int_equal(exr_initialize_required_attr(context, 0, &display, &data, 1.0f, &center, 1.0f,
                                                  kind->order, kind->compression),
                     EXR_ERR_SUCCESS);
    for (int c = 0; c < 4 && kind->channels[c] != NULL; c++) {
        assert_int_equal(exr_add_channel(context, 0, kind->channels[c], kind->type,
                                         EXR_PERCEPTUALLY_LINEAR, 1, 1),
                         EXR_ERR_SUCCESS);
    }
    if (kind->tile != 0) {
        assert_int_equal(exr_set_tile_descriptor(context, 0, kind->tile, kind->tile,
                                                 EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN),
                         EXR_ERR_SUCCESS);
    }
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    uint32_t step = kind->tile;
    if (step == 0) {
        int32_t lines;
        assert_int_equal(exr_get_scanlines_per_chunk(context, 0, &lines), EXR_ERR_SUCCESS);
        for (uint32_t y = 0; y < HEIGHT; y += (uint32_t)lines) {
            exr_chunk_info_t chunk;
            assert_int_equal(
                exr_write_scanline_chunk_info(context, 0, kind->origin + (int32_t)y, &chunk),
                EXR_ERR_SUCCESS);
            encode(context, kind, &chunk, 0, y, bad);
        }
    }
    for (uint32_t y = 0; y < HEIGHT && step != 0; y += step) {
        for (uint32_t x = 0; x < WIDTH; x += step) {
            exr_chunk_info_t chunk;
            assert_int_equal(exr_write_tile_chunk_info(context, 0, (int)(x / step), (int)(y / step),
                                                       0, 0, &chunk),
                             EXR_ERR_SUCCESS);
            encode(context, kind, &chunk, x, y, bad);
        }
    }
    assert_int_equal(exr_finish(&context), EXR_ERR_SUCCESS);
}

static void assert_exr_exact(const exr_kind *kind, int channel) {
    write_exr("map.exr", kind, 0);
    girih_height_map map = load("map.exr");
    assert_int_equal(map.width, WIDTH);
    assert_int_equal(map.height, HEIGHT);
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            float expected = exr_value(kind, channel, x, y);
            float got = map.texels[WIDTH * y + x];
            if (got != expected) {
                fail_msg("type %d, compression %d, tiles of %u, texel %u,%u: %.9g instead of %.9g",
                         kind->type, kind->compression, kind->tile, x, y, (double)got,
                         (double)expected);
            }
        }
    }
    assert_true(map.minimum == exr_value(kind, channel, 0, 0));
    assert_true(map.maximum == exr_value(kind, channel, WIDTH - 1, HEIGHT - 1));
    girih_height_map_free(&map);
}

static void exr_texels_are_exact(void **state) {
    (void)state;
    static const exr_pixel_type_t types[] = {EXR_PIXEL_HALF, EXR_PIXEL_FLOAT, EXR_PIXEL_UINT};
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE,
                                                     EXR_COMPRESSION_ZIPS, EXR_COMPRESSION_ZIP,
                                                     EXR_COMPRESSION_PIZ};
    for (int type = 0; type < 3; type++) {
        for (int compression = 0; compression < 5; compression++) {
            for (uint32_t tile = 0; tile <= 16; tile += 16) {
                exr_kind kind = {types[type],
                                 compressions[compression],
                                 tile,
                                 EXR_LINEORDER_INCREASING_Y,
                                 {"Y"},
                                 0,
                                 0};
                assert_exr_exact(&kind, 0);
                kind.origin = -7;
                assert_exr_exact(&kind, 0);
            }
        }
    }
}

static void exr_channel_is_chosen(void **state) {
    (void)state;
    exr_kind kind = {EXR_PIXEL_FLOAT,
                     EXR_COMPRESSION_ZIP,
                     0,
                     EXR_LINEORDER_INCREASING_Y,
                     {"B", "G", "R", "Y"},
                     0,
                     0};
    assert_exr_exact(&kind, 3);
    kind.channels[3] = NULL;
    assert_exr_exact(&kind, 2);
    kind.channels[2] = NULL;
    assert_exr_exact(&kind, 0);
}

static void exr_refusals(void **state) {
    (void)state;
    exr_kind kind = {
        EXR_PIXEL_FLOAT, EXR_COMPRESSION_NONE, 0, EXR_LINEORDER_INCREASING_Y, {"Y"}, 0, 0};
    write_exr("nan.exr", &kind, 0x7fc00000);
    assert_refused("nan.exr", GIRIH_ERROR_INVALID_DATA, "the texel at 5,3 is not a number");
    write_exr("infinite.exr", &kind, 0xff800000);
    assert_refused("infinite.exr", GIRIH_ERROR_INVALID_DATA, "the texel at 5,3 is infinite");
    kind.crop = 2;
    write_exr("cropped.exr", &kind, 0);
    assert_refused("cropped.exr", GIRIH_ERROR_INVALID_DATA, "without cropping");
    kind.crop = 0;
    write_exr("whole.exr", &kind, 0);
    size_t size;
    unsigned char *bytes = folder_read(folder_path("whole.exr"), &size);
    unsigned char *channel = bytes; // name, type, linearity, then the sampling along x and y
    while (memcmp(channel, "chlist", 7) != 0) {
        channel++;
    }
    channel[7 + 4 + 2 + 4 + 4] = 2;
    folder_write("subsampled.exr", bytes, size);
    free(bytes);
    assert_refused("subsampled.exr", GIRIH_ERROR_INVALID_DATA, "channel Y is subsampled");
}

// --- Broken files ---

static void other_files_are_refused(void **state) {
    (void)state;
    assert_refused("none.png", GIRIH_ERROR_INVALID_DATA, "No such file");
    folder_write("empty.png", "", 0);
    assert_refused("empty.png", GIRIH_ERROR_INVALID_DATA, "neither a PNG nor an OpenEXR file");
    folder_write("text.exr", "P5 2 2 255\n", 11);
    assert_refused("text.exr", GIRIH_ERROR_INVALID_DATA, "neither a PNG nor an OpenEXR file");
    assert_refused(".", GIRIH_ERROR_INVALID_DATA, "is no regular file");
    assert_int_equal(mkfifo(folder_path("fifo.png"), 0600), 0);
    assert_refused("fifo.png", GIRIH_ERROR_INVALID_DATA, "is no regular file");
    // An IHDR of 16385 x 1 texels with its checksum.
    static const uint8_t wide[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x40\x01\0\0\0\x01\x08\0\0\0\0";
    uint8_t file[sizeof wide + 3];
    memcpy(file, wide, sizeof wide - 1);
    uint32_t sum = 0xffffffff;
    for (size_t n = 12; n < sizeof wide - 1; n++) {
        sum ^= file[n];
        for (int bit = 0; bit < 8; bit++) {
            sum = sum >> 1 ^ (sum & 1 ? 0xedb88320 : 0);
        }
    }
    for (int n = 0; n < 4; n++) {
        file[sizeof wide - 1 + (size_t)n] = (uint8_t)(~sum >> (24 - 8 * n));
    }
    size_t more = sizeof file;
    uint8_t whole[sizeof file + 12];
    memcpy(whole, file, more);
    memcpy(whole + more, "\0\0\0\0IDAT\x35\xaf\x06\x1e", 12); // an empty IDAT ends the header
    folder_write("wide.png", whole, sizeof whole);
    assert_refused("wide.png", GIRIH_ERROR_TOO_LARGE, "16385 x 1 texels are more than 16384");
}

// Every beginning of a good file: refused with one line, or, where only what follows the texels is
// gone, read.
static void beginnings_are_refused(void **state) {
    (void)state;
    static const char *const names[] = {"map.png", "interlaced.png", "map.exr", "tiled.exr"};
    write_png("map.png", PNG_COLOR_TYPE_GRAY, 16, PNG_INTERLACE_NONE);
    write_png("interlaced.png", PNG_COLOR_TYPE_RGB, 8, PNG_INTERLACE_ADAM7);
    exr_kind kind = {
        EXR_PIXEL_FLOAT, EXR_COMPRESSION_ZIP, 0, EXR_LINEORDER_INCREASING_Y, {"Y"}, 0, 0};
    write_exr("map.exr", &kind, 0);
    kind.tile = 16;
    kind.type = EXR_PIXEL_HALF;
    kind.compression = EXR_COMPRESSION_PIZ;
    write_exr("tiled.exr", &kind, 0);
    for (int file = 0; file < 4; file++) {
        size_t size;
        unsigned char *bytes = folder_read(folder_path(names[file]), &size);
        for (size_t kept = 0; kept < size; kept++) {
            folder_write("short", bytes, kept);
            assert_refused("short", GIRIH_ERROR_INVALID_DATA, kept < 4 ? "neither" : "");
        }
        free(bytes);
    }
}

// Files with a few bytes changed at random are read or refused with one line; sanitizers watch.
// GIRIH_TEST_DAMAGED_FILES=N tries N of each kind.
static void damaged_files_do_no_harm(void **state) {
    (void)state;
    static const char *const names[] = {"map.png", "interlaced.png", "map.exr", "tiled.exr"};
    const char *more = getenv("GIRIH_TEST_DAMAGED_FILES");
    uint32_t rounds = more != NULL ? (uint32_t)strtoul(more, NULL, 10) : 500;
    uint32_t random = 12345;
    for (int file = 0; file < 4; file++) {
        size_t size;
        unsigned char *bytes = folder_read(folder_path(names[file]), &size);
        unsigned char *changed = malloc(size);
        for (uint32_t round = 0; round < rounds; round++) {
            memcpy(changed, bytes, size);
            for (uint32_t n = 0; n < 1 + round % 4; n++) {
                random = random * 1664525u + 1013904223u;
                uint32_t at = (random >> 8) % (uint32_t)size;
                random = random * 1664525u + 1013904223u;
                uint32_t value =
                    (round & 4) != 0 ? random >> 24 : changed[at] ^ 1u << (random >> 29);
                changed[at] = (unsigned char)value;
            }
            folder_write("damaged", changed, size);
            girih_height_map map;
            failure = (girih_error){0};
            girih_result result = girih_height_map_load(folder_path("damaged"), &map, &failure);
            assert_true(result == GIRIH_OK ? map.texels != NULL : map.texels == NULL);
            assert_true(result == GIRIH_OK || failure.message[0] != '\0');
            assert_null(strchr(failure.message, '\n'));
            girih_height_map_free(&map);
        }
        free(changed);
        free(bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(png_texels_are_exact),     cmocka_unit_test(exr_texels_are_exact),
        cmocka_unit_test(exr_channel_is_chosen),    cmocka_unit_test(exr_refusals),
        cmocka_unit_test(other_files_are_refused),  cmocka_unit_test(beginnings_are_refused),
        cmocka_unit_test(damaged_files_do_no_harm),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
