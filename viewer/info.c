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
    case KEY_JSON:
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        girih_option_model(state, &options->model, argument);
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no MODEL");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp info_argp = {own_options,
                                      parse,
                                      "MODEL",
                                      "Says what MODEL (.gltf or .glb) holds, how sound its "
                                      "meshes are and what refining would make of them. Open "
                                      "edges have one triangle, non-manifold ones three or more, "
                                      "flipped ones two that run along them the same way; at "
                                      "seams the two sides have vertices of their own, at hard "
                                      "edges other normals too."
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
    uint64_t edges, open, nonmanifold, flipped, seams, hard_edges, degenerate; // of all meshes
    uint32_t without_normals;                                                  // meshes
    float edge_length[3];  // shortest, median and longest, in mesh units; 0 without edges
    float low[3], high[3]; // world, of all placements
    bool has_bounds;
} totals;

static void add_placement(totals *t, const float *positions, uint32_t vertex_count,
                          const float transform[12]) {
    for (uint32_t v = 0; v < vertex_count; v++) {
        const float *p = positions + 3 * (size_t)v;
        for (int n = 0; n < 3; n++) {
            const float *row = transform + 4 * n;
            float value = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
            t->low[n] = !t->has_bounds || value < t->low[n] ? value : t->low[n];
            t->high[n] = !t->has_bounds || value > t->high[n] ? value : t->high[n];
        }
        t->has_bounds = true;
    }
}

// What a node deforms, as it is in a pose: number is of the model's meshes.
static girih_result add_deformed(totals *t, const girih_model *model, uint32_t number,
                                 const girih_pose *pose, uint32_t node, const float transform[12],
                                 girih_error *error) {
    const girih_mesh *mesh = model->meshes[number];
    const girih_gltf_mesh *source = &model->contents->meshes[model->mesh_source[number]];
    size_t floats = 3 * (size_t)mesh->vertex_count;
    float *vertices = malloc((2 * floats + 1) * sizeof *vertices);
    girih_deformer deformer = {0};
    bool is_done = vertices != NULL &&
                   girih_deformer_create(&deformer, source, model->vertex_sources[number],
                                         mesh->vertex_count) &&
                   girih_deform(&deformer, pose, node, mesh->positions, mesh->normals, vertices,
                                vertices + floats);
    if (is_done) {
        add_placement(t, vertices, mesh->vertex_count, transform);
    }
    girih_deformer_free(&deformer);
    free(vertices);
    return is_done ? GIRIH_OK : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

// The bounds of all placements as the file's nodes are by themselves.
static girih_result add_placements(totals *t, const girih_model *model, girih_error *error) {
    const girih_gltf_contents *contents = model->contents;
    girih_pose pose;
    girih_result result = girih_pose_create(&pose, contents)
                              ? GIRIH_OK
                              : girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    for (uint32_t n = 0; n < contents->placement_count && result == GIRIH_OK; n++) {
        uint32_t number = model->mesh_number[contents->placements[n].mesh];
        if (number == GIRIH_MODEL_NONE) {
            continue;
        }
        const girih_mesh *mesh = model->meshes[number];
        const girih_gltf_placement *placement = &pose.contents.placements[n];
        uint32_t node = pose.mesh_nodes[placement->mesh];
        if (node == GIRIH_GLTF_NO_NODE) {
            add_placement(t, mesh->positions, mesh->vertex_count, placement->transform);
        } else {
            result = add_deformed(t, model, number, &pose, node, placement->transform, error);
        }
    }
    girih_pose_free(&pose);
    for (int c = 0; c < 3 && result == GIRIH_OK; c++) {
        if (!isfinite(t->low[c]) || !isfinite(t->high[c])) {
            result = girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                                "its nodes place vertices beyond the range of floats");
        }
    }
    return result;
}

// Edges whose sides have vertices of their own. Two sides have two weld edges, one of which stands
// for both.
static uint32_t count_seams(const girih_mesh *mesh) {
    return mesh->weld_edge_count - mesh->edge_count;
}

// Edges whose two triangles have other normals: girih's seams, but for those where more triangles
// meet.
static uint32_t count_hard_edges(const girih_mesh *mesh) {
    uint32_t count = 0;
    for (uint32_t edge = 0; edge < mesh->seam_count; edge++) {
        count += mesh->edge_uses[edge] == 2;
    }
    return count;
}

static void add_mesh(totals *t, const girih_mesh *mesh) {
    t->edges += mesh->edge_count;
    t->open += mesh->open_edges;
    t->nonmanifold += mesh->nonmanifold_edges;
    t->flipped += mesh->flipped_edges;
    t->seams += count_seams(mesh);
    t->hard_edges += count_hard_edges(mesh);
    t->degenerate += mesh->dropped_triangles;
    t->without_normals += mesh->made_normals != 0;
}

static int compare_lengths(const void *a, const void *b) {
    const float left = *(const float *)a;
    const float right = *(const float *)b;
    return (left > right) - (left < right);
}

static girih_result measure_edges(totals *t, const girih_model *model, girih_error *error) {
    float *lengths = malloc((size_t)t->edges * sizeof *lengths + 1);
    if (lengths == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    size_t count = 0;
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        const girih_mesh *mesh = model->meshes[n];
        for (uint32_t edge = 0; edge < mesh->edge_count; edge++) {
            const float *a = mesh->positions + 3 * (size_t)mesh->edge_points[2 * (size_t)edge];
            const float *b = mesh->positions + 3 * (size_t)mesh->edge_points[2 * (size_t)edge + 1];
            lengths[count++] = hypotf(hypotf(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
        }
    }
    if (count != 0) {
        qsort(lengths, count, sizeof *lengths, compare_lengths);
        t->edge_length[0] = lengths[0];
        t->edge_length[1] = lengths[count / 2];
        t->edge_length[2] = lengths[count - 1];
    }
    free(lengths);
    return GIRIH_OK;
}

static girih_result sum_up(totals *t, const girih_model *model, const char *path,
                           girih_error *error) {
    const girih_gltf_contents *contents = model->contents;
    *t = (totals){0};
    struct stat status;
    if (stat(path, &status) == 0) {
        t->file_size = (uint64_t)status.st_size;
    }
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            t->primitives++;
            t->vertices += contents->meshes[m].primitives[n].vertex_count;
            t->triangles += contents->meshes[m].primitives[n].index_count / 3;
        }
    }
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        add_mesh(t, model->meshes[n]);
    }
    girih_result result = add_placements(t, model, error);
    return result == GIRIH_OK ? measure_edges(t, model, error) : result;
}

// The names of all primitives' attributes, each once, in the order of their first appearance, with
// how many primitives have it.
typedef struct attribute_use {
    const char *name;
    uint64_t primitives;
} attribute_use;

enum { MOST_ATTRIBUTES = 64 };

typedef struct attribute_uses {
    attribute_use uses[MOST_ATTRIBUTES];
    uint32_t count;
} attribute_uses;

static void add_attribute(attribute_uses *all, const char *name) {
    uint32_t n = 0;
    while (n < all->count && strcmp(all->uses[n].name, name) != 0) {
        n++;
    }
    if (n < MOST_ATTRIBUTES) {
        all->count = n == all->count ? n + 1 : all->count;
        all->uses[n].name = name;
        all->uses[n].primitives++;
    }
}

static attribute_uses find_attributes(const girih_gltf_contents *contents) {
    attribute_uses all = {.count = 0};
    for (uint32_t m = 0; m < contents->mesh_count; m++) {
        for (uint32_t n = 0; n < contents->meshes[m].primitive_count; n++) {
            const girih_gltf_primitive *primitive = &contents->meshes[m].primitives[n];
            add_attribute(&all, "POSITION");
            if (primitive->normals != NULL) {
                add_attribute(&all, "NORMAL");
            }
            for (uint32_t a = 0; a < primitive->attribute_count; a++) {
                add_attribute(&all, primitive->attributes[a].name);
            }
            if (primitive->influence_count != 0) {
                add_attribute(&all, "JOINTS and WEIGHTS");
            }
        }
    }
    return all;
}

// --- JSON ---

static json_t *bounds_json(const float low[3], const float high[3]) {
    return json_pack("{s:[f,f,f], s:[f,f,f]}", "min", (double)low[0], (double)low[1],
                     (double)low[2], "max", (double)high[0], (double)high[1], (double)high[2]);
}

static json_t *mesh_json(const girih_model *model, uint32_t number) {
    const girih_mesh *mesh = model->meshes[number];
    uint32_t source = model->mesh_source[number];
    return json_pack(
        "{s:s, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:b, s:o}", "name", mesh->name,
        "mesh", (int)source, "primitives", (int)model->contents->meshes[source].primitive_count,
        "triangles", (int)mesh->triangle_count, "edges", (int)mesh->edge_count, "open",
        (int)mesh->open_edges, "nonmanifold", (int)mesh->nonmanifold_edges, "flipped",
        (int)mesh->flipped_edges, "seams", (int)count_seams(mesh), "hard_edges",
        (int)count_hard_edges(mesh), "degenerate", (int)mesh->dropped_triangles, "missing_normals",
        mesh->made_normals != 0, "bounds", bounds_json(mesh->bounds_min, mesh->bounds_max));
}

static json_t *attributes_json(const girih_gltf_contents *contents) {
    attribute_uses all = find_attributes(contents);
    json_t *names = json_object();
    for (uint32_t n = 0; n < all.count; n++) {
        json_object_set_new(names, all.uses[n].name,
                            json_integer((json_int_t)all.uses[n].primitives));
    }
    return names;
}

static json_t *animations_json(const girih_gltf_contents *contents) {
    json_t *animations = json_array();
    for (uint32_t n = 0; n < contents->animation_count; n++) {
        const girih_gltf_animation *animation = &contents->animations[n];
        json_array_append_new(animations,
                              json_pack("{s:s*, s:f, s:f, s:i}", "name", animation->name, "start",
                                        (double)animation->start, "end", (double)animation->end,
                                        "channels", (int)animation->channel_count));
    }
    return animations;
}

static json_t *info_json(const girih_model *model, const totals *t) {
    const girih_gltf_contents *contents = model->contents;
    json_t *meshes = json_array();
    for (uint32_t n = 0; n < model->mesh_count; n++) {
        json_array_append_new(meshes, mesh_json(model, n));
    }
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:o, s:[f,f,f], s:i, s:i, s:i, s:i, s:i, s:o, s:i, s:i, s:i, s:o, "
        "s:o}",
        "bytes", (json_int_t)t->file_size, "triangles", (json_int_t)t->triangles, "primitives",
        (json_int_t)t->primitives, "vertices", (json_int_t)t->vertices, "attributes",
        attributes_json(contents), "edge_length_min_median_max", (double)t->edge_length[0],
        (double)t->edge_length[1], (double)t->edge_length[2], "materials",
        (int)contents->material_count, "images", (int)contents->image_count, "cameras",
        (int)contents->camera_count, "placements", (int)contents->placement_count, "animations",
        (int)contents->animation_count, "animation_times", animations_json(contents), "skins",
        (int)contents->skin_count, "morph_targets", (int)contents->morph_target_count,
        "skipped_primitives", (int)contents->skipped_primitives, "bounds",
        t->has_bounds ? bounds_json(t->low, t->high) : json_null(), "meshes", meshes);
}

// --- Text, no more than a screenful ---

// Lines of meshes and of animations; more are counted.
enum { MOST_MESHES = 10, MOST_ANIMATIONS = 6 };

// A number with commas between its thousands.
typedef struct count_text {
    char text[32];
} count_text;

static count_text count_of(uint64_t number) {
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%" PRIu64, number);
    count_text written = {{0}};
    size_t at = 0;
    for (int n = 0; n < length; n++) {
        if (n > 0 && (length - n) % 3 == 0) {
            written.text[at++] = ',';
        }
        written.text[at++] = digits[n];
    }
    return written;
}

// A line's label, where there is one.
static void begin_line(const char *label) {
    printf("  %s%-11s%s", girih_report_style(stdout, GIRIH_STYLE_LABEL), label,
           girih_report_style(stdout, GIRIH_STYLE_PLAIN));
}

// "number one" or "number many"; seen at once where it is a fault and not 0.
static void print_count(uint64_t number, const char *one, const char *many, bool is_fault) {
    bool is_marked = is_fault && number != 0;
    printf("%s%s %s%s", is_marked ? girih_report_style(stdout, GIRIH_STYLE_WARNING) : "",
           count_of(number).text, number == 1 ? one : many,
           is_marked ? girih_report_style(stdout, GIRIH_STYLE_PLAIN) : "");
}

static void print_size(const totals *t) {
    if (t->has_bounds) {
        begin_line("size");
        printf("%g x %g x %g, from (%g, %g, %g) to (%g, %g, %g)\n",
               (double)(t->high[0] - t->low[0]), (double)(t->high[1] - t->low[1]),
               (double)(t->high[2] - t->low[2]), (double)t->low[0], (double)t->low[1],
               (double)t->low[2], (double)t->high[0], (double)t->high[1], (double)t->high[2]);
    }
}

static void print_geometry(const girih_gltf_contents *contents, const totals *t) {
    begin_line("triangles");
    print_count(t->triangles, "in ", "in ", false);
    print_count(t->primitives, "primitive", "primitives", false);
    printf(", %s vertices", count_of(t->vertices).text);
    if (t->degenerate != 0) {
        fputs(", ", stdout);
        print_count(t->degenerate, "degenerate", "degenerate", true);
    }
    if (contents->skipped_primitives != 0) {
        printf("; beside them %s primitives of points or lines",
               count_of(contents->skipped_primitives).text);
    }
    putchar('\n');
    begin_line("attributes");
    attribute_uses all = find_attributes(contents);
    for (uint32_t n = 0; n < all.count; n++) {
        printf("%s%s", n > 0 ? ", " : "", all.uses[n].name);
        if (all.uses[n].primitives != t->primitives) {
            printf(" (in %s)", count_of(all.uses[n].primitives).text);
        }
    }
    putchar('\n');
    if (t->without_normals != 0) {
        begin_line("normals");
        printf("missing in %s of %u meshes: made smooth, hard where edges bend by more than "
               "--crease\n",
               count_of(t->without_normals).text, contents->mesh_count);
    }
}

static void print_edges(const totals *t) {
    begin_line("edges");
    printf("%s, of lengths from %g to %g, half of them below %g\n", count_of(t->edges).text,
           (double)t->edge_length[0], (double)t->edge_length[2], (double)t->edge_length[1]);
    begin_line("");
    print_count(t->open, "open", "open", true);
    fputs(", ", stdout);
    print_count(t->nonmanifold, "non-manifold", "non-manifold", true);
    fputs(", ", stdout);
    print_count(t->flipped, "flipped", "flipped", true);
    printf("; %s hard, %s at seams%s\n", count_of(t->hard_edges).text, count_of(t->seams).text,
           t->open + t->nonmanifold + t->flipped == 0 && t->edges != 0 ? ": closed" : "");
}

static void print_scene(const girih_gltf_contents *contents) {
    begin_line("scene");
    print_count(contents->placement_count, "mesh placed", "meshes placed", false);
    fputs(", ", stdout);
    print_count(contents->node_count, "node", "nodes", false);
    fputs(", ", stdout);
    print_count(contents->camera_count, "camera", "cameras", false);
    putchar('\n');
    begin_line("materials");
    print_count(contents->material_count, "material", "materials", false);
    fputs(", ", stdout);
    print_count(contents->image_count, "image", "images", false);
    for (uint32_t n = 0; n < contents->material_count && n < MOST_ANIMATIONS; n++) {
        const char *name = contents->materials[n].name;
        printf("%s%s", n == 0 ? ": " : ", ", name != NULL && name[0] != '\0' ? name : "unnamed");
    }
    puts(contents->material_count > MOST_ANIMATIONS ? ", ..." : "");
}

static void print_animations(const girih_gltf_contents *contents) {
    if (contents->animation_count == 0 && contents->skin_count == 0 &&
        contents->morph_target_count == 0) {
        return;
    }
    begin_line("animated");
    print_count(contents->animation_count, "animation", "animations", false);
    fputs(", ", stdout);
    print_count(contents->skin_count, "skin", "skins", false);
    fputs(", ", stdout);
    print_count(contents->morph_target_count, "morph target", "morph targets", false);
    putchar('\n');
    for (uint32_t n = 0; n < contents->animation_count && n < MOST_ANIMATIONS; n++) {
        const girih_gltf_animation *animation = &contents->animations[n];
        begin_line("");
        printf("%u %s: %g to %g s, %u channels\n", n, animation->name, (double)animation->start,
               (double)animation->end, animation->channel_count);
    }
    if (contents->animation_count > MOST_ANIMATIONS) {
        begin_line("");
        printf("and %u more\n", contents->animation_count - MOST_ANIMATIONS);
    }
}

static void print_meshes(const girih_model *model) {
    for (uint32_t n = 0; n < model->mesh_count && n < MOST_MESHES && model->mesh_count > 1; n++) {
        const girih_mesh *mesh = model->meshes[n];
        begin_line(n == 0 ? "meshes" : "");
        printf("%s: %s triangles, ", mesh->name, count_of(mesh->triangle_count).text);
        print_count(mesh->open_edges, "open", "open", true);
        fputs(", ", stdout);
        print_count(mesh->nonmanifold_edges, "non-manifold", "non-manifold", true);
        fputs(", ", stdout);
        print_count(mesh->flipped_edges, "flipped", "flipped", true);
        putchar('\n');
    }
    if (model->mesh_count > MOST_MESHES) {
        begin_line("");
        printf("and %u more (--json lists them all)\n", model->mesh_count - MOST_MESHES);
    }
}

static void print_text(const girih_model *model, const totals *t, const char *path) {
    printf("%s: %s bytes\n", path, count_of(t->file_size).text);
    print_scene(model->contents);
    print_size(t);
    print_geometry(model->contents, t);
    print_edges(t);
    print_animations(model->contents);
    print_meshes(model);
    uint64_t kept = t->triangles - t->degenerate;
    begin_line("refined");
    printf("--segments 4: %s triangles, 16: %s; --edge-length %.3g: about 4 segments an edge\n",
           count_of(kept * 16).text, count_of(kept * 256).text, (double)(t->edge_length[1] / 4.0f));
}

int girih_command_info(int argc, char **argv) {
    info_options options = {0};
    girih_options_parse(&info_argp, argc, argv, &options);
    girih_model model;
    girih_surface_options surface = {.surface = GIRIH_SURFACE_PN, .crease_degrees = 60.0f};
    girih_error error = {.result = GIRIH_OK};
    if (girih_model_load(&model, options.model, GIRIH_MODEL_TOPOLOGY, &surface, NULL, &error) !=
        GIRIH_OK) {
        return girih_report_failure(options.model, error.message);
    }
    totals t;
    int code = GIRIH_EXIT_DONE;
    if (sum_up(&t, &model, options.model, &error) != GIRIH_OK) {
        code = girih_report_failure(options.model, error.message);
    } else if (options.json) {
        code = girih_report_print(info_json(&model, &t));
    } else {
        print_text(&model, &t, options.model);
    }
    girih_model_free(&model);
    return code;
}
