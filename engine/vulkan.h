// The Vulkan functions girih calls, fetched through the host's vkGetInstanceProcAddr: one list, so
// that the table, its filling and its use cannot drift apart.
#ifndef GIRIH_ENGINE_VULKAN_H
#define GIRIH_ENGINE_VULKAN_H

#include <vulkan/vulkan_core.h>

#define GIRIH_INSTANCE_FUNCTIONS(X)                                                                \
    X(GetDeviceProcAddr)                                                                           \
    X(GetPhysicalDeviceMemoryProperties)                                                           \
    X(GetPhysicalDeviceProperties2)

#define GIRIH_DEVICE_FUNCTIONS(X)                                                                  \
    X(AllocateDescriptorSets)                                                                      \
    X(AllocateMemory)                                                                              \
    X(BindBufferMemory)                                                                            \
    X(CmdBindDescriptorSets)                                                                       \
    X(CmdBindIndexBuffer)                                                                          \
    X(CmdBindPipeline)                                                                             \
    X(CmdBindVertexBuffers)                                                                        \
    X(CmdCopyBuffer)                                                                               \
    X(CmdDispatch)                                                                                 \
    X(CmdDispatchIndirect)                                                                         \
    X(CmdDrawIndexedIndirect)                                                                      \
    X(CmdFillBuffer)                                                                               \
    X(CmdPipelineBarrier)                                                                          \
    X(CmdPushConstants)                                                                            \
    X(CmdUpdateBuffer)                                                                             \
    X(CmdWriteTimestamp)                                                                           \
    X(CreateBuffer)                                                                                \
    X(CreateComputePipelines)                                                                      \
    X(CreateDescriptorPool)                                                                        \
    X(CreateDescriptorSetLayout)                                                                   \
    X(CreatePipelineLayout)                                                                        \
    X(CreateShaderModule)                                                                          \
    X(DestroyBuffer)                                                                               \
    X(DestroyDescriptorPool)                                                                       \
    X(DestroyDescriptorSetLayout)                                                                  \
    X(DestroyPipeline)                                                                             \
    X(DestroyPipelineLayout)                                                                       \
    X(DestroyShaderModule)                                                                         \
    X(FreeMemory)                                                                                  \
    X(GetBufferMemoryRequirements)                                                                 \
    X(MapMemory)                                                                                   \
    X(UpdateDescriptorSets)

typedef struct girih_functions {
#define GIRIH_MEMBER(NAME) PFN_vk##NAME NAME;
    GIRIH_INSTANCE_FUNCTIONS(GIRIH_MEMBER)
    GIRIH_DEVICE_FUNCTIONS(GIRIH_MEMBER)
#undef GIRIH_MEMBER
} girih_functions;

#endif
