// The tests' own surfaces (shaders/test_surfaces.glsl): their modules, and the texture and numbers
// that they read. What cannot be done prints why and exits, as gpu.h's.
#ifndef GIRIH_TEST_OWN_SURFACES_H
#define GIRIH_TEST_OWN_SURFACES_H

#include "gpu_frame.h"

typedef enum own_surface {
    OWN_IDENTITY,      // over Curved PN triangles
    OWN_IDENTITY_FLAT, // over the flat triangles
    OWN_NASTY,         // as different on the two sides of every edge as can be
    OWN_NASTY_APART,   // the same, baked, each triangle evaluating its border itself: cracks
    OWN_WAVE,          // a smooth displacement along the normal, at most own_settings.height
    OWN_POLYNOMIAL,    // additions and multiplications alone
} own_surface;

typedef struct own_settings {
    float height; // mesh units
    float phase;
} own_settings;

// The descriptor set of all of them.
typedef struct own_set {
    VkDescriptorSetLayout layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
    VkSampler sampler;
    gpu_buffer numbers; // own_settings, mapped
} own_set;

own_set own_set_open(gpu *host, own_settings settings);
void own_set_close(gpu *host, own_set *set);
// What the next submission reads.
void own_set_write(own_set *set, own_settings settings);

// `reach` as in girih_surface_program_desc.
girih_surface_program_desc own_program_desc(const own_set *set, own_surface surface, float reach);
girih_surface_program *own_program(const girih_context *context, const own_set *set,
                                   own_surface surface, float reach);
// Instanced plans are drawn with this surface from now on.
void own_capture(gpu_capture *capture, const own_set *set, own_surface surface);

// --- What they are tried on ---------------------------------------------------------------------

// A sphere with a UV seam, a hard cube, a torus of two submeshes, and a soup of open, non-manifold
// and flipped edges; of the instances some are mirrored.
enum { OWN_SPHERE, OWN_CUBE, OWN_TORUS, OWN_SOUP, OWN_MESHES };
#define OWN_INSTANCES 5
void own_make_meshes(const girih_mesh *meshes[OWN_MESHES]);
void own_destroy_meshes(const girih_mesh *meshes[OWN_MESHES]);
extern const girih_instance own_instances[OWN_INSTANCES];

// A plan of all instances with every list that its mode has; program NULL: Curved PN triangles.
// Room for `room` triangles.
girih_plan_desc own_plan_of(const girih_scene *scene, const girih_surface_program *program,
                            girih_mode mode, uint32_t room);
girih_plan *own_make_plan(const girih_context *context, girih_plan_desc desc);

// An output vertex's position, and its normal with what follows it; stride: words of a vertex.
const float *own_position(const gpu_readback *read, uint32_t vertex);
const float *own_normal(const gpu_readback *read, uint32_t vertex, uint32_t stride);

#endif
