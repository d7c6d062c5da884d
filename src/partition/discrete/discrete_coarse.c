/* The coarse mesh, by the kernel that makes all cells. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/grow.h"
#include "partition/discrete/discrete_parts.h"

void vg_coarse_release(struct vg_coarse *c)
{
  vg_tets_release(&c->t);
  free(c->on);
  free(c->weight);
  free(c->part);
  memset(c, 0, sizeof *c);
}

/* Sizes of the coarse mesh grow from the front's own edges by this much for
 * each length: cells there are well shaped, and interfaces leave the front at
 * good angles. */
static const double growth = 1.6;   /* D9 */
/* The field of these sizes is as coarse. */
static const double coarseness = 3;

vg_status vg_discrete_sizes(const struct vg_mesh *front,
                            const struct vg_sizing *sizing, double factor,
                            struct vg_sizing **out, struct vg_error *err)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *most = NULL;
  vg_status st;

  o.growth = growth;
  o.coarseness = coarseness;
  o.h_max = INFINITY;
  st = vg_sizing_new(&o, 0, NULL, front, &most, err);
  if (st == VG_OK)
    st = vg_sizing_coarsened(sizing, factor, most, out, err);
  vg_sizing_free(most);
  return st;
}

static int stop(void *user, const char *stage, size_t done, size_t expected)
{
  (void)stage;
  (void)done;
  (void)expected;
  return vg_engine_stopping(user);
}

static vg_status grow(const struct vg_front *f, const struct vg_sizing *sizing,
                      double factor, const struct vg_engine *e,
                      struct vg_void *v, struct vg_error *err)
{
  struct vg_mesh m = { .n_point = f->n_point, .point = f->x,   /* borrowed */
                       .n_tri = f->n_face, .tri = f->face };
  struct vg_grow_options o = VG_GROW_OPTIONS_INIT;
  struct vg_fill_report report = {0};
  struct vg_sizing *coarse = NULL;
  vg_status st;

  if (e) o.progress = stop;
  o.user = (void *)(uintptr_t)e;
  if (vg_reserve(&v->x, &v->cap_point, f->n_point, sizeof *v->x) ||
      vg_reserve(&v->face, &v->cap_face, f->n_face, sizeof *v->face))
    return vg_fail_memory(err, "the coarse mesh");
  memcpy(v->x, f->x, f->n_point * sizeof *v->x);
  memcpy(v->face, f->face, f->n_face * sizeof *v->face);
  v->n_point = f->n_point;
  v->n_face = f->n_face;
  st = vg_discrete_sizes(&m, sizing, factor, &coarse, err);
  if (st == VG_OK) st = vg_grow(v, coarse, &o, &report, err);
  vg_sizing_free(coarse);
  return st;
}

/* A copy: what is given stays the giver's. */
static vg_status take(const struct vg_coarse_cells *given, struct vg_void *v,
                      struct vg_error *err)
{
  if (vg_reserve(&v->x, &v->cap_point, given->n_point, sizeof *v->x) ||
      vg_reserve(&v->cell, &v->cap_cell, given->n_cell, sizeof *v->cell))
    return vg_fail_memory(err, "the coarse mesh");
  memcpy(v->x, given->x, given->n_point * sizeof *v->x);
  memcpy(v->cell, given->cell, given->n_cell * sizeof *v->cell);
  v->n_point = given->n_point;
  v->n_cell = given->n_cell;
  return VG_OK;
}

/* --- which of its faces are the front's ---------------------------------- */

/* A face of the front, corners turned such that the first is the lowest. */
struct known { uint32_t v[3], face; };

static struct known known_of(const uint32_t v[3], uint32_t face)
{
  int k = v[0] < v[1] ? v[0] < v[2] ? 0 : 2 : v[1] < v[2] ? 1 : 2;

  return (struct known){ { v[k], v[(k + 1) % 3], v[(k + 2) % 3] }, face };
}

static int by_corners(const void *a, const void *b)
{
  return memcmp(((const struct known *)a)->v, ((const struct known *)b)->v,
                sizeof ((const struct known *)a)->v);
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
  struct vg_void v = VG_VOID_INIT;
  vg_status st = given ? take(given, &v, err)
                       : grow(front, sizing, factor, e, &v, err);

  if (st != VG_OK) goto done;          /* or stopped */
  c->n_front = front->n_point;
  st = vg_tets_from_cells(&c->t, v.n_point, v.x, v.n_cell,
                          (const uint32_t (*)[4])v.cell, err);
  v.x = NULL;
  if (st == VG_OK) st = find_front(front, c, err);
done:
  vg_void_release(&v);
  return st;
}
