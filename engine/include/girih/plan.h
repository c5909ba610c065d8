// Scene, frame and plan: what is refined, how finely, and into which buffers.
//
// Where nothing else is said, functions that take const objects may be called by several threads at
// once, and those that take others are externally synchronised on them.
// Stability: stable, but for own surfaces and previous positions (experimental)
#ifndef GIRIH_PLAN_H
#define GIRIH_PLAN_H

#include <vulkan/vulkan_core.h>

#include "girih/context.h"
#include "girih/mesh.h"
#include "girih/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Scene: an arena of meshes on the device ----------------------------------------------------

typedef struct girih_scene girih_scene;

// The buffers of a scene, in the order of girih_scene_needs.
typedef enum girih_scene_buffer {
    GIRIH_SCENE_ARENA = 0,
    GIRIH_SCENE_STAGING = 1, // only until the recorded girih_cmd_upload_scene has been executed
} girih_scene_buffer;
#define GIRIH_SCENE_BUFFERS 2

typedef struct girih_scene_desc {
    const girih_mesh *const *meshes; // of equal attribute_floats; read during the call only
    uint32_t mesh_count;
    int dynamic; // not 0: the host moves the vertices on the GPU (girih_scene_vertices); the meshes
                 // must have been prepared as dynamic
    int previous; // not 0, dynamic scenes: the previous frame's vertices are kept beside the
                  // current ones (girih_cmd_keep_vertices)
    VkBufferUsageFlags usage;          // usage flags the host wants beside girih's own on the arena
    const girih_buffer_range *buffers; // [GIRIH_SCENE_BUFFERS]; NULL: girih makes all. They must
                                       // outlive the scene and stay the host's
} girih_scene_desc;

// The buffers a scene of this description wants, for a host that brings them. Thread-safe.
GIRIH_API girih_result girih_scene_needs(const girih_context *context, const girih_scene_desc *desc,
                                         girih_buffer_need needs[GIRIH_SCENE_BUFFERS],
                                         girih_error *error);

// Packs meshes into one arena for a context's device. On success *scene is the caller's; record
// girih_cmd_upload_scene once before the first use. Thread-safe.
GIRIH_API girih_result girih_scene_create(const girih_context *context,
                                          const girih_scene_desc *desc, girih_scene **scene,
                                          girih_error *error);

// Records the upload of a scene: begins with no access, ends with transfer writes made available
// and visible to compute and vertex shader reads and to compute and transfer writes. Externally
// synchronised on the scene.
GIRIH_API void girih_cmd_upload_scene(girih_scene *scene, VkCommandBuffer commands);

// Frees the upload's staging buffer, if it is girih's, once the recorded upload has been executed.
// Optional. Externally synchronised on the scene.
GIRIH_API void girih_scene_trim(girih_scene *scene);

// Where a dynamic scene keeps the vertices of mesh number `mesh`: 6 floats each, position and unit
// normal, in the order of girih_mesh.positions (girih_mesh.vertex_source names the input vertex of
// each). The host's commands may write them between two girih_cmd_refine of the scene's plans:
//  - before the host's writes nothing is needed: girih_cmd_refine ends with a barrier that orders
//    later compute and transfer after its own reads; an instanced draw of an own surface reads them
//    in the vertex shader, so after such a draw order vertex shader before the writes;
//  - after them nothing is needed where they are compute shader or transfer writes on the same
//    queue: girih_cmd_refine begins by waiting for those. Other writes the host makes available and
//    visible to compute (and vertex shader) reads.
// Only positions of vertices that stand for their point count (vertex_point[v] == v): duplicates
// are read through them, so rounding can move nothing apart. Every normal counts. Coordinates must
// stay finite and within GIRIH_MAX_COORDINATE. Topology, seams and welds stay as prepared.
GIRIH_API girih_result girih_scene_vertices(const girih_scene *scene, uint32_t mesh,
                                            girih_buffer_range *range, VkDeviceSize *size,
                                            girih_error *error);

// Records, before the host moves the vertices for a new frame, the copy of the current vertices to
// the previous frame's: begins by waiting for compute and vertex shader reads and compute and
// transfer writes of the vertices, ends with transfer writes available and visible to compute,
// vertex shader and transfer, reads and writes. Scenes made with `previous` only; else does
// nothing.
GIRIH_API void girih_cmd_keep_vertices(const girih_scene *scene, VkCommandBuffer commands);

// Takes NULL. No submitted command buffer and no plan may still use the scene.
GIRIH_API void girih_scene_destroy(girih_scene *scene);

// --- Frame: how fine, and what is seen ----------------------------------------------------------

typedef enum girih_level_rule {
    GIRIH_LEVEL_SEGMENTS = 0, // every edge alike: `segments`
    GIRIH_LEVEL_RANDOM = 1,   // 1..segments per edge, from a hash of its end positions and `seed`
    GIRIH_LEVEL_EDGE_PIXELS = 2,  // `length` pixels a segment on the screen
    GIRIH_LEVEL_EDGE_LENGTH = 3,  // `length` mesh units a segment
    GIRIH_LEVEL_RANDOM_LEVEL = 4, // catalogue level 0..segments per edge, from the same hash: the
                                  // measure of ARKFPI's Table 3
    GIRIH_LEVEL_HORIZONTAL_PIXELS = 5, // `length` pixels a segment across the picture of a
                                       // cylindrical projection: its horizontal length on the
                                       // screen, of Lorenz and Doellner 2008, section 5.2
} girih_level_rule;

// One view of one frame. {0}: every edge one segment, nothing culled.
typedef struct girih_frame {
    girih_level_rule rule;
    uint32_t segments;
    uint32_t seed;
    float length;
    float pixels_per_unit; // GIRIH_LEVEL_EDGE_PIXELS: pixels that one unit covers at distance 1
                           // (perspective: resolution_y / (2 tan(fov_y / 2))) or anywhere
                           // (orthographic)
    float near_distance;   // perspective: nearer edges count as at this distance; > 0.
                           // GIRIH_LEVEL_HORIZONTAL_PIXELS: of the axis; no edge counts as longer
                           // than it would be, seen sideways, at this distance
    float eye[3];          // world; orthographic: the direction towards the viewer
    int orthographic;
    int cull_frustum;   // against planes
    int cull_back;      // triangles facing away whose material is not two-sided
    float planes[6][4]; // world: inside where n·p + d >= 0, any length
    // Own surfaces: the descriptor set of the surface's textures and buffers, as its program's
    // set_layout says. VK_NULL_HANDLE: none.
    VkDescriptorSet surface_set;
    // A number of the host's that changes whenever something that girih cannot see has changed: the
    // vertices of a dynamic scene, or what an own surface reads. See girih_cmd_refine.
    uint64_t revision;
    // A cylindrical projection: the axis goes through the eye along `up`; across the picture goes
    // the angle around it, up the picture the slope, height above the eye over distance from the
    // axis. panorama.glsl draws it. Sides closer together than 180 degrees are two of the planes;
    // farther apart they cull nothing. cull_back is as in perspective.
    int cylindrical;         // not 0: cull_frustum culls against the slopes too
    float up[3];             // world, any length; {0, 0, 0}: the world's y axis
    float pixels_per_radian; // GIRIH_LEVEL_HORIZONTAL_PIXELS: width / angle of view; > 0
    float lowest_slope;      // at the picture's lower and upper border: the tangents of their
    float highest_slope;     // angles above the horizon
} girih_frame;

// --- Plan: one frame in flight ------------------------------------------------------------------

typedef struct girih_instance {
    uint32_t mesh;       // index into the scene's meshes
    float transform[12]; // rows of mesh to world, 3x4: world = (t[0..2]·p + t[3], ...), this
                         // frame's and the previous frame's
} girih_instance;

typedef enum girih_mode {
    GIRIH_MODE_INSTANCED = 0, // drawn at once, one instance a triangle; needs multiDrawIndirect and
                              // drawIndirectFirstInstance
    GIRIH_MODE_BAKED = 1,     // vertices in a buffer, each triangle its own
    GIRIH_MODE_WELDED = 2,    // vertices in a buffer, shared inside a submesh
} girih_mode;

typedef enum girih_output_bits {
    GIRIH_OUTPUT_INDICES =
        1, // baked, welded: 32-bit indices of every output triangle; always there when welded
    GIRIH_OUTPUT_CLOSED_INDICES =
        2, // welded, nothing culled: indices by position alone, closed where the input is
    GIRIH_OUTPUT_SOURCES =
        4, // baked, welded: per output triangle: instance, and triangle of its girih_mesh
    GIRIH_OUTPUT_NO_DRAW = 8,   // no draw arguments are wanted
    GIRIH_OUTPUT_PREVIOUS = 16, // own surfaces, baked, welded: each vertex's position in the
                                // previous frame, 3 floats after its attributes
    GIRIH_OUTPUT_PADDED = 32,   // indices and closed indices beyond the output's are degenerate
                              // triangles (0, 0, 0), so that a count known beforehand may be built
                              // or drawn: max_triangles
} girih_output_bits;

// The buffers of a plan, in the order of girih_plan_needs.
typedef enum girih_plan_buffer {
    GIRIH_PLAN_WORK = 0,
    GIRIH_PLAN_STAGING = 1,
    GIRIH_PLAN_STATUS = 2,
    GIRIH_PLAN_POSITIONS = 3,
    GIRIH_PLAN_ATTRIBUTES = 4,
    GIRIH_PLAN_INDICES = 5,
    GIRIH_PLAN_CLOSED_INDICES = 6,
    GIRIH_PLAN_SOURCES = 7,
} girih_plan_buffer;
#define GIRIH_PLAN_BUFFERS 8

typedef struct girih_plan_desc {
    const girih_scene *scene;        // must outlive the plan
    const girih_instance *instances; // read during the call
    uint32_t instance_count;
    girih_surface surface;
    const girih_surface_program *program; // GIRIH_SURFACE_OWN: must outlive the plan
    girih_mode mode;
    uint32_t outputs;       // girih_output_bits
    uint32_t max_vertices;  // room for output vertices (baked, welded); 0: room for level 0 only
    uint32_t max_triangles; // room for output triangles; 0: room for level 0 only
    // Unlimited levels: a triangle with an edge that asks for more segments than the catalogue
    // holds is split by a base pattern, on the GPU, and its parts again if need be, until all
    // levels are the catalogue's. Baked and instanced; the welded mode is refused where both are
    // set. 0 in either: edges are clamped to the catalogue's levels. Both set: an instanced vertex
    // shader defines GIRIH_SPLITS (girih.glsl), whether anything will be split or not.
    uint32_t max_segments; // that an edge may ask for: rounded up to a level, at most 32768, and
                           // not below the catalogue's. GIRIH_LEVEL_HORIZONTAL_PIXELS: 256 levels
    uint32_t max_splits; // room for the parts of split triangles, all passes together: 60 to 68
                         // bytes each; instanced, a patch each as well (128 bytes flat, 240 PN, 48
                         // own); baked, max_triangles and max_vertices are raised to hold a
                         // triangle each
    VkBufferUsageFlags vertex_usage;   // usage flags the host wants beside girih's own on the
    VkBufferUsageFlags index_usage;    // position and attribute buffers, and on the index buffers
    const girih_buffer_range *buffers; // [GIRIH_PLAN_BUFFERS]; NULL: girih makes all. They must
                                       // outlive the plan and stay the host's
} girih_plan_desc;

typedef struct girih_plan girih_plan;

// The mode that is likely the fastest for a plan of this description, drawn once a frame, whose
// levels change every frame. `output_triangles` is about how many a frame will have; 0: unknown. Of
// the description, scene, instances, surface, program and outputs count. A mode that the outputs or
// the device's features ask for is taken first. Then, on CPU devices, as measured on lavapipe:
// instanced where patterns are large (24 triangles and more on average) and the surface is the
// library's own, else baked. On all other devices instanced, which was measured on none of them: a
// host that draws one refinement several times may do better with GIRIH_MODE_BAKED. Never fails:
// where something that must be set is not, GIRIH_MODE_BAKED. Thread-safe.
GIRIH_API girih_mode girih_choose_mode(const girih_context *context, const girih_plan_desc *desc,
                                       uint64_t output_triangles);

// The buffers a plan of this description wants, for a host that brings them. Thread-safe.
GIRIH_API girih_result girih_plan_needs(const girih_context *context, const girih_plan_desc *desc,
                                        girih_buffer_need needs[GIRIH_PLAN_BUFFERS],
                                        girih_error *error);

// Creates a plan with its buffers. Room below the level-0 output is raised to it. On success *plan
// is the caller's. Thread-safe.
GIRIH_API girih_result girih_plan_create(const girih_context *context, const girih_plan_desc *desc,
                                         girih_plan **plan, girih_error *error);

// Takes NULL. No submitted command buffer may still use the plan.
GIRIH_API void girih_plan_destroy(girih_plan *plan);

// Moves an instance; taken up by the next girih_cmd_refine. `previous` is where it was in the
// previous frame, for motion vectors; NULL: where it is. Both stay until they are set again: an
// instance that comes to rest is set once more, with NULL. Elements that are not finite or beyond
// GIRIH_MAX_COORDINATE are refused with GIRIH_ERROR_INVALID_DATA. Externally synchronised on the
// plan, and not while a submitted girih_cmd_refine of this plan has not finished.
GIRIH_API girih_result girih_plan_set_transform(girih_plan *plan, uint32_t instance,
                                                const float transform[12], const float *previous,
                                                girih_error *error);

// Timestamps that girih_cmd_refine writes, GIRIH_TIMESTAMPS of them from `first` on: at its begin,
// then at the end of levels, select, group, dispatch, evaluate and output. Small plans do the first
// four stages in one dispatch: the time of all four then stands as that of levels, and the others'
// are next to nothing. The host resets the queries.
typedef struct girih_timestamps {
    VkQueryPool pool; // VK_NULL_HANDLE: none
    uint32_t first;
} girih_timestamps;
#define GIRIH_TIMESTAMPS 7

// Records a frame: levels, select, group, dispatch, evaluate and output, compute and transfer only,
// outside a render pass. Begins by waiting for compute, vertex input, vertex shader, indirect and
// transfer accesses of the plan's buffers by earlier commands of the queue; ends with its writes
// available and visible to indirect command, index, vertex attribute, vertex shader, compute and
// transfer reads and to the host (statistics). `frame` is read during the call. Externally
// synchronised on the plan; plans of one scene may be recorded by several threads at once.
//
// A frame that cannot be meant (lengths that are not positive, values that are not finite) gives
// GIRIH_ERROR_INVALID_DATA or _ARGUMENT, as do closed indices with culling and an own surface's set
// that is missing; then nothing has been recorded.
//
// Unchanged input is not redone: where frame (its revision and surface_set included) and transforms
// are those of the plan's last recorded girih_cmd_refine, nothing but the timestamps is recorded,
// and the buffers keep what that one wrote. So a recorded girih_cmd_refine must be submitted,
// before later ones and on the same queue; one that was thrown away is made good by
// girih_plan_invalidate.
GIRIH_API girih_result girih_cmd_refine(girih_plan *plan, VkCommandBuffer commands,
                                        const girih_frame *frame,
                                        const girih_timestamps *timestamps, girih_error *error);

// Has the next girih_cmd_refine record everything, whatever has changed. Externally synchronised on
// the plan.
GIRIH_API void girih_plan_invalidate(girih_plan *plan);

// Records the draw of one material inside the host's render pass, with the host's pipeline bound:
// binds vertex and index buffers (bindings 0 and up, girih_plan_vertex_input) and draws indirectly.
// Instanced: also binds the descriptor set of girih.glsl as set `set` of `layout` where the scene
// has attributes or the surface is an own one; no push constants are touched. Begins and ends with
// indirect command, index, vertex attribute and vertex shader reads of what girih_cmd_refine wrote.
// May be recorded by several threads at once.
GIRIH_API void girih_cmd_draw(const girih_plan *plan, VkCommandBuffer commands, uint32_t material,
                              VkPipelineLayout layout, uint32_t set);

// Vertex input of a pipeline that draws this plan's mode and surface, for girih.glsl. The arrays
// live as long as the plan.
GIRIH_API const VkPipelineVertexInputStateCreateInfo *
girih_plan_vertex_input(const girih_plan *plan);

// What the last executed girih_cmd_refine did; valid once the host has waited for it.
typedef struct girih_statistics {
    uint64_t input_triangles; // of all instances
    uint64_t culled_triangles;
    uint64_t clamped_edges; // edges that asked for more segments than the catalogue holds, or,
                            // where triangles are split, than max_segments allows
    uint64_t split_triangles; // of the input's
    uint64_t parts;           // that they were refined as
    uint64_t needed_splits; // room that parts needed; after an overflow, as far as they were made:
                            // more than max_splits, and maybe not all yet
    uint64_t output_triangles;
    uint64_t output_vertices;  // instanced: vertices of all instances' patterns
    uint64_t needed_triangles; // what the levels asked for; more than the output after an overflow
    uint64_t needed_vertices;
    uint32_t groups;        // not empty
    uint32_t base_patterns; // in use
    int overflow;           // the frame did not fit and was drawn at level 0
} girih_statistics;
GIRIH_API girih_statistics girih_plan_statistics(const girih_plan *plan);

// Whether the last executed girih_cmd_refine used the base pattern of a rank of the context's
// catalogue: girih_statistics.base_patterns of them are in use. 0 for ranks that there are not.
GIRIH_API int girih_plan_uses_pattern(const girih_plan *plan, uint32_t rank);

// The buffers a plan writes. Vertex n of the output is 3 floats at positions + 12 n, and its normal
// and attributes (and previous position) are floats at attributes + attribute_stride n. Buffers
// that the mode or outputs do not ask for are VK_NULL_HANDLE.
typedef struct girih_plan_buffers {
    girih_buffer_range positions;
    girih_buffer_range attributes;
    girih_buffer_range indices;        // 3 x uint32 a triangle
    girih_buffer_range closed_indices; // 3 x uint32 a triangle
    girih_buffer_range sources; // 2 x uint32 a triangle: instance, triangle of its girih_mesh
    uint32_t attribute_stride;  // bytes
    uint32_t max_vertices, max_triangles;
} girih_plan_buffers;
GIRIH_API girih_plan_buffers girih_plan_get_buffers(const girih_plan *plan);

// The output triangles of a material after the last executed girih_cmd_refine: they are contiguous.
GIRIH_API void girih_plan_material_range(const girih_plan *plan, uint32_t material,
                                         uint32_t *first_triangle, uint32_t *triangle_count);

// Number of materials of the plan's scene: the largest material and one.
GIRIH_API uint32_t girih_plan_material_count(const girih_plan *plan);

#ifdef __cplusplus
}
#endif
#endif
