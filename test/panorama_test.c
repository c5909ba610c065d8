// The slices of a panorama.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "panorama.h"

static const double pi = 3.14159265358979323846;

// Side by side they fill the picture, none is wider than 160 degrees, and each one's angles are
// those of its columns.
static void slices_fill_the_picture(void **state) {
    (void)state;
    static const uint32_t widths[5] = {3, 100, 1000, 1601, 32768};
    for (int degrees = 1; degrees <= 360; ++degrees) {
        const double view_angle = (double)((float)degrees * (float)(pi / 180.0));
        const uint32_t count = girih_panorama_slice_count(view_angle);
        assert_int_equal(count, degrees <= 160 ? 1 : degrees <= 320 ? 2 : 3);
        for (size_t n = 0; n < sizeof widths / sizeof *widths; ++n) {
            uint32_t x = 0;
            for (uint32_t k = 0; k < count; ++k) {
                const girih_panorama_slice slice =
                    girih_panorama_slice_get(k, widths[n], view_angle);
                const double per_column = view_angle / (double)widths[n];
                assert_int_equal(slice.x, x);
                x += slice.width;
                const double left = ((double)slice.x - 0.5 * (double)widths[n]) * per_column;
                const double right = ((double)x - 0.5 * (double)widths[n]) * per_column;
                assert_true(fabs(slice.middle - slice.half_angle - left) < 1e-9);
                assert_true(fabs(slice.middle + slice.half_angle - right) < 1e-9);
                // Columns are whole, so slices of few columns may be wider than an equal share.
                assert_true(slice.half_angle <= 80.0001 / 180.0 * pi + per_column);
            }
            assert_int_equal(x, widths[n]);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(slices_fill_the_picture)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
