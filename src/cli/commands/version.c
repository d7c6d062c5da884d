/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Version of the program and of its libraries. */
#include <gnu/libc-version.h>
#include <string.h>

#include "base/helper/helper.h"
#include "base/library.h"
#include "base/version.h"
#include "cli/commands/commands.h"
#include "cli/http/http.h"
#include "io/cad/cad.h"
#include "io/cgns/cgns.h"
#include "io/stream/stream.h"
#include "partition/graph/graph.h"
#include "partition/model/rates.h"
#include "partition/store/store.h"
#include "run/common/json_build.h"

static void put(FILE *to, const struct vg_library *l)
{
  fprintf(to, "  %-13s %.*s\n", l->name, (int)strcspn(l->version, "\n"),
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

static void put_all(FILE *to, void (*const *say)(struct vg_library *), size_t n)
{
  struct vg_library l;

  for (size_t i = 0; i < n; i++) {
    memset(&l, 0, sizeof l);
    say[i](&l);
    put(to, &l);
  }
}

/* The libraries of the helper programs, by the answers of these. */
static void put_helper_libraries(FILE *to)
{
  struct vg_helper h;

  for (int kind = 0; kind < VG_HELPER_N; kind++) {
    const char *version;

    vg_helper_find(kind, &h);
    version = h.is_found ? strchr(h.library, ' ') : NULL;
    fprintf(to, "  %-13s %s%s\n", h.holds, version ? version + 1 : h.name,
            version ? "" : " not found");
  }
}

void vg_version_libraries(FILE *to)
{
  static void (*const say[])(struct vg_library *) = {
    vg_library_mpi,  vg_library_hwloc, vg_library_metis, vg_library_xxhash,
    vg_library_zlib, vg_library_hdf5,  vg_library_occt
  };

  put_all(to, say, sizeof say / sizeof *say);
  put_helper_libraries(to);
  fprintf(to, "  %-13s %s\n  %-13s %s\n", "jansson", jansson_version_str(),
          "glibc", gnu_get_libc_version());
  put_helpers(to);
}

/* Libraries that a run loads only when it needs them are loaded here to ask for
 * their version. */
void vg_version_print(FILE *to, int verbose)
{
  static void (*const on_demand[])(
    struct vg_library *) = { vg_library_lapacke, vg_library_microhttpd };

  fprintf(to, "vanguard " VG_VERSION "\n"
              "Licence LGPL-3.0-or-later: "
              "https://www.gnu.org/licenses/lgpl-3.0.html\n");
  if (!verbose) return;
  fprintf(to, "source   %s\ncompiler %s\nlibraries\n", vg_source_digest,
          __VERSION__);
  put_all(to, on_demand, sizeof on_demand / sizeof *on_demand);
  vg_version_libraries(to);
}
