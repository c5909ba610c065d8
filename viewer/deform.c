#include "deform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "node_transform.h"

// --- What is worked out once ---

// The sources' primitives: which one each vertex is of, and where in it.
static void find_vertices(girih_deformer *deformer, const uint32_t *sources) {
    const girih_gltf_mesh *mesh = deformer->mesh;
    uint32_t primitive = 0;
    uint32_t first = 0; // vertex of the primitive
    for (uint32_t v = 0; v < deformer->vertex_count; v++) {
        uint32_t source = sources[v];
        while (source < first) {
            first -= mesh->primitives[--primitive].vertex_count;
        }
        while (source - first >= mesh->primitives[primitive].vertex_count) {
            first += mesh->primitives[primitive++].vertex_count;
        }
        deformer->primitives[v] = primitive;
        deformer->vertices[v] = source - first;
    }
}

// Writes the influences of a vertex, by joint, then weight, the joints' sums made 1; returns their
// number. Files list them in any order, which must not decide how their sum is rounded.
static uint32_t sort_influences(const girih_gltf_primitive *primitive, uint32_t vertex,
                                uint32_t *joints, float *weights) {
    size_t first = (size_t)vertex * primitive->influence_count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < primitive->influence_count; i++) {
        uint32_t joint = primitive->joints[first + i];
        float weight = primitive->weights[first + i];
        if (!(weight > 0.0f)) {
            continue;
        }
        uint32_t at = count++;
        while (at > 0 &&
               (joints[at - 1] > joint || (joints[at - 1] == joint && weights[at - 1] > weight))) {
            joints[at] = joints[at - 1];
            weights[at] = weights[at - 1];
            at--;
        }
        joints[at] = joint;
        weights[at] = weight;
    }
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        sum += (double)weights[i];
    }
    for (uint32_t i = 0; i < count; i++) {
        weights[i] = (float)((double)weights[i] / sum);
    }
    return count;
}

bool girih_deformer_create(girih_deformer *deformer, const girih_gltf_mesh *mesh,
                           const uint32_t *sources, uint32_t vertex_count) {
    size_t room = (size_t)vertex_count + 1;
    *deformer = (girih_deformer){.mesh = mesh, .vertex_count = vertex_count};
    deformer->primitives = malloc(room * sizeof *deformer->primitives);
    deformer->vertices = malloc(room * sizeof *deformer->vertices);
    deformer->first_influences = malloc(room * sizeof *deformer->first_influences);
    if (deformer->primitives == NULL || deformer->vertices == NULL ||
        deformer->first_influences == NULL) {
        return false;
    }
    find_vertices(deformer, sources);
    size_t influences = 0;
    for (uint32_t v = 0; v < vertex_count; v++) {
        influences += mesh->primitives[deformer->primitives[v]].influence_count;
    }
    if (influences > UINT32_MAX) {
        return false;
    }
    deformer->joints = malloc((influences + 1) * sizeof *deformer->joints);
    deformer->weights = malloc((influences + 1) * sizeof *deformer->weights);
    if (deformer->joints == NULL || deformer->weights == NULL) {
        return false;
    }
    uint32_t next = 0;
    for (uint32_t v = 0; v < vertex_count; v++) {
        deformer->first_influences[v] = next;
        next += sort_influences(&mesh->primitives[deformer->primitives[v]], deformer->vertices[v],
                                deformer->joints + next, deformer->weights + next);
    }
    deformer->first_influences[vertex_count] = next;
    return true;
}

void girih_deformer_free(girih_deformer *deformer) {
    free(deformer->primitives);
    free(deformer->vertices);
    free(deformer->first_influences);
    free(deformer->joints);
    free(deformer->weights);
    *deformer = (girih_deformer){0};
}

// --- Morph targets ---

static void add_deltas(float *to, const float *deltas, float weight) {
    for (int c = 0; c < 3; c++) {
        to[c] += weight * deltas[c];
    }
}

static void add_target(const girih_deformer *deformer, uint32_t target, float weight,
                       float *positions, float *normals) {
    for (size_t v = 0; v < deformer->vertex_count; v++) {
        const girih_gltf_morph_target *from =
            &deformer->mesh->primitives[deformer->primitives[v]].targets[target];
        size_t vertex = 3 * (size_t)deformer->vertices[v];
        if (from->positions != NULL) {
            add_deltas(positions + 3 * v, from->positions + vertex, weight);
        }
        if (from->normals != NULL) {
            add_deltas(normals + 3 * v, from->normals + vertex, weight);
        }
    }
}

// --- Skins ---

// From the mesh's space to the placement's: of each of the skin's joints, and behind them of the
// node itself, which moves what no joint does.
static float (*skin_matrices(const girih_pose *pose, uint32_t node))[12] {
    const girih_gltf_skin *skin = &pose->file->skins[pose->file->nodes[node].skin];
    float(*matrices)[12] = malloc(((size_t)skin->joint_count + 1) * sizeof *matrices);
    if (matrices == NULL) {
        return NULL;
    }
    bool is_mirrored = girih_matrix_determinant(pose->worlds[node]) < 0.0;
    for (uint32_t j = 0; j <= skin->joint_count; j++) {
        double product[12];
        if (j < skin->joint_count) {
            double inverse_bind[12];
            for (int n = 0; n < 12; n++) {
                inverse_bind[n] = (double)skin->inverse_bind_matrices[j][n];
            }
            girih_matrix_product(pose->worlds[skin->joints[j]], inverse_bind, product);
        } else {
            memcpy(product, pose->worlds[node], sizeof product);
        }
        for (int n = 0; n < 4; n++) {
            product[n] = is_mirrored ? -product[n] : product[n];
        }
        girih_matrix_round(product, matrices[j]);
    }
    return matrices;
}

static void move_point(const float m[12], float point[3]) {
    const float p[3] = {point[0], point[1], point[2]};
    for (int row = 0; row < 3; row++) {
        point[row] =
            m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
    }
}

// By the cofactors, which turn a normal as the matrix turns the surface it stands on.
static void turn_normal(const float m[12], float normal[3]) {
    const float *a = m, *b = m + 4, *c = m + 8, *n = normal;
    const float turned[3] = {
        (b[1] * c[2] - b[2] * c[1]) * n[0] + (b[2] * c[0] - b[0] * c[2]) * n[1] +
            (b[0] * c[1] - b[1] * c[0]) * n[2],
        (c[1] * a[2] - c[2] * a[1]) * n[0] + (c[2] * a[0] - c[0] * a[2]) * n[1] +
            (c[0] * a[1] - c[1] * a[0]) * n[2],
        (a[1] * b[2] - a[2] * b[1]) * n[0] + (a[2] * b[0] - a[0] * b[2]) * n[1] +
            (a[0] * b[1] - a[1] * b[0]) * n[2]};
    double square = 0.0; // in double, where no float's square is lost
    for (int k = 0; k < 3; k++) {
        square += (double)turned[k] * (double)turned[k];
    }
    double scale = square > 0.0 && isfinite(square) ? 1.0 / sqrt(square) : 0.0;
    for (int k = 0; k < 3; k++) {
        normal[k] = scale > 0.0 ? (float)((double)turned[k] * scale) : 0.0f;
    }
}

static void apply_skin(const girih_deformer *deformer, float (*matrices)[12], uint32_t joint_count,
                       float *positions, float *normals) {
    for (size_t v = 0; v < deformer->vertex_count; v++) {
        float blend[12] = {0};
        uint32_t first = deformer->first_influences[v];
        uint32_t end = deformer->first_influences[v + 1];
        for (uint32_t i = first; i < end; i++) {
            const float *matrix = matrices[deformer->joints[i]];
            for (int n = 0; n < 12; n++) {
                blend[n] += deformer->weights[i] * matrix[n];
            }
        }
        const float *matrix = end > first ? blend : matrices[joint_count];
        move_point(matrix, positions + 3 * v);
        turn_normal(matrix, normals + 3 * v);
    }
}

bool girih_deform(const girih_deformer *deformer, const girih_pose *pose, uint32_t node,
                  const float *from_positions, const float *from_normals, float *positions,
                  float *normals) {
    size_t size = (size_t)deformer->vertex_count * 3 * sizeof(float);
    memcpy(positions, from_positions, size);
    memcpy(normals, from_normals, size);
    for (uint32_t t = 0; t < deformer->mesh->target_count; t++) {
        float weight = (float)pose->weights[pose->first_weights[node] + t];
        if (weight != 0.0f) {
            add_target(deformer, t, weight, positions, normals);
        }
    }
    int32_t skin = pose->file->nodes[node].skin;
    if (skin < 0) {
        return true;
    }
    float(*matrices)[12] = skin_matrices(pose, node);
    if (matrices == NULL) {
        return false;
    }
    apply_skin(deformer, matrices, pose->file->skins[skin].joint_count, positions, normals);
    free(matrices);
    return true;
}
