// What one frame of a plan wrote, as a host reads it through the public interface: outputs byte for
// byte and statistics. What cannot be done prints why and exits, as gpu.h's.
#ifndef GIRIH_TEST_RESULTS_H
#define GIRIH_TEST_RESULTS_H

#include "gpu.h"

// Positions, attributes, indices, closed indices, sources.
#define RESULTS_OUTPUTS 5

// Zero-initialised before the first use, and used again for later frames.
typedef struct results {
    gpu_buffer copy; // mapped: the plan's output buffers, one after another
    VkDeviceSize offset[RESULTS_OUTPUTS];
    VkDeviceSize bytes[RESULTS_OUTPUTS]; // that the frame wrote; 0: the plan has
                                         // no such output
    girih_statistics statistics;
} results;

// Records the copy, to be executed after a recorded girih_cmd_refine.
void results_record(gpu *host, const girih_plan *plan, VkCommandBuffer commands, results *read);
// Once that has been executed: what it read.
void results_finish(const girih_plan *plan, results *read);
// A whole frame: recorded, submitted and read.
void results_refine(gpu *host, girih_plan *plan, const girih_frame *frame, results *read);
void results_free(gpu *host, results *read);

// The name of the first output or figure in which two frames differ; NULL: they are equal.
const char *results_difference(const results *a, const results *b);
// Bytes of all outputs together.
uint64_t results_bytes(const results *read);

#endif
