// An own surface for tests in baking: see test_surfaces.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require

#ifdef TEST_APART
// The control of the tests' own: every triangle evaluates its border itself, as if nothing were shared.
#define GIRIH_SET 0
#define GIRIH_SURFACE_SET (GIRIH_SET + 1)
#define GIRIH_SURFACE 2
#include "own.glsl"
GirihPlaces own_triangle(uint triangle, uvec3 weights) {
    GirihPlace place = GirihPlace(triangle, weights);
    return GirihPlaces(place, place, true);
}
#define girih_find_places own_triangle
#endif

#define GIRIH_BAKE
#include "girih.glsl"
#include "test_surfaces.glsl"
