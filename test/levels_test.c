// Stage 1: the laws of levels, on the CPU.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "stages.h"

static const girih_plan_shape baked = {.mode = GIRIH_MODE_BAKED, .outputs = GIRIH_OUTPUT_NO_DRAW};

static uint32_t edge_level(const stages *s, uint32_t edge) {
    return s->arrays.words[GIRIH_BIND_LEVELS][edge];
}

static uint32_t segments_of(const girih_catalogue *catalogue, uint32_t level) {
    return girih_catalogue_segments(catalogue, level);
}

static const float *end_position(const girih_mesh *mesh, uint32_t edge, int end) {
    return mesh->positions + 3 * (size_t)mesh->edge_points[2 * edge + (uint32_t)end];
}

// The same triangles with the vertices and the triangles in another order, corners rotated.
static const girih_mesh *shuffled(const girih_mesh *mesh, uint64_t seed) {
    uint64_t state = seed;
    const uint32_t vertex_count = mesh->vertex_count;
    const uint32_t triangle_count = mesh->triangle_count;
    uint32_t *order = malloc(vertex_count * sizeof *order);
    float *positions = malloc(vertex_count * 3 * sizeof *positions);
    float *normals = malloc(vertex_count * 3 * sizeof *normals);
    uint32_t *indices = malloc(triangle_count * 3 * sizeof *indices);
    assert_true(order && positions && normals && indices);
    for (uint32_t n = 0; n < vertex_count; ++n) {
        const uint32_t other = draw_number(&state) % (n + 1);
        order[n] = n;
        order[n] = order[other];
        order[other] = n;
    }
    for (uint32_t n = 0; n < vertex_count; ++n) {
        memcpy(positions + 3 * (size_t)order[n], mesh->positions + 3 * (size_t)n, 12);
        memcpy(normals + 3 * (size_t)order[n], mesh->normals + 3 * (size_t)n, 12);
    }
    for (uint32_t n = 0; n < triangle_count; ++n) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            indices[3 * (triangle_count - 1 - n) + corner] =
                order[mesh->triangle_vertices[3 * n + (corner + n) % 3]];
        }
    }
    const girih_mesh_desc desc = {.vertex_count = vertex_count,
                                  .positions = positions,
                                  .normals = normals,
                                  .indices = indices,
                                  .index_count = triangle_count * 3};
    const girih_mesh *result = NULL;
    assert_int_equal(girih_mesh_create(&desc, &result, NULL), GIRIH_OK);
    free(order);
    free(positions);
    free(normals);
    free(indices);
    return result;
}

static void random_levels_depend_on_positions_alone(void **state) {
    (void)state;
    const girih_mesh *mesh = make_torus(12, 8);
    const girih_mesh *other = shuffled(mesh, 77);
    const girih_instance moved = {0, {2, 1, 0, 5, 0, -3, 0, 1, 0.5f, 0, 1, -2}};
    stages a = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
    stages b = stages_begin(girih_catalogue_linear(), &other, 1, &moved, 1, baked);
    assert_int_equal(mesh->edge_count, other->edge_count);
    uint32_t seen[17] = {0};
    uint32_t differ = 0;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = seed};
        stages_frame(&a, &frame);
        stages_frame(&b, &frame);
        girih_twin_levels(&a.arrays);
        girih_twin_levels(&b.arrays);
        for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
            uint32_t twin = 0;
            while (memcmp(end_position(mesh, edge, 0), end_position(other, twin, 0), 12) != 0 ||
                   memcmp(end_position(mesh, edge, 1), end_position(other, twin, 1), 12) != 0) {
                ++twin;
                assert_true(twin < other->edge_count);
            }
            assert_int_equal(edge_level(&a, edge), edge_level(&b, twin));
            ++seen[edge_level(&a, edge) + 1];
            differ += edge > 0 && edge_level(&a, edge) != edge_level(&a, edge - 1);
        }
    }
    // Every count of segments comes up, each about as often.
    const double mean = 20.0 * mesh->edge_count / 16.0;
    for (uint32_t segments = 1; segments <= 16; ++segments) {
        assert_true(seen[segments] > 0.7 * mean && seen[segments] < 1.3 * mean);
    }
    assert_true(differ > 20 * mesh->edge_count * 8 / 10);
    stages_end(&a);
    stages_end(&b);
    girih_mesh_destroy(mesh);
    girih_mesh_destroy(other);
}

// A mesh that the host has moved draws the levels of one prepared where it is now.
static void moved_meshes_draw_as_prepared_ones(void **state) {
    (void)state;
    const girih_mesh *sphere = make_seam_sphere(8, 6);
    const girih_mesh *mesh = make_copy(sphere, NULL, 0, 1);
    float *positions = malloc(mesh->vertex_count * 3 * sizeof *positions);
    assert_non_null(positions);
    stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        // Turned, so that other ends come first, and with zeros of either sign.
        const float *p = mesh->positions + 3 * (size_t)v;
        const float moved[3] = {-p[1], p[2], -0.5f * p[0]};
        memcpy(positions + 3 * (size_t)v, moved, sizeof moved);
        memcpy(s.arrays.words[GIRIH_BIND_VERTICES] + (size_t)v * GIRIH_VERTEX_WORDS, moved,
               sizeof moved);
    }
    const girih_mesh *prepared = make_copy(mesh, positions, 0, 1);
    stages t = stages_begin(girih_catalogue_linear(), &prepared, 1, NULL, 0, baked);
    assert_int_equal(mesh->edge_count, prepared->edge_count);
    uint32_t turned = 0;
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        turned += mesh->edge_points[2 * edge] != prepared->edge_points[2 * edge];
    }
    assert_true(turned > mesh->edge_count / 4);
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const girih_frame frame = {.rule = seed % 2 ? GIRIH_LEVEL_RANDOM_LEVEL : GIRIH_LEVEL_RANDOM,
                                   .segments = 16,
                                   .seed = seed};
        stages_frame(&s, &frame);
        stages_frame(&t, &frame);
        girih_twin_levels(&s.arrays);
        girih_twin_levels(&t.arrays);
        assert_memory_equal(s.arrays.words[GIRIH_BIND_LEVELS], t.arrays.words[GIRIH_BIND_LEVELS],
                            mesh->edge_count * sizeof(uint32_t));
    }
    stages_end(&s);
    stages_end(&t);
    free(positions);
    girih_mesh_destroy(prepared);
    girih_mesh_destroy(mesh);
    girih_mesh_destroy(sphere);
}

// Levels drawn as such: 0..segments of either spacing, clamped to the catalogue's last.
static void random_levels_of_the_catalogue(void **state) {
    (void)state;
    const girih_mesh *mesh = make_torus(12, 8);
    stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0, baked);
    for (uint32_t most = 0; most <= 8; ++most) {
        const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = most, .seed = 3};
        stages_frame(&s, &frame);
        girih_twin_levels(&s.arrays);
        uint32_t seen[7] = {0};
        for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
            assert_true(edge_level(&s, edge) <= most && edge_level(&s, edge) <= 6);
            ++seen[edge_level(&s, edge)];
        }
        const uint32_t mean = mesh->edge_count / (most + 1);
        for (uint32_t level = 0; level <= most && level < 6; ++level) {
            assert_true(seen[level] > mean / 2 && seen[level] < 2 * mean);
        }
        const uint64_t clamped = stages_statistics(&s).clamped_edges;
        assert_true(most <= 6 ? clamped == 0 : clamped > 0 && clamped < seen[6]);
    }
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

static void dyadic_levels_round_up(void **state) {
    (void)state;
    const girih_mesh *mesh = make_torus(12, 8);
    stages linear = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
    stages dyadic = stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0, baked);
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 16, .seed = 5};
    stages_frame(&linear, &frame);
    stages_frame(&dyadic, &frame);
    girih_twin_levels(&linear.arrays);
    girih_twin_levels(&dyadic.arrays);
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        const uint32_t asked = segments_of(girih_catalogue_linear(), edge_level(&linear, edge));
        const uint32_t got = segments_of(girih_catalogue_dyadic(), edge_level(&dyadic, edge));
        assert_true(got >= asked && (got == 1 || got / 2 < asked));
    }
    stages_end(&linear);
    stages_end(&dyadic);
    girih_mesh_destroy(mesh);
}

static void random_clamps_are_counted(void **state) {
    (void)state;
    const girih_mesh *mesh = make_icosphere(2);
    stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
    // The hash modulo 16 is the hash modulo 32 modulo 16, so half of the edges are clamped.
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = 32, .seed = 9};
    stages_frame(&s, &frame);
    girih_twin_levels(&s.arrays);
    uint32_t last = 0;
    for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
        last += edge_level(&s, edge) == 15;
    }
    const uint64_t clamped = stages_statistics(&s).clamped_edges;
    assert_true(clamped <= last && clamped > mesh->edge_count / 3);
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

// Segments asked for in double precision: the real number whose ceiling counts.
static double wanted_segments(const girih_mesh *mesh, uint32_t edge, const float t[12],
                              const girih_frame *frame) {
    double ends[2][3];
    for (int end = 0; end < 2; ++end) {
        const float *p = end_position(mesh, edge, end);
        for (int axis = 0; axis < 3; ++axis) {
            ends[end][axis] = (double)p[axis];
            if (frame->rule == GIRIH_LEVEL_EDGE_PIXELS) {
                const float *row = t + 4 * axis;
                ends[end][axis] = (double)row[0] * (double)p[0] + (double)row[1] * (double)p[1] +
                                  (double)row[2] * (double)p[2] + (double)row[3];
            }
        }
    }
    double length = 0, distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = ends[1][axis] - ends[0][axis];
        const double away = (ends[0][axis] + ends[1][axis]) / 2 - (double)frame->eye[axis];
        length += along * along;
        distance += away * away;
    }
    length = sqrt(length);
    if (frame->rule == GIRIH_LEVEL_EDGE_LENGTH) {
        return length / (double)frame->length;
    }
    distance = frame->orthographic ? 1.0 : fmax(sqrt(distance), (double)frame->near_distance);
    return length * (double)frame->pixels_per_unit / distance / (double)frame->length;
}

static void check_lengths(const girih_catalogue *catalogue, girih_frame frame, uint64_t seed,
                          uint64_t *checked) {
    const girih_mesh *mesh = make_soup(60, 40, seed);
    uint64_t random = seed + 1;
    girih_instance instances[2];
    for (uint32_t n = 0; n < 2; ++n) {
        instances[n].mesh = 0;
        for (int element = 0; element < 12; ++element) {
            instances[n].transform[element] = draw_float(&random, -2.0f, 2.0f);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        frame.eye[axis] = draw_float(&random, -3.0f, 3.0f);
    }
    stages s = stages_begin(catalogue, &mesh, 1, instances, 2, baked);
    stages_frame(&s, &frame);
    girih_twin_levels(&s.arrays);
    uint64_t clamped = 0, ties = 0;
    for (uint32_t n = 0; n < 2 * mesh->edge_count; ++n) {
        const girih_instance *instance = &instances[n / mesh->edge_count];
        const double wanted =
            wanted_segments(mesh, n % mesh->edge_count, instance->transform, &frame);
        if (fabs(wanted - round(wanted)) < 1e-4 * wanted) {
            ++ties;
            continue;
        }
        int is_clamped = 0;
        const uint32_t level = girih_catalogue_level(
            catalogue, wanted < 1e6 ? (uint32_t)ceil(wanted) : 1000000u, &is_clamped);
        assert_int_equal(edge_level(&s, n), level);
        clamped += is_clamped != 0;
        ++*checked;
    }
    const uint64_t counted = stages_statistics(&s).clamped_edges;
    assert_true(counted >= clamped && counted <= clamped + ties);
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

static void lengths_agree_with_double_precision(void **state) {
    (void)state;
    uint64_t checked = 0;
    for (uint64_t seed = 1; seed <= 8; ++seed) {
        girih_frame frame = {.rule = GIRIH_LEVEL_EDGE_PIXELS,
                             .length = 8.0f,
                             .pixels_per_unit = 90.0f * (float)seed,
                             .near_distance = 0.25f + (float)(seed % 4)};
        check_lengths(girih_catalogue_dyadic(), frame, seed, &checked);
        check_lengths(girih_catalogue_linear(), frame, seed, &checked);
        frame.orthographic = 1;
        check_lengths(girih_catalogue_linear(), frame, seed, &checked);
        frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_LENGTH, .length = 0.05f * (float)seed};
        check_lengths(girih_catalogue_dyadic(), frame, seed, &checked);
        check_lengths(girih_catalogue_linear(), frame, seed, &checked);
    }
    assert_true(checked > 10000);
}

// Segments asked for across a cylindrical picture, in long double: the real number whose ceiling
// counts, and how far off rounding may put it. The angle between two directions is off by the
// rounding of the ends' places, which is relative to their distance from the eye.
typedef struct horizontal {
    long double wanted, doubt;
    int is_obtuse, is_short;
} horizontal;

static horizontal wanted_across(const float *p, const float *q, const girih_frame *frame) {
    const float *const ends[2] = {p, q};
    long double up[3] = {0, 1, 0}, flat[2][3], far[2], away[2];
    long double length = 0, dot = 0, cross = 0, chord = 0;
    for (int n = 0; n < 3; ++n) {
        length += (long double)frame->up[n] * (long double)frame->up[n];
    }
    for (int n = 0; n < 3 && length > 0; ++n) {
        up[n] = (long double)frame->up[n] / sqrtl(length);
    }
    for (int end = 0; end < 2; ++end) {
        long double height = 0;
        far[end] = away[end] = 0;
        for (int n = 0; n < 3; ++n) {
            flat[end][n] = (long double)ends[end][n] - (long double)frame->eye[n];
            height += flat[end][n] * up[n];
            away[end] += flat[end][n] * flat[end][n];
        }
        for (int n = 0; n < 3; ++n) {
            flat[end][n] -= height * up[n];
            far[end] += flat[end][n] * flat[end][n];
        }
        far[end] = sqrtl(far[end]);
        away[end] = sqrtl(away[end]);
    }
    for (int n = 0; n < 3; ++n) {
        const int y = (n + 1) % 3, z = (n + 2) % 3;
        const long double across = flat[0][y] * flat[1][z] - flat[0][z] * flat[1][y];
        const long double along = flat[1][n] - flat[0][n];
        dot += flat[0][n] * flat[1][n];
        cross += across * across;
        chord += along * along;
    }
    chord = sqrtl(chord);
    const long double angle = atan2l(sqrtl(cross), dot);
    const long double segment = (long double)frame->length / (long double)frame->pixels_per_radian;
    const long double near = (long double)frame->near_distance;
    horizontal result = {.is_obtuse = dot < 0, .is_short = chord < angle * near};
    result.wanted = fminl(angle, chord / near) / segment;
    result.doubt =
        1e-5L * result.wanted + (result.is_short ? 5e-7L * (away[0] + away[1]) / near
                                                 : 5e-7L * (away[0] / far[0] + away[1] / far[1])) /
                                    segment;
    return result;
}

static girih_frame draw_panorama(uint64_t *random, uint32_t turn) {
    girih_frame frame = {.rule = GIRIH_LEVEL_HORIZONTAL_PIXELS,
                         .length = draw_float(random, 2.0f, 40.0f),
                         .pixels_per_radian = draw_float(random, 60.0f, 400.0f),
                         .near_distance = turn % 3 ? 0.3f : 0.001f};
    for (int axis = 0; axis < 3; ++axis) {
        frame.eye[axis] = draw_float(random, -0.7f, 0.7f);
        frame.up[axis] = turn % 2 ? draw_float(random, -2.0f, 2.0f) : 0.0f;
    }
    frame.up[turn / 4 % 3] += turn % 4 == 2 ? -3.0f : 0.0f;
    return frame;
}

// From within the mesh, so that there are edges on all sides, behind, across any seam that a
// panorama might have, above, below and through the axis.
static void panoramas_agree_with_long_double(void **state) {
    (void)state;
    const girih_catalogue *const catalogues[2] = {girih_catalogue_dyadic(),
                                                  girih_catalogue_linear()};
    uint64_t random = 99, checked = 0, ties = 0, obtuse = 0, near = 0, clamped = 0;
    for (uint32_t turn = 0; turn < 24; ++turn) {
        const girih_catalogue *catalogue = catalogues[turn % 5 % 2];
        const girih_mesh *mesh = make_soup(150, turn % 2 ? 0 : 60, turn + 1);
        stages s = stages_begin(catalogue, &mesh, 1, NULL, 0, baked);
        const girih_frame frame = draw_panorama(&random, turn);
        stages_frame(&s, &frame);
        girih_twin_levels(&s.arrays);
        uint64_t sure = 0, doubtful = 0;
        for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
            const horizontal asked =
                wanted_across(end_position(mesh, edge, 0), end_position(mesh, edge, 1), &frame);
            if (fabsl(asked.wanted - roundl(asked.wanted)) <= asked.doubt) {
                ++doubtful;
                continue;
            }
            int is_clamped = 0;
            const uint32_t level =
                girih_catalogue_level(catalogue, (uint32_t)ceill(asked.wanted), &is_clamped);
            assert_int_equal(edge_level(&s, edge), level);
            sure += is_clamped != 0;
            ++checked;
            obtuse += asked.is_obtuse != 0;
            near += asked.is_short != 0;
        }
        const uint64_t counted = stages_statistics(&s).clamped_edges;
        assert_true(counted >= sure && counted <= sure + doubtful);
        clamped += counted;
        ties += doubtful;
        stages_end(&s);
        girih_mesh_destroy(mesh);
    }
    print_message("%llu edges, %llu beyond 90 degrees, %llu near the axis, %llu clamped, "
                  "%llu too close to call\n",
                  (unsigned long long)checked, (unsigned long long)obtuse, (unsigned long long)near,
                  (unsigned long long)clamped, (unsigned long long)ties);
    assert_true(checked > 5000 && obtuse > 500 && near > 100 && clamped > 50);
    assert_true(ties * 100 < checked);
}

// Bit for bit: an edge asks for the same from either end, and on any scale.
static void panoramas_do_not_depend_on_direction_or_scale(void **state) {
    (void)state;
    static const float scales[3] = {1.0f, 0x1p49f, 0x1p-40f};
    uint64_t random = 5;
    for (uint32_t turn = 0; turn < 12; ++turn) {
        const girih_mesh *soup = make_soup(200, 70, turn + 1);
        const girih_frame frame = draw_panorama(&random, turn);
        uint32_t *expected = NULL;
        for (int n = 0; n < 3; ++n) {
            float *positions = malloc(soup->vertex_count * 3 * sizeof *positions);
            assert_non_null(positions);
            for (uint32_t k = 0; k < 3 * soup->vertex_count; ++k) {
                positions[k] = soup->positions[k] * scales[n];
            }
            const girih_mesh *mesh = make_copy(soup, positions, 0, 0);
            stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
            girih_frame scaled = frame;
            scaled.near_distance *= scales[n];
            for (int axis = 0; axis < 3; ++axis) {
                scaled.eye[axis] *= scales[n];
            }
            stages_frame(&s, &scaled);
            const size_t bytes = mesh->edge_count * sizeof(uint32_t);
            for (int reversed = 0; reversed < 2; ++reversed) {
                girih_twin_levels(&s.arrays);
                if (!expected) {
                    expected = malloc(bytes);
                    assert_non_null(expected);
                    memcpy(expected, s.arrays.words[GIRIH_BIND_LEVELS], bytes);
                }
                assert_memory_equal(expected, s.arrays.words[GIRIH_BIND_LEVELS], bytes);
                for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
                    uint32_t *points = s.arrays.words[GIRIH_BIND_EDGE_POINTS] + 2 * (size_t)edge;
                    const uint32_t first = points[0];
                    points[0] = points[1];
                    points[1] = first;
                }
            }
            stages_end(&s);
            girih_mesh_destroy(mesh);
            free(positions);
        }
        free(expected);
        girih_mesh_destroy(soup);
    }
}

// Known angles, at which the rule's sides are equal: seen from the origin, the edges of a square
// around the axis ask for 90 degrees, an edge through the axis for 180, one along it for nothing.
static void panoramas_of_known_angles(void **state) {
    (void)state;
    static const float positions[6][3] = {{1, 5, 0},  {0, -2, 1}, {-1, 0, 0},
                                          {0, 3, -1}, {0, 1, 0},  {0, 2, 0}};
    static const uint32_t indices[12] = {0, 1, 2, 2, 3, 0, 0, 4, 5, 2, 4, 5};
    const girih_mesh_desc desc = {
        .vertex_count = 6, .positions = positions[0], .indices = indices, .index_count = 12};
    const girih_mesh *mesh = NULL;
    assert_int_equal(girih_mesh_create(&desc, &mesh, NULL), GIRIH_OK);
    stages s = stages_begin(girih_catalogue_linear(), &mesh, 1, NULL, 0, baked);
    for (uint32_t parts = 1; parts <= 8; ++parts) {
        // A hair more than a whole part of 90 degrees.
        const girih_frame frame = {.rule = GIRIH_LEVEL_HORIZONTAL_PIXELS,
                                   .length = 90.0f * 1.00001f / (float)parts,
                                   .pixels_per_radian = 57.29577951f,
                                   .near_distance = 0.001f};
        stages_frame(&s, &frame);
        girih_twin_levels(&s.arrays);
        for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
            const float *p = end_position(mesh, edge, 0);
            const float *q = end_position(mesh, edge, 1);
            const int on_axis = (p[0] == 0.0f && p[2] == 0.0f) || (q[0] == 0.0f && q[2] == 0.0f);
            const int opposite = p[0] == -q[0] && p[2] == -q[2];
            const uint32_t segments = on_axis ? 1 : opposite ? 2 * parts : parts;
            assert_int_equal(edge_level(&s, edge) + 1, segments);
        }
    }
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

static void uniform_levels(void **state) {
    (void)state;
    const girih_mesh *mesh = make_cube(1);
    stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0, baked);
    static const struct {
        uint32_t segments, level;
        uint64_t clamped;
    } cases[] = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 2, 0}, {33, 6, 0}, {64, 6, 0}, {65, 6, 18}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; ++n) {
        const girih_frame frame = {.segments = cases[n].segments};
        stages_frame(&s, &frame);
        girih_twin_levels(&s.arrays);
        for (uint32_t edge = 0; edge < mesh->edge_count; ++edge) {
            assert_int_equal(edge_level(&s, edge), cases[n].level);
        }
        assert_int_equal(stages_statistics(&s).clamped_edges, cases[n].clamped);
    }
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

static void refused(stages *s, girih_frame frame, const char *message) {
    const girih_frame_block before = s->arrays.frame;
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_pack_frame(&s->arrays, &frame, &error), GIRIH_ERROR_INVALID_ARGUMENT);
    assert_string_equal(error.message, message);
    assert_memory_equal(&before, &s->arrays.frame, sizeof before);
}

static void frames_that_cannot_be_meant_are_refused(void **state) {
    (void)state;
    const girih_mesh *mesh = make_triangle();
    stages s = stages_begin(girih_catalogue_dyadic(), &mesh, 1, NULL, 0, baked);
    const girih_frame pixels = {.rule = GIRIH_LEVEL_EDGE_PIXELS,
                                .length = 8.0f,
                                .pixels_per_unit = 500.0f,
                                .near_distance = 0.1f};
    stages_frame(&s, &pixels);
    girih_frame frame = pixels;
    frame.length = 0.0f;
    refused(&s, frame, "frame: 0 pixels a segment and 500 pixels a unit must both be positive");
    frame = pixels;
    frame.pixels_per_unit = NAN;
    girih_error error = {GIRIH_OK, ""};
    assert_int_equal(girih_pack_frame(&s.arrays, &frame, &error), GIRIH_ERROR_INVALID_ARGUMENT);
    frame = pixels;
    frame.pixels_per_unit = 1e30f;
    refused(&s, frame, "frame: 1e+30 pixels a unit at 8 pixels a segment are out of range");
    frame = pixels;
    frame.near_distance = -1.0f;
    refused(&s, frame, "frame: the near distance -1 must be positive");
    frame.orthographic = 1;
    stages_frame(&s, &frame);
    frame = pixels;
    frame.eye[1] = INFINITY;
    refused(&s, frame, "frame: the eye is not finite");
    frame = pixels;
    frame.planes[4][3] = NAN;
    refused(&s, frame, "frame: plane 4 is not finite");
    frame = (girih_frame){.rule = GIRIH_LEVEL_EDGE_LENGTH, .length = -1.0f};
    refused(&s, frame, "frame: the length -1 of a segment must be positive");
    frame = (girih_frame){.rule = GIRIH_LEVEL_HORIZONTAL_PIXELS, .length = 8.0f};
    refused(&s, frame, "frame: 8 pixels a segment and 0 pixels a radian must both be positive");
    frame.pixels_per_radian = 160.0f;
    refused(&s, frame, "frame: segments of 0.05 radians at the near distance 0 are out of range");
    frame.near_distance = 0.1f;
    stages_frame(&s, &frame);
    frame.up[2] = NAN;
    refused(&s, frame, "frame: the vertical axis or a slope is not finite");
    frame = (girih_frame){.cylindrical = 1, .highest_slope = INFINITY};
    refused(&s, frame, "frame: the vertical axis or a slope is not finite");
    frame = (girih_frame){.rule = (girih_level_rule)7};
    refused(&s, frame, "frame: unknown level rule 7");
    stages_end(&s);
    girih_mesh_destroy(mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_levels_depend_on_positions_alone),
        cmocka_unit_test(moved_meshes_draw_as_prepared_ones),
        cmocka_unit_test(random_levels_of_the_catalogue),
        cmocka_unit_test(dyadic_levels_round_up),
        cmocka_unit_test(random_clamps_are_counted),
        cmocka_unit_test(lengths_agree_with_double_precision),
        cmocka_unit_test(panoramas_agree_with_long_double),
        cmocka_unit_test(panoramas_do_not_depend_on_direction_or_scale),
        cmocka_unit_test(panoramas_of_known_angles),
        cmocka_unit_test(uniform_levels),
        cmocka_unit_test(frames_that_cannot_be_meant_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
