#include "shader_compiler.h"

#include <ctype.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "input_file.h"
#include "shader_includes.h"

// What glslang has logged, cut into errors.
typedef struct error_list {
    uint32_t count, count_of_user;
    char first[400], first_of_user[400];
    bool lacks_function;
} error_list;

static void trim(char *text) {
    size_t size = strlen(text);
    while (size > 0 && isspace((unsigned char)text[size - 1])) {
        text[--size] = '\0';
    }
}

// A line "ERROR: STRING:LINE: WHAT". STRING is a number that girih_shader_expand gave out, 0 for
// the source itself, or what a #line in a user's file has put in its place.
static void take_error(const girih_shader_request *request, const girih_shader_text *text,
                       const char *line, error_list *errors) {
    size_t name_size = 0;
    unsigned long number = 0;
    const char *what = NULL;
    for (const char *colon = strchr(line, ':'); colon != NULL && what == NULL;
         colon = strchr(colon + 1, ':')) {
        char *end;
        if (isdigit((unsigned char)colon[1])) {
            number = strtoul(colon + 1, &end, 10);
            if (end[0] == ':') {
                name_size = (size_t)(colon - line);
                what = end + 1 + (end[1] == ' ');
            }
        }
    }
    if (what == NULL) {
        // "N compilation errors", or the linker's, which names no place.
        return;
    }
    char name[300];
    snprintf(name, sizeof name, "%.*s", (int)(name_size < 299 ? name_size : 299), line);
    char *end;
    unsigned long string = strtoul(name, &end, 10);
    bool is_user = true;
    const char *reason = NULL;
    if (*end == '\0' && string == 0) {
        is_user = false;
        snprintf(name, sizeof name, "%s", request->source_name);
    } else if (*end == '\0') {
        const girih_shader_file *file = girih_shader_text_file(text, string);
        is_user = file == NULL || file->is_user;
        snprintf(name, sizeof name, "%s", file != NULL ? file->name : request->source_name);
    }
    const char *marker = strstr(what, GIRIH_SHADER_FAILURE);
    if (marker != NULL) {
        reason = girih_shader_text_failure(
            text, strtoul(marker + strlen(GIRIH_SHADER_FAILURE), NULL, 10));
    }
    char message[400];
    snprintf(message, sizeof message, "%.200s:%lu: %.180s", name, number,
             reason != NULL ? reason : what);
    trim(message);
    if (errors->count++ == 0) {
        memcpy(errors->first, message, sizeof message);
    }
    if (is_user && errors->count_of_user++ == 0) {
        memcpy(errors->first_of_user, message, sizeof message);
    }
}

static void take_log(const girih_shader_request *request, const girih_shader_text *text,
                     const char *log, error_list *errors) {
    static const char mark[] = "ERROR: ";
    for (const char *line = log; line != NULL && *line != '\0';) {
        const char *end = strchr(line, '\n');
        size_t size = end != NULL ? (size_t)(end - line) : strlen(line);
        char copy[1024];
        snprintf(copy, sizeof copy, "%.*s", (int)(size < 1023 ? size : 1023), line);
        if (strncmp(copy, mark, sizeof mark - 1) == 0) {
            take_error(request, text, copy + sizeof mark - 1, errors);
        }
        line = end != NULL ? end + 1 : NULL;
    }
    // Declared, called, and defined nowhere: the linker's to find; not even declared: the parser's.
    if (request->function != NULL) {
        const char *body = strstr(log, "No function definition (body) found");
        char call[100];
        snprintf(call, sizeof call, "'%s' : no matching overloaded function", request->function);
        errors->lacks_function |= (body != NULL && strstr(body, request->function) != NULL) ||
                                  (errors->count_of_user == 0 && strstr(log, call) != NULL);
    }
}

static unsigned long count_lines(const char *path) {
    char *bytes = NULL;
    size_t size = 0;
    unsigned long lines = 1;
    if (girih_input_read(path, &bytes, &size, NULL) == GIRIH_OK) {
        for (size_t n = 0; n + 1 < size; n++) {
            lines += bytes[n] == '\n';
        }
    }
    free(bytes);
    return lines;
}

static girih_result report(const girih_shader_request *request, const error_list *errors,
                           const char *log, girih_error *error) {
    if (errors->lacks_function && errors->count_of_user == 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%.200s: defines no function `%s`",
                          request->user_file, request->declaration);
    }
    const char *whole = request->user_file != NULL ? request->user_file : request->source_name;
    if (errors->count == 0) {
        char line[300];
        snprintf(line, sizeof line, "%s", log != NULL ? log : "");
        trim(line);
        for (char *at = line; *at != '\0'; at++) {
            *at = *at == '\n' ? ' ' : *at;
        }
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%.200s: cannot be compiled: %s", whole,
                          line);
    }
    if (errors->count_of_user == 0 && request->user_file != NULL) {
        // What follows the user's text is in order, so something in it reaches beyond its end.
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "%.200s:%lu: something is not closed by the end of the file: a brace, a "
                          "parenthesis, a semicolon or an #endif is missing",
                          whole, count_lines(request->user_file));
    }
    bool has_user = errors->count_of_user != 0;
    uint32_t count = has_user ? errors->count_of_user : errors->count;
    char more[40] = "";
    if (count > 1) {
        snprintf(more, sizeof more, ", and %u more", count - 1);
    }
    return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "%s%s",
                      has_user ? errors->first_of_user : errors->first, more);
}

static girih_result take_words(glslang_program_t *program, glslang_stage_t stage, uint32_t **words,
                               size_t *bytes, girih_error *error) {
    glslang_program_SPIRV_generate(program, stage);
    size_t count = glslang_program_SPIRV_get_size(program);
    *bytes = count * sizeof **words;
    *words = malloc(*bytes + 1);
    if (*words == NULL) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    }
    glslang_program_SPIRV_get(program, *words);
    return GIRIH_OK;
}

static girih_result compile(const girih_shader_request *request, const girih_shader_text *text,
                            uint32_t **words, size_t *bytes, girih_error *error) {
    const glslang_messages_t messages = GLSLANG_MSG_SPV_RULES_BIT | GLSLANG_MSG_VULKAN_RULES_BIT;
    glslang_input_t input = {
        .language = GLSLANG_SOURCE_GLSL,
        .stage =
            request->stage == GIRIH_SHADER_VERTEX ? GLSLANG_STAGE_VERTEX : GLSLANG_STAGE_COMPUTE,
        .client = GLSLANG_CLIENT_VULKAN,
        .client_version = GLSLANG_TARGET_VULKAN_1_1,
        .target_language = GLSLANG_TARGET_SPV,
        .target_language_version = GLSLANG_TARGET_SPV_1_3,
        .code = text->bytes,
        .default_version = 450,
        .default_profile = GLSLANG_NO_PROFILE,
        .messages = messages,
        .resource = glslang_default_resource(),
    };
    glslang_shader_t *shader = glslang_shader_create(&input);
    glslang_program_t *program = glslang_program_create();
    girih_result result = GIRIH_OK;
    error_list errors = {0};
    if (shader == NULL || program == NULL) {
        result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } else if (!glslang_shader_preprocess(shader, &input) ||
               !glslang_shader_parse(shader, &input)) {
        const char *log = glslang_shader_get_info_log(shader);
        take_log(request, text, log, &errors);
        result = report(request, &errors, log, error);
    } else {
        glslang_program_add_shader(program, shader);
        if (!glslang_program_link(program, (int)messages)) {
            const char *log = glslang_program_get_info_log(program);
            take_log(request, text, log, &errors);
            result = report(request, &errors, log, error);
        } else {
            result = take_words(program, input.stage, words, bytes, error);
        }
    }
    if (program != NULL) {
        glslang_program_delete(program);
    }
    if (shader != NULL) {
        glslang_shader_delete(shader);
    }
    return result;
}

girih_result girih_shader_compile(const girih_shader_request *request, uint32_t **words,
                                  size_t *bytes, girih_error *error) {
    *words = NULL;
    *bytes = 0;
    girih_shader_text text;
    girih_result result = girih_shader_expand(request, &text, error);
    if (result == GIRIH_OK) {
        if (glslang_initialize_process()) {
            result = compile(request, &text, words, bytes, error);
            glslang_finalize_process();
        } else {
            result = girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "glslang does not start");
        }
    }
    girih_shader_text_free(&text);
    return result;
}
