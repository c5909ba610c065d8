// What every method's shaders share: the view and the levels of the frame (set 0), and a vertex put out.
#ifndef BENCH_VIEW_GLSL
#define BENCH_VIEW_GLSL

layout(std140, set = 0, binding = 0) uniform BenchView {
    vec4 rows[4]; // world to clip
} bench_view;

vec4 bench_clip(vec3 position) {
    vec4 p = vec4(position, 1.0);
    return vec4(dot(bench_view.rows[0], p), dot(bench_view.rows[1], p), dot(bench_view.rows[2], p),
                dot(bench_view.rows[3], p));
}

// In the last stage before the rasteriser: BENCH_LAST. Captured, it writes position and normal.
#ifdef BENCH_LAST
#ifdef BENCH_CAPTURE
layout(location = 0, xfb_buffer = 0, xfb_stride = 24, xfb_offset = 12) out vec3 bench_normal;
layout(location = 1, xfb_buffer = 0, xfb_offset = 0) out vec3 bench_position;
#else
layout(location = 0) out vec3 bench_normal;
#endif

void bench_vertex(vec3 position, vec3 normal) {
    gl_Position = bench_clip(position);
    bench_normal = normal;
#ifdef BENCH_CAPTURE
    bench_position = position;
#endif
}
#endif

#endif
