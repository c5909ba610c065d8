#define _GNU_SOURCE
#include "writer.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "error.h"
#include "output.h"

// Room for one pattern, the largest.
typedef struct workspace {
    uint32_t *vertices;
    uint32_t *indices;
    uint16_t *short_indices;
} workspace;

static uint64_t align(uint64_t offset, uint64_t alignment) {
    return (offset + alignment - 1) / alignment * alignment;
}

// The header and the pattern table, but for the checksum.
static void lay_out(const girih_family *family, girih_catalogue *header,
                    girih_base_pattern *patterns) {
    uint64_t indices = 0;
    girih_base_pattern *pattern = patterns;
    for (uint32_t i = 0; i < header->level_count; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++, pattern++) {
                const uint32_t levels[3] = {i, j, k};
                for (int edge = 0; edge < 3; edge++) {
                    pattern->levels[edge] = (uint8_t)levels[edge];
                    pattern->segments[edge] = girih_catalogue_segments(header, levels[edge]);
                }
                family->count(pattern->segments, &pattern->vertex_count, &pattern->triangle_count);
                pattern->index_bytes = pattern->vertex_count > 65536 ? 4 : 2;
                pattern->first_vertex = (uint32_t)header->vertex_count;
                pattern->index_offset = indices;
                indices += align(3ull * pattern->triangle_count * pattern->index_bytes, 4);
                header->vertex_count += pattern->vertex_count;
                header->triangle_count += pattern->triangle_count;
            }
        }
    }
    header->pattern_offset = sizeof *header;
    header->vertex_offset = header->pattern_offset + header->pattern_count * sizeof *patterns;
    uint64_t index_offset = header->vertex_offset + header->vertex_count * sizeof(uint32_t);
    for (uint32_t rank = 0; rank < header->pattern_count; rank++) {
        patterns[rank].index_offset += index_offset;
    }
    header->bytes = align(index_offset + indices, 8);
}

static girih_result write_at(FILE *stream, uint64_t offset, const void *bytes, size_t size,
                             girih_error *error) {
    if (fseeko(stream, (off_t)offset, SEEK_SET) != 0 || fwrite(bytes, 1, size, stream) != size) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot write the catalogue: %s",
                          strerror(errno));
    }
    return GIRIH_OK;
}

static girih_result write_pattern(const girih_family *family, const girih_catalogue *header,
                                  const girih_base_pattern *pattern, workspace *space, FILE *stream,
                                  girih_error *error) {
    girih_result result = girih_pattern_build(family, pattern->segments, space->vertices,
                                              space->indices, error);
    if (result == GIRIH_OK) {
        result = write_at(
            stream, header->vertex_offset + pattern->first_vertex * sizeof *space->vertices,
            space->vertices, pattern->vertex_count * sizeof *space->vertices, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    size_t count = (size_t)pattern->triangle_count * 3;
    const void *indices = space->indices;
    if (pattern->index_bytes == 2) {
        for (size_t n = 0; n < count; n++) {
            space->short_indices[n] = (uint16_t)space->indices[n];
        }
        indices = space->short_indices;
    }
    return write_at(stream, pattern->index_offset, indices, count * pattern->index_bytes, error);
}

// The checksum covers what is in the file, read back after everything else is written.
static girih_result write_checksum(girih_catalogue *header, FILE *stream, girih_error *error) {
    const size_t hashed = offsetof(girih_catalogue, checksum) + sizeof header->checksum;
    const size_t capacity = 1 << 20;
    unsigned char *buffer = malloc(capacity);
    XXH64_state_t *state = XXH64_createState();
    girih_result result = GIRIH_OK;
    if (!buffer || !state) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for the checksum");
    } else if (fseeko(stream, (off_t)hashed, SEEK_SET) != 0) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot write the catalogue: %s",
                            strerror(errno));
    } else {
        XXH64_reset(state, 0);
        for (size_t size; (size = fread(buffer, 1, capacity, stream)) > 0;) {
            XXH64_update(state, buffer, size);
        }
        header->checksum = XXH64_digest(state);
        result = write_at(stream, 0, header, sizeof *header, error);
    }
    XXH64_freeState(state);
    free(buffer);
    return result;
}

static girih_result write_all(const girih_family *family, girih_catalogue *header,
                              const girih_base_pattern *patterns, FILE *stream,
                              girih_progress *progress, girih_error *error) {
    // The largest pattern has the largest count on all edges, and the highest rank.
    const girih_base_pattern *largest = &patterns[header->pattern_count - 1];
    size_t index_count = (size_t)largest->triangle_count * 3;
    workspace space = {
        .vertices = malloc(largest->vertex_count * sizeof *space.vertices),
        .indices = malloc(index_count * sizeof *space.indices),
        .short_indices = malloc(index_count * sizeof *space.short_indices),
    };
    girih_result result = GIRIH_OK;
    if (!space.vertices || !space.indices || !space.short_indices) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for the largest pattern");
    }
    // What the tables leave free at the end is zero.
    const uint64_t zero = 0;
    if (result == GIRIH_OK) {
        result = write_at(stream, header->bytes - sizeof zero, &zero, sizeof zero, error);
    }
    if (result == GIRIH_OK) {
        result = write_at(stream, 0, header, sizeof *header, error);
    }
    if (result == GIRIH_OK) {
        result = write_at(stream, header->pattern_offset, patterns,
                          header->pattern_count * sizeof *patterns, error);
    }
    for (uint32_t rank = 0; rank < header->pattern_count && result == GIRIH_OK; rank++) {
        result = write_pattern(family, header, &patterns[rank], &space, stream, error);
        if (progress) {
            progress(rank + 1, header->pattern_count);
        }
    }
    if (result == GIRIH_OK) {
        result = write_checksum(header, stream, error);
    }
    free(space.short_indices);
    free(space.indices);
    free(space.vertices);
    return result;
}

girih_result girih_catalogue_write(const girih_family *family, girih_spacing spacing, uint32_t max,
                                   const char *path, girih_progress *progress, girih_error *error) {
    bool dyadic = spacing == GIRIH_SPACING_DYADIC;
    if (max > (dyadic ? GIRIH_LARGEST_DYADIC_LEVEL : GIRIH_LARGEST_LINEAR_COUNT) ||
        (!dyadic && max == 0)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "a maximum of %u is out of range for this spacing", max);
    }
    uint32_t levels = dyadic ? max + 1 : max;
    girih_catalogue header = {
        .magic = GIRIH_CATALOGUE_MAGIC,
        .version = GIRIH_CATALOGUE_VERSION,
        .header_bytes = sizeof header,
        .spacing = spacing,
        .max = max,
        .level_count = levels,
        .pattern_count = levels * (levels + 1) * (levels + 2) / 6,
    };
    memcpy(header.family, family->name, strlen(family->name));
    girih_base_pattern *patterns = calloc(header.pattern_count, sizeof *patterns);
    if (!patterns) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %u base patterns",
                          header.pattern_count);
    }
    lay_out(family, &header, patterns);
    girih_pattern_output output;
    girih_result result = girih_pattern_output_open(&output, path, error);
    if (result == GIRIH_OK) {
        result = write_all(family, &header, patterns, output.stream, progress, error);
        if (result == GIRIH_OK) {
            result = girih_pattern_output_commit(&output, error);
        } else {
            girih_pattern_output_discard(&output);
        }
    }
    free(patterns);
    return result;
}
