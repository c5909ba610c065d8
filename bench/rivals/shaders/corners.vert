// Corners as they are, for the stages behind.
#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 corner_position;
layout(location = 1) out vec3 corner_normal;

void main() {
    corner_position = position;
    corner_normal = normal;
}
