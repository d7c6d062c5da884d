/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Remeshes interfaces to the local size: first points along their edges, then
 * each coarse face as a plane region. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/domain/planar.h"
#include "core/geometry/vector.h"
#include "partition/discrete/discrete_parts.h"

/* Number of intervals in the sum of sizes along an edge. */
enum { STEPS = 32 };

void vg_sheets_release(struct vg_sheets *s)
{
  free(s->x);
  free(s->begin);
  free(s->tri);
  memset(s, 0, sizeof *s);
}

/* --- edges --------------------------------------------------------------- */

/* Points inside an edge: new[from ... from + n - 1], starting at its lower
 * end. */
struct divided {
  uint32_t from, n;
};

/* Divides the edge a b into segments by the integral of ds / h; cut out: [*n -
 * 1] positions as fractions of the edge. Owned by the caller. */
static int divide(const struct vg_sizing *sizing, const double a[3],
                  const double b[3], size_t *n, double **cut)
{
  double sum[STEPS + 1] = { 0 }, length = vg_distance(a, b), x[3];
  size_t k = 1;
  int i = 0;

  for (i = 0; i < STEPS; i++) {
    double t = (i + 0.5) / STEPS;

    for (int j = 0; j < 3; j++) x[j] = a[j] + t * (b[j] - a[j]);
    sum[i + 1] = sum[i] + length / STEPS / vg_sizing_at(sizing, x);
  }
  *n = sum[STEPS] < 1e8 ? (size_t)(sum[STEPS] + 0.5) : 100000000;
  if (*n < 1) *n = 1;
  *cut = vg_alloc(*n, sizeof **cut);
  if (!*cut) return -1;
  for (i = 0; k < *n; k++) {
    double at = sum[STEPS] * (double)k / (double)*n;

    while (i < STEPS - 1 && sum[i + 1] < at) i++;
    (*cut)[k - 1] = (i + (at - sum[i]) / (sum[i + 1] - sum[i])) / STEPS;
  }
  return 0;
}

static int by_ends(const void *a, const void *b)
{
  const uint32_t *s = a, *t = b;

  for (int k = 0; k < 2; k++)
    if (s[k] != t[k]) return s[k] < t[k] ? -1 : 1;
  return 0;
}

/* Marks the edges of the front's faces, which are not divided. */
static void mark_rim(const struct vg_coarse *c, const struct vg_interface *f,
                     uint8_t *is_rim)
{
  for (size_t q = 0; q < 4 * c->t.n_cell; q++) {
    const uint32_t *v = c->t.cell[q / 4].v;
    const uint8_t *face = vg_face[q % 4];

    if (c->on[q / 4][q % 4] == VG_NONE) continue;
    for (int k = 0; k < 3; k++) {
      uint32_t key[2] = { v[face[k]], v[face[(k + 1) % 3]] };
      const uint32_t(*at)[2];

      vg_order2(&key[0], &key[1]);
      at = bsearch(key, f->end, f->n_edge, sizeof *f->end, by_ends);
      if (at) is_rim[at - (const uint32_t(*)[2])f->end] = 1;
    }
  }
}

static vg_status divide_edge(const struct vg_coarse *c,
                             const struct vg_sizing *sizing,
                             const uint32_t end[2], struct vg_sheets *s,
                             struct divided *d, struct vg_error *err)
{
  const double *a = c->t.x[end[0]], *b = c->t.x[end[1]];
  double *cut = NULL;
  size_t n;

  if (divide(sizing, a, b, &n, &cut) ||
      vg_reserve(&s->x, &s->cap_point, s->n_point + n, sizeof *s->x)) {
    free(cut);
    return vg_fail_memory(err, "the interfaces");
  }
  *d = (struct divided){ (uint32_t)s->n_point, (uint32_t)(n - 1) };
  for (size_t k = 0; k + 1 < n; k++, s->n_point++)
    for (int j = 0; j < 3; j++)
      s->x[s->n_point][j] = a[j] + cut[k] * (b[j] - a[j]);
  free(cut);
  return VG_OK;
}

static vg_status divide_edges(const struct vg_coarse *c,
                              const struct vg_interface *f,
                              const struct vg_sizing *sizing,
                              struct vg_sheets *s, struct divided *d,
                              struct vg_error *err)
{
  uint8_t *is_rim = vg_calloc(f->n_edge, sizeof *is_rim);
  vg_status st = VG_OK;

  if (!is_rim) return vg_fail_memory(err, "the interfaces");
  mark_rim(c, f, is_rim);
  for (size_t k = 0; st == VG_OK && k < f->n_edge; k++)
    if (!is_rim[k]) st = divide_edge(c, sizing, f->end[k], s, &d[k], err);
  free(is_rim);
  return st;
}

/* --- faces --------------------------------------------------------------- */

/* Triangulation of a face. Points: those along its sides, starting at its
 * first corner, then `add`. */
struct facet {
  size_t n_side, n_add, n_tri;
  uint32_t *side; /* [n_side] */
  double (*add)[3];
  uint32_t (*tri)[3];
  vg_status st;
  struct vg_error err;
};

struct facets {
  const struct vg_coarse *c;
  const struct vg_interface *f;
  const struct vg_sizing *sizing;
  const struct vg_sheets *s;
  const struct divided *d;
  struct facet *of; /* [n_face] */
};

/* The plane of a face, with coordinates along u and v. */
struct plane {
  const struct vg_sizing *sizing;
  double o[3], u[3], v[3];
};

static void to_space(const struct plane *p, const double x[2], double out[3])
{
  for (int k = 0; k < 3; k++)
    out[k] = p->o[k] + x[0] * p->u[k] + x[1] * p->v[k];
}

static double size_at(void *user, const double x[2])
{
  const struct plane *p = user;
  double at[3];

  to_space(p, x, at);
  return vg_sizing_at(p->sizing, at);
}

static void plane_of(const double *const x[3], struct plane *p)
{
  double n[3], w[3];

  memcpy(p->o, x[0], sizeof p->o);
  vg_sub(x[1], x[0], p->u);
  vg_sub(x[2], x[0], w);
  vg_cross(p->u, w, n);
  vg_unit(p->u);
  vg_unit(n);
  vg_cross(n, p->u, p->v);
}

static const double *point_of(const struct facets *a, uint32_t k)
{
  size_t n = a->c->t.n_point;

  return k < n ? a->c->t.x[k] : a->s->x[k - n];
}

/* Lists the points along the sides. first out: [3] position of the corners
 * among them. */
static int list_side(const struct facets *a, size_t i, const uint32_t v[3],
                     struct facet *o, size_t first[3])
{
  const uint32_t n = (uint32_t)a->c->t.n_point;
  size_t all = 3, at = 0;

  for (int k = 0; k < 3; k++) all += a->d[a->f->edge[i][k]].n;
  o->side = vg_alloc(all, sizeof *o->side);
  if (!o->side) return -1;
  for (int k = 0; k < 3; k++) {
    uint32_t e = a->f->edge[i][k];
    const struct divided *d = &a->d[e];

    first[k] = at;
    o->side[at++] = v[k];
    for (uint32_t j = 0; j < d->n; j++)
      o->side[at++] = n + d->from +
                      (a->f->end[e][0] == v[k] ? j : d->n - 1 - j);
  }
  o->n_side = at;
  return 0;
}

/* Triangulates without inner points, between the side with most points and the
 * other two sides, by advancing along both. For faces that are too thin for
 * inner points. */
static int zip(struct facet *o, const size_t first[3])
{
  size_t n = o->n_side, best = 0, most = 0, low = 1, from = 1;

  for (size_t k = 0; k < 3; k++) {
    size_t end = k < 2 ? first[k + 1] : n;

    if (end - first[k] > most) {
      most = end - first[k];
      best = first[k];
    }
  }
  o->tri = vg_alloc(n - 2, sizeof *o->tri);
  if (!o->tri) return -1;
  for (o->n_tri = 0; o->n_tri < n - 2; o->n_tri++) {
    uint32_t *v = o->tri[o->n_tri];
    uint32_t a = (uint32_t)((best + low) % n);      /* along the side */
    uint32_t b = (uint32_t)((best + n - from) % n); /* back along the other
                                                       sides */
    int up = low + 1 < most && (from + 1 >= n - most ||
                                (low + 1) * (n - most) <= (from + 1) * most);

    v[0] = a;
    v[2] = b;
    if (!o->n_tri) {
      v[1] = b;
      v[2] = (uint32_t)best;
      continue;
    }
    if (up) v[1] = (uint32_t)((best + ++low) % n);
    else v[1] = (uint32_t)((best + n - ++from) % n);
  }
  return 0;
}

/* Meshes a face in its plane. */
static vg_status mesh_face(const struct facets *a, const double *const x[3],
                           struct facet *o)
{
  struct plane p = { .sizing = a->sizing };
  const struct vg_planar_law law = { .at = size_at, .user = &p };
  double(*at)[2] = vg_alloc(o->n_side, sizeof *at), (*add)[2] = NULL;
  uint32_t(*edge)[2] = vg_alloc(o->n_side, sizeof *edge);
  vg_status st = at && edge ? VG_OK : vg_fail_memory(&o->err, "interfaces");

  plane_of(x, &p);
  for (size_t k = 0; st == VG_OK && k < o->n_side; k++) {
    double w[3];

    vg_sub(point_of(a, o->side[k]), p.o, w);
    at[k][0] = vg_dot(w, p.u);
    at[k][1] = vg_dot(w, p.v);
    edge[k][0] = (uint32_t)k;
    edge[k][1] = (uint32_t)((k + 1) % o->n_side);
  }
  if (st == VG_OK)
    st = vg_planar_mesh(o->n_side, (const double(*)[2])at, o->n_side,
                        (const uint32_t(*)[2])edge, &law, &o->n_add, &add,
                        &o->n_tri, &o->tri, &o->err);
  if (st == VG_OK) {
    o->add = vg_alloc(o->n_add, sizeof *o->add);
    if (!o->add) st = vg_fail_memory(&o->err, "the interfaces");
    for (size_t k = 0; st == VG_OK && k < o->n_add; k++)
      to_space(&p, add[k], o->add[k]);
  }
  free(at);
  free(add);
  free(edge);
  return st;
}

static void do_faces(void *context, size_t begin, size_t end, int worker)
{
  const struct facets *a = context;

  (void)worker;
  for (size_t i = begin; i < end; i++) {
    struct facet *o = &a->of[i];
    size_t first[3];
    const double *x[3];
    uint32_t v[3];

    vg_interface_corners(a->c, a->f, i, v);
    for (int k = 0; k < 3; k++) x[k] = a->c->t.x[v[k]];
    if (list_side(a, i, v, o, first)) {
      o->st = vg_fail_memory(&o->err, "the interfaces");
      continue;
    }
    if (o->n_side > 3) o->st = mesh_face(a, x, o);
    if (o->n_side > 3 && o->st != VG_ERR_GEOMETRY) continue;
    o->st = zip(o, first) ? vg_fail_memory(&o->err, "interfaces") : VG_OK;
  }
}

/* Collects all facets. */
static vg_status collect(const struct facets *a, struct vg_sheets *s,
                         struct vg_error *err)
{
  size_t n = a->f->n_face, n_tri = 0, n_add = 0;
  uint32_t base = (uint32_t)(a->c->t.n_point + s->n_point);

  for (size_t i = 0; i < n; i++) {
    if (a->of[i].st < 0) {
      *err = a->of[i].err;
      return a->of[i].st;
    }
    n_tri += a->of[i].n_tri;
    n_add += a->of[i].n_add;
  }
  s->begin = vg_alloc(n + 1, sizeof *s->begin);
  s->tri = vg_alloc(n_tri, sizeof *s->tri);
  if (!s->begin || !s->tri ||
      vg_reserve(&s->x, &s->cap_point, s->n_point + n_add, sizeof *s->x))
    return vg_fail_memory(err, "the interfaces");
  n_tri = 0;
  for (size_t i = 0; i < n; i++) {
    const struct facet *o = &a->of[i];

    s->begin[i] = n_tri;
    for (size_t k = 0; k < o->n_tri; k++, n_tri++)
      for (int j = 0; j < 3; j++) {
        uint32_t q = o->tri[k][j];

        s->tri[n_tri][j] = q < o->n_side ? o->side[q]
                                         : base + q - (uint32_t)o->n_side;
      }
    if (o->n_add) memcpy(s->x + s->n_point, o->add, o->n_add * sizeof *s->x);
    s->n_point += o->n_add;
    base += (uint32_t)o->n_add;
  }
  s->begin[n] = n_tri;
  return VG_OK;
}

vg_status vg_sheets_remesh(const struct vg_coarse *c,
                           const struct vg_interface *f,
                           const struct vg_sizing *sizing,
                           const struct vg_engine *e, struct vg_sheets *s,
                           struct vg_error *err)
{
  struct divided *d = vg_calloc(f->n_edge, sizeof *d);
  struct facets a = { c, f, sizing, s, d, vg_calloc(f->n_face, sizeof *a.of) };
  vg_status st = d && a.of ? VG_OK : vg_fail_memory(err, "the interfaces");

  assert(!s->n_point && !s->x && !s->begin && !s->tri);
  VG_TRY(st);
  VG_TRY(divide_edges(c, f, sizing, s, d, err));
  vg_engine_loop(e, f->n_face, 32, do_faces, &a);
  st = collect(&a, s, err);
done:
  for (size_t i = 0; a.of && i < f->n_face; i++) {
    free(a.of[i].side);
    free(a.of[i].add);
    free(a.of[i].tri);
  }
  free(a.of);
  free(d);
  return st;
}
