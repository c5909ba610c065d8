// Methods: ways of drawing one refined mesh, girih's own among them. To add one, fill in a
// bench_method in a file of rivals/ and name it in methods.h.
#ifndef GIRIH_BENCH_METHOD_H
#define GIRIH_BENCH_METHOD_H

#include "target.h"

// What is to be drawn: the same for every method. All of it outlives the methods' states.
typedef struct bench_job {
    bench_target *target;
    girih_device *device; // the target's
    const char *name;     // in reports

    // The input as it was before any preparation, every vertex a position and a unit normal.
    const float *positions; // [vertex_count][3]
    const float *normals;   // [vertex_count][3]
    const uint32_t *indices;
    uint32_t vertex_count;
    uint32_t triangle_count;
    // The same on the device, for vertex input, indices, storage and transfer: 6 floats a vertex
    // (position, normal); 3 x uint32 a triangle.
    girih_device_buffer vertex_buffer;
    girih_device_buffer index_buffer;

    // The same, prepared for girih.
    const girih_mesh *mesh;
    const girih_catalogue *catalogue;
    girih_context *context;
    girih_scene *scene;

    girih_surface surface; // flat or PN
    // The most triangles that any frame puts out.
    uint32_t room_triangles;
    // Of girih's plans: segments that edges may ask for, and the most parts that any frame's split
    // triangles have; where none are split, 0.
    uint32_t max_segments;
    uint32_t room_splits;

    // The frame to be drawn: its levels and what is seen. Frame number 1 is the reference's.
    girih_frame frame;
    girih_frame reference;
} bench_job;

// Where the fields of a job's uniform blocks are: shaders/view.glsl.
typedef struct bench_method {
    const char *name;    // in reports: lower case, hyphens
    const char *follows; // the paper, standard or program it follows
    const char *note;    // what whoever reads its figures must know; NULL: nothing
    int variant;         // for `create`: where one file makes several methods

    // NULL where the device and the job suit the method, else why not, in one line. May be NULL.
    const char *(*unfit)(const bench_job *job);
    // Everything that is not repeated each frame. *state is the method's own, NULL on failure.
    girih_result (*create)(const bench_job *job, int variant, void **state, girih_error *error);
    void (*destroy)(void *state); // takes NULL
    // Work that needs submissions of its own, such as reading back; the device's command buffer is
    // not being recorded. May be NULL.
    girih_result (*ahead)(void *state, girih_error *error);
    // Records what the frame needs before its render pass. May be NULL.
    girih_result (*prepare)(void *state, VkCommandBuffer commands, girih_error *error);
    // Records the draws inside the render pass: the method binds its own pipeline of the raster
    // mode and the view (bench_bind_layout), then draws between bench_begin_draws and
    // bench_end_draws.
    void (*draw)(void *state, VkCommandBuffer commands, bench_raster raster);
    // Whether the last waited-for frame was cut short by lack of room, and thus not whole. May be
    // NULL: it never is.
    bool (*overflow)(void *state);
    // Triangles drawn in the last waited-for frame. May be NULL: it is not known.
    uint64_t (*drawn)(void *state);
} bench_method;

#endif
