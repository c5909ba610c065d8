// The vertex shaders that draw girih's output: instanced from patches, else from buffers.
#ifndef GIRIH_BENCH_VERTEX_SHADER_H
#define GIRIH_BENCH_VERTEX_SHADER_H

#include "bench.h"

// Sets the method's vertex_shader and vertex_shader_bytes.
void bench_set_vertex_shader(bench_method *method, girih_mode mode);

#endif
