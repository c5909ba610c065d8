// A camera that the mouse turns around a point.
#ifndef GIRIH_VIEWER_ORBIT_H
#define GIRIH_VIEWER_ORBIT_H

#include "camera.h"

typedef struct girih_orbit {
    girih_camera camera; // near and far are girih_orbit_camera's to find
    double focal[3];     // what it turns around
    double up[3];        // unit vector
    double middle[3];    // of what is to be seen
    double radius;
} girih_orbit;

// Takes up a camera that looks at what lies between low and high: it turns around the point before
// it that is as far away as their middle.
void girih_orbit_start(girih_orbit *orbit, const girih_camera *camera, const float up[3],
                       const double low[3], const double high[3]);

// What is to be seen lies between other bounds now; the camera stays.
void girih_orbit_surround(girih_orbit *orbit, const double low[3], const double high[3]);

// Turns by radians: what is looked at follows to the right, and upwards, no farther than to the
// axis.
void girih_orbit_turn(girih_orbit *orbit, double right, double up);

// Looks against `back`, a direction, from as far away.
void girih_orbit_look(girih_orbit *orbit, const double back[3]);

// Moves sideways, so that the focal point follows: in heights of the picture.
void girih_orbit_pan(girih_orbit *orbit, double right, double up);

// Goes to `factor` times the distance, within bounds.
void girih_orbit_zoom(girih_orbit *orbit, double factor);

// The camera with near and far planes around what is to be seen.
girih_camera girih_orbit_camera(const girih_orbit *orbit);

#endif
