// What the cases of girih-bench share: a job of many methods, measured in alternating pairs.
#ifndef GIRIH_BENCH_H
#define GIRIH_BENCH_H

#include <jansson.h>
#include <stdio.h>

#include "method.h"

// One run of the program.
typedef struct bench_run {
    girih_device *device;
    uint32_t pairs;
    json_t *cases;         // what the cases found
    FILE *samples;         // CSV with every frame that was timed; NULL: not wanted
    const char *pictures;  // folder for one picture a case and method; NULL: not wanted
    uint32_t picture_size; // its width and height: BENCH_PIXELS or a half, a quarter, ... of it
} bench_run;

// A mesh to refine; the case's.
typedef struct bench_mesh {
    const char *name;
    float *positions; // [vertex_count][3]
    float *normals;   // [vertex_count][3], unit
    uint32_t *indices;
    uint32_t vertex_count;
    uint32_t triangle_count;
} bench_mesh;
girih_result bench_mesh_allocate(bench_mesh *mesh, uint32_t vertex_count, uint32_t triangle_count,
                                 girih_error *error);
void bench_mesh_free(bench_mesh *mesh);
// A unit sphere of 20 * 4^halvings triangles.
girih_result bench_sphere(uint32_t halvings, bench_mesh *mesh, girih_error *error);
// Closed, by latitude and longitude: 2 * slices * (stacks - 1) triangles.
girih_result bench_ellipsoid(uint32_t slices, uint32_t stacks, const float radii[3],
                             bench_mesh *mesh, girih_error *error);
// Closed: 2 * slices * sides triangles.
girih_result bench_torus(uint32_t slices, uint32_t sides, float radius, float thickness,
                         bench_mesh *mesh, girih_error *error);

// Dyadic levels 0..6 and linear 1..16 of the family `uniform`, whatever the built-in catalogues
// are: its numbers of triangles are known by formula, so that what a case asks of all methods stays
// as it is.
const girih_catalogue *bench_uniform_dyadic(void);
const girih_catalogue *bench_uniform_linear(void);

// A dyadic catalogue of the uniform family with levels 0..max, in *bytes, the caller's.
girih_result bench_catalogue_create(uint32_t max, void **bytes, const girih_catalogue **catalogue,
                                    girih_error *error);

#define BENCH_FRAMES 64u

// What a job draws and how it changes from frame to frame.
typedef struct bench_job_desc {
    const char *name;
    const bench_mesh *mesh; // must outlive the job
    const girih_catalogue *catalogue;
    girih_surface surface;
    // Frame n; frame 1 is the reference's, whose triangles a static mesh draws. An odd frame has
    // the reference's levels, an even one others, so that levels change every frame.
    void (*frame)(const void *user, uint32_t n, girih_frame *frame, bench_view *view);
    const void *user;
    uint32_t max_segments; // of girih's plans: triangles with longer edges are split; 0: none are
    uint32_t frame_count;  // different frames; those after them begin again; 0: BENCH_FRAMES
    bool geometry_only;    // no shaded frames are timed
    // Where a method's pairs of one kind would take longer, there are fewer, but 5 at
    // least; 0: never.
    double most_seconds;
} bench_job_desc;

typedef struct bench_case_job {
    bench_job job;
    bench_job_desc desc;
    girih_statistics reference; // of frame 1
    double mean_triangles;      // of all frames; vertices as baked
    double mean_vertices;
    double mean_parts;  // of split triangles
    double mean_groups; // that are not empty; after bench_count_groups
} bench_case_job;

girih_result bench_job_create(bench_target *target, girih_device *device,
                              const bench_job_desc *desc, bench_case_job *job, girih_error *error);
void bench_job_destroy(bench_case_job *job);

// What a job's frames put out, once more: after what its `user` points to has changed.
girih_result bench_count_frames(bench_case_job *job, girih_error *error);
// The same with the output put out, which alone shows the groups.
girih_result bench_count_groups(bench_case_job *job, girih_error *error);

// One mesh for a catalogue, uploaded with it: for jobs, and for methods with another catalogue than
// their job's. *context and *scene are the caller's even after a failure, NULL where they were not
// made.
girih_result bench_scene_create(girih_device *device, const girih_catalogue *catalogue,
                                const girih_mesh *mesh, girih_context **context,
                                girih_scene **scene, girih_error *error);

// Levels at random, up to catalogue level `*(const uint32_t *)user`, of a unit sphere seen whole.
void bench_random_frame(const void *user, uint32_t n, girih_frame *frame, bench_view *view);

// Draws frame n of a method and waits for it.
typedef struct bench_time {
    double wall; // milliseconds from the begin of the recording to the end of the wait
    double cpu;  // milliseconds of processor time, all threads together
} bench_time;
girih_result bench_frame(bench_case_job *job, const bench_method *method, void *state,
                         bench_raster raster, uint32_t n, bench_time *time, girih_error *error);

// The triangles of frame n of a method; the caller's, to be freed. GIRIH_ERROR_UNSUPPORTED without
// transform feedback.
girih_result bench_capture(bench_case_job *job, const bench_method *method, void *state, uint32_t n,
                           bench_triangles *triangles, girih_error *error);

// Every method against the first, in alternating pairs after a warm-up, geometry and shaded. Before
// that, frame 1 of every method is captured and compared with the first's, triangle by triangle,
// and its picture is kept where pictures are wanted. Adds
// {"geometry":{...},"shaded":{...},"triangles":...} for each method's name to `figures`; methods
// that do not fit get {"unfit":"why"}.
girih_result bench_measure(const bench_run *run, bench_case_job *job,
                           const bench_method *const *methods, uint32_t method_count,
                           json_t *figures, girih_error *error);

// The second method of a pair, on the second job, against the first, on the first job, which may be
// the same one: geometry and shaded, nothing else; or {"unfit"}.
girih_result bench_measure_pair(const bench_run *run, bench_case_job *const jobs[2],
                                const bench_method *const pair[2], json_t *object,
                                girih_error *error);

// Only the picture of frame 1 of a method, into run->pictures.
girih_result bench_picture(const bench_run *run, bench_case_job *job, const bench_method *method,
                           girih_error *error);

// Appends a case's object to the run's.
girih_result bench_add_case(const bench_run *run, const bench_case_job *job, json_t *figures,
                            girih_error *error);

// Makes a job, measures methods on it and adds the case: what most cases are.
girih_result bench_run_job(const bench_run *run, bench_target *target, const bench_job_desc *desc,
                           const bench_method *const *methods, uint32_t method_count,
                           girih_error *error);

// The cases: each appends one or more objects to run->cases.
girih_result bench_spheres(const bench_run *run, girih_error *error);
girih_result bench_families(const bench_run *run, girih_error *error);
// The built-in catalogues at the same rule, linear against dyadic; and making them ready.
girih_result bench_spacings(const bench_run *run, girih_error *error);
girih_result bench_bake(const bench_run *run, girih_error *error);
girih_result bench_conditions(const bench_run *run, girih_error *error);
girih_result bench_knuth_case(const bench_run *run, girih_error *error);
// Equal error, not equal time: how far each method's triangles, at several finenesses, are from the
// surface that they stand for. No times.
girih_result bench_errors(const bench_run *run, girih_error *error);
girih_result bench_instances(const bench_run *run, girih_error *error);
girih_result bench_cities(const bench_run *run, girih_error *error);
girih_result bench_large_city(const bench_run *run, girih_error *error);
// For each input size and fineness that fits: the stages' and the whole time, medians of at most
// run->pairs frames whose levels change, for a triangle of the input and of the output; and the
// memory it takes. Times by stage are 0 where the queue has no timestamps.
girih_result bench_scaling(const bench_run *run, girih_error *error);
girih_result bench_table3(const bench_run *run, girih_error *error);

#endif
