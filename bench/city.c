#include "city.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

#define STREET 14.0f     // metres wide
#define LOTS 2u          // along a side of a block
#define GAP 3.0f         // between a building and the border of its lot
#define STOREY 3.5f      // metres high
#define PARK_RESERVE 60u // triangles kept back for the last lot
#define SIDES 4

typedef struct builder {
    bench_mesh *mesh;
    uint32_t vertices; // so far
    uint32_t triangles;
    uint32_t random;
} builder;

// Between 0 and 1.
static float next_random(builder *b) {
    b->random = b->random * 1664525u + 1013904223u;
    return (float)(b->random >> 8) / 16777216.0f;
}

// --- Faces --------------------------------------------------------------------------------------

// A convex face of 3 or 4 corners, counter-clockwise from outside.
static void add_face(builder *b, const float corners[][3], uint32_t count) {
    float along[3], across[3], normal[3];
    for (int k = 0; k < 3; ++k) {
        along[k] = corners[1][k] - corners[0][k];
        across[k] = corners[2][k] - corners[0][k];
    }
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const int m = (k + 2) % 3;
        normal[k] = along[l] * across[m] - along[m] * across[l];
    }
    const float length =
        sqrtf(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (uint32_t n = 0; n < count; ++n) {
        float *position = b->mesh->positions + 3 * (size_t)(b->vertices + n);
        float *out = b->mesh->normals + 3 * (size_t)(b->vertices + n);
        for (int k = 0; k < 3; ++k) {
            position[k] = corners[n][k];
            out[k] = normal[k] / length;
        }
    }
    for (uint32_t n = 2; n < count; ++n) {
        uint32_t *indices = b->mesh->indices + 3 * (size_t)b->triangles++;
        indices[0] = b->vertices;
        indices[1] = b->vertices + n - 1;
        indices[2] = b->vertices + n;
    }
    b->vertices += count;
}

static void set_corner(float corner[3], float x, float y, float z) {
    corner[0] = x;
    corner[1] = y;
    corner[2] = z;
}

// A rectangle seen from above, and its corners counter-clockwise from there: y points at the eye,
// so x grows to the right and z downwards.
typedef struct plot {
    float x0, x1, z0, z1;
} plot;

static void plot_corner(const plot *p, uint32_t n, float y, float corner[3]) {
    const float x[SIDES] = {p->x0, p->x1, p->x1, p->x0};
    const float z[SIDES] = {p->z1, p->z1, p->z0, p->z0};
    set_corner(corner, x[n % SIDES], y, z[n % SIDES]);
}

static void add_floor(builder *b, const plot *p, float y, bool up) {
    float corners[SIDES][3];
    for (uint32_t n = 0; n < SIDES; ++n) {
        plot_corner(p, up ? n : SIDES - 1 - n, y, corners[n]);
    }
    add_face(b, (const float(*)[3])corners, SIDES);
}

// Four faces from one rectangle to another: walls, or the terrace of a set-back.
static void add_ring(builder *b, const plot *from, float from_y, const plot *to, float to_y) {
    for (uint32_t n = 0; n < SIDES; ++n) {
        float corners[SIDES][3];
        plot_corner(from, n, from_y, corners[0]);
        plot_corner(from, n + 1, from_y, corners[1]);
        plot_corner(to, n + 1, to_y, corners[2]);
        plot_corner(to, n, to_y, corners[3]);
        add_face(b, (const float(*)[3])corners, SIDES);
    }
}

static plot inset(const plot *p, float by) {
    return (plot){p->x0 + by, p->x1 - by, p->z0 + by, p->z1 - by};
}

// --- Buildings ----------------------------------------------------------------------------------

typedef enum roof { FLAT_ROOF, TENT_ROOF, GABLE_ROOF } roof;
static const uint32_t roof_triangles[3] = {2, 4, 6};

static void add_tent(builder *b, const plot *p, float y, float rise, uint32_t first_side) {
    const float x = (p->x0 + p->x1) * 0.5f;
    const float z = (p->z0 + p->z1) * 0.5f;
    for (uint32_t n = first_side; n < SIDES; ++n) {
        float corners[3][3];
        plot_corner(p, n, y, corners[0]);
        plot_corner(p, n + 1, y, corners[1]);
        set_corner(corners[2], x, y + rise, z);
        add_face(b, (const float(*)[3])corners, 3);
    }
}

// The ridge runs along x.
static void add_gable(builder *b, const plot *p, float y, float rise) {
    const float z = (p->z0 + p->z1) * 0.5f;
    for (uint32_t side = 0; side < SIDES; ++side) {
        float corners[SIDES][3];
        plot_corner(p, side, y, corners[0]);
        plot_corner(p, side + 1, y, corners[1]);
        set_corner(corners[2], corners[1][0], y + rise, z);
        set_corner(corners[3], corners[0][0], y + rise, z);
        add_face(b, (const float(*)[3])corners, side % 2 == 0 ? 4 : 3);
    }
}

static void add_roof(builder *b, roof kind, const plot *p, float y) {
    const float rise = 2.0f + 3.0f * next_random(b);
    if (kind == FLAT_ROOF) {
        add_floor(b, p, y, true);
    } else if (kind == TENT_ROOF) {
        add_tent(b, p, y, rise, 0);
    } else {
        add_gable(b, p, y, rise);
    }
}

// A closed solid of about so many triangles: storeys, each a ring of walls, on up to three plots,
// each set back from the one below.
static void add_building(builder *b, plot p, float triangles) {
    const roof kind = (roof)(uint32_t)(3.0f * next_random(b));
    const float storeys_wanted = (triangles - 2.0f - (float)roof_triangles[kind]) / 8.0f;
    uint32_t storeys = storeys_wanted < 1.0f ? 1 : (uint32_t)(storeys_wanted + 0.5f);
    float y = 0.0f;
    add_floor(b, &p, y, false);
    for (uint32_t terraces = 0; storeys > 0; --storeys) {
        add_ring(b, &p, y, &p, y + STOREY);
        y += STOREY;
        // A terrace takes as many triangles as a storey.
        if (terraces < 2 && storeys > 2 && next_random(b) < 0.3f) {
            const plot smaller = inset(&p, 1.5f);
            add_ring(b, &p, y, &smaller, y);
            p = smaller;
            ++terraces;
            --storeys;
        }
    }
    add_roof(b, kind, &p, y);
}

// Tents on the ground, open below: four triangles each, and the last of what is left.
static void add_park(builder *b, const plot *p, uint32_t triangles) {
    const uint32_t tents = (triangles + 3) / 4;
    const uint32_t columns = (uint32_t)ceilf(sqrtf((float)tents));
    const float width = (p->x1 - p->x0) / (float)columns;
    for (uint32_t n = 0; n < tents; ++n) {
        const float x = p->x0 + width * (float)(n % columns);
        const float z = p->z0 + width * (float)(n / columns);
        const plot tent = {x + 0.2f * width, x + 0.8f * width, z + 0.2f * width, z + 0.8f * width};
        const uint32_t sides = triangles < SIDES ? triangles : SIDES;
        add_tent(b, &tent, 0.0f, 2.5f, SIDES - sides);
        triangles -= sides;
    }
}

// --- Districts ----------------------------------------------------------------------------------

// A block in the middle of its square and half of each street around it.
static plot block_plot(float x, float z) {
    const float half = STREET * 0.5f;
    return (plot){x + half, x + BENCH_BLOCK_PITCH - half, z + half, z + BENCH_BLOCK_PITCH - half};
}

// The block, the street to the right of it, the one below it, and their crossing; to the next
// block.
static void add_ground(builder *b, float x, float z) {
    const plot block = block_plot(x, z);
    const plot tiles[4] = {block,
                           {block.x1, block.x1 + STREET, block.z0, block.z1},
                           {block.x0, block.x1, block.z1, block.z1 + STREET},
                           {block.x1, block.x1 + STREET, block.z1, block.z1 + STREET}};
    for (int n = 0; n < 4; ++n) {
        add_floor(b, &tiles[n], 0.0f, true);
    }
}

static void add_district(builder *b, float x, float z) {
    const uint32_t end = b->triangles + BENCH_DISTRICT_TRIANGLES;
    for (uint32_t n = 0; n < BENCH_DISTRICT_BLOCKS * BENCH_DISTRICT_BLOCKS; ++n) {
        add_ground(b, x + BENCH_BLOCK_PITCH * (float)(n % BENCH_DISTRICT_BLOCKS),
                   z + BENCH_BLOCK_PITCH * (float)(n / BENCH_DISTRICT_BLOCKS));
    }
    const uint32_t lots = BENCH_DISTRICT_BLOCKS * BENCH_DISTRICT_BLOCKS * LOTS * LOTS;
    for (uint32_t n = 0; n < lots; ++n) {
        const uint32_t block = n / (LOTS * LOTS);
        const plot p = block_plot(x + BENCH_BLOCK_PITCH * (float)(block % BENCH_DISTRICT_BLOCKS),
                                  z + BENCH_BLOCK_PITCH * (float)(block / BENCH_DISTRICT_BLOCKS));
        const float size = (p.x1 - p.x0) / (float)LOTS;
        const float left = p.x0 + size * (float)(n % LOTS);
        const float top = p.z0 + size * (float)(n / LOTS % LOTS);
        const plot lot = {left, left + size, top, top + size};
        if (n + 1 == lots) {
            add_park(b, &lot, end - b->triangles);
        } else {
            const plot place = inset(&lot, GAP * (0.4f + 0.6f * next_random(b)));
            const float share = (float)(end - PARK_RESERVE - b->triangles) / (float)(lots - 1 - n);
            add_building(b, place, share * (0.4f + 1.2f * next_random(b)));
        }
    }
}

girih_result bench_city(uint32_t reach, bench_mesh *mesh, girih_error *error) {
    const uint32_t side = 2 * reach + 1;
    const uint32_t triangles = side * side * BENCH_DISTRICT_TRIANGLES;
    // No face has more than three vertices for each of its triangles.
    girih_result result = bench_mesh_allocate(mesh, 3 * triangles, triangles, error);
    if (result != GIRIH_OK) {
        return result;
    }
    mesh->name = "city";
    builder b = {.mesh = mesh};
    const float district = BENCH_BLOCK_PITCH * (float)BENCH_DISTRICT_BLOCKS;
    for (uint32_t n = 0; n < side * side; ++n) {
        // From the middle one on, so that the small city is the first of the large one.
        const uint32_t turned = (n + side * side / 2) % (side * side);
        const int x = (int)(turned % side) - (int)reach;
        const int z = (int)(turned / side) - (int)reach;
        b.random = 2008u + 7919u * n;
        add_district(&b, ((float)x - 0.5f) * district, ((float)z - 0.5f) * district);
    }
    mesh->vertex_count = b.vertices;
    if (b.triangles != triangles) {
        bench_mesh_free(mesh);
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "a city of %u triangles, not %u",
                          b.triangles, triangles);
    }
    return GIRIH_OK;
}

// --- The flight ---------------------------------------------------------------------------------

#define STEP 3.0f // metres a frame
#define TURN 6.0f // radius of its turns at crossings

// Along streets, from crossing to crossing, in blocks from the middle of the city.
static const float way[][2] = {{0, -3}, {0, 0}, {2, 0}, {2, 2}, {0, 2}};
#define CORNERS (sizeof way / sizeof *way)

// Where the flight is after so many metres. Its corners are rounded off.
static void place_at(float metres, float place[2], float direction[2]) {
    for (size_t n = 0; n + 1 < CORNERS; ++n) {
        float along[2];
        for (int k = 0; k < 2; ++k) {
            along[k] = (way[n + 1][k] - way[n][k]) * BENCH_BLOCK_PITCH;
        }
        const float length = fabsf(along[0]) + fabsf(along[1]);
        // A quarter of a circle instead of twice its radius.
        const float begin = n == 0 ? 0.0f : TURN;
        const float end = n + 2 == CORNERS ? length : length - TURN;
        const float unit[2] = {along[0] / length, along[1] / length};
        if (metres <= end - begin || n + 2 == CORNERS) {
            for (int k = 0; k < 2; ++k) {
                place[k] = way[n][k] * BENCH_BLOCK_PITCH + unit[k] * (begin + metres);
                direction[k] = unit[k];
            }
            return;
        }
        metres -= end - begin;
        const float arc = TURN * 1.57079633f;
        if (metres <= arc) {
            const float angle = metres / TURN;
            for (int k = 0; k < 2; ++k) {
                const float next =
                    (way[n + 2][k] - way[n + 1][k]) /
                    (fabsf(way[n + 2][0] - way[n + 1][0]) + fabsf(way[n + 2][1] - way[n + 1][1]));
                place[k] = way[n + 1][k] * BENCH_BLOCK_PITCH +
                           TURN * (next * (1.0f - cosf(angle)) - unit[k] * (1.0f - sinf(angle)));
                direction[k] = unit[k] * cosf(angle) + next * sinf(angle);
            }
            return;
        }
        metres -= arc;
    }
}

bench_flight bench_flight_at(uint32_t frame) {
    const float metres = STEP * (float)(frame % BENCH_FLIGHT_FRAMES);
    float place[2], direction[2];
    place_at(metres, place, direction);
    return (bench_flight){.eye = {place[0], 14.0f + 6.0f * sinf(metres * 0.02f), place[1]},
                          .forward = {direction[0], 0.0f, direction[1]}};
}
