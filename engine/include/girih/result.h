// Results and error texts: how every fallible girih function reports.
// Stability: stable
#ifndef GIRIH_RESULT_H
#define GIRIH_RESULT_H

#ifdef __cplusplus
extern "C" {
#endif

// Programs need no define, on Windows neither. There, GIRIH_USE_DLL saves calls into the DLL a jump
// and must not be set for the static library; GIRIH_BUILD_DLL is for the build of the DLL itself.
#if defined(_WIN32) && defined(GIRIH_BUILD_DLL)
#define GIRIH_API __declspec(dllexport)
#elif defined(_WIN32) && defined(GIRIH_USE_DLL)
#define GIRIH_API __declspec(dllimport)
#elif defined(__GNUC__) && !defined(_WIN32)
#define GIRIH_API __attribute__((visibility("default")))
#else
#define GIRIH_API
#endif

typedef enum girih_result {
    GIRIH_OK = 0,
    GIRIH_ERROR_INVALID_ARGUMENT =
        -1, // the call itself is wrong: a null pointer, an index out of range
    GIRIH_ERROR_INVALID_DATA =
        -2, // the data is wrong: a damaged catalogue, a coordinate that is not finite
    GIRIH_ERROR_OUT_OF_MEMORY = -3,
    GIRIH_ERROR_OUT_OF_DEVICE_MEMORY = -4,
    GIRIH_ERROR_TOO_LARGE = -5,   // more than the device's limits or 32-bit counts allow
    GIRIH_ERROR_UNSUPPORTED = -6, // the device or its enabled features cannot do what was asked
    GIRIH_ERROR_DEVICE = -7,      // a Vulkan call failed; the message names it and its VkResult
} girih_result;

// Why a call failed, in one line without a newline: what, where and what to do. The caller owns it,
// typically on the stack; functions that take one accept NULL. Untouched on success.
typedef struct girih_error {
    girih_result result;
    char message[512];
} girih_error;

#ifdef __cplusplus
}
#endif
#endif
