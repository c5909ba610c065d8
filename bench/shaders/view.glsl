// What every method's shaders share: the view and the levels of the frame (set 0), and a vertex put out.
#ifndef BENCH_VIEW_GLSL
#define BENCH_VIEW_GLSL

#include "panorama.glsl"

// A target's pipelines are all for one projection, so that none pays for the other.
layout(constant_id = 100) const bool bench_cylindrical = false;

layout(std140, set = 0, binding = 0) uniform BenchView {
    vec4 rows[4]; // world to clip
    vec4 eye;     // and the rest: one slice of a panorama
    vec4 forward; // w: half its angle
    vec4 right;
    vec4 up;
    vec4 slopes_depth;
} bench_view;

GirihPanoramaPoint bench_panorama_point(vec3 position) {
    return girih_panorama_point(
        GirihPanorama(bench_view.eye.xyz, bench_view.forward.xyz, bench_view.right.xyz, bench_view.up.xyz,
                      bench_view.forward.w, bench_view.slopes_depth.xy, bench_view.slopes_depth.zw),
        position);
}

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
layout(location = 2) out float bench_front; // below 0: to be cut away
#endif

void bench_vertex(vec3 position, vec3 normal) {
    if (bench_cylindrical) {
        GirihPanoramaPoint point = bench_panorama_point(position);
        gl_Position = point.position;
#ifndef BENCH_CAPTURE
        bench_front = point.front;
#endif
    } else {
        gl_Position = bench_clip(position);
    }
    bench_normal = normal;
#ifdef BENCH_CAPTURE
    bench_position = position;
#endif
}

// A vertex of a triangle that is not to be seen: all its corners are put at one point, outside the view.
void bench_nothing() {
    gl_Position = vec4(0.0, 0.0, -1.0, 0.0);
    bench_normal = vec3(0.0);
#ifdef BENCH_CAPTURE
    bench_position = vec3(0.0);
#endif
}
#endif

#endif
