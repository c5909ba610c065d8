// DMR, pass 1: a corner of an input triangle.
#version 450

layout(location = 0) in vec3 in_position;
layout(location = 0) out vec3 corner;

void main() {
    corner = in_position;
}
