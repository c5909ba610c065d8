// girih-bench: figures as ratios of alternating runs in one process. No absolute time is a fact on
// a shared machine.
#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "error.h"
#include "statistics.h"

typedef struct arguments {
    bool json;
    const char *only; // the case to run; NULL: all
    uint32_t pairs;
    const char *samples;
    const char *pictures;
    uint32_t picture_size;
    girih_device_options device;
} arguments;

static const struct bench_case {
    const char *name;
    const char *what;
    girih_result (*run)(const bench_run *run, girih_error *error);
} cases[] = {
    {"spheres", "Curved PN spheres with random levels, against the static mesh", bench_spheres},
    {"families", "built-in patterns against `uniform`, as many triangles", bench_families},
    {"spacings", "linear against dyadic at the same rule; making either ready", bench_spacings},
    {"errors", "triangles against distance, normal and picture errors", bench_errors},
    {"instances", "a thousand instances of a hundred meshes, against one mesh", bench_instances},
    {"cities", "DMR's flight through a city in a cylindrical projection", bench_cities},
    {"large_city", "the same through a city nine times as large", bench_large_city},
    {"conditions", "few groups or many, views that move or stand, surfaces", bench_conditions},
    {"bake", "bake-only throughput, against the CPU twin and OpenSubdiv's Bfr", bench_bake},
    {"scaling", "time and memory of a triangle, by input and output", bench_scaling},
    {"table3", "ARKFPI's Table 3: its 19 input and output sizes, against ARK", bench_table3},
    {"knuth", "geometry shaders by level, against girih; a thin tetrahedron", bench_knuth_case},
};
#define CASE_COUNT (sizeof cases / sizeof *cases)

static const struct argp_option options[] = {
    {"json", 'j', NULL, 0, "Print one JSON object on standard output and nothing else there", 0},
    {"case", 'c', "NAME", 0, "Run one case alone; their names are below", 0},
    {"runs", 'n', "N", 0,
     "Pairs of alternating runs, 40 to 4096 (default: 40), or 1 to see only whether all methods "
     "draw the same",
     0},
    {"csv", 's', "FILE", 0, "Write every timed frame to FILE", 0},
    {"pictures", 'p', "FOLDER", 0, "Write a picture of each case and method into FOLDER", 0},
    {"picture-size", 'z', "N", 0, "Width of these pictures: 1024 (the default), 512, 256 or 128",
     0},
    {"device", 'd', "NAME", 0, "The device whose name contains NAME", 0},
    {"validation", 'v', NULL, 0, "Turn the validation layers on; figures mean nothing then", 0},
    {0}};

static error_t parse(int key, char *value, struct argp_state *state) {
    arguments *a = state->input;
    switch (key) {
    case 'j':
        a->json = true;
        return 0;
    case 'c':
        for (size_t n = 0; n < CASE_COUNT; ++n) {
            if (strcmp(value, cases[n].name) == 0) {
                a->only = cases[n].name;
                return 0;
            }
        }
        argp_error(state, "there is no case '%s'; --help lists them", value);
        return EINVAL;
    case 'n': {
        char *end;
        const long runs = strtol(value, &end, 10);
        if (*end || (runs < 40 && runs != 1) || runs > (long)STATISTICS_MOST) {
            argp_error(state, "--runs %s: 1, or a number from 40 to %u, is wanted", value,
                       STATISTICS_MOST);
            return EINVAL;
        }
        a->pairs = (uint32_t)runs;
        return 0;
    }
    case 's':
        a->samples = value;
        return 0;
    case 'p':
        a->pictures = value;
        return 0;
    case 'z':
        a->picture_size = (uint32_t)strtoul(value, NULL, 10);
        if (a->picture_size != 1024 && a->picture_size != 512 && a->picture_size != 256 &&
            a->picture_size != 128) {
            argp_error(state, "--picture-size %s: 1024, 512, 256 or 128 is wanted", value);
            return EINVAL;
        }
        return 0;
    case 'd':
        a->device.name = value;
        return 0;
    case 'v':
        a->device.validation = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "'%s' is not expected", value);
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

// The text after the options: the cases.
static char *help_text(int key, const char *text, void *input) {
    (void)input;
    if (key != ARGP_KEY_HELP_POST_DOC) {
        return (char *)text;
    }
    size_t size = 0;
    char *whole = NULL;
    FILE *stream = open_memstream(&whole, &size);
    if (!stream) {
        return NULL;
    }
    fputs("Cases:\n", stream);
    for (size_t n = 0; n < CASE_COUNT; ++n) {
        fprintf(stream, "  %-10s %s\n", cases[n].name, cases[n].what);
    }
    fprintf(stream, "\n%s", text);
    return fclose(stream) == 0 ? whole : NULL;
}

// One line: the ratios of figures that have any.
static void print_ratios(const char *name, const json_t *figures) {
    const json_t *g = json_object_get(figures, "geometry");
    const json_t *s = json_object_get(figures, "shaded");
    if (!g) {
        return;
    }
    printf("  %-20s geometry %6.2f (%.2f to %.2f)", name,
           json_real_value(json_object_get(g, "ratio")),
           json_real_value(json_object_get(g, "ratio_low")),
           json_real_value(json_object_get(g, "ratio_high")));
    if (s) {
        printf(", shaded %6.2f (%.2f to %.2f)", json_real_value(json_object_get(s, "ratio")),
               json_real_value(json_object_get(s, "ratio_low")),
               json_real_value(json_object_get(s, "ratio_high")));
    }
    printf("\n");
}

// One line a point of the case `errors`.
static void print_points(const json_t *points) {
    size_t n;
    const json_t *point;
    json_array_foreach(points, n, point) {
        if (json_object_get(point, "unfit")) {
            continue;
        }
        printf("  %-28s %8" JSON_INTEGER_FORMAT " triangles: distance %.2e, normals %.3f degrees "
               "(most %.3f), picture %.2f\n",
               json_string_value(json_object_get(point, "method")),
               json_integer_value(json_object_get(point, "triangles")),
               json_real_value(json_object_get(point, "hausdorff")),
               json_real_value(json_object_get(point, "normal_degrees_mean")),
               json_real_value(json_object_get(point, "normal_degrees_max")),
               json_real_value(json_object_get(point, "image_rms")));
    }
}

static void print_table(const json_t *report) {
    size_t n;
    const json_t *item;
    printf("%s\n", json_string_value(json_object_get(report, "device")));
    json_array_foreach(json_object_get(report, "cases"), n, item) {
        const char *ratio_to = json_string_value(json_object_get(item, "ratio_to"));
        printf("\n%s: %" JSON_INTEGER_FORMAT " triangles in, %" JSON_INTEGER_FORMAT
               " out; ratio to %s (95 %% interval)\n",
               json_string_value(json_object_get(item, "name")),
               json_integer_value(json_object_get(item, "input_triangles")),
               json_integer_value(json_object_get(item, "output_triangles")),
               ratio_to ? ratio_to : "the first method");
        const char *name;
        json_t *figures;
        json_object_foreach(json_object_get(item, "methods"), name, figures) {
            print_ratios(name, figures);
        }
        print_points(json_object_get(item, "points"));
        print_ratios("hardware to girih", json_object_get(item, "against_hardware"));
    }
}

// Runs the cases that are wanted.
static girih_result run_cases(const arguments *a, bench_run *run, girih_error *error) {
    girih_result result = GIRIH_OK;
    if (a->samples) {
        run->samples = fopen(a->samples, "w");
        if (!run->samples) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "--csv %s: %s", a->samples,
                              strerror(errno));
        }
        fprintf(run->samples, "case,method,first_method,raster,pair,ms,first_method_ms,cpu_ms,"
                              "first_method_cpu_ms\n");
    }
    for (size_t n = 0; n < CASE_COUNT && result == GIRIH_OK; ++n) {
        if (!a->only || strcmp(a->only, cases[n].name) == 0) {
            fprintf(stderr, "girih-bench: %s\n", cases[n].name);
            result = cases[n].run(run, error);
        }
    }
    if (run->samples && fclose(run->samples) != 0 && result == GIRIH_OK) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "--csv %s: %s", a->samples,
                            strerror(errno));
    }
    return result;
}

int main(int argc, char **argv) {
    arguments a = {.pairs = 40, .picture_size = BENCH_PIXELS};
    static const struct argp argp = {
        options,
        parse,
        NULL,
        "Measure girih against its rivals, as ratios of alternating runs in one process.\v"
        "Examples:\n  girih-bench --json --case spheres\n  girih-bench --runs 100",
        NULL,
        help_text,
        NULL};
    argp_err_exit_status = 2;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    girih_device device;
    girih_error error = {0};
    const girih_device_wishes wishes = {.graphics = true,
                                        .transform_feedback = true,
                                        .features.geometryShader = VK_TRUE,
                                        .features.tessellationShader = VK_TRUE,
                                        .features.shaderClipDistance = VK_TRUE};
    girih_result result = girih_device_open(&device, &a.device, &wishes, &error);
    if (result != GIRIH_OK) {
        fprintf(stderr, "girih-bench: %s\n", error.message);
        return 1;
    }
    json_t *report = json_pack("{s:s,s:[]}", "device", device.properties.deviceName, "cases");
    bench_run run = {.device = &device,
                     .pairs = a.pairs,
                     .cases = json_object_get(report, "cases"),
                     .pictures = a.pictures,
                     .picture_size = a.picture_size};
    result = run_cases(&a, &run, &error);
    if (result == GIRIH_OK && device.validation_messages != 0) {
        result = girih_fail(&error, GIRIH_ERROR_INVALID_DATA, "%u validation messages",
                            device.validation_messages);
    }
    if (result != GIRIH_OK) {
        fprintf(stderr, "girih-bench: %s\n", error.message);
    } else if (a.json) {
        json_dumpf(report, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
        printf("\n");
    } else {
        print_table(report);
    }
    json_decref(report);
    girih_device_close(&device);
    return result == GIRIH_OK ? 0 : 1;
}
