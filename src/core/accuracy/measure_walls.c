/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Errors of the wall profile on walls. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/accuracy/accuracy_parts.h"
#include "core/geometry/vector.h"
#include "core/judge/face_shape.h"

/* Sums over the first control volumes and the faces of a wall. */
struct sums {
  double volume2[VG_SCHEME_VISCOUS], exact2; /* of squares, with volumes */
  double area, shear, shear2;
};

static void add_volume(const struct vg_measurement *k, size_t i,
                       struct vg_accuracy_patch *p, struct sums *s)
{
  double gradient[VG_SCHEME_VISCOUS][3], volume = k->volumes.volume[i];
  struct vg_field_value exact;

  vg_fields[VG_FIELD_WALL].at(&k->scale, &k->place[i], &exact);
  if (!(vg_dot(exact.gradient, exact.gradient) > 0)) return; /* sharp edge */
  vg_scheme_gradients(&k->values, i, gradient);
  p->n[k->volumes.in]++;
  for (int scheme = 0; scheme < VG_SCHEME_VISCOUS; scheme++)
    s->volume2[scheme] += volume *
                          vg_distance2(gradient[scheme], exact.gradient);
  s->exact2 += volume * vg_dot(exact.gradient, exact.gradient);
}

/* The gradient in a cell, from the values at its points. */
static void cell_gradient(const struct vg_measurement *k, uint32_t cell,
                          double out[3])
{
  const double *value = k->values.at;
  struct vg_face_shape shape[6];
  double middle[3], sum[3] = { 0, 0, 0 }, volume;
  int n_face = vg_half_faces(k->links, cell);

  for (int j = 0; j < n_face; j++) {
    uint32_t node[4];
    double x[4][3] = { { 0 } }, mean = 0;
    int n = vg_half_face_nodes(k->links, 8 * cell + (uint32_t)j, node);

    for (int i = 0; i < n; i++) {
      memcpy(x[i], k->m->point[node[i]], sizeof x[i]);
      mean += value[node[i]] / n;
    }
    vg_face_shape((const double(*)[3])x, n, &shape[j]);
    for (int c = 0; c < 3; c++) sum[c] += mean * shape[j].area[c];
  }
  volume = vg_faces_middle(shape, n_face, middle) / 3;
  for (int c = 0; c < 3; c++) out[c] = sum[c] / volume;
}

/* Wall shear on a boundary face, over its exact value. Returns the area of the
 * face, or 0 at a sharp edge. */
static double shear_on(const struct vg_measurement *k, size_t face,
                       double *shear)
{
  uint32_t node[4], code = k->links->boundary[face], cell = code >> 3;
  struct vg_face_shape shape;
  struct vg_place centre;
  double x[4][3] = { { 0 } }, slope, to[3], area;
  int n = vg_half_face_nodes(k->links, code, node);

  for (int i = 0; i < n; i++) memcpy(x[i], k->m->point[node[i]], sizeof x[i]);
  vg_face_shape((const double(*)[3])x, n, &shape);
  memcpy(centre.x, shape.centre, sizeof centre.x);
  vg_wall_search_ask(k->walls, &centre);
  area = vg_norm(shape.area);
  if (!(vg_dot(centre.normal, centre.normal) > 0) || !(area > 0)) return 0;
  if (k->volumes.in == VG_IN_NODES) {
    cell_gradient(k, cell, to);
    slope = -vg_dot(to, shape.area) / area;
  } else {
    vg_sub(shape.centre, k->volumes.x[cell], to);
    slope = k->values.at[cell] * area / vg_dot(to, shape.area);
  }
  *shear = slope * k->scale.viscous; /* the exact slope is 1 / viscous */
  return area;
}

static void add_faces(const struct vg_measurement *k, const uint32_t *index,
                      struct vg_accuracy_patch *list, struct sums *sums)
{
  const struct vg_mesh *m = k->m;
  const enum vg_unknowns in = k->volumes.in;

  for (size_t f = 0; f < m->n_tri + m->n_quad; f++) {
    uint32_t patch = f < m->n_tri ? m->tri_patch[f]
                                  : m->quad_patch[f - m->n_tri];
    struct vg_accuracy_patch *p;
    double area, shear;

    if (!k->is_wall[patch]) continue;
    p = &list[index[patch]];
    area = shear_on(k, f, &shear);
    if (!(area > 0)) continue;
    sums[index[patch]].area += area;
    sums[index[patch]].shear += area * shear;
    sums[index[patch]].shear2 += area * (shear - 1) * (shear - 1);
    p->shear_max[in] = fmax(p->shear_max[in], fabs(shear - 1));
  }
}

vg_status vg_measure_walls(struct vg_measurement *k,
                           struct vg_accuracy_report *r, struct vg_error *err)
{
  const enum vg_unknowns in = k->volumes.in;
  uint32_t *index = vg_calloc(k->m->n_patch, sizeof *index);
  struct sums *sums = vg_calloc(r->n_patch, sizeof *sums);
  vg_status st = VG_OK;

  if (!index || !sums) VG_TRY(vg_fail_memory(err, "the accuracy at walls"));
  for (size_t i = 0; i < r->n_patch; i++)
    index[r->patch[i].patch] = (uint32_t)i;
  vg_measure_values(k, VG_FIELD_WALL);
  for (size_t i = 0; i < k->volumes.n; i++)
    if (k->patch[i] != VG_NO_PATCH)
      add_volume(k, i, &r->patch[index[k->patch[i]]],
                 &sums[index[k->patch[i]]]);
  add_faces(k, index, r->patch, sums);
  for (size_t i = 0; i < r->n_patch; i++) {
    struct vg_accuracy_patch *p = &r->patch[i];
    const struct sums *s = &sums[i];

    for (int scheme = 0; scheme < VG_SCHEME_VISCOUS; scheme++)
      p->gradient[in][scheme] = sqrt(s->volume2[scheme] / s->exact2);
    p->shear_mean[in] = s->shear / s->area;
    p->shear_l2[in] = sqrt(s->shear2 / s->area);
  }
done:
  free(index);
  free(sums);
  return st;
}
