#include "family.h"

#include <stdlib.h>
#include <string.h>

#include <meshoptimizer.h>

#include "error.h"

static const girih_family *const families[] = {
    &girih_family_optimal,
    &girih_family_uniform,
    &girih_family_quadtri,
    &girih_family_semiuniform,
};

const girih_family *girih_family_at(uint32_t n) {
    return n < sizeof families / sizeof *families ? families[n] : NULL;
}

const girih_family *girih_family_find(const char *name) {
    for (uint32_t n = 0; girih_family_at(n); n++) {
        if (strcmp(name, girih_family_at(n)->name) == 0) {
            return girih_family_at(n);
        }
    }
    return NULL;
}

girih_result girih_pattern_build(const girih_family *family, const uint32_t segments[3], girih_pattern *pattern,
                                 girih_error *error) {
    girih_result result = family->build(family, segments, pattern, error);
    if (family->ordered) {
        return result;
    }
    const size_t index_count = (size_t)pattern->triangle_count * 3;
    uint32_t *ordered = result == GIRIH_OK ? malloc(index_count * sizeof *ordered) : NULL;
    if (ordered) {
        meshopt_optimizeVertexCache(ordered, pattern->indices, index_count, pattern->vertex_count);
        free(pattern->indices);
        pattern->indices = ordered;
    } else if (result == GIRIH_OK) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu indices", index_count);
    }
    return result;
}
