// Laws of the camera that the mouse turns: distances stay, turns add up, and what is to be seen
// lies between the near and the far plane.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "orbit.h"

static const double low[3] = {-1.0, 0.0, -2.0}, high[3] = {3.0, 2.0, 2.0};
static const float up[3] = {0.0f, 2.0f, 0.0f};
static const double pi = 3.14159265358979323846;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void check(double value, double wanted) {
    if (!(fabs(value - wanted) <= 1e-12 * (1.0 + fabs(wanted)))) {
        print_error("%.17g is not %.17g\n", value, wanted);
        fail();
    }
}

static void check_point(const double p[3], double x, double y, double z) {
    check(p[0], x);
    check(p[1], y);
    check(p[2], z);
}

static double distance_of(const girih_orbit *orbit) {
    double away[3];
    for (int n = 0; n < 3; n++) {
        away[n] = orbit->camera.eye[n] - orbit->focal[n];
    }
    return sqrt(dot(away, away));
}

// From the front, 11 before the box's middle.
static girih_orbit make_orbit(void) {
    girih_camera camera = {.eye = {1.0, 1.0, 11.0}, .back = {0.0, 0.0, 1.0}, .half_height = 0.25};
    girih_camera_level(&camera, (const double[3]){0.0, 1.0, 0.0});
    girih_orbit orbit;
    girih_orbit_start(&orbit, &camera, up, low, high);
    return orbit;
}

static void check_basis(const girih_camera *camera) {
    check(dot(camera->right, camera->right), 1.0);
    check(dot(camera->up, camera->up), 1.0);
    check(dot(camera->back, camera->back), 1.0);
    check(dot(camera->right, camera->up), 0.0);
    check(dot(camera->right, camera->back), 0.0);
    check(dot(camera->up, camera->back), 0.0);
}

static void test_start(void **state) {
    (void)state;
    const girih_orbit orbit = make_orbit();
    check_point(orbit.focal, 1.0, 1.0, 0.0);
    check_point(orbit.up, 0.0, 1.0, 0.0);
    check(orbit.radius, 3.0);
    // One that looks away turns around what is before it.
    girih_camera away = {.eye = {1.0, 1.0, 11.0}, .back = {0.0, 0.0, -1.0}, .half_height = 0.25};
    girih_orbit other;
    girih_orbit_start(&other, &away, up, low, high);
    check_point(other.focal, 1.0, 1.0, 14.0);
}

static void test_turn(void **state) {
    (void)state;
    girih_orbit orbit = make_orbit();
    // What is in front follows to the right: the camera goes to the left of it.
    girih_orbit_turn(&orbit, pi / 2.0, 0.0);
    check_point(orbit.camera.eye, -10.0, 1.0, 0.0);
    check_basis(&orbit.camera);
    // And down: the camera rises.
    girih_orbit_turn(&orbit, 0.0, -pi / 6.0);
    check(orbit.camera.eye[1], 1.0 + 11.0 * 0.5);
    check(orbit.camera.right[1], 0.0);
    check_basis(&orbit.camera);
    check(distance_of(&orbit), 11.0);
    girih_orbit_turn(&orbit, 0.0, pi / 6.0);
    for (int n = 0; n < 90; n++) {
        girih_orbit_turn(&orbit, pi / 60.0, 0.0);
    }
    check_point(orbit.camera.eye, 1.0, 1.0, 11.0);
}

// However far it is turned upwards, it comes to stand above, does not flip, and comes back.
static void test_never_flips(void **state) {
    (void)state;
    girih_orbit orbit = make_orbit();
    for (int n = 0; n < 40; n++) {
        girih_orbit_turn(&orbit, 0.0, -0.3);
        assert_true(orbit.camera.up[1] > 0.0);
        check(orbit.camera.right[0], 1.0);
        check(distance_of(&orbit), 11.0);
    }
    assert_true(orbit.camera.back[1] > 0.99999);
    girih_orbit_turn(&orbit, 0.0, 1.5690);
    check_point(orbit.camera.eye, 1.0, 1.0, 11.0);
    // From right above, a turn goes on from where the picture's up is.
    girih_orbit_look(&orbit, (const double[3]){0.0, 3.0, 0.0});
    check_point(orbit.camera.eye, 1.0, 12.0, 0.0);
    check_basis(&orbit.camera);
    girih_orbit_turn(&orbit, 0.0, pi / 2.0);
    check(orbit.camera.eye[1], 1.0);
    check(distance_of(&orbit), 11.0);
}

static void test_pan_and_zoom(void **state) {
    (void)state;
    girih_orbit orbit = make_orbit();
    // A picture is 2 * 0.25 * 11 = 5.5 high at the focal point.
    girih_orbit_pan(&orbit, 1.0, 0.5);
    check_point(orbit.camera.eye, 1.0 - 5.5, 1.0 - 2.75, 11.0);
    check_point(orbit.focal, 1.0 - 5.5, 1.0 - 2.75, 0.0);
    girih_orbit_zoom(&orbit, 0.5);
    check(distance_of(&orbit), 5.5);
    for (int n = 0; n < 1000; n++) {
        girih_orbit_zoom(&orbit, 0.9);
    }
    assert_true(distance_of(&orbit) > 1e-3 * orbit.radius);
    for (int n = 0; n < 1000; n++) {
        girih_orbit_zoom(&orbit, 1.1);
    }
    assert_true(distance_of(&orbit) < 1e3 * orbit.radius);
    orbit.camera.orthographic = true;
    girih_orbit_zoom(&orbit, 0.5);
    check(orbit.camera.half_height, 0.125);
}

// Corners of the box, and a quarter of its radius more, lie in between, wherever the camera is.
static void test_depth(void **state) {
    (void)state;
    girih_orbit orbit = make_orbit();
    for (int n = 0; n < 200; n++) {
        girih_orbit_turn(&orbit, 0.7, 0.4 * cos(n));
        girih_orbit_zoom(&orbit, n % 40 < 20 ? 0.7 : 1.42);
        const girih_camera camera = girih_orbit_camera(&orbit);
        assert_true(camera.near > 0.0 && camera.far > camera.near);
        for (int corner = 0; corner < 8; corner++) {
            double away[3];
            for (int k = 0; k < 3; k++) {
                away[k] = camera.eye[k] - ((corner >> k & 1) != 0 ? high[k] : low[k]);
            }
            const double depth = dot(away, camera.back);
            assert_true(depth + 0.25 * orbit.radius <= camera.far * (1.0 + 1e-12));
            if (distance_of(&orbit) > 4.0 * orbit.radius) {
                assert_true(depth - 0.25 * orbit.radius >= camera.near * (1.0 - 1e-12));
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_start),       cmocka_unit_test(test_turn),
        cmocka_unit_test(test_never_flips), cmocka_unit_test(test_pan_and_zoom),
        cmocka_unit_test(test_depth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
