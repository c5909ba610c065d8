// What the control stage hands to the evaluation stage: each invocation a corner and the edge that starts there, and the
// patch's inner control point. Everything that does not depend on the vertex is computed here, once a patch.
#ifdef BENCH_CONTROL
#define BENCH_HANDED out
#else
#define BENCH_HANDED in
#endif

struct BenchCorner {
    vec3 position;
    vec3 normal;
#if GIRIH_CURVED == 1
    vec3 near_first; // the control points of the edge to the next corner
    vec3 near_last;
    vec3 edge_normal;
#endif
};
layout(location = 0) BENCH_HANDED BenchCorner corners[];
#if GIRIH_CURVED == 1
layout(location = 5) patch BENCH_HANDED vec3 inner_point;
#endif
