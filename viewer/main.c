// girih: renders, refines and checks glTF models.
// Exit status: 0 done, 1 failed on this input, 2 wrong use.
#include <argp.h>
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "report.h"

static const struct command {
    const char *name, *alias, *what;
    int (*run)(int argc, char **argv);
    char *program; // what its messages and --help call it
} commands[] = {
    {"render", NULL, "draw a refined model into a PNG", girih_command_render,
     (char[]){"girih render"}},
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
          "  girih refine model.glb --segments 4 -o fine.glb\n"
          "  girih check fine.glb --from model.glb --segments 4\n\n"
          "girih COMMAND --help tells a command's options.\n",
          stream);
}

int main(int argc, char **argv) {
    argp_err_exit_status = GIRIH_EXIT_WRONG_USE;
    if (argc < 2) {
        print_usage(stderr);
        return GIRIH_EXIT_WRONG_USE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-?") == 0 ||
        strcmp(argv[1], "help") == 0) {
        print_usage(stdout);
        return GIRIH_EXIT_DONE;
    }
    for (size_t n = 0; n < sizeof commands / sizeof commands[0]; n++) {
        if (strcmp(argv[1], commands[n].name) == 0 ||
            (commands[n].alias != NULL && strcmp(argv[1], commands[n].alias) == 0)) {
            argv[1] = commands[n].program;
            return commands[n].run(argc - 1, argv + 1);
        }
    }
    fprintf(stderr, "girih: no command '%s'; girih --help lists them\n", argv[1]);
    return GIRIH_EXIT_WRONG_USE;
}
