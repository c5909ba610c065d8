// ARK, the Adaptive Refinement Kernel (Boubekeur, Schlick 2005 and 2008; as ARKFPI, sections 2 to 4
// and 5.7, has it): the mesh stays in the CPU's memory; the CPU chooses each triangle's adaptive
// pattern and draws it with a call of its own, the triangle's positions and normals as uniforms;
// the vertex shader maps the pattern's barycentrics to the surface.
//
// Levels stand on edges, each worked out once, where the papers take the mean of two vertices'
// levels: the job's levels are the edges'. Uniforms are push constants, Vulkan's fastest way to
// data that changes with every draw. A triangle of which nothing can be seen is not drawn at all.
#include <stdlib.h>

#include "adaptive.h"
#include "cpu_levels.h"
#include "error.h"
#include "methods.h"

typedef struct ark {
    bench_adaptive adaptive;
    bench_cpu_levels levels;
    uint32_t *selected; // pattern of each triangle
} ark;

static void destroy(void *state) {
    ark *s = state;
    if (!s) {
        return;
    }
    bench_adaptive_destroy(&s->adaptive);
    bench_cpu_levels_destroy(&s->levels);
    free(s->selected);
    free(s);
}

static girih_result create(const bench_job *job, int variant, void **state, girih_error *error) {
    (void)variant;
    const girih_mesh *mesh = job->mesh;
    ark *s = calloc(1, sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    s->selected = malloc((size_t)mesh->triangle_count * sizeof *s->selected + 1);
    girih_result result =
        s->selected ? GIRIH_OK : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    if (result == GIRIH_OK) {
        result = bench_cpu_levels_create(mesh, job->catalogue, job->surface, &s->levels, error);
    }
    if (result == GIRIH_OK) {
        result = bench_adaptive_create(job, mesh->positions, mesh->normals, mesh->triangle_vertices,
                                       mesh->triangle_count, &s->adaptive, error);
    }
    if (result != GIRIH_OK) {
        destroy(s);
        return result;
    }
    *state = s;
    return GIRIH_OK;
}

static girih_result prepare(void *state, VkCommandBuffer commands, girih_error *error) {
    ark *s = state;
    (void)commands;
    return bench_cpu_levels_select(&s->levels, &s->adaptive.job->frame, s->selected, error);
}

static void draw(void *state, VkCommandBuffer commands, bench_raster raster) {
    const ark *s = state;
    bench_adaptive_draw(&s->adaptive, commands, raster, s->selected);
}

const bench_method bench_ark = {.name = "ark",
                                .follows = "Boubekeur, Schlick 2008: Adaptive Refinement Kernel",
                                .create = create,
                                .destroy = destroy,
                                .prepare = prepare,
                                .draw = draw};
