// How the library fills a girih_error.
#ifndef GIRIH_ENGINE_ERROR_H
#define GIRIH_ENGINE_ERROR_H

#include <stdio.h>

#include "girih/result.h"

// Stores result and the formatted message where error is not NULL, and returns result, so that a
// failing function ends with `return girih_fail(error, ..., "...")`.
#if defined(__MINGW_PRINTF_FORMAT) // C11's conversions, where Windows' own printf lacks some
__attribute__((format(__MINGW_PRINTF_FORMAT, 3, 4)))
#elif defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
girih_result
girih_fail(girih_error *error, girih_result result, const char *format, ...);

#endif
