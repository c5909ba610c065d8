// Poses of glTF scenes: what samplers, skins and morph targets give by the formulas of glTF 2.0,
// and files that lie about them are refused.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "../viewer/deform.h"
#include "../viewer/model.h"
#include "gltf_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A strip of four rows of two vertices, a unit apart, along y. Joint 0 stands at the origin, joint
// 1 at (0, 1, 0) as its child. The last row lies where the third does, with the same influences in
// another order.
typedef struct rig {
    float positions[8][3], normals[8][3];
    uint8_t joints[8][4];
    float weights[8][4];
    float inverse_bind[2][16];
    float times[3], turns[3][4];
    int16_t short_turns[3][4];
    float path[3][3][3]; // cubic: in-tangent, value, out-tangent
    float lifts[8][3], tilts[8][3];
    float amounts[3];
    uint16_t triangles[18];
} rig;

#define HALF_TURN_ROOT 0.70710678f

static const rig rig_data = {
    .positions =
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}, {0, 2, 0}, {1, 2, 0}},
    .normals =
        {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
    .joints = {{0}, {0}, {1, 0}, {0, 1}, {1, 0, 1, 0}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 1, 1, 0}},
    .weights = {{1},
                {1},
                {1},
                {0, 1},
                {0.25f, 0.375f, 0.25f, 0.125f},
                {0.7f, 0.2f, 0.1f},
                {0.375f, 0.25f, 0.125f, 0.25f},
                {0.1f, 0, 0.7f, 0.2f}},
    .inverse_bind = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                     {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}},
    .times = {1, 3, 4},
    .turns = {{0, 0, 0, 1}, {0, 0, HALF_TURN_ROOT, HALF_TURN_ROOT}, {0, 0, 0, -1}},
    .short_turns = {{0, 0, 0, 32767}, {0, 0, 23170, 23170}, {0, 0, 0, -32768}},
    .lifts =
        {{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}, {0, 0, 5}, {0, 0, 6}, {0, 0, 5}, {0, 0, 6}},
    .tilts =
        {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}},
    .amounts = {0, 1, 0.5f},
    .triangles = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4, 6, 7, 4, 5, 7, 6},
};

// rig.glb: the accessors below, and what else its JSON has; there ' stands for ".
static void write_rig(const rig *data, const char *rest) {
    static const struct {
        size_t offset;
        unsigned type, count;
        const char *rest;
    } accessors[] = {
        {offsetof(rig, positions), 5126, 8, "'VEC3'"},
        {offsetof(rig, normals), 5126, 8, "'VEC3'"},
        {offsetof(rig, joints), 5121, 8, "'VEC4'"},
        {offsetof(rig, weights), 5126, 8, "'VEC4'"},
        {offsetof(rig, inverse_bind), 5126, 2, "'MAT4'"},
        {offsetof(rig, times), 5126, 3, "'SCALAR'"},
        {offsetof(rig, turns), 5126, 3, "'VEC4'"},
        {offsetof(rig, short_turns), 5122, 3, "'VEC4','normalized':true"},
        {offsetof(rig, path), 5126, 9, "'VEC3'"},
        {offsetof(rig, lifts), 5126, 8, "'VEC3'"},
        {offsetof(rig, tilts), 5126, 8, "'VEC3'"},
        {offsetof(rig, amounts), 5126, 3, "'SCALAR'"},
        {offsetof(rig, triangles), 5123, 18, "'SCALAR'"},
        {offsetof(rig, path), 5126, 3, "'VEC3'"},
    };
    char json[8192];
    size_t length = (size_t)snprintf(json, sizeof json,
                                     "{'asset':{'version':'2.0'},'buffers':[{'byteLength':%zu}],"
                                     "'bufferViews':[{'buffer':0,'byteLength':%zu}],'accessors':[",
                                     sizeof *data, sizeof *data);
    for (size_t n = 0; n < sizeof accessors / sizeof *accessors; n++) {
        length += (size_t)snprintf(
            json + length, sizeof json - length,
            "%s{'bufferView':0,'byteOffset':%zu,'componentType':%u,'count':%u,'type':%s}",
            n > 0 ? "," : "", accessors[n].offset, accessors[n].type, accessors[n].count,
            accessors[n].rest);
    }
    snprintf(json + length, sizeof json - length, "],%s}", rest);
    for (char *c = json; *c != '\0'; c++) {
        *c = *c == '\'' ? '"' : *c;
    }
    gltf_write_glb("rig.glb", json, data, sizeof *data);
}

#define SURFACE "{'POSITION':0,'NORMAL':1,'JOINTS_0':2,'WEIGHTS_0':3}"
#define SKIN "'skins':[{'joints':[1,2],'inverseBindMatrices':4}]"
#define BONES "{'children':[2]},{'translation':[0,1,0]}"
#define TURNING                                                                                    \
    "'animations':[{'name':'turn','channels':[{'sampler':0,'target':{'node':2,'path':"             \
    "'rotation'}}],'samplers':[{'input':5,'output':6}]}]"
#define SKINNED                                                                                    \
    "'meshes':[{'primitives':[{'attributes':" SURFACE ",'indices':12}]}]," SKIN                    \
    ",'nodes':[{'mesh':0,'skin':0,'translation':[100,0,0]}," BONES "]," TURNING

static girih_gltf_model *load_rig(const rig *data, const char *rest) {
    write_rig(data, rest);
    girih_gltf_model *model = gltf_load("rig.glb");
    if (model == NULL) {
        print_error("%s\n", gltf_message);
    }
    assert_non_null(model);
    return model;
}

static void assert_near(const float *values, const float *expected, unsigned count, float most) {
    for (unsigned n = 0; n < count; n++) {
        if (!(fabsf(values[n] - expected[n]) <= most)) {
            print_error("value %u is %.9g, expected %.9g\n", n, (double)values[n],
                        (double)expected[n]);
            fail();
        }
    }
}

// The vertices of a pose's mesh as its node deforms them, its primitives' one behind another:
// positions, then normals, 0 where there are none in the file. The caller frees it.
static float *deform(const girih_pose *pose, uint32_t number, uint32_t *count) {
    const girih_gltf_mesh *mesh = &pose->contents.meshes[number];
    *count = 0;
    for (uint32_t p = 0; p < mesh->primitive_count; p++) {
        *count += mesh->primitives[p].vertex_count;
    }
    const size_t floats = 3 * (size_t)*count;
    float *from = calloc(2 * floats + 1, sizeof *from);
    float *vertices = malloc((2 * floats + 1) * sizeof *vertices);
    uint32_t *sources = malloc((*count + 1) * sizeof *sources);
    assert_true(from != NULL && vertices != NULL && sources != NULL);
    for (uint32_t p = 0, first = 0; p < mesh->primitive_count; p++) {
        const girih_gltf_primitive *primitive = &mesh->primitives[p];
        const size_t at = 3 * (size_t)first, size = 12 * (size_t)primitive->vertex_count;
        memcpy(from + at, primitive->positions, size);
        if (primitive->normals != NULL) {
            memcpy(from + floats + at, primitive->normals, size);
        }
        for (uint32_t v = 0; v < primitive->vertex_count; v++, first++) {
            sources[first] = first;
        }
    }
    girih_deformer deformer;
    assert_true(girih_deformer_create(&deformer, mesh, sources, *count) &&
                girih_deform(&deformer, pose, pose->mesh_nodes[number], from, from + floats,
                             vertices, vertices + floats));
    girih_deformer_free(&deformer);
    free(sources);
    free(from);
    return vertices;
}

static void contents_of_a_rig(void **state) {
    (void)state;
    girih_gltf_model *model = load_rig(
        &rig_data,
        "'meshes':[{'weights':[0.5,0],'extras':{'targetNames':['lift','tilt']},'primitives':"
        "[{'attributes':" SURFACE ",'targets':[{'POSITION':9},{'NORMAL':10,'TANGENT':10}]}]}]," SKIN
        ",'nodes':[{'mesh':0,'skin':0,'name':'body'},{'children':[2]},{'weights':[0,1],'mesh':0,"
        "'rotation':[0,0,3,4]},{'children':[1]}]," TURNING);
    const girih_gltf_contents *contents = girih_gltf_get(model);
    assert_int_equal(contents->node_count, 4);
    assert_string_equal(contents->nodes[0].name, "body");
    assert_string_equal(contents->nodes[1].name, "node 1");
    assert_true(contents->nodes[0].skin == 0 && contents->nodes[2].skin == -1);
    assert_true(contents->nodes[0].parent == GIRIH_GLTF_NO_NODE && contents->nodes[1].parent == 3 &&
                contents->nodes[2].parent == 1);
    assert_true(contents->nodes[2].local.rotation[3] == 4.0 &&
                !contents->nodes[2].local.has_matrix);
    bool seen[4] = {false};
    for (unsigned n = 0; n < 4; n++) {
        const girih_gltf_node *node = &contents->nodes[contents->node_order[n]];
        assert_true(node->parent == GIRIH_GLTF_NO_NODE || seen[node->parent]);
        seen[contents->node_order[n]] = true;
    }
    assert_true(seen[0] && seen[1] && seen[2] && seen[3]);

    const girih_gltf_mesh *mesh = &contents->meshes[0];
    assert_int_equal(mesh->target_count, 2);
    assert_string_equal(mesh->target_names[1], "tilt");
    assert_true(mesh->weights[0] == 0.5f && contents->nodes[0].weights == mesh->weights);
    assert_true(contents->nodes[2].weights[0] == 0 && contents->nodes[2].weights[1] == 1);
    const girih_gltf_primitive *primitive = &mesh->primitives[0];
    assert_memory_equal(primitive->targets[0].positions, rig_data.lifts, sizeof rig_data.lifts);
    assert_null(primitive->targets[0].normals);
    assert_memory_equal(primitive->targets[1].normals, rig_data.tilts, sizeof rig_data.tilts);
    assert_int_equal(primitive->targets[1].attribute_count, 0); // no TANGENT to add to
    assert_int_equal(primitive->influence_count, 4);
    assert_memory_equal(primitive->weights, rig_data.weights, sizeof rig_data.weights);
    for (unsigned n = 0; n < 32; n++) {
        assert_int_equal(primitive->joints[n],
                         rig_data.weights[n / 4][n % 4] > 0 ? rig_data.joints[n / 4][n % 4] : 0);
    }
    assert_int_equal(contents->skins[0].joint_count, 2);
    assert_int_equal(contents->skins[0].joints[1], 2);
    static const float inverse_bind[12] = {1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0};
    assert_memory_equal(contents->skins[0].inverse_bind_matrices[1], inverse_bind,
                        sizeof inverse_bind);
    const girih_gltf_animation *animation = &contents->animations[0];
    assert_string_equal(animation->name, "turn");
    assert_true(animation->start == 1 && animation->end == 4 && animation->channel_count == 1);
    assert_int_equal(animation->channels[0].node, 2);
    assert_int_equal(animation->samplers[0].components, 4);
    girih_gltf_destroy(model);
}

// --- Samplers ---

// A node's transform in the pose of a sampler with its path.
static void sample(const rig *data, const char *path, const char *sampler, double seconds,
                   girih_gltf_transform *local, double world[12]) {
    char rest[512];
    snprintf(rest, sizeof rest,
             "'nodes':[{'scale':[2,2,2],'children':[1]},{}],'animations':[{'channels':[{'sampler':0"
             ",'target':{'node':1,'path':'%s'}}],'samplers':[{'input':5,%s}]}]",
             path, sampler);
    girih_gltf_model *model = load_rig(data, rest);
    girih_pose pose;
    assert_true(girih_pose_create(&pose, girih_gltf_get(model)));
    girih_pose_set(&pose, &pose.contents.animations[0], seconds);
    *local = pose.locals[1];
    memcpy(world, pose.worlds[1], sizeof pose.worlds[1]);
    girih_pose_free(&pose);
    girih_gltf_destroy(model);
}

static void rotations_go_round_the_shorter_way(void **state) {
    (void)state;
    // From the identity at 1 s to 90 degrees about z at 3 s, and back to minus the identity, which
    // is the identity, at 4 s.
    static const double expected[][2] = {{-1, 0}, {1, 0},    {1.5, 22.5}, {7.0 / 3, 60},
                                         {3, 90}, {3.5, 45}, {4, 0},      {9, 0}};
    for (unsigned n = 0; n < 2 * sizeof expected / sizeof *expected; n++) {
        girih_gltf_transform local;
        double world[12];
        const bool is_short = n % 2 == 1;
        sample(&rig_data, "rotation", is_short ? "'output':7" : "'output':6", expected[n / 2][0],
               &local, world);
        const double angle = expected[n / 2][1] * 3.14159265358979323846 / 180;
        assert_true(fabs(world[0] - 2 * cos(angle)) < 1e-7 && // 2: the parent's scale
                    fabs(world[4] - 2 * sin(angle)) < 1e-7 && world[10] == 2);
    }
}

static void splines_are_their_polynomials(void **state) {
    (void)state;
    // With the tangents of x = t^3 - 2t + 1, y = t^2 and z = 5, a cubic spline is these.
    rig data = rig_data;
    for (unsigned k = 0; k < 3; k++) {
        const float t = data.times[k];
        const float value[3] = {t * t * t - 2 * t + 1, t * t, 5};
        const float tangent[3] = {3 * t * t - 2, 2 * t, 0};
        memcpy(data.path[k][0], tangent, sizeof tangent);
        memcpy(data.path[k][1], value, sizeof value);
        memcpy(data.path[k][2], tangent, sizeof tangent);
    }
    for (double t = 1; t <= 4; t += 0.125) {
        girih_gltf_transform local;
        double world[12];
        sample(&data, "translation", "'output':8,'interpolation':'CUBICSPLINE'", t, &local, world);
        assert_true(fabs(local.translation[0] - (t * t * t - 2 * t + 1)) < 1e-12);
        assert_true(fabs(local.translation[1] - t * t) < 1e-12 && local.translation[2] == 5);
        assert_true(world[3] == 2 * local.translation[0]);
    }
}

static void lines_and_steps(void **state) {
    (void)state;
    rig data = rig_data;
    static const float keys[9] = {1, 2, 3, 5, 2, -1, 0, 0, 0};
    memcpy(data.path, keys, sizeof keys);
    static const struct {
        const char *interpolation;
        double seconds, x;
    } cases[] = {{"LINEAR", 0, 1},   {"LINEAR", 1.5, 2}, {"LINEAR", 3.75, 1.25}, {"LINEAR", 5, 0},
                 {"STEP", 2.999, 1}, {"STEP", 3, 5},     {"STEP", 3.999, 5},     {"STEP", 4, 0}};
    for (unsigned n = 0; n < sizeof cases / sizeof *cases; n++) {
        girih_gltf_transform local;
        double world[12];
        char sampler[128];
        snprintf(sampler, sizeof sampler, "'output':13,'interpolation':'%s'",
                 cases[n].interpolation);
        sample(&data, "scale", sampler, cases[n].seconds, &local, world);
        assert_true(local.scale[0] == cases[n].x);
        sample(&data, "translation", sampler, cases[n].seconds, &local, world);
        assert_true(local.translation[0] == cases[n].x);
    }
}

static void weights_and_cameras(void **state) {
    (void)state;
    girih_gltf_model *model = load_rig(
        &rig_data,
        "'cameras':[{'type':'perspective','perspective':{'yfov':1,'znear':1}}],'meshes':[{"
        "'primitives':[{'attributes':{'POSITION':0,'NORMAL':1},'targets':[{'POSITION':9,'NORMAL':"
        "10}]}]}],'nodes':[{'mesh':0,'weights':[2]},{'mesh':0,'children':[2],'translation':[0,0,1]}"
        ",{'camera':0}],'animations':[{'channels':[{'sampler':0,'target':{'node':1,'path':"
        "'weights'}},{'sampler':1,'target':{'node':1,'path':'rotation'}},{'sampler':0,'target':{"
        "'path':'pointer'}},{'sampler':0,'target':{'node':2,'path':'weights'}}],'samplers':[{"
        "'input':5,'output':11},{'input':5,'output':6}]}]");
    assert_non_null(strstr(gltf_warnings, "2 of its 4 channels are ignored"));
    girih_pose pose;
    assert_true(girih_pose_create(&pose, girih_gltf_get(model)));
    girih_pose_set(&pose, &pose.contents.animations[0], 2.5);
    assert_int_equal(pose.contents.mesh_count, 3); // the file's, and one for each of its nodes
    assert_int_equal(pose.contents.meshes[0].primitive_count, 0);
    static const double weights[2] = {2, 0.75};
    for (unsigned p = 0; p < 2; p++) {
        assert_int_equal(pose.contents.placements[p].mesh, 1 + p);
        uint32_t count;
        float *vertices = deform(&pose, 1 + p, &count);
        assert_int_equal(count, 8);
        for (unsigned v = 0; v < 8; v++) {
            const float z = (float)weights[p] * rig_data.lifts[v][2];
            const float point[3] = {rig_data.positions[v][0], rig_data.positions[v][1], z};
            const float normal[3] = {(float)weights[p], 0, 1};
            assert_memory_equal(vertices + 3 * v, point, sizeof point);
            assert_memory_equal(vertices + 24 + 3 * v, normal, sizeof normal);
        }
        free(vertices);
    }
    const double angle = 0.75 * 3.14159265358979323846 / 2;
    const float c = (float)cos(angle), s = (float)sin(angle);
    const float turned[12] = {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 1};
    assert_near(pose.contents.placements[1].transform, turned, 12, 1e-6f);
    assert_near(pose.contents.cameras[0].transform, turned, 12, 1e-6f);
    girih_pose_free(&pose);
    girih_gltf_destroy(model);
}

// --- Skins ---

// Deforms rest's mesh 0 as node 0 does, at 3 s: 90 degrees of joint 1 about z.
static void pose_rig(const rig *data, const char *rest, float positions[8][3], float normals[8][3],
                     float placement[12]) {
    girih_gltf_model *model = load_rig(data, rest);
    girih_pose pose;
    assert_true(girih_pose_create(&pose, girih_gltf_get(model)));
    girih_pose_set(&pose, &pose.contents.animations[0], 3);
    uint32_t count;
    float *vertices = deform(&pose, 1, &count);
    assert_int_equal(count, 8);
    memcpy(positions, vertices, 8 * sizeof *positions);
    memcpy(normals, vertices + 24, 8 * sizeof *normals);
    free(vertices);
    memcpy(placement, pose.contents.placements[0].transform, 12 * sizeof(float));
    girih_pose_free(&pose);
    girih_gltf_destroy(model);
}

static void a_skin_bends(void **state) {
    (void)state;
    float positions[8][3], normals[8][3], again[8][3], placement[12];
    pose_rig(&rig_data, SKINNED, positions, normals, placement);
    static const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_memory_equal(placement, identity, sizeof identity); // not by 100 along x
    for (unsigned v = 0; v < 8; v++) {
        // Joint 1 turns (x, y) to (1 - y, 1 + x); the share it has is the sum of its weights.
        float share = 0;
        for (unsigned i = 0; i < 4; i++) {
            share += rig_data.joints[v][i] == 1 ? rig_data.weights[v][i] : 0;
        }
        const float x = rig_data.positions[v][0], y = rig_data.positions[v][1];
        const float expected[3] = {x + share * (1 - y - x), y + share * (1 + x - y), 0};
        assert_near(positions[v], expected, 3, 1e-6f);
        assert_near(normals[v], rig_data.normals[v], 3, 1e-6f);
    }
    // The order of a vertex's influences decides no bit, nor does anything that is not in the file.
    assert_memory_equal(positions[4], positions[6], sizeof positions[4]);
    assert_memory_equal(positions[5], positions[7], sizeof positions[5]);
    pose_rig(&rig_data, SKINNED, again, normals, placement);
    assert_memory_equal(positions, again, sizeof again);
    // Weights that are not normalised are, as a sum of 2 is.
    rig data = rig_data;
    for (unsigned n = 0; n < 32; n++) {
        data.weights[n / 4][n % 4] *= 2;
    }
    pose_rig(&data, SKINNED, again, normals, placement);
    assert_memory_equal(positions, again, sizeof again);
}

static void targets_come_before_the_skin(void **state) {
    (void)state;
    float positions[8][3], normals[8][3], placement[12];
    pose_rig(&rig_data,
             "'meshes':[{'weights':[2],'primitives':[{'attributes':" SURFACE
             ",'targets':[{'POSITION':10,'NORMAL':10}]}]}]," SKIN
             ",'nodes':[{'mesh':0,'skin':0}," BONES "]," TURNING,
             positions, normals, placement);
    for (unsigned v = 0; v < 4; v++) {
        // Moved by 2 along x, which is y behind joint 1; a normal (2, 0, 1) is (0, 2, 1) there.
        const bool turned = v >= 2; // by joint 1
        const float x = rig_data.positions[v][0] + 2, y = rig_data.positions[v][1];
        const float expected[3] = {turned ? 1 - y : x, turned ? 1 + x : y, 0};
        const float normal[3] = {turned ? 0 : 2 / sqrtf(5), turned ? 2 / sqrtf(5) : 0,
                                 1 / sqrtf(5)};
        assert_near(positions[v], expected, 3, 1e-6f);
        assert_near(normals[v], normal, 3, 1e-6f);
    }
}

static void a_mirrored_skin_keeps_its_outside(void **state) {
    (void)state;
    // Everything under a node that mirrors x: the placement says so, and together they are where
    // the joints bring the vertices.
    float positions[8][3], normals[8][3], placement[12];
    pose_rig(&rig_data,
             "'meshes':[{'primitives':[{'attributes':" SURFACE "}]}]," SKIN
             ",'nodes':[{'mesh':0,'skin':0}," BONES
             ",{'scale':[-2,1,1],'children':[0,1]}]," TURNING,
             positions, normals, placement);
    static const float mirror[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    assert_memory_equal(placement, mirror, sizeof mirror);
    for (unsigned v = 0; v < 4; v++) {
        const bool turned = v >= 2; // by joint 1
        const float x = rig_data.positions[v][0], y = rig_data.positions[v][1];
        const float expected[3] = {2 * (turned ? 1 - y : x), turned ? 1 + x : y, 0};
        assert_near(positions[v], expected, 3, 1e-6f);
        assert_near(normals[v], rig_data.normals[v], 3, 1e-6f);
    }
}

static void a_primitive_without_joints_moves_with_its_node(void **state) {
    (void)state;
    float positions[8][3], normals[8][3], placement[12];
    pose_rig(&rig_data,
             "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':1}}]}]," SKIN
             ",'nodes':[{'mesh':0,'skin':0,'translation':[100,0,0]}," BONES "]," TURNING,
             positions, normals, placement);
    for (unsigned v = 0; v < 8; v++) {
        assert_true(positions[v][0] == rig_data.positions[v][0] + 100);
    }
}

// --- Models that move ---

static void load_model(girih_model *model, const char *path, const girih_pose_options *pose) {
    const girih_surface_options surface = {.surface = GIRIH_SURFACE_PN, .crease_degrees = 60};
    girih_error error;
    if (girih_model_load(model, path, GIRIH_MODEL_DRAW, &surface, pose, &error) != GIRIH_OK) {
        print_error("%s\n", error.message);
        fail();
    }
}

// To the bit: the same triangles, and the same vertices, which are where the file's are by formula.
static void assert_same_pose(const girih_model *one, const girih_model *other) {
    assert_int_equal(one->mesh_count, other->mesh_count);
    for (uint32_t m = 0; m < one->mesh_count; m++) {
        const girih_mesh *a = one->meshes[m], *b = other->meshes[m];
        const size_t size = 12 * (size_t)a->vertex_count;
        assert_true(a->triangle_count == b->triangle_count && a->vertex_count == b->vertex_count);
        assert_memory_equal(a->triangle_vertices, b->triangle_vertices,
                            12 * (size_t)a->triangle_count);
        assert_memory_equal(a->positions, b->positions, size);
        assert_memory_equal(a->normals, b->normals, size);
        assert_memory_equal(a->bounds_min, b->bounds_min, 12);
        assert_memory_equal(a->bounds_max, b->bounds_max, 12);
        if (!girih_model_is_deformed(one, m)) {
            continue;
        }
        uint32_t count;
        float *formula = deform(one->pose, one->mesh_source[m], &count);
        for (uint32_t v = 0; v < a->vertex_count; v++) {
            const float *p = a->positions + 3 * (size_t)v;
            const float *q = formula + 3 * (size_t)one->vertex_sources[m][v];
            assert_true(p[0] == q[0] && p[1] == q[1] && p[2] == q[2]); // -0 is 0
        }
        free(formula);
    }
}

static void moving_meshes(void **state) {
    (void)state;
    write_rig(&rig_data, SKINNED);
    char path[1024];
    snprintf(path, sizeof path, "%s", folder_path("rig.glb"));
    const girih_pose_options at_3 = {.has_time = true, .time = 3};
    girih_model posed, moving;
    girih_error error;
    load_model(&posed, path, &at_3);
    load_model(&moving, path, NULL);
    assert_true(posed.is_dynamic && moving.is_dynamic && moving.meshes[0]->dynamic);
    // The last two vertices have no triangle with an area.
    assert_true(girih_model_is_deformed(&moving, 0) && moving.meshes[0]->vertex_count == 6);
    for (unsigned run = 0; run < 2; run++) {
        const girih_gltf_animation *animation = &moving.contents->animations[0];
        assert_int_equal(girih_model_move(&moving, animation, 2, &error), GIRIH_OK);
        assert_int_equal(girih_model_move(&moving, animation, 3, &error), GIRIH_OK);
        assert_same_pose(&posed, &moving);
        float vertices[6][6];
        girih_model_vertices(&moving, 0, vertices[0]);
        for (unsigned v = 0; v < 6; v++) {
            assert_memory_equal(vertices[v], posed.meshes[0]->positions + 3 * v, 12);
            assert_memory_equal(vertices[v] + 3, posed.meshes[0]->normals + 3 * v, 12);
        }
    }
    assert_int_equal(girih_model_move(&moving, NULL, 0, &error), GIRIH_OK);
    assert_near(moving.meshes[0]->positions, rig_data.positions[0], 18, 0);
    girih_model_free(&posed);
    girih_model_free(&moving);
    const girih_surface_options surface = {.surface = GIRIH_SURFACE_PN};
    const girih_pose_options other = {.animation = "run"};
    assert_int_not_equal(girih_model_load(&posed, path, GIRIH_MODEL_DRAW, &surface, &other, &error),
                         GIRIH_OK);
    assert_non_null(strstr(error.message, "has no animation 'run'; it has 0 'turn'"));
}

// With normals in one primitive and none in the other.
static void moving_mixed_meshes(void **state) {
    (void)state;
    write_rig(&rig_data,
              "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':2,'WEIGHTS_0':3},"
              "'indices':12},{'attributes':" SURFACE ",'indices':12},{'attributes':{'POSITION':9,"
              "'JOINTS_0':2,'WEIGHTS_0':3}}]}]," SKIN ",'nodes':[{'mesh':0,'skin':0}," BONES
              "]," TURNING);
    const girih_pose_options at_3 = {.has_time = true, .time = 3};
    girih_model posed, moving;
    girih_error error;
    load_model(&posed, folder_path("rig.glb"), &at_3);
    load_model(&moving, folder_path("rig.glb"), NULL);
    assert_int_equal(girih_model_move(&moving, &moving.contents->animations[0], 3, &error),
                     GIRIH_OK);
    assert_int_equal(posed.meshes[0]->triangle_count, 10);
    assert_same_pose(&posed, &moving);
    girih_model_free(&posed);
    girih_model_free(&moving);
}

// Folded by 90 degrees, more than the crease angle, a strip that is flat at rest gets no crease: it
// is what it would be with its normals in the file.
static void made_normals_follow_the_skin(void **state) {
    (void)state;
    rig data = rig_data;
    static const float fold[4] = {HALF_TURN_ROOT, 0, 0, HALF_TURN_ROOT}; // about x
    memcpy(data.turns[1], fold, sizeof fold);
    const girih_pose_options at_3 = {.has_time = true, .time = 3};
    girih_model given, made;
    write_rig(&data, SKINNED);
    load_model(&given, folder_path("rig.glb"), &at_3);
    write_rig(&data, "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':2,"
                     "'WEIGHTS_0':3},'indices':12}]}]," SKIN ",'nodes':[{'mesh':0,'skin':0}," BONES
                     "]," TURNING);
    load_model(&made, folder_path("rig.glb"), &at_3);
    assert_true(made.moving[0].prepared->made_normals);
    assert_near(made.meshes[0]->normals, (const float[]){0, 0, 1}, 3, 0);
    assert_near(made.meshes[0]->normals + 6, (const float[]){0, -1, 0}, 3, 1e-6f);
    assert_same_pose(&given, &made);
    girih_model_free(&given);
    girih_model_free(&made);
}

// Triangles that are drawn flat have their own normals in every pose. The mixed mesh's first
// primitive has none in the file: what it has is right for where its vertices are.
static void flat_normals_are_the_triangles_own(void **state) {
    (void)state;
    rig data = rig_data;
    // Bent at rest, so that no two triangles lie in one plane and have vertices in common.
    for (unsigned v = 0; v < 8; v++) {
        data.positions[v][2] = (float)(v * v) / 16;
    }
    write_rig(&data, "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':2,"
                     "'WEIGHTS_0':3},'indices':12},{'attributes':" SURFACE ",'indices':12}]}]," SKIN
                     ",'nodes':[{'mesh':0,'skin':0}," BONES "]," TURNING);
    const girih_surface_options surface = {.surface = GIRIH_SURFACE_FLAT};
    const girih_pose_options at_2 = {.has_time = true, .time = 2};
    girih_model model;
    girih_error error;
    assert_int_equal(
        girih_model_load(&model, folder_path("rig.glb"), GIRIH_MODEL_DRAW, &surface, &at_2, &error),
        GIRIH_OK);
    const girih_mesh *mesh = model.meshes[0];
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const bool is_made = t < mesh->triangle_count / 2;
        const uint32_t *corners = mesh->triangle_vertices + 3 * (size_t)t;
        for (unsigned c = 0; c < 3; c++) {
            const float *p = mesh->positions + 3 * (size_t)corners[c];
            const float *q = mesh->positions + 3 * (size_t)corners[(c + 1) % 3];
            const float *n = mesh->normals + 3 * (size_t)corners[c];
            const float *first = mesh->normals + 3 * (size_t)corners[0];
            const float along = n[0] * (q[0] - p[0]) + n[1] * (q[1] - p[1]) + n[2] * (q[2] - p[2]);
            assert_true(!is_made || (fabsf(along) < 1e-6f && memcmp(n, first, 12) == 0));
            assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-6f);
        }
    }
    girih_model_free(&model);
}

// What is one point at rest is one point in a pose by formula, and a mesh that is prepared from the
// vertices of the pose has the triangles, the edges and the open edges that it has at rest.
static void assert_is_closed(const girih_model *model, uint32_t number) {
    const girih_moving_mesh *moving = &model->moving[number];
    const girih_mesh *rest = moving->prepared;
    const uint32_t source = model->mesh_source[number];
    const size_t size = 12 * (size_t)rest->vertex_count;
    float *positions = malloc(size), *normals = malloc(size);
    assert_true(positions != NULL && normals != NULL);
    assert_true(girih_deform(&moving->deformer, model->pose, model->pose->mesh_nodes[source],
                             rest->positions, rest->normals, positions, normals));
    for (uint32_t v = 0; v < rest->vertex_count; v++) {
        const float *p = positions + 3 * (size_t)v;
        const float *q = positions + 3 * (size_t)rest->vertex_point[v];
        assert_true(p[0] == q[0] && p[1] == q[1] && p[2] == q[2]); // -0 is 0
    }
    const girih_mesh_desc desc = {
        .name = "posed",
        .vertex_count = rest->vertex_count,
        .positions = positions,
        .indices = rest->triangle_vertices,
        .index_count = 3 * rest->triangle_count,
        .missing_normals = GIRIH_NORMALS_SMOOTH,
        .crease_degrees = 180,
    };
    const girih_mesh *posed;
    girih_error error;
    assert_int_equal(girih_mesh_create(&desc, &posed, &error), GIRIH_OK);
    assert_int_equal(posed->triangle_count, rest->triangle_count);
    assert_int_equal(posed->edge_count, rest->edge_count);
    assert_int_equal(posed->open_edges, rest->open_edges);
    girih_mesh_destroy(posed);
    free(positions);
    free(normals);
}

static void assert_stays_closed(const char *path, unsigned times) {
    girih_model model, posed;
    girih_error error;
    load_model(&model, path, NULL);
    assert_true(model.is_dynamic);
    for (uint32_t a = 0; a < model.contents->animation_count; a++) {
        const girih_gltf_animation *animation = &model.contents->animations[a];
        for (unsigned t = 0; t < times; t++) {
            const float seconds = animation->end * ((float)t + 0.4f) / (float)times;
            char number[16];
            snprintf(number, sizeof number, "%u", a);
            const girih_pose_options then = {
                .has_time = true, .time = seconds, .animation = number};
            load_model(&posed, path, &then);
            assert_int_equal(girih_model_move(&model, animation, (double)seconds, &error),
                             GIRIH_OK);
            assert_same_pose(&posed, &model);
            for (uint32_t m = 0; m < model.mesh_count; m++) {
                if (girih_model_is_deformed(&model, m)) {
                    assert_is_closed(&model, m);
                }
            }
            girih_model_free(&posed);
        }
    }
    girih_model_free(&model);
}

static void nothing_opens(void **state) {
    (void)state;
    char path[1024];
    snprintf(path, sizeof path, "%s/worm.glb", getenv("GIRIH_ASSETS"));
    assert_stays_closed(path, 20);
    const char *models = getenv("GIRIH_MODELS");
    static const char *const real[] = {"Fox/Fox.gltf", "SimpleSkin_embedded.gltf",
                                       "AnimatedMorphCube/AnimatedMorphCube.gltf"};
    for (size_t n = 0; models != NULL && n < sizeof real / sizeof *real; n++) {
        snprintf(path, sizeof path, "%s/mesh_gltf/%s", models, real[n]);
        FILE *file = fopen(path, "rb");
        if (file != NULL) {
            fclose(file);
            assert_stays_closed(path, 3);
        }
    }
}

// --- Refusals ---

static void mutations_never_crash(void **state) {
    (void)state;
    write_rig(&rig_data,
              "'meshes':[{'weights':[2],'primitives':[{'attributes':" SURFACE
              ",'targets':[{'POSITION':10,'NORMAL':10}]}]}]," SKIN
              ",'nodes':[{'mesh':0,'skin':0}," BONES
              "],'animations':[{'channels':[{'sampler':0,'target':{'node':2,'path':'rotation'}},{"
              "'sampler':1,'target':{'node':0,'path':'weights'}}],'samplers':[{'input':5,'output':"
              "6},{'input':5,'output':11}]}]");
    size_t size;
    unsigned char *good = folder_read(folder_path("rig.glb"), &size), *bad = malloc(size);
    assert_non_null(bad);
    const size_t json_size = size - sizeof(rig);
    uint64_t random = 88172645463325252u;
    unsigned posed = 0;
    for (unsigned run = 0; run < 2000; run++) {
        memcpy(bad, good, size);
        for (unsigned change = 0; change < 1 + run % 3; change++) {
            random ^= random << 13, random ^= random >> 7, random ^= random << 17;
            const size_t at = (size_t)(random >> 16) % (run % 2 == 0 ? json_size : size);
            if (random % 3 == 0) {
                bad[at] = (unsigned char)"0123456789-\"[{"[random / 3 % 14];
            } else {
                bad[at] ^= (unsigned char)(1u << random / 3 % 8);
            }
        }
        folder_write("mutant.glb", bad, size);
        girih_gltf_model *model = gltf_load("mutant.glb");
        girih_pose pose;
        if (model != NULL && girih_gltf_get(model)->animation_count > 0) {
            assert_true(girih_pose_create(&pose, girih_gltf_get(model)));
            girih_pose_set(&pose, &pose.contents.animations[0], 2);
            for (uint32_t m = 0; m < pose.contents.mesh_count; m++) {
                uint32_t count;
                if (pose.mesh_nodes[m] != GIRIH_GLTF_NO_NODE) {
                    free(deform(&pose, m, &count));
                }
            }
            girih_pose_free(&pose);
            posed++;
        }
        girih_gltf_destroy(model);
    }
    assert_true(posed > 100); // else nothing was tried
    free(good);
    free(bad);
}

static void broken_files_are_refused(void **state) {
    (void)state;
#define MESH(attributes) "'meshes':[{'primitives':[{'attributes':{'POSITION':0" attributes "}}]}]"
#define ANIMATION(target, sampler)                                                                 \
    "'nodes':[{}],'animations':[{'channels':[{'sampler':0,'target':" target                        \
    "}],'samplers':[" sampler "]}]"
    static const struct {
        const char *rest, *words;
    } cases[] = {
        {MESH(",'JOINTS_0':2"), "WEIGHTS_0 is missing"},
        {MESH(",'JOINTS_1':2,'WEIGHTS_1':3"), "JOINTS_0 is missing"},
        {MESH(",'JOINTS_0':3,'WEIGHTS_0':3"), "JOINTS_0 is VEC4 of component type 5126"},
        {MESH(",'JOINTS_0':2,'WEIGHTS_0':6"), "WEIGHTS_0 has 3 elements"},
        {MESH("") ",'skins':[{'joints':[]}]", "skin 0: has no joints"},
        {"'skins':[{'joints':[0]}]", "only 0 nodes"},
        {"'nodes':[{},{},{}],'skins':[{'joints':[0,1,2],'inverseBindMatrices':4}]",
         "3 joints need as many inverse bind matrices"},
        {"'nodes':[{}],'skins':[{'joints':[0],'inverseBindMatrices':3}]", "inverse bind matrices"},
        {"'nodes':[{'mesh':0,'skin':0},{}],'skins':[{'joints':[1]}],"
         "'meshes':[{'primitives':[{'attributes':" SURFACE "}]}]",
         "follows joint 1, but skin 'skin 0' has only 1"},
        {"'meshes':[{'weights':[1,2],'primitives':[{'attributes':{'POSITION':0},'targets':[{"
         "'POSITION':9}]}]}]",
         "has 2 weights, but 1 morph targets"},
        {"'meshes':[{'primitives':[{'attributes':{'POSITION':0},'targets':[{'POSITION':8}]}]}]",
         "morph target 0: POSITION has 9 elements"},
        {"'meshes':[{'primitives':[{'attributes':{'POSITION':0},'targets':[{}]},{'attributes':{"
         "'POSITION':0}}]}]",
         "has 0 morph targets, a primitive before it has 1"},
        {"'nodes':[{'mesh':0,'weights':[1]}]," MESH(""), "has 1 weights, but its mesh has 0"},
        {ANIMATION("{'node':0,'path':'scale'}", ""), "its sampler is 0, but there are only 0"},
        {ANIMATION("{'node':1,'path':'scale'}", "{'input':5,'output':13}"), "only 1 nodes"},
        {ANIMATION("{'node':0}", "{'input':5,'output':13}"), "path: is missing"},
        {ANIMATION("{'node':0,'path':'scale'}", "{'input':5,'output':99}"), "accessors"},
        {ANIMATION("{'node':0,'path':'scale'}", "{'input':0,'output':13}"), "float scalars"},
        {ANIMATION("{'node':0,'path':'scale'}", "{'input':11,'output':13}"), "predecessor"},
        {ANIMATION("{'node':0,'path':'scale'}", "{'input':5,'output':9}"),
         "its 3 keys need 3 elements of 3 components each, accessor 9 has 8 of 3"},
        {ANIMATION("{'node':0,'path':'rotation'}", "{'input':5,'output':13}"), "of 4 components"},
        {ANIMATION("{'node':0,'path':'scale'}",
                   "{'input':5,'output':13,'interpolation':'CUBICSPLINE'}"),
         "need 9 elements"},
        {ANIMATION("{'node':0,'path':'scale'}", "{'input':5,'output':13,'interpolation':'SINE'}"),
         "interpolation 'SINE'"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        write_rig(&rig_data, cases[n].rest);
        gltf_assert_refused("rig.glb", cases[n].words);
    }
    rig data = rig_data;
    data.weights[2][0] = -1;
    write_rig(&data, SKINNED);
    gltf_assert_refused("rig.glb", "WEIGHTS_0 of vertex 2 is not a number of at least 0");
    data = rig_data;
    data.turns[1][2] = NAN;
    write_rig(&data, SKINNED);
    gltf_assert_refused("rig.glb", "a value is not finite");
    data = rig_data;
    data.inverse_bind[1][2] = INFINITY;
    write_rig(&data, SKINNED);
    gltf_assert_refused("rig.glb", "inverse bind matrix 1 is not finite");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contents_of_a_rig),
        cmocka_unit_test(rotations_go_round_the_shorter_way),
        cmocka_unit_test(splines_are_their_polynomials),
        cmocka_unit_test(lines_and_steps),
        cmocka_unit_test(weights_and_cameras),
        cmocka_unit_test(a_skin_bends),
        cmocka_unit_test(targets_come_before_the_skin),
        cmocka_unit_test(a_mirrored_skin_keeps_its_outside),
        cmocka_unit_test(a_primitive_without_joints_moves_with_its_node),
        cmocka_unit_test(moving_meshes),
        cmocka_unit_test(moving_mixed_meshes),
        cmocka_unit_test(made_normals_follow_the_skin),
        cmocka_unit_test(flat_normals_are_the_triangles_own),
        cmocka_unit_test(nothing_opens),
        cmocka_unit_test(mutations_never_crash),
        cmocka_unit_test(broken_files_are_refused),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
