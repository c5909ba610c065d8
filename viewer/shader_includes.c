#include "shader_includes.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "error.h"
#include "input_file.h"

// Beyond what shaders come to; files without a guard that include each other grow without end.
#define MAX_DEPTH 64
#define MAX_BYTES ((size_t)16 << 20)

// String numbers of files in line directives, apart from those that a user's own #line may give.
#define FIRST_STRING 1000000u

typedef struct expansion {
    const girih_shader_request *request;
    girih_shader_text *text;
    girih_error *error;
    girih_result result;
} expansion;

// One file being expanded, and the one that includes it.
typedef struct frame {
    const struct frame *includer;
    uint32_t file;
    uint32_t depth;
} frame;

#define SOURCE UINT32_MAX // the request's source is no file

static void no_memory(expansion *e) {
    e->result = girih_fail(e->error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
}

static void append(expansion *e, const char *bytes, size_t size) {
    girih_shader_text *text = e->text;
    if (e->result != GIRIH_OK) {
        return;
    }
    if (size > MAX_BYTES - text->size) {
        e->result = girih_fail(
            e->error, GIRIH_ERROR_TOO_LARGE, "%.200s: with its includes more than %zu MiB",
            e->request->user_file != NULL ? e->request->user_file : e->request->source_name,
            MAX_BYTES >> 20);
        return;
    }
    if (text->room - text->size < size + 1) {
        size_t room = 2 * text->room + size + 4096;
        char *grown = realloc(text->bytes, room);
        if (grown == NULL) {
            no_memory(e);
            return;
        }
        text->bytes = grown;
        text->room = room;
    }
    memcpy(text->bytes + text->size, bytes, size);
    text->size += size;
    text->bytes[text->size] = '\0';
}

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
append_line(expansion *e, const char *format, ...) {
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    int size = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    append(e, line, (size_t)size < sizeof line ? (size_t)size : sizeof line - 1);
}

static char *copy_text(const char *text, size_t size) {
    char *copy = malloc(size + 1);
    if (copy != NULL) {
        memcpy(copy, text, size);
        copy[size] = '\0';
    }
    return copy;
}

// Takes name and storage. Returns SOURCE where memory is short.
static uint32_t add_file(expansion *e, girih_shader_file file) {
    girih_shader_text *text = e->text;
    girih_shader_file *grown = realloc(text->files, (text->file_count + 1) * sizeof *text->files);
    if (grown == NULL || file.name == NULL) {
        text->files = grown != NULL ? grown : text->files;
        free(file.name);
        free(file.storage);
        no_memory(e);
        return SOURCE;
    }
    text->files = grown;
    text->files[text->file_count] = file;
    return text->file_count++;
}

static void fail_include(expansion *e, const char *message) {
    girih_shader_text *text = e->text;
    char **grown = realloc(text->failures, (text->failure_count + 1) * sizeof *text->failures);
    char *copy = copy_text(message, strlen(message));
    if (grown != NULL) {
        text->failures = grown;
    }
    if (grown == NULL || copy == NULL) {
        free(copy);
        no_memory(e);
        return;
    }
    text->failures[text->failure_count] = copy;
    append_line(e, "#error " GIRIH_SHADER_FAILURE "%u\n", text->failure_count++);
}

// --- Finding files ---

typedef enum search {
    FOUND,
    NOT_THERE,
    UNREADABLE, // e->result, or a message in reason
} search;

static search find_on_disk(expansion *e, char *path, uint32_t *found, girih_error *reason) {
    struct stat status;
    if (stat(path, &status) != 0) {
        free(path);
        return NOT_THERE;
    }
    for (uint32_t n = 0; n < e->text->file_count; n++) {
        const girih_shader_file *file = &e->text->files[n];
        if (file->is_user && file->device == status.st_dev && file->inode == status.st_ino) {
            free(path);
            *found = n;
            return FOUND;
        }
    }
    char *bytes = NULL;
    size_t size;
    girih_result result =
        status.st_size > (off_t)MAX_BYTES
            ? girih_fail(reason, GIRIH_ERROR_TOO_LARGE, "more than %zu MiB", MAX_BYTES >> 20)
            : girih_input_read(path, &bytes, &size, reason);
    if (result == GIRIH_OK && memchr(bytes, '\0', size) != NULL) {
        result = girih_fail(reason, GIRIH_ERROR_INVALID_DATA, "is no text");
    }
    if (result != GIRIH_OK) {
        free(bytes);
        free(path);
        return UNREADABLE;
    }
    *found =
        add_file(e, (girih_shader_file){path, bytes, true, bytes, status.st_dev, status.st_ino});
    return *found != SOURCE ? FOUND : UNREADABLE;
}

static search find_in_memory(expansion *e, const char *name, uint32_t *found) {
    for (uint32_t n = 0; n < e->text->file_count; n++) {
        if (!e->text->files[n].is_user && strcmp(e->text->files[n].name, name) == 0) {
            *found = n;
            return FOUND;
        }
    }
    for (uint32_t n = 0; n < e->request->include_count; n++) {
        if (strcmp(e->request->includes[n].name, name) == 0) {
            girih_shader_file file = {.name = copy_text(name, strlen(name)),
                                      .text = e->request->includes[n].text};
            *found = add_file(e, file);
            return *found != SOURCE ? FOUND : UNREADABLE;
        }
    }
    return NOT_THERE;
}

// The path of a name beside a file, or the name itself where it begins at the root.
static char *beside(const char *path, const char *name) {
    const char *slash = strrchr(path, '/');
    size_t folder = name[0] == '/' || slash == NULL ? 0 : (size_t)(slash - path) + 1;
    char *joined = malloc(folder + strlen(name) + 1);
    if (joined != NULL) {
        memcpy(joined, path, folder);
        memcpy(joined + folder, name, strlen(name) + 1);
    }
    return joined;
}

static search find(expansion *e, const frame *includer, const char *name, bool is_quoted,
                   uint32_t *found, girih_error *reason) {
    if (includer->file == SOURCE && e->request->user_file != NULL &&
        strcmp(name, GIRIH_SHADER_USER_FILE) == 0) {
        char *path = copy_text(e->request->user_file, strlen(e->request->user_file));
        if (path == NULL) {
            no_memory(e);
            return UNREADABLE;
        }
        return find_on_disk(e, path, found, reason);
    }
    search result = NOT_THERE;
    if (is_quoted && includer->file != SOURCE && e->text->files[includer->file].is_user) {
        char *path = beside(e->text->files[includer->file].name, name);
        if (path == NULL) {
            no_memory(e);
            return UNREADABLE;
        }
        result = find_on_disk(e, path, found, reason);
    }
    return result == NOT_THERE ? find_in_memory(e, name, found) : result;
}

// --- Directives ---

static const char *skip_blanks(const char *at, const char *end) {
    while (at < end && (*at == ' ' || *at == '\t')) {
        at++;
    }
    return at;
}

// Where a line's directive of this name goes on, or NULL where it is another line.
static const char *after_directive(const char *line, const char *end, const char *name) {
    const char *at = skip_blanks(line, end);
    if (at == end || *at != '#') {
        return NULL;
    }
    at = skip_blanks(at + 1, end);
    size_t size = strlen(name);
    if ((size_t)(end - at) < size || memcmp(at, name, size) != 0 ||
        (at + size < end && (isalnum((unsigned char)at[size]) || at[size] == '_'))) {
        return NULL;
    }
    return skip_blanks(at + size, end);
}

// Whether a block comment is open after a line.
static bool comment_after(const char *line, const char *end, bool is_open) {
    for (const char *at = line; at + 1 < end; at++) {
        if (is_open && at[0] == '*' && at[1] == '/') {
            is_open = false;
            at++;
        } else if (!is_open && at[0] == '/' && at[1] == '*') {
            is_open = true;
            at++;
        } else if (!is_open && at[0] == '/' && at[1] == '/') {
            return false;
        }
    }
    return is_open;
}

static const char *end_of_line(const char *line) {
    const char *end = strchr(line, '\n');
    return end != NULL ? end : line + strlen(line);
}

// Whether a text's first directive is #ifndef NAME and its second #define NAME: included again,
// from within itself, it has nothing to say.
static bool has_guard(const char *text) {
    const char *name = NULL;
    size_t size = 0;
    bool is_comment = false;
    while (*text != '\0') {
        const char *end = end_of_line(text);
        const char *at = skip_blanks(text, end);
        if (!is_comment && at < end && *at == '#') {
            const char *guard = after_directive(text, end, name == NULL ? "ifndef" : "define");
            if (name != NULL) {
                return guard != NULL && (size_t)(end - guard) >= size &&
                       memcmp(guard, name, size) == 0;
            }
            if (guard == NULL) {
                return false;
            }
            name = guard;
            while (guard + size < end &&
                   (isalnum((unsigned char)guard[size]) || guard[size] == '_')) {
                size++;
            }
        }
        is_comment = comment_after(text, end, is_comment);
        text = *end != '\0' ? end + 1 : end;
    }
    return false;
}

static void expand(expansion *e, const frame *here, const char *text);

static void expand_include(expansion *e, const frame *here, const char *name, bool is_quoted) {
    uint32_t file = SOURCE;
    girih_error reason = {0};
    search result = find(e, here, name, is_quoted, &file, &reason);
    char message[400];
    if (e->result != GIRIH_OK) {
        return;
    }
    if (result != FOUND) {
        if (here->file == SOURCE) { // the user's file itself
            const char *path =
                strcmp(name, GIRIH_SHADER_USER_FILE) == 0 ? e->request->user_file : name;
            e->result = girih_fail(e->error, GIRIH_ERROR_INVALID_DATA, "%.200s: %.200s", path,
                                   result == NOT_THERE ? "there is no such file" : reason.message);
            return;
        }
        snprintf(message, sizeof message, "cannot include '%.150s': %.200s", name,
                 result == NOT_THERE ? "there is no such file" : reason.message);
        fail_include(e, message);
        return;
    }
    for (const frame *outer = here; outer != NULL; outer = outer->includer) {
        if (outer->file == file) {
            if (!has_guard(e->text->files[file].text)) {
                snprintf(message, sizeof message, "'%.150s' includes itself", name);
                fail_include(e, message);
            }
            return;
        }
    }
    if (here->depth == MAX_DEPTH) {
        snprintf(message, sizeof message, "files that include files, more than %d deep", MAX_DEPTH);
        fail_include(e, message);
        return;
    }
    frame inner = {here, file, here->depth + 1};
    append_line(e, "#line 1 %u\n", FIRST_STRING + file);
    expand(e, &inner, e->text->files[file].text);
    if (e->result == GIRIH_OK && e->text->bytes[e->text->size - 1] != '\n') {
        append(e, "\n", 1);
    }
}

// The name that an #include gives, between quotes or angle brackets; false where it gives none.
static bool included_name(const char *at, const char *end, char name[256], bool *is_quoted) {
    if (at == end || (*at != '"' && *at != '<')) {
        return false;
    }
    *is_quoted = *at == '"';
    const char *close = memchr(at + 1, *is_quoted ? '"' : '>', (size_t)(end - at - 1));
    if (close == NULL || close == at + 1 || close - at > 255) {
        return false;
    }
    size_t size = (size_t)(close - at - 1);
    memcpy(name, at + 1, size);
    name[size] = '\0';
    return true;
}

static void expand(expansion *e, const frame *here, const char *text) {
    // What a line directive says of this file: it counts as the file does, or as its own #line
    // wants.
    unsigned long number = 1;
    char string[256];
    snprintf(string, sizeof string, "%u", here->file == SOURCE ? 0 : FIRST_STRING + here->file);
    bool is_comment = false;
    bool is_continued = false;
    while (*text != '\0' && e->result == GIRIH_OK) {
        const char *end = end_of_line(text);
        const char *next = *end != '\0' ? end + 1 : end;
        const char *last = end > text && end[-1] == '\r' ? end - 1 : end;
        bool is_directive = !is_comment && !is_continued;
        const char *include = is_directive ? after_directive(text, last, "include") : NULL;
        const char *line = is_directive ? after_directive(text, last, "line") : NULL;
        bool is_quoted;
        char name[256];
        number++;
        if (include != NULL && included_name(include, last, name, &is_quoted)) {
            expand_include(e, here, name, is_quoted);
            append_line(e, "#line %lu %s\n", number, string);
        } else {
            append(e, text, (size_t)(next - text));
            if (line != NULL && isdigit((unsigned char)*line)) {
                char *rest;
                number = strtoul(line, &rest, 10);
                const char *other = skip_blanks(rest, last);
                if (other < last && last - other < 255) {
                    snprintf(string, sizeof string, "%.*s", (int)(last - other), other);
                }
            } else if (*next != '\0' && is_directive &&
                       (after_directive(text, last, "else") != NULL ||
                        after_directive(text, last, "elif") != NULL ||
                        after_directive(text, last, "endif") != NULL)) {
                // Line directives before this one, after an include, may have been skipped.
                append_line(e, "#line %lu %s\n", number, string);
            }
        }
        is_comment = comment_after(text, last, is_comment);
        is_continued = last > text && last[-1] == '\\';
        text = next;
    }
}

girih_result girih_shader_expand(const girih_shader_request *request, girih_shader_text *text,
                                 girih_error *error) {
    *text = (girih_shader_text){0};
    expansion e = {request, text, error, GIRIH_OK};
    frame source = {NULL, SOURCE, 0};
    expand(&e, &source, request->source);
    return e.result;
}

const girih_shader_file *girih_shader_text_file(const girih_shader_text *text,
                                                unsigned long string) {
    return string >= FIRST_STRING && string - FIRST_STRING < text->file_count
               ? &text->files[string - FIRST_STRING]
               : NULL;
}

const char *girih_shader_text_failure(const girih_shader_text *text, unsigned long number) {
    return number < text->failure_count ? text->failures[number] : NULL;
}

void girih_shader_text_free(girih_shader_text *text) {
    for (uint32_t n = 0; n < text->file_count; n++) {
        free(text->files[n].name);
        free(text->files[n].storage);
    }
    for (uint32_t n = 0; n < text->failure_count; n++) {
        free(text->failures[n]);
    }
    free(text->files);
    free(text->failures);
    free(text->bytes);
    *text = (girih_shader_text){0};
}
