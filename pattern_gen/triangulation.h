// A triangulation of the whole that is worked on: vertices move, edges flip, vertices come and go. Where two of the
// whole's edges are split alike it is mirror-symmetric, and every change happens on both sides of the axis at once.
#ifndef GIRIH_PATTERN_GEN_TRIANGULATION_H
#define GIRIH_PATTERN_GEN_TRIANGULATION_H

#include <stdbool.h>
#include <stdint.h>

#include "pattern.h"

#define GIRIH_NO_TRIANGLE UINT32_MAX

// Barycentric weights: whole numbers that add up to 32768, in doubles, which hold all of their products exactly. So
// what is computed for one side of an axis is what is computed for the other, and the same on every machine.
typedef struct girih_point {
    double weights[3];
} girih_point;

typedef struct girih_corner_triangle {
    uint32_t vertices[3];
    uint32_t neighbours[3]; // across the edge from vertex n to n + 1, or GIRIH_NO_TRIANGLE
} girih_corner_triangle;

typedef struct girih_triangulation {
    uint32_t segments[3];
    int symmetry_corner;     // on the axis, or -1
    uint32_t border_count;   // the first points, which never move
    uint32_t capacity;       // of points; triangles fewer than twice as many
    uint32_t point_count;
    uint32_t triangle_count;
    // Energy, which moves and flips lower: the sum over triangles of (the largest cotangent times sqrt(3))^power, a
    // power of two from 4 on: the larger, the more the flattest count.
    uint32_t power;
    girih_point *points;
    uint32_t *mirrors;       // the point on the other side of the axis: itself on the axis, or without one
    uint32_t *incident;      // a triangle at each point
    double *steps;           // how far each point is moved next
    girih_corner_triangle *triangles;
    uint32_t *around;        // scratch: the triangles around a point
} girih_triangulation;

// Room for inner_capacity points inside; one of them, in the middle, joined to all of the border. To be freed also
// where it fails.
girih_result girih_triangulation_create(girih_triangulation *t, const uint32_t segments[3], uint32_t inner_capacity,
                                        girih_error *error);

// Back to the one point that it was created with.
void girih_triangulation_restart(girih_triangulation *t, uint32_t power);

void girih_triangulation_free(girih_triangulation *t);

// From one to another that was made for the same pattern.
void girih_triangulation_copy(girih_triangulation *to, const girih_triangulation *from);

// The largest cotangent of all triangles times sqrt(3), 1 for equilateral ones, and, where not NULL, whose that is.
double girih_triangulation_flatness(const girih_triangulation *t, uint32_t *triangle);

// The triangle with the edge from a to b and, in *edge, which of its edges that is; GIRIH_NO_TRIANGLE without one.
uint32_t girih_triangulation_find_edge(const girih_triangulation *t, uint32_t a, uint32_t b, uint32_t *edge);

// Flips all edges that can be until none is left that should.
void girih_triangulation_flip_all(girih_triangulation *t);

// Puts a point into the middle of an inner edge, and another into its mirror image; where both are edges of one
// triangle, one point into that triangle. False, with nothing done, where there is no room for a point, or in it no place.
bool girih_triangulation_split(girih_triangulation *t, uint32_t triangle, uint32_t edge);

// Looks for a place of less energy one step from a point, and moves it and its mirror image there, flipping edges
// around it; its steps get longer while it moves, shorter where it cannot. A point whose step is below `smallest` (in
// units of the weights) rests until a neighbour moves by more. False where it did not move.
bool girih_triangulation_move(girih_triangulation *t, uint32_t point, double smallest);

// Sets a point to a place, or to the place on the axis next to it, and its mirror image; false, with nothing changed,
// where that would turn a triangle over.
bool girih_triangulation_set(girih_triangulation *t, uint32_t point, girih_point place);

// Collects the triangles around a point in t->around and returns their number. What changes or looks for an edge
// overwrites the list.
uint32_t girih_triangulation_star(const girih_triangulation *t, uint32_t point);

#endif
