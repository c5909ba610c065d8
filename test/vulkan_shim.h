// A vkGetInstanceProcAddr between girih and the driver, for tests. It keeps count of every object
// and every host allocation, makes a chosen call or allocation fail, and reports the limits that
// every device has, or better, in place of the device's own.
//
// One state for the whole program, used from one thread at a time. What girih does against Vulkan's
// rules (an object destroyed twice, other callbacks than it was made with, a call beyond the limits
// reported) is a breach: printed, and counted.
#ifndef GIRIH_TEST_VULKAN_SHIM_H
#define GIRIH_TEST_VULKAN_SHIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

// What a context_desc's get_instance_proc_addr is set to. A function that makes or destroys
// something and that this file does not know ends the program: nothing slips through uncounted.
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL shim_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name);

// Forgets everything: no object, no breach, no fault, the device's own limits, pipelines made anew.
void shim_reset(void);

// Pipelines come from pipeline_store.h. They count as made and destroyed all the same, but the
// driver compiles the first of a kind alone, and allocates for none through the callbacks.
void shim_share_pipelines(bool on);

// --- Objects -------------------------------------------------------------------------------------

typedef enum shim_kind {
    SHIM_BUFFER,
    SHIM_DESCRIPTOR_POOL,
    SHIM_DESCRIPTOR_SET_LAYOUT,
    SHIM_MEMORY,
    SHIM_PIPELINE,
    SHIM_PIPELINE_LAYOUT,
    SHIM_SHADER_MODULE,
    SHIM_KINDS,
} shim_kind;

typedef struct shim_counts {
    uint32_t alive[SHIM_KINDS]; // made and not destroyed
    uint32_t made[SHIM_KINDS];
    uint64_t memory_bytes;      // of the device memory that is alive
    uint32_t allocations;       // host memory from shim_callbacks that is not freed
    uint32_t without_callbacks; // objects made with other callbacks than shim_callbacks, or none
    uint32_t without_cache;     // pipelines made without a cache
    uint32_t breaches;
} shim_counts;
shim_counts shim_count(void);

const char *shim_kind_name(shim_kind kind); // for people

// --- Faults --------------------------------------------------------------------------------------

// Of the calls from now on that may return `result` (VK_ERROR_UNKNOWN: every call that can fail),
// number nth, from 0, does so once and does nothing else; what it should have made is not touched
// but for a handle that no object has. SIZE_MAX: none.
void shim_fail_call(size_t nth, VkResult result);
// The call that was made to fail; NULL: none has been reached.
const char *shim_failed_call(void);

// Callbacks that count allocations, check alignment and that what is freed was allocated.
const VkAllocationCallbacks *shim_callbacks(void);
// Allocation number nth, from 0, of shim_callbacks from now on fails once. SIZE_MAX: none.
void shim_fail_allocation(size_t nth);
// The call in whose course it failed; NULL: none has been reached.
const char *shim_failed_allocation(void);

// --- Limits --------------------------------------------------------------------------------------

// Vulkan 1.1's required limits of a device without optional features.
extern const VkPhysicalDeviceLimits shim_required_limits;
#define SHIM_REQUIRED_ALLOCATION (VkDeviceSize)(1u << 30) // maxMemoryAllocationSize

// Devices report Vulkan 1.1, shim_required_limits and no feature but robustBufferAccess, and what
// girih then does beyond these limits is a breach.
void shim_report_required_limits(bool on);

#endif
