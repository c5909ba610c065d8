// Surfaces of the user's: --surface FILE.glsl, --displace, or both.
#ifndef GIRIH_VIEWER_OWN_SURFACE_H
#define GIRIH_VIEWER_OWN_SURFACE_H

#include "device.h"
#include "displacement.h"
#include "model.h"

// girih.glsl's and the surface's descriptor sets in the renderer's vertex shader.
enum { GIRIH_DRAW_SET = 2, GIRIH_DRAW_SURFACE_SET = 3 };

typedef struct girih_own_surface {
    const girih_surface_options *options;
    girih_displacement displacement; // without --displace empty
    float reach;                     // as girih_surface_program_desc's
    // On a device:
    girih_surface_program *program;
    VkDescriptorSetLayout layout; // VK_NULL_HANDLE where the surface reads nothing of its own
    VkDescriptorPool pool;
    VkDescriptorSet set;
    VkSampler sampler;
    girih_device_image heights;
    uint32_t *vertex_words; // shaders/model.glsl with the surface, for the instanced mode
    size_t vertex_bytes;
    uint32_t revision; // changes with them
} girih_own_surface;

// Loads what the options name and tells the model how far the surface strays from it. Messages
// begin with the file they are about. On failure *surface is empty.
girih_result girih_own_surface_load(girih_own_surface *surface, const char *file,
                                    const girih_surface_options *options, girih_model *model,
                                    const girih_instance *instances, uint32_t instance_count,
                                    girih_error *error);

// Uploads what it reads, and compiles it for all modes but the instanced one.
girih_result girih_own_surface_upload(girih_own_surface *surface, girih_device *device,
                                      const girih_context *context, bool instanced,
                                      girih_error *error);

// Compiles it for drawing in the instanced mode, from a plan that splits triangles or not.
girih_result girih_own_surface_compile_drawing(girih_own_surface *surface, bool has_splits,
                                               girih_error *error);

// Compiles the surface as its file is now, for drawing in the instanced mode too if drawn, into
// *fresh, which shares all else with the surface. On failure *fresh holds nothing of its own.
girih_result girih_own_surface_compile_again(const girih_own_surface *surface,
                                             const girih_context *context, bool drawn,
                                             bool has_splits, girih_own_surface *fresh,
                                             girih_error *error);

// Has the surface take what was compiled. The plans of its program must be destroyed before.
void girih_own_surface_replace(girih_own_surface *surface, const girih_own_surface *fresh);

// Frees what is on the device, before it is closed. Its plans must be destroyed before.
void girih_own_surface_remove(girih_own_surface *surface, const girih_device *device);

void girih_own_surface_free(girih_own_surface *surface);

#endif
