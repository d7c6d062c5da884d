#include "partition/select.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/hilbert.h"

/* Faces to a box, and boxes to one of the next level. */
enum { RUN = 16, FAN = 8 };

void vg_select_init(struct vg_select *s, const struct vg_front *front,
                    const struct vg_sizing *sizing)
{
  memset(s, 0, sizeof *s);
  s->front = front;
  s->sizing = sizing;
}

void vg_select_release(struct vg_select *s)
{
  for (int k = 0; k < VG_SELECT_LEVELS; k++) free(s->level[k].box);
  free(s->local);
  memset(s, 0, sizeof *s);
}

/* --- boxes --------------------------------------------------------------- */

static const struct vg_select_box empty = {
  {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static int make_boxes(struct vg_select_level *l, size_t n)
{
  if (vg_reserve(&l->box, &l->cap, n, sizeof *l->box)) return -1;
  while (l->n < n) l->box[l->n++] = empty;
  return 0;
}

static void widen(struct vg_select_box *b, const double lo[3],
                  const double hi[3])
{
  for (int k = 0; k < 3; k++) {
    b->lo[k] = lo[k] < b->lo[k] ? lo[k] : b->lo[k];
    b->hi[k] = hi[k] > b->hi[k] ? hi[k] : b->hi[k];
  }
}

/* Faces from..end - 1, all of one run. */
static void widen_run(struct vg_select *s, size_t from, size_t end)
{
  const struct vg_front *f = s->front;
  struct vg_select_box b = s->level[0].box[from / RUN];

  for (size_t i = from; i < end; i++)
    for (int j = 0; j < 3 && f->face[i][0] != VG_FACE_GONE; j++)
      widen(&b, f->x[f->face[i][j]], f->x[f->face[i][j]]);
  s->level[0].box[from / RUN] = b;
}

vg_status vg_select_update(struct vg_select *s, struct vg_error *err)
{
  const struct vg_front *f = s->front;
  size_t from = s->n_face / RUN, n = (f->n_face + RUN - 1) / RUN;

  if (vg_reserve(&s->local, &s->cap_local, f->n_point, sizeof *s->local) ||
      make_boxes(&s->level[0], n))
    return vg_fail_memory(err, "cutting a front");
  for (; s->n_local < f->n_point; s->n_local++)
    s->local[s->n_local] = UINT32_MAX;
  while (s->n_face < f->n_face) {
    size_t end = (s->n_face / RUN + 1) * RUN;

    if (end > f->n_face) end = f->n_face;
    widen_run(s, s->n_face, end);
    s->n_face = end;
  }
  for (int k = 1; k < VG_SELECT_LEVELS && n > 1; k++) {
    const struct vg_select_level *below = &s->level[k - 1];

    n = (n + FAN - 1) / FAN;
    if (make_boxes(&s->level[k], n))
      return vg_fail_memory(err, "cutting a front");
    for (size_t b = from; b < below->n; b++)
      widen(&s->level[k].box[b / FAN], below->box[b].lo, below->box[b].hi);
    from /= FAN;
  }
  return VG_OK;
}

/* --- faces of a region --------------------------------------------------- */

struct list {
  const struct vg_select *s;
  const struct vg_region *region;
  size_t n, cap;
  uint32_t *face;
};

/* The spacing at the foot of any point of a box is at most this. */
static double most_spacing(const struct list *l, const struct vg_select_box *b)
{
  double middle[3], d2 = 0;

  for (int k = 0; k < 3; k++) {
    middle[k] = 0.5 * (b->lo[k] + b->hi[k]);
    d2 += (b->hi[k] - middle[k]) * (b->hi[k] - middle[k]);
  }
  return vg_region_spacing(l->region, l->s->sizing, middle) +
         vg_sizing_slope(l->s->sizing) * sqrt(d2);
}

/* The planes and walls of a region beyond which a triangle of a box may lie:
 * normal . x < least for all corners. */
struct limits {
  int n;
  struct { const double *normal; double sign, least; } of[2 * 2 +
                                                          VG_REGION_WALLS];
};

static void add_limit(struct limits *l, const struct vg_plane *p, double sign,
                      double most, const struct vg_select_box *b)
{
  double least = sign * p->offset - most, nearest = 0;

  for (int k = 0; k < 3; k++) {
    double n = sign * p->normal[k];

    nearest += n * (n > 0 ? b->lo[k] : b->hi[k]);
  }
  if (nearest >= least) return;
  l->of[l->n].normal = p->normal;
  l->of[l->n].sign = sign;
  l->of[l->n++].least = least;
}

static int is_far(const struct limits *l, const double *const x[3])
{
  for (int i = 0; i < l->n; i++) {
    const double *n = l->of[i].normal;
    int beyond = 0;

    for (int k = 0; k < 3; k++)
      beyond += l->of[i].sign * (n[0] * x[k][0] + n[1] * x[k][1] +
                                 n[2] * x[k][2]) < l->of[i].least;
    if (beyond == 3) return 1;
  }
  return 0;
}

static int list_run(struct list *l, size_t run)
{
  const struct vg_front *f = l->s->front;
  const struct vg_region *r = l->region;
  const struct vg_select_box *b = &l->s->level[0].box[run];
  size_t end = (run + 1) * RUN < f->n_face ? (run + 1) * RUN : f->n_face;
  double most = vg_region_band(r, VG_BAND_FRONT) * most_spacing(l, b);
  struct limits limits = { .n = 0 };

  if (vg_reserve(&l->face, &l->cap, l->n + RUN, sizeof *l->face)) return -1;
  for (int i = 0; i < r->n_plane; i++) {
    add_limit(&limits, &r->plane[i], 1, most, b);
    add_limit(&limits, &r->plane[i], -1, most, b);
  }
  for (int i = 0; i < r->n_wall; i++)
    add_limit(&limits, &r->wall[i], 1, most, b);
  for (size_t i = run * RUN; i < end; i++) {
    const double *x[3];

    if (f->face[i][0] == VG_FACE_GONE) continue;
    for (int k = 0; k < 3; k++) x[k] = f->x[f->face[i][k]];
    if (!is_far(&limits, x)) l->face[l->n++] = (uint32_t)i;
  }
  return 0;
}

static int list_box(struct list *l, int level, size_t b)
{
  const struct vg_select_level *at = &l->s->level[level];

  if (!(at->box[b].lo[0] <= at->box[b].hi[0]) ||
      !vg_region_meets_box(l->region, l->s->sizing, at->box[b].lo,
                           at->box[b].hi, VG_BAND_FRONT))
    return 0;
  if (!level) return list_run(l, b);
  for (size_t k = b * FAN; k < (b + 1) * FAN && k < (at - 1)->n; k++)
    if (list_box(l, level - 1, k)) return -1;
  return 0;
}

static int list_faces(struct list *l)
{
  int top = VG_SELECT_LEVELS - 1;

  while (top > 0 && !l->s->level[top].n) top--;
  for (size_t b = 0; b < l->s->level[top].n; b++)
    if (list_box(l, top, b)) return -1;
  return 0;
}

/* Points of the listed faces, numbered as they come. local: [points of the
 * front] all UINT32_MAX, before and after. */
static void number_points(const struct vg_front *f, uint32_t *local, size_t n,
                          const uint32_t *face, struct vg_front *part,
                          uint32_t *point)
{
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t p = f->face[face[i]][k];

      if (local[p] == UINT32_MAX) {
        point[part->n_point] = p;
        memcpy(part->x[part->n_point], f->x[p], sizeof *part->x);
        part->name[part->n_point] = f->name[p];
        local[p] = (uint32_t)part->n_point++;
      }
      part->face[i][k] = local[p];
    }
  part->n_face = n;
  for (size_t i = 0; i < part->n_point; i++) local[point[i]] = UINT32_MAX;
}

static vg_status take(const struct vg_front *f, uint32_t *local, size_t n,
                      const uint32_t *face, struct vg_front *part,
                      uint32_t **point, struct vg_error *err)
{
  size_t n_point = 3 * n < f->n_point ? 3 * n : f->n_point;

  memset(part, 0, sizeof *part);
  part->x = vg_alloc(n_point, sizeof *part->x);
  part->name = vg_alloc(n_point, sizeof *part->name);
  part->face = vg_alloc(n, sizeof *part->face);
  *point = vg_alloc(n_point, sizeof **point);
  if (part->x && part->name && part->face && *point) {
    number_points(f, local, n, face, part, *point);
    return VG_OK;
  }
  vg_front_release(part);
  free(*point);
  *point = NULL;
  return vg_fail_memory(err, "cutting a front");
}

vg_status vg_select_part(struct vg_select *s, const struct vg_region *region,
                         struct vg_front *part, uint32_t **point,
                         uint32_t **face, struct vg_error *err)
{
  struct list l = { .s = s, .region = region };
  vg_status st;

  memset(part, 0, sizeof *part);
  *point = *face = NULL;
  st = list_faces(&l) ? vg_fail_memory(err, "cutting a front") : VG_OK;
  if (st == VG_OK)
    st = take(s->front, s->local, l.n, l.face, part, point, err);
  if (st == VG_OK) *face = l.face;
  else free(l.face);
  return st;
}

vg_status vg_select_near(const struct vg_front *part,
                         const struct vg_region *region,
                         const struct vg_sizing *sizing,
                         struct vg_front *near, uint32_t **point,
                         uint32_t **face, struct vg_error *err)
{
  uint32_t *local = vg_alloc(part->n_point, sizeof *local);
  size_t n = 0;
  vg_status st = VG_OK;

  memset(near, 0, sizeof *near);
  *point = NULL;
  *face = vg_alloc(part->n_face, sizeof **face);
  if (!local || !*face) st = vg_fail_memory(err, "cutting a front");
  for (size_t i = 0; st == VG_OK && i < part->n_face; i++) {
    const uint32_t *v = part->face[i];

    if (vg_region_may_meet(region, sizing, part->x[v[0]], part->x[v[1]],
                           part->x[v[2]], VG_BAND_FRONT))
      (*face)[n++] = (uint32_t)i;
  }
  if (st == VG_OK) {
    memset(local, 0xff, part->n_point * sizeof *local);
    st = take(part, local, n, *face, near, point, err);
  }
  free(local);
  if (st == VG_OK) return VG_OK;
  free(*face);
  *face = NULL;
  return st;
}

vg_status vg_select_sort(struct vg_front *f, struct vg_error *err)
{
  double (*middle)[3] = vg_alloc(f->n_face, sizeof *middle);
  uint32_t *order = vg_alloc(f->n_face, sizeof *order);
  uint32_t (*face)[3] = vg_alloc(f->n_face, sizeof *face);
  vg_status st = VG_OK;

  if (!middle || !order || !face) {
    st = vg_fail_memory(err, "ordering a front");
    goto done;
  }
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++)
      middle[i][k] = (f->x[f->face[i][0]][k] + f->x[f->face[i][1]][k] +
                      f->x[f->face[i][2]][k]) / 3;
  VG_TRY(vg_hilbert_order(f->n_face, (const double (*)[3])middle, order,
                          err));
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
