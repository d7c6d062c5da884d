/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/commands/mesh_log.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/version.h"
#include "cli/commands/commands.h"
#include "run/common/log.h"
#include "run/settings/resolved.h"

static void put_command(FILE *to, int argc, char **argv)
{
  char *cwd = getcwd(NULL, 0);

  fprintf(to, "command  ");
  for (int i = 0; i < argc; i++)
    fprintf(to,
            i && strpbrk(argv[i], " \t\n\"'$*?;&|<>()\\") ? "%s'%s'" : "%s%s",
            i ? " " : "", argv[i]);
  fprintf(to, "\nfolder   %s\n", cwd ? cwd : "?");
  free(cwd);
}

void vg_mesh_log_start(const struct vg_run *r, int argc, char **argv)
{
  FILE *to = vg_log();
  char host[256] = "?", date[64] = "";
  time_t now = time(NULL);
  struct tm local;

  if (!to) return;
  gethostname(host, sizeof host - 1);
  if (localtime_r(&now, &local))
    strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S %z", &local);
  fprintf(to, "vanguard " VG_VERSION ", source %.16s, %s\n", vg_source_digest,
          date);
  put_command(to, argc, argv);
  fprintf(to, "host     %s; %d rank%s, %d on this node\nlibraries\n", host,
          r->size, r->size > 1 ? "s" : "", vg_comm_node_size(r->comm));
  vg_version_libraries(to);
}

void vg_mesh_log_settings(const struct vg_run *r,
                          const struct vg_settings *asked)
{
  static const enum vg_table_kind table[] = {
    VG_TABLE_PATCHES, VG_TABLE_LAYERS,   VG_TABLE_SURFACE, VG_TABLE_WAKES,
    VG_TABLE_ZONES,   VG_TABLE_PERIODIC, VG_TABLE_SOURCES
  };
  const struct vg_param *p;
  const char *name;
  char value[2 * VG_LIST_MAX + 4];
  struct vg_settings view = *asked, *s = &view; /* tables are borrowed */
  FILE *to = vg_log();
  int in_farfield;

  if (!to) return;
  vg_resolve_write(asked, view.write);
  fprintf(to, "threads  %d per rank\nsettings\n",
          s->threads ? (int)s->threads : vg_comm_default_threads(r->comm));
  for (size_t i = 0; (p = vg_settings_name(i, &name, &in_farfield)); i++) {
    vg_param_format(p,
                    in_farfield ? (const void *)&s->farfield : (const void *)s,
                    value, sizeof value);
    fprintf(to, "  %-20s %s\n", name, value);
  }
  for (size_t i = 0; i < sizeof table / sizeof *table; i++)
    if (vg_settings_rows(s, table[i]))
      fprintf(to, "  %-20s %zu rows in its table\n",
              vg_settings_table(table[i])->name, vg_settings_rows(s, table[i]));
  fprintf(to, "\n");
}
