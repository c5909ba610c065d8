#include "report.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static bool progress_shown;
static const char *progress_what; // whose parts are counted, NULL: none
static double progress_begin, progress_next;
static const char *part_kind; // of several files or pictures
static uint32_t part_number, part_count;
static double parts_begin;

const char *girih_report_style(FILE *stream, girih_style style) {
    static const char *const codes[] = {"\033[0m", "\033[1m", "\033[32m", "\033[33m", "\033[1;31m"};
    const char *refused = getenv("NO_COLOR");
    const char *terminal = getenv("TERM");
    bool has_styles = isatty(fileno(stream)) && (refused == NULL || refused[0] == '\0') &&
                      terminal != NULL && strcmp(terminal, "dumb") != 0;
    return has_styles ? codes[style] : "";
}

// "girih:" and, where it is not NULL, "FILE:".
static void begin_message(girih_style style, const char *file) {
    girih_report_progress(NULL);
    fprintf(stderr, "%sgirih:%s ", girih_report_style(stderr, style),
            girih_report_style(stderr, GIRIH_STYLE_PLAIN));
    if (file != NULL) {
        fprintf(stderr, "%s: ", file);
    }
}

int girih_report_failure(const char *file, const char *what) {
    // Messages about reading and writing begin with the file already.
    size_t length = file != NULL ? strlen(file) : 0;
    bool is_named = file != NULL && strncmp(what, file, length) == 0 && what[length] == ':';
    begin_message(GIRIH_STYLE_FAILURE, is_named ? NULL : file);
    fprintf(stderr, "%s\n", what);
    return GIRIH_EXIT_FAILED;
}

void girih_report_warning(const char *file, const char *what) {
    begin_message(GIRIH_STYLE_WARNING, file);
    fprintf(stderr, "warning: %s\n", what);
}

void girih_report_gltf_warning(void *user, const char *line) {
    girih_report_warning(user, line);
}

// "5 s left", or nothing as long as too little is done to tell.
static void print_time_left(double begin, uint64_t done, uint64_t all) {
    double seconds = girih_seconds() - begin;
    if (done == 0 || all == 0 || seconds < 1.0) {
        return;
    }
    double left = seconds * (double)(all - done) / (double)done;
    if (left < 90.0) {
        fprintf(stderr, ", %.0f s left", left);
    } else {
        fprintf(stderr, ", %.0f min left", left / 60.0);
    }
}

static bool begin_progress(void) {
    if (!isatty(STDERR_FILENO)) {
        return false;
    }
    fputs("\r\033[K", stderr);
    progress_shown = true;
    if (part_count > 1) {
        fprintf(stderr, "%s %u of %u", part_kind, part_number + 1, part_count);
        print_time_left(parts_begin, part_number, part_count);
        fputs(": ", stderr);
    }
    return true;
}

void girih_report_progress(const char *what) {
    if (what == NULL) {
        if (progress_shown) {
            fputs("\r\033[K", stderr);
            progress_shown = false;
        }
    } else if (begin_progress()) {
        fprintf(stderr, "%s ...", what);
        fflush(stderr);
    }
    progress_what = NULL;
}

void girih_report_progress_of(const char *what, uint64_t done, uint64_t all) {
    double now = girih_seconds();
    if (what != progress_what) {
        progress_what = what;
        progress_begin = now;
        progress_next = 0.0;
    }
    // A terminal shows no more than some lines a second.
    if (now >= progress_next && begin_progress()) {
        progress_next = now + 0.1;
        fprintf(stderr, "%s, %.0f %%", what, 100.0 * (double)done / (double)(all != 0 ? all : 1));
        print_time_left(progress_begin, done, all);
        fflush(stderr);
    }
}

void girih_report_part(const char *kind, uint32_t number, uint32_t count) {
    if (number == 0) {
        parts_begin = girih_seconds();
    }
    part_kind = kind;
    part_number = number;
    part_count = count;
}

const girih_stage_times girih_no_times = {-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0};

double girih_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static json_t *milliseconds(double time) {
    return time < 0.0 ? json_null() : json_real(time);
}

json_t *girih_report_json(const char *device, const char *mode, const girih_statistics *statistics,
                          const girih_stage_times *times) {
    return json_pack(
        "{s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:{s:o, s:o, s:o, s:o, s:o, s:o}, "
        "s:o}",
        "device", device, "mode", mode, "input_triangles", (json_int_t)statistics->input_triangles,
        "culled_triangles", (json_int_t)statistics->culled_triangles, "clamped_edges",
        (json_int_t)statistics->clamped_edges, "split_triangles",
        (json_int_t)statistics->split_triangles, "parts", (json_int_t)statistics->parts,
        "output_triangles", (json_int_t)statistics->output_triangles, "output_vertices",
        (json_int_t)statistics->output_vertices, "groups", (json_int_t)statistics->groups,
        "base_patterns", (json_int_t)statistics->base_patterns, "time_ms", "levels",
        milliseconds(times->levels), "select", milliseconds(times->select), "group",
        milliseconds(times->group), "dispatch", milliseconds(times->dispatch), "evaluate",
        milliseconds(times->evaluate), "draw", milliseconds(times->draw), "wall_ms",
        milliseconds(times->wall));
}

void girih_report_text(const char *device, const char *mode, const girih_statistics *statistics,
                       const girih_stage_times *times) {
    girih_report_progress(NULL);
    fprintf(stderr, "%s, %s\n", device, mode);
    fprintf(stderr,
            "%" PRIu64 " triangles in, %" PRIu64 " culled, %" PRIu64 " triangles out with %" PRIu64
            " vertices, %u base patterns in %u groups\n",
            statistics->input_triangles, statistics->culled_triangles, statistics->output_triangles,
            statistics->output_vertices, statistics->base_patterns, statistics->groups);
    if (statistics->split_triangles != 0) {
        fprintf(stderr, "%" PRIu64 " triangles beyond the catalogue split into %" PRIu64 " parts\n",
                statistics->split_triangles, statistics->parts);
    }
    if (statistics->clamped_edges != 0) {
        fprintf(stderr,
                "%" PRIu64
                " edges asked for more segments than the catalogue and --max-segments allow\n",
                statistics->clamped_edges);
    }
    if (times->levels >= 0.0) {
        fprintf(stderr, "ms: levels %.2f, select %.2f, group %.2f, dispatch %.2f, evaluate %.2f",
                times->levels, times->select, times->group, times->dispatch, times->evaluate);
        if (times->draw >= 0.0) {
            fprintf(stderr, ", draw %.2f", times->draw);
        }
        fputc('\n', stderr);
    } else if (times->wall >= 0.0) {
        fprintf(stderr, "ms: %.2f\n", times->wall);
    }
}

int girih_report_print(json_t *root) {
    girih_report_progress(NULL);
    int failed = root == NULL ||
                 json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) != 0 ||
                 fputc('\n', stdout) == EOF || fflush(stdout) != 0;
    json_decref(root);
    return failed ? girih_report_failure(NULL, "cannot write the JSON report to standard output")
                  : GIRIH_EXIT_DONE;
}

int girih_report_print_files(json_t *objects, uint32_t count) {
    int code = GIRIH_EXIT_DONE;
    if (count > 1) {
        code = girih_report_print(json_pack("{s:O}", "files", objects));
    } else if (json_array_size(objects) == 1) {
        code = girih_report_print(json_incref(json_array_get(objects, 0)));
    }
    json_decref(objects);
    return code;
}
