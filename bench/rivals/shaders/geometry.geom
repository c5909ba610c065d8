// One pass: the topology is made here, and put out as triangle strips. GEOMETRY_METHOD:
//   0  Knuth, Kohlhammer, Kuijper 2010: uniform triangle at the tip, semi-uniform quad below it (§3.1)
//   1  the same, barycentrics warped by a quadratic Bezier triangle (§3.2)
//   2  semi-uniform adaptive patches, dyadic (Dyken, Reimers, Seland 2009), Knuth's rival
//   3  uniform at the largest level (Vlachos et al. 2001), Knuth's black line: edges crack where levels differ
//
// Edge vertices stand where girih's do: number m of n at round(m * 32768 / n) / 32768, counted from the nearer
// end, so that both sides agree. Every vertex is the same `precise` function of what it is in the pattern, so
// strips agree along their common lines too.
//
// A triangle may have more vertices than a geometry shader can put out: its strips are dealt to as many parts as
// they fill, and each part is a draw (geometry.c says why not an invocation). The host writes max_vertices into
// the code: SPIR-V has no specialization constant there. GEOMETRY_ROOM is also in geometry.c.
#version 450
#extension GL_GOOGLE_include_directive : require

// The position alone: the components of the built-in block count too.
out gl_PerVertex {
    vec4 gl_Position;
};

#define BENCH_LAST
#include "rival.glsl"

// Of 1024 components, which every device with geometry shaders has: the built-in position 4, normal 3, and the
// front 1 or, captured, the position 3.
#ifdef BENCH_CAPTURE
#define GEOMETRY_ROOM 102
#else
#define GEOMETRY_ROOM 128
#endif
layout(triangles) in;
layout(triangle_strip, max_vertices = GEOMETRY_ROOM) out;

layout(push_constant) uniform Draw {
    uint part;
} draw;

layout(location = 0) in vec3 corner_position[];
layout(location = 1) in vec3 corner_normal[];

const float unit = 1.0 / 32768.0;

// How far edge vertex `at` of n is along its edge; `per` is 32768 / n. Exact up to n = 64.
float edge_share(float at, float n, float per) {
    float rest = n - at;
    precise float share = floor(min(at, rest) * per + 0.5) * unit;
    precise float far_share = 1.0 - share;
    return at <= rest ? share : far_share;
}

// --- Patterns: strips of two lines each, whose vertices alternate -------------------------------

#if GEOMETRY_METHOD == 0 || GEOMETRY_METHOD == 1

// After the rotation: corners A, B at the base, C on top.
struct Pattern {
    float base, right, left; // segments of AB, BC, CA
    float tip;               // resolution of the triangle part
    bool turned;             // the quad lies on the edge of the highest level (Figure 6)
    float lines;             // strips of the quad part
    float first, last;       // resolution of its first and last line
    float steps;             // of its strips: the larger of both
    float per_base, per_right, per_left, per_lines, per_steps;
};

uint rotation(uvec3 segments) {
    uint low = min(segments.x, min(segments.y, segments.z));
    uint high = max(segments.x, max(segments.y, segments.z));
    uint middle = segments.x + segments.y + segments.z - low - high;
    // The lowest level goes to the base (§3.1.1), in the special case the highest (§3.1.2).
    uint base = low == middle ? high : low;
    return segments.x == base ? 0u : segments.y == base ? 1u : 2u;
}

Pattern make_pattern(uvec3 segments) {
    Pattern p;
    p.base = float(segments.x);
    p.right = float(segments.y);
    p.left = float(segments.z);
    p.turned = segments.x > segments.y;
    // The triangle has the base's resolution, the quad has the rest of both sides: their difference to the
    // base is all it must bridge. Turned, it bridges base and triangle, and both sides are alike; how much
    // of them it takes the paper leaves open: half.
    p.tip = p.turned ? float(segments.y >> 1) : p.base;
    p.lines = p.turned ? p.right - p.tip : p.base;
    p.first = p.turned ? p.base : p.left - p.base;
    p.last = p.turned ? p.tip : p.right - p.base;
    p.steps = max(p.first, p.last);
    p.lines = p.steps > 0.0 ? p.lines : 0.0;
    p.per_base = 32768.0 / p.base;
    p.per_right = 32768.0 / p.right;
    p.per_left = 32768.0 / p.left;
    p.per_lines = 1.0 / max(p.lines, 1.0);
    p.per_steps = 1.0 / max(p.steps, 1.0);
    return p;
}

uint strip_count(Pattern p) {
    return uint(p.tip + p.lines);
}

// Vertices of a strip: the triangle part's first.
uint strip_length(Pattern p, uint strip) {
    return strip < uint(p.tip) ? 2u * strip + 3u : 2u * uint(p.steps) + 2u;
}

vec3 strip_vertex(Pattern p, uint strip, uint number) {
    float side = float(number & 1u);
    float along = float(number >> 1);
    bool tip = strip < uint(p.tip);
    // The line that the vertex is on, and its place there: k of n. The strips of the triangle part run from
    // right to left, those of the quad from bottom to top, turned from left to right: so they wind as the
    // input does. In the quad, n goes evenly from the first line's resolution to the last's and vertices
    // snap to the nearest of n (Figure 7); only a line that is a point has none.
    float row = float(strip) + 1.0 - side;
    float line = float(strip) - p.tip + (p.turned ? 1.0 - side : side);
    precise float resolution = max(floor((p.first + (p.last - p.first) * (line * p.per_lines)) + 0.5), 1.0);
    precise float snapped = floor(along * resolution * p.per_steps + 0.5);
    float n = tip ? row : resolution;
    float k = tip ? row - along : snapped;
    // Every vertex is on a straight line from edge CA to edge BC: how far up it begins and ends, in segments
    // of these edges, and how far along it is.
    precise float left_step = (p.left - p.base) / resolution * k;
    precise float right_step = (p.right - p.base) / resolution * k;
    bool on_top = k == resolution;
    bool across = tip || p.turned;
    float left = tip ? p.left - row : p.turned ? line : on_top ? p.left - p.base : left_step;
    float right = tip ? p.right - row : p.turned ? line : on_top ? p.right - p.base : right_step;
    float whole = max(across ? n : p.base, 1.0);
    precise float per = 32768.0 / whole;
    float share = edge_share(across ? k : line, whole, per);
    float begin = edge_share(left, p.left, p.per_left);
    float end = edge_share(right, p.right, p.per_right);
    precise float rest = 1.0 - share;
    precise vec3 place = vec3(rest * (1.0 - begin), share * (1.0 - end), rest * begin + share * end);
    return place;
}

#else

struct Pattern {
    uint segments;
    float per_segment;
    ivec3 spacing; // per edge, how many of the uniform grid's segments are one of the edge's
};

uint rotation(uvec3 segments) {
    return 0u;
}

Pattern make_pattern(uvec3 segments) {
    Pattern p;
    p.segments = max(segments.x, max(segments.y, segments.z));
    p.per_segment = 32768.0 / float(p.segments);
#if GEOMETRY_METHOD == 2
    uvec3 shift = uvec3(findMSB(p.segments)) - uvec3(findMSB(segments));
    p.spacing = ivec3(1) << ivec3(shift);
#endif
    return p;
}

uint strip_count(Pattern p) {
    return p.segments;
}

uint strip_length(Pattern p, uint strip) {
    return 2u * strip + 3u;
}

// The nearest vertex of the edge; from the middle between two, the one at the nearer end, so that an edge is
// the same from both ends.
int snap(int at, int n, int spacing) {
    int near = min(at, n - at);
    int there = (near + (spacing >> 1) - int(spacing > 1)) & ~(spacing - 1);
    return near == at ? there : n - there;
}

vec3 strip_vertex(Pattern p, uint strip, uint number) {
    int n = int(p.segments);
    int row = int(strip + 1u - (number & 1u));
    int k = row - int(number >> 1);
    ivec3 place = ivec3(row - k, k, n - row);
#if GEOMETRY_METHOD == 2
    if (place.x == 0) {
        place.y = snap(place.y, n, p.spacing.y);
        place.z = n - place.y;
    } else if (place.y == 0) {
        place.z = snap(place.z, n, p.spacing.z);
        place.x = n - place.z;
    } else if (place.z == 0) {
        place.x = snap(place.x, n, p.spacing.x);
        place.y = n - place.x;
    }
    return vec3(place) * (p.per_segment * unit); // exact: n is a power of two
#else
    // As girih's uniform family rounds: the largest takes what is left of the whole.
    vec3 at = vec3(place);
    vec3 share = vec3(edge_share(at.x, float(n), p.per_segment), edge_share(at.y, float(n), p.per_segment),
                      edge_share(at.z, float(n), p.per_segment));
    bool first = place.x >= place.y && place.x >= place.z;
    bool second = !first && place.y >= place.z;
    return vec3(first ? 1.0 - share.y - share.z : share.x, second ? 1.0 - share.x - share.z : share.y,
                first || second ? share.z : 1.0 - share.x - share.y);
#endif
}

#endif

// --- Warping (§3.2) -----------------------------------------------------------------------------

#if GEOMETRY_METHOD == 1

// The level of a vertex, from the vertex alone, so that both sides of an edge warp it alike: §4.1's silhouette
// rule, 1 where the surface faces the viewer, the largest where it is seen edge-on. (The edges' levels are
// girih's, which knows none for vertices.)
float vertex_level(vec3 p, vec3 n) {
    vec3 towards = girih_frame.eye.w != 0.0 ? p - girih_frame.eye.xyz : bench_view.rows[2].xyz;
    float facing = abs(girih_dot(girih_normalize(towards), n));
    precise float level = 1.0 + float(girih_level_segments(girih_frame.level_count - 1u) - 1u) * (1.0 - facing);
    return max(level, 1.0);
}

// How near a corner the control point of an edge is: (8) to (13), with the misprints of (10) and (11) mended.
float warp_weight(float own, float other) {
    precise float weight = own / (own + other);
    return weight;
}

struct Warp {
    float w210, w120, w021, w012, w201, w102;
};

Warp make_warp(float level[3]) {
    Warp w;
    w.w210 = warp_weight(level[0], level[1]);
    w.w120 = warp_weight(level[1], level[0]);
    w.w021 = warp_weight(level[1], level[2]);
    w.w012 = warp_weight(level[2], level[1]);
    w.w201 = warp_weight(level[0], level[2]);
    w.w102 = warp_weight(level[2], level[0]);
    return w;
}

// (3), (4) with the factor 2 that the printed formula lacks. On an edge one barycentric is 0, its terms
// vanish, and what is left depends on the edge's two levels alone.
vec3 warped(Warp w, vec3 b) {
    precise float uv = b.x * b.y;
    precise float vw = b.y * b.z;
    precise float wu = b.z * b.x;
    precise vec3 place = vec3(b.x * b.x + (w.w210 * uv + w.w201 * wu) * 2.0,
                              b.y * b.y + (w.w120 * uv + w.w021 * vw) * 2.0,
                              b.z * b.z + (w.w012 * vw + w.w102 * wu) * 2.0);
    return place;
}

#endif

// --- The shader ---------------------------------------------------------------------------------

uint edge_segments(uint from, uint to) {
    uint segments = girih_level_segments(bench_edge_level(corner_position[from], corner_position[to]));
#if GEOMETRY_METHOD == 2
    segments = 1u << uint(findMSB(segments - 1u) + 1); // the next power of two
#endif
    return segments;
}

void put_out(Pattern pattern, uint turn, uint strip, uint count) {
    vec3 p[3];
    vec3 n[3];
    for (uint corner = 0u; corner < 3u; ++corner) {
        uint next = corner == 2u ? 0u : corner + 1u;
        uint after = next == 2u ? 0u : next + 1u;
        p[corner] = turn == 0u ? corner_position[corner]
                               : turn == 1u ? corner_position[next] : corner_position[after];
        n[corner] = turn == 0u ? corner_normal[corner] : turn == 1u ? corner_normal[next] : corner_normal[after];
    }
    GirihPatch patch_ = bench_patch(p, n);
#if GEOMETRY_METHOD == 1
    float level[3];
    for (uint corner = 0u; corner < 3u; ++corner) {
        level[corner] = vertex_level(p[corner], n[corner]);
    }
    Warp warp = make_warp(level);
#endif
    uint number = 0u;
    // One loop for all strips, not one in another: triangles that run side by side keep in step, whatever
    // the lengths of their strips.
    for (uint vertex = 0u; vertex < count; ++vertex) {
        vec3 place = strip_vertex(pattern, strip, number);
#if GEOMETRY_METHOD == 1
        place = warped(warp, place);
#endif
        bench_surface_vertex(patch_, place);
        EmitVertex();
        ++number;
        if (number == strip_length(pattern, strip)) {
            EndPrimitive();
            ++strip;
            number = 0u;
        }
    }
}

void main() {
    uvec3 edges = uvec3(edge_segments(0u, 1u), edge_segments(1u, 2u), edge_segments(2u, 0u));
    uint turn = rotation(edges);
    Pattern pattern = make_pattern(turn == 0u ? edges : turn == 1u ? edges.yzx : edges.zxy);
    // This part's strips, and how many vertices they have.
    uint first = 0u;
    uint count = 0u;
    uint filled = 0u;
    uint full = 0u;
    uint strips = strip_count(pattern);
    for (uint strip = 0u; strip < strips && filled <= draw.part; ++strip) {
        uint vertices = strip_length(pattern, strip);
        if (full + vertices > GEOMETRY_ROOM) {
            ++filled;
            full = 0u;
        }
        full += vertices;
        if (filled == draw.part) {
            first = full == vertices ? strip : first;
            count = full;
        }
    }
    // A loop, since a CPU device leaves one out where a branch is run through regardless.
    for (uint once = 0u; once < min(count, 1u); ++once) {
        put_out(pattern, turn, first, count);
    }
}
