// 3x4 matrices of nodes: rows, in double.
#ifndef GIRIH_VIEWER_NODE_TRANSFORM_H
#define GIRIH_VIEWER_NODE_TRANSFORM_H

#include "gltf.h"

#ifdef __cplusplus
extern "C" {
#endif

void girih_node_matrix(const girih_gltf_transform *local, double matrix[12]);

// product = a b; product may be neither of the two.
void girih_matrix_product(const double a[12], const double b[12], double product[12]);

// As floats, never infinite.
void girih_matrix_round(const double from[12], float to[12]);

double girih_matrix_determinant(const double matrix[12]); // of its left 3x3 part

#ifdef __cplusplus
}
#endif

#endif
