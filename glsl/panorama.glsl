// A cylindrical projection in a host's vertex shader (Lorenz and Doellner 2008, section 5.2): across the picture
// goes the angle around a vertical axis through the eye, up the picture the slope, height above the eye over distance
// from the axis. Only vertices are projected so; between them edges are straight, which is why an edge is to be refined
// by its horizontal length on the screen (GIRIH_LEVEL_HORIZONTAL_PIXELS).
//
// The picture is drawn in slices side by side, each at most 160 degrees wide: one up to there, three of 120 degrees all
// the way round. Levels to dispatch run once; only the draw is repeated, with the slice's middle as `forward` and its
// columns as viewport and scissor. Every slice draws all triangles and keeps those columns, so where two slices meet
// no column is missing or drawn twice, and a triangle across that border comes out of both in the same place. As no
// picture is ever drawn across the place where the angle jumps from 180 to -180 degrees, the panorama's own seam is
// such a border too: it is nothing special.
//
// The jump itself lies behind the slice. A triangle across it would be smeared over the whole slice, so what is behind
// the slice, `front` < 0, must be cut away:
//   gl_ClipDistance[0] = point.front    where the device has shaderClipDistance; elsewhere `front` goes to the fragment
//   if (front < 0.0) discard;           shader as it is
// `front` is the distance before the plane across the slice's middle, so the cut runs exactly along that plane: at
// 90 degrees, 10 or more away from the slice's borders, which hides that the projection bends it. Triangles, once
// refined, must be seen under less than 90 degrees across; larger ones reach from before the plane to beyond the jump.
// Of those that are pierced by the axis this is never true: they are above or below any picture once they are small.
//
// Facing, depth test and interpolation are those of a perspective picture: w is the distance from the axis, so a point
// of an edge lies where its height and distance, both interpolated along the edge, put it.
#ifndef GIRIH_PANORAMA_GLSL
#define GIRIH_PANORAMA_GLSL

#include "math.glsl"

struct GirihPanorama {
    vec3 eye;         // world
    vec3 forward;     // unit vectors: to the middle of the slice, horizontally,
    vec3 right;       // to the right of it,
    vec3 up;          // and along the axis
    float half_angle; // of the slice, radians
    vec2 slopes;      // lowest and highest of the picture, where y is -1 and 1 in clip space
    vec2 depth;       // clip-space z is depth.x * distance from the axis + depth.y. From 1 at `near` to 0 at `far`:
                      // vec2(-near, near * far) / (far - near); from 0 to 1: vec2(far, -near * far) / (far - near)
};

struct GirihPanoramaPoint {
    vec4 position; // clip space
    float front;   // what lies behind, below 0, is to be cut away
};

GirihPanoramaPoint girih_panorama_point(GirihPanorama panorama, vec3 position) {
    // Precise: every mode must reach the same pixels.
    precise vec3 from_eye = position - panorama.eye;
    float forward = girih_dot(panorama.forward, from_eye);
    float right = girih_dot(panorama.right, from_eye);
    float height = girih_dot(panorama.up, from_eye);
    precise float distance_ = sqrt(right * right + forward * forward);
    // On the axis there is no angle; w is 0, and the near plane cuts the point away.
    float angle = distance_ > 0.0 ? atan(right, forward) : 0.0;
    precise vec4 clip = vec4(distance_ * (angle / panorama.half_angle),
                             (height * 2.0 - distance_ * (panorama.slopes.x + panorama.slopes.y)) /
                                 (panorama.slopes.y - panorama.slopes.x),
                             distance_ * panorama.depth.x + panorama.depth.y, distance_);
    return GirihPanoramaPoint(clip, forward);
}

#endif
