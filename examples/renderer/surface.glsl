// The host's own surface: Curved PN triangles with a relief from a texture, and a ripple that travels
// round. One text for the vertex shader (instanced) and for baking; girih.glsl keeps it watertight,
// seams of the texture coordinates included, and works out the normals.
#include "displace.glsl"
#include "view.glsl"

vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
    vec2 uv = vec2(girih_attribute(patch_, 0u, barycentric), girih_attribute(patch_, 1u, barycentric));
    float time = patch_.previous ? view.times.y : view.times.x;
    float height = 0.1 * girih_height(relief, uv * vec2(8.0, 4.0)) +
                   0.05 * sin(6.2831853 * (3.0 * uv.x + 2.0 * uv.y - time));
    vec3 normal = girih_base_normal(patch_, barycentric);
    return girih_base_position(patch_, barycentric) + girih_displacement(patch_, normal, height);
}
