/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Notes on settings without effect, and on symmetry planes that FUN3D would not
 * recognise. Declared in run/input/input.h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/input/input.h"
#include "io/mesh/format.h"
#include "partition/cut/decomposition.h"
#include "run/common/text.h"

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
  "the domain was cut by planes (decompose)",
  "the input is no plane section",
  "there are no cells to judge"
};

static unsigned in_use(const struct vg_problem *p, int layers_on)
{
  const struct vg_input_files *f = &p->read.files;
  int parted = p->read.settings.decompose != VG_DECOMPOSE_ADVANCING;
  int planes = p->read.settings.decompose != VG_DECOMPOSE_DISCRETE;
  int cad = !*f->front && *f->surface && vg_format_is_cad(f->surface);

  return 1u << VG_USE_ALWAYS | (unsigned)(*f->d3m != 0) << VG_USE_D3M |
         (unsigned)cad << VG_USE_CAD |
         (unsigned)(p->boundary.remeshing.is_done || p->read.is_section)
           << VG_USE_REMESH |
         (unsigned)p->read.is_section << VG_USE_SECTION |
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
  size_t n_hard = 0, n_layer = 0;

  if (!given) {
    vg_print_lose();
    return;
  }
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
  for (size_t i = 0; i < s->n_layer; i++)
    n_layer += s->layer_row[i].grow != VG_ANSWER_NO;
  if (n_layer && missing >> VG_USE_LAYERS & 1)
    vg_note(&p->notes,
            "table that has no effect because %s: layers (its patches grow "
            "layers if walls, or the column grow, requests them)",
            reason[VG_USE_LAYERS]);
  if (s->n_surface && missing >> VG_USE_REMESH & 1)
    vg_note(&p->notes, "table that has no effect because %s: surface",
            reason[VG_USE_REMESH]);
}

/* A patch that is thinner than this part of the largest extent of the mesh is
 * meant to be a plane. */
#define NEARLY_PLANE 1e-3

static void widen(double box[2], double x)
{
  if (x < box[0]) box[0] = x;
  if (x > box[1]) box[1] = x;
}

/* Axis along which patch p is thinnest, and its extent there. */
static int thin_axis(const struct vg_mesh *m, size_t p, double *extent)
{
  double box[3][2];
  int axis = 0;

  for (int k = 0; k < 3; k++) box[k][0] = INFINITY, box[k][1] = -INFINITY;
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; m->tri_patch[i] == p && k < 9; k++)
      widen(box[k % 3], m->point[m->tri[i][k / 3]][k % 3]);
  for (size_t i = 0; i < m->n_quad; i++)
    for (int k = 0; m->quad_patch[i] == p && k < 12; k++)
      widen(box[k % 3], m->point[m->quad[i][k / 3]][k % 3]);
  for (int k = 1; k < 3; k++)
    if (box[k][1] - box[k][0] < box[axis][1] - box[axis][0]) axis = k;
  *extent = box[axis][1] - box[axis][0];
  return axis;
}

void vg_note_symmetry(struct vg_notes *notes, const struct vg_mesh *m)
{
  double lo[3], hi[3], size = 0;

  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++)
    if (hi[k] - lo[k] > size) size = hi[k] - lo[k];
  for (size_t p = 0; p < m->n_patch; p++) {
    const struct vg_patch *at = m->patch + p;
    double extent;
    int axis;

    if (at->bc != 1 || at->bc_fun3d != 3000) continue;
    axis = thin_axis(m, p, &extent);
    if (!(extent > 0 && extent <= NEARLY_PLANE * size)) continue;
    vg_note(notes,
            "patch %d (%s) is a symmetry plane (1), but its points deviate by "
            "%.2g in %c, more than 1e-9 of the mesh: FUN3D's code is that of a "
            "slip wall, 3000, instead of %d; move the points into the plane",
            at->id, at->name, extent, "xyz"[axis], 6661 + axis);
  }
}
