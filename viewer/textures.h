// Base colour textures, normal maps and their samplers on the device.
#ifndef GIRIH_VIEWER_TEXTURES_H
#define GIRIH_VIEWER_TEXTURES_H

#include "device.h"
#include "gltf.h"

typedef struct girih_textures {
    uint32_t count; // two for each image of the model, sRGB and linear, then a white one
    girih_device_image *images; // those that no material uses are empty
    VkSampler samplers[18];     // by wrap_s, wrap_t and nearest; made as needed
} girih_textures;

// How an image's bytes are read.
typedef enum girih_texel {
    GIRIH_TEXEL_SRGB,   // base colours
    GIRIH_TEXEL_LINEAR, // normal maps
} girih_texel;

// Uploads the images that materials use, with mipmaps.
girih_result girih_textures_create(girih_textures *textures, girih_device *device,
                                   const girih_gltf_contents *contents, girih_error *error);
void girih_textures_free(girih_textures *textures, const girih_device *device);

// What a material samples: the texture's image, or white. texture may be NULL.
girih_result girih_textures_find(girih_textures *textures, const girih_device *device,
                                 const girih_gltf_texture *texture, girih_texel texel,
                                 VkDescriptorImageInfo *info, girih_error *error);

#endif
