// Stage 1: one level per unique edge of every instance, from the edge alone.
#ifndef GIRIH_LEVELS_GLSL
#define GIRIH_LEVELS_GLSL

#include "scene.glsl"
#include "level_rules.glsl"

// A small plan's shader asks the frame: its edges are few, and a pipeline for each rule takes longer to make than
// they will ever save.
uint level_rule() {
#ifdef GIRIH_SEVERAL_STAGES
    return girih_frame.rule;
#else
    return girih_variant >> GIRIH_VARIANT_RULE_SHIFT & 7u;
#endif
}

void write_level(uint edge) {
    uint rule = level_rule();
    if (rule == GIRIH_LEVELS_UNIFORM) {
        GIRIH_AT_LEVELS(edge) = girih_frame.uniform_level;
        if (edge == 0u && girih_frame.uniform_clamped != 0u) {
            GIRIH_AT_STATUS(GIRIH_STATUS_CLAMPED) = girih_frame.edge_count;
        }
        return;
    }
    uint instance = girih_find_instance(edge, GIRIH_INSTANCE_FIRST_EDGE, girih_frame.edge_blocks);
    uint scene_edge = edge - girih_instance(instance, GIRIH_INSTANCE_EDGE_DELTA);
    uvec2 points = GIRIH_AT_EDGE_POINTS(scene_edge);
    vec3 p = girih_point_position(points.x);
    vec3 q = girih_point_position(points.y);
    if (rule == GIRIH_LEVELS_LENGTH || rule == GIRIH_LEVELS_HORIZONTAL) {
        GirihTransform transform = girih_instance_transform(instance, 0u);
        p = girih_transform_point(transform, p);
        q = girih_transform_point(transform, q);
    }
    bool clamped;
    GIRIH_AT_LEVELS(edge) = girih_edge_level(rule, p, q, clamped);
    if (clamped) {
        atomicAdd(GIRIH_AT_STATUS(GIRIH_STATUS_CLAMPED), 1u);
    }
}

#endif
