// Whether a triangle can be seen at all (stage 2).
//
// Reads the frame's planes, eye and slopes from `girih_frame`, which the includer declares: the stages through
// arrays.glsl, any other shader as a uniform block of GIRIH_FRAME_BLOCK (shared.h).
#ifndef GIRIH_CULLING_GLSL
#define GIRIH_CULLING_GLSL

#include "math.glsl"

// Whether all of a box is above or below the picture of a cylindrical projection: the plane through a point of the
// picture's border is a cone there. `world` is the box's centre; its height above the eye and its distance from the
// axis are bounded by those of a box along the axis and the two horizontal vectors. All of it is above where even
// least height > highest slope * distance, at the farthest distance where the slope is positive, else at the nearest;
// in squares, so that no root is needed. Below is above upside down.
bool girih_outside_slopes(GirihTransform t, vec3 world, vec3 size, vec3 extent) {
    precise vec3 from_eye = world - girih_frame.eye.xyz;
    // Slack for the rounding of all that follows, as for the planes.
    precise float slack = (girih_length_bound(size) + girih_length_bound(girih_frame.eye.xyz)) * 1e-5;
    vec3 centre;
    precise vec3 radius;
    for (int n = 0; n < 3; ++n) {
        vec3 axis = girih_frame.up.xyz;
        if (n < 2) {
            axis = girih_frame.horizontal[n].xyz;
        }
        precise vec3 normal = (t.row0.xyz * axis.x + t.row1.xyz * axis.y) + t.row2.xyz * axis.z;
        centre[n] = girih_dot(axis, from_eye);
        radius[n] = girih_dot(abs(normal), extent) + slack;
    }
    precise vec2 far = abs(centre.xy) + radius.xy;
    precise vec2 near = max(abs(centre.xy) - radius.xy, vec2(0.0));
    precise float far_squared = far.x * far.x + far.y * far.y;
    precise float near_squared = near.x * near.x + near.y * near.y;
    for (int n = 0; n < 2; ++n) {
        float slope = n == 0 ? girih_frame.highest_slope : -girih_frame.lowest_slope;
        precise float least = (n == 0 ? centre.z : -centre.z) - radius.z;
        precise float square = least * least;
        precise float bound = (slope * slope) * (slope > 0.0 ? far_squared : near_squared);
        if (slope > 0.0 ? least > 0.0 && square > bound : least > 0.0 || square < bound) {
            return true;
        }
    }
    return false;
}

// Whether all of a triangle's patch is outside the frustum or faces away. The bounds are those of the
// curved surface: a Bezier patch lies in the box of its control points, and its normal, the cross
// product of its two derivatives, in a ball around the flat triangle's normal. A host's surface lies
// within girih_frame.reach of the box, and nothing is known of its normals. `p` are the mesh-space control
// points, the corners first; `t` places them in the world, and turns the winding round where it is `mirrored`.
bool girih_culled(vec3 p[10], int count, GirihTransform t, bool mirrored, bool two_sided) {
    vec3 low = p[0];
    vec3 high = p[0];
    for (int n = 1; n < count; ++n) {
        low = min(low, p[n]);
        high = max(high, p[n]);
    }
    precise vec3 centre = (low + high) * 0.5;
    precise vec3 extent = (high - low) * 0.5 + girih_frame.reach;
    if ((girih_frame.cull & GIRIH_CULL_FRUSTUM) != 0u) {
        vec3 world = girih_transform_point(t, centre);
        // Bounds |world| of every point of the box and of every sum on the way to it.
        precise vec3 far = max(abs(low), abs(high)) + girih_frame.reach;
        precise vec3 size = vec3(girih_dot(abs(t.row0.xyz), far) + abs(t.row0.w),
                                 girih_dot(abs(t.row1.xyz), far) + abs(t.row1.w),
                                 girih_dot(abs(t.row2.xyz), far) + abs(t.row2.w));
        for (int n = 0; n < 6; ++n) {
            vec3 plane = girih_frame.planes[n].xyz;
            precise float distance = girih_dot(plane, world) + girih_frame.planes[n].w;
            // The plane's normal in mesh space, so that the box stays a box.
            precise vec3 normal = (t.row0.xyz * plane.x + t.row1.xyz * plane.y) + t.row2.xyz * plane.z;
            precise float radius = girih_dot(abs(normal), extent);
            // Slack for the rounding of the test itself: culling may never open a hole.
            precise float slack = (radius + girih_length_bound(plane) * girih_length_bound(size)) * 1e-5;
            if (distance + (radius + slack) < 0.0) {
                return true;
            }
        }
        if (girih_frame.cylindrical != 0u && girih_outside_slopes(t, world, size, extent)) {
            return true;
        }
    }
    if ((girih_frame.cull & GIRIH_CULL_BACK) != 0u && !two_sided) {
        vec3 w[10];
        for (int n = 0; n < count; ++n) {
            w[n] = girih_transform_point(t, p[n]);
        }
        precise vec3 along2 = w[1] - w[0];
        precise vec3 along3 = w[2] - w[0];
        vec3 normal = girih_cross(along2, along3);
        if (mirrored) {
            normal = -normal;
        }
        // How far the derivatives' control vectors stray from the flat triangle's edges.
        float stray2 = 0.0;
        float stray3 = 0.0;
        if (count == 10) {
            // Control points in the order b300 b030 b003 b210 b120 b021 b012 b102 b201 b111: the
            // derivative towards corner 2 is 3 (b_ij+1k - b_i+1jk), towards corner 3 likewise.
            const int from[6] = int[6](0, 3, 4, 8, 9, 7);
            const int to2[6] = int[6](3, 4, 1, 9, 5, 6);
            const int to3[6] = int[6](8, 9, 5, 7, 6, 2);
            for (int n = 0; n < 6; ++n) {
                precise vec3 d2 = (w[to2[n]] - w[from[n]]) * 3.0 - along2;
                precise vec3 d3 = (w[to3[n]] - w[from[n]]) * 3.0 - along3;
                stray2 = max(stray2, girih_length_bound(d2));
                stray3 = max(stray3, girih_length_bound(d3));
            }
        }
        precise float spread = (girih_length_bound(along2) * stray3 + girih_length_bound(along3) * stray2) + stray2 * stray3;
        precise vec3 to_eye = girih_frame.eye.xyz;
        float radius = 0.0;
        if (girih_frame.eye.w != 0.0) {
            to_eye = girih_frame.eye.xyz - w[0];
            for (int n = 1; n < count; ++n) {
                precise vec3 away = w[n] - w[0];
                radius = max(radius, girih_length_bound(away));
            }
        }
        // For every point of the patch and every normal in the ball: normal · (eye - point) < 0.
        // Measured from corner 1, the flat triangle's own normal is perpendicular to its corners, so
        // only curved control points add to the radius.
        float lift = 0.0;
        if (girih_frame.eye.w != 0.0) {
            for (int n = 3; n < count; ++n) {
                precise vec3 away = w[n] - w[0];
                lift = max(lift, abs(girih_dot(normal, away)));
            }
        }
        precise float reach = girih_length_bound(to_eye) + radius;
        precise float facing = girih_dot(normal, to_eye) + lift;
        // The cross product of a sliver rounds by its factors' size, not by its own.
        precise float slack = ((girih_length_bound(along2) * girih_length_bound(along3)) * reach) * 1e-5;
        if (facing + (spread * reach + slack) < 0.0) {
            return true;
        }
    }
    return false;
}

#endif
