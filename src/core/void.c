#include "core/void.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_void_release(struct vg_void *v)
{
  free(v->x);
  free(v->face);
  free(v->cell);
  memset(v, 0, sizeof *v);
}

vg_status vg_void_from_mesh(struct vg_void *v, const struct vg_mesh *m,
                            struct vg_error *err)
{
  if (m->n_quad)
    return vg_fail(err, VG_ERR_INPUT, "the surface has %zu quadrilaterals; "
                   "split them into triangles", m->n_quad);
  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (m->tri[i][k] >= m->n_point)
        return vg_fail(err, VG_ERR_INPUT, "triangle %zu refers to point %u "
                       "of %zu", i + 1, m->tri[i][k] + 1, m->n_point);
  if (vg_reserve(&v->x, &v->cap_point, m->n_point, sizeof *v->x) ||
      vg_reserve(&v->face, &v->cap_face, m->n_tri, sizeof *v->face)) {
    vg_void_release(v);
    return vg_fail_memory(err, "the front");
  }
  v->n_point = m->n_point;
  v->n_face = m->n_tri;
  if (m->n_point) memcpy(v->x, m->point, m->n_point * sizeof *v->x);
  if (m->n_tri) memcpy(v->face, m->tri, m->n_tri * sizeof *v->face);
  return VG_OK;
}
