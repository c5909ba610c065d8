#include "view_text.h"

#include <stdio.h>
#include <string.h>

#include "legend.h"

enum { LINE_SIZE = 200, MOST_LINES = 12 };

// Lines of a panel, as they are written.
typedef struct lines {
    char text[MOST_LINES][LINE_SIZE];
    girih_overlay_line lines[MOST_LINES];
    uint32_t count;
} lines;

static char *add_line(lines *l) {
    uint32_t n = l->count < MOST_LINES - 1 ? l->count++ : l->count;
    l->lines[n] = (girih_overlay_line){.text = l->text[n]};
    return l->text[n];
}

// 1234567 as 1,234,567.
static const char *grouped(uint64_t number, char text[32]) {
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)number);
    char *to = text;
    for (int n = 0; n < length; n++) {
        if (n > 0 && (length - n) % 3 == 0) {
            *to++ = ',';
        }
        *to++ = digits[n];
    }
    *to = '\0';
    return text;
}

static void describe_levels(const girih_level_options *levels, char *text, size_t size) {
    switch (levels->rule) {
    case GIRIH_LEVEL_EDGE_PIXELS:
        snprintf(text, size, "%.3g pixels a segment", (double)levels->length);
        break;
    case GIRIH_LEVEL_EDGE_LENGTH:
        snprintf(text, size, "length %.3g a segment", (double)levels->length);
        break;
    case GIRIH_LEVEL_SEGMENTS:
        snprintf(text, size, "%u segments an edge", levels->segments);
        break;
    default:
        snprintf(text, size, "1 to %u segments an edge", levels->segments);
        break;
    }
}

static const char *surface_name(girih_surface surface) {
    return surface == GIRIH_SURFACE_FLAT ? "flat"
           : surface == GIRIH_SURFACE_PN ? "PN"
                                         : "own surface";
}

static void write_time(char *text, size_t size, double milliseconds) {
    if (milliseconds < 0.0) {
        snprintf(text, size, "-");
    } else {
        snprintf(text, size, "%.*f", milliseconds < 10.0 ? 2 : 0, milliseconds);
    }
}

static void add_times(lines *l, const girih_view_status *status) {
    const girih_stage_times *times = status->times;
    const double stages[6] = {times->levels,   times->select,   times->group,
                              times->dispatch, times->evaluate, times->draw};
    char text[6][16];
    for (int n = 0; n < 6; n++) {
        write_time(text[n], sizeof text[n], stages[n]);
    }
    snprintf(add_line(l), LINE_SIZE, "ms: levels %s  select %s  group %s", text[0], text[1],
             text[2]);
    snprintf(add_line(l), LINE_SIZE, "dispatch %s  evaluate %s  draw %s", text[3], text[4],
             text[5]);
    snprintf(add_line(l), LINE_SIZE, "%.1f frames/s%s", status->frames_per_second,
             status->is_unchanged ? "  (nothing to refine)" : "");
}

static void add_statistics(lines *l, const girih_view_controls *controls,
                           const girih_view_status *status) {
    char levels[64], a[32], b[32];
    const char *name = strrchr(status->file, '/');
    describe_levels(&controls->levels, levels, sizeof levels);
    snprintf(add_line(l), LINE_SIZE, "%.80s  %s  %s  %s  %s%s",
             name != NULL ? name + 1 : status->file, surface_name(controls->surface), levels,
             girih_mode_name(status->mode), girih_shade_name(controls->look.shade),
             controls->is_frozen ? "  FROZEN" : "");
    snprintf(add_line(l), LINE_SIZE, "%s triangles in, %s culled",
             grouped(status->statistics->input_triangles, a),
             grouped(status->statistics->culled_triangles, b));
    snprintf(add_line(l), LINE_SIZE, "%s triangles out, %s vertices",
             grouped(status->statistics->output_triangles, a),
             grouped(status->statistics->output_vertices, b));
    char *text = add_line(l);
    snprintf(text, LINE_SIZE, "%u patterns in %u groups", status->statistics->base_patterns,
             status->statistics->groups);
    size_t used = strlen(text);
    if (status->statistics->split_triangles > 0) {
        snprintf(text + used, LINE_SIZE - used, ", %s split into %s parts",
                 grouped(status->statistics->split_triangles, a),
                 grouped(status->statistics->parts, b));
    }
    if (status->animation != NULL) {
        snprintf(add_line(l), LINE_SIZE, "%.80s  %.2f s%s", status->animation,
                 status->animation_time, controls->is_playing ? "" : "  (paused)");
    }
    add_times(l, status);
}

static girih_result add_keys(girih_overlay *overlay, const girih_rectangle *area,
                             girih_error *error) {
    enum { MOST_KEYS = 32 };
    char text[MOST_KEYS][96];
    girih_overlay_line lines_of[MOST_KEYS] = {0};
    uint32_t count = girih_view_key_count < MOST_KEYS ? girih_view_key_count : MOST_KEYS;
    for (uint32_t n = 0; n < count; n++) {
        snprintf(text[n], sizeof text[n], "%s:  %s", girih_view_keys[n].key,
                 girih_view_keys[n].what);
        lines_of[n].text = text[n];
    }
    const girih_overlay_text panel = {
        .lines = lines_of,
        .line_count = count,
        .corner = GIRIH_CORNER_TOP_RIGHT,
        .area = *area,
    };
    return girih_overlay_add(overlay, &panel, NULL, error);
}

// A message in lines of at most so many letters, broken at blanks.
static void add_message(lines *l, const girih_view_status *status) {
    const size_t widest = 90;
    const char *rest = status->message;
    while (*rest != '\0' && l->count < MOST_LINES - 1) {
        size_t length = strlen(rest);
        if (length > widest) {
            length = widest;
            while (length > widest / 2 && rest[length] != ' ') {
                length--;
            }
        }
        bool is_first = rest == status->message;
        snprintf(add_line(l), LINE_SIZE, "%.*s", (int)length, rest);
        if (is_first && status->is_failure) {
            l->lines[l->count - 1].has_swatch = true;
            l->lines[l->count - 1].color[0] = 0.85f;
        }
        rest += length;
        rest += *rest == ' ';
    }
}

girih_result girih_view_text(girih_overlay *overlay, const girih_view_controls *controls,
                             const girih_view_status *status, uint32_t width, uint32_t height,
                             girih_error *error) {
    girih_overlay_clear(overlay);
    const girih_rectangle area = {0, 0, width, height};
    lines l = {.count = 0};
    girih_result result = GIRIH_OK;
    if (controls->shows_statistics && !controls->shows_help) {
        add_statistics(&l, controls, status);
        const girih_overlay_text panel = {
            .lines = l.lines, .line_count = l.count, .corner = GIRIH_CORNER_TOP_LEFT, .area = area};
        result = girih_overlay_add(overlay, &panel, NULL, error);
    }
    if (result == GIRIH_OK && controls->shows_statistics && !controls->shows_help) {
        result = girih_legend_add(overlay, controls->look.shade, status->catalogue, status->plan,
                                  GIRIH_CORNER_BOTTOM_RIGHT, &area, NULL, error);
    }
    if (result == GIRIH_OK && controls->shows_help) {
        result = add_keys(overlay, &area, error);
    }
    if (result == GIRIH_OK && status->message[0] != '\0') {
        l.count = 0;
        add_message(&l, status);
        const girih_overlay_text panel = {.lines = l.lines,
                                          .line_count = l.count,
                                          .corner = GIRIH_CORNER_BOTTOM_LEFT,
                                          .area = area};
        result = girih_overlay_add(overlay, &panel, NULL, error);
    }
    return result;
}
