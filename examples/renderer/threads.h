#ifndef THREADS_H
#define THREADS_H

#include "renderer.h"

// Four threads and two girih contexts on the renderer's device and queue; fails where any picture
// is not, byte for byte, the one that a thread alone got.
int run_threads(renderer *r);

#endif
