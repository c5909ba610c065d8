#include "morph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cpu/pn.h"
#include "cpu/surfaces.h"

// --- The morphed mesh ---

static girih_vector read_vector(const float *from) {
    return (girih_vector){from[0], from[1], from[2]};
}

static void write_vector(float *to, girih_vector value) {
    to[0] = value.x;
    to[1] = value.y;
    to[2] = value.z;
}

static bool is_zero(const float *vector) {
    return vector[0] == 0.0f && vector[1] == 0.0f && vector[2] == 0.0f;
}

static void move_vertex(girih_morphed_mesh *morphed, uint32_t vertex,
                        const girih_gltf_primitive *primitive, uint32_t target, uint32_t source) {
    const girih_gltf_morph_target *deltas = &primitive->targets[target];
    float *position = morphed->positions + 3 * (size_t)vertex;
    float *normal = morphed->normals + 3 * (size_t)vertex;
    if (deltas->positions != NULL && !is_zero(deltas->positions + 3 * (size_t)source)) {
        girih_vector moved =
            girih_add(read_vector(position), read_vector(deltas->positions + 3 * (size_t)source));
        write_vector(position, girih_no_negative_zeros(moved));
        morphed->is_moved[vertex] = true;
    }
    if (deltas->normals != NULL && primitive->normals != NULL &&
        !is_zero(deltas->normals + 3 * (size_t)source)) {
        girih_vector turned = girih_add(read_vector(primitive->normals + 3 * (size_t)source),
                                        read_vector(deltas->normals + 3 * (size_t)source));
        write_vector(normal, girih_no_negative_zeros(girih_normalize(turned)));
        morphed->is_moved[vertex] = true;
    }
}

// The vertex that stands for all that share its made normal: the lowest one at the same point
// with the same normal before.
static uint32_t find_smooth(const girih_mesh *mesh, uint32_t vertex, const bool *is_made,
                            const uint32_t *next_at_point) {
    uint32_t n = mesh->vertex_point[vertex];
    while (is_made[n] != is_made[vertex] ||
           memcmp(mesh->normals + 3 * (size_t)n, mesh->normals + 3 * (size_t)vertex, 12) != 0) {
        n = next_at_point[n];
    }
    return n;
}

static void add_face(const girih_morphed_mesh *morphed, uint32_t triangle, const uint32_t *smooth,
                     double (*sums)[3]) {
    const uint32_t *vertices = morphed->base->triangle_vertices + 3 * (size_t)triangle;
    double edges[3][3]; // from each corner to the next
    for (int c = 0; c < 3; c++) {
        const float *from = morphed->positions + 3 * (size_t)vertices[c];
        const float *to = morphed->positions + 3 * (size_t)vertices[(c + 1) % 3];
        for (int n = 0; n < 3; n++) {
            edges[c][n] = (double)to[n] - (double)from[n];
        }
    }
    const double cross[3] = {edges[0][1] * edges[1][2] - edges[0][2] * edges[1][1],
                             edges[0][2] * edges[1][0] - edges[0][0] * edges[1][2],
                             edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0]};
    const double area = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    for (int c = 0; c < 3 && area > 0.0; c++) {
        const double *out = edges[c];
        const double *in = edges[(c + 2) % 3];
        const double angle = atan2(area, -(out[0] * in[0] + out[1] * in[1] + out[2] * in[2]));
        for (int n = 0; n < 3; n++) {
            sums[smooth[vertices[c]]][n] += cross[n] / area * angle;
        }
    }
}

// Primitives without normals have ones that were made of the positions; so have they here: means of
// the faces' normals weighted by angles, over the vertices that had one normal before.
static bool make_normals(girih_morphed_mesh *morphed, const bool *is_made) {
    const girih_mesh *mesh = morphed->base;
    uint32_t *next_at_point = malloc((size_t)mesh->vertex_count * 4 + 1);
    uint32_t *smooth = malloc((size_t)mesh->vertex_count * 4 + 1);
    uint32_t *last = malloc((size_t)mesh->vertex_count * 4 + 1);
    double(*sums)[3] = calloc((size_t)mesh->vertex_count + 1, sizeof *sums);
    bool done = next_at_point != NULL && smooth != NULL && last != NULL && sums != NULL;
    if (done) {
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            uint32_t point = mesh->vertex_point[v];
            next_at_point[point == v ? v : last[point]] = v;
            last[point] = v;
        }
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            smooth[v] = find_smooth(mesh, v, is_made, next_at_point);
        }
        for (uint32_t t = 0; t < mesh->triangle_count; t++) {
            add_face(morphed, t, smooth, sums);
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count && done; v++) {
        const double *sum = sums[smooth[v]];
        const double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        if (is_made[v] && length > 0.0) {
            const girih_vector normal = {(float)(sum[0] / length), (float)(sum[1] / length),
                                         (float)(sum[2] / length)};
            write_vector(morphed->normals + 3 * (size_t)v, girih_no_negative_zeros(normal));
            morphed->is_moved[v] = true;
        }
    }
    free(next_at_point);
    free(smooth);
    free(last);
    free(sums);
    return done;
}

bool girih_morphed_mesh_make(girih_morphed_mesh *morphed, const girih_mesh *mesh,
                             const girih_gltf_mesh *source, const uint32_t *sources,
                             uint32_t target) {
    const size_t bytes = (size_t)mesh->vertex_count * 12;
    *morphed = (girih_morphed_mesh){
        .base = mesh,
        .positions = malloc(bytes + 1),
        .normals = malloc(bytes + 1),
        .is_moved = calloc((size_t)mesh->vertex_count + 1, sizeof *morphed->is_moved),
    };
    bool *is_made = calloc((size_t)mesh->vertex_count + 1, sizeof *is_made);
    if (morphed->positions == NULL || morphed->normals == NULL || morphed->is_moved == NULL ||
        is_made == NULL) {
        free(is_made);
        return false;
    }
    memcpy(morphed->positions, mesh->positions, bytes);
    memcpy(morphed->normals, mesh->normals, bytes);
    bool any_made = false;
    bool any_moved = false;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t vertex = sources[v];
        uint32_t p = 0;
        while (vertex >= source->primitives[p].vertex_count) {
            vertex -= source->primitives[p++].vertex_count;
        }
        move_vertex(morphed, v, &source->primitives[p], target, vertex);
        is_made[v] = source->primitives[p].normals == NULL;
        any_made |= is_made[v];
        any_moved |= morphed->is_moved[v];
    }
    const bool done = !any_made || !any_moved || make_normals(morphed, is_made);
    free(is_made);
    return done;
}

void girih_morphed_mesh_free(girih_morphed_mesh *morphed) {
    free(morphed->positions);
    free(morphed->normals);
    free(morphed->is_moved);
    *morphed = (girih_morphed_mesh){0};
}

// --- Patches ---

// The edge's control points where it is a seam: the mean of both sides' curves, as girih_pn_edge.
static void mend_seam(const girih_mesh *mesh, const float *normals, uint32_t edge, uint32_t from,
                      girih_vector p, girih_vector q, girih_vector *near_p, girih_vector *near_q) {
    if (edge >= mesh->seam_count) {
        return;
    }
    const uint32_t *seam = mesh->seams + 4 * (size_t)edge;
    const uint32_t at_p = mesh->edge_points[2 * (size_t)edge] == mesh->vertex_point[from] ? 0 : 1;
    const girih_vector a_p = read_vector(normals + 3 * (size_t)seam[at_p]);
    const girih_vector a_q = read_vector(normals + 3 * (size_t)seam[1 - at_p]);
    const girih_vector b_p = read_vector(normals + 3 * (size_t)seam[2 + at_p]);
    const girih_vector b_q = read_vector(normals + 3 * (size_t)seam[3 - at_p]);
    *near_p = girih_scale(girih_add(girih_pn_edge_point(p, q, a_p), girih_pn_edge_point(p, q, b_p)),
                          0.5f);
    *near_q = girih_scale(girih_add(girih_pn_edge_point(q, p, a_q), girih_pn_edge_point(q, p, b_q)),
                          0.5f);
}

static void make_patch(const girih_mesh *mesh, const float *positions, const float *normals,
                       uint32_t triangle, girih_surface surface, girih_patch *patch) {
    const uint32_t *vertices = mesh->triangle_vertices + 3 * (size_t)triangle;
    const uint32_t *edges = mesh->triangle_edges + 3 * (size_t)triangle;
    girih_vector p[3];
    girih_vector n[3];
    for (int c = 0; c < 3; c++) {
        p[c] = read_vector(positions + 3 * (size_t)vertices[c]);
        n[c] = read_vector(normals + 3 * (size_t)vertices[c]);
    }
    *patch = (girih_patch){
        .surface = surface,
        .b300 = p[0],
        .b030 = p[1],
        .b003 = p[2],
        .n200 = n[0],
        .n020 = n[1],
        .n002 = n[2],
    };
    if (surface != GIRIH_SURFACE_PN) {
        return;
    }
    girih_pn_points c = girih_make_smooth_pn_points(p, n);
    mend_seam(mesh, normals, edges[0], vertices[0], p[0], p[1], &c.b210, &c.b120);
    mend_seam(mesh, normals, edges[1], vertices[1], p[1], p[2], &c.b021, &c.b012);
    mend_seam(mesh, normals, edges[2], vertices[2], p[2], p[0], &c.b102, &c.b201);
    c.b111 = girih_pn_middle(p, &c);
    patch->b210 = c.b210;
    patch->b120 = c.b120;
    patch->b021 = c.b021;
    patch->b012 = c.b012;
    patch->b102 = c.b102;
    patch->b201 = c.b201;
    patch->b111 = c.b111;
    patch->n110 = girih_pn_edge_normal(p[0], p[1], n[0], n[1]);
    patch->n011 = girih_pn_edge_normal(p[1], p[2], n[1], n[2]);
    patch->n101 = girih_pn_edge_normal(p[2], p[0], n[2], n[0]);
}

// Whether a triangle's patch is another after the morph.
static bool is_triangle_moved(const girih_morphed_mesh *morphed, uint32_t triangle) {
    const girih_mesh *mesh = morphed->base;
    for (size_t n = 3 * (size_t)triangle; n < 3 * (size_t)triangle + 3; n++) {
        if (morphed->is_moved[mesh->triangle_vertices[n]]) {
            return true;
        }
        const uint32_t edge = mesh->triangle_edges[n];
        for (size_t s = 0; s < 4 && edge < mesh->seam_count; s++) {
            if (morphed->is_moved[mesh->seams[4 * (size_t)edge + s]]) {
                return true;
            }
        }
    }
    return false;
}

// --- Vertices ---

// On an edge two terms count, and + 0 makes -0 the same as 0.
static float interpolate(const float *values, uint32_t components, uint32_t component,
                         const uint32_t corners[3], const float b[3]) {
    const float *from = values + component;
    return girih_patch_attribute(from[(size_t)corners[0] * components],
                                 from[(size_t)corners[1] * components],
                                 from[(size_t)corners[2] * components], b[0], b[1], b[2]) +
           0.0f;
}

static int corner_of(const float b[3]) {
    return b[0] == 1.0f ? 0 : b[1] == 1.0f ? 1 : b[2] == 1.0f ? 2 : -1;
}

static void morph_surface(const girih_morphed_mesh *morphed, const girih_gltf_morph_target *deltas,
                          girih_surface surface, const girih_placed_vertices *vertices,
                          girih_morph_arrays *arrays) {
    const girih_mesh *mesh = morphed->base;
    girih_patch before;
    girih_patch after;
    uint32_t triangle = UINT32_MAX;
    bool moves = false;
    for (uint32_t v = 0; v < vertices->count; v++) {
        if (vertices->triangles[v] != triangle) {
            triangle = vertices->triangles[v];
            moves = is_triangle_moved(morphed, triangle);
            if (moves) {
                make_patch(mesh, mesh->positions, mesh->normals, triangle, surface, &before);
                make_patch(mesh, morphed->positions, morphed->normals, triangle, surface, &after);
            }
        }
        const float *b = vertices->barycentrics[v];
        const int corner = corner_of(b);
        girih_vector position = {0.0f, 0.0f, 0.0f};
        girih_vector normal = position;
        if (moves) {
            position = girih_subtract(girih_patch_position(&after, b[0], b[1], b[2]),
                                      girih_patch_position(&before, b[0], b[1], b[2]));
            normal = girih_subtract(girih_patch_unit_normal(&after, b[0], b[1], b[2]),
                                    girih_patch_unit_normal(&before, b[0], b[1], b[2]));
        }
        uint32_t corners[3];
        girih_placed_corners(vertices, v, corners);
        if (corner >= 0 && deltas->positions != NULL) {
            position = read_vector(deltas->positions + 3 * (size_t)corners[corner]);
        }
        if (corner >= 0 && deltas->normals != NULL) {
            normal = read_vector(deltas->normals + 3 * (size_t)corners[corner]);
        }
        if (arrays->positions != NULL) {
            write_vector(arrays->positions + 3 * (size_t)v, girih_no_negative_zeros(position));
        }
        if (arrays->normals != NULL) {
            write_vector(arrays->normals + 3 * (size_t)v, girih_no_negative_zeros(normal));
        }
    }
}

static void morph_attribute(const girih_gltf_attribute *deltas,
                            const girih_placed_vertices *vertices, float *to) {
    for (uint32_t v = 0; v < vertices->count; v++) {
        uint32_t corners[3];
        girih_placed_corners(vertices, v, corners);
        for (uint32_t c = 0; c < deltas->components; c++) {
            to[(size_t)v * deltas->components + c] = interpolate(
                deltas->values, deltas->components, c, corners, vertices->barycentrics[v]);
        }
    }
}

static bool is_pn(girih_surface surface) {
    return surface == GIRIH_SURFACE_PN;
}

bool girih_morph_vertices(const girih_morphed_mesh *morphed, const girih_gltf_primitive *source,
                          uint32_t target, girih_surface surface, bool has_normals,
                          const girih_placed_vertices *vertices, girih_morph_arrays *arrays) {
    const girih_gltf_morph_target *deltas = &source->targets[target];
    // Normals have a say in PN surfaces, and made ones follow the positions.
    const bool moves = deltas->positions != NULL || (is_pn(surface) && deltas->normals != NULL);
    const bool turns = has_normals && (deltas->normals != NULL || source->normals == NULL);
    const size_t count = vertices->count;
    bool done = true;
    if (moves) {
        done = (arrays->positions = malloc(count * 12 + 1)) != NULL;
    }
    if (turns && done) {
        done = (arrays->normals = malloc(count * 12 + 1)) != NULL;
    }
    arrays->attributes = calloc((size_t)deltas->attribute_count + 1, sizeof *arrays->attributes);
    done = done && arrays->attributes != NULL;
    if (done && (moves || turns)) {
        morph_surface(morphed, deltas, surface, vertices, arrays);
    }
    for (uint32_t a = 0; a < deltas->attribute_count && done; a++) {
        const girih_gltf_attribute *attribute = &deltas->attributes[a];
        arrays->attributes[a] = malloc(count * attribute->components * 4 + 1);
        done = arrays->attributes[a] != NULL;
        if (done) {
            morph_attribute(attribute, vertices, arrays->attributes[a]);
        }
    }
    return done;
}
