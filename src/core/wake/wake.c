/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/wake/wake.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/graded.h"
#include "core/geometry/vector.h"

/* W2: limits of a panel and of a strip. */
#define DEVIATION 0.1 /* of the half height */
#define CHORD_RATIO 1.15
#define STRIP_RATIO 1.1    /* of sizes along the stream */
#define CHORD_SLOPE 4.0    /* change of the chord per unit of span */
#define CELLS_PER_CUBE 9.0 /* tetrahedra per cube of the edge length */

#define NONE UINT32_MAX

/* --- directions ---------------------------------------------------------- */

static void turn(double degrees, double *sine, double *cosine)
{
  assert(fabs(degrees) <= 90);
  vg_quarter_turn(fabs(degrees) / 90, sine, cosine);
  if (degrees < 0) *sine = -*sine;
}

void vg_wake_direction(double alpha, double beta, const double stream[3],
                       const double up[3], double flow[3])
{
  double sa, ca, sb, cb, starboard[3];

  turn(alpha, &sa, &ca);
  turn(beta, &sb, &cb);
  vg_cross(up, stream, starboard);
  for (int k = 0; k < 3; k++)
    flow[k] = ca * cb * stream[k] + sa * cb * up[k] - sb * starboard[k];
}

/* --- panels -------------------------------------------------------------- */

/* The trailing edges that count, at their points. */
struct lines {
  const struct vg_mesh *m;
  const struct vg_wake *wake;
  size_t n;
  struct vg_trailing_edge *edge; /* [n] */
  uint8_t *is_used;              /* [n] */
  struct end {
    uint32_t point, edge;
  } * end; /* [2 n] by points, then by edges */
};

static int by_point(const void *pa, const void *pb)
{
  const struct end *a = pa, *b = pb;

  if (a->point != b->point) return a->point < b->point ? -1 : 1;
  return (a->edge > b->edge) - (a->edge < b->edge);
}

/* First end at a point, and the number of ends there. */
static size_t ends_at(const struct lines *l, uint32_t point, size_t *n)
{
  size_t lo = 0, hi = 2 * l->n, first;

  while (lo < hi) {
    const size_t mid = (lo + hi) / 2;

    if (l->end[mid].point < point) lo = mid + 1;
    else hi = mid;
  }
  for (first = lo; lo < 2 * l->n && l->end[lo].point == point;) lo++;
  *n = lo - first;
  return first;
}

static const double *middle(const struct lines *l, size_t e, double x[3])
{
  const struct vg_trailing_edge *t = l->edge + e;

  for (int k = 0; k < 3; k++)
    x[k] = 0.5 * (l->m->point[t->point[0]][k] + l->m->point[t->point[1]][k]);
  return x;
}

/* Limit the slope of the chord along the edges, by two sweeps over neighbours
 * in the order of chords: smaller chords are final. */
struct by_chord {
  double chord;
  uint32_t edge;
};

static int by_chord(const void *pa, const void *pb)
{
  const struct by_chord *a = pa, *b = pb;

  if (a->chord != b->chord) return a->chord < b->chord ? -1 : 1;
  return (a->edge > b->edge) - (a->edge < b->edge);
}

/* Lower the chord of e, and of edges that it reaches along the trailing edge,
 * to at most that of `from` plus the slope times the distance. */
static void spread(struct lines *l, uint32_t from)
{
  for (int side = 0; side < 2; side++) {
    uint32_t e = from, point = l->edge[from].point[side];

    for (size_t step = 0; step < l->n; step++) {
      size_t n, first = ends_at(l, point, &n);
      uint32_t next;
      double a[3], b[3], most;

      if (n != 2) break;
      next = l->end[first].edge == e ? l->end[first + 1].edge
                                     : l->end[first].edge;
      most = l->edge[e].chord +
             CHORD_SLOPE * vg_distance(middle(l, e, a), middle(l, next, b));
      if (next == from || !(l->edge[next].chord > most)) break;
      l->edge[next].chord = most;
      point = l->edge[next].point[l->edge[next].point[0] == point];
      e = next;
    }
  }
}

static vg_status limit_chords(struct lines *l, struct vg_error *err)
{
  struct by_chord *order;

  if (l->wake->chord > 0) {
    for (size_t i = 0; i < l->n; i++) l->edge[i].chord = l->wake->chord;
    return VG_OK;
  }
  order = vg_alloc(l->n, sizeof *order);
  if (!order) return vg_fail_memory(err, "the wakes");
  for (size_t i = 0; i < l->n; i++)
    order[i] = (struct by_chord){ l->edge[i].chord, (uint32_t)i };
  qsort(order, l->n, sizeof *order, by_chord);
  for (size_t i = 0; i < l->n; i++) spread(l, order[i].edge);
  free(order);
  return VG_OK;
}

/* A chain of edges: n edges and n + 1 points. */
struct chain {
  size_t n, cap_edge, cap_point;
  uint32_t *edge, *point;
};

static vg_status follow(struct lines *l, uint32_t e, uint32_t from,
                        struct chain *c, struct vg_error *err)
{
  c->n = 0;
  while (e != NONE) {
    size_t n, first;

    if (vg_reserve(&c->edge, &c->cap_edge, c->n + 1, sizeof *c->edge) ||
        vg_reserve(&c->point, &c->cap_point, c->n + 2, sizeof *c->point))
      return vg_fail_memory(err, "the wakes");
    l->is_used[e] = 1;
    c->point[c->n] = from;
    c->edge[c->n++] = e;
    from = l->edge[e].point[l->edge[e].point[0] == from];
    c->point[c->n] = from;
    first = ends_at(l, from, &n);
    e = NONE;
    for (size_t i = first; n == 2 && i < first + n; i++)
      if (!l->is_used[l->end[i].edge]) e = l->end[i].edge;
  }
  return VG_OK;
}

static double chord_at(const struct lines *l, const struct chain *c, size_t i)
{
  const double before = l->edge[c->edge[i ? i - 1 : i]].chord;
  const double after = l->edge[c->edge[i < c->n ? i : i - 1]].chord;

  return 0.5 * (before + after);
}

/* May one panel replace the edges from point i to point j of the chain? */
static int fits(const struct lines *l, const struct chain *c, size_t i,
                size_t j)
{
  const double *a = l->m->point[c->point[i]], *b = l->m->point[c->point[j]];
  double least = INFINITY, most = 0, far = 0, along[3], length;

  vg_sub(b, a, along);
  length = vg_unit(along);
  for (size_t k = i; k <= j; k++) {
    const double *x = l->m->point[c->point[k]], chord = chord_at(l, c, k);
    double d[3], s, off2;

    vg_sub(x, a, d);
    s = vg_dot(d, along);
    off2 = vg_dot(d, d) - s * s;
    if (s < 0 || s > length) off2 = vg_dot(d, d);
    if (k > i && k < j) far = fmax(far, off2);
    least = fmin(least, chord);
    most = fmax(most, chord);
  }
  far = sqrt(far);
  return length <= least && most <= CHORD_RATIO * least &&
         far <= DEVIATION * l->wake->height * least;
}

static vg_status add_panels(const struct lines *l, const struct chain *c,
                            struct vg_wake_panels *to, struct vg_error *err)
{
  for (size_t i = 0, j; i < c->n; i = j) {
    struct vg_wake_panel p = { .thickness = 0 };

    for (j = i + 1; j < c->n && fits(l, c, i, j + 1);) j++;
    memcpy(p.x[0], l->m->point[c->point[i]], sizeof p.x[0]);
    memcpy(p.x[1], l->m->point[c->point[j]], sizeof p.x[1]);
    p.chord[0] = chord_at(l, c, i);
    p.chord[1] = chord_at(l, c, j);
    for (size_t k = i; k < j; k++)
      p.thickness = fmax(p.thickness, l->edge[c->edge[k]].thickness);
    if (vg_reserve(&to->item, &to->cap, to->n + 1, sizeof *to->item))
      return vg_fail_memory(err, "the wakes");
    to->item[to->n++] = p;
  }
  return VG_OK;
}

/* Chains start at points where they end or branch; the rest are loops. */
static vg_status chain_up(struct lines *l, struct vg_wake_panels *out,
                          struct vg_error *err)
{
  struct chain c = { 0 };
  vg_status st = VG_OK;

  for (int loops = 0; loops < 2 && st >= 0; loops++)
    for (size_t i = 0; i < 2 * l->n && st >= 0; i++) {
      const struct end *at = l->end + i;
      size_t n;

      ends_at(l, at->point, &n);
      if (l->is_used[at->edge] || (!loops && n == 2)) continue;
      st = follow(l, at->edge, at->point, &c, err);
      if (st >= 0) st = add_panels(l, &c, out, err);
    }
  free(c.edge);
  free(c.point);
  return st;
}

static vg_status collect(const struct vg_trailing *t, const uint8_t *on,
                         struct lines *l, struct vg_error *err)
{
  l->edge = vg_alloc(t->n, sizeof *l->edge);
  l->is_used = vg_calloc(t->n, sizeof *l->is_used);
  l->end = vg_alloc(2 * t->n, sizeof *l->end);
  if (!l->edge || !l->is_used || !l->end)
    return vg_fail_memory(err, "the wakes");
  for (size_t i = 0; i < t->n; i++) {
    const struct vg_trailing_edge *e = t->edge + i;

    if (!on[e->patch[0]] && !on[e->patch[1]]) continue;
    for (int k = 0; k < 2; k++)
      l->end[2 * l->n + (size_t)k] = (struct end){ e->point[k],
                                                   (uint32_t)l->n };
    l->edge[l->n++] = *e;
  }
  if (l->n) qsort(l->end, 2 * l->n, sizeof *l->end, by_point);
  return VG_OK;
}

vg_status vg_wake_panels_make(const struct vg_mesh *m,
                              const struct vg_trailing *t, const uint8_t *on,
                              const struct vg_wake *w,
                              struct vg_wake_panels *out, struct vg_error *err)
{
  struct lines l = { .m = m, .wake = w };
  struct vg_wake_panels made = VG_WAKE_PANELS_INIT;
  vg_status st;

  assert(!out->n && w->size > 0 && w->height > 0);
  VG_TRY(collect(t, on, &l, err));
  if (l.n) VG_TRY(limit_chords(&l, err));
  VG_TRY(chain_up(&l, &made, err));
  *out = made;
  made = (struct vg_wake_panels)VG_WAKE_PANELS_INIT;
done:
  vg_wake_panels_release(&made);
  free(l.edge);
  free(l.is_used);
  free(l.end);
  return st;
}

void vg_wake_panels_release(struct vg_wake_panels *p)
{
  free(p->item);
  memset(p, 0, sizeof *p);
}

/* --- sources ------------------------------------------------------------- */

/* Size at s chords behind the trailing edge, in chords. */
static double size_at(const struct vg_wake *w, double s)
{
  return w->size + (w->growth - 1) * s;
}

/* End of the strip that begins at s: its sizes differ by STRIP_RATIO. */
static double strip_end(const struct vg_wake *w, double s)
{
  const double growth = w->growth - 1;
  double end;

  if (!(growth > 0)) return w->length;
  end = s + (STRIP_RATIO - 1) * size_at(w, s) / growth;
  return end < w->length ? end : w->length;
}

size_t vg_wake_sources_count(const struct vg_wake *w)
{
  size_t n = 0;

  for (double s = 0; s < w->length; s = strip_end(w, s)) n += 2;
  return n;
}

static void behind(const struct vg_wake_panel *p, int end, const double flow[3],
                   double s, double x[3])
{
  for (int k = 0; k < 3; k++) x[k] = p->x[end][k] + s * p->chord[end] * flow[k];
}

/* Span times the integral of (cells across) / h^2 along the stream. */
double vg_wake_cells(const struct vg_wake *w, const struct vg_wake_panel *p,
                     double scale)
{
  const double chord = 0.5 * (p->chord[0] + p->chord[1]);
  const double span = vg_distance(p->x[0], p->x[1]) / chord;
  const double across = 2 * w->height / w->size;
  const double first = w->size, last = size_at(w, w->length);
  const double along = w->length / (first * last); /* of ds / h(s)^2 */

  return CELLS_PER_CUBE * span * across * along /
         (w->stretch * scale * scale * scale);
}

void vg_wake_sources(const struct vg_wake *w, const struct vg_wake_panel *p,
                     const double flow[3], struct vg_source *out)
{
  const double chord = 0.5 * (p->chord[0] + p->chord[1]);
  size_t n = 0;

  for (double s = 0; s < w->length;) {
    const double end = strip_end(w, s);
    double x[2][2][3];
    struct vg_source strip = { .kind = VG_SOURCE_TRIANGLE, .an = 1 };

    for (int k = 0; k < 2; k++) {
      behind(p, k, flow, s, x[0][k]);
      behind(p, k, flow, end, x[1][k]);
    }
    strip.h0 = strip.h1 = size_at(w, 0.5 * (s + end)) * chord;
    strip.r0 = w->height * strip.h0 / w->size + 0.5 * p->thickness;
    if (w->stretch > 1) {
      strip.stretch = w->stretch;
      memcpy(strip.u, flow, sizeof strip.u);
    }
    for (int k = 0; k < 2; k++) {
      memcpy(strip.p0, x[k][0], sizeof strip.p0);
      memcpy(strip.p1, x[0][1], sizeof strip.p1);
      memcpy(strip.p2, x[1][k], sizeof strip.p2);
      out[n++] = strip;
    }
    s = end;
  }
}

int vg_wake_probe(const struct vg_wake *w, const struct vg_wake_panel *p,
                  const double flow[3], double s, double scale,
                  struct vg_wake_probe *out)
{
  const double chord = 0.5 * (p->chord[0] + p->chord[1]);
  const double half = w->height * chord * size_at(w, s) / w->size;
  double x[2][3], span[3], normal[3];

  assert(scale > 0);
  if (s > w->length) return 0;
  for (int k = 0; k < 2; k++) behind(p, k, flow, s, x[k]);
  vg_sub(p->x[1], p->x[0], span);
  vg_cross(flow, span, normal);
  if (!(vg_unit(normal) > 0)) return 0;
  for (int k = 0; k < 3; k++) {
    const double mid = 0.5 * (x[0][k] + x[1][k]);

    out->x[0][k] = mid - half * normal[k];
    out->x[1][k] = mid + half * normal[k];
  }
  out->asked = 2 * half / (scale * size_at(w, s) * chord);
  out->got = out->stretch = NAN;
  memcpy(out->flow, flow, sizeof out->flow);
  return 1;
}
