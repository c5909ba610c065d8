#include "legend.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "picture.h"

enum { TEXT_SIZE = 64 };

// Lines and their texts, which outlive no call.
typedef struct draft {
    girih_overlay_line *lines;
    char (*texts)[TEXT_SIZE];
    uint32_t count;
} draft;

static girih_overlay_line *next_line(draft *d, const float *color) {
    girih_overlay_line *line = &d->lines[d->count];
    *line = (girih_overlay_line){.text = d->texts[d->count]};
    if (color != NULL) {
        line->has_swatch = true;
        memcpy(line->color, color, sizeof line->color);
    }
    d->count++;
    return line;
}

static void write_line(draft *d, const float *color, const char *text) {
    snprintf(d->texts[d->count], TEXT_SIZE, "%s", text);
    next_line(d, color);
}

static bool is_used(const girih_plan *plan, uint32_t rank) {
    return plan == NULL || girih_plan_uses_pattern(plan, rank) != 0;
}

// What a triangle's colour stands for where triangles are split.
static void write_parts(draft *d, const girih_plan *plan) {
    if (plan != NULL && girih_plan_statistics(plan).parts != 0) {
        write_line(d, NULL, "(a split triangle's parts)");
    }
}

static void draft_normals(draft *d) {
    static const char *const axes[3] = {"x", "y", "z"};
    write_line(d, NULL, "normal towards");
    for (int n = 0; n < 6; n++) {
        float color[3] = {0.5f, 0.5f, 0.5f};
        color[n / 2] = n % 2 == 0 ? 1.0f : 0.0f;
        char text[8];
        snprintf(text, sizeof text, "%s%s", n % 2 == 0 ? "+" : "\u2212", axes[n / 2]);
        write_line(d, color, text);
    }
}

static void draft_levels(draft *d, const girih_catalogue *catalogue, const girih_plan *plan) {
    write_line(d, NULL, "segments of the");
    write_line(d, NULL, "finest edge");
    write_parts(d, plan);
    for (uint32_t level = 0; level < catalogue->level_count; level++) {
        bool used = false;
        for (uint32_t rank = 0; rank < catalogue->pattern_count && !used; rank++) {
            used =
                girih_catalogue_pattern(catalogue, rank)->levels[0] == level && is_used(plan, rank);
        }
        if (used) {
            float color[4];
            girih_picture_level_color(catalogue, level, color);
            char text[TEXT_SIZE];
            snprintf(text, sizeof text, "%u", girih_catalogue_segments(catalogue, level));
            write_line(d, color, text);
        }
    }
}

// Where more are in use than can be shown, those shown are spread evenly over them.
static void draft_patterns(draft *d, const girih_catalogue *catalogue, const girih_plan *plan,
                           uint32_t most) {
    write_line(d, NULL, "base patterns:");
    write_line(d, NULL, "segments of the edges");
    write_parts(d, plan);
    if (plan == NULL) {
        write_line(d, NULL, "a colour each");
        return;
    }
    uint32_t used = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        used += is_used(plan, rank);
    }
    uint32_t shown = used < most ? used : most;
    if (used > shown) {
        char text[TEXT_SIZE];
        snprintf(text, sizeof text, "%u of %u in use", shown, used);
        write_line(d, NULL, text);
    }
    uint32_t number = 0;
    for (uint32_t rank = 0; rank < catalogue->pattern_count; rank++) {
        if (!is_used(plan, rank)) {
            continue;
        }
        // The first of each of `shown` equal shares.
        if (number == 0 || number * shown / used != (number - 1) * shown / used) {
            const girih_base_pattern *pattern = girih_catalogue_pattern(catalogue, rank);
            float color[4];
            girih_picture_pattern_color(rank, color);
            char text[TEXT_SIZE];
            snprintf(text, sizeof text, "%u %u %u", pattern->segments[0], pattern->segments[1],
                     pattern->segments[2]);
            write_line(d, color, text);
            d->lines[d->count - 1].pattern = pattern;
        }
        number++;
    }
}

static void draft_density(draft *d) {
    static const char *const texts[GIRIH_DENSITY_COLORS] = {
        "\u00bc and fewer", "1", "4", "16", "64", "256", "1024 and more"};
    write_line(d, NULL, "pixels that a");
    write_line(d, NULL, "triangle covers");
    for (int n = 0; n < GIRIH_DENSITY_COLORS; n++) {
        write_line(d, girih_density_colors[n], texts[n]);
    }
}

girih_result girih_legend_add(girih_overlay *overlay, girih_shade shade,
                              const girih_catalogue *catalogue, const girih_plan *plan,
                              girih_corner corner, const girih_rectangle *area, bool *fits,
                              girih_error *error) {
    if (fits != NULL) {
        *fits = true;
    }
    if (shade == GIRIH_SHADE_LIT) {
        return GIRIH_OK;
    }
    // Two columns, so that there is a picture beside them.
    const uint32_t most_patterns = 2 * girih_overlay_patterns(area);
    const uint32_t most = most_patterns + catalogue->level_count + GIRIH_DENSITY_COLORS + 5;
    draft d = {.lines = malloc(most * sizeof *d.lines), .texts = malloc(most * sizeof *d.texts)};
    girih_result result = GIRIH_OK;
    if (d.lines == NULL || d.texts == NULL) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else {
        switch (shade) {
        case GIRIH_SHADE_NORMALS: draft_normals(&d); break;
        case GIRIH_SHADE_LEVELS: draft_levels(&d, catalogue, plan); break;
        case GIRIH_SHADE_PATTERNS: draft_patterns(&d, catalogue, plan, most_patterns); break;
        default: draft_density(&d); break;
        }
        const girih_overlay_text text = {.lines = d.lines,
                                         .line_count = d.count,
                                         .corner = corner,
                                         .area = *area,
                                         .is_scale = shade == GIRIH_SHADE_DENSITY,
                                         .catalogue = catalogue};
        result = girih_overlay_add(overlay, &text, fits, error);
    }
    free(d.lines);
    free(d.texts);
    return result;
}
