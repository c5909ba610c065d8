// Dynamic mesh refinement (Lorenz and Doellner 2008): the refined mesh is kept on the device as a
// plain list of subtriangles, and each frame's is made from the previous frame's. Three passes,
// each one draw: a pattern is selected for every input triangle in a geometry shader (section 4.3),
// every subtriangle puts out its share of the new pattern in another (4.4), and the whole
// intermediate mesh is rendered (4.5).
//
// What is ours:
// - Patterns are stored once for all permutations of their edge levels. The table has an entry for
//   each of the (t_max + 1)^3 patterns, and says how to permute the corners; pass 3 does so. The
//   paper's copies would take 211 MB for levels to 8, more than many devices let a shader read.
// - All passes are of the same frame: the paper draws what was selected two frames ago, to hide
//   dependencies.
// - `dmr` limits the growth of each triangle, as the paper, and cracks while it does; the paper
//   leaves open how, we lower the largest edge levels. `dmr-symmetric` limits each edge by its
//   level in the previous frame, the lowest of all triangles at it, and never cracks; that takes
//   the edges' neighbours, an output limit of what the catalogue can grow by, and hidden triangles
//   that keep the levels of edges which others are seen at.
// - Other hidden triangles are one subtriangle, as in the paper. None is put out with any area.
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "girih_permutation.h"
#include "methods.h"

#include "bench_shaders.h"

#define VERTEX_BYTES 12u // shaders/dmr.glsl
#define TRIANGLE_BYTES (3 * VERTEX_BYTES)
#define SELECTION_BYTES 12u
#define HIDDEN 0x80000000u
#define CRACKED (UINT32_MAX - 1) // instead of an edge's level
#define PAPER_GROWTH 4u          // s_r / s_p

// floor(j s_r / s_p) is worked out in 32 bits.
#define MOST_SUBTRIANGLES 65536u

static const struct {
    uint32_t vertices;
    const bench_shader *shader;
} output_limits[] = {{12, &bench_shader_dmr_update_12},  {18, &bench_shader_dmr_update_18},
                     {24, &bench_shader_dmr_update_24},  {48, &bench_shader_dmr_update_48},
                     {96, &bench_shader_dmr_update_96},  {192, &bench_shader_dmr_update_192},
                     {255, &bench_shader_dmr_update_255}};
#define LIMIT_COUNT (sizeof output_limits / sizeof *output_limits)

// A method's variant: the index of an output limit, or this.
#define SYMMETRIC (-1)

typedef struct dmr {
    const bench_job *job;
    bench_layout layouts[2]; // of the passes 1 and 2, by the frame's parity
    bench_layout draw_layout;
    VkPipeline select, update;
    VkPipeline pipelines[BENCH_RASTERS];
    // Of this frame and the previous one, in turn.
    girih_device_buffer selections[2];
    girih_device_buffer meshes[2];
    girih_device_buffer counters[2]; // bytes of the mesh
    girih_device_buffer table;
    girih_device_buffer patterns;
    girih_device_buffer around;
    // As pass 1 has them.
    struct {
        uint32_t growth;
        uint32_t others;
    } push;
    uint32_t latest;
    uint32_t room; // triangles of the intermediate mesh; it must not be full
} dmr;

static void destroy(void *state) {
    dmr *s = state;
    if (!s) {
        return;
    }
    const bench_job *job = s->job;
    bench_pipelines_destroy(job->target, s->pipelines);
    vkDestroyPipeline(job->device->device, s->select, NULL);
    vkDestroyPipeline(job->device->device, s->update, NULL);
    bench_layout_destroy(job->target, &s->draw_layout);
    for (int n = 0; n < 2; ++n) {
        bench_layout_destroy(job->target, &s->layouts[n]);
        girih_device_buffer_destroy(job->device, &s->selections[n]);
        girih_device_buffer_destroy(job->device, &s->meshes[n]);
        girih_device_buffer_destroy(job->device, &s->counters[n]);
    }
    girih_device_buffer_destroy(job->device, &s->table);
    girih_device_buffer_destroy(job->device, &s->patterns);
    girih_device_buffer_destroy(job->device, &s->around);
    free(s);
}

static girih_result upload(const bench_job *job, girih_device_buffer *buffer, const void *bytes,
                           size_t size, VkBufferUsageFlags usage, girih_error *error) {
    girih_result result = girih_device_buffer_create(job->device, buffer, size,
                                                     usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                                     GIRIH_MEMORY_DEVICE, error);
    if (result == GIRIH_OK) {
        result = girih_device_write(job->device, buffer->buffer, bytes, size, error);
    }
    return result;
}

// --- Patterns -----------------------------------------------------------------------------------

// A pattern as pass 1 and 2 look it up.
typedef struct table_entry {
    uint32_t count;
    uint32_t place; // first subtriangle << 3 | lambda
} table_entry;

static void pattern_levels(uint32_t p, uint32_t level_count, uint32_t levels[3]) {
    levels[0] = p / (level_count * level_count);
    levels[1] = p / level_count % level_count;
    levels[2] = p % level_count;
}

// The base pattern of three edge levels, which are sorted (ARKFPI, Figure 8), and its lambda, ties
// with the even one.
static uint32_t sorted_rank(uint32_t levels[3], uint32_t *lambda) {
    static const uint32_t swaps[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    *lambda = 0;
    for (uint32_t n = 0; n < 3; ++n) {
        uint32_t *a = &levels[swaps[n][0]];
        uint32_t *b = &levels[swaps[n][1]];
        if (*a < *b) {
            const uint32_t less = *a;
            *a = *b;
            *b = less;
            *lambda += 1u << n;
        }
    }
    if (levels[0] == levels[1] || levels[1] == levels[2]) {
        *lambda = GIRIH_LAMBDA_EVEN(*lambda);
    }
    return levels[0] * (levels[0] + 1) * (levels[0] + 2) / 6 + levels[1] * (levels[1] + 1) / 2 +
           levels[2];
}

static void fill_table(const girih_catalogue *catalogue, const uint32_t *firsts,
                       table_entry *table) {
    const uint32_t count = catalogue->level_count;
    for (uint32_t p = 0; p < count * count * count; ++p) {
        uint32_t levels[3];
        uint32_t lambda;
        pattern_levels(p, count, levels);
        const uint32_t rank = sorted_rank(levels, &lambda);
        table[p] = (table_entry){girih_catalogue_pattern(catalogue, rank)->triangle_count,
                                 firsts[rank] << 3 | lambda};
    }
}

// What each triangle may grow by where each of its edges grows by one level. Finer edges must never
// take fewer subtriangles, or an edge that is limited could make the pattern larger.
static girih_result find_growth(const girih_catalogue *catalogue, const table_entry *table,
                                uint32_t *growth, girih_error *error) {
    const uint32_t count = catalogue->level_count;
    const uint32_t steps[3] = {count * count, count, 1};
    *growth = PAPER_GROWTH;
    for (uint32_t p = 0; p < count * count * count; ++p) {
        uint32_t levels[3];
        uint32_t finer = p;
        pattern_levels(p, count, levels);
        for (int n = 0; n < 3; ++n) {
            if (levels[n] + 1 == count) {
                continue;
            }
            finer += steps[n];
            if (table[p + steps[n]].count < table[p].count) {
                return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                                  "dmr-symmetric: pattern [%u,%u,%u] has more triangles than one "
                                  "with a finer edge",
                                  levels[0], levels[1], levels[2]);
            }
        }
        const uint32_t grows = (table[finer].count + table[p].count - 1) / table[p].count;
        *growth = grows > *growth ? grows : *growth;
    }
    return GIRIH_OK;
}

static void fill_patterns(const girih_catalogue *catalogue, uint32_t *firsts, uint32_t *vertices) {
    uint32_t first = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; ++rank) {
        const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
        const uint32_t *packed = girih_catalogue_vertices(catalogue, pattern);
        firsts[rank] = first;
        for (uint32_t n = 0; n < 3 * pattern->triangle_count; ++n) {
            vertices[3 * (size_t)first + n] = packed[girih_catalogue_index(catalogue, pattern, n)];
        }
        first += pattern->triangle_count;
    }
}

static girih_result upload_patterns(dmr *s, bool symmetric, girih_error *error) {
    const girih_catalogue *catalogue = s->job->catalogue;
    const size_t entries =
        (size_t)catalogue->level_count * catalogue->level_count * catalogue->level_count;
    const size_t pattern_bytes = catalogue->triangle_count * 12;
    uint32_t *firsts = malloc(catalogue->pattern_count * sizeof *firsts);
    uint32_t *vertices = malloc(pattern_bytes);
    table_entry *table = malloc(entries * sizeof *table);
    girih_result result = GIRIH_OK;
    if (!firsts || !vertices || !table) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        fill_patterns(catalogue, firsts, vertices);
        fill_table(catalogue, firsts, table);
        s->push.growth = PAPER_GROWTH;
        if (symmetric) {
            result = find_growth(catalogue, table, &s->push.growth, error);
        }
        if (result == GIRIH_OK) {
            result = upload(s->job, &s->patterns, vertices, pattern_bytes,
                            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, error);
        }
        if (result == GIRIH_OK) {
            result = upload(s->job, &s->table, table, entries * sizeof *table,
                            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, error);
        }
    }
    free(table);
    free(vertices);
    free(firsts);
    return result;
}

// --- The input ----------------------------------------------------------------------------------

// Links the triangles' edges that lie on one edge of the mesh, by position, into a ring.
static girih_result upload_around(dmr *s, girih_error *error) {
    const bench_job *job = s->job;
    const girih_mesh *mesh = job->mesh;
    const size_t count = 3 * (size_t)job->triangle_count;
    uint32_t *around = malloc(count * 4);
    uint32_t *last = malloc((size_t)mesh->edge_count * 4 + 1);
    girih_result result = GIRIH_OK;
    if (!around || !last) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        for (uint32_t n = 0; n < count; ++n) {
            around[n] = n;
        }
        memset(last, 0xff, (size_t)mesh->edge_count * 4);
        for (uint32_t n = 0; n < 3 * mesh->triangle_count; ++n) {
            const uint32_t own = 3 * mesh->triangle_source[n / 3] + n % 3;
            uint32_t *other = &last[mesh->triangle_edges[n]];
            if (*other != UINT32_MAX) {
                around[own] = around[*other];
                around[*other] = own;
            }
            *other = own;
            const uint32_t others = mesh->edge_uses[mesh->triangle_edges[n]] - 1u;
            s->push.others = others > s->push.others ? others : s->push.others;
        }
        result =
            upload(job, &s->around, around, count * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, error);
    }
    free(last);
    free(around);
    return result;
}

// "The intermediate mesh must be initialized once to one subtriangle per original triangle."
static girih_result upload_first_frame(dmr *s, girih_error *error) {
    const uint32_t triangles = s->job->triangle_count;
    uint32_t(*mesh)[3][3] = malloc(triangles * sizeof *mesh);
    uint32_t(*selection)[3] = malloc(triangles * sizeof *selection);
    girih_result result = GIRIH_OK;
    if (!mesh || !selection) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        for (uint32_t n = 0; n < triangles; ++n) {
            const uint32_t corners[3] = {GIRIH_BARYCENTRIC_ONE, GIRIH_BARYCENTRIC_ONE << 16, 0};
            for (int k = 0; k < 3; ++k) {
                mesh[n][k][0] = n;
                mesh[n][k][1] = 0;
                mesh[n][k][2] = corners[k];
            }
            selection[n][0] = 0;
            selection[n][1] = 1;
            selection[n][2] = 1;
        }
        result = girih_device_write(s->job->device, s->meshes[0].buffer, mesh,
                                    triangles * sizeof *mesh, error);
        *(uint32_t *)s->counters[0].mapped = triangles * TRIANGLE_BYTES;
        if (result == GIRIH_OK) {
            result = girih_device_write(s->job->device, s->selections[0].buffer, selection,
                                        triangles * sizeof *selection, error);
        }
    }
    free(selection);
    free(mesh);
    return result;
}

static girih_result create_buffers(dmr *s, girih_error *error) {
    const bench_job *job = s->job;
    girih_result result = GIRIH_OK;
    for (int n = 0; n < 2 && result == GIRIH_OK; ++n) {
        const struct {
            girih_device_buffer *buffer;
            VkDeviceSize size;
            VkBufferUsageFlags usage;
            girih_memory_place place;
        } parts[3] = {{&s->selections[n], (VkDeviceSize)job->triangle_count * SELECTION_BYTES,
                       VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_BUFFER_BIT_EXT |
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                           VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                       GIRIH_MEMORY_DEVICE},
                      {&s->meshes[n], (VkDeviceSize)s->room * TRIANGLE_BYTES,
                       VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_BUFFER_BIT_EXT |
                           VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                       GIRIH_MEMORY_DEVICE},
                      {&s->counters[n], 4,
                       VK_BUFFER_USAGE_TRANSFORM_FEEDBACK_COUNTER_BUFFER_BIT_EXT |
                           VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT,
                       GIRIH_MEMORY_READBACK}};
        for (int k = 0; k < 3 && result == GIRIH_OK; ++k) {
            result = girih_device_buffer_create(job->device, parts[k].buffer, parts[k].size,
                                                parts[k].usage, parts[k].place, error);
        }
    }
    return result;
}

// --- Pipelines ----------------------------------------------------------------------------------

static girih_result create_layouts(dmr *s, girih_error *error) {
    const bench_job *job = s->job;
    girih_result result = GIRIH_OK;
    for (int n = 0; n < 2 && result == GIRIH_OK; ++n) {
        // In the order of the shaders' bindings: reads selection n, makes the other.
        const VkBuffer buffers[5] = {s->selections[n].buffer, s->selections[1 - n].buffer,
                                     s->table.buffer, s->patterns.buffer, s->around.buffer};
        result =
            bench_layout_create(job->target, buffers, 5, sizeof s->push, &s->layouts[n], error);
    }
    if (result == GIRIH_OK) {
        const VkBuffer buffers[2] = {job->index_buffer.buffer, job->vertex_buffer.buffer};
        result = bench_layout_create(job->target, buffers, 2, 0, &s->draw_layout, error);
    }
    return result;
}

static girih_result create_select(dmr *s, bool symmetric, girih_error *error) {
    const bool pn = s->job->surface == GIRIH_SURFACE_PN;
    const bench_shader shaders[2][2] = {
        {bench_shader_dmr_select_flat, bench_shader_dmr_select_pn},
        {bench_shader_dmr_select_symmetric_flat, bench_shader_dmr_select_symmetric_pn}};
    const bench_pipeline_desc desc = {.vertex = bench_shader_corners,
                                      .geometry = shaders[symmetric][pn],
                                      .input = &bench_corner_input,
                                      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
                                      .layout = s->layouts[0].layout};
    return bench_feedback_pipeline_create(s->job->target, &desc, &s->select, error);
}

// The least output limit that serves, where the variant does not name one.
static girih_result create_update(dmr *s, int variant, girih_error *error) {
    size_t limit = variant == SYMMETRIC ? 0 : (size_t)variant;
    while (limit < LIMIT_COUNT && output_limits[limit].vertices < 3 * s->push.growth) {
        ++limit;
    }
    if (limit == LIMIT_COUNT) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED, "dmr: patterns that grow %u-fold at once",
                          s->push.growth);
    }
    static const VkVertexInputBindingDescription binding = {0, VERTEX_BYTES, 0};
    static const VkVertexInputAttributeDescription subtriangle = {0, 0, VK_FORMAT_R32G32_UINT, 0};
    static const VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 1,
        .pVertexBindingDescriptions = &binding,
        .vertexAttributeDescriptionCount = 1,
        .pVertexAttributeDescriptions = &subtriangle};
    const bench_pipeline_desc desc = {.vertex = bench_shader_dmr_subtriangle,
                                      .geometry = *output_limits[limit].shader,
                                      .input = &input,
                                      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
                                      .layout = s->layouts[0].layout};
    return bench_feedback_pipeline_create(s->job->target, &desc, &s->update, error);
}

static girih_result create_draw(dmr *s, girih_error *error) {
    static const VkVertexInputBindingDescription binding = {0, VERTEX_BYTES, 0};
    static const VkVertexInputAttributeDescription vertex = {0, 0, VK_FORMAT_R32G32B32_UINT, 0};
    static const VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 1,
        .pVertexBindingDescriptions = &binding,
        .vertexAttributeDescriptionCount = 1,
        .pVertexAttributeDescriptions = &vertex};
    const bool pn = s->job->surface == GIRIH_SURFACE_PN;
    const bench_pipeline_desc desc = {
        .vertex = pn ? bench_shader_dmr_draw_pn : bench_shader_dmr_draw_flat,
        .capture = pn ? bench_shader_dmr_draw_pn_capture : bench_shader_dmr_draw_flat_capture,
        .input = &input,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
        .layout = s->draw_layout.layout};
    return bench_pipelines_create(s->job->target, &desc, s->pipelines, error);
}

// --- Frames -------------------------------------------------------------------------------------

static void barrier(VkCommandBuffer commands, VkPipelineStageFlags to, VkAccessFlags access) {
    const VkMemoryBarrier memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                    .srcAccessMask =
                                        VK_ACCESS_TRANSFORM_FEEDBACK_WRITE_BIT_EXT |
                                        VK_ACCESS_TRANSFORM_FEEDBACK_COUNTER_WRITE_BIT_EXT,
                                    .dstAccessMask = access};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFORM_FEEDBACK_BIT_EXT, to, 0, 1, &memory,
                         0, NULL, 0, NULL);
}

static void select_patterns(const dmr *s, VkCommandBuffer commands, uint32_t from) {
    const bench_job *job = s->job;
    const bench_feedback *feedback = bench_target_feedback(job->target);
    const VkDeviceSize offset = 0;
    bench_feedback_begin(job->target, commands);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->select);
    bench_bind_layout(job->target, commands, &s->layouts[from], VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdPushConstants(commands, s->layouts[from].layout, bench_target_stages(job->target), 0,
                       sizeof s->push, &s->push);
    vkCmdBindVertexBuffers(commands, 0, 1, &job->vertex_buffer.buffer, &offset);
    vkCmdBindIndexBuffer(commands, job->index_buffer.buffer, 0, VK_INDEX_TYPE_UINT32);
    const girih_device_buffer *to = &s->selections[1 - from];
    feedback->bind(commands, 0, 1, &to->buffer, &offset, &to->size);
    feedback->begin(commands, 0, 0, NULL, NULL);
    vkCmdDrawIndexed(commands, 3 * job->triangle_count, 1, 0, 0, 0);
    feedback->end(commands, 0, 0, NULL, NULL);
    bench_feedback_end(job->target, commands);
}

static void update_mesh(const dmr *s, VkCommandBuffer commands, uint32_t from) {
    const bench_job *job = s->job;
    const bench_feedback *feedback = bench_target_feedback(job->target);
    const VkDeviceSize offset = 0;
    bench_feedback_begin(job->target, commands);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->update);
    bench_bind_layout(job->target, commands, &s->layouts[from], VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdBindVertexBuffers(commands, 0, 1, &s->meshes[from].buffer, &offset);
    const girih_device_buffer *to = &s->meshes[1 - from];
    feedback->bind(commands, 0, 1, &to->buffer, &offset, &to->size);
    feedback->begin(commands, 0, 0, NULL, NULL);
    feedback->draw_indirect(commands, 1, 0, s->counters[from].buffer, 0, 0, VERTEX_BYTES);
    feedback->end(commands, 0, 1, &s->counters[1 - from].buffer, &offset);
    bench_feedback_end(job->target, commands);
}

static girih_result prepare(void *state, VkCommandBuffer commands, girih_error *error) {
    (void)error;
    dmr *s = state;
    select_patterns(s, commands, s->latest);
    barrier(commands, VK_PIPELINE_STAGE_GEOMETRY_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
    update_mesh(s, commands, s->latest);
    barrier(commands, VK_PIPELINE_STAGE_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
            VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT);
    s->latest = 1 - s->latest;
    return GIRIH_OK;
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const dmr *s = state;
    const bench_job *job = s->job;
    const VkDeviceSize offset = 0;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipelines[raster]);
    bench_bind_layout(job->target, commands, &s->draw_layout, VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdBindVertexBuffers(commands, 0, 1, &s->meshes[s->latest].buffer, &offset);
    bench_begin_draws(job->target, commands, raster);
    bench_target_feedback(job->target)
        ->draw_indirect(commands, 1, 0, s->counters[s->latest].buffer, 0, 0, VERTEX_BYTES);
    bench_end_draws(job->target, commands, raster);
}

static uint32_t mesh_triangles(const dmr *s) {
    return *(const uint32_t *)s->counters[s->latest].mapped / TRIANGLE_BYTES;
}

static bool overflow(void *state) {
    const dmr *s = state;
    return mesh_triangles(s) == s->room;
}

// --- What was drawn -----------------------------------------------------------------------------

// Looks at a seen triangle's edges; those that it splits otherwise than another one count once.
static void look_at_edges(const uint32_t levels[3], const uint32_t edges[3], uint32_t *edge_levels,
                          bench_dmr_audit *audit) {
    for (int k = 0; k < 3; ++k) {
        uint32_t *level = &edge_levels[edges[k]];
        if (*level == UINT32_MAX) {
            *level = levels[k];
        } else if (*level != levels[k] && *level != CRACKED) {
            *level = CRACKED;
            ++audit->cracked_edges;
        }
    }
}

girih_result bench_dmr_look(void *state, bench_dmr_audit *audit, girih_error *error) {
    const dmr *s = state;
    const girih_mesh *mesh = s->job->mesh;
    const uint32_t triangles = s->job->triangle_count;
    uint32_t(*selection)[3] = malloc(triangles * sizeof *selection);
    uint32_t *edge_levels = malloc((size_t)mesh->edge_count * 4 + 1);
    *audit = (bench_dmr_audit){0};
    girih_result result = GIRIH_OK;
    if (!selection || !edge_levels) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        const girih_buffer_range range = {.buffer = s->selections[s->latest].buffer};
        result = girih_device_read(s->job->device, &range, triangles * sizeof *selection, selection,
                                   error);
    }
    if (result == GIRIH_OK) {
        memset(edge_levels, 0xff, (size_t)mesh->edge_count * 4);
        for (uint32_t n = 0; n < mesh->triangle_count; ++n) {
            const uint32_t *selected = selection[mesh->triangle_source[n]];
            uint32_t levels[3];
            if ((selected[0] & HIDDEN) == 0) {
                audit->seen_triangles += selected[1];
                pattern_levels(selected[0], s->job->catalogue->level_count, levels);
                look_at_edges(levels, mesh->triangle_edges + 3 * (size_t)n, edge_levels, audit);
            }
        }
    }
    free(edge_levels);
    free(selection);
    return result;
}

// --- Creation -----------------------------------------------------------------------------------

static const char *unfit(const bench_job *job) {
    const VkPhysicalDeviceLimits *limits = &job->device->properties.limits;
    const uint64_t pattern_bytes = job->catalogue->triangle_count * 12;
    if (!job->device->has_transform_feedback || !job->device->features.geometryShader) {
        return "the device lacks VK_EXT_transform_feedback or geometryShader";
    }
    if (pattern_bytes > limits->maxStorageBufferRange) {
        return "the patterns take more than the device's maxStorageBufferRange";
    }
    for (uint32_t rank = 0; rank < job->catalogue->pattern_count; ++rank) {
        if (girih_catalogue_pattern(job->catalogue, rank)->triangle_count > MOST_SUBTRIANGLES) {
            return "the catalogue has patterns of more than 65,536 triangles";
        }
    }
    return NULL;
}

// The reference frame again and again until the growth limit limits nothing.
static girih_result settle(dmr *s, girih_error *error) {
    const bench_job *job = s->job;
    const bench_view nowhere = {.rows = {{0}}};
    girih_result result =
        bench_target_set_view(job->target, &nowhere, job->catalogue, &job->reference, error);
    uint32_t before = 0;
    while (result == GIRIH_OK && mesh_triangles(s) != before) {
        before = mesh_triangles(s);
        result = girih_device_begin(job->device, error);
        if (result == GIRIH_OK) {
            result = prepare(s, job->device->commands, error);
        }
        if (result == GIRIH_OK) {
            result = girih_device_finish(job->device, error);
        }
    }
    return result;
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    const bool symmetric = variant == SYMMETRIC;
    dmr *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    s->job = job;
    // Hidden triangles are there too. Those that are refined all the same are fewer than the seen.
    s->room = (symmetric ? 2 : 1) * job->room_triangles + job->triangle_count + 1;
    girih_result result = upload_patterns(s, symmetric, error);
    if (result == GIRIH_OK) {
        result = upload_around(s, error);
    }
    if (result == GIRIH_OK) {
        result = create_buffers(s, error);
    }
    if (result == GIRIH_OK) {
        result = upload_first_frame(s, error);
    }
    if (result == GIRIH_OK) {
        result = create_layouts(s, error);
    }
    if (result == GIRIH_OK) {
        result = create_select(s, symmetric, error);
    }
    if (result == GIRIH_OK) {
        result = create_update(s, variant, error);
    }
    if (result == GIRIH_OK) {
        result = create_draw(s, error);
    }
    if (result == GIRIH_OK) {
        result = settle(s, error);
    }
    if (result != GIRIH_OK) {
        destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

#define DMR(NAME, VARIANT)                                                                         \
    {                                                                                              \
        .name = NAME, .follows = "Lorenz and Doellner 2008", .variant = VARIANT, .unfit = unfit,   \
        .create = create, .destroy = destroy, .prepare = prepare, .draw = draw,                    \
        .overflow = overflow                                                                       \
    }

const bench_method bench_dmr = DMR("dmr", 0);
const bench_method bench_dmr_symmetric = DMR("dmr-symmetric", SYMMETRIC);
const bench_method bench_dmr_output_limits[BENCH_DMR_LIMITS] = {
    DMR("dmr-output-12", 0),  DMR("dmr-output-18", 1), DMR("dmr-output-24", 2),
    DMR("dmr-output-48", 3),  DMR("dmr-output-96", 4), DMR("dmr-output-192", 5),
    DMR("dmr-output-255", 6),
};
