/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/doubled.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/copies.h"

static int is_inner(const struct vg_mesh *m, size_t t, int32_t side)
{
  return m->patch[m->tri_patch[t]].inner == side;
}

/* --- copies of points ----------------------------------------------------- */

/* Points of triangles of inner surfaces at the same place are copies of each
 * other. No others are: layers may end at the same place as well. */
static vg_status find_copies(struct vg_doubled *d, struct vg_error *err)
{
  const struct vg_mesh *m = d->boundary;
  vg_status st;

  VG_TRY(vg_mesh_inner_points(m, &d->first, err));
  d->has_copies = vg_calloc(m->n_point, 1);
  if (!d->has_copies) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  for (uint32_t p = 0; p < m->n_point; p++)
    if (d->first[p] != p) d->has_copies[d->first[p]] = 1;
done:
  return st;
}

/* --- triangles at inner surfaces -------------------------------------------
 */

/* Triangles by their first copies, of pairs only the front, and those that
 * touch inner surfaces. */
static vg_status list_triangles(struct vg_doubled *d, size_t *n,
                                struct vg_error *err)
{
  const struct vg_mesh *m = d->boundary;
  uint8_t *on = vg_calloc(m->n_point, 1);
  uint32_t *other = vg_alloc(m->n_tri, sizeof *other);
  vg_status st = VG_OK;

  d->tri = vg_alloc(m->n_tri, sizeof *d->tri);
  d->of = vg_alloc(m->n_tri, sizeof *d->of);
  d->back = vg_alloc(m->n_tri, sizeof *d->back);
  if (!on || !other || !d->tri || !d->of || !d->back)
    VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  VG_TRY(vg_mesh_inner_pairs(m, d->first, other, err));
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && !is_inner(m, t, VG_INNER_NOT); k++)
      on[d->first[m->tri[t][k]]] = 1;
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t v[3];

    for (int k = 0; k < 3; k++) v[k] = d->first[m->tri[t][k]];
    if (!(on[v[0]] | on[v[1]] | on[v[2]]) ||
        (is_inner(m, t, VG_INNER_BACK) && other[t] != UINT32_MAX))
      continue;
    memcpy(d->tri[*n], v, sizeof v);
    d->back[*n] = other[t];
    d->of[(*n)++] = (uint32_t)t;
  }
done:
  free(on);
  free(other);
  return st;
}

vg_status vg_doubled_new(struct vg_doubled *d, const struct vg_mesh *boundary,
                         struct vg_error *err)
{
  size_t n = 0;
  vg_status st = VG_OK;

  assert(!d->first && !d->tri);
  if (!vg_mesh_has_inner(boundary)) return VG_OK;
  d->boundary = boundary;
  VG_TRY(find_copies(d, err));
  VG_TRY(list_triangles(d, &n, err));
  VG_TRY(vg_sides_build(&d->sides, boundary->n_point,
                        (const double(*)[3])boundary->point, n,
                        (const uint32_t(*)[3])d->tri, err));
done:
  if (st < 0) vg_doubled_release(d);
  return st;
}

void vg_doubled_release(struct vg_doubled *d)
{
  free(d->first);
  free(d->has_copies);
  free(d->tri);
  free(d->of);
  free(d->back);
  vg_sides_release(&d->sides);
  memset(d, 0, sizeof *d);
}

/* --- use -------------------------------------------------------------------
 */

vg_status vg_doubled_merge(const struct vg_doubled *d, struct vg_front *f,
                           struct vg_error *err)
{
  uint32_t *to, n = 0;

  if (!d->first) return VG_OK;
  assert(f->id && f->n_point == d->boundary->n_point);
  to = vg_alloc(f->n_point, sizeof *to);
  if (!to) return vg_fail_memory(err, "the front");
  for (uint32_t p = 0; p < f->n_point; p++) {
    if (d->first[p] != p) continue;
    memmove(f->x[n], f->x[p], sizeof *f->x);
    f->id[n] = f->id[p];
    to[p] = n++;
  }
  f->n_point = n;
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++) f->face[i][k] = to[d->first[f->face[i][k]]];
  free(to);
  return VG_OK;
}

uint64_t vg_doubled_copies(const struct vg_doubled *d)
{
  uint64_t n = 0;

  for (uint32_t p = 0; d->first && p < d->boundary->n_point; p++)
    n += d->first[p] != p;
  return n;
}

int vg_doubled_has(const struct vg_doubled *d, const uint32_t v[3])
{
  const struct vg_sides *s = &d->sides;

  for (uint32_t k = d->first ? s->first[v[0]] : 0;
       d->first && k < s->first[v[0] + 1]; k++) {
    const uint32_t t = s->corner[k] / 3;
    int n = 0;

    for (int i = 0; i < 3; i++)
      n += v[i] == d->tri[t][0] || v[i] == d->tri[t][1] || v[i] == d->tri[t][2];
    if (n == 3 && d->back[t] != UINT32_MAX) return 1;
  }
  return 0;
}

/* The corner of the boundary triangle that is a side of half-face h. The back
 * has the corners in the opposite order, and may begin with any. */
static uint32_t corner_of(const struct vg_doubled *d, uint32_t e)
{
  const uint32_t t = e / 6, v = d->tri[t][e % 3];
  const uint32_t *tri = d->boundary->tri[e / 3 % 2 ? d->back[t] : d->of[t]];

  for (int k = 0; k < 3; k++)
    if (d->first[tri[k]] == v) return tri[k];
  return UINT32_MAX;
}

/* --- slices -----------------------------------------------------------------
 */

/* A slice while its cells get copies. */
struct slicing {
  const struct vg_doubled *d;
  const struct vg_slice *s;
  uint32_t (*cell)[4]; /* [cells of s] copy of its cells, changed */
  uint32_t *local;     /* [boundary n_point] point of the slice of each copy
                          that was added, or UINT32_MAX */
  size_t n_more, cap_more;
  uint32_t *more; /* [n_more] boundary points that were added */
};

/* Boundary point of point k of the slice, or UINT32_MAX. */
static uint32_t boundary_point(const struct slicing *q, uint32_t k)
{
  const uint32_t id = q->s->id[k];

  return id < q->d->boundary->n_point ? id : UINT32_MAX;
}

/* The copy of boundary point v that is corner i of the cell with points w of
 * the slice; UINT32_MAX: the side of the cell is not known. */
static uint32_t find_copy(const struct slicing *q, const uint32_t w[4], int i,
                          uint32_t v)
{
  uint32_t at[3], e;
  const double *x[3];

  for (int k = 0; k < 3; k++) {
    const uint32_t other = w[(i + 1 + k) % 4];

    at[k] = boundary_point(q, other);
    x[k] = q->s->x[other];
  }
  e = vg_sides_find(&q->d->sides, v, at, x);
  if (e == UINT32_MAX || (e / 3 % 2 && q->d->back[e / 6] == UINT32_MAX))
    return UINT32_MAX;
  return corner_of(q->d, e);
}

static vg_status use_copy(struct slicing *q, size_t c, int i, uint32_t v,
                          struct vg_error *err)
{
  const uint32_t *w = (const uint32_t *)q->s->cell[VG_SLICE_TET] + 4 * c;
  const uint32_t copy = find_copy(q, w, i, v);
  const double *x = q->s->x[w[i]];

  if (copy == v) return VG_OK;
  if (copy == UINT32_MAX)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "a cell at (%g, %g, %g) is so flat that its side of the "
                   "inner surface there is not known; refine the surface",
                   x[0], x[1], x[2]);
  if (q->local[copy] == UINT32_MAX) {
    if (vg_reserve(&q->more, &q->cap_more, q->n_more + 1, sizeof *q->more))
      return vg_fail_memory(err, "a slice of the mesh");
    q->local[copy] = (uint32_t)(q->s->n_point + q->n_more);
    q->more[q->n_more++] = copy;
  }
  q->cell[c][i] = q->local[copy];
  return VG_OK;
}

/* Moves the arrays of the slice to one block with the further points: places,
 * cells, ids, own points. */
static vg_status take_block(const struct slicing *q, struct vg_slice *s,
                            struct vg_error *err)
{
  const size_t n_cell = s->n_cell[VG_SLICE_TET], n = s->n_point + q->n_more;
  double(*x)[3] = vg_alloc(n * sizeof *x + 4 * (4 * n_cell + n + s->n_own), 1);
  uint32_t *cell, *id, *own;

  if (!x) return vg_fail_memory(err, "a slice of the mesh");
  cell = (uint32_t *)(void *)(x + n);
  id = cell + 4 * n_cell;
  own = id + n;
  if (s->n_point) memcpy(x, s->x, s->n_point * sizeof *x);
  if (n_cell) memcpy(cell, q->cell, n_cell * sizeof *q->cell);
  if (s->n_point) memcpy(id, s->id, s->n_point * sizeof *id);
  if (s->n_own) memcpy(own, s->own, s->n_own * sizeof *own);
  for (size_t k = 0; k < q->n_more; k++) {
    memcpy(x[s->n_point + k], q->d->boundary->point[q->more[k]], sizeof *x);
    id[s->n_point + k] = q->more[k];
  }
  free(s->keep);
  s->x = (const double(*)[3])x;
  s->cell[VG_SLICE_TET] = cell;
  s->id = id;
  s->own = own;
  s->n_point = n;
  s->keep = x;
  return VG_OK;
}

vg_status vg_doubled_slice(const struct vg_doubled *d, struct vg_slice *s,
                           struct vg_error *err)
{
  const size_t n_cell = s->n_cell[VG_SLICE_TET];
  const size_t n_point = d->boundary->n_point;
  struct slicing q = { .d = d, .s = s };
  vg_status st = VG_OK;

  assert(d->first && (s->keep || !s->n_point));
  q.cell = vg_alloc(n_cell, sizeof *q.cell);
  q.local = vg_alloc(n_point, sizeof *q.local);
  if (!q.cell || !q.local) VG_TRY(vg_fail_memory(err, "a slice of the mesh"));
  if (n_cell) memcpy(q.cell, s->cell[VG_SLICE_TET], n_cell * sizeof *q.cell);
  memset(q.local, 0xff, n_point * sizeof *q.local);
  for (size_t c = 0; c < n_cell; c++)
    for (int i = 0; i < 4; i++) {
      const uint32_t v = boundary_point(&q, s->cell[VG_SLICE_TET][4 * c + i]);

      if (v != UINT32_MAX && vg_doubled_is(d, v))
        VG_TRY(use_copy(&q, c, i, v, err));
    }
  if (q.n_more) st = take_block(&q, s, err);
done:
  free(q.cell);
  free(q.local);
  free(q.more);
  return st;
}
