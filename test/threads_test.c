// Two contexts on one device and four threads that record at once: each makes, records and destroys
// plans of shared scenes with a command pool of its own, so that pipelines are made by whoever
// comes first; submissions stand under one lock. Every frame must give what one thread alone got.
//
// Plain runs have validation and synchronization validation on and must stay silent. threads.sh
// builds the same program with ThreadSanitizer and runs it with --no-validation, because the layer
// is not instrumented; --prove records one plan on two threads, which the sanitizer must report.
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gpu_frame.h"
#include "meshes.h"
#include "own_surfaces.h"
#include "results.h"

#define THREADS 4
#define CONTEXTS 2
#define ROOM 60000u // triangles
#define ROUNDS 16u

static const girih_instance instances[2] = {
    {.mesh = 0, .transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    {.mesh = 1, .transform = {0, -2, 0, 3, 1, 0, 0, 0, 0, 0, -1, 0.5f}}};

// The plans that threads make, record and destroy.
static const struct {
    int context;
    girih_surface surface;
    girih_mode mode;
    uint32_t outputs;
    girih_frame frame;
} kinds[] = {
    {0,
     GIRIH_SURFACE_FLAT,
     GIRIH_MODE_BAKED,
     GIRIH_OUTPUT_SOURCES,
     {.rule = GIRIH_LEVEL_RANDOM, .segments = 12, .seed = 1}},
    {1,
     GIRIH_SURFACE_PN,
     GIRIH_MODE_WELDED,
     GIRIH_OUTPUT_CLOSED_INDICES,
     {.rule = GIRIH_LEVEL_RANDOM, .segments = 12, .seed = 2}},
    {0,
     GIRIH_SURFACE_PN,
     GIRIH_MODE_INSTANCED,
     0,
     {.rule = GIRIH_LEVEL_EDGE_LENGTH, .length = 0.2f}},
    {1,
     GIRIH_SURFACE_FLAT,
     GIRIH_MODE_INSTANCED,
     0,
     {.rule = GIRIH_LEVEL_RANDOM, .segments = 9, .seed = 4}},
    {0,
     GIRIH_SURFACE_PN,
     GIRIH_MODE_WELDED,
     GIRIH_OUTPUT_SOURCES,
     {.rule = GIRIH_LEVEL_SEGMENTS, .segments = 5}},
    {1,
     GIRIH_SURFACE_PN,
     GIRIH_MODE_BAKED,
     0,
     {.rule = GIRIH_LEVEL_RANDOM_LEVEL, .segments = 3, .seed = 6}},
    {0,
     GIRIH_SURFACE_OWN,
     GIRIH_MODE_BAKED,
     GIRIH_OUTPUT_INDICES,
     {.rule = GIRIH_LEVEL_RANDOM, .segments = 6, .seed = 7}},
    {1,
     GIRIH_SURFACE_OWN,
     GIRIH_MODE_WELDED,
     GIRIH_OUTPUT_CLOSED_INDICES,
     {.rule = GIRIH_LEVEL_RANDOM, .segments = 6, .seed = 8}},
};
#define KINDS (sizeof kinds / sizeof *kinds)

// The plan that a thread keeps and records again in every round.
static girih_frame kept_frame(uint32_t round) {
    return (girih_frame){.rule = GIRIH_LEVEL_RANDOM, .segments = 8, .seed = round};
}

typedef struct world {
    girih_context *contexts[CONTEXTS];
    girih_surface_program *programs[CONTEXTS];
    girih_scene *scenes[CONTEXTS];
} world;

typedef struct outcome {
    results arrays;
    float *corners;
    uint32_t drawn;
} outcome;

static gpu device;
static own_set own;
#define REACH 0.05f // of the own surface
static pthread_mutex_t queue_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_barrier_t together;
static world shared;
static outcome expected[KINDS];
static results expected_kept[ROUNDS];

static world open_world(const girih_mesh *const meshes[2]) {
    world made;
    for (int n = 0; n < CONTEXTS; ++n) {
        made.contexts[n] =
            gpu_variant_context(&device, (gpu_variant){.linear = n, .few_buffers = n});
        made.programs[n] = own_program(made.contexts[n], &own, OWN_WAVE, REACH);
        made.scenes[n] = gpu_scene(&device, made.contexts[n], meshes, 2);
    }
    return made;
}

static void close_world(world *there) {
    for (int n = 0; n < CONTEXTS; ++n) {
        girih_scene_destroy(there->scenes[n]);
        girih_surface_program_destroy(there->programs[n]);
        girih_context_destroy(there->contexts[n]);
    }
}

static girih_plan *make_plan(const world *in, int context, girih_surface surface, girih_mode mode,
                             uint32_t outputs) {
    const girih_plan_desc desc = {.scene = in->scenes[context],
                                  .instances = instances,
                                  .instance_count = 2,
                                  .surface = surface,
                                  .program =
                                      surface == GIRIH_SURFACE_OWN ? in->programs[context] : NULL,
                                  .mode = mode,
                                  .outputs = outputs,
                                  .max_vertices = 3 * ROOM,
                                  .max_triangles = ROOM};
    girih_plan *plan = NULL;
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_plan_create(in->contexts[context], &desc, &plan, &error), &error);
    return plan;
}

static girih_plan *make_kind(const world *in, size_t kind) {
    return make_plan(in, kinds[kind].context, kinds[kind].surface, kinds[kind].mode,
                     kinds[kind].outputs);
}

static girih_plan *make_kept(const world *in, int thread) {
    return make_plan(in, thread % CONTEXTS, GIRIH_SURFACE_FLAT, GIRIH_MODE_WELDED,
                     GIRIH_OUTPUT_SOURCES);
}

static void refine(girih_plan *plan, VkCommandBuffer commands, const girih_frame *frame) {
    girih_error error = {GIRIH_OK, ""};
    gpu_girih(girih_cmd_refine(plan, commands, frame, NULL, &error), &error);
}

// Submits under the lock and waits outside of it.
static void run(gpu *host, VkCommandBuffer commands) {
    gpu_end(commands);
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .commandBufferCount = 1,
                                 .pCommandBuffers = &commands};
    pthread_mutex_lock(&queue_lock);
    gpu_check(vkQueueSubmit(host->queue, 1, &submit, host->fence), "vkQueueSubmit");
    pthread_mutex_unlock(&queue_lock);
    gpu_check(vkWaitForFences(host->device, 1, &host->fence, VK_TRUE, UINT64_MAX),
              "vkWaitForFences");
    gpu_check(vkResetFences(host->device, 1, &host->fence), "vkResetFences");
    vkFreeCommandBuffers(host->device, host->pool, 1, &commands);
}

// One frame of a new plan, its outputs and its draw.
static void run_kind(gpu *host, const world *in, size_t kind, gpu_capture *capture,
                     results *arrays) {
    girih_plan *plan = make_kind(in, kind);
    memset(capture->counter.mapped, 0, sizeof(uint32_t));
    VkCommandBuffer commands = gpu_begin(host);
    girih_frame frame = kinds[kind].frame;
    frame.surface_set = own.set;
    refine(plan, commands, &frame);
    results_record(host, plan, commands, arrays);
    gpu_record_draw(capture, plan, commands, ROOM);
    run(host, commands);
    results_finish(plan, arrays);
    girih_plan_destroy(plan);
}

static size_t corner_bytes(uint32_t drawn) {
    return (size_t)drawn * 3 * GPU_CAPTURE_FLOATS * sizeof(float);
}

// What one thread alone gets.
static void work_out_expected(const girih_mesh *const meshes[2]) {
    world alone = open_world(meshes);
    gpu_capture captures[CONTEXTS];
    for (int n = 0; n < CONTEXTS; ++n) {
        captures[n] = gpu_capture_open(&device, alone.contexts[n]);
        own_capture(&captures[n], &own, OWN_WAVE);
    }
    for (size_t kind = 0; kind < KINDS; ++kind) {
        outcome *reference = &expected[kind];
        gpu_capture *capture = &captures[kinds[kind].context];
        run_kind(&device, &alone, kind, capture, &reference->arrays);
        reference->drawn = gpu_drawn(capture);
        const size_t bytes = corner_bytes(reference->drawn);
        reference->corners = malloc(bytes + 1);
        if (!reference->corners || reference->arrays.statistics.overflow ||
            reference->drawn != reference->arrays.statistics.output_triangles) {
            fprintf(stderr, "plan %zu: %u triangles drawn of %llu\n", kind, reference->drawn,
                    (unsigned long long)reference->arrays.statistics.output_triangles);
            exit(1);
        }
        memcpy(reference->corners, capture->corners.mapped, bytes);
    }
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        girih_plan *plan = make_kept(&alone, (int)round);
        const girih_frame frame = kept_frame(round / CONTEXTS);
        results_refine(&device, plan, &frame, &expected_kept[round]);
        girih_plan_destroy(plan);
    }
    for (int n = 0; n < CONTEXTS; ++n) {
        gpu_capture_close(&captures[n]);
    }
    close_world(&alone);
}

typedef struct worker {
    pthread_t thread;
    int number;
    unsigned frames;
    unsigned differences;
} worker;

static void count(worker *self, const char *difference, const char *what, size_t number) {
    ++self->frames;
    if (difference) {
        ++self->differences;
        fprintf(stderr, "thread %d: %s %zu: other %s than alone\n", self->number, what, number,
                difference);
    }
}

// A host of its own but for instance, device and queue.
static gpu open_host(void) {
    gpu host = device;
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = host.queue_family};
    gpu_check(vkCreateCommandPool(host.device, &pool, NULL, &host.pool), "vkCreateCommandPool");
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    gpu_check(vkCreateFence(host.device, &fence, NULL, &host.fence), "vkCreateFence");
    return host;
}

static void close_host(gpu *host) {
    vkDestroyFence(host->device, host->fence, NULL);
    vkDestroyCommandPool(host->device, host->pool, NULL);
}

static void *work(void *argument) {
    worker *self = argument;
    gpu host = open_host();
    gpu_capture captures[CONTEXTS];
    for (int n = 0; n < CONTEXTS; ++n) {
        captures[n] = gpu_capture_open(&host, shared.contexts[n]);
        own_capture(&captures[n], &own, OWN_WAVE);
    }
    girih_plan *kept = make_kept(&shared, self->number);
    results arrays = {0};
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        // First everyone makes the same plan at once, so that all want the same pipelines; then
        // each goes its own way.
        size_t kind = round;
        if (round < KINDS) {
            pthread_barrier_wait(&together);
        } else {
            kind = (round * (uint32_t)(2 * self->number + 1) + (uint32_t)self->number) % KINDS;
        }
        const outcome *reference = &expected[kind];
        gpu_capture *capture = &captures[kinds[kind].context];
        run_kind(&host, &shared, kind, capture, &arrays);
        const char *difference = results_difference(&reference->arrays, &arrays);
        if (!difference && (gpu_drawn(capture) != reference->drawn ||
                            memcmp(capture->corners.mapped, reference->corners,
                                   corner_bytes(reference->drawn)) != 0)) {
            difference = "triangles drawn";
        }
        count(self, difference, "plan", kind);
        // The kept plan: every frame in two rounds, the second time with nothing new.
        const uint32_t seed = round / CONTEXTS;
        const girih_frame frame = kept_frame(seed);
        VkCommandBuffer commands = gpu_begin(&host);
        refine(kept, commands, &frame);
        results_record(&host, kept, commands, &arrays);
        run(&host, commands);
        results_finish(kept, &arrays);
        const size_t as = CONTEXTS * seed + (size_t)self->number % CONTEXTS;
        count(self, results_difference(&expected_kept[as], &arrays), "kept frame", seed);
    }
    results_free(&host, &arrays);
    girih_plan_destroy(kept);
    for (int n = 0; n < CONTEXTS; ++n) {
        gpu_capture_close(&captures[n]);
    }
    close_host(&host);
    return NULL;
}

// Against the rules, to show that a sanitizer sees into the library: one plan on two threads.
static girih_plan *same_plan;

static void *record_same_plan(void *argument) {
    (void)argument;
    gpu host = open_host();
    VkCommandBuffer commands = gpu_begin(&host);
    const girih_frame frame = kept_frame(1);
    refine(same_plan, commands, &frame);
    gpu_end(commands);
    vkFreeCommandBuffers(host.device, host.pool, 1, &commands);
    close_host(&host);
    return NULL;
}

static void start(pthread_t *thread, void *(*function)(void *), void *argument) {
    if (pthread_create(thread, NULL, function, argument)) {
        fprintf(stderr, "a thread could not be created\n");
        exit(1);
    }
}

static void break_the_rules(void) {
    same_plan = make_kept(&shared, 0);
    pthread_t threads[2];
    start(&threads[0], record_same_plan, NULL);
    start(&threads[1], record_same_plan, NULL);
    pthread_join(threads[0], NULL);
    pthread_join(threads[1], NULL);
    girih_plan_destroy(same_plan);
}

int main(int argument_count, char **arguments) {
    const char *option = argument_count > 1 ? arguments[1] : "";
    const bool prove = strcmp(option, "--prove") == 0;
    const bool validation = argument_count == 1;
    if (argument_count > 2 || (!validation && !prove && strcmp(option, "--no-validation") != 0)) {
        fprintf(stderr, "usage: threads_test [--no-validation | --prove]\n");
        return 2;
    }
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, validation);
    own = own_set_open(&device, (own_settings){.height = REACH, .phase = 0.3f});
    const girih_mesh *meshes[2] = {make_seam_sphere(9, 7), make_cube(1)};
    unsigned frames = 0;
    unsigned differences = 0;
    if (prove) {
        shared = open_world(meshes);
        break_the_rules();
        close_world(&shared);
    } else {
        work_out_expected(meshes);
        shared = open_world(meshes);
        if (pthread_barrier_init(&together, NULL, THREADS)) {
            fprintf(stderr, "a barrier could not be created\n");
            return 1;
        }
        worker workers[THREADS];
        for (int n = 0; n < THREADS; ++n) {
            workers[n] = (worker){.number = n};
            start(&workers[n].thread, work, &workers[n]);
        }
        for (int n = 0; n < THREADS; ++n) {
            pthread_join(workers[n].thread, NULL);
            frames += workers[n].frames;
            differences += workers[n].differences;
        }
        pthread_barrier_destroy(&together);
        close_world(&shared);
        for (size_t kind = 0; kind < KINDS; ++kind) {
            results_free(&device, &expected[kind].arrays);
            free(expected[kind].corners);
        }
        for (uint32_t round = 0; round < ROUNDS; ++round) {
            results_free(&device, &expected_kept[round]);
        }
        printf("%u frames on %d threads and %d contexts, %u unlike those of one thread\n", frames,
               THREADS, CONTEXTS, differences);
    }
    girih_mesh_destroy(meshes[0]);
    girih_mesh_destroy(meshes[1]);
    own_set_close(&device, &own);
    const unsigned messages = gpu_close(&device);
    printf("validation messages: %u%s\n", messages, validation ? "" : " (validation was off)");
    return differences != 0 || messages != 0 || (!prove && frames == 0);
}
