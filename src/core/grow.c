#include "core/grow.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "core/boundary.h"
#include "core/hilbert.h"
#include "core/insert.h"
#include "core/optimise.h"
#include "core/place.h"

/* Least distance of a new point to any other, over the spacing, and least
 * height over a front face, over its mean edge: points that fail would make
 * cells worse than those of the coarser mesh without them. */
static const double least_distance = 0.5;
static const double least_height = 0.3;
/* The first points of all keep farther off: the front decides near it. */
static const double seed_distance = 0.8;

enum { PROGRESS_STEP = 1 << 15 };

struct growth {
  struct vg_void *v;
  const struct vg_sizing *sizing;
  const struct vg_region *region;
  const struct vg_grow_options *options;
  struct vg_fill_report *report;
  struct vg_tets t;
  size_t n_front;            /* points of the front: the first of t */
  uint32_t *local;           /* [v->n_point] number in t, or VG_NONE */
  uint32_t *global;          /* [t.n_point] number in v */
};

static double now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int stopped(const struct growth *g, const char *stage, size_t done,
                   size_t expected)
{
  return g->options->progress &&
         g->options->progress(g->options->user, stage, done, expected);
}

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
  g->n_front = n;
  VG_TRY(vg_boundary_tets(n, (const double (*)[3])x, v->n_face,
                          (const uint32_t (*)[3])tri, &g->t, &b, err));
  g->report->n_surface_face_lost += b.n_face_lost;
  g->report->n_pocket += b.n_pocket;
  g->report->n_pocket_cell += b.n_pocket_cell;
  g->report->n_retry += b.n_retry;
  g->report->whole_void |= b.whole_void;
  g->report->n_steiner += b.n_steiner;
done:
  free(x);
  free(tri);
  return st;
}

static vg_status insert_one(struct growth *g, struct vg_inserter *s,
                            const double x[3], double nearest, uint32_t *at,
                            struct vg_error *err)
{
  struct vg_tets *t = &g->t;
  uint32_t p = (uint32_t)t->n_point, c;
  vg_status st;

  c = vg_tets_locate(t, *at, x);
  if (c == VG_NONE || t->flag[c] & VG_OUTSIDE) return VG_BLOCKED;
  if (vg_tets_reserve_points(t, 1))
    return vg_fail_memory(err, "the points of the mesh");
  memcpy(t->x[p], x, sizeof *t->x);
  t->n_point++;
  st = vg_insert(s, p, c, least_height,
                 nearest * vg_sizing_at(g->sizing, x), err);
  if (st == VG_OK) *at = s->last;
  else t->n_point--;
  return st;
}

static vg_status insert_all(struct growth *g, const struct vg_placed *placed,
                            const uint32_t *order, double nearest,
                            struct vg_error *err)
{
  struct vg_inserter s;
  uint32_t at = 0;
  vg_status st = vg_inserter_init(&s, &g->t, err);

  while (g->t.flag[at] & VG_OUTSIDE) at++;
  if (st == VG_OK && vg_tets_reserve_points(&g->t, placed->n))
    st = vg_fail_memory(err, "the points of the mesh");
  for (size_t i = 0; st >= 0 && i < placed->n; i++) {
    st = insert_one(g, &s, placed->x[order[i]], nearest, &at, err);
    g->report->n_inserted += st == VG_OK;
    g->report->n_refused += st == VG_BLOCKED;
    if (i % PROGRESS_STEP == 0 && stopped(g, "inserting", i, placed->n)) {
      vg_inserter_release(&s);
      return VG_BLOCKED;
    }
  }
  vg_inserter_release(&s);
  return st < 0 ? st : VG_OK;
}

static vg_status insert_placed(struct growth *g, struct vg_placed *placed,
                               double nearest, struct vg_error *err)
{
  uint32_t *order = vg_alloc(placed->n, sizeof *order);
  double t0 = now();
  vg_status st;

  if (!order) {
    st = vg_fail_memory(err, "ordering points");
    goto done;
  }
  VG_TRY(vg_insertion_order(placed->n, (const double (*)[3])placed->x, order,
                            err));
  st = insert_all(g, placed, order, nearest, err);
done:
  free(order);
  free(placed->x);
  g->report->n_placed += placed->n;
  g->report->time_insert += now() - t0;
  return st;
}

static vg_status populate(struct growth *g, struct vg_error *err)
{
  struct vg_placed placed = {0};
  double t0;
  vg_status st;

  VG_TRY(vg_place_seeds(g->n_front, (const double (*)[3])g->t.x, g->sizing,
                        g->region, &placed, err));
  st = insert_placed(g, &placed, seed_distance, err);
  if (st != VG_OK) goto done;
  t0 = now();
  VG_TRY(vg_place(&g->t, g->sizing, g->region, g->options->point_limit,
                  &placed, err));
  g->report->time_place += now() - t0;
  st = insert_placed(g, &placed, least_distance, err);
done:
  return st;
}

static vg_status improve(struct growth *g, struct vg_error *err)
{
  struct vg_optimise_report r = {0};
  double t0 = now();
  vg_status st = VG_OK;

  VG_TRY(vg_tets_tidy(&g->t, g->n_front, err));
  if (stopped(g, "optimising", 0, 1)) return VG_BLOCKED;
  if (g->options->sweeps > 0) {
    st = vg_optimise(&g->t, g->n_front, g->options->sweeps, &r, err);
    g->report->n_smoothed += r.n_smoothed;
    g->report->n_flip += r.n_flip;
    g->report->n_collapse += r.n_collapse;
    g->report->n_split += r.n_split;
  }
  g->report->time_optimise += now() - t0;
done:
  return st;
}

/* --- what is kept -------------------------------------------------------- */

/* VG_MARK on the cells that become final. */
static size_t choose(struct growth *g)
{
  struct vg_tets *t = &g->t;
  size_t n = 0, most = g->options->max_cells;

  for (size_t c = 0; c < t->n_cell && (!most || n < most); c++) {
    const uint32_t *v = t->cell[c].v;

    if (t->flag[c] & VG_DEAD) continue;
    if (g->region && !vg_region_has_cell(g->region, t->x[v[0]], t->x[v[1]],
                                         t->x[v[2]], t->x[v[3]]))
      continue;
    t->flag[c] |= VG_MARK;
    n++;
  }
  return n;
}

static vg_status number_points(struct growth *g, struct vg_error *err)
{
  struct vg_tets *t = &g->t;
  struct vg_void *v = g->v;

  g->global = vg_alloc(t->n_point, sizeof *g->global);
  if (!g->global ||
      vg_reserve(&v->x, &v->cap_point, v->n_point + t->n_point - g->n_front,
                 sizeof *v->x))
    return vg_fail_memory(err, "the points of the mesh");
  memset(g->global, 0xff, t->n_point * sizeof *g->global);
  for (size_t p = 0; p < v->n_point; p++)
    if (g->local[p] != VG_NONE) g->global[g->local[p]] = (uint32_t)p;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && t->flag[c] & VG_MARK; i++)
      if (t->cell[c].v[i] >= g->n_front) g->global[t->cell[c].v[i]] = 0;
  for (size_t p = g->n_front; p < t->n_point; p++)
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
  const struct vg_tets *t = &g->t;
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
  struct vg_tets *t = &g->t;
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
                  const struct vg_region *region,
                  const struct vg_grow_options *options,
                  struct vg_fill_report *report, struct vg_error *err)
{
  struct growth g = {v, sizing, region, options, report, VG_TETS_INIT, 0,
                     NULL, NULL};
  double t0 = now();
  vg_status st = VG_OK;

  if (!v->n_face) return VG_OK;
  if (stopped(&g, "recovering the boundary", 0, v->n_face)) return VG_BLOCKED;
  st = recover(&g, err);
  report->time_boundary += now() - t0;
  if (st == VG_OK) st = populate(&g, err);
  if (st == VG_OK) st = improve(&g, err);
  if (st == VG_OK) st = commit(&g, err);
  vg_tets_release(&g.t);
  free(g.local);
  free(g.global);
  report->time_total += now() - t0;
  return st;
}
