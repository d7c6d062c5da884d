/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The shape of an outermost shell: whether it is a box, or a part of a sphere
 * cut by coordinate planes, and how deep the rest of it reaches inside.
 * Farfields and tunnels have these shapes; a wing or a rocket does not,
 * although it also covers its hull. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/flow/evidence.h"
#include "core/geometry/vector.h"
#include "core/surface/envelope.h"

/* F2 */
#define BOX_SHARE 0.98 /* of a box's area: least part on its bounding box */
#define BOX_NEAR                                                               \
  1e-4             /* of its length: points this near are on the bounding box */
#define ROUND 0.02 /* of a sphere's radius: points this near are on it */
#define ARC 1      /* of a sphere's radius: no edge on it is longer */
#define DEEP 1e-3  /* of the length: least depth of a body inside */

/* Copy one shell to a mesh of its own. */
static vg_status take_shell(const struct vg_flow_evidence *e, uint32_t s,
                            struct vg_mesh *out, struct vg_error *err)
{
  const struct vg_mesh *m = e->m;
  uint32_t *place = vg_alloc(m->n_point, sizeof *place);
  vg_status st = VG_OK;

  out->tri = vg_alloc(e->r->shell[s].n_tri, sizeof *out->tri);
  out->point = vg_alloc(m->n_point, sizeof *out->point);
  if (!place || !out->tri || !out->point)
    VG_TRY(vg_fail_memory(err, "a shell of the surface"));
  memset(place, 0xff, m->n_point * sizeof *place);
  for (size_t t = 0; t < m->n_tri; t++) {
    if (e->r->tri_shell[t] != s) continue;
    for (int k = 0; k < 3; k++) {
      uint32_t *p = &place[m->tri[t][k]];

      if (*p == UINT32_MAX) {
        *p = (uint32_t)out->n_point;
        memcpy(out->point[out->n_point++], m->point[m->tri[t][k]],
               sizeof *out->point);
      }
      out->tri[out->n_tri][k] = *p;
    }
    out->n_tri++;
  }
done:
  free(place);
  return st;
}

struct hull {
  const struct vg_mesh *m;
  const uint8_t *outer; /* [n_tri] 1: part of the outer boundary; NULL: all
                           triangles are. */
  double lo[3], hi[3], length;
  double centre[3], radius; /* Of the sphere; radius 0: no sphere was found. */
};

static double off_box(const struct hull *h, const double x[3])
{
  double least = INFINITY;

  for (int k = 0; k < 3; k++)
    least = fmin(least, fmin(x[k] - h->lo[k], h->hi[k] - x[k]));
  return least;
}

/* Are all corners of the triangle on one side of the bounding box? */
static int is_on_side(const struct hull *h, size_t t)
{
  for (int k = 0; k < 3; k++) {
    int lo = 1, hi = 1;

    for (int i = 0; i < 3; i++) {
      const double x = h->m->point[h->m->tri[t][i]][k];

      lo &= x - h->lo[k] <= BOX_NEAR * h->length;
      hi &= h->hi[k] - x <= BOX_NEAR * h->length;
    }
    if (lo | hi) return 1;
  }
  return 0;
}

static int is_box(const struct hull *h)
{
  double all = 0, on = 0;

  for (size_t t = 0; t < h->m->n_tri; t++) {
    const uint32_t *v = h->m->tri[t];
    double a[3], b[3], n[3];

    if (h->outer && !h->outer[t]) continue;
    vg_sub(h->m->point[v[1]], h->m->point[v[0]], a);
    vg_sub(h->m->point[v[2]], h->m->point[v[0]], b);
    vg_cross(a, b, n);
    all += vg_norm(n);
    if (is_on_side(h, t)) on += vg_norm(n);
  }
  return on >= BOX_SHARE * all;
}

/* Is corner k of triangle t part of the outer boundary, but on no side of the
 * bounding box? */
static int is_free(const struct hull *h, size_t t, int k)
{
  return (!h->outer || h->outer[t]) &&
         off_box(h, h->m->point[h->m->tri[t][k]]) > BOX_NEAR * h->length;
}

/* Gaussian elimination with pivoting. Returns 0 if the system is singular. */
static int solve(double a[4][5])
{
  for (int i = 0; i < 4; i++) {
    int p = i;

    for (int r = i + 1; r < 4; r++)
      if (fabs(a[r][i]) > fabs(a[p][i])) p = r;
    if (!(fabs(a[p][i]) > 0)) return 0;
    for (int c = 0; c < 5; c++) {
      const double x = a[i][c];

      a[i][c] = a[p][c];
      a[p][c] = x;
    }
    for (int r = 0; r < 4; r++) {
      const double f = a[r][i] / a[i][i];

      for (int c = i; c < 5 && r != i; c++) a[r][c] -= f * a[i][c];
    }
  }
  for (int i = 0; i < 4; i++) a[i][4] /= a[i][i];
  return 1;
}

/* Fit a sphere to the free corners by least squares of |x|^2 = 2 c.x + d,
 * relative to the centre and size of the box. */
static int fit_sphere(struct hull *h)
{
  double a[4][5] = { { 0 } }, mid[3], rr;

  for (int k = 0; k < 3; k++) mid[k] = 0.5 * (h->lo[k] + h->hi[k]);
  for (size_t t = 0; t < h->m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const double *p = h->m->point[h->m->tri[t][k]];
      double x[5] = { 0, 0, 0, 1, 0 };

      if (!is_free(h, t, k)) continue;
      for (int d = 0; d < 3; d++) {
        x[d] = (p[d] - mid[d]) / h->length;
        x[4] += x[d] * x[d];
      }
      for (int i = 0; i < 4; i++)
        for (int j = 0; j < 5; j++) a[i][j] += x[i] * x[j];
    }
  if (!solve(a)) return 0;
  rr = a[3][4];
  for (int k = 0; k < 3; k++) {
    rr += a[k][4] * a[k][4] / 4;
    h->centre[k] = mid[k] + h->length * a[k][4] / 2;
  }
  h->radius = rr > 0 ? h->length * sqrt(rr) : 0;
  return rr > 0;
}

/* Do the triangles follow the sphere? The corners of any cuboid, prism or
 * cylinder are on one sphere, too, but their triangles have longer edges. */
static int follows_sphere(const struct hull *h, size_t t)
{
  const uint32_t *v = h->m->tri[t];

  if ((h->outer && !h->outer[t]) || is_on_side(h, t)) return 1;
  for (int k = 0; k < 3; k++) {
    const double *x = h->m->point[v[k]], *y = h->m->point[v[(k + 1) % 3]];

    if (vg_distance(x, y) > ARC * h->radius) return 0;
    if (is_free(h, t, k) &&
        fabs(vg_distance(x, h->centre) - h->radius) > ROUND * h->radius)
      return 0;
  }
  return 1;
}

static int is_round(struct hull *h)
{
  if (!fit_sphere(h)) return 0;
  for (size_t t = 0; t < h->m->n_tri; t++)
    if (!follows_sphere(h, t)) {
      h->radius = 0;
      return 0;
    }
  return 1;
}

/* Largest depth of the rest of the shell inside the outer boundary. */
static double depth(const struct hull *h)
{
  double most = 0;

  for (size_t t = 0; t < h->m->n_tri; t++)
    for (int k = 0; k < 3 && !h->outer[t]; k++) {
      const double *x = h->m->point[h->m->tri[t][k]];
      double d = off_box(h, x);

      if (h->radius > 0) d = fmin(d, h->radius - vg_distance(x, h->centre));
      most = fmax(most, d);
    }
  return most;
}

/* Mark the triangles of a body inside the outer boundary. outer: [n], in the
 * order of the shell's triangles. */
static vg_status mark_pocket(struct vg_flow_evidence *e, uint32_t shell,
                             const uint8_t *outer, struct vg_error *err)
{
  size_t n = 0;

  e->in_pocket = vg_calloc(e->m->n_tri, 1);
  if (!e->in_pocket) return vg_fail_memory(err, "a shell of the surface");
  for (size_t t = 0; t < e->m->n_tri; t++)
    if (e->r->tri_shell[t] == shell) e->in_pocket[t] = !outer[n++];
  return VG_OK;
}

vg_status vg_flow_measure_shape(struct vg_flow_evidence *e,
                                struct vg_flow_shell *s, struct vg_error *err)
{
  struct vg_mesh one = VG_MESH_INIT;
  struct hull h = { .m = &one };
  struct vg_envelope hull;
  uint8_t *outer = NULL;
  int shape;
  vg_status st;

  VG_TRY(take_shell(e, s->shell, &one, err));
  outer = vg_alloc(one.n_tri, 1);
  if (!outer) VG_TRY(vg_fail_memory(err, "a shell of the surface"));
  VG_TRY(vg_envelope_measure(&one, outer, &hull, err));
  vg_mesh_bounds(&one, h.lo, h.hi);
  for (int k = 0; k < 3; k++) h.length = fmax(h.length, h.hi[k] - h.lo[k]);
  s->covered = hull.covered;
  s->is_box = is_box(&h);
  if (s->n_inside || !hull.is_domain) goto done;
  h.outer = outer;
  shape = is_box(&h) || is_round(&h);
  s->has_pocket = shape && depth(&h) > DEEP * h.length;
  if (s->has_pocket) st = mark_pocket(e, s->shell, outer, err);
done:
  vg_mesh_release(&one);
  free(outer);
  return st;
}
