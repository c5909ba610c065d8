// girih check: looks for cracks in a model, by the exact bits of its positions.
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "audit.h"
#include "commands.h"
#include "error.h"
#include "expected.h"
#include "frame.h"
#include "report.h"

typedef struct check_options {
    const char **models; // [model_count]
    uint32_t model_count;
    const char *from;
    girih_level_options levels;
    girih_surface_options surface;
    girih_camera_options camera;
    bool json;
} check_options;

enum { KEY_FROM = GIRIH_KEY_OWN, KEY_JSON };

static const struct argp_option own_options[] = {
    {"from", KEY_FROM, "FILE", 0,
     "The model before girih refine; with the options it was refined with, what must be found is "
     "worked out",
     0},
    {"json", KEY_JSON, NULL, 0, "Print one JSON object", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

static error_t parse(int key, char *argument, struct argp_state *state) {
    check_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->levels;
        state->child_inputs[1] = &options->surface;
        state->child_inputs[2] = &options->camera;
        return 0;
    case KEY_FROM:
        options->from = argument;
        return 0;
    case KEY_JSON:
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        girih_option_models(state, &options->models, &options->model_count, argument);
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "no MODEL");
        return 0;
    case ARGP_KEY_END:
        if (options->from != NULL && options->model_count > 1) {
            argp_error(state, "--from is what one MODEL was refined from, and there are %u",
                       options->model_count);
        }
        if (options->from == NULL && options->levels.given != NULL) {
            argp_error(state, "--%s says how FILE of --from was refined, and there is no --from",
                       options->levels.given);
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&girih_level_argp, 0, NULL, 1},
                                             {&girih_surface_argp, 0, NULL, 2},
                                             {&girih_camera_argp, 0, NULL, 3},
                                             {NULL, 0, NULL, 0}};

static const struct argp check_argp = {
    own_options,
    parse,
    "MODEL...",
    "Counts, for each mesh of each MODEL and by the exact bits of the positions, open edges (one "
    "triangle), "
    "non-manifold edges "
    "(three or more), flipped edges (two triangles that run along them the same way) and "
    "degenerate triangles (two "
    "corners at one point). With --from, exits with 1 where open, non-manifold or flipped edges "
    "are not those that "
    "refining FILE must give."
    "\vExamples:\n"
    "  girih check spot.glb\n"
    "  girih check models/*.glb\n"
    "  girih refine spot.glb --segments random:7:16 -o fine.glb\n"
    "  girih check fine.glb --from spot.glb --segments random:7:16 --json\n",
    children,
    NULL,
    NULL};

// One mesh that has triangles, and the sum of all.
typedef struct row {
    const char *name;
    girih_audit audit;
    girih_expected expected;
} row;

typedef struct session {
    const check_options *options;
    const char *model;
    girih_gltf_model *file;
    girih_model from;
    girih_catalogue_source catalogue;
    girih_instance *instances;
    row *rows; // [row_count], one more for the sums
    uint32_t row_count;
} session;

static uint64_t triangle_count(const girih_gltf_mesh *mesh) {
    uint64_t count = 0;
    for (uint32_t n = 0; n < mesh->primitive_count; n++) {
        count += mesh->primitives[n].index_count / 3;
    }
    return count;
}

static girih_result audit_file(session *s, girih_error *error) {
    char message[sizeof error->message];
    char name[4096];
    snprintf(name, sizeof name, "%s", s->model);
    girih_report_progress("loading");
    s->file = girih_gltf_load(s->model, girih_report_gltf_warning, name, message, sizeof message);
    if (s->file == NULL) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s", message);
    }
    const girih_gltf_contents *contents = girih_gltf_get(s->file);
    s->rows = calloc((size_t)contents->mesh_count + 1, sizeof *s->rows);
    if (s->rows == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    girih_report_progress("auditing");
    for (uint32_t n = 0; n < contents->mesh_count; n++) {
        if (triangle_count(&contents->meshes[n]) == 0) {
            continue;
        }
        row *r = &s->rows[s->row_count++];
        r->name = contents->meshes[n].name;
        girih_result result = girih_audit_mesh(&contents->meshes[n], &r->audit, error);
        if (result != GIRIH_OK) {
            return result;
        }
    }
    girih_report_progress(NULL);
    return s->row_count != 0 ? GIRIH_OK
                             : girih_fail(error, GIRIH_ERROR_INVALID_DATA, "no triangles");
}

static girih_result expect_from(session *s, girih_error *error) {
    const check_options *options = s->options;
    girih_frame frame;
    uint32_t instance_count = 0;
    girih_result result =
        girih_catalogue_source_open(&s->catalogue, options->surface.catalogue, error);
    if (result == GIRIH_OK) {
        result = girih_model_load(&s->from, options->from, GIRIH_MODEL_TOPOLOGY, &options->surface,
                                  NULL, error);
    }
    if (result == GIRIH_OK) {
        result = girih_model_instances(&s->from, false, &s->instances, &instance_count, error);
    }
    if (result == GIRIH_OK) {
        result = girih_frame_create(&frame, &options->levels, &options->camera, &s->from,
                                    s->instances, instance_count, error);
    }
    if (result != GIRIH_OK) {
        return result;
    }
    // Refining leaves out meshes without triangles, those whose triangles are all degenerate
    // included; instances are the meshes that stay, in their order.
    if (instance_count != s->row_count) {
        return girih_fail(
            error, GIRIH_ERROR_INVALID_DATA,
            "%u meshes with triangles, where %s has %u: it is not the model this was refined from",
            instance_count, s->model, s->row_count);
    }
    girih_expected *expected = calloc((size_t)s->from.mesh_count + 1, sizeof *expected);
    if (expected == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    const girih_catalogue *catalogue = s->catalogue.catalogue;
    result = girih_expect(expected, &s->from, s->instances, instance_count, catalogue,
                          girih_segments_beyond(catalogue, &options->levels), &frame, error);
    for (uint32_t n = 0; n < instance_count; n++) {
        s->rows[n].expected = expected[s->instances[n].mesh];
    }
    free(expected);
    return result;
}

static void add_sums(session *s) {
    row *sum = &s->rows[s->row_count];
    *sum = (row){0};
    for (uint32_t n = 0; n < s->row_count; n++) {
        const row *r = &s->rows[n];
        sum->audit.triangles += r->audit.triangles;
        sum->audit.open += r->audit.open;
        sum->audit.nonmanifold += r->audit.nonmanifold;
        sum->audit.flipped += r->audit.flipped;
        sum->audit.degenerate += r->audit.degenerate;
        sum->expected.open += r->expected.open;
        sum->expected.nonmanifold += r->expected.nonmanifold;
        sum->expected.flipped += r->expected.flipped;
    }
}

static bool is_as_expected(const row *r) {
    return r->audit.open == r->expected.open && r->audit.nonmanifold == r->expected.nonmanifold &&
           r->audit.flipped == r->expected.flipped;
}

static json_t *row_json(const row *r, bool with_expected) {
    json_t *json =
        json_pack("{s:s*, s:I, s:I, s:I, s:I, s:I}", "name", r->name, "triangles",
                  (json_int_t)r->audit.triangles, "open", (json_int_t)r->audit.open, "nonmanifold",
                  (json_int_t)r->audit.nonmanifold, "flipped", (json_int_t)r->audit.flipped,
                  "degenerate", (json_int_t)r->audit.degenerate);
    if (json != NULL && with_expected) {
        json_t *expected = json_pack(
            "{s:I, s:I, s:I, s:b}", "expected_open", (json_int_t)r->expected.open,
            "expected_nonmanifold", (json_int_t)r->expected.nonmanifold, "expected_flipped",
            (json_int_t)r->expected.flipped, "as_expected", is_as_expected(r));
        json_object_update(json, expected);
        json_decref(expected);
    }
    return json;
}

// A file's object; NULL where memory ran out.
static json_t *file_json(const session *s, bool as_expected) {
    bool with_expected = s->options->from != NULL;
    json_t *root = row_json(&s->rows[s->row_count], with_expected);
    json_t *meshes = json_array();
    for (uint32_t n = 0; n < s->row_count; n++) {
        json_array_append_new(meshes, row_json(&s->rows[n], with_expected));
    }
    json_object_set_new(root, "meshes", meshes);
    if (with_expected) {
        json_object_set_new(root, "as_expected", json_boolean(as_expected));
    }
    if (s->options->model_count > 1) {
        json_object_set_new(root, "file", json_string(s->model));
    }
    return root;
}

static void print_row(const session *s, const char *name, const row *r) {
    if (s->options->model_count > 1) {
        printf("%s: ", s->model);
    }
    printf("%s: %" PRIu64 " triangles, open %" PRIu64 ", non-manifold %" PRIu64 ", flipped %" PRIu64
           ", degenerate %" PRIu64,
           name, r->audit.triangles, r->audit.open, r->audit.nonmanifold, r->audit.flipped,
           r->audit.degenerate);
    if (s->options->from != NULL) {
        bool is_good = is_as_expected(r);
        fputs(girih_report_style(stdout, is_good ? GIRIH_STYLE_GOOD : GIRIH_STYLE_FAILURE), stdout);
        if (is_good) {
            fputs(": as expected", stdout);
        } else {
            printf(": EXPECTED open %" PRIu64 ", non-manifold %" PRIu64 ", flipped %" PRIu64,
                   r->expected.open, r->expected.nonmanifold, r->expected.flipped);
        }
        fputs(girih_report_style(stdout, GIRIH_STYLE_PLAIN), stdout);
    }
    putchar('\n');
}

static void print_text(const session *s) {
    for (uint32_t n = 0; n < s->row_count; n++) {
        print_row(s, s->rows[n].name, &s->rows[n]);
    }
    if (s->row_count > 1) {
        print_row(s, "all", &s->rows[s->row_count]);
    }
}

// Checks one file; what --json prints goes into *json. Returns an exit code.
static int check_file(const check_options *options, const char *model, json_t **json) {
    session s = {.options = options, .model = model};
    girih_error error = {.result = GIRIH_OK};
    const char *file = model;
    girih_result result = audit_file(&s, &error);
    if (result == GIRIH_OK && options->from != NULL) {
        file = options->from;
        result = expect_from(&s, &error);
    }
    int code = GIRIH_EXIT_DONE;
    if (result != GIRIH_OK) {
        code = girih_report_failure(file, error.message);
    } else {
        bool as_expected = true;
        add_sums(&s);
        for (uint32_t n = 0; n < s.row_count && options->from != NULL; n++) {
            as_expected &= is_as_expected(&s.rows[n]);
        }
        if (options->json) {
            *json = file_json(&s, as_expected);
        } else {
            print_text(&s);
        }
        code = as_expected ? code : GIRIH_EXIT_FAILED;
    }
    free(s.rows);
    free(s.instances);
    girih_model_free(&s.from);
    girih_catalogue_source_free(&s.catalogue);
    girih_gltf_destroy(s.file);
    return code;
}

int girih_command_check(int argc, char **argv) {
    check_options options = {0};
    girih_options_parse(&check_argp, argc, argv, &options);
    int code = GIRIH_EXIT_DONE;
    json_t *files = json_array();
    for (uint32_t n = 0; n < options.model_count; n++) {
        json_t *json = NULL;
        girih_report_part("file", n, options.model_count);
        if (check_file(&options, options.models[n], &json) != GIRIH_EXIT_DONE) {
            code = GIRIH_EXIT_FAILED;
        }
        if (json != NULL) {
            json_array_append_new(files, json);
        }
    }
    if (options.json) {
        int printed = girih_report_print_files(files, options.model_count);
        code = code != GIRIH_EXIT_DONE ? code : printed;
    } else {
        json_decref(files);
    }
    free(options.models);
    return code;
}
