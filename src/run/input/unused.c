/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Notes on settings without effect. Declared in run/input/input.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/input/input.h"
#include "io/mesh/format.h"
#include "partition/cut/decomposition.h"

#define SHOWN 12

/* Why settings of each kind had no effect, in the order of enum vg_use. */
static const char *const reason[VG_USE_N] = {
  "",
  "",
  "there is no .d3m",
  "no CAD file was read",
  "the surface was not remeshed (remesh_surface)",
  "no layers grow",
  "no farfield was made",
  "the domain was not cut by planes (decompose)",
  "the domain was cut by planes (decompose)"
};

static unsigned in_use(const struct vg_problem *p, int layers_on)
{
  const struct vg_input_files *f = &p->read.files;
  int parted = p->read.settings.decompose != VG_DECOMPOSE_ADVANCING;
  int planes = p->read.settings.decompose != VG_DECOMPOSE_DISCRETE;
  int cad = !*f->front && *f->surface && vg_format_is_cad(f->surface);

  return 1u << VG_USE_ALWAYS | (unsigned)(*f->d3m != 0) << VG_USE_D3M |
         (unsigned)cad << VG_USE_CAD |
         (unsigned)p->boundary.remeshing.is_done << VG_USE_REMESH |
         (unsigned)layers_on << VG_USE_LAYERS |
         (unsigned)p->boundary.domain.added_farfield << VG_USE_FARFIELD |
         (unsigned)planes << VG_USE_PLANES | (unsigned)parted << VG_USE_PARTS;
}

/* Whether the surface is given; sizes of a surface that is made here are scaled
 * as well. */
static int is_given(const struct vg_input_files *f)
{
  return *f->front || (*f->surface && !vg_format_is_cad(f->surface)) ||
         (!*f->surface && !*f->d3m);
}

static void note_use(struct vg_problem *p, const uint8_t *given,
                     enum vg_use use)
{
  const struct vg_param *param;
  char list[SHOWN * 24 + 8] = "";
  const char *name;
  size_t n = 0, at = 0;
  int far;

  for (size_t i = 0; (param = vg_settings_name(i, &name, &far)); i++) {
    if (!given[i] || vg_param_use(param, far) != use) continue;
    if (n++ < SHOWN)
      at += (size_t)snprintf(list + at, sizeof list - at, "%s%s",
                             n > 1 ? ", " : "", name);
  }
  if (!n) return;
  vg_note(&p->notes, "settings that have no effect because %s: %s%s",
          reason[use], list, n > SHOWN ? ", ..." : "");
}

void vg_problem_note_unused(struct vg_problem *p, int layers_on,
                            unsigned judged)
{
  const struct vg_settings *s = &p->read.settings;
  const struct vg_boundary *b = &p->boundary;
  uint8_t *given = vg_settings_given(&p->asked);
  unsigned missing = judged & ~in_use(p, layers_on);
  size_t n_hard = 0;

  if (!given) return; /* As for a note for which there is no memory. */
  for (int use = VG_USE_D3M; use < VG_USE_N; use++)
    if (missing >> use & 1) note_use(p, given, (enum vg_use)use);
  free(given);
  if (layers_on && s->layer.scale_rule && s->scale == 1)
    vg_note(&p->notes, "setting that has no effect because scale is 1: "
                       "scale_layers");
  if (s->scale != 1 && missing >> VG_USE_REMESH & 1 && is_given(&p->read.files))
    vg_note(&p->notes,
            "scale %g changes only sizes in the volume: the surface is not "
            "remeshed and keeps its edge lengths (remesh_surface yes remeshes "
            "it)",
            s->scale);
  for (size_t i = 0; i < b->n_row; i++) n_hard += b->row[i].hard != 0;
  if (n_hard && missing >> VG_USE_REMESH & 1)
    vg_note(&p->notes,
            "setting that has no effect because %s: hard, in %zu rows of the "
            "table patches",
            reason[VG_USE_REMESH], n_hard);
  if (s->n_surface && missing >> VG_USE_REMESH & 1)
    vg_note(&p->notes, "table that has no effect because %s: surface",
            reason[VG_USE_REMESH]);
}
