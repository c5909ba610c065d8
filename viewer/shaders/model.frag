// Shading: a studio that moves with the camera. HAS_TRIANGLES: triangle.geom comes before.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "color.glsl"
#include "picture.glsl"
#include "studio.glsl"

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(set = 1, binding = 1) uniform sampler2D normal_map;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_texcoord;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in vec3 in_range_color;
#ifdef HAS_TRIANGLES
layout(location = 5) in vec3 in_edges;
layout(location = 6) flat in vec2 in_size;
#endif

layout(location = 0) out vec4 out_color;

// How much of its surroundings a surface mirrors: Karis's fit for mobile devices (2014).
vec3 mirrored_share(vec3 f0, float roughness, float n_v) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a004 = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    vec2 scale = vec2(-1.04, 1.04) * a004 + r.zw;
    return f0 * scale.x + scale.y;
}

// Khronos PBR neutral tone mapping: colours below 0.8 stay as they are.
vec3 tone_map(vec3 color) {
    const float start = 0.8 - 0.04;
    float least = min(color.r, min(color.g, color.b));
    float offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
    color -= offset;
    float peak = max(color.r, max(color.g, color.b));
    if (peak < start) {
        return color;
    }
    const float d = 1.0 - start;
    float mapped = 1.0 - d * d / (peak + d - start);
    color *= mapped / peak;
    float gray = 1.0 - 1.0 / (0.15 * (peak - mapped) + 1.0);
    return mix(color, vec3(mapped), gray);
}

// The texture over a pixel's footprint: up to sixteen taps along its longer axis, each about as wide as
// the shorter one. Written out, because lavapipe's own anisotropic filter never ends on some footprints.
vec4 texel_at(sampler2D map, vec2 place) {
    const float most = 16.0;
    vec2 along_x = dFdx(place);
    vec2 along_y = dFdy(place);
    bool x_is_longer = dot(along_x, along_x) > dot(along_y, along_y);
    vec2 longer = x_is_longer ? along_x : along_y;
    vec2 shorter = x_is_longer ? along_y : along_x;
    float ratio = sqrt(dot(longer, longer) / max(dot(shorter, shorter), 1e-20));
    float taps = ratio < most ? max(ceil(ratio), 1.0) : most;
    vec4 sum = vec4(0.0);
    for (float tap = 0.5; tap < taps; tap += 1.0) {
        sum += textureGrad(map, place + longer * (tap / taps - 0.5), longer / taps, shorter);
    }
    return sum / taps;
}

vec2 transformed(vec2 texcoord, vec4 row0, vec4 row1) {
    return vec2(dot(row0.xyz, vec3(texcoord, 1.0)), dot(row1.xyz, vec3(texcoord, 1.0)));
}

// The normal with the normal map on it, n being the front side's. The tangent frame comes from the
// screen derivatives of position and texture coordinates: Mikkelsen 2020, "Surface Gradient-Based
// Bump Mapping Framework", listing 3. It follows the refined surface, displaced or not, which
// tangents of the input's vertices do not. Where the coordinates span no area, there is no frame and
// the normal stays.
vec3 bumped(vec3 n, vec2 place) {
    vec3 along_x = dFdx(in_position);
    vec3 along_y = dFdy(in_position);
    vec2 place_x = dFdx(place);
    vec2 place_y = dFdy(place);
    vec3 texel = texel_at(normal_map, place).xyz * 2.0 - 1.0;
    along_x -= n * dot(along_x, n);
    along_y -= n * dot(along_y, n);
    float area = place_x.x * place_y.y - place_y.x * place_x.y;
    float turn = area < 0.0 ? -1.0 : 1.0;
    vec3 tangent = turn * (along_x * place_y.y - along_y * place_x.y);
    float square = dot(tangent, tangent);
    if (abs(area) <= 1e-4 * length(place_x) * length(place_y) || !(square > 0.0)) {
        return n;
    }
    tangent *= inversesqrt(square);
    // Green is up (glTF 2.0, section 3.9.3): against v, which runs down the image.
    float hand = dot(along_y, cross(n, along_x)) < 0.0 ? 1.0 : -1.0;
    vec3 bitangent = hand * turn * cross(n, tangent);
    texel.xy *= material.normal_scale;
    vec3 sum = tangent * texel.x + bitangent * texel.y + n * texel.z;
    return dot(sum, sum) > 0.0 ? normalize(sum) : n;
}

// Towards the viewer on either side. A vertex without a normal has 0: the triangle's own serves.
vec3 shading_normal() {
    vec3 n = normalize(cross(dFdx(in_position), -dFdy(in_position)));
    float side = gl_FrontFacing ? 1.0 : -1.0;
    if (dot(in_normal, in_normal) > 1e-12) {
        n = side * normalize(in_normal);
    }
    if (HAS_NORMAL_MAP && picture.shade == SHADE_LIT) {
        // The back is the front's underside: what rises there sinks here.
        n = side * bumped(side * n, transformed(in_texcoord.zw, material.normal_row0,
                                                material.normal_row1));
    }
    return n;
}

// Along the studio's axes.
vec3 in_studio(vec3 direction) {
    return vec3(dot(direction, picture.studio_right.xyz), dot(direction, picture.studio_up.xyz),
                dot(direction, picture.studio_back.xyz));
}

// By the triangle's area in pixels, on a scale of powers of four. Without triangle.geom there is none.
vec3 density_color() {
#ifdef HAS_TRIANGLES
    float place = clamp(0.5 * log2(max(in_size.x, 1e-6)) + 1.0, 0.0, 6.0);
    int first = min(int(place), 5);
    return mix(picture.density_colors[first].rgb, picture.density_colors[first + 1].rgb, place - float(first));
#else
    return vec3(0.0);
#endif
}

const vec3 line_color = vec3(0.07, 0.09, 0.13); // sRGB

// Dark, or light on a material that is dark itself: by its colour, not by the light on it, which would have lines
// change all over a surface.
vec3 line_over(vec3 base) {
    float brightness = picture.shade == SHADE_LIT ? dot(base, vec3(0.2126, 0.7152, 0.0722)) : 1.0;
    return from_srgb(mix(vec3(0.60, 0.64, 0.70), line_color, smoothstep(0.02, 0.05, brightness)));
}

// The farther, the fainter.
float line_strength(float depth) {
    return mix(0.92, 0.30, depth);
}

// How much of the fragment a line covers.
float line_cover() {
#ifdef HAS_TRIANGLES
    vec3 distances = abs(in_edges) * gl_FragCoord.w;
    float depth = clamp(dot(picture.depth_cue, vec4(in_position, 1.0)), 0.0, 1.0);
    float half_width = picture.line_half_width * mix(1.0, 0.6, depth);
    float nearest = min(min(distances.x, distances.y), distances.z);
    // Triangles hardly larger than lines are wide would be nothing but lines.
    float room = clamp(in_size.y / (6.0 * half_width), 0.2, 1.0);
    return clamp(half_width + 0.5 - nearest, 0.0, 1.0) * room * line_strength(depth);
#else
    return 0.0;
#endif
}

vec4 surface_color(vec4 base, vec3 n) {
    float alpha = IS_BLEND ? base.a : 1.0;
    if (picture.back_face.a > 0.0 && !gl_FrontFacing) {
        return vec4(from_srgb(picture.back_face.rgb), 1.0);
    }
    if (picture.shade == SHADE_NORMALS) {
        return vec4(from_srgb(n * 0.5 + 0.5), alpha);
    }
    if (picture.shade == SHADE_RANGES || picture.shade == SHADE_DENSITY) {
        // Lit a little, for the shape, so that the colours stay those of the legend.
        vec3 color = from_srgb(picture.shade == SHADE_RANGES ? in_range_color : density_color());
        return vec4(color * min(0.55 + 0.45 * studio_diffuse(in_studio(n)), vec3(1.0)), 1.0);
    }
    if (material.emissive.w != 0.0) {
        return vec4(base.rgb, alpha);
    }
    vec3 v = normalize(picture.eye.xyz - picture.eye.w * in_position);
    float roughness = clamp(material.roughness, 0.08, 1.0);
    vec3 f0 = mix(vec3(0.04), base.rgb, material.metallic);
    vec3 color = base.rgb * (1.0 - material.metallic) * studio_diffuse(in_studio(n));
    // Rough surfaces mirror less from the side than the mirrored direction says.
    vec3 mirrored = in_studio(normalize(mix(reflect(-v, n), n, roughness * roughness)));
    color += mirrored_share(f0, roughness, max(dot(n, v), 0.0)) * studio_mirrored(mirrored, roughness);
    color += material.emissive.rgb;
    return vec4(tone_map(color * picture.exposure), alpha);
}

void main() {
    vec4 base = material.base_color * in_color;
    if (HAS_BASE_COLOR_MAP) {
        base *= texel_at(base_color_map, transformed(in_texcoord.xy, material.base_color_row0,
                                                     material.base_color_row1));
    }
    vec3 n = shading_normal(); // its derivatives need all neighbours: before any is discarded
    if (IS_MASK && base.a < material.alpha_cutoff) {
        discard;
    }
    // What is behind the slice of a panorama: panorama.glsl. As few triangles are on the screen there, a
    // clip distance, which not every device has, would gain nothing.
    if (IS_CYLINDRICAL && dot(picture.panorama_forward.xyz, in_position - picture.eye.xyz) < 0.0) {
        discard;
    }
    if (IS_LINE) {
        float depth = clamp(dot(picture.depth_cue, vec4(in_position, 1.0)), 0.0, 1.0);
        out_color = vec4(from_srgb(line_color), 0.65 * line_strength(depth));
        return;
    }
    out_color = surface_color(base, n);
    if (picture.line_half_width > 0.0) {
        float cover = line_cover();
        out_color = vec4(mix(out_color.rgb, line_over(base.rgb), cover), max(out_color.a, cover));
    }
}
