// The library's version, by Semantic Versioning (https://semver.org).
// Stability: stable
//
// Every public header says in its first lines how stable it is. While the major version is 0:
// - "Stability: stable": a program that compiles against 0.MINOR.0 compiles unchanged against every
//   later 0.MINOR.*. A new MINOR may ask for changes; CHANGELOG.md lists them.
// - "Stability: experimental": may change in any release.
// Programs that link the shared library are compiled anew for each release: its soname holds the
// whole version.
#ifndef GIRIH_VERSION_H
#define GIRIH_VERSION_H

#include <stdint.h>

#include "girih/result.h"

#ifdef __cplusplus
extern "C" {
#endif

// Of the headers that a program is compiled with.
#define GIRIH_VERSION_MAJOR 0
#define GIRIH_VERSION_MINOR 2
#define GIRIH_VERSION_PATCH 0

// One number that grows with every release.
#define GIRIH_MAKE_VERSION(MAJOR, MINOR, PATCH) ((MAJOR)*1000000u + (MINOR)*1000u + (PATCH))
#define GIRIH_VERSION                                                                              \
    GIRIH_MAKE_VERSION(GIRIH_VERSION_MAJOR, GIRIH_VERSION_MINOR, GIRIH_VERSION_PATCH)

// GIRIH_VERSION of the library that the program runs with. Thread-safe.
GIRIH_API uint32_t girih_version(void);

#ifdef __cplusplus
}
#endif
#endif
