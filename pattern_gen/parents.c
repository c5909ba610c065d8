// Every inner vertex begins at the nearest vertex of the coarser pattern. That turns some triangles
// over; their corners then try other vertices near them, and those that their neighbours have,
// until none is turned over: the move that leaves the least area turned over, and of such the
// shortest, with a few moves during which it is not taken back (tabu search, Glover 1989). Then
// what has strayed goes back as far as it can, and coarser vertices without a child are given one
// where that costs less than it brings.
//
// All vertices that symmetries lead to move at once. A vertex on an axis can only go along it, and
// stays where that is far. Whole numbers alone and random numbers with a seed: the same parents
// come out everywhere.
#include "parents.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "nearest_vertices.h"
#include "symmetry.h"

#define NEAREST 12u
#define MOST_CANDIDATES 64u

// What a vertex leaves it does not choose again for so many moves at most.
#define LONGEST_LEFT 9u

// A coarse vertex without a child costs as much as one that strays by two of its distances to the
// next coarse vertex, and a vertex on an axis that stays as much as the coarse vertex nearest to
// it.
#define PRICE_OF_CHILDLESS 4

// Moves until a pattern is given up: so many, and so many more for each triangle that is turned
// over at first.
#define FIRST_MOVES 1000u
#define MOVES_A_TRIANGLE 100u

// Moves to mend what a child turns over, vertices near a childless one that are tried, and how
// often all of them are.
#define MOVES_A_CHILD 40u
#define CHILDREN_TRIED 24u
#define ROUNDS_OF_TRIALS 3u

typedef struct change {
    uint32_t vertex;
    uint32_t before; // what it had chosen
} change;

// What a vertex has left and may not choose again before a move.
typedef struct left_choice {
    uint32_t vertex;
    uint32_t coarse;
    uint64_t until;
} left_choice;

typedef struct search {
    const girih_pattern *fine;
    const girih_pattern *coarse;
    uint32_t border_count; // of the fine vertices
    girih_symmetry symmetry;
    girih_symmetry coarse_symmetry;
    uint32_t symmetries;     // so many of them are kept
    girih_vertex_grid grid;  // of the coarse vertices
    uint32_t *star_begins;   // by fine vertex, of `stars`, and the end
    uint32_t *stars;         // triangles
    uint32_t *parents;       // by fine vertex, packed
    uint32_t *chosen;        // by fine vertex: the coarse vertex, GIRIH_NO_VERTEX where it stays
    uint32_t *children;      // by coarse vertex
    int64_t *prices;         // by coarse vertex, of being childless
    int64_t *staying;        // by fine vertex, the price of it; 0 where it is no choice
    int64_t *areas;          // by triangle: what of it is turned over
    uint32_t *turned;        // the triangles that are
    uint32_t *turned_places; // by triangle, in `turned`, from 1; 0 where it is not there
    uint32_t turned_count;
    bool *held;                     // by fine vertex: not to be moved
    left_choice left[LONGEST_LEFT]; // of move n: left[n % LONGEST_LEFT]
    uint64_t moves;
    int64_t turned_area;
    int64_t stray; // squared distances, and prices
    uint64_t random;
    change *changes; // to be taken back
    uint32_t change_count;
    uint32_t change_capacity;
} search;

void girih_coarser_levels(const uint32_t levels[3], uint32_t coarser[3]) {
    for (int edge = 0; edge < 3; edge++) {
        coarser[edge] = levels[edge] > 0 ? levels[edge] - 1 : 0;
    }
}

static bool stays(uint32_t m, uint32_t n, uint32_t coarser) {
    return 2 * m == n && coarser % 2 == 1;
}

uint32_t girih_border_parent(uint32_t m, uint32_t n, uint32_t coarser) {
    return stays(m, n, coarser) ? GIRIH_BARYCENTRIC_ONE / 2
                                : girih_edge_parameter(girih_snap(m, n, coarser), coarser);
}

static uint64_t next_random(search *s) {
    s->random ^= s->random << 13;
    s->random ^= s->random >> 7;
    s->random ^= s->random << 17;
    return s->random >> 16;
}

// --- Moves ---

static int64_t turned_area(const search *s, uint32_t triangle) {
    int64_t u[3];
    int64_t v[3];
    for (int corner = 0; corner < 3; corner++) {
        const uint32_t parent = s->parents[s->fine->indices[3 * (size_t)triangle + (size_t)corner]];
        u[corner] = parent & 0xffff;
        v[corner] = parent >> 16;
    }
    const int64_t area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
    return area < 0 ? -area : 0;
}

static void list_turned(search *s, uint32_t triangle) {
    const uint32_t place = s->turned_places[triangle];
    if (s->areas[triangle] > 0 && place == 0) {
        s->turned[s->turned_count++] = triangle;
        s->turned_places[triangle] = s->turned_count;
    } else if (s->areas[triangle] == 0 && place > 0) {
        const uint32_t last = s->turned[--s->turned_count];
        s->turned[place - 1] = last;
        s->turned_places[last] = place;
        s->turned_places[triangle] = 0;
    }
}

static void measure_triangle(search *s, uint32_t triangle) {
    const int64_t area = turned_area(s, triangle);
    s->turned_area += area - s->areas[triangle];
    s->areas[triangle] = area;
    list_turned(s, triangle);
}

// Takes a child from a coarse vertex, or gives it one.
static void count_child(search *s, uint32_t coarse, bool gives) {
    if (coarse == GIRIH_NO_VERTEX) {
        return;
    }
    if (gives) {
        s->stray -= s->children[coarse]++ == 0 ? s->prices[coarse] : 0;
    } else {
        s->stray += --s->children[coarse] == 0 ? s->prices[coarse] : 0;
    }
}

static int64_t price_of(const search *s, uint32_t vertex) {
    return s->chosen[vertex] == GIRIH_NO_VERTEX
               ? s->staying[vertex]
               : girih_squared_distance(s->fine->vertices[vertex], s->parents[vertex]);
}

static void put_one(search *s, uint32_t vertex, uint32_t coarse) {
    s->stray -= price_of(s, vertex);
    count_child(s, s->chosen[vertex], false);
    count_child(s, coarse, true);
    s->chosen[vertex] = coarse;
    s->parents[vertex] =
        coarse == GIRIH_NO_VERTEX ? s->fine->vertices[vertex] : s->coarse->vertices[coarse];
    s->stray += price_of(s, vertex);
    for (uint32_t n = s->star_begins[vertex]; n < s->star_begins[vertex + 1]; n++) {
        measure_triangle(s, s->stars[n]);
    }
}

static uint32_t image_of(const search *s, uint32_t symmetry, uint32_t coarse) {
    return coarse == GIRIH_NO_VERTEX ? coarse : s->coarse_symmetry.images[symmetry][coarse];
}

// A vertex and its images.
static void put(search *s, uint32_t vertex, uint32_t coarse) {
    for (uint32_t n = 0; n < s->symmetries; n++) {
        const uint32_t image = image_of(s, n, coarse);
        const uint32_t where = s->symmetry.images[n][vertex];
        if (s->chosen[where] != image) {
            put_one(s, where, image);
        }
    }
}

// Puts a vertex, to be taken back. False without memory.
static bool change_to(search *s, uint32_t vertex, uint32_t coarse) {
    if (s->change_count == s->change_capacity) {
        const uint32_t capacity = 2 * s->change_capacity + 64;
        change *changes = realloc(s->changes, capacity * sizeof *changes);
        if (!changes) {
            return false;
        }
        s->changes = changes;
        s->change_capacity = capacity;
    }
    s->changes[s->change_count++] = (change){vertex, s->chosen[vertex]};
    put(s, vertex, coarse);
    return true;
}

static void take_back(search *s, uint32_t change_count) {
    while (s->change_count > change_count) {
        const change last = s->changes[--s->change_count];
        put(s, last.vertex, last.before);
    }
}

static void hold(search *s, uint32_t vertex, bool held) {
    for (uint32_t n = 0; n < s->symmetries; n++) {
        s->held[s->symmetry.images[n][vertex]] = held;
    }
}

// --- Candidates ---

typedef struct wish {
    const search *search;
    uint32_t vertex;
} wish;

// Whether what leaves a vertex where it is leaves the coarse vertex too, and this has all images.
static bool may_choose(const void *data, uint32_t coarse) {
    const wish *w = data;
    const search *s = w->search;
    for (uint32_t n = 1; n < s->symmetries; n++) {
        const uint32_t image = s->coarse_symmetry.images[n][coarse];
        const bool fixed = s->symmetry.images[n][w->vertex] == w->vertex;
        if (image == GIRIH_NO_VERTEX || (fixed && image != coarse)) {
            return false;
        }
    }
    return true;
}

static uint32_t nearest_of(const search *s, uint32_t vertex, girih_near_vertex *found,
                           uint32_t most) {
    const wish w = {s, vertex};
    return girih_vertex_grid_nearest(&s->grid, s->fine->vertices[vertex], may_choose, &w, found,
                                     most);
}

static uint32_t add_candidate(uint32_t *candidates, uint32_t count, uint32_t coarse) {
    for (uint32_t n = 0; n < count; n++) {
        if (candidates[n] == coarse) {
            return count;
        }
    }
    if (count < MOST_CANDIDATES) {
        candidates[count++] = coarse;
    }
    return count;
}

// Whether a symmetry leaves a vertex where it is.
static bool is_on_axis(const search *s, uint32_t vertex) {
    bool on_axis = false;
    for (uint32_t n = 1; n < s->symmetries; n++) {
        on_axis = on_axis || s->symmetry.images[n][vertex] == vertex;
    }
    return on_axis;
}

// The nearest coarse vertices, those of the neighbours, and to stay on an axis.
static uint32_t list_candidates(const search *s, uint32_t vertex,
                                uint32_t candidates[MOST_CANDIDATES]) {
    girih_near_vertex found[NEAREST];
    const wish w = {s, vertex};
    const uint32_t found_count = nearest_of(s, vertex, found, NEAREST);
    uint32_t count = 0;
    if (is_on_axis(s, vertex)) {
        candidates[count++] = GIRIH_NO_VERTEX;
    }
    for (uint32_t n = 0; n < found_count; n++) {
        candidates[count++] = found[n].vertex;
    }
    for (uint32_t n = s->star_begins[vertex]; n < s->star_begins[vertex + 1]; n++) {
        for (uint32_t corner = 0; corner < 3; corner++) {
            const uint32_t neighbour = s->fine->indices[3 * (size_t)s->stars[n] + corner];
            const uint32_t coarse = s->chosen[neighbour];
            if (coarse != GIRIH_NO_VERTEX && may_choose(&w, coarse)) {
                count = add_candidate(candidates, count, coarse);
            }
        }
    }
    return count;
}

typedef struct move {
    uint32_t vertex; // GIRIH_NO_VERTEX: none
    uint32_t coarse;
    int64_t turned_area;
    int64_t stray;
} move;

static bool is_better(const move *a, const move *b) {
    return a->turned_area != b->turned_area ? a->turned_area < b->turned_area : a->stray < b->stray;
}

// Whether a vertex, or an image of it, left this not long ago.
static bool has_left(const search *s, uint32_t vertex, uint32_t coarse) {
    for (uint32_t n = 0; n < LONGEST_LEFT; n++) {
        const left_choice *left = &s->left[n];
        for (uint32_t m = 0; m < s->symmetries && left->until > s->moves; m++) {
            if (left->vertex == s->symmetry.images[m][vertex] &&
                left->coarse == image_of(s, m, coarse)) {
                return true;
            }
        }
    }
    return false;
}

// Tries all of a vertex' candidates and keeps in *best what is better.
static void try_vertex(search *s, uint32_t vertex, move *best) {
    uint32_t candidates[MOST_CANDIDATES];
    const uint32_t count = list_candidates(s, vertex, candidates);
    const uint32_t before = s->chosen[vertex];
    for (uint32_t n = 0; n < count; n++) {
        if (candidates[n] != before && !has_left(s, vertex, candidates[n])) {
            put(s, vertex, candidates[n]);
            const move tried = {vertex, candidates[n], s->turned_area, s->stray};
            if (is_better(&tried, best)) {
                *best = tried;
            }
        }
    }
    put(s, vertex, before);
}

// --- Search ---

// A triangle that is turned over, or one beside it.
static uint32_t choose_triangle(search *s) {
    uint32_t triangle = s->turned[next_random(s) % s->turned_count];
    if (next_random(s) % 4 == 0) {
        const uint32_t corner = s->fine->indices[3 * (size_t)triangle + next_random(s) % 3];
        const uint32_t begin = s->star_begins[corner];
        triangle = s->stars[begin + next_random(s) % (s->star_begins[corner + 1] - begin)];
    }
    return triangle;
}

// At most so many moves until no triangle is turned over. False without memory.
static bool unturn(search *s, uint64_t most) {
    for (uint64_t n = 0; n < most && s->turned_count > 0; n++) {
        const uint32_t triangle = choose_triangle(s);
        move best = {.vertex = GIRIH_NO_VERTEX, .turned_area = INT64_MAX};
        s->moves++;
        for (uint32_t corner = 0; corner < 3; corner++) {
            const uint32_t vertex = s->fine->indices[3 * (size_t)triangle + corner];
            if (vertex >= s->border_count && !s->held[vertex]) {
                try_vertex(s, vertex, &best);
            }
        }
        if (best.vertex != GIRIH_NO_VERTEX) {
            const uint64_t until = s->moves + 2 + next_random(s) % (LONGEST_LEFT - 1);
            s->left[s->moves % LONGEST_LEFT] =
                (left_choice){best.vertex, s->chosen[best.vertex], until};
            if (!change_to(s, best.vertex, best.coarse)) {
                return false;
            }
        }
    }
    s->moves += LONGEST_LEFT; // what was left is free again
    return true;
}

// Moves a vertex to where it strays less and turns nothing over. False without memory.
static bool relax_vertex(search *s, uint32_t vertex, bool *moved) {
    move best = {GIRIH_NO_VERTEX, GIRIH_NO_VERTEX, s->turned_area, s->stray};
    try_vertex(s, vertex, &best);
    if (best.vertex == GIRIH_NO_VERTEX) {
        return true;
    }
    *moved = true;
    return change_to(s, vertex, best.coarse);
}

// The vertices changed since, until none can do better.
static bool relax(search *s, uint32_t since) {
    bool moved = true;
    for (uint32_t sweep = 0; sweep < 16 && moved; sweep++) {
        moved = false;
        const uint32_t end = s->change_count;
        for (uint32_t n = since; n < end; n++) {
            if (!relax_vertex(s, s->changes[n].vertex, &moved)) {
                return false;
            }
        }
    }
    return true;
}

static bool is_inner(const void *data, uint32_t vertex) {
    const search *s = data;
    return vertex >= s->border_count;
}

// Gives a childless vertex a child and mends what that turns over, or takes all of it back where
// more strays than before.
static bool try_child(search *s, uint32_t coarse, uint32_t vertex) {
    const wish w = {s, vertex};
    if (!may_choose(&w, coarse)) {
        return true;
    }
    const uint32_t since = s->change_count;
    const int64_t before = s->stray;
    hold(s, vertex, true);
    bool complete = change_to(s, vertex, coarse) && unturn(s, MOVES_A_CHILD);
    hold(s, vertex, false);
    complete = complete && (s->turned_count > 0 || relax(s, since));
    if (s->turned_count > 0 || s->stray >= before) {
        take_back(s, since);
    }
    return complete;
}

// Tries to give every childless vertex a child.
static bool adopt(search *s, const girih_vertex_grid *fine) {
    bool complete = true;
    for (uint32_t coarse = 0; coarse < s->coarse->vertex_count && complete; coarse++) {
        girih_near_vertex found[CHILDREN_TRIED];
        uint32_t count = 0;
        if (s->children[coarse] == 0) {
            count = girih_vertex_grid_nearest(fine, s->coarse->vertices[coarse], is_inner, s, found,
                                              CHILDREN_TRIED);
        }
        for (uint32_t n = 0; n < count && s->children[coarse] == 0 && complete; n++) {
            complete = try_child(s, coarse, found[n].vertex);
        }
    }
    return complete;
}

// What one has taken from another may be made up for the next time.
static bool adopt_all(search *s) {
    girih_vertex_grid fine;
    bool complete = girih_vertex_grid_create(&fine, s->fine->vertices, s->fine->vertex_count);
    for (uint32_t round = 0; round < ROUNDS_OF_TRIALS && complete; round++) {
        complete = adopt(s, &fine);
    }
    girih_vertex_grid_free(&fine);
    return complete;
}

// --- Beginning ---

static void place_border(search *s) {
    const uint32_t *segments = s->fine->segments;
    const uint32_t *coarser = s->coarse->segments;
    for (uint32_t edge = 0; edge < 3; edge++) {
        for (uint32_t m = 0; m <= segments[edge]; m++) {
            const uint32_t vertex = girih_border_vertex(segments, edge, m);
            if (!stays(m, segments[edge], coarser[edge])) {
                put_one(s, vertex,
                        girih_border_vertex(coarser, edge,
                                            girih_snap(m, segments[edge], coarser[edge])));
            }
        }
    }
}

static void place_inside(search *s) {
    for (uint32_t vertex = s->border_count; vertex < s->fine->vertex_count; vertex++) {
        bool first = true;
        for (uint32_t n = 1; n < s->symmetries; n++) {
            first = first && s->symmetry.images[n][vertex] >= vertex;
        }
        girih_near_vertex nearest;
        if (first && nearest_of(s, vertex, &nearest, 1) == 1 &&
            (s->staying[vertex] == 0 || nearest.distance < s->staying[vertex])) {
            put(s, vertex, nearest.vertex);
        }
    }
}

static void find_stars(search *s) {
    const girih_pattern *fine = s->fine;
    for (size_t n = 0; n < (size_t)fine->triangle_count * 3; n++) {
        s->star_begins[fine->indices[n] + 2]++;
    }
    for (uint32_t n = 0; n < fine->vertex_count; n++) {
        s->star_begins[n + 2] += s->star_begins[n + 1];
    }
    for (size_t n = 0; n < (size_t)fine->triangle_count * 3; n++) {
        s->stars[s->star_begins[fine->indices[n] + 1]++] = (uint32_t)(n / 3);
    }
}

static bool is_other(const void *data, uint32_t vertex) {
    return *(const uint32_t *)data != vertex;
}

static bool is_any(const void *data, uint32_t vertex) {
    (void)data;
    (void)vertex;
    return true;
}

// Before any is chosen: all coarse vertices are childless, and all fine ones stay.
static void set_prices(search *s) {
    girih_near_vertex nearest;
    for (uint32_t n = 0; n < s->coarse->vertex_count; n++) {
        girih_vertex_grid_nearest(&s->grid, s->coarse->vertices[n], is_other, &n, &nearest, 1);
        s->prices[n] = PRICE_OF_CHILDLESS * nearest.distance;
        s->stray += s->prices[n];
    }
    for (uint32_t n = s->border_count; n < s->fine->vertex_count; n++) {
        if (is_on_axis(s, n)) {
            girih_vertex_grid_nearest(&s->grid, s->fine->vertices[n], is_any, NULL, &nearest, 1);
            s->staying[n] = s->prices[nearest.vertex];
            s->stray += s->staying[n];
        }
    }
}

static girih_result create(search *s, const girih_pattern *fine, const girih_pattern *coarse,
                           uint32_t *parents, girih_error *error) {
    const size_t vertices = fine->vertex_count;
    const size_t triangles = fine->triangle_count;
    *s = (search){
        .fine = fine,
        .coarse = coarse,
        .border_count = girih_border_count(fine->segments),
        .parents = parents,
        .star_begins = calloc(vertices + 2, sizeof *s->star_begins),
        .stars = calloc(3 * triangles, sizeof *s->stars),
        .chosen = malloc(vertices * sizeof *s->chosen),
        .children = calloc(coarse->vertex_count, sizeof *s->children),
        .prices = calloc(coarse->vertex_count, sizeof *s->prices),
        .staying = calloc(vertices, sizeof *s->staying),
        .areas = calloc(triangles, sizeof *s->areas),
        .turned = calloc(triangles, sizeof *s->turned),
        .turned_places = calloc(triangles, sizeof *s->turned_places),
        .held = calloc(vertices, sizeof *s->held),
        .random = UINT64_C(88172645463325252),
    };
    girih_result result = girih_symmetry_find(fine, &s->symmetry, error);
    if (result == GIRIH_OK) {
        result = girih_symmetry_apply(&s->symmetry, coarse, &s->coarse_symmetry, error);
    }
    s->symmetries = s->symmetry.count;
    const bool complete =
        s->star_begins && s->stars && s->chosen && s->children && s->prices && s->staying &&
        s->areas && s->turned && s->turned_places && s->held &&
        girih_vertex_grid_create(&s->grid, coarse->vertices, coarse->vertex_count);
    if (result == GIRIH_OK && !complete) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                            "no memory for the parents of %u vertices", fine->vertex_count);
    }
    return result;
}

static void release(search *s) {
    girih_symmetry_free(&s->symmetry);
    girih_symmetry_free(&s->coarse_symmetry);
    girih_vertex_grid_free(&s->grid);
    free(s->star_begins);
    free(s->stars);
    free(s->chosen);
    free(s->children);
    free(s->prices);
    free(s->staying);
    free(s->areas);
    free(s->turned);
    free(s->turned_places);
    free(s->held);
    free(s->changes);
}

// The inner vertices that hang together with one, itself the first, and a coarse vertex that a
// border vertex beside them has chosen.
static uint32_t flood(const search *s, uint32_t vertex, uint32_t *found, bool *reached,
                      uint32_t *coarse) {
    uint32_t count = 1;
    found[0] = vertex;
    reached[vertex] = true;
    for (uint32_t next = 0; next < count; next++) {
        for (uint32_t n = s->star_begins[found[next]]; n < s->star_begins[found[next] + 1]; n++) {
            for (uint32_t corner = 0; corner < 3; corner++) {
                const uint32_t neighbour = s->fine->indices[3 * (size_t)s->stars[n] + corner];
                if (neighbour < s->border_count) {
                    *coarse = *coarse == GIRIH_NO_VERTEX ? s->chosen[neighbour] : *coarse;
                } else if (!reached[neighbour]) {
                    reached[neighbour] = true;
                    found[count++] = neighbour;
                }
            }
        }
    }
    return count;
}

// What turns no triangle over, whatever the pattern: inner vertices that hang together all go where
// one border vertex beside them goes, since the border keeps its order. Where all of these stay, so
// do they. It keeps no symmetry.
static bool collapse(search *s) {
    s->symmetries = 1;
    uint32_t *found = malloc(s->fine->vertex_count * sizeof *found);
    bool *reached = calloc(s->fine->vertex_count, sizeof *reached);
    bool complete = found && reached;
    for (uint32_t vertex = s->border_count; complete && vertex < s->fine->vertex_count; vertex++) {
        uint32_t coarse = GIRIH_NO_VERTEX;
        const uint32_t count = reached[vertex] ? 0 : flood(s, vertex, found, reached, &coarse);
        for (uint32_t n = 0; n < count && complete; n++) {
            complete = change_to(s, found[n], coarse);
        }
    }
    free(found);
    free(reached);
    return complete;
}

static bool run(search *s) {
    memcpy(s->parents, s->fine->vertices, s->fine->vertex_count * sizeof *s->parents);
    for (uint32_t n = 0; n < s->fine->vertex_count; n++) {
        s->chosen[n] = GIRIH_NO_VERTEX;
    }
    find_stars(s);
    set_prices(s);
    place_border(s);
    place_inside(s);
    bool complete = unturn(s, FIRST_MOVES + MOVES_A_TRIANGLE * (uint64_t)s->turned_count);
    if (complete && s->turned_count > 0) {
        complete = collapse(s);
    }
    return complete && relax(s, 0) && adopt_all(s);
}

girih_result girih_parents_find(const girih_pattern *fine, const girih_pattern *coarse,
                                uint32_t *parents, girih_error *error) {
    search s;
    girih_result result = create(&s, fine, coarse, parents, error);
    if (result == GIRIH_OK && !run(&s)) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                            "no memory for the parents of %u vertices", fine->vertex_count);
    }
    release(&s);
    return result;
}
