// What the cases of girih-bench share: a frame of each method, timed in alternating pairs.
#ifndef GIRIH_BENCH_H
#define GIRIH_BENCH_H

#include <jansson.h>

#include "device.h"
#include "girih/girih.h"

// Geometry alone (rasteriser discard), or 1024 x 1024 pixels of colour and depth.
typedef enum bench_raster { BENCH_GEOMETRY, BENCH_SHADED } bench_raster;
#define BENCH_PIXELS 1024u

// One way of drawing the same triangles.
typedef struct bench_method {
    const char *name;
    void *state;
    // Records what the frame needs before its render pass; may be NULL.
    girih_result (*prepare)(void *state, VkCommandBuffer commands, uint32_t frame,
                            girih_error *error);
    // Records the draws inside the render pass; the pipeline of the raster mode is bound.
    void (*draw)(void *state, VkCommandBuffer commands);
    const VkPipelineVertexInputStateCreateInfo *vertex_input;
    const uint32_t *vertex_shader;
    size_t vertex_shader_bytes;
} bench_method;

// Render targets and pipelines for one list of methods.
typedef struct bench_target bench_target;
girih_result bench_target_create(girih_device *device, const bench_method *methods,
                                 uint32_t method_count, bench_target **target, girih_error *error);
void bench_target_destroy(bench_target *target);

// Records and submits one frame of a method and waits for it; *milliseconds from the begin of the
// recording to the end of the wait.
girih_result bench_frame(bench_target *target, uint32_t method, bench_raster raster, uint32_t frame,
                         double *milliseconds, girih_error *error);

// Every method against method 0, in alternating runs: two warm-up frames each, then `pairs` pairs.
// Adds {"geometry":{...},"shaded":{...}} for each method's name to `methods`.
girih_result bench_measure(bench_target *target, const bench_method *list, uint32_t method_count,
                           uint32_t pairs, json_t *methods, girih_error *error);

// The cases: each appends one or more objects to `cases`.
girih_result bench_spheres(girih_device *device, uint32_t pairs, json_t *cases, girih_error *error);
girih_result bench_instances(girih_device *device, uint32_t pairs, json_t *cases,
                             girih_error *error);

#endif
