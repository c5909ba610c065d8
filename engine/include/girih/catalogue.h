// Catalogues of base patterns: the offline half of ARKFPI (Lenz, Cavalcante-Neto, Vidal 2009).
//
// A catalogue is a block of bytes that is used where it lies: every table is found by an offset in
// the header, nothing is parsed or copied. doc/catalogue.md describes the format. Every function
// may be called by several threads at once.
//
// Stability: stable
#ifndef GIRIH_CATALOGUE_H
#define GIRIH_CATALOGUE_H

#include <stddef.h>
#include <stdint.h>

#include "girih/result.h"

#ifdef __cplusplus
extern "C" {
#endif

// Barycentric coordinates are integers over this denominator, u + v + w == 32768 exactly.
#define GIRIH_BARYCENTRIC_ONE 32768u

#define GIRIH_CATALOGUE_MAGIC 0x4150544948524947ull // "GIRIHPAT" read as a little-endian integer
#define GIRIH_CATALOGUE_VERSION 3u

typedef enum girih_spacing {
    GIRIH_SPACING_DYADIC = 0, // level l splits an edge into 2^l segments
    GIRIH_SPACING_LINEAR = 1, // level l splits an edge into l + 1 segments
} girih_spacing;

// One base pattern: edge levels i >= j >= k on the edges P1P2, P2P3, P3P1.
//
// Vertices come in this order: the corners P1, P2, P3; then the inner vertices of edge 1 from P1
// to P2, of edge 2 from P2 to P3, of edge 3 from P3 to P1; then the interior. Triangles wind as
// P1, P2, P3.
typedef struct girih_base_pattern {
    uint8_t levels[3];    // i, j, k: levels from 0 in either spacing
    uint8_t index_bytes;  // 1, where there are more than 256 vertices 2, more than 65,536 4
    uint32_t segments[3]; // segments of the edges 1, 2, 3
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t first_vertex; // into the catalogue's vertices
    uint32_t reserved;
    uint64_t index_offset; // bytes from the start of the catalogue, 4-byte aligned
} girih_base_pattern;

// The first bytes of a catalogue. All values are little-endian.
typedef struct girih_catalogue {
    uint64_t magic;
    uint32_t version;
    uint32_t header_bytes;   // sizeof (girih_catalogue)
    uint64_t bytes;          // of the whole catalogue
    uint64_t checksum;       // XXH64, seed 0, of every byte after this field
    uint32_t spacing;        // girih_spacing
    uint32_t max;            // as asked for: the largest level (dyadic) or segment count (linear)
    uint32_t level_count;    // N distinct levels 0..N-1
    uint32_t pattern_count;  // N(N+1)(N+2)/6 (ARKFPI, equation 2)
    uint64_t vertex_count;   // of all patterns together
    uint64_t triangle_count; // of all patterns together
    uint64_t pattern_offset; // girih_base_pattern[pattern_count], in the order of their rank
    uint64_t vertex_offset;  // uint32_t[vertex_count]: u | v << 16, w = 32768 - u - v
    uint64_t parent_offset;  // uint32_t[vertex_count]: each vertex' parent, packed as it is
    char family[16];         // zero-terminated name, as "uniform"
} girih_catalogue;

// Checks a catalogue in memory and returns it as a view of the same bytes in *catalogue: size,
// magic, version, checksum, offsets, and every pattern's levels, ranges, places and indices. The
// bytes stay the caller's, must be aligned to 8 and must outlive the view. A damaged catalogue
// gives GIRIH_ERROR_INVALID_DATA and a reason. Thread-safe.
GIRIH_API girih_result girih_catalogue_open(const void *bytes, size_t size,
                                            const girih_catalogue **catalogue, girih_error *error);

// The built-in catalogues: dyadic levels 0..6 (the default) and linear 1..16 segments. They live as
// long as the program. Thread-safe.
GIRIH_API const girih_catalogue *girih_catalogue_dyadic(void);
GIRIH_API const girih_catalogue *girih_catalogue_linear(void);

// The base pattern of a rank in [0, pattern_count).
GIRIH_API const girih_base_pattern *girih_catalogue_pattern(const girih_catalogue *catalogue,
                                                            uint32_t rank);

// A pattern's packed vertices, vertex_count of them: u | v << 16.
GIRIH_API const uint32_t *girih_catalogue_vertices(const girih_catalogue *catalogue,
                                                   const girih_base_pattern *pattern);

// The parents of a pattern's vertices, packed as these are: where each goes as the pattern of
// levels i, j, k fades into that of max(i - 1, 0), max(j - 1, 0), max(k - 1, 0). No triangle is
// turned over on the way's end, and the vertices lie on those of the coarser pattern, but for the
// few that stay where they are (doc/patterns.md).
GIRIH_API const uint32_t *girih_catalogue_parents(const girih_catalogue *catalogue,
                                                  const girih_base_pattern *pattern);

// Index n in [0, 3 * triangle_count) of a pattern, local to its vertices.
GIRIH_API uint32_t girih_catalogue_index(const girih_catalogue *catalogue,
                                         const girih_base_pattern *pattern, uint32_t n);

// The number of segments of an edge of a level in [0, level_count).
GIRIH_API uint32_t girih_catalogue_segments(const girih_catalogue *catalogue, uint32_t level);

// The smallest level with at least this many segments; level_count - 1 where none has so many, and
// *clamped (which may be NULL) says so.
GIRIH_API uint32_t girih_catalogue_level(const girih_catalogue *catalogue, uint32_t segments,
                                         int *clamped);

#ifdef __cplusplus
}
#endif
#endif
