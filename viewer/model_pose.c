// A model in a pose: its meshes are prepared once, as they are in the file, whatever the pose is,
// and what its nodes deform is moved from there. So a pose has the topology, the creases and the
// made normals of every other, and a picture of a moment is the one that comes by while it plays.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "model.h"

static girih_result no_memory(girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

static girih_result find_animation(const girih_gltf_contents *file,
                                   const girih_pose_options *options,
                                   const girih_gltf_animation **animation, girih_error *error) {
    if (file->animation_count == 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "has no animations; leave --time and --animation out");
    }
    if (options->animation == NULL) {
        *animation = &file->animations[0];
        return GIRIH_OK;
    }
    *animation = girih_pose_find_animation(file, options->animation);
    if (*animation != NULL) {
        return GIRIH_OK;
    }
    char list[256] = "";
    size_t length = 0;
    for (uint32_t n = 0; n < file->animation_count && length < sizeof list; n++) {
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%u '%s'",
                                   n > 0 ? ", " : "", n, file->animations[n].name);
    }
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "has no animation '%s'; it has %s%s",
                      options->animation, list, length < sizeof list ? "" : "...");
}

girih_result girih_model_pose(girih_model *model, const girih_pose_options *options,
                              girih_error *error) {
    const girih_gltf_contents *file = model->contents;
    const girih_gltf_animation *animation = NULL;
    bool is_moment = options != NULL && (options->has_time || options->animation != NULL);
    if (is_moment) {
        girih_result result = find_animation(file, options, &animation, error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    model->pose = malloc(sizeof *model->pose);
    if (model->pose == NULL || !girih_pose_create(model->pose, file)) {
        return no_memory(error);
    }
    if (is_moment) {
        girih_pose_set(model->pose, animation, (double)options->time);
    }
    model->contents = &model->pose->contents;
    model->is_dynamic = model->contents->mesh_count > file->mesh_count;
    return GIRIH_OK;
}

// --- Moving meshes ---

static bool has_flat_normal(const girih_moving_mesh *moving, uint32_t vertex) {
    const girih_deformer *deformer = &moving->deformer;
    return moving->is_flat &&
           deformer->mesh->primitives[deformer->primitives[vertex]].normals == NULL;
}

// The unit vector of a sum, 0 where it has no length.
static void normalize(const double sum[3], double unit[3]) {
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int c = 0; c < 3; c++) {
        unit[c] = length > 0.0 ? sum[c] / length : 0.0;
    }
}

// Flat normals are the triangles' own in every pose. Triangles in one plane at rest may have a
// vertex in common, whose normal is the mean.
static void make_flat_normals(const girih_moving_mesh *moving, const float *positions,
                              float *normals) {
    const girih_mesh *mesh = moving->prepared;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (has_flat_normal(moving, v)) {
            memset(normals + 3 * (size_t)v, 0, 3 * sizeof(float));
        }
    }
    for (uint32_t triangle = 0; triangle < mesh->triangle_count; triangle++) {
        const uint32_t *vertices = mesh->triangle_vertices + 3 * (size_t)triangle;
        double sides[2][3];
        for (size_t n = 0; n < 6; n++) {
            sides[n / 3][n % 3] = (double)positions[3 * (size_t)vertices[1 + n / 3] + n % 3] -
                                  (double)positions[3 * (size_t)vertices[0] + n % 3];
        }
        double unit[3];
        normalize((const double[]){sides[0][1] * sides[1][2] - sides[0][2] * sides[1][1],
                                   sides[0][2] * sides[1][0] - sides[0][0] * sides[1][2],
                                   sides[0][0] * sides[1][1] - sides[0][1] * sides[1][0]},
                  unit);
        for (size_t n = 0; n < 9 && has_flat_normal(moving, vertices[0]); n++) {
            normals[3 * (size_t)vertices[n / 3] + n % 3] += (float)unit[n % 3];
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        float *normal = normals + 3 * (size_t)v;
        double unit[3];
        normalize((const double[]){(double)normal[0], (double)normal[1], (double)normal[2]}, unit);
        for (int c = 0; c < 3 && has_flat_normal(moving, v); c++) {
            normal[c] = (float)unit[c];
        }
    }
}

static girih_result move_mesh(girih_model *model, uint32_t number, girih_error *error) {
    girih_moving_mesh *moving = &model->moving[number];
    uint32_t node = model->pose->mesh_nodes[model->mesh_source[number]];
    const girih_mesh *prepared = moving->prepared;
    girih_mesh *now = &moving->now;
    float *positions = moving->vertices;
    float *normals = positions + 3 * (size_t)now->vertex_count;
    if (!girih_deform(&moving->deformer, model->pose, node, prepared->positions, prepared->normals,
                      positions, normals)) {
        return no_memory(error);
    }
    for (uint32_t v = 0; v < now->vertex_count; v++) {
        // As the device does it: what was one point stays one.
        memcpy(positions + 3 * (size_t)v, positions + 3 * (size_t)now->vertex_point[v],
               3 * sizeof(float));
        for (int c = 0; c < 3; c++) {
            float value = positions[3 * (size_t)v + (size_t)c];
            if (!(fabsf(value) <= GIRIH_MAX_COORDINATE)) {
                return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                  "mesh '%s' is moved to where a coordinate is %g, beyond %g",
                                  now->name, (double)value, (double)GIRIH_MAX_COORDINATE);
            }
            now->bounds_min[c] = v == 0 ? value : fminf(now->bounds_min[c], value);
            now->bounds_max[c] = v == 0 ? value : fmaxf(now->bounds_max[c], value);
        }
    }
    if (moving->is_flat) {
        make_flat_normals(moving, positions, normals);
    }
    return GIRIH_OK;
}

girih_result girih_model_begin_moving(girih_model *model, uint32_t mesh,
                                      const girih_surface_options *surface, girih_error *error) {
    uint32_t source = model->mesh_source[mesh];
    if (model->pose->mesh_nodes[source] == GIRIH_GLTF_NO_NODE) {
        return GIRIH_OK;
    }
    girih_moving_mesh *moving = &model->moving[mesh];
    const girih_mesh *prepared = model->meshes[mesh];
    moving->prepared = prepared;
    moving->now = *prepared;
    moving->is_flat = surface->surface == GIRIH_SURFACE_FLAT;
    moving->vertices = malloc(((size_t)prepared->vertex_count * 6 + 1) * sizeof(float));
    if (moving->vertices == NULL ||
        !girih_deformer_create(&moving->deformer, &model->pose->meshes[source],
                               model->vertex_sources[mesh], prepared->vertex_count)) {
        return no_memory(error);
    }
    moving->now.positions = moving->vertices;
    moving->now.normals = moving->vertices + 3 * (size_t)prepared->vertex_count;
    model->meshes[mesh] = &moving->now;
    return move_mesh(model, mesh, error);
}

girih_result girih_model_move(girih_model *model, const girih_gltf_animation *animation,
                              double seconds, girih_error *error) {
    girih_result result = GIRIH_OK;
    girih_pose_set(model->pose, animation, seconds);
    for (uint32_t n = 0; n < model->mesh_count && result == GIRIH_OK; n++) {
        result = girih_model_is_deformed(model, n) ? move_mesh(model, n, error) : GIRIH_OK;
    }
    return result;
}

bool girih_model_is_deformed(const girih_model *model, uint32_t mesh) {
    return model->moving != NULL && model->moving[mesh].prepared != NULL;
}

void girih_model_vertices(const girih_model *model, uint32_t mesh, float *vertices) {
    const girih_mesh *from = model->meshes[mesh];
    for (size_t v = 0; v < from->vertex_count; v++) {
        memcpy(vertices + 6 * v, from->positions + 3 * v, 3 * sizeof(float));
        memcpy(vertices + 6 * v + 3, from->normals + 3 * v, 3 * sizeof(float));
    }
}
