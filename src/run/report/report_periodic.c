/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on periodic patches. Declared in run/report/report.h. */
#include "core/periodic/periodic.h"
#include "run/common/text.h"
#include "run/report/report.h"
#include "run/report/report_parts.h"

static void put_transform(FILE *to, const struct vg_periodic *p)
{
  const double *x = p->shift;

  if (p->is_rotation) {
    fprintf(to, "rotation by %.9g degrees", vg_periodic_degrees(p));
    if (p->n) fprintf(to, " (360/%d)", p->n);
    x = p->axis;
    fprintf(to, " about (%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
    x = p->centre;
    fprintf(to, " through (%.6g, %.6g, %.6g)\n", x[0], x[1], x[2]);
  } else {
    fprintf(to, "translation by (%.9g, %.9g, %.9g)\n", x[0], x[1], x[2]);
  }
}

void vg_report_periodic_text(FILE *to, size_t n, const struct vg_periodic *p,
                             double distance)
{
  char count[32];

  if (!n) return;
  fprintf(to, "\nPeriodic patches\n");
  for (size_t i = 0; i < n; i++) {
    fprintf(to, "  %d to %d: ", (int)p[i].patch, (int)p[i].image);
    put_transform(to, &p[i]);
    fprintf(to, "    %s triangles each; points moved by at most %.3g\n",
            vg_text_count(p[i].n_face, count), p[i].distance);
  }
  fprintf(to, "  distance in the mesh: at most %.3g\n", distance);
}

json_t *vg_report_periodic_json(size_t n, const struct vg_periodic *p)
{
  json_t *list = json_array();

  for (size_t i = 0; i < n; i++) {
    json_t *o = json_pack("{s:i s:i s:s s:o s:f}", "patch", (int)p[i].patch,
                          "image", (int)p[i].image, "kind",
                          p[i].is_rotation ? "rotation" : "translation",
                          "triangles", vg_json_count(p[i].n_face), "moved",
                          p[i].distance);

    if (!p[i].is_rotation) {
      json_object_set_new(o, "translation", vg_json_reals(p[i].shift, 3));
    } else {
      json_object_set_new(o, "angle", json_real(vg_periodic_degrees(&p[i])));
      json_object_set_new(o, "turns_per_circle", json_integer(p[i].n));
      json_object_set_new(o, "axis", vg_json_reals(p[i].axis, 3));
      json_object_set_new(o, "centre", vg_json_reals(p[i].centre, 3));
    }
    json_array_append_new(list, o);
  }
  return list;
}
