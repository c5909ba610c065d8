#include "view_input.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// As in f3d where it has such a key.
const girih_view_key girih_view_keys[] = {
    {"left drag", "turn"},
    {"right or Shift drag", "move"},
    {"wheel", "nearer, farther"},
    {"Enter", "the camera as at first"},
    {"1 3 7 9", "from the front, the right, above, askew"},
    {"+ -", "finer, coarser"},
    {"R", "rule: pixels, length, segments, random"},
    {"S", "surface: flat, PN, the file's"},
    {"M", "mode: instanced, baked, welded"},
    {"C", "shading"},
    {"E", "edges"},
    {"B", "back faces in a colour of their own"},
    {"F", "freeze levels and culling"},
    {"Space", "play, pause"},
    {"W", "next animation"},
    {"Z", "statistics"},
    {"P F12", "picture into a PNG"},
    {"H ?", "these keys"},
    {"Esc Q", "quit"},
};
const uint32_t girih_view_key_count = sizeof girih_view_keys / sizeof girih_view_keys[0];

// --- Levels ---

static void set_rule(girih_view_controls *controls, girih_level_rule rule) {
    girih_level_options *levels = &controls->levels;
    levels->rule = rule;
    switch (rule) {
    case GIRIH_LEVEL_EDGE_PIXELS:
        levels->length = 8.0f;
        break;
    case GIRIH_LEVEL_EDGE_LENGTH:
        levels->length = (float)controls->edge_length;
        break;
    case GIRIH_LEVEL_SEGMENTS:
        levels->segments = 4;
        break;
    default:
        levels->segments = 16;
        break;
    }
}

static void next_rule(girih_view_controls *controls) {
    switch (controls->levels.rule) {
    case GIRIH_LEVEL_EDGE_PIXELS:
        set_rule(controls, GIRIH_LEVEL_EDGE_LENGTH);
        break;
    case GIRIH_LEVEL_EDGE_LENGTH:
        set_rule(controls, GIRIH_LEVEL_SEGMENTS);
        break;
    case GIRIH_LEVEL_SEGMENTS:
        set_rule(controls, GIRIH_LEVEL_RANDOM);
        break;
    default:
        set_rule(controls, GIRIH_LEVEL_EDGE_PIXELS);
        break;
    }
}

// Lengths by a quarter, segments by a quarter and at least one.
static void step_size(girih_view_controls *controls, bool finer) {
    girih_level_options *levels = &controls->levels;
    if (levels->rule == GIRIH_LEVEL_EDGE_PIXELS || levels->rule == GIRIH_LEVEL_EDGE_LENGTH) {
        float length = finer ? levels->length / 1.25f : levels->length * 1.25f;
        bool is_pixels = levels->rule == GIRIH_LEVEL_EDGE_PIXELS;
        float least = is_pixels ? 0.1f : (float)controls->edge_length * 1e-4f;
        float most = is_pixels ? 1e4f : (float)controls->edge_length * 1e4f;
        levels->length = fminf(fmaxf(length, least), most);
        return;
    }
    uint32_t step = levels->segments / (finer ? 4 : 5);
    step = step > 0 ? step : 1;
    if (finer) {
        uint32_t most = GIRIH_BARYCENTRIC_ONE;
        levels->segments = levels->segments + step < most ? levels->segments + step : most;
    } else {
        levels->segments = levels->segments > step ? levels->segments - step : 1;
    }
}

// --- What to choose from ---

static girih_surface next_surface(const girih_view_controls *controls) {
    switch (controls->surface) {
    case GIRIH_SURFACE_FLAT:
        return GIRIH_SURFACE_PN;
    case GIRIH_SURFACE_PN:
        return controls->has_own ? GIRIH_SURFACE_OWN : GIRIH_SURFACE_FLAT;
    default:
        return GIRIH_SURFACE_FLAT;
    }
}

static girih_mode next_mode(const girih_view_controls *controls) {
    switch (controls->mode) {
    case GIRIH_MODE_INSTANCED:
        return GIRIH_MODE_BAKED;
    case GIRIH_MODE_BAKED:
        return GIRIH_MODE_WELDED;
    default:
        return controls->can_instance ? GIRIH_MODE_INSTANCED : GIRIH_MODE_BAKED;
    }
}

static girih_shade next_shade(const girih_view_controls *controls) {
    switch (controls->look.shade) {
    case GIRIH_SHADE_LIT:
        return GIRIH_SHADE_NORMALS;
    case GIRIH_SHADE_NORMALS:
        if (controls->can_instance) {
            return GIRIH_SHADE_LEVELS;
        }
        return controls->can_draw_sizes ? GIRIH_SHADE_DENSITY : GIRIH_SHADE_LIT;
    case GIRIH_SHADE_LEVELS:
        return GIRIH_SHADE_PATTERNS;
    case GIRIH_SHADE_PATTERNS:
        return controls->can_draw_sizes ? GIRIH_SHADE_DENSITY : GIRIH_SHADE_LIT;
    default:
        return GIRIH_SHADE_LIT;
    }
}

// --- Events ---

static void look_along(girih_view_controls *controls, double right, double up, double back) {
    // In the frame that --camera-view-up gives: its axis, and the directions across it that are
    // nearest to x and z.
    const double *axis = controls->orbit.up;
    girih_camera frame = {.back = {0.0, 0.0, 1.0}};
    if (fabs(axis[2]) > 0.9) {
        frame.back[1] = -1.0;
        frame.back[2] = 0.0;
    }
    girih_camera_level(&frame, axis);
    double direction[3];
    for (int n = 0; n < 3; n++) {
        direction[n] = right * frame.right[n] + up * axis[n];
    }
    // Back without what it has of the axis: right x axis.
    for (int n = 0; n < 3; n++) {
        int a = (n + 1) % 3;
        int b = (n + 2) % 3;
        direction[n] += back * (frame.right[a] * axis[b] - frame.right[b] * axis[a]);
    }
    girih_orbit_look(&controls->orbit, direction);
}

static void on_letter(GLFWwindow *window, unsigned int letter) {
    girih_view_controls *controls = glfwGetWindowUserPointer(window);
    controls->has_news = true;
    switch (letter) {
    case '+':
    case '=':
        step_size(controls, true);
        break;
    case '-':
        step_size(controls, false);
        break;
    case '1':
        look_along(controls, 0.0, 0.0, 1.0);
        break;
    case '3':
        look_along(controls, 1.0, 0.0, 0.0);
        break;
    case '7':
        look_along(controls, 0.0, 1.0, 0.0);
        break;
    case '9':
        look_along(controls, 1.0, 1.0, 1.0);
        break;
    case 'b':
    case 'B':
        controls->look.has_back_face_color = !controls->look.has_back_face_color;
        break;
    case 'c':
    case 'C':
        controls->look.shade = next_shade(controls);
        break;
    case 'e':
    case 'E':
        controls->look.wireframe = !controls->look.wireframe && controls->can_draw_lines;
        break;
    case 'f':
    case 'F':
        controls->is_frozen = !controls->is_frozen;
        break;
    case 'h':
    case 'H':
    case '?':
        controls->shows_help = !controls->shows_help;
        break;
    case 'm':
    case 'M':
        controls->mode = next_mode(controls);
        break;
    case 'p':
    case 'P':
        controls->wants_picture = true;
        break;
    case 'q':
    case 'Q':
        glfwSetWindowShouldClose(window, GLFW_TRUE);
        break;
    case 'r':
    case 'R':
        next_rule(controls);
        break;
    case 's':
    case 'S':
        controls->surface = next_surface(controls);
        break;
    case 'w':
    case 'W':
        if (controls->animation_count > 0) {
            controls->animation = (controls->animation + 1) % controls->animation_count;
        }
        break;
    case 'z':
    case 'Z':
        controls->shows_statistics = !controls->shows_statistics;
        break;
    case ' ':
        controls->is_playing = !controls->is_playing && controls->animation_count > 0;
        break;
    default:
        break;
    }
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods) {
    (void)scancode;
    (void)mods;
    girih_view_controls *controls = glfwGetWindowUserPointer(window);
    if (action != GLFW_PRESS) {
        return;
    }
    switch (key) {
    case GLFW_KEY_ESCAPE:
        glfwSetWindowShouldClose(window, GLFW_TRUE);
        break;
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
        controls->wants_camera_reset = true;
        break;
    case GLFW_KEY_F12:
        controls->wants_picture = true;
        break;
    default:
        break;
    }
}

// GLFW tells of the cursor's movements in their order with the buttons; where it is asked, it may
// be farther already.
static void on_button(GLFWwindow *window, int button, int action, int mods) {
    girih_view_controls *controls = glfwGetWindowUserPointer(window);
    controls->is_dragging = action == GLFW_PRESS;
    controls->is_panning = button != GLFW_MOUSE_BUTTON_LEFT || (mods & GLFW_MOD_SHIFT) != 0;
}

static void on_cursor(GLFWwindow *window, double x, double y) {
    girih_view_controls *controls = glfwGetWindowUserPointer(window);
    int width, height;
    glfwGetWindowSize(window, &width, &height);
    double right = (x - controls->cursor[0]) / fmax(height, 1);
    double down = (y - controls->cursor[1]) / fmax(height, 1);
    controls->cursor[0] = x;
    controls->cursor[1] = y;
    if (!controls->is_dragging) {
        return;
    }
    if (controls->is_panning) {
        girih_orbit_pan(&controls->orbit, right, -down);
    } else {
        const double half_turn = 3.141592653589793; // for a drag as long as the window is high
        girih_orbit_turn(&controls->orbit, half_turn * right, -half_turn * down);
    }
}

static void on_wheel(GLFWwindow *window, double x, double y) {
    (void)x;
    girih_view_controls *controls = glfwGetWindowUserPointer(window);
    girih_orbit_zoom(&controls->orbit, pow(0.9, y));
}

static void on_drop(GLFWwindow *window, int count, const char **paths) {
    girih_view_controls *controls = glfwGetWindowUserPointer(window);
    if (count > 0) {
        free(controls->dropped);
        controls->dropped = strdup(paths[0]);
    }
}

void girih_view_listen(girih_view_controls *controls, GLFWwindow *window) {
    glfwSetWindowUserPointer(window, controls);
    glfwSetCharCallback(window, on_letter);
    glfwSetKeyCallback(window, on_key);
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetCursorPosCallback(window, on_cursor);
    glfwSetScrollCallback(window, on_wheel);
    glfwSetDropCallback(window, on_drop);
}
