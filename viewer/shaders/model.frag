// Shading: a key light and a fill light that move with the camera, a sky above and a ground below.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "color.glsl"
#include "picture.glsl"

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(set = 1, binding = 1) uniform sampler2D normal_map;

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_texcoord;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in vec3 in_range_color;

layout(location = 0) out vec4 out_color;

const float PI = 3.14159265;

// Light from all around, by direction.
vec3 surroundings(vec3 direction, float blur) {
    vec3 ground = vec3(0.30, 0.29, 0.28);
    vec3 sky = vec3(0.82, 0.86, 0.92);
    float height = direction.y * mix(1.6, 1.0, blur);
    return mix(ground, sky, smoothstep(-1.0, 1.0, height));
}

// GGX distribution with Smith's visibility, as in Karis 2013, "Real Shading in Unreal Engine 4".
float specular_lobe(float n_l, float n_v, float n_h, float alpha) {
    float squared = alpha * alpha;
    float bottom = n_h * n_h * (squared - 1.0) + 1.0;
    float visibility = n_l * sqrt(n_v * n_v * (1.0 - squared) + squared) +
                       n_v * sqrt(n_l * n_l * (1.0 - squared) + squared);
    return squared / (PI * bottom * bottom) * 0.5 / max(visibility, 1e-4);
}

vec3 fresnel(vec3 f0, float v_h) {
    return f0 + (1.0 - f0) * pow(clamp(1.0 - v_h, 0.0, 1.0), 5.0);
}

// The environment's part of the specular term: Karis's fit for mobile devices (2014).
vec3 surroundings_specular(vec3 f0, float roughness, float n_v) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a004 = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    vec2 scale = vec2(-1.04, 1.04) * a004 + r.zw;
    return f0 * scale.x + scale.y;
}

vec3 light(vec3 diffuse, vec3 f0, float alpha, vec3 n, vec3 v, vec3 l, float strength) {
    float n_l = max(dot(n, l), 0.0);
    float n_v = max(dot(n, v), 1e-3);
    vec3 h = normalize(l + v);
    float n_h = max(dot(n, h), 0.0);
    vec3 specular = fresnel(f0, max(dot(v, h), 0.0)) * specular_lobe(n_l, n_v, n_h, alpha);
    return (diffuse / PI + specular) * (n_l * strength * PI);
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
    float alpha = IS_BLEND ? base.a : 1.0;
    if (IS_LINE) {
        out_color = vec4(from_srgb(vec3(0.07, 0.09, 0.13)), 0.6);
        return;
    }
    if (picture.back_face.a > 0.0 && !gl_FrontFacing) {
        out_color = vec4(from_srgb(picture.back_face.rgb), 1.0);
        return;
    }
    if (picture.shade == SHADE_NORMALS) {
        out_color = vec4(from_srgb(n * 0.5 + 0.5), alpha);
        return;
    }
    vec3 v = normalize(picture.eye.xyz - picture.eye.w * in_position);
    vec3 albedo = base.rgb;
    float metallic = material.metallic;
    float roughness = material.roughness;
    if (picture.shade == SHADE_RANGES) {
        albedo = from_srgb(in_range_color);
        metallic = 0.0;
        roughness = 1.0;
        alpha = 1.0;
    } else if (material.emissive.w != 0.0) {
        out_color = vec4(albedo, alpha);
        return;
    }
    float rough = clamp(roughness, 0.2, 1.0);
    vec3 f0 = mix(vec3(0.04), albedo, metallic);
    vec3 diffuse = albedo * (1.0 - metallic);
    vec3 color = light(diffuse, f0, rough * rough, n, v, picture.key_light.xyz, 0.62);
    color += light(diffuse, f0, rough * rough, n, v, picture.fill_light.xyz, 0.16);
    color += diffuse * surroundings(n, 1.0) * 0.42;
    vec3 mirrored = reflect(-v, n);
    color += surroundings_specular(f0, rough, max(dot(n, v), 0.0)) *
             surroundings(mix(mirrored, n, rough * rough), rough) * 0.6;
    color += material.emissive.rgb;
    out_color = vec4(tone_map(color), alpha);
}
