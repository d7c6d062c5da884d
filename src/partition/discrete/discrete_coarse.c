/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Generates the coarse mesh with the kernel that makes all cells. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/fill.h"
#include "partition/discrete/discrete_parts.h"

void vg_coarse_release(struct vg_coarse *c)
{
  vg_tets_release(&c->t);
  free(c->on);
  free(c->weight);
  free(c->part);
  memset(c, 0, sizeof *c);
}

/* Growth of the coarse mesh from the front's own edges per length: cells there
 * are well shaped, and interfaces leave the front at good angles. */
static const double growth = 1.6; /* D9 */
/* Coarseness of the sizing field's octree for these sizes. */
static const double coarseness = 3;

vg_status vg_discrete_sizes(const struct vg_mesh *front,
                            const struct vg_sizing *sizing, double factor,
                            struct vg_sizing **out, struct vg_error *err)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *most = NULL;
  vg_status st;

  assert(front && sizing && out);
  o.growth = growth;
  o.coarseness = coarseness;
  o.h_max = INFINITY;
  st = vg_sizing_new(&o, 0, NULL, front, &most, err);
  if (st == VG_OK) st = vg_sizing_coarsened(sizing, factor, most, out, err);
  vg_sizing_free(most);
  return st;
}

/* Points of a coarse mesh: those of the front, then new ones. */
static vg_status join_points(const struct vg_front *f, struct vg_filled *made,
                             struct vg_coarse_cells *out, struct vg_error *err)
{
  out->n_point = f->n_point + made->n_point;
  out->x = vg_alloc(out->n_point, sizeof *out->x);
  if (!out->x) return vg_fail_memory(err, "the coarse mesh");
  memcpy(out->x, f->x, f->n_point * sizeof *out->x);
  if (made->n_point)
    memcpy(out->x + f->n_point, made->x, made->n_point * sizeof *out->x);
  out->n_cell = made->n_cell;
  out->cell = made->cell;
  made->cell = NULL;
  return VG_OK;
}

static vg_status fill(const struct vg_front *f, const struct vg_sizing *sizing,
                      double factor, const struct vg_engine *e,
                      struct vg_coarse_cells *out, struct vg_error *err)
{
  struct vg_mesh m = { .n_point = f->n_point,
                       .point = f->x, /* borrowed */
                       .n_tri = f->n_face,
                       .tri = f->face };
  struct vg_fill_options o = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report report = { 0 };
  struct vg_filled made = VG_FILLED_INIT;
  struct vg_sizing *coarse = NULL;
  vg_status st;

  o.stop = vg_engine_stop(e);
  VG_TRY(vg_discrete_sizes(&m, sizing, factor, &coarse, err));
  VG_TRY(vg_fill_front(f, NULL, coarse, &o, &made, &report, err));
  st = join_points(f, &made, out, err);
done:
  vg_filled_release(&made);
  vg_sizing_free(coarse);
  return st;
}

/* A coarse mesh made before is borrowed, so its points are copied for the
 * tetrahedra, which take the array over. */
static vg_status copy_points(const struct vg_coarse_cells *given,
                             struct vg_coarse_cells *out, struct vg_error *err)
{
  *out = *given;
  out->x = vg_alloc(given->n_point, sizeof *out->x);
  if (!out->x) return vg_fail_memory(err, "the coarse mesh");
  memcpy(out->x, given->x, given->n_point * sizeof *out->x);
  return VG_OK;
}

/* --- faces on the front -------------------------------------------------- */

/* A face of the front, rotated so that the lowest corner is first. */
struct known {
  uint32_t v[3], face;
};

static struct known known_of(const uint32_t v[3], uint32_t face)
{
  int k = v[0] < v[1] ? v[0] < v[2] ? 0 : 2 : v[1] < v[2] ? 1 : 2;

  return (struct known){ { v[k], v[(k + 1) % 3], v[(k + 2) % 3] }, face };
}

static int by_corners(const void *a, const void *b)
{
  return memcmp(((const struct known *)a)->v, ((const struct known *)b)->v,
                sizeof((const struct known *)a)->v);
}

static vg_status find_front(const struct vg_front *f, struct vg_coarse *c,
                            struct vg_error *err)
{
  struct known *k = vg_alloc(f->n_face, sizeof *k);

  c->on = vg_alloc(c->t.n_cell, sizeof *c->on);
  if (!k || !c->on) {
    free(k);
    return vg_fail_memory(err, "the coarse mesh");
  }
  for (size_t i = 0; i < f->n_face; i++)
    k[i] = known_of(f->face[i], (uint32_t)i);
  if (f->n_face) qsort(k, f->n_face, sizeof *k, by_corners);
  for (size_t q = 0; q < 4 * c->t.n_cell; q++) {
    struct vg_cell *cell = &c->t.cell[q / 4];
    const uint8_t *at = vg_face[q % 4];
    const uint32_t v[3] = { cell->v[at[0]], cell->v[at[1]], cell->v[at[2]] };
    const struct known key = known_of(v, 0), *found = NULL;

    if (v[0] < c->n_front && v[1] < c->n_front && v[2] < c->n_front)
      found = bsearch(&key, k, f->n_face, sizeof *k, by_corners);
    c->on[q / 4][q % 4] = found ? found->face : VG_NONE;
    if (found) cell->link[q % 4] = VG_NONE;
  }
  free(k);
  return VG_OK;
}

vg_status vg_coarse_fill(const struct vg_front *front,
                         const struct vg_sizing *sizing, double factor,
                         const struct vg_coarse_cells *given,
                         const struct vg_engine *e, struct vg_coarse *c,
                         struct vg_error *err)
{
  struct vg_coarse_cells all = { .n_cell = 0 };
  vg_status st;

  assert(!c->t.n_cell && !c->on && !c->weight && !c->part);
  VG_TRY(given ? copy_points(given, &all, err)
               : fill(front, sizing, factor, e, &all, err));
  c->n_front = front->n_point;
  st = vg_tets_from_cells(&c->t, all.n_point, all.x, all.n_cell,
                          (const uint32_t(*)[4])all.cell, err);
  all.x = NULL;
  if (st == VG_OK) st = find_front(front, c, err);
done:
  free(all.x);
  if (!given) free(all.cell);
  return st;
}
