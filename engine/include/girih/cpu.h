// The six stages on the CPU: the reference for tests, the path for machines without Vulkan, and
// what picking or physics can call. Integers and positions are bit-identical to the GPU's on
// devices that round as IEEE 754 and keep denormals.
#ifndef GIRIH_CPU_H
#define GIRIH_CPU_H

#include "girih/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct girih_cpu_desc {
    const girih_catalogue *catalogue; // NULL: the built-in dyadic one
    const girih_mesh *const *meshes;
    uint32_t mesh_count;
    const girih_instance *instances;
    uint32_t instance_count;
    girih_surface surface;
    girih_mode mode;                      // GIRIH_MODE_INSTANCED gives the same arrays as BAKED
    uint32_t outputs;                     // girih_output_bits
    uint64_t max_vertices, max_triangles; // 0: as many as needed
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
