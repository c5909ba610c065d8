// The host's shading: colour and motion.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "displace.glsl"
#include "motion.glsl"
#include "view.glsl"

layout(location = 0) in vec3 normal;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 now;
layout(location = 3) in vec4 before;
layout(location = 0) out vec4 colour;
layout(location = 1) out vec2 motion;

void main() {
    vec3 n = normalize(normal);
    float height = girih_height(relief, uv * vec2(8.0, 4.0));
    vec3 paint = mix(vec3(0.05, 0.35, 0.4), vec3(0.9, 0.75, 0.5), smoothstep(0.4, 0.55, height));
    vec3 light = vec3(0.2, 0.22, 0.28) * (0.5 + 0.5 * n.y) +
                 vec3(0.9, 0.85, 0.75) * max(dot(n, normalize(vec3(1.0, 2.0, 1.5))), 0.0);
    colour = vec4(pow(paint * light, vec3(1.0 / 2.2)), 1.0);
    motion = motion_between(before, now);
}
