// The surface in baking; compiled once as it is and once with GIRIH_FEW_BUFFERS.
#version 450
#extension GL_GOOGLE_include_directive : require

#define GIRIH_BAKE
#include "girih.glsl"
#include "surface.glsl"
