// From a sorted item to its patch: the corners permuted by lambda, the control points in world space.
#ifndef GIRIH_PATCH_GLSL
#define GIRIH_PATCH_GLSL

#include "girih_permutation.h"
#include "gather.glsl"
#include "part.glsl"

// One item as evaluate and output see it.
struct GirihItem {
    uint number;         // of the sorted items
    uint scene_triangle;
    uint instance;
    uint group;
    uint rank;
    bool mirrored;       // uses its pattern's mirrored range
    uint lambda;
    uint corners[3];     // input corner 0..2 at each of the base pattern's corners
    uint edges[3];       // input edge 0..2 at each of the base pattern's edges
    bool odd;            // the base pattern's edges run against the input's
    // A part's points are evaluated in its root, whose corners and edges stay in the input's order.
    bool is_part;
    GirihPart part;      // then, its corners in the base pattern's order
};

uint girih_group(uint group, uint field) {
    return GIRIH_AT_GROUPS(group * GIRIH_GROUP_WORDS + field);
}

// The words VERTICES to BASE_TRIANGLE of a group.
uvec4 girih_group_work(uint group) {
    return GIRIH_AT_GROUP_FOURS((group * GIRIH_GROUP_WORDS + GIRIH_GROUP_VERTICES) / 4u);
}

// `overflow`: the frame is drawn at level 0.
GirihItem girih_read_item(uint number, bool overflow) {
    GirihItem item;
    item.number = number;
    uvec2 words = GIRIH_AT_ITEMS(number);
    uint triangle = words[GIRIH_ITEM_TRIANGLE];
    uint key = words[GIRIH_ITEM_KEY];
    item.is_part = girih_has(GIRIH_VARIANT_SPLITS) && triangle >= girih_frame.triangle_count;
    // Where it is none, any record that is there.
    uint four = item.is_part ? (triangle - girih_frame.triangle_count) * (GIRIH_SPLIT_WORDS / 4u) : 0u;
#ifdef GIRIH_PARTS_APART
    // One branch for both would have a CPU device walk through both for every vertex.
    bool parts = girih_has(GIRIH_VARIANT_PARTS);
    triangle = item.is_part && !parts ? 0u : triangle;
    if (parts) {
#else
    if (item.is_part) {
#endif
        uvec4 about = GIRIH_AT_SPLIT_FOURS(four);
        triangle = about[GIRIH_SPLIT_ROOT];
        item.part = girih_unpack_part(GIRIH_AT_SPLIT_FOURS(four + 1u), GIRIH_AT_SPLIT_FOURS(four + 2u).xy);
        if (overflow) {
            item.part = girih_collapsed_part((about[GIRIH_SPLIT_LEVELS + 1] & GIRIH_SPLIT_FIRST) != 0u);
        }
    }
    item.instance = girih_find_instance(triangle, GIRIH_INSTANCE_FIRST_TRIANGLE, girih_frame.triangle_blocks);
    item.scene_triangle = triangle - girih_instance(item.instance, GIRIH_INSTANCE_TRIANGLE_DELTA);
    item.group = key >> 3;
    item.lambda = key & 7u;
    if (overflow) {
        // Drawn at level 0: base pattern [0,0,0], whose permutation only has to keep the winding.
        item.lambda = girih_instance_mirrored(item.instance) ? GIRIH_LAMBDA_ODD_IJ(0u) : 0u;
    }
    uint rank = girih_group(item.group, GIRIH_GROUP_RANK);
    item.rank = rank & ~GIRIH_GROUP_MIRRORED;
    item.mirrored = (rank & GIRIH_GROUP_MIRRORED) != 0u;
    if (item.is_part) {
        item.part = girih_permuted_part(item.part, GIRIH_LAMBDA_CORNERS(item.lambda));
    }
    uint placed = item.is_part ? 0u : item.lambda;
    uint corners = GIRIH_LAMBDA_CORNERS(placed);
    uint edges = GIRIH_LAMBDA_EDGES(placed);
    for (uint n = 0u; n < 3u; ++n) {
        item.corners[n] = corners >> (2u * n) & 3u;
        item.edges[n] = edges >> (2u * n) & 3u;
    }
    item.odd = GIRIH_LAMBDA_IS_ODD(placed) != 0u;
    return item;
}

// The weights, over GIRIH_SPLIT_ONE, of the item's corners where those of its base pattern weigh `weights`: of the
// triangle permuted by lambda, or of a part's root in the input's order.
uvec3 girih_item_weights(GirihItem item, uvec3 weights) {
    return item.is_part ? girih_part_weights(item.part, weights, uvec3(0u)) : weights * GIRIH_SPLIT_UNIT;
}

// The words PATTERN_TRIANGLE to INTERIOR of a group.
uvec4 girih_group_shape(uint group) {
    return GIRIH_AT_GROUP_FOURS((group * GIRIH_GROUP_WORDS + GIRIH_GROUP_PATTERN_TRIANGLE) / 4u);
}

// Of three words of a triangle the one that `which` of its corners or edges has.
uint girih_pick(uvec3 words, uint which) {
    return which == 0u ? words.x : which == 1u ? words.y : words.z;
}

void girih_item_vertices(GirihItem item, out uint vertices[3]) {
    uvec3 words;
    GIRIH_READ_THREE(GIRIH_AT_TRIANGLE_VERTICES, GIRIH_AT_TRIANGLE_VERTEX_PAIRS, 3u * item.scene_triangle, words)
    for (uint n = 0u; n < 3u; ++n) {
        vertices[n] = girih_pick(words, item.corners[n]);
    }
}

// The words of TRIANGLE_EDGES of the base pattern's edges, with their reversal relative to the pattern's.
uint[3] girih_item_edges(GirihItem item) {
    uint edges[3] = uint[3](0u, 0u, 0u);
#if GIRIH_CURVED == 1
    uvec3 words;
    GIRIH_READ_THREE(GIRIH_AT_TRIANGLE_EDGES, GIRIH_AT_TRIANGLE_EDGE_PAIRS, 3u * item.scene_triangle, words)
    words ^= item.odd ? GIRIH_EDGE_REVERSED : 0u;
    for (uint n = 0u; n < 3u; ++n) {
        edges[n] = girih_pick(words, item.edges[n]);
    }
#endif
    return edges;
}

GirihPatch girih_item_patch(GirihItem item, uint vertices[3]) {
    return girih_gather_patch(item.instance, vertices, girih_item_edges(item), false);
}

// Read before anything diverges, where a CPU device loads it once for all lanes.
bool girih_overflow() {
    return (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_OVERFLOW) != 0u;
}

// The item and the share of its work that an invocation of evaluate or output does. Invocation n has the
// first chunk of item first + n, with no search; what patterns of many vertices have beyond it is
// shared out among further invocations. False: nothing to do; item and chunk are there nevertheless.
bool girih_work(uint invocation, uint first, out uint item, out uint chunk) {
    uint items = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    uint chunks = GIRIH_AT_STATUS(GIRIH_STATUS_CHUNKS);
    uint group_count = girih_frame.group_count;
    invocation += first;
    item = min(invocation, items - 1u);
    chunk = 0u;
    uint further = invocation - items;
    if (invocation >= items && further < chunks) {
        uint low = 0u;
        uint high = group_count;
        while (high - low > 1u) {
            uint middle = (low + high) / 2u;
            if (girih_group(middle, GIRIH_GROUP_FIRST_CHUNK) <= further) {
                low = middle;
            } else {
                high = middle;
            }
        }
        uint each = girih_pattern(girih_group(low, GIRIH_GROUP_RANK) & ~GIRIH_GROUP_MIRRORED, GIRIH_PATTERN_CHUNKS) - 1u;
        uint rest = further - girih_group(low, GIRIH_GROUP_FIRST_CHUNK);
        item = girih_group(low, GIRIH_GROUP_FIRST) + girih_quotient(rest, each);
        chunk = 1u + rest;
    }
    return invocation < items || further < chunks;
}

// The number of this invocation, runs of workgroups dealt out in turn to eight parts of the dispatch: items
// are sorted by pattern, and a device that gives each core one contiguous part would leave the core with
// the small patterns idle. Within a run neighbours, which share vertices, stay together. No divisions: a
// CPU device does them lane by lane.
uint girih_interleaved_invocation() {
    uint count = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    int shift = count < 2048u ? 0 : 5;
    uint whole = count >> 3 >> shift << shift; // workgroups of a part
    if (group < whole << 3) {
        uint part = 0u;
        for (uint n = 1u; n < 8u; ++n) {
            part += group >= n * whole ? 1u : 0u;
        }
        uint place = group - part * whole;
        group = (((place >> shift << 3) + part) << shift) + (place & ((1u << shift) - 1u));
    }
    return group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

// Where a base pattern's vertices go when points are shared (GIRIH_OUTPUT_WELDED): vertex n of the corners to
// itself, of an edge's inner ones to base + (n ^ flip), where flip counts backwards, of the interior to
// base + n. No array and no loop: a CPU device would walk all of their turns for every vertex.
struct GirihWeld {
    uvec3 corners;
    uvec3 edges;
    uvec3 flips;
    uint interior;
    uvec3 ends;          // pattern vertices before the inner ones of edges 2 and 3 and the interior ones
};

// `closed`: by position alone, through the vertex and weld edge that stand for all at one place.
GirihWeld girih_item_weld(GirihItem item, uint vertices[3], uvec4 work, uvec4 shape, bool closed) {
    GirihWeld weld;
    uint vertex_delta = girih_instance(item.instance, GIRIH_INSTANCE_VERTEX_DELTA);
    uint weld_delta = girih_instance(item.instance, GIRIH_INSTANCE_WELD_DELTA);
    uint ends = shape[GIRIH_GROUP_EDGE_ENDS - GIRIH_GROUP_PATTERN_TRIANGLE];
    uint interior = shape[GIRIH_GROUP_INTERIOR - GIRIH_GROUP_PATTERN_TRIANGLE];
    weld.ends = uvec3(ends & 0xffffu, ends >> 16, interior);
    uvec3 begins = uvec3(3u, weld.ends.xy);
    uvec3 words;
    GIRIH_READ_THREE(GIRIH_AT_TRIANGLE_WELD_EDGES, GIRIH_AT_TRIANGLE_WELD_EDGE_PAIRS, 3u * item.scene_triangle, words)
    for (uint n = 0u; n < 3u; ++n) {
        uint word = girih_pick(words, item.edges[n]);
        uint edge = word & GIRIH_WELD_MASK;
        uint vertex = vertices[n];
        if (closed) {
            edge = GIRIH_AT_EDGE_WELD_EDGES(GIRIH_AT_WELD_EDGE_EDGES(edge));
            vertex = GIRIH_AT_WELD_POINTS(vertex);
        }
        uint first = girih_frame.corner_count + GIRIH_AT_WELD_OFFSETS(edge + weld_delta);
        bool reversed = ((word & GIRIH_WELD_REVERSED) != 0u) != item.odd;
        weld.corners[n] = vertex + vertex_delta;
        weld.edges[n] = reversed ? first + weld.ends[n] : first - begins[n];
        weld.flips[n] = reversed ? 0xffffffffu : 0u;
    }
    uint count = work[0] - interior;
    weld.interior = work[GIRIH_GROUP_BASE_VERTEX - GIRIH_GROUP_VERTICES] + item.number * count - interior;
    return weld;
}

// The output vertex of the base pattern's vertex n: corners, inner vertices of edges 1, 2, 3, interior.
uint girih_weld_vertex(GirihWeld weld, uint n) {
    uint corner = girih_pick(weld.corners, n);
    uint vertex = weld.interior + n;
    vertex = n < weld.ends.z ? weld.edges.z + (n ^ weld.flips.z) : vertex;
    vertex = n < weld.ends.y ? weld.edges.y + (n ^ weld.flips.y) : vertex;
    vertex = n < weld.ends.x ? weld.edges.x + (n ^ weld.flips.x) : vertex;
    return n < 3u ? corner : vertex;
}

#endif
