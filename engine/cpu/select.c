// Stage 2 on the CPU: base pattern, lambda and winding of every triangle, or culled. Twin of
// glsl/select.glsl, which tells why its bounds hold.
#include "key.h"
#include "pn.h"

// Control points in the order b300 b030 b003 b210 b120 b021 b012 b102 b201 b111.
#define CORNERS 3
#define CONTROL_POINTS 10

// Whether all of a box is above or below the picture of a cylindrical projection.
static bool outside_slopes(const girih_frame_block *frame, const girih_transform *t,
                           girih_vector world, girih_vector size, girih_vector extent) {
    const girih_vector eye = {frame->eye[0], frame->eye[1], frame->eye[2]};
    const girih_vector from_eye = girih_subtract(world, eye);
    const float slack = (girih_length_bound(size) + girih_length_bound(eye)) * 1e-5f;
    float centre[3];
    float radius[3];
    for (int n = 0; n < 3; ++n) {
        const float *words = n < 2 ? frame->horizontal[n] : frame->up;
        const girih_vector axis = {words[0], words[1], words[2]};
        const girih_vector normal =
            girih_add(girih_add(girih_scale(t->row[0], axis.x), girih_scale(t->row[1], axis.y)),
                      girih_scale(t->row[2], axis.z));
        centre[n] = girih_dot(axis, from_eye);
        radius[n] = girih_dot(girih_absolute(normal), extent) + slack;
    }
    const float far[2] = {fabsf(centre[0]) + radius[0], fabsf(centre[1]) + radius[1]};
    const float near[2] = {girih_max(fabsf(centre[0]) - radius[0], 0.0f),
                           girih_max(fabsf(centre[1]) - radius[1], 0.0f)};
    const float far_squared = far[0] * far[0] + far[1] * far[1];
    const float near_squared = near[0] * near[0] + near[1] * near[1];
    for (int n = 0; n < 2; ++n) {
        const float slope = n == 0 ? frame->highest_slope : -frame->lowest_slope;
        const float least = (n == 0 ? centre[2] : -centre[2]) - radius[2];
        const float square = least * least;
        const float bound = (slope * slope) * (slope > 0.0f ? far_squared : near_squared);
        if (slope > 0.0f ? least > 0.0f && square > bound : least > 0.0f || square < bound) {
            return true;
        }
    }
    return false;
}

static bool outside_frustum(const girih_frame_block *frame, const girih_vector *p, int count,
                            const girih_transform *t) {
    girih_vector low = p[0];
    girih_vector high = p[0];
    for (int n = 1; n < count; ++n) {
        low = girih_min_vector(low, p[n]);
        high = girih_max_vector(high, p[n]);
    }
    const girih_vector centre = girih_scale(girih_add(low, high), 0.5f);
    const girih_vector reach = {frame->reach, frame->reach, frame->reach};
    const girih_vector extent = girih_add(girih_scale(girih_subtract(high, low), 0.5f), reach);
    const girih_vector world = girih_transform_point(t, centre);
    // What the terms of a transformed point of the box amount to before they cancel.
    const girih_vector far =
        girih_add(girih_max_vector(girih_absolute(low), girih_absolute(high)), reach);
    const girih_vector size = {girih_dot(girih_absolute(t->row[0]), far) + fabsf(t->offset[0]),
                               girih_dot(girih_absolute(t->row[1]), far) + fabsf(t->offset[1]),
                               girih_dot(girih_absolute(t->row[2]), far) + fabsf(t->offset[2])};
    for (int n = 0; n < 6; ++n) {
        const girih_vector plane = {frame->planes[n][0], frame->planes[n][1], frame->planes[n][2]};
        const float distance = girih_dot(plane, world) + frame->planes[n][3];
        // The plane's normal in mesh space, so that the box stays a box.
        const girih_vector normal =
            girih_add(girih_add(girih_scale(t->row[0], plane.x), girih_scale(t->row[1], plane.y)),
                      girih_scale(t->row[2], plane.z));
        const float radius = girih_dot(girih_absolute(normal), extent);
        // Slack for the rounding of the test itself: culling may never open a hole.
        const float slack = (radius + girih_length_bound(plane) * girih_length_bound(size)) * 1e-5f;
        if (distance + (radius + slack) < 0.0f) {
            return true;
        }
    }
    return frame->cylindrical != 0 && outside_slopes(frame, t, world, size, extent);
}

static bool faces_away(const girih_frame_block *frame, const girih_vector *p, int count,
                       const girih_transform *t, bool mirrored) {
    girih_vector w[CONTROL_POINTS];
    for (int n = 0; n < count; ++n) {
        w[n] = girih_transform_point(t, p[n]);
    }
    const girih_vector along2 = girih_subtract(w[1], w[0]);
    const girih_vector along3 = girih_subtract(w[2], w[0]);
    girih_vector normal = girih_cross(along2, along3);
    if (mirrored) {
        normal = girih_negate(normal);
    }
    // How far the derivatives' control vectors stray from the flat triangle's edges.
    float stray2 = 0.0f;
    float stray3 = 0.0f;
    if (count == CONTROL_POINTS) {
        static const int from[6] = {0, 3, 4, 8, 9, 7};
        static const int to2[6] = {3, 4, 1, 9, 5, 6};
        static const int to3[6] = {8, 9, 5, 7, 6, 2};
        for (int n = 0; n < 6; ++n) {
            const girih_vector d2 =
                girih_subtract(girih_scale(girih_subtract(w[to2[n]], w[from[n]]), 3.0f), along2);
            const girih_vector d3 =
                girih_subtract(girih_scale(girih_subtract(w[to3[n]], w[from[n]]), 3.0f), along3);
            stray2 = girih_max(stray2, girih_length_bound(d2));
            stray3 = girih_max(stray3, girih_length_bound(d3));
        }
    }
    const float length2 = girih_length_bound(along2);
    const float length3 = girih_length_bound(along3);
    const float spread = (length2 * stray3 + length3 * stray2) + stray2 * stray3;
    girih_vector to_eye = {frame->eye[0], frame->eye[1], frame->eye[2]};
    float radius = 0.0f;
    float lift = 0.0f;
    if (frame->eye[3] != 0.0f) {
        to_eye = girih_subtract(to_eye, w[0]);
        for (int n = 1; n < count; ++n) {
            radius = girih_max(radius, girih_length_bound(girih_subtract(w[n], w[0])));
        }
        // Measured from corner 1, the flat triangle's own normal is perpendicular to its corners,
        // so only curved control points add to the radius.
        for (int n = CORNERS; n < count; ++n) {
            lift = girih_max(lift, fabsf(girih_dot(normal, girih_subtract(w[n], w[0]))));
        }
    }
    const float reach = girih_length_bound(to_eye) + radius;
    const float facing = girih_dot(normal, to_eye) + lift;
    // The cross product's rounding grows with its factors, not with itself: slivers.
    const float slack = ((length2 * length3) * reach) * 1e-5f;
    return facing + (spread * reach + slack) < 0.0f;
}

static bool is_culled(const girih_arrays *arrays, uint32_t scene_triangle, uint32_t instance,
                      const uint32_t edges[3], bool two_sided, girih_surface surface) {
    const girih_frame_block *frame = &arrays->frame;
    girih_vector p[CONTROL_POINTS];
    girih_vector normals[3];
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t vertex =
            girih_word(arrays, GIRIH_BIND_TRIANGLE_VERTICES, 3 * (size_t)scene_triangle + n);
        p[n] = girih_vertex_position(arrays, vertex);
        normals[n] = girih_vertex_normal(arrays, vertex);
    }
    int count = CORNERS;
    if (surface == GIRIH_SURFACE_PN) {
        const girih_pn_points c =
            girih_make_pn_points(arrays, p, normals, edges,
                                 girih_instance_word(arrays, instance, GIRIH_INSTANCE_SEAM_DELTA));
        p[3] = c.b210;
        p[4] = c.b120;
        p[5] = c.b021;
        p[6] = c.b012;
        p[7] = c.b102;
        p[8] = c.b201;
        p[9] = c.b111;
        count = CONTROL_POINTS;
    }
    const girih_transform t = girih_instance_transform(arrays, instance);
    if ((frame->cull & GIRIH_CULL_FRUSTUM) != 0 && outside_frustum(frame, p, count, &t)) {
        return true;
    }
    const bool mirrored = (girih_instance_word(arrays, instance, GIRIH_INSTANCE_FLAGS) &
                           GIRIH_INSTANCE_MIRRORED) != 0;
    return (frame->cull & GIRIH_CULL_BACK) != 0 && !two_sided &&
           faces_away(frame, p, count, &t, mirrored);
}

void girih_twin_select(girih_arrays *arrays, girih_surface surface) {
    const girih_frame_block *frame = &arrays->frame;
    const uint32_t *levels = arrays->words[GIRIH_BIND_LEVELS];
    uint32_t *keys = arrays->words[GIRIH_BIND_KEYS];
    for (uint32_t triangle = 0; triangle < frame->triangle_count; ++triangle) {
        const uint32_t instance = girih_find_instance(
            arrays, triangle, GIRIH_INSTANCE_FIRST_TRIANGLE, frame->triangle_blocks);
        const uint32_t scene_triangle =
            triangle - girih_instance_word(arrays, instance, GIRIH_INSTANCE_TRIANGLE_DELTA);
        const uint32_t edge_delta =
            girih_instance_word(arrays, instance, GIRIH_INSTANCE_EDGE_DELTA);
        const uint32_t material = girih_word(arrays, GIRIH_BIND_TRIANGLE_MATERIALS, scene_triangle);
        const uint32_t *edges =
            arrays->words[GIRIH_BIND_TRIANGLE_EDGES] + 3 * (size_t)scene_triangle;
        if (frame->cull != 0 && is_culled(arrays, scene_triangle, instance, edges,
                                          (material & GIRIH_TWO_SIDED) != 0, surface)) {
            keys[triangle] = GIRIH_KEY_CULLED;
            continue;
        }
        uint32_t triangle_levels[3];
        for (uint32_t n = 0; n < 3; ++n) {
            triangle_levels[n] = levels[(edges[n] & GIRIH_EDGE_MASK) + edge_delta];
        }
        const bool mirrored = (girih_instance_word(arrays, instance, GIRIH_INSTANCE_FLAGS) &
                               GIRIH_INSTANCE_MIRRORED) != 0;
        keys[triangle] = girih_key(arrays, triangle_levels, material, mirrored);
    }
}
