// Stage 2: the laws of select, on the CPU.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "girih_permutation.h"
#include "meshes.h"
#include "stages.h"

static const girih_plan_shape baked = {.mode = GIRIH_MODE_BAKED,
                                       .outputs = GIRIH_OUTPUT_NO_DRAW | GIRIH_OUTPUT_INDICES};

// --- Patterns ----------------------------------------------------------------------------------

static int compare_uint(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

// The key's permutation joins the right corners with the right edges, and its parity with the
// range's winding gives the winding asked for.
static void check_key(const stages *s, const uint32_t levels[3], int mirrored) {
    const uint32_t key = s->arrays.words[GIRIH_BIND_KEYS][0];
    const uint32_t lambda = key & 7, range = key >> 3;
    const uint32_t *patterns = s->arrays.words[GIRIH_BIND_PATTERNS];
    const uint32_t rank = patterns[s->arrays.frame.pattern_count * GIRIH_PATTERN_WORDS + range];
    const uint32_t *pattern = patterns + (size_t)rank * GIRIH_PATTERN_WORDS;
    const uint32_t corners = GIRIH_LAMBDA_CORNERS(lambda), edges = GIRIH_LAMBDA_EDGES(lambda);
    uint32_t corner[3];
    for (uint32_t n = 0; n < 3; ++n) {
        corner[n] = corners >> 2 * n & 3;
    }
    for (uint32_t n = 0; n < 3; ++n) {
        const uint32_t edge = edges >> 2 * n & 3, a = corner[n], b = corner[(n + 1) % 3];
        assert_int_equal(pattern[GIRIH_PATTERN_SEGMENTS + n], levels[edge] + 1);
        assert_true((a == edge && b == (edge + 1) % 3) || (b == edge && a == (edge + 1) % 3));
    }
    const int odd = corner[1] != (corner[0] + 1) % 3;
    assert_int_equal(odd, (GIRIH_LAMBDA_IS_ODD(lambda)) != 0);
    const int mirrored_range = range != pattern[GIRIH_PATTERN_RANGE];
    assert_int_equal(odd != mirrored_range, mirrored);
    const int distinct = levels[0] != levels[1] && levels[1] != levels[2] && levels[2] != levels[0];
    assert_true(distinct || !mirrored_range);
}

// On the triangle (0,0,0), (1,0,0), (0,1,0), or its mirror image in x: every input edge is split as
// asked, at the same places from either end, and every output triangle has a positive area.
static void check_placement(const stages *s, const uint32_t levels[3], int mirrored) {
    const girih_statistics statistics = stages_statistics(s);
    uint32_t counts[3] = {0, 0, 0};
    double area = 0.0;
    for (uint32_t n = 0; n < statistics.output_vertices; ++n) {
        float p[3];
        stages_position(s, n, p);
        const float x = mirrored ? -p[0] : p[0];
        // By exact barycentrics over 32768 on the three edges.
        const int on[3] = {p[1] == 0.0f, x + p[1] == 1.0f, x == 0.0f};
        for (int edge = 0; edge < 3; ++edge) {
            counts[edge] += on[edge] != 0;
            if (on[edge]) {
                const double t = (double)(edge == 0 ? x : p[1]);
                const double m = round(t * (levels[edge] + 1));
                assert_true(fabs(t - m / (levels[edge] + 1)) <= 0.5 / 32768);
            }
        }
    }
    for (int edge = 0; edge < 3; ++edge) {
        assert_int_equal(counts[edge], levels[edge] + 2);
    }
    for (uint32_t n = 0; n < statistics.output_triangles; ++n) {
        float p[3][3];
        for (uint32_t corner = 0; corner < 3; ++corner) {
            stages_position(s, s->arrays.words[GIRIH_BIND_OUT_INDICES][3 * n + corner], p[corner]);
        }
        const double doubled = (double)(p[1][0] - p[0][0]) * (double)(p[2][1] - p[0][1]) -
                               (double)(p[2][0] - p[0][0]) * (double)(p[1][1] - p[0][1]);
        assert_true(doubled > 0.0);
        area += doubled;
    }
    assert_true(fabs(area - 1.0) < 1e-6);
}

static void all_triples_are_placed_as_asked(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    girih_instance instance = {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const girih_frame frame = {.segments = 1};
    uint32_t mirrored_ranges = 0;
    for (int mirrored = 0; mirrored < 2; ++mirrored) {
        instance.transform[0] = mirrored ? -1.0f : 1.0f;
        stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, &instance, 1, baked);
        stages_frame(&s, &frame);
        for (uint32_t triple = 0; triple < 125; ++triple) {
            const uint32_t levels[3] = {triple / 25, triple / 5 % 5, triple % 5};
            girih_twin_levels(&s.arrays);
            for (uint32_t n = 0; n < 3; ++n) {
                s.arrays.words[GIRIH_BIND_LEVELS][mesh->triangle_edges[n]] = levels[n];
            }
            girih_twin_select(&s.arrays, GIRIH_SURFACE_FLAT);
            check_key(&s, levels, mirrored);
            assert_int_equal(girih_twin_group(&s.arrays, NULL), GIRIH_OK);
            girih_twin_dispatch(&s.arrays);
            stages_write(&s, GIRIH_SURFACE_FLAT);
            check_placement(&s, levels, mirrored);
            uint32_t sorted[3] = {levels[0], levels[1], levels[2]};
            qsort(sorted, 3, sizeof *sorted, compare_uint);
            const uint32_t i = sorted[2], j = sorted[1], k = sorted[0];
            const uint32_t range = s.arrays.words[GIRIH_BIND_KEYS][0] >> 3;
            const uint32_t *patterns = s.arrays.words[GIRIH_BIND_PATTERNS];
            assert_int_equal(patterns[s.arrays.frame.pattern_count * GIRIH_PATTERN_WORDS + range],
                             i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + k);
            mirrored_ranges +=
                range !=
                patterns[(i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + k) * GIRIH_PATTERN_WORDS +
                         GIRIH_PATTERN_RANGE];
        }
        stages_end(&s);
    }
    // 10 sets of three distinct levels, each with 3 odd arrangements, and 3 even ones when
    // mirrored.
    assert_int_equal(mirrored_ranges, 60);
    girih_mesh_destroy(mesh);
}

// The catalogue's arrays: ranges in rank order, replicas shifted by the vertex count, (a, c, b).
static void ranges_and_replicas(void **state) {
    (void)state;
    const girih_catalogue *const catalogues[2] = {girih_catalogue_dyadic(),
                                                  girih_catalogue_linear()};
    static const uint32_t expected_ranges[2] = {119, 1376};
    for (int n = 0; n < 2; ++n) {
        girih_arrays arrays = {.frame = {.rule = 0}};
        assert_int_equal(girih_pack_catalogue(&arrays, catalogues[n], NULL), GIRIH_OK);
        assert_int_equal(arrays.frame.range_count, expected_ranges[n]);
        const uint32_t *words = arrays.words[GIRIH_BIND_PATTERNS];
        const uint32_t *indices = arrays.words[GIRIH_BIND_PATTERN_INDICES];
        uint32_t range = 0;
        for (uint32_t rank = 0; rank < catalogues[n]->pattern_count; ++rank) {
            const girih_base_pattern *pattern = girih_catalogue_pattern(catalogues[n], rank);
            const uint32_t *record = words + (size_t)rank * GIRIH_PATTERN_WORDS;
            const uint32_t count = pattern->triangle_count,
                           replicas = record[GIRIH_PATTERN_REPLICAS];
            const int two =
                pattern->levels[0] > pattern->levels[1] && pattern->levels[1] > pattern->levels[2];
            assert_true(replicas == 1 || replicas * count <= GIRIH_DRAW_TRIANGLES);
            assert_true(replicas * count > GIRIH_DRAW_TRIANGLES / 2);
            assert_int_equal(record[GIRIH_PATTERN_RANGE], range);
            assert_int_equal(record[GIRIH_PATTERN_CHUNKS], (pattern->vertex_count + 255) / 256);
            for (int mirrored = 0; mirrored <= two; ++mirrored, ++range) {
                assert_int_equal(words[catalogues[n]->pattern_count * GIRIH_PATTERN_WORDS + range],
                                 rank);
                const uint32_t first =
                    record[mirrored ? GIRIH_PATTERN_FIRST_MIRRORED : GIRIH_PATTERN_FIRST_INDEX];
                for (uint32_t m = 0; m < 3 * count * replicas; ++m) {
                    const uint32_t corner = m % 3;
                    const uint32_t source =
                        m % (3 * count) - corner + (mirrored && corner > 0 ? 3 - corner : corner);
                    const uint32_t index = indices[first + m];
                    if (index != girih_catalogue_index(catalogues[n], pattern, source) +
                                     m / (3 * count) * pattern->vertex_count) {
                        fail_msg("rank %u, index %u", rank, m);
                    }
                    // The first replica again, a triangle to two words.
                    const uint32_t *triangle =
                        indices + 2 * (record[GIRIH_PATTERN_FIRST_TRIANGLE] +
                                       (size_t)(mirrored ? count : 0) + m / 3 % count);
                    const uint64_t packed = (uint64_t)triangle[1] << 32 | triangle[0];
                    if (m < 3 * count &&
                        (packed >> corner * GIRIH_TRIANGLE_BITS & GIRIH_TRIANGLE_MASK) != index) {
                        fail_msg("rank %u, packed triangle %u", rank, m / 3);
                    }
                }
            }
            assert_true(two ||
                        record[GIRIH_PATTERN_FIRST_MIRRORED] == record[GIRIH_PATTERN_FIRST_INDEX]);
        }
        assert_int_equal(range, expected_ranges[n]);
        girih_arrays_free(&arrays, 0, GIRIH_BIND_COUNT);
    }
}

// --- Culling -----------------------------------------------------------------------------------

typedef struct point {
    double v[3];
} point;

static point to_point(const float *p) {
    return (point){{(double)p[0], (double)p[1], (double)p[2]}};
}

static point combine(point a, double s, point b, double t) {
    point r;
    for (int n = 0; n < 3; ++n) {
        r.v[n] = a.v[n] * s + b.v[n] * t;
    }
    return r;
}

static double dot(point a, point b) {
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2];
}

static point cross(point a, point b) {
    return (point){{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
                    a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}

static point transformed(const float t[12], point p) {
    point r;
    for (int n = 0; n < 3; ++n) {
        r.v[n] = (double)t[4 * n] * p.v[0] + (double)t[4 * n + 1] * p.v[1] +
                 (double)t[4 * n + 2] * p.v[2] + (double)t[4 * n + 3];
    }
    return r;
}

// A Bezier triangle b[i][j], k = 3 - i - j, in double precision (Vlachos et al. 2001).
typedef struct bezier {
    point b[4][4];
} bezier;

static point edge_point(point p, point q, point n) {
    const double rise = dot(combine(q, 1, p, -1), n);
    return combine(combine(p, 2.0 / 3, q, 1.0 / 3), 1, n, -rise / 3);
}

// Of a mesh without seams.
static bezier make_bezier(const girih_mesh *mesh, uint32_t triangle, const float t[12], int flat) {
    point p[3], n[3];
    for (int corner = 0; corner < 3; ++corner) {
        const size_t vertex = mesh->triangle_vertices[3 * triangle + (uint32_t)corner];
        p[corner] = to_point(mesh->positions + 3 * vertex);
        n[corner] = flat ? (point){{0, 0, 0}} : to_point(mesh->normals + 3 * vertex);
    }
    bezier z;
    z.b[3][0] = p[0];
    z.b[0][3] = p[1];
    z.b[0][0] = p[2];
    z.b[2][1] = edge_point(p[0], p[1], n[0]);
    z.b[1][2] = edge_point(p[1], p[0], n[1]);
    z.b[0][2] = edge_point(p[1], p[2], n[1]);
    z.b[0][1] = edge_point(p[2], p[1], n[2]);
    z.b[1][0] = edge_point(p[2], p[0], n[2]);
    z.b[2][0] = edge_point(p[0], p[2], n[0]);
    point sum = {{0, 0, 0}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; i + j <= 3; ++j) {
            if (i < 3 && j < 3 && i + j > 0 && !(i == 1 && j == 1)) {
                sum = combine(sum, 1, z.b[i][j], 1);
            }
        }
    }
    const point centre = combine(combine(p[0], 1.0 / 3, p[1], 1.0 / 3), 1, p[2], 1.0 / 3);
    z.b[1][1] = combine(sum, 1.5 / 6, centre, -0.5);
    for (int i = 0; i <= 3; ++i) {
        for (int j = 0; i + j <= 3; ++j) {
            z.b[i][j] = transformed(t, z.b[i][j]);
        }
    }
    return z;
}

static double weight(int i, int j, int k, double u, double v, double w) {
    static const double factorial[4] = {1, 1, 2, 6};
    return factorial[i + j + k] / (factorial[i] * factorial[j] * factorial[k]) * pow(u, i) *
           pow(v, j) * pow(w, k);
}

static void sample(const bezier *z, double u, double v, point *position, point *normal) {
    const double w = 1 - u - v;
    point along_v = {{0, 0, 0}}, along_w = {{0, 0, 0}};
    *position = (point){{0, 0, 0}};
    for (int i = 0; i <= 3; ++i) {
        for (int j = 0; i + j <= 3; ++j) {
            *position = combine(*position, 1, z->b[i][j], weight(i, j, 3 - i - j, u, v, w));
            if (i + j <= 2) {
                const double factor = weight(i, j, 2 - i - j, u, v, w);
                along_v =
                    combine(along_v, 1, combine(z->b[i][j + 1], 1, z->b[i + 1][j], -1), factor);
                along_w = combine(along_w, 1, combine(z->b[i][j], 1, z->b[i + 1][j], -1), factor);
            }
        }
    }
    *normal = cross(along_v, along_w);
}

// Whether a point is neither above nor below the picture of a cylindrical projection.
static int is_within_slopes(const girih_frame *frame, point position) {
    point up = to_point(frame->up);
    const double length = sqrt(dot(up, up));
    up = combine(up, 1 / length, up, 0);
    const point away = combine(position, 1, to_point(frame->eye), -1);
    const double height = dot(away, up);
    const point flat = combine(away, 1, up, -height);
    const double distance = sqrt(dot(flat, flat));
    return height >= (double)frame->lowest_slope * distance &&
           height <= (double)frame->highest_slope * distance;
}

// Whether some sampled point lies within all planes and faces the viewer.
static int is_seen(const bezier *z, const girih_frame *frame, int mirrored, int two_sided) {
    const int steps = 16;
    for (int i = 0; i <= steps; ++i) {
        for (int j = 0; i + j <= steps; ++j) {
            point position, normal;
            sample(z, (double)i / steps, (double)j / steps, &position, &normal);
            int inside = 1;
            for (int n = 0; n < 6 && frame->cull_frustum; ++n) {
                inside =
                    inside &&
                    dot(to_point(frame->planes[n]), position) + (double)frame->planes[n][3] >= 0.0;
            }
            if (frame->cull_frustum && frame->cylindrical) {
                inside = inside && is_within_slopes(frame, position);
            }
            const point eye = to_point(frame->eye);
            const point to_eye = frame->orthographic ? eye : combine(eye, 1, position, -1);
            const double facing = dot(normal, to_eye) * (mirrored ? -1 : 1);
            if (inside && (facing > 0.0 || two_sided || !frame->cull_back)) {
                return 1;
            }
        }
    }
    return 0;
}

// A camera around the origin that looks roughly at it, with its side, near and far planes.
static girih_frame draw_camera(uint64_t *random, int kind) {
    girih_frame frame = {.segments = 1, .cull_frustum = kind % 3 != 0, .cull_back = kind % 3 != 1};
    frame.orthographic = kind % 4 == 3;
    point eye, target, up;
    for (int n = 0; n < 3; ++n) {
        frame.eye[n] = draw_float(random, -3.0f, 3.0f);
        eye.v[n] = (double)frame.eye[n];
        target.v[n] = (double)draw_float(random, -0.5f, 0.5f);
        up.v[n] = (double)draw_float(random, -1.0f, 1.0f);
    }
    point forward = combine(target, 1, eye, -1);
    forward = combine(forward, 1 / sqrt(dot(forward, forward)), up, 0);
    point right = cross(forward, up);
    right = combine(right, 1 / sqrt(dot(right, right)), up, 0);
    const point above = cross(right, forward);
    const double slope = (double)draw_float(random, 0.1f, 1.0f);
    const point normals[6] = {combine(forward, slope, right, 1), combine(forward, slope, right, -1),
                              combine(forward, slope, above, 1), combine(forward, slope, above, -1),
                              combine(forward, 1, forward, 0),   combine(forward, -1, forward, 0)};
    for (int n = 0; n < 6; ++n) {
        double offset = -dot(normals[n], eye);
        offset += n == 4 ? -0.5 : n == 5 ? 4.0 : 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            frame.planes[n][axis] = (float)normals[n].v[axis];
        }
        frame.planes[n][3] = (float)offset;
    }
    return frame;
}

// A cylindrical projection from among what there is to see: a wedge or all around, its picture
// around the horizon, above or below it.
static girih_frame draw_panorama(uint64_t *random, int kind) {
    girih_frame frame = {
        .segments = 1, .cull_frustum = 1, .cull_back = kind % 3 == 1, .cylindrical = 1};
    point eye, up, forward;
    for (int n = 0; n < 3; ++n) {
        frame.eye[n] = draw_float(random, -0.6f, 0.6f);
        frame.up[n] = kind % 2 ? draw_float(random, -2.0f, 2.0f) : n == 1 ? 1.0f : 0.0f;
        forward.v[n] = (double)draw_float(random, -1.0f, 1.0f);
    }
    eye = to_point(frame.eye);
    up = to_point(frame.up);
    up = combine(up, 1 / sqrt(dot(up, up)), up, 0);
    forward = combine(forward, 1, up, -dot(forward, up));
    forward = combine(forward, 1 / sqrt(dot(forward, forward)), up, 0);
    const point right = cross(forward, up);
    const double half = (double)draw_float(random, 0.1f, 1.5f);
    for (int side = 0; side < 2 && kind % 4 != 3; ++side) {
        const point normal = combine(forward, sin(half), right, side ? cos(half) : -cos(half));
        for (int n = 0; n < 3; ++n) {
            frame.planes[side][n] = (float)normal.v[n];
        }
        frame.planes[side][3] = (float)-dot(normal, eye);
    }
    frame.lowest_slope = draw_float(random, -1.5f, kind % 5 ? -0.1f : 1.0f);
    frame.highest_slope = frame.lowest_slope + draw_float(random, 0.05f, 1.2f);
    return frame;
}

static void check_culling(const girih_mesh *mesh, uint64_t seed, uint32_t cameras, int flat,
                          girih_frame (*draw)(uint64_t *, int), uint64_t *culled_total,
                          uint64_t *unseen_total) {
    uint64_t random = seed;
    assert_int_equal(mesh->seam_count, 0);
    for (uint32_t n = 0; n < cameras; ++n) {
        girih_instance instance = {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
        for (int element = 0; element < 12 && n % 2 == 1; ++element) {
            instance.transform[element] += draw_float(&random, -0.7f, 0.7f);
        }
        stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, &instance, 1, baked);
        const girih_frame frame = draw(&random, (int)n);
        stages_frame(&s, &frame);
        stages_count(&s, flat ? GIRIH_SURFACE_FLAT : GIRIH_SURFACE_PN);
        const int mirrored =
            s.arrays.words[GIRIH_BIND_INSTANCES][GIRIH_INSTANCE_FLAGS] == GIRIH_INSTANCE_MIRRORED;
        for (uint32_t triangle = 0; triangle < mesh->triangle_count; ++triangle) {
            const int two_sided =
                (s.arrays.words[GIRIH_BIND_TRIANGLE_MATERIALS][triangle] & GIRIH_TWO_SIDED) != 0;
            const bezier z = make_bezier(mesh, triangle, instance.transform, flat);
            const int culled = s.arrays.words[GIRIH_BIND_KEYS][triangle] == GIRIH_KEY_CULLED;
            const int seen = is_seen(&z, &frame, mirrored, two_sided);
            if (culled && seen) {
                fail_msg("camera %u: triangle %u is culled but seen", n, triangle);
            }
            *culled_total += culled != 0;
            *unseen_total += !seen;
        }
        assert_true(stages_statistics(&s).culled_triangles <= mesh->triangle_count);
        stages_end(&s);
    }
}

static void nothing_seen_is_culled(void **state) {
    (void)state;
    uint64_t culled = 0, unseen = 0;
    for (uint64_t seed = 1; seed <= 6; ++seed) {
        const girih_mesh *soup = make_soup(90, 0, seed);
        check_culling(soup, seed, 12, 0, draw_camera, &culled, &unseen);
        check_culling(soup, seed + 100, 12, 1, draw_camera, &culled, &unseen);
        girih_mesh_destroy(soup);
    }
    print_message("soup: %.1f %% of the unseen triangles culled\n",
                  100.0 * (double)culled / (double)unseen);
    culled = unseen = 0;
    const girih_mesh *sphere = make_icosphere(2);
    check_culling(sphere, 1234, 24, 0, draw_camera, &culled, &unseen);
    girih_mesh_destroy(sphere);
    print_message("sphere: %.1f %% of the unseen triangles culled\n",
                  100.0 * (double)culled / (double)unseen);
    assert_true(culled * 10 > unseen * 3);
}

static void nothing_seen_in_a_panorama_is_culled(void **state) {
    (void)state;
    uint64_t culled = 0, unseen = 0;
    for (uint64_t seed = 1; seed <= 6; ++seed) {
        const girih_mesh *soup = make_soup(90, 0, seed);
        check_culling(soup, seed, 20, 0, draw_panorama, &culled, &unseen);
        check_culling(soup, seed + 100, 20, 1, draw_panorama, &culled, &unseen);
        girih_mesh_destroy(soup);
    }
    print_message("soup: %.1f %% of the unseen triangles culled\n",
                  100.0 * (double)culled / (double)unseen);
    culled = unseen = 0;
    const girih_mesh *sphere = make_icosphere(3);
    check_culling(sphere, 1234, 40, 0, draw_panorama, &culled, &unseen);
    girih_mesh_destroy(sphere);
    print_message("sphere: %.1f %% of the unseen triangles culled\n",
                  100.0 * (double)culled / (double)unseen);
    assert_true(culled * 10 > unseen * 8);
}

// Back faces alone, on a fine sphere from far away: nearly half face away.
static void back_faces_of_a_sphere_are_culled(void **state) {
    (void)state;
    const girih_mesh *sphere = make_icosphere(3);
    stages s = stages_begin(girih_catalogue_dyadic(), &sphere, 1, NULL, 0, baked);
    const girih_frame frame = {.cull_back = 1, .eye = {4.0f, 3.0f, 2.0f}};
    stages_frame(&s, &frame);
    stages_count(&s, GIRIH_SURFACE_PN);
    const double part = (double)stages_statistics(&s).culled_triangles / sphere->triangle_count;
    print_message("back faces culled on a sphere of %u triangles: %.1f %%\n",
                  sphere->triangle_count, 100.0 * part);
    assert_true(part > 0.3 && part < 0.7);
    stages_end(&s);
    girih_mesh_destroy(sphere);
}

// A mesh far from its origin that its transform brings back: its bounds round off far more than its
// place in the world tells.
static void far_meshes_are_not_culled(void **state) {
    (void)state;
    static const float far[3][3] = {
        {1e6f, 1e6f, 1e6f}, {1e6f + 1, 1e6f, 1e6f}, {1e6f, 1e6f + 1, 1e6f}};
    static const uint32_t indices[3] = {0, 1, 2};
    const girih_mesh_desc desc = {
        .vertex_count = 3, .positions = far[0], .indices = indices, .index_count = 3};
    const girih_mesh *mesh = NULL;
    assert_int_equal(girih_mesh_create(&desc, &mesh, NULL), GIRIH_OK);
    uint64_t random = 3;
    for (int n = 0; n < 300; ++n) {
        const double angle = (double)draw_float(&random, 0.0f, 6.28f);
        const float c = (float)cos(angle), d = (float)sin(angle);
        const float m = 1e6f;
        const girih_instance instance = {
            0, {c, -d, 0, -(c - d) * m, d, c, 0, -(d + c) * m, 0, 0, 1, -m}};
        stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, &instance, 1, baked);
        // A plane that passes through the first corner as it is written.
        girih_frame frame = {.segments = 1};
        stages_refine(&s, &frame, GIRIH_SURFACE_FLAT);
        float corner[3];
        stages_position(&s, 0, corner);
        frame.cull_frustum = 1;
        for (int plane = 0; plane < 6; ++plane) {
            frame.planes[plane][3] = 1.0f;
        }
        double least = 1e9;
        uint32_t lowest = 0;
        for (uint32_t v = 0; v < 3; ++v) {
            stages_position(&s, v, corner);
            if ((double)corner[0] < least) {
                least = (double)corner[0];
                lowest = v;
            }
        }
        stages_position(&s, lowest, corner);
        frame.planes[0][0] = -1.0f;
        frame.planes[0][3] = corner[0];
        stages_frame(&s, &frame);
        stages_count(&s, GIRIH_SURFACE_FLAT);
        assert_int_equal(stages_statistics(&s).culled_triangles, 0);
        stages_end(&s);
    }
    girih_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_triples_are_placed_as_asked),
        cmocka_unit_test(ranges_and_replicas),
        cmocka_unit_test(nothing_seen_is_culled),
        cmocka_unit_test(nothing_seen_in_a_panorama_is_culled),
        cmocka_unit_test(back_faces_of_a_sphere_are_culled),
        cmocka_unit_test(far_meshes_are_not_culled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
