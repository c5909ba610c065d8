// Catalogues of base patterns in memory: the checks of girih_catalogue_open and the accessors.
// doc/catalogue.md describes the format.
#include "girih/catalogue.h"

#include <inttypes.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "error.h"

// Tables are used where they lie, so the machine must read them as they are written.
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "catalogues are little-endian");
_Static_assert(sizeof(girih_catalogue) == 104, "the header has no padding");
_Static_assert(sizeof(girih_base_pattern) == 40, "a pattern has no padding");

// 2^15 segments, one per step of the barycentric denominator.
#define LARGEST_DYADIC_LEVEL 15u
// A pattern keeps its levels in one byte each.
#define LARGEST_LINEAR_COUNT 256u
// Vulkan 1.1 guarantees index values below 2^24 only.
#define LARGEST_VERTEX_COUNT (1u << 24)

static const void *at(const girih_catalogue *catalogue, uint64_t offset) {
    return (const unsigned char *)catalogue + offset;
}

// The end of a table of `count` entries of `stride` bytes at `offset`, 0 where it does not lie
// between `begin` and `end` or is not aligned to `alignment`.
static uint64_t table_end(uint64_t offset, uint64_t count, uint64_t stride, uint64_t alignment,
                          uint64_t begin, uint64_t end) {
    if (offset < begin || offset > end || offset % alignment != 0) {
        return 0;
    }
    return count <= (end - offset) / stride ? offset + count * stride : 0;
}

static girih_result check_header(const void *bytes, size_t size, girih_error *error) {
    const girih_catalogue *header = bytes;
    if (size < sizeof *header) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: %zu bytes are too short for the header of %zu", size,
                          sizeof *header);
    }
    if (header->magic != GIRIH_CATALOGUE_MAGIC) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: does not begin with GIRIHPAT, so it is no girih catalogue");
    }
    if (header->version != GIRIH_CATALOGUE_VERSION) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: format version %" PRIu32
                          ", only %u is known; generate it anew",
                          header->version, GIRIH_CATALOGUE_VERSION);
    }
    if (header->header_bytes != sizeof *header) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: a header of %" PRIu32 " bytes, expected %zu",
                          header->header_bytes, sizeof *header);
    }
    if (header->bytes != size) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: %zu bytes, its header says %" PRIu64, size, header->bytes);
    }
    size_t hashed = offsetof(girih_catalogue, checksum) + sizeof header->checksum;
    if (header->checksum != XXH64((const unsigned char *)bytes + hashed, size - hashed, 0)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: damaged, the checksum does not match");
    }
    uint32_t level_count = 0;
    if (header->spacing == GIRIH_SPACING_DYADIC && header->max <= LARGEST_DYADIC_LEVEL) {
        level_count = header->max + 1;
    } else if (header->spacing == GIRIH_SPACING_LINEAR && header->max <= LARGEST_LINEAR_COUNT) {
        level_count = header->max;
    }
    if (level_count == 0 || header->level_count != level_count) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: spacing %" PRIu32 ", maximum %" PRIu32 " and %" PRIu32
                          " levels do not go together",
                          header->spacing, header->max, header->level_count);
    }
    // ARKFPI, equation 2.
    if (header->pattern_count != level_count * (level_count + 1) * (level_count + 2) / 6) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: %" PRIu32 " base patterns do not fit %" PRIu32 " levels",
                          header->pattern_count, level_count);
    }
    if (memchr(header->family, 0, sizeof header->family) == NULL) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: the family's name does not end");
    }
    return GIRIH_OK;
}

// The largest index of a pattern whose indices lie within the catalogue.
static uint32_t largest_index(const girih_catalogue *catalogue, const girih_base_pattern *pattern) {
    uint32_t largest = 0;
    for (uint32_t n = 0; n < pattern->triangle_count * 3; n++) {
        const uint32_t index = girih_catalogue_index(catalogue, pattern, n);
        largest = index > largest ? index : largest;
    }
    return largest;
}

// `vertex` and `index_end` walk along: where this pattern's vertices and indices may begin.
static girih_result check_pattern(const girih_catalogue *catalogue, const uint32_t levels[3],
                                  const girih_base_pattern *pattern, uint64_t *vertex,
                                  uint64_t *index_end, girih_error *error) {
    const char *reason = NULL;
    uint64_t border = 0;
    for (int edge = 0; edge < 3; edge++) {
        uint32_t segments = girih_catalogue_segments(catalogue, levels[edge]);
        if (pattern->levels[edge] != levels[edge] || pattern->segments[edge] != segments) {
            reason = "levels or segments out of order";
        }
        border += segments;
    }
    uint32_t index_bytes = pattern->vertex_count > 65536 ? 4 : pattern->vertex_count > 256 ? 2 : 1;
    uint64_t end = 0;
    if (reason) {
        // The first reason is the one to tell.
    } else if (pattern->vertex_count < border || pattern->vertex_count > LARGEST_VERTEX_COUNT ||
               pattern->first_vertex != *vertex ||
               pattern->vertex_count > catalogue->vertex_count - *vertex) {
        reason = "vertices out of range";
    } else if (pattern->index_bytes != index_bytes || pattern->reserved != 0) {
        reason = "index size or reserved field wrong";
    } else {
        end = table_end(pattern->index_offset, (uint64_t)pattern->triangle_count * 3, index_bytes,
                        4, *index_end, catalogue->bytes);
        if (end == 0) {
            reason = "indices out of the catalogue";
        } else if (pattern->triangle_count == 0 || pattern->triangle_count > UINT32_MAX / 3) {
            reason = "number of triangles out of range";
        } else if (largest_index(catalogue, pattern) >= pattern->vertex_count) {
            reason = "an index beyond its vertices";
        }
    }
    if (reason) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]: %s", levels[0],
                          levels[1], levels[2], reason);
    }
    *vertex += pattern->vertex_count;
    *index_end = end;
    return GIRIH_OK;
}

// Whether all places of a table lie in their triangles.
static girih_result check_places(const girih_catalogue *catalogue, uint64_t offset,
                                 const char *name, girih_error *error) {
    const uint32_t *places = at(catalogue, offset);
    for (uint64_t n = 0; n < catalogue->vertex_count; n++) {
        if ((places[n] & 0xffff) + (places[n] >> 16) > GIRIH_BARYCENTRIC_ONE) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "catalogue: %s %" PRIu64 " lies outside its triangle", name, n);
        }
    }
    return GIRIH_OK;
}

static girih_result check_tables(const girih_catalogue *catalogue, girih_error *error) {
    uint64_t end = table_end(catalogue->pattern_offset, catalogue->pattern_count,
                             sizeof(girih_base_pattern), 8, sizeof *catalogue, catalogue->bytes);
    if (end != 0) {
        end = table_end(catalogue->vertex_offset, catalogue->vertex_count, sizeof(uint32_t), 4, end,
                        catalogue->bytes);
    }
    if (end != 0) {
        end = table_end(catalogue->parent_offset, catalogue->vertex_count, sizeof(uint32_t), 4, end,
                        catalogue->bytes);
    }
    if (end == 0) {
        return girih_fail(
            error, GIRIH_ERROR_INVALID_DATA,
            "catalogue: a table of patterns, vertices or parents lies out of the catalogue");
    }
    girih_result inside = check_places(catalogue, catalogue->vertex_offset, "vertex", error);
    if (inside == GIRIH_OK) {
        inside = check_places(catalogue, catalogue->parent_offset, "parent", error);
    }
    if (inside != GIRIH_OK) {
        return inside;
    }
    const girih_base_pattern *pattern = at(catalogue, catalogue->pattern_offset);
    uint64_t vertex = 0;
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < catalogue->level_count; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            for (uint32_t k = 0; k <= j; k++, pattern++) {
                const uint32_t levels[3] = {i, j, k};
                girih_result result =
                    check_pattern(catalogue, levels, pattern, &vertex, &end, error);
                if (result != GIRIH_OK) {
                    return result;
                }
                triangles += pattern->triangle_count;
            }
        }
    }
    if (vertex != catalogue->vertex_count || triangles != catalogue->triangle_count) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "catalogue: the patterns' vertices or triangles do not add up");
    }
    return GIRIH_OK;
}

girih_result girih_catalogue_open(const void *bytes, size_t size, const girih_catalogue **catalogue,
                                  girih_error *error) {
    if (!bytes || !catalogue) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "catalogue: a null pointer");
    }
    if ((uintptr_t)bytes % 8 != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "catalogue: the bytes are not aligned to 8");
    }
    girih_result result = check_header(bytes, size, error);
    if (result == GIRIH_OK) {
        result = check_tables(bytes, error);
    }
    if (result == GIRIH_OK) {
        *catalogue = bytes;
    }
    return result;
}

const girih_base_pattern *girih_catalogue_pattern(const girih_catalogue *catalogue, uint32_t rank) {
    const girih_base_pattern *patterns = at(catalogue, catalogue->pattern_offset);
    return patterns + rank;
}

const uint32_t *girih_catalogue_vertices(const girih_catalogue *catalogue,
                                         const girih_base_pattern *pattern) {
    const uint32_t *vertices = at(catalogue, catalogue->vertex_offset);
    return vertices + pattern->first_vertex;
}

const uint32_t *girih_catalogue_parents(const girih_catalogue *catalogue,
                                        const girih_base_pattern *pattern) {
    const uint32_t *parents = at(catalogue, catalogue->parent_offset);
    return parents + pattern->first_vertex;
}

uint32_t girih_catalogue_index(const girih_catalogue *catalogue, const girih_base_pattern *pattern,
                               uint32_t n) {
    if (pattern->index_bytes == 1) {
        return ((const uint8_t *)at(catalogue, pattern->index_offset))[n];
    }
    if (pattern->index_bytes == 2) {
        return ((const uint16_t *)at(catalogue, pattern->index_offset))[n];
    }
    return ((const uint32_t *)at(catalogue, pattern->index_offset))[n];
}

uint32_t girih_catalogue_segments(const girih_catalogue *catalogue, uint32_t level) {
    return catalogue->spacing == GIRIH_SPACING_DYADIC ? 1u << level : level + 1;
}

uint32_t girih_catalogue_level(const girih_catalogue *catalogue, uint32_t segments, int *clamped) {
    uint32_t last = catalogue->level_count - 1;
    uint32_t level = 0;
    if (catalogue->spacing == GIRIH_SPACING_LINEAR) {
        level = segments == 0 ? 0 : segments - 1;
        level = level < last ? level : last;
    } else {
        while (level < last && girih_catalogue_segments(catalogue, level) < segments) {
            level++;
        }
    }
    if (clamped) {
        *clamped = girih_catalogue_segments(catalogue, level) < segments;
    }
    return level;
}
