#include "own_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "report.h"
#include "shader_compiler.h"

// --- Loading ---

// How often the map goes into a mesh unit so that it goes once into the largest mesh.
static float repeats_of(const girih_model *model) {
    float size = 0.0f;
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        const girih_mesh *mesh = model->meshes[n];
        for (int axis = 0; axis < 3; axis++) {
            size = fmaxf(size, mesh->bounds_max[axis] - mesh->bounds_min[axis]);
        }
    }
    return size > 0.0f ? 1.0f / size : 1.0f;
}

// What a transform makes of a mesh unit along its most stretched axis.
static float stretch(const float t[12]) {
    float longest = 0.0f;
    for (int c = 0; c < 3; c++) {
        longest = fmaxf(longest, t[c] * t[c] + t[4 + c] * t[4 + c] + t[8 + c] * t[8 + c]);
    }
    return sqrtf(longest);
}

static void warn_of_bare_primitives(const girih_model *model, const char *file) {
    uint32_t bare = 0;
    uint32_t count = 0;
    for (uint32_t m = 0; m < model->contents->mesh_count; m++) {
        const girih_gltf_mesh *mesh = &model->contents->meshes[m];
        for (uint32_t n = 0; n < mesh->primitive_count; n++, count++) {
            bare += girih_model_find_attribute(&mesh->primitives[n], "TEXCOORD_0") == NULL;
        }
    }
    if (bare != 0) {
        char text[160];
        snprintf(text, sizeof text,
                 "%u of %u primitives have no TEXCOORD_0: --displace moves all of each as the "
                 "map's corner says",
                 bare, count);
        girih_report_warning(file, text);
    }
}

girih_result girih_own_surface_load(girih_own_surface *surface, const char *file,
                                    const girih_surface_options *options, girih_model *model,
                                    const girih_instance *instances, uint32_t instance_count,
                                    girih_error *error) {
    *surface = (girih_own_surface){.options = options, .reach = -1.0f};
    if (options->height_map == NULL) {
        return GIRIH_OK;
    }
    girih_displacement *displacement = &surface->displacement;
    displacement->per_unit = options->height;
    displacement->zero = options->height_zero;
    displacement->texcoord_float = girih_model_height_float(model);
    displacement->by_axes = displacement->texcoord_float == GIRIH_MODEL_NONE;
    displacement->repeats = repeats_of(model);
    if (!displacement->by_axes) {
        warn_of_bare_primitives(model, file);
    }
    girih_result result = girih_height_map_load(options->height_map, &displacement->map, error);
    if (result != GIRIH_OK) {
        return result;
    }
    float distance = girih_displacement_distance(displacement);
    if (!isfinite(distance)) {
        girih_height_map_free(&displacement->map);
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "height map %.200s: --height %g of its heights is more than floats hold",
                          options->height_map, (double)options->height);
    }
    for (uint32_t n = 0; n < instance_count; n++) {
        model->reach = fmaxf(model->reach, distance * stretch(instances[n].transform));
    }
    // The user's own function may go anywhere.
    surface->reach = options->file == NULL ? distance : -1.0f;
    return GIRIH_OK;
}

void girih_own_surface_free(girih_own_surface *surface) {
    girih_height_map_free(&surface->displacement.map);
    *surface = (girih_own_surface){0};
}

// --- Compiling ---

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

// The name of a texture or buffer that neither girih nor the viewer declares; NULL: there is none.
// Pipelines that read what no descriptor shows would crash the driver.
static const char *find_foreign_resource(const uint32_t *words, size_t count) {
    enum { OP_NAME = 5, OP_DECORATE = 71, DECORATION_SET = 34 };
    for (size_t at = 5; at < count && words[at] >> 16 != 0; at += words[at] >> 16) {
        if ((words[at] & 0xffff) != OP_DECORATE || words[at + 2] != DECORATION_SET) {
            continue;
        }
        // Names come before decorations. The arrays of girih and of the viewer have empty ones.
        uint32_t set = words[at + 3];
        for (size_t name = 5; name < at; name += words[name] >> 16) {
            const char *text = (const char *)(words + name + 2);
            if ((words[name] & 0xffff) != OP_NAME || words[name + 1] != words[at + 1]) {
                continue;
            }
            if (text[0] == '\0' ? set != 0 && set != GIRIH_DRAW_SET
                                : strncmp(text, "girih_", 6) != 0 && strcmp(text, "picture") != 0) {
                return text[0] == '\0' ? "a block without a name" : text;
            }
        }
    }
    return NULL;
}

// The whole shader: what it is for, girih's GLSL, then the surface, so that an error in the user's
// file cannot be taken for one after it. `define` is a macro that girih's GLSL asks for, or empty.
static girih_result compile(const girih_own_surface *surface, girih_shader_stage stage,
                            const char *define, uint32_t **words, size_t *bytes,
                            girih_error *error) {
    const girih_surface_options *options = surface->options;
    bool is_displaced = options->height_map != NULL;
    bool is_bake = stage == GIRIH_SHADER_COMPUTE;
    char kind[200];
    char displaced[600] = "";
    char place[100];
    if (is_bake) {
        snprintf(kind, sizeof kind, "%s#define GIRIH_BAKE\n#include \"girih.glsl\"\n", define);
    } else {
        snprintf(kind, sizeof kind,
                 "%s#define GIRIH_MODE 0\n#define GIRIH_SURFACE 2\n#define GIRIH_SET %d\n"
                 "#define GIRIH_SURFACE_SET %d\n#include \"model.glsl\"\n",
                 define, GIRIH_DRAW_SET, GIRIH_DRAW_SURFACE_SET);
    }
    if (is_displaced) {
        const girih_displacement *displacement = &surface->displacement;
        if (displacement->by_axes) {
            snprintf(place, sizeof place, "#define HEIGHT_MAP_REPEATS uintBitsToFloat(0x%08xu)\n",
                     bits_of(displacement->repeats));
        } else {
            snprintf(place, sizeof place, "#define HEIGHT_MAP_FLOAT %uu\n",
                     displacement->texcoord_float);
        }
        snprintf(displaced, sizeof displaced,
                 "%s#define HEIGHT_PER_UNIT uintBitsToFloat(0x%08xu)\n"
                 "#define HEIGHT_ZERO uintBitsToFloat(0x%08xu)\n"
                 "#define HEIGHT_LOW uintBitsToFloat(0x%08xu)\n"
                 "#define HEIGHT_HIGH uintBitsToFloat(0x%08xu)\n"
                 "#include \"displaced.glsl\"\n",
                 place, bits_of(displacement->per_unit), bits_of(displacement->zero),
                 bits_of(displacement->map.minimum), bits_of(displacement->map.maximum));
    }
    // Displaced, the user's function is not the surface itself and goes by another name.
    const char *file = options->file == NULL ? ""
                       : is_displaced
                           ? "#define girih_surface girih_undisplaced\n"
                             "#include \"" GIRIH_SHADER_USER_FILE "\"\n"
                             "#undef girih_surface\n#define UNDISPLACED girih_undisplaced\n"
                           : "#include \"" GIRIH_SHADER_USER_FILE "\"\n";
    char source[1500];
    snprintf(source, sizeof source,
             "#version 450\n#extension GL_GOOGLE_include_directive : require\n"
             "#define GIRIH_BASE %d\n%s%s%s",
             options->base == GIRIH_SURFACE_FLAT ? 0 : 1, kind, file, displaced);
    girih_shader_request request = {
        .stage = stage,
        .source = source,
        .source_name = is_bake ? "surface for baking" : "surface for drawing",
        .includes = girih_shader_library,
        .include_count = girih_shader_library_count,
        .user_file = options->file,
        .function = is_displaced ? "girih_undisplaced" : "girih_surface",
        .declaration = "vec3 girih_surface(GirihPatch, vec3)",
    };
    girih_result result = girih_shader_compile(&request, words, bytes, error);
    const char *foreign = result == GIRIH_OK ? find_foreign_resource(*words, *bytes / 4) : NULL;
    if (foreign != NULL) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                            "%.200s: declares '%.100s', a texture or buffer that the command line "
                            "cannot fill; a host of the library can",
                            options->file, foreign);
        free(*words);
        *words = NULL;
    }
    return result;
}

// --- The height map on the device ---

static void record_heights(VkCommandBuffer commands, VkImage image, VkBuffer staging,
                           const girih_height_map *map) {
    VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
    };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
    VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              .imageExtent = {map->width, map->height, 1}};
    vkCmdCopyBufferToImage(commands, staging, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &copy);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    // The queue may be one that cannot draw, and whoever reads them comes in a later submission.
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

static girih_result upload_heights(girih_own_surface *surface, girih_device *device,
                                   girih_error *error) {
    const girih_height_map *map = &surface->displacement.map;
    uint32_t limit = device->properties.limits.maxImageDimension2D;
    if (map->width > limit || map->height > limit) {
        return girih_fail(
            error, GIRIH_ERROR_TOO_LARGE,
            "height map %.200s: %u x %u texels are more than the %u the device takes: make it "
            "smaller",
            surface->options->height_map, map->width, map->height, limit);
    }
    VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = VK_FORMAT_R32_SFLOAT,
        .extent = {map->width, map->height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
    };
    VkDeviceSize size = (VkDeviceSize)map->width * map->height * sizeof(float);
    girih_device_buffer staging = {0};
    girih_result result = girih_device_image_create(device, &surface->heights, &info,
                                                    VK_IMAGE_ASPECT_COLOR_BIT, error);
    if (result == GIRIH_OK) {
        result = girih_device_buffer_create(
            device, &staging, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, GIRIH_MEMORY_UPLOAD, error);
    }
    if (result == GIRIH_OK) {
        memcpy(staging.mapped, map->texels, (size_t)size);
        result = girih_device_begin(device, error);
    }
    if (result == GIRIH_OK) {
        record_heights(device->commands, surface->heights.image, staging.buffer, map);
        result = girih_device_finish(device, error);
    }
    girih_device_buffer_destroy(device, &staging);
    return result;
}

static girih_result create_set(girih_own_surface *surface, const girih_device *device,
                               girih_error *error) {
    VkDescriptorSetLayoutBinding binding = {
        0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
        VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT, NULL};
    VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 1,
        .pBindings = &binding};
    VkResult result = vkCreateDescriptorSetLayout(device->device, &layout, NULL, &surface->layout);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorSetLayout", result);
    }
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = 1,
                                       .poolSizeCount = 1,
                                       .pPoolSizes = &size};
    result = vkCreateDescriptorPool(device->device, &pool, NULL, &surface->pool);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateDescriptorPool", result);
    }
    VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO}; // fetches only
    result = vkCreateSampler(device->device, &sampler, NULL, &surface->sampler);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkCreateSampler", result);
    }
    VkDescriptorSetAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorPool = surface->pool,
                                            .descriptorSetCount = 1,
                                            .pSetLayouts = &surface->layout};
    result = vkAllocateDescriptorSets(device->device, &allocate, &surface->set);
    if (result != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkAllocateDescriptorSets", result);
    }
    VkDescriptorImageInfo image = {surface->sampler, surface->heights.view,
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = surface->set,
                                  .descriptorCount = 1,
                                  .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                  .pImageInfo = &image};
    vkUpdateDescriptorSets(device->device, 1, &write, 0, NULL);
    return GIRIH_OK;
}

static girih_result create_program(girih_own_surface *surface, const girih_context *context,
                                   bool instanced, girih_error *error) {
    girih_report_progress("compiling the surface");
    bool few_buffers = girih_context_uses_few_buffers(context) != 0;
    uint32_t *words = NULL;
    size_t bytes = 0;
    girih_result result = GIRIH_OK;
    if (!instanced) {
        result = compile(surface, GIRIH_SHADER_COMPUTE,
                         few_buffers ? "#define GIRIH_FEW_BUFFERS\n" : "", &words, &bytes, error);
    }
    if (result == GIRIH_OK) {
        girih_surface_program_desc desc = {
            .set_layout = surface->layout,
            .base = surface->options->base,
            .reach = surface->reach,
        };
        if (few_buffers) {
            desc.bake_few = words;
            desc.bake_few_bytes = bytes;
        } else {
            desc.bake = words;
            desc.bake_bytes = bytes;
        }
        result = girih_surface_program_create(context, &desc, &surface->program, error);
    }
    free(words);
    return result;
}

girih_result girih_own_surface_upload(girih_own_surface *surface, girih_device *device,
                                      const girih_context *context, bool instanced,
                                      girih_error *error) {
    girih_result result = GIRIH_OK;
    if (surface->options->height_map != NULL) {
        result = upload_heights(surface, device, error);
        if (result == GIRIH_OK) {
            result = create_set(surface, device, error);
        }
    }
    return result == GIRIH_OK ? create_program(surface, context, instanced, error) : result;
}

girih_result girih_own_surface_compile_drawing(girih_own_surface *surface, bool has_splits,
                                               girih_error *error) {
    girih_report_progress("compiling the surface");
    free(surface->vertex_words);
    surface->vertex_words = NULL;
    surface->revision++;
    return compile(surface, GIRIH_SHADER_VERTEX, has_splits ? "#define GIRIH_SPLITS\n" : "",
                   &surface->vertex_words, &surface->vertex_bytes, error);
}

girih_result girih_own_surface_compile_again(const girih_own_surface *surface,
                                             const girih_context *context, bool drawn,
                                             bool has_splits, girih_own_surface *fresh,
                                             girih_error *error) {
    *fresh = *surface;
    fresh->program = NULL;
    fresh->vertex_words = NULL;
    girih_result result = create_program(fresh, context, false, error);
    if (result == GIRIH_OK && drawn) {
        result = girih_own_surface_compile_drawing(fresh, has_splits, error);
    }
    if (result != GIRIH_OK) {
        girih_surface_program_destroy(fresh->program);
        fresh->program = NULL;
    }
    return result;
}

void girih_own_surface_replace(girih_own_surface *surface, const girih_own_surface *fresh) {
    girih_surface_program_destroy(surface->program);
    free(surface->vertex_words);
    *surface = *fresh;
}

void girih_own_surface_remove(girih_own_surface *surface, const girih_device *device) {
    girih_surface_program_destroy(surface->program);
    vkDestroySampler(device->device, surface->sampler, NULL);
    vkDestroyDescriptorPool(device->device, surface->pool, NULL);
    vkDestroyDescriptorSetLayout(device->device, surface->layout, NULL);
    girih_device_image_destroy(device, &surface->heights);
    free(surface->vertex_words);
    surface->program = NULL;
    surface->vertex_words = NULL;
    surface->sampler = VK_NULL_HANDLE;
    surface->pool = VK_NULL_HANDLE;
    surface->layout = VK_NULL_HANDLE;
    surface->set = VK_NULL_HANDLE;
}
