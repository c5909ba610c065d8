// Beam search for an order of triangles. What an order must cost is known before its end: a vertex
// that leaves the cache while some of its triangles are left will miss once more. So the orders
// kept after every triangle are those that have lost the fewest vertices in this way, then those
// with the fewest unfinished vertices in the cache, then those whose unfinished vertices entered
// last.
#include "order_search.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "order.h"

#define BEAM_WIDTH 16u

#define NO_STEP UINT32_MAX

// An order of the first triangles.
typedef struct state {
    uint32_t lost; // vertices that left the cache unfinished
    uint32_t cached;
    uint32_t cache[GIRIH_CACHE_SIZE]; // its vertices, the last entered first
    uint64_t hash;                    // of the set of triangles ordered
    uint32_t step;                    // the last one's
    uint8_t *is_ordered;              // by triangle
    uint16_t *left;                   // by vertex: its triangles that are not ordered yet
} state;

// A triangle that may follow a state's.
typedef struct candidate {
    uint32_t from; // the state
    uint32_t triangle;
    uint32_t lost;
    uint32_t open; // unfinished vertices in the cache
    uint32_t age;  // of these, added up
    uint64_t hash;
} candidate;

// One triangle of an order, and the step before it.
typedef struct step {
    uint32_t triangle, previous;
} step;

typedef struct search {
    const girih_pattern *pattern;
    const uint32_t *order; // triangles are numbered by their place in it
    uint32_t *first;       // by vertex: of its triangles in `around`, and the end
    uint32_t *around;
    state states[2][BEAM_WIDTH];
    uint32_t state_count;
    candidate *candidates;
    uint32_t candidate_count;
    step *steps;
    uint32_t step_count;
} search;

static const uint32_t *corners_of(const search *s, uint32_t triangle) {
    return s->pattern->indices + 3 * (size_t)s->order[triangle];
}

// Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators": one number mixed.
static uint64_t mix(uint64_t number) {
    number += 0x9e3779b97f4a7c15u;
    number = (number ^ number >> 30) * 0xbf58476d1ce4e5b9u;
    number = (number ^ number >> 27) * 0x94d049bb133111ebu;
    return number ^ number >> 31;
}

static bool is_cached(const state *from, uint32_t vertex) {
    uint32_t n = 0;
    while (n < from->cached && from->cache[n] != vertex) {
        n++;
    }
    return n < from->cached;
}

// Lets a triangle's vertices into a state's cache; `left` must already count without it.
static void enter(state *to, const uint32_t corners[3]) {
    for (int corner = 0; corner < 3; corner++) {
        if (is_cached(to, corners[corner])) {
            continue;
        }
        if (to->cached == GIRIH_CACHE_SIZE) {
            to->lost += to->left[to->cache[--to->cached]] != 0;
        }
        memmove(to->cache + 1, to->cache, to->cached * sizeof *to->cache);
        to->cache[0] = corners[corner];
        to->cached++;
    }
}

static void consider(search *s, uint32_t number, uint32_t triangle) {
    state *from = &s->states[0][number];
    const uint32_t *corners = corners_of(s, triangle);
    state after = *from;
    for (int corner = 0; corner < 3; corner++) {
        after.left[corners[corner]]--;
    }
    enter(&after, corners);
    candidate made = {.from = number,
                      .triangle = triangle,
                      .lost = after.lost,
                      .hash = from->hash ^ mix(triangle)};
    for (uint32_t n = 0; n < after.cached; n++) {
        if (after.left[after.cache[n]] != 0) {
            made.open++;
            made.age += n;
        }
    }
    for (int corner = 0; corner < 3; corner++) {
        from->left[corners[corner]]++; // `after` has borrowed it
    }
    s->candidates[s->candidate_count++] = made;
}

// Triangles at the cache's vertices; where all of these are finished, the first that is left.
static void consider_neighbours(search *s, uint32_t number) {
    const state *from = &s->states[0][number];
    const uint32_t before = s->candidate_count;
    for (uint32_t n = 0; n < from->cached; n++) {
        const uint32_t vertex = from->cache[n];
        for (uint32_t k = s->first[vertex]; k < s->first[vertex + 1]; k++) {
            const uint32_t triangle = s->around[k];
            // Once, at the corner that entered last.
            const uint32_t *corners = corners_of(s, triangle);
            bool is_first = !from->is_ordered[triangle];
            for (uint32_t m = 0; m < n && is_first; m++) {
                is_first = from->cache[m] != corners[0] && from->cache[m] != corners[1] &&
                           from->cache[m] != corners[2];
            }
            if (is_first) {
                consider(s, number, triangle);
            }
        }
    }
    if (s->candidate_count == before) {
        uint32_t triangle = 0;
        while (from->is_ordered[triangle]) {
            triangle++;
        }
        consider(s, number, triangle);
    }
}

static int compare_candidates(const void *a, const void *b) {
    const candidate *left = a;
    const candidate *right = b;
    const uint32_t pairs[][2] = {{left->lost, right->lost},
                                 {left->open, right->open},
                                 {left->age, right->age},
                                 {left->from, right->from},
                                 {left->triangle, right->triangle}};
    for (size_t n = 0; n < sizeof pairs / sizeof pairs[0]; n++) {
        if (pairs[n][0] != pairs[n][1]) {
            return pairs[n][0] < pairs[n][1] ? -1 : 1;
        }
    }
    return 0;
}

// Whether a kept state has the same triangles behind it and the same cache before it.
static bool is_known(const search *s, const state *found, uint32_t kept) {
    for (uint32_t n = 0; n < kept; n++) {
        const state *other = &s->states[1][n];
        if (other->hash == found->hash && other->cached == found->cached &&
            memcmp(other->cache, found->cache, found->cached * sizeof *found->cache) == 0) {
            return true;
        }
    }
    return false;
}

static void follow(search *s, const candidate *chosen, state *to) {
    const state *from = &s->states[0][chosen->from];
    const uint32_t *corners = corners_of(s, chosen->triangle);
    uint8_t *is_ordered = to->is_ordered;
    uint16_t *left = to->left;
    memcpy(is_ordered, from->is_ordered, s->pattern->triangle_count * sizeof *is_ordered);
    memcpy(left, from->left, s->pattern->vertex_count * sizeof *left);
    *to = *from;
    to->is_ordered = is_ordered;
    to->left = left;
    to->hash = chosen->hash;
    is_ordered[chosen->triangle] = 1;
    for (int corner = 0; corner < 3; corner++) {
        left[corners[corner]]--;
    }
    enter(to, corners);
}

// The best of what may follow all states. Equal ones are few, so they are dropped one by one.
static void keep_best(search *s) {
    qsort(s->candidates, s->candidate_count, sizeof *s->candidates, compare_candidates);
    uint32_t kept = 0;
    for (uint32_t n = 0; n < s->candidate_count && kept < BEAM_WIDTH; n++) {
        state *to = &s->states[1][kept];
        follow(s, &s->candidates[n], to);
        if (!is_known(s, to, kept)) {
            s->steps[s->step_count] =
                (step){s->candidates[n].triangle, s->states[0][s->candidates[n].from].step};
            to->step = s->step_count++;
            kept++;
        }
    }
    for (uint32_t n = 0; n < kept; n++) {
        const state swapped = s->states[0][n];
        s->states[0][n] = s->states[1][n];
        s->states[1][n] = swapped;
    }
    s->state_count = kept;
}

// Each vertex's triangles, and that all of them are left.
static void find_neighbours(search *s) {
    const uint32_t vertices = s->pattern->vertex_count;
    uint16_t *left = s->states[0][0].left;
    for (size_t n = 0; n < (size_t)s->pattern->triangle_count * 3; n++) {
        left[s->pattern->indices[n]]++;
    }
    for (uint32_t vertex = 0; vertex < vertices; vertex++) {
        s->first[vertex + 1] = s->first[vertex] + left[vertex];
    }
    for (uint32_t triangle = 0; triangle < s->pattern->triangle_count; triangle++) {
        for (int corner = 0; corner < 3; corner++) {
            const uint32_t vertex = corners_of(s, triangle)[corner];
            s->around[s->first[vertex + 1] - left[vertex]--] = triangle;
        }
    }
    for (uint32_t vertex = 0; vertex < vertices; vertex++) {
        left[vertex] = (uint16_t)(s->first[vertex + 1] - s->first[vertex]);
    }
}

static void *array(bool *complete, size_t count, size_t size) {
    void *made = calloc(count, size);
    *complete = *complete && made;
    return made;
}

static bool allocate(search *s, const girih_pattern *pattern, const uint32_t *order) {
    const uint32_t vertices = pattern->vertex_count;
    const uint32_t triangles = pattern->triangle_count;
    bool complete = true;
    *s = (search){
        .pattern = pattern,
        .order = order,
        .first = array(&complete, (size_t)vertices + 1, sizeof *s->first),
        .around = array(&complete, (size_t)triangles * 3, sizeof *s->around),
        .candidates = array(&complete, (size_t)triangles * BEAM_WIDTH, sizeof *s->candidates),
        .steps = array(&complete, (size_t)triangles * BEAM_WIDTH, sizeof *s->steps),
        .state_count = 1,
    };
    for (int n = 0; n < 2; n++) {
        for (uint32_t k = 0; k < BEAM_WIDTH; k++) {
            state *made = &s->states[n][k];
            made->is_ordered = array(&complete, triangles, sizeof *made->is_ordered);
            made->left = array(&complete, vertices, sizeof *made->left);
            made->step = NO_STEP;
        }
    }
    return complete;
}

static void release(search *s) {
    for (int n = 0; n < 2; n++) {
        for (uint32_t k = 0; k < BEAM_WIDTH; k++) {
            free(s->states[n][k].left);
            free(s->states[n][k].is_ordered);
        }
    }
    free(s->steps);
    free(s->candidates);
    free(s->around);
    free(s->first);
}

girih_result girih_search_order(const girih_pattern *pattern, uint32_t *order, girih_error *error) {
    search s;
    const uint32_t count = pattern->triangle_count;
    bool complete = allocate(&s, pattern, order);
    uint32_t *found = array(&complete, count, sizeof *found);
    if (complete) {
        find_neighbours(&s);
        for (uint32_t n = 0; n < count; n++) {
            s.candidate_count = 0;
            for (uint32_t k = 0; k < s.state_count; k++) {
                consider_neighbours(&s, k);
            }
            keep_best(&s);
        }
        uint32_t last = s.states[0][0].step;
        for (uint32_t n = count; n-- > 0; last = s.steps[last].previous) {
            found[n] = order[s.steps[last].triangle];
        }
        memcpy(order, found, count * sizeof *order);
    }
    free(found);
    release(&s);
    return complete ? GIRIH_OK
                    : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                                 "no memory to order a pattern of %u triangles", count);
}
