// Stage 2, one invocation a triangle.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#define GIRIH_LOCAL_SIZE GIRIH_LARGE_WORKGROUP
#include "select.glsl"

void main() {
    uint triangle = girih_invocation();
    if (triangle < girih_frame.triangle_count) {
        write_key(triangle);
    }
}
