// One panel of an overlay. Its pixels lie in a buffer, not in an image: they are read once, each where
// it is shown.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "color.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Pixels {
    uint pixels[]; // 0xAARRGGBB, sRGB, premultiplied
};

layout(push_constant) uniform Panel {
    ivec2 corner;
    int width;
    int first;
} panel;

layout(location = 0) out vec4 out_color; // linear, premultiplied

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy) - panel.corner;
    vec4 texel = unpackUnorm4x8(pixels[panel.first + place.y * panel.width + place.x]).bgra;
    out_color = vec4(from_srgb(texel.rgb / max(texel.a, 1e-3)) * texel.a, texel.a);
}
