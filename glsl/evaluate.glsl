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

#if GIRIH_SURFACE == 1
#define GIRIH_PATCH_WORDS GIRIH_PATCH_WORDS_PN
#elif GIRIH_SURFACE == 2
#define GIRIH_PATCH_WORDS GIRIH_PATCH_WORDS_OWN
#else
#define GIRIH_PATCH_WORDS GIRIH_PATCH_WORDS_FLAT
#endif

void girih_write_vector(uint word, vec3 v) {
    GIRIH_AT_OUT_ATTRIBUTES(word) = floatBitsToUint(v.x);
    GIRIH_AT_OUT_ATTRIBUTES(word + 1u) = floatBitsToUint(v.y);
    GIRIH_AT_OUT_ATTRIBUTES(word + 2u) = floatBitsToUint(v.z);
}

void main() {
    bool overflow = girih_overflow();
    uint number = girih_interleaved_invocation();
    // The patches' own window, where they are more than one storage buffer can hold.
    if (number < girih_push.window_first || number - girih_push.window_first >= girih_push.window_count ||
        number >= GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS)) {
        return;
    }
    GirihItem item = girih_read_item(number, overflow);
    uint group = overflow ? item.group - item.group % girih_frame.range_count : item.group;
    uint key = group << 3 | item.lambda;
    uint word = (number - girih_push.window_first) * GIRIH_PATCH_WORDS;
#if GIRIH_SURFACE == 2
    GIRIH_AT_OUT_ATTRIBUTES(word) = item.scene_triangle;
    GIRIH_AT_OUT_ATTRIBUTES(word + 1u) = item.instance;
    GIRIH_AT_OUT_ATTRIBUTES(word + 2u) = key;
    GIRIH_AT_OUT_ATTRIBUTES(word + 3u) = item.rank;
#else
    uint vertices[3];
    girih_item_vertices(item, vertices);
    GirihPatch p = girih_item_patch(item, vertices);
    girih_write_vector(word, p.b300);
    girih_write_vector(word + 3u, p.b030);
    girih_write_vector(word + 6u, p.b003);
    word += 9u;
#if GIRIH_SURFACE == 1
    girih_write_vector(word, p.b210);
    girih_write_vector(word + 3u, p.b120);
    girih_write_vector(word + 6u, p.b021);
    girih_write_vector(word + 9u, p.b012);
    girih_write_vector(word + 12u, p.b102);
    girih_write_vector(word + 15u, p.b201);
    girih_write_vector(word + 18u, p.b111);
    word += 21u;
#endif
    girih_write_vector(word, p.n200);
    girih_write_vector(word + 3u, p.n020);
    girih_write_vector(word + 6u, p.n002);
    word += 9u;
#if GIRIH_SURFACE == 1
    girih_write_vector(word, p.n110);
    girih_write_vector(word + 3u, p.n011);
    girih_write_vector(word + 6u, p.n101);
    word += 9u;
#endif
    GIRIH_AT_OUT_ATTRIBUTES(word) = vertices[0];
    GIRIH_AT_OUT_ATTRIBUTES(word + 1u) = vertices[1];
    GIRIH_AT_OUT_ATTRIBUTES(word + 2u) = vertices[2];
    GIRIH_AT_OUT_ATTRIBUTES(word + 3u) = key;
#endif
}

#else

bool girih_in_window(uint vertex) {
    return vertex - girih_push.window_first < girih_push.window_count;
}

void girih_write_position(uint vertex, vec3 position) {
    uint word = (vertex - girih_push.window_first) * 3u;
    GIRIH_AT_OUT_POSITIONS(word) = floatBitsToUint(position.x);
    GIRIH_AT_OUT_POSITIONS(word + 1u) = floatBitsToUint(position.y);
    GIRIH_AT_OUT_POSITIONS(word + 2u) = floatBitsToUint(position.z);
}

// `first`: a word of the vertex's record.
void girih_write_attribute_vector(uint vertex, uint first, vec3 v) {
    uint word = (vertex - girih_push.window_first) * girih_frame.attribute_stride + first;
    GIRIH_AT_OUT_ATTRIBUTES(word) = floatBitsToUint(v.x);
    GIRIH_AT_OUT_ATTRIBUTES(word + 1u) = floatBitsToUint(v.y);
    GIRIH_AT_OUT_ATTRIBUTES(word + 2u) = floatBitsToUint(v.z);
}

// Linear interpolation, each side of a seam with its own: `vertices` and weights in the same order.
void girih_write_attributes(uint vertex, uint vertices[3], vec3 b) {
    if (!girih_has(GIRIH_VARIANT_ATTRIBUTES)) {
        return;
    }
    for (uint a = 0u; a < girih_frame.attribute_floats; ++a) {
        float value = girih_scene_attribute(vertices, a, b);
        GIRIH_AT_OUT_ATTRIBUTES((vertex - girih_push.window_first) * girih_frame.attribute_stride + 3u + a) =
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
    if (!welded && (first + end <= girih_push.window_first ||
                    first + begin >= girih_push.window_first + girih_push.window_count)) {
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
    GirihPatch patch_ = girih_own_patch(item.scene_triangle, item.instance, false);
    for (uint n = begin; n < end; ++n) {
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!girih_in_window(vertex)) {
            continue;
        }
        uvec3 weights = girih_pattern_weights(pattern_vertex + n);
        girih_write_attributes(vertex, vertices, girih_barycentric(weights));
        GirihPlaces places = girih_find_places(item.scene_triangle, girih_input_weights(item.lambda, weights));
        // The point, the normal where it is another's, the previous point: all from one place in the code,
        // so that the compiler cannot treat two sides of an edge differently.
        uint turns = girih_has(GIRIH_VARIANT_PREVIOUS) ? 3u : places.smooth_ ? 1u : 2u;
        for (uint turn = 0u; turn < turns; ++turn) {
            GirihPlace place = places.position;
            if (turn == 1u) {
                place = places.normal;
            }
            if (place.triangle != patch_.triangle || patch_.previous != (turn == 2u)) {
                patch_ = girih_own_patch(place.triangle, item.instance, turn == 2u);
            }
            vec3 position;
            vec3 normal;
            girih_own_sample(patch_, girih_barycentric(place.weights), position, normal);
            if (turn == 0u) {
                girih_write_position(vertex, position);
            }
            if (turn == 2u) {
                girih_write_attribute_vector(vertex, 3u + girih_frame.attribute_floats, position);
            } else if (turn == 1u || turns != 2u) {
                girih_write_attribute_vector(vertex, 0u, normal);
            }
        }
    }
#else
    GirihPatch p = girih_item_patch(item, vertices);
    for (uint n = begin; n < end; ++n) {
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!girih_in_window(vertex)) {
            continue;
        }
        vec3 b = girih_barycentric(girih_pattern_weights(pattern_vertex + n));
        girih_write_position(vertex, girih_patch_position(p, b.x, b.y, b.z));
        girih_write_attribute_vector(vertex, 0u, girih_patch_unit_normal(p, b.x, b.y, b.z));
        girih_write_attributes(vertex, vertices, b);
    }
#endif
}

#endif
#endif
