#include "adaptive.h"

#include <stdlib.h>
#include <string.h>

#include "cpu_levels.h"
#include "error.h"
#include "girih_permutation.h"
#include "target_private.h"

#include "bench_shaders.h"

// --- Patterns -----------------------------------------------------------------------------------

// Where an adaptive pattern comes from.
typedef struct origin {
    const girih_base_pattern *base;
    uint32_t lambda;
} origin;

static void sort_two(uint32_t *a, uint32_t *b, uint32_t bit, uint32_t *lambda) {
    if (*a < *b) {
        const uint32_t old = *a;
        *a = *b;
        *b = old;
        *lambda += bit;
    }
}

// ARKFPI, Figure 8; at ties the permutation that keeps the winding, as girih has it.
static origin origin_of(const girih_catalogue *catalogue, uint32_t number) {
    const uint32_t levels = catalogue->level_count;
    uint32_t i = number / (levels * levels);
    uint32_t j = number / levels % levels;
    uint32_t k = number % levels;
    uint32_t lambda = 0;
    sort_two(&i, &j, 1, &lambda);
    sort_two(&i, &k, 2, &lambda);
    sort_two(&j, &k, 4, &lambda);
    if (i == j || j == k) {
        lambda = GIRIH_LAMBDA_EVEN(lambda);
    }
    const uint32_t rank = i * (i + 1) * (i + 2) / 6 + j * (j + 1) / 2 + k;
    return (origin){girih_catalogue_pattern(catalogue, rank), lambda};
}

girih_result bench_adaptive_layout(const girih_catalogue *catalogue,
                                   bench_adaptive_patterns *patterns, girih_error *error) {
    const uint64_t levels = catalogue->level_count;
    *patterns = (bench_adaptive_patterns){0};
    if (levels > 256) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE, "%u levels have too many adaptive patterns",
                          catalogue->level_count);
    }
    patterns->pattern_count = (uint32_t)(levels * levels * levels);
    patterns->draws = calloc(patterns->pattern_count, sizeof *patterns->draws);
    if (!patterns->draws) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t n = 0; n < patterns->pattern_count; ++n) {
        const girih_base_pattern *base = origin_of(catalogue, n).base;
        patterns->draws[n] = (bench_pattern_draw){.first_index = (uint32_t)patterns->index_count,
                                                  .index_count = 3 * base->triangle_count,
                                                  .first_vertex = (int32_t)patterns->vertex_count};
        patterns->vertex_count += base->vertex_count;
        patterns->index_count += 3 * (uint64_t)base->triangle_count;
    }
    if (patterns->vertex_count > INT32_MAX || patterns->index_count > UINT32_MAX) {
        bench_adaptive_patterns_free(patterns);
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "the adaptive patterns are more than one buffer can hold");
    }
    patterns->bytes = 4 * (patterns->vertex_count + patterns->index_count);
    patterns->base_bytes = 4 * (catalogue->vertex_count + 3 * catalogue->triangle_count);
    return GIRIH_OK;
}

void bench_adaptive_patterns_free(bench_adaptive_patterns *patterns) {
    free(patterns->draws);
    *patterns = (bench_adaptive_patterns){0};
}

// A base pattern's vertex (u, v, w) lies at Q1 u + Q2 v + Q3 w, where Q are the triangle's corners
// as lambda permutes them: the same weights, by the triangle's own corners.
static uint32_t permuted_vertex(uint32_t packed, uint32_t lambda) {
    uint32_t weights[3];
    const uint32_t u = packed & 0xffffu;
    const uint32_t v = packed >> 16;
    weights[GIRIH_LAMBDA_CORNER_1(lambda)] = u;
    weights[GIRIH_LAMBDA_CORNER_2(lambda)] = v;
    weights[GIRIH_LAMBDA_CORNER_3(lambda)] = GIRIH_BARYCENTRIC_ONE - u - v;
    return weights[0] | weights[1] << 16;
}

static void write_pattern(const girih_catalogue *catalogue, const origin *from,
                          const bench_pattern_draw *draw, uint32_t *vertices, uint32_t *indices) {
    const uint32_t *base = girih_catalogue_vertices(catalogue, from->base);
    for (uint32_t n = 0; n < from->base->vertex_count; ++n) {
        vertices[(size_t)draw->first_vertex + n] = permuted_vertex(base[n], from->lambda);
    }
    // A mirrored pattern's triangles (a, c, b) keep the winding and the first corner.
    const uint32_t odd = GIRIH_LAMBDA_IS_ODD(from->lambda);
    const uint32_t order[3] = {0, odd ? 2 : 1, odd ? 1 : 2};
    for (uint32_t n = 0; n < draw->index_count; ++n) {
        indices[(size_t)draw->first_index + n] =
            girih_catalogue_index(catalogue, from->base, n / 3 * 3 + order[n % 3]);
    }
}

static girih_result upload(girih_device *device, girih_device_buffer *buffer, const void *bytes,
                           VkDeviceSize size, VkBufferUsageFlags usage, girih_error *error) {
    const girih_result result = girih_device_buffer_create(
        device, buffer, size, usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, GIRIH_MEMORY_DEVICE, error);
    return result == GIRIH_OK ? girih_device_write(device, buffer->buffer, bytes, size, error)
                              : result;
}

static girih_result make_patterns(bench_adaptive *a, girih_error *error) {
    const girih_catalogue *catalogue = a->job->catalogue;
    girih_result result = bench_adaptive_layout(catalogue, &a->patterns, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const bench_adaptive_patterns *patterns = &a->patterns;
    const size_t vertex_bytes = 4 * (size_t)patterns->vertex_count;
    const size_t index_bytes = 4 * (size_t)patterns->index_count;
    uint32_t *vertices = malloc(vertex_bytes);
    uint32_t *indices = malloc(index_bytes);
    if (!vertices || !indices) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                            "out of memory for %u adaptive patterns", patterns->pattern_count);
    } else {
        for (uint32_t n = 0; n < patterns->pattern_count; ++n) {
            const origin from = origin_of(catalogue, n);
            write_pattern(catalogue, &from, &patterns->draws[n], vertices, indices);
        }
        result = upload(a->job->device, &a->vertices, vertices, vertex_bytes,
                        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, error);
        if (result == GIRIH_OK) {
            result = upload(a->job->device, &a->indices, indices, index_bytes,
                            VK_BUFFER_USAGE_INDEX_BUFFER_BIT, error);
        }
    }
    free(vertices);
    free(indices);
    return result;
}

// --- Draws --------------------------------------------------------------------------------------

static girih_result make_uniforms(bench_adaptive *a, const float *positions, const float *normals,
                                  const uint32_t *indices, girih_error *error) {
    a->triangles = malloc((size_t)a->triangle_count * sizeof *a->triangles + 1);
    if (!a->triangles) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t n = 0; n < 3 * (size_t)a->triangle_count; ++n) {
        bench_triangle_uniforms *triangle = &a->triangles[n / 3];
        memcpy(triangle->positions[n % 3], positions + 3 * (size_t)indices[n], 12);
        memcpy(triangle->normals[n % 3], normals + 3 * (size_t)indices[n], 12);
    }
    return GIRIH_OK;
}

// The view, and push constants for the vertex stage alone: a driver takes them up again for every
// stage that they are declared for, with every draw.
static girih_result create_layout(const bench_target *target, bench_layout *layout,
                                  girih_error *error) {
    const VkPushConstantRange push = {.stageFlags = VK_SHADER_STAGE_VERTEX_BIT,
                                      .size = sizeof(bench_triangle_uniforms)};
    const VkPipelineLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = 1,
                                             .pSetLayouts = &target->view_layout,
                                             .pushConstantRangeCount = 1,
                                             .pPushConstantRanges = &push};
    const VkResult result =
        vkCreatePipelineLayout(target->device->device, &info, NULL, &layout->layout);
    return result == VK_SUCCESS
               ? GIRIH_OK
               : girih_vulkan_failure(error, "creating the triangles' pipeline layout", result);
}

girih_result bench_adaptive_create(const bench_job *job, const float *positions,
                                   const float *normals, const uint32_t *indices,
                                   uint32_t triangle_count, bench_adaptive *adaptive,
                                   girih_error *error) {
    *adaptive = (bench_adaptive){.job = job, .triangle_count = triangle_count};
    girih_result result = make_patterns(adaptive, error);
    if (result == GIRIH_OK) {
        result = make_uniforms(adaptive, positions, normals, indices, error);
    }
    if (result == GIRIH_OK) {
        result = create_layout(job->target, &adaptive->layout, error);
    }
    if (result == GIRIH_OK) {
        static const VkVertexInputBindingDescription binding = {0, 4, 0};
        static const VkVertexInputAttributeDescription attribute = {0, 0, VK_FORMAT_R32_UINT, 0};
        static const VkPipelineVertexInputStateCreateInfo input = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
            .vertexBindingDescriptionCount = 1,
            .pVertexBindingDescriptions = &binding,
            .vertexAttributeDescriptionCount = 1,
            .pVertexAttributeDescriptions = &attribute};
        const bool pn = job->surface == GIRIH_SURFACE_PN;
        const bench_pipeline_desc desc = {
            .vertex = pn ? bench_shader_ark_pn : bench_shader_ark_flat,
            .capture = pn ? bench_shader_ark_pn_capture : bench_shader_ark_flat_capture,
            .input = &input,
            .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
            .layout = adaptive->layout.layout};
        result = bench_pipelines_create(job->target, &desc, adaptive->pipelines, error);
    }
    return result;
}

void bench_adaptive_destroy(bench_adaptive *adaptive) {
    const bench_job *job = adaptive->job;
    if (!job) {
        return;
    }
    bench_pipelines_destroy(job->target, adaptive->pipelines);
    bench_layout_destroy(job->target, &adaptive->layout);
    girih_device_buffer_destroy(job->device, &adaptive->vertices);
    girih_device_buffer_destroy(job->device, &adaptive->indices);
    bench_adaptive_patterns_free(&adaptive->patterns);
    free(adaptive->triangles);
    *adaptive = (bench_adaptive){.job = NULL};
}

void bench_adaptive_draw(const bench_adaptive *adaptive, VkCommandBuffer commands,
                         bench_raster raster, const uint32_t *selected) {
    const bench_job *job = adaptive->job;
    const VkDeviceSize offset = 0;
    const VkPipelineLayout layout = adaptive->layout.layout;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, adaptive->pipelines[raster]);
    bench_bind_layout(job->target, commands, &adaptive->layout, VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdBindVertexBuffers(commands, 0, 1, &adaptive->vertices.buffer, &offset);
    vkCmdBindIndexBuffer(commands, adaptive->indices.buffer, 0, VK_INDEX_TYPE_UINT32);
    bench_begin_draws(job->target, commands, raster);
    for (uint32_t n = 0; n < adaptive->triangle_count; ++n) {
        if (selected[n] != BENCH_HIDDEN) {
            const bench_pattern_draw *draw = &adaptive->patterns.draws[selected[n]];
            vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_VERTEX_BIT, 0,
                               sizeof *adaptive->triangles, &adaptive->triangles[n]);
            vkCmdDrawIndexed(commands, draw->index_count, 1, draw->first_index, draw->first_vertex,
                             0);
        }
    }
    bench_end_draws(job->target, commands, raster);
}
