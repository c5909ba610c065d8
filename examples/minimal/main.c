// The smallest host of girih: refines an icosahedron and draws it once into minimal.ppm, without a
// window. `make && ./minimal`; it needs girih, a Vulkan 1.1 device and glslangValidator. Where the
// validation layer is installed it watches, and any message of it makes the program fail.
#include <girih/girih.h>
#include <stdio.h>
#include <vulkan/vulkan.h>

#include "baked.spv.h"
#include "fragment.spv.h"
#include "instanced.spv.h"

// clang-format off
// Calls of Vulkan and girih return 0 on success. After a failure the process ends with what it has.
#define TRY(CALL) do { const int result_ = (int)(CALL); if (result_ != 0) { \
    fprintf(stderr, "%.60s: %d %s\n", #CALL, result_, error.message); return 1; } } while (0)
#define INFO(WHAT, NAME, ...) &(Vk##WHAT){.sType = VK_STRUCTURE_TYPE_##NAME, __VA_ARGS__}
#define CREATE(WHAT, NAME, HANDLE, ...) Vk##WHAT HANDLE; TRY(vkCreate##WHAT(device, \
    INFO(WHAT##CreateInfo, NAME##_CREATE_INFO, __VA_ARGS__), NULL, &HANDLE))
#define STATE(WHAT, NAME, ...) .p##WHAT##State = INFO(Pipeline##WHAT##StateCreateInfo, \
    PIPELINE_##NAME##_STATE_CREATE_INFO, __VA_ARGS__)
#define ALLOCATE(WHAT, HANDLE, FLAGS) VkDeviceMemory HANDLE##_memory; \
    vkGet##WHAT##MemoryRequirements(device, HANDLE, &needs); \
    TRY(allocate(FLAGS, &HANDLE##_memory)); \
    TRY(vkBind##WHAT##Memory(device, HANDLE, HANDLE##_memory, 0))
#define FUNCTION(NAME) ((PFN_##NAME)vkGetInstanceProcAddr(instance, #NAME))
#define READABLE (VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)
#define DESTROY(WHAT, HANDLE) vkDestroy##WHAT(device, HANDLE, NULL)
#define SIZE 512

static girih_error error;
static VkInstance instance;
static VkPhysicalDevice physical_device;
static VkDevice device;
static VkMemoryRequirements needs;
static int messages;

static VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
    VkFlags types, const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    (void)severity, (void)types, (void)user, ++messages;
    return fprintf(stderr, "%s\n", data->pMessage), VK_FALSE;
}

static int allocate(VkFlags flags, VkDeviceMemory *memory) {
    VkPhysicalDeviceMemoryProperties have;
    vkGetPhysicalDeviceMemoryProperties(physical_device, &have);
    uint32_t n = 0; // Vulkan promises that there is one
    while (!(needs.memoryTypeBits >> n & 1) || ~have.memoryTypes[n].propertyFlags & flags) ++n;
    return (int)vkAllocateMemory(device, INFO(MemoryAllocateInfo, MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size, .memoryTypeIndex = n), NULL, memory);
}

int main(void) {
    // The host: an instance, watched if possible, and the first device.
    const char *layer = "VK_LAYER_KHRONOS_validation", *extension = "VK_EXT_debug_utils";
    const VkValidationFeatureEnableEXT synchronization[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    VkInstanceCreateInfo info = *INFO(InstanceCreateInfo, INSTANCE_CREATE_INFO,
        .pNext = INFO(ValidationFeaturesEXT, VALIDATION_FEATURES_EXT,
            .enabledValidationFeatureCount = 1, .pEnabledValidationFeatures = synchronization),
        .pApplicationInfo = INFO(ApplicationInfo, APPLICATION_INFO,
            .apiVersion = girih_get_requirements().api_version),
        .enabledLayerCount = 1, .ppEnabledLayerNames = &layer,
        .enabledExtensionCount = 1, .ppEnabledExtensionNames = &extension);
    VkResult instance_made = vkCreateInstance(&info, NULL, &instance);
    const int watched = instance_made != VK_ERROR_LAYER_NOT_PRESENT;
    if (!watched) {
        info.enabledLayerCount = info.enabledExtensionCount = 0, info.pNext = NULL;
        instance_made = vkCreateInstance(&info, NULL, &instance);
    }
    TRY(instance_made);
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    if (watched) TRY(FUNCTION(vkCreateDebugUtilsMessengerEXT)(instance, INFO(
        DebugUtilsMessengerCreateInfoEXT, DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT, .pfnUserCallback = on_message,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT), NULL, &messenger));
    uint32_t count = 1;
    const int none = vkEnumeratePhysicalDevices(instance, &count, &physical_device) < 0 || !count;
    if (none) return fprintf(stderr, "no Vulkan device\n"), 1;
    TRY(girih_check_device(vkGetInstanceProcAddr, instance, physical_device, &error));
    VkQueueFamilyProperties family;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, &family);
    const int useless = (~family.queueFlags & (VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT)) != 0;
    if (useless) return fprintf(stderr, "queue family 0 does not draw and compute\n"), 1;
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(physical_device, &features); // girih uses what it finds enabled
    TRY(vkCreateDevice(physical_device, INFO(DeviceCreateInfo, DEVICE_CREATE_INFO,
        .queueCreateInfoCount = 1, .pQueueCreateInfos = INFO(DeviceQueueCreateInfo,
            DEVICE_QUEUE_CREATE_INFO, .queueFamilyIndex = 0, .queueCount = 1,
            .pQueuePriorities = &(float){1}), .pEnabledFeatures = &features), NULL, &device));
    // girih: a context for the device, a mesh, a scene of it, and a plan of one instance of it.
    girih_context *context; const girih_mesh *mesh; girih_scene *scene; girih_plan *plan;
    const float a = 0.5257311f, b = 0.8506508f, positions[] = {-a,0,b, a,0,b, -a,0,-b, a,0,-b,
        0,b,a, 0,b,-a, 0,-b,a, 0,-b,-a, b,a,0, -b,a,0, b,-a,0, -b,-a,0};
    const uint32_t indices[] = {0,1,4, 0,4,9, 9,4,5, 4,8,5, 4,1,8, 8,1,10, 8,10,3, 5,8,3, 5,3,2,
        2,3,7, 7,3,10, 7,10,6, 7,6,11, 11,6,0, 0,6,1, 6,10,1, 9,11,0, 9,2,11, 9,5,2, 7,11,2};
    const girih_instance turned = {0, {0.8f, 0, 0.6f, 0, 0, 1, 0, 0, -0.6f, 0, 0.8f, 0}};
    const int instanced = features.multiDrawIndirect && features.drawIndirectFirstInstance;
    TRY(girih_context_create(&(girih_context_desc){.get_instance_proc_addr = vkGetInstanceProcAddr,
        .instance = instance, .physical_device = physical_device, .device = device,
        .enabled_features = &features}, &context, &error));
    TRY(girih_mesh_create(&(girih_mesh_desc){.vertex_count = 12, .positions = positions,
        .indices = indices, .index_count = 60}, &mesh, &error)); // makes smooth normals
    const girih_scene_desc meshes = {.meshes = &mesh, .mesh_count = 1};
    TRY(girih_scene_create(context, &meshes, &scene, &error));
    TRY(girih_plan_create(context, &(girih_plan_desc){.scene = scene, .surface = GIRIH_SURFACE_PN,
        .instances = &turned, .instance_count = 1, .max_vertices = 99999, .max_triangles = 99999,
        .mode = instanced ? GIRIH_MODE_INSTANCED : GIRIH_MODE_BAKED}, &plan, &error));
    // The host's own: an image to draw into, a buffer to read it from, a render pass, a pipeline.
    CREATE(Image, IMAGE, image, .imageType = VK_IMAGE_TYPE_2D, .format = VK_FORMAT_R8G8B8A8_UNORM,
        .extent = {SIZE, SIZE, 1}, .mipLevels = 1, .arrayLayers = 1, .samples = 1,
        .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    ALLOCATE(Image, image, 0);
    CREATE(Buffer, BUFFER, buffer, .size = 4 * SIZE * SIZE,
        .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    ALLOCATE(Buffer, buffer, READABLE);
    CREATE(ImageView, IMAGE_VIEW, view, .image = image, .viewType = VK_IMAGE_VIEW_TYPE_2D, .format =
        VK_FORMAT_R8G8B8A8_UNORM, .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1});
    CREATE(RenderPass, RENDER_PASS, pass, .attachmentCount = 1, .pAttachments =
        &(VkAttachmentDescription){.format = VK_FORMAT_R8G8B8A8_UNORM, .samples = 1, .loadOp =
            VK_ATTACHMENT_LOAD_OP_CLEAR, .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
        .subpassCount = 1, .pSubpasses = &(VkSubpassDescription){.colorAttachmentCount = 1,
        .pColorAttachments = &(VkAttachmentReference){0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL}},
        .dependencyCount = 1, .pDependencies = &(VkSubpassDependency){0, VK_SUBPASS_EXTERNAL,
            VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
            VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT, 0});
    CREATE(Framebuffer, FRAMEBUFFER, framebuffer, .renderPass = pass, .attachmentCount = 1,
        .pAttachments = &view, .width = SIZE, .height = SIZE, .layers = 1);
    CREATE(ShaderModule, SHADER_MODULE, vertex, .pCode = instanced ? instanced_spv : baked_spv,
        .codeSize = instanced ? sizeof instanced_spv : sizeof baked_spv);
    CREATE(ShaderModule, SHADER_MODULE, fragment, .pCode = fragment_spv,
        .codeSize = sizeof fragment_spv);
    CREATE(PipelineLayout, PIPELINE_LAYOUT, layout, .setLayoutCount = 0);
    VkPipelineShaderStageCreateInfo stages[2] = {
        *INFO(PipelineShaderStageCreateInfo, PIPELINE_SHADER_STAGE_CREATE_INFO, .pName = "main")};
    stages[1] = stages[0];
    stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT, stages[0].module = vertex;
    stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT, stages[1].module = fragment;
    VkPipeline pipeline; // without back faces nothing here needs a depth buffer
    TRY(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, INFO(GraphicsPipelineCreateInfo,
        GRAPHICS_PIPELINE_CREATE_INFO, .layout = layout, .renderPass = pass, .stageCount = 2,
        .pStages = stages, .pVertexInputState = girih_plan_vertex_input(plan),
        STATE(InputAssembly, INPUT_ASSEMBLY, .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST),
        STATE(Viewport, VIEWPORT, .viewportCount = 1, .scissorCount = 1,
            .pViewports = &(VkViewport){.width = SIZE, .height = SIZE, .maxDepth = 1},
            .pScissors = &(VkRect2D){.extent = {SIZE, SIZE}}),
        STATE(Rasterization, RASTERIZATION, .cullMode = VK_CULL_MODE_BACK_BIT, .lineWidth = 1),
        STATE(Multisample, MULTISAMPLE, .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT),
        STATE(ColorBlend, COLOR_BLEND, .attachmentCount = 1, .pAttachments =
            &(VkPipelineColorBlendAttachmentState){.colorWriteMask = 15})), NULL, &pipeline));

    // One frame: upload, refine, draw, copy.
    VkQueue queue; VkCommandBuffer commands;
    vkGetDeviceQueue(device, 0, 0, &queue);
    CREATE(CommandPool, COMMAND_POOL, pool, .queueFamilyIndex = 0);
    TRY(vkAllocateCommandBuffers(device, INFO(CommandBufferAllocateInfo,
        COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = pool, .commandBufferCount = 1), &commands));
    TRY(vkBeginCommandBuffer(commands, INFO(CommandBufferBeginInfo, COMMAND_BUFFER_BEGIN_INFO, 0)));
    girih_cmd_upload_context(context, commands);
    girih_cmd_upload_scene(scene, commands);
    TRY(girih_cmd_refine(plan, commands, &(girih_frame){.rule = GIRIH_LEVEL_EDGE_PIXELS,
        .length = 12, .pixels_per_unit = SIZE, .near_distance = 1, .eye = {0,0,3}}, NULL, &error));
    vkCmdBeginRenderPass(commands, INFO(RenderPassBeginInfo, RENDER_PASS_BEGIN_INFO,
        .renderPass = pass, .framebuffer = framebuffer, .renderArea = {{0, 0}, {SIZE, SIZE}},
        .clearValueCount = 1, .pClearValues = &(VkClearValue){{{0}}}), VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    girih_cmd_draw(plan, commands, 0, layout, 0);
    vkCmdEndRenderPass(commands);
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1,
        &(VkBufferImageCopy){.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
            .imageExtent = {SIZE, SIZE, 1}});
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
        INFO(MemoryBarrier, MEMORY_BARRIER, .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
            .dstAccessMask = VK_ACCESS_HOST_READ_BIT), 0, NULL, 0, NULL);
    TRY(vkEndCommandBuffer(commands));
    TRY(vkQueueSubmit(queue, 1, INFO(SubmitInfo, SUBMIT_INFO, .commandBufferCount = 1,
        .pCommandBuffers = &commands), VK_NULL_HANDLE));
    TRY(vkQueueWaitIdle(queue));
    const girih_statistics done = girih_plan_statistics(plan);
    printf("%d triangles refined to %d, %s\n", (int)done.input_triangles,
        (int)done.output_triangles, messenger ? "validated" : "not validated");
    unsigned char *pixels;
    TRY(vkMapMemory(device, buffer_memory, 0, VK_WHOLE_SIZE, 0, (void **)&pixels));
    FILE *file = fopen("minimal.ppm", "wb");
    TRY(!file || fprintf(file, "P6 %d %d 255\n", SIZE, SIZE) < 0);
    for (int n = 0; n < SIZE * SIZE; ++n) TRY(fwrite(pixels + 4 * n, 3, 1, file) != 1);
    TRY(fclose(file));
    girih_plan_destroy(plan), girih_scene_destroy(scene);
    girih_mesh_destroy(mesh), girih_context_destroy(context);
    DESTROY(CommandPool, pool), DESTROY(Pipeline, pipeline), DESTROY(PipelineLayout, layout);
    DESTROY(ShaderModule, vertex), DESTROY(ShaderModule, fragment), DESTROY(RenderPass, pass);
    DESTROY(Framebuffer, framebuffer), DESTROY(ImageView, view), DESTROY(Image, image);
    DESTROY(Buffer, buffer), vkFreeMemory(device, image_memory, NULL);
    vkFreeMemory(device, buffer_memory, NULL);
    vkDestroyDevice(device, NULL);
    if (messenger) FUNCTION(vkDestroyDebugUtilsMessengerEXT)(instance, messenger, NULL);
    vkDestroyInstance(instance, NULL);
    return messages != 0;
}
