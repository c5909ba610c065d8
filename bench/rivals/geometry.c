// Geometry-shader rivals, one pass each: Knuth, Kohlhammer and Kuijper 2010, without and with
// warping, and the two that the paper compares with. rivals/shaders/geometry.geom says how they
// refine.
//
// Vulkan promises a geometry shader 1024 output components: 128 vertices of eight components,
// 102 while triangles are captured. Patterns of more are made in parts, whole strips each: as many
// as the most that the job can ask for needs, one draw each. 32 parts suffice for the uniform
// pattern up to level 54, level 49 where it is to be captured as well. Beyond that the job is
// unfit; dyadic patterns end at 32.
//
// Invocations of the geometry shader would be the parts of one draw. lavapipe takes four triangles
// side by side through a geometry shader with one invocation and no more than one through a shader
// with several, however little each does (Mesa 22.3, draw_gs_should_flush): frames take 2 to 4
// times as long. A draw costs it a few microseconds.
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "error.h"
#include "methods.h"

#include "bench_shaders.h"

enum { KNUTH, KNUTH_WARPED, SUAPT, UNIFORM };

#define ROOM 128u
#define CAPTURE_ROOM 102u

// --- Parts --------------------------------------------------------------------------------------

#define MOST_PARTS 32u

typedef struct deal {
    uint32_t parts;
    uint32_t vertices; // the most of one part
} deal;

// The strips of a pattern, i >= j >= k segments: strip_count and strip_length of the shader.
typedef struct strips {
    uint32_t tip;   // strips of the triangle part
    uint32_t lines; // of the quad part
    uint32_t steps; // segments along them
} strips;

static strips strips_of(int variant, uint32_t i, uint32_t j, uint32_t k) {
    if (variant == SUAPT || variant == UNIFORM) {
        return (strips){.tip = i};
    }
    if (j == k && i > j) {
        return (strips){.tip = j / 2, .lines = j - j / 2, .steps = i};
    }
    return (strips){.tip = k, .lines = i > k ? k : 0, .steps = i - k};
}

// As the shader deals them.
static void deal_strips(const strips *s, uint32_t room, deal *most) {
    uint32_t parts = 1;
    uint32_t full = 0;
    for (uint32_t n = 0; n < s->tip + s->lines; ++n) {
        const uint32_t vertices = n < s->tip ? 2 * n + 3 : 2 * s->steps + 2;
        if (full + vertices > room) {
            ++parts;
            full = 0;
        }
        full += vertices;
        most->vertices = full > most->vertices ? full : most->vertices;
    }
    most->parts = parts > most->parts ? parts : most->parts;
}

// Over all patterns up to so many segments. More than `room` vertices: a strip is too long.
static deal deal_patterns(int variant, uint32_t segments, uint32_t room) {
    deal most = {1, 3};
    for (uint32_t i = 1; i <= segments; ++i) {
        for (uint32_t j = 1; j <= i; ++j) {
            for (uint32_t k = 1; k <= j; ++k) {
                const strips s = strips_of(variant, i, j, k);
                deal_strips(&s, room, &most);
                if (most.vertices > room) {
                    return most;
                }
            }
        }
    }
    return most;
}

// --- The most segments of a frame ---------------------------------------------------------------

static float longest_edge_squared(const bench_job *job) {
    float longest = 0.0f;
    for (size_t n = 0; n < 3 * (size_t)job->triangle_count; ++n) {
        const float *p = job->positions + 3 * (size_t)job->indices[n];
        const float *q = job->positions + 3 * (size_t)job->indices[n % 3 == 2 ? n - 2 : n + 1];
        const float x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
        const float square = (x * x + y * y) + z * z;
        longest = square > longest ? square : longest;
    }
    return longest;
}

// A bound that takes no look at the mesh, so that it costs nothing each frame: what the rule can
// give at most, by the longest edge where lengths count. The levels themselves are the shader's.
static uint32_t most_segments(const bench_job *job, const girih_frame *frame, float longest) {
    girih_arrays arrays = {.frame.level_count = job->catalogue->level_count,
                           .frame.last_level = job->catalogue->level_count - 1,
                           .frame.linear_spacing = job->catalogue->spacing == GIRIH_SPACING_LINEAR};
    const uint32_t last = job->catalogue->level_count - 1;
    uint32_t level = last;
    if (girih_pack_frame(&arrays, frame, NULL) != GIRIH_OK) {
        return girih_catalogue_segments(job->catalogue, last); // refused before it is drawn
    }
    const girih_frame_block *block = &arrays.frame;
    if (block->rule == GIRIH_LEVELS_UNIFORM) {
        level = block->uniform_level;
    } else if (block->rule == GIRIH_LEVELS_RANDOM_LEVEL) {
        level = block->random_segments - 1;
    } else if (block->rule == GIRIH_LEVELS_RANDOM) {
        level = girih_catalogue_level(job->catalogue, block->random_segments, NULL);
    } else if (block->rule == GIRIH_LEVELS_OBJECT_LENGTH || block->eye[3] == 0.0f) {
        // A little longer than it is: the shader may round its sum otherwise.
        const float wanted = longest * 1.00001f * block->length_factor;
        for (level = 0; level < last; ++level) {
            const float segments = (float)girih_catalogue_segments(job->catalogue, level);
            if (wanted <= segments * segments * block->near_squared) {
                break;
            }
        }
    }
    return girih_catalogue_segments(job->catalogue, level < last ? level : last);
}

static uint32_t dyadic(uint32_t segments) {
    uint32_t power = 1;
    while (power < segments) {
        power *= 2;
    }
    return power;
}

// --- The method ---------------------------------------------------------------------------------

typedef struct geometry {
    const bench_job *job;
    bench_layout layout;
    VkPipeline pipelines[BENCH_RASTERS];
    uint32_t parts[BENCH_RASTERS];
    float longest;
    uint32_t segments; // the most that the parts suffice for
} geometry;

static void destroy(void *state) {
    geometry *s = state;
    if (!s) {
        return;
    }
    bench_pipelines_destroy(s->job->target, s->pipelines);
    bench_layout_destroy(s->job->target, &s->layout);
    free(s);
}

// The code with its number of output vertices replaced, which is an execution mode of SPIR-V and
// has no specialization constant; the caller's, to be freed.
static uint32_t *with_vertices(bench_shader shader, uint32_t vertices) {
    enum { HEADER_WORDS = 5, EXECUTION_MODE = 16, OUTPUT_VERTICES = 26 };
    uint32_t *words = malloc(shader.bytes);
    if (!words) {
        return NULL;
    }
    memcpy(words, shader.words, shader.bytes);
    for (size_t at = HEADER_WORDS; at < shader.bytes / 4 && words[at] >> 16 != 0;
         at += words[at] >> 16) {
        if ((words[at] & 0xffffu) == EXECUTION_MODE && words[at + 2] == OUTPUT_VERTICES) {
            words[at + 3] = vertices;
        }
    }
    return words;
}

static girih_result create_pipelines(geometry *s, int variant, girih_error *error) {
    static const bench_shader *const shaders[4][2][2] = {
        {{&bench_shader_knuth_flat, &bench_shader_knuth_flat_capture},
         {&bench_shader_knuth_pn, &bench_shader_knuth_pn_capture}},
        {{&bench_shader_knuth_warped_flat, &bench_shader_knuth_warped_flat_capture},
         {&bench_shader_knuth_warped_pn, &bench_shader_knuth_warped_pn_capture}},
        {{&bench_shader_suapt_flat, &bench_shader_suapt_flat_capture},
         {&bench_shader_suapt_pn, &bench_shader_suapt_pn_capture}},
        {{&bench_shader_uniform_flat, &bench_shader_uniform_flat_capture},
         {&bench_shader_uniform_pn, &bench_shader_uniform_pn_capture}}};
    const bench_shader *const *pair = shaders[variant][s->job->surface == GIRIH_SURFACE_PN];
    const deal drawn = deal_patterns(variant, s->segments, ROOM);
    const deal captured = deal_patterns(variant, s->segments, CAPTURE_ROOM);
    s->parts[BENCH_GEOMETRY] = drawn.parts;
    s->parts[BENCH_SHADED] = drawn.parts;
    s->parts[BENCH_CAPTURE] = captured.parts;
    uint32_t *words = with_vertices(*pair[0], drawn.vertices);
    uint32_t *capture = with_vertices(*pair[1], captured.vertices);
    const bench_pipeline_desc desc = {.vertex = bench_shader_corners,
                                      .geometry = {words, pair[0]->bytes},
                                      .capture = {capture, pair[1]->bytes},
                                      .input = &bench_corner_input,
                                      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST,
                                      .layout = s->layout.layout};
    const girih_result result =
        words && capture ? bench_pipelines_create(s->job->target, &desc, s->pipelines, error)
                         : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    free(words);
    free(capture);
    return result;
}

static uint32_t pattern_segments(const bench_job *job, int variant, float longest) {
    const uint32_t segments = most_segments(job, &job->reference, longest);
    return variant == SUAPT ? dyadic(segments) : segments;
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    geometry *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    s->job = job;
    s->longest = longest_edge_squared(job);
    s->segments = pattern_segments(job, variant, s->longest);
    girih_result result =
        bench_layout_create(job->target, NULL, 0, sizeof(uint32_t), &s->layout, error);
    if (result == GIRIH_OK) {
        result = create_pipelines(s, variant, error);
    }
    if (result != GIRIH_OK) {
        destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

static const char *unfit(const bench_job *job, int variant) {
    if (!job->device->features.geometryShader) {
        return "the device lacks geometryShader";
    }
    const uint32_t segments = pattern_segments(job, variant, longest_edge_squared(job));
    const uint32_t room = job->device->has_transform_feedback ? CAPTURE_ROOM : ROOM;
    const deal most = deal_patterns(variant, segments, room);
    if (most.vertices > room) {
        return "a strip of its patterns has more vertices than a geometry shader can put out";
    }
    return most.parts > MOST_PARTS ? "its patterns need more than 32 draws" : NULL;
}

static const char *unfit_knuth(const bench_job *job) {
    return unfit(job, KNUTH);
}
static const char *unfit_suapt(const bench_job *job) {
    return unfit(job, SUAPT);
}
static const char *unfit_uniform(const bench_job *job) {
    return unfit(job, UNIFORM);
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const geometry *s = state;
    const bench_job *job = s->job;
    const VkDeviceSize offset = 0;
    bench_bind_layout(job->target, commands, &s->layout, VK_PIPELINE_BIND_POINT_GRAPHICS);
    vkCmdBindVertexBuffers(commands, 0, 1, &job->vertex_buffer.buffer, &offset);
    vkCmdBindIndexBuffer(commands, job->index_buffer.buffer, 0, VK_INDEX_TYPE_UINT32);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipelines[raster]);
    bench_begin_draws(job->target, commands, raster);
    for (uint32_t part = 0; part < s->parts[raster]; ++part) {
        vkCmdPushConstants(commands, s->layout.layout, bench_target_stages(job->target), 0,
                           sizeof part, &part);
        vkCmdDrawIndexed(commands, 3 * job->triangle_count, 1, 0, 0, 0);
    }
    bench_end_draws(job->target, commands, raster);
}

static bool overflow(void *state) {
    const geometry *s = state;
    return most_segments(s->job, &s->job->frame, s->longest) > s->segments;
}

#define GEOMETRY(NAME, FOLLOWS, VARIANT, UNFIT)                                                    \
    {                                                                                              \
        .name = NAME, .follows = FOLLOWS, .variant = VARIANT, .unfit = UNFIT, .create = create,    \
        .destroy = destroy, .draw = draw, .overflow = overflow                                     \
    }

const bench_method bench_knuth =
    GEOMETRY("knuth", "Knuth, Kohlhammer, Kuijper 2010, no warping", KNUTH, unfit_knuth);
const bench_method bench_knuth_warped =
    GEOMETRY("knuth-warped", "Knuth, Kohlhammer, Kuijper 2010", KNUTH_WARPED, unfit_knuth);
const bench_method bench_suapt =
    GEOMETRY("suapt", "Dyken, Reimers, Seland 2009, in a geometry shader", SUAPT, unfit_suapt);
const bench_method bench_uniform_pn =
    GEOMETRY("uniform-pn", "Vlachos et al. 2001, in a geometry shader; cracks where levels differ",
             UNIFORM, unfit_uniform);
