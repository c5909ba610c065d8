// One light.
#version 450

layout(location = 0) in vec3 normal;
layout(location = 0) out vec4 colour;

void main() {
    float light = max(dot(normalize(normal), normalize(vec3(1.0, 2.0, 2.0))), 0.0);
    colour = vec4(vec3(0.9, 0.5, 0.2) * (0.1 + 0.9 * light), 1.0);
}
