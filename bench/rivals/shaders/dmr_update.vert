// DMR, pass 2: a vertex of the previous frame's intermediate mesh.
#version 450

layout(location = 0) in uvec2 in_subtriangle; // i, j
layout(location = 0) flat out uvec2 subtriangle;

void main() {
    subtriangle = in_subtriangle;
}
