#include "frame.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

static girih_result read_file(const char *path, void **bytes, size_t *size, girih_error *error) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "catalogue %s: %s", path,
                          strerror(errno));
    }
    size_t room = 1 << 16;
    *bytes = malloc(room);
    *size = 0;
    girih_result result = GIRIH_OK;
    while (*bytes != NULL) {
        *size += fread((char *)*bytes + *size, 1, room - *size, file);
        if (*size < room) {
            break;
        }
        room *= 2;
        void *grown = realloc(*bytes, room);
        if (grown == NULL) {
            free(*bytes);
        }
        *bytes = grown;
    }
    if (*bytes == NULL) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "catalogue %s: out of memory", path);
    } else if (ferror(file)) {
        result =
            girih_fail(error, GIRIH_ERROR_INVALID_DATA, "catalogue %s: %s", path, strerror(errno));
        free(*bytes);
        *bytes = NULL;
    }
    fclose(file);
    return result;
}

girih_result girih_catalogue_source_open(girih_catalogue_source *source, const char *name,
                                         girih_error *error) {
    *source = (girih_catalogue_source){0};
    if (strcmp(name, "dyadic") == 0) {
        source->catalogue = girih_catalogue_dyadic();
        return GIRIH_OK;
    }
    if (strcmp(name, "linear") == 0) {
        source->catalogue = girih_catalogue_linear();
        return GIRIH_OK;
    }
    size_t size = 0;
    girih_result result = read_file(name, &source->bytes, &size, error);
    if (result != GIRIH_OK) {
        return result;
    }
    girih_error reason = {0};
    result = girih_catalogue_open(source->bytes, size, &source->catalogue, &reason);
    if (result != GIRIH_OK) {
        girih_catalogue_source_free(source);
        return girih_fail(error, result, "catalogue %s: %.400s", name, reason.message);
    }
    return GIRIH_OK;
}

void girih_catalogue_source_free(girih_catalogue_source *source) {
    free(source->bytes);
    *source = (girih_catalogue_source){0};
}

uint32_t girih_segments_beyond(const girih_catalogue *catalogue,
                               const girih_level_options *levels) {
    uint32_t most = girih_catalogue_segments(catalogue, catalogue->level_count - 1);
    // A catalogue of one level splits nothing.
    return catalogue->level_count > 1 && levels->max_segments > most ? levels->max_segments : 0;
}

girih_frame girih_frame_from_options(const girih_level_options *levels, const girih_view *view) {
    girih_frame frame = {.rule = levels->rule,
                         .segments = levels->segments,
                         .seed = levels->seed,
                         .length = levels->length};
    if (view != NULL) {
        frame.pixels_per_unit = view->pixels_per_unit;
        frame.near_distance = view->orthographic ? 1.0f : view->near_distance;
        memcpy(frame.eye, view->eye, sizeof frame.eye);
        frame.orthographic = view->orthographic;
        memcpy(frame.planes, view->planes, sizeof frame.planes);
        if (view->cylindrical) {
            frame.rule = levels->rule == GIRIH_LEVEL_EDGE_PIXELS ? GIRIH_LEVEL_HORIZONTAL_PIXELS
                                                                 : levels->rule;
            frame.cylindrical = 1;
            memcpy(frame.up, view->up, sizeof frame.up);
            frame.pixels_per_radian = view->pixels_per_unit;
            frame.lowest_slope = view->slopes[0];
            frame.highest_slope = view->slopes[1];
        }
    }
    return frame;
}

girih_result girih_frame_create(girih_frame *frame, const girih_level_options *levels,
                                const girih_camera_options *camera, const girih_model *model,
                                const girih_instance *instances, uint32_t instance_count,
                                girih_error *error) {
    if (levels->rule != GIRIH_LEVEL_EDGE_PIXELS) {
        *frame = girih_frame_from_options(levels, NULL);
        return GIRIH_OK;
    }
    girih_view view;
    girih_result result = girih_view_create(&view, camera, model, instances, instance_count,
                                            camera->width, camera->height, error);
    if (result == GIRIH_OK) {
        *frame = girih_frame_from_options(levels, &view);
    }
    return result;
}
