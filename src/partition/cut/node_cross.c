/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Detects changes that cross the front. Outline: a zone is given the front
 * within a band around its planes, whose width is a number of local spacings,
 * and it keeps cells by their corners. A long cell can leave that band between
 * its corners, where the spacing is smaller, and pass through a front that the
 * zone does not know. Its new faces outside the band are few; they are tested
 * against the whole front, as it was before the stage.
 *
 * A small body may be completely inside such cells, and intersect no face.
 * Seen from the body straight away from the plane, the band ends before the
 * cells do, since the foot point and so the band width stay constant. The body
 * is therefore between the plane and a face around the cells, new or gone,
 * that leaves the band. Points there that the zone was not given must be
 * outside all faces around its cells. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/geometry/triangles.h"
#include "partition/cut/node.h"

/* --- faces that leave the band ------------------------------------------- */

/* Position of the last spacing query, which also bounds the spacing at nearby
 * faces. */
struct band {
  const struct vg_region *region;
  const struct vg_sizing *sizing;
  double width, slope; /* Band width in spacings; slope of the sizing field. */
  double x[3], h;
};

/* Is no point of a triangle farther from the planes than `most`, by the cached
 * spacing? The feet of two points are no farther apart than the points. */
static int is_within(const struct band *b, const double *const x[3],
                     double most)
{
  double far2 = 0;

  for (int i = 0; i < 3; i++) {
    double d2 = 0;

    for (int k = 0; k < 3; k++) d2 += (x[i][k] - b->x[k]) * (x[i][k] - b->x[k]);
    far2 = fmax(far2, d2);
  }
  return most <= b->width * (b->h - b->slope * sqrt(far2));
}

/* The same in a metric, by lower bounds of the spacings across the planes. */
static int is_within_metric(const struct band *b, const double *const x[3])
{
  const struct vg_region *r = b->region;
  struct vg_box box = VG_BOX_EMPTY;
  double low[VG_REGION_SIDES], high[VG_REGION_SIDES];

  for (int k = 0; k < 3; k++) vg_box_add(&box, x[k]);
  vg_region_across_within(r, b->sizing, box.lo, box.hi, low, high);
  for (int i = 0; i < r->n_plane; i++)
    for (int k = 0; k < 3; k++)
      if (fabs(vg_plane_side(&r->plane[i], x[k])) > b->width * low[i]) return 0;
  return 1;
}

/* Does the triangle stay within the known band? Also no in doubt. */
static int stays(struct band *b, const double *const x[3])
{
  const struct vg_region *r = b->region;
  double most = 0;

  if (vg_sizing_is_stretched(b->sizing)) return is_within_metric(b, x);
  for (int i = 0; i < r->n_plane; i++)
    for (int k = 0; k < 3; k++)
      most = fmax(most, fabs(vg_plane_side(&r->plane[i], x[k])));
  if (is_within(b, x, most)) return 1;
  for (int k = 0; k < 3; k++) b->x[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
  b->h = vg_region_spacing(r, b->sizing, b->x);
  return is_within(b, x, most);
}

/* --- faces that cross the front ------------------------------------------ */

struct crossing {
  const struct vg_node *n;
  size_t work, first; /* Its new points are in the front from here on. */
  const struct vg_filled *made; /* Result of the task. */
  uint32_t v[3];                /* The face being tested. */
};

/* Faces around the cells: new ones, then consumed ones. */
static size_t n_around(const struct crossing *c)
{
  return c->made->n_face + c->made->n_consumed;
}

static void face_around(const struct crossing *c, size_t k, uint32_t v[3])
{
  if (k < c->made->n_face) {
    for (int j = 0; j < 3; j++)
      v[j] = vg_node_point(c->n, c->work, c->first, c->made->face[k][j]);
  } else {
    uint32_t face = c->made->consumed[k - c->made->n_face];

    memcpy(v, c->n->front.face[c->n->face[c->work][face]], 3 * sizeof *v);
  }
}

/* Is the face gone because a cell of the zone has consumed it? */
static int is_gone(const struct crossing *c, uint32_t face)
{
  for (size_t k = 0; k < c->made->n_consumed; k++)
    if (c->n->face[c->work][c->made->consumed[k]] == face) return 1;
  return 0;
}

static int crosses(void *context, uint32_t face)
{
  const struct crossing *c = context;
  const struct vg_front *f = &c->n->front;
  const uint32_t *v = c->v, *w = f->face[face];
  int common = 0;

  for (int k = 0; k < 9; k++) common += v[k / 3] == w[k % 3];
  return common < 3 &&
         vg_triangles_meet((const double(*)[3])f->x, v, w, v, w) &&
         !is_gone(c, face);
}

/* --- bodies inside cells ------------------------------------------------- */

/* Length of the box around the cells, which bounds the length of a ray. */
static double size_of(const struct crossing *c)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY };
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY };

  for (size_t k = 0; k < n_around(c); k++) {
    uint32_t v[3];

    face_around(c, k, v);
    for (int j = 0; j < 9; j++) {
      lo[j % 3] = fmin(lo[j % 3], c->n->front.x[v[j / 3]][j % 3]);
      hi[j % 3] = fmax(hi[j % 3], c->n->front.x[v[j / 3]][j % 3]);
    }
  }
  return hi[0] - lo[0] + hi[1] - lo[1] + hi[2] - lo[2];
}

/* Faces around the cells projected along the first ray direction, listed by
 * the cells of a grid in which they may lie. */
struct shadow {
  double lo[2], per[2]; /* Corner; grid cells per length. */
  uint32_t n[2];
  uint32_t *first, *face; /* Faces of grid cell i: first[i] to first[i + 1]. */
};

struct body {
  const struct crossing *c;
  struct shadow shadow;
  double lo[3], hi[3]; /* Box that may contain it. */
  double size;         /* Length of the box around the cells. */
  uint8_t *is_beside;  /* [points of the front] 1: was given to the zone, or
                          is known to be outside the cells. */
};

/* Ray directions, oblique so that they seldom touch an edge. The projection is
 * kept for the first one, which is nearly always sufficient; its third
 * component is 1. */
static const double way[][3] = { { 0.4142, -0.2718, 1 },
                                 { -1.1, 0.5, 0.3 },
                                 { 0.3, -0.9, -0.8 },
                                 { 1.1, -0.2, 0.6 },
                                 { -0.6, -0.5, 1.2 } };

static void across(const double x[3], double u[2])
{
  for (int k = 0; k < 2; k++) u[k] = x[k] - way[0][k] * x[2];
}

/* Range of grid cells in which a face may lie: the margin of a thousandth of a
 * grid cell is far above the rounding error. */
static void shadow_of(const struct crossing *c, const struct shadow *s,
                      size_t k, uint32_t lo[2], uint32_t hi[2])
{
  double from[2] = { INFINITY, INFINITY }, to[2] = { -INFINITY, -INFINITY },
         u[2];
  uint32_t v[3];

  face_around(c, k, v);
  for (int i = 0; i < 3; i++) {
    across(c->n->front.x[v[i]], u);
    for (int j = 0; j < 2; j++) {
      from[j] = fmin(from[j], (u[j] - s->lo[j]) * s->per[j]);
      to[j] = fmax(to[j], (u[j] - s->lo[j]) * s->per[j]);
    }
  }
  for (int j = 0; j < 2; j++) {
    lo[j] = (uint32_t)fmin(fmax(from[j] - 1e-3, 0), s->n[j] - 1.0);
    hi[j] = (uint32_t)fmin(fmax(to[j] + 1e-3, 0), s->n[j] - 1.0);
  }
}

static void measure_shadow(const struct crossing *c, struct shadow *s)
{
  double hi[2] = { -INFINITY, -INFINITY }, u[2];
  double side = sqrt((double)n_around(c)) / 2 + 1;

  s->lo[0] = s->lo[1] = INFINITY;
  for (size_t k = 0; k < n_around(c); k++) {
    uint32_t v[3];

    face_around(c, k, v);
    for (int i = 0; i < 6; i++) {
      across(c->n->front.x[v[i / 2]], u);
      s->lo[i % 2] = fmin(s->lo[i % 2], u[i % 2]);
      hi[i % 2] = fmax(hi[i % 2], u[i % 2]);
    }
  }
  for (int j = 0; j < 2; j++) {
    s->n[j] = (uint32_t)fmin(side, 4096);
    s->per[j] = hi[j] > s->lo[j] ? s->n[j] / (hi[j] - s->lo[j]) : 0;
  }
}

static int make_shadow(const struct crossing *c, struct shadow *s)
{
  size_t n;

  measure_shadow(c, s);
  n = (size_t)s->n[0] * s->n[1];
  s->first = vg_calloc(n + 2, sizeof *s->first);
  if (!s->first) return -1;
  for (int fill = 0; fill < 2; fill++) {
    for (size_t k = 0; k < n_around(c); k++) {
      uint32_t lo[2], hi[2];

      shadow_of(c, s, k, lo, hi);
      for (uint32_t j = lo[1]; j <= hi[1]; j++)
        for (uint32_t i = lo[0]; i <= hi[0]; i++) {
          size_t at = (size_t)j * s->n[0] + i;

          if (fill) s->face[s->first[at + 1]++] = (uint32_t)k;
          else s->first[at + 2]++;
        }
    }
    if (fill) break;
    for (size_t i = 2; i < n + 2; i++) s->first[i] += s->first[i - 1];
    s->face = vg_alloc(s->first[n + 1], sizeof *s->face);
    if (!s->face) return -1;
  }
  return 0;
}

/* Called once per task, and only if a face leaves the band. */
static int prepare(struct body *b)
{
  const struct vg_node *n = b->c->n;
  const struct vg_change *change = &n->change[b->c->work];

  b->size = size_of(b->c);
  b->is_beside = vg_calloc(n->front.n_point, 1);
  if (!b->is_beside || make_shadow(b->c, &b->shadow)) return -1;
  for (size_t k = 0; k < change->n_part; k++)
    b->is_beside[n->point[b->c->work][k]] = 1;
  return 0;
}

/* Does the segment from x to y cross the triangle? -1: it touches its border,
 * or starts on it. */
static int passes(const double x[3], const double y[3],
                  const double *const t[3])
{
  int up = 0, down = 0, zero = 0;
  double from, to;

  for (int k = 0; k < 3; k++) {
    double side = vg_orient3d(x, y, t[k], t[(k + 1) % 3]);

    up |= side > 0;
    down |= side < 0;
    zero |= side == 0;
    if (up && down) return 0;
  }
  from = vg_orient3d(t[0], t[1], t[2], x);
  to = vg_orient3d(t[0], t[1], t[2], y);
  if ((from > 0 && to > 0) || (from < 0 && to < 0)) return 0;
  return zero || from == 0 || to == 0 ? -1 : 1;
}

/* Number of faces around the cells that the segment from x to y crosses; -1:
 * undecided. list: [n] faces to test, NULL: the first n. */
static int n_passed(const struct body *b, const double x[3], const double y[3],
                    size_t n, const uint32_t *list)
{
  int sum = 0;

  for (size_t i = 0; i < n; i++) {
    const double *t[3];
    uint32_t v[3];
    int one;

    face_around(b->c, list ? list[i] : i, v);
    for (int j = 0; j < 3; j++) t[j] = b->c->n->front.x[v[j]];
    one = passes(x, y, t);
    if (one < 0) return -1;
    sum += one;
  }
  return sum;
}

static int n_passed_in_shadow(const struct body *b, const double x[3],
                              const double y[3])
{
  const struct shadow *s = &b->shadow;
  size_t at[2];
  double u[2];

  across(x, u);
  for (int j = 0; j < 2; j++) {
    double f = (u[j] - s->lo[j]) * s->per[j];

    if (!(f > -1e-3 && f < s->n[j] + 1e-3)) return 0;
    at[j] = (size_t)fmin(fmax(f, 0), s->n[j] - 1.0);
  }
  at[0] += at[1] * s->n[0];
  return n_passed(b, x, y, s->first[at[0] + 1] - s->first[at[0]],
                  s->face + s->first[at[0]]);
}

/* Is x inside the cells? Exact, by the number of faces that a ray crosses. 1
 * if all rays are undecided. */
static int is_within_cells(const struct body *b, const double x[3])
{
  for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
    double y[3];
    int sum;

    for (int j = 0; j < 3; j++) y[j] = x[j] + 2 * b->size * way[k][j];
    sum = k ? n_passed(b, x, y, n_around(b->c), NULL)
            : n_passed_in_shadow(b, x, y);
    if (sum >= 0) return sum % 2;
  }
  return 1;
}

static int is_body(void *context, uint32_t face)
{
  struct body *b = context;
  const struct vg_front *f = &b->c->n->front;

  for (int k = 0; k < 3; k++) {
    uint32_t p = f->face[face][k];
    const double *x = f->x[p];
    int is_beside = b->is_beside[p];

    for (int j = 0; j < 3; j++) is_beside |= x[j] < b->lo[j] || x[j] > b->hi[j];
    if (is_beside) continue;
    if (is_within_cells(b, x)) return 1;
    b->is_beside[p] = 1;
  }
  return 0;
}

/* Is there a body between this face around the cells and the planes? */
static int holds_body(struct body *b, const struct vg_region *r,
                      const double *const x[3])
{
  const double *box[3] = { b->lo, b->hi,
                           b->lo }; /* flat: only its box is used */

  for (int k = 0; k < 3; k++) {
    b->lo[k] = fmin(x[0][k], fmin(x[1][k], x[2][k]));
    b->hi[k] = fmax(x[0][k], fmax(x[1][k], x[2][k]));
  }
  for (int i = 0; i < 3 * r->n_plane; i++) {
    const struct vg_plane *plane = &r->plane[i / 3];
    double side = vg_plane_side(plane, x[i % 3]);

    for (int k = 0; k < 3; k++) {
      double foot = x[i % 3][k] - side * plane->normal[k];

      b->lo[k] = fmin(b->lo[k], foot);
      b->hi[k] = fmax(b->hi[k], foot);
    }
  }
  return vg_select_touched(&b->c->n->select, box, is_body, b);
}

int vg_node_crosses(const struct vg_node *n, size_t i, size_t first)
{
  const struct vg_sizing *sizing = n->select.sizing;
  const struct vg_region *r = &n->region[i];
  struct crossing c = {
    .n = n, .work = i, .first = first, .made = &n->change[i].made
  };
  struct body body = { .c = &c };
  int found = 0;
  struct band b = { .region = r,
                    .sizing = sizing,
                    .width = vg_region_band(r, VG_BAND_FRONT) };

  assert(i < n->n_work && first <= n->front.n_point);
  if (!r->n_plane || !sizing) return 0;
  b.slope = vg_sizing_slope(sizing);
  for (size_t k = 0; k < n_around(&c) && !found; k++) {
    const double *x[3];

    face_around(&c, k, c.v);
    for (int j = 0; j < 3; j++) x[j] = n->front.x[c.v[j]];
    if (stays(&b, x)) continue;
    if (k < c.made->n_face && vg_select_touched(&n->select, x, crosses, &c))
      found = 1;
    else if (!body.is_beside && prepare(&body)) found = -1;
    else found = holds_body(&body, r, x);
  }
  free(body.is_beside);
  free(body.shadow.first);
  free(body.shadow.face);
  return found;
}
