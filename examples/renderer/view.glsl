// What the host hands to all its shaders. The set is the one after girih's, in drawing and in baking.
#ifndef GIRIH_SURFACE_SET
#define GIRIH_SURFACE_SET 1
#endif

layout(std140, set = GIRIH_SURFACE_SET, binding = 0) uniform View {
    mat4 world_to_clip;
    mat4 previous_world_to_clip;
    vec4 times; // seconds: of this frame, of the previous one
} view;

layout(set = GIRIH_SURFACE_SET, binding = 1) uniform sampler2D relief;
