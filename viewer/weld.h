// Vertices of a refined model that are the same become one.
#ifndef GIRIH_VIEWER_WELD_H
#define GIRIH_VIEWER_WELD_H

#include "girih/cpu.h"

#ifdef __cplusplus
extern "C" {
#endif

// Welds a baked output in place: vertices of one material whose position, normal and attributes
// have the same bits become one. Triangles stay in their order. Returns NULL, or why it could not.
const char *girih_weld(girih_cpu_output *output);

#ifdef __cplusplus
}
#endif
#endif
