#include "camera.h"

#include <math.h>
#include <string.h>

#include "error.h"

static const double pi = 3.14159265358979323846;

// What must be in the picture: points are seen through a callback, so that nothing is stored.
typedef struct points {
    const girih_model *model;
    const girih_instance *instances;
    uint32_t instance_count;
} points;

// How far points reach along directions: max of dot(direction, point). Without any point, those of
// a cube around the origin, so that there is something to look at.
static void reach(const points *set, double directions[][3], uint32_t direction_count,
                  double *reaches) {
    for (uint32_t d = 0; d < direction_count; d++) {
        const double *direction = directions[d];
        reaches[d] = set->instance_count > 0
                         ? -INFINITY
                         : fabs(direction[0]) + fabs(direction[1]) + fabs(direction[2]);
    }
    for (uint32_t n = 0; n < set->instance_count; n++) {
        const girih_mesh *mesh = set->model->meshes[set->instances[n].mesh];
        const float *t = set->instances[n].transform;
        for (uint32_t d = 0; d < direction_count; d++) {
            // The direction in mesh space.
            const double *direction = directions[d];
            double local[4];
            for (int c = 0; c < 4; c++) {
                local[c] = direction[0] * (double)t[c] + direction[1] * (double)t[4 + c] +
                           direction[2] * (double)t[8 + c];
            }
            for (uint32_t v = 0; v < mesh->vertex_count; v++) {
                const float *p = mesh->positions + 3 * (size_t)v;
                double along = local[0] * (double)p[0] + local[1] * (double)p[1] +
                               local[2] * (double)p[2] + local[3];
                reaches[d] = along > reaches[d] ? along : reaches[d];
            }
        }
    }
    for (uint32_t d = 0; d < direction_count; d++) {
        const double *direction = directions[d];
        reaches[d] += (double)set->model->reach *
                      sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                           direction[2] * direction[2]);
    }
}

static void cross(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool normalize(double a[3]) {
    double length = sqrt(dot(a, a));
    if (!(length > 0.0) || !isfinite(length)) {
        return false;
    }
    for (int n = 0; n < 3; n++) {
        a[n] /= length;
    }
    return true;
}

// Another up where it is parallel to back.
void girih_camera_level(girih_camera *camera, const double view_up[3]) {
    cross(view_up, camera->back, camera->right);
    double length = sqrt(dot(view_up, view_up));
    if (sqrt(dot(camera->right, camera->right)) < 1e-6 * length || !normalize(camera->right)) {
        double other[3] = {0.0, 0.0, fabs(camera->back[2]) < 0.9 ? -1.0 : 0.0};
        other[1] = other[2] != 0.0 ? 0.0 : 1.0;
        cross(other, camera->back, camera->right);
        normalize(camera->right);
    }
    cross(camera->back, camera->right, camera->up);
    normalize(camera->up);
}

static void complete_basis(girih_camera *c, const float view_up[3]) {
    girih_camera_level(c, (const double[3]){view_up[0], view_up[1], view_up[2]});
}

// Moves the eye along `back` to where all points are inside the picture, and sideways to the middle
// of them unless the camera has a point to look at. For one direction and slope s of the picture's
// side, a point is inside where side·p - eye_side <= (eye_back - back·p) s, so the largest side·p +
// s back·p decides.
static void frame_points(girih_camera *c, const points *set, double aspect,
                         const double *focal_point) {
    const double margin = 0.92;
    double slope[2] = {c->half_height * aspect * margin, c->half_height * margin};
    const double *sides[2] = {c->right, c->up};
    double directions[4][3];
    for (int side = 0; side < 2; side++) {
        for (int n = 0; n < 3; n++) {
            directions[2 * side][n] = sides[side][n] + slope[side] * c->back[n];
            directions[2 * side + 1][n] = -sides[side][n] + slope[side] * c->back[n];
        }
    }
    double reaches[4];
    reach(set, directions, 4, reaches);
    double distance = -INFINITY;
    double middle[2];
    for (int side = 0; side < 2; side++) {
        double both = (reaches[2 * side] + reaches[2 * side + 1]) / (2.0 * slope[side]);
        middle[side] = (reaches[2 * side] - reaches[2 * side + 1]) / 2.0;
        if (focal_point != NULL) {
            middle[side] = dot(sides[side], focal_point);
            double first = (reaches[2 * side] - middle[side]) / slope[side];
            double second = (reaches[2 * side + 1] + middle[side]) / slope[side];
            both = first > second ? first : second;
        }
        distance = both > distance ? both : distance;
    }
    for (int n = 0; n < 3; n++) {
        c->eye[n] = middle[0] * c->right[n] + middle[1] * c->up[n] + distance * c->back[n];
    }
}

// The area that a triangle, placed by t, turns towards a direction; negative where it turns its
// back.
static double facing_area(const girih_mesh *mesh, uint32_t triangle, const float t[12],
                          const double direction[3]) {
    double corners[3][3], along[2][3], normal[3];
    for (int k = 0; k < 3; k++) {
        const float *p =
            mesh->positions + 3 * (size_t)mesh->triangle_vertices[3 * (size_t)triangle + (size_t)k];
        for (int n = 0; n < 3; n++) {
            const float *row = t + 4 * n;
            corners[k][n] = (double)row[0] * (double)p[0] + (double)row[1] * (double)p[1] +
                            (double)row[2] * (double)p[2] + (double)row[3];
        }
    }
    for (int n = 0; n < 3; n++) {
        along[0][n] = corners[1][n] - corners[0][n];
        along[1][n] = corners[2][n] - corners[0][n];
    }
    cross(along[0], along[1], normal);
    return dot(normal, direction);
}

static bool is_mirroring(const float t[12]) {
    double columns[3][3], product[3];
    for (int n = 0; n < 3; n++) {
        for (int k = 0; k < 3; k++) {
            columns[n][k] = t[4 * k + n];
        }
    }
    cross(columns[0], columns[1], product);
    return dot(product, columns[2]) < 0.0;
}

// Whether next to nothing is to be seen from a direction, and more from the other side: a sheet of
// single-sided triangles that turns its back.
static bool turns_its_back(const points *set, const double direction[3]) {
    double front = 0.0;
    double back = 0.0;
    for (uint32_t n = 0; n < set->instance_count; n++) {
        const girih_mesh *mesh = set->model->meshes[set->instances[n].mesh];
        const float *t = set->instances[n].transform;
        double sign = is_mirroring(t) ? -1.0 : 1.0;
        for (uint32_t s = 0; s < mesh->submesh_count; s++) {
            const girih_submesh *range = &mesh->submeshes[s];
            for (uint32_t i = 0; i < range->index_count; i += 3) {
                double area = sign * facing_area(mesh, (range->first_index + i) / 3, t, direction);
                front += area > 0.0 || range->two_sided ? fabs(area) : 0.0;
                back += area < 0.0 || range->two_sided ? fabs(area) : 0.0;
            }
        }
    }
    return front < 0.1 * back;
}

static void use_file_camera(girih_camera *c, const girih_gltf_camera *source) {
    const float *t = source->transform;
    for (int n = 0; n < 3; n++) {
        c->eye[n] = t[4 * n + 3];
        c->back[n] = t[4 * n + 2];
    }
    if (!normalize(c->back)) {
        c->back[2] = 1.0;
    }
    complete_basis(c, (const float[3]){t[1], t[5], t[9]});
    c->orthographic = !source->perspective;
    c->half_height = source->perspective ? tan((double)source->vertical_view_angle / 2.0)
                                         : fabs((double)source->y_magnification);
    c->near = source->near;
    c->far = source->far;
}

void girih_model_box(const girih_model *model, const girih_instance *instances,
                     uint32_t instance_count, double low[3], double high[3]) {
    const points set = {model, instances, instance_count};
    double axes[6][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    double reaches[6];
    reach(&set, axes, 6, reaches);
    for (int n = 0; n < 3; n++) {
        low[n] = -reaches[3 + n];
        high[n] = reaches[n];
    }
}

static void use_options(girih_camera *c, const girih_camera_options *options, const points *set,
                        double aspect) {
    double low[3], high[3];
    double focal_point[3];
    girih_model_box(set->model, set->instances, set->instance_count, low, high);
    for (int n = 0; n < 3; n++) {
        focal_point[n] =
            options->has_focal_point ? (double)options->focal_point[n] : (low[n] + high[n]) / 2.0;
    }
    c->half_height = tan((double)options->view_angle * (pi / 360.0));
    if (options->has_position) {
        for (int n = 0; n < 3; n++) {
            c->eye[n] = options->position[n];
            c->back[n] = c->eye[n] - focal_point[n];
        }
        if (!normalize(c->back)) {
            c->back[2] = 1.0;
        }
        complete_basis(c, options->view_up);
        return;
    }
    if (options->has_direction) {
        for (int n = 0; n < 3; n++) {
            c->back[n] = -(double)options->direction[n];
        }
        normalize(c->back);
        complete_basis(c, options->view_up);
        frame_points(c, set, aspect, options->has_focal_point ? focal_point : NULL);
        return;
    }
    // Three quarters: from the front, from the right and from above, as `view up` says what above
    // is.
    double up[3] = {options->view_up[0], options->view_up[1], options->view_up[2]};
    normalize(up);
    double front[3] = {0.0, 0.0, 1.0};
    if (fabs(dot(up, front)) > 0.9) {
        front[1] = -1.0;
        front[2] = 0.0;
    }
    double side[3];
    cross(up, front, side);
    normalize(side);
    cross(side, up, front);
    for (int n = 0; n < 3; n++) {
        c->back[n] = front[n] + 0.55 * side[n] + 0.42 * up[n];
    }
    normalize(c->back);
    if (turns_its_back(set, c->back)) {
        for (int n = 0; n < 3; n++) {
            c->back[n] = -c->back[n];
        }
    }
    complete_basis(c, options->view_up);
    frame_points(c, set, aspect, options->has_focal_point ? focal_point : NULL);
}

// Near and far planes around all points, with room for surfaces that bulge out of them.
static void find_depth(girih_camera *c, const points *set) {
    double directions[2][3];
    for (int n = 0; n < 3; n++) {
        directions[0][n] = c->back[n];
        directions[1][n] = -c->back[n];
    }
    double reaches[2];
    reach(set, directions, 2, reaches);
    double eye = dot(c->back, c->eye);
    double nearest = eye - reaches[0];
    double farthest = eye + reaches[1];
    double axes[6][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    double box[6];
    reach(set, axes, 6, box);
    double size =
        sqrt((box[0] + box[3]) * (box[0] + box[3]) + (box[1] + box[4]) * (box[1] + box[4]) +
             (box[2] + box[5]) * (box[2] + box[5]));
    size = size > 0.0 ? size : 1.0;
    c->far = farthest + 0.25 * size;
    c->near = nearest - 0.25 * size;
    if (!c->orthographic) {
        double least = 1e-4 * (c->far > size ? c->far : size);
        c->near = c->near > least ? c->near : least;
    }
    c->far = c->far > c->near ? c->far : c->near + size;
}

static void fill_view(girih_view *view, const girih_camera *c, double aspect, uint32_t height) {
    double view_matrix[4][4] = {{0}}; // columns
    for (int n = 0; n < 3; n++) {
        view_matrix[n][0] = c->right[n];
        view_matrix[n][1] = c->up[n];
        view_matrix[n][2] = c->back[n];
    }
    view_matrix[3][0] = -dot(c->right, c->eye);
    view_matrix[3][1] = -dot(c->up, c->eye);
    view_matrix[3][2] = -dot(c->back, c->eye);
    view_matrix[3][3] = 1.0;
    double projection[4][4] = {{0}};
    double depth = c->far - c->near;
    projection[0][0] = 1.0 / (c->half_height * aspect);
    projection[1][1] = 1.0 / c->half_height;
    if (c->orthographic) {
        projection[2][2] = 1.0 / depth;
        projection[3][2] = c->far / depth;
        projection[3][3] = 1.0;
    } else {
        projection[2][2] = c->near / depth;
        projection[3][2] = c->near * c->far / depth;
        projection[2][3] = -1.0;
    }
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            double sum = 0.0;
            for (int k = 0; k < 4; k++) {
                sum += projection[k][row] * view_matrix[column][k];
            }
            view->view_projection[column][row] = (float)sum;
        }
    }
    // Gribb and Hartmann 2001: a clip-space half-space is a sum of the matrix's rows.
    for (int column = 0; column < 4; column++) {
        const float *m = view->view_projection[column];
        view->planes[0][column] = m[3] + m[0];
        view->planes[1][column] = m[3] - m[0];
        view->planes[2][column] = m[3] + m[1];
        view->planes[3][column] = m[3] - m[1];
        view->planes[4][column] = m[2];
        view->planes[5][column] = m[3] - m[2];
    }
    for (int n = 0; n < 3; n++) {
        view->eye[n] = (float)(c->orthographic ? c->back[n] : c->eye[n]);
        view->right[n] = (float)c->right[n];
        view->up[n] = (float)c->up[n];
        view->back[n] = (float)c->back[n];
    }
    view->orthographic = c->orthographic;
    view->near_distance = (float)c->near;
    view->pixels_per_unit = (float)((double)height / (2.0 * c->half_height));
}

// Perspective or, from a file, orthographic.
static void make_camera(girih_camera *c, const girih_camera_options *options, const points *set,
                        double aspect) {
    *c = (girih_camera){0};
    if (options->has_index) {
        use_file_camera(c, &set->model->contents->cameras[options->index]);
    } else {
        use_options(c, options, set, aspect);
    }
    if (!(c->far > 0.0)) {
        double near = c->near;
        find_depth(c, set);
        c->near = options->has_index ? near : c->near;
        c->far = c->far > c->near ? c->far : 2.0 * c->near;
    }
}

// Where a camera in a cylindrical projection stands, and what it looks at; look 0: nothing in
// particular.
static void stand_in_cylinder(const girih_camera_options *options, const girih_model *model,
                              const points *set, double eye[3], double look[3], bool *is_aimed) {
    *is_aimed = options->has_index || options->has_focal_point;
    if (options->has_index) {
        const float *t = model->contents->cameras[options->index].transform;
        for (int n = 0; n < 3; n++) {
            eye[n] = t[4 * n + 3];
            look[n] = -t[4 * n + 2];
        }
        return;
    }
    double axes[6][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    double reaches[6];
    reach(set, axes, 6, reaches);
    for (int n = 0; n < 3; n++) {
        double middle = (reaches[n] - reaches[3 + n]) / 2.0;
        eye[n] = options->has_position ? (double)options->position[n] : middle;
        look[n] = (options->has_focal_point ? (double)options->focal_point[n] : middle) - eye[n];
    }
}

// The farthest that a point can be from the axis, by a box along right and back.
static double farthest_from_axis(const girih_camera *c, const points *set) {
    double sides[4][3];
    for (int n = 0; n < 3; n++) {
        sides[0][n] = c->right[n];
        sides[1][n] = -c->right[n];
        sides[2][n] = c->back[n];
        sides[3][n] = -c->back[n];
    }
    double reaches[4];
    reach(set, sides, 4, reaches);
    double square = 0.0;
    for (int n = 0; n < 2; n++) {
        double along = dot(sides[2 * n], c->eye);
        double most = fmax(fabs(reaches[2 * n] - along), fabs(reaches[2 * n + 1] + along));
        square += most * most;
    }
    return sqrt(square);
}

static girih_result fill_cylinder(girih_view *view, const girih_camera_options *options,
                                  const girih_model *model, const points *set, uint32_t width,
                                  uint32_t height, girih_error *error) {
    girih_camera c = {0};
    double look[3];
    bool is_aimed;
    stand_in_cylinder(options, model, set, c.eye, look, &is_aimed);
    for (int n = 0; n < 3; n++) {
        c.up[n] = options->view_up[n];
    }
    normalize(c.up);
    double rise = dot(look, c.up);
    for (int n = 0; n < 3; n++) {
        c.back[n] = rise * c.up[n] - look[n];
    }
    double away = sqrt(dot(c.back, c.back));
    if (!(away > 1e-6 * fabs(rise)) || !isfinite(away)) {
        if (is_aimed) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "the camera looks along its upward axis, where a cylinder has no "
                              "picture: set another focal point");
        }
        c.back[2] = 1.0;
    }
    normalize(c.back);
    // To the right, whatever is left of the axis in back; then back without it.
    double axis[3] = {c.up[0], c.up[1], c.up[2]};
    complete_basis(&c, options->view_up);
    memcpy(c.up, axis, sizeof c.up);
    cross(c.right, c.up, c.back);
    view->cylindrical = true;
    view->view_angle = (double)options->view_angle * (pi / 180.0);
    double middle = is_aimed ? rise / away : 0.0;
    double half = view->view_angle * 0.5 * (double)height / (double)width;
    view->slopes[0] = (float)(middle - half);
    view->slopes[1] = (float)(middle + half);
    view->pixels_per_unit = (float)((double)width / view->view_angle);
    // A quarter more, for surfaces that bulge out of their points' box.
    c.far = 1.25 * farthest_from_axis(&c, set);
    c.far = c.far > 0.0 ? c.far : 1.0;
    c.near = 1e-4 * c.far;
    view->near_distance = (float)c.near;
    view->depth[0] = (float)(-c.near / (c.far - c.near));
    view->depth[1] = (float)(c.near * c.far / (c.far - c.near));
    for (int n = 0; n < 3; n++) {
        view->eye[n] = (float)c.eye[n];
        view->right[n] = (float)c.right[n];
        view->up[n] = (float)c.up[n];
        view->back[n] = (float)c.back[n];
    }
    // The two sides, where they bound a wedge.
    double cosine = cos(view->view_angle / 2.0);
    double sine = sin(view->view_angle / 2.0);
    for (int side = 0; side < 2 && view->view_angle < pi; side++) {
        double normal[3];
        for (int n = 0; n < 3; n++) {
            normal[n] = (side == 0 ? cosine : -cosine) * c.right[n] - sine * c.back[n];
            view->planes[side][n] = (float)normal[n];
        }
        view->planes[side][3] = (float)-dot(normal, c.eye);
    }
    return GIRIH_OK;
}

static bool view_is_finite(const girih_view *view) {
    bool is_finite = isfinite(view->near_distance) && isfinite(view->pixels_per_unit) &&
                     view->pixels_per_unit > 0.0f &&
                     (view->orthographic || view->near_distance > 0.0f);
    for (int n = 0; n < 2; n++) {
        is_finite &= isfinite(view->slopes[n]) && isfinite(view->depth[n]);
    }
    for (int n = 0; n < 16; n++) {
        is_finite &= isfinite(view->view_projection[n / 4][n % 4]) != 0;
    }
    return is_finite;
}

static girih_result check_index(const girih_camera_options *options, const girih_model *model,
                                girih_error *error) {
    if (options->has_index && options->index >= model->contents->camera_count) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "no camera %u: the file has %u",
                          options->index, model->contents->camera_count);
    }
    return GIRIH_OK;
}

static girih_result check_view(const girih_view *view, girih_error *error) {
    if (!view_is_finite(view)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "the camera cannot see a model of this size or place: set another one");
    }
    return GIRIH_OK;
}

girih_result girih_camera_create(girih_camera *camera, const girih_camera_options *options,
                                 const girih_model *model, const girih_instance *instances,
                                 uint32_t instance_count, uint32_t width, uint32_t height,
                                 girih_error *error) {
    const points set = {model, instances, instance_count};
    girih_result result = check_index(options, model, error);
    if (result == GIRIH_OK) {
        make_camera(camera, options, &set, (double)width / (double)height);
    }
    return result;
}

// Around a unit axis, by Rodrigues' formula.
static void turn(const double axis[3], double angle, const double v[3], double turned[3]) {
    double sideways[3];
    cross(axis, v, sideways);
    double along = dot(axis, v) * (1.0 - cos(angle));
    for (int n = 0; n < 3; n++) {
        turned[n] = v[n] * cos(angle) + sideways[n] * sin(angle) + axis[n] * along;
    }
}

girih_result girih_camera_turntable(const girih_camera_options *options, const girih_model *model,
                                    const girih_instance *instances, uint32_t instance_count,
                                    uint32_t width, uint32_t height, uint32_t count,
                                    girih_camera_options *turned, girih_error *error) {
    girih_camera first;
    girih_result result = girih_camera_create(&first, options, model, instances, instance_count,
                                              width, height, error);
    if (result != GIRIH_OK) {
        return result;
    }
    const points set = {model, instances, instance_count};
    double low[3], high[3], focal_point[3], axis[3], away[3];
    girih_model_box(model, instances, instance_count, low, high);
    double distance = 0.0;
    for (int n = 0; n < 3; n++) {
        float middle = (float)((low[n] + high[n]) / 2.0);
        focal_point[n] = (double)(options->has_focal_point ? options->focal_point[n] : middle);
        axis[n] = options->view_up[n];
        away[n] = options->has_position ? first.eye[n] - focal_point[n] : first.back[n];
    }
    normalize(axis);
    for (uint32_t k = 0; k < count && !options->has_position; k++) {
        girih_camera c = first;
        turn(axis, 2.0 * pi * k / count, first.back, c.back);
        complete_basis(&c, options->view_up);
        frame_points(&c, &set, (double)width / (double)height, focal_point);
        distance = fmax(distance, dot(c.eye, c.back) - dot(focal_point, c.back));
    }
    for (uint32_t k = 0; k < count; k++) {
        double offset[3];
        turn(axis, 2.0 * pi * k / count, away, offset);
        turned[k] = *options;
        turned[k].has_position = true;
        turned[k].has_focal_point = true;
        for (int n = 0; n < 3; n++) {
            double far = options->has_position ? 1.0 : distance;
            turned[k].position[n] = (float)(focal_point[n] + far * offset[n]);
            turned[k].focal_point[n] = (float)focal_point[n];
        }
    }
    return GIRIH_OK;
}

girih_result girih_view_from_camera(girih_view *view, const girih_camera *camera, uint32_t width,
                                    uint32_t height, girih_error *error) {
    *view = (girih_view){0};
    fill_view(view, camera, (double)width / (double)height, height);
    return check_view(view, error);
}

girih_result girih_view_create(girih_view *view, const girih_camera_options *options,
                               const girih_model *model, const girih_instance *instances,
                               uint32_t instance_count, uint32_t width, uint32_t height,
                               girih_error *error) {
    if (!options->cylindrical) {
        girih_camera camera;
        girih_result result = girih_camera_create(&camera, options, model, instances,
                                                  instance_count, width, height, error);
        return result == GIRIH_OK ? girih_view_from_camera(view, &camera, width, height, error)
                                  : result;
    }
    const points set = {model, instances, instance_count};
    *view = (girih_view){0};
    girih_result result = check_index(options, model, error);
    if (result == GIRIH_OK) {
        result = fill_cylinder(view, options, model, &set, width, height, error);
    }
    return result == GIRIH_OK ? check_view(view, error) : result;
}
