// girih-bench: figures as ratios of alternating runs in one process. No absolute time is a fact on
// a shared machine.
#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"
#include "statistics.h"

typedef struct arguments {
    bool json;
    const char *only; // the case to run; NULL: all
    uint32_t pairs;
    girih_device_options device;
} arguments;

static const struct bench_case {
    const char *name;
    girih_result (*run)(girih_device *device, uint32_t pairs, json_t *cases, girih_error *error);
} cases[] = {{"spheres", bench_spheres}, {"instances", bench_instances}};
#define CASE_COUNT (sizeof cases / sizeof *cases)

static const struct argp_option options[] = {
    {"json", 'j', NULL, 0, "Print one JSON object on standard output and nothing else there", 0},
    {"case", 'c', "NAME", 0, "Run one case: spheres, instances", 0},
    {"runs", 'n', "N", 0, "Pairs of alternating runs, 40 to 4096 (default: 40)", 0},
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
        argp_error(state, "there is no case '%s'; cases: spheres, instances", value);
        return EINVAL;
    case 'n': {
        char *end;
        const long runs = strtol(value, &end, 10);
        if (*end || runs < 40 || runs > (long)STATISTICS_MOST) {
            argp_error(state, "--runs %s: a number from 40 to %u is wanted", value,
                       STATISTICS_MOST);
            return EINVAL;
        }
        a->pairs = (uint32_t)runs;
        return 0;
    }
    case ARGP_KEY_ARG:
        argp_error(state, "'%s' is not expected", value);
        return EINVAL;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void print_table(const json_t *report) {
    size_t n;
    const json_t *item;
    printf("%s\n", json_string_value(json_object_get(report, "device")));
    json_array_foreach(json_object_get(report, "cases"), n, item) {
        printf("\n%s: %" JSON_INTEGER_FORMAT " triangles in, %" JSON_INTEGER_FORMAT
               " out; ratio to the first method (95 %% interval)\n",
               json_string_value(json_object_get(item, "name")),
               json_integer_value(json_object_get(item, "input_triangles")),
               json_integer_value(json_object_get(item, "output_triangles")));
        const char *name;
        json_t *figures;
        json_object_foreach(json_object_get(item, "methods"), name, figures) {
            const json_t *g = json_object_get(figures, "geometry");
            const json_t *s = json_object_get(figures, "shaded");
            printf("  %-16s geometry %6.2f (%.2f to %.2f), shaded %6.2f (%.2f to %.2f)\n", name,
                   json_real_value(json_object_get(g, "ratio")),
                   json_real_value(json_object_get(g, "ratio_low")),
                   json_real_value(json_object_get(g, "ratio_high")),
                   json_real_value(json_object_get(s, "ratio")),
                   json_real_value(json_object_get(s, "ratio_low")),
                   json_real_value(json_object_get(s, "ratio_high")));
        }
    }
}

int main(int argc, char **argv) {
    arguments a = {.pairs = 40};
    static const struct argp argp = {
        options,
        parse,
        NULL,
        "Measure girih against its rivals, as ratios of alternating runs in one process.\v"
        "Examples:\n  girih-bench --json --case spheres\n  girih-bench --runs 100",
        NULL,
        NULL,
        NULL};
    argp_err_exit_status = 2;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    girih_device device;
    girih_error error = {0};
    girih_result result = girih_device_open(&device, &a.device, true, NULL, &error);
    if (result != GIRIH_OK) {
        fprintf(stderr, "girih-bench: %s\n", error.message);
        return 1;
    }
    json_t *report = json_pack("{s:s,s:[]}", "device", device.properties.deviceName, "cases");
    for (size_t n = 0; n < CASE_COUNT && result == GIRIH_OK; ++n) {
        if (!a.only || strcmp(a.only, cases[n].name) == 0) {
            fprintf(stderr, "girih-bench: %s\n", cases[n].name);
            result = cases[n].run(&device, a.pairs, json_object_get(report, "cases"), &error);
        }
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
