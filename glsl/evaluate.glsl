// Stage 5: patches for the instanced mode (GIRIH_KERNEL 0), or the surface's points in buffers for the
// baked and welded modes (1). With a host's surface (GIRIH_SURFACE 2) the vertex shader gathers its
// patches itself, and the instanced mode's records only name triangles.
#ifndef GIRIH_EVALUATE_GLSL
#define GIRIH_EVALUATE_GLSL

#include "patch.glsl"
#if GIRIH_SURFACE == 2 && GIRIH_KERNEL == 1
#include "own.glsl"
#endif


#if GIRIH_KERNEL == 0

void write_vector(uint word, vec3 v) {
    OUT_ATTRIBUTES(word) = floatBitsToUint(v.x);
    OUT_ATTRIBUTES(word + 1u) = floatBitsToUint(v.y);
    OUT_ATTRIBUTES(word + 2u) = floatBitsToUint(v.z);
}

void main() {
    bool overflow = girih_overflow();
    uint number = girih_interleaved_invocation();
    // The patches' own window, where they are more than one storage buffer can hold.
    if (number < push.window_first || number - push.window_first >= push.window_count ||
        number >= STATUS(GIRIH_STATUS_ITEMS)) {
        return;
    }
    GirihItem item = girih_read_item(number, overflow);
    uint group = overflow ? item.group - item.group % frame.range_count : item.group;
    uint key = group << 3 | item.lambda;
#if GIRIH_SURFACE == 2
    uint word = (number - push.window_first) * GIRIH_PATCH_WORDS_OWN;
    OUT_ATTRIBUTES(word) = item.scene_triangle;
    OUT_ATTRIBUTES(word + 1u) = item.instance;
    OUT_ATTRIBUTES(word + 2u) = key;
    OUT_ATTRIBUTES(word + 3u) = item.rank;
#else
    uint vertices[3];
    girih_item_vertices(item, vertices);
    GirihPatch p = girih_item_patch(item, vertices);
#if GIRIH_SURFACE == 1
    uint word = (number - push.window_first) * GIRIH_PATCH_WORDS_PN;
    write_vector(word, p.b300);
    write_vector(word + 3u, p.b030);
    write_vector(word + 6u, p.b003);
    write_vector(word + 9u, p.b210);
    write_vector(word + 12u, p.b120);
    write_vector(word + 15u, p.b021);
    write_vector(word + 18u, p.b012);
    write_vector(word + 21u, p.b102);
    write_vector(word + 24u, p.b201);
    write_vector(word + 27u, p.b111);
    write_vector(word + 30u, p.n200);
    write_vector(word + 33u, p.n020);
    write_vector(word + 36u, p.n002);
    write_vector(word + 39u, p.n110);
    write_vector(word + 42u, p.n011);
    write_vector(word + 45u, p.n101);
    word += 48u;
#else
    uint word = (number - push.window_first) * GIRIH_PATCH_WORDS_FLAT;
    write_vector(word, p.b300);
    write_vector(word + 3u, p.b030);
    write_vector(word + 6u, p.b003);
    write_vector(word + 9u, p.n200);
    write_vector(word + 12u, p.n020);
    write_vector(word + 15u, p.n002);
    word += 18u;
#endif
    OUT_ATTRIBUTES(word) = vertices[0];
    OUT_ATTRIBUTES(word + 1u) = vertices[1];
    OUT_ATTRIBUTES(word + 2u) = vertices[2];
    OUT_ATTRIBUTES(word + 3u) = key;
#endif
}

#else

bool in_window(uint vertex) {
    return vertex - push.window_first < push.window_count;
}

void write_position(uint vertex, vec3 position) {
    uint word = (vertex - push.window_first) * 3u;
    OUT_POSITIONS(word) = floatBitsToUint(position.x);
    OUT_POSITIONS(word + 1u) = floatBitsToUint(position.y);
    OUT_POSITIONS(word + 2u) = floatBitsToUint(position.z);
}

// `first`: a word of the vertex's record.
void write_attribute_vector(uint vertex, uint first, vec3 v) {
    uint word = (vertex - push.window_first) * frame.attribute_stride + first;
    OUT_ATTRIBUTES(word) = floatBitsToUint(v.x);
    OUT_ATTRIBUTES(word + 1u) = floatBitsToUint(v.y);
    OUT_ATTRIBUTES(word + 2u) = floatBitsToUint(v.z);
}

// Linear interpolation, each side of a seam with its own: `vertices` and weights in the same order.
void write_attributes(uint vertex, uint vertices[3], vec3 b) {
    if (!girih_has(GIRIH_VARIANT_ATTRIBUTES)) {
        return;
    }
    for (uint a = 0u; a < frame.attribute_floats; ++a) {
        float value = girih_patch_attribute(uintBitsToFloat(ATTRIBUTES(vertices[0] * frame.attribute_floats + a)),
                                            uintBitsToFloat(ATTRIBUTES(vertices[1] * frame.attribute_floats + a)),
                                            uintBitsToFloat(ATTRIBUTES(vertices[2] * frame.attribute_floats + a)), b.x,
                                            b.y, b.z);
        OUT_ATTRIBUTES((vertex - push.window_first) * frame.attribute_stride + 3u + a) =
            floatBitsToUint(girih_no_negative_zero(value));
    }
}

#if GIRIH_SURFACE == 2
void write_previous(uint vertex, GirihPatch before, vec3 b) {
    if (girih_has(GIRIH_VARIANT_PREVIOUS)) {
        write_attribute_vector(vertex, 3u + frame.attribute_floats, girih_own_position(before, b));
    }
}
#endif

// The barycentrics of a pattern's vertex, over 32768.
uvec3 pattern_weights(uint n) {
    uint packed = PATTERN_VERTICES(n);
    uint u = packed & 0xffffu;
    uint v = packed >> 16;
    return uvec3(u, v, 32768u - u - v);
}

void main() {
    bool overflow = girih_overflow();
    uint number;
    uint chunk;
    if (!girih_work(girih_interleaved_invocation(), number, chunk)) {
        return;
    }
    GirihItem item = girih_read_item(number, overflow);
    uvec4 work = girih_group_work(item.group);
    uint count = work[0];
    uint begin = chunk * GIRIH_CHUNK_VERTICES;
    uint end = min(begin + GIRIH_CHUNK_VERTICES, count);
    uint first = work[GIRIH_GROUP_BASE_VERTEX - GIRIH_GROUP_VERTICES] + number * count;
    bool welded = girih_has(GIRIH_VARIANT_WELDED);
    if (!welded && (first + end <= push.window_first || first + begin >= push.window_first + push.window_count)) {
        return;
    }
    uint vertices[3];
    girih_item_vertices(item, vertices);
    GirihWeld weld;
    if (welded) {
        weld = girih_item_weld(item, vertices, false);
    }
    uint pattern_vertex = work[GIRIH_GROUP_PATTERN_VERTEX - GIRIH_GROUP_VERTICES];
#if GIRIH_SURFACE == 2
    // Vertices on the border come first. They are evaluated by whoever owns them, all at one place in the
    // code, so that the compiler cannot treat two sides of an edge differently.
    uint border = girih_pattern(item.rank, GIRIH_PATTERN_SEGMENTS) +
                  girih_pattern(item.rank, GIRIH_PATTERN_SEGMENTS + 1u) +
                  girih_pattern(item.rank, GIRIH_PATTERN_SEGMENTS + 2u);
    uint inner = clamp(border, begin, end);
    GirihPatch own = girih_own_patch(item.scene_triangle, item.instance, false);
    GirihPatch own_before = own;
    if (girih_has(GIRIH_VARIANT_PREVIOUS)) {
        own_before = girih_own_patch(item.scene_triangle, item.instance, true);
    }
    GirihPatch owner = own;
    GirihPatch owner_before = own_before;
    for (uint n = begin; n < inner; ++n) {
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!in_window(vertex)) {
            continue;
        }
        uvec3 weights = pattern_weights(pattern_vertex + n);
        write_attributes(vertex, vertices, girih_barycentric(weights));
        GirihPlaces places = girih_find_places(item.scene_triangle, girih_input_weights(item.lambda, weights));
        if (places.position.triangle != owner.triangle) {
            owner = girih_own_patch(places.position.triangle, item.instance, false);
            if (girih_has(GIRIH_VARIANT_PREVIOUS)) {
                owner_before = girih_own_patch(places.position.triangle, item.instance, true);
            }
        }
        vec3 b = girih_barycentric(places.position.weights);
        write_position(vertex, girih_own_position(owner, b));
        write_previous(vertex, owner_before, b);
        vec3 normal = girih_own_normal(owner, b);
        // Without seams there is no hard edge.
        if (girih_has(GIRIH_VARIANT_SEAMS) && !places.smooth_) {
            normal = girih_own_normal(girih_own_patch(places.normal.triangle, item.instance, false),
                                      girih_barycentric(places.normal.weights));
        }
        write_attribute_vector(vertex, 0u, normal);
    }
    for (uint n = inner; n < end; ++n) {
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!in_window(vertex)) {
            continue;
        }
        uvec3 weights = pattern_weights(pattern_vertex + n);
        write_attributes(vertex, vertices, girih_barycentric(weights));
        vec3 b = girih_barycentric(girih_input_weights(item.lambda, weights));
        write_position(vertex, girih_own_position(own, b));
        write_previous(vertex, own_before, b);
        write_attribute_vector(vertex, 0u, girih_own_normal(own, b));
    }
#else
    GirihPatch p = girih_item_patch(item, vertices);
    for (uint n = begin; n < end; ++n) {
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!in_window(vertex)) {
            continue;
        }
        vec3 b = girih_barycentric(pattern_weights(pattern_vertex + n));
        write_position(vertex, girih_patch_position(p, b.x, b.y, b.z));
        write_attribute_vector(vertex, 0u, girih_patch_unit_normal(p, b.x, b.y, b.z));
        write_attributes(vertex, vertices, b);
    }
#endif
}

#endif
#endif
