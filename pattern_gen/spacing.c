#include "spacing.h"

#include <math.h>

#include "girih/catalogue.h"

#define LN2 0.69314718055994530942

double girih_logarithm(double x) {
    int exponent = 0;
    double fraction = frexp(x, &exponent); // in [1/2, 1)
    if (fraction < 0.70710678118654752440) {
        fraction *= 2;
        exponent--;
    }
    // 2 artanh((f - 1) / (f + 1)), of at most 0.172.
    const double z = (fraction - 1) / (fraction + 1);
    double power = z;
    double sum = 0;
    for (int n = 1; n < 22; n += 2) {
        sum += power / n;
        power *= z * z;
    }
    return exponent * LN2 + 2 * sum;
}

static double exponential(double x) {
    const double exponent = floor(x / LN2 + 0.5);
    const double rest = x - exponent * LN2;
    double term = 1;
    double sum = 1;
    for (int n = 1; n < 16; n++) {
        term *= rest / n;
        sum += term;
    }
    return ldexp(sum, (int)exponent);
}

girih_spacing_field girih_spacing_create(const uint32_t segments[3]) {
    girih_spacing_field field;
    for (int edge = 0; edge < 3; edge++) {
        field.logarithms[edge] = girih_logarithm(segments[edge]);
    }
    return field;
}

double girih_spacing_at(const girih_spacing_field *field, const double weights[3]) {
    // The inverse distances from the edges, 1 / w, 1 / u, 1 / v, each times u v w: nothing is divided by zero on a
    // border.
    const double near[3] = {weights[0] * weights[1], weights[1] * weights[2], weights[2] * weights[0]};
    double sum = 0;
    double total = 0;
    for (int edge = 0; edge < 3; edge++) {
        sum += near[edge] * field->logarithms[edge];
        total += near[edge];
    }
    return exponential(-sum / total);
}

double girih_spacing_ratio(const girih_spacing_field *field, const double from[3], const double to[3]) {
    double middle[3];
    double squares = 0;
    for (int n = 0; n < 3; n++) {
        squares += (to[n] - from[n]) * (to[n] - from[n]);
        middle[n] = from[n] + to[n];
    }
    // In an equilateral triangle a length's square is half the sum of the squared differences of weights.
    return sqrt(squares / 2) / (GIRIH_BARYCENTRIC_ONE * girih_spacing_at(field, middle));
}

double girih_corner_flatness(uint32_t a, uint32_t b) {
    // Of 60, 30, 20, ... degrees. More triangles than these gain nothing up to 16,384 segments.
    static const double cosines[] = {0.5,
                                     0.86602540378443864676,
                                     0.93969262078590838405,
                                     0.96592582628906828675,
                                     0.97814760073380563793,
                                     0.98480775301220805937,
                                     0.98883082622512854506,
                                     0.99144486137381041115,
                                     0.99323835774194300000,
                                     0.99452189536827328986,
                                     0.99547192257308458885,
                                     0.99619469809174554520,
                                     0.99675730813421004051,
                                     0.99720379718118012935,
                                     0.99756405025982419765};
    static const double sines[] = {0.86602540378443864676, 0.5,
                                   0.34202014332566873304, 0.25881904510252076235,
                                   0.20791169081775933710, 0.17364817766693034885,
                                   0.14904226617617444693, 0.13052619222005159155,
                                   0.11609291412523022967, 0.10452846326765347085, 0.09505604330418265802, 0.08715574274765816587, 0.08046656871672587530, 0.07473009358642425382, 0.06975647374412530244};
    const double root3 = 1.7320508075688772935;
    const double ratio = a > b ? girih_logarithm((double)a / b) : girih_logarithm((double)b / a);
    double best = INFINITY;
    for (int n = 0; n < (int)(sizeof cosines / sizeof *cosines); n++) {
        const double factor = exponential(ratio / (n + 1));
        const double across = root3 * (factor - cosines[n]) / sines[n];
        const double corner = root3 * cosines[n] / sines[n];
        const double flatness = across > corner ? across : corner;
        best = flatness < best ? flatness : best;
    }
    return best;
}

double girih_pattern_bound(const uint32_t segments[3]) {
    double worst = 0;
    for (int corner = 0; corner < 3; corner++) {
        const double flatness = girih_corner_flatness(segments[corner], segments[(corner + 2) % 3]);
        worst = flatness > worst ? flatness : worst;
    }
    return worst;
}
