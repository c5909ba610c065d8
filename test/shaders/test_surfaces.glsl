// Own surfaces for tests, included after girih.glsl; TEST_SURFACE chooses. Their texture and numbers are
// in the surface's set, bound by own_surfaces.c.
#define TEST_IDENTITY 0
#define TEST_NASTY 1
#define TEST_WAVE 2
#define TEST_POLYNOMIAL 3

layout(set = GIRIH_SURFACE_SET, binding = 0) uniform sampler2D bumps;
layout(set = GIRIH_SURFACE_SET, binding = 1) uniform Settings {
    float height;  // mesh units
    float phase;
};

vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
#if TEST_SURFACE == TEST_IDENTITY
    return girih_base_position(patch_, barycentric);
#elif TEST_SURFACE == TEST_NASTY
    // Everything that differs between the two sides of an edge: the triangle, the order of its corners,
    // the attributes at a UV seam, the normals at a hard edge.
    vec2 uv = vec2(girih_attribute(patch_, 0u, barycentric), girih_attribute(patch_, 1u, barycentric));
    float bump = textureLod(bumps, uv * 3.7 + phase, 0.0).r;
    float tear = sin(float(patch_.triangle) * 12.9898 + barycentric.x * 3.0 + barycentric.y * barycentric.y * 7.0);
    vec3 base = girih_base_position(patch_, barycentric);
    vec3 sheared = sin(base.zxy * 17.0 + float(patch_.instance + patch_.material)) * 0.1;
    return base + (girih_base_normal(patch_, barycentric) * (bump + tear) + sheared) * (height * patch_.scale);
#elif TEST_SURFACE == TEST_WAVE
    vec3 base = girih_base_position(patch_, barycentric);
    float wave = sin(base.x * 5.0 + phase) * cos(base.y * 4.0) * sin(base.z * 3.0 + 1.0);
    return base + girih_base_normal(patch_, barycentric) * (wave * height * patch_.scale);
#else
    // Additions and multiplications in a written order, for the CPU to repeat.
    precise vec3 base = girih_base_position(patch_, barycentric);
    precise float s = girih_attribute(patch_, 0u, barycentric);
    precise float t = girih_attribute(patch_, 1u, barycentric);
    precise float bend = (s * s - t) * 0.25 + barycentric.x * barycentric.y;
    precise vec3 square = base * base;
    precise vec3 turned = vec3(square.y, square.z, square.x);
    precise vec3 point = base + (turned + vec3(bend)) * 0.125;
    return point;
#endif
}
