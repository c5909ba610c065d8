// Triangles in bands. A pattern is cut into bands parallel to an edge, and the triangles of each
// follow a line that sweeps along it: of a band that is narrower than the cache every vertex misses
// once, and again only where the next band begins. Bands consist of rows, as wide as those of a
// regular grid. Dynamic programming finds where to cut, from the misses that each band has after
// the best way to where it begins. Bands along every edge are tried, with the line at three slopes,
// and the best order of all is kept.
#include "order.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "order_search.h"

// In rows. Of a regular grid 14 fill the cache.
#define WIDEST_BAND 15u

// For the time it would take, of a larger pattern the first way to sweep is taken untried.
#define MOST_TRIANGLES_TO_TRY_ALL (1u << 13)

// Of the vertices: bands that miss no more often are not improved on.
#define FEW_MISSES_PERCENT 115u

// A cache whose entries leave in the order in which they came: it holds the last `size` that
// entered.
typedef struct cache {
    uint64_t *entered; // by vertex: when
    uint64_t clock;    // counts entries, and jumps by `size` to forget them all
    uint32_t size;
} cache;

// A way to order triangles: the rows are counted from the edge opposite to a corner, and the line
// sweeps away from the next corner.
typedef struct sweep {
    uint32_t corner;
    uint32_t slope; // of the line: 0 and 2 are directions of the grid, 1 is at right angles to rows
} sweep;

// The best way found to order all triangles of the rows before a cut.
typedef struct cut {
    uint64_t misses;
    uint32_t recent[GIRIH_CACHE_SIZE]; // what the cache holds: miss n at n % GIRIH_CACHE_SIZE
    uint32_t previous;                 // where the last band begins
} cut;

// What ordering a pattern needs; by vertex or by triangle unless said otherwise.
typedef struct workspace {
    const girih_pattern *pattern;
    uint32_t grid; // steps from a corner to the edge across, at each a row begins
    cache cache;
    uint32_t *ranks;      // of the vertices along the sweep
    uint32_t *keys;       // to sort by
    uint32_t *order;      // sorted
    uint32_t *other;      // sorted before
    uint32_t *counts;     // by key
    uint32_t *places;     // of the triangles along the sweep
    uint32_t *row_begins; // by row: of its triangles in `order`, and the end
    cut *cuts;            // by row: before it
    uint32_t *band;
    uint32_t *wider;
    uint32_t *best;
    uint64_t best_misses;
} workspace;

static bool enters(cache *c, uint32_t vertex) {
    if (c->clock - c->entered[vertex] <= c->size) {
        return false;
    }
    c->entered[vertex] = c->clock++;
    return true;
}

uint64_t girih_cache_misses(const uint32_t *indices, size_t index_count, uint32_t vertex_count,
                            uint32_t cache_size) {
    cache c = {.entered = calloc(vertex_count, sizeof *c.entered),
               .clock = (uint64_t)cache_size + 1,
               .size = cache_size};
    uint64_t misses = c.entered ? 0 : UINT64_MAX;
    for (size_t n = 0; n < index_count && c.entered; n++) {
        misses += enters(&c, indices[n]);
    }
    free(c.entered);
    return misses;
}

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static uint32_t weight(const girih_pattern *pattern, uint32_t vertex, uint32_t corner) {
    const uint32_t u = pattern->vertices[vertex] & 0xffff;
    const uint32_t v = pattern->vertices[vertex] >> 16;
    return corner == 0 ? u : corner == 1 ? v : GIRIH_BARYCENTRIC_ONE - u - v;
}

// Rounded, for the vertices on a line of a regular grid have to tie.
static uint32_t steps(const workspace *w, uint32_t part) {
    return (part * w->grid + GIRIH_BARYCENTRIC_ONE / 2) / GIRIH_BARYCENTRIC_ONE;
}

// Sorts w->order by w->keys, each below key_count; equal keys stay as they were.
static void sort_by_keys(workspace *w, uint32_t count, uint32_t key_count) {
    memset(w->counts, 0, ((size_t)key_count + 1) * sizeof *w->counts);
    for (uint32_t n = 0; n < count; n++) {
        w->counts[w->keys[n] + 1]++;
    }
    for (uint32_t key = 0; key < key_count; key++) {
        w->counts[key + 1] += w->counts[key];
    }
    for (uint32_t n = 0; n < count; n++) {
        w->other[w->counts[w->keys[w->order[n]]]++] = w->order[n];
    }
    uint32_t *sorted = w->other;
    w->other = w->order;
    w->order = sorted;
}

// Vertices in the order in which the sweeping line meets them.
static void rank_vertices(workspace *w, const sweep *way) {
    const girih_pattern *pattern = w->pattern;
    for (uint32_t vertex = 0; vertex < pattern->vertex_count; vertex++) {
        w->order[vertex] = vertex;
        w->keys[vertex] = steps(w, weight(pattern, vertex, way->corner));
    }
    sort_by_keys(w, pattern->vertex_count, w->grid + 1);
    for (uint32_t vertex = 0; vertex < pattern->vertex_count; vertex++) {
        const uint32_t near = 2 * weight(pattern, vertex, (way->corner + 1) % 3) +
                              way->slope * weight(pattern, vertex, way->corner);
        w->keys[vertex] = 2 * w->grid - steps(w, near);
    }
    sort_by_keys(w, pattern->vertex_count, 2 * w->grid + 1);
    for (uint32_t n = 0; n < pattern->vertex_count; n++) {
        w->ranks[w->order[n]] = n;
    }
}

static void sort_three(uint32_t values[3]) {
    for (int n = 0; n < 3; n++) {
        const int first = n == 1;
        if (values[first] > values[first + 1]) {
            const uint32_t kept = values[first];
            values[first] = values[first + 1];
            values[first + 1] = kept;
        }
    }
}

static void corner_ranks(const workspace *w, uint32_t triangle, uint32_t ranks[3]) {
    for (uint32_t corner = 0; corner < 3; corner++) {
        ranks[corner] = w->ranks[w->pattern->indices[3 * (size_t)triangle + corner]];
    }
    sort_three(ranks);
}

// The row that a triangle fills; of one that a distant vertex draws out over many rows, where its
// other two lie.
static uint32_t row_of(const workspace *w, uint32_t triangle, const sweep *way) {
    uint32_t rows[3];
    for (uint32_t corner = 0; corner < 3; corner++) {
        const uint32_t vertex = w->pattern->indices[3 * (size_t)triangle + corner];
        rows[corner] = steps(w, weight(w->pattern, vertex, way->corner));
    }
    sort_three(rows);
    return larger(rows[0] + 1, rows[1]) - 1;
}

// Triangles by row, and in each row as the sweeping line leaves their last vertices behind.
static void sort_triangles(workspace *w, const sweep *way) {
    const uint32_t count = w->pattern->triangle_count;
    for (uint32_t n = 0; n < count; n++) {
        w->order[n] = n;
    }
    for (uint32_t corner = 0; corner < 3; corner++) {
        for (uint32_t triangle = 0; triangle < count; triangle++) {
            uint32_t ranks[3];
            corner_ranks(w, triangle, ranks);
            w->keys[triangle] = ranks[corner];
        }
        sort_by_keys(w, count, w->pattern->vertex_count);
    }
    for (uint32_t n = 0; n < count; n++) {
        w->places[w->order[n]] = n;
    }
    memset(w->row_begins, 0, ((size_t)w->grid + 2) * sizeof *w->row_begins);
    for (uint32_t triangle = 0; triangle < count; triangle++) {
        w->keys[triangle] = row_of(w, triangle, way);
        w->row_begins[w->keys[triangle] + 1]++;
    }
    for (uint32_t row = 0; row <= w->grid; row++) {
        w->row_begins[row + 1] += w->row_begins[row];
    }
    sort_by_keys(w, count, w->grid + 1);
}

// Adds a row's triangles to the band; returns how many it has then.
static uint32_t widen(workspace *w, uint32_t band_count, uint32_t row) {
    const uint32_t end = w->row_begins[row + 1];
    uint32_t count = 0;
    uint32_t from_band = 0;
    uint32_t from_row = w->row_begins[row];
    while (from_band < band_count || from_row < end) {
        const bool row_next =
            from_band == band_count ||
            (from_row < end && w->places[w->order[from_row]] < w->places[w->band[from_band]]);
        w->wider[count++] = row_next ? w->order[from_row++] : w->band[from_band++];
    }
    uint32_t *kept = w->band;
    w->band = w->wider;
    w->wider = kept;
    return count;
}

static void enter(workspace *w, cut *reached, uint32_t vertex) {
    if (enters(&w->cache, vertex)) {
        reached->recent[reached->misses++ % GIRIH_CACHE_SIZE] = vertex;
    }
}

// Where the band leads from a cut; gives up where it misses as often as a way already known.
static cut follow_band(workspace *w, const cut *from, uint32_t band_count, uint64_t known_misses) {
    cut reached = *from;
    w->cache.clock += w->cache.size;
    const uint64_t held = from->misses < GIRIH_CACHE_SIZE ? from->misses : GIRIH_CACHE_SIZE;
    for (uint64_t n = from->misses - held; n < from->misses; n++) {
        enters(&w->cache, from->recent[n % GIRIH_CACHE_SIZE]);
    }
    for (uint32_t n = 0; n < band_count && reached.misses < known_misses; n++) {
        for (size_t corner = 0; corner < 3; corner++) {
            enter(w, &reached, w->pattern->indices[3 * (size_t)w->band[n] + corner]);
        }
    }
    return reached;
}

static void find_cuts(workspace *w) {
    w->cuts[0] = (cut){.misses = 0};
    for (uint32_t end = 1; end <= w->grid + 1; end++) {
        w->cuts[end].misses = UINT64_MAX;
        uint32_t count = 0;
        for (uint32_t begin = end; begin > 0 && end - begin < WIDEST_BAND; begin--) {
            count = widen(w, count, begin - 1);
            const cut reached = follow_band(w, &w->cuts[begin - 1], count, w->cuts[end].misses);
            if (reached.misses < w->cuts[end].misses) {
                w->cuts[end] = reached;
                w->cuts[end].previous = begin - 1;
            }
        }
    }
}

// The triangles of all bands, from the last to the first.
static void keep_order(workspace *w) {
    uint32_t left = w->pattern->triangle_count;
    for (uint32_t end = w->grid + 1; end > 0; end = w->cuts[end].previous) {
        uint32_t count = 0;
        for (uint32_t row = end; row > w->cuts[end].previous; row--) {
            count = widen(w, count, row - 1);
        }
        left -= count;
        memcpy(w->best + left, w->band, count * sizeof *w->best);
    }
    w->best_misses = w->cuts[w->grid + 1].misses;
}

static void find_order(workspace *w) {
    const uint32_t ways = w->pattern->triangle_count > MOST_TRIANGLES_TO_TRY_ALL ? 1 : 9;
    for (uint32_t n = 0; n < ways; n++) {
        const sweep way = {.corner = n / 3, .slope = (n + 1) % 3};
        rank_vertices(w, &way);
        sort_triangles(w, &way);
        find_cuts(w);
        if (w->cuts[w->grid + 1].misses < w->best_misses) {
            keep_order(w);
        }
    }
}

static uint64_t count_misses(workspace *w, const uint32_t *order) {
    uint64_t misses = 0;
    w->cache.clock += w->cache.size;
    for (size_t n = 0; n < (size_t)w->pattern->triangle_count * 3; n++) {
        misses += enters(&w->cache, w->pattern->indices[3 * (size_t)order[n / 3] + n % 3]);
    }
    return misses;
}

// Bands serve strips of many lengths badly; what a search finds there is kept where it is better.
static girih_result improve_order(workspace *w, girih_error *error) {
    if (w->best_misses * 100 <= FEW_MISSES_PERCENT * (uint64_t)w->pattern->vertex_count ||
        w->pattern->triangle_count > GIRIH_MOST_TRIANGLES_TO_SEARCH) {
        return GIRIH_OK;
    }
    memcpy(w->band, w->best, w->pattern->triangle_count * sizeof *w->band);
    const girih_result result = girih_search_order(w->pattern, w->band, error);
    if (result == GIRIH_OK && count_misses(w, w->band) < w->best_misses) {
        memcpy(w->best, w->band, w->pattern->triangle_count * sizeof *w->best);
    }
    return result;
}

// The best order's indices, and the vertices they count.
static void take_order(const workspace *w, girih_pattern *pattern, uint32_t *vertices,
                       uint32_t *indices) {
    const uint32_t border = girih_border_count(pattern->segments);
    uint32_t *renamed = w->ranks;
    uint32_t named = border;
    for (uint32_t vertex = 0; vertex < pattern->vertex_count; vertex++) {
        renamed[vertex] = vertex < border ? vertex : UINT32_MAX;
    }
    memcpy(vertices, pattern->vertices, border * sizeof *vertices);
    for (size_t n = 0; n < (size_t)pattern->triangle_count * 3; n++) {
        const uint32_t vertex = pattern->indices[3 * (size_t)w->best[n / 3] + n % 3];
        if (renamed[vertex] == UINT32_MAX) {
            vertices[named] = pattern->vertices[vertex];
            renamed[vertex] = named++;
        }
        indices[n] = renamed[vertex];
    }
}

static void *array(bool *complete, size_t count, size_t size) {
    void *made = calloc(count, size);
    *complete = *complete && made;
    return made;
}

// The rows of the regular grid; but a graded pattern of fewer triangles gets as many rows as a grid
// of twice its triangles, or a band could not be wide enough where it is coarse.
static uint32_t grid_of(const girih_pattern *pattern) {
    uint32_t grid = 1;
    while (grid < pattern->segments[0] &&
           (uint64_t)(grid + 1) * (grid + 1) <= 2 * (uint64_t)pattern->triangle_count) {
        grid++;
    }
    return grid;
}

static bool allocate(workspace *w, const girih_pattern *pattern) {
    const uint32_t vertices = pattern->vertex_count;
    const uint32_t triangles = pattern->triangle_count;
    const uint32_t grid = grid_of(pattern);
    const size_t most = larger(vertices, triangles);
    bool complete = true;
    *w = (workspace){
        .pattern = pattern,
        .grid = grid,
        .cache = {.entered = array(&complete, vertices, sizeof *w->cache.entered),
                  .clock = 1,
                  .size = GIRIH_CACHE_SIZE},
        .ranks = array(&complete, vertices, sizeof *w->ranks),
        .keys = array(&complete, most, sizeof *w->keys),
        .order = array(&complete, most, sizeof *w->order),
        .other = array(&complete, most, sizeof *w->other),
        .counts = array(&complete, (size_t)larger(vertices, 2 * grid + 1) + 1, sizeof *w->counts),
        .places = array(&complete, triangles, sizeof *w->places),
        .row_begins = array(&complete, (size_t)grid + 2, sizeof *w->row_begins),
        .cuts = array(&complete, (size_t)grid + 2, sizeof *w->cuts),
        .band = array(&complete, triangles, sizeof *w->band),
        .wider = array(&complete, triangles, sizeof *w->wider),
        .best = array(&complete, triangles, sizeof *w->best),
        .best_misses = UINT64_MAX,
    };
    return complete;
}

static void release(workspace *w) {
    free(w->best);
    free(w->wider);
    free(w->band);
    free(w->cuts);
    free(w->row_begins);
    free(w->places);
    free(w->counts);
    free(w->other);
    free(w->order);
    free(w->keys);
    free(w->ranks);
    free(w->cache.entered);
}

girih_result girih_pattern_order(girih_pattern *pattern, girih_error *error) {
    workspace w;
    bool complete = allocate(&w, pattern);
    uint32_t *vertices = array(&complete, pattern->vertex_count, sizeof *vertices);
    uint32_t *indices = array(&complete, (size_t)pattern->triangle_count * 3, sizeof *indices);
    girih_result result = GIRIH_OK;
    if (complete) {
        find_order(&w);
        result = improve_order(&w, error);
    } else {
        result =
            girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                       "no memory to order a pattern of %u triangles", pattern->triangle_count);
    }
    if (result == GIRIH_OK) {
        take_order(&w, pattern, vertices, indices);
        free(pattern->vertices);
        free(pattern->indices);
        pattern->vertices = vertices;
        pattern->indices = indices;
    } else {
        free(vertices);
        free(indices);
    }
    release(&w);
    return result;
}
