// Stage 6: index buffers of the baked and welded modes (GIRIH_KERNEL 0), and before them the numbers
// of the welded vertices inside shared edges: sums of blocks (1), of all blocks (2), of every weld edge
// (3). One lane a block, and in (2) one workgroup.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#if GIRIH_KERNEL == 2
#define GIRIH_LOCAL_SIZE GIRIH_LARGE_WORKGROUP
#elif GIRIH_KERNEL != 0
#define GIRIH_LOCAL_SIZE GIRIH_SCAN_WORKGROUP
#endif
#include "patch.glsl"

#if GIRIH_KERNEL == 0

uvec3 weld_triangle(GirihWeld weld, uvec3 corners) {
    return uvec3(girih_weld_vertex(weld, corners.x), girih_weld_vertex(weld, corners.y),
                 girih_weld_vertex(weld, corners.z));
}

bool writes(uint list) {
    return girih_has(list << GIRIH_VARIANT_OUTPUT_SHIFT);
}

// As evaluate's: no way out before the end, and what can be is done outside of all branches.
void main() {
    bool overflow = girih_overflow();
    uint window_first = girih_push.window_first;
    uint window_count = girih_push.window_count;
    uint number;
    uint chunk;
    bool there = girih_work(girih_interleaved_invocation(), 0u, number, chunk);
    GirihItem item = girih_read_item(number, overflow);
    uvec4 work = girih_group_work(item.group);
    uvec4 shape = girih_group_shape(item.group);
    uint count = shape[GIRIH_GROUP_TRIANGLES - GIRIH_GROUP_PATTERN_TRIANGLE];
    uint pattern = shape[0];
    // A pattern has less than twice as many triangles as vertices (Euler).
    uint triangle = min(chunk * 2u * GIRIH_CHUNK_VERTICES, count);
    uint end = there ? min(triangle + 2u * GIRIH_CHUNK_VERTICES, count) : 0u;
    uint first = work[GIRIH_GROUP_BASE_TRIANGLE - GIRIH_GROUP_VERTICES] + number * count - window_first;
    bool welded = girih_has(GIRIH_VARIANT_WELDED);
    bool closed = writes(GIRIH_OUTPUT_BIT_CLOSED_INDICES);
    uint first_vertex = work[GIRIH_GROUP_BASE_VERTEX - GIRIH_GROUP_VERTICES] + number * work[0];
    GirihWeld weld;
    GirihWeld closed_weld;
    if (welded) {
        uint vertices[3];
        girih_item_vertices(item, vertices);
        weld = girih_item_weld(item, vertices, work, shape, false);
        if (closed) {
            closed_weld = girih_item_weld(item, vertices, work, shape, true);
        }
    }
    uint mesh_triangle = item.scene_triangle - girih_instance(item.instance, GIRIH_INSTANCE_MESH_TRIANGLE);
    do {
        uint slot = first + triangle;
        uvec3 corners = girih_pattern_triangle(GIRIH_AT_PATTERN_TRIANGLES(pattern + min(triangle, count - 1u)));
        uvec3 triangle_vertices = welded ? weld_triangle(weld, corners) : first_vertex + corners;
        if (triangle < end && slot < window_count) {
            if (writes(GIRIH_OUTPUT_BIT_INDICES)) {
                GIRIH_WRITE_THREE(GIRIH_AT_OUT_INDICES, GIRIH_AT_OUT_INDEX_PAIRS, 3u * slot, triangle_vertices)
            }
            if (closed) {
                uvec3 closed_vertices = weld_triangle(closed_weld, corners);
                GIRIH_WRITE_THREE(GIRIH_AT_OUT_CLOSED_INDICES, GIRIH_AT_OUT_CLOSED_INDEX_PAIRS, 3u * slot, closed_vertices)
            }
            if (writes(GIRIH_OUTPUT_BIT_SOURCES)) {
                GIRIH_AT_OUT_SOURCES(slot) = uvec2(item.instance, mesh_triangle);
            }
        }
        ++triangle;
    } while (triangle < end);
}

#else

// Output vertices inside the plan's weld edge.
uint inner_vertices(uint weld_edge) {
    uint instance = girih_find_instance(weld_edge, GIRIH_INSTANCE_FIRST_WELD_EDGE, girih_frame.weld_blocks);
    uint scene_weld_edge = weld_edge - girih_instance(instance, GIRIH_INSTANCE_WELD_DELTA);
    uint level = GIRIH_AT_LEVELS(GIRIH_AT_WELD_EDGE_EDGES(scene_weld_edge) + girih_instance(instance, GIRIH_INSTANCE_EDGE_DELTA));
    return girih_frame.linear_spacing != 0u ? level : (1u << level) - 1u;
}

#if GIRIH_KERNEL == 1

void main() {
    uint block = girih_invocation();
    if (block >= girih_frame.scan_block_count) {
        return;
    }
    uint end = min((block + 1u) * GIRIH_SCAN_BLOCK, girih_frame.weld_edge_count);
    uint low = 0u;
    for (uint n = block * GIRIH_SCAN_BLOCK; n < end; ++n) {
        low += inner_vertices(n);
    }
    GIRIH_AT_COUNTERS(block) = low;
}

#elif GIRIH_KERNEL == 2

shared uvec2 sums[girih_lanes];

// Counts that may pass 2^32 are carried as (low, high).
uvec2 add_wide(uvec2 a, uvec2 b) {
    uint carry;
    uint low = uaddCarry(a.x, b.x, carry);
    return uvec2(low, a.y + b.y + carry);
}

// Each lane sums a run of blocks, the sums of the lanes before it are added, and it walks its run again
// to write: at most 2^15 turns.
void main() {
    uint lane = gl_LocalInvocationID.x;
    uint run = (girih_frame.scan_block_count + girih_lanes - 1u) / girih_lanes;
    uint begin = min(lane * run, girih_frame.scan_block_count);
    uint end = min(begin + run, girih_frame.scan_block_count);
    uvec2 sum = uvec2(0u);
    for (uint block = begin; block < end; ++block) {
        sum = add_wide(sum, uvec2(GIRIH_AT_COUNTERS(block), 0u));
    }
    sums[lane] = sum;
    barrier();
    for (uint step = 1u; step < girih_lanes; step *= 2u) {
        uvec2 before = lane >= step ? sums[lane - step] : uvec2(0u);
        barrier();
        sums[lane] = add_wide(sums[lane], before);
        barrier();
    }
    // Offsets count where the frame fits 32 bits; else it is drawn at level 0.
    uint offset = lane > 0u ? sums[lane - 1u].x : 0u;
    for (uint block = begin; block < end; ++block) {
        uint count = GIRIH_AT_COUNTERS(block);
        GIRIH_AT_COUNTERS(block) = offset;
        offset += count;
    }
    if (lane == girih_lanes - 1u) {
        GIRIH_AT_STATUS(GIRIH_STATUS_WELD_VERTICES) = sums[lane].x;
        GIRIH_AT_STATUS(GIRIH_STATUS_WELD_VERTICES + 1u) = sums[lane].y;
    }
}

#else

void main() {
    uint block = girih_invocation();
    if (block >= girih_frame.scan_block_count) {
        return;
    }
    uint end = min((block + 1u) * GIRIH_SCAN_BLOCK, girih_frame.weld_edge_count);
    uint sum = GIRIH_AT_COUNTERS(block);
    for (uint n = block * GIRIH_SCAN_BLOCK; n < end; ++n) {
        GIRIH_AT_WELD_OFFSETS(n) = sum;
        sum += inner_vertices(n);
    }
}

#endif
#endif
