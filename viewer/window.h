// A window that shows pictures: GLFW's window, and the swapchain in it.
#ifndef GIRIH_VIEWER_WINDOW_H
#define GIRIH_VIEWER_WINDOW_H

#include "device.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

// Pictures in flight: while the device draws one, the next one is recorded.
enum { GIRIH_WINDOW_FRAMES = 2 };

typedef struct girih_window_image {
    VkImage image;
    VkSemaphore drawn; // the picture is in it
} girih_window_image;

typedef struct girih_window_frame {
    VkCommandBuffer commands;
    VkSemaphore acquired; // the window's image is there to be drawn into
    VkFence finished;
    VkQueryPool queries; // GIRIH_WINDOW_QUERIES; VK_NULL_HANDLE where the device has no clock
} girih_window_frame;

// girih's timestamps, then the begin and the end of the picture.
enum { GIRIH_WINDOW_QUERIES = GIRIH_TIMESTAMPS + 2 };

typedef struct girih_window {
    GLFWwindow *handle;
    girih_device *device; // NULL until girih_window_attach
    VkSurfaceKHR surface;
    VkSwapchainKHR swapchain;
    bool is_stale; // the swapchain no longer fits the window
    uint32_t width, height;
    uint32_t image_count, image; // image: the one acquired
    girih_window_image *images;  // [image_count]
    girih_window_frame frames[GIRIH_WINDOW_FRAMES];
    uint32_t frame; // the one to record next
} girih_window;

// Opens a window without Vulkan in it yet. girih_window_close takes *window, whatever the result.
girih_result girih_window_open(girih_window *window, const char *title, uint32_t width,
                               uint32_t height, girih_error *error);

// What the window's device must have.
void girih_window_wishes(girih_device_wishes *wishes);

// Gives the window its device, which must outlive what is in it: girih_window_detach.
girih_result girih_window_attach(girih_window *window, girih_device *device, girih_error *error);
void girih_window_detach(girih_window *window); // the device must be idle
void girih_window_close(girih_window *window);

// Whether there is anything to draw into: not while the window is minimised or 0 x 0.
bool girih_window_is_visible(const girih_window *window);

// Makes the swapchain fit the window: *is_new where it had to be made again, which waits for the
// device, and width and height may be others.
girih_result girih_window_fit(girih_window *window, bool *is_new, girih_error *error);

// Waits until the pictures in flight leave room for one more; window->frame is finished then.
girih_result girih_window_wait(girih_window *window, girih_error *error);

// Acquires an image and begins the commands of window->frame; *commands is VK_NULL_HANDLE where the
// swapchain has to be fitted first.
girih_result girih_window_begin(girih_window *window, VkCommandBuffer *commands,
                                girih_error *error);

// Copies a picture of the window's size, in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, submits the
// commands and shows the image. window->frame is the next one then.
girih_result girih_window_end(girih_window *window, VkImage picture, girih_error *error);

#endif
