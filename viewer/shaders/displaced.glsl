// The surface of --displace: the base surface, or the user's own, moved along its normal by the height
// map. The program defines before
//   HEIGHT_MAP_FLOAT    where the texture coordinates begin in a vertex's attributes; without any,
//   HEIGHT_MAP_REPEATS  how often the map goes into a mesh unit
//   HEIGHT_PER_UNIT     mesh units that a difference of 1 in the map comes to
//   HEIGHT_ZERO         the map's value that moves nothing
//   HEIGHT_LOW, _HIGH   the map's smallest and largest value
//   UNDISPLACED         the user's function, where there is one
#include "displace.glsl"
#include "seamless.glsl"

layout(set = GIRIH_SURFACE_SET, binding = 0) uniform sampler2D girih_height_map;

#ifdef UNDISPLACED
vec3 UNDISPLACED(GirihPatch patch_, vec3 barycentric);

GIRIH_DEFINE_SAMPLE(girih_undisplaced_sample, UNDISPLACED)
#endif

float girih_own_height(GirihPatch patch_, vec3 barycentric) {
#ifdef HEIGHT_MAP_FLOAT
    return girih_height(girih_height_map,
                        vec2(girih_attribute(patch_, HEIGHT_MAP_FLOAT, barycentric),
                             girih_attribute(patch_, HEIGHT_MAP_FLOAT + 1u, barycentric)));
#else
    vec3 mesh_position, mesh_normal;
    girih_mesh_place(patch_, barycentric, mesh_position, mesh_normal);
    return girih_height_by_axes(girih_height_map, mesh_position * HEIGHT_MAP_REPEATS, mesh_normal);
#endif
}

vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
#ifdef UNDISPLACED
    vec3 point, normal;
    girih_undisplaced_sample(patch_, barycentric, point, normal);
#else
    vec3 point = girih_base_position(patch_, barycentric);
    vec3 normal = girih_base_normal(patch_, barycentric);
#endif
    // Bent at seams, heights may leave the map's range, which culling relies on.
    float height = clamp(girih_seamless_height(patch_, barycentric), HEIGHT_LOW, HEIGHT_HIGH);
    precise float distance = (height - HEIGHT_ZERO) * HEIGHT_PER_UNIT;
    precise vec3 displaced = point + girih_displacement(patch_, normal, distance);
    return displaced;
}
