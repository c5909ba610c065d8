// The run-time shader compiler: what it makes, and the file and line that its messages give.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "folder.h"
#include "shader_compiler.h"

// As a surface's: something before the user's function, which it may use, and something after it
// that calls it.
static const girih_shader_include library[] = {
    {"patch.glsl", "#ifndef PATCH\n#define PATCH\n#include \"scale.glsl\"\n"
                   "struct Patch { vec3 corner; };\n"
                   "vec3 surface(Patch patch_, vec3 barycentric);\n#endif\n"},
    {"scale.glsl", "#if 0\n#include \"nowhere\"\n#else\nconst float SCALE = 2.0;\n#endif"},
};

static const char source[] = "#version 450\n"
                             "#extension GL_GOOGLE_include_directive : require\n"
                             "#include \"patch.glsl\"\n"
                             "#include \"" GIRIH_SHADER_USER_FILE "\"\n"
                             "layout(local_size_x = 1) in;\n"
                             "layout(std430, binding = 0) buffer Out { vec4 result[]; };\n"
                             "void main() {\n"
                             "    Patch p = Patch(vec3(1.0));\n"
                             "    result[0] = vec4(surface(p, vec3(SCALE)), 1.0);\n"
                             "}\n";

static girih_error failure;

static bool compile_stage(girih_shader_stage stage, const char *text, const char *user_file,
                          uint32_t **words, size_t *bytes) {
    char path[600] = "";
    if (user_file != NULL) {
        snprintf(path, sizeof path, "%s", folder_path(user_file));
    }
    girih_shader_request request = {
        .stage = stage,
        .source = text,
        .source_name = "wrapper",
        .includes = library,
        .include_count = sizeof library / sizeof library[0],
        .user_file = user_file != NULL ? path : NULL,
        .function = "surface",
        .declaration = "vec3 surface(Patch, vec3)",
    };
    failure = (girih_error){0};
    girih_result result = girih_shader_compile(&request, words, bytes, &failure);
    assert_true((*words != NULL) == (result == GIRIH_OK));
    assert_int_equal(failure.result, result);
    assert_null(strchr(failure.message, '\n'));
    return result == GIRIH_OK;
}

static void assert_compiles(const char *user_file) {
    uint32_t *words;
    size_t bytes;
    if (!compile_stage(GIRIH_SHADER_COMPUTE, source, user_file, &words, &bytes)) {
        fail_msg("%s", failure.message);
    }
    assert_true(bytes > 20 && bytes % 4 == 0);
    assert_int_equal(words[0], 0x07230203); // SPIR-V
    assert_int_equal(words[1], 0x00010300); // 1.3
    free(words);
}

// The whole message but for the folder.
static void assert_fails(const char *user_file, const char *expected) {
    uint32_t *words;
    size_t bytes;
    if (compile_stage(GIRIH_SHADER_COMPUTE, source, user_file, &words, &bytes)) {
        free(words);
        fail_msg("compiled, instead of: %s", expected);
    }
    char folder[600];
    snprintf(folder, sizeof folder, "%s", folder_path(""));
    const char *got = failure.message;
    if (strncmp(got, folder, strlen(folder)) != 0 || strcmp(got + strlen(folder), expected) != 0) {
        fail_msg("'%s' instead of '%s'", got, expected);
    }
}

static void write_text(const char *name, const char *text) {
    folder_write(name, text, strlen(text));
}

#define GOOD "vec3 surface(Patch patch_, vec3 b) {\n    return patch_.corner * b * SCALE;\n}\n"

static void good_surfaces_compile(void **state) {
    (void)state;
    write_text("good.glsl", GOOD);
    assert_compiles("good.glsl");
    write_text("no newline.glsl", "vec3 surface(Patch patch_, vec3 b) { return b; } // end");
    assert_compiles("no newline.glsl");
    write_text("windows.glsl", "#ifdef PATCH\r\n#include \"good.glsl\"\r\n#endif\r\n");
    assert_compiles("windows.glsl");
    write_text("quote\"d.glsl", GOOD); // names are no part of the text that glslang reads
    assert_compiles("quote\"d.glsl");
}

static void vertex_shaders_compile(void **state) {
    (void)state;
    uint32_t *words;
    size_t bytes;
    if (!compile_stage(GIRIH_SHADER_VERTEX,
                       "#version 450\nvoid main() {\n    gl_Position = vec4(0.0);\n}\n", NULL,
                       &words, &bytes)) {
        fail_msg("%s", failure.message);
    }
    free(words);
    assert_false(compile_stage(GIRIH_SHADER_VERTEX, "#version 450\n\nvoid main() { x = 1; }\n",
                               NULL, &words, &bytes));
    assert_string_equal(failure.message, "wrapper:3: 'x' : undeclared identifier, and 1 more");
}

// Includes come from beside the includer before they come from memory; guards and inactive lines
// are respected.
static void includes_are_found(void **state) {
    (void)state;
    write_text("scale.glsl", "#define MINE 3.0\n");
    write_text("half.glsl", "#ifndef HALF\n#define HALF\n#include \"ring.glsl\"\n"
                            "float half_of(float x) { return 0.5 * x; }\n#endif\n");
    write_text("ring.glsl", "/* a ring */\n\n#ifndef RING\n#define RING\n#include \"half.glsl\"\n"
                            "float ring = 1.0;\n#endif\n");
    write_text("user.glsl",
               "#include \"scale.glsl\"\n"
               "#include <patch.glsl>\n"
               "  #  include \"half.glsl\" // twice\n"
               "#include \"half.glsl\"\n"
               "// #include \"none\"\n"
               "/*\n#include \"none\"\n*/\n"
               "#ifdef NEVER\n#include \"none\"\n#include \"user.glsl\"\n#endif\n"
               "vec3 surface(Patch patch_, vec3 b) { return b * half_of(MINE) * ring; }\n");
    assert_compiles("user.glsl");
}

static void errors_have_the_users_lines(void **state) {
    (void)state;
    write_text("syntax.glsl", "// one\nvec3 surface(Patch patch_, vec3 b) {\n    return b +;\n}\n");
    assert_fails("syntax.glsl", "syntax.glsl:3: '' :  syntax error, unexpected SEMICOLON");
    write_text("type.glsl", "vec3 surface(Patch patch_, vec3 b) {\n\n    return patch_.edge;\n}\n");
    assert_fails("type.glsl",
                 "type.glsl:3: 'edge' : no such field in structure 'patch_', and 1 more");
    write_text("quote\"d.glsl", "\n\n\nfloat x = y;\n" GOOD);
    assert_fails("quote\"d.glsl", "quote\"d.glsl:4: 'y' : undeclared identifier");
    write_text("error.glsl", GOOD "#error no: this one\n");
    assert_fails("error.glsl", "error.glsl:4: '#error' : no : this one");
    // Behind includes, inactive ones among them.
    write_text("good.glsl", GOOD);
    write_text("behind.glsl",
               "#if 0\n#include \"good.glsl\"\n#include \"good.glsl\"\n#else\n"
               "float before = 1.0;\n#endif\n#include \"good.glsl\"\nint after = z;\n");
    assert_fails("behind.glsl", "behind.glsl:8: 'z' : undeclared identifier, and 1 more");
    // In a file that an included one includes.
    write_text("outer.glsl", "\n#include \"middle.glsl\"\n" GOOD);
    write_text("middle.glsl", "\n\n#include \"inner.glsl\"\n");
    write_text("inner.glsl", "\n\n\n\nfloat inner() { return q; }\n");
    assert_fails("outer.glsl", "inner.glsl:5: 'q' : undeclared identifier, and 1 more");
    // Lines that the user numbers.
    write_text("numbered.glsl",
               "#line 200\nfloat a = 1.0;\n#if 1\n#endif\nfloat b = nothing;\n" GOOD);
    assert_fails("numbered.glsl", "numbered.glsl:203: 'nothing' : undeclared identifier");
}

static void missing_function_is_named(void **state) {
    (void)state;
    static const char lacks[] = ": defines no function `vec3 surface(Patch, vec3)`";
    char expected[200];
    snprintf(expected, sizeof expected, "empty.glsl%s", lacks);
    write_text("empty.glsl", "");
    assert_fails("empty.glsl", expected);
    snprintf(expected, sizeof expected, "other.glsl%s", lacks);
    write_text("other.glsl",
               "vec3 surface(Patch patch_, vec2 b) {\n    return patch_.corner;\n}\n");
    assert_fails("other.glsl", expected);
    snprintf(expected, sizeof expected, "declared.glsl%s", lacks);
    write_text("declared.glsl", "vec3 surface(Patch patch_, vec3 b);\n");
    assert_fails("declared.glsl", expected);
}

static void failed_includes_are_named(void **state) {
    (void)state;
    write_text("missing.glsl", "float x;\n#include \"none.glsl\"\n" GOOD);
    assert_fails("missing.glsl",
                 "missing.glsl:2: cannot include 'none.glsl': there is no such file");
    write_text("folder.glsl", "#include \".\"\n" GOOD);
    assert_fails("folder.glsl", "folder.glsl:1: cannot include '.': is no regular file");
    write_text("itself.glsl", GOOD "\n#include \"itself.glsl\"\n");
    assert_fails("itself.glsl", "itself.glsl:5: 'itself.glsl' includes itself");
    write_text("ping.glsl", GOOD "#include \"pong.glsl\"\n");
    write_text("pong.glsl", "// back\n#include \"./ping.glsl\"\n");
    assert_fails("ping.glsl", "pong.glsl:2: './ping.glsl' includes itself");
    assert_fails("absent.glsl", "absent.glsl: there is no such file");
    folder_write("binary.glsl", "a\0b", 3);
    assert_fails("binary.glsl", "binary.glsl: is no text");
    for (int n = 0; n < 70; n++) {
        char name[32], text[64];
        snprintf(name, sizeof name, "deep%d.glsl", n);
        snprintf(text, sizeof text, "#include \"deep%d.glsl\"\n", n + 1);
        write_text(name, text);
    }
    assert_fails("deep0.glsl", "deep63.glsl:1: files that include files, more than 64 deep");
    // Twice the text with every level.
    for (int n = 0; n < 40; n++) {
        char name[32], text[100];
        snprintf(name, sizeof name, "wide%d.glsl", n);
        snprintf(text, sizeof text, "#include \"wide%d.glsl\"\n#include \"wide%d.glsl\"\n", n + 1,
                 n + 1);
        write_text(name, text);
    }
    write_text("wide40.glsl", "// the end\n");
    assert_fails("wide0.glsl", "wide0.glsl: with its includes more than 16 MiB");
}

// girih's own GLSL as it is built in, with surfaces that stand on it, in baking and in drawing.
static void library_is_whole(void **state) {
    (void)state;
    static const char head[] = "#version 450\n#extension GL_GOOGLE_include_directive : require\n";
    static const char draw[] =
        "#define GIRIH_MODE 0\n#define GIRIH_SURFACE 2\n#define GIRIH_SET 2\n"
        "#define GIRIH_SURFACE_SET 3\n#include \"model.glsl\"\n";
    static const char *const kinds[] = {
        "#define GIRIH_BAKE\n#include \"girih.glsl\"\n",
        "#define GIRIH_BAKE\n#define GIRIH_FEW_BUFFERS\n#include \"girih.glsl\"\n", draw};
    static const char *const surfaces[] = {
        "#include \"" GIRIH_SHADER_USER_FILE "\"\n",
        "#define HEIGHT_MAP_FLOAT 0u\n#define HEIGHT_PER_UNIT 1.0\n#define HEIGHT_ZERO 0.0\n"
        "#define HEIGHT_LOW 0.0\n#define HEIGHT_HIGH 1.0\n"
        "#include \"displaced.glsl\"\n"};
    write_text("base.glsl", "#include \"girih.glsl\"\n#include <displace.glsl>\n"
                            "vec3 girih_surface(GirihPatch patch_, vec3 b) {\n"
                            "    return girih_base_position(patch_, b);\n}\n");
    char path[600];
    snprintf(path, sizeof path, "%s", folder_path("base.glsl"));
    for (int kind = 0; kind < 3; kind++) {
        for (int surface = 0; surface < 2; surface++) {
            char text[1000];
            snprintf(text, sizeof text, "%s%s%s", head, kinds[kind], surfaces[surface]);
            girih_shader_request request = {
                .stage = kind == 2 ? GIRIH_SHADER_VERTEX : GIRIH_SHADER_COMPUTE,
                .source = text,
                .source_name = "wrapper",
                .includes = girih_shader_library,
                .include_count = girih_shader_library_count,
                .user_file = path,
            };
            uint32_t *words;
            size_t bytes;
            failure = (girih_error){0};
            if (girih_shader_compile(&request, &words, &bytes, &failure) != GIRIH_OK) {
                fail_msg("kind %d, surface %d: %s", kind, surface, failure.message);
            }
            free(words);
        }
    }
}

// Any beginning of a source is compiled or refused; sanitizers watch.
static void beginnings_do_no_harm(void **state) {
    (void)state;
    static const char whole[] =
        "#ifndef A\n#define A\n#include \"inner.glsl\"\n/* c */ // d\n"
        "#line 3 \"x\"\n#endif\n#include <patch.glsl>\n#if 1\\\n\n" GOOD "#else\n#endif";
    write_text("inner.glsl", "#define B\n");
    for (size_t size = 0; size < sizeof whole; size += 3) {
        folder_write("part.glsl", whole, size);
        uint32_t *words;
        size_t bytes;
        if (compile_stage(GIRIH_SHADER_COMPUTE, source, "part.glsl", &words, &bytes)) {
            free(words);
        } else {
            assert_true(failure.message[0] != '\0');
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_surfaces_compile),     cmocka_unit_test(vertex_shaders_compile),
        cmocka_unit_test(includes_are_found),        cmocka_unit_test(errors_have_the_users_lines),
        cmocka_unit_test(missing_function_is_named), cmocka_unit_test(failed_includes_are_named),
        cmocka_unit_test(library_is_whole),          cmocka_unit_test(beginnings_do_no_harm),
    };
    return cmocka_run_group_tests(tests, folder_make, folder_remove);
}
