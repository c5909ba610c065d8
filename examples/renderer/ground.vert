// The host's own geometry: a square of two triangles, from nothing but the vertex's number.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "view.glsl"

layout(location = 0) out vec3 position;
layout(location = 1) out vec4 now;
layout(location = 2) out vec4 before;

void main() {
    const vec2 corners[6] = vec2[](vec2(-1, -1), vec2(-1, 1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(1, -1));
    vec2 corner = corners[gl_VertexIndex] * 12.0;
    position = vec3(corner.x, -1.0, corner.y);
    now = view.world_to_clip * vec4(position, 1.0);
    before = view.previous_world_to_clip * vec4(position, 1.0);
    gl_Position = now;
}
