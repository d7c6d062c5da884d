/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Discretisation errors of a mesh: scales, and the order of the steps. */
#include "core/accuracy/accuracy.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/accuracy/accuracy_parts.h"
#include "core/geometry/vector.h"

void vg_accuracy_release(struct vg_accuracy_report *r)
{
  free(r->patch);
  memset(r, 0, sizeof *r);
}

/* --- scales --------------------------------------------------------------- */

static void find_length(const struct vg_mesh *m, const struct vg_wall_search *s,
                        struct vg_accuracy_report *r)
{
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  if (s->n) {
    const struct vg_box *all = vg_box_tree_node(&s->tree, 0);

    memcpy(lo, all->lo, sizeof lo);
    memcpy(hi, all->hi, sizeof hi);
  }
  for (int k = 0; k < 3; k++) r->centre[k] = 0.5 * (lo[k] + hi[k]);
  r->length = vg_distance(lo, hi);
  for (size_t t = 0; t < s->n; t++) {
    const uint32_t *v = s->tri[t];

    r->wall_area += vg_triangle_area(vg_wall_corner(s, v[0]),
                                     vg_wall_corner(s, v[1]),
                                     vg_wall_corner(s, v[2]));
  }
}

static int by_value(const void *a, const void *b)
{
  const double *p = a, *q = b;

  return (*p > *q) - (*p < *q);
}

/* The height of the first point above point i of a wall: the least distance
 * of a neighbour from the walls. INFINITY: all neighbours are on walls. */
static double height_above(const struct vg_volumes *v, const uint8_t *on_wall,
                           const struct vg_wall_search *s, size_t i)
{
  double least = INFINITY;

  for (size_t e = v->first[i]; e < v->first[i + 1]; e++) {
    uint32_t entry = v->entry[e], to;
    struct vg_place p;

    if (entry >= 2 * v->n_face) continue;
    to = v->side[entry / 2][!(entry % 2)];
    if (on_wall[to]) continue;
    memcpy(p.x, v->x[to], sizeof p.x);
    vg_wall_search_ask(s, &p);
    least = fmin(least, p.distance);
  }
  return least;
}

/* Count the points of walls, and find the median of the heights above them. */
static vg_status find_height(const struct vg_volumes *v,
                             const struct vg_wall_search *s,
                             struct vg_accuracy_report *r, struct vg_error *err)
{
  uint8_t *on_wall = vg_calloc(v->n, 1);
  double *height = NULL;
  size_t n = 0;
  vg_status st = VG_OK;

  if (!on_wall) return vg_fail_memory(err, "the first heights");
  for (size_t t = 0; t < s->n; t++)
    for (int k = 0; k < 3; k++)
      if (s->tri[t][k] < v->n) on_wall[s->tri[t][k]] = 1;
  for (size_t i = 0; i < v->n; i++) r->n_wall += on_wall[i];
  height = vg_alloc(r->n_wall, sizeof *height);
  if (!height) VG_TRY(vg_fail_memory(err, "the first heights"));
  for (size_t i = 0; i < v->n; i++) {
    double h = on_wall[i] ? height_above(v, on_wall, s, i) : INFINITY;

    if (h > 0 && h < INFINITY) height[n++] = h;
  }
  qsort(height, n, sizeof *height, by_value);
  r->first_height = n ? height[n / 2] : 0;
done:
  free(on_wall);
  free(height);
  return st;
}

/* --- steps ---------------------------------------------------------------- */

static vg_status list_walls(const struct vg_mesh *m, const uint8_t *is_wall,
                            struct vg_accuracy_report *r, struct vg_error *err)
{
  r->patch = vg_calloc(m->n_patch, sizeof *r->patch);
  if (!r->patch) return vg_fail_memory(err, "the accuracy at walls");
  for (size_t i = 0; i < m->n_patch; i++)
    if (is_wall[i]) r->patch[r->n_patch++].patch = (uint32_t)i;
  return VG_OK;
}

/* Measure with the unknowns in the points or in the cells. */
static vg_status measure(struct vg_measurement *k, enum vg_unknowns in,
                         const struct vg_accuracy_options *o,
                         struct vg_accuracy_report *r, struct vg_error *err)
{
  vg_status st;

  if (in == VG_IN_NODES) {
    VG_TRY(vg_volumes_dual(&k->volumes, k->links, err));
    VG_TRY(find_height(&k->volumes, k->walls, r, err));
    r->viscous_length = o->viscous_length > 0 && r->first_height > 0
                        ? o->viscous_length
                        : r->first_height;
  } else {
    VG_TRY(vg_volumes_cells(&k->volumes, k->links, err));
  }
  r->n[in] = k->volumes.n;
  k->scale.length = r->length > 0 ? r->length : 1;
  memcpy(k->scale.centre, r->centre, sizeof r->centre);
  k->scale.viscous = r->viscous_length;
  VG_TRY(vg_measurement_open(k, err));
  for (size_t i = 0; i < k->volumes.n && in == VG_IN_NODES; i++)
    r->n_layer += k->zone[i] <= VG_ZONE_LOG;
  VG_TRY(vg_measure_fields(k, r, err));
  if (r->first_height > 0) st = vg_measure_walls(k, r, err);
done:
  vg_measurement_release(k);
  return st;
}

static void set_unknown(struct vg_accuracy_report *r)
{
  const struct vg_accuracy_error none = { 0, 0, NAN, NAN, NAN };

  for (int in = 0; in < VG_UNKNOWNS; in++)
    for (int f = 0; f < VG_FIELDS; f++)
      for (int s = 0; s < VG_SCHEMES; s++)
        for (int z = 0; z < VG_ZONES; z++) r->error[in][f][s][z] = none;
}

vg_status vg_accuracy_measure_with(const struct vg_mesh *m,
                                   const struct vg_accuracy_options *o,
                                   int only_walls, struct vg_accuracy_report *r,
                                   struct vg_error *err)
{
  struct vg_cell_links links = VG_CELL_LINKS_INIT;
  struct vg_wall_search walls = VG_WALL_SEARCH_INIT;
  vg_status st;

  memset(r, 0, sizeof *r);
  set_unknown(r);
  VG_TRY(vg_wall_search_open(&walls, m, o->is_wall, err));
  VG_TRY(list_walls(m, o->is_wall, r, err));
  VG_TRY(vg_cell_links_build(&links, m, 0, "the mesh", err));
  find_length(m, &walls, r);
  for (int in = 0; in < VG_UNKNOWNS; in++) {
    struct vg_measurement k = { .m = m,
                                .links = &links,
                                .walls = &walls,
                                .is_wall = o->is_wall,
                                .threads = o->threads,
                                .only_walls = only_walls,
                                .volumes = VG_VOLUMES_INIT };

    VG_TRY(measure(&k, (enum vg_unknowns)in, o, r, err));
  }
done:
  vg_cell_links_release(&links);
  vg_wall_search_release(&walls);
  if (st < 0) vg_accuracy_release(r);
  return st;
}

vg_status vg_accuracy_measure(const struct vg_mesh *m,
                              const struct vg_accuracy_options *o,
                              struct vg_accuracy_report *r,
                              struct vg_error *err)
{
  assert(m && o && r);
  assert(o->is_wall && o->viscous_length >= 0);

  struct vg_accuracy_report got;
  vg_status st = vg_accuracy_measure_with(m, o, 0, &got, err);

  if (st < 0) return st;
  if (o->with_reference && got.first_height > 0)
    st = vg_accuracy_compare(o, &got, err);
  if (st < 0) vg_accuracy_release(&got);
  else *r = got;
  return st;
}
