#include "pose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "node_transform.h"

// --- Samplers ---

// The last key that is not behind a time; 0 before the first.
static uint32_t find_key(const girih_gltf_sampler *sampler, double seconds) {
    uint32_t low = 0;
    uint32_t high = sampler->key_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if ((double)sampler->times[middle] <= seconds) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Spherical linear interpolation along the shorter way (glTF 2.0, appendix C.4).
static void slerp(const float from[4], const float to[4], double part, double *value) {
    double a[4];
    double b[4];
    double lengths[2] = {0.0, 0.0};
    for (int c = 0; c < 4; c++) {
        lengths[0] += (double)from[c] * (double)from[c];
        lengths[1] += (double)to[c] * (double)to[c];
    }
    double dot = 0.0;
    for (int c = 0; c < 4; c++) {
        a[c] = lengths[0] > 0.0 ? (double)from[c] / sqrt(lengths[0]) : 0.0;
        b[c] = lengths[1] > 0.0 ? (double)to[c] / sqrt(lengths[1]) : 0.0;
        dot += a[c] * b[c];
    }
    double sign = dot < 0.0 ? -1.0 : 1.0;
    double angle = acos(fmin(fabs(dot), 1.0));
    double shares[2] = {1.0 - part, part};
    if (angle > 1e-6) { // below, an arc is its chord to the last bit
        shares[0] = sin(angle * (1.0 - part)) / sin(angle);
        shares[1] = sin(angle * part) / sin(angle);
    }
    for (int c = 0; c < 4; c++) {
        value[c] = shares[0] * a[c] + sign * shares[1] * b[c];
    }
}

// The value of a sampler at a time: components numbers.
static void sample(const girih_gltf_sampler *sampler, girih_gltf_path path, double seconds,
                   double *value) {
    bool is_cubic = sampler->interpolation == GIRIH_GLTF_CUBIC_SPLINE;
    uint32_t components = sampler->components;
    size_t size = (size_t)components * (is_cubic ? 3 : 1);
    uint32_t key = find_key(sampler, seconds);
    const float *from = sampler->values + key * size + (is_cubic ? components : 0);
    bool is_held = sampler->interpolation == GIRIH_GLTF_STEP || key + 1 == sampler->key_count ||
                   !((double)sampler->times[key] < seconds);
    if (is_held) {
        for (uint32_t c = 0; c < components; c++) {
            value[c] = (double)from[c];
        }
        return;
    }
    const float *to = from + size;
    double step = (double)sampler->times[key + 1] - (double)sampler->times[key];
    double t = (seconds - (double)sampler->times[key]) / step;
    if (is_cubic) { // appendix C.5
        const float *leaving = from + components;
        const float *arriving = to - components;
        for (uint32_t c = 0; c < components; c++) {
            value[c] = (2.0 * t * t * t - 3.0 * t * t + 1.0) * (double)from[c] +
                       step * (t * t * t - 2.0 * t * t + t) * (double)leaving[c] +
                       (-2.0 * t * t * t + 3.0 * t * t) * (double)to[c] +
                       step * (t * t * t - t * t) * (double)arriving[c];
        }
    } else if (path == GIRIH_GLTF_ROTATION) {
        slerp(from, to, t, value);
    } else {
        for (uint32_t c = 0; c < components; c++) {
            value[c] = (1.0 - t) * (double)from[c] + t * (double)to[c];
        }
    }
}

// --- Poses ---

static bool is_skinned(const girih_gltf_contents *file, uint32_t node) {
    return node != GIRIH_GLTF_NO_NODE && file->nodes[node].skin >= 0;
}

static bool is_deformed(const girih_gltf_contents *file, const girih_gltf_placement *placement) {
    return is_skinned(file, placement->node) || (placement->node != GIRIH_GLTF_NO_NODE &&
                                                 file->meshes[placement->mesh].target_count > 0);
}

static size_t target_count(const girih_gltf_contents *file, uint32_t node) {
    int32_t mesh = file->nodes[node].mesh;
    return mesh < 0 ? 0 : file->meshes[mesh].target_count;
}

// Each deformed placement gets a copy of its mesh.
static bool copy_meshes(girih_pose *pose) {
    const girih_gltf_contents *file = pose->file;
    size_t mesh_count = file->mesh_count;
    for (uint32_t n = 0; n < file->placement_count; n++) {
        mesh_count += is_deformed(file, &file->placements[n]);
    }
    pose->meshes = malloc((mesh_count + 1) * sizeof *pose->meshes);
    pose->mesh_nodes = malloc((mesh_count + 1) * sizeof *pose->mesh_nodes);
    bool *is_used = calloc((size_t)file->mesh_count + 1, sizeof *is_used);
    if (pose->meshes == NULL || pose->mesh_nodes == NULL || is_used == NULL) {
        free(is_used);
        return false;
    }
    uint32_t count = file->mesh_count;
    for (uint32_t n = 0; n < file->placement_count; n++) {
        const girih_gltf_placement *placement = &file->placements[n];
        if (!is_deformed(file, placement)) {
            is_used[placement->mesh] = true;
            continue;
        }
        pose->meshes[count] = file->meshes[placement->mesh];
        pose->mesh_nodes[count] = placement->node;
        pose->placements[n].mesh = count++;
    }
    for (uint32_t m = 0; m < file->mesh_count; m++) {
        pose->meshes[m] = file->meshes[m];
        pose->mesh_nodes[m] = GIRIH_GLTF_NO_NODE;
        pose->meshes[m].primitive_count = is_used[m] ? file->meshes[m].primitive_count : 0;
    }
    free(is_used);
    pose->contents.mesh_count = count;
    pose->contents.meshes = pose->meshes;
    return true;
}

bool girih_pose_create(girih_pose *pose, const girih_gltf_contents *file) {
    *pose = (girih_pose){.file = file, .contents = *file};
    size_t weight_count = 0;
    for (uint32_t n = 0; n < file->node_count; n++) {
        weight_count += target_count(file, n);
    }
    pose->locals = malloc(((size_t)file->node_count + 1) * sizeof *pose->locals);
    pose->worlds = malloc(((size_t)file->node_count + 1) * sizeof *pose->worlds);
    pose->weights = malloc((weight_count + 1) * sizeof *pose->weights);
    pose->first_weights = malloc(((size_t)file->node_count + 1) * sizeof *pose->first_weights);
    pose->placements = malloc(((size_t)file->placement_count + 1) * sizeof *pose->placements);
    pose->cameras = malloc(((size_t)file->camera_count + 1) * sizeof *pose->cameras);
    if (pose->locals == NULL || pose->worlds == NULL || pose->weights == NULL ||
        pose->first_weights == NULL || pose->placements == NULL || pose->cameras == NULL) {
        return false;
    }
    weight_count = 0;
    for (uint32_t n = 0; n < file->node_count; n++) {
        pose->first_weights[n] = weight_count;
        weight_count += target_count(file, n);
    }
    for (uint32_t n = 0; n < file->placement_count; n++) {
        pose->placements[n] = file->placements[n];
    }
    for (uint32_t n = 0; n < file->camera_count; n++) {
        pose->cameras[n] = file->cameras[n];
    }
    pose->contents.placements = pose->placements;
    pose->contents.cameras = pose->cameras;
    if (!copy_meshes(pose)) {
        return false;
    }
    girih_pose_set(pose, NULL, 0.0);
    return true;
}

static void animate(girih_pose *pose, const girih_gltf_channel *channel,
                    const girih_gltf_sampler *sampler, double seconds) {
    girih_gltf_transform *local = &pose->locals[channel->node];
    double *const values[] = {
        [GIRIH_GLTF_TRANSLATION] = local->translation,
        [GIRIH_GLTF_ROTATION] = local->rotation,
        [GIRIH_GLTF_SCALE] = local->scale,
        [GIRIH_GLTF_WEIGHTS] = pose->weights + pose->first_weights[channel->node],
    };
    sample(sampler, channel->path, seconds, values[channel->path]);
}

void girih_pose_set(girih_pose *pose, const girih_gltf_animation *animation, double seconds) {
    const girih_gltf_contents *file = pose->file;
    for (uint32_t n = 0; n < file->node_count; n++) {
        pose->locals[n] = file->nodes[n].local;
        for (size_t w = 0; w < target_count(file, n); w++) {
            pose->weights[pose->first_weights[n] + w] = (double)file->nodes[n].weights[w];
        }
    }
    for (uint32_t n = 0; animation != NULL && n < animation->channel_count; n++) {
        const girih_gltf_channel *channel = &animation->channels[n];
        animate(pose, channel, &animation->samplers[channel->sampler], seconds);
    }
    for (uint32_t n = 0; n < file->node_count; n++) {
        uint32_t node = file->node_order[n];
        uint32_t parent = file->nodes[node].parent;
        if (parent == GIRIH_GLTF_NO_NODE) {
            girih_node_matrix(&pose->locals[node], pose->worlds[node]);
        } else {
            double local[12];
            girih_node_matrix(&pose->locals[node], local);
            girih_matrix_product(pose->worlds[parent], local, pose->worlds[node]);
        }
    }
    for (uint32_t n = 0; n < file->placement_count; n++) {
        girih_gltf_placement *placement = &pose->placements[n];
        if (is_skinned(file, placement->node)) {
            bool is_mirrored = girih_matrix_determinant(pose->worlds[placement->node]) < 0.0;
            const double side[12] = {is_mirrored ? -1 : 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
            girih_matrix_round(side, placement->transform);
        } else if (placement->node != GIRIH_GLTF_NO_NODE) {
            girih_matrix_round(pose->worlds[placement->node], placement->transform);
        }
    }
    for (uint32_t n = 0; n < file->camera_count; n++) {
        girih_matrix_round(pose->worlds[pose->cameras[n].node], pose->cameras[n].transform);
    }
}

void girih_pose_free(girih_pose *pose) {
    free(pose->cameras);
    free(pose->placements);
    free(pose->meshes);
    free(pose->first_weights);
    free(pose->weights);
    free(pose->worlds);
    free(pose->locals);
    free(pose->mesh_nodes);
    *pose = (girih_pose){0};
}

const girih_gltf_animation *girih_pose_find_animation(const girih_gltf_contents *file,
                                                      const char *number_or_name) {
    char *end;
    unsigned long number = strtoul(number_or_name, &end, 10);
    bool is_number = *end == '\0' && *number_or_name >= '0' && *number_or_name <= '9';
    if (is_number && number < file->animation_count) {
        return &file->animations[number];
    }
    for (uint32_t n = 0; n < file->animation_count; n++) {
        if (strcmp(file->animations[n].name, number_or_name) == 0) {
            return &file->animations[n];
        }
    }
    return NULL;
}
