// All frames on four threads at once: each with its own command pool, plans and pictures, two of
// them in each of two girih contexts, whose surface program and scene they share. One context
// bakes, the other draws instanced where the device can. Nothing but the submission takes a lock.
//
// The contexts are new, so that their threads make girih's pipelines at the same time.
#include "threads.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CONTEXTS = 2,
    THREADS = 4,
    COLOUR_BYTES = WIDTH * HEIGHT * 4,
    MOTION_BYTES = WIDTH * HEIGHT * 8,
};

typedef struct picture {
    unsigned char colour[COLOUR_BYTES], motion[MOTION_BYTES];
} picture;

typedef struct worker {
    pthread_t thread;
    recorder recorder;
    const tessellator *tessellator;
    picture *alone; // FRAMES of them, as one thread got them
    int same, different;
    int failed;
} worker;

static int keep(const flight *f, void *user) {
    picture *kept = (picture *)user + f->frame;
    memcpy(kept->colour, f->pixels[0].mapped, COLOUR_BYTES);
    memcpy(kept->motion, f->pixels[1].mapped, MOTION_BYTES);
    return 0;
}

static int compare(const flight *f, void *user) {
    worker *w = user;
    const picture *alone = &w->alone[f->frame];
    const int same = memcmp(alone->colour, f->pixels[0].mapped, COLOUR_BYTES) == 0 &&
                     memcmp(alone->motion, f->pixels[1].mapped, MOTION_BYTES) == 0;
    w->same += same;
    w->different += !same;
    return 0;
}

static int draw_alone(renderer *r, int baked, picture *pictures) {
    tessellator t = {0};
    recorder c = {0};
    const int failed = tessellator_create(&t, r, baked) || recorder_create(&c, &t) ||
                       recorder_run(&c, keep, pictures);
    recorder_destroy(&c);
    tessellator_destroy(&t);
    return failed;
}

static void *work(void *user) {
    worker *w = user;
    w->failed =
        recorder_create(&w->recorder, w->tessellator) || recorder_run(&w->recorder, compare, w);
    recorder_destroy(&w->recorder);
    return NULL;
}

static int draw_together(const renderer *r, worker workers[THREADS]) {
    const unsigned before = r->submissions;
    int started = 0;
    while (started < THREADS &&
           pthread_create(&workers[started].thread, NULL, work, &workers[started]) == 0) {
        ++started;
    }
    int failed = started < THREADS, same = 0, different = 0;
    for (int n = 0; n < started; ++n) {
        TRY(pthread_join(workers[n].thread, NULL));
        failed = failed || workers[n].failed;
        same += workers[n].same;
        different += workers[n].different;
    }
    printf("%d threads in %d contexts, %u submissions: %d pictures are those of one thread, %d are "
           "not\n",
           started, CONTEXTS, r->submissions - before, same, different);
    return failed || same != THREADS * FRAMES;
}

int run_threads(renderer *r) {
    tessellator tessellators[CONTEXTS] = {{0}};
    worker workers[THREADS] = {{0}};
    picture *pictures = calloc(CONTEXTS * FRAMES, sizeof *pictures);
    int failed = !pictures;
    for (int n = 0; n < CONTEXTS && !failed; ++n) {
        failed =
            draw_alone(r, n, pictures + n * FRAMES) || tessellator_create(&tessellators[n], r, n);
    }
    for (int n = 0; n < THREADS; ++n) {
        workers[n].tessellator = &tessellators[n % CONTEXTS];
        workers[n].alone = pictures + n % CONTEXTS * FRAMES;
    }
    failed = failed || draw_together(r, workers);
    for (int n = 0; n < CONTEXTS; ++n) {
        tessellator_destroy(&tessellators[n]);
    }
    free(pictures);
    return failed;
}
