/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks the invariant of planar_tri.h, as a stage check (base/checks.h). */
#include "core/domain/planar_tri.h"
#include "core/geometry/predicates.h"

static size_t bad_edge(const struct vg_tri2 *t, uint32_t e)
{
  const uint32_t twin = vg_t2_twin(t, e);

  if (twin == VG_T2_NONE) return 0;
  if (twin >> 2 >= t->n_face || t->face[twin >> 2].flag & VG_T2_DEAD) return 1;
  return (size_t)(vg_t2_twin(t, twin) != e) +
         (vg_t2_from(t, twin) != vg_t2_to(t, e)) +
         (vg_t2_to(t, twin) != vg_t2_from(t, e)) +
         (vg_t2_is_fixed(t, twin) != vg_t2_is_fixed(t, e));
}

static size_t is_wrong(const struct vg_tri2 *t, uint32_t e)
{
  const uint32_t twin = vg_t2_twin(t, e);

  return twin != VG_T2_NONE && !vg_t2_is_fixed(t, e) &&
         vg_incircle(t->x[vg_t2_from(t, e)], t->x[vg_t2_to(t, e)],
                     t->x[vg_t2_apex(t, e)], t->x[vg_t2_apex(t, twin)]) > 0;
}

size_t vg_tri2_defects(const struct vg_tri2 *t)
{
  size_t bad = 0;

  for (uint32_t i = 0; i < t->n_face; i++) {
    const uint32_t *v = t->face[i].v;

    if (t->face[i].flag & VG_T2_DEAD) continue;
    bad += !(vg_orient2d(t->x[v[0]], t->x[v[1]], t->x[v[2]]) > 0);
    for (uint32_t e = 4 * i; e < 4 * i + 3; e++) bad += bad_edge(t, e);
  }
  for (uint32_t i = 0; !bad && i < t->n_face; i++)
    for (uint32_t e = 4 * i; e < 4 * i + 3; e++)
      bad += !(t->face[i].flag & VG_T2_DEAD) && is_wrong(t, e);
  return bad;
}
