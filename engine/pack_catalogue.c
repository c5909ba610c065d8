// A catalogue's patterns, vertices and replicated indices as the shaders read them.
#include "pack.h"

#include <inttypes.h>

#include "error.h"

// Copies of a pattern's indices in one baked draw.
//
// A full draw of R = GIRIH_DRAW_TRIANGLES / T copies of T triangles has more than half of
// GIRIH_DRAW_TRIANGLES: with R >= 2, R T > R / (R + 1) GIRIH_DRAW_TRIANGLES; with R <= 1, T itself
// has. So a material of N output triangles takes at most N / (GIRIH_DRAW_TRIANGLES / 2) full draws,
// and one that is not full for each range (frame.draws_per_material).
//
// Indices have 4 bytes, though 2 would do for most patterns: on lavapipe draws with indices of 2
// bytes take half a nanosecond longer for each index, which is up to an eighth of a whole frame.
static uint32_t replicas_of(const girih_base_pattern *pattern) {
    uint32_t replicas = GIRIH_DRAW_TRIANGLES / pattern->triangle_count;
    return replicas > 1 ? replicas : 1;
}

// Three distinct levels leave one permutation alone, which may be odd; all others have an even one.
static uint32_t ranges_of(const girih_base_pattern *pattern) {
    return pattern->levels[0] > pattern->levels[1] && pattern->levels[1] > pattern->levels[2] ? 2
                                                                                              : 1;
}

static uint64_t range_indices(const girih_base_pattern *pattern) {
    return (uint64_t)3 * pattern->triangle_count * replicas_of(pattern);
}

// A mirrored triangle (a, c, b) keeps its first corner.
static void write_range(uint32_t *words, const girih_catalogue *catalogue,
                        const girih_base_pattern *pattern, int mirrored) {
    const uint32_t order[3] = {0, mirrored ? 2 : 1, mirrored ? 1 : 2};
    const uint32_t replicas = replicas_of(pattern);
    const uint64_t replica_indices = (uint64_t)3 * pattern->triangle_count;
    for (uint32_t triangle = 0; triangle < pattern->triangle_count; ++triangle) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            uint32_t index =
                girih_catalogue_index(catalogue, pattern, 3 * triangle + order[corner]);
            uint32_t *target = words + (size_t)3 * triangle + corner;
            for (uint32_t replica = 0; replica < replicas; ++replica) {
                target[replica * replica_indices] = index + replica * pattern->vertex_count;
            }
        }
    }
}

// One copy of a range's triangles, two words each, for output.
static void write_triangles(uint32_t *words, const girih_catalogue *catalogue,
                            const girih_base_pattern *pattern, int mirrored) {
    const uint32_t order[3] = {0, mirrored ? 2 : 1, mirrored ? 1 : 2};
    for (uint32_t triangle = 0; triangle < pattern->triangle_count; ++triangle, words += 2) {
        uint64_t packed = 0;
        for (uint32_t corner = 0; corner < 3; ++corner) {
            packed |=
                (uint64_t)girih_catalogue_index(catalogue, pattern, 3 * triangle + order[corner])
                << (corner * GIRIH_TRIANGLE_BITS);
        }
        words[0] = (uint32_t)packed;
        words[1] = (uint32_t)(packed >> 32);
    }
}

typedef struct totals {
    uint64_t indices;
    uint64_t index_words; // rounded to an even number: the triangles come after them
    uint64_t triangles;
    uint32_t ranges;
} totals;

static girih_result sum_patterns(const girih_catalogue *catalogue, totals *sums,
                                 girih_error *error) {
    *sums = (totals){0};
    for (uint32_t rank = 0; rank < catalogue->pattern_count; ++rank) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        if (pattern->vertex_count - 2 > pattern->triangle_count) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "catalogue: %" PRIu32 " vertices of pattern %" PRIu32
                              " are more than its %" PRIu32 " triangles can use",
                              pattern->vertex_count, rank, pattern->triangle_count);
        }
        if (pattern->vertex_count > GIRIH_TRIANGLE_MASK + 1) {
            return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                              "catalogue: %" PRIu32 " vertices of pattern %" PRIu32
                              " are more than %u",
                              pattern->vertex_count, rank, GIRIH_TRIANGLE_MASK + 1);
        }
        sums->indices += range_indices(pattern) * ranges_of(pattern);
        sums->triangles += (uint64_t)pattern->triangle_count * ranges_of(pattern);
        sums->ranges += ranges_of(pattern);
    }
    sums->index_words = girih_ceiling_quotient(sums->indices, 2) * 2;
    if (sums->indices > UINT32_MAX || catalogue->vertex_count > UINT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "catalogue: %" PRIu64 " indices and %" PRIu64
                          " vertices are more than 32 bits can number",
                          sums->indices, catalogue->vertex_count);
    }
    return GIRIH_OK;
}

static void write_patterns(girih_arrays *arrays, const girih_catalogue *catalogue,
                           const totals *sums) {
    uint32_t *patterns = arrays->words[GIRIH_BIND_PATTERNS];
    uint32_t *range_ranks = patterns + (size_t)catalogue->pattern_count * GIRIH_PATTERN_WORDS;
    uint32_t *indices = arrays->words[GIRIH_BIND_PATTERN_INDICES];
    uint32_t index = 0;
    uint32_t triangle = (uint32_t)(sums->index_words / 2);
    uint32_t range = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; ++rank) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        uint32_t *words = patterns + (size_t)rank * GIRIH_PATTERN_WORDS;
        memcpy(words + GIRIH_PATTERN_SEGMENTS, pattern->segments, sizeof pattern->segments);
        words[GIRIH_PATTERN_VERTICES] = pattern->vertex_count;
        words[GIRIH_PATTERN_TRIANGLES] = pattern->triangle_count;
        words[GIRIH_PATTERN_FIRST_VERTEX] = pattern->first_vertex;
        words[GIRIH_PATTERN_RANGE] = range;
        words[GIRIH_PATTERN_REPLICAS] = replicas_of(pattern);
        words[GIRIH_PATTERN_CHUNKS] =
            (uint32_t)girih_ceiling_quotient(pattern->vertex_count, GIRIH_CHUNK_VERTICES);
        words[GIRIH_PATTERN_FIRST_TRIANGLE] = triangle;
        const uint32_t ranges = ranges_of(pattern);
        for (uint32_t mirrored = 0; mirrored < ranges; ++mirrored) {
            words[GIRIH_PATTERN_FIRST_MIRRORED] = index;
            if (!mirrored) {
                words[GIRIH_PATTERN_FIRST_INDEX] = index;
            }
            write_range(indices + index, catalogue, pattern, mirrored != 0);
            write_triangles(indices + 2 * (size_t)triangle, catalogue, pattern, mirrored != 0);
            triangle += pattern->triangle_count;
            index += (uint32_t)range_indices(pattern);
            range_ranks[range++] = rank;
        }
    }
}

girih_result girih_pack_catalogue(girih_arrays *arrays, const girih_catalogue *catalogue,
                                  girih_error *error) {
    totals sums;
    girih_result result = sum_patterns(catalogue, &sums, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const uint64_t pattern_words =
        (uint64_t)catalogue->pattern_count * GIRIH_PATTERN_WORDS + sums.ranges;
    result = girih_allocate_words(arrays, GIRIH_BIND_PATTERNS, pattern_words, error);
    if (result == GIRIH_OK) {
        result = girih_allocate_words(arrays, GIRIH_BIND_PATTERN_VERTICES, catalogue->vertex_count,
                                      error);
    }
    if (result == GIRIH_OK) {
        result = girih_allocate_words(arrays, GIRIH_BIND_PATTERN_INDICES,
                                      sums.index_words + 2 * sums.triangles, error);
    }
    if (result != GIRIH_OK) {
        girih_arrays_free(arrays, GIRIH_BIND_PATTERNS, GIRIH_BIND_PATTERN_INDICES + 1);
        return result;
    }
    write_patterns(arrays, catalogue, &sums);
    // The patterns' vertices stand one after another from the first pattern on.
    memcpy(arrays->words[GIRIH_BIND_PATTERN_VERTICES],
           girih_catalogue_vertices(catalogue, girih_catalogue_pattern(catalogue, 0)),
           (size_t)catalogue->vertex_count * sizeof(uint32_t));
    arrays->frame.level_count = catalogue->level_count;
    arrays->frame.linear_spacing = catalogue->spacing == GIRIH_SPACING_LINEAR;
    arrays->frame.pattern_count = catalogue->pattern_count;
    arrays->frame.range_count = sums.ranges;
    return GIRIH_OK;
}
