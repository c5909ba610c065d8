#include "statistics.h"

#include <stdlib.h>

#define RESAMPLES 2000

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

double statistics_median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, compare);
    return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

void statistics_interval(const double *values, uint32_t count, double *low, double *high) {
    static const uint64_t seed = 0x9e3779b97f4a7c15u;
    double medians[RESAMPLES];
    double sample[STATISTICS_MOST];
    uint64_t state = seed;
    for (uint32_t n = 0; n < RESAMPLES; ++n) {
        for (uint32_t k = 0; k < count; ++k) {
            state ^= state >> 12;
            state ^= state << 25;
            state ^= state >> 27;
            sample[k] = values[(state * 0x2545f4914f6cdd1du >> 32) % count];
        }
        medians[n] = statistics_median(sample, count);
    }
    statistics_median(medians, RESAMPLES);
    *low = medians[RESAMPLES / 40];
    *high = medians[RESAMPLES - 1 - RESAMPLES / 40];
}
