#include "core/remesh/remesh.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"

struct arranging {
  double (*middle)[3];      /* [n_tri] */
  uint32_t *order;          /* [n_tri] */
  uint32_t (*tri)[3];
  uint32_t *patch;
  double (*point)[3];
  uint32_t *number;         /* [n_point] new ones */
};

static void release(struct arranging *a)
{
  free(a->middle);
  free(a->order);
  free(a->tri);
  free(a->patch);
  free(a->point);
  free(a->number);
}

static void put_point(struct arranging *a, const struct vg_mesh *m,
                      uint32_t p, uint32_t *n)
{
  if (a->number[p] != UINT32_MAX) return;
  memcpy(a->point[*n], m->point[p], sizeof *a->point);
  a->number[p] = (*n)++;
}

/* Triangles by the order; points as they come first. */
static void put(struct arranging *a, struct vg_mesh *m)
{
  uint32_t n = 0;

  memset(a->number, 0xff, m->n_point * sizeof *a->number);
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t t = a->order[i];

    for (int k = 0; k < 3; k++) {
      put_point(a, m, m->tri[t][k], &n);
      a->tri[i][k] = a->number[m->tri[t][k]];
    }
    a->patch[i] = m->tri_patch[t];
  }
  for (uint32_t p = 0; p < m->n_point; p++) put_point(a, m, p, &n);
  memcpy(m->point, a->point, m->n_point * sizeof *m->point);
  memcpy(m->tri, a->tri, m->n_tri * sizeof *m->tri);
  memcpy(m->tri_patch, a->patch, m->n_tri * sizeof *m->tri_patch);
}

vg_status vg_remesh_arrange(struct vg_mesh *m, struct vg_error *err)
{
  struct arranging a = { 0 };
  vg_status st = VG_OK;

  a.middle = vg_alloc(m->n_tri, sizeof *a.middle);
  a.order = vg_alloc(m->n_tri, sizeof *a.order);
  a.tri = vg_alloc(m->n_tri, sizeof *a.tri);
  a.patch = vg_alloc(m->n_tri, sizeof *a.patch);
  a.point = vg_alloc(m->n_point, sizeof *a.point);
  a.number = vg_alloc(m->n_point, sizeof *a.number);
  if (!a.middle || !a.order || !a.tri || !a.patch || !a.point || !a.number)
    VG_TRY(vg_fail_memory(err, "the order of the surface"));
  for (size_t t = 0; t < m->n_tri; t++)
    for (int d = 0; d < 3; d++)
      a.middle[t][d] = (m->point[m->tri[t][0]][d] + m->point[m->tri[t][1]][d]
                        + m->point[m->tri[t][2]][d]) / 3;
  VG_TRY(vg_hilbert_order(m->n_tri, (const double (*)[3])a.middle, a.order,
                          err));
  put(&a, m);
done:
  release(&a);
  return st;
}
