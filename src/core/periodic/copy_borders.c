/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Corresponding borders of periodic patches. Declared in
 * core/periodic/copy_parts.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "core/periodic/copy_parts.h"
#include "core/periodic/near_points.h"

#define NONE VG_PERIODIC_NONE
/* S121: cosine of the angle of feature edges and of turns of a border. */
#define SHARP 0.766

/* --- borders and corners -------------------------------------------------- */

static int32_t id_of(const struct vg_mesh *m, uint32_t half)
{
  return m->patch[m->tri_patch[half / 3]].id;
}

static void normal_of(const struct vg_mesh *m, uint32_t t, double n[3])
{
  double u[3], v[3];

  vg_sub(m->point[m->tri[t][1]], m->point[m->tri[t][0]], u);
  vg_sub(m->point[m->tri[t][2]], m->point[m->tri[t][0]], v);
  vg_cross(u, v, n);
  vg_unit(n);
}

/* Whether feature curves may run along the edge between two triangles. */
static int is_feature(const struct vg_mesh *m, uint32_t s, uint32_t t)
{
  double a[3], b[3];

  if (m->tri_patch[s] != m->tri_patch[t]) return 1;
  normal_of(m, s, a);
  normal_of(m, t, b);
  return vg_dot(a, b) < SHARP;
}

static vg_status tangled(const struct vg_borders *b, int side, uint32_t point,
                         struct vg_error *err)
{
  const double *x = b->m->point[point];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "periodic: the border of patch %d touches itself at (%.6g, "
                 "%.6g, %.6g), so that its image cannot be made; divide the "
                 "patch there",
                 (int)(side ? b->p->image : b->p->patch), x[0], x[1], x[2]);
}

/* Half-edge h, of a triangle of the patch, is on the border. */
static vg_status add_half(struct vg_borders *b, int side, uint32_t h,
                          struct vg_error *err)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])b->m->tri;
  const uint32_t u = vg_half_from(tri, h), v = vg_half_to(tri, h);
  const uint32_t at = side ? v : u;

  if (b->next[side][at] != NONE) return tangled(b, side, at, err);
  b->next[side][at] = side ? u : v;
  return VG_OK;
}

static vg_status add_edge(struct vg_borders *b, const struct vg_edges *e,
                          size_t i, struct vg_error *err)
{
  const uint32_t *h = &e->half[e->start[i]];
  const uint32_t n = vg_edges_count(e, i);
  vg_status st = VG_OK;

  for (int side = 0; side < 2 && st >= 0; side++) {
    const int32_t id = side ? b->p->image : b->p->patch;
    uint32_t n_own = 0, own = 0;

    for (uint32_t k = 0; k < n; k++)
      if (id_of(b->m, h[k]) == id) {
        n_own++;
        own = h[k];
      }
    if (n > 2 && n_own)
      return tangled(b, side,
                     vg_half_from((const uint32_t(*)[3])b->m->tri, own), err);
    if (n_own == 1) st = add_half(b, side, own, err);
    if (n_own || (n == 2 && !is_feature(b->m, h[0] / 3, h[1] / 3))) continue;
    b->corner[side][vg_half_from((const uint32_t(*)[3])b->m->tri, h[0])] = 1;
    b->corner[side][vg_half_to((const uint32_t(*)[3])b->m->tri, h[0])] = 1;
  }
  return st;
}

/* Marks points at which a border turns. */
static void mark_turns(struct vg_borders *b, int side)
{
  for (uint32_t i = 0; i < b->m->n_point; i++) {
    const uint32_t j = b->next[side][i];
    double u[3], v[3];

    if (j == NONE || b->next[side][j] == NONE) continue;
    vg_sub(b->m->point[j], b->m->point[i], u);
    vg_sub(b->m->point[b->next[side][j]], b->m->point[j], v);
    vg_unit(u);
    vg_unit(v);
    if (vg_dot(u, v) < SHARP) b->corner[side][j] = 1;
  }
}

vg_status vg_borders_find(const struct vg_mesh *m, const struct vg_periodic *p,
                          struct vg_borders *b, struct vg_error *err)
{
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st = VG_OK;

  *b = (struct vg_borders){ .m = m, .p = p };
  b->next[0] = vg_alloc(4 * m->n_point, sizeof *b->next[0]);
  b->corner[0] = vg_calloc(2 * m->n_point, 1);
  if (!b->next[0] || !b->corner[0])
    VG_TRY(vg_fail_memory(err, "the periodic patches"));
  memset(b->next[0], 0xff, 4 * m->n_point * sizeof *b->next[0]);
  b->next[1] = b->next[0] + m->n_point;
  b->to = b->next[1] + m->n_point;
  b->from = b->to + m->n_point;
  b->corner[1] = b->corner[0] + m->n_point;
  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, (const uint32_t(*)[3])m->tri,
                        NULL, 0, err));
  for (size_t i = 0; i < e.n; i++) VG_TRY(add_edge(b, &e, i, err));
  for (int side = 0; side < 2; side++) mark_turns(b, side);
done:
  vg_edges_release(&e);
  return st;
}

void vg_borders_release(struct vg_borders *b)
{
  free(b->next[0]);
  free(b->corner[0]);
  memset(b, 0, sizeof *b);
}

/* --- partners ------------------------------------------------------------- */

static vg_status plant(struct vg_near_points *border, const struct vg_mesh *m,
                       const uint32_t *next, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (uint32_t i = 0; i < m->n_point; i++)
    if (next[i] != NONE) VG_TRY(vg_near_points_add(border, i, err));
  st = vg_near_points_build(border, m, err);
done:
  return st;
}

static vg_status no_partner(const struct vg_borders *b, int side, uint32_t i,
                            double distance, double tolerance,
                            struct vg_error *err)
{
  const double *x = b->m->point[i];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "periodic: patches %d and %d do not match: a corner of the "
                 "border of patch %d, at (%.6g, %.6g, %.6g), is %.3g from the "
                 "nearest border point of the other patch, and at most %.3g is "
                 "allowed; make the patches images of each other, or correct "
                 "the transform",
                 (int)b->p->patch, (int)b->p->image,
                 (int)(side ? b->p->image : b->p->patch), x[0], x[1], x[2],
                 distance, tolerance);
}

/* Pairs the corners of a side. */
static vg_status pair_side(struct vg_borders *b, int side,
                           const struct vg_near_points *other, double tolerance,
                           int is_strict, struct vg_error *err)
{
  const struct vg_periodic back = vg_periodic_reverse(b->p);
  uint32_t *mine = side ? b->from : b->to, *its = side ? b->to : b->from;
  double worst = 0;
  uint32_t worst_at = NONE;

  for (uint32_t i = 0; i < b->m->n_point; i++) {
    uint32_t j;
    double x[3], d2;

    if (b->next[side][i] == NONE || mine[i] != NONE) continue;
    if (b->next[!side][i] != NONE) {
      mine[i] = its[i] = i;
      continue;
    }
    if (!b->corner[side][i]) continue;
    vg_periodic_image(side ? &back : b->p, b->m->point[i], x);
    j = vg_near_points_find(other, x, &d2);
    if (j != NONE && d2 <= tolerance * tolerance && its[j] == NONE) {
      mine[i] = j;
      its[j] = i;
    } else if (worst_at == NONE || d2 > worst) {
      worst = d2;
      worst_at = i;
    }
  }
  return is_strict && worst_at != NONE
         ? no_partner(b, side, worst_at, sqrt(worst), tolerance, err)
         : VG_OK;
}

/* The first point of each loop of the patch without a pair, and the nearest
 * point of the other border, become a pair. */
static vg_status pair_loops(struct vg_borders *b,
                            const struct vg_near_points *other,
                            struct vg_error *err)
{
  uint8_t *seen = vg_calloc(b->m->n_point, 1);

  if (!seen) return vg_fail_memory(err, "the periodic patches");
  for (uint32_t i = 0; i < b->m->n_point; i++) {
    uint32_t k = i;
    int has_pair = 0;
    double x[3], d2;

    if (b->next[0][i] == NONE || seen[i]) continue;
    for (; k != NONE && !seen[k]; k = b->next[0][k]) {
      seen[k] = 1;
      has_pair |= b->to[k] != NONE;
    }
    if (has_pair) continue;
    vg_periodic_image(b->p, b->m->point[i], x);
    k = vg_near_points_find(other, x, &d2);
    if (k == NONE || b->from[k] != NONE) continue;
    b->to[i] = k;
    b->from[k] = i;
  }
  free(seen);
  return VG_OK;
}

vg_status vg_borders_pair(struct vg_borders *b, double tolerance, int is_strict,
                          struct vg_error *err)
{
  struct vg_near_points f[2] = { VG_NEAR_POINTS_INIT, VG_NEAR_POINTS_INIT };
  vg_status st = VG_OK;

  for (int side = 0; side < 2; side++)
    VG_TRY(plant(&f[side], b->m, b->next[side], err));
  for (int side = 0; side < 2; side++)
    VG_TRY(pair_side(b, side, &f[!side], tolerance, is_strict, err));
  if (is_strict) VG_TRY(pair_loops(b, &f[1], err));
done:
  for (int side = 0; side < 2; side++) vg_near_points_release(&f[side]);
  return st;
}

/* --- pieces --------------------------------------------------------------- */

/* The points of a border between two pairs, with their shares of the length. */
struct course {
  size_t n, cap, cap_share;
  uint32_t *point;
  double *share;
};

static vg_status follow(const struct vg_borders *b, int side, uint32_t start,
                        struct course *c, uint32_t *end, struct vg_error *err)
{
  const uint32_t *partner = side ? b->from : b->to;
  double length = 0;
  uint32_t i = start;

  c->n = 0;
  for (;;) {
    const uint32_t j = b->next[side][i];

    if (j == NONE || c->n > b->m->n_point) return tangled(b, side, i, err);
    length += vg_distance(b->m->point[i], b->m->point[j]);
    i = j;
    if (partner[i] != NONE) break;
    if (vg_reserve(&c->point, &c->cap, c->n + 1, sizeof *c->point) < 0 ||
        vg_reserve(&c->share, &c->cap_share, c->n + 1, sizeof *c->share) < 0)
      return vg_fail_memory(err, "the periodic patches");
    c->point[c->n] = i;
    c->share[c->n++] = length;
  }
  for (size_t k = 0; k < c->n; k++) c->share[k] /= length;
  *end = i;
  return VG_OK;
}

/* The point of c nearest to the share s, of the two around `at`, the first one
 * beyond s. */
static size_t nearest_in(const struct course *c, size_t at, double s)
{
  if (at == c->n) return at ? at - 1 : SIZE_MAX;
  if (!at || c->share[at] - s < s - c->share[at - 1]) return at;
  return at - 1;
}

static size_t beyond(const struct course *c, double s)
{
  size_t lo = 0, hi = c->n;

  while (lo < hi) {
    const size_t mid = (lo + hi) / 2;

    if (c->share[mid] > s) hi = mid;
    else lo = mid + 1;
  }
  return lo;
}

static vg_status add_point(struct vg_border_pieces *out, uint32_t a, uint32_t b,
                           struct vg_error *err)
{
  if (vg_reserve(&out->point, &out->cap, out->n + 1, sizeof *out->point) < 0)
    return vg_fail_memory(err, "the periodic patches");
  out->point[out->n++] = (struct vg_border_point){ a, b };
  return VG_OK;
}

/* Joins points that are nearest to each other, and puts all in order. */
static vg_status merge(const struct course c[2], struct vg_border_pieces *out,
                       struct vg_error *err)
{
  size_t i = 0, j = 0;
  vg_status st = VG_OK;

  while ((i < c[0].n || j < c[1].n) && st >= 0) {
    const size_t i_to = i < c[0].n
                        ? nearest_in(&c[1], beyond(&c[1], c[0].share[i]),
                                     c[0].share[i])
                        : SIZE_MAX;
    const size_t j_to = j < c[1].n
                        ? nearest_in(&c[0], beyond(&c[0], c[1].share[j]),
                                     c[1].share[j])
                        : SIZE_MAX;

    if (i < c[0].n && j < c[1].n && i_to == j && j_to == i)
      st = add_point(out, c[0].point[i++], c[1].point[j++], err);
    else if (j == c[1].n || (i < c[0].n && i_to < j))
      st = add_point(out, c[0].point[i++], NONE, err);
    else if (i == c[0].n || j_to < i || c[1].share[j] < c[0].share[i])
      st = add_point(out, NONE, c[1].point[j++], err);
    else st = add_point(out, c[0].point[i++], NONE, err);
  }
  return st;
}

static vg_status crossed(const struct vg_borders *b, int side, uint32_t i,
                         struct vg_error *err)
{
  const double *x = b->m->point[i];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "periodic: patches %d and %d do not match: their borders "
                 "differ near (%.6g, %.6g, %.6g) of patch %d; make the patches "
                 "images of each other, with the same holes and corners",
                 (int)b->p->patch, (int)b->p->image, x[0], x[1], x[2],
                 (int)(side ? b->p->image : b->p->patch));
}

static vg_status divide_from(const struct vg_borders *b, uint32_t i,
                             struct course c[2], struct vg_border_pieces *out,
                             struct vg_error *err)
{
  uint32_t end[2] = { NONE, NONE };
  vg_status st;

  VG_TRY(follow(b, 0, i, &c[0], &end[0], err));
  VG_TRY(follow(b, 1, b->to[i], &c[1], &end[1], err));
  if (b->to[end[0]] != end[1]) return crossed(b, 0, i, err);
  VG_TRY(add_point(out, i, b->to[i], err));
  VG_TRY(merge(c, out, err));
  VG_TRY(add_point(out, end[0], end[1], err));
  if (vg_reserve(&out->end, &out->cap_piece, out->n_piece + 1,
                 sizeof *out->end) < 0)
    VG_TRY(vg_fail_memory(err, "the periodic patches"));
  out->end[out->n_piece++] = out->n;
done:
  return st;
}

/* Each point of both borders must be in a piece. */
static vg_status check_whole(const struct vg_borders *b,
                             const struct vg_border_pieces *pieces,
                             struct vg_error *err)
{
  const size_t n = b->m->n_point;
  uint8_t *seen = vg_calloc(2 * n, 1);
  vg_status st = VG_OK;

  if (!seen) return vg_fail_memory(err, "the periodic patches");
  for (size_t i = 0; i < pieces->n; i++) {
    if (pieces->point[i].a != NONE) seen[pieces->point[i].a] = 1;
    if (pieces->point[i].b != NONE) seen[n + pieces->point[i].b] = 1;
  }
  for (int side = 0; side < 2; side++)
    for (uint32_t i = 0; i < n && st >= 0; i++)
      if (b->next[side][i] != NONE && !seen[(size_t)side * n + i])
        st = crossed(b, side, i, err);
  free(seen);
  return st;
}

vg_status vg_borders_divide(struct vg_borders *b, struct vg_border_pieces *out,
                            struct vg_error *err)
{
  struct course c[2] = { { 0 }, { 0 } };
  vg_status st = VG_OK;

  for (uint32_t i = 0; i < b->m->n_point; i++)
    if (b->next[0][i] != NONE && b->to[i] != NONE)
      VG_TRY(divide_from(b, i, c, out, err));
  VG_TRY(check_whole(b, out, err));
done:
  for (int side = 0; side < 2; side++) {
    free(c[side].point);
    free(c[side].share);
  }
  return st;
}
