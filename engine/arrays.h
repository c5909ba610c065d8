// The arrays of glsl/shared.h on the CPU: packed here once, uploaded for the GPU, and worked on as
// they are by the CPU twins. One layout for both is what lets a test compare any stage word by
// word.
#ifndef GIRIH_ENGINE_ARRAYS_H
#define GIRIH_ENGINE_ARRAYS_H

#include "girih/cpu.h"

#include "shared.h"

typedef float girih_float4[4];
typedef uint32_t girih_uint4[4];

// The uniform block of every stage.
typedef struct girih_frame_block {
    GIRIH_FRAME_BLOCK(girih_float4, girih_uint4, uint32_t, float)
} girih_frame_block;

typedef struct girih_push_block {
    GIRIH_PUSH_BLOCK(uint32_t)
} girih_push_block;

// Words of each binding's array; arrays that are not there are NULL with count 0. count is 64 bits
// wide because outputs may be larger than one storage buffer can show.
typedef struct girih_arrays {
    uint32_t *words[GIRIH_BIND_COUNT];
    uint64_t count[GIRIH_BIND_COUNT];
    girih_frame_block frame;
} girih_arrays;

// Frees the words of the bindings from first up to, not including, end; their counts stay.
void girih_arrays_free(girih_arrays *arrays, uint32_t first, uint32_t end);

// Fills the catalogue's arrays (PATTERNS, PATTERN_VERTICES, PATTERN_INDICES), and the frame's
// level_count, linear_spacing, pattern_count and range_count. Ranges are numbered in the order of
// their patterns' ranks, a mirrored one right after its forward one. The replicas' indices stand
// one after another, replica r with r * vertex_count added. A mirrored triangle (a, c, b) keeps its
// first corner.
girih_result girih_pack_catalogue(girih_arrays *arrays, const girih_catalogue *catalogue,
                                  girih_error *error);

// Where a mesh's records begin in the scene's arrays.
typedef struct girih_scene_mesh {
    uint32_t first_vertex, vertex_count;
    uint32_t first_triangle, triangle_count;
    uint32_t first_edge, edge_count;
    uint32_t first_seam, seam_count;
    uint32_t first_weld_edge, weld_edge_count;
} girih_scene_mesh;

typedef struct girih_scene_table {
    girih_scene_mesh *meshes;
    uint32_t mesh_count;
    uint32_t material_count; // the largest material and one; at least 1
    uint32_t attribute_floats;
    uint32_t seam_count; // of all meshes
    int has_materials;   // a submesh has another material than 0, or two sides
} girih_scene_table;

// Fills the scene's arrays (VERTICES to EDGES) and the frame's material_count, attribute_floats and
// previous_vertices. Empty arrays get one word, so that each can be bound. With `previous` VERTICES
// holds all vertices twice, the second time as those of the previous frame. On success the caller
// owns table->meshes (girih_free).
girih_result girih_pack_scene(girih_arrays *arrays, girih_scene_table *table,
                              const girih_mesh *const *meshes, uint32_t mesh_count, int previous,
                              girih_error *error);

// What a plan is made for, beside its instances.
typedef struct girih_plan_shape {
    girih_mode mode;
    uint32_t outputs;
    uint64_t max_vertices, max_triangles; // raised to the level-0 output
    int pattern_draws;                    // baked draws use the catalogue's indices
    int serial_sort;                      // chooses the size of the sort's blocks
    uint32_t
        max_segments; // edges ask for at most so many; beyond the catalogue's triangles are split
    uint32_t max_splits; // room for their parts; 0: nothing is split
    uint32_t previous;   // not 0: output vertices have their previous position after the attributes
} girih_plan_shape;

// Fills INSTANCES and BLOCKS and all of the frame's fields that neither the catalogue, the scene
// nor girih_pack_frame fill (but for reach, variant, first_index and first_list_index, which are
// the caller's), and sets count (leaving words NULL) of the plan's other arrays: LEVELS, KEYS,
// SPLITS, ITEMS, ITEMS_SPARE, COUNTERS, GROUPS, STATUS, DRAWS, WELD_OFFSETS. Reads
// frame.range_count, pattern_count, material_count, attribute_floats. Counts beyond 2^30 triangles
// or edges, or 2^28 groups, are refused with GIRIH_ERROR_TOO_LARGE. Raises shape->max_vertices and
// max_triangles to the level-0 output (triangles: the instances' triangles and max_splits; baked
// vertices: 3 a triangle; welded: the corners).
girih_result girih_pack_plan(girih_arrays *arrays, girih_plan_shape *shape,
                             const girih_scene_table *table, const girih_instance *instances,
                             uint32_t instance_count, girih_error *error);

// Refuses a transform with an element that is not finite or beyond GIRIH_MAX_COORDINATE
// (GIRIH_ERROR_INVALID_DATA); `instance` is for the message.
girih_result girih_check_transform(const float transform[12], uint32_t instance,
                                   girih_error *error);

// The transforms' words of one instance record: rows, the normal matrix (inverse transpose times
// the absolute determinant, so that mirroring keeps normals outward), flags, scale, and the rows of
// the previous frame (NULL: as now).
void girih_pack_transform(uint32_t *record, const float transform[12], const float *previous);

// Refuses a frame that cannot be meant (a length that is not positive, a NaN), and fills the
// frame's planes, eye, rule and culling fields. Reads level_count and linear_spacing.
girih_result girih_pack_frame(girih_arrays *arrays, const girih_frame *frame, girih_error *error);

// The level that is left to the parts of an edge of this level when it is split: half of the levels
// (linear: about the root of the segments, but 8; a power of two), or more where the catalogue
// cannot split so finely.
uint32_t girih_rest_level(const girih_frame_block *frame, uint32_t level);

// Passes of the sort, and how many bits of the group number each takes.
uint32_t girih_sort_passes(uint32_t group_count, uint32_t *bits);

// The statistics in a STATUS array.
girih_statistics girih_read_status(const girih_frame_block *frame, const uint32_t *status);

// --- The CPU twins: each reads and writes the arrays as its shader does -------------------------

void girih_twin_levels(girih_arrays *arrays);
// An own surface's culling is that of its base surface, with frame.reach.
void girih_twin_select(girih_arrays *arrays, girih_surface surface);
// Splits the triangles that select has marked: SPLITS, the parts' keys, STATUS_SPLITS and what
// stands beside it. Where more than frame.max_splits are needed there are none, and
// GIRIH_STATUS_SPLIT_OVERFLOW is set.
void girih_twin_split(girih_arrays *arrays);

// After select: output triangles that the split triangles come to at the least. Inside one, edges
// are about as short as the segments of its coarsest edge or shorter: that makes the square of them
// and more, or, as measured, not less than 0.64 of it where levels are rounded.
uint64_t girih_least_split_triangles(const girih_arrays *arrays);
// Sorts into ITEMS and writes the groups' bounds and STATUS_ITEMS; COUNTERS and ITEMS_SPARE are the
// shader's alone.
girih_result girih_twin_group(girih_arrays *arrays, girih_error *error);
// The numbers of welded vertices inside shared edges: WELD_OFFSETS, STATUS_WELD_VERTICES. Part of
// output, before dispatch.
void girih_twin_weld(girih_arrays *arrays);
// After girih_twin_group, which clears the groups: of empty ones it writes only where they begin.
void girih_twin_dispatch(girih_arrays *arrays);
// Writes OUT_POSITIONS and OUT_ATTRIBUTES (instanced: patches into OUT_ATTRIBUTES), all in one
// window.
void girih_twin_evaluate(girih_arrays *arrays, girih_surface surface);
// The same for the description's own surface, baked or welded. Of the description it reads meshes,
// instances, own, own_user and base. What other frames' positions the stride leaves room for is not
// written.
void girih_twin_evaluate_own(girih_arrays *arrays, const girih_cpu_desc *desc);
// Writes the index lists whose bits are set in outputs, all in one window.
void girih_twin_output(girih_arrays *arrays, uint32_t outputs);

#endif
