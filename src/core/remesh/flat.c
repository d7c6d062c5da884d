/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/job.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/metric.h"
#include "core/remesh/reference.h"

#define FLAT2 7.596e-3 /* S50: (sin 5 degrees)^2 */
#define OUTER 1e-3     /* of the longest edge: flat height on outer boundary */
#define SWEEPS 12
#define TURN 0.9 /* least cosine between new triangles and neighbour */

struct flat {
  double shape;  /* Squared sine of the smallest angle. */
  uint32_t half; /* Half-edge of the longest edge. */
};

static int by_shape(const void *pa, const void *pb)
{
  const struct flat *a = pa, *b = pb;

  if (a->shape != b->shape) return a->shape < b->shape ? -1 : 1;
  return a->half < b->half ? -1 : a->half > b->half;
}

static double shape_of(const struct vg_mesh *m, const uint32_t v[3])
{
  return vg_form_shape(NULL, m->point[v[0]], m->point[v[1]], m->point[v[2]]);
}

static double normal_of(const struct vg_mesh *m, const uint32_t v[3],
                        double n[3])
{
  double a[3], b[3];

  vg_sub(m->point[v[1]], m->point[v[0]], a);
  vg_sub(m->point[v[2]], m->point[v[0]], b);
  vg_cross(a, b, n);
  return vg_unit(n);
}

/* The longest edge of triangle t. Sets *height to the height above it, and
 * *is_cap to whether the opposite corner projects into the middle of the
 * edge. */
static uint32_t longest(const struct vg_mesh *m, uint32_t t, double *height,
                        int *is_cap)
{
  double l[3], n[3], most = -1;
  uint32_t at = 0;

  for (uint32_t k = 0; k < 3; k++) {
    l[k] = vg_distance2(m->point[m->tri[t][k]],
                        m->point[m->tri[t][(k + 1) % 3]]);
    if (l[k] > most) most = l[k], at = k;
  }
  *height = most > 0 ? normal_of(m, m->tri[t], n) / sqrt(most) : 0;
  /* The angle opposite the longest edge exceeds 120 degrees. */
  *is_cap = l[0] + l[1] + l[2] <
            2 * most - sqrt(l[(at + 1) % 3] * l[(at + 2) % 3]);
  return 3 * t + at;
}

static double limit_of(const struct vg_mesh *m, uint32_t h,
                       const struct vg_flat_limit *limit)
{
  const double edge = vg_distance(m->point[m->tri[h / 3][h % 3]],
                                  m->point[m->tri[h / 3][(h % 3 + 1) % 3]]);

  return limit->far > 0 && edge > limit->far ? OUTER * edge : limit->height;
}

static vg_status list_flat(const struct vg_mesh *m,
                           const struct vg_flat_limit *limit,
                           struct flat **list, size_t *n, struct vg_error *err)
{
  size_t cap = 0;

  for (uint32_t t = 0; t < m->n_tri; t++) {
    const double shape = shape_of(m, m->tri[t]);
    double height;
    uint32_t h;
    int is_cap;

    if (!(shape < FLAT2)) continue;
    h = longest(m, t, &height, &is_cap);
    if (!is_cap || height > limit_of(m, h, limit)) continue;
    if (vg_reserve(list, &cap, *n + 1, sizeof **list))
      return vg_fail_memory(err, "flat triangles");
    (*list)[(*n)++] = (struct flat){ shape, h };
  }
  if (*n > 1) qsort(*list, *n, sizeof **list, by_shape);
  return VG_OK;
}

struct swapper {
  struct vg_mesh *m;
  struct vg_ref ref; /* Faces at the beginning of the sweep. */
  uint8_t *busy;     /* [n_tri] Changed in this sweep, or next to a changed
                        triangle. */
  size_t *count;     /* [n_patch] Number of triangles. */
};

/* May an edge from the start of h to q be created? Not if that edge exists, nor
 * if triangles around the start have changed. */
static int may_join(const struct swapper *s, uint32_t h, uint32_t q)
{
  const struct vg_ref *r = &s->ref;
  uint32_t g = h;

  do {
    const uint32_t back = vg_half_prev(g);

    if (s->busy[g / 3] || vg_ref_to(r, g) == q || vg_ref_from(r, back) == q)
      return 0;
    g = r->mate[back];
  } while (g != VG_REF_NONE && g != h);
  if (g == h) return 1;
  for (g = r->mate[h]; g != VG_REF_NONE; g = r->mate[g]) {
    g = vg_half_next(g);
    if (s->busy[g / 3] || vg_ref_to(r, g) == q) return 0;
  }
  return 1;
}

static void set_busy(struct swapper *s, uint32_t h)
{
  s->busy[h / 3] = 1;
  for (uint32_t e = 3 * (h / 3); e < 3 * (h / 3) + 3; e++)
    if (s->ref.mate[e] != VG_REF_NONE) s->busy[s->ref.mate[e] / 3] = 1;
}

/* Are the two new triangles better, and do they face the same way as u? */
static int is_better(const struct vg_mesh *m, uint32_t t, uint32_t u,
                     const uint32_t made[2][3])
{
  const double before = fmin(shape_of(m, m->tri[t]), shape_of(m, m->tri[u]));
  double n[3], made_n[3];

  if (!(normal_of(m, m->tri[u], n) > 0)) return 0;
  for (int k = 0; k < 2; k++)
    if (!(shape_of(m, made[k]) > before) ||
        !(normal_of(m, made[k], made_n) > 0) || !(vg_dot(n, made_n) > TURN))
      return 0;
  return 1;
}

/* Swap the longest edge h of a flat triangle with its neighbour, which is cut
 * in two. */
static int swap(struct swapper *s, uint32_t h)
{
  struct vg_mesh *m = s->m;
  const struct vg_ref *r = &s->ref;
  const uint32_t g = r->mate[h], t = h / 3, u = g / 3;
  uint32_t c, d;

  if (g == VG_REF_NONE || s->busy[t] || s->busy[u]) return 0;
  if (m->tri_patch[t] != m->tri_patch[u] && s->count[m->tri_patch[t]] < 2)
    return 0;
  c = vg_ref_from(r, vg_half_prev(h));
  d = vg_ref_from(r, vg_half_prev(g));
  {
    const uint32_t made[2][3] = { { vg_ref_from(r, h), d, c },
                                  { d, vg_ref_to(r, h), c } };

    if (c == d || !may_join(s, vg_half_prev(h), d) || !is_better(m, t, u, made))
      return 0;
    set_busy(s, h);
    set_busy(s, g);
    memcpy(m->tri[t], made[0], sizeof made[0]);
    memcpy(m->tri[u], made[1], sizeof made[1]);
  }
  s->count[m->tri_patch[t]]--;
  m->tri_patch[t] = m->tri_patch[u];
  s->count[m->tri_patch[t]]++;
  return 1;
}

static vg_status sweep(struct vg_mesh *m, const struct vg_flat_limit *limit,
                       size_t *n, struct vg_error *err)
{
  struct swapper s = { .m = m, .ref = VG_REF_INIT };
  struct flat *list = NULL;
  size_t n_flat = 0;
  vg_status st;

  *n = 0;
  VG_TRY(list_flat(m, limit, &list, &n_flat, err));
  if (!n_flat) goto done;
  s.busy = vg_calloc(m->n_tri, 1);
  s.count = vg_calloc(m->n_patch, sizeof *s.count);
  if (!s.busy || !s.count) VG_TRY(vg_fail_memory(err, "flat triangles"));
  for (size_t t = 0; t < m->n_tri; t++) s.count[m->tri_patch[t]]++;
  VG_TRY(vg_ref_set_faces(&s.ref, m, NULL, err));
  for (size_t i = 0; i < n_flat; i++) *n += (size_t)swap(&s, list[i].half);
done:
  free(list);
  free(s.busy);
  free(s.count);
  vg_ref_release(&s.ref);
  return st;
}

vg_status vg_flat_swap(struct vg_mesh *m, const struct vg_flat_limit *limit,
                       size_t *n, struct vg_error *err)
{
  vg_status st = VG_OK;

  *n = 0;
  for (int i = 0; i < SWEEPS; i++) {
    size_t done;

    VG_TRY(sweep(m, limit, &done, err));
    *n += done;
    if (!done) break;
  }
done:
  return st;
}
