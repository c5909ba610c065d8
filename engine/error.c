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
        // Names from files can hold anything; a message is one line.
        for (char *c = error->message; *c; ++c) {
            *c = (unsigned char)*c < ' ' || *c == 0x7f ? ' ' : *c;
        }
    }
    return result;
}
