// Stages 1 to 4 of a small plan in one dispatch of one workgroup: to begin and to await each stage would take longer
// than its work. Welded plans, whose vertices are numbered between the stages, keep the dispatches apart.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "shared.h"
#define GIRIH_SEVERAL_STAGES
#include "levels.glsl"
#include "select.glsl"
#include "group.glsl"
#include "dispatch.glsl"

// What all lanes have written is there for all to read.
void end_step() {
    memoryBarrierBuffer();
    barrier();
}

// One pass of the sort: its blocks one after another.
void sort_digit() {
    for (uint block = 0u; block < girih_frame.sort_block_count; ++block) {
        count_block(block);
    }
    end_step();
    for (uint digit = gl_LocalInvocationID.x; digit < pass.bins; digit += girih_lanes) {
        sum_blocks(digit);
    }
    end_step();
    sum_digits();
    end_step();
    for (uint block = 0u; block < girih_frame.sort_block_count; ++block) {
        place_block(block);
        barrier(); // the next block begins with what this one still reads
    }
    end_step();
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    for (uint edge = lane; edge < girih_frame.edge_count; edge += girih_lanes) {
        write_level(edge);
    }
    end_step();
    for (uint triangle = lane; triangle < girih_frame.triangle_count; triangle += girih_lanes) {
        write_key(triangle);
    }
    end_step();
    uint last = girih_push.first_pass - 1u;
    for (uint n = 0u; n <= last; ++n) {
        // The last pass ends in ITEMS.
        pass = Pass(n * girih_push.shift, girih_push.bins, n == 0u, ((last - n) & 1u) != 0u);
        sort_digit();
    }
    uint items = last > 0u ? GIRIH_AT_STATUS(GIRIH_STATUS_ITEMS) : 0u;
    for (uint n = lane; n < items; n += girih_lanes) {
        write_bounds_at(n, items);
    }
    end_step();
    dispatch_groups();
    end_step();
    // Those of the instanced mode are written with their groups.
    bool lists = girih_frame.output_mode != GIRIH_OUTPUT_INSTANCED && girih_frame.draws_per_material != 0u;
    uint materials = lists ? girih_frame.material_count : 0u;
    for (uint material = 0u; material < materials; ++material) {
        uint count = draw_count(material);
        for (uint number = lane; number < count; number += girih_lanes) {
            dispatch_draw(material, number);
        }
    }
}
