// Surfaces: the library's own, and the host's.
//
// A host writes one GLSL function,
//     vec3 girih_surface(GirihPatch patch_, vec3 barycentric)
// that maps a patch and barycentrics to a point in the world, and girih.glsl does the rest. The
// function may read textures and buffers of the host's, and it needs no care for watertightness:
// a vertex on a shared edge is evaluated in the one triangle that owns the edge, whoever asks, with
// the same arguments, so both sides get the same bits whatever the function does.
// Stability: experimental
#ifndef GIRIH_SURFACE_H
#define GIRIH_SURFACE_H

#include <stddef.h>
#include <vulkan/vulkan_core.h>

#include "girih/context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum girih_surface {
    GIRIH_SURFACE_FLAT = 0, // the input's own triangles
    GIRIH_SURFACE_PN = 1,   // Curved PN triangles (Vlachos et al. 2001) with PN-AEN seams
    GIRIH_SURFACE_OWN = 2,  // the host's girih_surface_program
} girih_surface;

typedef struct girih_surface_program_desc {
    // The surface in baking: SPIR-V of a shader that includes girih.glsl with GIRIH_BAKE defined,
    // compiled for Vulkan 1.1 (bake), and the same with GIRIH_FEW_BUFFERS defined too (bake_few).
    // A context takes one of the two: girih_context_uses_few_buffers. NULL where the surface is
    // only drawn in the instanced mode, from the host's own vertex shader.
    const uint32_t *bake;
    size_t bake_bytes;
    const uint32_t *bake_few;
    size_t bake_few_bytes;
    // The surface's own textures and buffers in baking: descriptor set GIRIH_SURFACE_SET, which is
    // 1 or, with a context's host_set_layouts, host_set_layout_count + 1 (girih.glsl: the modules
    // must be compiled with GIRIH_SET and GIRIH_PUSH_OFFSET as the context has them, and may read
    // the host's sets too). Its storage buffers count together with girih's 30 (few_buffers: 4)
    // against maxPerStageDescriptorStorageBuffers; textures and uniform buffers are free.
    // VK_NULL_HANDLE: none.
    VkDescriptorSetLayout set_layout;
    // What culling may rely on: every point lies within `reach` (mesh units, along each axis) of
    // the base surface's point at the same place: GIRIH_SURFACE_FLAT or GIRIH_SURFACE_PN, as
    // GIRIH_BASE says in the shaders. Not finite or negative: nothing is known, and nothing is
    // culled. Triangles facing away are never culled: nothing is known of the normals.
    girih_surface base;
    float reach;
} girih_surface_program_desc;

// A host's surface for one context: read-only, may be shared by any number of threads and plans.
typedef struct girih_surface_program girih_surface_program;

// Copies the modules' words. On success *program is the caller's. Thread-safe.
GIRIH_API girih_result girih_surface_program_create(const girih_context *context,
                                                    const girih_surface_program_desc *desc,
                                                    girih_surface_program **program,
                                                    girih_error *error);

// Takes NULL. Its plans must be destroyed before.
GIRIH_API void girih_surface_program_destroy(girih_surface_program *program);

#ifdef __cplusplus
}
#endif
#endif
