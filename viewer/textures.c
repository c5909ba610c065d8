#include "textures.h"

#include <stdlib.h>
#include <string.h>

#include "error.h"

static const VkFormat texture_formats[] = {
    [GIRIH_TEXEL_SRGB] = VK_FORMAT_R8G8B8A8_SRGB,
    [GIRIH_TEXEL_LINEAR] = VK_FORMAT_R8G8B8A8_UNORM,
};

static VkImageMemoryBarrier level_barrier(VkImage image, uint32_t level, uint32_t level_count,
                                          VkAccessFlags from, VkAccessFlags to,
                                          VkImageLayout old_layout, VkImageLayout new_layout) {
    return (VkImageMemoryBarrier){
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = from,
        .dstAccessMask = to,
        .oldLayout = old_layout,
        .newLayout = new_layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, level, level_count, 0, 1},
    };
}

// Each level is the one before it, halved; in the end all are for shaders to read.
static void record_levels(VkCommandBuffer commands, VkImage image, VkBuffer staging, uint32_t width,
                          uint32_t height, uint32_t level_count) {
    VkImageMemoryBarrier barrier =
        level_barrier(image, 0, level_count, 0, VK_ACCESS_TRANSFER_WRITE_BIT,
                      VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
    VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              .imageExtent = {width, height, 1}};
    vkCmdCopyBufferToImage(commands, staging, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &copy);
    for (uint32_t level = 0; level < level_count; level++) {
        barrier = level_barrier(image, level, 1, VK_ACCESS_TRANSFER_WRITE_BIT,
                                VK_ACCESS_TRANSFER_READ_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                             VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
        if (level + 1 == level_count) {
            break;
        }
        int32_t from_width = (int32_t)(width >> level), from_height = (int32_t)(height >> level);
        from_width = from_width > 0 ? from_width : 1;
        from_height = from_height > 0 ? from_height : 1;
        VkImageBlit blit = {
            .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
            .srcOffsets = {{0, 0, 0}, {from_width, from_height, 1}},
            .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level + 1, 0, 1},
            .dstOffsets = {{0, 0, 0},
                           {from_width > 1 ? from_width / 2 : 1,
                            from_height > 1 ? from_height / 2 : 1, 1}},
        };
        vkCmdBlitImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
    }
    barrier = level_barrier(image, 0, level_count, VK_ACCESS_TRANSFER_WRITE_BIT,
                            VK_ACCESS_SHADER_READ_BIT, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

static girih_result create_texture(girih_device *device, girih_device_image *image,
                                   girih_texel texel, uint32_t width, uint32_t height,
                                   const uint8_t *pixels, girih_error *error) {
    uint32_t limit = device->properties.limits.maxImageDimension2D;
    if (width > limit || height > limit) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "a texture of %u x %u pixels is more than the %u the device takes: make it smaller",
            width, height, limit);
    }
    uint32_t level_count = 1;
    while ((width > height ? width : height) >> level_count != 0) {
        level_count++;
    }
    VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = texture_formats[texel],
        .extent = {width, height, 1},
        .mipLevels = level_count,
        .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
    };
    girih_device_buffer staging = {0};
    girih_result result =
        girih_device_image_create(device, image, &info, VK_IMAGE_ASPECT_COLOR_BIT, error);
    if (result == GIRIH_OK) {
        result = girih_device_buffer_create(device, &staging, (VkDeviceSize)width * height * 4,
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT, GIRIH_MEMORY_UPLOAD,
                                            error);
    }
    if (result == GIRIH_OK) {
        memcpy(staging.mapped, pixels, (size_t)width * height * 4);
        result = girih_device_begin(device, error);
    }
    if (result == GIRIH_OK) {
        record_levels(device->commands, image->image, staging.buffer, width, height, level_count);
        result = girih_device_finish(device, error);
    }
    girih_device_buffer_destroy(device, &staging);
    return result;
}

static girih_result create_used(girih_textures *textures, girih_device *device,
                                const girih_gltf_contents *contents,
                                const girih_gltf_texture *texture, girih_texel texel,
                                girih_error *error) {
    if (texture->image < 0) {
        return GIRIH_OK;
    }
    const girih_gltf_image *image = &contents->images[texture->image];
    girih_device_image *made = &textures->images[2 * (uint32_t)texture->image + texel];
    if (made->image != VK_NULL_HANDLE || image->pixels == NULL || image->width == 0 ||
        image->height == 0) {
        return GIRIH_OK;
    }
    return create_texture(device, made, texel, image->width, image->height, image->pixels, error);
}

girih_result girih_textures_create(girih_textures *textures, girih_device *device,
                                   const girih_gltf_contents *contents, girih_error *error) {
    *textures = (girih_textures){.count = 2 * contents->image_count + 1};
    textures->images = calloc(textures->count, sizeof *textures->images);
    if (textures->images == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    static const uint8_t white[4] = {255, 255, 255, 255};
    girih_result result = create_texture(device, &textures->images[textures->count - 1],
                                         GIRIH_TEXEL_SRGB, 1, 1, white, error);
    for (uint32_t n = 0; n < contents->material_count && result == GIRIH_OK; n++) {
        const girih_gltf_material *material = &contents->materials[n];
        result = create_used(textures, device, contents, &material->base_color_texture,
                             GIRIH_TEXEL_SRGB, error);
        if (result == GIRIH_OK) {
            result = create_used(textures, device, contents, &material->normal_texture,
                                 GIRIH_TEXEL_LINEAR, error);
        }
    }
    if (result != GIRIH_OK) {
        girih_textures_free(textures, device);
    }
    return result;
}

void girih_textures_free(girih_textures *textures, const girih_device *device) {
    for (uint32_t n = 0; n < textures->count && textures->images != NULL; n++) {
        girih_device_image_destroy(device, &textures->images[n]);
    }
    for (uint32_t n = 0; n < sizeof textures->samplers / sizeof textures->samplers[0]; n++) {
        vkDestroySampler(device->device, textures->samplers[n], NULL);
    }
    free(textures->images);
    *textures = (girih_textures){0};
}

static VkSamplerAddressMode address_mode(girih_gltf_wrap wrap) {
    return wrap == GIRIH_GLTF_WRAP_CLAMP    ? VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE
           : wrap == GIRIH_GLTF_WRAP_MIRROR ? VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT
                                            : VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

girih_result girih_textures_find(girih_textures *textures, const girih_device *device,
                                 const girih_gltf_texture *texture, girih_texel texel,
                                 VkDescriptorImageInfo *info, girih_error *error) {
    static const girih_gltf_texture none = {.image = -1};
    texture = texture != NULL ? texture : &none;
    uint32_t image = textures->count - 1;
    if (texture->image >= 0) {
        uint32_t own = 2 * (uint32_t)texture->image + texel;
        image = textures->images[own].image != VK_NULL_HANDLE ? own : image;
    }
    VkSampler *sampler =
        &textures->samplers[((uint32_t)texture->wrap_s * 3 + (uint32_t)texture->wrap_t) * 2 +
                            texture->nearest];
    if (*sampler == VK_NULL_HANDLE) {
        VkSamplerCreateInfo create = {
            .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
            .magFilter = texture->nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR,
            .minFilter = VK_FILTER_LINEAR,
            .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
            .addressModeU = address_mode(texture->wrap_s),
            .addressModeV = address_mode(texture->wrap_t),
            .addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT,
            .maxLod = VK_LOD_CLAMP_NONE,
        };
        VkResult result = vkCreateSampler(device->device, &create, NULL, sampler);
        if (result != VK_SUCCESS) {
            return girih_vulkan_failure(error, "vkCreateSampler", result);
        }
    }
    *info = (VkDescriptorImageInfo){*sampler, textures->images[image].view,
                                    VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    return GIRIH_OK;
}
