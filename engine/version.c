#include "girih/version.h"

uint32_t girih_version(void) {
    return GIRIH_VERSION;
}
