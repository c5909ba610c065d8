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

// --- Heights of a mesh's triangle ---

static float attribute(const girih_mesh *mesh, const uint32_t vertices[3], const float b[3],
                       uint32_t n) {
    const float *attributes = mesh->attributes + n;
    size_t stride = mesh->attribute_floats;
    return (attributes[stride * vertices[0]] * b[0] + attributes[stride * vertices[1]] * b[1]) +
           attributes[stride * vertices[2]] * b[2];
}

// girih_mesh_place of glsl/own.glsl.
static void mesh_place(const girih_mesh *mesh, const uint32_t vertices[3], const float b[3],
                       float position[3], float normal[3]) {
    for (int n = 0; n < 3; n++) {
        position[n] = normal[n] = 0.0f;
        for (int corner = 0; corner < 3; corner++) {
            size_t at = 3 * (size_t)vertices[corner] + (size_t)n;
            position[n] += mesh->positions[at] * b[corner];
            normal[n] += mesh->normals[at] * b[corner];
        }
    }
    float square = (normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2];
    float inverse = square > 0.0f ? 1.0f / sqrtf(square) : 0.0f;
    for (int n = 0; n < 3; n++) {
        normal[n] *= inverse;
    }
}

// girih_height_by_axes of glsl/displace.glsl.
static float height_by_axes(const girih_displacement *displacement, const girih_mesh *mesh,
                            const uint32_t vertices[3], const float barycentric[3]) {
    float p[3], n[3], weight[3];
    mesh_place(mesh, vertices, barycentric, p, n);
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

// girih_own_height of shaders/displaced.glsl.
static float own_height(const girih_displacement *displacement, const girih_mesh *mesh,
                        uint32_t triangle, const float barycentric[3]) {
    const uint32_t *vertices = mesh->triangle_vertices + 3 * (size_t)triangle;
    if (displacement->by_axes) {
        return height_by_axes(displacement, mesh, vertices, barycentric);
    }
    uint32_t n = displacement->texcoord_float;
    float u = attribute(mesh, vertices, barycentric, n);
    float v = attribute(mesh, vertices, barycentric, n + 1);
    return girih_displacement_height(&displacement->map, u, v);
}

// The height at a corner, 3 * triangle + 0..2.
static float corner_height(const girih_displacement *displacement, const girih_mesh *mesh,
                           uint32_t corner) {
    float barycentric[3] = {0.0f, 0.0f, 0.0f};
    barycentric[corner % 3] = 1.0f;
    return own_height(displacement, mesh, corner / 3, barycentric);
}

// --- Heights that meet at seams: glsl/seamless.glsl ---

static float ease(float x) {
    return x * x * (3.0f - 2.0f * x);
}

static float dot(const float a[3], const float b[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static float corners_lacking(const float weights[3], const float apart[3], const float lacking[3]) {
    float sum = dot(weights, apart);
    return sum > 0.0f ? ease(sum) / sum * dot(weights, lacking) : 0.0f;
}

static uint32_t edge_end(uint32_t edge) {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
}

static bool runs_backwards(const girih_mesh *mesh, uint32_t edge) {
    return mesh->triangle_weld_edges[edge] >> 31 != 0;
}

static uint32_t point_owner(const girih_mesh *mesh, uint32_t corner) {
    return mesh->vertex_owner[mesh->vertex_point[mesh->triangle_vertices[corner]]];
}

static bool is_apart(const girih_mesh *mesh, uint32_t corner) {
    return mesh->triangle_vertices[point_owner(mesh, corner)] != mesh->triangle_vertices[corner];
}

static float edge_height(const girih_displacement *displacement, const girih_mesh *mesh,
                         uint32_t first, uint32_t second, float t, const float points[2]) {
    float barycentric[3] = {0.0f, 0.0f, 0.0f};
    barycentric[first % 3] = 1.0f - t;
    barycentric[second % 3] = t;
    float weights[3] = {1.0f - t, t, 0.0f};
    float apart[3] = {is_apart(mesh, first) ? 1.0f : 0.0f, is_apart(mesh, second) ? 1.0f : 0.0f,
                      0.0f};
    float lacking[3] = {points[0] - corner_height(displacement, mesh, first),
                        points[1] - corner_height(displacement, mesh, second), 0.0f};
    return own_height(displacement, mesh, first / 3, barycentric) +
           corners_lacking(weights, apart, lacking);
}

static float seamless_height(const girih_displacement *displacement, const girih_mesh *mesh,
                             uint32_t triangle, const float b[3]) {
    const uint32_t *vertices = mesh->triangle_vertices;
    uint32_t firsts[3], seconds[3]; // the edges' owners' corners
    float apart[3];
    bool parted[3];
    bool is_seam = false;
    for (uint32_t n = 0; n < 3; n++) {
        uint32_t corner = 3 * triangle + n;
        uint32_t owner = mesh->edge_owner[mesh->triangle_edges[corner]];
        bool same_way = runs_backwards(mesh, corner) == runs_backwards(mesh, owner);
        firsts[n] = same_way ? owner : edge_end(owner);
        seconds[n] = same_way ? edge_end(owner) : owner;
        parted[n] = vertices[firsts[n]] != vertices[corner] ||
                    vertices[seconds[n]] != vertices[edge_end(corner)];
        apart[n] = is_apart(mesh, corner) ? 1.0f : 0.0f;
        is_seam = is_seam || parted[n] || is_apart(mesh, corner);
    }
    float height = own_height(displacement, mesh, triangle, b);
    if (!is_seam) {
        return height;
    }
    float points[3], lacking[3];
    for (uint32_t n = 0; n < 3; n++) {
        uint32_t corner = 3 * triangle + n;
        points[n] = corner_height(displacement, mesh, point_owner(mesh, corner));
        lacking[n] = points[n] - corner_height(displacement, mesh, corner);
    }
    height += corners_lacking(b, apart, lacking);
    for (uint32_t n = 0; n < 3; n++) {
        uint32_t end = (n + 1) % 3;
        float third = b[(n + 2) % 3];
        float along = b[n] + b[end];
        float weight = (b[n] + third) * (b[end] + third);
        if (!parted[n] || weight == 0.0f || along == 0.0f) {
            continue;
        }
        float t = b[end] / along;
        float ends[2] = {points[n], points[end]};
        float wanted = edge_height(displacement, mesh, firsts[n], seconds[n], t, ends);
        float reached =
            edge_height(displacement, mesh, 3 * triangle + n, 3 * triangle + end, t, ends);
        height += ease(b[n] * b[end] / weight) * (wanted - reached);
    }
    return height;
}

void girih_displacement_surface(void *user, const girih_cpu_patch *patch,
                                const float barycentric[3], float position[3]) {
    const girih_displacement *displacement = user;
    float normal[3], offset[3];
    girih_cpu_base_position(patch, barycentric, position);
    girih_cpu_base_normal(patch, barycentric, normal);
    float height = seamless_height(displacement, patch->mesh, patch->triangle, barycentric);
    height = fminf(fmaxf(height, displacement->map.minimum), displacement->map.maximum);
    girih_cpu_displacement(patch, normal, (height - displacement->zero) * displacement->per_unit,
                           offset);
    for (int n = 0; n < 3; n++) {
        position[n] += offset[n];
    }
}
