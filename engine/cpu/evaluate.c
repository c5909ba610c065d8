// Stage 5 on the CPU: patches for the instanced mode, or the surface's points for the baked and
// welded modes. Twin of glsl/evaluate.comp.
#include "item.h"

// Copied, not assigned as words: girih_cpu_output hands the same memory out as floats.
static void write_vector(uint32_t *words, girih_vector v) {
    const float values[3] = {v.x, v.y, v.z};
    memcpy(words, values, sizeof values);
}

static void write_patch(girih_arrays *arrays, uint32_t number, girih_surface surface) {
    const girih_item item = girih_read_item(arrays, number);
    uint32_t vertices[3];
    girih_item_vertices(arrays, &item, vertices);
    girih_patch p;
    girih_item_patch(arrays, &item, vertices, surface, &p);
    const bool pn = surface == GIRIH_SURFACE_PN;
    const uint32_t patch_words = pn ? GIRIH_PATCH_WORDS_PN : GIRIH_PATCH_WORDS_FLAT;
    uint32_t *words = arrays->words[GIRIH_BIND_OUT_ATTRIBUTES] + (size_t)number * patch_words;
    write_vector(words, p.b300);
    write_vector(words + 3, p.b030);
    write_vector(words + 6, p.b003);
    words += 9;
    if (pn) {
        write_vector(words, p.b210);
        write_vector(words + 3, p.b120);
        write_vector(words + 6, p.b021);
        write_vector(words + 9, p.b012);
        write_vector(words + 12, p.b102);
        write_vector(words + 15, p.b201);
        write_vector(words + 18, p.b111);
        words += 21;
    }
    write_vector(words, p.n200);
    write_vector(words + 3, p.n020);
    write_vector(words + 6, p.n002);
    words += 9;
    if (pn) {
        write_vector(words, p.n110);
        write_vector(words + 3, p.n011);
        write_vector(words + 6, p.n101);
        words += 9;
    }
    memcpy(words, vertices, sizeof vertices);
    const bool overflow =
        (girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_FLAGS) & GIRIH_STATUS_OVERFLOW) != 0;
    const uint32_t group =
        overflow ? item.group - item.group % arrays->frame.range_count : item.group;
    words[3] = group << 3 | item.lambda;
}

static void write_points(girih_arrays *arrays, uint32_t number, girih_surface surface) {
    const uint32_t attribute_floats = arrays->frame.attribute_floats;
    const uint32_t *attributes = arrays->words[GIRIH_BIND_ATTRIBUTES];
    const girih_item item = girih_read_item(arrays, number);
    const uint32_t count = girih_group_word(arrays, item.group, GIRIH_GROUP_VERTICES);
    const uint32_t first =
        girih_group_word(arrays, item.group, GIRIH_GROUP_BASE_VERTEX) + number * count;
    const bool welded = arrays->frame.output_mode == GIRIH_OUTPUT_WELDED;
    uint32_t vertices[3];
    girih_item_vertices(arrays, &item, vertices);
    girih_weld weld = {{0}, {0}, {false}, {0}, 0};
    if (welded) {
        weld = girih_item_weld(arrays, &item, vertices, false);
    }
    girih_patch p;
    girih_item_patch(arrays, &item, vertices, surface, &p);
    const uint32_t *pattern_vertices =
        arrays->words[GIRIH_BIND_PATTERN_VERTICES] +
        girih_group_word(arrays, item.group, GIRIH_GROUP_PATTERN_VERTEX);
    for (uint32_t n = 0; n < count; ++n) {
        const uint32_t vertex = welded ? girih_weld_vertex(&weld, n) : first + n;
        const uint32_t ui = pattern_vertices[n] & 0xffff;
        const uint32_t vi = pattern_vertices[n] >> 16;
        const float u = (float)ui * (1.0f / 32768.0f);
        const float v = (float)vi * (1.0f / 32768.0f);
        const float w = (float)(32768 - ui - vi) * (1.0f / 32768.0f);
        write_vector(arrays->words[GIRIH_BIND_OUT_POSITIONS] + (size_t)vertex * 3,
                     girih_patch_position(&p, u, v, w));
        uint32_t *words = arrays->words[GIRIH_BIND_OUT_ATTRIBUTES] +
                          (size_t)vertex * (3 + attribute_floats);
        write_vector(words, girih_patch_unit_normal(&p, u, v, w));
        for (uint32_t a = 0; a < attribute_floats; ++a) {
            const float value = girih_no_negative_zero(girih_patch_attribute(
                girih_word_float(attributes[(size_t)vertices[0] * attribute_floats + a]),
                girih_word_float(attributes[(size_t)vertices[1] * attribute_floats + a]),
                girih_word_float(attributes[(size_t)vertices[2] * attribute_floats + a]), u, v, w));
            memcpy(words + 3 + a, &value, sizeof value);
        }
    }
}

void girih_twin_evaluate(girih_arrays *arrays, girih_surface surface) {
    const uint32_t items = girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_ITEMS);
    for (uint32_t number = 0; number < items; ++number) {
        if (arrays->frame.output_mode == GIRIH_OUTPUT_INSTANCED) {
            write_patch(arrays, number, surface);
        } else {
            write_points(arrays, number, surface);
        }
    }
}
