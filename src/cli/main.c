/* The program `vanguard`: finds the subcommand. Exit status: 0 done, 1 the
 * job failed, 2 wrong usage, 4 done but not as it should be: a limit on the
 * layers is not met, or runs of a sweep differ. */
#include <malloc.h>
#include <stdio.h>
#include <string.h>

#include "base/child.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "run/common/progress.h"
#include "run/settings/settings.h"

static const struct command {
  const char *name, *summary;
  int (*run)(int argc, char **argv);
  const char *title; /* argv[0] of the subcommand, for help */
  int meshes;
} commands[] = {
  { "mesh", "mesh the volume of a project, on threads and MPI ranks",
    vg_cmd_mesh, "vanguard mesh", 1 },
  { "surface", "make the triangles of a surface anew to size", vg_cmd_surface,
    "vanguard surface", 0 },
  { "check", "judge a surface or a volume mesh", vg_cmd_check, "vanguard check",
    0 },
  { "partition", "share a volume mesh out to a solver's processes",
    vg_cmd_partition, "vanguard partition", 1 },
  { "plan", "forecast cells, memory and time before a project is meshed",
    vg_cmd_plan, "vanguard plan", 0 },
  { "sweep", "mesh with many leaf sizes, ranks and threads, and compare",
    vg_cmd_sweep, "vanguard sweep", 0 },
  { "serve", "start, watch and resume runs from a browser", vg_cmd_serve,
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
              "Vanguard makes volume meshes for aerodynamics from closed "
              "surfaces: viscous\nlayers on the walls, tetrahedra around "
              "them.\n\n");
  for (size_t i = 0; i < N_COMMAND; i++)
    fprintf(to, "  %-9s %s\n", commands[i].name, commands[i].summary);
  fprintf(to,
          "\n'vanguard COMMAND --help' lists the options of a command, "
          "'vanguard --version'\nshows the version. On several nodes: "
          "'mpirun -n RANKS vanguard mesh -p PROJECT'.\n"
          "Exit status: 0 done, 1 failed, 2 wrong usage, 4 done, but a limit "
          "on the layers\nis not met or runs of a sweep differ.\n");
}

static const char *command_name(const void *user, size_t i)
{
  (void)user;
  return commands[i].name;
}

static int unknown(const char *word)
{
  const char *near = vg_nearest_name(word, N_COMMAND, command_name, NULL);

  if (near)
    fprintf(stderr, "vanguard: no command '%s'; did you mean '%s'?\n", word,
            near);
  else
    fprintf(stderr,
            "vanguard: no command '%s'; 'vanguard --help' lists "
            "them\n",
            word);
  return VG_EXIT_USAGE;
}

/* Every task and slice takes a few arrays of megabytes and gives them back.
 * By default glibc would hand many of them to the system, which has to clear
 * each page again for the next: with these limits a run has half the page
 * faults (DLR-F6, 4.2 M cells: 50,000, now 22,000), for some 50 MB that are
 * kept. Larger blocks stay mappings of their own and are given back at once. */
static void keep_memory(void)
{
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 1 << 20);
#endif
}

/* A report that could not be written is a failure like any other. */
static int written(int status)
{
  if (!fflush(stdout) && !ferror(stdout)) return status;
  fprintf(stderr, "vanguard: standard output could not be written whole\n");
  return status == VG_EXIT_USAGE ? status : VG_EXIT_FAILED;
}

/* Before threads and MPI: while this process is small. Without the server
 * TetGen is dearer to start, so a refusal ends nothing. */
static int run(const struct command *c, int argc, char **argv)
{
  int status;

  if (c->meshes) vg_display_watch();
  keep_memory();
  if (c->meshes) vg_child_server_start(NULL);
  status = c->run(argc, argv);
  vg_child_server_stop();
  return written(status);
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
    return written(VG_EXIT_DONE);
  }
  if (!strcmp(word, "--help") || !strcmp(word, "-h") || !strcmp(word, "help")) {
    if (argc < 3) {
      usage(stdout);
      return VG_EXIT_DONE;
    }
    word = argv[1] = argv[2]; /* of a command, as COMMAND --help has it */
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
