// Compute pipelines shared by all contexts of a device, for tests that open many: what one context
// has made, the next is given instead of having the driver compile it again. Only where all that
// makes a pipeline is the same, word for word: the module, its constants, the layout's definition.
//
// The driver's allocations for a shared pipeline do not go through the caller's callbacks, and it
// is destroyed when the store is closed, not by the context; tests of those two do without.
// Used from one thread at a time.
#ifndef GIRIH_TEST_PIPELINE_STORE_H
#define GIRIH_TEST_PIPELINE_STORE_H

#include <vulkan/vulkan.h>

// A context_desc's get_instance_proc_addr: Vulkan's own but for the functions below.
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL store_get_instance_proc_addr(VkInstance instance,
                                                                      const char *name);

// Destroys the device's pipelines. Returns how many of them were made and not destroyed by their
// makers, and prints the number where it is not 0.
unsigned store_close(VkDevice device);

// --- For a get_instance_proc_addr of another kind -------------------------------------------------
// Objects that these have not made are Vulkan's own, and are passed on.

VKAPI_ATTR VkResult VKAPI_CALL store_create_descriptor_set_layout(
    VkDevice device, const VkDescriptorSetLayoutCreateInfo *info,
    const VkAllocationCallbacks *allocator, VkDescriptorSetLayout *layout);
VKAPI_ATTR VkResult VKAPI_CALL store_create_pipeline_layout(VkDevice device,
                                                            const VkPipelineLayoutCreateInfo *info,
                                                            const VkAllocationCallbacks *allocator,
                                                            VkPipelineLayout *layout);
VKAPI_ATTR VkResult VKAPI_CALL store_create_shader_module(VkDevice device,
                                                          const VkShaderModuleCreateInfo *info,
                                                          const VkAllocationCallbacks *allocator,
                                                          VkShaderModule *module);
VKAPI_ATTR VkResult VKAPI_CALL
store_create_compute_pipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                               const VkComputePipelineCreateInfo *infos,
                               const VkAllocationCallbacks *allocator, VkPipeline *pipelines);
VKAPI_ATTR void VKAPI_CALL store_destroy_descriptor_set_layout(
    VkDevice device, VkDescriptorSetLayout layout, const VkAllocationCallbacks *allocator);
VKAPI_ATTR void VKAPI_CALL store_destroy_pipeline_layout(VkDevice device, VkPipelineLayout layout,
                                                         const VkAllocationCallbacks *allocator);
VKAPI_ATTR void VKAPI_CALL store_destroy_shader_module(VkDevice device, VkShaderModule module,
                                                       const VkAllocationCallbacks *allocator);
VKAPI_ATTR void VKAPI_CALL store_destroy_pipeline(VkDevice device, VkPipeline pipeline,
                                                  const VkAllocationCallbacks *allocator);

#endif
