// The limit: the refined triangles as one static, welded, vertex-cache-optimised, indexed draw with
// the same attributes.
#include <stdlib.h>
#include <string.h>

#include <meshoptimizer.h>

#include "error.h"
#include "methods.h"

#include "bench_shaders.h"

typedef struct static_mesh {
    const bench_job *job;
    bench_layout layout;
    VkPipeline pipelines[BENCH_RASTERS];
    girih_device_buffer positions, normals, indices;
    uint32_t index_count;
} static_mesh;

static void destroy(void *state) {
    static_mesh *s = state;
    if (!s) {
        return;
    }
    bench_pipelines_destroy(s->job->target, s->pipelines);
    bench_layout_destroy(s->job->target, &s->layout);
    girih_device_buffer_destroy(s->job->device, &s->positions);
    girih_device_buffer_destroy(s->job->device, &s->normals);
    girih_device_buffer_destroy(s->job->device, &s->indices);
    free(s);
}

// Vertex cache order, then vertex fetch order.
static girih_result optimize(girih_cpu_output *output, girih_error *error) {
    const size_t vertices = output->statistics.output_vertices;
    const size_t indices = 3 * output->statistics.output_triangles;
    uint32_t *remap = malloc(vertices * 4 + 1);
    if (!remap) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    meshopt_optimizeVertexCache(output->indices, output->indices, indices, vertices);
    meshopt_optimizeVertexFetchRemap(remap, output->indices, indices, vertices);
    meshopt_remapIndexBuffer(output->indices, output->indices, indices, remap);
    meshopt_remapVertexBuffer(output->positions, output->positions, vertices, 12, remap);
    meshopt_remapVertexBuffer(output->attributes, output->attributes, vertices, 12, remap);
    free(remap);
    return GIRIH_OK;
}

static girih_result upload(static_mesh *s, const girih_cpu_output *output, girih_error *error) {
    const size_t vertex_bytes = output->statistics.output_vertices * 12;
    const size_t index_bytes = output->statistics.output_triangles * 12;
    const struct {
        girih_device_buffer *buffer;
        const void *bytes;
        VkDeviceSize size;
        VkBufferUsageFlags usage;
    } parts[3] = {
        {&s->positions, output->positions, vertex_bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT},
        {&s->normals, output->attributes, vertex_bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT},
        {&s->indices, output->indices, index_bytes, VK_BUFFER_USAGE_INDEX_BUFFER_BIT}};
    girih_result result = GIRIH_OK;
    for (int n = 0; n < 3 && result == GIRIH_OK; ++n) {
        result = girih_device_buffer_create(s->job->device, parts[n].buffer, parts[n].size,
                                            parts[n].usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                            GIRIH_MEMORY_DEVICE, error);
        if (result == GIRIH_OK) {
            result = girih_device_write(s->job->device, parts[n].buffer->buffer, parts[n].bytes,
                                        parts[n].size, error);
        }
    }
    s->index_count = (uint32_t)(3 * output->statistics.output_triangles);
    return result;
}

// The refined mesh of the reference frame, made by the CPU twin.
static girih_result make_mesh(static_mesh *s, girih_error *error) {
    const bench_job *job = s->job;
    const girih_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const girih_cpu_desc desc = {.meshes = &job->mesh,
                                 .mesh_count = 1,
                                 .instances = &instance,
                                 .instance_count = 1,
                                 .catalogue = job->catalogue,
                                 .surface = job->surface,
                                 .mode = GIRIH_MODE_WELDED};
    girih_cpu_output output = {0};
    girih_result result = girih_cpu_refine(&desc, &job->reference, &output, error);
    if (result == GIRIH_OK) {
        result = optimize(&output, error);
    }
    if (result == GIRIH_OK) {
        result = upload(s, &output, error);
    }
    girih_cpu_output_free(&output);
    return result;
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    (void)variant;
    static_mesh *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    s->job = job;
    girih_result result = make_mesh(s, error);
    if (result == GIRIH_OK) {
        result = bench_layout_create(job->target, NULL, 0, 0, &s->layout, error);
    }
    if (result == GIRIH_OK) {
        static const VkVertexInputBindingDescription bindings[2] = {{0, 12, 0}, {1, 12, 0}};
        static const VkVertexInputAttributeDescription attributes[2] = {
            {0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0}, {1, 1, VK_FORMAT_R32G32B32_SFLOAT, 0}};
        static const VkPipelineVertexInputStateCreateInfo input = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
            .vertexBindingDescriptionCount = 2,
            .pVertexBindingDescriptions = bindings,
            .vertexAttributeDescriptionCount = 2,
            .pVertexAttributeDescriptions = attributes};
        const bench_pipeline_desc desc = {.vertex = bench_shader_baked,
                                          .capture = bench_shader_baked_capture,
                                          .input = &input,
                                          .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
                                          .layout = s->layout.layout};
        result = bench_pipelines_create(job->target, &desc, s->pipelines, error);
    }
    if (result != GIRIH_OK) {
        destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const static_mesh *s = state;
    const VkBuffer buffers[2] = {s->positions.buffer, s->normals.buffer};
    const VkDeviceSize offsets[2] = {0, 0};
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipelines[raster]);
    bench_bind_layout(s->job->target, commands, &s->layout, VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdBindVertexBuffers(commands, 0, 2, buffers, offsets);
    vkCmdBindIndexBuffer(commands, s->indices.buffer, 0, VK_INDEX_TYPE_UINT32);
    bench_begin_draws(s->job->target, commands, raster);
    vkCmdDrawIndexed(commands, s->index_count, 1, 0, 0, 0);
    bench_end_draws(s->job->target, commands, raster);
}

const bench_method bench_static = {.name = "static",
                                   .follows = "a mesh refined beforehand: the limit",
                                   .create = create,
                                   .destroy = destroy,
                                   .draw = draw};
