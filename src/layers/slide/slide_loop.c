/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The new boundary of a slide patch, which is its former one with the edges at
 * walls moved to the tops, and checks of the region that it encloses. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "layers/slide/slide_parts.h"

static int has_key(const uint64_t *key, size_t n, uint64_t k)
{
  return n && bsearch(&k, key, n, sizeof *key, vg_compare_edge_keys) != NULL;
}

static vg_status add_edge(struct vg_slide_work *w, struct vg_slide_loops *l,
                          uint32_t a, uint32_t b)
{
  if (vg_reserve(&l->edge, &l->cap, l->n + 1, sizeof *l->edge))
    return vg_fail_memory(w->err, "the boundary of a slide patch");
  l->edge[l->n][0] = a;
  l->edge[l->n++][1] = b;
  return VG_OK;
}

/* Half-edges of the part without a twin in it, or on an edge of a sheet, except
 * those replaced by columns or curves. */
static vg_status former_edges(struct vg_slide_work *w, size_t s,
                              const uint64_t *border, size_t n_border,
                              struct vg_slide_loops *l)
{
  for (uint32_t i = w->tri_first[s]; i < w->tri_first[s + 1]; i++)
    for (int k = 0; k < 3; k++) {
      const uint32_t *v = w->m->tri[w->tri[i]];
      const uint32_t a = v[k], b = v[k < 2 ? k + 1 : 0];
      const uint32_t twin = vg_slide_twin(w, a, b);

      if (twin != VG_NO_INDEX && w->part_of[twin / 3] == s &&
          !vg_slide_is_held(w, a, b))
        continue;
      if (has_key(border, n_border, (uint64_t)b << 32 | a) ||
          has_key(w->gone, w->n_gone, vg_slide_key(a, b)))
        continue;
      if (add_edge(w, l, a, b)) return VG_ERR_MEMORY;
    }
  return VG_OK;
}

static vg_status new_edges(struct vg_slide_work *w, size_t s,
                           struct vg_slide_loops *l)
{
  for (uint32_t i = w->border_first[s]; i < w->border_first[s + 1]; i++) {
    const uint32_t *r = w->c->border[w->border[i]];
    const uint32_t a = vg_slide_top(w, r[0]), b = vg_slide_top(w, r[1]);

    if (a != b && add_edge(w, l, b, a)) return VG_ERR_MEMORY;
  }
  for (size_t i = 0; i < w->n_edge; i++)
    if (w->edge[i].part == s &&
        add_edge(w, l, w->edge[i].v[0], w->edge[i].v[1]))
      return VG_ERR_MEMORY;
  return VG_OK;
}

static void mark_bad_point(struct vg_slide_work *w, size_t s, uint32_t p,
                           const char *what)
{
  const uint32_t patch = w->part[s].patch;
  const uint32_t i = vg_slide_column(w, p);

  if (i != VG_NO_INDEX) vg_slide_mark_bad(w, i, patch, w->x[p], what);
  for (uint32_t r = w->border_first[s];
       i == VG_NO_INDEX && r < w->border_first[s + 1]; r++)
    for (int k = 0; k < 2; k++) {
      const uint32_t j = w->c->border[w->border[r]][k];

      if (w->c->column[j].root == p)
        vg_slide_mark_bad(w, j, patch, w->x[p], what);
    }
}

static int compare_point(const void *a, const void *b)
{
  const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;

  return (p > q) - (p < q);
}

/* Every point must have equally many incoming and outgoing edges. */
static vg_status check_closed(struct vg_slide_work *w, size_t s,
                              const struct vg_slide_loops *l, int *is_closed)
{
  uint32_t *from = vg_alloc(l->n, sizeof *from);
  uint32_t *to = vg_alloc(l->n, sizeof *to);
  const char *what = "columns do not follow the boundary of the patch";

  *is_closed = 1;
  if (!from || !to) {
    free(from);
    free(to);
    return vg_fail_memory(w->err, "the boundary of a slide patch");
  }
  for (size_t i = 0; i < l->n; i++) {
    from[i] = l->edge[i][0];
    to[i] = l->edge[i][1];
  }
  qsort(from, l->n, sizeof *from, compare_point);
  qsort(to, l->n, sizeof *to, compare_point);
  for (size_t i = 0, j = 0; i < l->n || j < l->n;) {
    if (i < l->n && j < l->n && from[i] == to[j]) {
      i++, j++;
      continue;
    }
    *is_closed = 0;
    if (j == l->n || (i < l->n && from[i] < to[j]))
      mark_bad_point(w, s, from[i++], what);
    else mark_bad_point(w, s, to[j++], what);
  }
  if (!*is_closed && !w->n_bad) vg_slide_mark_bad_all(w, s, what);
  free(from);
  free(to);
  return VG_OK;
}

vg_status vg_slide_boundary(struct vg_slide_work *w, size_t s,
                            struct vg_slide_loops *out)
{
  assert(s < w->n_part && !out->n);

  const size_t n_border = w->border_first[s + 1] - w->border_first[s];
  uint64_t *border = vg_alloc(n_border, sizeof *border);
  int is_closed = 0;
  vg_status st = VG_OK;

  out->n = 0;
  if (!border) return vg_fail_memory(w->err, "the boundary of a slide patch");
  for (size_t i = 0; i < n_border; i++) {
    const uint32_t *r = w->c->border[w->border[w->border_first[s] + i]];

    border[i] = (uint64_t)w->c->column[r[0]].root << 32 |
                w->c->column[r[1]].root;
  }
  qsort(border, n_border, sizeof *border, vg_compare_edge_keys);
  VG_TRY(former_edges(w, s, border, n_border, out));
  VG_TRY(new_edges(w, s, out));
  VG_TRY(check_closed(w, s, out, &is_closed));
  if (!is_closed) out->n = 0;
done:
  free(border);
  return st;
}

/* --- intersections ------------------------------------------------------- */

struct cross {
  struct vg_slide_work *w;
  size_t s, n_bad;
  const struct vg_slide_loops *l;
  const double (*p)[2];
  uint32_t edge; /* Index of the edge; it is compared with edges of higher
                    index. */
  int n;         /* Number of corners of the current side face. */
  uint32_t border, corner[4];
  double q[4][2];
};

static int sign(double x)
{
  return (x > 0) - (x < 0);
}

static int in_box(const double a[2], const double b[2], const double x[2])
{
  for (int k = 0; k < 2; k++)
    if (x[k] < fmin(a[k], b[k]) || x[k] > fmax(a[k], b[k])) return 0;
  return 1;
}

/* Whether two segments without a common end touch. Exact. */
static int touch(const double a[2], const double b[2], const double c[2],
                 const double d[2])
{
  const int abc = sign(vg_orient2d(a, b, c)), abd = sign(vg_orient2d(a, b, d));
  const int cda = sign(vg_orient2d(c, d, a)), cdb = sign(vg_orient2d(c, d, b));

  if (abc * abd < 0 && cda * cdb < 0) return 1;
  return (!abc && in_box(a, b, c)) || (!abd && in_box(a, b, d)) ||
         (!cda && in_box(c, d, a)) || (!cdb && in_box(c, d, b));
}

/* Whether segments a - b and a - c overlap. */
static int overlap(const double a[2], const double b[2], const double c[2])
{
  return vg_orient2d(a, b, c) == 0 &&
         (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]) >= 0;
}

static int visit_edge(void *user, uint32_t j)
{
  struct cross *x = user;
  const uint32_t *e = x->l->edge[x->edge], *f = x->l->edge[j];
  const double *at[4];
  uint32_t v[4];
  int k, is_bad;

  if (j <= x->edge) return 0;
  for (k = 0; k < 4; k++) {
    v[k] = vg_slide_local(x->w, k < 2 ? e[k] : f[k - 2]);
    at[k] = x->p[v[k]];
  }
  if (v[0] == v[2] && v[1] == v[3]) is_bad = 1;
  else if (v[0] == v[3] && v[1] == v[2])
    is_bad = e[0] == f[1] && e[1] == f[0] && /* Otherwise a slit. */
             !vg_slide_is_held(x->w, e[0], e[1]);
  else if (v[0] == v[2]) is_bad = overlap(at[0], at[1], at[3]);
  else if (v[0] == v[3]) is_bad = overlap(at[0], at[1], at[2]);
  else if (v[1] == v[2]) is_bad = overlap(at[1], at[0], at[3]);
  else if (v[1] == v[3]) is_bad = overlap(at[1], at[0], at[2]);
  else is_bad = touch(at[0], at[1], at[2], at[3]);
  if (!is_bad) return 0;
  x->n_bad++;
  for (k = 0; k < 2; k++) {
    mark_bad_point(x->w, x->s, e[k], "the outline of the tops crosses itself");
    mark_bad_point(x->w, x->s, f[k], "the outline of the tops crosses itself");
  }
  return 0;
}

static void mark_bad_flank(struct cross *x, const char *what)
{
  const uint32_t *r = x->w->c->border[x->border];

  x->n_bad++;
  for (int k = 0; k < 2; k++)
    vg_slide_mark_bad(x->w, r[k], x->w->part[x->s].patch,
                      x->w->m->point[x->w->c->column[r[k]].root], what);
}

/* No point of the boundary may lie within a side face. */
static int visit_flank(void *user, uint32_t j)
{
  struct cross *x = user;
  const uint32_t v = x->l->edge[j][0];
  const double *p = x->p[vg_slide_local(x->w, v)];

  for (int i = 0; i < x->n; i++)
    if (vg_slide_first(x->w, x->corner[i]) == vg_slide_first(x->w, v)) return 0;
  for (int i = 0; i < x->n; i++)
    if (vg_orient2d(x->q[i], x->q[i + 1 < x->n ? i + 1 : 0], p) < 0) return 0;
  mark_bad_flank(x, "a side face of the layers overlaps another part of the "
                    "boundary");
  mark_bad_point(x->w, x->s, v,
                 "a side face of the layers overlaps another part of the "
                 "boundary");
  return 0;
}

/* Point of column i at level 1, in the plane. */
static void risen(const struct vg_slide_work *w, const struct vg_slide_frame *f,
                  uint32_t i, double q[2])
{
  const struct vg_column *c = &w->c->column[i];
  const double *root = w->m->point[c->root];
  double x[3], d[2];

  if (c->bent != SIZE_MAX) {
    memcpy(x, w->c->path[c->bent + 1], sizeof x);
  } else {
    vg_growth_law_heights(&w->c->law[c->law], c->cap, 1, d);
    vg_column_at(c, root, d[1], x);
  }
  vg_slide_to_plane(f, x, q);
}

/* Side face above a boundary edge, counter-clockwise; 0 corners if it has no
 * area. */
static void set_flank(struct cross *x, const struct vg_slide_frame *f,
                      uint32_t border)
{
  const struct vg_slide_work *w = x->w;
  const uint32_t *r = w->c->border[border];
  const uint32_t v[4] = { w->c->column[r[1]].root, w->c->column[r[0]].root,
                          vg_slide_top(w, r[0]), vg_slide_top(w, r[1]) };

  x->border = border;
  x->n = 0;
  for (int i = 0; i < 4; i++) {
    if (x->n && (v[i] == x->corner[x->n - 1] || v[i] == x->corner[0])) continue;
    x->corner[x->n] = v[i];
    vg_slide_to_plane(f, w->x[v[i]], x->q[x->n++]);
  }
  if (x->n < 3) x->n = 0;
}

static int is_convex(const struct cross *x)
{
  for (int i = 0; i < x->n; i++)
    if (!(vg_orient2d(x->q[i], x->q[(i + 1) % x->n], x->q[(i + 2) % x->n]) > 0))
      return 0;
  return 1;
}

/* Marks the columns of a folded side face that leave the patch already at their
 * first level. */
static void give_up(struct cross *x, const struct vg_slide_frame *f)
{
  const struct vg_slide_work *w = x->w;
  const uint32_t *r = w->c->border[x->border];
  const uint32_t a = w->c->column[r[0]].root, b = w->c->column[r[1]].root;
  double pa[2], pb[2], q[2];

  vg_slide_to_plane(f, w->x[a], pa);
  vg_slide_to_plane(f, w->x[b], pb);
  for (int k = 0; k < 2 && a != b; k++) {
    if (!w->bad[r[k]]) continue;
    risen(w, f, r[k], q);
    if (!(vg_orient2d(pb, pa, q) > 0)) w->bad[r[k]] = 2;
  }
}

static struct vg_box box_of(size_t n, const double (*q)[2])
{
  double lo[2], hi[2];

  for (int k = 0; k < 2; k++) {
    lo[k] = hi[k] = q[0][k];
    for (size_t i = 1; i < n; i++) {
      lo[k] = fmin(lo[k], q[i][k]);
      hi[k] = fmax(hi[k], q[i][k]);
    }
  }
  return vg_slide_box(lo, hi);
}

vg_status vg_slide_cross(struct vg_slide_work *w, size_t s,
                         const struct vg_slide_frame *frame,
                         const struct vg_slide_loops *loops,
                         const double (*p)[2], size_t *n_bad)
{
  assert(s < w->n_part && n_bad);

  struct cross x = { .w = w, .s = s, .l = loops, .p = p };
  struct vg_box *box = vg_alloc(loops->n, sizeof *box), b;
  struct vg_box_tree tree = VG_BOX_TREE_INIT;
  vg_status st = VG_OK;

  *n_bad = 0;
  for (size_t i = 0; box && i < loops->n; i++) {
    const double *a = p[vg_slide_local(w, loops->edge[i][0])];
    const double *c = p[vg_slide_local(w, loops->edge[i][1])];
    const double q[2][2] = { { a[0], a[1] }, { c[0], c[1] } };

    box[i] = box_of(2, q);
  }
  if (!box) VG_TRY(vg_fail_memory(w->err, "the boundary of a slide patch"));
  VG_TRY(vg_slide_tree(&tree, loops->n, box, w->err));
  for (size_t i = 0; i < loops->n; i++) {
    x.edge = (uint32_t)i;
    vg_box_tree_touched(&tree, &box[i], visit_edge, &x);
  }
  for (uint32_t i = w->border_first[s]; i < w->border_first[s + 1]; i++) {
    set_flank(&x, frame, w->border[i]);
    if (!x.n) continue;
    if (!is_convex(&x)) {
      mark_bad_flank(&x, "a side face of the layers folds over");
      give_up(&x, frame);
      continue;
    }
    b = box_of((size_t)x.n, (const double(*)[2])x.q);
    vg_box_tree_touched(&tree, &b, visit_flank, &x);
  }
  *n_bad = x.n_bad;
done:
  vg_box_tree_release(&tree);
  free(box);
  return st;
}
