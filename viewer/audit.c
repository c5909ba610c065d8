#include "audit.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"

// The mesh's vertices, all primitives counted through.
typedef struct mesh_points {
    const girih_gltf_mesh *mesh;
    uint32_t vertex_count;
    uint64_t index_count;
    uint32_t *points; // [vertex_count] number of the vertex's position
    uint32_t point_count;
} mesh_points;

static girih_result no_memory(girih_error *error) {
    return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

static void position_bits(const float *position, uint32_t bits[3]) {
    memcpy(bits, position, 12);
    for (int n = 0; n < 3; n++) {
        bits[n] = bits[n] == 0x80000000u ? 0 : bits[n];
    }
}

static uint64_t hash_bits(const uint32_t bits[3]) {
    uint64_t hash = bits[0] * 0x9e3779b97f4a7c15ull;
    hash = (hash ^ (hash >> 29) ^ bits[1]) * 0xbf58476d1ce4e5b9ull;
    hash = (hash ^ (hash >> 32) ^ bits[2]) * 0x94d049bb133111ebull;
    return hash ^ (hash >> 31);
}

// Numbers positions in the order of their first vertices, through a table of open addressing that
// holds a vertex with each position.
static girih_result weld(mesh_points *set, girih_error *error) {
    size_t room = 16;
    while (room < (size_t)set->vertex_count * 2) {
        room *= 2;
    }
    uint32_t *table = malloc(room * sizeof *table);
    uint32_t *firsts =
        malloc(((size_t)set->vertex_count + 1) * sizeof *firsts); // point -> its first vertex
    set->points = malloc(((size_t)set->vertex_count + 1) * sizeof *set->points);
    float *joined = malloc((size_t)set->vertex_count * 12 + 1);
    if (table == NULL || firsts == NULL || set->points == NULL || joined == NULL) {
        free(table);
        free(firsts);
        free(joined);
        return no_memory(error);
    }
    memset(table, 0xff, room * sizeof *table);
    size_t vertex = 0;
    for (uint32_t n = 0; n < set->mesh->primitive_count; n++) {
        const girih_gltf_primitive *primitive = &set->mesh->primitives[n];
        memcpy(joined + 3 * vertex, primitive->positions, (size_t)primitive->vertex_count * 12);
        vertex += primitive->vertex_count;
    }
    for (uint32_t v = 0; v < set->vertex_count; v++) {
        uint32_t bits[3];
        position_bits(joined + 3 * (size_t)v, bits);
        size_t slot = hash_bits(bits) & (room - 1);
        for (;; slot = (slot + 1) & (room - 1)) {
            if (table[slot] == UINT32_MAX) {
                firsts[set->point_count] = v;
                table[slot] = set->point_count++;
                break;
            }
            uint32_t other[3];
            position_bits(joined + 3 * (size_t)firsts[table[slot]], other);
            if (memcmp(bits, other, sizeof bits) == 0) {
                break;
            }
        }
        set->points[v] = table[slot];
    }
    free(table);
    free(firsts);
    free(joined);
    return GIRIH_OK;
}

// Calls back for every triangle that is not degenerate with its three points.
static uint64_t for_each_triangle(const mesh_points *set,
                                  void (*visit)(void *user, const uint32_t points[3]), void *user) {
    uint64_t degenerate = 0;
    uint32_t first = 0;
    for (uint32_t n = 0; n < set->mesh->primitive_count; n++) {
        const girih_gltf_primitive *primitive = &set->mesh->primitives[n];
        for (size_t i = 0; i + 2 < primitive->index_count; i += 3) {
            uint32_t p[3];
            for (size_t k = 0; k < 3; k++) {
                p[k] = set->points[first + primitive->indices[i + k]];
            }
            if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) {
                degenerate++;
            } else {
                visit(user, p);
            }
        }
        first += primitive->vertex_count;
    }
    return degenerate;
}

// Half-edges in buckets by the lower of their two points: the other point, shifted, and in the
// lowest bit whether the half-edge starts there.
typedef struct buckets {
    uint64_t *ends; // [point_count + 1] after filling: ends[p] is where bucket p ends
    uint32_t *half_edges;
} buckets;

static void count_triangle(void *user, const uint32_t points[3]) {
    buckets *b = user;
    for (int k = 0; k < 3; k++) {
        uint32_t from = points[k], to = points[(k + 1) % 3];
        b->ends[(from < to ? from : to) + 1]++;
    }
}

static void place_triangle(void *user, const uint32_t points[3]) {
    buckets *b = user;
    for (int k = 0; k < 3; k++) {
        uint32_t from = points[k], to = points[(k + 1) % 3];
        uint32_t low = from < to ? from : to;
        b->half_edges[b->ends[low]++] = (from < to ? to : from) << 1 | (from < to ? 0u : 1u);
    }
}

static int compare_half_edges(const void *a, const void *b) {
    uint32_t first, second;
    memcpy(&first, a, sizeof first);
    memcpy(&second, b, sizeof second);
    return (first > second) - (first < second);
}

static void sort_bucket(uint32_t *half_edges, size_t count) {
    if (count > 32) {
        qsort(half_edges, count, sizeof *half_edges, compare_half_edges);
        return;
    }
    for (size_t n = 1; n < count; n++) {
        uint32_t half_edge = half_edges[n];
        size_t at = n;
        for (; at > 0 && half_edges[at - 1] > half_edge; at--) {
            half_edges[at] = half_edges[at - 1];
        }
        half_edges[at] = half_edge;
    }
}

static void audit_bucket(girih_audit *audit, uint32_t *half_edges, size_t count) {
    sort_bucket(half_edges, count);
    for (size_t n = 0; n < count;) {
        size_t end = n + 1;
        while (end < count && half_edges[end] >> 1 == half_edges[n] >> 1) {
            end++;
        }
        size_t uses = end - n;
        audit->open += uses == 1;
        audit->nonmanifold += uses >= 3;
        audit->flipped += uses == 2 && half_edges[n] == half_edges[n + 1];
        n = end;
    }
}

static girih_result audit_edges(const mesh_points *set, girih_audit *audit, girih_error *error) {
    buckets b = {.ends = calloc((size_t)set->point_count + 2, sizeof *b.ends),
                 .half_edges = malloc((size_t)set->index_count * sizeof *b.half_edges + 1)};
    if (b.ends == NULL || b.half_edges == NULL) {
        free(b.ends);
        free(b.half_edges);
        return no_memory(error);
    }
    audit->degenerate = for_each_triangle(set, count_triangle, &b);
    for (size_t p = 0; p < set->point_count; p++) {
        b.ends[p + 1] += b.ends[p];
    }
    for_each_triangle(set, place_triangle, &b);
    uint64_t begin = 0;
    for (size_t p = 0; p < set->point_count; p++) {
        audit_bucket(audit, b.half_edges + begin, (size_t)(b.ends[p] - begin));
        begin = b.ends[p];
    }
    free(b.ends);
    free(b.half_edges);
    return GIRIH_OK;
}

girih_result girih_audit_mesh(const girih_gltf_mesh *mesh, girih_audit *audit, girih_error *error) {
    *audit = (girih_audit){0};
    uint64_t vertices = 0;
    mesh_points set = {.mesh = mesh};
    for (uint32_t n = 0; n < mesh->primitive_count; n++) {
        vertices += mesh->primitives[n].vertex_count;
        set.index_count += mesh->primitives[n].index_count;
    }
    if (vertices > INT32_MAX) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE, "mesh '%s' has more than 2^31 vertices",
                          mesh->name);
    }
    set.vertex_count = (uint32_t)vertices;
    audit->triangles = set.index_count / 3;
    girih_result result = weld(&set, error);
    if (result == GIRIH_OK) {
        result = audit_edges(&set, audit, error);
    }
    free(set.points);
    return result;
}
