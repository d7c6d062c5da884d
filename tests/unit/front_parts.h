/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Connected components of a front, for tests: separator zones must divide the
 * front. */
#ifndef FRONT_PARTS_H
#define FRONT_PARTS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "partition/cut/task_data.h"

/* --- components ---------------------------------------------------------- */

/* Half edges by their lower point. */
struct part_edges {
  uint32_t *first; /* [n_point + 2] */
  uint32_t *half;  /* [3 n_face] 3 * face + first corner */
};

static void part_ends_of(const struct vg_front *f, uint32_t half,
                         uint32_t *from, uint32_t *to)
{
  *from = f->face[half / 3][half % 3];
  *to = f->face[half / 3][(half % 3 + 1) % 3];
}

static int part_edges_init(struct part_edges *e, const struct vg_front *f)
{
  e->first = vg_calloc(f->n_point + 2, sizeof *e->first);
  e->half = vg_alloc(3 * f->n_face, sizeof *e->half);
  if (!e->first || !e->half) return -1;
  for (uint32_t h = 0; h < 3 * f->n_face; h++) {
    uint32_t a, b;

    part_ends_of(f, h, &a, &b);
    e->first[(a < b ? a : b) + 2]++;
  }
  for (size_t p = 0; p < f->n_point; p++) e->first[p + 2] += e->first[p + 1];
  for (uint32_t h = 0; h < 3 * f->n_face; h++) {
    uint32_t a, b;

    part_ends_of(f, h, &a, &b);
    e->half[e->first[(a < b ? a : b) + 1]++] = h;
  }
  return 0;
}

/* The corner of a half edge's face that is not on the edge. */
static const double *part_apex(const struct vg_front *f, uint32_t half)
{
  return f->x[f->face[half / 3][(half % 3 + 2) % 3]];
}

static void part_minus(const double a[3], const double b[3], double d[3])
{
  for (int k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

static double part_triple(const double a[3], const double b[3],
                          const double c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) +
         a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double part_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A monotonic measure, from 0 to 4, of the angle by which a face must be turned
 * about its edge, through the void in front of it, to reach another face. */
static double part_turn(const struct vg_front *f, uint32_t half, uint32_t other)
{
  uint32_t from, to;
  double e[3], u[3], v[3], n, c, s;

  part_ends_of(f, half, &from, &to);
  part_minus(f->x[to], f->x[from], e);
  part_minus(part_apex(f, half), f->x[from], u);
  part_minus(part_apex(f, other), f->x[from], v);
  n = part_dot(e, e);
  c = part_dot(u, v) - part_dot(u, e) * part_dot(v, e) / n;
  s = part_triple(e, u, v) / sqrt(n);
  n = fabs(c) + fabs(s);
  if (!(n > 0)) return 0;
  return s >= 0 ? (c >= 0 ? s / n : 2 - s / n)
                : (c < 0 ? 2 - s / n : 4 + s / n);
}

/* Where more than two faces meet at an edge, several voids touch there. A face
 * is united with the first face that it meets when it is turned into its own
 * void. */
static void part_unite_crowd(const struct vg_front *f, uint32_t *parent,
                             size_t n, const uint32_t *half)
{
  for (size_t i = 0; i < n; i++) {
    uint32_t from, to, a, b, best = UINT32_MAX;
    double least = 5;

    part_ends_of(f, half[i], &from, &to);
    for (size_t j = 0; j < n; j++) {
      double angle;

      part_ends_of(f, half[j], &a, &b);
      if (a != to) continue;
      angle = part_turn(f, half[i], half[j]);
      if (angle < least) {
        least = angle;
        best = half[j];
      }
    }
    if (best != UINT32_MAX) vg_union(parent, half[i] / 3, best / 3);
  }
}

/* Unite the faces at all edges whose lower point is p. */
static void part_unite_around(const struct vg_front *f,
                              const struct part_edges *e, uint32_t *parent,
                              size_t p)
{
  uint32_t *list = e->half + e->first[p];
  size_t n = e->first[p + 1] - e->first[p], same;

  for (; n; n -= same, list += same) {
    uint32_t a, b, far;

    part_ends_of(f, list[0], &a, &b);
    far = a < b ? b : a;
    same = 1;
    for (size_t j = 1; j < n; j++) {
      uint32_t keep = list[j];

      part_ends_of(f, keep, &a, &b);
      if ((a < b ? b : a) != far) continue;
      list[j] = list[same];
      list[same++] = keep;
    }
    if (same == 2) vg_union(parent, list[0] / 3, list[1] / 3);
    else part_unite_crowd(f, parent, same, list);
  }
}

/* Components of a front that share no edge, numbered by their first face. part
 * out: [n_face] 0, 1, ...; n out: their number. */
static inline vg_status front_parts(const struct vg_front *f, uint32_t *part,
                                    size_t *n, struct vg_error *err)
{
  struct part_edges e = { 0 };
  uint32_t *parent = vg_alloc(f->n_face, sizeof *parent);
  vg_status st = VG_OK;

  *n = 0;
  if (!parent || part_edges_init(&e, f)) {
    st = vg_fail_memory(err, "the parts of a front");
    goto done;
  }
  for (uint32_t i = 0; i < f->n_face; i++) parent[i] = i;
  for (size_t p = 0; p < f->n_point; p++) part_unite_around(f, &e, parent, p);
  for (uint32_t i = 0; i < f->n_face; i++) {
    uint32_t r = vg_root_of(parent, i);

    part[i] = r == i ? (uint32_t)(*n)++ : part[r];
  }
done:
  free(parent);
  free(e.first);
  free(e.half);
  return st;
}

static vg_status part_allocate(struct vg_front *f, size_t n_point,
                               size_t n_face, struct vg_error *err)
{
  memset(f, 0, sizeof *f);
  f->x = vg_alloc(n_point, sizeof *f->x);
  f->id = vg_alloc(n_point, sizeof *f->id);
  f->face = vg_alloc(n_face, sizeof *f->face);
  if (f->x && f->id && f->face) return VG_OK;
  vg_front_release(f);
  return vg_fail_memory(err, "a front");
}

/* The listed faces, with their points. to: [n_point] all UINT32_MAX, before and
 * after. */
static vg_status part_take(const struct vg_front *f, size_t n,
                           const uint32_t *face, uint32_t *to,
                           struct vg_front *out, struct vg_error *err)
{
  size_t np = 0;
  vg_status st;

  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      if (to[f->face[face[i]][k]] == UINT32_MAX)
        to[f->face[face[i]][k]] = (uint32_t)np++;
  st = part_allocate(out, np, n, err);
  for (size_t i = 0; st == VG_OK && i < n; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = f->face[face[i]][k];

      out->face[i][k] = to[p];
      memcpy(out->x[to[p]], f->x[p], sizeof *out->x);
      out->id[to[p]] = f->id[p];
    }
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) to[f->face[face[i]][k]] = UINT32_MAX;
  if (st < 0) return st;
  out->n_point = np;
  out->n_face = n;
  return VG_OK;
}

/* One front for each of n components: out [n], with the points they use. */
static inline vg_status front_split(const struct vg_front *f,
                                    const uint32_t *part, size_t n,
                                    struct vg_front *out, struct vg_error *err)
{
  uint32_t *to = vg_alloc(f->n_point, sizeof *to);
  uint32_t *list = vg_alloc(f->n_face, sizeof *list);
  size_t *first = vg_calloc(n + 2, sizeof *first);
  vg_status st = VG_OK;

  memset(out, 0, n * sizeof *out);
  if (!to || !list || !first) {
    st = vg_fail_memory(err, "the parts of a front");
    goto done;
  }
  memset(to, 0xff, f->n_point * sizeof *to);
  for (size_t i = 0; i < f->n_face; i++) first[part[i] + 2]++;
  for (size_t k = 0; k < n; k++) first[k + 2] += first[k + 1];
  for (size_t i = 0; i < f->n_face; i++)
    list[first[part[i] + 1]++] = (uint32_t)i;
  for (size_t k = 0; k < n; k++)
    VG_TRY(
      part_take(f, first[k + 1] - first[k], list + first[k], to, &out[k], err));
done:
  for (size_t k = 0; st < 0 && k < n; k++) vg_front_release(&out[k]);
  free(to);
  free(list);
  free(first);
  return st;
}

#endif
