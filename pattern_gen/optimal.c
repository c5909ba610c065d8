// The family `optimal`: vertices where the spacing of the three borders suggests them, triangles as little flat as can
// be found, few of them.
//
// From one point that is joined to the whole border, points are put into the edges that are longest against the
// spacing at their place. Now and then all points are moved to where the triangles around them are least flat and
// edges are flipped likewise, by an energy in which the smallest angles count more and more; where a pattern's smallest
// angle stays far below what its corners allow, points near it are thrown about and settle anew. Of all that were
// looked at on the way from few points to many, the pattern is kept whose smallest angle is large for its number of
// triangles and whose edges are between half and double the spacing.
//
// Random numbers have a seed and computing is in IEEE double precision without functions that machines round
// differently, so the same pattern comes out everywhere.
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "error.h"
#include "family.h"
#include "spacing.h"
#include "triangulation.h"

// The energy's powers: all angles, then the smaller ones, then the smallest alone.
#define FIRST_POWER 4u
#define LAST_POWER 64u

// Points rest when their steps are this part of the finest border's spacing.
#define SMALLEST_STEP (1.0 / 48)

// Kicks in a row without a better smallest angle before a pattern is taken as it is: more of them while the angle is
// far from what the corners allow. And triangles of all kicks together.
#define FRUITLESS_KICKS 40u
#define FRUITLESS_KICKS_AT_LAST 80u
#define FAR_FROM_BOUND 0.75
#define KICKED_TRIANGLES 60000u

// What costs so much more than the best found so far will not become better by being kicked.
#define WORTH_KICKING 1.5

// Ways to grow that are tried, as long as not so many triangles have been settled in all.
#define WAYS 9u
#define SETTLED_TRIANGLES 3000000u

#define SHARE_OF_SPLITS 0.25

// What is looked at on the way has this many points more than what was looked at before.
#define GROWTH 0.06
#define LARGE_GROWTH 0.5
#define LARGE_PATTERN 2000u

typedef struct long_edge {
    double ratio; // to the spacing
    uint32_t a;
    uint32_t b;
} long_edge;

typedef struct measured {
    double sine; // of the smallest angle
    double shortest; // inner edge, in units of the spacing
    double longest;
    double cost;
} measured;

typedef struct search {
    girih_spacing_field spacing;
    double bound; // the sine of the angle that the corners allow
    uint32_t most_triangles;
    uint64_t random;
    double smallest_step;
    uint64_t settled_triangles;
    girih_triangulation growing;
    girih_triangulation settled; // the best that came of it
    girih_triangulation kicked;
    girih_triangulation tried;
    girih_triangulation best; // of all
    measured least;           // what it is like
    long_edge *edges;
} search;

// The sine of an angle of which sqrt(3) times the cotangent is given.
static double sine_of(double flatness) {
    return sqrt(3 / (3 + flatness * flatness));
}

// xorshift64 (Marsaglia 2003), in [0, 1).
static double next_random(search *s) {
    s->random ^= s->random << 13;
    s->random ^= s->random >> 7;
    s->random ^= s->random << 17;
    return (double)(s->random >> 11) / 9007199254740992.0;
}

// Every inner edge once, with its ratio, in s->edges.
static uint32_t list_edges(search *s, const girih_triangulation *t) {
    uint32_t count = 0;
    for (uint32_t n = 0; n < t->triangle_count; n++) {
        for (uint32_t edge = 0; edge < 3; edge++) {
            const uint32_t across = t->triangles[n].neighbours[edge];
            if (across != GIRIH_NO_TRIANGLE && across > n) {
                const uint32_t a = t->triangles[n].vertices[edge];
                const uint32_t b = t->triangles[n].vertices[(edge + 1) % 3];
                s->edges[count++] = (long_edge){girih_spacing_ratio(&s->spacing, t->points[a].weights, t->points[b].weights), a, b};
            }
        }
    }
    return count;
}

static int compare_edges(const void *left, const void *right) {
    const long_edge *a = left;
    const long_edge *b = right;
    if (a->ratio > b->ratio || a->ratio < b->ratio) {
        return a->ratio > b->ratio ? -1 : 1;
    }
    return a->a != b->a ? (a->a > b->a) - (a->a < b->a) : (a->b > b->b) - (a->b < b->b);
}

static double cost_of_triangles(const girih_triangulation *t) {
    return 3 * girih_logarithm(t->triangle_count);
}

// What the search makes small. A third more angle is worth a tenth of the triangles; less than nine tenths of what the
// corners allow costs more; edges out of proportion are not wanted at all.
static measured measure(search *s, const girih_triangulation *t) {
    measured m = {.sine = sine_of(girih_triangulation_flatness(t, NULL)), .shortest = INFINITY};
    const uint32_t count = list_edges(s, t);
    for (uint32_t n = 0; n < count; n++) {
        const double ratio = s->edges[n].ratio;
        m.shortest = ratio < m.shortest ? ratio : m.shortest;
        m.longest = ratio > m.longest ? ratio : m.longest;
    }
    const double share = m.sine / s->bound;
    m.cost = cost_of_triangles(t) - girih_logarithm(share);
    m.cost += share < 0.9 ? 6 * (0.9 - share) : 0;
    m.cost += t->triangle_count > s->most_triangles ? INFINITY : 0;
    m.cost += m.shortest < GIRIH_SHORTEST_EVEN ? 20 * (GIRIH_SHORTEST_EVEN - m.shortest) + 2 : 0;
    m.cost += m.longest > GIRIH_LONGEST_EVEN ? 10 * (m.longest - GIRIH_LONGEST_EVEN) + 2 : 0;
    return m;
}

static void wake(const search *s, girih_triangulation *t) {
    for (uint32_t n = t->border_count; n < t->point_count; n++) {
        const double step = GIRIH_BARYCENTRIC_ONE / 8 * girih_spacing_at(&s->spacing, t->points[n].weights);
        t->steps[n] = t->steps[n] > step ? t->steps[n] : step;
    }
}

// Moves points until they rest, at most `sweeps` times each.
static void settle(search *s, girih_triangulation *t, uint32_t power, uint32_t sweeps) {
    t->power = power;
    s->settled_triangles += t->triangle_count;
    bool awake = true;
    for (uint32_t sweep = 0; sweep < sweeps && awake; sweep++) {
        awake = false;
        for (uint32_t n = t->border_count; n < t->point_count; n++) {
            if (n <= t->mirrors[n]) {
                girih_triangulation_move(t, n, s->smallest_step);
                awake = awake || floor(t->steps[n]) >= s->smallest_step;
            }
        }
    }
}

// Settles what has grown by one power after the other and leaves the least costly in s->settled: the last power makes
// the smallest angle largest, at the price of all others and of the spacing.
static measured settle_fully(search *s) {
    const uint32_t sweeps = s->growing.point_count < LARGE_PATTERN ? 60 : 20;
    measured best = {.cost = INFINITY};
    girih_triangulation_copy(&s->tried, &s->growing);
    for (uint32_t power = FIRST_POWER; power <= LAST_POWER; power *= 4) {
        wake(s, &s->tried);
        settle(s, &s->tried, power, sweeps);
        const measured found = measure(s, &s->tried);
        if (found.cost < best.cost) {
            best = found;
            girih_triangulation_copy(&s->settled, &s->tried);
        }
    }
    return best;
}

// Throws up to three points beside the flattest triangle about, or puts another one into one of its edges: where a fan
// has too few triangles, moving them does not help.
static void kick(search *s, girih_triangulation *t) {
    uint32_t flattest = 0;
    girih_triangulation_flatness(t, &flattest);
    if (next_random(s) < SHARE_OF_SPLITS) {
        girih_triangulation_split(t, flattest, (uint32_t)(next_random(s) * 3));
        girih_triangulation_flip_all(t);
        return;
    }
    for (int tries = 0; tries < 3; tries++) {
        const uint32_t corner = t->triangles[flattest].vertices[(int)(next_random(s) * 3)];
        const uint32_t count = girih_triangulation_star(t, corner);
        const uint32_t triangle = t->around[(uint32_t)(next_random(s) * count)];
        const uint32_t point = t->triangles[triangle].vertices[(int)(next_random(s) * 3)];
        const double u = 2 * next_random(s) - 1;
        const double v = 2 * next_random(s) - 1;
        const double far = next_random(s);
        if (point < t->border_count) {
            continue;
        }
        girih_point place = t->points[point];
        // From a tenth of the spacing to all of it.
        const double share = 0.1 + 0.9 * far * far;
        const double reach = share * GIRIH_BARYCENTRIC_ONE * girih_spacing_at(&s->spacing, place.weights);
        place.weights[0] += floor(u * reach);
        place.weights[1] += floor(v * reach);
        place.weights[2] = GIRIH_BARYCENTRIC_ONE - place.weights[0] - place.weights[1];
        girih_triangulation_set(t, point, place);
        // Of a point and its mirror image the one with the lower number is moved.
        t->steps[point] = reach / 2;
        t->steps[t->mirrors[point]] = reach / 2;
    }
    girih_triangulation_flip_all(t);
}

// Kicks what is in s->settled while its smallest angle is less than the corners allow, and leaves the least costly
// there.
static measured kick_on(search *s, measured best) {
    uint32_t left = KICKED_TRIANGLES / s->settled.triangle_count;
    if (left == 0) {
        return best;
    }
    girih_triangulation_copy(&s->kicked, &s->settled);
    s->kicked.power = LAST_POWER;
    double flatness = girih_triangulation_flatness(&s->kicked, NULL);
    for (uint32_t fruitless = 0; left > 0; left--) {
        const bool far = best.sine < FAR_FROM_BOUND * s->bound;
        if (fruitless >= (far ? FRUITLESS_KICKS_AT_LAST : FRUITLESS_KICKS) ||
            (best.sine > 0.9 * s->bound && best.shortest >= GIRIH_SHORTEST_EVEN)) {
            break;
        }
        fruitless++;
        girih_triangulation_copy(&s->tried, &s->kicked);
        kick(s, &s->tried);
        settle(s, &s->tried, LAST_POWER, 60);
        const double after = girih_triangulation_flatness(&s->tried, NULL);
        if (after > flatness) {
            continue;
        }
        fruitless = after < 0.999 * flatness ? 0 : fruitless;
        flatness = after;
        girih_triangulation_copy(&s->kicked, &s->tried);
        const measured found = measure(s, &s->tried);
        if (found.cost < best.cost) {
            best = found;
            girih_triangulation_copy(&s->settled, &s->tried);
        }
    }
    return best;
}

// Splits the edge from a to b; false where it is gone, split with its mirror image.
static bool split_edge(girih_triangulation *t, uint32_t a, uint32_t b) {
    uint32_t edge = 0;
    const uint32_t triangle = girih_triangulation_find_edge(t, a, b, &edge);
    return triangle != GIRIH_NO_TRIANGLE && girih_triangulation_split(t, triangle, edge);
}

// Splits the longest edges, one in twenty points at once; `noise` times a random number makes some of them longer. False
// where there is no more room, or nothing that can be split.
static bool grow(search *s, uint32_t power, double noise) {
    girih_triangulation *t = &s->growing;
    const uint32_t count = list_edges(s, t);
    for (uint32_t n = 0; n < count && noise > 0; n++) {
        s->edges[n].ratio *= 1 + noise * next_random(s);
    }
    qsort(s->edges, count, sizeof *s->edges, compare_edges);
    const uint32_t wanted = 1 + (t->point_count - t->border_count) / 20;
    uint32_t split = 0;
    for (uint32_t n = 0; n < count && split < wanted; n++) {
        split += split_edge(t, s->edges[n].a, s->edges[n].b) ? 1 : 0;
    }
    girih_triangulation_flip_all(t);
    settle(s, t, power, 2);
    return split > 0;
}

// Grows from one point on, settling by a power on the way, and leaves the least costly in s->best.
static void grow_and_look(search *s, uint32_t power, double noise) {
    double next = 0;
    girih_triangulation_restart(&s->growing, power);
    girih_triangulation_flip_all(&s->growing);
    do {
        const uint32_t inside = s->growing.point_count - s->growing.border_count;
        // With so many triangles not even the angle that the corners allow would cost less.
        if (s->growing.triangle_count > s->most_triangles ||
            cost_of_triangles(&s->growing) > s->least.cost) {
            break;
        }
        if (inside < next) {
            continue;
        }
        settle(s, &s->growing, power, 60);
        // Too few points to be settled, unless it may be the only chance.
        if (measure(s, &s->growing).longest > 2.6 &&
            s->growing.triangle_count + 2 < s->most_triangles) {
            continue;
        }
        next = inside * (1 + (inside < LARGE_PATTERN ? GROWTH : LARGE_GROWTH));
        measured found = settle_fully(s);
        if (found.cost < s->least.cost + WORTH_KICKING) {
            found = kick_on(s, found);
        }
        if (found.cost < s->least.cost) {
            s->least = found;
            girih_triangulation_copy(&s->best, &s->settled);
        }
    } while (grow(s, power, noise));
}

static bool is_good(const search *s) {
    return s->least.sine >= FAR_FROM_BOUND * s->bound && s->least.shortest >= GIRIH_SHORTEST_EVEN &&
           s->least.longest <= GIRIH_LONGEST_EVEN;
}

// Where points are while there are few decides how many triangles meet at the corners. Where the first way leaves the
// smallest angle far from what the corners allow, or edges out of proportion, others are tried.
static void find_best(search *s) {
    uint32_t power = FIRST_POWER;
    for (uint32_t way = 0;
         way == 0 || (way < WAYS && !is_good(s) && s->settled_triangles < SETTLED_TRIANGLES); way++) {
        grow_and_look(s, power, way < 3 ? 0 : 0.4);
        power = power == LAST_POWER ? FIRST_POWER : power * 4;
    }
}

static girih_result create_search(search *s, const uint32_t segments[3], uint32_t seed, girih_error *error) {
    const uint32_t n = segments[0];
    *s = (search){
        .spacing = girih_spacing_create(segments),
        .bound = sine_of(girih_pattern_bound(segments)),
        .most_triangles = n * n + girih_border_count(segments) - 3 * n,
        .random = 88172645463325252u + seed * UINT64_C(0x9e3779b97f4a7c15),
        .least = {.cost = INFINITY},
        .smallest_step = SMALLEST_STEP * GIRIH_BARYCENTRIC_ONE / n,
    };
    s->smallest_step = s->smallest_step > 1 ? s->smallest_step : 1;
    const uint32_t inside = (n - 1) * (n - 2) / 2 + 2;
    girih_triangulation *all[] = {&s->growing, &s->settled, &s->kicked, &s->tried, &s->best};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        const girih_result result = girih_triangulation_create(all[k], segments, inside, error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    // Fewer edges than three for every point (Euler).
    const size_t edges = 3 * (size_t)s->growing.capacity;
    s->edges = malloc(edges * sizeof *s->edges);
    return s->edges ? GIRIH_OK
                    : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu edges", edges);
}

static void free_search(search *s) {
    girih_triangulation_free(&s->growing);
    girih_triangulation_free(&s->settled);
    girih_triangulation_free(&s->kicked);
    girih_triangulation_free(&s->tried);
    girih_triangulation_free(&s->best);
    free(s->edges);
}

static girih_result take(const girih_triangulation *t, girih_pattern *pattern, girih_error *error) {
    const girih_result result =
        girih_pattern_allocate(pattern, t->segments, t->point_count, t->triangle_count, error);
    if (result != GIRIH_OK) {
        return result;
    }
    for (uint32_t n = t->border_count; n < t->point_count; n++) {
        pattern->vertices[n] =
            girih_pack_vertex((uint32_t)t->points[n].weights[0], (uint32_t)t->points[n].weights[1]);
    }
    for (uint32_t n = 0; n < t->triangle_count; n++) {
        for (uint32_t corner = 0; corner < 3; corner++) {
            pattern->indices[3 * n + corner] = t->triangles[n].vertices[corner];
        }
    }
    return GIRIH_OK;
}

// The vertex (a, b, c) / n of the regular grid, rounded so that whoever permutes the weights permutes the result. Of
// two equal weights that are the largest both give way to the third: it is rounded so that they can stay equal.
static uint32_t grid_position(uint32_t n, const uint32_t steps[3]) {
    uint32_t weights[3];
    uint32_t rest = GIRIH_BARYCENTRIC_ONE;
    uint32_t largest = 0;
    for (uint32_t k = 0; k < 3; k++) {
        largest = steps[k] > steps[largest] ? k : largest;
        weights[k] = girih_edge_parameter(steps[k], n);
        rest -= weights[k];
    }
    const uint32_t a = (largest + 1) % 3;
    const uint32_t b = (largest + 2) % 3;
    if (steps[a] == steps[b] && steps[a] == steps[largest]) {
        return girih_pack_vertex(10923, 10923);
    }
    if (steps[a] != steps[largest] && steps[b] != steps[largest]) {
        weights[largest] += rest;
    } else {
        const uint32_t other = steps[a] == steps[largest] ? b : a;
        const uint32_t equal = 3 - largest - other;
        weights[other] = 2 * ((steps[other] * GIRIH_BARYCENTRIC_ONE + n) / (2 * n));
        weights[largest] = (GIRIH_BARYCENTRIC_ONE - weights[other]) / 2;
        weights[equal] = weights[largest];
    }
    return girih_pack_vertex(weights[0], weights[1]);
}

// All edges alike: the regular grid, as the family `uniform` has it, symmetric in all three ways.
static girih_result build_grid(const uint32_t segments[3], girih_pattern *pattern, girih_error *error) {
    const uint32_t n = segments[0];
    const girih_result result = girih_family_uniform.build(&girih_family_uniform, segments, pattern, error);
    uint32_t vertex = girih_border_count(segments);
    for (uint32_t c = 1; c + 1 < n && result == GIRIH_OK; c++) {
        for (uint32_t b = 1; b + c < n; b++) {
            pattern->vertices[vertex++] = grid_position(n, (uint32_t[3]){n - b - c, b, c});
        }
    }
    return result;
}

static girih_result build(const girih_family *family, const uint32_t segments[3], girih_pattern *pattern,
                          girih_error *error) {
    if (segments[0] == segments[2]) {
        return build_grid(segments, pattern, error);
    }
    // Nothing to choose.
    if (segments[0] == 2) {
        return girih_family_uniform.build(&girih_family_uniform, segments, pattern, error);
    }
    search s;
    girih_result result = create_search(&s, segments, family->data ? *(const uint32_t *)family->data : 0, error);
    if (result == GIRIH_OK) {
        find_best(&s);
        result = take(&s.best, pattern, error);
    } else {
        *pattern = (girih_pattern){.vertex_count = 0};
    }
    free_search(&s);
    return result;
}

const girih_family girih_family_optimal = {
    .name = "optimal",
    .summary = "few triangles, as little flat as their borders allow, that grow from the fine edges to the coarse",
    .build = build,
};
