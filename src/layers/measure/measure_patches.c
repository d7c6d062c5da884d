/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Statistics of layers by patch. */
#include "layers/measure/measure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

#define SHARE_BINS 1000
#define SHARE_LOW 0.05  /* Share of the area. */
#define SHARE_WHOLE 0.9 /* Share of the height of the growth law. */

/* Counts that become percentages; means are sums until the end. */
struct tally {
  struct vg_patch_layers p;
  size_t n_full, n_uncompressed, n_any;
  double area, area_whole;
  double bin[SHARE_BINS + 1]; /* Area by relative height. */
};

struct patches_job {
  const struct vg_mesh *surface;
  const struct vg_columns *columns;
  const struct vg_wall_fields *w;
  double reynolds, length;
  size_t *face_first; /* [surface->n_patch + 1] offsets into face[]. */
  uint32_t *face;     /* Faces of triangles sorted by patch. */
  uint32_t *field;    /* [surface->n_point] index into w, or VG_NO_INDEX. */
  uint32_t *seen;     /* [w->n] last patch, + 1, that counted the point. */
};

static void note(struct vg_range *r, double x, size_t n_before)
{
  if (!n_before || x < r->min) r->min = x;
  if (!n_before || x > r->max) r->max = x;
  r->mean += x;
}

static void finish_range(struct vg_range *r, size_t n)
{
  if (n) r->mean /= (double)n;
}

static void add_point(const struct vg_wall_fields *w, size_t i, struct tally *t)
{
  double error;

  if (!(w->asked[i] > 0)) return;
  note(&t->p.asked, w->asked[i], t->p.n_point);
  note(&t->p.first, w->first[i], t->p.n_point);
  note(&t->p.level, w->level[i], t->p.n_point);
  note(&t->p.total, w->total[i], t->p.n_point);
  note(&t->p.growth, w->growth[i], t->p.n_point);
  error = fabs(w->first[i] - w->asked[i]) / w->asked[i];
  if (error > t->p.first_error) t->p.first_error = error;
  t->p.n_point++;
}

static void add_share(const struct patches_job *j, size_t f, struct tally *t)
{
  const struct vg_mesh *m = j->surface;
  const uint32_t *v = m->tri[j->columns->face_tri[f]];
  double a[3], b[3], n[3], area, share = 0;

  vg_sub(m->point[v[1]], m->point[v[0]], a);
  vg_sub(m->point[v[2]], m->point[v[0]], b);
  vg_cross(a, b, n);
  area = 0.5 * vg_norm(n);
  for (int k = 0; k < 3; k++) share += j->w->share[j->field[v[k]]] / 3;
  assert(share >= 0 && share < 1 + 1e-9);
  t->area += area;
  t->p.share_mean += area * share;
  if (share >= SHARE_WHOLE) t->area_whole += area;
  t->bin[(int)(fmin(share, 1) * SHARE_BINS)] += area;
}

static void finish_share(struct tally *t)
{
  double below = 0;
  int i = 0;

  if (!(t->area > 0)) return;
  while (i < SHARE_BINS && below + t->bin[i] < SHARE_LOW * t->area)
    below += t->bin[i++];
  t->p.share_low = (double)i / SHARE_BINS;
  t->p.share_mean /= t->area;
  t->p.share_area = 100 * t->area_whole / t->area;
}

static void add_face(const struct patches_job *j, size_t f, struct tally *t)
{
  const uint32_t *v = j->columns->face[f];
  const struct vg_column *col = j->columns->column;
  const struct vg_column *worst = &col[v[0]], *tightest = worst;
  int full = 1, loose = 1, any = 1;
  double first = 0;

  for (int k = 0; k < 3; k++) {
    const struct vg_column *c = &col[v[k]];

    if (vg_column_is_worse(c, worst)) worst = c;
    if (vg_column_is_tighter(c, tightest)) tightest = c;
    full &= c->n >= c->n_fit;
    loose &= c->compressed == VG_CAUSE_NONE;
    any &= c->n > 0;
    first += j->w->first[j->field[c->root]];
  }
  if (worst->cause < VG_CAUSE_N) t->p.cause[worst->cause]++;
  if (tightest->compressed < VG_CAUSE_N)
    t->p.compressed[tightest->compressed]++;
  if (any && j->reynolds > 0)
    note(&t->p.y_plus, vg_y_plus(first / 3, j->reynolds, j->length), t->n_any);
  t->n_any += any;
  t->p.n_bare += full && !any;
  full &= any;
  t->n_full += full;
  t->n_uncompressed += full && loose;
  add_share(j, f, t);
  t->p.n_face++;
}

static double percent(size_t part, size_t whole)
{
  return whole ? 100 * (double)part / (double)whole : 0;
}

static void finish(struct tally *t)
{
  struct vg_patch_layers *p = &t->p;

  p->full = percent(t->n_full, p->n_face);
  p->full_inside = percent(t->n_full, p->n_face - p->cause[VG_CAUSE_INNER]);
  p->uncompressed = percent(t->n_uncompressed, p->n_face);
  p->any = percent(t->n_any, p->n_face);
  finish_range(&p->asked, p->n_point);
  finish_range(&p->first, p->n_point);
  finish_range(&p->level, p->n_point);
  finish_range(&p->total, p->n_point);
  finish_range(&p->growth, p->n_point);
  finish_range(&p->y_plus, t->n_any);
  finish_share(t);
}

/* Sorts the faces of triangles by patch; *n out: number of patches with
 * faces. */
static vg_status sort_faces(struct patches_job *j, size_t *n,
                            struct vg_error *err)
{
  const struct vg_columns *c = j->columns;
  const uint32_t *patch = j->surface->tri_patch;
  size_t n_patch = j->surface->n_patch;
  size_t *first = vg_calloc(n_patch + 2, sizeof *first);

  j->face_first = first;
  j->face = vg_alloc(c->n_face, sizeof *j->face);
  if (!first || !j->face) return vg_fail_memory(err, "faces by patch");
  for (size_t f = 0; f < c->n_face; f++)
    if (c->face_tri[f] != VG_NO_INDEX) first[patch[c->face_tri[f]] + 2]++;
  *n = 0;
  for (size_t p = 2; p <= n_patch + 1; p++) {
    *n += first[p] > 0;
    first[p] += first[p - 1];
  }
  /* Filling advances first[p + 1] to the end of p, which is the start of p +
   * 1. */
  for (size_t f = 0; f < c->n_face; f++)
    if (c->face_tri[f] != VG_NO_INDEX)
      j->face[first[patch[c->face_tri[f]] + 1]++] = (uint32_t)f;
  return VG_OK;
}

static vg_status find_fields(struct patches_job *j, struct vg_error *err)
{
  j->field = vg_alloc(j->surface->n_point, sizeof *j->field);
  j->seen = vg_calloc(j->w->n, sizeof *j->seen);
  if (!j->field || !j->seen) return vg_fail_memory(err, "points by patch");
  memset(j->field, 0xff, j->surface->n_point * sizeof *j->field);
  for (size_t i = 0; i < j->w->n; i++) j->field[j->w->point[i]] = (uint32_t)i;
  return VG_OK;
}

static void tally_patch(const struct patches_job *j, size_t patch,
                        struct tally *t, struct tally *sum)
{
  t->p.patch = (uint32_t)patch;
  for (size_t i = j->face_first[patch]; i < j->face_first[patch + 1]; i++) {
    add_face(j, j->face[i], t);
    add_face(j, j->face[i], sum);
    for (int k = 0; k < 3; k++) {
      uint32_t column = j->columns->face[j->face[i]][k];
      uint32_t at = j->field[j->columns->column[column].root];

      if (j->seen[at] == patch + 1) continue;
      if (!j->seen[at]) add_point(j->w, at, sum);
      add_point(j->w, at, t);
      j->seen[at] = (uint32_t)patch + 1;
    }
  }
}

vg_status vg_layers_patches(const struct vg_mesh *surface,
                            const struct vg_columns *columns,
                            const struct vg_wall_fields *fields,
                            double reynolds, double length, size_t *n,
                            struct vg_patch_layers **out,
                            struct vg_patch_layers *all, struct vg_error *err)
{
  vg_status st = VG_OK;
  struct patches_job j = { .surface = surface,
                           .columns = columns,
                           .w = fields,
                           .reynolds = reynolds,
                           .length = length };
  struct tally sum = { .p.patch = VG_NO_INDEX };
  struct vg_patch_layers *list = NULL;
  size_t n_wall = 0, n_done = 0;

  assert(reynolds >= 0 && n && out);
  VG_TRY(find_fields(&j, err));
  VG_TRY(sort_faces(&j, &n_wall, err));
  list = vg_alloc(n_wall, sizeof *list);
  if (!list) {
    st = vg_fail_memory(err, "patches with layers");
    goto done;
  }
  for (size_t p = 0; p < surface->n_patch; p++) {
    struct tally t = { .n_full = 0 };

    if (j.face_first[p] == j.face_first[p + 1]) continue;
    tally_patch(&j, p, &t, &sum);
    finish(&t);
    list[n_done++] = t.p;
  }
  finish(&sum);
  if (all) *all = sum.p;
  *n = n_wall;
  *out = list;
done:
  free(j.face_first);
  free(j.face);
  free(j.field);
  free(j.seen);
  return st;
}
