// Stage 3: count_block (GIRIH_KERNEL 0), sum_blocks (1), sum_digits (2), place_block (3) or find_bounds (4).
#version 450
#extension GL_GOOGLE_include_directive : require

#ifdef GIRIH_SERIAL
#define GIRIH_LOCAL_SIZE GIRIH_SERIAL_WORKGROUP
#else
#define GIRIH_LOCAL_SIZE GIRIH_LARGE_WORKGROUP
#endif
#include "shared.h"
#include "group.glsl"

void begin_pass() {
    pass = Pass(girih_push.shift, girih_push.bins, girih_push.first_pass != 0u, girih_push.to_spare != 0u);
    find_parts();
}

#if GIRIH_KERNEL == 0 || GIRIH_KERNEL == 3

void main() {
    begin_pass();
#ifdef GIRIH_SERIAL
    uint block = girih_invocation();
#else
    uint block = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
#endif
    if (block < girih_frame.sort_block_count) {
#if GIRIH_KERNEL == 0
        count_block(block);
#else
        place_block(block);
#endif
    }
}

#elif GIRIH_KERNEL == 1 && defined(GIRIH_SERIAL)

void main() {
    begin_pass();
    uint digit = girih_invocation();
    if (digit < pass.bins) {
        sum_blocks(digit);
    }
}

#elif GIRIH_KERNEL == 1

void main() {
    begin_pass();
    sum_blocks_together(gl_WorkGroupID.x);
}

#elif GIRIH_KERNEL == 2

void main() {
    begin_pass();
    sum_digits();
}

#else

void main() {
    begin_pass();
    uint group = girih_invocation();
    if (group < girih_frame.group_count) {
        find_bounds(group);
    }
}

#endif
