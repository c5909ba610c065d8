// Crack audit: edges by the exact bits of their end positions.
#ifndef GIRIH_VIEWER_AUDIT_H
#define GIRIH_VIEWER_AUDIT_H

#include "gltf.h"
#include "girih/result.h"

typedef struct girih_audit {
    uint64_t triangles;
    uint64_t open;        // edges of one triangle
    uint64_t nonmanifold; // edges of three or more triangles
    uint64_t flipped;     // edges of two triangles that run along them the same way
    uint64_t degenerate;  // triangles with two corners at one point; they take no part in the rest
} girih_audit;

// Audits a mesh, all of its primitives together. -0 equals +0. Time and memory are linear in the
// triangles: about 24 bytes a triangle and 12 a vertex at the peak.
girih_result girih_audit_mesh(const girih_gltf_mesh *mesh, girih_audit *audit, girih_error *error);

#endif
