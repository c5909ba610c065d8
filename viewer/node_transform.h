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

#ifdef __cplusplus
}
#endif

#endif
