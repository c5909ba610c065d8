// How the library fills a girih_error.
#ifndef GIRIH_ENGINE_ERROR_H
#define GIRIH_ENGINE_ERROR_H

#include "girih/result.h"

// Stores result and the formatted message where error is not NULL, and returns result, so that a
// failing function ends with `return girih_fail(error, ..., "...")`.
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
girih_result
girih_fail(girih_error *error, girih_result result, const char *format, ...);

#endif
