#include "core/fill/grow.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/fill/growth.h"
#include "core/recover/boundary.h"

struct growth {
  struct vg_growth k;
  struct vg_void *v;
  uint32_t *local;           /* [v->n_point] number in t, or VG_NONE */
  uint32_t *global;          /* [t.n_point] number in v */
};

/* --- from the front to cells --------------------------------------------- */

static vg_status recover(struct growth *g, struct vg_error *err)
{
  struct vg_void *v = g->v;
  struct vg_boundary_report b = {0};
  double (*x)[3] = NULL;
  uint32_t (*tri)[3] = NULL;
  size_t n = 0;
  vg_status st = VG_OK;

  g->local = vg_alloc(v->n_point, sizeof *g->local);
  tri = vg_alloc(v->n_face, sizeof *tri);
  if (g->local && tri) {
    memset(g->local, 0xff, v->n_point * sizeof *g->local);
    for (size_t i = 0; i < v->n_face; i++)
      for (int k = 0; k < 3; k++) g->local[v->face[i][k]] = 0;
    for (size_t p = 0; p < v->n_point; p++)
      if (g->local[p] != VG_NONE) g->local[p] = (uint32_t)n++;
    x = vg_alloc(n, sizeof *x);
  }
  if (!g->local || !tri || !x) {
    st = vg_fail_memory(err, "the front");
    goto done;
  }
  for (size_t p = 0; p < v->n_point; p++)
    if (g->local[p] != VG_NONE) memcpy(x[g->local[p]], v->x[p], sizeof *x);
  for (size_t i = 0; i < v->n_face; i++)
    for (int k = 0; k < 3; k++) tri[i][k] = g->local[v->face[i][k]];
  g->k.n_front = n;
  VG_TRY(vg_boundary_tets(n, (const double (*)[3])x, v->n_face,
                          (const uint32_t (*)[3])tri, &g->k.t, &b, err));
  g->k.report->n_surface_face_lost += b.n_face_lost;
  g->k.report->n_pocket += b.n_pocket;
  g->k.report->n_pocket_cell += b.n_pocket_cell;
  g->k.report->n_retry += b.n_retry;
  g->k.report->whole_void |= b.whole_void;
  g->k.report->n_steiner += b.n_steiner;
done:
  free(x);
  free(tri);
  return st;
}

/* --- what is kept -------------------------------------------------------- */

/* VG_MARK on the cells that become final. */
static size_t choose(struct growth *g)
{
  struct vg_tets *t = &g->k.t;
  size_t n = 0, most = g->k.options->max_cells;

  for (size_t c = 0; c < t->n_cell && (!most || n < most); c++) {
    if (t->flag[c] & VG_DEAD) continue;
    t->flag[c] |= VG_MARK;
    n++;
  }
  return n;
}

static vg_status number_points(struct growth *g, struct vg_error *err)
{
  struct vg_tets *t = &g->k.t;
  struct vg_void *v = g->v;

  g->global = vg_alloc(t->n_point, sizeof *g->global);
  if (!g->global ||
      vg_reserve(&v->x, &v->cap_point, v->n_point + t->n_point - g->k.n_front,
                 sizeof *v->x))
    return vg_fail_memory(err, "the points of the mesh");
  memset(g->global, 0xff, t->n_point * sizeof *g->global);
  for (size_t p = 0; p < v->n_point; p++)
    if (g->local[p] != VG_NONE) g->global[g->local[p]] = (uint32_t)p;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && t->flag[c] & VG_MARK; i++)
      if (t->cell[c].v[i] >= g->k.n_front) g->global[t->cell[c].v[i]] = 0;
  for (size_t p = g->k.n_front; p < t->n_point; p++)
    if (g->global[p] != VG_NONE) {
      memcpy(v->x[v->n_point], t->x[p], sizeof *v->x);
      g->global[p] = (uint32_t)v->n_point++;
    }
  return VG_OK;
}

/* The new front: faces between a kept cell and one that is not, and old front
 * faces before a cell that is not kept. All face the cell that is not kept. */
static size_t new_front(const struct growth *g, uint32_t (*face)[3])
{
  const struct vg_tets *t = &g->k.t;
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & (VG_MARK | VG_DEAD)) continue;
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i];

      if (!(t->flag[c] >> i & 1) &&
          (link == VG_NONE || !(t->flag[link >> 2] & VG_MARK)))
        continue;
      for (int k = 0; face && k < 3; k++)
        face[n][k] = g->global[t->cell[c].v[vg_face[i][k]]];
      n++;
    }
  }
  return n;
}

static vg_status commit(struct growth *g, struct vg_error *err)
{
  struct vg_tets *t = &g->k.t;
  struct vg_void *v = g->v;
  size_t n = choose(g), n_face;
  vg_status st;

  if (vg_reserve(&v->cell, &v->cap_cell, v->n_cell + n, sizeof *v->cell))
    return vg_fail_memory(err, "the cells of the mesh");
  n_face = new_front(g, NULL);
  if (vg_reserve(&v->face, &v->cap_face, n_face, sizeof *v->face))
    return vg_fail_memory(err, "the front");
  VG_TRY(number_points(g, err));
  for (size_t c = 0; c < t->n_cell; c++)
    if (t->flag[c] & VG_MARK) {
      for (int i = 0; i < 4; i++)
        v->cell[v->n_cell][i] = g->global[t->cell[c].v[i]];
      v->n_cell++;
    }
  v->n_face = new_front(g, v->face);
done:
  return st;
}

vg_status vg_grow(struct vg_void *v, const struct vg_sizing *sizing,
                  const struct vg_grow_options *options,
                  struct vg_fill_report *report, struct vg_error *err)
{
  struct growth g = { .k = { sizing, NULL, options, report, VG_TETS_INIT, 0 },
                      .v = v };
  double t0 = vg_clock();
  vg_status st = VG_OK;

  if (!v->n_face) return VG_OK;
  if (vg_growth_stopped(&g.k, "recovering the boundary", 0, v->n_face))
    return VG_BLOCKED;
  st = recover(&g, err);
  report->time_boundary += vg_clock() - t0;
  if (st == VG_OK) st = vg_growth_populate(&g.k, err);
  if (st == VG_OK) st = vg_growth_improve(&g.k, err);
  if (st == VG_OK) st = commit(&g, err);
  vg_tets_release(&g.k.t);
  free(g.local);
  free(g.global);
  report->time_total += vg_clock() - t0;
  return st;
}
