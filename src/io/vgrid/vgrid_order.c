/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Point order of VGRID (formats.md 1.2): corners, points along the curves
 * between patches, other surface points, field points. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/edges.h"
#include "io/vgrid/vgrid.h"

enum { ON_CURVE, ON_SURFACE, IN_FIELD, PLACED };

/* An edge between two patches, stored once from each end. */
struct link {
  uint32_t from, to;
};

struct walk {
  const struct vg_mesh *m;
  unsigned char *class; /* [n_point] */
  uint32_t *new_to_old;
  size_t n;          /* number of points placed so far */
  struct link *link; /* sorted by from, to */
  size_t n_link;
};

static vg_status classify(const struct vg_mesh *m, unsigned char *class,
                          struct vg_error *err)
{
  uint32_t *first = vg_alloc(m->n_point, sizeof *first);

  if (!first) return vg_fail_memory(err, "the order of the points");
  memset(class, IN_FIELD, m->n_point);
  for (size_t f = 0; f < m->n_tri; f++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = m->tri[f][k];

      if (class[p] == IN_FIELD) {
        class[p] = ON_SURFACE;
        first[p] = m->tri_patch[f];
      } else if (first[p] != m->tri_patch[f]) {
        class[p] = ON_CURVE;
      }
    }
  free(first);
  return VG_OK;
}

static int compare_link(const void *x, const void *y)
{
  const struct link *p = x, *q = y;

  if (p->from != q->from) return p->from < q->from ? -1 : 1;
  return (p->to > q->to) - (p->to < q->to);
}

/* Sides of triangles whose two ends are on curves. */
struct sides {
  size_t n, cap_end, cap_patch;
  uint32_t (*end)[2], *patch;
};

static int list_sides(const struct walk *w, struct sides *s)
{
  const struct vg_mesh *m = w->m;

  for (size_t f = 0; f < m->n_tri; f++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = m->tri[f][k], b = m->tri[f][(k + 1) % 3];

      if (w->class[a] != ON_CURVE || w->class[b] != ON_CURVE || a == b)
        continue;
      if (vg_reserve(&s->end, &s->cap_end, s->n + 1, sizeof *s->end) ||
          vg_reserve(&s->patch, &s->cap_patch, s->n + 1, sizeof *s->patch))
        return -1;
      s->end[s->n][0] = a;
      s->end[s->n][1] = b;
      s->patch[s->n++] = m->tri_patch[f];
    }
  return 0;
}

/* Create links from the edges whose triangles belong to different patches. */
static vg_status find_links(struct walk *w, struct vg_error *err)
{
  struct sides s = { 0 };
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st = VG_OK;

  if (list_sides(w, &s))
    VG_TRY(vg_fail_memory(err, "the curves between patches"));
  VG_TRY(vg_edges_build_sides(&e, w->m->n_point, s.n,
                              (const uint32_t(*)[2])s.end, err));
  w->link = vg_alloc(2 * e.n, sizeof *w->link);
  if (!w->link) VG_TRY(vg_fail_memory(err, "the curves between patches"));
  for (size_t i = 0; i < e.n; i++) {
    const uint32_t *h = vg_edges_at(&e, i), *end = s.end[h[0]];
    uint32_t k = 1;

    while (k < vg_edges_count(&e, i) && s.patch[h[k]] == s.patch[h[0]]) k++;
    if (k == vg_edges_count(&e, i)) continue;
    w->link[w->n_link++] = (struct link){ end[0], end[1] };
    w->link[w->n_link++] = (struct link){ end[1], end[0] };
  }
  qsort(w->link, w->n_link, sizeof *w->link, compare_link);
done:
  vg_edges_release(&e);
  free(s.end);
  free(s.patch);
  return st;
}

static size_t first_link(const struct walk *w, uint32_t from)
{
  size_t lo = 0, hi = w->n_link;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (w->link[mid].from < from) lo = mid + 1;
    else hi = mid;
  }
  return lo;
}

static size_t degree(const struct walk *w, uint32_t p)
{
  size_t i = first_link(w, p), n = 0;

  while (i + n < w->n_link && w->link[i + n].from == p) n++;
  return n;
}

static void place(struct walk *w, uint32_t p)
{
  w->class[p] = PLACED;
  w->new_to_old[w->n++] = p;
}

/* Follow a curve from p, which has been placed, through points that have
 * not. */
static void follow(struct walk *w, uint32_t p)
{
  for (;;) {
    size_t i = first_link(w, p);

    while (i < w->n_link && w->link[i].from == p &&
           w->class[w->link[i].to] == PLACED)
      i++;
    if (i == w->n_link || w->link[i].from != p) return;
    p = w->link[i].to;
    place(w, p);
  }
}

/* Corners are points where curves end, meet or touch, that is, points without
 * exactly two links. */
static void place_curves(struct walk *w)
{
  size_t n_corner;

  for (size_t p = 0; p < w->m->n_point; p++)
    if (w->class[p] == ON_CURVE && degree(w, (uint32_t)p) != 2)
      place(w, (uint32_t)p);
  n_corner = w->n;
  for (size_t i = 0; i < n_corner; i++) {
    uint32_t p = w->new_to_old[i];
    size_t n = degree(w, p), at = first_link(w, p);

    for (size_t k = at; k < at + n; k++) {
      uint32_t q = w->link[k].to;

      if (w->class[q] == PLACED) continue;
      place(w, q);
      follow(w, q);
    }
  }
  for (size_t p = 0; p < w->m->n_point; p++)
    if (w->class[p] == ON_CURVE) {
      place(w, (uint32_t)p);
      follow(w, (uint32_t)p);
    }
}

static void place_class(struct walk *w, int class)
{
  for (size_t p = 0; p < w->m->n_point; p++)
    if (w->class[p] == class) w->new_to_old[w->n++] = (uint32_t)p;
}

static void count_classes(const struct walk *w, size_t *n_curve,
                          size_t *n_boundary, int *in_order)
{
  *n_curve = *n_boundary = 0;
  *in_order = 1;
  for (size_t p = 0; p < w->m->n_point; p++) {
    *n_curve += w->class[p] == ON_CURVE;
    *n_boundary += w->class[p] != IN_FIELD;
    if (p && w->class[p] < w -> class[p - 1]) *in_order = 0;
  }
}

vg_status vg_vgrid_order(const struct vg_mesh *m, uint32_t **new_to_old,
                         uint32_t **old_to_new, size_t *n_curve_point,
                         size_t *n_boundary, struct vg_error *err)
{
  struct walk w = { m, NULL, NULL, 0, NULL, 0 };
  uint32_t *inverse = NULL;
  vg_status st = VG_OK;
  int in_order;

  assert(new_to_old && old_to_new && n_curve_point && n_boundary);
  *new_to_old = *old_to_new = NULL;
  w.class = vg_alloc(m->n_point, 1);
  if (!w.class) return vg_fail_memory(err, "the order of the points");
  VG_TRY(classify(m, w.class, err));
  count_classes(&w, n_curve_point, n_boundary, &in_order);
  if (in_order) goto done;
  w.new_to_old = vg_alloc(m->n_point, sizeof *w.new_to_old);
  inverse = vg_alloc(m->n_point, sizeof *inverse);
  if (!w.new_to_old || !inverse) {
    st = vg_fail_memory(err, "the order of the points");
    goto done;
  }
  VG_TRY(find_links(&w, err));
  place_curves(&w);
  place_class(&w, ON_SURFACE);
  place_class(&w, IN_FIELD);
  for (size_t i = 0; i < w.n; i++) inverse[w.new_to_old[i]] = (uint32_t)i;
  *new_to_old = w.new_to_old;
  *old_to_new = inverse;
  w.new_to_old = inverse = NULL;
done:
  free(w.class);
  free(w.new_to_old);
  free(inverse);
  free(w.link);
  return st;
}
