// Cities: streets, blocks and buildings, the same for the same seed. Their sizes are those of the
// data sets of Lorenz and Doellner 2008, section 6: 13,639 triangles, and nine times as many.
#ifndef GIRIH_BENCH_CITY_H
#define GIRIH_BENCH_CITY_H

#include "bench.h"

#define BENCH_DISTRICT_TRIANGLES 13639u
// Blocks along a side of a district, and metres from street to street.
#define BENCH_DISTRICT_BLOCKS 8u
#define BENCH_BLOCK_PITCH 60.0f

// Districts from -reach to reach in both directions, the one around the origin the same in all: 0
// is the small city, 1 the large one. The y axis is up, the unit a metre. Every face has its own
// normals.
girih_result bench_city(uint32_t reach, bench_mesh *mesh, girih_error *error);

// A flight above the streets of the middle district, between its buildings.
#define BENCH_FLIGHT_FRAMES 128u
typedef struct bench_flight {
    float eye[3];
    float forward[3]; // horizontal, unit
} bench_flight;
bench_flight bench_flight_at(uint32_t frame);

#endif
