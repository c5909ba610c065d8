#include "node_transform.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void rotation_matrix(const double quaternion[4], double m[12]) {
    double x = quaternion[0], y = quaternion[1], z = quaternion[2], w = quaternion[3];
    const double length = sqrt(x * x + y * y + z * z + w * w);
    const double scale = length > 0.0 && isfinite(length) ? 1.0 / length : 0.0;
    x *= scale;
    y *= scale;
    z *= scale;
    w *= scale;
    // With all of them 0 it is the identity.
    const double rows[12] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),     0,
        2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),     0,
        2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y), 0};
    memcpy(m, rows, sizeof rows);
}

void girih_node_matrix(const girih_gltf_transform *local, double matrix[12]) {
    if (local->has_matrix) {
        memcpy(matrix, local->matrix, sizeof local->matrix);
        return;
    }
    rotation_matrix(local->rotation, matrix);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            matrix[4 * row + column] *= local->scale[column];
        }
        matrix[4 * row + 3] = local->translation[row];
    }
}

void girih_matrix_product(const double a[12], const double b[12], double product[12]) {
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            double sum = column == 3 ? a[4 * row + 3] : 0.0;
            for (int k = 0; k < 3; k++) {
                sum += a[4 * row + k] * b[4 * k + column];
            }
            product[4 * row + column] = sum;
        }
    }
}

void girih_matrix_round(const double from[12], float to[12]) {
    for (int n = 0; n < 12; n++) {
        to[n] = (float)fmin(fmax(from[n], -(double)FLT_MAX), (double)FLT_MAX);
    }
}

double girih_matrix_determinant(const double matrix[12]) {
    const double *a = matrix, *b = matrix + 4, *c = matrix + 8;
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}
