/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Remeshing of a slide patch inside its new boundary. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"
#include "layers/slide/slide_parts.h"

/* A triangle with all corners on the boundary and a height below this share of
 * its longest edge is a sliver between nearly collinear tops. */
#define SLIVER 1e-9

void vg_slide_frame(const struct vg_slide_work *w, size_t s,
                    struct vg_slide_frame *f)
{
  assert(s < w->n_part);

  const struct vg_slide *sl = &w->part[s];
  const double *x = w->m->point[w->m->tri[w->tri[w->tri_first[s]]][0]];
  double e[3] = { 0 }, off;
  int low;

  memset(f, 0, sizeof *f);
  memcpy(f->n, sl->normal, sizeof f->n);
  f->axis = sl->is_plane ? sl->axis : -1;
  if (f->axis >= 0) {
    const int flip = f->n[f->axis] < 0;

    f->at = x[f->axis];
    f->iu = (f->axis + (flip ? 2 : 1)) % 3;
    f->iv = (f->axis + (flip ? 1 : 2)) % 3;
    return;
  }
  off = vg_dot(x, f->n) - sl->at;
  for (int k = 0; k < 3; k++) f->o[k] = x[k] - off * f->n[k];
  low = fabs(f->n[0]) < fabs(f->n[1]) ? 0 : 1;
  if (fabs(f->n[2]) < fabs(f->n[low])) low = 2;
  e[low] = 1;
  vg_cross(e, f->n, f->u);
  vg_unit(f->u);
  vg_cross(f->n, f->u, f->v);
}

void vg_slide_to_plane(const struct vg_slide_frame *f, const double x[3],
                       double p[2])
{
  double d[3];

  if (f->axis >= 0) {
    p[0] = x[f->iu];
    p[1] = x[f->iv];
    return;
  }
  vg_sub(x, f->o, d);
  p[0] = vg_dot(d, f->u);
  p[1] = vg_dot(d, f->v);
}

void vg_slide_to_space(const struct vg_slide_frame *f, const double p[2],
                       double x[3])
{
  if (f->axis >= 0) {
    x[f->axis] = f->at;
    x[f->iu] = p[0];
    x[f->iv] = p[1];
    return;
  }
  for (int k = 0; k < 3; k++) x[k] = f->o[k] + p[0] * f->u[k] + p[1] * f->v[k];
}

/* The region in the plane with its own numbering; `number` is the point, the
 * first of its copies. */
struct region {
  size_t n;
  uint32_t *number, (*edge)[2];
  double (*p)[2];
};

static vg_status make_region(struct vg_slide_work *w,
                             const struct vg_slide_loops *l,
                             const struct vg_slide_frame *f, struct region *r)
{
  r->number = vg_alloc(2 * l->n, sizeof *r->number);
  r->edge = vg_alloc(l->n, sizeof *r->edge);
  r->p = vg_alloc(2 * l->n, sizeof *r->p);
  if (!r->number || !r->edge || !r->p)
    return vg_fail_memory(w->err, "a slide patch");
  for (size_t i = 0; i < 2 * l->n; i++) {
    const uint32_t v = vg_slide_first(w, l->edge[i / 2][i % 2]);

    if (w->local[v] == VG_NO_INDEX) {
      vg_slide_to_plane(f, w->x[v], r->p[r->n]);
      r->number[r->n] = v;
      w->local[v] = (uint32_t)r->n++;
    }
    r->edge[i / 2][i % 2] = w->local[v];
  }
  return VG_OK;
}

static void release_region(struct vg_slide_work *w, struct region *r)
{
  for (size_t i = 0; i < r->n; i++) w->local[r->number[i]] = VG_NO_INDEX;
  free(r->number);
  free(r->edge);
  free(r->p);
}

/* Marks the columns of slivers between points of the boundary. */
static void check_slivers(struct vg_slide_work *w, size_t s,
                          const struct region *r, size_t n_tri,
                          const uint32_t (*tri)[3])
{
  for (size_t i = 0; i < n_tri; i++) {
    const uint32_t *t = tri[i];
    double e[3][2], longest = 0;

    if (t[0] >= r->n || t[1] >= r->n || t[2] >= r->n) continue;
    for (int k = 0; k < 3; k++) {
      const double *a = r->p[t[k]], *b = r->p[t[k < 2 ? k + 1 : 0]];

      for (int j = 0; j < 2; j++) e[k][j] = b[j] - a[j];
      longest = fmax(longest, e[k][0] * e[k][0] + e[k][1] * e[k][1]);
    }
    if (e[0][0] * e[1][1] - e[0][1] * e[1][0] > SLIVER * longest) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t c = vg_slide_column(w, r->number[t[k]]);

      if (c != VG_NO_INDEX)
        vg_slide_mark_bad(w, c, w->part[s].patch, w->x[r->number[t[k]]],
                          "tops are collinear and leave a triangle without "
                          "area");
    }
  }
}

static vg_status append(struct vg_slide_work *w, size_t s,
                        const struct vg_slide_law *law,
                        const struct vg_slide_loops *loops,
                        const struct region *r, size_t n_add,
                        const double (*add)[2], size_t n_tri,
                        const uint32_t (*tri)[3])
{
  const size_t base = w->n_x;
  double x[3];
  uint32_t number;

  if (vg_reserve(&w->new_tri, &w->cap_new, w->n_new + n_tri,
                 sizeof *w->new_tri) ||
      vg_reserve(&w->new_patch, &w->cap_new_patch, w->n_new + n_tri,
                 sizeof *w->new_patch))
    return vg_fail_memory(w->err, "a slide patch");
  for (size_t i = 0; i < n_add; i++) {
    vg_status st;

    vg_slide_place(law, add[i], x);
    st = vg_slide_add_point(w, x, &number);
    if (st != VG_OK) return st;
  }
  for (size_t i = 0; i < n_tri; i++) {
    for (int k = 0; k < 3; k++)
      w->new_tri[w->n_new][k] = tri[i][k] < r->n
                                ? r->number[tri[i][k]]
                                : (uint32_t)(base + (tri[i][k] - r->n));
    w->new_patch[w->n_new++] = w->part[s].patch;
  }
  return vg_slide_use_copies(w, loops, r->n + n_add, n_tri, tri,
                             w->new_tri + w->n_new - n_tri);
}

static vg_status fill(struct vg_slide_work *w, size_t s,
                      struct vg_slide_law *law,
                      const struct vg_slide_loops *loops,
                      const struct region *r)
{
  double(*add)[2] = NULL;
  uint32_t(*tri)[3] = NULL;
  size_t n_add = 0, n_tri = 0;
  const struct vg_planar_law sizes = { .at = vg_slide_size,
                                       .user = law,
                                       .splits = 1 };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_planar_mesh(r->n, (const double(*)[2])r->p, loops->n,
                                (const uint32_t(*)[2])r->edge, &sizes, &n_add,
                                &add, &n_tri, &tri, &err);

  if (st == VG_ERR_GEOMETRY || st == VG_ERR_INPUT) {
    vg_slide_mark_bad_all(w, s, "its new boundary encloses no region");
    return VG_OK;
  }
  if (st != VG_OK) return vg_fail(w->err, st, "%s", err.text);
  check_slivers(w, s, r, n_tri, (const uint32_t(*)[3])tri);
  st = append(w, s, law, loops, r, n_add, (const double(*)[2])add, n_tri,
              (const uint32_t(*)[3])tri);
  free(add);
  free(tri);
  return st;
}

vg_status vg_slide_remesh(struct vg_slide_work *w, size_t s)
{
  assert(s < w->n_part);

  struct vg_slide_graph graph = { 0 };
  struct vg_slide_frame frame;
  struct vg_slide_law law = { .sizing = w->sizing, .frame = &frame };
  struct vg_slide_loops loops = { 0, 0, NULL };
  struct region r = { 0, NULL, NULL, NULL };
  size_t n_bad = 0;
  vg_status st;

  if (!w->part[s].is_plane) {
    VG_TRY(vg_slide_graph(w, s, &graph));
    if (st == VG_BLOCKED) {
      vg_slide_mark_steep(w, s);
      return VG_OK;
    }
    law.graph = &graph;
    VG_TRY(vg_slide_bend(w, s, &graph));
  }
  vg_slide_frame(w, s, &frame);
  VG_TRY(vg_slide_boundary(w, s, &loops));
  if (!loops.n) goto done;
  VG_TRY(make_region(w, &loops, &frame, &r));
  VG_TRY(vg_slide_cross(w, s, &frame, &loops, (const double(*)[2])r.p, &n_bad));
  if (!n_bad) {
    VG_TRY(vg_slide_law_floor(w, &loops, &law));
    VG_TRY(fill(w, s, &law, &loops, &r));
  }
  if (n_bad && !w->n_bad)
    vg_slide_mark_bad_all(w, s, "its border crosses itself");
done:
  release_region(w, &r);
  free(loops.edge);
  vg_slide_law_release(&law);
  vg_slide_graph_release(&graph);
  return st;
}
