/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on discretisation errors. */
#include "run/common/text.h"
#include "run/report/report.h"
#include "run/report/report_parts.h"

static const char *const scheme_name[VG_SCHEMES] = {
  [VG_SCHEME_LSQ] = "least_squares",
  [VG_SCHEME_WLSQ] = "weighted_least_squares",
  [VG_SCHEME_GAUSS] = "green_gauss",
  [VG_SCHEME_VISCOUS] = "laplacian"
};

static const char *const unknowns_name[VG_UNKNOWNS] = { "points", "cells" };

static const char *const shape_name[VG_REFERENCES] = {
  [VG_REFERENCE_PLATE] = "plate", [VG_REFERENCE_CYLINDER] = "cylinder"
};

/* --- text ----------------------------------------------------------------- */

static void put_number(FILE *to, double v)
{
  if (isfinite(v)) fprintf(to, " %8.3g", v);
  else fprintf(to, " %8s", "-");
}

/* A line of errors in per cent; `errors` of both kinds of unknowns. */
static void put_errors(FILE *to, const char *title,
                       const struct vg_accuracy_error *const e[VG_UNKNOWNS],
                       size_t step)
{
  fprintf(to, "    %-18s", title);
  for (int in = 0; in < VG_UNKNOWNS; in++)
    for (size_t s = 0; s < VG_SCHEMES; s++)
      put_number(to, 100 * e[in][s * step].l2);
  fprintf(to, "\n");
}

static void put_zone(FILE *to, const struct vg_accuracy_report *r,
                     const char *title, enum vg_accuracy_field f,
                     enum vg_accuracy_zone z)
{
  const struct vg_accuracy_error *e[VG_UNKNOWNS];

  for (int in = 0; in < VG_UNKNOWNS; in++) e[in] = &r->error[in][f][0][z];
  put_errors(to, title, e, VG_ZONES);
}

static void put_references(FILE *to, const struct vg_accuracy_report *r)
{
  for (int shape = 0; shape < VG_REFERENCES; shape++) {
    const struct vg_accuracy_reference *ref = &r->reference[shape];
    const struct vg_accuracy_error *const e[VG_UNKNOWNS] = { ref->layers[0],
                                                             ref->layers[1] };
    char title[32];

    snprintf(title, sizeof title, "structured %s", shape_name[shape]);
    put_errors(to, title, e, 1);
  }
  fprintf(to, "    (structured: hexahedra, levels %zu, growth %.4g)\n",
          r->reference[0].levels, r->reference[0].growth);
}

static void put_walls(FILE *to, const struct vg_accuracy_report *r,
                      const struct vg_mesh *m)
{
  fprintf(to,
          "  wall shear over its exact value, mean and deviation (%%), from "
          "points and from cells\n");
  for (size_t i = 0; i < r->n_patch && i < VG_SHOWN_PATCHES; i++) {
    const struct vg_accuracy_patch *p = &r->patch[i];
    const struct vg_patch *patch = &m->patch[p->patch];

    fprintf(to, "    %-18s", "");
    for (int in = 0; in < VG_UNKNOWNS; in++) {
      put_number(to, p->shear_mean[in]);
      put_number(to, 100 * p->shear_l2[in]);
    }
    fprintf(to, "   patch %d %s\n", (int)patch->id, patch->name);
  }
}

void vg_report_accuracy_text(FILE *to, const struct vg_accuracy_report *r,
                             const struct vg_mesh *m)
{
  char a[32], b[32];

  fprintf(to,
          "  accuracy: errors relative to exact values, 2-norm (%%); gradients "
          "by least squares\n"
          "  (LSQ, and with weights 1/d), by Green-Gauss (GG), and the "
          "Laplacian (visc)\n"
          "    %-18s %35s %35s\n    %-18s",
          "", "unknowns in points", "unknowns in cells", "");
  for (int in = 0; in < VG_UNKNOWNS; in++)
    fprintf(to, " %8s %8s %8s %8s", "LSQ", "LSQ 1/d", "GG", "visc");
  fprintf(to, "\n");
  for (int f = 0; f < VG_FIELD_WALL; f++)
    put_zone(to, r, vg_accuracy_field_name((enum vg_accuracy_field)f),
             (enum vg_accuracy_field)f, VG_ZONE_FIELD);
  if (!(r->first_height > 0)) {
    fprintf(to, "    no walls: no wall profile\n");
    return;
  }
  fprintf(to,
          "  wall profile: y+ is 1 at %.4g; %s of %s points below y+ 1000\n",
          r->viscous_length, vg_text_count(r->n_layer, a),
          vg_text_count(r->n[VG_IN_NODES], b));
  for (int z = 0; z < VG_ZONES; z++)
    if (z <= VG_ZONE_LOG || z == VG_ZONE_LAYERS)
      put_zone(to, r, vg_accuracy_zone_name((enum vg_accuracy_zone)z),
               VG_FIELD_WALL, (enum vg_accuracy_zone)z);
  if (r->has_reference) put_references(to, r);
  put_walls(to, r, m);
}

/* --- JSON ----------------------------------------------------------------- */

static json_t *error_json(const struct vg_accuracy_error *e)
{
  return json_pack("{s:o s:o s:o s:o s:o}", "unknowns", vg_json_count(e->n),
                   "volume", vg_json_real(e->volume), "l1", vg_json_real(e->l1),
                   "l2", vg_json_real(e->l2), "max", vg_json_real(e->max));
}

static json_t *schemes_json(const struct vg_accuracy_error *e, size_t step)
{
  json_t *o = json_object();

  for (size_t s = 0; s < VG_SCHEMES; s++)
    if (e[s * step].n)
      json_object_set_new(o, scheme_name[s], error_json(&e[s * step]));
  return o;
}

/* Errors of all functions in all zones with control volumes. */
static json_t *fields_json(const struct vg_accuracy_report *r, int in)
{
  json_t *all = json_array();

  for (int f = 0; f < VG_FIELDS; f++)
    for (int z = 0; z < VG_ZONES; z++) {
      const struct vg_accuracy_error *e = &r->error[in][f][0][z];

      if (!e->n) continue;
      json_array_append_new(
        all, json_pack("{s:s s:s s:o}", "field",
                       vg_accuracy_field_name((enum vg_accuracy_field)f),
                       "zone", vg_accuracy_zone_name((enum vg_accuracy_zone)z),
                       "errors", schemes_json(e, VG_ZONES)));
    }
  return all;
}

static json_t *wall_json(const struct vg_accuracy_patch *p, int in)
{
  return json_pack("{s:o s:o s:o s:o s:o}", "unknowns", vg_json_count(p->n[in]),
                   "gradient_l2",
                   vg_json_reals(p->gradient[in], VG_SCHEME_VISCOUS),
                   "shear_mean", vg_json_real(p->shear_mean[in]), "shear_l2",
                   vg_json_real(p->shear_l2[in]), "shear_max",
                   vg_json_real(p->shear_max[in]));
}

static json_t *walls_json(const struct vg_accuracy_report *r,
                          const struct vg_mesh *m)
{
  json_t *all = json_array();

  for (size_t i = 0; i < r->n_patch && r->first_height > 0; i++) {
    const struct vg_accuracy_patch *p = &r->patch[i];

    json_array_append_new(all, json_pack("{s:I s:o s:o}", "patch",
                                         (json_int_t)m->patch[p->patch].id,
                                         unknowns_name[VG_IN_NODES],
                                         wall_json(p, VG_IN_NODES),
                                         unknowns_name[VG_IN_CELLS],
                                         wall_json(p, VG_IN_CELLS)));
  }
  return all;
}

static json_t *references_json(const struct vg_accuracy_report *r)
{
  json_t *all = json_array();

  for (int shape = 0; shape < VG_REFERENCES && r->has_reference; shape++) {
    const struct vg_accuracy_reference *ref = &r->reference[shape];

    json_array_append_new(
      all, json_pack("{s:s s:o s:o s:o s:o}", "shape", shape_name[shape],
                     "levels", vg_json_count(ref->levels), "growth",
                     vg_json_real(ref->growth), unknowns_name[VG_IN_NODES],
                     schemes_json(ref->layers[VG_IN_NODES], 1),
                     unknowns_name[VG_IN_CELLS],
                     schemes_json(ref->layers[VG_IN_CELLS], 1)));
  }
  return all;
}

json_t *vg_report_accuracy_json(const struct vg_accuracy_report *r,
                                const struct vg_mesh *m)
{
  json_t *o = json_pack("{s:o s:o s:o s:o s:o s:o s:o}", "first_height",
                        vg_json_real(r->first_height), "viscous_length",
                        vg_json_real(r->viscous_length), "length",
                        vg_json_real(r->length), "centre",
                        vg_json_reals(r->centre, 3), "wall_area",
                        vg_json_real(r->wall_area), "wall_points",
                        vg_json_count(r->n_wall), "layer_points",
                        vg_json_count(r->n_layer));

  for (int in = 0; in < VG_UNKNOWNS; in++)
    json_object_set_new(o, unknowns_name[in],
                        json_pack("{s:o s:o s:o}", "unknowns",
                                  vg_json_count(r->n[in]), "deficient_stencils",
                                  vg_json_count(r->n_deficient[in]), "fields",
                                  fields_json(r, in)));
  json_object_set_new(o, "walls", walls_json(r, m));
  json_object_set_new(o, "structured", references_json(r));
  return o;
}
