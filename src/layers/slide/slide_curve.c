/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Columns that slide in two patches follow the common curve of the patches.
 * Points that a column passes are removed from the curve, and new points are
 * placed between its top and the next remaining point. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "layers/slide/slide_parts.h"

/* A curve that turns by more than 60 degrees at a point has a corner there,
 * which is preserved. */
#define CORNER 0.5 /* L14 */
/* Points farther from a top than this share of the local size remain, ... */
#define KEEP 0.5
/* ... and the end of the curve must be farther away than this share. */
#define LEAST 0.25

/* A curve from the root of a column to a corner. Edge i is a half-edge of patch
 * `left` from point i to point i + 1. */
struct chain {
  size_t n, cap, cap_s;
  uint32_t *v;
  double *s; /* Arc length up to each point. */
  uint32_t left, right;
};

static uint32_t patch_of(const struct vg_slide_work *w, uint32_t half)
{
  return w->m->tri_patch[half / 3];
}

static uint32_t head(const struct vg_slide_work *w, uint32_t half)
{
  return w->m->tri[half / 3][half % 3 < 2 ? half % 3 + 1 : 0];
}

/* The slide patch on the other side of half-edge a -> b, or VG_NO_INDEX. */
static uint32_t across(const struct vg_slide_work *w, uint32_t a, uint32_t b)
{
  const uint32_t t = vg_slide_twin(w, a, b);

  return t == VG_NO_INDEX ? t : patch_of(w, t);
}

static vg_status add_vertex(struct vg_slide_work *w, struct chain *c,
                            uint32_t v)
{
  double step = 0;

  if (vg_reserve(&c->v, &c->cap, c->n + 1, sizeof *c->v) ||
      vg_reserve(&c->s, &c->cap_s, c->n + 1, sizeof *c->s))
    return vg_fail_memory(w->err, "a curve between slide patches");
  if (c->n) step = vg_distance(w->m->point[c->v[c->n - 1]], w->m->point[v]);
  c->s[c->n] = c->n ? c->s[c->n - 1] + step : 0;
  c->v[c->n++] = v;
  return VG_OK;
}

static int is_corner(const struct vg_mesh *m, const uint32_t v[2], uint32_t r)
{
  double a[3], b[3];

  vg_sub(m->point[v[1]], m->point[v[0]], a);
  vg_sub(m->point[r], m->point[v[1]], b);
  return vg_dot(a, b) < CORNER * vg_norm(a) * vg_norm(b);
}

/* The only edge that continues the chain from its last point; VG_NO_INDEX at an
 * end. Points of sheets remain. */
static uint32_t next_vertex(const struct vg_slide_work *w,
                            const struct chain *c)
{
  const uint32_t q = c->v[c->n - 1];
  uint32_t next = VG_NO_INDEX;

  if (w->held && w->held[q]) return VG_NO_INDEX;
  for (uint32_t i = w->first[q]; i < w->first[q + 1]; i++) {
    const uint32_t r = head(w, w->half[i]);

    if (patch_of(w, w->half[i]) != c->left || across(w, q, r) != c->right)
      continue;
    if (next != VG_NO_INDEX) return VG_NO_INDEX;
    next = r;
  }
  if (next == VG_NO_INDEX || next == c->v[0] ||
      is_corner(w->m, &c->v[c->n - 2], next))
    return VG_NO_INDEX;
  return next;
}

/* The curve between patches a and b that starts at p; empty if there is
 * none. */
static vg_status follow(struct vg_slide_work *w, uint32_t p,
                        const uint32_t patch[2], struct chain *c)
{
  uint32_t next = VG_NO_INDEX;

  c->n = 0;
  for (uint32_t i = w->first[p]; i < w->first[p + 1]; i++) {
    const uint32_t q = head(w, w->half[i]), l = patch_of(w, w->half[i]);

    if (l != patch[0] && l != patch[1]) continue;
    if (across(w, p, q) != (l == patch[0] ? patch[1] : patch[0])) continue;
    c->left = l;
    c->right = l == patch[0] ? patch[1] : patch[0];
    next = q;
    break;
  }
  if (next == VG_NO_INDEX) return VG_OK;
  if (add_vertex(w, c, p)) return VG_ERR_MEMORY;
  while (next != VG_NO_INDEX) {
    if (add_vertex(w, c, next)) return VG_ERR_MEMORY;
    next = next_vertex(w, c);
  }
  return VG_OK;
}

/* Point at arc length s. Exact in a coordinate in which both ends of the edge
 * agree. */
static void on_chain(const struct vg_slide_work *w, const struct chain *c,
                     double s, double x[3])
{
  size_t i = 0;
  const double *a, *b;
  double t;

  while (i + 2 < c->n && c->s[i + 1] <= s) i++;
  a = w->m->point[c->v[i]];
  b = w->m->point[c->v[i + 1]];
  t = (s - c->s[i]) / (c->s[i + 1] - c->s[i]);
  for (int k = 0; k < 3; k++) x[k] = a[k] + t * (b[k] - a[k]);
}

/* Bends column i along the curve, with the distances of its levels measured
 * along the curve. *is_short is set if the curve is too short for the column.
 */
static vg_status bend(struct vg_slide_work *w, uint32_t i,
                      const struct chain *c, int *is_short)
{
  struct vg_columns *cs = w->c;
  struct vg_column *col = &cs->column[i];
  const double *root = w->m->point[col->root];
  double d[VG_LEVELS_MAX + 1], x[3];

  vg_growth_law_heights(&cs->law[col->law], col->cap, col->n, d);
  vg_column_at(col, root, d[col->n], x);
  *is_short = !(vg_distance(x, root) < c->s[c->n - 1]);
  if (*is_short) return VG_OK;
  if (vg_reserve(&cs->path, &w->cap_path, cs->n_path + col->n + 1,
                 sizeof *cs->path))
    return vg_fail_memory(w->err, "bent columns");
  memcpy(cs->path[cs->n_path], root, 3 * sizeof *root);
  for (int l = 1; l <= col->n; l++) {
    vg_column_at(col, root, d[l], x);
    on_chain(w, c, vg_distance(x, root), cs->path[cs->n_path + (size_t)l]);
  }
  col->bent = cs->n_path;
  cs->n_path += (size_t)col->n + 1;
  memcpy(w->x[w->m->n_point + i], cs->path[cs->n_path - 1], 3 * sizeof(double));
  return VG_OK;
}

/* Position of a top along the chain, and the first point beyond it that remains
 * (c->n - 1 at most). Returns -1 if the top is beyond the end. */
static int cut(const struct vg_slide_work *w, const struct chain *c,
               const double top[3], double h, double *s, size_t *keep)
{
  size_t i = 0;

  for (;; i++) {
    const double *a = w->m->point[c->v[i]];
    double e[3], d[3], t;

    vg_sub(w->m->point[c->v[i + 1]], a, e);
    vg_sub(top, a, d);
    t = vg_dot(d, e) / vg_dot(e, e);
    if (t >= 1 && i + 2 < c->n) continue;
    *s = c->s[i] + fmax(t, 0) * (c->s[i + 1] - c->s[i]);
    if (t >= 1) return -1;
    break;
  }
  for (*keep = i + 1; *keep + 1 < c->n; ++*keep)
    if (vg_distance(w->m->point[c->v[*keep]], top) >= KEEP * h) break;
  return 0;
}

/* Records a step, if a curve may have images. */
static vg_status record(struct vg_slide_work *w, struct vg_slide_step step)
{
  if (!w->image) return VG_OK;
  if (vg_reserve(&w->step, &w->cap_step, w->n_step + 1, sizeof *w->step))
    return vg_fail_memory(w->err, "curves between slide patches");
  w->step[w->n_step++] = step;
  return VG_OK;
}

/* Adds an edge of the new curve to the parts on both sides of chain edge i. */
static vg_status add_edge(struct vg_slide_work *w, const struct chain *c,
                          size_t i, uint32_t a, uint32_t b)
{
  const uint32_t left = vg_slide_twin(w, c->v[i + 1], c->v[i]);
  const uint32_t right = vg_slide_twin(w, c->v[i], c->v[i + 1]);

  if (vg_reserve(&w->edge, &w->cap_edge, w->n_edge + 2, sizeof *w->edge))
    return vg_fail_memory(w->err, "curves between slide patches");
  w->edge[w->n_edge++] = (struct vg_slide_edge){ w->part_of[left / 3],
                                                 { a, b } };
  w->edge[w->n_edge++] = (struct vg_slide_edge){ w->part_of[right / 3],
                                                 { b, a } };
  return record(w, (struct vg_slide_step){ 1, i, a, b });
}

static vg_status remove_edges(struct vg_slide_work *w, const struct chain *c,
                              size_t from, size_t to)
{
  if (vg_reserve(&w->gone, &w->cap_gone, w->n_gone + (to - from),
                 sizeof *w->gone))
    return vg_fail_memory(w->err, "curves between slide patches");
  for (size_t i = from; i < to; i++)
    w->gone[w->n_gone++] = vg_slide_key(c->v[i], c->v[i + 1]);
  return record(w,
                (struct vg_slide_step){ 0, 0, (uint32_t)from, (uint32_t)to });
}

/* An end of a gap in the curve. At a top, h is the length of the edges that
 * meet there, from which sizes change with the slope of the sizing field; h is
 * 0 at a remaining point. */
struct end {
  uint32_t v;
  double s, h;
};

/* Target edge length along the curve. */
static double size_at(const struct vg_slide_work *w, const struct chain *c,
                      const struct end end[2], double s)
{
  const double slope = vg_sizing_growth(w->sizing);
  double x[3], h;

  on_chain(w, c, s, x);
  h = vg_sizing_at(w->sizing, x);
  for (int k = 0; k < 2; k++) {
    const double far = slope * fabs(s - end[k].s);

    if (end[k].h > 0) h = fmax(fmin(h, end[k].h + far), end[k].h - far);
  }
  return h;
}

/* Number of edges that fit between a and b, by Simpson's rule on PIECES
 * intervals; sum[i] is the number up to the i-th. */
enum { PIECES = 256 };

static void count_edges(const struct vg_slide_work *w, const struct chain *c,
                        const struct end end[2], double *sum)
{
  const double step = (end[1].s - end[0].s) / PIECES;
  double left = 1 / size_at(w, c, end, end[0].s);

  sum[0] = 0;
  for (int i = 0; i < PIECES; i++) {
    const double at = end[0].s + step * i;
    const double mid = 1 / size_at(w, c, end, at + 0.5 * step);
    const double right = 1 / size_at(w, c, end, at + step);

    sum[i + 1] = sum[i] + step / 6 * (left + 4 * mid + right);
    left = right;
  }
}

/* Places points from one end to the other, in place of the chain edges from
 * `at` on. */
static vg_status march(struct vg_slide_work *w, const struct chain *c,
                       size_t at, struct end a, struct end b)
{
  const struct end end[2] = { a, b };
  double sum[PIECES + 1], x[3], fit;
  uint32_t last = a.v, v;
  size_t n;
  int piece = 0;

  count_edges(w, c, end, sum);
  fit = sum[PIECES];
  n = fit < 1.5 ? 1 : fit > 1e6 ? 1000000 : (size_t)(fit + 0.5);
  for (size_t i = 1; i < n; i++) {
    const double want = fit * (double)i / (double)n;
    double part;

    while (piece + 1 < PIECES && sum[piece + 1] < want) piece++;
    part = (want - sum[piece]) / (sum[piece + 1] - sum[piece]);
    on_chain(w, c, a.s + (b.s - a.s) * (piece + part) / PIECES, x);
    if (vg_slide_add_point(w, x, &v)) return VG_ERR_MEMORY;
    if (add_edge(w, c, at, last, v)) return VG_ERR_MEMORY;
    last = v;
  }
  return add_edge(w, c, at, last, b.v);
}

/* Column at the end of the chain that also follows it, or VG_NO_INDEX. */
static uint32_t other_end(const struct vg_slide_work *w, const struct chain *c,
                          const uint8_t *runs)
{
  const uint32_t root = c->v[c->n - 1];
  size_t lo = 0, n = w->c->n_column;

  while (n) {
    const size_t half = n / 2;

    if (w->c->column[lo + half].root < root) {
      lo += half + 1;
      n -= half + 1;
    } else {
      n = half;
    }
  }
  for (; lo < w->c->n_column && w->c->column[lo].root == root; lo++) {
    const struct vg_column *k = &w->c->column[lo];

    if (runs[lo] && (k->slide[0] == c->left || k->slide[1] == c->left) &&
        (k->slide[0] == c->right || k->slide[1] == c->right))
      return (uint32_t)lo;
  }
  return VG_NO_INDEX;
}

static void reverse(struct chain *c)
{
  const double total = c->s[c->n - 1];

  for (size_t i = 0, j = c->n - 1; i < j; i++, j--) {
    const uint32_t v = c->v[i];
    const double s = c->s[i];

    c->v[i] = c->v[j];
    c->v[j] = v;
    c->s[i] = c->s[j];
    c->s[j] = s;
  }
  for (size_t i = 0; i < c->n; i++) c->s[i] = total - c->s[i];
}

static int is_bent(const struct vg_slide_work *w, const struct chain *c)
{
  return !w->slide[w->slide_of[c->left]].is_plane ||
         !w->slide[w->slide_of[c->right]].is_plane;
}

/* Mean length of the edges between tops at column i. */
static double top_edge(const struct vg_slide_work *w, uint32_t i)
{
  const double *x = w->x[w->m->n_point + i];
  double sum = 0;
  int n = 0;

  for (size_t r = 0; r < w->c->n_border; r++) {
    const uint32_t *e = w->c->border[r];

    if (e[0] != i && e[1] != i) continue;
    sum += vg_distance(x, w->x[vg_slide_top(w, e[0] == i ? e[1] : e[0])]);
    n++;
  }
  return n ? sum / n : 0;
}

/* Cuts the chain at the top of column i, whose root is the start of the chain.
 * Marks the column if it does not fit; *keep is then c->n. */
static vg_status cut_start(struct vg_slide_work *w, const struct chain *c,
                           uint32_t i, struct end *top, size_t *keep)
{
  const double *x = w->x[w->m->n_point + i];
  int is_short = 0;

  if (is_bent(w, c) && bend(w, i, c, &is_short)) return VG_ERR_MEMORY;
  top->h = top_edge(w, i);
  if (is_short ||
      cut(w, c, x, fmin(vg_sizing_at(w->sizing, x), top->h), &top->s, keep)) {
    vg_slide_mark_bad(w, i, c->left, w->m->point[c->v[0]],
                      "a column is longer than the curve that it follows");
    *keep = c->n;
    return VG_OK;
  }
  top->v = vg_slide_top(w, i);
  return VG_OK;
}

/* Whether the two ends are too close for an edge between them. */
static int is_narrow(const struct chain *c, struct end a, struct end b)
{
  double h = c->s[c->n - 1];

  if (a.h > 0) h = fmin(h, a.h);
  if (b.h > 0) h = fmin(h, b.h);
  return b.s - a.s < LEAST * h;
}

/* One column at the start; all points from `keep` on remain. */
static vg_status run_single(struct vg_slide_work *w, const struct chain *c,
                            uint32_t i)
{
  struct end top = { 0, 0, 0 }, next = { 0, 0, 0 };
  size_t keep;
  vg_status st = VG_OK;

  VG_TRY(cut_start(w, c, i, &top, &keep));
  if (keep == c->n) return VG_OK;
  next.v = c->v[keep];
  next.s = c->s[keep];
  if (is_narrow(c, top, next)) {
    vg_slide_mark_bad(w, i, c->left, w->m->point[c->v[0]],
                      "a column ends too close to the end of its curve");
    return VG_OK;
  }
  VG_TRY(remove_edges(w, c, 0, keep));
  st = march(w, c, 0, top, next);
done:
  return st;
}

/* Column i at the start and column j at the end; the points between them
 * remain. */
static vg_status run_double(struct vg_slide_work *w, struct chain *c,
                            uint32_t i, uint32_t j)
{
  struct end a = { 0, 0, 0 }, b = { 0, 0, 0 }, p = { 0, 0, 0 };
  const size_t n = c->n;
  size_t keep_a, keep_b;
  vg_status st = VG_OK;

  VG_TRY(cut_start(w, c, i, &a, &keep_a));
  reverse(c);
  VG_TRY(cut_start(w, c, j, &b, &keep_b));
  b.s = c->s[n - 1] - b.s;
  reverse(c);
  if (keep_a == n || keep_b == n) return VG_OK;
  keep_b = n - 1 - keep_b;
  if (is_narrow(c, a, b)) {
    for (int k = 0; k < 2; k++)
      vg_slide_mark_bad(w, k ? j : i, c->left, w->m->point[c->v[k ? n - 1 : 0]],
                        "two columns meet on the curve that they follow");
    return VG_OK;
  }
  if (keep_a > keep_b) {
    VG_TRY(remove_edges(w, c, 0, n - 1));
    return march(w, c, 0, a, b);
  }
  VG_TRY(remove_edges(w, c, 0, keep_a));
  VG_TRY(remove_edges(w, c, keep_b, n - 1));
  p.v = c->v[keep_a];
  p.s = c->s[keep_a];
  VG_TRY(march(w, c, 0, a, p));
  p.v = c->v[keep_b];
  p.s = c->s[keep_b];
  st = march(w, c, n - 2, p, b);
done:
  return st;
}

/* runs[i]: column i has boundary edges in both patches in which it slides. */
static void find_runs(const struct vg_slide_work *w, uint8_t *runs)
{
  const struct vg_columns *c = w->c;

  for (size_t i = 0; i < c->n_border; i++)
    for (int k = 0; k < 2; k++) {
      const struct vg_column *col = &c->column[c->border[i][k]];

      if (!col->n || col->slide[1] == VG_NO_INDEX) continue;
      if (col->slide[0] == c->border_patch[i]) runs[c->border[i][k]] |= 1;
      else if (col->slide[1] == c->border_patch[i]) runs[c->border[i][k]] |= 2;
    }
  for (size_t i = 0; i < c->n_column; i++) runs[i] = runs[i] == 3;
}

/* Whether chain d is the image of c by pair p. */
static int is_chain_image(const struct vg_slide_work *w, size_t p,
                          const struct chain *c, const struct chain *d)
{
  if (d->n != c->n) return 0;
  for (size_t i = 0; i < c->n; i++)
    if (d->v[i] != w->twins->match[p].point[c->v[i]]) return 0;
  return 1;
}

/* Steps along chain d as those of column i along the original of d. */
static vg_status repeat(struct vg_slide_work *w, size_t p, uint32_t i,
                        const struct chain *d)
{
  const size_t end = w->steps_of[i][1];
  vg_status st = VG_OK;

  for (size_t k = w->steps_of[i][0]; k < end && st >= 0; k++) {
    const struct vg_slide_step s = w->step[k];
    uint32_t a, b;

    if (!s.is_edge) {
      st = remove_edges(w, d, s.a, s.b);
      continue;
    }
    VG_TRY(vg_slide_image(w, p, s.a, &a));
    VG_TRY(vg_slide_image(w, p, s.b, &b));
    st = add_edge(w, d, s.at, a, b);
  }
done:
  return st;
}

/* The points along two curves, each the image of the other, that exist. */
static vg_status relate(struct vg_slide_work *w, size_t p, uint32_t i,
                        uint32_t k)
{
  const size_t *a = w->steps_of[i], *b = w->steps_of[k];
  vg_status st = VG_OK;

  assert(a[1] - a[0] == b[1] - b[0]);
  for (size_t s = 0; s < a[1] - a[0] && st >= 0; s++)
    if (w->step[a[0] + s].is_edge)
      st = vg_slide_set_image(w, p, w->step[a[0] + s].b, w->step[b[0] + s].b);
  return st;
}

/* Makes the images of the curve c, which starts at column i, and their images
 * by other pairs. */
static vg_status copy_curve(struct vg_slide_work *w, const struct chain *c,
                            uint32_t i)
{
  struct chain d = { 0, 0, 0, NULL, NULL, 0, 0 };
  vg_status st = VG_OK;

  for (size_t p = 0; w->image && p < w->twins->n && st >= 0; p++) {
    const uint32_t patch = w->twins->patch[p][0];
    const uint32_t k = w->twins->column[p][i];

    if ((c->left != patch && c->right != patch) || k == VG_NO_INDEX) continue;
    if (w->steps_of[k][1]) {
      st = relate(w, p, i, k);
      continue;
    }
    VG_TRY(follow(w, w->c->column[k].root, w->c->column[k].slide, &d));
    if (!is_chain_image(w, p, c, &d)) {
      vg_slide_mark_bad(w, i, c->left, w->m->point[c->v[0]],
                        "the curve differs from its periodic image");
      continue;
    }
    w->steps_of[k][0] = w->n_step;
    VG_TRY(repeat(w, p, i, &d));
    w->steps_of[k][1] = w->n_step;
    st = copy_curve(w, &d, k);
  }
done:
  free(d.v);
  free(d.s);
  return st;
}

/* Whether the curve is the image of another one. The axis of a rotation is that
 * of itself. */
static int is_copied(const struct vg_slide_work *w, const struct chain *c)
{
  for (int k = 0; w->image && k < 2; k++) {
    const size_t p = vg_twins_image(w->twins, k ? c->right : c->left);

    if (p < w->twins->n && w->twins->patch[p][0] != (k ? c->left : c->right))
      return 1;
  }
  return 0;
}

/* The curve c between two patches, from column i on. */
static vg_status run(struct vg_slide_work *w, struct chain *c, uint32_t i,
                     const uint8_t *runs)
{
  /* A curve with columns at both ends is handled once, from the column with
   * the lower index. */
  const uint32_t j = other_end(w, c, runs);
  vg_status st = VG_OK;

  if (j != VG_NO_INDEX && j < i) return VG_OK;
  if (w->image) w->steps_of[i][0] = w->n_step;
  if (j == VG_NO_INDEX) VG_TRY(run_single(w, c, i));
  else VG_TRY(run_double(w, c, i, j));
  if (!w->image || w->steps_of[i][0] == w->n_step) return VG_OK;
  w->steps_of[i][1] = w->n_step;
  st = copy_curve(w, c, i);
done:
  return st;
}

vg_status vg_slide_curves(struct vg_slide_work *w)
{
  struct chain c = { 0, 0, 0, NULL, NULL, 0, 0 };
  uint8_t *runs = vg_calloc(w->c->n_column, 1);
  vg_status st = VG_OK;

  if (w->image) w->steps_of = vg_calloc(w->c->n_column, sizeof *w->steps_of);
  if (!runs || (w->image && !w->steps_of)) {
    st = vg_fail_memory(w->err, "curves between slide patches");
    goto done;
  }
  find_runs(w, runs);
  for (uint32_t i = 0; i < w->c->n_column; i++) {
    const struct vg_column *col = &w->c->column[i];

    if (!runs[i]) continue;
    VG_TRY(follow(w, col->root, col->slide, &c));
    if (c.n && !is_copied(w, &c)) VG_TRY(run(w, &c, i, runs));
  }
  if (w->n_gone)
    qsort(w->gone, w->n_gone, sizeof *w->gone, vg_compare_edge_keys);
done:
  free(runs);
  free(c.v);
  free(c.s);
  return st;
}
