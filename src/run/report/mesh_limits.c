/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Limits of the settings on the quality of the mesh. */
#include <assert.h>
#include <math.h>

#include "run/report/report.h"
#include "run/report/report_parts.h"

int vg_wants_median_dual(const struct vg_settings *s)
{
  return s->median_dual || !isnan(s->min_dual_orthogonality);
}

int vg_mesh_limits_missed(const struct vg_settings *s,
                          const struct vg_mesh_report *r,
                          struct vg_mesh_limit out[VG_MESH_LIMITS])
{
  const struct vg_solver_quality *q = &r->solver;
  const struct {
    struct vg_mesh_limit limit;
    int is_least;
  } all[VG_MESH_LIMITS] = {
    { { "max_non_orthogonality", " degrees", s->max_non_orthogonality,
        q->angle_max },
      0 },
    { { "max_skewness", "", s->max_skewness, q->skewness_max }, 0 },
    { { "min_face_weight", "", s->min_face_weight, q->weight_min }, 1 },
    { { "min_orthogonal_quality", "", s->min_orthogonal_quality,
        q->quality_min },
      1 },
    { { "min_dual_orthogonality", " degrees",
        r->has_dual ? s->min_dual_orthogonality : NAN, r->dual.point_min },
      1 },
  };
  int n = 0;

  assert(out);
  if (!r->has_solver) return 0;
  for (int i = 0; i < VG_MESH_LIMITS; i++) {
    const struct vg_mesh_limit *l = &all[i].limit;

    /* NAN, no limit, compares false. */
    if (all[i].is_least ? l->got < l->wanted : l->got > l->wanted)
      out[n++] = *l;
  }
  return n;
}

void vg_report_mesh_limits_text(FILE *to, const struct vg_settings *s,
                                const struct vg_mesh_report *r)
{
  struct vg_mesh_limit limit[VG_MESH_LIMITS];
  int n = vg_mesh_limits_missed(s, r, limit);

  for (int i = 0; i < n; i++)
    fprintf(to, "limit not met: mesh: %s is %.10g%s, reached %.10g%s\n",
            limit[i].name, limit[i].wanted, limit[i].unit, limit[i].got,
            limit[i].unit);
}

json_t *vg_report_mesh_limits_json(const struct vg_settings *s,
                                   const struct vg_mesh_report *r)
{
  struct vg_mesh_limit limit[VG_MESH_LIMITS];
  int n = vg_mesh_limits_missed(s, r, limit);
  json_t *list = json_array();

  for (int i = 0; i < n; i++)
    json_array_append_new(list,
                          json_pack("{s:s s:o s:o}", "limit", limit[i].name,
                                    "required", vg_json_real(limit[i].wanted),
                                    "got", vg_json_real(limit[i].got)));
  return list;
}
