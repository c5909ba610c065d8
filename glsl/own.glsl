// A host's own surface: one function that maps a patch and barycentrics to a point in the world.
//
//     vec3 girih_surface(GirihPatch patch_, vec3 barycentric);
//
// Watertight whatever it does: a vertex on an edge is evaluated in the one triangle that owns the edge,
// a vertex at a corner in the one that owns the point, whichever triangle asks. Both sides of an edge run
// the same code on the same arguments and get the same bits.
#ifndef GIRIH_OWN_GLSL
#define GIRIH_OWN_GLSL

#include "girih_permutation.h"
#include "gather.glsl"

vec3 girih_surface(GirihPatch patch_, vec3 barycentric);

// --- What girih_surface may call ----------------------------------------------------------------------

// A point of the base surface (GIRIH_BASE), in the world.
vec3 girih_base_position(GirihPatch patch_, vec3 barycentric) {
    return girih_patch_position(patch_, barycentric.x, barycentric.y, barycentric.z);
}

// Its normal, of unit length.
vec3 girih_base_normal(GirihPatch patch_, vec3 barycentric) {
    return girih_patch_unit_normal(patch_, barycentric.x, barycentric.y, barycentric.z);
}

// The way of a point that goes `height` mesh units along a unit normal, both in the world: as if the mesh
// had been displaced before it was placed, whatever the transform's scales are.
vec3 girih_displacement(GirihPatch patch_, vec3 normal, float height) {
    GirihTransform t = girih_instance_transform(
        patch_.instance, patch_.previous ? GIRIH_INSTANCE_PREVIOUS : GIRIH_INSTANCE_TRANSFORM);
    // World normals are mesh normals times the inverse transpose; its inverse is the transpose.
    vec3 mesh = girih_normalize(t.row0.xyz * normal.x + t.row1.xyz * normal.y + t.row2.xyz * normal.z);
    return vec3(girih_dot(t.row0.xyz, mesh), girih_dot(t.row1.xyz, mesh), girih_dot(t.row2.xyz, mesh)) * height;
}

// Float n of the vertices' attributes.
float girih_attribute(GirihPatch patch_, uint n, vec3 barycentric) {
    return girih_scene_attribute(patch_.vertices, n, barycentric);
}

// Where the place lies on the flat triangle in mesh space, and the mesh-space normal there, of unit
// length: for patterns in space that stay with the mesh.
void girih_mesh_place(GirihPatch patch_, vec3 barycentric, out vec3 position, out vec3 normal) {
    uint first = patch_.previous ? girih_frame.previous_vertices : 0u;
    position = vec3(0.0);
    normal = vec3(0.0);
    for (uint n = 0u; n < 3u; ++n) {
        vec3 p, q;
        girih_vertex(patch_.vertices[n], first, p, q);
        position += p * barycentric[n];
        normal += q * barycentric[n];
    }
    normal = girih_normalize(normal);
}

// --- The normal ---------------------------------------------------------------------------------------

// How far the points are at least that a normal is taken from, as a share of the way to each corner.
#ifndef GIRIH_NORMAL_STEP
#define GIRIH_NORMAL_STEP (1.0 / 256.0)
#endif

// The share for a patch: far from the origin, or where triangles are small, the rounding of coordinates
// must stay a hundredth of what lies between the points.
float girih_normal_step(GirihPatch patch_) {
    vec3 far = max(max(abs(patch_.b300), abs(patch_.b030)), abs(patch_.b003));
    vec3 wide = max(max(abs(patch_.b030 - patch_.b300), abs(patch_.b003 - patch_.b030)), abs(patch_.b300 - patch_.b003));
    float size = max(max(far.x, far.y), far.z);
    float extent = max(max(wide.x, wide.y), wide.z);
    // 128 units in the last place.
    float wanted = extent > 0.0 ? size * (128.0 / 8388608.0) / extent : 1.0;
    return max(min(wanted, 0.25), GIRIH_NORMAL_STEP);
}

// The three points around a place, which never leave the triangle.
vec3 girih_normal_place(vec3 barycentric, int corner, float share) {
    vec3 near = barycentric * (1.0 - share);
    near[corner] += share;
    return near;
}

// The normal of a surface that adds `added` to points `base` of another whose normal is `normal`: the
// base's tangents are taken perpendicular to its normal, which need not be that of its own facets, and
// what is added is differentiated.
vec3 girih_turned_normal(vec3 normal, vec3 base[3], vec3 added[3]) {
    vec3 along2 = base[1] - base[0];
    vec3 along3 = base[2] - base[0];
    // Mirrored, folded, or given with normals that oppose the winding: the normal decides. A sliver, or a
    // base that the normal lies in, cannot tell.
    float facing = girih_dot(girih_cross(along2, along3), normal);
    bool unclear = !(abs(facing) > 0.01 * girih_length_bound(along2) * girih_length_bound(along3));
    along2 += (added[1] - added[0]) - normal * girih_dot(along2, normal);
    along3 += (added[2] - added[0]) - normal * girih_dot(along3, normal);
    vec3 turned = girih_normalize(girih_cross(along2, along3));
    unclear = unclear || !(girih_dot(turned, turned) > 0.5);
    return unclear ? normal : facing < 0.0 ? -turned : turned;
}

#ifdef GIRIH_SURFACE_NORMAL
// The host's own.
vec3 girih_surface_normal(GirihPatch patch_, vec3 barycentric);
#endif

// --- Places: who evaluates a pattern vertex -----------------------------------------------------------

// A place in a triangle of the scene: the weights of its corners in the order of the input, over GIRIH_SPLIT_ONE.
struct GirihPlace {
    uint triangle;
    uvec3 weights;
};

// Where a pattern vertex's position and normal are evaluated. Across a hard edge the normals part; all
// who share an output vertex (the weld edge, the vertex) still share the place.
struct GirihPlaces {
    GirihPlace position;
    GirihPlace normal;
    bool smooth_; // the normal's place is the position's
};

bool girih_same_normal(uint a, uint b) {
    return a == b || girih_vertex_normal(a) == girih_vertex_normal(b);
}

GirihPlace girih_corner_place(uint owner) {
    GirihPlace place = GirihPlace(owner / 3u, uvec3(0u));
    place.weights[owner % 3u] = GIRIH_SPLIT_ONE;
    return place;
}

// Edge n of a triangle runs from corner n to corner n + 1.
uint girih_edge_end(uint edge) {
    return edge % 3u == 2u ? edge - 2u : edge + 1u;
}

// `first` and `second` weigh the ends of an edge in canonical order.
GirihPlace girih_edge_place(uint owner, uint first, uint second) {
    bool reversed = (GIRIH_AT_TRIANGLE_EDGES(owner) & GIRIH_EDGE_REVERSED) != 0u;
    GirihPlace place = GirihPlace(owner / 3u, uvec3(0u));
    place.weights[owner % 3u] = reversed ? second : first;
    place.weights[girih_edge_end(owner) % 3u] = reversed ? first : second;
    return place;
}

// `weights` of the corners of `triangle` in the order of the input.
GirihPlaces girih_find_places(uint triangle, uvec3 weights) {
    GirihPlace inside = GirihPlace(triangle, weights);
    GirihPlaces places = GirihPlaces(inside, inside, true);
    uint zeros = uint(weights.x == 0u) + uint(weights.y == 0u) + uint(weights.z == 0u);
    if (zeros == 2u) {
        uint corner = weights.x != 0u ? 0u : weights.y != 0u ? 1u : 2u;
        uint vertex = GIRIH_AT_TRIANGLE_VERTICES(3u * triangle + corner);
        uint owner = GIRIH_AT_VERTEX_OWNERS(GIRIH_AT_WELD_POINTS(vertex));
        places.position = girih_corner_place(owner);
        places.normal = places.position;
        places.smooth_ = girih_same_normal(vertex, GIRIH_AT_TRIANGLE_VERTICES(owner));
        if (!places.smooth_) {
            places.normal = girih_corner_place(GIRIH_AT_VERTEX_OWNERS(vertex));
        }
    } else if (zeros == 1u) {
        uint edge = 3u * triangle + (weights.z == 0u ? 0u : weights.x == 0u ? 1u : 2u);
        uint end = girih_edge_end(edge);
        uint word = GIRIH_AT_TRIANGLE_EDGES(edge);
        bool reversed = (word & GIRIH_EDGE_REVERSED) != 0u;
        uint first = weights[(reversed ? end : edge) % 3u];
        uint second = GIRIH_SPLIT_ONE - first;
        uint owner = GIRIH_AT_EDGE_OWNERS(word & GIRIH_EDGE_MASK);
        places.position = girih_edge_place(owner, first, second);
        places.normal = places.position;
        uint near = GIRIH_AT_TRIANGLE_VERTICES(owner);
        uint far = GIRIH_AT_TRIANGLE_VERTICES(girih_edge_end(owner));
        bool same_way = ((word ^ GIRIH_AT_TRIANGLE_EDGES(owner)) & GIRIH_EDGE_REVERSED) == 0u;
        places.smooth_ = girih_same_normal(GIRIH_AT_TRIANGLE_VERTICES(edge), same_way ? near : far) &&
                         girih_same_normal(GIRIH_AT_TRIANGLE_VERTICES(end), same_way ? far : near);
        if (!places.smooth_) {
            uint weld_edge = GIRIH_AT_TRIANGLE_WELD_EDGES(edge) & GIRIH_WELD_MASK;
            places.normal = girih_edge_place(GIRIH_AT_WELD_EDGE_OWNERS(weld_edge), first, second);
        }
    }
    return places;
}

// From the base pattern's corners to the input's.
uvec3 girih_input_weights(uint lambda, uvec3 weights) {
    uint corners = GIRIH_LAMBDA_CORNERS(lambda);
    uvec3 result = uvec3(0u);
    for (uint n = 0u; n < 3u; ++n) {
        result[corners >> (2u * n) & 3u] = weights[n];
    }
    return result;
}

GirihPatch girih_own_patch(uint triangle, uint instance, bool previous) {
    uint vertices[3];
    uint edges[3];
    for (uint n = 0u; n < 3u; ++n) {
        vertices[n] = GIRIH_AT_TRIANGLE_VERTICES(3u * triangle + n);
        edges[n] = GIRIH_AT_TRIANGLE_EDGES(3u * triangle + n);
    }
    GirihPatch patch_ = girih_gather_patch(instance, vertices, edges, previous);
    patch_.vertices = vertices;
    patch_.triangle = triangle;
    patch_.instance = instance;
    patch_.material = GIRIH_AT_TRIANGLE_MATERIALS(triangle) & GIRIH_MATERIAL_MASK;
    uint when = previous ? GIRIH_INSTANCE_PREVIOUS : 0u;
    patch_.scale = uintBitsToFloat(girih_instance(instance, GIRIH_INSTANCE_SCALE + when));
    patch_.mirrored = (girih_instance(instance, GIRIH_INSTANCE_FLAGS + when) & GIRIH_INSTANCE_MIRRORED) != 0u;
    patch_.previous = previous;
    return patch_;
}

// Defines the function NAME: the point of a surface given as a function, and its normal. A loop, so that
// the function is compiled into one place, however long it is.
#define GIRIH_DEFINE_SAMPLE(NAME, SURFACE) \
    void NAME(GirihPatch patch_, vec3 barycentric, out vec3 position, out vec3 normal) { \
        vec3 base[3]; \
        vec3 added[3]; \
        position = vec3(0.0); \
        float share = girih_normal_step(patch_); \
        for (int n = 0; n < 4; ++n) { \
            vec3 near = n == 0 ? barycentric : girih_normal_place(barycentric, n - 1, share); \
            vec3 point = SURFACE(patch_, near); \
            if (n == 0) { \
                position = point; \
            } else { \
                base[n - 1] = girih_base_position(patch_, near); \
                added[n - 1] = point - base[n - 1]; \
            } \
        } \
        normal = girih_turned_normal(girih_base_normal(patch_, barycentric), base, added); \
    }

#ifdef GIRIH_SURFACE_NORMAL
void girih_surface_sample(GirihPatch patch_, vec3 barycentric, out vec3 position, out vec3 normal) {
    position = girih_surface(patch_, barycentric);
    normal = girih_surface_normal(patch_, barycentric);
}
#else
GIRIH_DEFINE_SAMPLE(girih_surface_sample, girih_surface)
#endif

// The surface's point and normal at a place, as they are put out.
void girih_own_sample(GirihPatch patch_, vec3 barycentric, out vec3 position, out vec3 normal) {
    girih_surface_sample(patch_, barycentric, position, normal);
    position = girih_no_negative_zero(position);
    normal = girih_no_negative_zero(normal);
}

#endif
