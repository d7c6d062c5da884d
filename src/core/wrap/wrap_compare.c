/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Compares the input with its wrap: is a part of the input missing, and is the
 * wrap a hollow shell? */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/wrap/wrap_parts.h"

#define REACH 1.5      /* offsets: input deeper inside is enclosed */
#define PIECES 8       /* most pieces of an edge */
#define SIDES 20000    /* approximate number of samples with examined sides */
#define STAND_OFF 5.0  /* S70: offsets: distance of a side from its sample */
#define START 0.01     /* offsets: start of the segment to a side */
#define HOLLOW 0.5     /* S70: share of sheets that makes a hollow shell */
#define LEAK 0.2       /* S70: the same for a part that should be a body */
#define LEAK_WIDE 0.03 /* S70: for a part with lids above WIDE of its area */
#define WIDE 0.005
#define COARSER 1.6 /* S71: factor of the size suggested for narrow rims */
#define MINOR 0.01  /* S70: of the area: smaller parts are ignored */

/* Sample points of the input; the first n_centre are centroids of pieces. */
struct samples {
  double (*x)[3], (*foot)[3];
  uint32_t *tri, *near; /* [n_centre] Triangle of the input; [n] nearest
                           triangle of the wrap. */
  double *area;         /* [n_centre] Area of the piece. */
  uint8_t *state;       /* [n] ON, INSIDE or OUTSIDE. */
  size_t n, n_centre;
};
enum { ON, INSIDE, OUTSIDE };

static void samples_release(struct samples *s)
{
  free(s->x);
  free(s->foot);
  free(s->tri);
  free(s->near);
  free(s->area);
  free(s->state);
}

static size_t pieces(const struct vg_mesh *m, size_t i, double size)
{
  double longest = 0;

  for (int k = 0; k < 3; k++)
    longest = fmax(longest, vg_distance(m->point[m->tri[i][k]],
                                        m->point[m->tri[i][(k + 1) % 3]]));
  return (size_t)fmin(PIECES, fmax(1, ceil(longest / size)));
}

static void normal_of(const struct vg_mesh *m, size_t i, double n[3])
{
  double u[3], v[3];

  vg_sub(m->point[m->tri[i][1]], m->point[m->tri[i][0]], u);
  vg_sub(m->point[m->tri[i][2]], m->point[m->tri[i][0]], v);
  vg_cross(u, v, n);
}

static void place(const struct vg_mesh *m, size_t i, double a, double b,
                  double x[3])
{
  const uint32_t *t = m->tri[i];

  for (int k = 0; k < 3; k++)
    x[k] = (1 - a - b) * m->point[t[0]][k] + a * m->point[t[1]][k] +
           b * m->point[t[2]][k];
}

/* Add the centroids of the n^2 similar pieces of triangle i. */
static void add_centres(const struct vg_mesh *m, size_t i, size_t n,
                        struct samples *s)
{
  double normal[3], h = 1 / (3 * (double)n);

  normal_of(m, i, normal);
  for (size_t p = 0; p < n; p++)
    for (size_t q = 0; p + q < n; q++)
      for (int down = 0; down < 2 - (p + q + 1 == n); down++) {
        place(m, i, (3 * (double)p + 1 + down) * h,
              (3 * (double)q + 1 + down) * h, s->x[s->n]);
        s->area[s->n] = vg_norm(normal) / 2 / (double)(n * n);
        s->tri[s->n++] = (uint32_t)i;
      }
}

static vg_status take_samples(const struct vg_mesh *m, double size,
                              struct samples *s, struct vg_error *err)
{
  size_t n = 0, cap;

  for (size_t i = 0; i < m->n_tri; i++)
    n += pieces(m, i, size) * pieces(m, i, size);
  cap = n + m->n_point + 3 * m->n_tri;
  s->x = vg_alloc(cap, sizeof *s->x);
  s->foot = vg_alloc(cap, sizeof *s->foot);
  s->near = vg_alloc(cap, sizeof *s->near);
  s->state = vg_calloc(cap, 1);
  s->tri = vg_alloc(n, sizeof *s->tri);
  s->area = vg_alloc(n, sizeof *s->area);
  if (!s->x || !s->foot || !s->near || !s->state || !s->tri || !s->area)
    return vg_fail_memory(err, "a wrap");
  for (size_t i = 0; i < m->n_tri; i++)
    add_centres(m, i, pieces(m, i, size), s);
  s->n_centre = s->n;
  memcpy(s->x + s->n, m->point, m->n_point * sizeof *s->x);
  s->n += m->n_point;
  for (size_t i = 0; i < m->n_tri; i++) {
    if (pieces(m, i, size) == 1) continue;
    place(m, i, 0.5, 0, s->x[s->n++]);
    place(m, i, 0, 0.5, s->x[s->n++]);
    place(m, i, 0.5, 0.5, s->x[s->n++]);
  }
  return VG_OK;
}

/* Classify samples farther than `least` from the wrap as inside or outside. */
static vg_status find_states(struct samples *s, const struct vg_mesh *out,
                             double least, const struct vg_stop *stop,
                             struct vg_error *err)
{
  double(*x)[3] = vg_alloc(s->n, sizeof *x);
  uint8_t *outside = vg_alloc(s->n, 1);
  size_t n = 0;
  vg_status st;

  if (!x || !outside) VG_TRY(vg_fail_memory(err, "a wrap"));
  for (size_t i = 0; i < s->n; i++)
    if (vg_distance(s->x[i], s->foot[i]) > least)
      memcpy(x[n++], s->x[i], sizeof *x);
  VG_TRY(vg_wrap_outside(out, n, (const double(*)[3])x, stop, outside, err));
  n = 0;
  for (size_t i = 0; i < s->n; i++)
    if (vg_distance(s->x[i], s->foot[i]) > least)
      s->state[i] = outside[n++] ? OUTSIDE : INSIDE;
done:
  free(x);
  free(outside);
  return st;
}

static void sum_up(const struct samples *s, double reach,
                   struct vg_wrap_report *r)
{
  double area = 0, inside = 0;

  for (size_t i = 0; i < s->n; i++) {
    double d = vg_distance(s->x[i], s->foot[i]);

    if (s->state[i] == OUTSIDE && d > r->missing) {
      r->missing = d;
      memcpy(r->missing_at, s->x[i], sizeof r->missing_at);
    }
    if (i >= s->n_centre) continue;
    area += s->area[i];
    if (s->state[i] == INSIDE && d > reach) inside += s->area[i];
  }
  r->inside = area > 0 ? inside / area : 0;
}

/* Both sides of every step-th sample: points close to it and at a distance. */
struct sides {
  double (*from)[3], (*to)[3]; /* [2 n] Two for each sample. */
  uint8_t *outside;            /* [2 n] 1: the side is outside the wrap. */
  uint32_t *blocked, *twice;   /* [2 n], [n] Numbers of triangles crossed by the
                                  segments from `from` to `to`, and by the
                                  segment from one side to the other. */
  size_t n, step;
};

static vg_status allocate_sides(const struct samples *s, struct sides *x,
                                struct vg_error *err)
{
  size_t cap;

  x->step = 1 + s->n_centre / SIDES;
  cap = s->n_centre / x->step + 1;
  x->from = vg_alloc(2 * cap, sizeof *x->from);
  x->to = vg_alloc(2 * cap, sizeof *x->to);
  x->outside = vg_alloc(2 * cap, 1);
  x->blocked = vg_alloc(2 * cap, sizeof *x->blocked);
  x->twice = vg_alloc(cap, sizeof *x->twice);
  if (!x->from || !x->to || !x->outside || !x->blocked || !x->twice)
    return vg_fail_memory(err, "a wrap");
  return VG_OK;
}

static void sides_release(struct sides *x)
{
  free(x->from);
  free(x->to);
  free(x->outside);
  free(x->blocked);
  free(x->twice);
}

static void place_sides(const struct vg_mesh *m, const struct samples *s,
                        double offset, struct sides *x)
{
  for (size_t i = 0; i < s->n_centre; i += x->step, x->n++) {
    double normal[3], length;

    normal_of(m, s->tri[i], normal);
    length = vg_norm(normal);
    for (size_t side = 0; side < 2; side++)
      for (int k = 0; k < 3; k++) {
        double d = length > 0 ? offset * normal[k] / length : 0;

        if (side) d = -d;
        x->from[2 * x->n + side][k] = s->x[i][k] + START * d;
        x->to[2 * x->n + side][k] = s->x[i][k] + STAND_OFF * d;
      }
  }
}

/* Kind of a sample: on the skin of a body, on a sheet, or on a sheet that the
 * input contains twice. */
enum { BODY, SHEET, DOUBLED, KINDS };

/* Sum up the areas of each part by kind. A thin body is not mistaken for a
 * sheet: its opposite skin blocks the segment to the other side. */
static vg_status find_sheets(const struct vg_wrap_rims *rims,
                             const struct samples *s, const struct vg_mesh *out,
                             double offset, const struct vg_stop *stop,
                             double (*area)[KINDS], struct vg_error *err)
{
  const struct vg_mesh *m = &rims->m;
  struct sides x = { .n = 0 };
  vg_status st;

  VG_TRY(allocate_sides(s, &x, err));
  place_sides(m, s, offset, &x);
  VG_TRY(vg_wrap_outside(out, 2 * x.n, (const double(*)[3])x.to, stop,
                         x.outside, err));
  VG_TRY(vg_wrap_crossings(m, 2 * x.n, (const double(*)[3])x.from,
                           (const double(*)[3])x.to, stop, x.blocked, err));
  for (size_t i = 0; i < x.n; i++) {
    memcpy(x.to[i], x.from[2 * i + 1], sizeof *x.to);
    memmove(x.from[i], x.from[2 * i], sizeof *x.from);
  }
  VG_TRY(vg_wrap_crossings(m, x.n, (const double(*)[3])x.from,
                           (const double(*)[3])x.to, stop, x.twice, err));
  for (size_t i = 0; i < x.n; i++) {
    size_t at = i * x.step;
    int wet[2];

    for (size_t k = 0; k < 2; k++)
      wet[k] = x.outside[2 * i + k] && !x.blocked[2 * i + k];
    if (wet[0] || wet[1])
      area[rims->part_of[s->tri[at]]][!(wet[0] && wet[1]) ? BODY
                                      : x.twice[i] > 1    ? DOUBLED
                                                       : SHEET] += s->area[at];
  }
done:
  sides_release(&x);
  return st;
}

static vg_status refuse(const struct vg_wrap_rims *rims, double size,
                        double share, int is_pocket, struct vg_error *err)
{
  struct vg_wrap_forecast f = vg_wrap_count(rims, size);

  if (!is_pocket)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "the wrap of size %g is a hollow shell with fluid on both "
                   "sides of %.0f %% of its walls: the surface consists of "
                   "sheets without thickness (%zu parts, of which %zu are "
                   "open), and gaps between them are wider than the size. "
                   "Take a larger size, or give the sheets a thickness",
                   size, 100 * share, f.n_part, f.n_open);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the wrap of size %g goes through the "
                 "holes of the surface and is a hollow shell with fluid inside "
                 "it, on both sides of %.0f %% of its walls: holes are up to "
                 "%.3g wide, the widest at (%.6g, %.6g, %.6g). Close them "
                 "(close_holes yes), or take a wrap of size > %.3g, which "
                 "closes them",
                 size, 100 * share, f.widest, f.at[0], f.at[1], f.at[2],
                 fmax(f.widest, COARSER * size));
}

/* The wrap is hollow if half of all walls are sheets, or a large fraction of a
 * part that should be a body. */
static vg_status judge_sheets(const struct vg_wrap_rims *rims,
                              const double (*area)[KINDS], double size,
                              struct vg_wrap_report *r, struct vg_error *err)
{
  double all = 0, sheets = 0, worst = 0;

  for (size_t i = 0; i < rims->n_part; i++) {
    sheets += area[i][SHEET] + area[i][DOUBLED];
    all += area[i][BODY] + area[i][SHEET] + area[i][DOUBLED];
  }
  r->sheet = all > 0 ? sheets / all : 0;
  for (size_t i = 0; i < rims->n_part; i++) {
    const struct vg_wrap_part *p = &rims->part[i];
    const double *x = area[i];
    double own = x[BODY] + x[SHEET] + x[DOUBLED];
    double most = p->lid > WIDE * p->area ? LEAK_WIDE : LEAK;

    if (p->is_pocket && own > MINOR * all && x[SHEET] > most * own)
      worst = fmax(worst, x[SHEET] / own);
  }
  if (worst > 0) return refuse(rims, size, worst, 1, err);
  if (r->sheet > HOLLOW) return refuse(rims, size, r->sheet, 0, err);
  return VG_OK;
}

vg_status vg_wrap_compare(const struct vg_wrap_rims *rims,
                          const struct vg_mesh *out, double size,
                          const struct vg_stop *stop, struct vg_wrap_report *r,
                          struct vg_error *err)
{
  assert(size > 0 && r);

  struct samples s = { 0 };
  double(*area)[KINDS] = vg_calloc(rims->n_part, sizeof *area);
  vg_status st;

  if (!area) VG_TRY(vg_fail_memory(err, "a wrap"));
  VG_TRY(take_samples(&rims->m, size, &s, err));
  VG_TRY(vg_wrap_nearest(out, s.n, (const double(*)[3])s.x, stop, s.foot,
                         s.near, err));
  VG_TRY(find_states(&s, out, 1e-3 * r->offset, stop, err));
  sum_up(&s, REACH * r->offset, r);
  VG_TRY(find_sheets(rims, &s, out, r->offset, stop, area, err));
  st = judge_sheets(rims, (const double(*)[KINDS])area, size, r, err);
done:
  samples_release(&s);
  free(area);
  return st;
}
