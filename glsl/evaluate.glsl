// Stage 5: patches for the instanced mode (GIRIH_KERNEL 0), or the surface's points in buffers for the
// baked and welded modes (1). Welded, each point is evaluated once: those inside triangles by kernel 1,
// corners by kernel 2, those inside edges by kernel 3. With a host's surface (GIRIH_SURFACE 2) the vertex
// shader gathers its patches itself, the instanced mode's records only name triangles, and kernel 1
// evaluates shared points with every triangle that has them.
#ifndef GIRIH_EVALUATE_GLSL
#define GIRIH_EVALUATE_GLSL

#if GIRIH_SURFACE != 2 && GIRIH_KERNEL == 1
#define GIRIH_PARTS_APART
#endif
#include "patch.glsl"
#if GIRIH_SURFACE == 2 && GIRIH_KERNEL == 1
#include "own.glsl"
#endif

#if GIRIH_KERNEL == 0

#if GIRIH_SURFACE == 1
#define GIRIH_PATCH_WORDS GIRIH_PATCH_WORDS_PN
#elif GIRIH_SURFACE == 2
#define GIRIH_PATCH_WORDS GIRIH_PATCH_WORDS_OWN
#else
#define GIRIH_PATCH_WORDS GIRIH_PATCH_WORDS_FLAT
#endif

// Patches are whole fours of words, and every store costs a CPU device.
void girih_write_four(uint four, uvec4 words) {
    GIRIH_AT_OUT_PATCH_FOURS(four) = words;
}

void girih_write_vectors(uint four, vec3 a, vec3 b, vec3 c, vec3 d) {
    girih_write_four(four, floatBitsToUint(vec4(a, b.x)));
    girih_write_four(four + 1u, floatBitsToUint(vec4(b.yz, c.xy)));
    girih_write_four(four + 2u, floatBitsToUint(vec4(c.z, d)));
}

void main() {
    bool overflow = girih_overflow();
    uint items = GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS);
    uint range_count = girih_frame.range_count;
    uint window_first = girih_push.window_first;
    uint window_count = girih_push.window_count;
    uint invocation = girih_interleaved_invocation();
    uint number = min(invocation, items - 1u);
    GirihItem item = girih_read_item(number, overflow);
    uint beyond = overflow ? item.group : 0u;
    girih_quotient(beyond, range_count);
    uint key = (item.group - beyond) << 3 | item.lambda;
    uint fours = uint(GIRIH_PATCH_WORDS + (girih_has(GIRIH_VARIANT_SPLITS) ? GIRIH_PATCH_WORDS_PART : 0)) / 4u;
    uint four = (number - window_first) * fours;
#if GIRIH_SURFACE != 2
    uint vertices[3];
    girih_item_vertices(item, vertices);
    GirihPatch p = girih_item_patch(item, vertices);
#endif
    // The patches' own window, where they are more than one storage buffer can hold.
    if (invocation < items && number - window_first < window_count) {
#if GIRIH_SURFACE == 2
        girih_write_four(four, uvec4(item.scene_triangle, item.instance, key, item.rank));
#elif GIRIH_SURFACE == 1
        girih_write_vectors(four, p.b300, p.b030, p.b003, p.b210);
        girih_write_vectors(four + 3u, p.b120, p.b021, p.b012, p.b102);
        girih_write_vectors(four + 6u, p.b201, p.b111, p.n200, p.n020);
        girih_write_vectors(four + 9u, p.n002, p.n110, p.n011, p.n101);
        girih_write_four(four + 12u, uvec4(vertices[0], vertices[1], vertices[2], key));
#else
        girih_write_vectors(four, p.b300, p.b030, p.b003, p.n200);
        girih_write_four(four + 3u, floatBitsToUint(vec4(p.n020, p.n002.x)));
        girih_write_four(four + 4u, uvec4(floatBitsToUint(p.n002.yz), vertices[0], vertices[1]));
        girih_write_four(four + 5u, uvec4(vertices[2], key, 0u, 0u));
#endif
        if (girih_has(GIRIH_VARIANT_SPLITS)) {
            // 0: not a part.
            uvec4 corners = uvec4(0u);
            uvec2 last_corner = uvec2(0u);
            if (item.is_part) {
                girih_pack_part(item.part, corners, last_corner);
            }
            girih_write_four(four + fours - 2u, corners);
            girih_write_four(four + fours - 1u, uvec4(last_corner, 0u, 0u));
        }
    }
}

#else

// What is the same for all invocations. Read where all of them still go the same way (girih_begin), where a
// CPU device reads it once and not lane by lane.
uint girih_window_first;
uint girih_window_count;
uint girih_stride;

void girih_begin() {
    girih_window_first = girih_push.window_first;
    girih_window_count = girih_push.window_count;
    girih_stride = girih_frame.attribute_stride;
}

bool girih_in_window(uint vertex) {
    return vertex - girih_window_first < girih_window_count;
}

void girih_write_position(uint vertex, vec3 position) {
    uvec3 words = floatBitsToUint(position);
    GIRIH_WRITE_THREE(GIRIH_AT_OUT_POSITIONS, GIRIH_AT_OUT_POSITION_PAIRS, (vertex - girih_window_first) * 3u, words)
}

// `first`: a word of the vertex's record.
void girih_write_attribute_vector(uint vertex, uint first, vec3 v) {
    uvec3 words = floatBitsToUint(v);
    GIRIH_WRITE_THREE(GIRIH_AT_OUT_ATTRIBUTES, GIRIH_AT_OUT_ATTRIBUTE_PAIRS,
                      (vertex - girih_window_first) * girih_stride + first, words)
}

// Linear interpolation, each side of a seam with its own: `vertices` and weights in the same order.
void girih_write_attributes(uint vertex, uint vertices[3], vec3 b) {
    if (!girih_has(GIRIH_VARIANT_ATTRIBUTES)) {
        return;
    }
    for (uint a = 0u; a < girih_frame.attribute_floats; ++a) {
        float value = girih_scene_attribute(vertices, a, b);
        GIRIH_AT_OUT_ATTRIBUTES((vertex - girih_window_first) * girih_stride + 3u + a) =
            floatBitsToUint(girih_no_negative_zero(value));
    }
}

// The barycentrics of a pattern's vertex, over 32768.
uvec3 girih_pattern_weights(uint n) {
    uint packed = GIRIH_AT_PATTERN_VERTICES(n);
    uint u = packed & 0xffffu;
    uint v = packed >> 16;
    return uvec3(u, v, 32768u - u - v);
}

#if GIRIH_SURFACE != 2

// One vertex of a triangle with the corners `vertices`.
void girih_write_point(uint vertex, uint vertices[3], vec3 barycentric, vec3 position, vec3 normal) {
    girih_write_position(vertex, position);
    girih_write_attribute_vector(vertex, 0u, normal);
    girih_write_attributes(vertex, vertices, barycentric);
}

#if GIRIH_KERNEL == 1

// There is no way out before the end, and what can be is done outside of all branches: a CPU device walks
// through them anyway, and reads what is the same for all lanes only once where all of them are there.
void main() {
    bool overflow = girih_overflow();
    girih_begin();
    // Where many triangles are culled, their corners and edges are better not evaluated at all.
    bool by_items = girih_has(GIRIH_VARIANT_WELDED) && girih_has(GIRIH_VARIANT_CULL);
    bool interior = girih_has(GIRIH_VARIANT_WELDED) && !by_items;
    uint number;
    uint chunk;
    bool parts = girih_has(GIRIH_VARIANT_PARTS);
    bool there;
    if (parts) {
        // Invocation n has the first chunk of part n; further chunks, of parts and others, follow.
        uint part = girih_invocation();
        uint splits = GIRIH_AT_STATUS(GIRIH_STATUS_SPLITS);
        bool first_chunk = part < splits;
        there = girih_work(part - splits + GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS), 0u, number, chunk) && !first_chunk;
        if (first_chunk) {
            uint item = GIRIH_AT_SPLIT_FOURS(part * (GIRIH_SPLIT_WORDS / 4u))[GIRIH_SPLIT_ITEM];
            there = item != 0u;
            number = max(item, 1u) - 1u;
            chunk = 0u;
        }
    } else {
        there = girih_work(girih_interleaved_invocation(),
                           interior ? GIRIH_AT_STATUS(GIRIH_STATUS_FIRST_INTERIOR) : 0u, number, chunk);
    }
    GirihItem item = girih_read_item(number, overflow);
    there = there && item.is_part == parts;
    uvec4 work = girih_group_work(item.group);
    uint count = work[0];
    uint pattern_vertex = work[GIRIH_GROUP_PATTERN_VERTEX - GIRIH_GROUP_VERTICES];
    // Pattern vertices that other kernels evaluate.
    uint border = interior ? girih_group(item.group, GIRIH_GROUP_INTERIOR) : 0u;
    uint first = work[GIRIH_GROUP_BASE_VERTEX - GIRIH_GROUP_VERTICES] + number * (count - border) - border;
    uint begin = chunk * GIRIH_CHUNK_VERTICES;
    uint end = there ? min(begin + GIRIH_CHUNK_VERTICES, count) : 0u;
    uint vertices[3];
    girih_item_vertices(item, vertices);
    GirihWeld weld;
    if (by_items) {
        weld = girih_item_weld(item, vertices, work, girih_group_shape(item.group), false);
    }
    GirihPatch p = girih_item_patch(item, vertices);
    if (!interior && !parts) {
        // The corners need no formula.
        vec3 corners[3] = vec3[3](p.b300, p.b030, p.b003);
        vec3 normals[3] = vec3[3](p.n200, p.n020, p.n002);
        for (uint n = 0u; n < 3u; ++n) {
            uint vertex = by_items ? weld.corners[n] : first + n;
            if (begin == 0u && end != 0u && girih_in_window(vertex)) {
                girih_write_point(vertex, vertices, vec3(n == 0u, n == 1u, n == 2u),
                                  girih_no_negative_zero(corners[n]),
                                  girih_no_negative_zero(girih_normalize(normals[n])));
            }
        }
    }
    uint n = max(begin, parts ? border : max(border, 3u));
    do {
        uint vertex = by_items ? girih_weld_vertex(weld, n) : first + n;
        if (n < end && girih_in_window(vertex)) {
            uvec3 weights = girih_pattern_weights(pattern_vertex + n);
            vec3 b = parts ? girih_root_barycentric(girih_item_weights(item, weights)) : girih_barycentric(weights);
            girih_write_point(vertex, vertices, b, girih_patch_position(p, b.x, b.y, b.z),
                              girih_patch_unit_normal(p, b.x, b.y, b.z));
        }
        ++n;
    } while (n < end);
}

#elif GIRIH_KERNEL == 2

// One invocation a corner: the surface goes through it.
void main() {
    girih_begin();
    uint count = girih_frame.corner_count;
    uint invocation = girih_invocation();
    uint vertex = min(invocation, count - 1u);
    uint instance = girih_find_instance(vertex, GIRIH_INSTANCE_FIRST_CORNER, girih_frame.corner_blocks);
    uint scene_vertex = vertex - girih_instance(instance, GIRIH_INSTANCE_VERTEX_DELTA);
    GirihTransform t = girih_instance_transform(instance, 0u);
    GirihTransform nt = girih_instance_normal_transform(instance, 0u);
    vec3 position;
    vec3 normal;
    girih_vertex(scene_vertex, 0u, position, normal);
    if (invocation < count && girih_in_window(vertex)) {
        uint vertices[3] = uint[3](scene_vertex, scene_vertex, scene_vertex);
        girih_write_point(vertex, vertices, vec3(1.0, 0.0, 0.0),
                          girih_no_negative_zero(girih_transform_point(t, position)),
                          girih_no_negative_zero(girih_normalize(girih_transform_point(nt, normal))));
    }
}

#else

// One invocation a weld edge, from its first to its second end in canonical order. What a patch is on an
// edge depends on the edge alone: the other corner's terms vanish, and those that remain are grouped alike.
void main() {
    bool overflow = girih_overflow();
    girih_begin();
    uint corner_count = girih_frame.corner_count;
    uint count = girih_frame.weld_edge_count;
    uint linear_spacing = girih_frame.linear_spacing;
    uint invocation = girih_invocation();
    uint number = min(invocation, count - 1u);
    uint instance = girih_find_instance(number, GIRIH_INSTANCE_FIRST_WELD_EDGE, girih_frame.weld_blocks);
    uint scene_weld_edge = number - girih_instance(instance, GIRIH_INSTANCE_WELD_DELTA);
    uvec2 record = GIRIH_AT_WELD_EDGES(scene_weld_edge);
    uint level = GIRIH_AT_LEVELS(record.x + girih_instance(instance, GIRIH_INSTANCE_EDGE_DELTA));
    uint inner = linear_spacing != 0u ? level : (1u << level) - 1u;
    uint end = overflow || invocation >= count ? 0u : inner;
    // The pattern [level,0,0] has the same vertices on its first edge as all patterns on such an edge.
    uint rank = level * (level + 1u) * (level + 2u) / 6u;
    uint pattern_vertex = girih_pattern(rank, GIRIH_PATTERN_FIRST_VERTEX) + 3u;
    uint first = corner_count + GIRIH_AT_WELD_OFFSETS(number);
    uint owner = record.y;
    uint next = owner % 3u == 2u ? owner - 2u : owner + 1u;
    uint word = GIRIH_AT_TRIANGLE_EDGES(owner);
    bool reversed = (word & GIRIH_EDGE_REVERSED) != 0u;
    uint a = GIRIH_AT_TRIANGLE_VERTICES(reversed ? next : owner);
    uint b = GIRIH_AT_TRIANGLE_VERTICES(reversed ? owner : next);
    uint vertices[3] = uint[3](a, b, a);
    GirihCurve curve = girih_gather_curve(instance, a, b, word & ~GIRIH_EDGE_REVERSED);
    uint n = 0u;
    do {
        if (n < end && girih_in_window(first + n)) {
            vec3 weights = girih_barycentric(girih_pattern_weights(pattern_vertex + n));
            girih_write_point(first + n, vertices, weights, girih_curve_position(curve, weights.x, weights.y),
                              girih_curve_unit_normal(curve, weights.x, weights.y));
        }
        ++n;
    } while (n < end);
}

#endif

#else

void main() {
    bool overflow = girih_overflow();
    girih_begin();
    uint number;
    uint chunk;
    if (!girih_work(girih_interleaved_invocation(), 0u, number, chunk)) {
        return;
    }
    GirihItem item = girih_read_item(number, overflow);
    uvec4 work = girih_group_work(item.group);
    uint count = work[0];
    uint begin = chunk * GIRIH_CHUNK_VERTICES;
    uint end = min(begin + GIRIH_CHUNK_VERTICES, count);
    uint first = work[GIRIH_GROUP_BASE_VERTEX - GIRIH_GROUP_VERTICES] + number * count;
    bool welded = girih_has(GIRIH_VARIANT_WELDED);
    if (!welded && (first + end <= girih_window_first ||
                    first + begin >= girih_window_first + girih_window_count)) {
        return;
    }
    uint vertices[3];
    girih_item_vertices(item, vertices);
    GirihWeld weld;
    if (welded) {
        weld = girih_item_weld(item, vertices, work, girih_group_shape(item.group), false);
    }
    uint pattern_vertex = work[GIRIH_GROUP_PATTERN_VERTEX - GIRIH_GROUP_VERTICES];
    GirihPatch patch_ = girih_own_patch(item.scene_triangle, item.instance, false);
    // Loops that ask at their end: asking first, a CPU device would walk through them once more in vain. Only
    // what a branch with loads has set is used after them: lavapipe lets go of other values when a lane leaves.
    uint next = begin;
    do {
        uint n = next++;
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!girih_in_window(vertex)) {
            continue;
        }
        uvec3 weights = girih_item_weights(item, girih_pattern_weights(pattern_vertex + n));
        girih_write_attributes(vertex, vertices, girih_root_barycentric(weights));
        uvec3 input_weights = item.is_part ? weights : girih_input_weights(item.lambda, weights);
        GirihPlaces places = girih_find_places(item.scene_triangle, input_weights);
        // The point, the normal where it is another's, the previous point: all from one place in the code,
        // so that the compiler cannot treat two sides of an edge differently.
        uint turns = girih_has(GIRIH_VARIANT_PREVIOUS) ? 3u : places.smooth_ ? 1u : 2u;
        uint turn = 0u;
        do {
            GirihPlace place = places.position;
            if (turn == 1u) {
                place = places.normal;
            }
            if (place.triangle != patch_.triangle || patch_.previous != (turn == 2u)) {
                patch_ = girih_own_patch(place.triangle, item.instance, turn == 2u);
            }
            vec3 position;
            vec3 normal;
            girih_own_sample(patch_, girih_root_barycentric(place.weights), position, normal);
            if (turn == 0u) {
                girih_write_position(vertex, position);
            }
            if (turn == 2u) {
                girih_write_attribute_vector(vertex, 3u + girih_frame.attribute_floats, position);
            } else if (turn == 1u || turns != 2u) {
                girih_write_attribute_vector(vertex, 0u, normal);
            }
        } while (++turn < turns);
    } while (next < end);
}

#endif

#endif
#endif
