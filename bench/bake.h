// Case `bake`: refinement into buffers alone, on the device and by its rivals on the CPU.
#ifndef BENCH_BAKE_H
#define BENCH_BAKE_H

#include <jansson.h>

#include "device.h"

// Appends one object for each sphere to `cases`. Every method's `bake` has median_ms, min_ms and
// max_ms of wall time, output_triangles, ns_per_triangle and triangles_per_second (of the median),
// and `ratio` with its interval: the method's wall time for an output triangle to girih's. cpu_ms
// and cpu_ratio are the same of CPU time, all threads together: what a method costs where other
// programs take its cores.
girih_result bench_bake(girih_device *device, uint32_t pairs, json_t *cases, girih_error *error);

#endif
