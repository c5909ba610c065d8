// Alternating pairs of frames, their ratios, and whether both methods draw the same.
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "bench.h"
#include "compare.h"
#include "error.h"
#include "png.h"
#include "report.h"
#include "statistics.h"

#define WARM_UP_FRAMES 4u
#define LEAST_PAIRS 5u

static const char *const raster_names[2] = {"geometry", "shaded"};

static double cpu_milliseconds(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1e3 +
           (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-3;
}

girih_result bench_frame(bench_case_job *job, const bench_method *method, void *state,
                         bench_raster raster, uint32_t n, bench_time *time, girih_error *error) {
    bench_job *j = &job->job;
    bench_view view;
    job->desc.frame(job->desc.user, n % job->desc.frame_count, &j->frame, &view);
    girih_result result = bench_target_set_view(j->target, &view, j->catalogue, &j->frame, error);
    const double wall = girih_seconds();
    const double cpu = cpu_milliseconds();
    if (result == GIRIH_OK && method->ahead) {
        result = method->ahead(state, error);
    }
    if (result == GIRIH_OK) {
        result = girih_device_begin(j->device, error);
    }
    const VkCommandBuffer commands = j->device->commands;
    if (result == GIRIH_OK && method->prepare) {
        result = method->prepare(state, commands, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    bench_target_begin(j->target, commands, raster);
    method->draw(state, commands, raster);
    bench_target_end(j->target, commands);
    if (raster == BENCH_CAPTURE) {
        girih_device_full_barrier(commands);
    }
    result = girih_device_finish(j->device, error);
    time->wall = (girih_seconds() - wall) * 1e3;
    time->cpu = cpu_milliseconds() - cpu;
    if (result == GIRIH_OK && method->overflow && method->overflow(state)) {
        result = girih_fail(error, GIRIH_ERROR_TOO_LARGE, "%s: %s has no room for frame %u",
                            j->name, method->name, n);
    }
    return result;
}

// --- Figures ------------------------------------------------------------------------------------

typedef struct samples {
    uint32_t pairs;
    bench_time own[STATISTICS_MOST];
    bench_time base[STATISTICS_MOST];
} samples;

// One method's figures from its own times and the paired times of the first method.
static json_t *figures_of(const samples *s) {
    const uint32_t pairs = s->pairs;
    double sorted[STATISTICS_MOST];
    double ratios[STATISTICS_MOST];
    double low, high;
    for (uint32_t n = 0; n < pairs; ++n) {
        ratios[n] = s->own[n].cpu / s->base[n].cpu;
    }
    const double cpu_ratio = statistics_median(ratios, pairs);
    for (uint32_t n = 0; n < pairs; ++n) {
        sorted[n] = s->own[n].wall;
        ratios[n] = s->own[n].wall / s->base[n].wall;
    }
    const double median = statistics_median(sorted, pairs);
    statistics_interval(ratios, pairs, &low, &high);
    return json_pack("{s:i,s:f,s:f,s:f,s:f,s:f,s:f,s:f}", "pairs", (int)pairs, "median_ms", median,
                     "min_ms", sorted[0], "max_ms", sorted[pairs - 1], "ratio",
                     statistics_median(ratios, pairs), "ratio_low", low, "ratio_high", high,
                     "cpu_ratio", cpu_ratio);
}

static void write_sample(const bench_run *run, const char *name, const bench_method *const pair[2],
                         const char *raster, uint32_t n, const bench_time *own,
                         const bench_time *base) {
    if (run->samples) {
        fprintf(run->samples, "\"%s\",%s,%s,%s,%u,%.6f,%.6f,%.6f,%.6f\n", name, pair[1]->name,
                pair[0]->name, raster, n, own->wall, base->wall, own->cpu, base->cpu);
    }
}

// Two methods on one job, or one on each of two.
static girih_result measure_raster(const bench_run *run, bench_case_job *const jobs[2],
                                   const bench_method *const methods[2], void *const states[2],
                                   bench_raster raster, samples *s, girih_error *error) {
    bench_time warm_up[2] = {{0}}; // of the last pair
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < WARM_UP_FRAMES && result == GIRIH_OK; ++n) {
        const uint32_t which = n % 2;
        result = bench_frame(jobs[which], methods[which], states[which], raster, n, &warm_up[which],
                             error);
    }
    s->pairs = run->pairs;
    const double most_seconds = jobs[1]->desc.most_seconds;
    const double seconds = (warm_up[0].wall + warm_up[1].wall) * 1e-3;
    if (most_seconds > 0.0 && s->pairs > LEAST_PAIRS && s->pairs * seconds > most_seconds) {
        const uint32_t affordable = (uint32_t)(most_seconds / seconds);
        s->pairs = affordable > LEAST_PAIRS ? affordable : LEAST_PAIRS;
    }
    for (uint32_t n = 0; n < s->pairs && result == GIRIH_OK; ++n) {
        // Which of the two goes first alternates too.
        for (uint32_t turn = 0; turn < 2 && result == GIRIH_OK; ++turn) {
            const uint32_t which = (n + turn) % 2;
            bench_time *time = which ? &s->own[n] : &s->base[n];
            result =
                bench_frame(jobs[which], methods[which], states[which], raster, n, time, error);
        }
        if (result == GIRIH_OK) {
            write_sample(run, jobs[1]->job.name, methods, raster_names[raster], n, &s->own[n],
                         &s->base[n]);
        }
    }
    return result;
}

// --- Whether the methods draw the same ----------------------------------------------------------

// Averages squares of pixels, in place.
static void shrink(uint8_t *rgba, uint32_t size) {
    const uint32_t square = BENCH_PIXELS / size;
    for (uint32_t y = 0; y < size; ++y) {
        for (uint32_t x = 0; x < size; ++x) {
            for (uint32_t channel = 0; channel < 4; ++channel) {
                uint32_t sum = 0;
                for (uint32_t n = 0; n < square * square; ++n) {
                    const uint32_t from = (y * square + n / square) * BENCH_PIXELS + x * square;
                    sum += rgba[4 * (from + n % square) + channel];
                }
                rgba[4 * (y * size + x) + channel] = (uint8_t)(sum / (square * square));
            }
        }
    }
}

static girih_result write_picture(const bench_run *run, bench_case_job *job,
                                  const bench_method *method, void *state, girih_error *error) {
    bench_time time;
    uint8_t *rgba = NULL;
    girih_result result = bench_frame(job, method, state, BENCH_SHADED, 1, &time, error);
    if (result == GIRIH_OK) {
        result = bench_target_picture(job->job.target, &rgba, error);
    }
    if (result == GIRIH_OK) {
        char path[4096];
        char name[256];
        char message[512];
        snprintf(name, sizeof name, "%s", job->job.name);
        for (char *c = name; *c; ++c) {
            *c = *c == ' ' || *c == ',' || *c == '/' ? '-' : *c;
        }
        snprintf(path, sizeof path, "%s/%s_%s.png", run->pictures, name, method->name);
        shrink(rgba, run->picture_size);
        if (!girih_png_write(path, run->picture_size, run->picture_size, rgba, message,
                             sizeof message)) {
            result = girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s: %s", path, message);
        }
    }
    free(rgba);
    return result;
}

girih_result bench_picture(const bench_run *run, bench_case_job *job, const bench_method *method,
                           girih_error *error) {
    void *state = NULL;
    girih_result result = method->create(&job->job, method->variant, &state, error);
    if (result == GIRIH_OK) {
        result = write_picture(run, job, method, state, error);
        method->destroy(state);
    }
    return result;
}

// A method may put hidden triangles out as one point each: bench_nothing.
static void drop_points(bench_triangles *triangles) {
    uint32_t kept = 0;
    for (uint32_t n = 0; n < triangles->count; ++n) {
        const float(*corners)[6] = (const float(*)[6])triangles->corners + 3 * (size_t)n;
        if (memcmp(corners[0], corners[1], 12) != 0 || memcmp(corners[0], corners[2], 12) != 0) {
            memmove(triangles->corners + 3 * (size_t)kept++, corners, sizeof(float[3][6]));
        }
    }
    triangles->count = kept;
}

girih_result bench_capture(bench_case_job *job, const bench_method *method, void *state, uint32_t n,
                           bench_triangles *triangles, girih_error *error) {
    bench_time time;
    // Other patterns than girih's may put out more: fractional odd spacing makes 9 to 13 triangles
    // of 2 to 4.
    girih_result result =
        bench_capture_reserve(job->job.target, 5 * job->job.room_triangles + 64, error);
    if (result == GIRIH_OK) {
        result = bench_frame(job, method, state, BENCH_CAPTURE, n, &time, error);
    }
    if (result == GIRIH_OK) {
        result = bench_capture_read(job->job.target, triangles, error);
    }
    if (result == GIRIH_OK) {
        drop_points(triangles);
    }
    return result;
}

// Adds what frame 1 of a method is, compared with the first method's.
static girih_result agree(bench_case_job *job, const bench_method *method, void *state,
                          bench_triangles *reference, json_t *object, girih_error *error) {
    bench_triangles triangles = {0};
    bench_agreement agreement;
    uint64_t open = 0;
    girih_result result = bench_capture(job, method, state, 1, &triangles, error);
    if (result == GIRIH_OK) {
        result = bench_compare(reference, &triangles, &agreement, error);
    }
    if (result == GIRIH_OK) {
        result = bench_open_edges(&triangles, &open, error);
    }
    if (result == GIRIH_OK) {
        json_object_set_new(object, "triangles", json_integer(triangles.count));
        json_object_set_new(object, "triangles_with_area",
                            json_integer(bench_triangles_with_area(&triangles)));
        json_object_set_new(object, "equal_triangles", json_boolean(agreement.equal));
        json_object_set_new(object, "largest_distance", json_real(agreement.largest_distance));
        json_object_set_new(object, "area_ratio", json_real(agreement.area_ratio));
        json_object_set_new(object, "open_edges", json_integer((json_int_t)open));
    }
    free(triangles.corners);
    return result;
}

// --- All methods --------------------------------------------------------------------------------

static girih_result measure_rasters(const bench_run *run, bench_case_job *const jobs[2],
                                    const bench_method *const pair[2], void *const states[2],
                                    json_t *object, girih_error *error) {
    samples *s = malloc(sizeof *s);
    if (!s) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_result result = GIRIH_OK;
    const uint32_t rasters = jobs[1]->desc.geometry_only ? 1 : 2;
    for (uint32_t raster = 0; raster < rasters && result == GIRIH_OK; ++raster) {
        char line[256];
        snprintf(line, sizeof line, "%s: %s, %s", jobs[1]->job.name, pair[1]->name,
                 raster_names[raster]);
        girih_report_progress(line);
        result = measure_raster(run, jobs, pair, states, raster, s, error);
        if (result == GIRIH_OK) {
            json_object_set_new(object, raster_names[raster], figures_of(s));
        }
    }
    girih_report_progress(NULL);
    free(s);
    return result;
}

static girih_result measure_method(const bench_run *run, bench_case_job *job,
                                   const bench_method *const pair[2], void *const states[2],
                                   bench_triangles *reference, json_t *object, girih_error *error) {
    girih_result result = GIRIH_OK;
    if (reference->corners) {
        result = agree(job, pair[1], states[1], reference, object, error);
    }
    if (result == GIRIH_OK && run->pictures) {
        result = write_picture(run, job, pair[1], states[1], error);
    }
    if (result == GIRIH_OK) {
        bench_case_job *const jobs[2] = {job, job};
        result = measure_rasters(run, jobs, pair, states, object, error);
    }
    return result;
}

girih_result bench_measure(const bench_run *run, bench_case_job *job,
                           const bench_method *const *methods, uint32_t method_count,
                           json_t *figures, girih_error *error) {
    void *base = NULL;
    bench_triangles reference = {0};
    const char *unfit = methods[0]->unfit ? methods[0]->unfit(&job->job) : NULL;
    if (unfit) {
        // Nothing to compare the others with.
        json_object_set_new(figures, methods[0]->name, json_pack("{s:s}", "unfit", unfit));
        return GIRIH_OK;
    }
    girih_result result = methods[0]->create(&job->job, methods[0]->variant, &base, error);
    if (result == GIRIH_OK && job->job.device->has_transform_feedback) {
        result = bench_capture(job, methods[0], base, 1, &reference, error);
    }
    for (uint32_t n = 0; n < method_count && result == GIRIH_OK; ++n) {
        json_t *object =
            json_pack("{s:s,s:s*}", "follows", methods[n]->follows, "note", methods[n]->note);
        json_object_set_new(figures, methods[n]->name, object);
        const char *why = methods[n]->unfit ? methods[n]->unfit(&job->job) : NULL;
        if (why) {
            json_object_set_new(object, "unfit", json_string(why));
            continue;
        }
        // One at a time, so that the methods' memory does not add up.
        void *own = NULL;
        result = methods[n]->create(&job->job, methods[n]->variant, &own, error);
        if (result == GIRIH_OK) {
            const bench_method *const pair[2] = {methods[0], methods[n]};
            void *const states[2] = {base, own};
            result = measure_method(run, job, pair, states, &reference, object, error);
        }
        methods[n]->destroy(own);
    }
    free(reference.corners);
    methods[0]->destroy(base);
    return result;
}

girih_result bench_measure_pair(const bench_run *run, bench_case_job *const jobs[2],
                                const bench_method *const pair[2], json_t *object,
                                girih_error *error) {
    void *states[2] = {NULL, NULL};
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < 2; ++n) {
        const char *why = pair[n]->unfit ? pair[n]->unfit(&jobs[n]->job) : NULL;
        if (why) {
            json_object_set_new(object, "unfit", json_string(why));
            return GIRIH_OK;
        }
    }
    for (uint32_t n = 0; n < 2 && result == GIRIH_OK; ++n) {
        result = pair[n]->create(&jobs[n]->job, pair[n]->variant, &states[n], error);
    }
    if (result == GIRIH_OK) {
        result = measure_rasters(run, jobs, pair, states, object, error);
    }
    for (uint32_t n = 0; n < 2; ++n) {
        pair[n]->destroy(states[n]);
    }
    return result;
}

// What the frames were: their seeds, and where the eye was.
static json_t *frames_of(const bench_case_job *job) {
    json_t *frames = json_array();
    for (uint32_t n = 0; n < job->desc.frame_count; ++n) {
        girih_frame frame = {0};
        bench_view view;
        job->desc.frame(job->desc.user, n, &frame, &view);
        json_array_append_new(frames, json_pack("{s:I,s:[f,f,f]}", "seed", (json_int_t)frame.seed,
                                                "eye", (double)frame.eye[0], (double)frame.eye[1],
                                                (double)frame.eye[2]));
    }
    return frames;
}

girih_result bench_add_case(const bench_run *run, const bench_case_job *job, json_t *figures,
                            girih_error *error) {
    json_t *item = json_pack("{s:s,s:I,s:I,s:o,s:O}", "name", job->job.name, "input_triangles",
                             (json_int_t)job->job.triangle_count, "output_triangles",
                             (json_int_t)job->reference.needed_triangles, "frames", frames_of(job),
                             "methods", figures);
    if (!item || json_array_append_new(run->cases, item) != 0) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    return GIRIH_OK;
}

girih_result bench_run_job(const bench_run *run, bench_target *target, const bench_job_desc *desc,
                           const bench_method *const *methods, uint32_t method_count,
                           girih_error *error) {
    bench_case_job job = {0};
    json_t *figures = json_object();
    girih_result result = bench_job_create(target, run->device, desc, &job, error);
    if (result == GIRIH_OK) {
        result = bench_measure(run, &job, methods, method_count, figures, error);
    }
    if (result == GIRIH_OK) {
        result = bench_add_case(run, &job, figures, error);
    }
    json_decref(figures);
    bench_job_destroy(&job);
    return result;
}
