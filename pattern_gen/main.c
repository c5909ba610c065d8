// girih-patterns: generates, describes and checks catalogues of base patterns.
// Exit status: 0 done, 1 failed on this input, 2 wrong use.
#define _GNU_SOURCE
#include <argp.h>
#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "error.h"
#include "family.h"
#include "girih/catalogue.h"
#include "import.h"
#include "laws.h"
#include "output.h"
#include "permutation.h"
#include "report.h"
#include "sheet.h"
#include "writer.h"

enum { EXIT_WRONG_USE = 2 };

// What all subcommands' options are read into.
typedef struct arguments {
    const char *program; // "girih-patterns generate"
    uint32_t file_count; // how many it takes
    uint32_t given;
    const char *files[2];
    const char *output;
    const char *spacing;
    const char *max;
    const char *family;
    const char *seed;
    const char *symbol;
    const char *patterns;
    const char *columns;
    bool json;
    bool verbose;
} arguments;

typedef struct command {
    const char *name;
    const char *usage; // the operands
    uint32_t file_count;
    const char *text;  // what --help says: a summary, then \v and examples
    const struct argp_option *options;
    int (*run)(const arguments *arguments);
} command;

enum {
    OPTION_SPACING = 256,
    OPTION_MAX,
    OPTION_FAMILY,
    OPTION_SEED,
    OPTION_NAME,
    OPTION_JSON,
    OPTION_PATTERNS,
    OPTION_COLUMNS
};

#define OUTPUT_OPTION {"output", 'o', "FILE", 0, "The file to write", 0}
#define JSON_OPTION {"json", OPTION_JSON, NULL, 0, "Print one JSON object", 0}
#define END_OF_OPTIONS {NULL, 0, NULL, 0, NULL, 0}

static const struct argp_option generate_options[] = {
    {"spacing", OPTION_SPACING, "dyadic|linear", 0,
     "dyadic: level l splits an edge into 2^l segments; linear: into l + 1", 0},
    {"max", OPTION_MAX, "N", 0, "Levels 0..N (dyadic) or 1..N segments (linear)", 0},
    {"family", OPTION_FAMILY, "NAME", 0, "Of patterns; --help of girih-patterns lists them", 0},
    {"seed", OPTION_SEED, "N", 0, "Of the family optimal's random numbers (0): other patterns of much the same quality", 0},
    OUTPUT_OPTION,
    END_OF_OPTIONS,
};
static const struct argp_option json_options[] = {JSON_OPTION, END_OF_OPTIONS};
static const struct argp_option info_options[] = {
    JSON_OPTION,
    {"verbose", 'v', NULL, 0, "Print a row for every pattern too; --json has them always", 0},
    END_OF_OPTIONS,
};
static const struct argp_option sheet_options[] = {
    OUTPUT_OPTION,
    {"patterns", OPTION_PATTERNS, "I,J,K;...", 0, "Only these, levels as --max counts them", 0},
    {"columns", OPTION_COLUMNS, "N", 0, "Patterns side by side", 0},
    END_OF_OPTIONS,
};
static const struct argp_option no_options[] = {END_OF_OPTIONS};
static const struct argp_option output_options[] = {OUTPUT_OPTION, END_OF_OPTIONS};
static const struct argp_option embed_options[] = {
    {"name", OPTION_NAME, "SYMBOL", 0, "The array's name in C", 0},
    OUTPUT_OPTION,
    END_OF_OPTIONS,
};

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static int wrong_use(const char *program, const char *format, ...) {
    va_list values;
    va_start(values, format);
    fprintf(stderr, "%s: ", program);
    vfprintf(stderr, format, values);
    fputc('\n', stderr);
    va_end(values);
    return EXIT_WRONG_USE;
}

static int failed(const arguments *arguments, const char *where, const girih_error *error) {
    fprintf(stderr, "%s: %s%s%s\n", arguments->program, where ? where : "", where ? ": " : "",
            error->message);
    return EXIT_FAILURE;
}

// A catalogue in memory: the file's own pages.
typedef struct mapped_catalogue {
    void *bytes;
    size_t size;
    const girih_catalogue *catalogue;
} mapped_catalogue;

static girih_result map_file(mapped_catalogue *mapped, int file, girih_error *error) {
    struct stat status;
    if (fstat(file, &status) != 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s", strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "is not a regular file");
    }
    if (status.st_size == 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA, "is empty");
    }
    mapped->size = (size_t)status.st_size;
    mapped->bytes = mmap(NULL, mapped->size, PROT_READ, MAP_PRIVATE, file, 0);
    if (mapped->bytes == MAP_FAILED) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "%s", strerror(errno));
    }
    return GIRIH_OK;
}

static girih_result open_catalogue(mapped_catalogue *mapped, const char *path,
                                   girih_error *error) {
    *mapped = (mapped_catalogue){.bytes = MAP_FAILED};
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT, "%s", strerror(errno));
    }
    girih_result result = map_file(mapped, file, error);
    close(file);
    if (result != GIRIH_OK) {
        return result;
    }
    result = girih_catalogue_open(mapped->bytes, mapped->size, &mapped->catalogue, error);
    if (result != GIRIH_OK) {
        munmap(mapped->bytes, mapped->size);
    }
    return result;
}

static void close_catalogue(mapped_catalogue *mapped) {
    munmap(mapped->bytes, mapped->size);
}

static int finish_output(const arguments *arguments) {
    if (fflush(stdout) != 0 || ferror(stdout)) {
        girih_error error;
        girih_fail(&error, GIRIH_ERROR_INVALID_ARGUMENT, "cannot write to standard output");
        return failed(arguments, NULL, &error);
    }
    return EXIT_SUCCESS;
}

static void show_progress(uint32_t done, uint32_t all) {
    if (isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r%u of %u patterns%s", done, all, done == all ? "\n" : "");
    }
}

// One where the catalogue is so large that a person at a terminal waits for it.
static girih_progress *progress_for(const girih_catalogue *catalogue) {
    const uint64_t slow = 5000000;
    return catalogue->triangle_count > slow ? show_progress : NULL;
}

// Reads a whole number of at most nine digits.
static bool read_number(const char *text, uint32_t *number) {
    if (!isdigit((unsigned char)text[0]) || strlen(text) > 9) {
        return false;
    }
    char *end = NULL;
    *number = (uint32_t)strtoul(text, &end, 10);
    return *end == 0;
}

static int run_generate(const arguments *arguments) {
    const char *program = arguments->program;
    if (!arguments->spacing || !arguments->max || !arguments->output) {
        return wrong_use(program, "--spacing, --max and --output are needed");
    }
    bool dyadic = strcmp(arguments->spacing, "dyadic") == 0;
    if (!dyadic && strcmp(arguments->spacing, "linear") != 0) {
        return wrong_use(program, "--spacing is dyadic or linear, not '%s'", arguments->spacing);
    }
    uint32_t first = dyadic ? 0 : 1;
    uint32_t last = dyadic ? GIRIH_LARGEST_DYADIC_LEVEL : GIRIH_LARGEST_LINEAR_COUNT;
    uint32_t max = 0;
    if (!read_number(arguments->max, &max) || max < first || max > last) {
        return wrong_use(program, "--max is a number from %u to %u with --spacing %s, not '%s'",
                         first, last, arguments->spacing, arguments->max);
    }
    const char *name = arguments->family ? arguments->family : girih_family_optimal.name;
    const girih_family *family = girih_family_find(name);
    if (!family) {
        return wrong_use(program, "there is no family '%s'; girih-patterns --help lists them", name);
    }
    girih_error error;
    uint32_t seed = 0;
    if (arguments->seed && family != &girih_family_optimal) {
        return wrong_use(program, "--seed is for the family optimal, not '%s'", name);
    }
    if (arguments->seed && !read_number(arguments->seed, &seed)) {
        return wrong_use(program, "--seed is a number of at most nine digits, not '%s'", arguments->seed);
    }
    girih_family seeded = *family;
    seeded.data = &seed;
    girih_spacing spacing = dyadic ? GIRIH_SPACING_DYADIC : GIRIH_SPACING_LINEAR;
    if (girih_catalogue_write(&seeded, spacing, max, arguments->output, show_progress, &error) !=
        GIRIH_OK) {
        return failed(arguments, NULL, &error);
    }
    return EXIT_SUCCESS;
}

static int run_info(const arguments *arguments) {
    girih_error error;
    mapped_catalogue mapped;
    if (open_catalogue(&mapped, arguments->files[0], &error) != GIRIH_OK) {
        return failed(arguments, arguments->files[0], &error);
    }
    girih_report_form form = arguments->json      ? GIRIH_REPORT_JSON
                             : arguments->verbose ? GIRIH_REPORT_ROWS
                                                  : GIRIH_REPORT_TEXT;
    girih_result result = girih_report_info(mapped.catalogue, form, progress_for(mapped.catalogue),
                                            stdout, &error);
    close_catalogue(&mapped);
    return result == GIRIH_OK ? finish_output(arguments)
                              : failed(arguments, arguments->files[0], &error);
}

static int run_compare(const arguments *arguments) {
    girih_error error;
    mapped_catalogue mapped[2];
    girih_compared compared[2];
    girih_progress *progress = NULL;
    for (int n = 0; n < 2; n++) {
        if (open_catalogue(&mapped[n], arguments->files[n], &error) != GIRIH_OK) {
            int status = failed(arguments, arguments->files[n], &error);
            if (n == 1) {
                close_catalogue(&mapped[0]);
            }
            return status;
        }
        compared[n] = (girih_compared){arguments->files[n], mapped[n].catalogue};
        progress = progress ? progress : progress_for(mapped[n].catalogue);
    }
    girih_result result = girih_report_compare(compared, arguments->json, progress, stdout, &error);
    close_catalogue(&mapped[1]);
    close_catalogue(&mapped[0]);
    return result == GIRIH_OK ? finish_output(arguments) : failed(arguments, NULL, &error);
}

static int run_import(const arguments *arguments) {
    if (!arguments->output) {
        return wrong_use(arguments->program, "--output is needed");
    }
    girih_error error;
    FILE *stream = fopen(arguments->files[0], "rbe");
    if (!stream) {
        girih_fail(&error, GIRIH_ERROR_INVALID_ARGUMENT, "%s", strerror(errno));
        return failed(arguments, arguments->files[0], &error);
    }
    girih_import import;
    girih_result result = girih_import_read(&import, stream, &error);
    fclose(stream);
    const char *where = arguments->files[0];
    if (result == GIRIH_OK) {
        where = NULL;
        result = girih_catalogue_write(&import.family, import.spacing, import.max,
                                       arguments->output, show_progress, &error);
    }
    girih_import_free(&import);
    return result == GIRIH_OK ? EXIT_SUCCESS : failed(arguments, where, &error);
}

static girih_result draw_sheet(const arguments *arguments, const girih_sheet *sheet,
                               const girih_catalogue *catalogue, girih_sheet_format format,
                               girih_error *error) {
    girih_pattern_output output;
    girih_result result = girih_pattern_output_open(&output, arguments->output, error);
    if (result != GIRIH_OK) {
        return result;
    }
    result = girih_sheet_draw(sheet, catalogue, format, progress_for(catalogue), output.stream,
                              error);
    if (result != GIRIH_OK) {
        girih_pattern_output_discard(&output);
        return result;
    }
    return girih_pattern_output_commit(&output, error);
}

static bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text);
    return length >= strlen(end) && strcmp(text + length - strlen(end), end) == 0;
}

static int run_sheet(const arguments *arguments) {
    const char *program = arguments->program;
    const char *path = arguments->output;
    if (!path) {
        return wrong_use(program, "--output is needed");
    }
    bool svg = ends_with(path, ".svg");
    if (!svg && !ends_with(path, ".png")) {
        return wrong_use(program, "--output ends in .svg or .png, unlike '%s'", path);
    }
    uint32_t columns = 0;
    if (arguments->columns && (!read_number(arguments->columns, &columns) || columns == 0)) {
        return wrong_use(program, "--columns is a number from 1, not '%s'", arguments->columns);
    }
    girih_error error;
    mapped_catalogue mapped;
    if (open_catalogue(&mapped, arguments->files[0], &error) != GIRIH_OK) {
        return failed(arguments, arguments->files[0], &error);
    }
    girih_sheet sheet;
    girih_result result =
        girih_sheet_choose(&sheet, mapped.catalogue, arguments->patterns, &error);
    bool wrong = result == GIRIH_ERROR_INVALID_ARGUMENT;
    bool chosen = result == GIRIH_OK;
    sheet.columns = columns;
    if (chosen) {
        result = draw_sheet(arguments, &sheet, mapped.catalogue,
                            svg ? GIRIH_SHEET_SVG : GIRIH_SHEET_PNG, &error);
    }
    girih_sheet_free(&sheet);
    close_catalogue(&mapped);
    if (wrong) {
        return wrong_use(program, "%s", error.message);
    }
    return result == GIRIH_OK ? EXIT_SUCCESS
                              : failed(arguments, chosen ? NULL : arguments->files[0], &error);
}

static int run_dump(const arguments *arguments) {
    girih_error error;
    mapped_catalogue mapped;
    if (open_catalogue(&mapped, arguments->files[0], &error) != GIRIH_OK) {
        return failed(arguments, arguments->files[0], &error);
    }
    girih_result result = girih_report_dump(mapped.catalogue, arguments->json, stdout, &error);
    close_catalogue(&mapped);
    return result == GIRIH_OK ? finish_output(arguments)
                              : failed(arguments, arguments->files[0], &error);
}

static int run_check(const arguments *arguments) {
    girih_error error;
    mapped_catalogue mapped;
    if (open_catalogue(&mapped, arguments->files[0], &error) != GIRIH_OK) {
        return failed(arguments, arguments->files[0], &error);
    }
    girih_result result = girih_laws_check_catalogue(mapped.catalogue, &error);
    uint32_t count = mapped.catalogue->pattern_count;
    uint64_t degenerate = girih_laws_count_degenerate(mapped.catalogue);
    close_catalogue(&mapped);
    if (result != GIRIH_OK) {
        return failed(arguments, arguments->files[0], &error);
    }
    printf("%s: %u base patterns, every law holds; %" PRIu64 " degenerate triangles\n",
           arguments->files[0], count, degenerate);
    return finish_output(arguments);
}

static int run_emit_permutation(const arguments *arguments) {
    if (!arguments->output) {
        return wrong_use(arguments->program, "--output is needed");
    }
    girih_error error;
    girih_permutation table[GIRIH_LAMBDA_COUNT];
    girih_pattern_output output;
    if (girih_permutation_derive(table, &error) != GIRIH_OK ||
        girih_pattern_output_open(&output, arguments->output, &error) != GIRIH_OK) {
        return failed(arguments, NULL, &error);
    }
    girih_permutation_emit(table, output.stream);
    if (girih_pattern_output_commit(&output, &error) != GIRIH_OK) {
        return failed(arguments, NULL, &error);
    }
    return EXIT_SUCCESS;
}

static bool is_identifier(const char *text) {
    if (!isalpha((unsigned char)text[0]) && text[0] != '_') {
        return false;
    }
    for (; *text; text++) {
        if (!isalnum((unsigned char)*text) && *text != '_') {
            return false;
        }
    }
    return true;
}

static int run_embed(const arguments *arguments) {
    if (!arguments->symbol || !arguments->output) {
        return wrong_use(arguments->program, "--name and --output are needed");
    }
    if (!is_identifier(arguments->symbol)) {
        return wrong_use(arguments->program, "--name is a C identifier, not '%s'",
                         arguments->symbol);
    }
    girih_error error;
    mapped_catalogue mapped;
    if (open_catalogue(&mapped, arguments->files[0], &error) != GIRIH_OK) {
        return failed(arguments, arguments->files[0], &error);
    }
    girih_pattern_output output;
    girih_result result = girih_pattern_output_open(&output, arguments->output, &error);
    if (result == GIRIH_OK) {
        girih_report_embed(mapped.catalogue, arguments->symbol, output.stream);
        result = girih_pattern_output_commit(&output, &error);
    }
    close_catalogue(&mapped);
    return result == GIRIH_OK ? EXIT_SUCCESS : failed(arguments, NULL, &error);
}

static const command commands[] = {
    {"generate", "", 0,
     "Generate a catalogue.\v"
     "Examples:\n"
     "  girih-patterns generate --spacing dyadic --max 6 -o dyadic.gpat\n"
     "  girih-patterns generate --spacing linear --max 16 -o linear.gpat\n",
     generate_options, run_generate},
    {"import", "FILE.json", 1,
     "Make a catalogue of patterns from JSON, of the form that dump --json writes. Every law is "
     "checked.\v"
     "Patterns and their vertices may come in any order. All patterns up to \"max\" are needed.\n"
     "\n"
     "Examples:\n"
     "  girih-patterns dump linear.gpat --json > linear.json\n"
     "  girih-patterns import linear.json -o linear.gpat\n",
     output_options, run_import},
    {"info", "FILE", 1,
     "Print a catalogue's figures: patterns, sizes, angles, spacing, vertex reuse, parents.\v"
     "Examples:\n"
     "  girih-patterns info dyadic.gpat\n"
     "  girih-patterns info dyadic.gpat --verbose\n"
     "  girih-patterns info dyadic.gpat --json\n",
     info_options, run_info},
    {"compare", "A B", 2,
     "Print two catalogues' figures side by side, and which has the better pattern how often. "
     "Patterns of the same segments are compared, whatever the maxima.\v"
     "Examples:\n"
     "  girih-patterns compare uniform.gpat other.gpat\n"
     "  girih-patterns compare uniform.gpat other.gpat --json\n",
     json_options, run_compare},
    {"sheet", "FILE", 1,
     "Draw a catalogue's patterns, coloured by their triangles' smallest angles.\v"
     "Examples:\n"
     "  girih-patterns sheet linear.gpat -o linear.svg\n"
     "  girih-patterns sheet linear.gpat -o some.png --patterns '4,2,1;8,8,3'\n",
     sheet_options, run_sheet},
    {"dump", "FILE", 1,
     "Print every vertex, its parent, and every triangle of a catalogue.\v"
     "Examples:\n"
     "  girih-patterns dump linear.gpat --json > linear.json\n",
     json_options, run_dump},
    {"check", "FILE", 1,
     "Check every law of a catalogue: distinct vertices, exact borders, positive areas that add up "
     "to the whole, every inner edge shared by two triangles, parents that turn no triangle over. Degenerate "
     "triangles, which have a corner twice, are counted; only the family semiuniform may have them.\v"
     "Examples:\n"
     "  girih-patterns check dyadic.gpat\n",
     no_options, run_check},
    {"embed", "FILE", 1,
     "Write a catalogue as a C source: const uint64_t SYMBOL[] and const size_t SYMBOL_size.\v"
     "Examples:\n"
     "  girih-patterns embed dyadic.gpat --name my_catalogue -o my_catalogue.c\n",
     embed_options, run_embed},
    {"emit-permutation", "", 0,
     "Write girih_permutation.h, the table of lambda for C and GLSL.\v"
     "Examples:\n"
     "  girih-patterns emit-permutation -o girih_permutation.h\n",
     output_options, run_emit_permutation},
};

static const char help[] =
    "usage: girih-patterns COMMAND [OPTION...]\n"
    "Catalogues of base patterns for adaptive tessellation.\n"
    "\n"
    "  generate          generate a catalogue\n"
    "  import            make a catalogue of patterns from JSON\n"
    "  info              print a catalogue's figures\n"
    "  compare           print two catalogues' figures side by side\n"
    "  sheet             draw a catalogue's patterns\n"
    "  dump              print every vertex and triangle\n"
    "  check             check every law of a catalogue\n"
    "  embed             write a catalogue as a C source\n"
    "  emit-permutation  write the table of lambda for C and GLSL\n"
    "\n"
    "Examples:\n"
    "  girih-patterns generate --spacing dyadic --max 6 -o dyadic.gpat\n"
    "  girih-patterns info dyadic.gpat --json\n"
    "  girih-patterns check dyadic.gpat\n"
    "  girih-patterns sheet dyadic.gpat -o dyadic.svg\n"
    "\n"
    "girih-patterns COMMAND --help tells more.\n";

static error_t parse_option(int key, char *value, struct argp_state *state) {
    arguments *arguments = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        // One line per error: without a stream argp leaves out its "Try --help" and the exit.
        state->err_stream = NULL;
        return 0;
    case 'o':
        arguments->output = value;
        return 0;
    case OPTION_SPACING:
        arguments->spacing = value;
        return 0;
    case OPTION_MAX:
        arguments->max = value;
        return 0;
    case OPTION_SEED:
        arguments->seed = value;
        return 0;
    case OPTION_FAMILY:
        arguments->family = value;
        return 0;
    case OPTION_NAME:
        arguments->symbol = value;
        return 0;
    case OPTION_JSON:
        arguments->json = true;
        return 0;
    case OPTION_PATTERNS:
        arguments->patterns = value;
        return 0;
    case OPTION_COLUMNS:
        arguments->columns = value;
        return 0;
    case 'v':
        arguments->verbose = true;
        return 0;
    case ARGP_KEY_ARG:
        if (arguments->given == arguments->file_count) {
            wrong_use(arguments->program, "one argument too many: '%s'", value);
            return EINVAL;
        }
        arguments->files[arguments->given++] = value;
        return 0;
    case ARGP_KEY_END:
        if (arguments->given < arguments->file_count) {
            wrong_use(arguments->program, "%s needed", arguments->file_count == 2 ? "two FILEs are" : "a FILE is");
            return EINVAL;
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int run_command(const command *command, int argc, char **argv) {
    char program[64];
    snprintf(program, sizeof program, "girih-patterns %s", command->name);
    argv[0] = program;
    arguments arguments = {.program = program, .file_count = command->file_count};
    const struct argp parser = {
        .options = command->options,
        .parser = parse_option,
        .args_doc = command->usage,
        .doc = command->text,
    };
    argp_err_exit_status = EXIT_WRONG_USE;
    if (argp_parse(&parser, argc, argv, 0, NULL, &arguments) != 0) {
        return EXIT_WRONG_USE;
    }
    return command->run(&arguments);
}

int main(int argc, char **argv) {
    if (argc < 2) {
        return wrong_use("girih-patterns", "a command is needed; --help lists them");
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-?") == 0 ||
        strcmp(argv[1], "help") == 0) {
        fputs(help, stdout);
        for (uint32_t n = 0; girih_family_at(n); n++) {
            printf("%s  %-12s %s\n", n == 0 ? "\nFamilies of patterns:\n" : "", girih_family_at(n)->name, girih_family_at(n)->summary);
        }
        return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    for (size_t n = 0; n < sizeof commands / sizeof *commands; n++) {
        if (strcmp(argv[1], commands[n].name) == 0) {
            return run_command(&commands[n], argc - 1, argv + 1);
        }
    }
    return wrong_use("girih-patterns", "unknown %s '%s'; --help lists the commands",
                     argv[1][0] == '-' ? "option" : "command", argv[1]);
}
