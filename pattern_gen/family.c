#include "family.h"

#include <stdlib.h>
#include <string.h>

#include <meshoptimizer.h>

#include "error.h"

const girih_family *girih_family_find(const char *name) {
    return strcmp(name, girih_family_uniform.name) == 0 ? &girih_family_uniform : NULL;
}

girih_result girih_pattern_build(const girih_family *family, const uint32_t segments[3],
                                 uint32_t *vertices, uint32_t *indices, girih_error *error) {
    uint32_t vertex_count = 0;
    uint32_t triangle_count = 0;
    family->count(segments, &vertex_count, &triangle_count);
    size_t index_count = (size_t)triangle_count * 3;
    uint32_t *unordered = malloc(index_count * sizeof *unordered);
    if (!unordered) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu indices",
                          index_count);
    }
    girih_result result = family->build(segments, vertices, unordered, error);
    if (result == GIRIH_OK) {
        meshopt_optimizeVertexCache(indices, unordered, index_count, vertex_count);
    }
    free(unordered);
    return result;
}
