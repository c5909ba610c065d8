// girih: renders, shows, refines and checks glTF models.
// Exit status: 0 done, 1 failed on this input, 2 wrong use.
#include <argp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "girih/version.h"
#include "report.h"

static const struct command {
    const char *name, *alias, *what;
    int (*run)(int argc, char **argv);
    char *program; // what its messages and --help call it
} commands[] = {
    {"render", NULL, "draw a refined model into a PNG", girih_command_render,
     (char[]){"girih render"}},
    {"view", NULL, "show a refined model in a window", girih_command_view, (char[]){"girih view"}},
    {"refine", NULL, "write a refined model as a .glb", girih_command_refine,
     (char[]){"girih refine"}},
    {"info", "inspect", "say what a model holds", girih_command_info, (char[]){"girih info"}},
    {"check", "validate", "look for cracks in a model", girih_command_check,
     (char[]){"girih check"}},
};

static void print_usage(FILE *stream) {
    fputs("Usage: girih COMMAND [OPTION...]\n"
          "Adaptive, crack-free tessellation of glTF models.\n\n",
          stream);
    for (size_t n = 0; n < sizeof commands / sizeof commands[0]; n++) {
        fprintf(stream, "  %-8s %s%s%s%s\n", commands[n].name, commands[n].what,
                commands[n].alias != NULL ? " (also: " : "",
                commands[n].alias != NULL ? commands[n].alias : "",
                commands[n].alias != NULL ? ")" : "");
    }
    fputs("\nExamples:\n"
          "  girih render model.glb -o picture.png\n"
          "  girih view model.glb\n"
          "  girih refine model.glb --segments 4 -o fine.glb\n"
          "  girih check fine.glb --from model.glb --segments 4\n\n"
          "girih COMMAND --help, or girih help COMMAND, tells a command's options.\n",
          stream);
}

static const struct command *find_command(const char *name) {
    for (size_t n = 0; n < sizeof commands / sizeof commands[0]; n++) {
        if (strcmp(name, commands[n].name) == 0 ||
            (commands[n].alias != NULL && strcmp(name, commands[n].alias) == 0)) {
            return &commands[n];
        }
    }
    return NULL;
}

int main(int argc, char **argv) {
    argp_err_exit_status = GIRIH_EXIT_WRONG_USE;
    if (argc < 2) {
        print_usage(stderr);
        return GIRIH_EXIT_WRONG_USE;
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        printf("girih %d.%d.%d\n", GIRIH_VERSION_MAJOR, GIRIH_VERSION_MINOR, GIRIH_VERSION_PATCH);
        return GIRIH_EXIT_DONE;
    }
    bool asks_for_help = strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-?") == 0 ||
                         strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0;
    if (asks_for_help && argc == 2) {
        print_usage(stdout);
        return GIRIH_EXIT_DONE;
    }
    const char *name = argv[asks_for_help ? 2 : 1];
    const struct command *command = find_command(name);
    if (command == NULL) {
        fprintf(stderr, "girih: no command '%s'; girih --help lists them\n", name);
        return GIRIH_EXIT_WRONG_USE;
    }
    if (asks_for_help) {
        return command->run(2, (char *[]){command->program, (char[]){"--help"}, NULL});
    }
    argv[1] = command->program;
    return command->run(argc - 1, argv + 1);
}
