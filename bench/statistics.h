// Medians, and how far to trust them.
#ifndef GIRIH_BENCH_STATISTICS_H
#define GIRIH_BENCH_STATISTICS_H

#include <stdint.h>

// Sorts values and returns their median; count > 0.
double statistics_median(double *values, uint32_t count);

// The bootstrap 95 % interval of the median of values, from 2,000 resamples of a fixed seed; count
// > 0 and at most STATISTICS_MOST.
#define STATISTICS_MOST 4096u
void statistics_interval(const double *values, uint32_t count, double *low, double *high);

#endif
