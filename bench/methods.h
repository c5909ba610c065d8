// Every method there is.
#ifndef GIRIH_BENCH_METHODS_H
#define GIRIH_BENCH_METHODS_H

#include "method.h"

extern const bench_method bench_static;

// One draw a triangle.
extern const bench_method bench_ark; // patterns chosen on the CPU
extern const bench_method bench_arp; // patterns chosen on the GPU and read back

// Dynamic mesh refinement: with the paper's limit of growth, which cracks, and one that does not.
extern const bench_method bench_dmr;
extern const bench_method bench_dmr_symmetric;
// The paper's with larger and larger output limits of the update pass, its Figure 8.
#define BENCH_DMR_LIMITS 7
extern const bench_method bench_dmr_output_limits[BENCH_DMR_LIMITS];
// What these drew in the last waited-for frame.
typedef struct bench_dmr_audit {
    uint64_t seen_triangles; // all but the hidden ones
    uint64_t cracked_edges; // edges of the input whose triangles, unless hidden, split them unalike
} bench_dmr_audit;
girih_result bench_dmr_look(void *state, bench_dmr_audit *audit, girih_error *error);

// girih itself: all stages and the draw, each frame.
extern const bench_method bench_girih; // the mode that it chooses
extern const bench_method bench_girih_baked;
extern const bench_method bench_girih_splits;
extern const bench_method bench_girih_welded;
extern const bench_method bench_girih_instanced;
extern const bench_method bench_girih_built_in;  // with another catalogue than the job's
extern const bench_method bench_girih_unchanged; // refined once, drawn again each frame
extern const bench_method bench_girih_displaced; // baked, with waves on the base surface

// Their functions, for methods of girih's with a scene of their own: the state of a plan that
// `plan` describes, in the scene's context, with pipelines for its mode and surface.
girih_result bench_girih_create(const bench_job *job, const girih_context *context,
                                const girih_plan_desc *plan, void **state, girih_error *error);
void bench_girih_destroy(void *state);
girih_result bench_girih_prepare(void *state, VkCommandBuffer commands, girih_error *error);
void bench_girih_draw(void *state, VkCommandBuffer commands, bench_raster raster);
bool bench_girih_overflow(void *state);

// Geometry shaders.
extern const bench_method bench_knuth;
extern const bench_method bench_knuth_warped;
extern const bench_method bench_suapt;
extern const bench_method bench_uniform_pn;

// Tessellation control and evaluation stages.
extern const bench_method bench_hardware;            // equal spacing
extern const bench_method bench_hardware_fractional; // fractional odd spacing

#endif
