#include "family.h"

#include <string.h>

#include "order.h"

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
    const girih_result result = family->build(family, segments, pattern, error);
    return result == GIRIH_OK && !family->ordered ? girih_pattern_order(pattern, error) : result;
}
