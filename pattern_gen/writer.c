#define _GNU_SOURCE
#include "writer.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "error.h"
#include "output.h"
#include "parents_table.h"

#define MOST_THREADS 64u

// A pattern on its way from the thread that builds it to the file.
typedef struct slot {
    girih_pattern pattern;
    girih_result result;
    girih_error error;
    bool built;
} slot;

// Patterns are built in any order and written in the order of their ranks; a thread that is far ahead waits.
typedef struct workshop {
    const girih_family *family;
    const girih_base_pattern *patterns;
    uint32_t pattern_count;
    slot *slots; // of rank n: slot n % slot_count
    uint32_t slot_count;
    pthread_mutex_t mutex; // of what follows and of the slots' `built`
    pthread_cond_t built;
    pthread_cond_t written_one;
    uint32_t next; // rank to be built
    uint32_t written;
    bool stopped;
} workshop;

static uint64_t align(uint64_t offset, uint64_t alignment) {
    return (offset + alignment - 1) / alignment * alignment;
}

// What of the pattern table is known before anything is built.
static void name_patterns(const girih_catalogue *header, girih_base_pattern *pattern) {
    for (uint32_t i = 0; i < header->level_count; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++, pattern++) {
                const uint32_t levels[3] = {i, j, k};
                for (int edge = 0; edge < 3; edge++) {
                    pattern->levels[edge] = (uint8_t)levels[edge];
                    pattern->segments[edge] = girih_catalogue_segments(header, levels[edge]);
                }
            }
        }
    }
}

static girih_result write_at(FILE *stream, uint64_t offset, const void *bytes, size_t size,
                             girih_error *error) {
    if (fseeko(stream, (off_t)offset, SEEK_SET) != 0 || fwrite(bytes, 1, size, stream) != size) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot write the catalogue: %s",
                          strerror(errno));
    }
    return GIRIH_OK;
}

static void *build_patterns(void *data) {
    workshop *shop = data;
    pthread_mutex_lock(&shop->mutex);
    while (true) {
        while (!shop->stopped && shop->next < shop->pattern_count && shop->next >= shop->written + shop->slot_count) {
            pthread_cond_wait(&shop->written_one, &shop->mutex);
        }
        if (shop->stopped || shop->next == shop->pattern_count) {
            break;
        }
        const uint32_t rank = shop->next++;
        pthread_mutex_unlock(&shop->mutex);
        slot *mine = &shop->slots[rank % shop->slot_count];
        mine->result = girih_pattern_build(shop->family, shop->patterns[rank].segments, &mine->pattern, &mine->error);
        pthread_mutex_lock(&shop->mutex);
        mine->built = true;
        pthread_cond_broadcast(&shop->built);
    }
    pthread_mutex_unlock(&shop->mutex);
    return NULL;
}

// Vertices go to the catalogue, indices beside it: where they begin is known after the last vertex.
static girih_result write_pattern(girih_catalogue *header, girih_base_pattern *entry, const girih_pattern *pattern,
                                  uint64_t *index_bytes, FILE *stream, FILE *indices, girih_error *error) {
    if (header->vertex_count + pattern->vertex_count > UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "more than 2^32 vertices; use a smaller maximum");
    }
    entry->vertex_count = pattern->vertex_count;
    entry->triangle_count = pattern->triangle_count;
    entry->index_bytes = pattern->vertex_count > 65536 ? 4 : pattern->vertex_count > 256 ? 2 : 1;
    entry->first_vertex = (uint32_t)header->vertex_count;
    entry->index_offset = *index_bytes;
    girih_result result =
        write_at(stream, header->vertex_offset + header->vertex_count * sizeof(uint32_t), pattern->vertices,
                 pattern->vertex_count * sizeof(uint32_t), error);
    const size_t count = (size_t)pattern->triangle_count * 3;
    const size_t bytes = align(count * entry->index_bytes, 4);
    unsigned char *narrow = result == GIRIH_OK ? calloc(bytes, 1) : NULL;
    if (narrow) {
        for (size_t n = 0; n < count; n++) {
            for (size_t byte = 0; byte < entry->index_bytes; byte++) {
                narrow[n * entry->index_bytes + byte] = (unsigned char)(pattern->indices[n] >> (8 * byte));
            }
        }
        result = write_at(indices, *index_bytes, narrow, bytes, error);
        free(narrow);
    } else if (result == GIRIH_OK) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu indices", count);
    }
    header->vertex_count += pattern->vertex_count;
    header->triangle_count += pattern->triangle_count;
    *index_bytes += bytes;
    return result;
}

static girih_result write_patterns(workshop *shop, girih_catalogue *header, girih_base_pattern *patterns,
                                   uint64_t *index_bytes, FILE *stream, FILE *indices, girih_progress *progress,
                                   girih_error *error) {
    girih_result result = GIRIH_OK;
    for (uint32_t rank = 0; rank < header->pattern_count && result == GIRIH_OK; rank++) {
        slot *from = &shop->slots[rank % shop->slot_count];
        pthread_mutex_lock(&shop->mutex);
        while (!from->built) {
            pthread_cond_wait(&shop->built, &shop->mutex);
        }
        pthread_mutex_unlock(&shop->mutex);
        result = from->result;
        if (result == GIRIH_OK) {
            result = write_pattern(header, &patterns[rank], &from->pattern, index_bytes, stream, indices, error);
        } else if (error) {
            *error = from->error;
        }
        girih_pattern_free(&from->pattern);
        pthread_mutex_lock(&shop->mutex);
        from->built = false;
        shop->written++;
        pthread_cond_broadcast(&shop->written_one);
        pthread_mutex_unlock(&shop->mutex);
        if (progress) {
            progress(rank + 1, header->pattern_count);
        }
    }
    return result;
}

static girih_result build_and_write(const girih_family *family, girih_catalogue *header, girih_base_pattern *patterns,
                                    uint64_t *index_bytes, FILE *stream, FILE *indices, girih_progress *progress,
                                    girih_error *error) {
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const uint32_t wanted = processors < 1 ? 1 : processors > (long)MOST_THREADS ? MOST_THREADS : (uint32_t)processors;
    workshop shop = {
        .family = family,
        .patterns = patterns,
        .pattern_count = header->pattern_count,
        .slot_count = 4 * wanted,
        .mutex = PTHREAD_MUTEX_INITIALIZER,
        .built = PTHREAD_COND_INITIALIZER,
        .written_one = PTHREAD_COND_INITIALIZER,
    };
    shop.slots = calloc(shop.slot_count, sizeof *shop.slots);
    if (!shop.slots) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory to build patterns in");
    }
    pthread_t threads[MOST_THREADS];
    uint32_t thread_count = 0;
    while (thread_count < wanted && pthread_create(&threads[thread_count], NULL, build_patterns, &shop) == 0) {
        thread_count++;
    }
    girih_result result = thread_count > 0 ? write_patterns(&shop, header, patterns, index_bytes, stream, indices,
                                                            progress, error)
                                           : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no thread can be started");
    pthread_mutex_lock(&shop.mutex);
    shop.stopped = true;
    pthread_cond_broadcast(&shop.written_one);
    pthread_mutex_unlock(&shop.mutex);
    for (uint32_t n = 0; n < thread_count; n++) {
        pthread_join(threads[n], NULL);
    }
    for (uint32_t n = 0; n < shop.slot_count; n++) {
        girih_pattern_free(&shop.slots[n].pattern);
    }
    free(shop.slots);
    return result;
}

// From the beginning of one stream to a place in another.
static girih_result append(FILE *from, uint64_t bytes, FILE *to, uint64_t offset, girih_error *error) {
    char buffer[1 << 16];
    rewind(from);
    for (uint64_t done = 0; done < bytes;) {
        const size_t size = bytes - done < sizeof buffer ? (size_t)(bytes - done) : sizeof buffer;
        if (fread(buffer, 1, size, from) != size) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot read the indices back: %s", strerror(errno));
        }
        girih_result result = write_at(to, offset + done, buffer, size, error);
        if (result != GIRIH_OK) {
            return result;
        }
        done += size;
    }
    return GIRIH_OK;
}

// Parents take two patterns each, so they are found once all else is in the file, and written into its pages.
static girih_result write_parents(const girih_catalogue *header, FILE *stream, girih_error *error) {
    void *bytes = MAP_FAILED;
    if (fflush(stream) == 0) {
        bytes = mmap(NULL, header->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fileno(stream), 0);
    }
    if (bytes == MAP_FAILED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot map the catalogue: %s", strerror(errno));
    }
    uint32_t *parents = (uint32_t *)((char *)bytes + header->parent_offset);
    const girih_result result = girih_parents_fill(bytes, parents, error);
    munmap(bytes, header->bytes);
    return result;
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

static girih_result write_all(const girih_family *family, girih_catalogue *header, girih_base_pattern *patterns,
                              FILE *stream, girih_progress *progress, girih_error *error) {
    FILE *indices = tmpfile();
    if (!indices) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "no temporary file: %s", strerror(errno));
    }
    header->pattern_offset = sizeof *header;
    header->vertex_offset = header->pattern_offset + header->pattern_count * sizeof *patterns;
    uint64_t index_bytes = 0;
    girih_result result =
        build_and_write(family, header, patterns, &index_bytes, stream, indices, progress, error);
    header->parent_offset = header->vertex_offset + header->vertex_count * sizeof(uint32_t);
    const uint64_t index_offset = header->parent_offset + header->vertex_count * sizeof(uint32_t);
    header->bytes = align(index_offset + index_bytes, 8);
    for (uint32_t rank = 0; rank < header->pattern_count; rank++) {
        patterns[rank].index_offset += index_offset;
    }
    // What is left free at the end is zero.
    const uint64_t zero = 0;
    if (result == GIRIH_OK) {
        result = write_at(stream, header->bytes - sizeof zero, &zero, sizeof zero, error);
    }
    if (result == GIRIH_OK) {
        result = append(indices, index_bytes, stream, index_offset, error);
    }
    if (result == GIRIH_OK) {
        result = write_at(stream, 0, header, sizeof *header, error);
    }
    if (result == GIRIH_OK) {
        result = write_at(stream, header->pattern_offset, patterns,
                          header->pattern_count * sizeof *patterns, error);
    }
    if (result == GIRIH_OK) {
        result = write_parents(header, stream, error);
    }
    if (result == GIRIH_OK) {
        result = write_checksum(header, stream, error);
    }
    fclose(indices);
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
    name_patterns(&header, patterns);
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
