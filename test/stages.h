// One scene, packed once, and the CPU twins run on it frame after frame. A failure fails the test.
#ifndef GIRIH_TEST_STAGES_H
#define GIRIH_TEST_STAGES_H

#include "arrays.h"

typedef struct stages {
    girih_arrays arrays;
    girih_scene_table table;
    girih_plan_shape shape;
} stages;

extern const float identity_transform[12];

// Packs catalogue, scene and plan. shape.max_* 0: as large as 32 bits can count. With instances
// NULL every mesh is placed once by the identity. All of the plan's arrays get memory; outputs do
// not.
stages stages_begin(const girih_catalogue *catalogue, const girih_mesh *const *meshes,
                    uint32_t mesh_count, const girih_instance *instances, uint32_t instance_count,
                    girih_plan_shape shape);
void stages_end(stages *stages);

void stages_frame(stages *stages, const girih_frame *frame);

// Runs levels to dispatch.
void stages_count(stages *stages, girih_surface surface);
// Runs evaluate and output into new memory of the output's exact size, after stages_count.
void stages_write(stages *stages, girih_surface surface);
// A frame from its beginning to its end.
void stages_refine(stages *stages, const girih_frame *frame, girih_surface surface);

// The triangles that the built-in catalogue of the stages' spacing has for edges of these levels, in any order.
uint32_t stages_pattern_triangles(const stages *stages, const uint32_t levels[3]);

girih_statistics stages_statistics(const stages *stages);

// Output vertex `vertex`'s position, and its normal followed by its attributes.
void stages_position(const stages *stages, uint32_t vertex, float position[3]);
void stages_normal(const stages *stages, uint32_t vertex, float normal[3]);

// How edges are used: triangles by three numbers a corner, equal where the points are.
typedef struct edge_audit {
    uint64_t edges;       // used by two triangles, in opposite directions
    uint64_t open;        // one triangle
    uint64_t nonmanifold; // three or more
    uint64_t flipped;     // two, in the same direction
    uint64_t degenerate;  // triangles with two equal corners
} edge_audit;
edge_audit audit_indices(const uint32_t *indices, uint64_t triangle_count);
// The same by the exact bits of the positions, 3 floats a vertex.
edge_audit audit_points(const float *positions, uint64_t vertex_count, const uint32_t *indices,
                        uint64_t triangle_count);
// The same of OUT_POSITIONS and OUT_INDICES.
edge_audit audit_positions(const stages *stages);

#endif
