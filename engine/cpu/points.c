// The arithmetic is that of item.h and surfaces.h, function by function, in loops over eight lanes
// that the compiler turns into vector instructions; so each point has the bits it would have alone.
// A lane is an item while patches are made. While points are evaluated it is an item where a
// pattern is small and many items have it, else a vertex of one item's pattern.
#include "points.h"

#include "attributes.h"

#define LANES 8u

// Vertices of a pattern that are evaluated before they are written.
#define CHUNK 64u

// Up to here eight items that share a pattern are evaluated vertex by vertex: there, chunks would
// be mostly empty.
#define SMALL_PATTERN 48u

// Two builds of the same code, chosen when it runs. GCC misaligns wide vectors on Windows' stacks.
// AVX2 has no fused multiply-add, so both round alike. Sanitizers check every access of what is
// flattened, which takes GCC many minutes: their builds call the functions instead.
#if !defined(__GNUC__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FLATTEN
#else
#define FLATTEN __attribute__((flatten))
#if defined(__x86_64__) && !defined(_WIN32)
#define FLATTEN_AVX2 __attribute__((flatten, target("avx2")))
#endif
#endif

// The vectors of a girih_patch; a flat one has the first six.
#define FLAT_VECTORS(X) X(0, b300) X(1, b030) X(2, b003) X(3, n200) X(4, n020) X(5, n002)
#define CURVE_VECTORS(X)                                                                           \
    X(6, b210)                                                                                     \
    X(7, b120)                                                                                     \
    X(8, b021) X(9, b012) X(10, b102) X(11, b201) X(12, b111) X(13, n110) X(14, n011) X(15, n101)
#define VECTORS 16

// Eight vectors.
typedef struct lanes {
    float x[LANES], y[LANES], z[LANES];
} lanes;

static inline girih_vector get(const lanes *from, uint32_t lane) {
    return (girih_vector){from->x[lane], from->y[lane], from->z[lane]};
}

static inline void put(lanes *to, uint32_t lane, girih_vector v) {
    to->x[lane] = v.x;
    to->y[lane] = v.y;
    to->z[lane] = v.z;
}

// Items one after another that have the same group.
typedef struct batch {
    uint32_t count;
    girih_item items[LANES];
    uint32_t vertices[LANES][3];
    bool has_seams;
    uint32_t edges[LANES][3];
    uint32_t instances[LANES]; // whose transforms the lanes hold
    lanes corners[3], normals[3];
    lanes rows[3], normal_rows[3];
    lanes offset; // of the rows
    lanes patch[VECTORS];
} batch;

static void read_transform(const girih_arrays *arrays, batch *b, uint32_t lane, uint32_t instance) {
    const girih_transform t = girih_instance_transform(arrays, instance);
    const girih_transform nt = girih_instance_normal_transform(arrays, instance);
    for (uint32_t n = 0; n < 3; ++n) {
        put(&b->rows[n], lane, t.row[n]);
        put(&b->normal_rows[n], lane, nt.row[n]);
    }
    put(&b->offset, lane, (girih_vector){t.offset[0], t.offset[1], t.offset[2]});
    b->instances[lane] = instance;
}

// Reads the batch that begins with an item; lanes beyond its count keep what they had.
static void read_batch(const girih_arrays *arrays, bool pn, uint32_t first, uint32_t end,
                       batch *b) {
    b->count = 0;
    b->has_seams = false;
    for (uint32_t lane = 0; lane < LANES && first + lane < end; ++lane) {
        const girih_item item = girih_read_item(arrays, first + lane);
        if (lane > 0 && (item.group != b->items[0].group || item.is_part)) {
            return;
        }
        b->items[lane] = item;
        girih_item_vertices(arrays, &item, b->vertices[lane]);
        for (uint32_t n = 0; n < 3; ++n) {
            put(&b->corners[n], lane, girih_vertex_position(arrays, b->vertices[lane][n]));
            put(&b->normals[n], lane, girih_vertex_normal(arrays, b->vertices[lane][n]));
        }
        if (item.instance != b->instances[lane]) {
            read_transform(arrays, b, lane, item.instance);
        }
        if (pn) {
            girih_item_edges(arrays, &item, b->edges[lane]);
            b->has_seams |= ((b->edges[lane][0] | b->edges[lane][1] | b->edges[lane][2]) &
                             GIRIH_EDGE_SEAM) != 0;
        }
        b->count = lane + 1;
        // A part's vertices have weights of their own, so it stands alone.
        if (item.is_part) {
            return;
        }
    }
}

static inline void put_patch(batch *b, uint32_t lane, const girih_patch *patch, bool pn) {
#define PUT(n, name) put(&b->patch[n], lane, patch->name);
    FLAT_VECTORS(PUT)
    if (pn) {
        CURVE_VECTORS(PUT)
    }
#undef PUT
}

static inline girih_patch get_patch(const batch *b, uint32_t lane, bool pn) {
    girih_patch patch;
    patch.surface = pn ? GIRIH_SURFACE_PN : GIRIH_SURFACE_FLAT;
#define GET(n, name) patch.name = get(&b->patch[n], lane);
    FLAT_VECTORS(GET)
    if (pn) {
        CURVE_VECTORS(GET)
    }
#undef GET
    return patch;
}

static inline void make_patches(const girih_arrays *arrays, bool pn, batch *b) {
    for (uint32_t lane = 0; lane < LANES; ++lane) {
        const girih_vector p[3] = {get(&b->corners[0], lane), get(&b->corners[1], lane),
                                   get(&b->corners[2], lane)};
        const girih_vector n[3] = {get(&b->normals[0], lane), get(&b->normals[1], lane),
                                   get(&b->normals[2], lane)};
        const girih_transform t = {
            {get(&b->rows[0], lane), get(&b->rows[1], lane), get(&b->rows[2], lane)},
            {b->offset.x[lane], b->offset.y[lane], b->offset.z[lane]}};
        const girih_transform nt = {{get(&b->normal_rows[0], lane), get(&b->normal_rows[1], lane),
                                     get(&b->normal_rows[2], lane)},
                                    {0.0f, 0.0f, 0.0f}};
        girih_patch patch;
        girih_place_flat(p, n, &t, &nt, &patch);
        if (pn) {
            const girih_pn_points c = girih_make_smooth_pn_points(p, n);
            girih_place_curve(p, n, &c, &t, &nt, &patch);
        }
        put_patch(b, lane, &patch, pn);
    }
    for (uint32_t lane = 0; lane < b->count && b->has_seams; ++lane) {
        girih_patch patch;
        girih_item_patch(arrays, &b->items[lane], b->vertices[lane], GIRIH_SURFACE_PN, &patch);
        put_patch(b, lane, &patch, true);
    }
}

// Barycentrics of a word of PATTERN_VERTICES.
static inline girih_vector barycentric(uint32_t word) {
    // Signed: the smaller vector instruction sets convert nothing else.
    const int32_t u = (int32_t)(word & 0xffff);
    const int32_t v = (int32_t)(word >> 16);
    return (girih_vector){(float)u * (1.0f / 32768.0f), (float)v * (1.0f / 32768.0f),
                          (float)(32768 - u - v) * (1.0f / 32768.0f)};
}

static inline void evaluate(const girih_patch *patch, girih_vector b, float *position,
                            float *normal) {
    const girih_vector p = girih_patch_position(patch, b.x, b.y, b.z);
    const girih_vector n = girih_patch_unit_normal(patch, b.x, b.y, b.z);
    position[0] = p.x;
    position[1] = p.y;
    position[2] = p.z;
    normal[0] = n.x;
    normal[1] = n.y;
    normal[2] = n.z;
}

// A vertex of the pattern in every lane's item.
static inline void evaluate_items(const batch *b, bool pn, uint32_t word,
                                  float (*restrict positions)[3], float (*restrict normals)[3]) {
    const girih_vector weights = barycentric(word);
    for (uint32_t lane = 0; lane < LANES; ++lane) {
        const girih_patch patch = get_patch(b, lane, pn);
        evaluate(&patch, weights, positions[lane], normals[lane]);
    }
}

// Vertices of the pattern in one item, rounded up to whole lanes.
static inline void evaluate_vertices(const girih_patch *patch, const uint32_t *restrict words,
                                     uint32_t count, float (*restrict positions)[3],
                                     float (*restrict normals)[3]) {
    for (uint32_t first = 0; first < count; first += LANES) {
        for (uint32_t lane = 0; lane < LANES; ++lane) {
            evaluate(patch, barycentric(words[first + lane]), positions[first + lane],
                     normals[first + lane]);
        }
    }
}

// Where an item's vertices go.
typedef struct writer {
    const girih_arrays *arrays;
    float *positions, *attributes;
    uint32_t stride; // of the attributes
    bool welded;
    uint32_t first[LANES]; // baked: output vertex of each item's first
    girih_weld weld[LANES];
} writer;

static void write_vertex(const writer *w, const batch *b, uint32_t lane, uint32_t number,
                         girih_vector weights, const float position[3], const float normal[3]) {
    const size_t vertex =
        w->welded ? girih_weld_vertex(&w->weld[lane], number) : w->first[lane] + number;
    memcpy(w->positions + 3 * vertex, position, 3 * sizeof *position);
    float *attributes = w->attributes + w->stride * vertex;
    memcpy(attributes, normal, 3 * sizeof *normal);
    if (w->arrays->frame.attribute_floats > 0) {
        const float values[3] = {weights.x, weights.y, weights.z};
        girih_write_attributes(w->arrays, b->vertices[lane], values, attributes + 3);
    }
}

static void begin_batch(writer *w, const batch *b, uint32_t count) {
    for (uint32_t lane = 0; lane < b->count; ++lane) {
        const girih_item *item = &b->items[lane];
        if (w->welded) {
            w->weld[lane] = girih_item_weld(w->arrays, item, b->vertices[lane], false);
        } else {
            w->first[lane] = girih_group_word(w->arrays, item->group, GIRIH_GROUP_BASE_VERTEX) +
                             item->number * count;
        }
    }
}

static inline void write_small(const writer *w, const batch *b, bool pn, const uint32_t *words,
                               uint32_t count) {
    float positions[LANES][3];
    float normals[LANES][3];
    for (uint32_t n = 0; n < count; ++n) {
        evaluate_items(b, pn, words[n], positions, normals);
        for (uint32_t lane = 0; lane < b->count; ++lane) {
            write_vertex(w, b, lane, n, barycentric(words[n]), positions[lane], normals[lane]);
        }
    }
}

static inline void write_chunks(const writer *w, const batch *b, uint32_t lane, bool pn,
                                const uint32_t *words, uint32_t count) {
    const girih_patch patch = get_patch(b, lane, pn);
    float positions[CHUNK][3];
    float normals[CHUNK][3];
    uint32_t padded[CHUNK] = {0};
    for (uint32_t first = 0; first < count; first += CHUNK) {
        const uint32_t left = count - first < CHUNK ? count - first : CHUNK;
        memcpy(padded, words + first, left * sizeof *words);
        evaluate_vertices(&patch, padded, left, positions, normals);
        if (!w->welded && w->stride == 3) {
            const size_t vertex = w->first[lane] + first;
            memcpy(w->positions + 3 * vertex, positions, left * sizeof *positions);
            memcpy(w->attributes + 3 * vertex, normals, left * sizeof *normals);
            continue;
        }
        for (uint32_t n = 0; n < left; ++n) {
            write_vertex(w, b, lane, first + n, barycentric(padded[n]), positions[n], normals[n]);
        }
    }
}

static void write_part(const writer *w, const batch *b, bool pn, const uint32_t *words,
                       uint32_t count) {
    const girih_patch patch = get_patch(b, 0, pn);
    const girih_part part = girih_item_part(w->arrays, &b->items[0]);
    for (uint32_t n = 0; n < count; ++n) {
        uint32_t weights[3];
        girih_item_weights(&b->items[0], &part, words[n], weights);
        const float scale = 1.0f / (float)GIRIH_SPLIT_ONE;
        const girih_vector values = {(float)weights[0] * scale, (float)weights[1] * scale,
                                     (float)weights[2] * scale};
        float position[3];
        float normal[3];
        evaluate(&patch, values, position, normal);
        write_vertex(w, b, 0, n, values, position, normal);
    }
}

static inline void write_points(girih_arrays *arrays, bool pn) {
    const uint32_t items = girih_word(arrays, GIRIH_BIND_STATUS, GIRIH_STATUS_ITEMS);
    writer w = {.arrays = arrays,
                .positions = (float *)(void *)arrays->words[GIRIH_BIND_OUT_POSITIONS],
                .attributes = (float *)(void *)arrays->words[GIRIH_BIND_OUT_ATTRIBUTES],
                .stride = arrays->frame.attribute_stride,
                .welded = arrays->frame.output_mode == GIRIH_OUTPUT_WELDED};
    batch b = {.count = 0};
    memset(b.instances, 0xff, sizeof b.instances);
    for (uint32_t first = 0; first < items; first += b.count) {
        read_batch(arrays, pn, first, items, &b);
        make_patches(arrays, pn, &b);
        const uint32_t group = b.items[0].group;
        const uint32_t count = girih_group_word(arrays, group, GIRIH_GROUP_VERTICES);
        const uint32_t *words = arrays->words[GIRIH_BIND_PATTERN_VERTICES] +
                                girih_group_word(arrays, group, GIRIH_GROUP_PATTERN_VERTEX);
        begin_batch(&w, &b, count);
        if (b.items[0].is_part) {
            write_part(&w, &b, pn, words, count);
            continue;
        }
        if (count <= SMALL_PATTERN && 2 * b.count > LANES) {
            write_small(&w, &b, pn, words, count);
            continue;
        }
        for (uint32_t lane = 0; lane < b.count; ++lane) {
            write_chunks(&w, &b, lane, pn, words, count);
        }
    }
}

FLATTEN static void write_flat(girih_arrays *arrays) {
    write_points(arrays, false);
}

FLATTEN static void write_pn(girih_arrays *arrays) {
    write_points(arrays, true);
}

#ifdef FLATTEN_AVX2
FLATTEN_AVX2 static void write_flat_avx2(girih_arrays *arrays) {
    write_points(arrays, false);
}

FLATTEN_AVX2 static void write_pn_avx2(girih_arrays *arrays) {
    write_points(arrays, true);
}
#endif

void girih_twin_points(girih_arrays *arrays, girih_surface surface) {
    const bool pn = surface == GIRIH_SURFACE_PN;
#ifdef FLATTEN_AVX2
    if (__builtin_cpu_supports("avx2")) {
        (pn ? write_pn_avx2 : write_flat_avx2)(arrays);
        return;
    }
#endif
    (pn ? write_pn : write_flat)(arrays);
}
