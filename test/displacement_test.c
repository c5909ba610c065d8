// Displacement on the CPU: the height map's filter, and how far the surface goes.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "displacement.h"

enum { WIDTH = 5, HEIGHT = 3 };

static float texels[HEIGHT][WIDTH] = {{0.0f, 1.0f, 4.0f, 9.0f, 16.0f},
                                      {-8.0f, 2.0f, 0.5f, 3.0f, 1.0f},
                                      {32.0f, 5.0f, 6.0f, 7.0f, 8.0f}};

static girih_height_map make_map(void) {
    return (girih_height_map){WIDTH, HEIGHT, &texels[0][0], -8.0f, 32.0f};
}

// At a texel's centre its own value, halfway between two their mean, whatever whole number is added
// to the place.
static void filter_repeats_and_interpolates(void **state) {
    (void)state;
    girih_height_map map = make_map();
    for (int turn = -3; turn <= 3; turn++) {
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                double u = turn + (x + 0.5) / WIDTH, v = 2 * turn + (y + 0.5) / HEIGHT;
                double here = (double)texels[y][x];
                double right = (double)texels[y][(x + 1) % WIDTH];
                double below = (double)texels[(y + 1) % HEIGHT][x];
                double corner = (double)texels[(y + 1) % HEIGHT][(x + 1) % WIDTH];
                double half_u = u + 0.5 / WIDTH, half_v = v + 0.5 / HEIGHT;
                double got[4] = {
                    (double)girih_displacement_height(&map, (float)u, (float)v),
                    (double)girih_displacement_height(&map, (float)half_u, (float)v),
                    (double)girih_displacement_height(&map, (float)u, (float)half_v),
                    (double)girih_displacement_height(&map, (float)half_u, (float)half_v)};
                double wanted[4] = {here, (here + right) / 2, (here + below) / 2,
                                    (here + right + below + corner) / 4};
                for (int n = 0; n < 4; n++) {
                    // A place is rounded to 2^-21 of a map near 7, which spans 40 over a texel.
                    assert_true(fabs(got[n] - wanted[n]) < 1e-3);
                }
            }
        }
    }
    assert_true(girih_displacement_height(&map, 0.5f, 0.5f) == 0.5f);
}

static void filter_takes_any_place(void **state) {
    (void)state;
    girih_height_map map = make_map();
    girih_height_map one = {1, 1, &texels[0][3], 9.0f, 9.0f};
    static const float places[] = {0.0f, -0.0f, 1.0f,    -1e-30f,  1e-30f,  0.99999994f,
                                   1e9f, -1e9f, FLT_MAX, -FLT_MAX, FLT_MIN, -5.5f};
    for (size_t u = 0; u < sizeof places / sizeof places[0]; u++) {
        for (size_t v = 0; v < sizeof places / sizeof places[0]; v++) {
            float height = girih_displacement_height(&map, places[u], places[v]);
            assert_true(height >= -8.0f && height <= 32.0f);
            assert_true(girih_displacement_height(&one, places[u], places[v]) == 9.0f);
        }
    }
    // What is no place gives no height, and reads nothing outside the map.
    assert_true(isnan(girih_displacement_height(&map, NAN, 0.5f)));
    assert_true(isnan(girih_displacement_height(&map, 0.5f, INFINITY)));
}

static const float square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
static const float square_normals[4][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
static const float square_places[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
static const uint32_t square_indices[6] = {0, 1, 2, 0, 2, 3};

// Refines the square, placed by a transform, and checks every point's height over it.
static void check_square(girih_displacement *displacement, const float transform[12],
                         float (*height)(float x, float y), float tolerance) {
    girih_submesh submesh = {.index_count = 6};
    girih_mesh_desc mesh_desc = {
        .name = "square",
        .vertex_count = 4,
        .positions = &square[0][0],
        .normals = &square_normals[0][0],
        .attributes = &square_places[0][0],
        .attribute_floats = 2,
        .indices = square_indices,
        .index_count = 6,
        .submeshes = &submesh,
        .submesh_count = 1,
    };
    const girih_mesh *mesh;
    girih_error error = {0};
    assert_int_equal(girih_mesh_create(&mesh_desc, &mesh, &error), GIRIH_OK);
    girih_instance instance = {0};
    memcpy(instance.transform, transform, sizeof instance.transform);
    girih_cpu_desc desc = {
        .meshes = &mesh,
        .mesh_count = 1,
        .instances = &instance,
        .instance_count = 1,
        .surface = GIRIH_SURFACE_OWN,
        .mode = GIRIH_MODE_WELDED,
        .outputs = GIRIH_OUTPUT_INDICES,
        .own = girih_displacement_surface,
        .own_user = displacement,
        .base = GIRIH_SURFACE_FLAT,
        .reach = girih_displacement_distance(displacement),
    };
    girih_frame frame = {.rule = GIRIH_LEVEL_SEGMENTS, .segments = 8};
    girih_cpu_output output;
    assert_int_equal(girih_cpu_refine(&desc, &frame, &output, &error), GIRIH_OK);
    assert_int_equal(output.statistics.output_vertices, 81);
    for (uint32_t n = 0; n < 81; n++) {
        const float *p = output.positions + 3 * n;
        float x = p[0] / transform[0], y = p[1] / transform[5];
        float expected = height(x, y) * transform[10];
        if (!(fabsf(p[2] - expected) <= tolerance)) {
            fail_msg("%.9g instead of %.9g over %g, %g", (double)p[2], (double)expected, (double)x,
                     (double)y);
        }
        assert_true(fabsf(p[2]) <= desc.reach * transform[10]);
    }
    girih_cpu_output_free(&output);
    girih_mesh_destroy(mesh);
}

static float constant(float x, float y) {
    (void)x;
    (void)y;
    return 2.0f * (0.75f - 0.25f);
}

// Between the centres of two texels, 0 at x = 1/4 and 1 at x = 3/4, repeating; half of that.
static float ramp(float x, float y) {
    (void)y;
    float height = x < 0.25f ? 0.5f - 2.0f * x : x < 0.75f ? 2.0f * x - 0.5f : 2.5f - 2.0f * x;
    return 0.5f * height;
}

// (height - zero) * per_unit mesh units along the normal, in the mesh's space: a transform
// stretches it as it stretches the mesh.
static void surface_goes_as_far_as_the_map_says(void **state) {
    (void)state;
    static const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    static const float uneven[12] = {2, 0, 0, 0, 0, 8, 0, 0, 0, 0, 4, 0};
    float level = 0.75f;
    girih_displacement flat = {
        .map = {1, 1, &level, 0.75f, 0.75f}, .per_unit = 2.0f, .zero = 0.25f};
    check_square(&flat, identity, constant, 0.0f);
    check_square(&flat, uneven, constant, 0.0f);
    float steps[2] = {0.0f, 1.0f};
    girih_displacement waves = {.map = {2, 1, steps, 0.0f, 1.0f}, .per_unit = 0.5f};
    check_square(&waves, identity, ramp, 1e-6f);
    // Without texture coordinates the square, in the plane of x and y, is laid on by x and -y.
    waves.by_axes = true;
    waves.repeats = 1.0f;
    check_square(&waves, identity, ramp, 1e-6f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filter_repeats_and_interpolates),
        cmocka_unit_test(filter_takes_any_place),
        cmocka_unit_test(surface_goes_as_far_as_the_map_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
