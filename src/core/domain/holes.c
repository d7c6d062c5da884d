/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: open edges are joined to rims. The rims of the cut of a half model
 * stay open; each other rim is closed by a patch of its own, or by two or three
 * if it lies in two or three planes (rim_planes.h). */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/domain/open_edges.h"
#include "core/domain/planar.h"
#include "core/domain/rim_planes.h"
#include "core/domain/span.h"
#include "core/domain/symmetry.h"
#include "core/geometry/vector.h"

#define HOLE_FLATNESS 0.05 /* S11 */
#define ONE_PLANE 1e-3     /* S11: flatter rims are not divided */
#define NEAR_END 1e-3      /* S125: of the length of the body */
#define CORNER 0.7         /* S125: cosine of the turn of a rim at a corner */
#define FAR 0.3            /* S125: of the width of a rim */
#define PART 0.2 /* S11: of a rim in two planes: least part in one of them */
#define OPPOSITE                                                               \
  0.1 /* S11: of the extent: rims this near to an end belong to it */

struct holes {
  struct vg_mesh m;
  struct vg_border open;
  uint32_t *next; /* [n_point] Next point along the rim, or UINT32_MAX. */
  uint32_t *loop; /* [n_point] Number of its rim. */
  uint32_t *apex; /* [n_point] Third point of the triangle at the edge to the
                     next point of the rim, or UINT32_MAX. */
  uint32_t n_loop;
  struct rim {
    uint32_t first;
    int stays;
  } * rim;
  double lo[3], hi[3], length, tolerance;
  size_t n_curved; /* Caps whose rims lie in no plane. */
};

static vg_status follow_rims(struct holes *h, struct vg_error *err)
{
  for (size_t i = 0; i < h->m.n_point; i++)
    h->next[i] = h->loop[i] = UINT32_MAX;
  for (size_t i = 0; i < h->open.n; i++) {
    const uint32_t *e = h->open.edge[i];
    const double *x = h->m.point[e[0]];

    if (h->next[e[0]] != UINT32_MAX)
      return vg_fail(err, VG_ERR_GEOMETRY,
                     "two holes of the surface meet at "
                     "(%.9g, %.9g, %.9g), so that it is not clear how to close "
                     "them",
                     x[0], x[1], x[2]);
    h->next[e[0]] = e[1];
  }
  for (size_t i = 0; i < h->open.n; i++) {
    uint32_t p = h->open.edge[i][0];

    if (h->loop[p] != UINT32_MAX) continue;
    h->rim[h->n_loop] = (struct rim){ .first = p };
    for (; h->loop[p] == UINT32_MAX; p = h->next[p]) h->loop[p] = h->n_loop;
    h->n_loop++;
  }
  return VG_OK;
}

static int is_in_plane(const struct holes *h, uint32_t k, int axis, double at)
{
  uint32_t p = h->rim[k].first;

  do {
    if (fabs(h->m.point[p][axis] - at) > h->tolerance) return 0;
    p = h->next[p];
  } while (p != h->rim[k].first);
  return 1;
}

static vg_status list_edges(const struct holes *h, uint32_t k,
                            struct vg_border *to, struct vg_error *err)
{
  uint32_t p = h->rim[k].first;
  vg_status st = VG_OK;

  do {
    st = vg_border_add(to, p, h->next[p], err);
    p = h->next[p];
  } while (st == VG_OK && p != h->rim[k].first);
  return st;
}

/* Set *cut to whether the rims in a plane are the cut of a half model. */
static vg_status is_cut(const struct holes *h, int symmetry, int axis,
                        double at, int *cut, struct vg_error *err)
{
  struct vg_border some = VG_BORDER_INIT;
  vg_status st = VG_OK;

  for (uint32_t k = 0; k < h->n_loop; k++)
    if (is_in_plane(h, k, axis, at)) VG_TRY(list_edges(h, k, &some, err));
  *cut = some.n && (symmetry > 0 || vg_is_symmetry(&h->m, &some, axis, at));
done:
  vg_border_release(&some);
  return st;
}

/* Is there a rim at the end of the body opposite the plane? */
static int is_open_opposite(const struct holes *h, int axis, int is_lo)
{
  const double extent = h->hi[axis] - h->lo[axis];

  for (uint32_t k = 0; k < h->n_loop; k++) {
    const double x = h->m.point[h->rim[k].first][axis];

    if ((is_lo ? h->hi[axis] - x : x - h->lo[axis]) < OPPOSITE * extent)
      return 1;
  }
  return 0;
}

/* Mark the rims of a half model to stay open. A shaft or a wing section that is
 * open at both ends is not a half model. */
static vg_status keep_symmetry(struct holes *h, int symmetry,
                               struct vg_error *err)
{
  int found = 0;
  vg_status st = VG_OK;

  for (int i = 0; i < 3 && symmetry >= 0 && !found; i++) {
    const int axis = (i + 1) % 3; /* y first: the most common */
    int lo, hi;

    VG_TRY(is_cut(h, symmetry, axis, h->lo[axis], &lo, err));
    VG_TRY(is_cut(h, symmetry, axis, h->hi[axis], &hi, err));
    if (lo && hi && symmetry > 0) { /* decide by the shape of the ends */
      VG_TRY(is_cut(h, 0, axis, h->lo[axis], &lo, err));
      VG_TRY(is_cut(h, 0, axis, h->hi[axis], &hi, err));
    }
    found = lo != hi && (symmetry > 0 || !is_open_opposite(h, axis, lo));
    for (uint32_t k = 0; found && k < h->n_loop; k++)
      h->rim[k].stays = is_in_plane(h, k, axis, lo ? h->lo[axis] : h->hi[axis]);
  }
done:
  return st;
}

/* Add the patch of the n-th cap. Its id is one above all others. */
static vg_status add_cap(struct holes *h, size_t n, uint32_t *patch,
                         struct vg_error *err)
{
  char name[VG_NAME_MAX];
  const int32_t id = vg_mesh_last_id(&h->m);
  size_t at;

  if (id == INT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "no patch number is left for a "
                   "cap; renumber the patches");
  snprintf(name, sizeof name, "cap_%zu", n);
  at = vg_mesh_add_patch(&h->m, id + 1, name);
  if (at == SIZE_MAX) return vg_fail_memory(err, "a patch");
  *patch = (uint32_t)at;
  return VG_OK;
}

/* Is every point of the loop within `flatness` times its extent of a plane? */
static int is_flat(const struct holes *h, size_t n, const uint32_t *loop,
                   double flatness)
{
  double sum[3] = { 0, 0, 0 }, most = 0, extent = 0;
  const double *o = h->m.point[loop[0]];

  for (size_t i = 1; i + 1 < n; i++) {
    double u[3], v[3], c[3];

    vg_sub(h->m.point[loop[i]], o, u);
    vg_sub(h->m.point[loop[i + 1]], o, v);
    vg_cross(u, v, c);
    for (int d = 0; d < 3; d++) sum[d] += c[d];
    extent = fmax(extent, vg_norm(u));
  }
  if (!(vg_unit(sum) > 0)) return 0;
  for (size_t i = 1; i < n; i++) {
    double u[3];

    vg_sub(h->m.point[loop[i]], o, u);
    most = fmax(most, fabs(vg_dot(u, sum)));
  }
  return most <= flatness * extent;
}

/* Close the loop of n points by a patch of its own: plane if the loop is nearly
 * so, otherwise with the least area between its points. */
static vg_status close_loop(struct holes *h, size_t n, const uint32_t *loop,
                            const struct vg_size_function *law, size_t *n_cap,
                            struct vg_error *err)
{
  struct vg_border rim = VG_BORDER_INIT;
  struct vg_error inner = VG_ERROR_INIT;
  const double *x = h->m.point[loop[0]];
  uint32_t patch = 0;
  vg_status st;

  VG_TRY(add_cap(h, ++*n_cap, &patch, err));
  for (size_t i = 0; i < n; i++)
    VG_TRY(vg_border_add(&rim, loop[i], loop[(i + 1) % n], err));
  st = vg_planar_patch_near(&h->m, rim.n, (const uint32_t(*)[2])rim.edge, law,
                            HOLE_FLATNESS, patch, &inner);
  if (st == VG_ERR_GEOMETRY) st = vg_span_rim(&h->m, n, loop, patch, &inner);
  h->n_curved += !is_flat(h, n, loop, ONE_PLANE);
  if (st < 0)
    st = vg_fail(err, st,
                 "the hole at (%.9g, %.9g, %.9g), of %zu edges, "
                 "cannot be closed: %s",
                 x[0], x[1], x[2], rim.n, inner.text);
done:
  vg_border_release(&rim);
  return st;
}

/* Cosine of the angle by which the loop turns in point i. */
static double turn(const struct holes *h, size_t n, const uint32_t *loop,
                   size_t i)
{
  double in[3], out[3];

  vg_sub(h->m.point[loop[i % n]], h->m.point[loop[(i + n - 1) % n]], in);
  vg_sub(h->m.point[loop[(i + 1) % n]], h->m.point[loop[i % n]], out);
  return vg_unit(in) > 0 && vg_unit(out) > 0 ? vg_dot(in, out) : 1;
}

/* Number of points of a run that follow its sharpest corner near its end i, in
 * steps of `step` towards the other end. */
static size_t n_behind_corner(const struct holes *h, size_t n,
                              const uint32_t *loop, size_t n_run, size_t i,
                              size_t step)
{
  const double *end = h->m.point[loop[i % n]];
  double sharpest = turn(h, n, loop, i);
  size_t best = 0;

  for (size_t k = 1; k + 1 < n_run; k++) {
    double cosine;

    i = (i + step) % n;
    if (vg_distance(h->m.point[loop[i]], end) > NEAR_END * h->length) break;
    cosine = turn(h, n, loop, i);
    if (cosine >= sharpest) continue;
    sharpest = cosine;
    best = k;
  }
  return best;
}

/* Consecutive points of a loop in the plane x[axis] = at. */
struct run {
  size_t first, n;
  int axis;
  double at;
};

/* Longest run of the loop in a plane normal to an axis at an end of the body.
 * It ends at corners: the edge of a thin stem is within the tolerance of the
 * plane of symmetry, too. */
static struct run find_run(const struct holes *h, size_t n,
                           const uint32_t *loop)
{
  struct run r = { 0, 0, 0, 0 };
  size_t behind;

  for (int side = 0; side < 6; side++) {
    const int axis = side / 2;
    const double at = side % 2 ? h->hi[axis] : h->lo[axis];
    size_t run = 0;

    /* Twice around, so that a run may pass the first point. */
    for (size_t i = 0; i < 2 * n; i++) {
      if (fabs(h->m.point[loop[i % n]][axis] - at) > h->tolerance) run = 0;
      else if (++run > r.n && run <= n)
        r = (struct run){ (i + 1 - run) % n, run, axis, at };
    }
  }
  if (r.n < 2 || r.n == n) return r;
  r.n -= n_behind_corner(h, n, loop, r.n, r.first + r.n - 1, n - 1);
  behind = n_behind_corner(h, n, loop, r.n, r.first, 1);
  r.first = (r.first + behind) % n;
  r.n -= behind;
  return r;
}

/* Add points to the chord from point a to point b, `step` apart. */
static vg_status add_chord(struct holes *h, uint32_t a, uint32_t b, double step,
                           size_t *n, uint32_t *point, struct vg_error *err)
{
  const double length = vg_distance(h->m.point[a], h->m.point[b]);
  const double n_piece = fmin(fmax(1, length / step), VG_SPAN_MOST / 3);
  double(*list)[3];

  *n = (size_t)n_piece - 1;
  list = vg_realloc(h->m.point, h->m.n_point + *n, sizeof *list);
  if (!list) return vg_fail_memory(err, "the cap of a rim");
  h->m.point = list;
  for (size_t i = 0; i < *n; i++) {
    const double t = (double)(i + 1) / (double)(*n + 1);
    const size_t at = h->m.n_point++;

    for (int d = 0; d < 3; d++)
      list[at][d] = list[a][d] + t * (list[b][d] - list[a][d]);
    point[i] = (uint32_t)at;
  }
  return VG_OK;
}

static vg_status add_point(struct holes *h, const double x[3], uint32_t *point,
                           struct vg_error *err)
{
  double(*list)[3] = vg_realloc(h->m.point, h->m.n_point + 1, sizeof *list);

  if (!list) return vg_fail_memory(err, "the cap of a rim");
  h->m.point = list;
  *point = (uint32_t)h->m.n_point++;
  memcpy(list[*point], x, sizeof *list);
  return VG_OK;
}

/* Points that divide a rim: chord i has n[i] points at point[i]. */
struct chords {
  size_t n[3];
  uint32_t *point[3];
};

/* A list of points that becomes the loop of a cap. */
struct part {
  size_t n;
  uint32_t *point;
};

/* Append points i to j of the loop, around its end. */
static void append_rim(struct part *to, size_t n, const uint32_t *loop,
                       size_t i, size_t j)
{
  for (; i <= j; i++) to->point[to->n++] = loop[i % n];
}

static void append_chord(struct part *to, const struct chords *c, int i,
                         int is_reversed)
{
  for (size_t k = 0; k < c->n[i]; k++)
    to->point[to->n++] = c->point[i][is_reversed ? c->n[i] - 1 - k : k];
}

static double length_of(const struct holes *h, size_t n, const uint32_t *loop)
{
  double length = 0;

  for (size_t i = 0; i < n; i++)
    length += vg_distance(h->m.point[loop[i]], h->m.point[loop[(i + 1) % n]]);
  return length;
}

/* A rim in two planes, such as that of half a hull without deck, is divided by
 * the chord between both parts:
 *
 *      first o====================o last       deck: the other part, closed by
 *             \ . . . chord . . ./             the reversed chord
 *              \                /
 *               '--------------'              run in the plane of symmetry
 *
 * A rim in three planes, such as that of half a hull without deck and transom,
 * is divided by chords that meet in the foot:
 *
 *      first o====== deck =====o corner
 *            |                /|
 *            |\             2  |  transom
 *            | \           /   |
 *            |  `--- 1 ---o-0--o last
 *            '--- run ---------'
 */
static vg_status close_in_parts(struct holes *h, size_t n, const uint32_t *loop,
                                const struct vg_rim_parts *p, struct chords *c,
                                struct part *part,
                                const struct vg_size_function *law,
                                size_t *n_cap, struct vg_error *err)
{
  const double step = length_of(h, n, loop) / (double)n;
  uint32_t foot = 0;
  vg_status st = VG_OK;

  if (p->n_part == 2)
    VG_TRY(add_chord(h, loop[p->at[1] % n], loop[p->at[0] % n], step, &c->n[0],
                     c->point[0], err));
  else {
    VG_TRY(add_point(h, p->foot, &foot, err));
    VG_TRY(
      add_chord(h, loop[p->at[1] % n], foot, step, &c->n[1], c->point[1], err));
    VG_TRY(
      add_chord(h, foot, loop[p->at[0] % n], step, &c->n[0], c->point[0], err));
    VG_TRY(
      add_chord(h, foot, loop[p->at[2] % n], step, &c->n[2], c->point[2], err));
  }
  for (int i = 0; i < p->n_part; i++) {
    const int j = (i + 1) % 3;

    part->n = 0;
    append_rim(part, n, loop, p->at[i], p->at[i + 1]);
    if (p->n_part == 2) append_chord(part, c, 0, i);
    else { /* chord 1 leads to the foot, the others away from it */
      append_chord(part, c, j, j != 1);
      part->point[part->n++] = foot;
      append_chord(part, c, i, i == 1);
    }
    VG_TRY(close_loop(h, part->n, part->point, law, n_cap, err));
  }
done:
  return st;
}

/* Sharpest corner of the loop outside the run, away from its plane; 0: the loop
 * has none. */
static size_t find_corner(const struct holes *h, size_t n, const uint32_t *loop,
                          const struct run *r)
{
  double sharpest = CORNER, far = 0;
  size_t at = 0;

  for (size_t i = r->first + r->n; i < r->first + n; i++)
    far = fmax(far, fabs(h->m.point[loop[i % n]][r->axis] - r->at));
  for (size_t i = r->first + r->n; i < r->first + n; i++) {
    const double off = fabs(h->m.point[loop[i % n]][r->axis] - r->at);
    const double cosine = turn(h, n, loop, i);

    if (off < FAR * far || cosine >= sharpest) continue;
    sharpest = cosine;
    at = i;
  }
  return at;
}

/* Divide and close. */
static vg_status close_divided(struct holes *h, size_t n, const uint32_t *loop,
                               const struct vg_rim_parts *p,
                               const struct vg_size_function *law,
                               size_t *n_cap, struct vg_error *err)
{
  uint32_t *memory = vg_alloc(n + 2 * VG_SPAN_MOST + 2, sizeof *memory);
  struct part part = { 0, memory };
  struct chords c = { .n = { 0 } };
  vg_status st;

  if (!memory) VG_TRY(vg_fail_memory(err, "the cap of a rim"));
  for (size_t i = 0; i < 3; i++)
    c.point[i] = memory + n + VG_SPAN_MOST + 2 + i * (VG_SPAN_MOST / 3);
  st = close_in_parts(h, n, loop, p, &c, &part, law, n_cap, err);
done:
  free(memory);
  return st;
}

/* Is the run a considerable part of the rim? */
static int is_part(const struct holes *h, size_t n, const uint32_t *loop,
                   size_t first, size_t n_run)
{
  double all = 0, run = 0;

  for (size_t i = 0; i < n; i++) {
    const double length = vg_distance(h->m.point[loop[(first + i) % n]],
                                      h->m.point[loop[(first + i + 1) % n]]);

    all += length;
    if (i + 1 < n_run) run += length;
  }
  return run > PART * all && run < (1 - PART) * all;
}

/* Parts of the rim of which one lies in a plane normal to an axis at an end of
 * the body. The others may be curved, as the deck of a hull is; three of them
 * meet in the projection of a corner onto the plane. */
static int find_parts_at_end(const struct holes *h, size_t n,
                             const uint32_t *loop, struct vg_rim_parts *p)
{
  const struct run r = find_run(h, n, loop);
  size_t corner;

  if (r.n <= 2 || r.n >= n || !is_part(h, n, loop, r.first, r.n)) return 0;
  corner = find_corner(h, n, loop, &r);
  p->n_part = corner ? 3 : 2;
  p->at[0] = r.first;
  p->at[1] = r.first + r.n - 1;
  p->at[2] = corner ? corner : r.first + n;
  p->at[3] = r.first + n;
  if (!corner) return 1;
  memcpy(p->foot, h->m.point[loop[corner % n]], sizeof p->foot);
  p->foot[r.axis] = r.at;
  return 1;
}

/* Set *p to the parts of the rim; n_part = 1 if it is not divided. Parts in
 * planes of any orientation replace those at an end of the body only if the
 * latter are not plane. */
static void find_parts(const struct holes *h, size_t n, const uint32_t *loop,
                       struct vg_rim_parts *p)
{
  const struct vg_rim_loop l = { n, (const double(*)[3])h->m.point, loop,
                                 h->apex };

  p->n_part = 1;
  if (is_flat(h, n, loop, ONE_PLANE)) return;
  if (find_parts_at_end(h, n, loop, p) &&
      vg_rim_parts_are_flat(&l, p, ONE_PLANE))
    return;
  vg_rim_parts_find(&l, ONE_PLANE, p);
}

static vg_status close_rim(struct holes *h, uint32_t k,
                           const struct vg_size_function *law, size_t *n_cap,
                           struct vg_error *err)
{
  uint32_t p = h->rim[k].first, *loop = NULL;
  struct vg_rim_parts parts = { 0 };
  size_t n = 0, cap = 0;
  vg_status st = VG_OK;

  do {
    if (vg_reserve(&loop, &cap, n + 1, sizeof *loop))
      VG_TRY(vg_fail_memory(err, "the cap of a rim"));
    loop[n++] = p;
    p = h->next[p];
  } while (p != h->rim[k].first);
  find_parts(h, n, loop, &parts);
  st = parts.n_part > 1 ? close_divided(h, n, loop, &parts, law, n_cap, err)
                        : close_loop(h, n, loop, law, n_cap, err);
done:
  free(loop);
  return st;
}

/* Third points of the triangles at the rims. */
static void find_apexes(struct holes *h)
{
  const size_t n_given = h->m.n_point;

  for (size_t i = 0; i < n_given; i++) h->apex[i] = UINT32_MAX;
  for (size_t t = 0; t < h->m.n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const uint32_t *v = h->m.tri[t], a = v[(k + 1) % 3];

      if (h->next[a] == v[k]) h->apex[a] = v[(k + 2) % 3];
    }
}

static vg_status prepare(struct holes *h, struct vg_error *err)
{
  double length = 0;
  vg_status st;

  vg_mesh_bounds(&h->m, h->lo, h->hi);
  for (int k = 0; k < 3; k++) length = fmax(length, h->hi[k] - h->lo[k]);
  h->tolerance = VG_PLANE_TOLERANCE * length;
  h->length = length;
  VG_TRY(vg_open_edges(&h->m, &h->open, err));
  h->next = vg_alloc(h->m.n_point, sizeof *h->next);
  h->loop = vg_alloc(h->m.n_point, sizeof *h->loop);
  h->apex = vg_alloc(h->m.n_point, sizeof *h->apex);
  h->rim = vg_alloc(h->open.n, sizeof *h->rim);
  if (!h->next || !h->loop || !h->apex || !h->rim)
    return vg_fail_memory(err, "the holes of the surface");
  VG_TRY(follow_rims(h, err));
  find_apexes(h);
done:
  return st;
}

static void release(struct holes *h)
{
  vg_mesh_release(&h->m);
  vg_border_release(&h->open);
  free(h->next);
  free(h->loop);
  free(h->apex);
  free(h->rim);
}

vg_status vg_domain_close_holes(struct vg_mesh *surface, int symmetry,
                                const struct vg_sizing *sizing,
                                struct vg_cap_report *report,
                                struct vg_error *err)
{
  assert(sizing && report);

  struct holes h = { .n_loop = 0 };
  const struct vg_size_function law = vg_size_function_of(sizing);
  vg_status st;

  *report = (struct vg_cap_report){ 0 };
  VG_TRY(vg_mesh_copy(&h.m, surface, err));
  VG_TRY(prepare(&h, err));
  VG_TRY(keep_symmetry(&h, symmetry, err));
  for (uint32_t k = 0; k < h.n_loop; k++) {
    if (h.rim[k].stays) continue;
    VG_TRY(close_rim(&h, k, &law, &report->n, err));
  }
  report->n_tri = h.m.n_tri - surface->n_tri;
  report->n_curved = h.n_curved;
  vg_mesh_move(surface, &h.m);
done:
  release(&h);
  return st;
}

static struct vg_rim measure_rim(const struct holes *h, uint32_t k)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };
  struct vg_rim r = { .axis = -1 };
  uint32_t p = h->rim[k].first;
  const double *first = h->m.point[p];
  double u[3], v[3], n[3];

  do {
    vg_sub(h->m.point[p], first, u);
    vg_sub(h->m.point[h->next[p]], first, v);
    vg_cross(u, v, n);
    for (int d = 0; d < 3; d++) r.normal[d] += n[d];
    for (int d = 0; d < 3; d++) {
      lo[d] = fmin(lo[d], h->m.point[p][d]);
      hi[d] = fmax(hi[d], h->m.point[p][d]);
    }
    r.n_edge++;
    p = h->next[p];
  } while (p != h->rim[k].first);
  for (int d = 0; d < 3; d++) {
    r.centre[d] = 0.5 * (lo[d] + hi[d]);
    r.width = fmax(r.width, hi[d] - lo[d]);
    if (hi[d] - lo[d] <= h->tolerance) r.axis = d;
  }
  vg_unit(r.normal);
  return r;
}

vg_status vg_domain_rims(const struct vg_mesh *surface, size_t *n,
                         struct vg_rim **rim, struct vg_error *err)
{
  assert(n && rim);

  struct holes h = { .m = *surface };
  vg_status st;

  VG_TRY(prepare(&h, err));
  *rim = vg_alloc(h.n_loop, sizeof **rim);
  if (!*rim) VG_TRY(vg_fail_memory(err, "the rims of the surface"));
  for (uint32_t k = 0; k < h.n_loop; k++) (*rim)[k] = measure_rim(&h, k);
  *n = h.n_loop;
done:
  h.m = (struct vg_mesh)VG_MESH_INIT; /* borrowed from the caller */
  release(&h);
  return st;
}
