/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/slits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"

struct work {
  struct vg_mesh *m;
  struct vg_mesh *sheets;
  const struct vg_slit_plane *plane;
  struct vg_border *border;
  uint8_t *on;    /* [sheets->n_point] 1: in the plane */
  uint64_t *edge; /* [n_edge] in the plane: lower and higher point of sheets */
  size_t n_edge;
  uint32_t *point; /* [sheets->n_point] of m, for points in the plane */
};

/* Refuses triangle t of the sheets at point x. */
static vg_status refuse(const struct work *w, size_t t, const double *x,
                        const char *why, const char *remedy,
                        struct vg_error *err)
{
  const struct vg_patch *p = &w->m->patch[w->sheets->tri_patch[t]];
  const char axis = "xyz"[w->plane->axis];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "patch %d%s%s, an inner surface, %s the symmetry plane %c = "
                 "%.9g at (%.9g, %.9g, %.9g); %s",
                 (int)p->id, *p->name ? " " : "", p->name, why, axis,
                 w->plane->at, x[0], x[1], x[2], remedy);
}

/* Finds the points in the plane, and moves them exactly into it. */
static vg_status find_points(struct work *w, struct vg_error *err)
{
  const struct vg_slit_plane *p = w->plane;

  for (size_t k = 0; k < 3 * w->sheets->n_tri; k++) {
    const uint32_t v = w->sheets->tri[k / 3][k % 3];
    double *x = w->sheets->point[v];
    const double off = p->side ? x[p->axis] - p->at : p->at - x[p->axis];

    if (off < -p->tolerance)
      return refuse(w, k / 3, x, "reaches beyond", "cut it off at the plane",
                    err);
    if (off > p->tolerance) continue;
    x[p->axis] = p->at;
    w->on[v] = 1;
  }
  return VG_OK;
}

static vg_status find_edges(struct work *w, struct vg_error *err)
{
  size_t n = 0;

  for (size_t t = 0; t < w->sheets->n_tri; t++) {
    const uint32_t *v = w->sheets->tri[t];

    if (w->on[v[0]] && w->on[v[1]] && w->on[v[2]])
      return refuse(w, t, w->sheets->point[v[0]], "has a triangle in",
                    "if it bounds the fluid, remove it from the list of "
                    "baffles, sheets or zone_interfaces; otherwise cut it off "
                    "at the plane",
                    err);
    for (int k = 0; k < 3; k++) {
      const uint32_t a = v[k], b = v[(k + 1) % 3];

      if (w->on[a] && w->on[b]) w->edge[n++] = vg_edge_key(a, b);
    }
  }
  if (n) qsort(w->edge, n, sizeof *w->edge, vg_compare_edge_keys);
  for (size_t i = 0; i < n; i++)
    if (!w->n_edge || w->edge[w->n_edge - 1] != w->edge[i])
      w->edge[w->n_edge++] = w->edge[i];
  return VG_OK;
}

static int is_same_place(const double a[3], const double b[3])
{
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The entry of the table at the place of point p of m. */
static uint32_t *slot_of(const struct work *w, const struct vg_table *table,
                         const double *x)
{
  uint32_t *at;

  VG_TABLE_FIND(table, at, vg_hash_point(x),
                is_same_place(w->m->point[*at], x));
  return at;
}

/* Numbers the ends of edges: points of the border at the same place, or new
 * points of m. */
static vg_status number_points(struct work *w, struct vg_error *err)
{
  struct vg_mesh *m = w->m;
  struct vg_table table;
  size_t cap = m->n_point;
  vg_status st = VG_OK;

  if (vg_table_init(&table, w->border->n + 2 * w->n_edge))
    return vg_fail_memory(err, "the symmetry plane");
  for (size_t i = 0; i < w->border->n; i++) {
    const uint32_t p = w->border->edge[i][0];
    uint32_t *at = slot_of(w, &table, m->point[p]);

    if (*at == VG_TABLE_FREE) *at = p;
  }
  for (size_t i = 0; i < 2 * w->n_edge; i++) {
    const uint32_t p = (uint32_t)(w->edge[i / 2] >> (i % 2 ? 0 : 32));
    uint32_t *at = slot_of(w, &table, w->sheets->point[p]);

    if (*at == VG_TABLE_FREE) {
      if (vg_reserve(&m->point, &cap, m->n_point + 1, sizeof *m->point)) {
        st = vg_fail_memory(err, "the symmetry plane");
        break;
      }
      memcpy(m->point[m->n_point], w->sheets->point[p], sizeof *m->point);
      *at = (uint32_t)m->n_point++;
    }
    w->point[p] = *at;
  }
  vg_table_release(&table);
  return st;
}

/* Adds both directions of each edge that the border does not have. */
static vg_status add_edges(struct work *w, struct vg_error *err)
{
  const size_t n = w->border->n;
  uint64_t *has = vg_alloc(n, sizeof *has);
  vg_status st = VG_OK;

  if (!has) return vg_fail_memory(err, "the symmetry plane");
  for (size_t i = 0; i < n; i++)
    has[i] = vg_edge_key(w->border->edge[i][0], w->border->edge[i][1]);
  if (n) qsort(has, n, sizeof *has, vg_compare_edge_keys);
  for (size_t i = 0; i < w->n_edge && st >= 0; i++) {
    const uint32_t a = w->point[w->edge[i] >> 32];
    const uint32_t b = w->point[(uint32_t)w->edge[i]];
    const uint64_t key = vg_edge_key(a, b);

    if (n && bsearch(&key, has, n, sizeof key, vg_compare_edge_keys)) continue;
    st = vg_border_add(w->border, a, b, err);
    if (st >= 0) st = vg_border_add(w->border, b, a, err);
  }
  free(has);
  return st;
}

vg_status vg_add_slits(struct vg_mesh *m, struct vg_mesh *sheets,
                       const struct vg_slit_plane *plane,
                       struct vg_border *border, struct vg_error *err)
{
  struct work w = {
    .m = m, .sheets = sheets, .plane = plane, .border = border
  };
  vg_status st;

  w.on = vg_calloc(sheets->n_point, 1);
  w.edge = vg_alloc(3 * sheets->n_tri, sizeof *w.edge);
  w.point = vg_alloc(sheets->n_point, sizeof *w.point);
  st = w.on && w.edge && w.point ? find_points(&w, err)
                                 : vg_fail_memory(err, "the symmetry plane");
  if (st >= 0) st = find_edges(&w, err);
  if (st >= 0) st = number_points(&w, err);
  if (st >= 0) st = add_edges(&w, err);
  free(w.on);
  free(w.edge);
  free(w.point);
  return st;
}
