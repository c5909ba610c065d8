// Sheets are drawn by cairo, SVG and PNG alike. All lengths are pixels.
#include "sheet.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <cairo-svg.h>
#include <cairo.h>

#include "error.h"
#include "quality.h"
#include "report.h"

// Colours stand for steps of two degrees. A triangle without area has none.
enum { COLOUR_COUNT = 30, NO_COLOUR = 255 };

#define LARGEST_CELL 480.0
#define SMALLEST_CELL 60.0
#define USUAL_WIDTH 3600.0
#define USUAL_CELL 160.0
// Of a picture, so that it can be in memory, and of one side, which cairo limits.
#define MOST_PIXELS 100e6
#define LONGEST_SIDE 30000.0
// Some hundred bytes each, and cairo keeps them in memory.
#define MOST_SVG_TRIANGLES 4000000u
// The header's texts and the legend need so much beside each other.
#define SMALLEST_WIDTH 1100.0

// A cell: its height in widths, its triangle, and its lines of text below, in widths too.
static const double cell_height = 1.03;
static const double triangle_side = 0.86;
static const double triangle_base = 0.82; // of the triangle, from the top of the cell
static const double first_line = 0.905;
static const double second_line = 0.968;

typedef struct sheet_colour {
    double red;
    double green;
    double blue;
} sheet_colour;

static const sheet_colour ink = {0.09, 0.11, 0.20};
static const sheet_colour pale_ink = {0.38, 0.41, 0.49};

typedef struct sheet_layout {
    uint32_t columns;
    uint32_t rows;
    double cell;
    double margin;
    double header;
    double width;
    double height;
    double text; // size of the header's texts
} sheet_layout;

typedef struct sheet_text {
    double x;
    double y;
    double size;
    double align; // 0 begins at x, 1 ends there
    double room;  // smaller letters where it is wider
    bool bold;
    sheet_colour colour;
} sheet_text;

static double to_srgb(double linear) {
    const double light = fmin(fmax(linear, 0), 1);
    return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

// From OKLab (Ottosson 2020), in which equal distances look equal.
static sheet_colour from_oklab(double lightness, double a, double b) {
    const double l = pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double m = pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double s = pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    return (sheet_colour){
        to_srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        to_srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        to_srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s),
    };
}

// Lightness grows evenly with the angle, from indigo over teal to cream, so that the order shows to
// every eye. No colour is so strong that sRGB would lack it.
static sheet_colour angle_colour(uint32_t step) {
    const double at = step / (COLOUR_COUNT - 1.0);
    const double hue = (285 - 185 * at) * 0.017453292519943295;
    const double chroma = 0.045 + 0.045 * (1 - at) + 0.08 * at * (1 - at);
    return from_oklab(0.28 + 0.69 * at, chroma * cos(hue), chroma * sin(hue));
}

static uint8_t angle_step(double angle) {
    const uint8_t step = (uint8_t)(angle / 60 * COLOUR_COUNT + 1e-9);
    return step < COLOUR_COUNT ? step : COLOUR_COUNT - 1;
}

static void set_colour(cairo_t *cairo, sheet_colour colour, double opacity) {
    cairo_set_source_rgba(cairo, colour.red, colour.green, colour.blue, opacity);
}

static void draw_text(cairo_t *cairo, const sheet_text *text, const char *letters) {
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           text->bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, text->size);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, letters, &extents);
    if (extents.x_advance > text->room) {
        cairo_set_font_size(cairo, text->size * text->room / extents.x_advance);
        cairo_text_extents(cairo, letters, &extents);
    }
    set_colour(cairo, text->colour, 1);
    cairo_move_to(cairo, text->x - text->align * extents.x_advance, text->y);
    cairo_show_text(cairo, letters);
    cairo_new_path(cairo);
}

// A number with commas between its thousands.
static const char *grouped(uint64_t number, char text[32]) {
    char digits[24];
    const int count = snprintf(digits, sizeof digits, "%" PRIu64, number);
    char *to = text;
    for (int n = 0; n < count; n++) {
        if (n > 0 && (count - n) % 3 == 0) {
            *to++ = ',';
        }
        *to++ = digits[n];
    }
    *to = 0;
    return text;
}

// The triangle of a cell, P1 and P2 below, so that the edge of most segments is its base.
typedef struct cell_frame {
    double left;
    double base;
    double side;
} cell_frame;

static void vertex_point(const cell_frame *frame, uint32_t vertex, double *x, double *y) {
    const double v = (vertex >> 16) / (double)GIRIH_BARYCENTRIC_ONE;
    const double w = 1 - v - (vertex & 0xffff) / (double)GIRIH_BARYCENTRIC_ONE;
    *x = frame->left + frame->side * (v + w / 2);
    *y = frame->base - frame->side * w * 0.86602540378443864676;
}

static void add_corner(cairo_t *cairo, const cell_frame *frame, uint32_t vertex, bool first) {
    double x = 0;
    double y = 0;
    vertex_point(frame, vertex, &x, &y);
    if (first) {
        cairo_move_to(cairo, x, y);
    } else {
        cairo_line_to(cairo, x, y);
    }
}

static void add_triangle(cairo_t *cairo, const cell_frame *frame, const uint32_t vertices[3]) {
    for (int n = 0; n < 3; n++) {
        add_corner(cairo, frame, vertices[n], n == 0);
    }
    cairo_close_path(cairo);
}

static void corners_of(const girih_pattern *pattern, uint32_t triangle, uint32_t vertices[3]) {
    for (size_t corner = 0; corner < 3; corner++) {
        vertices[corner] = pattern->vertices[pattern->indices[(size_t)triangle * 3 + corner]];
    }
}

// Triangles of one colour are one path. The whole lies below them in the colour of most, so that no
// background shows through where two colours meet.
static void fill_triangles(cairo_t *cairo, const cell_frame *frame, const girih_pattern *pattern,
                           const uint8_t *steps) {
    static const uint32_t whole[3] = {GIRIH_BARYCENTRIC_ONE, GIRIH_BARYCENTRIC_ONE << 16, 0};
    uint32_t counts[COLOUR_COUNT] = {0};
    uint32_t most = 0;
    for (uint32_t n = 0; n < pattern->triangle_count; n++) {
        if (steps[n] != NO_COLOUR) {
            counts[steps[n]]++;
            most = counts[steps[n]] > counts[most] ? steps[n] : most;
        }
    }
    add_triangle(cairo, frame, whole);
    set_colour(cairo, angle_colour(most), 1);
    cairo_fill(cairo);
    for (uint32_t step = 0; step < COLOUR_COUNT; step++) {
        if (counts[step] == 0 || step == most) {
            continue;
        }
        for (uint32_t n = 0; n < pattern->triangle_count; n++) {
            if (steps[n] == step) {
                uint32_t vertices[3];
                corners_of(pattern, n, vertices);
                add_triangle(cairo, frame, vertices);
            }
        }
        set_colour(cairo, angle_colour(step), 1);
        cairo_fill(cairo);
    }
}

static bool on_one_border(uint32_t a, uint32_t b) {
    const uint32_t one = GIRIH_BARYCENTRIC_ONE;
    const bool u = (a & 0xffff) + (b & 0xffff) == 0;
    const bool v = (a >> 16) + (b >> 16) == 0;
    return u || v || ((a & 0xffff) + (a >> 16) == one && (b & 0xffff) + (b >> 16) == one);
}

static void draw_lines(cairo_t *cairo, const cell_frame *frame, const girih_pattern *pattern) {
    static const uint32_t whole[3] = {GIRIH_BARYCENTRIC_ONE, GIRIH_BARYCENTRIC_ONE << 16, 0};
    // Thin enough to leave the colours of the smallest triangles.
    const double width = fmin(frame->side * 0.004, frame->side / pattern->segments[0] * 0.06);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    for (size_t n = 0; n < (size_t)pattern->triangle_count * 3; n++) {
        const uint32_t from = pattern->indices[n];
        const uint32_t to = pattern->indices[n % 3 == 2 ? n - 2 : n + 1];
        // Each inner edge once, of the two triangles that have it.
        if (from < to && !on_one_border(pattern->vertices[from], pattern->vertices[to])) {
            add_corner(cairo, frame, pattern->vertices[from], true);
            add_corner(cairo, frame, pattern->vertices[to], false);
        }
    }
    set_colour(cairo, ink, 0.8);
    cairo_set_line_width(cairo, width);
    cairo_stroke(cairo);
    add_triangle(cairo, frame, whole);
    set_colour(cairo, ink, 1);
    cairo_set_line_width(cairo, frame->side * 0.006);
    cairo_stroke(cairo);
}

// A dot for every vertex on the border: where the segments begin.
static void draw_border_vertices(cairo_t *cairo, const cell_frame *frame,
                                 const girih_pattern *pattern) {
    const double radius = fmin(frame->side * 0.01, frame->side / pattern->segments[0] * 0.12);
    for (uint32_t n = 0; n < girih_border_count(pattern->segments); n++) {
        double x = 0;
        double y = 0;
        vertex_point(frame, pattern->vertices[n], &x, &y);
        cairo_new_sub_path(cairo);
        cairo_arc(cairo, x, y, radius, 0, 6.283185307179586);
    }
    set_colour(cairo, ink, 1);
    cairo_fill(cairo);
}

static void draw_caption(cairo_t *cairo, const girih_catalogue *catalogue,
                         const girih_base_pattern *pattern, double angle, double x, double y,
                         double cell) {
    uint32_t levels[3];
    girih_report_levels(catalogue, pattern, levels);
    char text[128];
    char numbers[2][32];
    const double left = x + cell * (1 - triangle_side) / 2;
    const double right = x + cell * (1 + triangle_side) / 2;
    sheet_text line = {.x = left,
                       .y = y + cell * first_line,
                       .size = fmin(cell * 0.072, 25),
                       .room = cell * 0.5,
                       .bold = true,
                       .colour = ink};
    snprintf(text, sizeof text, "%" PRIu32 ", %" PRIu32 ", %" PRIu32, levels[0], levels[1],
             levels[2]);
    draw_text(cairo, &line, text);

    line.x = right;
    line.align = 1;
    line.room = cell * 0.3;
    snprintf(text, sizeof text, angle < 0.1 ? "%.3f°" : "%.1f°", angle);
    draw_text(cairo, &line, text);

    line.x = left;
    line.y = y + cell * second_line;
    line.size = fmin(cell * 0.056, 17);
    line.align = 0;
    line.room = cell * triangle_side;
    line.bold = false;
    line.colour = pale_ink;
    snprintf(text, sizeof text, "%s triangle%s, %s vertices",
             grouped(pattern->triangle_count, numbers[0]), pattern->triangle_count == 1 ? "" : "s",
             grouped(pattern->vertex_count, numbers[1]));
    draw_text(cairo, &line, text);
}

static girih_result draw_pattern(cairo_t *cairo, const girih_catalogue *catalogue, uint32_t rank,
                                 double x, double y, double cell, girih_error *error) {
    girih_pattern pattern;
    girih_result result = girih_pattern_read(catalogue, rank, &pattern, error);
    uint8_t *steps = result == GIRIH_OK ? malloc(pattern.triangle_count) : NULL;
    if (steps) {
        const cell_frame frame = {x + cell * (1 - triangle_side) / 2, y + cell * triangle_base,
                                  cell * triangle_side};
        double smallest = 60;
        for (uint32_t n = 0; n < pattern.triangle_count; n++) {
            uint32_t vertices[3];
            corners_of(&pattern, n, vertices);
            const double angle = girih_quality_angle(GIRIH_SHAPE_EQUILATERAL, 0, vertices);
            smallest = angle > 0 ? fmin(smallest, angle) : smallest;
            steps[n] = angle > 0 ? angle_step(angle) : NO_COLOUR;
        }
        fill_triangles(cairo, &frame, &pattern, steps);
        draw_lines(cairo, &frame, &pattern);
        draw_border_vertices(cairo, &frame, &pattern);
        draw_caption(cairo, catalogue, girih_catalogue_pattern(catalogue, rank), smallest, x, y,
                     cell);
    } else if (result == GIRIH_OK) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for a pattern's colours");
    }
    free(steps);
    girih_pattern_free(&pattern);
    return result;
}

// The colours and the angles for which they stand, at the right.
static void draw_legend(cairo_t *cairo, const sheet_layout *layout) {
    const double size = layout->text;
    const double width = size * 22;
    const double left = layout->width - layout->margin - width;
    const double top = layout->margin + size * 1.6;
    const double height = size * 1.3;
    const double step = width / COLOUR_COUNT;
    sheet_text text = {
        .x = left, .y = top - size * 0.6, .size = size, .room = width, .colour = pale_ink};
    draw_text(cairo, &text, "smallest angle of a triangle");
    for (uint32_t n = 0; n < COLOUR_COUNT; n++) {
        // Each reaches below the next, so that no background shows between them.
        cairo_rectangle(cairo, left + n * step, top, width - n * step, height);
        set_colour(cairo, angle_colour(n), 1);
        cairo_fill(cairo);
    }
    cairo_rectangle(cairo, left, top, width, height);
    set_colour(cairo, ink, 1);
    cairo_set_line_width(cairo, size * 0.06);
    cairo_stroke(cairo);
    for (int degrees = 0; degrees <= 60; degrees += 10) {
        char label[16];
        snprintf(label, sizeof label, "%d°", degrees);
        text.x = left + width * degrees / 60;
        text.y = top + height + size * 1.3;
        text.align = degrees == 0 ? 0 : degrees == 60 ? 1 : 0.5;
        draw_text(cairo, &text, label);
    }
}

static void draw_header(cairo_t *cairo, const girih_sheet *sheet, const girih_catalogue *catalogue,
                        const girih_quality_totals *totals, const sheet_layout *layout) {
    const double size = layout->text;
    char text[256];
    char numbers[3][32];
    sheet_text line = {.x = layout->margin,
                       .y = layout->margin + size * 1.8,
                       .size = size * 2.2,
                       .bold = true,
                       .room = layout->width - 2 * layout->margin - size * 24,
                       .colour = ink};
    const char *first = catalogue->spacing == GIRIH_SPACING_DYADIC ? "0" : "1";
    snprintf(text, sizeof text, "%s, %s %s..%" PRIu32, catalogue->family,
             girih_report_spacing(catalogue), first, catalogue->max);
    draw_text(cairo, &line, text);

    line.bold = false;
    line.size = size;
    line.y += size * 1.9;
    line.colour = pale_ink;
    int length = 0;
    if (sheet->count != catalogue->pattern_count) {
        length = snprintf(text, sizeof text, "%" PRIu32 " of ", sheet->count);
    }
    snprintf(
        text + length, sizeof text - (size_t)length, "%s base patterns, %s vertices, %s triangles",
        grouped(catalogue->pattern_count, numbers[0]), grouped(catalogue->vertex_count, numbers[1]),
        grouped(catalogue->triangle_count, numbers[2]));
    draw_text(cairo, &line, text);

    uint32_t worst[3];
    girih_report_levels(catalogue, girih_catalogue_pattern(catalogue, totals->worst_rank), worst);
    line.y += size * 1.5;
    snprintf(text, sizeof text,
             "smallest angles: %.2f° in the mean, %.2f° at worst (%" PRIu32 ", %" PRIu32
             ", %" PRIu32 "); their bound: %.2f° in the mean",
             totals->mean_angles[GIRIH_SHAPE_EQUILATERAL],
             totals->worst_angles[GIRIH_SHAPE_EQUILATERAL], worst[0], worst[1], worst[2],
             totals->mean_bound);
    draw_text(cairo, &line, text);
    draw_legend(cairo, layout);
}

static girih_result place_cells(const girih_sheet *sheet, sheet_layout *layout,
                                girih_error *error) {
    const double count = sheet->count;
    const uint32_t usual = (uint32_t)ceil(sqrt(count * 1.25));
    layout->columns = sheet->columns > 0 ? sheet->columns : usual;
    layout->columns = layout->columns < sheet->count ? layout->columns : sheet->count;
    layout->rows = (sheet->count + layout->columns - 1) / layout->columns;
    const double places = (double)layout->rows * layout->columns;
    layout->cell = fmin(fmax(USUAL_WIDTH / layout->columns, USUAL_CELL), LARGEST_CELL);
    layout->cell = fmin(layout->cell, sqrt(MOST_PIXELS / (places * cell_height)));
    layout->cell =
        fmin(layout->cell, LONGEST_SIDE / fmax(layout->rows * cell_height, layout->columns));
    if (layout->cell < SMALLEST_CELL) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "%" PRIu32 " patterns in %" PRIu32
                          " columns are too many to be told apart; choose some with "
                          "--patterns or other --columns",
                          sheet->count, layout->columns);
    }
    layout->width = fmax(layout->columns * layout->cell, SMALLEST_WIDTH);
    layout->text = fmin(fmax(layout->width * 0.0095, 16), 40);
    layout->margin = 2 * layout->text;
    layout->width = ceil(layout->width + 2 * layout->margin);
    layout->header = layout->margin + layout->text * 7;
    layout->height =
        ceil(layout->header + layout->rows * cell_height * layout->cell + layout->margin);
    return GIRIH_OK;
}

static girih_result draw_sheet(cairo_t *cairo, const girih_sheet *sheet,
                               const girih_catalogue *catalogue, const girih_quality_totals *totals,
                               const sheet_layout *layout, girih_progress *progress,
                               girih_error *error) {
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    draw_header(cairo, sheet, catalogue, totals, layout);
    // Few patterns stand in the middle of the header's width.
    const double left = (layout->width - layout->columns * layout->cell) / 2;
    girih_result result = GIRIH_OK;
    for (uint32_t n = 0; n < sheet->count && result == GIRIH_OK; n++) {
        const double x = left + n % layout->columns * layout->cell;
        const double y = layout->header + n / layout->columns * layout->cell * cell_height;
        result = draw_pattern(cairo, catalogue, sheet->ranks[n], x, y, layout->cell, error);
        if (progress) {
            progress(n + 1, sheet->count);
        }
    }
    return result;
}

// Write errors are found in the stream.
static cairo_status_t write_bytes(void *stream, const unsigned char *bytes, unsigned count) {
    return fwrite(bytes, 1, count, stream) == count ? CAIRO_STATUS_SUCCESS
                                                    : CAIRO_STATUS_WRITE_ERROR;
}

static cairo_surface_t *create_surface(const sheet_layout *layout, girih_sheet_format format,
                                       FILE *stream) {
    if (format == GIRIH_SHEET_PNG) {
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)layout->width,
                                          (int)layout->height);
    }
    cairo_surface_t *surface =
        cairo_svg_surface_create_for_stream(write_bytes, stream, layout->width, layout->height);
    cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
    return surface;
}

static girih_result measure(const girih_catalogue *catalogue, girih_quality_totals *totals,
                            girih_error *error) {
    girih_quality *qualities = calloc(catalogue->pattern_count, sizeof *qualities);
    girih_result result =
        qualities ? girih_quality_measure_catalogue(catalogue, qualities, NULL, error)
                  : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory to measure patterns");
    if (result == GIRIH_OK) {
        *totals = girih_quality_total(catalogue, qualities);
    }
    free(qualities);
    return result;
}

static girih_result check_triangles(const girih_sheet *sheet, const girih_catalogue *catalogue,
                                    girih_error *error) {
    uint64_t triangles = 0;
    for (uint32_t n = 0; n < sheet->count; n++) {
        triangles += girih_catalogue_pattern(catalogue, sheet->ranks[n])->triangle_count;
    }
    if (triangles > MOST_SVG_TRIANGLES) {
        return girih_fail(error, GIRIH_ERROR_TOO_LARGE,
                          "%" PRIu64 " triangles are too many for an SVG, which has room for %u; "
                          "choose some with --patterns, or write a .png",
                          triangles, MOST_SVG_TRIANGLES);
    }
    return GIRIH_OK;
}

girih_result girih_sheet_draw(const girih_sheet *sheet, const girih_catalogue *catalogue,
                              girih_sheet_format format, girih_progress *progress, FILE *stream,
                              girih_error *error) {
    sheet_layout layout = {.columns = 0};
    girih_quality_totals totals;
    girih_result result = place_cells(sheet, &layout, error);
    if (result == GIRIH_OK && format == GIRIH_SHEET_SVG) {
        result = check_triangles(sheet, catalogue, error);
    }
    if (result == GIRIH_OK) {
        result = measure(catalogue, &totals, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    cairo_surface_t *surface = create_surface(&layout, format, stream);
    cairo_t *cairo = cairo_create(surface);
    result = draw_sheet(cairo, sheet, catalogue, &totals, &layout, progress, error);
    cairo_status_t status = cairo_status(cairo);
    cairo_destroy(cairo);
    if (status == CAIRO_STATUS_SUCCESS && format == GIRIH_SHEET_PNG) {
        status = cairo_surface_write_to_png_stream(surface, write_bytes, stream);
    }
    cairo_surface_finish(surface);
    status = status == CAIRO_STATUS_SUCCESS ? cairo_surface_status(surface) : status;
    cairo_surface_destroy(surface);
    if (result == GIRIH_OK && status != CAIRO_STATUS_SUCCESS) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot draw the sheet: %s",
                            cairo_status_to_string(status));
    }
    return result;
}
