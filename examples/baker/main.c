// A host that only computes: refines a box with hard edges, which Curved PN triangles leave flat,
// and a ball that they round, into welded vertices, reads them back and writes baker.obj.
//
// What it asks for is what ray tracing wants: an index list that is closed by position, the source
// triangle of each output triangle, lists padded with degenerate triangles up to a count that is
// known before the GPU has run, and the usage flags for building acceleration structures where the
// device offers them. It checks the law of each and fails where one does not hold.
//
// Any queue that computes will do. Where the validation layer is installed it watches, and any
// message of it makes the program fail.
#include <girih/girih.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

// Leaves the function where a call of Vulkan's, girih's or this program's fails; all return 0 on
// success.
#define TRY(CALL)                                                                                  \
    do {                                                                                           \
        const int result_ = (int)(CALL);                                                           \
        if (result_ != 0) {                                                                        \
            fprintf(stderr, "%.60s: %d %s\n", #CALL, result_, error.message);                      \
            return 1;                                                                              \
        }                                                                                          \
    } while (0)

static girih_error error;

enum { SEGMENTS = 8, ROOM = 20000, LISTS = 4 };

typedef struct baker {
    unsigned messages;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical_device;
    VkPhysicalDeviceProperties properties;
    int traces_rays; // the device offers acceleration structures
    uint32_t family;
    VkQueueFlags queue_flags;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands;
    girih_context *context;
    const girih_mesh *meshes[2];
    girih_scene *scene;
    girih_plan *plan;
    VkBuffer buffer; // everything read back
    VkDeviceMemory memory;
    unsigned char *mapped;
    VkDeviceSize offsets[LISTS + 1]; // of positions, indices, closed indices, sources in it
} baker;

// --- The host
// -------------------------------------------------------------------------------------

static VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                      VkDebugUtilsMessageTypeFlagsEXT types,
                                      const VkDebugUtilsMessengerCallbackDataEXT *data,
                                      void *user) {
    (void)severity;
    (void)types;
    fprintf(stderr, "%s\n", data->pMessage);
    ++((baker *)user)->messages;
    return VK_FALSE;
}

static int create_instance(baker *b) {
    const char *layer = "VK_LAYER_KHRONOS_validation";
    const char *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkLayerProperties layers[64];
    uint32_t count = 64, watched = 0;
    TRY(vkEnumerateInstanceLayerProperties(&count, layers));
    for (uint32_t n = 0; n < count; ++n) {
        watched |= strcmp(layers[n].layerName, layer) == 0;
    }
    const VkValidationFeatureEnableEXT enable =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT validation = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                                .enabledValidationFeatureCount = 1,
                                                .pEnabledValidationFeatures = &enable};
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pApplicationName = "girih baker",
                                           .apiVersion = girih_get_requirements().api_version};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pNext = watched ? &validation : NULL,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = watched,
                                       .ppEnabledLayerNames = &layer,
                                       .enabledExtensionCount = watched,
                                       .ppEnabledExtensionNames = &extension};
    TRY(vkCreateInstance(&info, NULL, &b->instance));
    if (watched) {
        const PFN_vkCreateDebugUtilsMessengerEXT create =
            (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                b->instance, "vkCreateDebugUtilsMessengerEXT");
        const VkDebugUtilsMessengerCreateInfoEXT messenger = {
            .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
            .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                               VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
            .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
            .pfnUserCallback = on_message,
            .pUserData = b};
        TRY(create(b->instance, &messenger, NULL, &b->messenger));
    }
    return 0;
}

// The family that computes and does the least beside it.
static int choose_family(baker *b) {
    VkQueueFamilyProperties families[16];
    uint32_t count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(b->physical_device, &count, families);
    const VkQueueFlags wanted = girih_get_requirements().queue;
    for (uint32_t n = 0; n < count; ++n) {
        const VkQueueFlags flags = families[n].queueFlags;
        const int better = !b->queue_flags || ((b->queue_flags & VK_QUEUE_GRAPHICS_BIT) &&
                                               !(flags & VK_QUEUE_GRAPHICS_BIT));
        if ((flags & wanted) == wanted && better) {
            b->family = n;
            b->queue_flags = flags;
        }
    }
    return b->queue_flags == 0;
}

static const char *const ray_tracing[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                          VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                          VK_KHR_BUFFER_DEVICE_ADDRESS_EXTENSION_NAME,
                                          VK_EXT_DESCRIPTOR_INDEXING_EXTENSION_NAME,
                                          VK_KHR_SPIRV_1_4_EXTENSION_NAME,
                                          VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME};
enum { RAY_TRACING = sizeof ray_tracing / sizeof *ray_tracing };

static int find_ray_tracing(baker *b) {
    uint32_t count = 0;
    TRY(vkEnumerateDeviceExtensionProperties(b->physical_device, NULL, &count, NULL));
    VkExtensionProperties *there = calloc(count + 1, sizeof *there);
    if (!there ||
        vkEnumerateDeviceExtensionProperties(b->physical_device, NULL, &count, there) != 0) {
        free(there);
        return 1;
    }
    int found = 0;
    for (int n = 0; n < RAY_TRACING; ++n) {
        for (uint32_t m = 0; m < count; ++m) {
            found += strcmp(there[m].extensionName, ray_tracing[n]) == 0;
        }
    }
    free(there);
    b->traces_rays = found == RAY_TRACING;
    return 0;
}

static int create_device(baker *b) {
    uint32_t count = 1;
    if (vkEnumeratePhysicalDevices(b->instance, &count, &b->physical_device) < 0 || count == 0) {
        fprintf(stderr, "no Vulkan device\n");
        return 1;
    }
    TRY(girih_check_device(vkGetInstanceProcAddr, b->instance, b->physical_device, &error));
    vkGetPhysicalDeviceProperties(b->physical_device, &b->properties);
    TRY(choose_family(b));
    TRY(find_ray_tracing(b));
    VkPhysicalDeviceBufferDeviceAddressFeatures addresses = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
        .bufferDeviceAddress = VK_TRUE};
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structures = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
        .pNext = &addresses,
        .accelerationStructure = VK_TRUE};
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = b->family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = b->traces_rays ? &structures : NULL,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .enabledExtensionCount = b->traces_rays ? RAY_TRACING : 0,
                                     .ppEnabledExtensionNames = ray_tracing};
    TRY(vkCreateDevice(b->physical_device, &info, NULL, &b->device));
    vkGetDeviceQueue(b->device, b->family, 0, &b->queue);
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = b->family};
    TRY(vkCreateCommandPool(b->device, &pool, NULL, &b->pool));
    const VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = b->pool,
        .commandBufferCount = 1};
    TRY(vkAllocateCommandBuffers(b->device, &commands, &b->commands));
    return 0;
}

// --- girih
// ----------------------------------------------------------------------------------------

// A box with hard edges: where its sides meet, each has vertices and normals of its own.
static int create_box(const girih_mesh **mesh) {
    float positions[24][3], normals[24][3] = {{0}};
    uint32_t indices[6][6];
    for (uint32_t side = 0; side < 6; ++side) {
        const uint32_t axis = side / 2;
        const float outwards = side % 2 ? 1.0f : -1.0f;
        for (uint32_t corner = 0; corner < 4; ++corner) {
            const uint32_t n = 4 * side + corner;
            // Counterclockwise as seen from outside.
            const float along = corner == 1 || corner == 2 ? 1.0f : -1.0f;
            positions[n][axis] = outwards;
            positions[n][(axis + 1) % 3] = along * outwards;
            positions[n][(axis + 2) % 3] = corner >= 2 ? 1.0f : -1.0f;
            normals[n][axis] = outwards;
        }
        const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
        for (uint32_t n = 0; n < 6; ++n) {
            indices[side][n] = 4 * side + order[n];
        }
    }
    const girih_mesh_desc desc = {.name = "box",
                                  .vertex_count = 24,
                                  .positions = positions[0],
                                  .normals = normals[0],
                                  .indices = indices[0],
                                  .index_count = 36};
    TRY(girih_mesh_create(&desc, mesh, &error));
    return 0;
}

// An octahedron without normals: smooth ones are made.
static int create_ball(const girih_mesh **mesh) {
    const float positions[] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    const uint32_t indices[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    const girih_mesh_desc desc = {.name = "ball",
                                  .vertex_count = 6,
                                  .positions = positions,
                                  .indices = indices,
                                  .index_count = 24};
    TRY(girih_mesh_create(&desc, mesh, &error));
    return 0;
}

static int create_girih(baker *b) {
    const girih_context_desc context = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                                        .instance = b->instance,
                                        .physical_device = b->physical_device,
                                        .device = b->device,
                                        .queue_flags = b->queue_flags};
    TRY(girih_context_create(&context, &b->context, &error));
    TRY(create_box(&b->meshes[0]));
    TRY(create_ball(&b->meshes[1]));
    const girih_scene_desc scene = {.meshes = b->meshes, .mesh_count = 2};
    TRY(girih_scene_create(b->context, &scene, &b->scene, &error));
    const girih_instance instances[2] = {
        {.mesh = 0, .transform = {1, 0, 0, -1.5f, 0, 1, 0, 0, 0, 0, 1, 0}},
        {.mesh = 1, .transform = {1, 0, 0, 1.5f, 0, 1, 0, 0, 0, 0, 1, 0}}};
    const VkBufferUsageFlags traced =
        b->traces_rays ? VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                             VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT
                       : 0;
    const girih_plan_desc plan = {.scene = b->scene,
                                  .instances = instances,
                                  .instance_count = 2,
                                  .surface = GIRIH_SURFACE_PN,
                                  .mode = GIRIH_MODE_WELDED,
                                  .outputs = GIRIH_OUTPUT_CLOSED_INDICES | GIRIH_OUTPUT_SOURCES |
                                             GIRIH_OUTPUT_PADDED | GIRIH_OUTPUT_NO_DRAW,
                                  .max_vertices = ROOM,
                                  .max_triangles = ROOM,
                                  .vertex_usage = traced,
                                  .index_usage = traced};
    TRY(girih_plan_create(b->context, &plan, &b->plan, &error));
    return 0;
}

// --- Reading back
// ---------------------------------------------------------------------------------

static int create_readback(baker *b, const VkDeviceSize sizes[LISTS]) {
    for (int n = 0; n < LISTS; ++n) {
        b->offsets[n + 1] = b->offsets[n] + sizes[n];
    }
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = b->offsets[LISTS],
                                     .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    TRY(vkCreateBuffer(b->device, &info, NULL, &b->buffer));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(b->device, b->buffer, &needs);
    VkPhysicalDeviceMemoryProperties there;
    vkGetPhysicalDeviceMemoryProperties(b->physical_device, &there);
    const VkMemoryPropertyFlags flags =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = 0; // Vulkan promises that there is one for buffers
    while (!(needs.memoryTypeBits >> type & 1) ||
           (there.memoryTypes[type].propertyFlags & flags) != flags) {
        ++type;
    }
    const VkMemoryAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                             .allocationSize = needs.size,
                                             .memoryTypeIndex = type};
    TRY(vkAllocateMemory(b->device, &allocation, NULL, &b->memory));
    TRY(vkBindBufferMemory(b->device, b->buffer, b->memory, 0));
    TRY(vkMapMemory(b->device, b->memory, 0, VK_WHOLE_SIZE, 0, (void **)&b->mapped));
    return 0;
}

// Everything in one submission: upload, refine, copy. girih_cmd_refine ends with its writes visible
// to transfer reads, so the copies need no barrier.
static int bake(baker *b) {
    const girih_plan_buffers lists = girih_plan_get_buffers(b->plan);
    const girih_buffer_range ranges[LISTS] = {lists.positions, lists.indices, lists.closed_indices,
                                              lists.sources};
    const VkDeviceSize sizes[LISTS] = {12ull * lists.max_vertices, 12ull * lists.max_triangles,
                                       12ull * lists.max_triangles, 8ull * lists.max_triangles};
    TRY(create_readback(b, sizes));
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    TRY(vkBeginCommandBuffer(b->commands, &begin));
    girih_cmd_upload_context(b->context, b->commands);
    girih_cmd_upload_scene(b->scene, b->commands);
    // Every edge its own number of segments: closed all the same.
    const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM, .segments = SEGMENTS, .seed = 7};
    TRY(girih_cmd_refine(b->plan, b->commands, &frame, NULL, &error));
    for (int n = 0; n < LISTS; ++n) {
        const VkBufferCopy copy = {ranges[n].offset, b->offsets[n], sizes[n]};
        vkCmdCopyBuffer(b->commands, ranges[n].buffer, b->buffer, 1, &copy);
    }
    const VkMemoryBarrier to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                     .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(b->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0,
                         1, &to_host, 0, NULL, 0, NULL);
    TRY(vkEndCommandBuffer(b->commands));
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                 .commandBufferCount = 1,
                                 .pCommandBuffers = &b->commands};
    TRY(vkQueueSubmit(b->queue, 1, &submit, VK_NULL_HANDLE));
    TRY(vkQueueWaitIdle(b->queue));
    return 0;
}

// --- Laws
// -----------------------------------------------------------------------------------------

typedef struct edge {
    uint32_t from, to;
} edge;

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    return x->from != y->from ? (x->from < y->from ? -1 : 1) : (x->to > y->to) - (x->to < y->to);
}

// Every directed edge is there once, and so is its reverse.
static int check_closed(const uint32_t *indices, size_t triangles) {
    edge *edges = calloc(3 * triangles + 1, sizeof *edges);
    if (!edges) {
        return 1;
    }
    for (size_t n = 0; n < 3 * triangles; ++n) {
        edges[n] = (edge){indices[n], indices[n % 3 == 2 ? n - 2 : n + 1]};
    }
    qsort(edges, 3 * triangles, sizeof *edges, compare_edges);
    size_t wrong = 0;
    for (size_t n = 0; n < 3 * triangles; ++n) {
        const edge back = {edges[n].to, edges[n].from};
        wrong += n > 0 && compare_edges(&edges[n - 1], &edges[n]) == 0;
        wrong += !bsearch(&back, edges, 3 * triangles, sizeof *edges, compare_edges);
    }
    free(edges);
    if (wrong) {
        fprintf(stderr, "%zu edges are open, doubled or flipped\n", wrong);
    }
    return wrong != 0;
}

static int check(const baker *b, const girih_statistics *s) {
    const uint32_t room = girih_plan_get_buffers(b->plan).max_triangles;
    const uint32_t *indices = (const void *)(b->mapped + b->offsets[1]);
    const uint32_t *closed = (const void *)(b->mapped + b->offsets[2]);
    const uint32_t *sources = (const void *)(b->mapped + b->offsets[3]);
    const float *positions = (const void *)b->mapped;
    const size_t triangles = (size_t)s->output_triangles;
    TRY(s->overflow);
    TRY(check_closed(closed, triangles));
    for (size_t n = 0; n < 3 * triangles; ++n) {
        // Both lists name the same places; the welded one keeps the box's sides apart.
        const int apart = indices[n] >= s->output_vertices || closed[n] >= s->output_vertices ||
                          memcmp(positions + 3 * indices[n], positions + 3 * closed[n], 12) != 0;
        TRY(apart);
    }
    for (size_t n = 0; n < triangles; ++n) {
        const int no_source =
            sources[2 * n] > 1 || sources[2 * n + 1] >= b->meshes[sources[2 * n]]->triangle_count;
        TRY(no_source);
    }
    for (size_t n = 3 * triangles; n < 3 * (size_t)room; ++n) {
        const int not_padded = indices[n] != 0 || closed[n] != 0;
        TRY(not_padded);
    }
    printf("closed: %zu triangles over %llu welded vertices; %zu degenerate ones fill the room of "
           "%u\n",
           triangles, (unsigned long long)s->output_vertices, room - triangles, room);
    return 0;
}

static int write_obj(const baker *b, const girih_statistics *s) {
    const float *positions = (const void *)b->mapped;
    const uint32_t *closed = (const void *)(b->mapped + b->offsets[2]);
    FILE *file = fopen("baker.obj", "w");
    int failed = !file;
    for (uint64_t n = 0; n < s->output_vertices && !failed; ++n) {
        const float *p = positions + 3 * n;
        failed = fprintf(file, "v %.9g %.9g %.9g\n", (double)p[0], (double)p[1], (double)p[2]) < 0;
    }
    for (uint64_t n = 0; n < s->output_triangles && !failed; ++n) {
        const uint32_t *t = closed + 3 * n;
        failed = fprintf(file, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1) < 0;
    }
    if (file) {
        failed = fclose(file) != 0 || failed;
    }
    if (failed) {
        perror("baker.obj");
    }
    return failed;
}

static int run(baker *b) {
    TRY(create_instance(b));
    TRY(create_device(b));
    TRY(create_girih(b));
    TRY(bake(b));
    const girih_statistics statistics = girih_plan_statistics(b->plan);
    printf("%s, queue family %u%s, %s, %s\n", b->properties.deviceName, b->family,
           b->queue_flags & VK_QUEUE_GRAPHICS_BIT ? "" : " without graphics",
           b->traces_rays ? "ready to build acceleration structures" : "no acceleration structures",
           b->messenger ? "validated" : "not validated");
    TRY(check(b, &statistics));
    return write_obj(b, &statistics);
}

static void destroy(baker *b) {
    if (b->device) {
        vkDeviceWaitIdle(b->device);
        girih_plan_destroy(b->plan);
        girih_scene_destroy(b->scene);
        girih_mesh_destroy(b->meshes[0]);
        girih_mesh_destroy(b->meshes[1]);
        girih_context_destroy(b->context);
        vkDestroyBuffer(b->device, b->buffer, NULL);
        vkFreeMemory(b->device, b->memory, NULL);
        vkDestroyCommandPool(b->device, b->pool, NULL);
        vkDestroyDevice(b->device, NULL);
    }
    if (b->messenger) {
        const PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                b->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy_messenger(b->instance, b->messenger, NULL);
    }
    if (b->instance) {
        vkDestroyInstance(b->instance, NULL);
    }
}

int main(void) {
    static baker b;
    const int failed = run(&b);
    destroy(&b);
    if (b.messages) {
        fprintf(stderr, "%u messages of the validation layer\n", b.messages);
    }
    return failed || b.messages;
}
