// What a fragment wants to know of its triangle on the screen, for wireframes and for --shade density.
//
// Lines are drawn inside the triangles, by the distance from their edges in pixels (Baerentzen et al. 2006,
// "Single-pass Wireframe Rendering"): so they have one width, hide behind surfaces, and never fight with them for
// depth. In homogeneous coordinates p = (x, y, w) an edge's line is the cross product of its ends, and a point's
// distance from it dot(line, p) / (|line.xy| w). The dividend is 0 at both ends; at the third corner it is the
// determinant of all three. So it is interpolated, and the fragment divides by w: no corner is projected, and
// triangles may reach behind the viewer.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "picture.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) in vec3 in_position[];
layout(location = 1) in vec3 in_normal[];
layout(location = 2) in vec4 in_texcoord[];
layout(location = 3) in vec4 in_color[];
layout(location = 4) flat in vec3 in_range_color[];

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_texcoord;
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out vec3 out_range_color;
layout(location = 5) out vec3 out_edges;      // distances from the edges in pixels, times w
layout(location = 6) flat out vec2 out_size;  // area and smallest height in pixels

void main() {
    vec3 corners[3];
    for (int n = 0; n < 3; ++n) {
        corners[n] = vec3(gl_in[n].gl_Position.xy * picture.half_pixels, gl_in[n].gl_Position.w);
    }
    float determinant = abs(dot(corners[0], cross(corners[1], corners[2])));
    vec3 distances;
    vec2 size = vec2(1e9);
    bool is_before = min(min(corners[0].z, corners[1].z), corners[2].z) > 0.0;
    if (is_before) {
        size.x = 0.5 * determinant / (corners[0].z * corners[1].z * corners[2].z);
    }
    for (int n = 0; n < 3; ++n) {
        vec3 line = cross(corners[(n + 1) % 3], corners[(n + 2) % 3]);
        distances[n] = determinant / max(length(line.xy), 1e-20);
        if (is_before) {
            size.y = min(size.y, distances[n] / corners[n].z);
        }
    }
    for (int n = 0; n < 3; ++n) {
        gl_Position = gl_in[n].gl_Position;
        out_position = in_position[n];
        out_normal = in_normal[n];
        out_texcoord = in_texcoord[n];
        out_color = in_color[n];
        out_range_color = in_range_color[0];
        out_edges = vec3(0.0);
        out_edges[n] = distances[n];
        out_size = size;
        EmitVertex();
    }
}
