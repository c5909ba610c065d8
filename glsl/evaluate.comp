// Stage 5: see evaluate.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "evaluate.glsl"
