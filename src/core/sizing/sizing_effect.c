/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_effect.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/sizing/sizing_probes.h"
#include "core/sizing/sizing_stretch.h"

#define NEARBY                                                                 \
  3 /* distance of sample points around a source without points                \
       in the void, in spacings */
#define MANY                                                                   \
  200 /* if there are more sources, each gets fewer sample points              \
       */

struct finder {
  const struct vg_sizing_options *options;
  const struct vg_source *source;
  const struct vg_mesh *front;
  const struct vg_sizing *sizing;
  struct vg_effects *out;
  size_t cap, cap_outside, cap_place;
};

/* Faces that limit a source. */
struct holders {
  size_t n, cap;
  struct holder {
    double edge, distance;
  } * item;
};

void vg_effects_release(struct vg_effects *h)
{
  free(h->item);
  free(h->outside);
  free(h->place);
  free(h->unmet);
  memset(h, 0, sizeof *h);
}

/* Requested spacing of a source at x, including its growth. A VGRID source by
 * itself only defines the spacing at its own position, where the mean is its
 * spacing. */
static double asked_at(const struct finder *f, size_t i, const double x[3])
{
  struct vg_source s = f->source[i];
  double ratio[2];

  /* A VGRID source may have a flag instead of the ratio. */
  s.stretch = vg_source_stretch(&f->source[i], s.u, ratio) ? ratio[0] : 0;
  if (s.kind == VG_SOURCE_VGRID_NODE) s.kind = VG_SOURCE_POINT;
  if (s.kind == VG_SOURCE_VGRID_LINE) s.kind = VG_SOURCE_LINE;
  if (s.kind != f->source[i].kind) s.r0 = s.growth = 0;
  return vg_sizing_sources_at(f->options, 1, &s, x);
}

/* Mean edge of a triangle, and the distance of its nearest corner or centroid.
 */
static void measure(const struct vg_mesh *m, size_t tri, const double x[3],
                    double *edge, double *distance)
{
  double mid[3] = { 0, 0, 0 }, near2 = INFINITY;

  *edge = 0;
  for (int c = 0; c < 4; c++) {
    const double *a = c < 3 ? m->point[m->tri[tri][c]] : mid;
    const double *b = m->point[m->tri[tri][(c + 1) % 3]];
    double d2 = 0, e2 = 0;

    for (int k = 0; k < 3; k++) {
      d2 += (a[k] - x[k]) * (a[k] - x[k]);
      e2 += (b[k] - a[k]) * (b[k] - a[k]);
      if (c < 3) mid[k] += a[k] / 3;
    }
    if (c < 3) *edge += sqrt(e2) / 3;
    near2 = fmin(near2, d2);
  }
  *distance = sqrt(near2);
}

/* Find the face that requires the largest spacing, and all faces that require
 * a larger spacing than the source. */
static int find_faces(const struct finder *f, struct vg_limited_source *h,
                      struct holders *all)
{
  const double growth = vg_scaled_growth(f->options->growth, f->options->scale);
  double most = 0;

  h->face = SIZE_MAX;
  all->n = 0;
  for (size_t i = 0; i < f->front->n_tri; i++) {
    struct holder g;
    double v;

    measure(f->front, i, h->at, &g.edge, &g.distance);
    v = vg_sizing_below(growth, g.edge, g.distance);
    if (!(v > h->asked)) continue;
    if (vg_reserve(&all->item, &all->cap, all->n + 1, sizeof g)) return -1;
    all->item[all->n++] = g;
    if (!(v > most)) continue;
    most = v;
    h->face = i;
    h->edge = g.edge;
    h->distance = g.distance;
  }
  if (most < 0.5 * h->got) h->face = SIZE_MAX;
  return 0;
}

/* Would no face limit the source with another growth rate? */
static int is_unlimited(const struct holders *all, double growth, double asked)
{
  for (size_t i = 0; i < all->n; i++)
    if (vg_sizing_below(growth, all->item[i].edge, all->item[i].distance) >
        asked)
      return 0;
  return 1;
}

static void find_remedy(const struct finder *f, struct vg_limited_source *h,
                        const struct holders *all)
{
  const struct vg_sizing_options *o = f->options;
  double nearest = h->distance;

  h->edge_wanted = h->growth_wanted = 0;
  if (h->face == SIZE_MAX) return;
  for (size_t i = 0; i < all->n; i++)
    nearest = fmin(nearest, all->item[i].distance);
  h->edge_wanted = vg_sizing_below_edge(vg_scaled_growth(o->growth, o->scale),
                                        h->asked, nearest);
  for (int k = 21; k <= 40; k++)
    if (0.05 * k > o->growth &&
        is_unlimited(all, vg_scaled_growth(0.05 * k, o->scale), h->asked)) {
      h->growth_wanted = 0.05 * k;
      return;
    }
}

static vg_status find_cause(const struct finder *f, struct vg_limited_source *h,
                            struct vg_error *err)
{
  struct holders all = { 0 };
  vg_status st = VG_OK;

  if (find_faces(f, h, &all)) st = vg_fail_memory(err, "the sources");
  else find_remedy(f, h, &all);
  free(all.item);
  return st;
}

static void take(struct vg_limited_source *h, const double x[3], double asked,
                 double got)
{
  memcpy(h->at, x, sizeof h->at);
  h->asked = asked;
  h->got = got;
}

/* Is the limitation worth reporting? The field around a source need not follow
 * it everywhere. */
static int is_limited(const struct vg_limited_source *h, int is_wide)
{
  return h->n_limited &&
         (h->n_limited == h->n_place ||
          (!is_wide &&
           (double)h->n_limited >= VG_LIMITED_SHARE * (double)h->n_place));
}

/* Store a sample point if the spacing more than doubles within four spacings
 * of it. */
static int keep_place(struct finder *f, size_t i, const double x[3], double got)
{
  struct vg_steep_place p = { .got = got, .source = i };
  int is_small = 0;

  if (vg_sizing_slope(f->sizing) <= VG_MET_STEEP) return 0;
  for (int k = 0; k < 6 && !is_small; k++) {
    memcpy(p.x, x, sizeof p.x);
    p.x[k / 2] += (k % 2 ? 4 : -4) * got;
    is_small = vg_sizing_at(f->sizing, p.x) > 2 * got;
  }
  if (!is_small) return 0;
  if (vg_reserve(&f->out->place, &f->cap_place, f->out->n_place + 1, sizeof p))
    return -1;
  memcpy(p.x, x, sizeof p.x);
  f->out->place[f->out->n_place++] = p;
  return 0;
}

/* Evaluate source i at its sample points from .. to that are in the void.
 * is_wide: the points are around the source. */
static vg_status ask(struct finder *f, size_t i, const struct vg_probes *p,
                     size_t from, size_t to, int is_wide, struct vg_error *err)
{
  struct vg_limited_source best = { .source = i }, worst = best, *h = &best;
  double least = INFINITY, most = 0;

  for (size_t j = from; j < to; j++) {
    const struct vg_probe *q = p->item + j;
    double asked, got;

    if (q->crossings >= 0) continue;
    asked = asked_at(f, i, q->x);
    got = vg_sizing_at(f->sizing, q->x);
    best.n_place++;
    best.n_limited += got > VG_LIMITED_RATIO * asked;
    if (got > most * asked) take(&worst, q->x, asked, got);
    if (got < least * asked) take(&best, q->x, asked, got);
    if (!is_wide && got <= VG_LIMITED_RATIO * asked &&
        keep_place(f, i, q->x, got))
      return vg_fail_memory(err, "the sources");
    most = worst.got / worst.asked;
    least = best.got / best.asked;
  }
  if (!is_limited(&best, is_wide)) return VG_OK;
  worst.n_place = best.n_place;
  worst.n_limited = best.n_limited;
  if (best.n_limited < best.n_place) h = &worst;
  if (find_cause(f, h, err) < 0) return VG_ERR_MEMORY;
  if (vg_reserve(&f->out->item, &f->cap, f->out->n + 1, sizeof *h))
    return vg_fail_memory(err, "the sources");
  f->out->item[f->out->n++] = *h;
  return VG_OK;
}

static int any_inside(const struct vg_probes *p, size_t from, size_t to)
{
  for (size_t j = from; j < to; j++)
    if (p->item[j].crossings < 0) return 1;
  return 0;
}

static size_t end_of(const struct vg_probes *p, size_t from)
{
  size_t to = from;

  while (to < p->n && p->item[to].source == p->item[from].source) to++;
  return to;
}

static vg_status ask_all(struct finder *f, const struct vg_probes *p,
                         uint8_t *is_met, int is_wide, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t j = 0, end; st >= 0 && j < p->n; j = end) {
    uint32_t i = p->item[j].source;

    end = end_of(p, j);
    if (is_met[i] || !any_inside(p, j, end)) continue;
    is_met[i] = 1;
    st = ask(f, i, p, j, end, is_wide, err);
  }
  return st;
}

/* For sources without a sample point in the void: create sample points around
 * them. */
static void look_around(const struct finder *f, const struct vg_probes *p,
                        const uint8_t *is_met, struct vg_probes *wide)
{
  for (size_t j = 0, end; j < p->n; j = end) {
    const struct vg_source *s = f->source + p->item[j].source;
    double h = f->options->scale * s->h0;
    size_t from = wide->n, to;

    end = end_of(p, j);
    if (is_met[p->item[j].source]) continue;
    vg_probes_shape(wide, s, p->item[j].source, 0);
    to = wide->n;
    vg_probes_around(wide, from, to, h);
    vg_probes_around(wide, from, to, NEARBY * h);
  }
}

static int is_beyond(const struct vg_probes *p, size_t from, size_t to,
                     const double lo[3], const double hi[3])
{
  for (size_t j = from; j < to; j++) {
    int within = 1;

    for (int k = 0; k < 3; k++)
      within = within && p->item[j].x[k] >= lo[k] && p->item[j].x[k] <= hi[k];
    if (within) return 0;
  }
  return 1;
}

/* List the sources that have no sample point in the fluid either, which
 * includes the layers. */
static vg_status list_outside(struct finder *f, const struct vg_probes *p,
                              const struct vg_mesh *surface,
                              const uint8_t *is_met, struct vg_error *err)
{
  double lo[3], hi[3];

  vg_mesh_bounds(surface, lo, hi);
  for (size_t j = 0, end; j < p->n; j = end) {
    uint32_t i = p->item[j].source;

    end = end_of(p, j);
    if (is_met[i] || any_inside(p, j, end)) continue;
    if (vg_reserve(&f->out->outside, &f->cap_outside, f->out->n_outside + 1,
                   sizeof *f->out->outside))
      return vg_fail_memory(err, "the sources");
    f->out->outside[f->out->n_outside++] = (struct vg_outside_source){
      i, is_beyond(p, j, end, lo, hi)
    };
  }
  return VG_OK;
}

static int by_source(const void *a, const void *b)
{
  const struct vg_limited_source *h = a, *g = b;

  return h->source < g->source ? -1 : h->source > g->source;
}

static vg_status find(struct finder *f, struct vg_probes *p,
                      struct vg_probes *wide, uint8_t *is_met,
                      const struct vg_mesh *surface, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_probes_cross(p, f->front, err));
  VG_TRY(ask_all(f, p, is_met, 0, err));
  look_around(f, p, is_met, wide);
  if (wide->refused) {
    st = vg_fail_memory(err, "the sample points of sources");
    goto done;
  }
  if (!wide->n) goto done;
  VG_TRY(vg_probes_cross(wide, f->front, err));
  VG_TRY(ask_all(f, wide, is_met, 1, err));
  if (surface != f->front) VG_TRY(vg_probes_cross(wide, surface, err));
  VG_TRY(list_outside(f, wide, surface, is_met, err));
  if (f->out->n)
    qsort(f->out->item, f->out->n, sizeof *f->out->item, by_source);
done:
  return st;
}

vg_status vg_effects_find(const struct vg_sizing_options *options, size_t n,
                          const struct vg_source *source,
                          const struct vg_mesh *front,
                          const struct vg_mesh *surface,
                          const struct vg_sizing *sizing,
                          struct vg_effects *out, struct vg_error *err)
{
  struct vg_probes p = VG_PROBES_INIT, wide = VG_PROBES_INIT;
  struct vg_effects found = VG_EFFECTS_INIT;
  struct finder f = { .options = options,
                      .source = source,
                      .front = front,
                      .sizing = sizing,
                      .out = &found };
  uint8_t *is_met;
  vg_status st;

  assert(options && sizing && out && (source || !n));
  if (!n || !front->n_tri) return VG_OK;
  is_met = vg_calloc(n, 1);
  for (size_t i = 0; i < n; i++)
    vg_probes_shape(&p, source + i, (uint32_t)i, n <= MANY);
  if (!is_met || p.refused)
    st = vg_fail_memory(err, "the sample points of sources");
  else st = find(&f, &p, &wide, is_met, surface, err);
  vg_probes_release(&p);
  vg_probes_release(&wide);
  free(is_met);
  if (st >= 0) *out = found;
  else vg_effects_release(&found);
  return st;
}
