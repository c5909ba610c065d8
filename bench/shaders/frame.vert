// One vertex of any method: girih's own point, or position and normal from buffers.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "girih.glsl"

layout(push_constant) uniform Camera {
    vec4 rows[4]; // world to clip
} camera;

layout(location = 0) out vec3 normal;

void main() {
    GirihPoint point = girih_point();
    vec4 position = vec4(point.position, 1.0);
    gl_Position = vec4(dot(camera.rows[0], position), dot(camera.rows[1], position), dot(camera.rows[2], position),
                       dot(camera.rows[3], position));
    normal = point.normal;
}
