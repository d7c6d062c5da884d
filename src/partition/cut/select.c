/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/select.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/geometry/hilbert.h"
#include "partition/engine/engine_memory.h"

/* Faces per box, boxes per box of the next level, and boxes per chunk of a
 * loop. */
enum { RUN = 16, FAN = 8, CHUNK = 512 };

/* Distances in spacings: a face this near a plane counts as crossing it; and
 * the front must be known this far beyond the faces that cross it. */
static const double crossing = 0.1, margin = 1.5; /* K22 */

void vg_select_init(struct vg_select *s, const struct vg_front *front,
                    const struct vg_sizing *sizing)
{
  assert(s && front && sizing);
  memset(s, 0, sizeof *s);
  s->front = front;
  s->sizing = sizing;
}

void vg_select_release(struct vg_select *s)
{
  for (int k = 0; k < VG_SELECT_LEVELS; k++) free(s->level[k].box);
  memset(s, 0, sizeof *s);
}

/* Spacings with a smaller ratio count as equal. */
static const double close_enough = 1.1;

/* --- boxes --------------------------------------------------------------- */

/* Boxes of a level from `first` on have new items below, which begin at
 * `from`; boxes from n on are new themselves. */
struct update {
  struct vg_select *s;
  int level;
  size_t first, from, n;
};

static void widen_run(const struct update *u, size_t run, struct vg_box *b)
{
  const struct vg_front *f = u->s->front;
  size_t end = (run + 1) * RUN < f->n_face ? (run + 1) * RUN : f->n_face;
  size_t from = run * RUN > u->from ? run * RUN : u->from;

  for (size_t i = from; i < end; i++)
    for (int j = 0; j < 3 && f->face[i][0] != VG_FACE_GONE; j++)
      vg_box_add(b, f->x[f->face[i][j]]);
}

static void widen_box(const struct update *u, size_t box, struct vg_box *b)
{
  const struct vg_select_level *below = &u->s->level[u->level - 1];
  size_t end = (box + 1) * FAN < below->n ? (box + 1) * FAN : below->n;
  size_t from = box * FAN > u->from ? box * FAN : u->from;

  for (size_t i = from; i < end; i++) vg_box_join(b, &below->box[i]);
}

static void update_part(void *context, size_t first, size_t end, int worker)
{
  const struct update *u = context;
  struct vg_box *box = u->s->level[u->level].box;

  (void)worker;
  for (size_t i = u->first + first; i < u->first + end; i++) {
    struct vg_box b = VG_BOX_EMPTY;

    if (i < u->n) b = box[i];
    if (u->level) widen_box(u, i, &b);
    else widen_run(u, i, &b);
    box[i] = b;
  }
}

vg_status vg_select_update(struct vg_select *s, const struct vg_engine *e,
                           struct vg_error *err)
{
  size_t from = s->n_face, below = s->front->n_face;

  assert(s->n_face <= s->front->n_face);
  for (int k = 0; k < VG_SELECT_LEVELS && (!k || below > 1); k++) {
    struct vg_select_level *l = &s->level[k];
    size_t fan = k ? FAN : RUN, n = (below + fan - 1) / fan;
    struct update u = { s, k, 0, l->n ? from : 0, l->n };

    u.first = u.from / fan;
    if (vg_engine_reserve(e, &l->box, &l->cap, l->n, n, sizeof *l->box))
      return vg_fail_memory(err, "cutting a front");
    if (n > u.first) vg_engine_loop(e, n - u.first, CHUNK, update_part, &u);
    l->n = n;
    from = u.first;
    below = n;
  }
  s->n_face = s->front->n_face;
  return VG_OK;
}

/* --- faces of a region --------------------------------------------------- */

struct list {
  const struct vg_select *s;
  const struct vg_region *region;
  double band, least; /* Band in spacings, including the region's reach; the
                         smallest spacing anywhere. */
  size_t n, cap;
  uint32_t *face;
};

/* Upper bound of the spacing at the foot of any point of a box. */
static double most_spacing(const struct list *l, const struct vg_box *b)
{
  double least, most;

  vg_region_spacing_within(l->region, l->s->sizing, b->lo, b->hi, &least,
                           &most);
  return most;
}

/* Distance by which sign * n . x is below sign * offset in the whole box. */
static double beyond(const struct vg_plane *p, double sign,
                     const struct vg_box *b)
{
  double far = sign * p->offset;

  for (int k = 0; k < 3; k++) {
    double n = sign * p->normal[k];

    far -= n * (n > 0 ? b->hi[k] : b->lo[k]);
  }
  return far;
}

/* Largest distance of a box from a plane, or beyond a wall, where distances
 * are weighted; the search ends once it exceeds `enough`. */
static double distance(const struct vg_region *r, const struct vg_box *b,
                       double enough)
{
  double far = 0;

  for (int i = 0; i < r->n_plane && far <= enough; i++)
    far = fmax(far,
               fmax(beyond(&r->plane[i], 1, b), beyond(&r->plane[i], -1, b)));
  for (int i = 0; i < r->n_wall && far <= enough; i++)
    far = fmax(far, beyond(&r->wall[i], 1, b) / VG_BEYOND_WALLS);
  return far;
}

/* Planes and walls of a region beyond which a triangle in a box may lie:
 * normal . x < least for all corners. */
struct limits {
  int n;
  struct {
    double normal[3], least;
  } of[2 * 2 + VG_REGION_WALLS];
};

static void add_limit(struct limits *l, const struct vg_plane *p, double sign,
                      double most, const struct vg_box *b)
{
  double least = sign * p->offset - most, nearest = 0;

  for (int k = 0; k < 3; k++) {
    double n = l->of[l->n].normal[k] = sign * p->normal[k];

    nearest += n * (n > 0 ? b->lo[k] : b->hi[k]);
  }
  if (nearest < least) l->of[l->n++].least = least;
}

static int is_far(const struct limits *l, const double *const x[3])
{
  for (int i = 0; i < l->n; i++) {
    const double *n = l->of[i].normal;
    int k = 0;

    while (k < 3 &&
           n[0] * x[k][0] + n[1] * x[k][1] + n[2] * x[k][2] < l->of[i].least)
      k++;
    if (k == 3) return 1;
  }
  return 0;
}

static int list_run(struct list *l, size_t run, double most)
{
  const struct vg_front *f = l->s->front;
  const struct vg_region *r = l->region;
  const struct vg_box *b = &l->s->level[0].box[run];
  size_t end = (run + 1) * RUN < f->n_face ? (run + 1) * RUN : f->n_face;
  struct limits limits = { .n = 0 };

  if (vg_reserve(&l->face, &l->cap, l->n + RUN, sizeof *l->face)) return -1;
  for (int i = 0; i < r->n_plane; i++) {
    add_limit(&limits, &r->plane[i], 1, l->band * most, b);
    add_limit(&limits, &r->plane[i], -1, l->band * most, b);
  }
  for (int i = 0; i < r->n_wall; i++)
    add_limit(&limits, &r->wall[i], 1, VG_BEYOND_WALLS * l->band * most, b);
  for (size_t i = run * RUN; i < end; i++) {
    const double *x[3];

    if (f->face[i][0] == VG_FACE_GONE) continue;
    for (int k = 0; k < 3; k++) x[k] = f->x[f->face[i][k]];
    if (!is_far(&limits, x)) l->face[l->n++] = (uint32_t)i;
  }
  return 0;
}

/* most: upper bound of the spacing in the box, from the boxes around it; the
 * sizing field is queried only if it matters. */
static int list_box(struct list *l, int level, size_t b, double most)
{
  const struct vg_select_level *at = &l->s->level[level];
  const struct vg_box *box = &at->box[b];
  double far;

  if (!(box->lo[0] <= box->hi[0])) return 0;
  far = distance(l->region, box, l->band * most);
  if (far > l->band * most) return 0;
  if (most > close_enough * l->least && (!level || far > l->band * l->least)) {
    most = fmin(most, most_spacing(l, box));
    if (far > l->band * most) return 0;
  }
  if (!level) return list_run(l, b, most);
  for (size_t k = b * FAN; k < (b + 1) * FAN && k < (at - 1)->n; k++)
    if (list_box(l, level - 1, k, most)) return -1;
  return 0;
}

static int list_faces(struct list *l)
{
  int top = VG_SELECT_LEVELS - 1;
  double most;

  vg_sizing_range_along(l->s->sizing, &l->least, &most);
  while (top > 0 && !l->s->level[top].n) top--;
  for (size_t b = 0; b < l->s->level[top].n; b++)
    if (list_box(l, top, b, most)) return -1;
  return 0;
}

/* Local numbers of the listed points. The table is as large as the selected
 * part; an array over all points would be as long as the front, in each
 * thread. */
struct numbers {
  struct vg_table table;
  size_t n;        /* Points listed. */
  uint32_t *point; /* [n] */
};

static uint64_t hash_of(const void *numbers, uint32_t k)
{
  return vg_hash_1(((const struct numbers *)numbers)->point[k]);
}

/* Numbers the corners of the listed faces by first use; to: [n] these faces in
 * local numbers. */
static int number_points(struct numbers *t, const uint32_t (*from)[3], size_t n,
                         const uint32_t *face, uint32_t (*to)[3])
{
  if (vg_table_init(&t->table, n / 2 + 8)) return -1;
  for (size_t i = 0; i < n; i++) {
    if (vg_table_reserve(&t->table, t->n + 3, hash_of, t)) return -1;
    for (int k = 0; k < 3; k++) {
      uint32_t p = from[face[i]][k], *at;

      VG_TABLE_FIND(&t->table, at, vg_hash_1(p), t->point[*at] == p);
      if (*at == VG_TABLE_FREE) {
        t->point[t->n] = p;
        *at = (uint32_t)t->n++;
      }
      to[i][k] = *at;
    }
  }
  return 0;
}

static int gather(const struct vg_front *f, const struct numbers *t,
                  struct vg_front *part)
{
  part->x = vg_alloc(t->n, sizeof *part->x);
  part->id = vg_alloc(t->n, sizeof *part->id);
  if (!part->x || !part->id) return -1;
  part->n_point = t->n;
  for (size_t k = 0; k < t->n; k++) {
    memcpy(part->x[k], f->x[t->point[k]], sizeof *part->x);
    part->id[k] = f->id[t->point[k]];
  }
  return 0;
}

static vg_status take(const struct vg_front *f, size_t n, const uint32_t *face,
                      struct vg_front *part, uint32_t **point,
                      struct vg_error *err)
{
  struct numbers t = { .n = 0 };
  int bad;

  memset(part, 0, sizeof *part);
  t.point = vg_alloc(3 * n < f->n_point ? 3 * n : f->n_point, sizeof *t.point);
  part->face = vg_alloc(n, sizeof *part->face);
  part->n_face = n;
  bad = !t.point || !part->face ||
        number_points(&t, (const uint32_t(*)[3])f->face, n, face, part->face) ||
        gather(f, &t, part);
  vg_table_release(&t.table);
  if (!bad) {
    uint32_t *less = vg_realloc(t.point, t.n, sizeof *t.point);

    *point = less ? less : t.point;
    return VG_OK;
  }
  vg_front_release(part);
  free(t.point);
  *point = NULL;
  return vg_fail_memory(err, "cutting a front");
}

/* Returns the list of faces without spare room, for the caller. */
static uint32_t *shrunk(struct list *l)
{
  uint32_t *less = vg_realloc(l->face, l->n, sizeof *l->face);

  return less ? less : l->face;
}

vg_status vg_select_part(const struct vg_select *s,
                         const struct vg_region *region, struct vg_front *part,
                         uint32_t **point, uint32_t **face,
                         struct vg_error *err)
{
  struct list l = { .s = s,
                    .region = region,
                    .band = vg_region_band(region, VG_BAND_FRONT) };
  vg_status st;

  assert(vg_region_is_sound(region) && part && point && face);
  memset(part, 0, sizeof *part);
  *point = *face = NULL;
  st = list_faces(&l) ? vg_fail_memory(err, "cutting a front") : VG_OK;
  if (st == VG_OK) st = take(s->front, l.n, l.face, part, point, err);
  if (st == VG_OK) *face = shrunk(&l);
  else free(l.face);
  return st;
}

/* Distance of the corner of a face farthest from a plane, in spacings at its
 * foot. */
static double farthest(const struct list *l, const double *const x[3])
{
  const struct vg_region *r = l->region;
  double most = 0;

  for (int k = 0; k < 3; k++) {
    int is_stretched = vg_sizing_is_stretched(l->s->sizing);
    double h[VG_REGION_SIDES];

    if (is_stretched) vg_region_across(r, l->s->sizing, x[k], h);
    else h[0] = vg_region_spacing(r, l->s->sizing, x[k]);
    for (int i = 0; i < r->n_plane; i++) {
      const double *n = r->plane[i].normal;
      double d = n[0] * x[k][0] + n[1] * x[k][1] + n[2] * x[k][2] -
                 r->plane[i].offset;

      most = fmax(most, fabs(d) / h[is_stretched ? i : 0]);
    }
  }
  return most;
}

vg_status vg_select_widen(const struct vg_select *s, struct vg_region *region,
                          struct vg_error *err)
{
  double band = crossing - region->reach;
  struct list l = { .s = s,
                    .region = region,
                    .band = vg_region_band(region, band) };
  vg_status st = VG_OK;
  double most = 0;

  assert(vg_region_is_sound(region));
  if (list_faces(&l)) st = vg_fail_memory(err, "cutting a front");
  for (size_t i = 0; st == VG_OK && i < l.n; i++) {
    const double *x[3];

    for (int k = 0; k < 3; k++)
      x[k] = s->front->x[s->front->face[l.face[i]][k]];
    if (vg_region_meets(region, s->sizing, x[0], x[1], x[2], band))
      most = fmax(most, farthest(&l, x));
  }
  free(l.face);
  region->wide = most > VG_BAND_FLUID ? most + margin - VG_BAND_FLUID : 0;
  return st;
}

/* Lists the faces of the part that are near enough: [n], ascending. */
static vg_status list_near(const struct vg_front *part,
                           const struct vg_region *region,
                           const struct vg_sizing *sizing, uint32_t *near,
                           size_t *n, struct vg_error *err)
{
  struct vg_region_cache cache = { .spacing = NULL };
  vg_status st = vg_region_cache_init(&cache, region, sizing, part->n_point,
                                      (const double(*)[3])part->x, err);

  *n = 0;
  for (size_t i = 0; st == VG_OK && i < part->n_face; i++)
    if (vg_region_cache_may_meet(&cache, part->face[i], VG_BAND_FRONT))
      near[(*n)++] = (uint32_t)i;
  vg_region_cache_release(&cache);
  return st;
}

vg_status vg_select_near(struct vg_front *part, const struct vg_region *region,
                         const struct vg_sizing *sizing, uint32_t **point,
                         uint32_t **face, struct vg_error *err)
{
  uint32_t *near = vg_alloc(part->n_face, sizeof *near), *of_part = NULL;
  struct vg_front less = VG_FRONT_INIT;
  size_t n = 0;
  vg_status st = near ? list_near(part, region, sizing, near, &n, err)
                      : vg_fail_memory(err, "cutting a front");

  assert(vg_region_is_sound(region) && *point && *face);
  if (st < 0 || n == part->n_face) goto done;
  VG_TRY(take(part, n, near, &less, &of_part, err));
  for (size_t k = 0; k < less.n_point; k++) of_part[k] = (*point)[of_part[k]];
  for (size_t i = 0; i < n; i++) near[i] = (*face)[near[i]];
  vg_front_release(part);
  free(*point);
  free(*face);
  *part = less;
  *point = of_part;
  *face = near;
  return VG_OK;
done:
  free(near);
  return st;
}

/* --- faces that a triangle may touch ------------------------------------- */

struct touch {
  const struct vg_select *s;
  const double *const *x;
  double lo[3], hi[3], normal[3];
  double size, most; /* Longest side; largest coordinate. */
  int (*visit)(void *context, uint32_t face);
  void *context;
};

static void touch_init(struct touch *t)
{
  const double *const *x = t->x;

  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3, m = (k + 2) % 3;

    t->lo[k] = fmin(fmin(x[0][k], x[1][k]), x[2][k]);
    t->hi[k] = fmax(fmax(x[0][k], x[1][k]), x[2][k]);
    t->normal[k] = (x[1][l] - x[0][l]) * (x[2][m] - x[0][m]) -
                   (x[1][m] - x[0][m]) * (x[2][l] - x[0][l]);
    t->size += t->hi[k] - t->lo[k];
    t->most = fmax(t->most, fmax(fabs(t->lo[k]), fabs(t->hi[k])));
  }
}

/* Is the box disjoint from the triangle's box, or on one side of its plane?
 * The tolerance is well above the rounding error. */
static int is_separated(const struct touch *t, const double lo[3],
                        const double hi[3])
{
  double middle = 0, reach = 0, size = t->size;

  for (int k = 0; k < 3; k++) {
    double x = 0.5 * (lo[k] + hi[k]) - t->x[0][k], half = 0.5 * (hi[k] - lo[k]);

    if (lo[k] > t->hi[k] || hi[k] < t->lo[k]) return 1;
    middle += t->normal[k] * x;
    reach += fabs(t->normal[k]) * half;
    size += fabs(x) + half;
  }
  return fabs(middle) > reach + 1e-14 * (t->most + size) * t->size * size;
}

static int touch_run(const struct touch *t, size_t run)
{
  const struct vg_front *f = t->s->front;
  size_t end = (run + 1) * RUN < t->s->n_face ? (run + 1) * RUN : t->s->n_face;

  for (size_t i = run * RUN; i < end; i++) {
    struct vg_box b = VG_BOX_EMPTY;
    int found;

    if (f->face[i][0] == VG_FACE_GONE) continue;
    for (int j = 0; j < 3; j++) vg_box_add(&b, f->x[f->face[i][j]]);
    if (is_separated(t, b.lo, b.hi)) continue;
    found = t->visit(t->context, (uint32_t)i);
    if (found) return found;
  }
  return 0;
}

static int touch_box(const struct touch *t, int level, size_t b)
{
  const struct vg_select_level *at = &t->s->level[level];
  const struct vg_box *box = &at->box[b];

  if (!(box->lo[0] <= box->hi[0]) || is_separated(t, box->lo, box->hi))
    return 0;
  if (!level) return touch_run(t, b);
  for (size_t k = b * FAN; k < (b + 1) * FAN && k < (at - 1)->n; k++) {
    int found = touch_box(t, level - 1, k);

    if (found) return found;
  }
  return 0;
}

int vg_select_touched(const struct vg_select *s, const double *const x[3],
                      int (*visit)(void *context, uint32_t face), void *context)
{
  struct touch t = { .s = s, .x = x, .visit = visit, .context = context };
  int top = VG_SELECT_LEVELS - 1, found = 0;

  assert(s->front && x && visit);
  touch_init(&t);
  while (top > 0 && !s->level[top].n) top--;
  for (size_t b = 0; b < s->level[top].n && !found; b++)
    found = touch_box(&t, top, b);
  return found;
}

vg_status vg_select_sort(struct vg_front *f, struct vg_error *err)
{
  double(*middle)[3] = vg_alloc(f->n_face, sizeof *middle);
  uint32_t *order = vg_alloc(f->n_face, sizeof *order);
  uint32_t(*face)[3] = vg_alloc(f->n_face, sizeof *face);
  vg_status st = VG_OK;

  if (!middle || !order || !face) {
    st = vg_fail_memory(err, "ordering a front");
    goto done;
  }
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++)
      middle[i][k] = (f->x[f->face[i][0]][k] + f->x[f->face[i][1]][k] +
                      f->x[f->face[i][2]][k]) /
                     3;
  VG_TRY(vg_hilbert_order(f->n_face, (const double(*)[3])middle, order, err));
  for (size_t i = 0; i < f->n_face; i++)
    memcpy(face[i], f->face[order[i]], sizeof *face);
  free(f->face);
  f->face = face;
  face = NULL;
done:
  free(middle);
  free(order);
  free(face);
  return st;
}
