// The case `scaling` of girih-bench.
#ifndef GIRIH_BENCH_SCALING_H
#define GIRIH_BENCH_SCALING_H

#include <jansson.h>

#include "device.h"

// Appends an object for each input size and fineness that fits: its stages' and its whole time,
// medians of at most `runs` frames, whose levels change, each for a triangle of the input and of
// the output; and the memory it takes. Times by stage are 0 where the queue has no timestamps.
girih_result bench_scaling(girih_device *device, uint32_t runs, json_t *cases, girih_error *error);

#endif
