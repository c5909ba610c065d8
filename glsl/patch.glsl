// From a sorted item to its patch: the corners permuted by lambda, the control points in world space.
#ifndef GIRIH_PATCH_GLSL
#define GIRIH_PATCH_GLSL

#include "girih_permutation.h"
#include "gather.glsl"

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
    uint corners = GIRIH_LAMBDA_CORNERS(item.lambda);
    uint edges = GIRIH_LAMBDA_EDGES(item.lambda);
    for (uint n = 0u; n < 3u; ++n) {
        item.corners[n] = corners >> (2u * n) & 3u;
        item.edges[n] = edges >> (2u * n) & 3u;
    }
    item.odd = GIRIH_LAMBDA_IS_ODD(item.lambda) != 0u;
    return item;
}

void girih_item_vertices(GirihItem item, out uint vertices[3]) {
    for (uint n = 0u; n < 3u; ++n) {
        vertices[n] = GIRIH_AT_TRIANGLE_VERTICES(3u * item.scene_triangle + item.corners[n]);
    }
}

// The word of TRIANGLE_EDGES of the base pattern's edge `edge`, with its reversal relative to the pattern's.
uint girih_item_edge(GirihItem item, uint edge) {
#if GIRIH_CURVED == 1
    uint word = GIRIH_AT_TRIANGLE_EDGES(3u * item.scene_triangle + item.edges[edge]);
    return item.odd ? word ^ GIRIH_EDGE_REVERSED : word;
#else
    return 0u;
#endif
}

uint[3] girih_item_edges(GirihItem item) {
    return uint[3](girih_item_edge(item, 0u), girih_item_edge(item, 1u), girih_item_edge(item, 2u));
}

GirihPatch girih_item_patch(GirihItem item, uint vertices[3]) {
    return girih_gather_patch(item.instance, vertices, girih_item_edges(item), false);
}

// Read before anything diverges, where a CPU device loads it once for all lanes.
bool girih_overflow() {
    return (GIRIH_AT_STATUS(GIRIH_STATUS_FLAGS) & GIRIH_STATUS_OVERFLOW) != 0u;
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

// The item and the share of its work that an invocation of evaluate or output does. Invocation n < items
// has the first chunk of item n, with no search; what patterns of many vertices have beyond it is
// shared out among further invocations. False: nothing to do; item and chunk are there nevertheless.
bool girih_work(uint invocation, out uint item, out uint chunk) {
    uint items = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    uint chunks = GIRIH_AT_STATUS(GIRIH_STATUS_CHUNKS);
    uint group_count = girih_frame.group_count;
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

// Where a base pattern's vertices go when points are shared (GIRIH_OUTPUT_WELDED).
struct GirihWeld {
    uint corners[3];     // output vertex of each corner
    uint edges[3];       // output vertex of the first inner vertex of each edge, in canonical order
    bool reversed[3];    // the pattern runs along the edge against the canonical order
    uint segments[3];
    uint interior;       // output vertex of the first interior vertex
};

// `closed`: by position alone, through the vertex and weld edge that stand for all at one place.
GirihWeld girih_item_weld(GirihItem item, uint vertices[3], bool closed) {
    GirihWeld weld;
    uint vertex_delta = girih_instance(item.instance, GIRIH_INSTANCE_VERTEX_DELTA);
    uint weld_delta = girih_instance(item.instance, GIRIH_INSTANCE_WELD_DELTA);
    uint border = 0u;
    for (uint n = 0u; n < 3u; ++n) {
        uint word = GIRIH_AT_TRIANGLE_WELD_EDGES(3u * item.scene_triangle + item.edges[n]);
        uint edge = word & GIRIH_WELD_MASK;
        uint vertex = vertices[n];
        if (closed) {
            edge = GIRIH_AT_EDGE_WELD_EDGES(GIRIH_AT_WELD_EDGE_EDGES(edge));
            vertex = GIRIH_AT_WELD_POINTS(vertex);
        }
        weld.corners[n] = vertex + vertex_delta;
        weld.edges[n] = girih_frame.corner_count + GIRIH_AT_WELD_OFFSETS(edge + weld_delta);
        weld.reversed[n] = ((word & GIRIH_WELD_REVERSED) != 0u) != item.odd;
        weld.segments[n] = girih_pattern(item.rank, GIRIH_PATTERN_SEGMENTS + n);
        border += weld.segments[n];
    }
    uint interior = girih_group(item.group, GIRIH_GROUP_VERTICES) - border;
    weld.interior = girih_group(item.group, GIRIH_GROUP_BASE_VERTEX) + item.number * interior;
    return weld;
}

// The output vertex of the base pattern's vertex n: corners, inner vertices of edges 1, 2, 3, interior.
uint girih_weld_vertex(GirihWeld weld, uint n) {
    if (n < 3u) {
        return weld.corners[n];
    }
    n -= 3u;
    for (uint edge = 0u; edge < 3u; ++edge) {
        uint inner = weld.segments[edge] - 1u;
        if (n < inner) {
            return weld.edges[edge] + (weld.reversed[edge] ? inner - 1u - n : n);
        }
        n -= inner;
    }
    return weld.interior + n;
}

#endif
