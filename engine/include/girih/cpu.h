// The six stages on the CPU: the reference for tests, the path for machines without Vulkan, and
// what picking or physics can call. Integers and positions are bit-identical to the GPU's on
// devices that round as IEEE 754 and keep denormals. Every function may be called by several
// threads at once.
//
// Stability: stable
#ifndef GIRIH_CPU_H
#define GIRIH_CPU_H

#include "girih/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Own surfaces -------------------------------------------------------------------------------

// What an own surface is given of an instance's triangle: the CPU's GirihPatch. In world space, the
// corners in the order of the triangle's input. Valid during the call only.
typedef struct girih_cpu_patch {
    float position[3][3]; // of the corners
    float normal[3][3];   // of unit length, or 0 where none can be told
    const girih_mesh *mesh;
    uint32_t vertices[3]; // of the mesh
    uint32_t triangle;    // of the mesh
    uint32_t instance;    // index into girih_cpu_desc.instances
    uint32_t material;
    float scale; // mesh units to world units: the cube root of the transform's |determinant|
    const float *transform;         // of the instance: girih_instance.transform
    const struct girih_patch *base; // for girih_cpu_base_position and girih_cpu_base_normal
} girih_cpu_patch;

// Maps a patch and barycentrics (of the corners, adding up to 1) to a point in the world: the twin
// of a host's girih_surface in GLSL. It is called more than once for a vertex, and for a vertex on
// an edge or at a corner in the one triangle that owns the place, so that it need not care for
// watertightness; but equal arguments must give equal results.
typedef void (*girih_cpu_surface)(void *user, const girih_cpu_patch *patch,
                                  const float barycentric[3], float position[3]);

// The base surface (girih_cpu_desc.base) of a patch: a point, and the normal there, of unit length
// or 0 where none can be told.
GIRIH_API void girih_cpu_base_position(const girih_cpu_patch *patch, const float barycentric[3],
                                       float position[3]);
GIRIH_API void girih_cpu_base_normal(const girih_cpu_patch *patch, const float barycentric[3],
                                     float normal[3]);

// The way of a point that goes `height` mesh units along a unit normal, both in the world: as if
// the mesh had been displaced before it was placed, whatever the transform's scales are.
GIRIH_API void girih_cpu_displacement(const girih_cpu_patch *patch, const float normal[3],
                                      float height, float offset[3]);

// --- Refinement ---------------------------------------------------------------------------------

typedef struct girih_cpu_desc {
    const girih_catalogue *catalogue; // NULL: the built-in dyadic one
    const girih_mesh *const *meshes;
    uint32_t mesh_count;
    const girih_instance *instances;
    uint32_t instance_count;
    girih_surface surface;
    girih_mode mode;                      // GIRIH_MODE_INSTANCED gives the same arrays as BAKED
    uint32_t outputs;                     // girih_output_bits; PREVIOUS and PADDED are the GPU's
                                          // alone
    uint64_t max_vertices, max_triangles; // 0: as many as needed
    uint32_t max_segments; // that an edge may ask for, as in girih_plan_desc; not welded. Room for
                           // parts is as much as needed; a frame whose parts alone tell that it is
                           // more than can be written is GIRIH_ERROR_TOO_LARGE
    // GIRIH_SURFACE_OWN: the surface, what it is handed, and, as in girih_surface_program_desc,
    // what it stands on and what culling may rely on.
    girih_cpu_surface own;
    void *own_user;
    girih_surface base;
    float reach;
} girih_cpu_desc;

// Wall time of the stages, in milliseconds; evaluate and output together.
typedef struct girih_cpu_times {
    double levels, select, group, dispatch, evaluate;
} girih_cpu_times;

// The output, as in girih_plan_buffers. Owned by the caller: girih_cpu_output_free.
typedef struct girih_cpu_output {
    float *positions;         // [output_vertices][3]
    float *attributes;        // [output_vertices][3 + attribute_floats]: normal, attributes
    uint32_t *indices;        // [output_triangles][3], always
    uint32_t *closed_indices; // as asked for
    uint32_t *sources;        // [output_triangles][2] as asked for
    uint32_t material_count;
    uint32_t *material_first; // [material_count + 1] first output triangle
    uint32_t attribute_floats;
    girih_statistics statistics;
    girih_cpu_times times;
} girih_cpu_output;

// Refines a scene on the calling thread. Thread-safe.
GIRIH_API girih_result girih_cpu_refine(const girih_cpu_desc *desc, const girih_frame *frame,
                                        girih_cpu_output *output, girih_error *error);

GIRIH_API void girih_cpu_output_free(girih_cpu_output *output);

#ifdef __cplusplus
}
#endif
#endif
