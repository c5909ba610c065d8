// Shared by the files of the target.
#ifndef GIRIH_BENCH_TARGET_PRIVATE_H
#define GIRIH_BENCH_TARGET_PRIVATE_H

#include "target.h"

struct bench_target {
    girih_device *device;
    girih_device_image color, depth;
    VkRenderPass pass;
    VkFramebuffer framebuffer;
    VkRenderPass empty_pass; // without images
    VkFramebuffer empty_framebuffer;
    VkShaderModule fragment;
    // Set 0 of every method: the view and the frame's levels.
    VkDescriptorSetLayout view_layout;
    VkDescriptorPool view_pool;
    VkDescriptorSet view_set;
    girih_device_buffer view; // bench_view, then girih_frame_block at frame_offset
    VkDeviceSize frame_offset;
    girih_device_buffer picture;
    bench_feedback feedback;
    girih_device_buffer captured; // corners of BENCH_CAPTURE
    girih_device_buffer counter;  // bytes captured
    uint32_t capture_room;        // triangles
    VkBool32 cylindrical;         // constant 100 of all shaders
};

#define BENCH_CORNER_BYTES 24u

#endif
