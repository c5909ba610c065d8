#include "orbit.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance_of(const girih_orbit *orbit) {
    double away[3];
    for (int n = 0; n < 3; n++) {
        away[n] = orbit->camera.eye[n] - orbit->focal[n];
    }
    return sqrt(dot(away, away));
}

void girih_orbit_surround(girih_orbit *orbit, const double low[3], const double high[3]) {
    double square = 0.0;
    for (int n = 0; n < 3; n++) {
        orbit->middle[n] = (low[n] + high[n]) / 2.0;
        square += (high[n] - low[n]) * (high[n] - low[n]) / 4.0;
    }
    orbit->radius = square > 0.0 ? sqrt(square) : 1.0;
}

void girih_orbit_start(girih_orbit *orbit, const girih_camera *camera, const float up[3],
                       const double low[3], const double high[3]) {
    *orbit = (girih_orbit){.camera = *camera};
    girih_orbit_surround(orbit, low, high);
    double length = sqrt((double)up[0] * (double)up[0] + (double)up[1] * (double)up[1] +
                         (double)up[2] * (double)up[2]);
    double distance = 0.0;
    for (int n = 0; n < 3; n++) {
        orbit->up[n] = (double)up[n] / length;
        distance += (camera->eye[n] - orbit->middle[n]) * camera->back[n];
    }
    // A camera that looks away from everything turns around what is right before it.
    distance = distance > 0.01 * orbit->radius ? distance : orbit->radius;
    for (int n = 0; n < 3; n++) {
        orbit->focal[n] = camera->eye[n] - distance * camera->back[n];
    }
}

// Stands behind the focal point, at a distance of it.
static void stand(girih_orbit *orbit, double distance) {
    for (int n = 0; n < 3; n++) {
        orbit->camera.eye[n] = orbit->focal[n] + distance * orbit->camera.back[n];
    }
}

void girih_orbit_look(girih_orbit *orbit, const double back[3]) {
    double distance = distance_of(orbit);
    double length = sqrt(dot(back, back));
    for (int n = 0; n < 3; n++) {
        orbit->camera.back[n] = back[n] / length;
    }
    girih_camera_level(&orbit->camera, orbit->up);
    stand(orbit, distance);
}

void girih_orbit_turn(girih_orbit *orbit, double right, double up) {
    const double highest = 1.5690; // a little less than a right angle: the camera never flips
    const girih_camera *camera = &orbit->camera;
    double height = dot(camera->back, orbit->up);
    double elevation = asin(height < -1.0 ? -1.0 : height > 1.0 ? 1.0 : height) - up;
    elevation = elevation < -highest ? -highest : elevation > highest ? highest : elevation;
    // The horizontal direction towards the viewer: upright the picture's up has it.
    double level[3];
    double length = 0.0;
    for (int n = 0; n < 3; n++) {
        level[n] = camera->back[n] - height * orbit->up[n];
    }
    length = sqrt(dot(level, level));
    if (length < 1e-6) {
        for (int n = 0; n < 3; n++) {
            level[n] = (height > 0.0 ? -1.0 : 1.0) * camera->up[n];
        }
        length = sqrt(dot(level, level));
    }
    // Around the axis: the vector across is up x level.
    double across[3];
    for (int n = 0; n < 3; n++) {
        int a = (n + 1) % 3;
        int b = (n + 2) % 3;
        across[n] = (orbit->up[a] * level[b] - orbit->up[b] * level[a]) / length;
    }
    double back[3];
    for (int n = 0; n < 3; n++) {
        double turned = cos(right) * level[n] / length - sin(right) * across[n];
        back[n] = cos(elevation) * turned + sin(elevation) * orbit->up[n];
    }
    girih_orbit_look(orbit, back);
}

void girih_orbit_pan(girih_orbit *orbit, double right, double up) {
    girih_camera *camera = &orbit->camera;
    double height = 2.0 * camera->half_height * (camera->orthographic ? 1.0 : distance_of(orbit));
    for (int n = 0; n < 3; n++) {
        double step = -height * (right * camera->right[n] + up * camera->up[n]);
        camera->eye[n] += step;
        orbit->focal[n] += step;
    }
}

void girih_orbit_zoom(girih_orbit *orbit, double factor) {
    const double nearest = 1e-3;
    const double farthest = 1e3;
    girih_camera *camera = &orbit->camera;
    if (camera->orthographic) {
        double next = camera->half_height * factor / orbit->radius;
        if (next > nearest && next < farthest) {
            camera->half_height *= factor;
        }
        return;
    }
    double next = distance_of(orbit) * factor;
    if (next > nearest * orbit->radius && next < farthest * orbit->radius) {
        stand(orbit, next);
    }
}

girih_camera girih_orbit_camera(const girih_orbit *orbit) {
    girih_camera camera = orbit->camera;
    // A quarter more, for surfaces that bulge out of their points' box.
    double reach = 1.25 * orbit->radius;
    double away[3];
    for (int n = 0; n < 3; n++) {
        away[n] = camera.eye[n] - orbit->middle[n];
    }
    double depth = dot(away, camera.back);
    camera.far = depth + reach;
    camera.near = depth - reach;
    if (!camera.orthographic) {
        double least = 1e-4 * (camera.far > reach ? camera.far : reach);
        camera.near = camera.near > least ? camera.near : least;
    }
    camera.far = camera.far > camera.near ? camera.far : camera.near + reach;
    return camera;
}
