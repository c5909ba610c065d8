#include "triangulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

static const double one = GIRIH_BARYCENTRIC_ONE;

// Twice the area over that of the whole, in units of 1 / 32768^2.
static double determinant(const girih_point *a, const girih_point *b, const girih_point *c) {
    return (b->weights[0] - a->weights[0]) * (c->weights[1] - a->weights[1]) -
           (c->weights[0] - a->weights[0]) * (b->weights[1] - a->weights[1]);
}

// Twice the square of the distance in an equilateral whole with sides of 1.
static double squared_distance(const girih_point *a, const girih_point *b) {
    double sum = 0;
    for (int n = 0; n < 3; n++) {
        const double difference = b->weights[n] - a->weights[n];
        sum += difference * difference;
    }
    return sum;
}

// The largest cotangent, times sqrt(3): of the angle across from the shortest side, dot = (the squares of the two sides
// beside it - the square of the shortest) / 2.
static double flatness_of(const girih_point *a, const girih_point *b, const girih_point *c, double area) {
    const double ab = squared_distance(a, b);
    const double bc = squared_distance(b, c);
    const double ca = squared_distance(c, a);
    double shortest = ab < bc ? ab : bc;
    shortest = ca < shortest ? ca : shortest;
    return (0.5 * (ab + bc + ca) - shortest) / area;
}

static double energy_of(const girih_point *a, const girih_point *b, const girih_point *c, uint32_t power) {
    const double area = determinant(a, b, c);
    if (area <= 0) {
        return INFINITY;
    }
    double value = flatness_of(a, b, c, area);
    for (uint32_t p = power; p > 1; p /= 2) {
        value *= value;
    }
    return value;
}

static double corner_energy(const girih_triangulation *t, uint32_t a, uint32_t b, uint32_t c) {
    return energy_of(&t->points[a], &t->points[b], &t->points[c], t->power);
}

static double triangle_energy(const girih_triangulation *t, uint32_t triangle) {
    const uint32_t *v = t->triangles[triangle].vertices;
    return corner_energy(t, v[0], v[1], v[2]);
}

static double triangle_flatness(const girih_triangulation *t, uint32_t triangle) {
    const uint32_t *v = t->triangles[triangle].vertices;
    const girih_point *p = t->points;
    const double area = determinant(&p[v[0]], &p[v[1]], &p[v[2]]);
    return area > 0 ? flatness_of(&p[v[0]], &p[v[1]], &p[v[2]], area) : INFINITY;
}

double girih_triangulation_flatness(const girih_triangulation *t, uint32_t *triangle) {
    double largest = 0;
    for (uint32_t n = 0; n < t->triangle_count; n++) {
        const double flatness = triangle_flatness(t, n);
        if (flatness > largest) {
            largest = flatness;
            if (triangle) {
                *triangle = n;
            }
        }
    }
    return largest;
}

// --- Mirror images ------------------------------------------------------------------------------------------------

static girih_point mirrored(const girih_triangulation *t, girih_point p) {
    if (t->symmetry_corner >= 0) {
        const int a = (t->symmetry_corner + 1) % 3;
        const int b = (t->symmetry_corner + 2) % 3;
        const double kept = p.weights[a];
        p.weights[a] = p.weights[b];
        p.weights[b] = kept;
    }
    return p;
}

// The place on the axis next to p: the axis' own weight is even, so that the other two can be equal.
static girih_point onto_axis(const girih_triangulation *t, girih_point p) {
    const int corner = t->symmetry_corner;
    p.weights[corner] = 2 * floor(p.weights[corner] / 2);
    p.weights[(corner + 1) % 3] = (one - p.weights[corner]) / 2;
    p.weights[(corner + 2) % 3] = p.weights[(corner + 1) % 3];
    return p;
}

static void put(girih_triangulation *t, uint32_t point, girih_point place) {
    t->points[point] = place;
    if (t->mirrors[point] != point) {
        t->points[t->mirrors[point]] = mirrored(t, place);
    }
}

static bool on_axis(const girih_triangulation *t, uint32_t point) {
    return t->symmetry_corner >= 0 && t->mirrors[point] == point;
}

// --- Topology -----------------------------------------------------------------------------------------------------

static uint32_t corner_of(const girih_corner_triangle *triangle, uint32_t point) {
    return triangle->vertices[0] == point ? 0 : triangle->vertices[1] == point ? 1 : 2;
}

uint32_t girih_triangulation_star(const girih_triangulation *t, uint32_t point) {
    uint32_t count = 0;
    const uint32_t first = t->incident[point];
    uint32_t here = first;
    // Around one way; a point of the border needs the other way too.
    do {
        t->around[count++] = here;
        here = t->triangles[here].neighbours[(corner_of(&t->triangles[here], point) + 2) % 3];
    } while (here != first && here != GIRIH_NO_TRIANGLE);
    if (here == GIRIH_NO_TRIANGLE) {
        here = t->triangles[first].neighbours[corner_of(&t->triangles[first], point)];
        while (here != GIRIH_NO_TRIANGLE) {
            t->around[count++] = here;
            here = t->triangles[here].neighbours[corner_of(&t->triangles[here], point)];
        }
    }
    return count;
}

uint32_t girih_triangulation_find_edge(const girih_triangulation *t, uint32_t a, uint32_t b, uint32_t *edge) {
    const uint32_t count = girih_triangulation_star(t, a);
    for (uint32_t n = 0; n < count; n++) {
        const girih_corner_triangle *triangle = &t->triangles[t->around[n]];
        const uint32_t corner = corner_of(triangle, a);
        if (triangle->vertices[(corner + 1) % 3] == b) {
            *edge = corner;
            return t->around[n];
        }
    }
    return GIRIH_NO_TRIANGLE;
}

static void replace_neighbour(girih_triangulation *t, uint32_t triangle, uint32_t old, uint32_t new) {
    for (int edge = 0; edge < 3 && triangle != GIRIH_NO_TRIANGLE; edge++) {
        if (t->triangles[triangle].neighbours[edge] == old) {
            t->triangles[triangle].neighbours[edge] = new;
            return;
        }
    }
}

static void set_triangle(girih_triangulation *t, uint32_t here, uint32_t a, uint32_t b, uint32_t c, uint32_t ab,
                         uint32_t bc, uint32_t ca) {
    t->triangles[here] = (girih_corner_triangle){{a, b, c}, {ab, bc, ca}};
    t->incident[a] = here;
    t->incident[b] = here;
    t->incident[c] = here;
}

// Two triangles that share the edge from a to b: the left one has c, the right one d.
typedef struct quadrilateral {
    uint32_t left;
    uint32_t right;
    uint32_t a;
    uint32_t b;
    uint32_t c;
    uint32_t d;
    uint32_t bc; // what lies across the outer edges
    uint32_t ca;
    uint32_t ad;
    uint32_t db;
} quadrilateral;

static bool find_quadrilateral(const girih_triangulation *t, uint32_t triangle, uint32_t edge, quadrilateral *q) {
    const girih_corner_triangle *left = &t->triangles[triangle];
    q->left = triangle;
    q->right = left->neighbours[edge];
    if (q->right == GIRIH_NO_TRIANGLE) {
        return false;
    }
    q->a = left->vertices[edge];
    q->b = left->vertices[(edge + 1) % 3];
    q->c = left->vertices[(edge + 2) % 3];
    q->bc = left->neighbours[(edge + 1) % 3];
    q->ca = left->neighbours[(edge + 2) % 3];
    const girih_corner_triangle *right = &t->triangles[q->right];
    const uint32_t a = corner_of(right, q->a);
    q->d = right->vertices[(a + 1) % 3];
    q->ad = right->neighbours[a];
    q->db = right->neighbours[(a + 1) % 3];
    return true;
}

static void flip_quadrilateral(girih_triangulation *t, const quadrilateral *q) {
    replace_neighbour(t, q->ad, q->right, q->left);
    replace_neighbour(t, q->bc, q->left, q->right);
    set_triangle(t, q->left, q->c, q->a, q->d, q->ca, q->ad, q->right);
    set_triangle(t, q->right, q->d, q->b, q->c, q->db, q->bc, q->left);
}

// Whether an edge's two triangles have a mirror image apart from themselves. *shared: the two have a triangle in
// common, so that one cannot be changed without the other.
static bool has_image(const girih_triangulation *t, const quadrilateral *q, bool *shared) {
    const uint32_t a = t->mirrors[q->a];
    const uint32_t b = t->mirrors[q->b];
    *shared = false;
    if (t->symmetry_corner < 0 || (a == q->a && b == q->b) || (a == q->b && b == q->a)) {
        return false;
    }
    uint32_t edge = 0;
    const uint32_t image = girih_triangulation_find_edge(t, b, a, &edge);
    const uint32_t across = t->triangles[image].neighbours[edge];
    *shared = image == q->left || image == q->right || across == q->left || across == q->right;
    return true;
}

// The mirror image of a quadrilateral that has one and was already changed: its outer neighbours may be new.
static quadrilateral image_of(const girih_triangulation *t, const quadrilateral *q) {
    quadrilateral image;
    uint32_t edge = 0;
    const uint32_t triangle = girih_triangulation_find_edge(t, t->mirrors[q->b], t->mirrors[q->a], &edge);
    find_quadrilateral(t, triangle, edge, &image);
    return image;
}

static bool can_flip(const girih_triangulation *t, const quadrilateral *q) {
    const girih_point *p = t->points;
    return determinant(&p[q->c], &p[q->a], &p[q->d]) > 0 && determinant(&p[q->d], &p[q->b], &p[q->c]) > 0;
}

// Flips an edge and its mirror image where that lowers the energy. False where nothing was flipped.
static bool flip(girih_triangulation *t, uint32_t triangle, uint32_t edge) {
    quadrilateral q;
    if (!find_quadrilateral(t, triangle, edge, &q) || !can_flip(t, &q)) {
        return false;
    }
    const double now = corner_energy(t, q.a, q.b, q.c) + corner_energy(t, q.b, q.a, q.d);
    const double then = corner_energy(t, q.c, q.a, q.d) + corner_energy(t, q.d, q.b, q.c);
    // By more than rounding, or two that are as good would flip forever.
    if (!(then < now * (1 - 1e-9))) {
        return false;
    }
    bool shared;
    const bool twice = has_image(t, &q, &shared);
    if (shared) {
        return false;
    }
    flip_quadrilateral(t, &q);
    if (twice) {
        const quadrilateral image = image_of(t, &q);
        flip_quadrilateral(t, &image);
    }
    return true;
}

void girih_triangulation_flip_all(girih_triangulation *t) {
    // Each flip lowers the energy, so this ends; long cascades wait for the next time.
    for (uint32_t turn = 0; turn < 64; turn++) {
        bool flipped = false;
        for (uint32_t n = 0; n < t->triangle_count; n++) {
            for (uint32_t edge = 0; edge < 3; edge++) {
                flipped = flip(t, n, edge) || flipped;
            }
        }
        if (!flipped) {
            return;
        }
    }
}

// --- Points -------------------------------------------------------------------------------------------------------

// The star's energy, of which what holds the mirror image too counts once where all else counts twice. Not all of it
// where it is more than `limit` already.
static double star_energy(const girih_triangulation *t, uint32_t point, uint32_t count, double limit) {
    const uint32_t mirror = t->mirrors[point];
    double sum = 0;
    for (uint32_t n = 0; n < count && sum < limit; n++) {
        const girih_corner_triangle *triangle = &t->triangles[t->around[n]];
        const bool both = mirror != point && triangle->vertices[corner_of(triangle, mirror)] == mirror;
        const double energy = triangle_energy(t, t->around[n]);
        sum += both ? energy : 2 * energy;
    }
    return sum;
}

bool girih_triangulation_set(girih_triangulation *t, uint32_t point, girih_point place) {
    const girih_point kept = t->points[point];
    const uint32_t count = girih_triangulation_star(t, point);
    put(t, point, on_axis(t, point) ? onto_axis(t, place) : place);
    if (isinf(star_energy(t, point, count, INFINITY))) {
        put(t, point, kept);
        return false;
    }
    return true;
}

// Six directions of the regular grid; on the axis the two along it.
static girih_point moved(const girih_triangulation *t, uint32_t point, int direction, double step) {
    girih_point p = t->points[point];
    const double signed_step = direction % 2 == 0 ? step : -step;
    if (on_axis(t, point)) {
        const int corner = t->symmetry_corner;
        p.weights[corner] += 2 * signed_step;
        p.weights[(corner + 1) % 3] -= signed_step;
        p.weights[(corner + 2) % 3] -= signed_step;
    } else {
        p.weights[direction / 2] += signed_step;
        p.weights[(direction / 2 + 1) % 3] -= signed_step;
    }
    return p;
}

// The neighbours of a point that moved by `step` are not where they would be best any more.
static void wake_neighbours(girih_triangulation *t, uint32_t count, double step) {
    for (uint32_t n = 0; n < count; n++) {
        for (int corner = 0; corner < 3; corner++) {
            const uint32_t neighbour = t->triangles[t->around[n]].vertices[corner];
            const uint32_t image = t->mirrors[neighbour];
            t->steps[neighbour] = t->steps[neighbour] > step / 2 ? t->steps[neighbour] : step / 2;
            t->steps[image] = t->steps[neighbour];
        }
    }
}

static void flip_around(girih_triangulation *t, uint32_t point) {
    const uint32_t count = girih_triangulation_star(t, point);
    for (uint32_t n = 0; n < count; n++) {
        for (uint32_t edge = 0; edge < 3; edge++) {
            if (flip(t, t->around[n], edge)) {
                return;
            }
            // Looking for a mirror image has overwritten the list.
            girih_triangulation_star(t, point);
        }
    }
}

bool girih_triangulation_move(girih_triangulation *t, uint32_t point, double smallest) {
    const double step = floor(t->steps[point]);
    if (step < smallest) {
        return false;
    }
    const uint32_t count = girih_triangulation_star(t, point);
    const int directions = on_axis(t, point) ? 2 : 6;
    const girih_point start = t->points[point];
    girih_point place = start;
    const double before = star_energy(t, point, count, INFINITY);
    // Less than a hundred-thousandth of an angle is not worth a move.
    double best = before * (1 - 1e-5 * t->power);
    bool found = false;
    for (int direction = 0; direction < directions; direction++) {
        const girih_point tried = moved(t, point, direction, step);
        put(t, point, tried);
        const double energy = star_energy(t, point, count, best);
        if (energy < best) {
            best = energy;
            place = tried;
            found = true;
        }
        put(t, point, start);
    }
    put(t, point, place);
    if (found) {
        wake_neighbours(t, count, step);
    }
    t->steps[point] = found ? step * 1.5 : step / 2;
    t->steps[t->mirrors[point]] = t->steps[point];
    if (found) {
        flip_around(t, point);
    }
    return found;
}

static uint32_t add_point(girih_triangulation *t, girih_point place, double step) {
    const uint32_t point = t->point_count++;
    t->points[point] = place;
    t->mirrors[point] = point;
    t->steps[point] = step;
    return point;
}

// Cuts the quadrilateral's two triangles into four around a point on the edge between them.
static void split_quadrilateral(girih_triangulation *t, const quadrilateral *q, uint32_t middle) {
    const uint32_t left = t->triangle_count++;
    const uint32_t right = t->triangle_count++;
    replace_neighbour(t, q->bc, q->left, left);
    replace_neighbour(t, q->ad, q->right, right);
    set_triangle(t, q->left, q->a, middle, q->c, right, left, q->ca);
    set_triangle(t, left, middle, q->b, q->c, q->right, q->bc, q->left);
    set_triangle(t, q->right, q->b, middle, q->d, left, right, q->db);
    set_triangle(t, right, middle, q->a, q->d, q->left, q->ad, q->right);
}

// Whether a point inside the triangle of a, b, c leaves all three others an area.
static bool is_inside(const girih_triangulation *t, const girih_point *point, uint32_t a, uint32_t b, uint32_t c) {
    const girih_point *p = t->points;
    return determinant(point, &p[a], &p[b]) > 0 && determinant(point, &p[b], &p[c]) > 0 &&
           determinant(point, &p[c], &p[a]) > 0;
}

static bool is_own_image(const girih_triangulation *t, uint32_t triangle) {
    const uint32_t *v = t->triangles[triangle].vertices;
    for (int n = 0; n < 3; n++) {
        const uint32_t image = t->mirrors[v[n]];
        if (image != v[0] && image != v[1] && image != v[2]) {
            return false;
        }
    }
    return true;
}

// Cuts a triangle, its own mirror image, into three around a point on the axis.
static bool split_triangle(girih_triangulation *t, uint32_t here) {
    const girih_corner_triangle old = t->triangles[here];
    const uint32_t *v = old.vertices;
    const uint32_t *across = old.neighbours;
    girih_point centre;
    for (int n = 0; n < 3; n++) {
        centre.weights[n] = floor((t->points[v[0]].weights[n] + t->points[v[1]].weights[n] + t->points[v[2]].weights[n]) / 3);
    }
    centre = onto_axis(t, centre);
    if (!is_inside(t, &centre, v[0], v[1], v[2])) {
        return false;
    }
    const double step = sqrt(determinant(&t->points[v[0]], &t->points[v[1]], &t->points[v[2]])) / 4;
    const uint32_t point = add_point(t, centre, step);
    const uint32_t second = t->triangle_count++;
    const uint32_t third = t->triangle_count++;
    replace_neighbour(t, across[1], here, second);
    replace_neighbour(t, across[2], here, third);
    set_triangle(t, here, v[0], v[1], point, across[0], second, third);
    set_triangle(t, second, v[1], v[2], point, across[1], third, here);
    set_triangle(t, third, v[2], v[0], point, across[2], here, second);
    return true;
}

// Whether all four triangles around a point near the middle of the quadrilateral's edge have an area.
static bool can_split(const girih_triangulation *t, const quadrilateral *q, const girih_point *middle) {
    const girih_point *p = t->points;
    return determinant(middle, &p[q->b], &p[q->c]) > 0 && determinant(middle, &p[q->c], &p[q->a]) > 0 &&
           determinant(middle, &p[q->a], &p[q->d]) > 0 && determinant(middle, &p[q->d], &p[q->b]) > 0;
}

bool girih_triangulation_split(girih_triangulation *t, uint32_t triangle, uint32_t edge) {
    quadrilateral q;
    bool shared;
    if (t->point_count + 2 > t->capacity || !find_quadrilateral(t, triangle, edge, &q)) {
        return false;
    }
    const bool twice = has_image(t, &q, &shared);
    if (shared) {
        return split_triangle(t, is_own_image(t, q.left) ? q.left : q.right);
    }
    girih_point middle;
    middle.weights[2] = one;
    for (int n = 0; n < 2; n++) {
        middle.weights[n] = floor((t->points[q.a].weights[n] + t->points[q.b].weights[n]) / 2);
        middle.weights[2] -= middle.weights[n];
    }
    if (t->symmetry_corner >= 0 && !twice) {
        middle = onto_axis(t, middle);
    }
    // Whole numbers have no middle between neighbours.
    if (!can_split(t, &q, &middle)) {
        return false;
    }
    const double step = sqrt(squared_distance(&t->points[q.a], &t->points[q.b])) / 4;
    const uint32_t point = add_point(t, middle, step);
    split_quadrilateral(t, &q, point);
    if (twice) {
        const quadrilateral image = image_of(t, &q);
        const uint32_t other = add_point(t, mirrored(t, middle), step);
        t->mirrors[point] = other;
        t->mirrors[other] = point;
        split_quadrilateral(t, &image, other);
    }
    return true;
}

// --- Whole --------------------------------------------------------------------------------------------------------

// A border's point on the other side of the axis.
static uint32_t mirrored_border_vertex(const girih_triangulation *t, uint32_t edge, uint32_t m) {
    // The edges at the axis' corner change places, the one across from it stays; all run the other way.
    const uint32_t opposite = ((uint32_t)t->symmetry_corner + 1) % 3;
    const uint32_t image = edge == opposite ? edge : 3 - opposite - edge;
    return girih_border_vertex(t->segments, image, t->segments[image] - m);
}

static void place_border(girih_triangulation *t) {
    for (uint32_t edge = 0; edge < 3; edge++) {
        const uint32_t n = t->segments[edge];
        for (uint32_t m = 0; m < n; m++) {
            const uint32_t vertex = girih_border_vertex(t->segments, edge, m);
            girih_point *point = &t->points[vertex];
            point->weights[(edge + 1) % 3] = girih_edge_parameter(m, n);
            point->weights[edge] = one - point->weights[(edge + 1) % 3];
            t->mirrors[vertex] = t->symmetry_corner < 0 ? vertex : mirrored_border_vertex(t, edge, m);
        }
    }
}

static void join_to_border(girih_triangulation *t, uint32_t middle) {
    const uint32_t count = t->border_count;
    for (uint32_t edge = 0; edge < 3; edge++) {
        for (uint32_t m = 0; m < t->segments[edge]; m++) {
            const uint32_t here = t->triangle_count++;
            set_triangle(t, here, girih_border_vertex(t->segments, edge, m),
                         girih_border_vertex(t->segments, edge, m + 1), middle, GIRIH_NO_TRIANGLE, (here + 1) % count,
                         (here + count - 1) % count);
        }
    }
}

girih_result girih_triangulation_create(girih_triangulation *t, const uint32_t segments[3], uint32_t inner_capacity,
                                        girih_error *error) {
    const uint32_t border = girih_border_count(segments);
    const size_t capacity = (size_t)border + inner_capacity;
    *t = (girih_triangulation){
        .segments = {segments[0], segments[1], segments[2]},
        .symmetry_corner = girih_symmetry_corner(segments),
        .border_count = border,
        .capacity = (uint32_t)capacity,
        .point_count = border,
        .points = calloc(capacity, sizeof *t->points),
        .mirrors = calloc(capacity, sizeof *t->mirrors),
        .incident = calloc(capacity, sizeof *t->incident),
        .steps = calloc(capacity, sizeof *t->steps),
        .triangles = calloc(2 * capacity, sizeof *t->triangles),
        .around = calloc(2 * capacity, sizeof *t->around),
    };
    if (!t->points || !t->mirrors || !t->incident || !t->steps || !t->triangles || !t->around) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu vertices", capacity);
    }
    place_border(t);
    girih_triangulation_restart(t, 4);
    return GIRIH_OK;
}

void girih_triangulation_restart(girih_triangulation *t, uint32_t power) {
    t->power = power;
    t->point_count = t->border_count;
    t->triangle_count = 0;
    girih_point middle = {{10923, 10923, 10922}};
    if (t->symmetry_corner >= 0) {
        middle = onto_axis(t, middle);
    }
    join_to_border(t, add_point(t, middle, one / 8));
}

void girih_triangulation_free(girih_triangulation *t) {
    free(t->points);
    free(t->mirrors);
    free(t->incident);
    free(t->steps);
    free(t->triangles);
    free(t->around);
    *t = (girih_triangulation){.capacity = 0};
}

void girih_triangulation_copy(girih_triangulation *to, const girih_triangulation *from) {
    to->point_count = from->point_count;
    to->triangle_count = from->triangle_count;
    to->power = from->power;
    memcpy(to->points, from->points, from->point_count * sizeof *from->points);
    memcpy(to->mirrors, from->mirrors, from->point_count * sizeof *from->mirrors);
    memcpy(to->incident, from->incident, from->point_count * sizeof *from->incident);
    memcpy(to->steps, from->steps, from->point_count * sizeof *from->steps);
    memcpy(to->triangles, from->triangles, from->triangle_count * sizeof *from->triangles);
}
