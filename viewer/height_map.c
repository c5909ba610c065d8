#include "height_map.h"

#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <OpenEXR/openexr.h>
#include <libpng16/png.h> // with its folder: <png.h> alone could mean this project's

#include "error.h"
#include "input_file.h"

// The file's bytes, and how far PNG's reader has come.
typedef struct source {
    char *bytes;
    size_t size, position;
} source;

static girih_result allocate_texels(girih_height_map *map, uint64_t width, uint64_t height,
                                    girih_error *error) {
    if (width == 0 || height == 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "is empty");
    }
    if (width > GIRIH_HEIGHT_MAP_MAX_SIDE || height > GIRIH_HEIGHT_MAP_MAX_SIDE) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "%llu x %llu texels are more than %u x %u: make it smaller",
                          (unsigned long long)width, (unsigned long long)height,
                          GIRIH_HEIGHT_MAP_MAX_SIDE, GIRIH_HEIGHT_MAP_MAX_SIDE);
    }
    map->width = (uint32_t)width;
    map->height = (uint32_t)height;
    map->texels = malloc((size_t)width * (size_t)height * sizeof *map->texels);
    return map->texels != NULL ? GIRIH_OK
                               : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

// --- PNG ---

typedef struct png_reader {
    jmp_buf jump;
    source *file;
    girih_height_map *map;
    uint8_t *rows;
    girih_error *error;
    girih_result result;
} png_reader;

static void png_failure(png_structp png, png_const_charp text) {
    png_reader *reader = png_get_error_ptr(png);
    reader->result = girih_fail(reader->error, GIRIH_ERROR_INVALID_DATA, "damaged PNG: %s", text);
    longjmp(reader->jump, 1);
}

static void png_nothing(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

static void png_take(png_structp png, png_bytep bytes, size_t size) {
    source *file = ((png_reader *)png_get_io_ptr(png))->file;
    if (size > file->size - file->position) {
        png_error(png, "the file ends too early");
    }
    memcpy(bytes, file->bytes + file->position, size);
    file->position += size;
}

static void take_row(float *texels, uint32_t width, const uint8_t *row, size_t channels, int bits) {
    for (size_t x = 0; x < width; x++) {
        if (bits == 16) {
            const uint8_t *sample = row + 2 * channels * x;
            texels[x] = (float)(sample[0] << 8 | sample[1]) / 65535.0f;
        } else {
            texels[x] = (float)row[channels * x] / 255.0f;
        }
    }
}

// What must outlive a jump lies in *reader, and nothing of this function's is used after one.
static void decode_png(png_structp png, png_infop info, png_reader *reader) {
    if (setjmp(reader->jump) != 0) {
        return;
    }
    png_set_read_fn(png, reader, png_take);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); // allocate_texels has its own line
    png_read_info(png, info);
    girih_height_map *map = reader->map;
    reader->result = allocate_texels(map, png_get_image_width(png, info),
                                     png_get_image_height(png, info), reader->error);
    if (reader->result != GIRIH_OK) {
        return;
    }
    if (png_get_color_type(png, info) == PNG_COLOR_TYPE_PALETTE) {
        png_set_palette_to_rgb(png);
    } else if (png_get_bit_depth(png, info) < 8) {
        png_set_expand_gray_1_2_4_to_8(png); // times 255, 85 or 17: the quotient stays
    }
    int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    size_t row_bytes = png_get_rowbytes(png, info);
    size_t channels = png_get_channels(png, info);
    int bits = png_get_bit_depth(png, info);
    // Interlaced pictures come in passes that fill all rows bit by bit.
    reader->rows = malloc(row_bytes * (passes > 1 ? map->height : 1));
    if (reader->rows == NULL) {
        reader->result = girih_fail(reader->error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
        return;
    }
    for (int pass = 1; pass <= passes; pass++) {
        for (size_t y = 0; y < map->height; y++) {
            uint8_t *row = reader->rows + (passes > 1 ? row_bytes * y : 0);
            png_read_row(png, row, NULL);
            if (pass == passes) {
                take_row(map->texels + map->width * y, map->width, row, channels, bits);
            }
        }
    }
    png_read_end(png, NULL);
}

static girih_result load_png(source *file, girih_height_map *map, girih_error *error) {
    png_reader reader = {.file = file, .map = map, .error = error, .result = GIRIH_OK};
    png_structp png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, png_failure, png_nothing);
    png_infop info = png != NULL ? png_create_info_struct(png) : NULL;
    if (info == NULL) {
        reader.result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        decode_png(png, info, &reader);
    }
    png_destroy_read_struct(&png, &info, NULL);
    free(reader.rows);
    return reader.result;
}

// --- OpenEXR ---

typedef struct exr_reader {
    const source *file;
    exr_context_t context;
    girih_height_map *map;
    exr_attr_box2i_t window;
    int channel;
    exr_pixel_type_t type;
    char reason[256];
} exr_reader;

static void exr_failure_line(exr_const_context_t context, exr_result_t code, const char *text) {
    (void)code;
    void *user = NULL;
    if (exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user != NULL) {
        exr_reader *reader = user;
        snprintf(reader->reason, sizeof reader->reason, "%s", text);
    }
}

static int64_t exr_size(exr_const_context_t context, void *user) {
    (void)context;
    return (int64_t)((const exr_reader *)user)->file->size;
}

static int64_t exr_take(exr_const_context_t context, void *user, void *bytes, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t failure) {
    (void)context;
    (void)failure;
    const source *file = ((const exr_reader *)user)->file;
    if (offset >= file->size) {
        return 0;
    }
    uint64_t there = file->size - offset;
    size_t count = (size_t)(size < there ? size : there);
    memcpy(bytes, file->bytes + offset, count);
    return (int64_t)count;
}

static girih_result exr_failure(const exr_reader *reader, exr_result_t code, girih_error *error) {
    if (code == EXR_ERR_OUT_OF_MEMORY) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "damaged OpenEXR: %s",
                      reader->reason[0] != '\0' ? reader->reason
                                                : exr_get_default_error_message(code));
}

static girih_result choose_channel(exr_reader *reader, girih_error *error) {
    const exr_attr_chlist_t *channels;
    exr_result_t code = exr_get_channels(reader->context, 0, &channels);
    if (code != EXR_ERR_SUCCESS) {
        return exr_failure(reader, code, error);
    }
    if (channels->num_channels < 1) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "has no channel");
    }
    static const char *const names[] = {"R", "Y"};
    for (int wanted = 0; wanted < 2; wanted++) {
        for (int n = 0; n < channels->num_channels; n++) {
            if (strcmp(channels->entries[n].name.str, names[wanted]) == 0) {
                reader->channel = n;
            }
        }
    }
    const exr_attr_chlist_entry_t *entry = &channels->entries[reader->channel];
    if (entry->x_sampling != 1 || entry->y_sampling != 1) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "channel %.100s is subsampled: save it at full resolution",
                          entry->name.str);
    }
    reader->type = entry->pixel_type;
    return GIRIH_OK;
}

// Decodes one chunk whose first texel is (x, y) of the map.
static exr_result_t decode_chunk(const exr_reader *reader, const exr_chunk_info_t *chunk,
                                 uint32_t x, uint32_t y) {
    const girih_height_map *map = reader->map;
    if (chunk->width < 0 || chunk->height < 0 || (uint32_t)chunk->width > map->width - x ||
        (uint32_t)chunk->height > map->height - y) {
        return EXR_ERR_BAD_CHUNK_LEADER;
    }
    exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t code = exr_decoding_initialize(reader->context, 0, chunk, &decode);
    if (code == EXR_ERR_SUCCESS && reader->channel >= decode.channel_count) {
        code = EXR_ERR_BAD_CHUNK_LEADER;
    }
    if (code == EXR_ERR_SUCCESS) {
        exr_coding_channel_info_t *channel = &decode.channels[reader->channel];
        channel->decode_to_ptr = (uint8_t *)(map->texels + (size_t)map->width * y + x);
        channel->user_data_type = reader->type == EXR_PIXEL_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = 4;
        channel->user_pixel_stride = 4;
        channel->user_line_stride = (int32_t)(4 * map->width);
        code = exr_decoding_choose_default_routines(reader->context, 0, &decode);
    }
    if (code == EXR_ERR_SUCCESS) {
        code = exr_decoding_run(reader->context, 0, &decode);
    }
    exr_decoding_destroy(reader->context, &decode);
    return code;
}

static exr_result_t decode_scanlines(const exr_reader *reader) {
    int32_t lines = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(reader->context, 0, &lines);
    if (code == EXR_ERR_SUCCESS && lines < 1) {
        code = EXR_ERR_BAD_CHUNK_LEADER;
    }
    for (uint32_t y = 0; y < reader->map->height && code == EXR_ERR_SUCCESS; y += (uint32_t)lines) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(reader->context, 0, reader->window.min.y + (int32_t)y,
                                            &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = decode_chunk(reader, &chunk, 0, y);
        }
    }
    return code;
}

static exr_result_t decode_tiles(const exr_reader *reader) {
    int32_t width = 0;
    int32_t height = 0;
    exr_result_t code = exr_get_tile_sizes(reader->context, 0, 0, 0, &width, &height);
    if (code == EXR_ERR_SUCCESS && (width < 1 || height < 1)) {
        code = EXR_ERR_BAD_CHUNK_LEADER;
    }
    for (uint32_t y = 0; y < reader->map->height && code == EXR_ERR_SUCCESS;
         y += (uint32_t)height) {
        for (uint32_t x = 0; x < reader->map->width && code == EXR_ERR_SUCCESS;
             x += (uint32_t)width) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(reader->context, 0, (int)(x / (uint32_t)width),
                                            (int)(y / (uint32_t)height), 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) {
                code = decode_chunk(reader, &chunk, x, y);
            }
        }
    }
    return code;
}

static girih_result decode_exr(exr_reader *reader, girih_error *error) {
    exr_storage_t storage;
    exr_attr_box2i_t display;
    exr_result_t code = exr_get_storage(reader->context, 0, &storage);
    if (code == EXR_ERR_SUCCESS) {
        code = exr_get_data_window(reader->context, 0, &reader->window);
    }
    if (code == EXR_ERR_SUCCESS) {
        code = exr_get_display_window(reader->context, 0, &display);
    }
    if (code != EXR_ERR_SUCCESS) {
        return exr_failure(reader, code, error);
    }
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "is a deep OpenEXR file, which holds no one height for a texel");
    }
    const exr_attr_box2i_t *window = &reader->window;
    if (memcmp(window, &display, sizeof display) != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "its data window is not its display window: save it without cropping");
    }
    girih_result result = choose_channel(reader, error);
    if (result == GIRIH_OK) {
        result =
            allocate_texels(reader->map, (uint64_t)((int64_t)window->max.x - window->min.x + 1),
                            (uint64_t)((int64_t)window->max.y - window->min.y + 1), error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    code = storage == EXR_STORAGE_TILED ? decode_tiles(reader) : decode_scanlines(reader);
    if (code != EXR_ERR_SUCCESS) {
        return exr_failure(reader, code, error);
    }
    size_t count = (size_t)reader->map->width * reader->map->height;
    for (size_t n = 0; n < count && reader->type == EXR_PIXEL_UINT; n++) {
        uint32_t value;
        memcpy(&value, &reader->map->texels[n], sizeof value);
        reader->map->texels[n] = (float)value;
    }
    return GIRIH_OK;
}

static girih_result load_exr(const source *file, girih_height_map *map, girih_error *error) {
    exr_reader reader = {.file = file, .map = map};
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = exr_failure_line;
    initializer.user_data = &reader;
    initializer.read_fn = exr_take;
    initializer.size_fn = exr_size;
    // Searching a damaged file for chunks would only find part of the picture.
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t code = exr_start_read(&reader.context, "height map", &initializer);
    girih_result result =
        code == EXR_ERR_SUCCESS ? decode_exr(&reader, error) : exr_failure(&reader, code, error);
    exr_finish(&reader.context);
    return result;
}

// --- Both ---

static girih_result find_range(girih_height_map *map, girih_error *error) {
    map->minimum = map->maximum = map->texels[0];
    for (uint32_t y = 0; y < map->height; y++) {
        for (uint32_t x = 0; x < map->width; x++) {
            float texel = map->texels[(size_t)map->width * y + x];
            if (!isfinite(texel)) {
                return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "the texel at %u,%u is %s", x, y,
                                  isnan(texel) ? "not a number" : "infinite");
            }
            map->minimum = texel < map->minimum ? texel : map->minimum;
            map->maximum = texel > map->maximum ? texel : map->maximum;
        }
    }
    return GIRIH_OK;
}

girih_result girih_height_map_load(const char *path, girih_height_map *map, girih_error *error) {
    static const uint8_t png_mark[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    static const uint8_t exr_mark[4] = {0x76, 0x2f, 0x31, 0x01};
    *map = (girih_height_map){0};
    source file = {0};
    girih_error reason = {0};
    girih_result result = girih_input_read(path, &file.bytes, &file.size, &reason);
    if (result == GIRIH_OK) {
        if (file.size >= sizeof png_mark && memcmp(file.bytes, png_mark, sizeof png_mark) == 0) {
            result = load_png(&file, map, &reason);
        } else if (file.size >= sizeof exr_mark &&
                   memcmp(file.bytes, exr_mark, sizeof exr_mark) == 0) {
            result = load_exr(&file, map, &reason);
        } else {
            result = girih_fail(&reason, GIRIH_ERROR_INVALID_DATA,
                                "is neither a PNG nor an OpenEXR file");
        }
    }
    free(file.bytes);
    if (result == GIRIH_OK) {
        result = find_range(map, &reason);
    }
    if (result != GIRIH_OK) {
        girih_height_map_free(map);
        return girih_fail(error, result, "height map %.200s: %.280s", path, reason.message);
    }
    return GIRIH_OK;
}

void girih_height_map_free(girih_height_map *map) {
    free(map->texels);
    *map = (girih_height_map){0};
}
