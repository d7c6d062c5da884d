/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sides/zone_map.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/predicates.h"
#include "core/geometry/volume.h"
#include "core/mesh/copies.h"
#include "core/sides/sides.h"
#include "core/sides/zone_line.h"

struct work {
  const struct vg_mesh *m;
  struct vg_zone_map *z;
  size_t n_single;       /* triangles without the backs of inner surfaces */
  uint32_t *single;      /* [n_single] their numbers */
  uint32_t (*tri)[3];    /* [n_single] with the first points at a place */
  struct vg_sides sides; /* of these */
  uint32_t *up, *part;   /* [sides.n_region] regions that are one; those of a
                            component */
  uint32_t *first;       /* [n_point] first point at the place, or NULL */
};

static const struct vg_patch *patch_of(const struct work *w, size_t i)
{
  return &w->m->patch[w->m->tri_patch[w->single[i]]];
}

static void corners(const struct vg_mesh *m, const uint32_t v[3],
                    const double *x[3])
{
  for (int k = 0; k < 3; k++) x[k] = m->point[v[k]];
}

/* The half-face of triangle i, 2 i or 2 i + 1, that looks to x; UINT32_MAX if x
 * is in its plane. */
static uint32_t half_to(const struct work *w, size_t i, const double *x)
{
  const double *c[3];
  double side;

  corners(w->m, w->tri[i], c);
  side = vg_orient3d(c[0], c[1], c[2], x);
  return side == 0 ? UINT32_MAX : (uint32_t)(2 * i) + (side < 0);
}

/* --- one side of each triangle ---------------------------------------------
 */

static vg_status take_single(struct work *w, struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  vg_status st;

  w->single = vg_alloc(m->n_tri, sizeof *w->single);
  w->tri = vg_alloc(m->n_tri, sizeof *w->tri);
  if (!w->single || !w->tri) return vg_fail_memory(err, "the zones");
  VG_TRY(vg_mesh_inner_points(m, &w->first, err));
  for (uint32_t t = 0; t < m->n_tri; t++) {
    if (m->patch[m->tri_patch[t]].inner == VG_INNER_BACK) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t p = m->tri[t][k];

      w->tri[w->n_single][k] = w->first ? w->first[p] : p;
    }
    w->single[w->n_single++] = t;
  }
  st = vg_sides_build(&w->sides, m->n_point, (const double(*)[3])m->point,
                      w->n_single, (const uint32_t(*)[3])w->tri, err);
  if (st < 0) return st;
  w->up = vg_alloc(w->sides.n_region, sizeof *w->up);
  w->part = vg_alloc(w->sides.n_region, sizeof *w->part);
  if (!w->up || !w->part) return vg_fail_memory(err, "the zones");
  for (uint32_t r = 0; r < w->sides.n_region; r++) w->up[r] = w->part[r] = r;
done:
  return st;
}

/* Sheets other than interfaces do not separate regions. */
static void pass_sheets(struct work *w)
{
  for (size_t i = 0; i < w->n_single; i++) {
    const struct vg_patch *p = patch_of(w, i);
    const uint32_t *r = w->sides.region + 2 * i;

    vg_union(w->part, r[0], r[1]);
    if (p->is_sheet && !p->is_interface) vg_union(w->up, r[0], r[1]);
  }
}

/* --- components of the surface --------------------------------------------
 */

struct crossing {
  double at;
  uint32_t tri, half; /* half: of the side from which the line comes */
};

static int by_place(const void *a, const void *b)
{
  const struct crossing *p = a, *q = b;

  if (p->at != q->at) return p->at < q->at ? -1 : 1;
  return p->tri < q->tri ? -1 : p->tri > q->tri;
}

struct line {
  const struct work *w;
  uint32_t from, to; /* triangles at its ends */
  double a[3], b[3];
  struct crossing *list;
  size_t n, cap;
  int is_bad; /* 1: it meets a border, -1: no memory */
};

static void meet(struct line *l, uint32_t i)
{
  const double *x[3];
  int hit;

  if (l->is_bad || i == l->from || i == l->to) return;
  corners(l->w->m, l->w->tri[i], x);
  hit = vg_line_crosses(x, l->a, l->b);
  if (hit < 0) l->is_bad = 1;
  if (hit <= 0) return;
  if (vg_reserve(&l->list, &l->cap, l->n + 1, sizeof *l->list)) l->is_bad = -1;
  else
    l->list[l->n++] = (struct crossing){ vg_line_at(x, l->a, l->b), i,
                                         half_to(l->w, i, l->a) };
}

static void unite(struct work *w, uint32_t g, uint32_t h)
{
  vg_union(w->up, w->sides.region[g], w->sides.region[h]);
}

/* Regions on both sides of each gap between two triangles on the line are one.
 * Returns 0 if the line meets a border. */
static int follow(struct work *w, struct line *l)
{
  uint32_t half = half_to(w, l->from, l->b), end = half_to(w, l->to, l->a);

  l->is_bad = half == UINT32_MAX || end == UINT32_MAX;
  l->n = 0;
  for (uint32_t i = 0; i < w->n_single; i++) meet(l, i);
  if (l->is_bad) return 0;
  if (l->n) qsort(l->list, l->n, sizeof *l->list, by_place);
  for (size_t k = 0; k < l->n; k++) {
    unite(w, half, l->list[k].half);
    half = l->list[k].half ^ 1;
  }
  unite(w, half, end);
  return 1;
}

static vg_status connect(struct work *w, uint32_t from, uint32_t to,
                         struct vg_error *err)
{
  struct line l = { .w = w, .from = from, .to = to };
  const double *x[3], *y[3];
  int done = 0;

  corners(w->m, w->tri[from], x);
  corners(w->m, w->tri[to], y);
  for (int i = 0; i < VG_LINE_TRIES && !done && l.is_bad >= 0; i++) {
    vg_line_place(x, i, l.a);
    vg_line_place(y, 3 * i + 1, l.b);
    done = follow(w, &l);
  }
  free(l.list);
  if (done) return VG_OK;
  if (l.is_bad < 0) return vg_fail_memory(err, "the zones");
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the zone around the triangle at (%g, %g, %g) is not known, "
                 "since lines from it to the other surfaces meet their edges; "
                 "move that part of the surface a little",
                 l.a[0], l.a[1], l.a[2]);
}

/* The triangle with the point of least x is on an outermost component. */
static uint32_t outermost(const struct work *w)
{
  uint32_t at = 0;
  double least = INFINITY;

  for (uint32_t i = 0; i < w->n_single; i++)
    for (int k = 0; k < 3; k++)
      if (w->m->point[w->tri[i][k]][0] < least) {
        least = w->m->point[w->tri[i][k]][0];
        at = i;
      }
  return at;
}

static vg_status connect_components(struct work *w, struct vg_error *err)
{
  const uint32_t *region = w->sides.region, to = outermost(w);
  uint8_t *done = vg_calloc(w->sides.n_region, 1);
  vg_status st = done ? VG_OK : vg_fail_memory(err, "the zones");

  if (done && w->n_single) done[vg_root_of(w->part, region[2 * to])] = 1;
  for (uint32_t i = 0; i < w->n_single && st >= 0; i++) {
    uint8_t *is = &done[vg_root_of(w->part, region[2 * i])];

    if (!*is) st = connect(w, i, to, err);
    *is = 1;
  }
  free(done);
  return st;
}

/* --- interfaces that are not closed -----------------------------------------
 */

/* Free edges of interfaces; the first one. */
static size_t free_edges(const struct work *w, uint32_t *first)
{
  const struct vg_edges *e = &w->sides.edge;
  size_t n = 0;

  for (size_t i = 0; i < e->n; i++) {
    const uint32_t *half = vg_edges_at(e, i);

    if (vg_edges_count(e, i) > 1 || !patch_of(w, half[0] / 3)->is_interface)
      continue;
    if (!n++) *first = half[0];
  }
  return n;
}

static vg_status not_closed(const struct work *w, size_t i,
                            struct vg_error *err)
{
  const struct vg_patch *p = patch_of(w, i);
  const double *x[3], *a, *b;
  uint32_t half = 0;
  const size_t n = free_edges(w, &half);
  char why[240];

  corners(w->m, w->tri[i], x);
  a = w->m->point[vg_half_from((const uint32_t(*)[3])w->tri, half)];
  b = w->m
        ->point[vg_half_from((const uint32_t(*)[3])w->tri, vg_half_next(half))];
  if (n)
    snprintf(why, sizeof why,
             "%zu edges of interfaces are free, the first one from (%g, %g, "
             "%g) to (%g, %g, %g); close the hole there, or",
             n, a[0], a[1], a[2], b[0], b[1], b[2]);
  else
    snprintf(
      why, sizeof why,
      "it ends on a baffle or sheet around which the fluid is "
      "connected; name the patches that close the zone in zone_interfaces, "
      "or");
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "interface %d%s%s encloses no zone: the same fluid is on both "
                 "sides of its triangle at (%g, %g, %g); %s make it a sheet",
                 (int)p->id, *p->name ? " " : "", p->name,
                 (x[0][0] + x[1][0] + x[2][0]) / 3,
                 (x[0][1] + x[1][1] + x[2][1]) / 3,
                 (x[0][2] + x[1][2] + x[2][2]) / 3, why);
}

static vg_status check_closed(const struct work *w, struct vg_error *err)
{
  for (size_t i = 0; i < w->n_single; i++) {
    const uint32_t *r = w->sides.region + 2 * i;

    if (patch_of(w, i)->is_interface && patch_of(w, i)->is_sheet &&
        vg_root_of(w->up, r[0]) == vg_root_of(w->up, r[1]))
      return not_closed(w, i, err);
  }
  return VG_OK;
}

/* --- zones ------------------------------------------------------------------
 */

/* Sets the root of the region into which each triangle of the surface looks. */
static vg_status look(struct work *w, struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  uint32_t *other = NULL;
  vg_status st = VG_OK;

  w->z->of = vg_alloc(m->n_tri, sizeof *w->z->of);
  other = vg_alloc(m->n_tri, sizeof *other);
  if (!w->z->of || !other) VG_TRY(vg_fail_memory(err, "the zones"));
  if (w->first) VG_TRY(vg_mesh_inner_pairs(m, w->first, other, err));
  for (size_t i = 0; i < w->n_single; i++) {
    const uint32_t t = w->single[i], *r = w->sides.region + 2 * i;

    w->z->of[t] = vg_root_of(w->up, r[0]);
    if (patch_of(w, i)->inner != VG_INNER_FRONT) continue;
    assert(other[t] != UINT32_MAX);
    w->z->of[other[t]] = vg_root_of(w->up, r[1]);
  }
done:
  free(other);
  return st;
}

struct region {
  uint32_t root;
  double volume;
};

static int by_volume(const void *a, const void *b)
{
  const struct region *p = a, *q = b;

  if (p->volume != q->volume) return p->volume > q->volume ? -1 : 1;
  return p->root < q->root ? -1 : p->root > q->root;
}

static void add_volumes(const struct work *w, double *volume)
{
  const struct vg_mesh *m = w->m;

  for (size_t t = 0; t < m->n_tri; t++) {
    const double *x[3];

    corners(m, m->tri[t], x);
    volume[w->z->of[t]] -= vg_tri_cone(m->point[0], x[0], x[1], x[2]) / 6;
  }
}

/* Numbers the regions that triangles look into by their volume. */
static vg_status number(struct work *w, struct vg_error *err)
{
  const size_t n_tri = w->m->n_tri, n_region = w->sides.n_region;
  double *volume = vg_calloc(n_region, sizeof *volume);
  struct region *list = vg_alloc(n_region, sizeof *list);
  uint8_t *is_zone = vg_calloc(n_region, 1);
  struct vg_zone_map *z = w->z;
  vg_status st = VG_OK;

  if (!volume || !list || !is_zone) VG_TRY(vg_fail_memory(err, "the zones"));
  add_volumes(w, volume);
  for (size_t t = 0; t < n_tri; t++) is_zone[z->of[t]] = 1;
  for (uint32_t r = 0; r < n_region; r++)
    if (is_zone[r]) list[z->n++] = (struct region){ r, volume[r] };
  if (z->n > UINT16_MAX)
    VG_TRY(vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the interfaces enclose %zu zones; at most %d are possible",
                   z->n, UINT16_MAX));
  if (z->n) qsort(list, z->n, sizeof *list, by_volume);
  z->volume = vg_alloc(z->n, sizeof *z->volume);
  z->zone = vg_calloc(z->n, sizeof *z->zone);
  if (!z->volume || !z->zone) VG_TRY(vg_fail_memory(err, "the zones"));
  for (uint32_t k = 0; k < z->n; k++) {
    z->volume[k] = list[k].volume;
    z->zone[k].id = (int32_t)k + 1;
    w->up[list[k].root] = k;
  }
  for (size_t t = 0; t < n_tri; t++) z->of[t] = w->up[z->of[t]];
done:
  free(volume);
  free(list);
  free(is_zone);
  return st;
}

enum { NO_PATCH = -1, SEVERAL = -2 };

/* The first interface with the name of patch p. */
static size_t first_of_name(const struct vg_mesh *m, size_t p)
{
  size_t i = 0;

  p = vg_mesh_front_patch(m, p);
  while (i < p && (!m->patch[i].is_interface || !*m->patch[i].name ||
                   strcmp(m->patch[i].name, m->patch[p].name)))
    i++;
  return i;
}

/* largest: [n_patch] the largest zone next to each interface, by its first
 * patch. */
static void find_largest(const struct vg_zone_map *z, uint32_t *largest)
{
  const struct vg_mesh *m = z->surface;

  for (size_t p = 0; p < m->n_patch; p++) largest[p] = UINT32_MAX;
  for (size_t t = 0; t < m->n_tri; t++)
    if (m->patch[m->tri_patch[t]].is_interface) {
      const size_t i = first_of_name(m, m->tri_patch[t]);

      if (z->of[t] < largest[i]) largest[i] = z->of[t];
    }
}

/* by: [z->n] the interface between each zone and the largest zone next to it,
 * which has to be larger than itself; or NO_PATCH or SEVERAL */
static void find_interfaces(const struct vg_zone_map *z,
                            const uint32_t *largest, int64_t *by)
{
  const struct vg_mesh *m = z->surface;

  for (size_t k = 0; k < z->n; k++) by[k] = NO_PATCH;
  for (int pass = 0; pass < 2; pass++)
    for (size_t t = 0; t < m->n_tri; t++) {
      const uint32_t p = m->tri_patch[t], zone = z->of[t];
      int64_t i;

      if (!m->patch[p].is_interface) continue;
      i = (int64_t)first_of_name(m, p);
      if (largest[i] >= zone) continue;
      if (by[zone] == NO_PATCH || (!pass && largest[i] < largest[by[zone]]))
        by[zone] = i;
      else if (pass && by[zone] != i && by[zone] != SEVERAL &&
               largest[i] == largest[by[zone]])
        by[zone] = SEVERAL;
    }
}

static int has_name(const struct vg_zone_map *z, size_t n, const char *name)
{
  for (size_t k = 0; k < n; k++)
    if (!strcmp(z->zone[k].name, name)) return 1;
  return 0;
}

static vg_status name_zones(struct vg_zone_map *z, struct vg_error *err)
{
  const struct vg_patch *patch = z->surface->patch;
  int64_t *by = vg_alloc(z->n, sizeof *by);
  uint32_t *largest = vg_alloc(z->surface->n_patch, sizeof *largest);
  const int bad = !by || !largest;

  if (!bad) find_largest(z, largest);
  if (!bad) find_interfaces(z, largest, by);
  for (size_t k = 0; !bad && k < z->n; k++) {
    const char *name = by[k] >= 0 ? patch[by[k]].name : "";
    char *to = z->zone[k].name;

    if (*name && !has_name(z, k, name)) snprintf(to, VG_NAME_MAX, "%s", name);
    else snprintf(to, VG_NAME_MAX, "zone_%zu", k + 1);
  }
  free(by);
  free(largest);
  return bad ? vg_fail_memory(err, "the zones") : VG_OK;
}

/* --- places -----------------------------------------------------------------
 */

static vg_status plant(struct vg_zone_map *z, struct vg_error *err)
{
  const struct vg_mesh *m = z->surface;
  struct vg_box *box = vg_alloc(m->n_tri, sizeof *box);
  vg_status st;

  if (!box) return vg_fail_memory(err, "the zones");
  for (size_t t = 0; t < m->n_tri; t++) {
    box[t] = (struct vg_box)VG_BOX_EMPTY;
    for (int k = 0; k < 3; k++) vg_box_add(&box[t], m->point[m->tri[t][k]]);
  }
  st = vg_box_tree_build_items(&z->tree, m->n_tri, box, NULL, err);
  free(box);
  return st;
}

struct search {
  const struct vg_zone_map *z;
  const double *x;
  double to[3];       /* end of the line, in triangle t */
  uint32_t t;         /* UINT32_MAX: none */
  double near2;       /* squared distance from x to its box */
  double front, back; /* first triangles on the line, 0..1, seen from the
                         zone into which they look, and from behind */
  uint32_t zone;      /* of the first one */
  int is_bad;
};

static int enter(void *context, size_t node, double d2)
{
  const struct search *s = context;

  (void)node;
  return d2 < s->near2;
}

/* The nearest box of a triangle that does not have x in its plane. */
static void choose(void *context, size_t node)
{
  struct search *s = context;
  const struct vg_box_tree *tree = &s->z->tree;

  for (size_t i = vg_box_tree_first(tree, node);
       i < vg_box_tree_end(tree, node); i++) {
    const uint32_t t = tree->item[i];
    const double d2 = vg_box_distance2(&tree->box[i], s->x);
    const double *c[3];

    if (d2 > s->near2 || (d2 == s->near2 && t >= s->t)) continue;
    corners(s->z->surface, s->z->surface->tri[t], c);
    if (vg_orient3d(c[0], c[1], c[2], s->x) == 0) continue;
    s->near2 = d2;
    s->t = t;
  }
}

/* A triangle of an inner surface that is seen from behind hides nothing: the
 * one of its other side is at the same place. */
static int see(void *context, uint32_t t)
{
  struct search *s = context;
  const struct vg_mesh *m = s->z->surface;
  const double *c[3];
  double at = 1, side;

  corners(m, m->tri[t], c);
  if (t != s->t) {
    const int hit = vg_line_crosses(c, s->x, s->to);

    s->is_bad |= hit < 0;
    if (hit <= 0) return s->is_bad;
    at = vg_line_at(c, s->x, s->to);
  }
  side = vg_orient3d(c[0], c[1], c[2], s->x);
  if (side > 0 && at < s->front) {
    s->front = at;
    s->zone = s->z->of[t];
  }
  if (side < 0 && at < s->back && !m->patch[m->tri_patch[t]].inner)
    s->back = at;
  return 0;
}

/* The other side of an inner surface has the end of the line in its plane. */
static int is_other_side(const struct search *s, uint32_t t)
{
  const struct vg_mesh *m = s->z->surface;

  for (int k = 0; k < 3; k++)
    if (memcmp(m->point[m->tri[t][k]], m->point[m->tri[s->t][k ? 3 - k : 0]],
               sizeof *m->point))
      return 0;
  return 1;
}

static int visit(void *context, uint32_t t)
{
  struct search *s = context;

  if (t != s->t && is_other_side(s, t)) {
    const uint32_t end = s->t;

    s->t = t;
    see(s, t);
    s->t = end;
    return 0;
  }
  return see(s, t);
}

uint32_t vg_zone_map_at(const struct vg_zone_map *z, const double x[3])
{
  struct search s = { .z = z, .x = x, .t = UINT32_MAX, .near2 = INFINITY };
  const double *c[3];

  vg_box_tree_approach(&z->tree, x, enter, choose, &s);
  if (s.t == UINT32_MAX) return VG_ZONE_OUTSIDE;
  corners(z->surface, z->surface->tri[s.t], c);
  for (int i = 0; i < VG_LINE_TRIES; i++) {
    struct vg_box box = VG_BOX_EMPTY;

    vg_line_place(c, i, s.to);
    vg_box_add(&box, x);
    /* s.to is not exactly in the plane of its triangle. */
    for (int k = 0; k < 3; k++) vg_box_add(&box, c[k]);
    s.front = s.back = INFINITY;
    s.is_bad = 0;
    vg_box_tree_touched(&z->tree, &box, visit, &s);
    assert(s.is_bad || fmin(s.front, s.back) <= 1);
    if (!s.is_bad) return s.front <= s.back ? s.zone : VG_ZONE_OUTSIDE;
  }
  return VG_ZONE_ON;
}

static int touch(void *context, uint32_t item)
{
  (void)context;
  (void)item;
  return 1;
}

int vg_zone_map_touches(const struct vg_zone_map *z, const double lo[3],
                        const double hi[3])
{
  struct vg_box box;

  memcpy(box.lo, lo, sizeof box.lo);
  memcpy(box.hi, hi, sizeof box.hi);
  return vg_box_tree_touched(&z->tree, &box, touch, NULL);
}

/* --- whole ------------------------------------------------------------------
 */

vg_status vg_zone_map_new(const struct vg_mesh *surface, struct vg_zone_map *z,
                          struct vg_error *err)
{
  struct work w = { .m = surface, .z = z };
  vg_status st;

  assert(surface->n_tri && !z->of && !z->zone);
  z->surface = surface;
  VG_TRY(take_single(&w, err));
  pass_sheets(&w);
  VG_TRY(connect_components(&w, err));
  VG_TRY(check_closed(&w, err));
  VG_TRY(look(&w, err));
  VG_TRY(number(&w, err));
  VG_TRY(name_zones(z, err));
  st = plant(z, err);
done:
  vg_sides_release(&w.sides);
  free(w.single);
  free(w.tri);
  free(w.up);
  free(w.part);
  free(w.first);
  if (st < 0) vg_zone_map_release(z);
  return st;
}

void vg_zone_map_release(struct vg_zone_map *z)
{
  vg_box_tree_release(&z->tree);
  free(z->of);
  free(z->volume);
  free(z->zone);
  *z = (struct vg_zone_map)VG_ZONE_MAP_INIT;
}
