// Smooth shapes of a given number of triangles.
#include <math.h>
#include <stddef.h>

#include "bench.h"

#define PI 3.14159265358979323846

// A point with its normal, without -0.
static void set_vertex(bench_mesh *mesh, uint32_t vertex, const double position[3],
                       const double normal[3]) {
    const double length =
        sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (size_t n = 0; n < 3; ++n) {
        mesh->positions[3 * (size_t)vertex + n] = (float)position[n] + 0.0f;
        mesh->normals[3 * (size_t)vertex + n] = (float)(normal[n] / length) + 0.0f;
    }
}

static void add_triangle(bench_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *corners = mesh->indices + 3 * (size_t)mesh->triangle_count++;
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

static void set_ellipsoid_vertex(bench_mesh *mesh, uint32_t vertex, const float radii[3],
                                 double latitude, double longitude) {
    const double unit[3] = {cos(latitude) * cos(longitude), cos(latitude) * sin(longitude),
                            sin(latitude)};
    double position[3], normal[3];
    for (int n = 0; n < 3; ++n) {
        position[n] = unit[n] * (double)radii[n];
        normal[n] = unit[n] / (double)radii[n];
    }
    set_vertex(mesh, vertex, position, normal);
}

girih_result bench_ellipsoid(uint32_t slices, uint32_t stacks, const float radii[3],
                             bench_mesh *mesh, girih_error *error) {
    const uint32_t rings = stacks - 1;
    const girih_result result =
        bench_mesh_allocate(mesh, slices * rings + 2, 2 * slices * rings, error);
    if (result != GIRIH_OK) {
        return result;
    }
    mesh->name = "ellipsoid";
    mesh->triangle_count = 0;
    const uint32_t south = slices * rings;
    const uint32_t north = south + 1;
    set_ellipsoid_vertex(mesh, south, radii, -PI / 2, 0.0);
    set_ellipsoid_vertex(mesh, north, radii, PI / 2, 0.0);
    for (uint32_t ring = 0; ring < rings; ++ring) {
        for (uint32_t slice = 0; slice < slices; ++slice) {
            const uint32_t next = (slice + 1) % slices;
            const uint32_t at = ring * slices;
            set_ellipsoid_vertex(mesh, at + slice, radii, PI * (ring + 1) / stacks - PI / 2,
                                 2 * PI * slice / slices);
            if (ring == 0) {
                add_triangle(mesh, south, next, slice);
            }
            if (ring + 1 == rings) {
                add_triangle(mesh, at + slice, at + next, north);
            } else {
                add_triangle(mesh, at + slice, at + next, at + slices + next);
                add_triangle(mesh, at + slice, at + slices + next, at + slices + slice);
            }
        }
    }
    return GIRIH_OK;
}

girih_result bench_torus(uint32_t slices, uint32_t sides, float radius, float thickness,
                         bench_mesh *mesh, girih_error *error) {
    const girih_result result =
        bench_mesh_allocate(mesh, slices * sides, 2 * slices * sides, error);
    if (result != GIRIH_OK) {
        return result;
    }
    mesh->name = "torus";
    mesh->triangle_count = 0;
    for (uint32_t slice = 0; slice < slices; ++slice) {
        for (uint32_t side = 0; side < sides; ++side) {
            const double around = 2 * PI * slice / slices;
            const double about = 2 * PI * side / sides;
            const double normal[3] = {cos(about) * cos(around), cos(about) * sin(around),
                                      sin(about)};
            const double spoke = (double)radius + (double)thickness * cos(about);
            const double position[3] = {spoke * cos(around), spoke * sin(around),
                                        (double)thickness * sin(about)};
            const uint32_t next_slice = (slice + 1) % slices * sides;
            const uint32_t next_side = (side + 1) % sides;
            set_vertex(mesh, slice * sides + side, position, normal);
            add_triangle(mesh, slice * sides + side, next_slice + side, next_slice + next_side);
            add_triangle(mesh, slice * sides + side, next_slice + next_side,
                         slice * sides + next_side);
        }
    }
    return GIRIH_OK;
}
