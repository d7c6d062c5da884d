/* A zone or a pencil: cells along a plane or a line, from the front nearby. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/fill/grow.h"
#include "core/fill/growth.h"
#include "core/geometry/shape.h"
#include "core/geometry/vector.h"
#include "core/recover/boundary.h"

/* A plane without walls may use all that is known of the front, which large
 * triangles of the surface ask for; where others grow beside it, less. */
static const double whole_band = VG_BAND_FRONT - 0.2;
/* Dents are not filled with cells worse than this (dihedral angles of about
 * 30 and 150 degrees). */
static const double dent = 0.25;   /* K20 */
/* A cell of this shape (angles of 1 and 179 degrees) on the front, under one
 * that becomes final, would be all that can fill the slit between the two. */
static const double slit = 0.0003;   /* K34 */
/* Edges of more than so many spacings stay out of a pencil. */
static const double overlong = 4;   /* K21 */

struct zone {
  struct vg_growth k;
  size_t n_face;
  const uint32_t (*face)[3];
  struct vg_zone *z;
  uint8_t *at;               /* [t.n_point] bits 2 i and 2 i + 1: not below and
                                not above plane i; NULL: cells within reach
                                belong too */
  uint32_t *number;          /* [t.n_point] in the result, or VG_NONE */
};

void vg_zone_release(struct vg_zone *z)
{
  free(z->x);
  free(z->face);
  free(z->cell);
  free(z->gone);
  memset(z, 0, sizeof *z);
}

static int is_corner(const struct zone *g, uint32_t p)
{
  return p >= g->k.n_front && p < g->k.n_front + 8;
}

static int all_four(const struct zone *g, const uint8_t *flag, uint32_t c)
{
  const uint32_t *v = g->k.t.cell[c].v;

  return flag[v[0]] && flag[v[1]] && flag[v[2]] && flag[v[3]];
}

/* Where the points are now: g->at. */
static vg_status look_at_points(struct zone *g, struct vg_error *err)
{
  const struct vg_tets *t = &g->k.t;

  if (g->k.region->reach > 0) return VG_OK;
  free(g->at);
  g->at = vg_calloc(t->n_point, 1);
  if (!g->at) return vg_fail_memory(err, "the points of a zone");
  for (int i = 0; i < g->k.region->n_plane; i++) {
    const struct vg_plane *plane = &g->k.region->plane[i];

    for (size_t p = 0; p < t->n_point; p++) {
      double s = vg_plane_side(plane, t->x[p]);

      g->at[p] |= (uint8_t)(((s >= 0) | (s <= 0) << 1) << 2 * i);
    }
  }
  return VG_OK;
}

/* Is the longest edge of cell c much longer than the spacing along it, and not
 * one of the front? Where spacing grows away along a line, points are placed in
 * the shape of a trumpet; cells across the air beside it hold no points yet. */
static int is_overlong(const struct zone *g, uint32_t c)
{
  const struct vg_tets *t = &g->k.t;
  const uint32_t *v = t->cell[c].v;
  double most = 0, middle[3] = {0}, h;
  int is_new = 0;

  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      double d2 = vg_distance2(t->x[v[i]], t->x[v[j]]);

      if (d2 <= most) continue;
      most = d2;
      is_new = v[i] >= g->k.n_front || v[j] >= g->k.n_front;
      for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (t->x[v[i]][k] + t->x[v[j]][k]);
    }
  h = vg_sizing_at(g->k.sizing, middle);
  return is_new && most > overlong * overlong * h * h;
}

/* Most cells cross no plane; that is told before anything is measured. What
 * does not cross all of them, but is within reach, can wait. */
static int belongs(const struct zone *g, uint32_t c)
{
  const struct vg_tets *t = &g->k.t;
  const uint32_t *v = t->cell[c].v;
  const uint8_t *at = g->at;
  struct vg_region r = *g->k.region;

  if (at && (at[v[0]] | at[v[1]] | at[v[2]] | at[v[3]]) !=
              (1 << 2 * g->k.region->n_plane) - 1)
    return 0;
  if (!vg_region_has_cell(&r, g->k.sizing, t->x[v[0]], t->x[v[1]], t->x[v[2]],
                          t->x[v[3]]))
    return 0;
  if (!(r.reach > 0) || !is_overlong(g, c)) return 1;
  r.reach = 0;
  return vg_region_has_cell(&r, g->k.sizing, t->x[v[0]], t->x[v[1]], t->x[v[2]],
                            t->x[v[3]]);
}

/* Only cells near the region stay, none of them at a corner of the box. The
 * faces around them are fixed. */
static vg_status narrow(struct zone *g, struct vg_error *err)
{
  struct vg_tets *t = &g->k.t;
  uint8_t *is_known = vg_alloc(t->n_point, 1);
  const struct vg_region *r = g->k.region;
  double band = r->n_plane > 1 || r->n_wall ? VG_BAND_FLUID : whole_band;

  if (!is_known) return vg_fail_memory(err, "the points of a zone");
  if (look_at_points(g, err)) {
    free(is_known);
    return VG_ERR_MEMORY;
  }
  for (uint32_t p = 0; p < t->n_point; p++)
    is_known[p] = !is_corner(g, p) &&
                  vg_region_near(g->k.region, g->k.sizing, t->x[p],
                                 band);
  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE) || all_four(g, is_known, c))
      continue;
    t->flag[c] |= VG_OUTSIDE;
    g->z->n_hole += (size_t)belongs(g, c);
  }
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && !(t->flag[c] & (VG_DEAD | VG_OUTSIDE)); i++) {
      uint32_t link = t->cell[c].link[i];

      if (link == VG_NONE || t->flag[link >> 2] & VG_OUTSIDE)
        t->flag[c] |= (uint8_t)(1 << i);
    }
  free(is_known);
  return VG_OK;
}

static double shares_of_spacing(const struct vg_sizing *sizing,
                                const double *const x[4])
{
  double e[3][3], middle[3], h;

  for (int i = 0; i < 3; i++) vg_sub(x[i + 1], x[0], e[i]);
  for (int k = 0; k < 3; k++)
    middle[k] = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
  h = vg_sizing_at(sizing, middle);
  return vg_triple(e[0], e[1], e[2]) / 6 / (h * h * h);
}

static void take(struct zone *g, uint32_t c)
{
  struct vg_tets *t = &g->k.t;
  const double *x[4];

  for (int i = 0; i < 4; i++) x[i] = t->x[t->cell[c].v[i]];
  t->flag[c] |= VG_MARK;
  g->z->n_cell++;
  g->z->volume += shares_of_spacing(g->k.sizing, x);
}

static int is_within(const struct zone *g, uint32_t c)
{
  const struct vg_tets *t = &g->k.t;

  for (int i = 0; i < 4; i++)
    if (!vg_region_within(g->k.region, t->x[t->cell[c].v[i]])) return 0;
  return 1;
}

static double shape_of(const struct vg_tets *t, uint32_t c)
{
  const uint32_t *v = t->cell[c].v;

  return vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
}

/* Does the sphere around cell c lie where points are placed? One that reaches
 * farther would hold points that are placed later: the cell is larger than any
 * that should be there. */
static int is_settled(const struct zone *g, uint32_t c)
{
  const double (*x)[3] = (const double (*)[3])g->k.t.x;
  const uint32_t *v = g->k.t.cell[c].v;
  const struct vg_region *region = g->k.region;
  double e[3][3], n[3][3], d2[3], det, r2 = 0, r, middle[3];

  for (int i = 0; i < 3; i++) {
    vg_sub(x[v[i + 1]], x[v[0]], e[i]);
    d2[i] = vg_dot(e[i], e[i]);
  }
  for (int i = 0; i < 3; i++) vg_cross(e[(i + 1) % 3], e[(i + 2) % 3], n[i]);
  det = vg_dot(e[0], n[0]);
  for (int k = 0; k < 3; k++) {
    double d = (d2[0] * n[0][k] + d2[1] * n[1][k] + d2[2] * n[2][k]) / det / 2;

    middle[k] = x[v[0]][k] + d;
    r2 += d * d;
  }
  r = sqrt(r2) / vg_region_spacing(region, g->k.sizing, middle);
  return vg_region_near(region, g->k.sizing, middle, VG_BAND_PLACE - r);
}

static void leave(struct zone *g, uint32_t c)
{
  struct vg_tets *t = &g->k.t;
  const double *x[4];

  for (int i = 0; i < 4; i++) x[i] = t->x[t->cell[c].v[i]];
  t->flag[c] &= (uint8_t)~VG_MARK;
  g->z->n_cell--;
  g->z->n_hole++;
  g->z->volume -= shares_of_spacing(g->k.sizing, x);
}

/* What could not be mended above a flat cell on the front is left to the void,
 * which then has room there. */
static void leave_no_slits(struct zone *g)
{
  struct vg_tets *t = &g->k.t;

  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE | VG_MARK) ||
        !(t->flag[c] & VG_FIXED_FACES) || shape_of(t, c) >= slit)
      continue;
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[c].link[i];

      if (!(t->flag[c] >> i & 1) && link != VG_NONE &&
          t->flag[link >> 2] & VG_MARK)
        leave(g, link >> 2);
    }
  }
}

/* VG_MARK on the cells that become final: those that belong, and those that
 * fill the dents between them without a further point, which leaves a smooth
 * front, but for those that leave slits. */
static vg_status choose(struct zone *g, struct vg_error *err)
{
  struct vg_tets *t = &g->k.t;
  uint8_t *used = vg_calloc(t->n_point, 1);

  if (!used) return vg_fail_memory(err, "the points of a zone");
  if (look_at_points(g, err)) {
    free(used);
    return VG_ERR_MEMORY;
  }
  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD || !belongs(g, c)) continue;
    take(g, c);
    for (int i = 0; i < 4; i++) used[t->cell[c].v[i]] = 1;
  }
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (!(t->flag[c] & (VG_DEAD | VG_MARK)) && all_four(g, used, c) &&
        is_within(g, c) && shape_of(t, c) > dent && is_settled(g, c))
      take(g, c);
  free(used);
  leave_no_slits(g);
  return VG_OK;
}

static vg_status number_points(struct zone *g, struct vg_error *err)
{
  struct vg_tets *t = &g->k.t;
  struct vg_zone *z = g->z;
  size_t n_front = g->k.n_front;

  g->number = vg_alloc(t->n_point, sizeof *g->number);
  if (!g->number) return vg_fail_memory(err, "the points of a zone");
  memset(g->number, 0xff, t->n_point * sizeof *g->number);
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && t->flag[c] & VG_MARK; i++)
      g->number[t->cell[c].v[i]] = 0;
  for (size_t p = n_front; p < t->n_point; p++)
    if (g->number[p] != VG_NONE)
      g->number[p] = (uint32_t)(n_front + z->n_point++);
  for (size_t p = 0; p < n_front; p++) g->number[p] = (uint32_t)p;
  z->x = vg_alloc(z->n_point, sizeof *z->x);
  if (!z->x) return vg_fail_memory(err, "the points of a zone");
  for (size_t p = n_front; p < t->n_point; p++)
    if (g->number[p] != VG_NONE)
      memcpy(z->x[g->number[p] - n_front], t->x[p], sizeof *z->x);
  return VG_OK;
}

/* Faces of the front by their lowest point. */
struct lookup {
  uint32_t *first;           /* [n_front + 1] */
  uint32_t *face;            /* [n_face] */
};

static uint32_t lowest(const uint32_t v[3])
{
  uint32_t low = v[0] < v[1] ? v[0] : v[1];

  return low < v[2] ? low : v[2];
}

static vg_status lookup_init(struct lookup *l, const struct zone *g,
                             struct vg_error *err)
{
  size_t n = g->k.n_front;

  l->first = vg_calloc(n + 2, sizeof *l->first);
  l->face = vg_alloc(g->n_face, sizeof *l->face);
  if (!l->first || !l->face) return vg_fail_memory(err, "the front");
  for (size_t i = 0; i < g->n_face; i++) l->first[lowest(g->face[i]) + 2]++;
  for (size_t p = 0; p < n; p++) l->first[p + 2] += l->first[p + 1];
  for (size_t i = 0; i < g->n_face; i++)
    l->face[l->first[lowest(g->face[i]) + 1]++] = (uint32_t)i;
  return VG_OK;
}

/* The face of the front with these points in this sense, or VG_NONE. */
static uint32_t lookup_find(const struct lookup *l, const struct zone *g,
                            const uint32_t v[3])
{
  uint32_t low = lowest(v);

  for (uint32_t i = l->first[low]; i < l->first[low + 1]; i++) {
    const uint32_t *f = g->face[l->face[i]];

    for (int k = 0; k < 3; k++)
      if (f[0] == v[k] && f[1] == v[(k + 1) % 3] && f[2] == v[(k + 2) % 3])
        return l->face[i];
  }
  return VG_NONE;
}

/* Every face around the kept cells was the front's, and is gone; or is new,
 * and faces away from the cell. */
static vg_status close_front(struct zone *g, const struct lookup *l,
                             struct vg_error *err)
{
  const struct vg_tets *t = &g->k.t;
  struct vg_zone *z = g->z;
  size_t cap = 0;

  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && t->flag[c] & VG_MARK; i++) {
      uint32_t link = t->cell[c].link[i], v[3], f = VG_NONE;

      if (link != VG_NONE && t->flag[link >> 2] & VG_MARK &&
          !(t->flag[c] >> i & 1))
        continue;
      for (int k = 0; k < 3; k++)
        v[k] = g->number[t->cell[c].v[vg_face[i][k]]];
      if (t->flag[c] >> i & 1 && v[0] < g->k.n_front &&
          v[1] < g->k.n_front && v[2] < g->k.n_front)
        f = lookup_find(l, g, v);
      if (f != VG_NONE) {
        z->gone[f] = 1;
        continue;
      }
      if (vg_reserve(&z->face, &cap, z->n_face + 1, sizeof *z->face))
        return vg_fail_memory(err, "the front");
      z->face[z->n_face][0] = v[0];
      z->face[z->n_face][1] = v[2];
      z->face[z->n_face++][2] = v[1];
    }
  return VG_OK;
}

static vg_status commit(struct zone *g, struct vg_error *err)
{
  const struct vg_tets *t = &g->k.t;
  struct vg_zone *z = g->z;
  struct lookup l = {0};
  size_t n = 0;
  vg_status st;

  VG_TRY(choose(g, err));
  z->cell = vg_alloc(z->n_cell, sizeof *z->cell);
  z->gone = vg_calloc(g->n_face, 1);
  if (!z->cell || !z->gone) {
    st = vg_fail_memory(err, "the cells of a zone");
    goto done;
  }
  VG_TRY(number_points(g, err));
  for (size_t c = 0; c < t->n_cell; c++) {
    if (!(t->flag[c] & VG_MARK)) continue;
    for (int i = 0; i < 4; i++) z->cell[n][i] = g->number[t->cell[c].v[i]];
    n++;
  }
  VG_TRY(lookup_init(&l, g, err));
  st = close_front(g, &l, err);
done:
  free(l.first);
  free(l.face);
  return st;
}

static void add_boundary(struct vg_fill_report *to,
                         const struct vg_boundary_report *b)
{
  to->n_surface_face_lost += b->n_face_lost;
  to->n_pocket += b->n_pocket;
  to->n_pocket_cell += b->n_pocket_cell;
  to->n_retry += b->n_retry;
  to->n_steiner += b->n_steiner;
}

/* A front that this band alone does not settle is no failure: the cut may be
 * made elsewhere, or the void filled as it is. */
static vg_status recover(struct zone *g, size_t n_point,
                         const double (*x)[3], struct vg_error *err)
{
  struct vg_boundary_report b = {0};
  double t0 = vg_clock();
  vg_status st;

  st = vg_boundary_open(n_point, x, g->n_face, g->face, g->k.region,
                        g->k.sizing, &g->k.t, &b, err);
  add_boundary(g->k.report, &b);
  g->k.report->time_boundary += vg_clock() - t0;
  if (st != VG_ERR_GEOMETRY) return st;
  g->k.report->n_retry++;
  return VG_BLOCKED;
}

vg_status vg_zone_grow(size_t n_point, const double (*x)[3], size_t n_face,
                       const uint32_t (*face)[3],
                       const struct vg_region *region,
                       const struct vg_sizing *sizing,
                       const struct vg_grow_options *options,
                       struct vg_zone *z, struct vg_fill_report *report,
                       struct vg_error *err)
{
  struct zone g = { .k = { sizing, region, options, report, VG_TETS_INIT,
                           n_point },
                    .n_face = n_face, .face = face, .z = z };
  double t0 = vg_clock();
  vg_status st;

  if (!n_point || !n_face) return VG_BLOCKED;
  if (vg_growth_stopped(&g.k, "recovering the boundary", 0, n_face))
    return VG_BLOCKED;
  st = recover(&g, n_point, x, err);
  if (st == VG_OK) st = vg_growth_populate(&g.k, err);
  if (st == VG_OK) st = narrow(&g, err);
  if (st == VG_OK) st = vg_growth_improve(&g.k, err);
  if (st == VG_OK) st = commit(&g, err);
  if (st != VG_OK) vg_zone_release(z);
  vg_tets_release(&g.k.t);
  free(g.at);
  free(g.number);
  report->time_total += vg_clock() - t0;
  return st;
}
