#include "error.h"

#include <stdarg.h>
#include <stdio.h>

girih_result girih_fail(girih_error *error, girih_result result, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        error->result = result;
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return result;
}
