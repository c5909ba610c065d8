#include "overlay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cairo.h>

#include "error.h"

// Of a text that is not UTF-8.
enum { MOST_LETTERS = 512 };

// Lengths are pixels before a panel is made smaller.
typedef struct layout {
    double letter; // size of the letters
    double line;   // height of a line, and of one with a pattern
    double pattern;
    double margin;       // between the panel's border and what is in it, and around the panel
    double swatch;       // width of a field of colour, 0: there is none
    double text_x;       // where text begins behind a field
    double column;       // width of a column
    uint32_t head, rows; // lines before the columns, and lines in each of them
    uint32_t column_count;
    double width, height;
} layout;

static double line_height(const girih_overlay_text *text, const layout *l, uint32_t n) {
    return text->lines[n].pattern != NULL ? l->pattern : l->line;
}

// The upper left corner of a line.
static void find_line(const girih_overlay_text *text, const layout *l, uint32_t n, double *x,
                      double *y) {
    bool is_head = n < l->head;
    uint32_t column = is_head ? 0 : (n - l->head) / l->rows;
    *x = l->margin + l->column * column;
    *y = l->margin;
    for (uint32_t k = 0; k < n; k++) {
        bool is_above = k < l->head || (k - l->head) / l->rows == column;
        *y += is_above ? line_height(text, l, k) : 0.0;
    }
}

static layout begin_layout(const girih_rectangle *area) {
    double letter = fmin(fmax(round((double)area->height / 46.0), 11.0), 30.0);
    return (layout){.letter = letter,
                    .line = round(1.4 * letter),
                    .pattern = round(2.9 * letter),
                    .margin = round(0.6 * letter)};
}

// Lines of a height that one column holds in three quarters of the area's height.
static uint32_t column_room(const girih_rectangle *area, const layout *l, double line) {
    double room = 0.75 * (double)area->height - 2.0 * l->margin - l->line * l->head;
    return (uint32_t)fmax(1.0, floor(room / line));
}

static void choose_font(cairo_t *cairo, double size) {
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
}

// Whether bytes after a first one of UTF-8 carry it on.
static bool continues(const unsigned char *text, int count) {
    for (int n = 1; n <= count; n++) {
        if ((text[n] & 0xc0) != 0x80) {
            return false;
        }
    }
    return true;
}

// The text, where it is UTF-8, which cairo insists on; file names may be anything, so else a copy
// with question marks.
static const char *readable(const char *text, char copy[MOST_LETTERS]) {
    const unsigned char *at = (const unsigned char *)text;
    while (*at != 0) {
        int more = *at < 0x80   ? 0
                   : *at < 0xc2 ? -1
                   : *at < 0xe0 ? 1
                   : *at < 0xf0 ? 2
                   : *at < 0xf5 ? 3
                                : -1;
        bool is_bad = more < 0 || !continues(at, more) || (*at == 0xe0 && at[1] < 0xa0) ||
                      (*at == 0xed && at[1] >= 0xa0) || (*at == 0xf0 && at[1] < 0x90) ||
                      (*at == 0xf4 && at[1] >= 0x90);
        if (is_bad) {
            break;
        }
        at += more + 1;
    }
    if (*at == 0) {
        return text;
    }
    size_t length = 0;
    for (; text[length] != '\0' && length + 1 < MOST_LETTERS; length++) {
        copy[length] = (unsigned char)text[length] < 0x80 ? text[length] : '?';
    }
    copy[length] = '\0';
    return copy;
}

static double text_width(cairo_t *cairo, const girih_overlay_line *line) {
    char copy[MOST_LETTERS];
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, readable(line->text, copy), &extents);
    return extents.x_advance;
}

static layout lay_out(cairo_t *cairo, const girih_overlay_text *text) {
    layout l = begin_layout(&text->area);
    choose_font(cairo, l.letter);
    while (l.head < text->line_count && !text->lines[l.head].has_swatch) {
        l.width = fmax(l.width, text_width(cairo, &text->lines[l.head++]));
    }
    uint32_t body = text->line_count - l.head;
    double widest = 0.0;
    double body_line = l.line;
    for (uint32_t n = l.head; n < text->line_count; n++) {
        const girih_overlay_line *line = &text->lines[n];
        widest = fmax(widest, text_width(cairo, line));
        l.swatch = fmax(l.swatch, round((line->pattern != NULL ? 3.2 : 1.7) * l.letter));
        body_line = fmax(body_line, line_height(text, &l, n));
    }
    l.text_x = l.swatch + round(0.6 * l.letter);
    l.column = ceil(l.text_x + widest + l.letter);
    uint32_t most = column_room(&text->area, &l, body_line);
    l.column_count = text->is_scale || body <= most ? 1 : (body + most - 1) / most;
    l.rows = body == 0 ? 1 : (body + l.column_count - 1) / l.column_count;
    if (body != 0) {
        l.width = fmax(l.width, l.column * l.column_count - l.letter);
    }
    l.width = ceil(l.width + 2.0 * l.margin);
    l.height = 2.0 * l.margin + l.line * l.head + (body == 0 ? 0.0 : body_line * l.rows);
    return l;
}

// The base pattern as an equilateral triangle in a box.
static void draw_pattern(cairo_t *cairo, const girih_catalogue *catalogue,
                         const girih_overlay_line *line, double x, double y, double width,
                         double height) {
    const girih_base_pattern *pattern = line->pattern;
    const uint32_t *vertices = girih_catalogue_vertices(catalogue, pattern);
    double side = fmin(width, height / 0.8660254);
    double corners[3][2] = {{x, y + height}, {x + side, y + height}, {x + side / 2.0, 0.0}};
    corners[2][1] = y + height - side * 0.8660254;
    for (uint32_t n = 0; n < 3 * pattern->triangle_count; n++) {
        uint32_t packed = vertices[girih_catalogue_index(catalogue, pattern, n)];
        double u = (double)(packed & 0xffffu) / GIRIH_BARYCENTRIC_ONE;
        double v = (double)(packed >> 16) / GIRIH_BARYCENTRIC_ONE;
        double w = 1.0 - u - v;
        double place[2];
        for (int k = 0; k < 2; k++) {
            place[k] = u * corners[0][k] + v * corners[1][k] + w * corners[2][k];
        }
        if (n % 3 == 0) {
            cairo_move_to(cairo, place[0], place[1]);
        } else {
            cairo_line_to(cairo, place[0], place[1]);
        }
        if (n % 3 == 2) {
            cairo_close_path(cairo);
        }
    }
    cairo_set_source_rgb(cairo, (double)line->color[0], (double)line->color[1],
                         (double)line->color[2]);
    cairo_fill_preserve(cairo);
    cairo_set_source_rgba(cairo, 0.0, 0.0, 0.0, 0.75);
    cairo_set_line_width(cairo, pattern->triangle_count > 100 ? 0.3 : 0.7);
    cairo_stroke(cairo);
}

static void draw_swatch(cairo_t *cairo, const girih_overlay_text *text, const layout *l, uint32_t n,
                        double x, double y) {
    const girih_overlay_line *line = &text->lines[n];
    if (line->pattern != NULL) {
        draw_pattern(cairo, text->catalogue, line, x, y + 0.06 * l->pattern, l->swatch,
                     0.88 * l->pattern);
        return;
    }
    double gap = round(0.12 * l->line);
    cairo_rectangle(cairo, x, y + gap, l->swatch, l->line - 2.0 * gap);
    cairo_set_source_rgb(cairo, (double)line->color[0], (double)line->color[1],
                         (double)line->color[2]);
    cairo_fill(cairo);
}

// A bar from the middle of the first line with a field to that of the last one, with a mark at
// each.
static void draw_scale(cairo_t *cairo, const girih_overlay_text *text, const layout *l) {
    if (l->rows < 2) {
        return;
    }
    double x = l->margin;
    double top = l->margin + l->line * (l->head + 0.5);
    double bottom = top + l->line * (l->rows - 1);
    cairo_pattern_t *bar = cairo_pattern_create_linear(0.0, top, 0.0, bottom);
    for (uint32_t n = 0; n < l->rows; n++) {
        const float *color = text->lines[l->head + n].color;
        cairo_pattern_add_color_stop_rgb(bar, (double)n / (l->rows - 1), (double)color[0],
                                         (double)color[1], (double)color[2]);
    }
    cairo_rectangle(cairo, x, top, l->swatch, bottom - top);
    cairo_set_source(cairo, bar);
    cairo_fill(cairo);
    cairo_pattern_destroy(bar);
    cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
    cairo_set_line_width(cairo, 1.0);
    for (uint32_t n = 0; n < l->rows; n++) {
        cairo_move_to(cairo, x + l->swatch, floor(top + l->line * n) + 0.5);
        cairo_rel_line_to(cairo, 0.3 * l->letter, 0.0);
    }
    cairo_stroke(cairo);
}

static void draw_panel(cairo_t *cairo, const girih_overlay_text *text, const layout *l) {
    cairo_set_source_rgba(cairo, 0.08, 0.09, 0.11, 0.9);
    cairo_paint(cairo);
    if (text->is_scale) {
        draw_scale(cairo, text, l);
    }
    choose_font(cairo, l->letter);
    cairo_font_extents_t font;
    cairo_font_extents(cairo, &font);
    for (uint32_t n = 0; n < text->line_count; n++) {
        const girih_overlay_line *line = &text->lines[n];
        double x, y;
        find_line(text, l, n, &x, &y);
        if (line->has_swatch && !text->is_scale) {
            draw_swatch(cairo, text, l, n, x, y);
        }
        double middle = y + 0.5 * line_height(text, l, n);
        cairo_set_source_rgb(cairo, 0.96, 0.96, 0.96);
        cairo_move_to(cairo, line->has_swatch ? x + l->text_x : x,
                      round(middle + 0.5 * (font.ascent - font.descent)));
        char copy[MOST_LETTERS];
        cairo_show_text(cairo, readable(line->text, copy));
    }
}

// As large as it is laid out, or as the area lets it.
static double find_scale(const girih_overlay_text *text, const layout *l) {
    double width = (double)text->area.width - 2.0 * l->margin;
    double height = (double)text->area.height - 2.0 * l->margin;
    return fmin(1.0, fmin(width / l->width, height / l->height));
}

static girih_rectangle find_place(const girih_overlay_text *text, const layout *l, double scale) {
    const girih_rectangle *area = &text->area;
    uint32_t margin = (uint32_t)(l->margin * scale);
    girih_rectangle place = {.width = (uint32_t)(l->width * scale),
                             .height = (uint32_t)(l->height * scale)};
    bool is_right =
        text->corner == GIRIH_CORNER_TOP_RIGHT || text->corner == GIRIH_CORNER_BOTTOM_RIGHT;
    bool is_bottom =
        text->corner == GIRIH_CORNER_BOTTOM_LEFT || text->corner == GIRIH_CORNER_BOTTOM_RIGHT;
    place.x = area->x + (is_right ? area->width - margin - place.width : margin);
    place.y = area->y + (is_bottom ? area->height - margin - place.height : margin);
    return place;
}

// NULL: no memory.
static cairo_surface_t *create_surface(int width, int height) {
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
    if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
        cairo_surface_destroy(surface);
        return NULL;
    }
    return surface;
}

static girih_result copy_pixels(cairo_surface_t *surface, girih_panel *panel, girih_error *error) {
    const girih_rectangle *place = &panel->place;
    cairo_surface_flush(surface);
    panel->pixels = malloc((size_t)place->width * place->height * sizeof *panel->pixels);
    if (panel->pixels == NULL || cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
        free(panel->pixels);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    for (uint32_t row = 0; row < place->height; row++) {
        memcpy(panel->pixels + (size_t)row * place->width,
               cairo_image_surface_get_data(surface) +
                   (size_t)row * (size_t)cairo_image_surface_get_stride(surface),
               (size_t)place->width * sizeof *panel->pixels);
    }
    return GIRIH_OK;
}

girih_result girih_overlay_add(girih_overlay *overlay, const girih_overlay_text *text, bool *fits,
                               girih_error *error) {
    // Letters smaller than this share of their size are not read.
    const double least_scale = 0.5;
    cairo_surface_t *measure = create_surface(1, 1);
    if (measure == NULL || overlay->panel_count == GIRIH_OVERLAY_PANELS) {
        cairo_surface_destroy(measure);
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no room for another panel");
    }
    cairo_t *cairo = cairo_create(measure);
    layout l = lay_out(cairo, text);
    cairo_destroy(cairo);
    cairo_surface_destroy(measure);
    double scale = find_scale(text, &l);
    if (fits != NULL) {
        *fits = scale >= least_scale;
    }
    if (!(scale >= least_scale)) {
        return GIRIH_OK;
    }
    girih_panel *panel = &overlay->panels[overlay->panel_count];
    panel->place = find_place(text, &l, scale);
    cairo_surface_t *surface = create_surface((int)panel->place.width, (int)panel->place.height);
    if (surface == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    cairo = cairo_create(surface);
    cairo_scale(cairo, scale, scale);
    draw_panel(cairo, text, &l);
    bool is_drawn = cairo_status(cairo) == CAIRO_STATUS_SUCCESS;
    cairo_destroy(cairo);
    girih_result result = is_drawn ? copy_pixels(surface, panel, error)
                                   : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    cairo_surface_destroy(surface);
    overlay->panel_count += result == GIRIH_OK;
    return result;
}

uint32_t girih_overlay_patterns(const girih_rectangle *area) {
    layout l = begin_layout(area);
    l.head = 3;
    return column_room(area, &l, l.pattern);
}

void girih_overlay_clear(girih_overlay *overlay) {
    for (uint32_t n = 0; n < overlay->panel_count; n++) {
        free(overlay->panels[n].pixels);
    }
    *overlay = (girih_overlay){0};
}
