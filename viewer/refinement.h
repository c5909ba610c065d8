// A frame of girih on a device, repeated with more room until it fits.
#ifndef GIRIH_VIEWER_REFINEMENT_H
#define GIRIH_VIEWER_REFINEMENT_H

#include "device.h"
#include "girih/cpu.h"
#include "report.h"

typedef struct girih_refinement_desc {
    girih_device *device;
    const girih_context *context;
    const girih_scene *scene; // uploaded
    const girih_instance *instances;
    uint32_t instance_count;
    girih_surface surface;
    const girih_surface_program *program; // GIRIH_SURFACE_OWN
    girih_mode mode;
    uint32_t outputs;      // girih_output_bits
    uint32_t max_segments; // that splitting may give an edge, as girih_segments_beyond's
    VkBufferUsageFlags vertex_usage, index_usage;
} girih_refinement_desc;

typedef struct girih_refinement {
    girih_plan *plan; // the caller's to destroy
    girih_mode mode;  // baked where triangles are split and should have been welded
    bool has_splits;  // the plan's patches say how they are split (GIRIH_SPLITS of girih.glsl)
    girih_statistics statistics;
    girih_stage_times times;
} girih_refinement;

// What a plan has room for.
typedef struct girih_refinement_room {
    uint64_t triangles, vertices, splits;
    bool grown; // as the levels asked for
} girih_refinement_room;

// Room that is tried first: most pictures fit, and what does not says how much it needs. splits is
// where triangles are split.
extern const girih_refinement_room girih_refinement_first_room;

// Makes room for what a frame that overflowed needs; false where it should have had enough.
bool girih_refinement_grow(girih_refinement_room *room, const girih_statistics *needed);

// Creates the plan of a refinement, whose mode and has_splits say which. A failure that levels are
// to blame for says what to do.
girih_result girih_refinement_plan(girih_refinement *refinement, const girih_refinement_desc *desc,
                                   const girih_refinement_room *room, girih_error *error);

// Whether a frame asked for more segments than the catalogue holds, and the next plan must split.
bool girih_refinement_must_split(const girih_refinement *refinement,
                                 const girih_refinement_desc *desc);

// The mode where triangles are split: they cannot be welded as they are refined.
girih_mode girih_refinement_split_mode(girih_mode mode);

// Reads the times of the stages from GIRIH_TIMESTAMPS queries; those that are not there are
// negative.
void girih_refinement_read_times(girih_stage_times *times, const girih_device *device,
                                 VkQueryPool queries, uint32_t first);

// Where edges ask for more segments than the catalogue holds, the frame is repeated with triangles
// split, as desc->max_segments allows.
girih_result girih_refinement_run(girih_refinement *refinement, const girih_refinement_desc *desc,
                                  const girih_frame *frame, girih_error *error);

// A scene of the model's meshes, dynamic where they are, uploaded together with the context's
// catalogue.
girih_result girih_refinement_scene(girih_device *device, girih_context *context,
                                    const girih_mesh *const *meshes, uint32_t mesh_count,
                                    girih_scene **scene, girih_error *error);

// The same on the CPU, within what memory the machine has. *desc becomes what was refined:
// max_segments 0 where nothing is split, else baked where it should have been welded.
girih_result girih_refinement_run_on_cpu(girih_cpu_desc *desc, const girih_frame *frame,
                                         girih_cpu_output *output, girih_stage_times *times,
                                         girih_error *error);

#endif
