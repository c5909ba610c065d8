// The built-in catalogues: bytes that girih-patterns generated and embedded while girih was built.
// They were opened with all checks when they were embedded, so they are not checked again.
#include "girih/catalogue.h"

extern const uint64_t girih_builtin_dyadic[];
extern const uint64_t girih_builtin_linear[];

const girih_catalogue *girih_catalogue_dyadic(void) {
    return (const void *)girih_builtin_dyadic;
}

const girih_catalogue *girih_catalogue_linear(void) {
    return (const void *)girih_builtin_linear;
}
