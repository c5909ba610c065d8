// Frames of a plan on the GPU: all that the stages wrote read back, and what a host's vertex shader
// sees of the draw captured by transform feedback. What cannot be done prints why and exits, as
// gpu.h's.
#ifndef GIRIH_TEST_GPU_FRAME_H
#define GIRIH_TEST_GPU_FRAME_H

#include "context.h"
#include "gpu.h"

// What every GPU test asks of its context.
typedef struct gpu_variant {
    int linear; // catalogue
    girih_sort sort;
    int few_buffers;
} gpu_variant;
girih_context *gpu_variant_context(gpu *gpu, gpu_variant variant);

// The plan's arrays and outputs as the last gpu_refine read them: host memory, as large as the
// plan's buffers are. Zero-initialised before the first use.
typedef struct gpu_readback {
    gpu_buffer buffer;
    const uint32_t *words[GIRIH_BIND_COUNT]; // from INSTANCES on; NULL where there is none
} gpu_readback;

// Runs one frame and reads everything back; the outputs are filled with 0xa5a5a5a5 before.
void gpu_refine(gpu *gpu, girih_plan *plan, const girih_frame *frame, gpu_readback *readback);
void gpu_readback_free(gpu *gpu, gpu_readback *readback);

// --- Capture: the triangles that a draw hands to the rasteriser
// -------------------------------------

// The pipeline, of a capture's, that draws baked and welded vertices.
#define GPU_CAPTURE_BUFFERS 4

// Floats of a captured corner: position, normal, and 2 attributes.
#define GPU_CAPTURE_FLOATS 8

// An own surface's vertex shaders (shaders/capture.vert) for the instanced mode: as it is, with the
// previous frame's positions, and where triangles may be split; its set is bound as set 1. Words of the caller's.
typedef struct gpu_own_shader {
    const uint32_t *words[3];
    size_t bytes[3];
    VkDescriptorSetLayout layout;
    VkDescriptorSet set;
} gpu_own_shader;

// Pipelines of one context for meshes of 2 attribute floats, made when they are first used. Plans
// with GIRIH_OUTPUT_PREVIOUS have another vertex input and are not drawn.
typedef struct gpu_capture {
    gpu *gpu;
    const girih_context *context;
    VkRenderPass pass;
    VkFramebuffer framebuffer;
    VkPipelineLayout layout;
    VkPipeline pipelines[8]; // instanced flat, instanced PN, the same where triangles may be split,
                             // from buffers; instanced own, previous, split
    gpu_own_shader own;      // gpu_capture_own
    VkPipelineLayout own_layout;
    bool previous;      // own surfaces: the positions captured are the previous frame's
    gpu_buffer corners; // mapped
    gpu_buffer counter; // mapped
    PFN_vkCmdBindTransformFeedbackBuffersEXT bind;
    PFN_vkCmdBeginTransformFeedbackEXT begin;
    PFN_vkCmdEndTransformFeedbackEXT end;
} gpu_capture;

gpu_capture gpu_capture_open(gpu *gpu, const girih_context *context);
void gpu_capture_close(gpu_capture *capture);
// The own surface that instanced plans are drawn with from now on.
void gpu_capture_own(gpu_capture *capture, const gpu_own_shader *own);

// Refines (unless frame is NULL) and draws all materials in order. Returns the number of triangles;
// their corners stand in capture->corners.mapped until the next call. `room` is the most triangles
// there may be.
uint32_t gpu_draw(gpu_capture *capture, girih_plan *plan, const girih_frame *frame, uint32_t room);
// The same in two parts: recorded into a command buffer of the caller's, counted after it has run.
void gpu_record_draw(gpu_capture *capture, const girih_plan *plan, VkCommandBuffer commands,
                     uint32_t room);
uint32_t gpu_drawn(const gpu_capture *capture);

#endif
