#include "displacement.h"

#include <math.h>

// The texels on either side of a place along one axis, the map repeating, and the second one's
// weight. The same operations in the same order as girih_texel_pair of glsl/displace.glsl.
static void texel_pair(float place, uint32_t size, uint32_t *first, uint32_t *second,
                       float *weight) {
    float at = (place - floorf(place)) * (float)size - 0.5f;
    float before = floorf(at);
    *weight = at - before;
    // Not below -1; a place that is not a number counts as the first texel.
    *first = before < 0.0f ? size - 1 : before < (float)size ? (uint32_t)before : 0;
    *second = *first + 1 == size ? 0 : *first + 1;
}

float girih_displacement_height(const girih_height_map *map, float u, float v) {
    uint32_t left, right, top, bottom;
    float weight_x, weight_y;
    texel_pair(u, map->width, &left, &right, &weight_x);
    texel_pair(v, map->height, &top, &bottom, &weight_y);
    const float *row0 = map->texels + (size_t)map->width * top;
    const float *row1 = map->texels + (size_t)map->width * bottom;
    float rest_x = 1.0f - weight_x;
    float height0 = row0[left] * rest_x + row0[right] * weight_x;
    float height1 = row1[left] * rest_x + row1[right] * weight_x;
    return height0 * (1.0f - weight_y) + height1 * weight_y;
}

float girih_displacement_distance(const girih_displacement *displacement) {
    float low = fabsf(displacement->map.minimum - displacement->zero);
    float high = fabsf(displacement->map.maximum - displacement->zero);
    // What filtering and moving round off.
    return fabsf(displacement->per_unit) * (low > high ? low : high) * 1.00001f;
}

static float attribute(const girih_cpu_patch *patch, const float b[3], uint32_t n) {
    const float *attributes = patch->mesh->attributes + n;
    size_t stride = patch->mesh->attribute_floats;
    return (attributes[stride * patch->vertices[0]] * b[0] +
            attributes[stride * patch->vertices[1]] * b[1]) +
           attributes[stride * patch->vertices[2]] * b[2];
}

// girih_mesh_place of glsl/own.glsl.
static void mesh_place(const girih_cpu_patch *patch, const float b[3], float position[3],
                       float normal[3]) {
    for (int n = 0; n < 3; n++) {
        position[n] = normal[n] = 0.0f;
        for (int corner = 0; corner < 3; corner++) {
            size_t at = 3 * (size_t)patch->vertices[corner] + (size_t)n;
            position[n] += patch->mesh->positions[at] * b[corner];
            normal[n] += patch->mesh->normals[at] * b[corner];
        }
    }
    float square = (normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2];
    float inverse = square > 0.0f ? 1.0f / sqrtf(square) : 0.0f;
    for (int n = 0; n < 3; n++) {
        normal[n] *= inverse;
    }
}

// girih_height_by_axes of glsl/displace.glsl.
static float height_by_axes(const girih_displacement *displacement, const girih_cpu_patch *patch,
                            const float barycentric[3]) {
    float p[3], n[3], weight[3];
    mesh_place(patch, barycentric, p, n);
    for (int axis = 0; axis < 3; axis++) {
        p[axis] *= displacement->repeats;
        float square = n[axis] * n[axis];
        weight[axis] = square * square;
    }
    float sum = (weight[0] + weight[1]) + weight[2];
    float along_x = girih_displacement_height(&displacement->map, -p[2], -p[1]);
    float along_y = girih_displacement_height(&displacement->map, p[0], p[2]);
    float along_z = girih_displacement_height(&displacement->map, p[0], -p[1]);
    float height = (along_x * weight[0] + along_y * weight[1]) + along_z * weight[2];
    return sum > 0.0f ? height / sum : along_x;
}

void girih_displacement_surface(void *user, const girih_cpu_patch *patch,
                                const float barycentric[3], float position[3]) {
    const girih_displacement *displacement = user;
    float normal[3], offset[3], height;
    girih_cpu_base_position(patch, barycentric, position);
    girih_cpu_base_normal(patch, barycentric, normal);
    if (displacement->by_axes) {
        height = height_by_axes(displacement, patch, barycentric);
    } else {
        float u = attribute(patch, barycentric, displacement->texcoord_float);
        float v = attribute(patch, barycentric, displacement->texcoord_float + 1);
        height = girih_displacement_height(&displacement->map, u, v);
    }
    girih_cpu_displacement(patch, normal, (height - displacement->zero) * displacement->per_unit,
                           offset);
    for (int n = 0; n < 3; n++) {
        position[n] += offset[n];
    }
}
