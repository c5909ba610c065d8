// Vertices of a refined model that are the same become one.
#ifndef GIRIH_VIEWER_WELD_H
#define GIRIH_VIEWER_WELD_H

#include "girih/cpu.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GIRIH_WELD_KEY_WORDS 5

// Welds a baked output in place: vertices of one material become one, the first of them, where
// their keys [output_vertices] are equal; where keys is NULL, where position, normal and attributes
// have the same bits. Triangles stay in their order; triangles [output_vertices], a word of each
// vertex, which may be NULL, goes with the vertices. Returns NULL, or why it could not.
const char *girih_weld(girih_cpu_output *output, const uint32_t (*keys)[GIRIH_WELD_KEY_WORDS],
                       uint32_t *triangles);

#ifdef __cplusplus
}
#endif
#endif
