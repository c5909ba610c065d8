// A grid on the ground.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "motion.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec4 now;
layout(location = 2) in vec4 before;
layout(location = 0) out vec4 colour;
layout(location = 1) out vec2 motion;

void main() {
    vec2 distance_ = abs(fract(position.xz - 0.5) - 0.5);
    vec2 line = clamp(1.5 - distance_ / fwidth(position.xz), 0.0, 1.0);
    float fade = exp(-0.02 * dot(position.xz, position.xz));
    colour = vec4(mix(vec3(0.55), vec3(0.3 + 0.35 * max(line.x, line.y)), fade), 1.0);
    motion = motion_between(before, now);
}
