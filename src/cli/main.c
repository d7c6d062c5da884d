/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The program `vanguard`: dispatches to the subcommands. Exit status: 0
 * success, 1 failure, 2 wrong usage, 4 finished, but a limit on the layers is
 * not met or runs of a sweep differ. */
#include <malloc.h>
#include <stdio.h>
#include <string.h>

#include "base/child.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "run/common/progress.h"
#include "run/settings/names.h"

static const struct command {
  const char *name, *summary;
  int (*run)(int argc, char **argv);
  const char *title; /* argv[0] of the subcommand, for help */
  int meshes;
} commands[] = {
  { "mesh", "generate the volume mesh of a project on threads and MPI ranks",
    vg_cmd_mesh, "vanguard mesh", 1 },
  { "surface", "remesh a surface to target edge lengths", vg_cmd_surface,
    "vanguard surface", 0 },
  { "check", "check a surface or a volume mesh", vg_cmd_check, "vanguard check",
    0 },
  { "partition", "partition a volume mesh for a parallel flow solver",
    vg_cmd_partition, "vanguard partition", 1 },
  { "convert", "write a mesh or a surface in another format", vg_cmd_convert,
    "vanguard convert", 0 },
  { "metric", "make the metric of the next mesh from a flow solution",
    vg_cmd_metric, "vanguard metric", 0 },
  { "adapt", "run cycles of mesh, flow solver and metric", vg_cmd_adapt,
    "vanguard adapt", 0 },
  { "plan", "forecast cells, memory and time of a run", vg_cmd_plan,
    "vanguard plan", 0 },
  { "sweep", "mesh with various subdomain sizes, ranks and threads; compare",
    vg_cmd_sweep, "vanguard sweep", 0 },
  { "serve", "start, monitor and resume runs from a browser", vg_cmd_serve,
    "vanguard serve", 0 },
  { "deck", "write a run deck with all defaults", vg_cmd_deck, "vanguard deck",
    0 },
  { "demo", "write a complete example project", vg_cmd_demo, "vanguard demo",
    0 },
};
#define N_COMMAND (sizeof commands / sizeof *commands)

static void usage(FILE *to)
{
  fprintf(to, "Usage: vanguard COMMAND [OPTION...]\n"
              "Vanguard generates volume meshes for aerodynamics from closed "
              "surfaces: viscous\nlayers on the walls, tetrahedra "
              "elsewhere.\n\n");
  for (size_t i = 0; i < N_COMMAND; i++)
    fprintf(to, "  %-9s %s\n", commands[i].name, commands[i].summary);
  fprintf(to,
          "\n'vanguard COMMAND --help' lists the options of a command, "
          "'vanguard --version'\nshows the version. On several nodes: "
          "'mpirun -n RANKS vanguard mesh -p PROJECT'.\n"
          "Exit status: 0 success, 1 failure, 2 wrong usage, 4 finished, but "
          "a limit on the\nlayers is not met or runs of a sweep differ.\n");
}

static const char *command_name(const void *user, size_t i)
{
  (void)user;
  return commands[i].name;
}

static int unknown(const char *word)
{
  const struct vg_names names = { N_COMMAND, command_name, NULL };
  char hint[VG_HINT_SIZE];

  fprintf(stderr, "vanguard: unknown command '%s'; %s\n", word,
          vg_hint_for(word, &names, "", "'vanguard --help' lists the commands",
                      hint));
  return VG_EXIT_USAGE;
}

/* Every task and slice allocates and frees a few arrays of several megabytes.
 * By default glibc returns many of them to the system, which must clear each
 * page again for the next allocation. These limits halve the page faults of a
 * run (DLR-F6, 4.2 M cells: from 50,000 to 22,000) and retain about 50 MB.
 * Larger blocks are still mapped separately and returned at once. */
static void keep_memory(void)
{
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 1 << 20);
#endif
}

/* Every command may need a child: TetGen, METIS, CAD and CGNS files have their
 * own. Their server starts before threads and MPI, while this process is small:
 * a child forked next to a running thread may wait for a lock that this thread
 * held. Without the server, children only cost more, so that is not an error.
 */
static int run(const struct command *c, int argc, char **argv)
{
  int status;

  if (c->meshes) vg_display_watch();
  keep_memory();
  vg_child_server_start(NULL);
  status = c->run(argc, argv);
  vg_child_server_stop();
  return vg_cli_written(status);
}

int main(int argc, char **argv)
{
  const char *word = argc > 1 ? argv[1] : "";
  char help[] = "--help";

  if (argc < 2) {
    usage(stderr);
    return VG_EXIT_USAGE;
  }
  if (!strcmp(word, "--version") || !strcmp(word, "-V")) {
    vg_version_print(stdout, argc > 2 && !strcmp(argv[2], "--verbose"));
    return vg_cli_written(VG_EXIT_DONE);
  }
  if (!strcmp(word, "--help") || !strcmp(word, "-h") || !strcmp(word, "help")) {
    if (argc < 3) {
      usage(stdout);
      return vg_cli_written(VG_EXIT_DONE);
    }
    word = argv[1] = argv[2]; /* 'help COMMAND' as 'COMMAND --help' */
    argv[2] = help;
    argc = 3;
  }
  for (size_t i = 0; i < N_COMMAND; i++)
    if (!strcmp(word, commands[i].name)) {
      argv[1] = (char *)commands[i].title;
      return run(&commands[i], argc - 1, argv + 1);
    }
  return unknown(word);
}
