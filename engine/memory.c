#include "memory.h"

#include <stdint.h>
#include <stdlib.h>

static _Thread_local size_t allocations_left = SIZE_MAX;

void girih_allocation_failure_after(size_t count) {
    allocations_left = count;
}

void *girih_reallocate_array(void *memory, size_t count, size_t size) {
    if (size != 0 && count > SIZE_MAX / size) {
        return NULL;
    }
    if (allocations_left != SIZE_MAX) {
        if (allocations_left == 0) {
            return NULL;
        }
        --allocations_left;
    }
    size_t bytes = count * size;
    return realloc(memory, bytes ? bytes : 1);
}

void *girih_allocate_array(size_t count, size_t size) {
    return girih_reallocate_array(NULL, count, size);
}

void *girih_allocate(size_t size) {
    return girih_allocate_array(1, size);
}

void girih_free(const void *memory) {
    free((void *)memory);
}
