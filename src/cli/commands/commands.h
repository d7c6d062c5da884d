/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/commands/commands.h: the subcommands. Each is one file with one entry
 * point, which takes argc and argv and returns an exit status
 * (cli/common/cli.h). */
#ifndef VG_CLI_COMMANDS_COMMANDS_H
#define VG_CLI_COMMANDS_COMMANDS_H

#include <stdio.h>

int vg_cmd_mesh(int argc, char **argv);
int vg_cmd_surface(int argc, char **argv);
int vg_cmd_check(int argc, char **argv);
int vg_cmd_sweep(int argc, char **argv);
int vg_cmd_serve(int argc, char **argv);
int vg_cmd_partition(int argc, char **argv);
int vg_cmd_convert(int argc, char **argv);
int vg_cmd_metric(int argc, char **argv);
int vg_cmd_adapt(int argc, char **argv);
int vg_cmd_plan(int argc, char **argv);
int vg_cmd_deck(int argc, char **argv);
int vg_cmd_demo(int argc, char **argv);

/** Print version and licence; if verbose, also source digest, compiler and
 * libraries. vg_version_libraries prints the libraries only, one per line.
 * version.c */
void vg_version_print(FILE *to, int verbose);
void vg_version_libraries(FILE *to);

#endif
