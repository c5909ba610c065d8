// A light grey, a little darker below.
#version 450

layout(location = 0) in float in_height;
layout(location = 0) out vec4 out_color;

void main() {
    out_color = vec4(mix(vec3(0.62, 0.64, 0.67), vec3(0.90, 0.91, 0.92), in_height), 1.0);
}
