// What the three passes of dynamic mesh refinement share (Lorenz and Doellner 2008). Vulkan reads any buffer as
// storage, where the paper's Direct3D 10 needs buffer textures.
#ifndef BENCH_DMR_GLSL
#define BENCH_DMR_GLSL

#include "girih_permutation.h"

// Three words for each triangle of the input: the pattern p, and how many subtriangles it has, s_r, and had in
// the previous frame, s_p (section 4.3).
#define DMR_SELECTION_WORDS 3u

// A vertex of the intermediate mesh is three words: the triangle i of the input; the subtriangle j within its
// pattern with lambda and a mark for hidden triangles; u | v << 16, over 32768 (section 4.4).
#define DMR_LAMBDA_SHIFT 24u
#define DMR_HIDDEN 0x80000000u
#define DMR_SUBTRIANGLE 0xffffffu

#endif
