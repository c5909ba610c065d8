// Arithmetic on the way to positions, levels and culling: every sum written out and `precise`, so that
// both sides of an edge, all output modes and the CPU round alike. dot, mix, length, mat * vec and
// division leave their order or rounding open.
#ifndef GIRIH_MATH_GLSL
#define GIRIH_MATH_GLSL

float girih_dot(vec3 a, vec3 b) {
    precise float result = (a.x * b.x + a.y * b.y) + a.z * b.z;
    return result;
}

vec3 girih_cross(vec3 a, vec3 b) {
    precise vec3 result = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return result;
}

// An upper bound of a vector's length without a root: sqrt(1 + a^2 + b^2) <= 1 + (a + b) / 2 for a, b in [0,1].
float girih_length_bound(vec3 a) {
    vec3 m = abs(a);
    precise float result = 0.5 * (max(max(m.x, m.y), m.z) + ((m.x + m.y) + m.z));
    return result;
}

// Sums of vanishing terms can come out as -0 on one side of an edge and +0 on the other; an integer
// test makes them one, where `x + 0.0` would be folded away.
float girih_no_negative_zero(float x) {
    return floatBitsToUint(x) == 0x80000000u ? 0.0 : x;
}

vec3 girih_no_negative_zero(vec3 p) {
    return vec3(girih_no_negative_zero(p.x), girih_no_negative_zero(p.y), girih_no_negative_zero(p.z));
}

// Rows of an affine map applied to a point.
struct GirihTransform {
    vec4 row0, row1, row2;
};

vec3 girih_transform_point(GirihTransform t, vec3 p) {
    precise vec3 result = vec3(((t.row0.x * p.x + t.row0.y * p.y) + t.row0.z * p.z) + t.row0.w,
                               ((t.row1.x * p.x + t.row1.y * p.y) + t.row1.z * p.z) + t.row1.w,
                               ((t.row2.x * p.x + t.row2.y * p.y) + t.row2.z * p.z) + t.row2.w);
    return result;
}

// Only ever used for shading: zero stays zero.
vec3 girih_normalize(vec3 n) {
    precise float square = girih_dot(n, n);
    return square > 0.0 ? n * (1.0 / sqrt(square)) : vec3(0.0);
}

#endif
