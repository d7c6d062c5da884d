/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Closes places where a void is still connected across a lattice. Outline:
 * every cell that touches a plane is made in a stage, so the remaining faces
 * are on one side of each plane, except where cells could not be kept because
 * they would have reached into another region. The faces that touch a plane
 * there are grouped into places. The boxes around small places are filled, all
 * at once; these few cells need not be cut by a plane any more. The remaining
 * places are elongated along lines where the spacing grows, or bounded by
 * triangles that reach farther from their plane than the band in which zones
 * know the front. They are grown again plane by plane, as patches of the
 * planes without the interfering regions, and as wide as these triangles. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "partition/cut/node.h"

/* A box extends this many spacings beyond the faces that it is made for; in a
 * metric, spacings across its sides. */
static const double margin = 1.5, patch_margin = 2.5; /* C11 */
/* Larger places, in cubes of their spacing, are not filled. */
static const double most_volume = 1500;
/* A box is not small if it has spacings below this share of its own. */
static const double finer = 0.4;
/* Nor are boxes in which the load expects more cells, since fine spacing may
 * be limited to a corner of a box. */
static const double most_cells = 20000;
/* Patches with more faces are in places where a region failed; with fewer
 * faces a void may be connected all along a body. With more places, the planes
 * do not suit this void. */
enum { MOST_FACES = 4000, MOST_PLACES = 512, MOST_TOUCHING = 16384 };

struct touching {
  int plane;
  uint32_t face;
};

struct place {
  int plane;      /* Plane of a patch, across the axis. */
  size_t n_face;  /* 0: merged into another place. */
  uint32_t first; /* First of its faces. */
  double spacing; /* Smallest spacing at the faces. */
  double wide;    /* Maximum distance of a patch from the plane, in spacings. */
  double lo[3], hi[3];
};

struct search {
  const struct vg_node *n;
  const struct vg_sizing *sizing;
  int axis; /* Axis normal to the patches; -1: boxes. */
  double margin;
  int is_cut; /* 1: a limit was exceeded. */
  size_t n_touching, cap_touching;
  struct touching *touching;
  uint32_t *parent; /* [n_touching] Union-find of faces that share a point. */
  size_t n_place, cap_place;
  struct place *place;
};

static void extent_of(const struct search *s, uint32_t face, int axis,
                      double *lo, double *hi)
{
  const struct vg_front *f = &s->n->front;
  const uint32_t *v = f->face[face];
  double a = f->x[v[0]][axis], b = f->x[v[1]][axis], c = f->x[v[2]][axis];

  *lo = fmin(fmin(a, b), c);
  *hi = fmax(fmax(a, b), c);
}

static int add_touching(struct search *s, int plane, uint32_t face)
{
  if (vg_reserve(&s->touching, &s->cap_touching, s->n_touching + 1,
                 sizeof *s->touching))
    return -1;
  s->touching[s->n_touching++] = (struct touching){ plane, face };
  return 0;
}

static int add_planes(struct search *s, uint32_t face)
{
  const struct vg_lattice *l = &s->n->lattice;
  double lo, hi;

  extent_of(s, face, s->axis, &lo, &hi);
  for (int i = 0; i < l->n[s->axis]; i++)
    if (l->at[s->axis][i] >= lo && l->at[s->axis][i] <= hi &&
        add_touching(s, i, face))
      return -1;
  return 0;
}

static vg_status list_touching(struct search *s, struct vg_error *err)
{
  for (size_t k = 0; k < s->n->n_open; k++) {
    uint32_t i = s->n->open[k];

    if (s->n_touching >= MOST_TOUCHING) {
      s->n_touching = 0;
      s->is_cut = 1;
      return VG_OK;
    }
    if (s->axis < 0 ? add_touching(s, 0, i) : add_planes(s, i))
      return vg_fail_memory(err, "cutting a front");
  }
  return VG_OK;
}

static int by_point(const void *a, const void *b)
{
  const uint64_t *s = a, *t = b;

  return (*s > *t) - (*s < *t);
}

/* Unites the faces of a plane that share a point into one place. The lowest of
 * them is the root. */
static vg_status unite_touching(struct search *s, struct vg_error *err)
{
  size_t m = 0;
  uint64_t *key = vg_alloc(3 * s->n_touching, sizeof *key);

  s->parent = vg_alloc(s->n_touching, sizeof *s->parent);
  if (!key || !s->parent) {
    free(key);
    return vg_fail_memory(err, "cutting a front");
  }
  for (uint32_t i = 0; i < s->n_touching; i++) {
    const uint32_t *v = s->n->front.face[s->touching[i].face];

    s->parent[i] = i;
    for (int k = 0; k < 3; k++) key[m++] = (uint64_t)v[k] << 32 | i;
  }
  qsort(key, m, sizeof *key, by_point);
  for (size_t i = 1; i < m; i++) {
    uint32_t a = (uint32_t)key[i - 1], b = (uint32_t)key[i];

    if (key[i - 1] >> 32 != key[i] >> 32 ||
        s->touching[a].plane != s->touching[b].plane)
      continue;
    vg_union(s->parent, a, b);
  }
  free(key);
  return VG_OK;
}

static void widen(struct place *p, const struct place *by)
{
  for (int k = 0; k < 3; k++) {
    p->lo[k] = fmin(p->lo[k], by->lo[k]);
    p->hi[k] = fmax(p->hi[k], by->hi[k]);
  }
  p->spacing = fmin(p->spacing, by->spacing);
  p->wide = fmax(p->wide, by->wide);
  p->n_face += by->n_face;
}

/* Distance of a face from its plane, in spacings on the plane. */
static double width_of(const struct search *s, const struct touching *t)
{
  const struct vg_front *f = &s->n->front;
  const double across[3] = { s->axis == 0, s->axis == 1, s->axis == 2 };
  double at = s->n->lattice.at[s->axis][t->plane], most = 0;

  for (int k = 0; k < 3; k++) {
    const double *x = f->x[f->face[t->face][k]];
    double foot[3] = { x[0], x[1], x[2] };

    foot[s->axis] = at;
    most = fmax(most, fabs(x[s->axis] - at) /
                        vg_sizing_across(s->sizing, foot, across));
  }
  return most;
}

static void place_of_face(const struct search *s, const struct touching *t,
                          struct place *out)
{
  double middle[3];

  out->first = t->face;
  out->plane = t->plane;
  out->n_face = 1;
  for (int k = 0; k < 3; k++) {
    extent_of(s, t->face, k, &out->lo[k], &out->hi[k]);
    middle[k] = 0.5 * (out->lo[k] + out->hi[k]);
  }
  out->spacing = vg_sizing_at(s->sizing, middle);
  out->wide = s->axis < 0 ? 0 : width_of(s, t);
  for (int k = 0; k < 3; k++) {
    const double normal[3] = { k == 0, k == 1, k == 2 };
    double room = s->margin * vg_sizing_across(s->sizing, middle, normal);

    out->lo[k] -= room;
    out->hi[k] += room;
  }
}

static vg_status make_places(struct search *s, struct vg_error *err)
{
  uint32_t *place = vg_alloc(s->n_touching, sizeof *place);
  vg_status st = place ? VG_OK : vg_fail_memory(err, "cutting a front");

  for (uint32_t i = 0; st == VG_OK && i < s->n_touching; i++) {
    uint32_t root = vg_root_of(s->parent, i);
    struct place one;

    place_of_face(s, &s->touching[i], &one);
    if (root != i) {
      widen(&s->place[place[root]], &one);
      continue;
    }
    if (vg_reserve(&s->place, &s->cap_place, s->n_place + 1,
                   sizeof *s->place)) {
      st = vg_fail_memory(err, "cutting a front");
      break;
    }
    place[i] = (uint32_t)s->n_place;
    s->place[s->n_place++] = one;
  }
  free(place);
  return st;
}

/* Point i of 3 x 3 x 3 in the box. */
static void point_in(const struct place *p, int i, double x[3])
{
  for (int k = 0; k < 3; k++, i /= 3)
    x[k] = p->lo[k] + 0.5 * (i % 3) * (p->hi[k] - p->lo[k]);
}

/* Are few cells expected in the box by the complexity at some points? A box
 * around oblique cells extends across many of them, where the sizes differ and
 * the octants of the load are large. */
static int is_small_in_metric(const struct search *s, const struct place *p)
{
  double each = VG_LOAD_CELLS_PER_CUBE / 27, n = 0;

  for (int k = 0; k < 3; k++) each *= p->hi[k] - p->lo[k];
  for (int i = 0; i < 27 && n <= most_cells; i++) {
    double x[3], h;

    point_in(p, i, x);
    h = vg_sizing_at(s->sizing, x);
    n += each / (h * h * h);
  }
  return n <= most_cells;
}

/* Are few cells expected in the box, by the spacing at the faces, by the
 * spacing elsewhere in the box, and by the load? */
static int is_small(const struct search *s, const struct place *p)
{
  double volume = 1, x[3];

  if (vg_sizing_is_stretched(s->sizing)) return is_small_in_metric(s, p);
  for (int k = 0; k < 3; k++) volume *= (p->hi[k] - p->lo[k]) / p->spacing;
  for (int i = 0; i < 27 && volume <= most_volume; i++) {
    point_in(p, i, x);
    if (vg_sizing_at(s->sizing, x) < finer * p->spacing) return 0;
  }
  return volume <= most_volume &&
         vg_load_within(&s->n->load, p->lo, p->hi) <= most_cells;
}

static int overlap(const struct place *a, const struct place *b)
{
  for (int k = 0; k < 3; k++)
    if (a->lo[k] >= b->hi[k] || b->lo[k] >= a->hi[k]) return 0;
  return 1;
}

static int by_spacing(const void *a, const void *b)
{
  const struct place *p = a, *q = b;

  if (p->spacing != q->spacing) return p->spacing < q->spacing ? -1 : 1;
  return (p->first > q->first) - (p->first < q->first);
}

/* Merges p with all places that it overlaps, as long as the result stays
 * small; they leave the list, and p replaces them. Otherwise p is dropped. */
static int absorb(const struct search *s, struct place *list, size_t *n,
                  struct place *p)
{
  uint8_t is_taken[MOST_PLACES] = { 0 };
  size_t left = 0;
  struct place all = *p;
  int again = 1;

  while (again) {
    again = 0;
    for (size_t k = 0; k < *n; k++) {
      if (is_taken[k] || !overlap(&list[k], &all)) continue;
      widen(&all, &list[k]);
      again = is_taken[k] = 1;
    }
  }
  if (!is_small(s, &all)) return 0;
  for (size_t k = 0; k < *n; k++)
    if (!is_taken[k]) list[left++] = list[k];
  *n = left;
  *p = all;
  return 1;
}

/* Chooses small boxes that do not overlap, the finest first. */
static void choose_places(struct search *s)
{
  size_t n = 0;

  qsort(s->place, s->n_place, sizeof *s->place, by_spacing);
  for (size_t k = 0; k < s->n_place; k++) {
    struct place p = s->place[k];

    if (absorb(s, s->place, &n, &p)) s->place[n++] = p;
  }
  s->n_place = n;
}

/* Merges overlapping patches of a plane. */
static void merge_patches(struct search *s)
{
  int again = 1, b = (s->axis + 1) % 3, c = (s->axis + 2) % 3;

  while (again) {
    again = 0;
    for (size_t i = 0; i < s->n_place; i++)
      for (size_t j = i + 1; j < s->n_place; j++) {
        struct place *p = &s->place[i], *q = &s->place[j];

        if (p->plane != q->plane || !p->n_face || !q->n_face ||
            p->lo[b] >= q->hi[b] || q->lo[b] >= p->hi[b] ||
            p->lo[c] >= q->hi[c] || q->lo[c] >= p->hi[c])
          continue;
        widen(p, q);
        q->n_face = 0;
        again = 1;
      }
  }
}

static void box_region(const struct place *p, struct vg_region *r)
{
  memset(r, 0, sizeof *r);
  for (int k = 0; k < 3; k++) {
    r->wall[r->n_wall].normal[k] = 1;
    r->wall[r->n_wall++].offset = p->lo[k];
    r->wall[r->n_wall].normal[k] = -1;
    r->wall[r->n_wall++].offset = -p->hi[k];
  }
}

static vg_status to_regions(struct search *s, struct vg_region **region,
                            size_t *n_region, struct vg_error *err)
{
  *region = vg_alloc(s->n_place, sizeof **region);
  if (!*region) return vg_fail_memory(err, "cutting a front");
  for (size_t k = 0; k < s->n_place; k++) {
    const struct place *p = &s->place[k];
    struct vg_region *r = &(*region)[*n_region];

    if (s->axis < 0) {
      box_region(p, r);
    } else {
      if (!p->n_face || p->n_face > MOST_FACES) {
        s->is_cut |= p->n_face > MOST_FACES;
        continue;
      }
      vg_lattice_patch(&s->n->lattice, s->axis, p->plane, p->lo, p->hi, r);
      r->wide = fmax(p->wide + margin - VG_BAND_FLUID, 0);
    }
    ++*n_region;
  }
  return VG_OK;
}

vg_status vg_node_open_places(struct vg_partition *p, struct vg_node *n,
                              int axis, const struct vg_engine *e,
                              struct vg_region **region, size_t *n_region,
                              struct vg_error *err)
{
  struct search s = { .n = n,
                      .sizing = p->sizing,
                      .axis = axis,
                      .margin = axis < 0 ? margin : patch_margin };
  vg_status st;

  assert(axis >= -1 && axis < 3);
  assert(region && n_region);
  *region = NULL;
  *n_region = 0;
  if (axis >= 0 && !n->lattice.n[axis]) return VG_OK;
  VG_TRY(vg_node_list_open(n, e, err));
  VG_TRY(list_touching(&s, err));
  if (!s.n_touching) goto done;
  VG_TRY(unite_touching(&s, err));
  VG_TRY(make_places(&s, err));
  if (s.n_place > MOST_PLACES) {
    s.is_cut = 1;
    goto done;
  }
  if (axis < 0) choose_places(&s);
  else merge_patches(&s);
  st = to_regions(&s, region, n_region, err);
done:
  if (s.is_cut) {
    pthread_mutex_lock(&p->lock);
    p->report.n_open_left++;
    pthread_mutex_unlock(&p->lock);
  }
  free(s.touching);
  free(s.parent);
  free(s.place);
  return st;
}
