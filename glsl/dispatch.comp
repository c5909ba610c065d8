// Stage 4: the groups (GIRIH_KERNEL 0), and the draws of the baked and welded modes (1).
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#if GIRIH_KERNEL == 1
#define GIRIH_LOCAL_SIZE GIRIH_WORKGROUP
#elif defined(GIRIH_SERIAL)
#define GIRIH_LOCAL_SIZE GIRIH_SERIAL_WORKGROUP
#else
#define GIRIH_LOCAL_SIZE GIRIH_LARGE_WORKGROUP
#endif
#include "dispatch.glsl"

void main() {
#if GIRIH_KERNEL == 0
    dispatch_groups();
#else
    uint number = girih_invocation();
    uint material = girih_quotient(number, girih_frame.draws_per_material);
    if (material < girih_frame.material_count && number < draw_count(material)) {
        dispatch_draw(material, number);
    }
#endif
}
