// girih view: a refined model in a window.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "error.h"
#include "output_file.h"
#include "png.h"
#include "shown_model.h"
#include "view_text.h"

typedef struct view_options {
    const char *model, *output;
    girih_level_options levels;
    girih_surface_options surface;
    girih_look_options look;
    girih_camera_options camera;
    girih_device_options device;
    girih_pose_options pose;
    bool plays;
    uint32_t frames; // 0: until it is closed
    bool json;
} view_options;

// --- Options ---

enum { KEY_FRAMES = GIRIH_KEY_OWN, KEY_PLAY, KEY_JSON };

static const struct argp_option own_options[] = {
    {"output", 'o', "FILE", 0, "Write the last picture as a PNG at the end", 0},
    {"play", KEY_PLAY, NULL, 0, "Play the animation from the start on, or from --time", 0},
    {"frames", KEY_FRAMES, "N", 0, "End after N pictures", 0},
    {"json", KEY_JSON, NULL, 0, "At the end, print one JSON object with counts and times", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static void check_options(struct argp_state *state, const view_options *options) {
    if (options->output != NULL) {
        girih_option_output(state, options->output, options->json);
    }
    if (options->device.cpu) {
        argp_error(state, "--cpu: a window's frames are refined on the device; girih render and "
                          "girih refine take it");
    }
    if (options->camera.cylindrical) {
        argp_error(state, "--projection cylinder: a window has a camera to turn, girih render "
                          "draws panoramas");
    }
}

static error_t parse(int key, char *argument, struct argp_state *state) {
    view_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->levels;
        state->child_inputs[1] = &options->surface;
        state->child_inputs[2] = &options->camera;
        state->child_inputs[3] = &options->look;
        state->child_inputs[4] = &options->device;
        state->child_inputs[5] = &options->pose;
        return 0;
    case 'o':
        options->output = argument;
        return 0;
    case KEY_FRAMES:
        options->frames = girih_option_count(state, "frames", argument, 1, UINT32_MAX);
        return 0;
    case KEY_PLAY:
        options->plays = true;
        return 0;
    case KEY_JSON:
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        girih_option_model(state, &options->model, argument);
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no MODEL");
        return 0;
    case ARGP_KEY_END:
        check_options(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&girih_level_argp, 0, NULL, 1},
                                             {&girih_surface_argp, 0, NULL, 2},
                                             {&girih_camera_argp, 0, NULL, 3},
                                             {&girih_look_argp, 0, NULL, 4},
                                             {&girih_device_argp, 0, NULL, 5},
                                             {&girih_pose_argp, 0, NULL, 6},
                                             {NULL, 0, NULL, 0}};

static const struct argp view_argp = {
    own_options,
    parse,
    "MODEL",
    "Shows MODEL (.gltf or .glb) in a window, its triangles refined on the graphics device for "
    "every picture. H shows the keys. A surface's file is compiled again when it changes; a model "
    "or a .glsl file dropped on the window takes the place of the one that is there."
    "\vExamples:\n"
    "  girih view teapot.glb\n"
    "  girih view city.gltf --edge-pixels 4 --shade levels --wireframe\n"
    "  girih view teapot.glb --surface waves.glsl   # edit waves.glsl and watch\n"
    "  girih view teapot.glb --frames 200 --json    # how fast is it here?\n",
    children,
    NULL,
    NULL};

// --- A session ---

typedef struct session {
    const view_options *options;
    girih_camera_options camera; // to begin with, and to come back to
    const char *file;            // that a failure is about; NULL: none, or the message names it
    girih_catalogue_source catalogue;
    girih_device device;
    bool is_device_open;
    girih_window window;
    girih_view_controls controls;
    girih_shown_model *shown;
    girih_view view, frozen_view; // frozen_view: what levels and culling are of while frozen
    bool is_frozen;
    struct timespec surface_time; // of the file, when it was compiled

    girih_overlay overlay;
    uint64_t overlay_number, slot_overlay[GIRIH_WINDOW_FRAMES];
    double next_text;
    char message[sizeof((girih_error *)NULL)->message];
    bool is_failure;
    double message_end; // 0: it stays
    uint32_t drawn, counted;
    double start, counting_since, frames_per_second;
    girih_drawing last; // what the last picture shows
    uint32_t animation; // that the model is in a pose of
    double time, last_loop;
} session;

static void say(session *s, bool is_failure, const char *text) {
    snprintf(s->message, sizeof s->message, "%s", text);
    s->is_failure = is_failure;
    s->message_end = is_failure ? 0.0 : girih_seconds() + 4.0;
    s->controls.has_news = true;
}

static girih_result start_camera(session *s, girih_error *error) {
    const girih_shown_model *shown = s->shown;
    int width, height;
    glfwGetFramebufferSize(s->window.handle, &width, &height);
    girih_camera camera;
    girih_result result = girih_camera_create(
        &camera, &s->camera, &shown->model, shown->instances, shown->instance_count,
        width > 0 ? (uint32_t)width : 1, height > 0 ? (uint32_t)height : 1, error);
    if (result == GIRIH_OK) {
        girih_orbit_start(&s->controls.orbit, &camera, s->camera.view_up, shown->low, shown->high);
        s->controls.edge_length = s->controls.orbit.radius / 20.0;
    }
    return result;
}

static struct timespec time_of(const char *path) {
    struct stat about;
    return path != NULL && stat(path, &about) == 0 ? about.st_mtim : (struct timespec){0};
}

static girih_mode choose_mode(const session *s) {
    const girih_plan_desc desc = {
        .scene = s->shown->scene,
        .instances = s->shown->instances,
        .instance_count = s->shown->instance_count,
        .surface = s->controls.surface,
    };
    switch (s->options->look.mode) {
    case GIRIH_MODE_OPTION_INSTANCED:
        return GIRIH_MODE_INSTANCED;
    case GIRIH_MODE_OPTION_BAKED:
        return GIRIH_MODE_BAKED;
    case GIRIH_MODE_OPTION_WELDED:
        return GIRIH_MODE_WELDED;
    default:
        return girih_choose_mode(s->shown->context, &desc, 0);
    }
}

static void start_controls(session *s) {
    const view_options *options = s->options;
    const VkPhysicalDeviceFeatures *features = &s->device.features;
    girih_view_controls *controls = &s->controls;
    controls->can_instance = features->multiDrawIndirect && features->drawIndirectFirstInstance;
    controls->can_draw_sizes = features->geometryShader;
    controls->can_draw_lines = features->geometryShader || features->fillModeNonSolid;
    controls->surface = options->surface.surface;
    controls->levels = options->levels;
    controls->look = options->look;
    if (!controls->look.has_back_face_color) {
        memcpy(controls->look.back_face_color, (const float[3]){1.0f, 0.0f, 1.0f},
               sizeof controls->look.back_face_color);
    }
    controls->shows_statistics = !options->look.no_legend;
    controls->mode = choose_mode(s);
}

static girih_result open_device(session *s, girih_error *error) {
    girih_device_wishes wishes = {
        .graphics = true,
        .features = {.geometryShader = VK_TRUE, .fillModeNonSolid = VK_TRUE, .wideLines = VK_TRUE}};
    girih_window_wishes(&wishes);
    girih_result result = girih_device_open(&s->device, &s->options->device, &wishes, error);
    if (result != GIRIH_OK) {
        return result;
    }
    s->is_device_open = true;
    result = girih_look_check_device(&s->options->look, &s->device, error);
    return result == GIRIH_OK ? girih_window_attach(&s->window, &s->device, error) : result;
}

static girih_result open_model(session *s, const char *path, const girih_pose_options *pose,
                               girih_shown_model **shown, girih_error *error) {
    const girih_shown_desc desc = {
        .device = &s->device,
        .catalogue = s->catalogue.catalogue,
        .path = path,
        .surface = s->shown != NULL ? &s->shown->surface : &s->options->surface,
        .pose = pose,
        .samples = s->options->look.samples,
    };
    return girih_shown_open(&desc, shown, error);
}

static void take_model(session *s, girih_shown_model *shown) {
    s->shown = shown;
    s->controls.has_own = girih_shown_has_own(shown);
    s->controls.has_news = true;
    s->controls.animation_count = shown->model.contents->animation_count;
    s->controls.animation = 0;
    s->controls.is_playing = false;
    s->animation = 0;
    s->time = 0.0;
    s->surface_time = time_of(shown->surface.file);
    const char *name = strrchr(shown->path, '/');
    char title[300];
    snprintf(title, sizeof title, "%.250s - girih", name != NULL ? name + 1 : shown->path);
    glfwSetWindowTitle(s->window.handle, title);
}

// --- Files that come while it runs ---

static girih_result resize(session *s, girih_error *error) {
    memset(s->slot_overlay, 0, sizeof s->slot_overlay);
    s->controls.has_news = true;
    return girih_renderer_resize(s->shown->renderer, s->window.width, s->window.height, error);
}

static girih_result drop_model(session *s, const char *path, girih_error *error) {
    girih_shown_model *shown = NULL;
    girih_error reason = {.result = GIRIH_OK};
    // Frames in flight may still use what the model before has on the device.
    VkResult idle = vkDeviceWaitIdle(s->device.device);
    if (idle != VK_SUCCESS) {
        return girih_vulkan_failure(error, "vkDeviceWaitIdle", idle);
    }
    if (open_model(s, path, NULL, &shown, &reason) != GIRIH_OK) {
        girih_report_failure(NULL, reason.message);
        say(s, true, reason.message);
        return GIRIH_OK;
    }
    // A dropped surface belongs to the model before.
    char *file = s->shown->surface_file;
    s->shown->surface_file = NULL;
    girih_shown_close(s->shown);
    shown->surface_file = file;
    take_model(s, shown);
    // Neither a camera of the file before nor what was seen of it has to do with this one.
    s->camera.has_index = false;
    s->controls.is_frozen = false;
    say(s, false, path);
    s->last = (girih_drawing){0};
    // Without a swapchain the size is not known yet.
    girih_result result = s->window.swapchain != VK_NULL_HANDLE ? resize(s, error) : GIRIH_OK;
    return result == GIRIH_OK ? start_camera(s, error) : result;
}

static void compile_surface(session *s, const char *file) {
    girih_error reason = {.result = GIRIH_OK};
    if (girih_shown_take_surface(s->shown, file, &reason) != GIRIH_OK) {
        girih_report_failure(NULL, reason.message);
        say(s, true, reason.message);
        return;
    }
    char text[300];
    snprintf(text, sizeof text, "compiled %.280s", s->shown->surface.file);
    fprintf(stderr, "girih: %s\n", text);
    say(s, false, text);
    s->last = (girih_drawing){0}; // its plan may be gone
    s->controls.has_own = true;
    if (file != NULL) {
        s->controls.surface = GIRIH_SURFACE_OWN;
    }
}

static bool is_glsl(const char *path) {
    const char *ending = strrchr(path, '.');
    return ending != NULL && strcmp(ending, ".glsl") == 0;
}

static girih_result take_dropped(session *s, girih_error *error) {
    char *path = s->controls.dropped;
    s->controls.dropped = NULL;
    girih_result result = GIRIH_OK;
    if (is_glsl(path)) {
        compile_surface(s, path);
        s->surface_time = time_of(s->shown->surface.file);
    } else {
        result = drop_model(s, path, error);
    }
    free(path);
    return result;
}

// A file that is gone for now, as an editor renames, is left to come back.
static void watch_surface(session *s) {
    if (s->shown->surface.file == NULL) {
        return;
    }
    struct timespec time = time_of(s->shown->surface.file);
    if (time.tv_sec != 0 &&
        (time.tv_sec != s->surface_time.tv_sec || time.tv_nsec != s->surface_time.tv_nsec)) {
        s->surface_time = time;
        compile_surface(s, NULL);
    }
}

// --- Animation ---

static const girih_gltf_animation *find_animation(const session *s) {
    const girih_gltf_contents *contents = s->shown->model.contents;
    return contents->animation_count > 0 ? &contents->animations[s->controls.animation] : NULL;
}

// Where --animation and --time begin; the model has been loaded in that pose.
static void start_animation(session *s) {
    const girih_pose_options *pose = &s->options->pose;
    const girih_gltf_contents *contents = s->shown->model.contents;
    if (pose->animation != NULL) {
        s->controls.animation =
            (uint32_t)(girih_pose_find_animation(contents, pose->animation) - contents->animations);
    }
    s->animation = s->controls.animation;
    s->time = (double)pose->time;
    s->controls.is_playing = s->options->plays && contents->animation_count > 0;
}

// Time goes on while it plays, from the end back to the beginning.
static girih_result animate(session *s, girih_error *error) {
    const girih_gltf_animation *animation = find_animation(s);
    double now = girih_seconds();
    double passed = now - s->last_loop;
    bool is_other = s->animation != s->controls.animation;
    s->last_loop = now;
    if (animation == NULL || (!s->controls.is_playing && !is_other)) {
        return GIRIH_OK;
    }
    s->animation = s->controls.animation;
    s->time = is_other ? 0.0 : s->time + passed;
    if (s->time > (double)animation->end) {
        s->time = animation->end > 0.0f ? fmod(s->time, (double)animation->end) : 0.0;
    }
    girih_result result = girih_shown_move(s->shown, animation, s->time, error);
    girih_orbit_surround(&s->controls.orbit, s->shown->low, s->shown->high);
    return result;
}

// --- Pictures ---

static girih_picture describe_picture(const session *s, const girih_drawing *drawing) {
    girih_picture picture = {.view = &s->view, .drawings = drawing, .drawing_count = 1};
    memcpy(picture.box[0], s->shown->low, sizeof picture.box[0]);
    memcpy(picture.box[1], s->shown->high, sizeof picture.box[1]);
    girih_look_apply(&s->controls.look, &picture);
    return picture;
}

static girih_result fill_overlay(session *s, uint32_t slot, girih_error *error) {
    double now = girih_seconds();
    if (s->message_end != 0.0 && now > s->message_end) {
        s->message[0] = '\0';
        s->message_end = 0.0;
        s->controls.has_news = true;
    }
    const girih_shown_model *shown = s->shown;
    const girih_gltf_animation *animation = find_animation(s);
    girih_result result = GIRIH_OK;
    if (s->controls.has_news || now >= s->next_text) {
        const girih_view_status status = {
            .file = shown->path,
            .mode = shown->slots[slot].refinement.mode,
            .statistics = &shown->latest.statistics,
            .times = &shown->latest.times,
            .is_unchanged = shown->is_unchanged,
            .frames_per_second = s->frames_per_second,
            .catalogue = s->catalogue.catalogue,
            .plan = shown->slots[slot].is_finished ? shown->slots[slot].refinement.plan : NULL,
            .animation = animation != NULL ? animation->name : NULL,
            .animation_time = s->time,
            .message = s->message[0] != '\0' ? s->message : shown->notice,
            .is_failure = s->message[0] != '\0' ? s->is_failure : true,
        };
        result = girih_view_text(&s->overlay, &s->controls, &status, s->window.width,
                                 s->window.height, error);
        s->overlay_number++;
        s->next_text = now + 0.25;
        s->controls.has_news = false;
    }
    if (result == GIRIH_OK && s->slot_overlay[slot] != s->overlay_number) {
        result = girih_renderer_set_overlay(s->shown->renderer, slot, &s->overlay, error);
        s->slot_overlay[slot] = s->overlay_number;
    }
    return result;
}

// Draws the last picture once more, waiting for it, without a message of something done.
static girih_result save_picture(session *s, const char *path, girih_error *error) {
    uint32_t width = s->window.width;
    uint32_t height = s->window.height;
    if (s->last.plan == NULL) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "%.200s: there has been no picture to write", path);
    }
    uint8_t *rgba = malloc((size_t)width * height * 4);
    if (rgba == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_picture picture = describe_picture(s, &s->last);
    double milliseconds;
    char message[sizeof error->message];
    girih_result result = GIRIH_OK;
    VkResult idle = vkDeviceWaitIdle(s->device.device);
    if (idle != VK_SUCCESS) {
        result = girih_vulkan_failure(error, "vkDeviceWaitIdle", idle);
    } else {
        s->message[0] = s->is_failure ? s->message[0] : '\0';
        s->controls.has_news = true;
        result = fill_overlay(s, 0, error);
    }
    if (result == GIRIH_OK) {
        result = girih_renderer_draw(s->shown->renderer, &picture, rgba, &milliseconds, error);
    }
    if (result == GIRIH_OK &&
        !girih_png_write(path, width, height, rgba, message, sizeof message)) {
        result = girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%.480s", message);
    }
    free(rgba);
    return result;
}

// The model's name and the first number that no file has yet, in the current folder.
static void name_picture(const session *s, char *path, size_t size) {
    const char *name = strrchr(s->shown->path, '/');
    name = name != NULL ? name + 1 : s->shown->path;
    const char *ending = strrchr(name, '.');
    int length = ending != NULL && ending != name ? (int)(ending - name) : (int)strlen(name);
    struct stat about;
    for (uint32_t n = 1; n < 10000; n++) {
        snprintf(path, size, "%.*s-%03u.png", length > 200 ? 200 : length, name, n);
        if (stat(path, &about) != 0) {
            return;
        }
    }
}

static void take_picture(session *s) {
    char path[300], text[340];
    girih_error reason = {.result = GIRIH_OK};
    name_picture(s, path, sizeof path);
    if (save_picture(s, path, &reason) != GIRIH_OK) {
        girih_report_failure(NULL, reason.message);
        say(s, true, reason.message);
        return;
    }
    snprintf(text, sizeof text, "wrote %s", path);
    fprintf(stderr, "girih: %s\n", text);
    say(s, false, text);
}

static girih_frame make_frame(session *s) {
    const girih_view_controls *controls = &s->controls;
    if (controls->is_frozen && !s->is_frozen) {
        s->frozen_view = s->view;
    }
    s->is_frozen = controls->is_frozen;
    girih_frame frame =
        girih_frame_from_options(&controls->levels, s->is_frozen ? &s->frozen_view : &s->view);
    frame.surface_set = controls->surface == GIRIH_SURFACE_OWN ? s->shown->own.set : VK_NULL_HANDLE;
    frame.cull_frustum = 1;
    frame.cull_back = !controls->look.has_back_face_color;
    return frame;
}

static girih_result record_picture(session *s, uint32_t slot, VkCommandBuffer commands,
                                   girih_error *error) {
    girih_view_controls *controls = &s->controls;
    const girih_camera camera = girih_orbit_camera(&controls->orbit);
    girih_result result =
        girih_view_from_camera(&s->view, &camera, s->window.width, s->window.height, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const girih_frame frame = make_frame(s);
    const girih_shown_wish wish = {
        .surface = controls->surface,
        .mode =
            girih_shade_is_by_pattern(controls->look.shade) ? GIRIH_MODE_INSTANCED : controls->mode,
        .max_segments = girih_segments_beyond(s->catalogue.catalogue, &controls->levels),
    };
    VkQueryPool queries = s->window.frames[slot].queries;
    result = girih_shown_refine(s->shown, slot, commands, &wish, &frame, queries, error);
    if (result == GIRIH_OK) {
        result = fill_overlay(s, slot, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    s->last = girih_shown_drawing(s->shown, slot, s->window.width);
    const girih_picture picture = describe_picture(s, &s->last);
    if (queries != VK_NULL_HANDLE) {
        vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries,
                            GIRIH_TIMESTAMPS);
    }
    result = girih_renderer_record(s->shown->renderer, commands, slot, &picture, error);
    if (queries != VK_NULL_HANDLE) {
        vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries,
                            GIRIH_TIMESTAMPS + 1);
    }
    return result;
}

static void count_frame(session *s) {
    double now = girih_seconds();
    s->drawn++;
    s->counted++;
    if (now - s->counting_since >= 0.5) {
        s->frames_per_second = s->counted / (now - s->counting_since);
        s->counting_since = now;
        s->counted = 0;
    }
}

static girih_result draw_picture(session *s, girih_error *error) {
    bool is_new;
    girih_result result = girih_window_fit(&s->window, &is_new, error);
    if (result != GIRIH_OK || s->window.swapchain == VK_NULL_HANDLE) {
        return result;
    }
    if (is_new) {
        result = resize(s, error);
    }
    if (result == GIRIH_OK) {
        result = girih_window_wait(&s->window, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    const uint32_t slot = s->window.frame;
    girih_shown_collect(s->shown, slot, s->window.frames[slot].queries);
    VkCommandBuffer commands;
    result = girih_window_begin(&s->window, &commands, error);
    if (result != GIRIH_OK || commands == VK_NULL_HANDLE) {
        return result;
    }
    result = record_picture(s, slot, commands, error);
    if (result == GIRIH_OK) {
        result = girih_window_end(&s->window, girih_renderer_image(s->shown->renderer), error);
    }
    if (result == GIRIH_OK) {
        count_frame(s);
    }
    return result;
}

// --- The loop ---

static girih_result do_once(session *s, girih_error *error) {
    girih_result result = GIRIH_OK;
    if (s->controls.dropped != NULL) {
        result = take_dropped(s, error);
    }
    if (result == GIRIH_OK && s->controls.wants_camera_reset) {
        s->controls.wants_camera_reset = false;
        result = start_camera(s, error);
    }
    return result;
}

static girih_result run(session *s, girih_error *error) {
    girih_result result = GIRIH_OK;
    s->start = girih_seconds();
    s->counting_since = s->start;
    s->last_loop = s->start;
    while (result == GIRIH_OK && !glfwWindowShouldClose(s->window.handle) &&
           (s->options->frames == 0 || s->drawn < s->options->frames)) {
        if (girih_window_is_visible(&s->window)) {
            glfwPollEvents();
        } else {
            glfwWaitEventsTimeout(0.2);
        }
        result = do_once(s, error);
        watch_surface(s);
        if (result == GIRIH_OK) {
            result = animate(s, error);
        }
        if (result == GIRIH_OK && girih_window_is_visible(&s->window)) {
            result = draw_picture(s, error);
        }
        // Behind the picture that shows what the keys before have changed.
        if (result == GIRIH_OK && s->controls.wants_picture && s->last.plan != NULL) {
            s->controls.wants_picture = false;
            take_picture(s);
        }
    }
    return result;
}

static girih_result open_all(session *s, girih_error *error) {
    const view_options *options = s->options;
    if (options->output != NULL && girih_output_is_same(options->model, options->output)) {
        s->file = options->model;
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "is the input; write to another file");
    }
    girih_result result =
        girih_catalogue_source_open(&s->catalogue, options->surface.catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_window_open(&s->window, "girih", options->camera.width,
                                   options->camera.height, error);
    }
    if (result == GIRIH_OK) {
        result = open_device(s, error);
    }
    girih_shown_model *shown = NULL;
    if (result == GIRIH_OK) {
        result = open_model(s, options->model, &options->pose, &shown, error);
    }
    if (result == GIRIH_OK) {
        take_model(s, shown);
        start_controls(s);
        start_animation(s);
        girih_view_listen(&s->controls, s->window.handle);
        s->file = options->model;
        result = start_camera(s, error);
    }
    return result;
}

static void close_all(session *s) {
    if (s->is_device_open) {
        vkDeviceWaitIdle(s->device.device);
        girih_shown_close(s->shown);
        girih_window_detach(&s->window);
        girih_device_close(&s->device);
    }
    girih_window_close(&s->window);
    girih_overlay_clear(&s->overlay);
    girih_catalogue_source_free(&s->catalogue);
    free(s->controls.dropped);
}

// The statistics of the last picture, which is finished.
static int report(session *s) {
    // The one that was recorded last comes last.
    for (uint32_t n = 0; n < GIRIH_WINDOW_FRAMES; n++) {
        uint32_t slot = (s->window.frame + n) % GIRIH_WINDOW_FRAMES;
        girih_shown_collect(s->shown, slot, s->window.frames[slot].queries);
    }
    const girih_refinement *latest = &s->shown->latest;
    if (!s->options->json) {
        return GIRIH_EXIT_DONE;
    }
    json_t *root = girih_report_json(s->device.properties.deviceName, girih_mode_name(latest->mode),
                                     &latest->statistics, &latest->times);
    if (root != NULL) {
        json_object_set_new(root, "frames", json_integer(s->drawn));
        json_object_set_new(root, "frames_per_second",
                            json_real(s->drawn / (girih_seconds() - s->start)));
    }
    return girih_report_print(root);
}

int girih_command_view(int argc, char **argv) {
    view_options options = {0};
    girih_options_parse(&view_argp, argc, argv, &options);
    session s = {.options = &options, .camera = options.camera};
    girih_error error = {.result = GIRIH_OK};
    girih_result result = open_all(&s, &error);
    if (result == GIRIH_OK) {
        result = run(&s, &error);
    }
    int code = GIRIH_EXIT_DONE;
    if (result == GIRIH_OK && options.output != NULL) {
        s.file = NULL;
        result = save_picture(&s, options.output, &error);
    }
    if (result == GIRIH_OK) {
        VkResult idle = vkDeviceWaitIdle(s.device.device);
        if (idle != VK_SUCCESS) {
            result = girih_vulkan_failure(&error, "vkDeviceWaitIdle", idle);
        } else {
            code = report(&s);
        }
    }
    if (result != GIRIH_OK) {
        code = girih_report_failure(s.file, error.message);
    }
    close_all(&s);
    return s.device.validation_messages != 0 ? GIRIH_EXIT_FAILED : code;
}
