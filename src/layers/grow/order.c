/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sorts the faces so that neighbours are close: cells and points of the layers
 * are numbered by face. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "layers/grow/grow_parts.h"

/* Three times the centres of the first n faces. */
static void centre_faces(const struct vg_columns *c, const struct vg_mesh *m,
                         size_t n, double (*x)[3])
{
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      x[i][k] = 0;
      for (int j = 0; j < 3; j++)
        x[i][k] += m->point[c->column[c->face[i][j]].root][k];
    }
}

vg_status vg_layers_order(const struct vg_mesh *surface, struct vg_layers *l,
                          struct vg_error *err)
{
  struct vg_columns *c = &l->columns;
  size_t n = 0;
  double(*x)[3];
  uint32_t *order, *at, *tri, (*face)[3];
  vg_status st;

  while (n < c->n_face && c->face_tri[n] != VG_NO_INDEX) n++;
  x = vg_alloc(n, sizeof *x);
  order = vg_alloc(n, sizeof *order);
  at = vg_alloc(n, sizeof *at);
  tri = vg_alloc(n, sizeof *tri);
  face = vg_alloc(n, sizeof *face);
  if (!x || !order || !at || !tri || !face) {
    st = vg_fail_memory(err, "the order of the layers");
    goto done;
  }
  centre_faces(c, surface, n, x);
  VG_TRY(vg_hilbert_order(n, (const double(*)[3])x, order, err));
  for (size_t i = 0; i < n; i++) {
    memcpy(face[i], c->face[order[i]], sizeof *face);
    tri[i] = c->face_tri[order[i]];
    at[order[i]] = (uint32_t)i;
  }
  memcpy(c->face, face, n * sizeof *face);
  memcpy(c->face_tri, tri, n * sizeof *tri);
  for (size_t i = 0; i < l->front.n_face; i++)
    if (l->front.face_id[i] < n) l->front.face_id[i] = at[l->front.face_id[i]];
done:
  free(x);
  free(order);
  free(at);
  free(tri);
  free(face);
  return st;
}
