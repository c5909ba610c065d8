// Stage 1, one invocation an edge.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#define GIRIH_LOCAL_SIZE GIRIH_LARGE_WORKGROUP
#include "levels.glsl"

void main() {
    uint edge = girih_invocation();
    if (edge < girih_frame.edge_count) {
        write_level(edge);
    }
}
