// glTF 2.0 in and out, behind a C header: the only C++ of the project lies behind it (gltf.cc).
#ifndef GIRIH_VIEWER_GLTF_H
#define GIRIH_VIEWER_GLTF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct girih_gltf_model girih_gltf_model;

typedef enum girih_gltf_alpha_mode {
    GIRIH_GLTF_ALPHA_OPAQUE,
    GIRIH_GLTF_ALPHA_MASK,
    GIRIH_GLTF_ALPHA_BLEND
} girih_gltf_alpha_mode;

typedef enum girih_gltf_wrap {
    GIRIH_GLTF_WRAP_REPEAT,
    GIRIH_GLTF_WRAP_MIRROR,
    GIRIH_GLTF_WRAP_CLAMP
} girih_gltf_wrap;

// An image as 8-bit RGBA rows, top row first: sRGB as a base colour, linear as a normal map. Only
// images that some material uses as one of these are decoded; a material whose image cannot be has
// none.
typedef struct girih_gltf_image {
    uint32_t width, height;
    const uint8_t *pixels; // 4 * width * height bytes, owned by the model
} girih_gltf_image;

// A material's use of a texture.
typedef struct girih_gltf_texture {
    int32_t image;                       // index into images, -1: none
    uint32_t texcoord;                   // the TEXCOORD set it uses
    float offset[2], scale[2], rotation; // KHR_texture_transform; (0,0), (1,1), 0
    girih_gltf_wrap wrap_s, wrap_t;
    bool nearest; // magnification filter
} girih_gltf_texture;

typedef struct girih_gltf_material {
    const char *name;
    float base_color[4]; // linear factor
    girih_gltf_texture base_color_texture;
    girih_gltf_texture normal_texture;
    float normal_scale;        // of the normal map's x and y
    float metallic, roughness; // factors
    float emissive[3];
    girih_gltf_alpha_mode alpha_mode;
    float alpha_cutoff;
    bool double_sided;
    bool unlit; // KHR_materials_unlit
} girih_gltf_material;

// One vertex attribute kept beside POSITION and NORMAL: TANGENT, TEXCOORD_n, COLOR_n, or a custom
// _NAME, as floats (normalised integers are already divided out).
typedef struct girih_gltf_attribute {
    const char *name;
    uint32_t components; // 1..4
    const float *values; // [vertex_count][components]
} girih_gltf_attribute;

// A morph target of a primitive: what a weight of 1 adds. NULL and absent attributes add nothing.
// Only what the primitive itself has is morphed.
typedef struct girih_gltf_morph_target {
    const float *positions; // [vertex_count][3] or NULL
    const float *normals;   // [vertex_count][3] or NULL
    uint32_t attribute_count;
    const girih_gltf_attribute *attributes; // TANGENT has 3 components here: the sign stays
} girih_gltf_morph_target;

// A triangle primitive, whatever its mode and index type were in the file: strips and fans are
// unrolled, missing indices are made, degenerate triangles stay. Winding is as the file's.
typedef struct girih_gltf_primitive {
    int32_t material; // index into materials, -1: the default material
    uint32_t vertex_count;
    const float *positions; // [vertex_count][3]
    const float *normals;   // [vertex_count][3] or NULL
    uint32_t attribute_count;
    const girih_gltf_attribute *attributes;
    uint32_t influence_count; // 4 for each pair of JOINTS_n and WEIGHTS_n, in the order of n
    const uint32_t *joints;   // [vertex_count][influence_count] into the joints of its nodes' skins
    const float *weights;     // [vertex_count][influence_count] as in the file: >= 0, sum about 1
    const girih_gltf_morph_target *targets; // [target_count of its mesh]
    uint32_t index_count;
    const uint32_t *indices; // each below vertex_count
} girih_gltf_primitive;

typedef struct girih_gltf_mesh {
    const char *name;         // never NULL: the file's, or "mesh N"
    uint32_t primitive_count; // triangle primitives only; may be 0
    const girih_gltf_primitive *primitives;
    uint32_t target_count;           // of each primitive
    const float *weights;            // [target_count] of its targets by default
    const char *const *target_names; // [target_count] from extras.targetNames, or NULL
} girih_gltf_mesh;

#define GIRIH_GLTF_NO_NODE UINT32_MAX

// A node's transform, either as a matrix or as translation, rotation and scale, applied from right
// to left. In double, as the file's decimals are read: deep hierarchies lose little that way.
typedef struct girih_gltf_transform {
    bool has_matrix;
    double matrix[12]; // rows of the 3x4 matrix, where it has one
    double translation[3];
    double rotation[4]; // quaternion x, y, z, w, as in the file: of any length
    double scale[3];
} girih_gltf_transform;

typedef struct girih_gltf_node {
    const char *name;   // never NULL: the file's, or "node N"
    uint32_t parent;    // GIRIH_GLTF_NO_NODE: a root
    int32_t mesh, skin; // -1: none; a skin without a mesh is none
    int32_t camera;     // of the file's cameras, -1: none
    girih_gltf_transform local;
    const float *weights; // [target_count of its mesh], its mesh's where the node has none of its
                          // own; NULL without a mesh or targets
} girih_gltf_node;

// A skinned vertex is, in the world, the sum over its influences of weight times the joint's
// node-to-world matrix times its inverse bind matrix, applied to the point; the node of the skinned
// mesh has no part in it (glTF 2.0, section 3.7.3.3).
typedef struct girih_gltf_skin {
    const char *name;
    uint32_t joint_count;
    const uint32_t *joints;                   // [joint_count] nodes
    const float (*inverse_bind_matrices)[12]; // [joint_count] rows of 3x4 matrices
    uint32_t skeleton;                        // GIRIH_GLTF_NO_NODE: not given; has no effect
} girih_gltf_skin;

typedef enum girih_gltf_interpolation {
    GIRIH_GLTF_LINEAR, // rotations: spherical
    GIRIH_GLTF_STEP,
    GIRIH_GLTF_CUBIC_SPLINE
} girih_gltf_interpolation;

typedef struct girih_gltf_sampler {
    girih_gltf_interpolation interpolation;
    uint32_t key_count;  // at least 1
    const float *times;  // [key_count] seconds, none before its predecessor
    uint32_t components; // of a value
    const float *values; // [key_count][components]; CUBIC_SPLINE: [key_count][3][components], an
                         // in-tangent, a value and an out-tangent, tangents a second
} girih_gltf_sampler;

typedef enum girih_gltf_path {
    GIRIH_GLTF_TRANSLATION, // 3 components
    GIRIH_GLTF_ROTATION,    // 4
    GIRIH_GLTF_SCALE,       // 3
    GIRIH_GLTF_WEIGHTS      // target_count of the node's mesh
} girih_gltf_path;

typedef struct girih_gltf_channel {
    uint32_t sampler, node;
    girih_gltf_path path; // the sampler has as many components as it asks for
} girih_gltf_channel;

// Channels that girih does not know, or whose node has nothing for them to move, are left out, in
// one warning an animation.
typedef struct girih_gltf_animation {
    const char *name; // never NULL: the file's, or "animation N"
    float start, end; // seconds: of the first and the last key of its channels; 0 without any
    uint32_t sampler_count;
    const girih_gltf_sampler *samplers; // as in the file; one that no channel uses has no keys
    uint32_t channel_count;
    const girih_gltf_channel *channels;
} girih_gltf_animation;

// A mesh placed in the scene: every node with a mesh that the default scene reaches (the first
// scene where none is the default, all nodes where a file has no scene), in the pose that its nodes
// have by themselves. A skinned mesh has the transform of its own node too, which is not where it
// is seen: pose.h. In a file without any node that has a mesh, every mesh is placed once,
// untransformed, its node being GIRIH_GLTF_NO_NODE.
typedef struct girih_gltf_placement {
    uint32_t mesh;
    uint32_t node;
    float transform[12]; // rows of the 3x4 node-to-world matrix: world = (t[0..2]·p + t[3],
                         // t[4..6]·p + t[7], ...)
} girih_gltf_placement;

typedef struct girih_gltf_camera {
    const char *name;
    bool perspective;
    float vertical_view_angle;              // radians, perspective
    float aspect;                           // width / height, 0: the picture's
    float x_magnification, y_magnification; // orthographic
    float near, far;                        // far 0: infinite
    uint32_t node;
    float transform[12]; // node-to-world as above; looks along -z, y up
} girih_gltf_camera;

// What a model holds. All pointers belong to the model.
typedef struct girih_gltf_contents {
    uint32_t mesh_count;
    const girih_gltf_mesh *meshes;
    uint32_t placement_count;
    const girih_gltf_placement *placements;
    uint32_t material_count;
    const girih_gltf_material *materials;
    uint32_t image_count;
    const girih_gltf_image *images;
    uint32_t camera_count;
    const girih_gltf_camera *cameras;
    uint32_t node_count;
    const girih_gltf_node *nodes; // in the scene or not, as in the file
    const uint32_t *node_order;   // [node_count] every node, behind its parent
    uint32_t skin_count;
    const girih_gltf_skin *skins;
    uint32_t animation_count;
    const girih_gltf_animation *animations;
    uint32_t morph_target_count; // of all meshes
    uint32_t skipped_primitives; // points and lines, each named in a warning
    uint32_t triangle_count;     // of all meshes, each mesh once
} girih_gltf_contents;

// Loads .gltf or .glb. Warnings (points and lines left out, an optional extension not known, a
// texture that cannot be decoded) are handed to warn, one line each without a newline; warn may be
// NULL. On failure returns NULL and writes one line into message: the path, what is wrong, where in
// the file, and what to do where something can be done. Never aborts or throws. Calls on different
// models may run at once.
girih_gltf_model *girih_gltf_load(const char *path, void (*warn)(void *user, const char *line),
                                  void *user, char *message, size_t message_size);

void girih_gltf_destroy(girih_gltf_model *model); // takes NULL

const girih_gltf_contents *girih_gltf_get(const girih_gltf_model *model);

// What replaces a morph target of a primitive: as many arrays as the source's has.
typedef struct girih_gltf_refined_target {
    const float *positions; // [vertex_count][3] or NULL
    const float *normals;   // [vertex_count][3] or NULL; may be there where the source has none
    const float *const *attributes; // one array for each of the target's attributes, in its order
} girih_gltf_refined_target;

// What replaces a primitive's geometry when a model is written. Read during girih_gltf_write only.
typedef struct girih_gltf_refined_primitive {
    uint32_t vertex_count;
    const float *positions; // [vertex_count][3]
    const float *normals;   // [vertex_count][3] or NULL
    const float *const
        *attributes; // one array for each of the primitive's attributes, in its order
    uint32_t index_count;
    const uint32_t *indices;
    const uint32_t *joints; // [vertex_count][influence_count of the source], each below 65536
    const float *weights;   // [vertex_count][influence_count of the source]
    const girih_gltf_refined_target *targets; // [target_count of its mesh]
} girih_gltf_refined_primitive;

// Writes a .glb: the model, each triangle primitive's geometry replaced by
// refined[mesh][primitive], in the order of girih_gltf_contents. Nodes, skins, animations,
// materials, textures (embedded), cameras, extras, names and extensions stay as they are;
// primitives that have no triangles, in the source or refined, too. Extensions that describe bytes
// or vertices of the source are left out: each is named to warn, which may be NULL. Positions are
// written bit for bit, with exact min and max; normals and tangents are made unit length where they
// are not. The file is written beside the target under another name and moved over it when it is
// whole. Streams its output: no copy of the refined geometry is held in memory. Returns false and
// one line in message on failure.
bool girih_gltf_write(const girih_gltf_model *model,
                      const girih_gltf_refined_primitive *const *refined, const char *path,
                      void (*warn)(void *user, const char *line), void *user, char *message,
                      size_t message_size);

#ifdef __cplusplus
}
#endif
#endif
