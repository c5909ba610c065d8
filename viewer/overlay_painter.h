// Puts an overlay's panels over a finished picture, on the device.
#ifndef GIRIH_VIEWER_OVERLAY_PAINTER_H
#define GIRIH_VIEWER_OVERLAY_PAINTER_H

#include "device.h"
#include "overlay.h"

// {0} is one that paints nothing and may be destroyed.
typedef struct girih_overlay_painter {
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool descriptors;
    VkDescriptorSet set;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    girih_device_buffer pixels; // of all panels, one after another
    girih_rectangle places[GIRIH_OVERLAY_PANELS];
    uint32_t panel_count;
} girih_overlay_painter;

// For subpass 0 of a render pass with one colour attachment of sRGB encoding.
girih_result girih_overlay_painter_create(girih_overlay_painter *painter,
                                          const girih_device *device, VkRenderPass pass,
                                          VkSampleCountFlagBits samples, girih_error *error);
void girih_overlay_painter_destroy(girih_overlay_painter *painter, const girih_device *device);

// Copies an overlay, NULL being an empty one. No submitted command buffer may still use the
// painter.
girih_result girih_overlay_painter_set(girih_overlay_painter *painter, const girih_device *device,
                                       const girih_overlay *overlay, girih_error *error);

// Records, inside the render pass, the panels over what has been drawn. Sets the viewport and
// the scissor.
void girih_overlay_painter_record(const girih_overlay_painter *painter, VkCommandBuffer commands);

#endif
