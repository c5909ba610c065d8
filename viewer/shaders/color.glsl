// sRGB colours as the linear ones that an sRGB attachment encodes.
#ifndef GIRIH_COLOR_GLSL
#define GIRIH_COLOR_GLSL

vec3 from_srgb(vec3 color) {
    vec3 curve = pow((color + 0.055) / 1.055, vec3(2.4));
    return mix(color / 12.92, curve, greaterThan(color, vec3(0.04045)));
}

#endif
