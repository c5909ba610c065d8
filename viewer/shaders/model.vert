// model.glsl with a surface of the library's own. Of the user's surfaces, the program compiles it
// while it runs.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "model.glsl"
