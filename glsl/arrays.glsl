// The arrays of shared.h as storage buffers, and the words of their records.
//
// Where the device offers enough storage buffers a stage, each array has a binding of its own. With
// the four that core Vulkan promises (GIRIH_FEW_BUFFERS), the scene's and the catalogue's arrays share
// one binding, the plan's share another, and girih_frame.bases tells where each begins. A host's vertex
// shader (GIRIH_VERTEX) always reads them like that.
#ifndef GIRIH_ARRAYS_GLSL
#define GIRIH_ARRAYS_GLSL

#include "shared.h"

// The descriptor set of all this, and where the push constants begin: the host's to choose.
#ifndef GIRIH_SET
#define GIRIH_SET 0
#endif
#ifndef GIRIH_PUSH_OFFSET
#define GIRIH_PUSH_OFFSET 0
#endif

layout(std140, set = GIRIH_SET, binding = GIRIH_BIND_FRAME) uniform GirihFrame {
    GIRIH_FRAME_BLOCK(vec4, uvec4, uint, float)
} girih_frame;

#ifdef GIRIH_VERTEX

#define GIRIH_ACCESS readonly

// The host's specialization constants are its own.
bool girih_has(uint variant) {
    return (girih_frame.variant & variant) != 0u;
}

#else

#define GIRIH_ACCESS

// Declared before anything uses gl_WorkGroupSize: the compiler takes it for 1 up to here.
#ifndef GIRIH_LOCAL_SIZE
#define GIRIH_LOCAL_SIZE GIRIH_WORKGROUP
#endif
layout(local_size_x = GIRIH_LOCAL_SIZE) in;
const uint girih_lanes = gl_WorkGroupSize.x;

layout(push_constant) uniform GirihPush {
    layout(offset = GIRIH_PUSH_OFFSET) GIRIH_PUSH_BLOCK(uint)
} girih_push;

layout(constant_id = 0) const uint girih_variant = 0xffffffffu;

bool girih_has(uint variant) {
    return (girih_variant & variant) != 0u;
}

#endif

#if defined(GIRIH_FEW_BUFFERS) || defined(GIRIH_VERTEX)
#define GIRIH_AT(BINDING, INDEX) [girih_frame.bases[BINDING >> 2][BINDING & 3] + (INDEX)]
#define GIRIH_AT_PAIR(BINDING, INDEX) [girih_frame.bases[BINDING >> 2][BINDING & 3] / 2u + (INDEX)]
#define GIRIH_AT_FOUR(BINDING, INDEX) [girih_frame.bases[BINDING >> 2][BINDING & 3] / 4u + (INDEX)]
#define GIRIH_SCENE_BINDING(BINDING) GIRIH_BIND_SHARED_SCENE
#define GIRIH_PLAN_BINDING(BINDING) GIRIH_BIND_SHARED_PLAN
#define GIRIH_OUTPUT_BINDING(BINDING) BINDING
#define GIRIH_LIST_BINDING(BINDING) GIRIH_BIND_SHARED_LIST
#else
#define GIRIH_AT(BINDING, INDEX) [INDEX]
#define GIRIH_AT_PAIR(BINDING, INDEX) [INDEX]
#define GIRIH_AT_FOUR(BINDING, INDEX) [INDEX]
#define GIRIH_SCENE_BINDING(BINDING) BINDING
#define GIRIH_PLAN_BINDING(BINDING) BINDING
#define GIRIH_OUTPUT_BINDING(BINDING) BINDING
#define GIRIH_LIST_BINDING(BINDING) BINDING
#endif

#define GIRIH_ARRAY(WHOSE, BINDING, BLOCK, NAME) \
    layout(std430, set = GIRIH_SET, binding = WHOSE(BINDING)) GIRIH_ACCESS buffer BLOCK { uint NAME[]; };
// Words that are read together are loaded together: a CPU device pays for every load of every lane.
#define GIRIH_PAIR_ARRAY(WHOSE, BINDING, BLOCK, NAME) \
    layout(std430, set = GIRIH_SET, binding = WHOSE(BINDING)) GIRIH_ACCESS buffer BLOCK { uvec2 NAME[]; };
#define GIRIH_FOUR_ARRAY(WHOSE, BINDING, BLOCK, NAME) \
    layout(std430, set = GIRIH_SET, binding = WHOSE(BINDING)) readonly buffer BLOCK { uvec4 NAME[]; };
// Written by one invocation and read by another of the same dispatch.
#define GIRIH_COHERENT_ARRAY(WHOSE, BINDING, BLOCK, NAME) \
    layout(std430, set = GIRIH_SET, binding = WHOSE(BINDING)) coherent buffer BLOCK { uint NAME[]; };
// Written by one stage and read by the next, which is another dispatch unless the shader does several stages
// (GIRIH_SEVERAL_STAGES).
#ifdef GIRIH_SEVERAL_STAGES
#define GIRIH_STAGE_ACCESS coherent
#else
#define GIRIH_STAGE_ACCESS
#endif
#define GIRIH_STAGE_ARRAY(WHOSE, BINDING, BLOCK, TYPE, NAME) \
    layout(std430, set = GIRIH_SET, binding = WHOSE(BINDING)) GIRIH_STAGE_ACCESS buffer BLOCK { TYPE NAME[]; };

// What a surface reads.
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_VERTICES, GirihVertices, girih_vertices)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_ATTRIBUTES, GirihAttributes, girih_attributes)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_VERTICES, GirihTriangleVertices, girih_triangle_vertices)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_EDGES, GirihTriangleEdges, girih_triangle_edges)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_MATERIALS, GirihTriangleMaterials, girih_triangle_materials)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_SEAMS, GirihSeams, girih_seams)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_WELD_EDGES, GirihTriangleWeldEdges, girih_triangle_weld_edges)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_WELD_EDGES, GirihWeldEdges, girih_weld_edges)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_POINTS, GirihPoints, girih_points)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_EDGES, GirihEdges, girih_edges)
GIRIH_FOUR_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_INSTANCES, GirihInstances, girih_instances)

#define GIRIH_AT_VERTEX_PAIRS(I) girih_vertices GIRIH_AT_PAIR(GIRIH_BIND_VERTICES, I)
#define GIRIH_AT_ATTRIBUTES(I) girih_attributes GIRIH_AT(GIRIH_BIND_ATTRIBUTES, I)
#define GIRIH_AT_TRIANGLE_VERTICES(I) girih_triangle_vertices GIRIH_AT(GIRIH_BIND_TRIANGLE_VERTICES, I)
#define GIRIH_AT_TRIANGLE_EDGES(I) girih_triangle_edges GIRIH_AT(GIRIH_BIND_TRIANGLE_EDGES, I)
#define GIRIH_AT_TRIANGLE_MATERIALS(I) girih_triangle_materials GIRIH_AT(GIRIH_BIND_TRIANGLE_MATERIALS, I)
#define GIRIH_AT_SEAMS(I) girih_seams GIRIH_AT(GIRIH_BIND_SEAMS, I)
#define GIRIH_AT_TRIANGLE_WELD_EDGES(I) girih_triangle_weld_edges GIRIH_AT(GIRIH_BIND_TRIANGLE_WELD_EDGES, I)
#define GIRIH_AT_WELD_EDGES(I) girih_weld_edges GIRIH_AT_PAIR(GIRIH_BIND_WELD_EDGES, I)
#define GIRIH_AT_WELD_EDGE_EDGES(I) girih_weld_edges GIRIH_AT_PAIR(GIRIH_BIND_WELD_EDGES, I).x
#define GIRIH_AT_WELD_EDGE_OWNERS(I) girih_weld_edges GIRIH_AT_PAIR(GIRIH_BIND_WELD_EDGES, I).y
#define GIRIH_AT_WELD_POINTS(I) girih_points GIRIH_AT_PAIR(GIRIH_BIND_POINTS, I).x
#define GIRIH_AT_VERTEX_OWNERS(I) girih_points GIRIH_AT_PAIR(GIRIH_BIND_POINTS, I).y
#define GIRIH_AT_EDGE_WELD_EDGES(I) girih_edges GIRIH_AT_PAIR(GIRIH_BIND_EDGES, I).x
#define GIRIH_AT_EDGE_OWNERS(I) girih_edges GIRIH_AT_PAIR(GIRIH_BIND_EDGES, I).y
#define GIRIH_AT_INSTANCE_FOURS(I) girih_instances GIRIH_AT_FOUR(GIRIH_BIND_INSTANCES, I)

uvec4 girih_instance_four(uint instance, uint field) {
    if (!girih_has(GIRIH_VARIANT_INSTANCES)) {
        return girih_frame.only_instance[field >> 2];
    }
    return GIRIH_AT_INSTANCE_FOURS(instance * (GIRIH_INSTANCE_WORDS / 4) + (field >> 2));
}

uint girih_instance(uint instance, uint field) {
    return girih_instance_four(instance, field)[field & 3u];
}

#ifndef GIRIH_VERTEX

GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_EDGE_POINTS, GirihEdgePoints, girih_edge_points)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_PATTERNS, GirihPatterns, girih_patterns)
GIRIH_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_PATTERN_VERTICES, GirihPatternVertices, girih_pattern_vertices)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_PATTERN_INDICES, GirihPatternTriangles, girih_pattern_triangles)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_VERTICES, GirihTriangleVertexPairs, girih_triangle_vertex_pairs)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_EDGES, GirihTriangleEdgePairs, girih_triangle_edge_pairs)
GIRIH_PAIR_ARRAY(GIRIH_SCENE_BINDING, GIRIH_BIND_TRIANGLE_WELD_EDGES, GirihTriangleWeldEdgePairs, girih_triangle_weld_edge_pairs)
GIRIH_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_BLOCKS, GirihBlocks, girih_blocks)
GIRIH_STAGE_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_LEVELS, GirihLevels, uint, girih_levels)
GIRIH_STAGE_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_SPLITS, GirihSplitFours, uvec4, girih_split_fours)
GIRIH_STAGE_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_KEYS, GirihKeys, uint, girih_keys)
GIRIH_STAGE_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_ITEMS, GirihItems, uvec2, girih_items)
GIRIH_STAGE_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_ITEMS_SPARE, GirihItemsSpare, uvec2, girih_items_spare)
GIRIH_STAGE_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_COUNTERS, GirihCounters, uint, girih_counters)
GIRIH_COHERENT_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_GROUPS, GirihGroups, girih_groups)
GIRIH_FOUR_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_GROUPS, GirihGroupFours, girih_group_fours)
GIRIH_COHERENT_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_STATUS, GirihStatus, girih_status)
GIRIH_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_DRAWS, GirihDraws, girih_draws)
GIRIH_ARRAY(GIRIH_PLAN_BINDING, GIRIH_BIND_WELD_OFFSETS, GirihWeldOffsets, girih_weld_offsets)
GIRIH_ARRAY(GIRIH_OUTPUT_BINDING, GIRIH_BIND_OUT_POSITIONS, GirihOutPositions, girih_out_positions)
GIRIH_ARRAY(GIRIH_OUTPUT_BINDING, GIRIH_BIND_OUT_ATTRIBUTES, GirihOutAttributes, girih_out_attributes)
GIRIH_PAIR_ARRAY(GIRIH_OUTPUT_BINDING, GIRIH_BIND_OUT_POSITIONS, GirihOutPositionPairs, girih_out_position_pairs)
GIRIH_PAIR_ARRAY(GIRIH_OUTPUT_BINDING, GIRIH_BIND_OUT_ATTRIBUTES, GirihOutAttributePairs, girih_out_attribute_pairs)
layout(std430, set = GIRIH_SET, binding = GIRIH_OUTPUT_BINDING(GIRIH_BIND_OUT_ATTRIBUTES)) writeonly buffer GirihOutPatchFours {
    uvec4 girih_out_patch_fours[];
};
GIRIH_ARRAY(GIRIH_LIST_BINDING, GIRIH_BIND_OUT_INDICES, GirihOutIndices, girih_out_indices)
GIRIH_ARRAY(GIRIH_LIST_BINDING, GIRIH_BIND_OUT_CLOSED_INDICES, GirihOutClosedIndices, girih_out_closed_indices)
GIRIH_PAIR_ARRAY(GIRIH_LIST_BINDING, GIRIH_BIND_OUT_INDICES, GirihOutIndexPairs, girih_out_index_pairs)
GIRIH_PAIR_ARRAY(GIRIH_LIST_BINDING, GIRIH_BIND_OUT_CLOSED_INDICES, GirihOutClosedIndexPairs, girih_out_closed_index_pairs)
GIRIH_PAIR_ARRAY(GIRIH_LIST_BINDING, GIRIH_BIND_OUT_SOURCES, GirihOutSources, girih_out_sources)

#define GIRIH_AT_EDGE_POINTS(I) girih_edge_points GIRIH_AT_PAIR(GIRIH_BIND_EDGE_POINTS, I)
#define GIRIH_AT_PATTERNS(I) girih_patterns GIRIH_AT(GIRIH_BIND_PATTERNS, I)
#define GIRIH_AT_PATTERN_VERTICES(I) girih_pattern_vertices GIRIH_AT(GIRIH_BIND_PATTERN_VERTICES, I)
#define GIRIH_AT_PATTERN_TRIANGLES(I) girih_pattern_triangles GIRIH_AT_PAIR(GIRIH_BIND_PATTERN_INDICES, I)
#define GIRIH_AT_TRIANGLE_VERTEX_PAIRS(I) girih_triangle_vertex_pairs GIRIH_AT_PAIR(GIRIH_BIND_TRIANGLE_VERTICES, I)
#define GIRIH_AT_TRIANGLE_EDGE_PAIRS(I) girih_triangle_edge_pairs GIRIH_AT_PAIR(GIRIH_BIND_TRIANGLE_EDGES, I)
#define GIRIH_AT_TRIANGLE_WELD_EDGE_PAIRS(I) girih_triangle_weld_edge_pairs GIRIH_AT_PAIR(GIRIH_BIND_TRIANGLE_WELD_EDGES, I)
#define GIRIH_AT_BLOCKS(I) girih_blocks GIRIH_AT(GIRIH_BIND_BLOCKS, I)
#define GIRIH_AT_LEVELS(I) girih_levels GIRIH_AT(GIRIH_BIND_LEVELS, I)
#define GIRIH_AT_SPLIT_FOURS(I) girih_split_fours GIRIH_AT_FOUR(GIRIH_BIND_SPLITS, I)
#define GIRIH_AT_KEYS(I) girih_keys GIRIH_AT(GIRIH_BIND_KEYS, I)
#define GIRIH_AT_ITEMS(I) girih_items GIRIH_AT_PAIR(GIRIH_BIND_ITEMS, I)
#define GIRIH_AT_ITEMS_SPARE(I) girih_items_spare GIRIH_AT_PAIR(GIRIH_BIND_ITEMS_SPARE, I)
#define GIRIH_AT_COUNTERS(I) girih_counters GIRIH_AT(GIRIH_BIND_COUNTERS, I)
#define GIRIH_AT_GROUPS(I) girih_groups GIRIH_AT(GIRIH_BIND_GROUPS, I)
#define GIRIH_AT_GROUP_FOURS(I) girih_group_fours GIRIH_AT_FOUR(GIRIH_BIND_GROUPS, I)
#define GIRIH_AT_STATUS(I) girih_status GIRIH_AT(GIRIH_BIND_STATUS, I)
#define GIRIH_AT_DRAWS(I) girih_draws GIRIH_AT(GIRIH_BIND_DRAWS, I)
#define GIRIH_AT_WELD_OFFSETS(I) girih_weld_offsets GIRIH_AT(GIRIH_BIND_WELD_OFFSETS, I)
#define GIRIH_AT_OUT_POSITIONS(I) girih_out_positions[I]
#define GIRIH_AT_OUT_ATTRIBUTES(I) girih_out_attributes[I]
#define GIRIH_AT_OUT_POSITION_PAIRS(I) girih_out_position_pairs[I]
#define GIRIH_AT_OUT_ATTRIBUTE_PAIRS(I) girih_out_attribute_pairs[I]
#define GIRIH_AT_OUT_PATCH_FOURS(I) girih_out_patch_fours[I]
#define GIRIH_AT_OUT_INDICES(I) girih_out_indices[I]
#define GIRIH_AT_OUT_CLOSED_INDICES(I) girih_out_closed_indices[I]
#define GIRIH_AT_OUT_INDEX_PAIRS(I) girih_out_index_pairs[I]
#define GIRIH_AT_OUT_CLOSED_INDEX_PAIRS(I) girih_out_closed_index_pairs[I]
#define GIRIH_AT_OUT_SOURCES(I) girih_out_sources[I]

// Three words from `FIRST` on, as a pair and a single one: every load and store of every lane costs a CPU
// device, and three words begin at an even word or end at one.
#define GIRIH_READ_THREE(AT, AT_PAIRS, FIRST, V) \
    { \
        uint girih_word = (FIRST); \
        bool girih_even = (girih_word & 1u) == 0u; \
        uvec2 girih_pair = AT_PAIRS((girih_word + 1u) >> 1); \
        uint girih_single = AT(girih_even ? girih_word + 2u : girih_word); \
        V = girih_even ? uvec3(girih_pair, girih_single) : uvec3(girih_single, girih_pair); \
    }
#define GIRIH_WRITE_THREE(AT, AT_PAIRS, FIRST, V) \
    { \
        uint girih_word = (FIRST); \
        bool girih_even = (girih_word & 1u) == 0u; \
        AT_PAIRS((girih_word + 1u) >> 1) = girih_even ? (V).xy : (V).yz; \
        AT(girih_even ? girih_word + 2u : girih_word) = girih_even ? (V).z : (V).x; \
    }

// number / divisor; `number` becomes the remainder. A CPU device divides lane by lane, and would do so for
// the lanes that have nothing to divide too; this loop it leaves at once.
uint girih_quotient(inout uint number, uint divisor) {
    uint quotient = 0u;
    for (int bit = findMSB(number) - findMSB(divisor); bit >= 0; --bit) {
        if (number >> bit >= divisor) {
            number -= divisor << bit;
            quotient |= 1u << bit;
        }
    }
    return quotient;
}

// Arguments, from word `field` of STATUS on, of a dispatch of so many invocations in workgroups of `size`.
void girih_write_dispatch(uint field, uint invocations, uint size) {
    uint workgroups = (invocations + size - 1u) / size;
    uint rows = (workgroups + 65534u) / 65535u;
    GIRIH_AT_STATUS(field) = rows > 1u ? 65535u : workgroups;
    GIRIH_AT_STATUS(field + 1u) = rows;
    GIRIH_AT_STATUS(field + 2u) = 1u;
}

// The first of the sorted items whose group is not before `group`.
uint girih_first_item(uint group, uint items) {
    uint low = 0u;
    uint high = items;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (GIRIH_AT_ITEMS(middle)[GIRIH_ITEM_KEY] >> 3 < group) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// Word `field` of a rank's pattern.
uint girih_pattern(uint rank, uint field) {
    return GIRIH_AT_PATTERNS(rank * GIRIH_PATTERN_WORDS + field);
}

// The corners of a triangle from its two words of PATTERN_TRIANGLES.
uvec3 girih_pattern_triangle(uvec2 words) {
    return uvec3(words.x, words.x >> GIRIH_TRIANGLE_BITS | words.y << (32u - GIRIH_TRIANGLE_BITS),
                 words.y >> (2u * GIRIH_TRIANGLE_BITS - 32u)) & GIRIH_TRIANGLE_MASK;
}

// The rank of a range.
uint girih_range_rank(uint range) {
    return GIRIH_AT_PATTERNS(girih_frame.pattern_count * GIRIH_PATTERN_WORDS + range);
}

// The instance that the plan's triangle, edge or weld edge `number` belongs to: `first` is the field
// with an instance's first number, `blocks` where the words for this kind begin in BLOCKS.
uint girih_find_instance(uint number, uint first, uint blocks) {
    if (!girih_has(GIRIH_VARIANT_INSTANCES)) {
        return 0u;
    }
    uint instance = GIRIH_AT_BLOCKS(blocks + number / GIRIH_BLOCK);
    while (girih_instance(instance + 1u, first) <= number) {
        ++instance;
    }
    return instance;
}

// The number of this invocation in a dispatch whose workgroups may fill a second dimension.
uint girih_invocation() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

#endif

#endif
