/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/picture/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

/* Planes are placed slightly away from the middle, where symmetric bodies have
 * points and edges (V4). */
#define MIDDLE 0.4871
#define TRIED 7       /* Number of planes tried. */
#define AROUND 1.3    /* Window of a section relative to its extent. */
#define CLOSE 5       /* Window close to a wall, in heights of the layers. */
#define CLOSE_BARE 14 /* The same without layers, in edges. */

static int is_wall(const struct vg_patch *p)
{
  int32_t bc = p->bc;

  if (bc == VG_BC_NONE)
    return p->bc_fun3d == VG_BC_NONE ||
           (p->bc_fun3d >= 3000 && p->bc_fun3d < 5000);
  return bc == 4 || bc == 5 || bc == 41 || bc == 44 || bc == 55 ||
         (bc >= 3000 && bc < 5000);
}

void vg_body_patches(const struct vg_mesh *surface,
                     const struct vg_columns *columns, uint8_t *on)
{
  size_t n = 0;

  memset(on, 0, surface->n_patch);
  for (size_t i = 0; columns && i < columns->n_face; i++)
    if (columns->face_tri[i] != VG_NO_INDEX)
      on[surface->tri_patch[columns->face_tri[i]]] = 1;
  for (size_t i = 0; i < surface->n_patch; i++) n += on[i];
  for (size_t i = 0; !n && i < surface->n_patch; i++)
    on[i] = (uint8_t)is_wall(&surface->patch[i]);
  for (size_t i = 0; i < surface->n_patch; i++) n += on[i];
  if (!n) memset(on, 1, surface->n_patch);
}

/* --- choice of the cuts -------------------------------------------------- */

/* The body and its bounding box. */
struct body {
  const struct vg_mesh *m;
  const struct vg_columns *columns;
  uint8_t *on;    /* Patches of the body. */
  double *height; /* [n_point] height of the layers; NULL: no layers. */
  double lo[3], hi[3];
};

static void box_of(struct body *b)
{
  for (int k = 0; k < 3; k++) {
    b->lo[k] = INFINITY;
    b->hi[k] = -INFINITY;
  }
  for (size_t i = 0; i < b->m->n_tri; i++)
    for (int j = 0; j < 9 && b->on[b->m->tri_patch[i]]; j++) {
      double v = b->m->point[b->m->tri[i][j / 3]][j % 3];

      b->lo[j % 3] = fmin(b->lo[j % 3], v);
      b->hi[j % 3] = fmax(b->hi[j % 3], v);
    }
}

static int first_of(int axis)
{
  return axis == 0 ? 1 : 0;
}
static int second_of(int axis)
{
  return axis == 2 ? 1 : 2;
}

static void add(struct vg_cut_plan *plan, enum vg_cut_view view,
                const struct vg_cut *cut)
{
  if (!(cut->width > 0)) return;
  plan->view[plan->n] = view;
  plan->cut[plan->n++] = *cut;
}

/* A window that shows lo .. hi. */
static struct vg_cut window(const double lo[3], const double hi[3], int axis,
                            double at, double around)
{
  int u = first_of(axis), v = second_of(axis);
  struct vg_cut c = { .axis = axis,
                      .at = at,
                      .centre = { (lo[u] + hi[u]) / 2, (lo[v] + hi[v]) / 2 } };

  c.width = around *
            fmax(hi[u] - lo[u], (hi[v] - lo[v]) * VG_CUT_WIDTH / VG_CUT_HEIGHT);
  return c;
}

/* Section of the body by a plane: its bounding box, its ends along the first
 * axis, and the size of the details there, which are the layers or some
 * edges. */
struct section {
  double lo[3], hi[3], at[2][2], size[2];
};

static double size_at(const struct body *b, const uint32_t *t)
{
  double edge = 0, height = 0;

  for (int k = 0; k < 3; k++) {
    edge = fmax(edge,
                vg_distance(b->m->point[t[k]], b->m->point[t[(k + 1) % 3]]));
    if (b->height) height = fmax(height, b->height[t[k]]);
  }
  return fmax(CLOSE * height, height > 0 ? edge : CLOSE_BARE * edge);
}

static void cut_triangle(const struct body *b, const uint32_t *t, int axis,
                         double at, struct section *s)
{
  int u = first_of(axis), v = second_of(axis);

  for (int k = 0; k < 3; k++) {
    const double *p = b->m->point[t[k]], *q = b->m->point[t[(k + 1) % 3]];
    double share, x[3];

    if ((p[axis] >= at) == (q[axis] >= at)) continue;
    share = (at - p[axis]) / (q[axis] - p[axis]);
    for (int j = 0; j < 3; j++) x[j] = p[j] + share * (q[j] - p[j]);
    for (int side = 0; side < 2; side++)
      if (side ? x[u] > s->hi[u] : x[u] < s->lo[u]) {
        s->at[side][0] = x[u];
        s->at[side][1] = x[v];
        s->size[side] = size_at(b, t);
      }
    for (int j = 0; j < 3; j++) {
      s->lo[j] = fmin(s->lo[j], x[j]);
      s->hi[j] = fmax(s->hi[j], x[j]);
    }
  }
}

/* Returns 0 if the plane does not intersect the body. */
static double cut_body(const struct body *b, int axis, double at,
                       struct section *s)
{
  int u = first_of(axis), v = second_of(axis);

  for (int k = 0; k < 3; k++) {
    s->lo[k] = INFINITY;
    s->hi[k] = -INFINITY;
  }
  for (size_t i = 0; i < b->m->n_tri; i++)
    if (b->on[b->m->tri_patch[i]]) cut_triangle(b, b->m->tri[i], axis, at, s);
  return s->hi[u] > s->lo[u] ? (s->hi[u] - s->lo[u]) * (s->hi[v] - s->lo[v])
                             : 0;
}

static double plane_at(const struct body *b, int axis, double share)
{
  return b->lo[axis] + share * (b->hi[axis] - b->lo[axis]);
}

/* The middle plane or, among a few others, the plane with the largest section:
 * for a wing it is the one along its span. */
static double choose_plane(const struct body *b, int axis, struct section *s)
{
  double at = plane_at(b, axis, MIDDLE), most = cut_body(b, axis, at, s);

  for (int k = 0; axis != 1 && k < TRIED; k++) {
    double other = plane_at(b, axis, (k + MIDDLE) / TRIED);
    struct section is;
    double area = cut_body(b, axis, other, &is);

    if (area <= 1.02 * most) continue;
    most = area;
    at = other;
    *s = is;
  }
  return at;
}

static void close_to_ends(const struct section *s, const struct vg_cut *whole,
                          struct vg_cut_plan *plan)
{
  for (int side = 0; side < 2; side++) {
    struct vg_cut c = *whole;

    memcpy(c.centre, s->at[side], sizeof c.centre);
    c.width = fmin(s->size[side], whole->width);
    add(plan, side ? VG_VIEW_LAST : VG_VIEW_FIRST, &c);
  }
}

/* Among columns with missing levels, the one with the smallest share of its
 * levels. */
static size_t poorest(const struct vg_columns *c)
{
  size_t found = SIZE_MAX;
  double least = 1;

  for (size_t i = 0; i < c->n_column; i++) {
    const struct vg_column *k = &c->column[i];
    double share = k->n_fit ? (double)k->n / k->n_fit : 1;

    if (share >= least || k->cause <= VG_CAUSE_SIZE) continue;
    least = share;
    found = i;
  }
  return found;
}

/* The plane is normal to the axis to which the column is inclined least. */
static void close_to_poorest(const struct body *b, struct vg_cut_plan *plan)
{
  const struct vg_columns *c = b->columns;
  size_t i = poorest(c);
  const double *x, *dir;
  struct vg_cut cut = { .axis = 1 };
  double size = 0;

  if (i == SIZE_MAX) return;
  x = b->m->point[c->column[i].root];
  dir = c->column[i].dir;
  for (int k = 0; k < 3; k += 2)
    if (fabs(dir[k]) < fabs(dir[cut.axis])) cut.axis = k;
  for (size_t f = 0; f < c->n_face; f++)
    for (int k = 0; k < 3; k++)
      if (c->face[f][k] == i && c->face_tri[f] != VG_NO_INDEX)
        size = fmax(size, size_at(b, b->m->tri[c->face_tri[f]]));
  cut.at = x[cut.axis];
  cut.centre[0] = x[first_of(cut.axis)];
  cut.centre[1] = x[second_of(cut.axis)];
  cut.width = size;
  add(plan, VG_VIEW_POOREST, &cut);
}

static void find_heights(struct body *b)
{
  for (size_t i = 0; i < b->columns->n_column; i++) {
    uint32_t root = b->columns->column[i].root;
    double x[3], h;

    vg_column_top(b->columns, b->m, i, x);
    h = vg_distance(x, b->m->point[root]);
    if (h > b->height[root]) b->height[root] = h;
  }
}

vg_status vg_cut_plan(const struct vg_mesh *surface,
                      const struct vg_columns *columns, int is_slab,
                      struct vg_cut_plan *plan, struct vg_error *err)
{
  const int axes[3] = { is_slab ? 2 : 1, 0, 2 };
  struct body b = { surface,
                    columns,
                    vg_alloc(surface->n_patch, 1),
                    columns ? vg_calloc(surface->n_point, sizeof *b.height)
                            : NULL,
                    { 0 },
                    { 0 } };
  double lo[3], hi[3];
  vg_status st = VG_OK;

  plan->n = 0;
  if (!b.on || (columns && !b.height)) {
    st = vg_fail_memory(err, "the pictures");
    goto done;
  }
  vg_body_patches(surface, columns, b.on);
  box_of(&b);
  if (columns) find_heights(&b);
  vg_mesh_bounds(surface, lo, hi);
  for (int k = 0; k < (is_slab ? 1 : 3); k++) {
    struct section s;
    double at = choose_plane(&b, axes[k], &s);
    int met = s.hi[0] >= s.lo[0];
    struct vg_cut c = window(met ? s.lo : b.lo, met ? s.hi : b.hi, axes[k], at,
                             AROUND);

    add(plan, VG_VIEW_BODY, &c);
    if (k) continue;
    if (met) close_to_ends(&s, &c, plan);
    c = window(lo, hi, axes[k], at, 1.03);
    add(plan, VG_VIEW_DOMAIN, &c);
  }
  if (columns) close_to_poorest(&b, plan);
done:
  free(b.on);
  free(b.height);
  return st;
}
