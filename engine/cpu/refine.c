// All stages on the CPU, one after another, into memory of the output's exact size.
#include "girih/cpu.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#else
#include <time.h>
#endif

#include "../arrays.h"
#include "../error.h"
#include "../memory.h"

// Counts that index lists and signed offsets of other programs can still hold.
#define MAX_OUTPUT (UINT64_C(1) << 31)

// Room for parts that is tried first.
#define FIRST_SPLITS 4096u

// The surface whose control points bound what is refined.
static girih_surface base_surface(const girih_cpu_desc *desc) {
    return desc->surface == GIRIH_SURFACE_OWN ? desc->base : desc->surface;
}

static girih_result check(const girih_cpu_desc *desc, const girih_frame *frame,
                          girih_error *error) {
    if ((desc->mesh_count > 0 && !desc->meshes) || (desc->instance_count > 0 && !desc->instances)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "refine: meshes or instances are NULL");
    }
    const girih_surface base = base_surface(desc);
    if (desc->surface == GIRIH_SURFACE_OWN && !desc->own) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "refine: the own surface is NULL");
    }
    if (desc->surface == GIRIH_SURFACE_OWN && base != GIRIH_SURFACE_FLAT &&
        base != GIRIH_SURFACE_PN) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "refine: unknown base %d of the own surface", (int)base);
    }
    if (base != GIRIH_SURFACE_FLAT && base != GIRIH_SURFACE_PN) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "refine: unknown surface %d",
                          (int)desc->surface);
    }
    if (desc->mode != GIRIH_MODE_INSTANCED && desc->mode != GIRIH_MODE_BAKED &&
        desc->mode != GIRIH_MODE_WELDED) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "refine: unknown mode %d",
                          (int)desc->mode);
    }
    if ((desc->outputs & GIRIH_OUTPUT_PREVIOUS) != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "refine: the previous frame's positions are written on the GPU only");
    }
    if ((desc->outputs & GIRIH_OUTPUT_CLOSED_INDICES) != 0 &&
        (desc->mode != GIRIH_MODE_WELDED || frame->cull_frustum || frame->cull_back)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "refine: closed indices need the welded mode, and nothing culled");
    }
    if (desc->max_segments > 0 && desc->mode == GIRIH_MODE_WELDED) {
        return girih_fail(error, GIRIH_ERROR_UNSUPPORTED,
                          "refine: split triangles are not welded; use the baked mode, or "
                          "max_segments 0");
    }
    return GIRIH_OK;
}

static double milliseconds(void) {
#ifdef _WIN32 // Windows' older C runtimes have no timespec_get
    LARGE_INTEGER now, frequency;
    QueryPerformanceCounter(&now);
    QueryPerformanceFrequency(&frequency);
    return (double)now.QuadPart * 1e3 / (double)frequency.QuadPart;
#else
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
#endif
}

// The time since *begin, which becomes now.
static double lap(double *begin) {
    const double before = *begin;
    *begin = milliseconds();
    return *begin - before;
}

// What may be culled of an own surface: see girih_surface_program_desc.
static void limit_culling(girih_frame_block *frame, const girih_cpu_desc *desc) {
    if (!isfinite(desc->reach) || desc->reach < 0.0f) {
        frame->cull = 0;
        return;
    }
    frame->reach = desc->reach;
    frame->cull &= GIRIH_CULL_FRUSTUM;
}

// Memory of what the stages up to dispatch write. The sort's counters and spare items, and the
// draws, are the GPU's alone.
static girih_result allocate_work(girih_arrays *arrays, girih_error *error) {
    static const uint32_t written[] = {GIRIH_BIND_LEVELS,      GIRIH_BIND_SPLITS, GIRIH_BIND_KEYS,
                                       GIRIH_BIND_ITEMS,       GIRIH_BIND_GROUPS, GIRIH_BIND_STATUS,
                                       GIRIH_BIND_WELD_OFFSETS};
    for (size_t n = 0; n < sizeof written / sizeof *written; ++n) {
        const uint64_t count = arrays->count[written[n]];
        arrays->words[written[n]] =
            count <= SIZE_MAX ? girih_allocate_array((size_t)count, sizeof(uint32_t)) : NULL;
        if (!arrays->words[written[n]]) {
            return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                              "refine: no memory for %" PRIu64 " words of work", count);
        }
    }
    return GIRIH_OK;
}

// Parts take memory before their triangles are counted, so a frame that nobody could write is told
// from what is sure about it.
static girih_result check_splits(const girih_arrays *arrays, girih_error *error) {
    const uint64_t least = girih_least_split_triangles(arrays);
    return least <= MAX_OUTPUT
               ? GIRIH_OK
               : girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                            "refine: %" PRIu64 " triangles or more are needed, at most %" PRIu64
                            " can be written",
                            least, MAX_OUTPUT);
}

// Levels and select, with room for some parts; where that is too little, once more with what was
// needed as far as it is known: a further pass may need more.
static girih_result choose_patterns(girih_arrays *arrays, const girih_cpu_desc *desc,
                                    const girih_frame *frame, const girih_scene_table *table,
                                    girih_cpu_times *times, girih_error *error) {
    girih_plan_shape shape = {
        .mode = desc->mode == GIRIH_MODE_WELDED ? GIRIH_MODE_WELDED : GIRIH_MODE_BAKED,
        .outputs = desc->outputs | GIRIH_OUTPUT_NO_DRAW,
        .max_vertices = desc->max_vertices != 0 ? desc->max_vertices : UINT32_MAX,
        .max_triangles = desc->max_triangles != 0 ? desc->max_triangles : UINT32_MAX,
        .max_segments = desc->max_segments,
        .max_splits = desc->max_segments > 0 ? FIRST_SPLITS : 0,
    };
    for (;;) {
        girih_result result =
            girih_pack_plan(arrays, &shape, table, desc->instances, desc->instance_count, error);
        if (result == GIRIH_OK) {
            result = girih_pack_frame(arrays, frame, error);
        }
        if (result == GIRIH_OK && desc->surface == GIRIH_SURFACE_OWN) {
            limit_culling(&arrays->frame, desc);
        }
        if (result == GIRIH_OK) {
            result = allocate_work(arrays, error);
        }
        if (result != GIRIH_OK) {
            return result;
        }
        double begin = milliseconds();
        girih_twin_levels(arrays);
        times->levels = lap(&begin);
        girih_twin_select(arrays, base_surface(desc));
        result = check_splits(arrays, error);
        if (result != GIRIH_OK) {
            return result;
        }
        girih_twin_split(arrays);
        times->select = lap(&begin);
        const uint32_t *status = arrays->words[GIRIH_BIND_STATUS];
        if ((status[GIRIH_STATUS_FLAGS] & GIRIH_STATUS_SPLIT_OVERFLOW) == 0) {
            return GIRIH_OK;
        }
        const uint32_t needed = status[GIRIH_STATUS_NEEDED_SPLITS];
        if (needed <= shape.max_splits || needed >= GIRIH_SPLIT_MOST_PARTS) {
            return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                              "refine: split triangles have %" PRIu32
                              " parts and more, which are too many",
                              needed);
        }
        shape.max_splits = needed;
        girih_arrays_free(arrays, GIRIH_BIND_INSTANCES, GIRIH_BIND_OUT_POSITIONS);
    }
}

// Everything up to the counts of the output.
static girih_result count_output(girih_arrays *arrays, const girih_cpu_desc *desc,
                                 const girih_frame *frame, girih_cpu_times *times,
                                 girih_error *error) {
    girih_scene_table table;
    girih_result result = girih_pack_catalogue(
        arrays, desc->catalogue ? desc->catalogue : girih_catalogue_dyadic(), error);
    if (result == GIRIH_OK) {
        result = girih_pack_scene(arrays, &table, desc->meshes, desc->mesh_count, 0, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    result = choose_patterns(arrays, desc, frame, &table, times, error);
    girih_free(table.meshes);
    if (result != GIRIH_OK) {
        return result;
    }
    double begin = milliseconds();
    result = girih_twin_group(arrays, error);
    times->group = lap(&begin);
    if (result == GIRIH_OK) {
        if (desc->mode == GIRIH_MODE_WELDED) {
            girih_twin_weld(arrays);
        }
        girih_twin_dispatch(arrays);
        times->dispatch = lap(&begin);
    }
    return result;
}

static girih_result check_counts(const girih_cpu_desc *desc, const girih_statistics *statistics,
                                 girih_error *error) {
    const uint64_t vertices =
        desc->max_vertices == 0 ? statistics->needed_vertices : statistics->output_vertices;
    const uint64_t triangles =
        desc->max_triangles == 0 ? statistics->needed_triangles : statistics->output_triangles;
    if (vertices > MAX_OUTPUT || triangles > MAX_OUTPUT) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "refine: %" PRIu64 " vertices and %" PRIu64
                          " triangles are needed, at most %" PRIu64 " of each can be written",
                          vertices, triangles, MAX_OUTPUT);
    }
    return GIRIH_OK;
}

static girih_result allocate(void *memory, uint64_t count, size_t size, girih_error *error) {
    void *allocated = count <= SIZE_MAX ? girih_allocate_array((size_t)count, size) : NULL;
    memcpy(memory, &allocated, sizeof allocated);
    return allocated
               ? GIRIH_OK
               : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY,
                            "refine: no memory for %" PRIu64 " records of %zu bytes of output",
                            count, size);
}

static girih_result allocate_output(girih_cpu_output *output, uint32_t outputs,
                                    girih_error *error) {
    const uint64_t vertices = output->statistics.output_vertices;
    const uint64_t triangles = output->statistics.output_triangles;
    const size_t point_bytes = ((size_t)output->attribute_floats + 3) * sizeof(float);
    girih_result result = allocate(&output->positions, vertices, 3 * sizeof(float), error);
    if (result == GIRIH_OK) {
        result = allocate(&output->attributes, vertices, point_bytes, error);
    }
    if (result == GIRIH_OK) {
        result = allocate(&output->indices, triangles, 3 * sizeof(uint32_t), error);
    }
    if (result == GIRIH_OK && (outputs & GIRIH_OUTPUT_CLOSED_INDICES) != 0) {
        result = allocate(&output->closed_indices, triangles, 3 * sizeof(uint32_t), error);
    }
    if (result == GIRIH_OK && (outputs & GIRIH_OUTPUT_SOURCES) != 0) {
        result = allocate(&output->sources, triangles, 2 * sizeof(uint32_t), error);
    }
    if (result == GIRIH_OK) {
        result = allocate(&output->material_first, (uint64_t)output->material_count + 1,
                          sizeof(uint32_t), error);
    }
    if (result == GIRIH_OK && output->statistics.culled_triangles > 0) {
        // Welded corners of culled triangles alone have no other value.
        memset(output->positions, 0, (size_t)vertices * 3 * sizeof(float));
        memset(output->attributes, 0, (size_t)vertices * point_bytes);
    }
    return result;
}

girih_result girih_cpu_refine(const girih_cpu_desc *desc, const girih_frame *frame,
                              girih_cpu_output *output, girih_error *error) {
    if (!desc || !frame || !output) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "refine: a null pointer");
    }
    girih_cpu_output refined = {0};
    girih_arrays arrays = {.frame = {.instance_count = 0}};
    girih_result result = check(desc, frame, error);
    if (result == GIRIH_OK) {
        result = count_output(&arrays, desc, frame, &refined.times, error);
    }
    if (result == GIRIH_OK) {
        refined.statistics = girih_read_status(&arrays.frame, arrays.words[GIRIH_BIND_STATUS]);
        refined.material_count = arrays.frame.material_count;
        refined.attribute_floats = arrays.frame.attribute_floats;
        result = check_counts(desc, &refined.statistics, error);
    }
    if (result == GIRIH_OK) {
        result = allocate_output(&refined, desc->outputs, error);
    }
    if (result == GIRIH_OK) {
        arrays.words[GIRIH_BIND_OUT_POSITIONS] = (uint32_t *)(void *)refined.positions;
        arrays.words[GIRIH_BIND_OUT_ATTRIBUTES] = (uint32_t *)(void *)refined.attributes;
        arrays.words[GIRIH_BIND_OUT_INDICES] = refined.indices;
        arrays.words[GIRIH_BIND_OUT_CLOSED_INDICES] = refined.closed_indices;
        arrays.words[GIRIH_BIND_OUT_SOURCES] = refined.sources;
        double begin = milliseconds();
        if (desc->surface == GIRIH_SURFACE_OWN) {
            girih_twin_evaluate_own(&arrays, desc);
        } else {
            girih_twin_evaluate(&arrays, desc->surface);
        }
        girih_twin_output(&arrays, desc->outputs | GIRIH_OUTPUT_INDICES);
        refined.times.evaluate = lap(&begin);
        memcpy(refined.material_first,
               arrays.words[GIRIH_BIND_STATUS] + GIRIH_STATUS_WORDS + arrays.frame.pattern_count,
               ((size_t)refined.material_count + 1) * sizeof(uint32_t));
        *output = refined;
    } else {
        girih_cpu_output_free(&refined);
    }
    girih_arrays_free(&arrays, 0, GIRIH_BIND_OUT_POSITIONS);
    return result;
}

void girih_cpu_output_free(girih_cpu_output *output) {
    if (!output) {
        return;
    }
    girih_free(output->positions);
    girih_free(output->attributes);
    girih_free(output->indices);
    girih_free(output->closed_indices);
    girih_free(output->sources);
    girih_free(output->material_first);
    *output = (girih_cpu_output){0};
}
