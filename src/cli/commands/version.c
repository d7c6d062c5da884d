/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Version of the program and of its libraries. */
#include <gnu/libc-version.h>
#include <jansson.h>
#include <string.h>

#include "base/helper/helper.h"
#include "base/library.h"
#include "base/version.h"
#include "cli/commands/commands.h"
#include "io/stream/stream.h"
#include "partition/graph/graph.h"
#include "partition/store/store.h"

static void put(FILE *to, const struct vg_library *l)
{
  fprintf(to, "  %-8s %.*s\n", l->name, (int)strcspn(l->version, "\n"),
          l->version);
}

static void put_helpers(FILE *to)
{
  struct vg_helper h;

  fprintf(to, "helper programs\n");
  for (int kind = 0; kind < VG_HELPER_N; kind++) {
    vg_helper_find(kind, &h);
    fprintf(to, "  %s %s\n", h.name, h.is_found ? h.identity : "not found");
  }
}

void vg_version_libraries(FILE *to)
{
  static void (*const say[])(
    struct vg_library *) = { vg_library_mpi, vg_library_hwloc, vg_library_metis,
                             vg_library_xxhash, vg_library_zlib };
  struct vg_library l;

  for (size_t i = 0; i < sizeof say / sizeof *say; i++) {
    memset(&l, 0, sizeof l);
    say[i](&l);
    put(to, &l);
  }
  fprintf(to, "  %-8s %s\n  %-8s %s\n", "jansson", JANSSON_VERSION, "glibc",
          gnu_get_libc_version());
  put_helpers(to);
}

void vg_version_print(FILE *to, int verbose)
{
  fprintf(to, "vanguard " VG_VERSION "\n"
              "Licence LGPL-3.0-or-later: "
              "https://www.gnu.org/licenses/lgpl-3.0.html\n");
  if (!verbose) return;
  fprintf(to, "source   %s\ncompiler %s\nlibraries\n", vg_source_digest,
          __VERSION__);
  vg_version_libraries(to);
}
