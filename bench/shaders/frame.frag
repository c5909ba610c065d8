#version 450

layout(constant_id = 100) const bool bench_cylindrical = false;

layout(location = 0) in vec3 bench_normal;
layout(location = 2) in float bench_front;
layout(location = 0) out vec4 color;

void main() {
    if (bench_cylindrical && bench_front < 0.0) {
        discard;
    }
    color = vec4(vec3(0.2 + 0.8 * max(dot(normalize(bench_normal), vec3(0.36, 0.48, 0.8)), 0.0)), 1.0);
}
