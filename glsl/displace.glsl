// Displacement, for own surfaces: a height map's height at a place. Include it after girih.glsl;
// girih_surface may then be
//
//     layout(set = GIRIH_SURFACE_SET, binding = 0) uniform sampler2D heights;
//     vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
//         vec2 place = vec2(girih_attribute(patch_, 0u, barycentric), girih_attribute(patch_, 1u, barycentric));
//         return girih_base_position(patch_, barycentric) +
//                girih_displacement(patch_, girih_base_normal(patch_, barycentric),
//                                   girih_height(heights, place) * HEIGHT);
//     }
//
// with the map's largest absolute height times HEIGHT for girih_surface_program_desc.reach.
#ifndef GIRIH_DISPLACE_GLSL
#define GIRIH_DISPLACE_GLSL

// The texels on either side of a place along one axis, the map repeating, and the second one's weight.
void girih_texel_pair(float place, int size, out int first, out int second, out float weight) {
    precise float at = (place - floor(place)) * float(size) - 0.5;
    precise float before = floor(at);
    precise float share = at - before;
    weight = share;
    // From -1, before the first texel's centre, to size, where rounding took the place to 1. A place that
    // is not a number comes out somewhere.
    first = clamp(int(before), -1, size);
    first = first < 0 ? size - 1 : first == size ? 0 : first;
    second = first + 1 == size ? 0 : first + 1;
}

// A map's first channel, filtered bilinearly and repeated; place (0, 0) is the corner of its first
// texel, as in glTF. Texels are fetched and filtered by written-out arithmetic: a sampler's own filter
// has as few as 8 bits of weight, which makes steps of a smooth slope, and differs between devices. The
// image needs neither mipmaps nor a format that can be filtered.
float girih_height(sampler2D map, vec2 place) {
    ivec2 size = textureSize(map, 0);
    ivec2 first, second;
    vec2 weight;
    girih_texel_pair(place.x, size.x, first.x, second.x, weight.x);
    girih_texel_pair(place.y, size.y, first.y, second.y, weight.y);
    float texel00 = texelFetch(map, first, 0).r;
    float texel10 = texelFetch(map, ivec2(second.x, first.y), 0).r;
    float texel01 = texelFetch(map, ivec2(first.x, second.y), 0).r;
    float texel11 = texelFetch(map, second, 0).r;
    precise vec2 rest = 1.0 - weight;
    precise float row0 = texel00 * rest.x + texel10 * weight.x;
    precise float row1 = texel01 * rest.x + texel11 * weight.x;
    precise float height = row0 * rest.y + row1 * weight.y;
    return height;
}

// The same for models without texture coordinates: the map is laid on along the three axes of the mesh's
// own space, and what the normal faces most counts most. Both as girih_mesh_place gives them.
float girih_height_by_axes(sampler2D map, vec3 position, vec3 normal) {
    vec3 square = normal * normal;
    precise vec3 weight = square * square;
    precise float sum = (weight.x + weight.y) + weight.z;
    float along_x = girih_height(map, vec2(-position.z, -position.y));
    float along_y = girih_height(map, vec2(position.x, position.z));
    float along_z = girih_height(map, vec2(position.x, -position.y));
    precise float height = (along_x * weight.x + along_y * weight.y) + along_z * weight.z;
    return sum > 0.0 ? height / sum : along_x;
}

#endif
