// The images that a picture is drawn into, and the render pass over them.
#ifndef GIRIH_VIEWER_ATTACHMENTS_H
#define GIRIH_VIEWER_ATTACHMENTS_H

#include "device.h"

typedef struct girih_attachments {
    // As long as the device has them:
    VkSampleCountFlagBits samples;
    VkFormat depth_format;
    VkRenderPass pass;
    // Of one size, 0 x 0 until girih_attachments_resize:
    uint32_t width, height;
    girih_device_image color; // with several samples only
    girih_device_image resolved, depth;
    VkFramebuffer framebuffer;
} girih_attachments;

// Chooses formats and makes the render pass. samples of a pixel: 0 for 4, or 1 where the device has
// no more. girih_attachments_free takes *attachments, whatever
// the result.
girih_result girih_attachments_create(girih_attachments *attachments, const girih_device *device,
                                      uint32_t samples, girih_error *error);

// Makes the images anew. No submitted commands may still use the ones before.
girih_result girih_attachments_resize(girih_attachments *attachments, const girih_device *device,
                                      uint32_t width, uint32_t height, girih_error *error);

void girih_attachments_free(girih_attachments *attachments, const girih_device *device);

#endif
