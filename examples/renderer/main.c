// A host with its own render pass, depth buffer, shaders, texture, uniform buffer and geometry, and
// with a surface of its own (surface.glsl) that girih refines anew each frame: two rings that turn,
// with a relief from a texture and a ripple, over a grid; two frames in flight, and motion vectors
// in a second attachment. No window: every third frame is written to renderer_N.ppm, its colours on
// the left, its motion on the right (red to the right, green down, grey at rest).
//
// Instanced where the device can draw so; else, or as `./renderer baked`, baked by the same
// surface. As `./renderer threads`, two contexts and four threads draw it at once (threads.c). The
// validation layer watches where it is installed; any message makes the program fail.
#include <stdio.h>
#include <string.h>

#include "threads.h"

static unsigned char shade(float motion) { // pixels
    const float value = 127.5f + 8.0f * motion;
    return (unsigned char)(value < 0 ? 0 : value > 255 ? 255 : value);
}

static int write_picture(const flight *f, int number) {
    const unsigned char *colour = f->pixels[0].mapped;
    const float *motion = f->pixels[1].mapped;
    char name[32];
    snprintf(name, sizeof name, "renderer_%d.ppm", number);
    FILE *file = fopen(name, "wb");
    int failed = !file || fprintf(file, "P6 %d %d 255\n", 2 * WIDTH, HEIGHT) < 0;
    for (int y = 0; y < HEIGHT && !failed; ++y) {
        unsigned char row[2 * WIDTH][3];
        for (int x = 0; x < WIDTH; ++x) {
            const int n = y * WIDTH + x;
            memcpy(row[x], colour + 4 * n, 3);
            row[WIDTH + x][0] = shade(motion[2 * n] * WIDTH);
            row[WIDTH + x][1] = shade(motion[2 * n + 1] * HEIGHT);
            row[WIDTH + x][2] = 128;
        }
        failed = fwrite(row, sizeof row, 1, file) != 1;
    }
    if (file) {
        failed = fclose(file) != 0 || failed;
    }
    if (failed) {
        perror(name);
    }
    return failed;
}

static int show(const flight *f, void *user) {
    (void)user;
    const girih_statistics s = girih_plan_statistics(f->plan);
    printf("frame %d: %llu triangles, %llu out of view, refined to %llu\n", f->frame,
           (unsigned long long)s.input_triangles, (unsigned long long)s.culled_triangles,
           (unsigned long long)s.output_triangles);
    return f->frame % 3 == 2 ? write_picture(f, f->frame / 3) : 0;
}

static int run(renderer *r, int baked) {
    static tessellator t;
    static recorder c;
    const int failed =
        tessellator_create(&t, r, baked) || recorder_create(&c, &t) || recorder_run(&c, show, NULL);
    printf("%s, %s\n", r->host.properties.deviceName,
           t.mode == GIRIH_MODE_BAKED ? "baked" : "instanced");
    recorder_destroy(&c);
    tessellator_destroy(&t);
    return failed;
}

int main(int argc, char **argv) {
    const char *how = argc > 1 ? argv[1] : "";
    const int baked = strcmp(how, "baked") == 0, threads = strcmp(how, "threads") == 0;
    if (argc > 2 || (argc == 2 && !baked && !threads)) {
        fprintf(stderr, "usage: %s [baked | threads]\n", argv[0]);
        return 2;
    }
    static renderer r;
    const int failed = renderer_create(&r) || (threads ? run_threads(&r) : run(&r, baked));
    renderer_destroy(&r);
    const unsigned messages = r.host.messages;
    if (r.host.messenger) {
        printf("messages of the validation layer: %u\n", messages);
    } else {
        printf("not validated: no validation layer was found\n");
    }
    return failed || messages;
}
