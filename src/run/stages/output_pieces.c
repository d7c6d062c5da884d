/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Pieces of a .pvtu. Declared in run/stages/output.h. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "io/slices/slices.h"
#include "run/stages/output.h"

vg_status vg_outputs_pieces(struct vg_outputs *o, const char *stem,
                            struct vg_error *err)
{
  char suffix[40];
  vg_status st = VG_OK;

  for (size_t k = 0; st >= 0; k++) {
    char *path = vg_slices_piece(stem, k);
    int there;

    if (!path) return vg_fail_memory(err, "the output paths");
    there = access(path, F_OK) == 0;
    free(path);
    if (!there) break;
    snprintf(suffix, sizeof suffix, "_%zu.vtu", k);
    st = vg_outputs_add(o, suffix, err);
  }
  return st;
}
