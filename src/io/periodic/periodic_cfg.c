/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/periodic/periodic_cfg.h"

#include <stdlib.h>

#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

#define DEGREES 57.295779513082320877

static void put_reals(struct vg_output *out, const double v[3], double factor)
{
  for (int k = 0; k < 3; k++) {
    vg_output_text(out, ", ");
    vg_output_real(out, factor * v[k] + 0.0); /* not -0 */
  }
}

static void put_pair(struct vg_output *out, const struct vg_periodic *p,
                     const char *patch, const char *image)
{
  static const double zero[3] = { 0 };
  double angle[3];

  vg_periodic_angles(p, angle);
  vg_output_format(out, "%s, %s", patch, image);
  put_reals(out, p->is_rotation ? p->centre : zero, 1);
  put_reals(out, p->is_rotation ? angle : zero, DEGREES);
  put_reals(out, p->is_rotation ? zero : p->shift, 1);
}

vg_status vg_periodic_cfg_write(const char *path,
                                const struct vg_mesh *boundary, size_t n,
                                const struct vg_periodic *pair,
                                struct vg_error *err)
{
  char(*word)[VG_PATCH_WORD] = vg_patch_words(boundary, VG_PATCH_WORD_MOST);
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st = word ? vg_output_open(path, &out, err)
                      : vg_fail_memory(err, "the names of the patches");

  if (st < 0) goto done;
  vg_output_text(&out, "% Periodic patches, by Vanguard: patch, image, centre, "
                       "angles about x, y, z in\n% degrees, translation; "
                       "from the patch to the image\nMARKER_PERIODIC= ( ");
  for (size_t i = 0; i < n; i++) {
    if (i) vg_output_text(&out, ", ");
    put_pair(&out, &pair[i], word[vg_mesh_find_patch(boundary, pair[i].patch)],
             word[vg_mesh_find_patch(boundary, pair[i].image)]);
  }
  vg_output_text(&out, " )\n");
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  free(word);
  return st;
}
