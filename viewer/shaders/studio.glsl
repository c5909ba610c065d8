// A photographer's studio around the camera: three softboxes, a light ceiling and a darker floor. It is a formula,
// not a map, so that light from it for any roughness costs a few dozen operations, which on a CPU is less than looking
// up a map that was blurred beforehand.
#ifndef GIRIH_STUDIO_GLSL
#define GIRIH_STUDIO_GLSL

struct Softbox {
    vec3 towards, across, along; // unit vectors, at right angles; camera space: right, up, towards the viewer
    vec2 half_size;              // at distance 1
    float radiance;
};

// The key light, the fill light, and a strip above and behind that draws outlines.
const Softbox softboxes[3] = Softbox[3](
    Softbox(vec3(-0.5186, 0.5657, 0.6411), vec3(0.7775, 0.0, 0.6289), vec3(0.3558, 0.8246, -0.4398), vec2(0.34, 0.26),
            6.0),
    Softbox(vec3(0.9035, 0.1004, 0.4166), vec3(0.4187, 0.0, -0.9081), vec3(-0.0912, 0.9949, -0.0420),
            vec2(0.12, 0.60), 2.6),
    Softbox(vec3(0.1961, 0.6865, -0.7002), vec3(-0.9629, 0.0, -0.2697), vec3(-0.1852, 0.7272, 0.6610),
            vec2(0.75, 0.12), 3.2));

const vec3 studio_floor = vec3(0.20, 0.195, 0.19);
const vec3 studio_ceiling = vec3(0.66, 0.69, 0.74);

// From the floor to the ceiling, with a horizon that roughness blurs.
vec3 studio_walls(float height, float roughness) {
    float blur = mix(0.25, 1.0, roughness);
    return mix(studio_floor, studio_ceiling, smoothstep(-blur, blur, height - 0.1 * (1.0 - roughness)));
}

// What comes from a direction, blurred as a surface of this roughness mirrors it.
vec3 studio_mirrored(vec3 direction, float roughness) {
    vec3 sum = studio_walls(direction.y, roughness);
    float blur = mix(0.02, 1.1, roughness * roughness);
    for (int n = 0; n < 3; ++n) {
        Softbox box = softboxes[n];
        float front = dot(direction, box.towards);
        vec2 place = vec2(dot(direction, box.across), dot(direction, box.along)) / max(front, 0.05);
        vec2 inside = smoothstep(box.half_size + blur, box.half_size - blur, abs(place));
        // Blurred wider than it is, a box keeps the light that it gives.
        vec2 share = min(box.half_size / blur, vec2(1.0));
        sum += box.radiance * (inside.x * inside.y * share.x * share.y * smoothstep(0.0, 0.3, front));
    }
    return sum;
}

// Irradiance over pi at a surface of this normal: the walls' and, light wrapping around the edge as it does from
// something large, the softboxes'.
vec3 studio_diffuse(vec3 n) {
    vec3 sum = 0.58 * studio_walls(n.y, 1.0);
    for (int k = 0; k < 3; ++k) {
        Softbox box = softboxes[k];
        float solid_angle = 4.0 * box.half_size.x * box.half_size.y;
        const float wrap = 0.25;
        float facing = max((dot(n, box.towards) + wrap) / (1.0 + wrap), 0.0);
        sum += box.radiance * solid_angle / 3.14159265 * facing * facing;
    }
    return sum;
}

#endif
