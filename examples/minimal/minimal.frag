// One light: on the left the surface's normals, on the right those of the facets.
#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec4 colour;

void main() {
    vec3 n = position.x < 0.0 ? normal : cross(dFdy(position), dFdx(position));
    float light = max(dot(normalize(n), normalize(vec3(1.0, 2.0, 2.0))), 0.0);
    colour = vec4(vec3(0.9, 0.5, 0.2) * (0.15 + 0.85 * light), 1.0);
}
