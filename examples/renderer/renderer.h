// The host's renderer, by who may use what: a renderer is the whole program's, a tessellator
// belongs to one girih context, a recorder to one thread.
#ifndef RENDERER_H
#define RENDERER_H

#include <pthread.h>

#include "host.h"

enum {
    WIDTH = 640,
    HEIGHT = 480,
    FRAMES = 9,
    IN_FLIGHT = 2,
};

// Shared by all threads. Only the queue needs a lock: every submission is made under it.
typedef struct renderer {
    host host;
    pthread_mutex_t queue_lock;
    unsigned submissions; // under the lock: a sanitizer that cannot see into the queue sees this
    const girih_mesh *mesh;
    host_image relief;
    VkSampler sampler;
    VkDescriptorSetLayout set_layout;
    VkRenderPass pass;
    VkCommandPool upload_pool; // of the thread that creates renderer and tessellators
} renderer;

// A girih context with its surface and scene. Once created it is only read here, so that any number
// of threads may use it.
typedef struct tessellator {
    renderer *renderer;
    girih_context *context;
    girih_surface_program *program;
    girih_scene *scene;
    girih_mode mode;
} tessellator;

// One frame in flight: everything that two frames at once cannot share.
typedef struct flight {
    girih_plan *plan;
    host_image images[3]; // colour, motion, depth
    VkFramebuffer framebuffer;
    host_buffer pixels[2]; // colour, motion, for the CPU
    host_buffer view;
    VkDescriptorSet set;
    VkCommandBuffer commands;
    VkFence fence;
    int frame;
    int submitted; // and not waited for yet
} flight;

// With a plan for each frame in flight, and pipelines, for their vertex input is a plan's.
typedef struct recorder {
    const tessellator *tessellator;
    VkPipelineLayout layout; // set 0: girih's, set 1: the host's
    VkPipeline model, ground;
    VkCommandPool pool;
    VkDescriptorPool descriptors;
    flight flights[IN_FLIGHT];
} recorder;

// What a zeroed object is to become, in this order; what could be created of it is destroyed too.
int renderer_create(renderer *r);
void renderer_destroy(renderer *r);

// Instanced where the device can draw so and it is not to be baked.
int tessellator_create(tessellator *t, renderer *r, int baked);
void tessellator_destroy(tessellator *t);

int recorder_create(recorder *c, const tessellator *t);
void recorder_destroy(recorder *c);

// Takes a flight whose frame is done, with its pictures in its pixels; 0 to go on.
typedef int picture_taker(const flight *f, void *user);

// Records, submits and takes all frames in their order, IN_FLIGHT of them under way at once.
int recorder_run(recorder *c, picture_taker *take, void *user);

#endif
