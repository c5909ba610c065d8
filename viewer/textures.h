// Base colour textures and their samplers on the device.
#ifndef GIRIH_VIEWER_TEXTURES_H
#define GIRIH_VIEWER_TEXTURES_H

#include "device.h"
#include "gltf.h"

typedef struct girih_textures {
    uint32_t count;             // images of the model, then a white one
    girih_device_image *images; // those that no material uses are empty
    VkSampler samplers[18];     // by wrap_s, wrap_t and nearest; made as needed
} girih_textures;

// Uploads the images that base colours use, with mipmaps.
girih_result girih_textures_create(girih_textures *textures, girih_device *device,
                                   const girih_gltf_contents *contents, girih_error *error);
void girih_textures_free(girih_textures *textures, const girih_device *device);

// What a material samples: its image, or white. material may be NULL.
girih_result girih_textures_find(girih_textures *textures, const girih_device *device,
                                 const girih_gltf_material *material, VkDescriptorImageInfo *info,
                                 girih_error *error);

#endif
