// girih info: says what a model holds.
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "error.h"
#include "model.h"
#include "options.h"
#include "report.h"

typedef struct info_options {
    const char *model;
    bool json;
} info_options;

enum { KEY_JSON = GIRIH_KEY_OWN };

static const struct argp_option own_options[] = {
    {"json", KEY_JSON, NULL, 0, "Print one JSON object", 0}, {NULL, 0, NULL, 0, NULL, 0}};

static error_t parse(int key, char *argument, struct argp_state *state) {
    info_options *options = state->input;
    switch (key) {
    case KEY_JSON: options->json = true; return 0;
    case ARGP_KEY_ARG: girih_option_model(state, &options->model, argument); return 0;
    case ARGP_KEY_NO_ARGS: argp_error(state, "no MODEL"); return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp info_argp = {own_options,
                                      parse,
                                      "MODEL",
                                      "Says what MODEL (.gltf or .glb) holds, and how sound its "
                                      "meshes are: open edges have one triangle, non-manifold "
                                      "ones three or more, flipped ones two that run along them "
                                      "the same way; at seams two triangles carry other normals."
                                      "\vExamples:\n"
                                      "  girih info spot.glb\n"
                                      "  girih info spot.glb --json\n",
                                      NULL,
                                      NULL,
                                      NULL};

// Sums over the file.
typedef struct totals {
    uint64_t file_size; // of the file that was named, without what it refers to
    uint64_t triangles, primitives, vertices;
    float low[3], high[3]; // world, of all placements
    bool has_bounds;
} totals;

static void add_placement(totals *t, const girih_mesh *mesh, const float transform[12]) {
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * (size_t)v;
        for (int n = 0; n < 3; n++) {
            const float *row = transform + 4 * n;
            float value = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
            t->low[n] = !t->has_bounds || value < t->low[n] ? value : t->low[n];
            t->high[n] = !t->has_bounds || value > t->high[n] ? value : t->high[n];
        }
        t->has_bounds = true;
    }
}

static totals sum_up(const girih_model *model, const char *path) {
    const girih_gltf_contents *contents = model->contents;
    totals t = {0};
    struct stat status;
    if (stat(path, &status) == 0) {
        t.file_size = (uint64_t)status.st_size;
    }
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            t.primitives++;
            t.vertices += contents->meshes[m].primitives[n].vertex_count;
            t.triangles += contents->meshes[m].primitives[n].index_count / 3;
        }
    }
    for (uint32_t n = 0; n < contents->placement_count; n++) {
        uint32_t mesh = model->mesh_number[contents->placements[n].mesh];
        if (mesh != GIRIH_MODEL_NONE) {
            add_placement(&t, model->meshes[mesh], contents->placements[n].transform);
        }
    }
    return t;
}

static json_t *bounds_json(const float low[3], const float high[3]) {
    return json_pack("{s:[f,f,f], s:[f,f,f]}", "min", (double)low[0], (double)low[1],
                     (double)low[2], "max", (double)high[0], (double)high[1], (double)high[2]);
}

static json_t *mesh_json(const girih_model *model, uint32_t number) {
    const girih_mesh *mesh = model->meshes[number];
    uint32_t source = model->mesh_source[number];
    return json_pack("{s:s, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:b, s:o}", "name",
                     mesh->name, "mesh", (int)source, "primitives",
                     (int)model->contents->meshes[source].primitive_count, "triangles",
                     (int)mesh->triangle_count, "edges", (int)mesh->edge_count, "open",
                     (int)mesh->open_edges, "nonmanifold", (int)mesh->nonmanifold_edges, "flipped",
                     (int)mesh->flipped_edges, "seams", (int)mesh->seam_count, "degenerate",
                     (int)mesh->dropped_triangles, "missing_normals", mesh->made_normals != 0,
                     "bounds", bounds_json(mesh->bounds_min, mesh->bounds_max));
}

static json_t *info_json(const girih_model *model, const totals *t) {
    const girih_gltf_contents *contents = model->contents;
    json_t *meshes = json_array();
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        json_array_append_new(meshes, mesh_json(model, n));
    }
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:o, s:o}", "bytes",
        (json_int_t)t->file_size, "triangles", (json_int_t)t->triangles, "primitives",
        (json_int_t)t->primitives, "vertices", (json_int_t)t->vertices, "materials",
        (int)contents->material_count, "images", (int)contents->image_count, "cameras",
        (int)contents->camera_count, "placements", (int)contents->placement_count, "animations",
        (int)contents->animation_count, "skins", (int)contents->skin_count, "morph_targets",
        (int)contents->morph_target_count, "skipped_primitives", (int)contents->skipped_primitives,
        "bounds", t->has_bounds ? bounds_json(t->low, t->high) : json_null(), "meshes", meshes);
}

static void print_text(const girih_model *model, const totals *t) {
    const girih_gltf_contents *contents = model->contents;
    printf("%" PRIu64 " bytes, %" PRIu64 " triangles, %" PRIu64 " vertices, %" PRIu64
           " primitives\n",
           t->file_size, t->triangles, t->vertices, t->primitives);
    printf("%u materials, %u images, %u cameras, %u meshes placed in the scene\n",
           contents->material_count, contents->image_count, contents->camera_count,
           contents->placement_count);
    if (contents->animation_count + contents->skin_count + contents->morph_target_count != 0) {
        printf("%u animations, %u skins, %u morph targets (refine leaves them out)\n",
               contents->animation_count, contents->skin_count, contents->morph_target_count);
    }
    if (contents->skipped_primitives != 0) {
        printf("%u primitives of points or lines\n", contents->skipped_primitives);
    }
    if (t->has_bounds) {
        printf("bounds %g %g %g to %g %g %g\n", (double)t->low[0], (double)t->low[1],
               (double)t->low[2], (double)t->high[0], (double)t->high[1], (double)t->high[2]);
    }
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        const girih_mesh *mesh = model->meshes[n];
        printf("%s: %u triangles, %u edges: open %u, non-manifold %u, flipped %u, seams %u",
               mesh->name, mesh->triangle_count, mesh->edge_count, mesh->open_edges,
               mesh->nonmanifold_edges, mesh->flipped_edges, mesh->seam_count);
        if (mesh->dropped_triangles != 0) {
            printf("; %u degenerate triangles", mesh->dropped_triangles);
        }
        puts(mesh->made_normals ? "; no normals" : "");
    }
}

int girih_command_info(int argc, char **argv) {
    info_options options = {0};
    girih_options_parse(&info_argp, argc, argv, &options);
    girih_model model;
    girih_surface_options surface = {.surface = GIRIH_SURFACE_PN, .crease_degrees = 60.0f};
    girih_error error = {.result = GIRIH_OK};
    if (girih_model_load(&model, options.model, GIRIH_MODEL_TOPOLOGY, &surface, &error) !=
        GIRIH_OK) {
        return girih_report_failure(options.model, error.message);
    }
    totals t = sum_up(&model, options.model);
    int code = GIRIH_EXIT_DONE;
    if (options.json) {
        code = girih_report_print(info_json(&model, &t));
    } else {
        print_text(&model, &t);
    }
    girih_model_free(&model);
    return code;
}
