// The subcommands. Each takes its own arguments, argv[0] being "girih NAME", and returns an exit
// code.
#ifndef GIRIH_VIEWER_COMMANDS_H
#define GIRIH_VIEWER_COMMANDS_H

int girih_command_render(int argc, char **argv);
int girih_command_view(int argc, char **argv);
int girih_command_refine(int argc, char **argv);
int girih_command_info(int argc, char **argv);
int girih_command_check(int argc, char **argv);

#endif
