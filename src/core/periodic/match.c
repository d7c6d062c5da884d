/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Partners of points and faces. Declared in core/periodic/periodic.h. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/periodic/near_points.h"

/* S101: share of the shortest edge at a point by which the point may move, so
 * that no triangle folds. */
#define EDGE_SHARE 0.1

struct work {
  const struct vg_mesh *m;
  const struct vg_periodic *p;
  double *edge;    /* [n_point] squared length of the shortest edge */
  uint8_t *in[2];  /* [n_point] the point is in the patch, in the image */
  uint8_t *is_hit; /* [n_point] the point is a partner */
  struct vg_near_points image;
};

/* Nodes of face f, quadrilaterals after triangles; returns their number. */
static int nodes_of(const struct vg_mesh *m, size_t f, const uint32_t **node)
{
  *node = f < m->n_tri ? m->tri[f] : m->quad[f - m->n_tri];
  return f < m->n_tri ? 3 : 4;
}

/* 0: the face is in the patch, 1: in the image, -1: in neither. */
static int side_of(const struct work *w, size_t f)
{
  const struct vg_mesh *m = w->m;
  const uint32_t at = f < m->n_tri ? m->tri_patch[f]
                                   : m->quad_patch[f - m->n_tri];
  const int32_t id = m->patch[at].id;

  return id == w->p->patch ? 0 : id == w->p->image ? 1 : -1;
}

static double area_of(const struct vg_mesh *m, const uint32_t *q, int n)
{
  double area = vg_triangle_area(m->point[q[0]], m->point[q[1]],
                                 m->point[q[2]]);

  if (n == 4)
    area += vg_triangle_area(m->point[q[0]], m->point[q[2]], m->point[q[3]]);
  return area;
}

static void mark(struct work *w, struct vg_periodic_match *out)
{
  const struct vg_mesh *m = w->m;

  for (size_t i = 0; i < m->n_point; i++) w->edge[i] = INFINITY;
  for (size_t f = 0; f < m->n_tri + m->n_quad; f++) {
    const uint32_t *q;
    const int n = nodes_of(m, f, &q), side = side_of(w, f);

    for (int k = 0; k < n; k++) {
      const uint32_t a = q[k], b = q[(k + 1) % n];
      const double d = vg_distance2(m->point[a], m->point[b]);

      w->edge[a] = fmin(w->edge[a], d);
      w->edge[b] = fmin(w->edge[b], d);
      if (side >= 0) w->in[side][a] = 1;
    }
    if (side < 0) continue;
    out->n_face[side]++;
    out->area[side] += area_of(m, q, n);
  }
  for (size_t i = 0; i < m->n_point; i++)
    for (int s = 0; s < 2; s++) out->n_point[s] += w->in[s][i];
}

static vg_status plant(struct work *w, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (uint32_t i = 0; i < w->m->n_point; i++)
    if (w->in[1][i]) VG_TRY(vg_near_points_add(&w->image, i, err));
  st = vg_near_points_build(&w->image, w->m, err);
done:
  return st;
}

static void match_points(struct work *w, double tolerance,
                         struct vg_periodic_match *out)
{
  for (uint32_t i = 0; i < w->m->n_point; i++) {
    double x[3], d2, d;
    uint32_t point = i;

    out->point[i] = VG_PERIODIC_NONE;
    if (!w->in[0][i]) continue;
    vg_periodic_image(w->p, w->m->point[i], x);
    if (w->in[1][i]) d2 = vg_distance2(x, w->m->point[i]);
    else point = vg_near_points_find(&w->image, x, &d2);
    d = sqrt(d2);
    if (out->worst == VG_PERIODIC_NONE || d > out->distance) {
      out->distance = d;
      out->worst = i;
    }
    if (point == VG_PERIODIC_NONE || d > tolerance ||
        d2 > EDGE_SHARE * EDGE_SHARE * w->edge[point] || w->is_hit[point]++) {
      out->n_off++;
      continue;
    }
    out->point[i] = point;
  }
}

/* A face of the image by its nodes in ascending order. */
struct key {
  uint32_t node[4], face;
};

static struct key key_of(const uint32_t *node, int n, uint32_t face)
{
  struct key key = { { 0, 0, 0, VG_PERIODIC_NONE }, face };

  for (int i = 0; i < n; i++) {
    int k = i;

    for (; k > 0 && key.node[k - 1] > node[i]; k--)
      key.node[k] = key.node[k - 1];
    key.node[k] = node[i];
  }
  return key;
}

static int by_nodes(const void *a, const void *b)
{
  const struct key *x = a, *y = b;

  for (int k = 0; k < 4; k++)
    if (x->node[k] != y->node[k]) return x->node[k] < y->node[k] ? -1 : 1;
  return 0;
}

/* Whether the face goes through the nodes in the reverse order. */
static int is_reversed(const uint32_t *node, const uint32_t *face, int n)
{
  int at = 0;

  while (at < n && face[at] != node[0]) at++;
  for (int k = 0; k < n; k++)
    if (at == n || face[(at + n - k) % n] != node[k]) return 0;
  return 1;
}

static vg_status match_faces(struct work *w, struct vg_periodic_match *out,
                             struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  const size_t n_face = m->n_tri + m->n_quad;
  struct key *key = vg_alloc(out->n_face[1], sizeof *key);
  size_t n_key = 0;

  if (!key) return vg_fail_memory(err, "the periodic patches");
  for (size_t f = 0; f < n_face; f++) {
    const uint32_t *q;
    const int n = nodes_of(m, f, &q);

    out->face[f] = VG_PERIODIC_NONE;
    if (side_of(w, f) == 1) key[n_key++] = key_of(q, n, (uint32_t)f);
  }
  qsort(key, n_key, sizeof *key, by_nodes);
  for (size_t f = 0; f < n_face; f++) {
    const uint32_t *q, *other;
    uint32_t node[4];
    const int n = nodes_of(m, f, &q);
    const struct key *found;
    struct key one;

    if (side_of(w, f) != 0) continue;
    for (int k = 0; k < n; k++) node[k] = out->point[q[k]];
    one = key_of(node, n, 0);
    found = bsearch(&one, key, n_key, sizeof *key, by_nodes);
    if (found) nodes_of(m, found->face, &other);
    if (found && is_reversed(node, other, n)) out->face[f] = found->face;
    else out->n_bad++;
  }
  free(key);
  return VG_OK;
}

vg_status vg_periodic_match(const struct vg_mesh *m,
                            const struct vg_periodic *p, double tolerance,
                            struct vg_periodic_match *out, struct vg_error *err)
{
  struct work w = { .m = m, .p = p, .image = VG_NEAR_POINTS_INIT };
  const size_t n = m->n_point;
  vg_status st = VG_OK;

  assert(p->patch != p->image);
  *out = (struct vg_periodic_match)VG_PERIODIC_MATCH_INIT;
  out->worst = VG_PERIODIC_NONE;
  w.edge = vg_alloc(n, sizeof *w.edge);
  w.in[0] = vg_calloc(3 * n, 1);
  out->point = vg_alloc(n, sizeof *out->point);
  out->face = vg_alloc(m->n_tri + m->n_quad, sizeof *out->face);
  if (!w.edge || !w.in[0] || !out->point || !out->face)
    VG_TRY(vg_fail_memory(err, "the periodic patches"));
  w.in[1] = w.in[0] + n;
  w.is_hit = w.in[1] + n;
  mark(&w, out);
  VG_TRY(plant(&w, err));
  match_points(&w, tolerance, out);
  if (!out->n_off) st = match_faces(&w, out, err);
done:
  vg_near_points_release(&w.image);
  free(w.edge);
  free(w.in[0]);
  if (st < 0) vg_periodic_match_release(out);
  return st;
}

int vg_periodic_matches(const struct vg_periodic_match *match)
{
  return match->n_face[0] && match->n_face[0] == match->n_face[1] &&
         match->n_point[0] == match->n_point[1] && !match->n_off &&
         !match->n_bad;
}

void vg_periodic_match_release(struct vg_periodic_match *match)
{
  free(match->point);
  free(match->face);
  match->point = match->face = NULL;
}

static int by_value(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;

  return (x > y) - (x < y);
}

vg_status vg_periodic_refine(const struct vg_mesh *m, struct vg_periodic *p,
                             const struct vg_periodic_match *match,
                             struct vg_error *err)
{
  double *d;

  if (p->is_rotation || !match->n_point[0]) return VG_OK;
  d = vg_alloc(match->n_point[0], sizeof *d);
  if (!d) return vg_fail_memory(err, "the periodic patches");
  for (int k = 0; k < 3; k++) {
    size_t n = 0;

    for (size_t i = 0; i < m->n_point; i++)
      if (match->point[i] != VG_PERIODIC_NONE)
        d[n++] = m->point[match->point[i]][k] - m->point[i][k];
    qsort(d, n, sizeof *d, by_value);
    p->shift[k] = d[n / 2];
  }
  free(d);
  return VG_OK;
}

size_t vg_periodic_apply(struct vg_mesh *m, struct vg_periodic *p,
                         const struct vg_periodic_match *match)
{
  size_t n = 0;

  assert(vg_periodic_matches(match));
  p->distance = match->distance;
  p->n_face = match->n_face[0];
  for (uint32_t i = 0; i < m->n_point; i++) {
    const uint32_t to = match->point[i];
    double x[3];

    if (to == VG_PERIODIC_NONE || to == i) continue;
    vg_periodic_image(p, m->point[i], x);
    if (!memcmp(x, m->point[to], sizeof x)) continue;
    memcpy(m->point[to], x, sizeof x);
    n++;
  }
  return n;
}
