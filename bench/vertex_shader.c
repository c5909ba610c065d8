#include "vertex_shader.h"

// The build's headers define their arrays, so one file alone includes them.
#include "bench_baked.spv.h"
#include "bench_instanced.spv.h"

void bench_set_vertex_shader(bench_method *method, girih_mode mode) {
    const bool instanced = mode == GIRIH_MODE_INSTANCED;
    method->vertex_shader = instanced ? girih_spirv_bench_instanced : girih_spirv_bench_baked;
    method->vertex_shader_bytes =
        instanced ? sizeof girih_spirv_bench_instanced : sizeof girih_spirv_bench_baked;
}
