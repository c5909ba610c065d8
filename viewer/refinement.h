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

// Where edges ask for more segments than the catalogue holds, the frame is repeated with triangles
// split, as desc->max_segments allows.
girih_result girih_refinement_run(girih_refinement *refinement, const girih_refinement_desc *desc,
                                  const girih_frame *frame, girih_error *error);

// A scene of the model's meshes, uploaded together with the context's catalogue.
girih_result girih_refinement_scene(girih_device *device, girih_context *context,
                                    const girih_mesh *const *meshes, uint32_t mesh_count,
                                    girih_scene **scene, girih_error *error);

// The same on the CPU, within what memory the machine has. *desc becomes what was refined:
// max_segments 0 where nothing is split, else baked where it should have been welded.
girih_result girih_refinement_run_on_cpu(girih_cpu_desc *desc, const girih_frame *frame,
                                         girih_cpu_output *output, girih_stage_times *times,
                                         girih_error *error);

#endif
