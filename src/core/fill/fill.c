/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/fill/fill.h"

#include <assert.h>
#include <math.h>

#include "base/checks.h"
#include "base/clock.h"
#include "core/fill/fill_parts.h"
#include "core/recover/boundary.h"

static void add_boundary(struct vg_fill_report *to,
                         const struct vg_boundary_report *b)
{
  to->n_surface_face_lost += b->n_face_lost;
  to->n_pocket += b->n_pocket;
  to->n_pocket_cell += b->n_pocket_cell;
  to->n_retry += b->n_retry;
  to->n_unassisted += b->n_unassisted;
  to->whole_void |= b->whole_void;
  to->n_steiner += b->n_steiner;
}

/* If recovery fails in a region, this is not an error: the cut may be made
 * elsewhere, or the void filled without it. */
static vg_status recover(struct vg_filling *g, struct vg_error *err)
{
  const struct vg_front *f = g->front;
  const double(*x)[3] = (const double(*)[3])f->x;
  const uint32_t(*face)[3] = (const uint32_t(*)[3])f->face;
  struct vg_boundary_report b = { 0 };
  double t0 = vg_clock();
  vg_status st;

  if (g->region)
    st = vg_boundary_open(f->n_point, x, f->n_face, face, g->region, g->sizing,
                          &g->t, &b, err);
  else
    st = vg_boundary_tets(f->n_point, x, f->n_face, face, g->sizing, &g->t, &b,
                          err);
  add_boundary(g->report, &b);
  g->report->time_boundary += vg_clock() - t0;
  if (st != VG_ERR_GEOMETRY || !g->region) return st;
  g->report->n_retry++;
  return VG_BLOCKED;
}

/* Set VG_MARK on the cells that are kept: all cells, or those of a region. */
static vg_status choose(struct vg_filling *g, struct vg_error *err)
{
  struct vg_tets *t = &g->t;

  if (g->region) return vg_zone_choose(g, err);
  for (size_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD) continue;
    t->flag[c] |= VG_MARK;
    g->out.n_cell++;
  }
  return VG_OK;
}

/* Slots in use: reserved ones cost no memory. */
static void note_bytes(const struct vg_filling *g)
{
  const struct vg_tets *t = &g->t;
  size_t bytes = t->n_point * sizeof *t->x + t->n_free * sizeof *t->free +
                 t->n_cell * (sizeof *t->cell + sizeof *t->flag);

  g->report->bytes = fmax(g->report->bytes, (double)bytes);
}

static vg_status make(struct vg_filling *g, struct vg_error *err)
{
  vg_status st = vg_stopped(&g->options->stop, err);

  if (st == VG_OK) st = recover(g, err);
  if (st == VG_OK) st = vg_filling_populate(g, err);
  note_bytes(g);
  if (st == VG_OK && g->region) st = vg_zone_narrow(g, err);
  if (st == VG_OK) st = vg_filling_improve(g, err);
  if (st == VG_OK) st = choose(g, err);
  if (st == VG_OK) st = vg_filled_take(g, err);
  if (st == VG_OK)
    VG_CHECK("the filling of a front",
             vg_filled_defects(g->front, &g->out, g->region != NULL));
  return st;
}

vg_status vg_fill_front(const struct vg_front *front,
                        const struct vg_region *region,
                        const struct vg_sizing *sizing,
                        const struct vg_fill_options *options,
                        struct vg_filled *out, struct vg_fill_report *report,
                        struct vg_error *err)
{
  struct vg_filling g = { front,  region,       sizing,        options,
                          report, VG_TETS_INIT, VG_FILLED_INIT };
  double t0 = vg_clock();
  vg_status st;

  assert(sizing && options && options->sweeps >= 0 && report);
  assert(!region || region->n_plane > 0 || region->n_wall > 0);
  assert(!region || vg_region_is_sound(region));
  assert(!out->n_point && !out->n_cell && !out->x && !out->cell);
  assert(!out->n_face && !out->n_consumed && !out->face && !out->consumed);
  if (!front->n_face) return region ? VG_BLOCKED : VG_OK;
  st = vg_front_check(front, err);
  if (st == VG_OK) st = make(&g, err);
  if (st == VG_OK) *out = g.out;
  else vg_filled_release(&g.out);
  vg_tets_release(&g.t);
  report->time_total += vg_clock() - t0;
  return st;
}
