// Stage 5: patches for the instanced mode (GIRIH_KERNEL 0), or the surface's points in buffers for the
// baked and welded modes (1).
#version 450
#extension GL_GOOGLE_include_directive : require

#include "patch.glsl"

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
    uint group = overflow ? item.group - item.group % frame.range_count : item.group;
    OUT_ATTRIBUTES(word + 3u) = group << 3 | item.lambda;
}

#else

bool in_window(uint vertex) {
    return vertex - push.window_first < push.window_count;
}

void write_point(uint vertex, vec3 position, vec3 normal) {
    uint slot = vertex - push.window_first;
    uint word = slot * 3u;
    OUT_POSITIONS(word) = floatBitsToUint(position.x);
    OUT_POSITIONS(word + 1u) = floatBitsToUint(position.y);
    OUT_POSITIONS(word + 2u) = floatBitsToUint(position.z);
    word = slot * (3u + frame.attribute_floats);
    OUT_ATTRIBUTES(word) = floatBitsToUint(normal.x);
    OUT_ATTRIBUTES(word + 1u) = floatBitsToUint(normal.y);
    OUT_ATTRIBUTES(word + 2u) = floatBitsToUint(normal.z);
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
    GirihPatch p = girih_item_patch(item, vertices);
    uint pattern_vertex = work[GIRIH_GROUP_PATTERN_VERTEX - GIRIH_GROUP_VERTICES];
    for (uint n = begin; n < end; ++n) {
        uint vertex = welded ? girih_weld_vertex(weld, n) : first + n;
        if (!in_window(vertex)) {
            continue;
        }
        uint packed = PATTERN_VERTICES(pattern_vertex + n);
        uint ui = packed & 0xffffu;
        uint vi = packed >> 16;
        float u = float(ui) * (1.0 / 32768.0);
        float v = float(vi) * (1.0 / 32768.0);
        float w = float(32768u - ui - vi) * (1.0 / 32768.0);
        write_point(vertex, girih_patch_position(p, u, v, w), girih_patch_unit_normal(p, u, v, w));
        if (!girih_has(GIRIH_VARIANT_ATTRIBUTES)) {
            continue;
        }
        for (uint a = 0u; a < frame.attribute_floats; ++a) {
            float value = girih_patch_attribute(uintBitsToFloat(ATTRIBUTES(vertices[0] * frame.attribute_floats + a)),
                                                uintBitsToFloat(ATTRIBUTES(vertices[1] * frame.attribute_floats + a)),
                                                uintBitsToFloat(ATTRIBUTES(vertices[2] * frame.attribute_floats + a)), u, v, w);
            OUT_ATTRIBUTES((vertex - push.window_first) * (3u + frame.attribute_floats) + 3u + a) =
                floatBitsToUint(girih_no_negative_zero(value));
        }
    }
}

#endif
