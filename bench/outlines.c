#include "outlines.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "error.h"

#define PIXELS 1000.0

// Pixels from the top left corner.
static void project(const bench_view *view, const float *p, double at[2]) {
    double clip[4];
    for (int n = 0; n < 4; ++n) {
        const float *row = view->rows[n];
        clip[n] = (double)row[0] * (double)p[0] + (double)row[1] * (double)p[1] +
                  (double)row[2] * (double)p[2] + (double)row[3];
    }
    at[0] = (clip[0] / clip[3] + 1.0) * 0.5 * PIXELS;
    at[1] = (clip[1] / clip[3] + 1.0) * 0.5 * PIXELS;
}

girih_result bench_outlines_write(const char *path, const bench_triangles *triangles,
                                  const bench_view *view, girih_error *error) {
    FILE *file = fopen(path, "w");
    if (!file) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s: %s", path, strerror(errno));
    }
    fprintf(file,
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g'>"
            "<rect width='100%%' height='100%%' fill='white'/>\n"
            "<path fill='none' stroke='black' stroke-width='0.7' stroke-linejoin='round' d='",
            PIXELS, PIXELS);
    for (uint32_t n = 0; n < triangles->count; ++n) {
        double at[3][2];
        for (int k = 0; k < 3; ++k) {
            project(view, triangles->corners[3 * (size_t)n + (size_t)k], at[k]);
        }
        const double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                            (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
        // Downwards is positive here: counterclockwise triangles have negative areas.
        if (area < 0.0) {
            fprintf(file, "M%.1f %.1fL%.1f %.1fL%.1f %.1fZ\n", at[0][0], at[0][1], at[1][0],
                    at[1][1], at[2][0], at[2][1]);
        }
    }
    fprintf(file, "'/></svg>\n");
    const bool written = !ferror(file);
    if (fclose(file) != 0 || !written) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s: cannot be written", path);
    }
    return GIRIH_OK;
}
