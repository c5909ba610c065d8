// Where the methods draw: images, a render pass, the view's uniform blocks, pipelines, and
// triangles captured by transform feedback.
#ifndef GIRIH_BENCH_TARGET_H
#define GIRIH_BENCH_TARGET_H

#include "device.h"
#include "girih/girih.h"

// Geometry alone (rasteriser discard); BENCH_PIXELS squared pixels of colour and depth; or geometry
// alone, its triangles captured (not timed).
typedef enum bench_raster { BENCH_GEOMETRY, BENCH_SHADED, BENCH_CAPTURE } bench_raster;
#define BENCH_RASTERS 3
#define BENCH_PIXELS 1024u

// The view as shaders/view.glsl has it.
typedef struct bench_view {
    float rows[4][4]; // world to clip space, by rows
    float eye[4];     // and the rest, with bench_target_use_panorama: one slice of a panorama,
    float forward[4]; // w: half its angle
    float right[4];
    float up[4];
    float slopes[2]; // as panorama.glsl has them
    float depth[2];
} bench_view;

typedef struct bench_target bench_target;
girih_result bench_target_create(girih_device *device, bench_target **target, girih_error *error);
void bench_target_destroy(bench_target *target); // takes NULL

// Pipelines that are made from now on draw a panorama, views' slices, instead of views' rows.
void bench_target_use_panorama(bench_target *target);

// Takes up the view and the levels of the next frames, as far as rivals' shaders read them; no
// frame may be under way.
girih_result bench_target_set_view(bench_target *target, const bench_view *view,
                                   const girih_catalogue *catalogue, const girih_frame *frame,
                                   girih_error *error);

// --- Pipelines ---

typedef struct bench_shader {
    const uint32_t *words; // NULL: there is none
    size_t bytes;
} bench_shader;
// Those of bench/shaders and bench/rivals/shaders are bench_shader_NAME, of the build's shaders.h.

typedef struct bench_pipeline_desc {
    bench_shader vertex, control, evaluation, geometry;
    // The last of these once more, compiled with BENCH_CAPTURE.
    bench_shader capture;
    const VkPipelineVertexInputStateCreateInfo *input; // NULL: nothing
    VkPrimitiveTopology topology;
    uint32_t patch_points; // VK_PRIMITIVE_TOPOLOGY_PATCH_LIST
    VkPipelineLayout layout;
} bench_pipeline_desc;

// The vertex input of a job's vertex buffer: position and normal at locations 0 and 1.
extern const VkPipelineVertexInputStateCreateInfo bench_corner_input;

// One pipeline for each raster mode, with the target's fragment shader, and a dynamic viewport and
// scissor. BENCH_CAPTURE's is VK_NULL_HANDLE where the device has no transform feedback.
girih_result bench_pipelines_create(const bench_target *target, const bench_pipeline_desc *desc,
                                    VkPipeline pipelines[BENCH_RASTERS], girih_error *error);
void bench_pipelines_destroy(const bench_target *target, VkPipeline pipelines[BENCH_RASTERS]);

// A pipeline whose last stage before the rasteriser writes by transform feedback, with nothing
// rasterised: for passes before the one that draws, between bench_feedback_begin and _end.
// `capture` of the description is not looked at.
girih_result bench_feedback_pipeline_create(const bench_target *target,
                                            const bench_pipeline_desc *desc, VkPipeline *pipeline,
                                            girih_error *error);

// A layout with the view as set 0, the method's storage buffers, if it has any, as set 1, and push
// constants, if any, for all stages.
typedef struct bench_layout {
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool pool;
    VkDescriptorSet set; // VK_NULL_HANDLE: there is none
    VkPipelineLayout layout;
} bench_layout;
girih_result bench_layout_create(const bench_target *target, const VkBuffer *storage_buffers,
                                 uint32_t storage_buffer_count, uint32_t push_bytes,
                                 bench_layout *layout, girih_error *error);
void bench_layout_destroy(const bench_target *target, bench_layout *layout);

// The stages that all of it is for, as vkCmdPushConstants must have them.
VkShaderStageFlags bench_target_stages(const bench_target *target);

// Binds the view and the layout's own set.
void bench_bind_layout(const bench_target *target, VkCommandBuffer commands,
                       const bench_layout *layout, VkPipelineBindPoint bind_point);

girih_result bench_compute_pipeline_create(const bench_target *target, bench_shader shader,
                                           VkPipelineLayout layout, VkPipeline *pipeline,
                                           girih_error *error);

// VK_EXT_transform_feedback; NULL where the device does not have it.
typedef struct bench_feedback {
    PFN_vkCmdBindTransformFeedbackBuffersEXT bind;
    PFN_vkCmdBeginTransformFeedbackEXT begin;
    PFN_vkCmdEndTransformFeedbackEXT end;
    PFN_vkCmdDrawIndirectByteCountEXT draw_indirect;
} bench_feedback;
const bench_feedback *bench_target_feedback(const bench_target *target);

// --- Frames ---

// Begins and ends a pass without images, for a feedback pipeline's draws.
void bench_feedback_begin(const bench_target *target, VkCommandBuffer commands);
void bench_feedback_end(const bench_target *target, VkCommandBuffer commands);

// Begins and ends the pass around a method's draws. Where nothing is rasterised only one pixel is
// cleared: the clear of a whole picture costs more than a small frame.
void bench_target_begin(const bench_target *target, VkCommandBuffer commands, bench_raster raster);
void bench_target_end(const bench_target *target, VkCommandBuffer commands);

// Triangles as they were drawn: per corner position and normal.
typedef struct bench_triangles {
    float (*corners)[6]; // [3 * count]; the caller's, to be freed
    uint32_t count;
} bench_triangles;

// Around a method's draws, inside the pass and after its pipeline of the raster mode is bound.
void bench_begin_draws(bench_target *target, VkCommandBuffer commands, bench_raster raster);
void bench_end_draws(bench_target *target, VkCommandBuffer commands, bench_raster raster);

// Capture of what is drawn with BENCH_CAPTURE: room for so many triangles, made before the frame is
// recorded, and reading them once it has been waited for. GIRIH_ERROR_UNSUPPORTED without transform
// feedback, GIRIH_ERROR_TOO_LARGE where there were more.
girih_result bench_capture_reserve(bench_target *target, uint32_t triangles, girih_error *error);
girih_result bench_capture_read(bench_target *target, bench_triangles *triangles,
                                girih_error *error);

// The picture of the last shaded frame, 4 bytes a pixel, the top row first; the caller's.
girih_result bench_target_picture(bench_target *target, uint8_t **rgba, girih_error *error);

#endif
