// Every allocation of the library's own passes through here, so that sizes are checked in one place
// and tests can make any one of them fail.
#ifndef GIRIH_ENGINE_MEMORY_H
#define GIRIH_ENGINE_MEMORY_H

#include <stddef.h>

// Uninitialised memory, to be freed with girih_free; NULL if there is none. A size of 0 gives a
// pointer that is not NULL, so NULL always means failure.
void *girih_allocate(size_t size);

// As girih_allocate for count * size bytes; NULL if the product overflows.
void *girih_allocate_array(size_t count, size_t size);

// As realloc for count * size bytes. On failure NULL, and memory stays as it was.
void *girih_reallocate_array(void *memory, size_t count, size_t size);

// Takes NULL. Takes const memory too: what a caller may only read is still the library's to free.
void girih_free(const void *memory);

// For tests: on the calling thread the next count allocations may succeed and all later ones fail,
// until it is called again. SIZE_MAX, the state at first: none is made to fail.
void girih_allocation_failure_after(size_t count);

#endif
