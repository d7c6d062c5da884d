/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Swaps across interfaces: the cells around those to be swapped are linked to
 * a patch. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/repair/repair_parts.h"

struct patch {
  struct vg_overlap *f;
  float below;   /* Cells below this shape are swapped. */
  uint8_t *mark; /* [f.t.n_point] 1: corner of a cell to be swapped. */
  size_t n;
  uint32_t *cell;   /* [n] Indices in the overlap. */
  uint32_t *number; /* [f.t.n_point] Index in the patch, or VG_NONE. */
  uint32_t *vertex; /* [t.n_point] Inverse. */
  struct vg_tets t;
  struct vg_metrics *metrics; /* Of the points of t, or NULL. */
  uint32_t (*old)[4];         /* [n] Vertices before the swaps. */
  float *q;                   /* [t.n_cell] Shapes. */
  uint8_t *gone;              /* [f.t.n_cell] 1: removed. */
};

static void patch_release(struct patch *p)
{
  vg_metrics_free(p->metrics);
  vg_tets_release(&p->t);
  free(p->mark);
  free(p->cell);
  free(p->number);
  free(p->vertex);
  free(p->old);
  free(p->q);
  free(p->gone);
}

/* --- selection ----------------------------------------------------------- */

static int is_ours(const struct vg_overlap *f, size_t c)
{
  return !(f->kind[c] & VG_OVERLAP_LATER);
}

/* Chooses the cells with two marked corners: only these share an edge or a
 * face with a cell to be swapped. */
static vg_status choose(struct patch *p)
{
  const struct vg_overlap *f = p->f;
  size_t n = f->t.n_cell, n_want = 0;

  p->mark = vg_calloc(f->t.n_point, 1);
  if (!p->mark) return VG_ERR_MEMORY;
  for (size_t c = 0; c < n; c++) {
    if (f->shape[c] >= p->below || !is_ours(f, c)) continue;
    for (int i = 0; i < 4; i++) p->mark[f->t.cell[c].v[i]] = 1;
    n_want++;
  }
  if (!n_want) return VG_OK;
  p->cell = vg_alloc(n, sizeof *p->cell);
  if (!p->cell) return VG_ERR_MEMORY;
  for (size_t c = 0; c < n; c++) {
    const uint32_t *v = f->t.cell[c].v;

    if (p->mark[v[0]] + p->mark[v[1]] + p->mark[v[2]] + p->mark[v[3]] > 1 &&
        is_ours(f, c))
      p->cell[p->n++] = (uint32_t)c;
  }
  return VG_OK;
}

/* --- links --------------------------------------------------------------- */

static int on_boundary(const struct patch *p, uint32_t v)
{
  const struct vg_overlap *f = p->f;
  uint32_t at = p->vertex[v];

  if (at < f->q->n_in) return !(f->q->in[at] >> 32);
  return at >= f->n_base && !(f->other[at - f->n_base] >> 32);
}

/* Fixes the outer faces of the patch, and faces that may be boundary
 * triangles. */
static void fix_faces(struct patch *p)
{
  struct vg_tets *t = &p->t;

  for (uint32_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;
    int on[4], n = 0;

    for (int i = 0; i < 4; i++) n += on[i] = on_boundary(p, v[i]);
    for (int i = 0; i < 4; i++)
      if (t->cell[c].link[i] == VG_NONE || n - on[i] == 3)
        t->flag[c] |= (uint8_t)(1 << i);
  }
}

static vg_status make_room(struct patch *p)
{
  size_t n_vertex = p->f->t.n_point;

  p->number = vg_alloc(n_vertex, sizeof *p->number);
  p->vertex = vg_alloc(4 * p->n < n_vertex ? 4 * p->n : n_vertex,
                       sizeof *p->vertex);
  p->old = vg_alloc(p->n, sizeof *p->old);
  p->q = vg_alloc(p->n, sizeof *p->q);
  p->gone = vg_calloc(p->f->t.n_cell, 1);
  if (!p->number || !p->vertex || !p->old || !p->q || !p->gone)
    return VG_ERR_MEMORY;
  memset(p->number, 0xff, n_vertex * sizeof *p->number);
  return VG_OK;
}

static vg_status link_cells(struct patch *p)
{
  const struct vg_overlap *f = p->f;
  double(*x)[3];
  size_t n_point = 0;
  vg_status st;

  for (size_t k = 0; k < p->n; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t v = f->t.cell[p->cell[k]].v[i];

      if (p->number[v] == VG_NONE) {
        p->vertex[n_point] = v;
        p->number[v] = (uint32_t)n_point++;
      }
      p->old[k][i] = p->number[v];
    }
  x = vg_alloc(n_point, sizeof *x);
  if (!x) return VG_ERR_MEMORY;
  for (size_t v = 0; v < n_point; v++)
    memcpy(x[v], f->t.x[p->vertex[v]], sizeof *x);
  st = vg_tets_from_cells(&p->t, n_point, x, p->n, (const uint32_t(*)[4])p->old,
                          NULL);
  if (st == VG_OK) st = vg_metrics_of_corners(f->sizing, &p->t, &p->metrics);
  if (st < 0) return st;
  for (size_t k = 0; k < p->n; k++) {
    memcpy(p->old[k], p->t.cell[k].v, sizeof *p->old);
    p->q[k] = f->shape[p->cell[k]];
  }
  fix_faces(p);
  return VG_OK;
}

/* --- back into the overlap ----------------------------------------------- */

static int is_new(const struct patch *p, size_t c)
{
  return !(p->t.flag[c] & VG_DEAD) &&
         (c >= p->n || memcmp(p->t.cell[c].v, p->old[c], sizeof *p->old));
}

static size_t find_gone(struct patch *p)
{
  size_t n = 0;

  for (size_t k = 0; k < p->n; k++)
    if (p->t.flag[k] & VG_DEAD || is_new(p, k)) {
      p->gone[p->cell[k]] = 1;
      n++;
    }
  return n;
}

/* Marks removed cells in the halos and in out->gone. */
static vg_status note_gone(const struct patch *p, struct vg_edit *out)
{
  const struct vg_overlap *f = p->f;
  size_t at = f->n_own;

  out->gone = vg_calloc(f->q->n_cell, 1);
  if (!out->gone) return VG_ERR_MEMORY;
  for (size_t c = 0; c < f->n_own; c++)
    if (p->gone[c]) out->gone[f->place[c]] = 1;
  for (size_t k = 0; k < f->n_halo; k++) {
    struct vg_halo *s = f->halo[k];

    for (size_t c = 0; c < s->n_cell; c++)
      if (p->gone[at + c]) s->place[s->n_gone++] = s->place[c];
    at += s->n_cell;
  }
  return VG_OK;
}

static vg_status put_back(struct patch *p)
{
  struct vg_overlap *f = p->f;
  size_t n = 0, n_new = 0;

  for (size_t c = 0; c < f->t.n_cell; c++) {
    if (p->gone[c]) continue;
    if (n < c) {
      f->t.cell[n] = f->t.cell[c];
      f->kind[n] = f->kind[c];
      f->shape[n] = f->shape[c];
    }
    n++;
  }
  for (size_t c = 0; c < p->t.n_cell; c++) n_new += (size_t)is_new(p, c);
  if (vg_reserve(&f->t.cell, &f->t.cap_cell, n + n_new, sizeof *f->t.cell) ||
      vg_reserve(&f->kind, &f->cap_kind, n + n_new, 1) ||
      vg_reserve(&f->shape, &f->cap_shape, n + n_new, sizeof *f->shape))
    return VG_ERR_MEMORY;
  for (size_t c = 0; c < p->t.n_cell; c++) {
    if (!is_new(p, c)) continue;
    for (int i = 0; i < 4; i++)
      f->t.cell[n].v[i] = p->vertex[p->t.cell[c].v[i]];
    f->kind[n] = VG_OVERLAP_NEW;
    f->shape[n++] = p->q[c];
  }
  f->t.n_cell = n;
  return VG_OK;
}

vg_status vg_overlap_swap(struct vg_overlap *f, struct vg_edit *out,
                          size_t *n_swap)
{
  struct patch p = { .f = f, .below = vg_repair_levels(f->sizing)->swap };
  struct vg_optimise_report r = { 0 };
  vg_status st = choose(&p);

  *n_swap = 0;
  if (st == VG_OK && p.n) {
    st = make_room(&p);
    if (st == VG_OK) st = link_cells(&p);
    if (st == VG_OK)
      st = vg_optimise_swaps(&p.t, p.below, p.metrics, &p.q, &r, NULL);
    if (st == VG_OK && find_gone(&p)) {
      st = note_gone(&p, out);
      if (st == VG_OK) st = put_back(&p);
    }
    /* inconsistent or flat cells are left unchanged */
    if (st == VG_ERR_GEOMETRY) st = VG_OK;
  }
  *n_swap = r.n_flip;
  patch_release(&p);
  return st;
}

vg_status vg_overlap_take(const struct vg_overlap *f, struct vg_edit *out)
{
  uint32_t *to = vg_alloc(f->n_other, sizeof *to);
  size_t n = 0;

  while (n < f->t.n_cell && f->kind[f->t.n_cell - 1 - n] & VG_OVERLAP_NEW) n++;
  out->cell = vg_alloc(n, sizeof *out->cell);
  out->name = vg_alloc(f->n_other, sizeof *out->name);
  out->x = vg_alloc(f->n_other, sizeof *out->x);
  if (!to || !out->cell || !out->name || !out->x) {
    free(to);
    return VG_ERR_MEMORY;
  }
  if (f->n_other) memset(to, 0xff, f->n_other * sizeof *to);
  for (size_t c = f->t.n_cell - n; c < f->t.n_cell; c++, out->n_cell++)
    for (int i = 0; i < 4; i++) {
      uint32_t v = f->t.cell[c].v[i], k = v - (uint32_t)f->n_base;

      if (v >= f->n_base && to[k] == VG_NONE) {
        to[k] = (uint32_t)out->n_point;
        out->name[out->n_point] = f->other[k];
        memcpy(out->x[out->n_point++], f->t.x[v], sizeof *out->x);
      }
      out->cell[out->n_cell][i] = v < f->n_base ? v
                                                : (uint32_t)f->n_base + to[k];
    }
  free(to);
  return VG_OK;
}
